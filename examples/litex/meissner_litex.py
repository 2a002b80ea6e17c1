"""The core as a LiteX peripheral: registers on the SoC's bus, samples and packets as LiteX streams.

    python examples/litex/meissner_litex.py build/litex     writes the Verilog of a SoC without a processor

``Meissner(platform, Rows=4, Columns=6)`` takes the parameters of rtl/msn_axis.sv; in a SoC of yours:

    self.tactile = Meissner(platform, Rows=4, Columns=6, ClkKhz=sys_clk_freq // 1000)
    self.bus.add_slave("tactile", self.tactile.bus, SoCRegion(size=0x1000, cached=False))

The registers are at that region's base, as docs/registers.md lists them; ``sink`` takes a beat of a frame in
32 bits, with ``last`` on the frame's last one; ``source`` gives packets (docs/link.md) byte by byte.
"""

import sys
from pathlib import Path

from litex.build.generic_platform import Pins, Subsignal
from litex.build.sim import SimPlatform
from litex.gen import LiteXModule
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import axi, stream, wishbone
from migen import ClockDomain, ClockSignal, Constant, Instance, ResetSignal, Signal

ROOT = Path(__file__).resolve().parents[2]
BASE = 0x3000_0000  # of the core in the SoC below


class Meissner(LiteXModule):
    def __init__(self, platform, **parameters):
        self.bus = bus = axi.AXILiteInterface(data_width=32, address_width=32)
        self.sink, self.source = stream.Endpoint([("data", 32)]), stream.Endpoint([("data", 8)])
        self.slip, self.gross, self.touched, self.pressed = (Signal() for _ in range(4))
        ports = {f"p_{name}": Constant(value, 32) for name, value in parameters.items()}
        ports |= {"i_clk_i": ClockSignal(), "i_rst_i": ResetSignal(), "i_actuator_moving_i": 0}
        ports |= {"o_slip_o": self.slip, "o_gross_o": self.gross}
        ports |= {"o_touched_o": self.touched, "o_pressed_o": self.pressed}

        def join(prefix, end, fields, takes, width=None):
            """``takes``: the core is at the receiving end."""
            into, out = ("i", "o") if takes else ("o", "i")
            ports[f"{into}_{prefix}valid"], ports[f"{out}_{prefix}ready"] = end.valid, end.ready
            for field in fields.split():
                value = getattr(end, field)
                ports[f"{into}_{prefix}{field}"] = value[:width] if width else value

        join("s_axis_t", self.sink, "data last", True)
        join("m_axis_t", self.source, "data last", False)
        join("s_axil_aw", bus.aw, "addr", True, 12)
        join("s_axil_ar", bus.ar, "addr", True, 12)
        join("s_axil_w", bus.w, "data strb", True)
        join("s_axil_b", bus.b, "resp", False)
        join("s_axil_r", bus.r, "data resp", False)
        self.specials += Instance("msn_axis", i_s_axil_awprot=0, i_s_axil_arprot=0, **ports)
        for line in (ROOT / "rtl/rtl.f").read_text("utf-8").split():
            platform.add_source(str(ROOT / line))


def pads(name, **widths):
    return (name, 0, *(Subsignal(signal, Pins(width)) for signal, width in widths.items()))


BUS = {"adr": 30, "dat_w": 32, "sel": 4, "cyc": 1, "stb": 1, "we": 1, "dat_r": 32, "ack": 1, "err": 1}
STREAM = {"valid": 1, "ready": 1, "last": 1}
IO = [("clk", 0, Pins(1)), ("rst", 0, Pins(1)), pads("bus", **BUS)]
IO += [pads("samples", data=32, **STREAM), pads("packets", data=8, **STREAM)]


class Soc(SoCMini):
    """The core on the bus of a SoC whose only master is a Wishbone bus at its pins."""

    def __init__(self, platform, clk_khz=100_000, **parameters):
        super().__init__(platform, clk_freq=clk_khz * 1000, cpu_type=None)
        self.cd_sys = ClockDomain()
        self.comb += [
            self.cd_sys.clk.eq(platform.request("clk")),
            self.cd_sys.rst.eq(platform.request("rst")),
        ]
        self.tactile = Meissner(platform, ClkKhz=clk_khz, **parameters)
        self.bus.add_slave("tactile", self.tactile.bus, SoCRegion(origin=BASE, size=0x1000, cached=False))
        master, pins = wishbone.Interface(data_width=32, address_width=32), platform.request("bus")
        self.bus.add_master("pins", master)
        self.comb += [getattr(master, name).eq(getattr(pins, name)) for name in list(BUS)[:6]]
        self.comb += [getattr(pins, name).eq(getattr(master, name)) for name in list(BUS)[6:]]
        for name, end, takes in (
            ("samples", self.tactile.sink, True),
            ("packets", self.tactile.source, False),
        ):
            pins = platform.request(name)
            for field in ("valid", "data", "last"):
                one, other = getattr(end, field), getattr(pins, field)
                self.comb += one.eq(other) if takes else other.eq(one)
            self.comb += pins.ready.eq(end.ready) if takes else end.ready.eq(pins.ready)


def write(path, top="msn_litex", **parameters):
    """The Verilog of ``Soc`` without the core's own sources, to ``path``."""
    platform = SimPlatform("SIM", IO)
    soc = Soc(platform, **parameters)
    soc.finalize()
    Path(path).write_text(str(platform.get_verilog(soc, name=top)), "utf-8")


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "msn_litex.v", Rows=4, Columns=6)
