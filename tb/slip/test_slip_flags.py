"""msn_slip_flags against its model: random states of one and of several channels, with gaps and frames that
are cut short; reset."""

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
    await bench.start(dut, in_state_i=3, in_first_i=1, in_last_i=1)
    await ReadOnly()
    assert [bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched")] == [0] * 3
    await RisingEdge(dut.clk_i)
    likely = [0] * 12 + [1, 1, 2, 3, 4, 4]
    decisions = some(draw, channels, likely, 600)
    expected = slip_flags(decisions)
    assert {flags for flags in expected} >= {(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 0, 1)}

    def put(*values):
        for name, value in zip(("valid", "first", "state", "last"), values):
            getattr(dut, f"in_{name}_i").value = int(value)

    for (channel, state, last), flags in zip(decisions, expected):
        put(1, channel == 0, state, last)
        await RisingEdge(dut.clk_i)
        put(0, draw.randrange(2), draw.randrange(5), draw.randrange(2))
        for _ in range(draw.randrange(3)):
            await RisingEdge(dut.clk_i)
        await ReadOnly()
        got = tuple(bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched"))
        assert got == flags
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_at_reset(dut):
    await bench.start(dut, in_state_i=3, in_first_i=0, in_last_i=0)
    dut.in_valid_i.value = 1
    await bench.clocks(dut, 2)
    dut.in_valid_i.value = 0
    await bench.reset(dut)
    dut.in_valid_i.value, dut.in_state_i.value, dut.in_last_i.value = 1, 0, 1
    await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await ReadOnly()
    assert [bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched")] == [0] * 3


def some(draw, channels, states, frames):
    """(channel, state, last) of frames of which some end before their last channel."""
    found = []
    for _ in range(frames):
        here = [(c, draw.choice(states), c == channels - 1) for c in range(channels)]
        found += here[: draw.randint(1, channels)] if draw.random() < 0.1 else here
    return found


def of_frames(decisions):
    """Each flag after each decision: whether any state has it since the last complete frame began, or in a
    complete frame that ends here."""
    since, frame, found = [], [], []
    for channel, state, last in decisions:
        frame = [state] if channel == 0 else [*frame, state]
        since = frame if last else [*since, state]
        found.append(tuple(any(state in which for state in since) for which in ((2, 3), (3,), (1, 2, 3))))
    return found


EVIDENCE = {
    "faults": {"settle": 20, "driver": {"frame": "in_valid_i"}},
}


@pytest.mark.parametrize("channels", [1, 2, 7])
def test_model_against_a_plain_loop(channels):
    draw = random.Random(bench.SEED)
    decisions = some(draw, channels, [0] * 9 + [1, 2, 3, 4, 4], 500)
    assert [tuple(map(bool, flags)) for flags in slip_flags(decisions)] == of_frames(decisions)


def test_flags_by_hand():
    """Two channels: contact, slip of the second, gross of the first, release; then a frame without its second
    decision."""
    states = [0, 1, 0, 2, 0, 0, 3, 0, 4, 4, 4, 0]
    seen = ["", "t", "t", "st", "st", "", "sgt", "sgt", "sgt", "", "", ""]
    decisions = [(n % 2, state, n % 2 == 1) for n, state in enumerate(states)]
    decisions += [(0, 3, False), (0, 1, False), (1, 0, True), (0, 0, False), (1, 0, True)]
    seen += ["sgt", "sgt", "t", "t", ""]
    flags = slip_flags(decisions)
    assert ["".join(name for name, flag in zip("sgt", each) if flag) for each in flags] == seen


def test_slip_flags():
    bench.run("slip", "slip_flags")
