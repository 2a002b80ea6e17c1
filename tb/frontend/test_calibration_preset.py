"""msn_calibration_preset against its model: every write after a reset, the swap, then the host's writes
unchanged and none before, but none to a word that does not exist; a reset in the middle starts again."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from harness.refusals import refusals
from meissner.twins.frontend.calibrate import preset

KIND = "calibrate_cfg"


def size_of(dut):
    return [getattr(dut, name).value.to_unsigned() for name in ("Rows", "Columns", "Lanes", "RowColumn")]


def passes(given, rows, columns, lanes, row_column):
    """What the host's settings become: a write to a word or row that the array does not have is none."""
    beats = -(-columns // lanes)
    words = rows if given["write_row"] else beats if row_column else rows * beats
    return given | {"write_written": given["write_written"] & (given["word"] < words)}


async def watch(dut, clocks, draw, gain=777):
    """The writes, the clocks of swap and of done, and for each clock whether the host's settings passed."""
    writes, swaps, done, passed = [], [], [], []
    for clock in range(clocks):
        given = {name: draw.getrandbits(bits) for name, (_, bits) in members.PLACES[KIND].items()}
        given["preset"] = gain
        given["word"] >>= draw.choice((0, 14, 18))
        if draw.random() < 0.3:  # around the first word that does not exist
            rows, columns, lanes, _ = size_of(dut)
            given["word"] = draw.choice((rows, -(-columns // lanes), rows * -(-columns // lanes)))
            given["word"] -= draw.randint(0, 1)
        dut.in_i.value = sum(value << members.PLACES[KIND][name][0] for name, value in given.items())
        await ReadOnly()
        seen = members.of(KIND, bench.read(dut.out_o))
        passed.append(seen == passes(given, *size_of(dut)))
        if seen["write_written"] and seen["write_lanes"] == 255:
            writes.append((bool(seen["write_row"]), seen["word"], seen["offset"], seen["gain"]))
        if seen["swap"]:
            swaps.append(clock)
        if dut.done_o.value == 1:
            done.append(clock)
        await RisingEdge(dut.clk_i)
    return writes, swaps, done, passed


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def writes_every_word_once_then_steps_aside(dut):
    draw = random.Random(bench.SEED)
    rows, columns, lanes, row_column = size_of(dut)
    expected = preset(rows, columns, lanes, 777, bool(row_column))
    await bench.start(dut, in_i=777 << members.PLACES[KIND]["preset"][0])
    count = len(expected)
    writes, swaps, done, passed = await watch(dut, count + 200, draw)
    assert writes[:count] == expected
    assert swaps[0] == count and done == [count + 1]
    assert all(passed[count + 1 :])
    await bench.reset(dut)
    await watch(dut, count // 2, draw)
    for wanted in (65535, 0):
        await bench.reset(dut)
        writes, swaps, done, _ = await watch(dut, count + 2, draw, wanted)
        gains = [gain for row, _, _, gain in writes[:count] if not row]
        assert gains == [wanted] * sum(not write[0] for write in expected)
        assert swaps[0] == count and done == [count + 1]


# It runs once after a reset, so a fault can only damage the table.
EVIDENCE = {
    "faults": {"driver": {"kept": "all"}},
}


@pytest.mark.parametrize(
    "rows, columns, lanes, row_column", [(4, 5, 1, 0), (2, 19, 8, 0), (5, 6, 4, 1), (9, 2, 1, 1)]
)
def test_calibration_preset(rows, columns, lanes, row_column):
    sizes = {"Rows": rows, "Columns": columns, "Lanes": lanes, "RowColumn": row_column}
    bench.run("frontend", "calibration_preset", sizes)


test_refuses_illegal_parameters = refusals(
    "calibration_preset", preset, {"Lanes": 3}, rows=2, columns=2, gain=1
)
