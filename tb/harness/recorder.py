"""Records what a block's own tests drive into it in each clock: the stimulus for fault injection.

If MEISSNER_RECORD=FILE is set, each start of a clock begins a recording of the ports of the top.
FILE: a line "port bits" for each port, an empty line, then for each recording a line "=" and one line of
hexadecimal values per clock. After ``ROWS`` clocks the simulation ends, whether or not its tests are done.
"""

import os

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly

ROWS = int(os.environ.get("MEISSNER_RECORD_ROWS", "24000"))
FILE = os.environ.get("MEISSNER_RECORD")
_open = None
_rows = 0
_begun = 0  # number of recordings: when a test starts its clock again, the previous recording ends


def _bits(handle):
    try:
        return len(handle)
    except TypeError:
        return 1


def _ports(dut):
    """The ports of the top that MEISSNER_RECORD_PORTS names, except the clock."""
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


def end():
    """End the present recording: a replay has only inputs, and the bench sets a register now."""
    global _begun
    _begun += 1


def install():
    """From here on every start of a clock begins a recording."""
    start = Clock.start

    def recorded(self, *given, **named):
        cocotb.start_soon(record(cocotb.top))
        return start(self, *given, **named)

    Clock.start = recorded
