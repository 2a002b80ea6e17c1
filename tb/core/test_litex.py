"""The core as a peripheral of LiteX (examples/litex): a SoC that LiteX writes, with a Wishbone master at its
pins. Registers through LiteX's bus and its bridge to AXI4-Lite, frames and packets through its streams;
numbers by hand. LiteX's own simulator is not used: it needs packages that are not on PyPI."""

import contextlib
import io
import logging
import runpy

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

import bench
from meissner.builds import toolchain
from meissner.twins.link import cobs
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Decoder

BASE = 0x3000_0000
ROWS, COLUMNS = 2, 3
FRAME = (100, 200, 300, 400, 500, 600)
LINT = "WIDTHEXPAND WIDTHTRUNC CASEINCOMPLETE COMBDLY UNDRIVEN DECLFILENAME PROCASSINIT BLKSEQ PINMISSING"


async def access(dut, address, data=None):
    """A Wishbone access; (word, whether it ended in an error)."""
    dut.bus_adr.value, dut.bus_dat_w.value, dut.bus_sel.value = address >> 2, data or 0, 15
    dut.bus_we.value = data is not None
    dut.bus_cyc.value = dut.bus_stb.value = 1
    while True:
        await RisingEdge(dut.clk)
        if dut.bus_ack.value or dut.bus_err.value:
            break
    word, error = dut.bus_dat_r.value.to_unsigned(), bool(dut.bus_err.value)
    dut.bus_cyc.value = dut.bus_stb.value = 0
    await RisingEdge(dut.clk)
    return word, error


async def listen(dut, decoder, found):
    """Take packets, with a pause of two clocks after each byte."""
    whole = bytearray()
    while True:
        dut.packets_ready.value = 1
        await RisingEdge(dut.clk)
        if dut.packets_valid.value:
            whole.append(dut.packets_data.value.to_unsigned())
            if dut.packets_last.value:
                found += decoder.next(cobs.encode(bytes(whole)))
                whole.clear()
            dut.packets_ready.value = 0
            await RisingEdge(dut.clk)
            await RisingEdge(dut.clk)


@bench.applies(lambda dut: True, long=True)
@cocotb.test(timeout_time=2, timeout_unit="ms")
async def works_as_a_peripheral(dut):
    for name in ("bus_adr", "bus_dat_w", "bus_sel", "bus_cyc", "bus_stb", "bus_we", "sim_trace"):
        getattr(dut, name).value = 0
    for name in ("valid", "data", "last"):
        getattr(dut, f"samples_{name}").value = 0
    dut.packets_ready.value, dut.rst.value = 0, 1
    cocotb.start_soon(Clock(dut.clk, 10, "ns").start())
    for _ in range(5):
        await RisingEdge(dut.clk)
    dut.rst.value = 0
    await RisingEdge(dut.clk)
    assert await access(dut, BASE) == (0x4D534E52, False)
    assert await access(dut, BASE + 0x00C) == (ROWS | COLUMNS << 16, False)
    for offset, value in ((0x200, 777), (0x204, 888), (0x500, 4096), (0x600, 7)):
        await access(dut, BASE + offset, value)
        assert await access(dut, BASE + offset) == (value, False), hex(offset)
    found = []
    cocotb.start_soon(listen(dut, Decoder(), found))
    for _ in range(2):
        for k, code in enumerate(FRAME):
            dut.samples_valid.value, dut.samples_data.value = 1, code
            dut.samples_last.value = k == len(FRAME) - 1
            await RisingEdge(dut.clk)
            while not dut.samples_ready.value:
                await RisingEdge(dut.clk)
        dut.samples_valid.value = 0
        for _ in range(1500):
            await RisingEdge(dut.clk)
    cops = [one.fields for one in found if one.kind == p.COP]
    # Load 2100; (900 - 500) / 2100 to the right, (600 - 1500) / 2100 up, times 16384 and rounded.
    assert cops == 2 * [{"x": 3121, "y": -7022, "load": 2100, "pressed": True}]
    images = [list(one.fields["taxels"]) for one in found if one.kind == p.IMAGE]
    assert images == 2 * [list(FRAME)]
    changes = [one.fields for one in found if one.kind == p.CHANGE]  # the level of contact is 0
    assert [(one["channel"], one["told"], one["state"]) for one in changes] == [(k, 0, 1) for k in range(6)]
    assert {one.kind for one in found} <= {p.COP, p.IMAGE, p.CHANGE, p.STATISTIC}


@pytest.mark.long
def test_litex():
    pytest.importorskip("litex", reason="LiteX is not installed: pip install litex migen")
    folder = toolchain.BUILD / "litex"
    folder.mkdir(parents=True, exist_ok=True)
    example = runpy.run_path(str(toolchain.ROOT / "examples/litex/meissner_litex.py"))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        logging.disable(logging.CRITICAL)
        example["write"](folder / "msn_litex.v", Rows=ROWS, Columns=COLUMNS)
        logging.disable(logging.NOTSET)
    text = (folder / "msn_litex.v").read_text("utf-8")
    off, on = (
        "\n".join(f"/* verilator lint_{what} {name} */" for name in LINT.split()) for what in ("off", "on")
    )
    (folder / "msn_litex.v").write_text(f"{off}\n{text}\n{on}\n", "utf-8")
    bench.run("core", "litex", sources=[*toolchain.sources_of("msn_axis"), folder / "msn_litex.v"])
