"""msn_slip_flags against its model: random states of one and of several channels, with gaps; reset."""

import random

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.slip.slip_flags import slip_flags


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(channels=[1, 2, 9])
async def matches_model(dut, channels):
    draw = random.Random(bench.SEED)
    await bench.start(dut, in_state_i=3, in_last_i=1)
    await ReadOnly()
    assert [bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched")] == [0] * 3
    await RisingEdge(dut.clk_i)
    likely = [0] * 12 + [1, 1, 2, 3, 4, 4]
    states = [draw.choice(likely) for _ in range(600 * channels)]
    decisions = [(state, n % channels == channels - 1) for n, state in enumerate(states)]
    expected = slip_flags(decisions)
    assert {flags for flags in expected} >= {(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 0, 1)}
    for (state, last), flags in zip(decisions, expected):
        dut.in_valid_i.value, dut.in_state_i.value, dut.in_last_i.value = 1, state, int(last)
        await RisingEdge(dut.clk_i)
        dut.in_valid_i.value, dut.in_state_i.value, dut.in_last_i.value = (
            0,
            draw.randrange(5),
            draw.randrange(2),
        )
        for _ in range(draw.randrange(3)):
            await RisingEdge(dut.clk_i)
        await ReadOnly()
        got = tuple(bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched"))
        assert got == flags
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_at_reset(dut):
    await bench.start(dut, in_state_i=3, in_last_i=0)
    dut.in_valid_i.value = 1
    await bench.clocks(dut, 2)
    dut.in_valid_i.value = 0
    await bench.reset(dut)
    dut.in_valid_i.value, dut.in_state_i.value, dut.in_last_i.value = 1, 0, 1
    await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await ReadOnly()
    assert [bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched")] == [0] * 3


def test_slip_flags():
    bench.run("slip", "slip_flags")
