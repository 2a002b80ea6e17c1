"""msn_slip_flags against its model: random states of one and of several channels, with gaps; reset."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.slip.slip_path import slip_flags


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


def of_frames(decisions):
    """Each flag after each decision: whether any state of this frame, or of the previous one until this ends,
    has it."""
    frames, found = [[]], []
    for state, last in decisions:
        frames[-1].append(state)
        seen = frames[-1] if last or len(frames) == 1 else frames[-2] + frames[-1]
        found.append(tuple(any(state in which for state in seen) for which in ((2, 3), (3,), (1, 2, 3))))
        if last:
            frames.append([])
    return found


EVIDENCE = {
    "faults": {"settle": 20, "driver": {"frame": "in_valid_i"}},
}


@pytest.mark.parametrize("channels", [1, 2, 7])
def test_model_against_a_plain_loop(channels):
    draw = random.Random(bench.SEED)
    states = [draw.choice([0] * 9 + [1, 2, 3, 4, 4]) for _ in range(500 * channels)]
    decisions = [(state, n % channels == channels - 1) for n, state in enumerate(states)]
    assert [tuple(map(bool, flags)) for flags in slip_flags(decisions)] == of_frames(decisions)


def test_flags_by_hand():
    """Two channels: contact, slip of the second, gross of the first, release."""
    states = [0, 1, 0, 2, 0, 0, 3, 0, 4, 4, 4, 0]
    seen = ["", "t", "t", "st", "st", "", "sgt", "sgt", "sgt", "", "", ""]
    flags = slip_flags([(state, n % 2 == 1) for n, state in enumerate(states)])
    assert ["".join(name for name, flag in zip("sgt", each) if flag) for each in flags] == seen


def test_slip_flags():
    bench.run("slip", "slip_flags")
