"""The row lines of a board whose array has more than eight rows, clock by clock, over whole scans.

A frame drives its rows in order. Between two rows and while the scan rests, no row is driven and the number
stays that of the last one, so that a decoder visits no other. A converter starts only while a row is driven,
the first of its transfers exactly when that row has settled. Arrays with a row for each code of their number,
and with fewer.
"""

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner import boards, config, toolchain

NUMBER_LINES = {16: 4, 33: 6}  # of so many rows
SETTLE = 24  # clocks: 1 us at 24 MHz
FRAMES = 2


def build(rows, columns):
    """One converter, a scan that is over in less than half of its period."""
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
    seen = []  # [row, clocks driven, clocks before it without a row, transfers]
    dark, cs_n, last = 0, 1, None
    while len(seen) <= FRAMES * rows:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        if bench.read(dut.u_reset.rst_o):
            continue
        value, was = bench.read(dut.row_o), cs_n
        cs_n = bench.read(dut.adc_cs_n_o)
        number, off = value & (1 << lines) - 1, value >> lines
        assert off in (0, 1), f"{value:b}: a line above those of {rows} rows"
        if off:
            assert last is None or number == last, f"{number} after row {last}, while no row is driven"
            assert not (was and not cs_n), "a transfer begins while no row is driven"
            dark += 1
            continue
        if dark or last is None:
            seen.append([number, 0, dark, 0])
            dark, last = 0, number
        assert number == last, f"row {last} to {number} without a pause"
        if was and not cs_n:
            assert seen[-1][3] or seen[-1][1] == SETTLE - 1, f"after {seen[-1][1]} clocks of row {number}"
            seen[-1][3] += 1
        seen[-1][1] += 1
    assert [row for row, *_ in seen] == [*range(rows)] * FRAMES + [0]
    pauses = [dark for _, _, dark, _ in seen[1:]]
    assert [pause for at, pause in enumerate(pauses, 1) if at % rows] == [1] * (rows - 1) * FRAMES
    assert all(pause > 1000 for at, pause in enumerate(pauses, 1) if at % rows == 0), "no rest to look at"
    assert len({transfers for *_, transfers in seen[:-1]}) == 1 and seen[0][3] > 0


@pytest.mark.parametrize("rows, columns", [(16, 3), (33, 2)])
def test_rows(rows, columns):
    made = build(rows, columns)
    folder = f"build/tb/include/rows{rows}"
    boards.write_build(folder, made.parameters)
    outer = [toolchain.ROOT / source for source in boards.COMMON]
    waivers = toolchain.ROOT / "tb/lint/verilator.vlt"
    sources = [waivers, *toolchain.sources_of("msn_core"), *outer]
    bench.run("boards", "board", module="test_rows", sources=sources, include=toolchain.ROOT / folder)
