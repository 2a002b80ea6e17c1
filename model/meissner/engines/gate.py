"""Engine ``gate``: the netlist after synthesis, in cells of an ECP5, behind the drivers of engine ``rtl``."""

from functools import wraps

from meissner.engines import rtl, rtl_core, rtl_hand, verilated

CELLS = "ecp5"


def _of_gates(function):
    @wraps(function)
    def run(*arguments, **named):
        with verilated.gates(CELLS):
            return function(*arguments, **named)

    return run


watch, windows, watch_pins = (_of_gates(f) for f in (rtl.watch, rtl.windows, rtl.watch_pins))
cop, cop4, cop_slip = (_of_gates(f) for f in (rtl.cop, rtl.cop4, rtl.cop_slip))
calibrate, demodulate = _of_gates(rtl.calibrate), _of_gates(rtl.demodulate)
core_on_pins, core_of_hand = _of_gates(rtl_core.CoreOnPins), _of_gates(rtl_hand.Core)
