"""msn_calibration_preset against its model: every write after a reset, the swap, then the host's writes
unchanged and none before; a reset in the middle starts again."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.calibration_preset import preset

HOST = ("write", "write_row", "word", "offset", "gain", "swap")


async def watch(dut, clocks, draw):
    """The writes, the clocks of swap and of done, and for each clock whether the host's signals passed."""
    writes, swaps, done, passed = [], [], [], []
    for clock in range(clocks):
        given = {name: draw.getrandbits(len(getattr(dut, f"in_{name}_i"))) for name in HOST}
        for name, value in given.items():
            getattr(dut, f"in_{name}_i").value = value
        await ReadOnly()
        seen = {name: bench.read(getattr(dut, f"out_{name}_o")) for name in HOST}
        passed.append(seen == given)
        every = (1 << len(dut.out_write_o)) - 1
        if seen["write"] in (0, every) and bool(seen["write"]) != bool(seen["write_row"]):
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
    names = ("Rows", "Columns", "Lanes")
    rows, columns, lanes = (getattr(dut, name).value.to_unsigned() for name in names)
    expected = preset(rows, columns, lanes, 777, bool(dut.RowColumn.value.to_unsigned()))
    idle = {f"in_{name}_i": 0 for name in HOST}
    await bench.start(dut, cfg_gain_i=777, **idle)
    count = len(expected)
    writes, swaps, done, passed = await watch(dut, count + 40, draw)
    assert writes[:count] == expected
    assert swaps[0] == count and done == [count + 1]
    assert all(passed[count + 1 :])
    await bench.reset(dut)
    await watch(dut, count // 2, draw)
    for wanted in (65535, 0):
        await bench.reset(dut)
        dut.cfg_gain_i.value = wanted
        writes, swaps, done, _ = await watch(dut, count + 2, draw)
        gains = [gain for row, _, _, gain in writes[:count] if not row]
        assert gains == [wanted] * sum(not write[0] for write in expected)
        assert swaps[0] == count and done == [count + 1]


# It runs once after a reset, so a fault can only damage the table.
EVIDENCE = {
    "reference": {
        "against": "writes `by_hand`",
        "test": "tb/frontend/test_front_references.py::test_a_preset_by_hand",
    },
    "faults": {"driver": {"kept": "all"}},
}


@pytest.mark.parametrize(
    "rows, columns, lanes, row_column", [(4, 5, 1, 0), (2, 19, 8, 0), (5, 6, 4, 1), (9, 2, 1, 1)]
)
def test_calibration_preset(rows, columns, lanes, row_column):
    sizes = {"Rows": rows, "Columns": columns, "Lanes": lanes, "RowColumn": row_column}
    bench.run("frontend", "calibration_preset", sizes)


def test_refuses_illegal_parameters():
    assert "Lanes = 3" in bench.refuses("calibration_preset", {"Lanes": 3})
    with pytest.raises(ValueError, match="lanes = 3"):
        preset(2, 2, 3, 1)
