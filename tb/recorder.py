"""What a block's own tests drive into it, clock by clock: the stimulus of fault injection.

With MEISSNER_RECORD=FILE in the environment each start of a clock begins a recording of the ports of the top.
FILE: a line "port bits" for each, an empty line, then hexadecimal values per clock; "=" begins one.
After ``ROWS`` clocks the simulation ends, its tests unfinished.
"""

import os

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly

ROWS = int(os.environ.get("MEISSNER_RECORD_ROWS", "24000"))
FILE = os.environ.get("MEISSNER_RECORD")
_open = None
_rows = 0
_begun = 0  # recordings: a test that starts its clock again begins another, and the one before ends


def _bits(handle):
    try:
        return len(handle)
    except TypeError:
        return 1


def _ports(dut):
    """The ports of a top but its clock, as MEISSNER_RECORD_PORTS names them."""
    names = [name for name in os.environ["MEISSNER_RECORD_PORTS"].split(",") if name != "clk_i"]
    return {name: getattr(dut, name) for name in sorted(names)}


async def record(dut):
    global _open, _rows, _begun
    ports = _ports(dut)
    _begun += 1
    mine = _begun
    if _open is None:
        _open = open(FILE, "w")  # noqa: SIM115 - as long as the simulation
        _open.writelines(f"{name} {_bits(handle)}\n" for name, handle in ports.items())
        _open.write("\n")
    _open.write("=\n")
    while True:
        await FallingEdge(dut.clk_i)
        await ReadOnly()
        if mine != _begun:
            return
        values = [handle.value for handle in ports.values()]
        _open.write(" ".join(f"{int(v):x}" if v.is_resolvable else "0" for v in values) + "\n")
        _rows += 1
        if _rows >= ROWS:
            _open.close()
            os._exit(0)


def install():
    """From here on whoever starts a clock is recorded."""
    start = Clock.start

    def recorded(self, *given, **named):
        cocotb.start_soon(record(cocotb.top))
        return start(self, *given, **named)

    Clock.start = recorded
