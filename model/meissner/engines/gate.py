"""Engine ``gate``: the netlist after synthesis, in ECP5 cells, with the drivers of engine ``rtl``."""

from meissner.engines import rtl, rtl_core
from meissner.engines.verilated import of_gates

watch, windows, watch_pins = (of_gates(f) for f in (rtl.watch, rtl.windows, rtl.watch_pins))
cop, cop4, cop_slip = (of_gates(f) for f in (rtl.cop, rtl.cop4, rtl.cop_slip))
calibrate, demodulate = of_gates(rtl.calibrate), of_gates(rtl.demodulate)
core_on_pins = of_gates(rtl_core.CoreOnPins)
