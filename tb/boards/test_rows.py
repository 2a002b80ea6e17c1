"""The row lines of a board whose array has more than eight rows, clock by clock, over complete scans.

A frame drives its rows in order. Between two rows, and while the scan rests, no row is driven and the row
number keeps its last value, so that a decoder selects no other row. A converter starts only while a row is
driven, and its first transfer starts exactly when that row has settled. Covers arrays that use every code of
the row number, and arrays that use fewer.
"""

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, First, ReadOnly, ValueChange
from cocotb.utils import get_sim_time

import bench
from meissner.builds import boards, config, toolchain

NUMBER_LINES = {16: 4, 33: 6}  # by number of rows
SETTLE = 24  # clocks: 1 us at 24 MHz
FRAMES = 2


def build(rows, columns):
    """One converter, and a scan that takes less than half of its period."""
    tables = {
        "about": "an array for its row lines",
        "clock": {"mhz": 24.0},
        "sensor": {"kind": "array", "rows": rows, "columns": columns},
        "adc": {"part": "MCP3208", "channels": columns, "volts": 5.0, "rate_hz": 600.0, "settle_us": 1.0},
        "array": {"tare": False},
        "link": {"registers": False},
    }
    return config.read("rows", tables)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def one_row_after_the_other_and_none_between(dut):
    rows = len(dut.u_core.row_o)
    lines = NUMBER_LINES[rows]
    dut.good_i.value = dut.rx_i.value = 1
    dut.adc_miso_i.value = dut.adc_busy_i.value = dut.moving_i.value = 0
    cocotb.start_soon(Clock(dut.clk_i, 10, unit="ns").start())
    await FallingEdge(dut.u_reset.rst_o)
    await ReadOnly()
    clock = lambda: round(get_sim_time("ns")) // 10
    row, cs_n, since, last = bench.read(dut.row_o), bench.read(dut.adc_cs_n_o), clock(), None
    seen = []  # [row, clocks without a row before it, transfers]
    while len(seen) <= FRAMES * rows:  # each turn of the loop is one change of a line
        await First(ValueChange(dut.row_o), ValueChange(dut.adc_cs_n_o))
        await ReadOnly()
        row_was, cs_was, now = row, cs_n, clock()
        row, cs_n = bench.read(dut.row_o), bench.read(dut.adc_cs_n_o)
        number, off = row & (1 << lines) - 1, row >> lines
        assert off in (0, 1), f"{row:b}: a line above those of {rows} rows"
        if off:
            assert last is None or number == last, f"{number} after row {last}, while no row is driven"
        elif row != row_was:
            assert last is None or row_was >> lines, f"row {last} to {number} without a pause"
            seen.append([number, now - since, 0])
            last = number
        if row != row_was:
            since = now
        if cs_was and not cs_n:
            assert not off, "a transfer begins while no row is driven"
            assert seen[-1][2] or now - since == SETTLE - 1, f"after {now - since} clocks of row {number}"
            seen[-1][2] += 1
    assert [row for row, *_ in seen] == [*range(rows)] * FRAMES + [0]
    pauses = [dark for _, dark, _ in seen[1:]]
    assert [pause for at, pause in enumerate(pauses, 1) if at % rows] == [1] * (rows - 1) * FRAMES
    assert all(pause > 1000 for at, pause in enumerate(pauses, 1) if at % rows == 0), "no rest to look at"
    assert len({transfers for *_, transfers in seen[:-1]}) == 1 and seen[0][2] > 0


@pytest.mark.parametrize("rows, columns", [(16, 3), (33, 2)])
def test_rows(rows, columns):
    made = build(rows, columns)
    folder = f"build/tb/include/rows{rows}"
    boards.write_build(folder, made.parameters)
    outer = [toolchain.ROOT / source for source in boards.COMMON]
    waivers = toolchain.ROOT / "rtl/verilator.vlt"
    sources = [waivers, *toolchain.sources_of("msn_core"), *outer]
    files = {"sources": sources, "include": toolchain.ROOT / folder}
    bench.run("boards", "board", module="test_rows", inside=["msn_core", "msn_board_reset"], **files)
