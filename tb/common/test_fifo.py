"""msn_fifo against its model: every entry in order, none twice, gaps and stalls; the number it holds; an
entry a clock; its latency; empty after a reset at any fill."""

import random

import cocotb
import pytest

import bench
from meissner.common.fifo import fifo


def beats_of(dut, count):
    draw = random.Random(bench.SEED)
    return [{"data": draw.getrandbits(len(dut.in_data_i))} for _ in range(count)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.5, 0.9], stall_rate=[0.0, 0.5, 0.9])
async def matches_model(dut, gap_rate, stall_rate):
    await bench.start(dut)
    beats = beats_of(dut, 300)
    got = await bench.stream(dut, beats, ["data"], *bench.gaps_and_stalls(gap_rate, stall_rate))
    assert [b["data"] for b in got] == fifo([b["data"] for b in beats], width=len(dut.in_data_i))


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def holds_its_depth_and_two(dut):
    depth = dut.Depth.value.to_unsigned()
    await bench.start(dut, in_valid_i=1, in_data_i=0)
    taken = seen = 0
    for _ in range(depth + 20):
        dut.in_data_i.value = taken & ((1 << len(dut.in_data_i)) - 1)
        await bench.ReadOnly()
        taken += dut.in_ready_o.value == 1
        await bench.RisingEdge(dut.clk_i)
    assert taken == depth + 2
    dut.in_valid_i.value = 0
    dut.out_ready_i.value = 1
    for _ in range(depth + 20):
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1:
            assert bench.read(dut.out_data_o) == seen & ((1 << len(dut.in_data_i)) - 1)
            seen += 1
        await bench.RisingEdge(dut.clk_i)
    assert seen == taken


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def clocks_are_as_stated_and_reset_empties(dut):
    await bench.start(dut, out_ready_i=1, in_data_i=1)
    for fill in range(8):
        seen = []
        for clock in range(20):
            dut.in_valid_i.value = int(clock < 5)
            await bench.ReadOnly()
            seen.append(int(dut.out_valid_o.value))
            await bench.RisingEdge(dut.clk_i)
        assert seen == [0] * 3 + [1] * 5 + [0] * 12
        dut.out_ready_i.value = 0
        dut.in_valid_i.value = 1
        await bench.clocks(dut, fill)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        dut.out_ready_i.value = 1


SPACE = lambda draw: {"Depth": 1 << draw.randint(1, 8), "Width": draw.randint(1, 91)}


@pytest.mark.parametrize("depth, width", [(2, 1), (16, 91), (256, 24)])
def test_fifo(depth, width):
    bench.run("common", "fifo", {"Depth": depth, "Width": width})


def test_refuses_illegal_parameters():
    for depth in (0, 1, 3):
        assert f"Depth = {depth}" in bench.refuses("fifo", {"Depth": depth})
        with pytest.raises(ValueError, match=f"depth = {depth}"):
            fifo([], depth)
    assert "Width = 0" in bench.refuses("fifo", {"Width": 0})
    with pytest.raises(ValueError, match="width = 0"):
        fifo([], width=0)
