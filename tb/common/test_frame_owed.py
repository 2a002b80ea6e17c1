"""msn_frame_owed: hand-written sequences of beats and results with the busy clocks they must give (results in
either order, in one clock, before the frame's last beat, a dropped frame, one beat a frame); the clock in
which a lost result is given up, not one earlier or later; random clocks against the twin.
"""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refusals
from meissner.twins.common.frames import FrameOwed

IDLE = (0, 1, 0, 0, 1)  # taken, first, done (bits), drop, quiet


async def play(dut, clocks):
    """``busy_o`` in each clock."""
    seen = []
    for taken, first, done, drop, quiet in clocks:
        dut.taken_i.value, dut.first_i.value, dut.done_i.value = taken, first, done
        dut.drop_i.value, dut.quiet_i.value = drop, quiet
        await ReadOnly()
        seen.append(bench.read(dut.busy_o))
        await RisingEdge(dut.clk_i)
    return seen


async def begin(dut):
    await bench.start(dut, taken_i=0, first_i=1, done_i=0, drop_i=0, quiet_i=1)
    return dut.Results.value.to_unsigned(), dut.QuietBits.value.to_unsigned()


# Clocks; busy with two results; busy with one (the lower bit of done). Beats: the first, one in the middle.
FIRST, MIDDLE, NONE = (1, 1, 0, 0, 1), (1, 0, 0, 0, 1), (0, 0, 0, 0, 1)
SEQUENCES = {
    "one after the other": (
        [FIRST, MIDDLE, IDLE, (0, 1, 1, 0, 1), IDLE, (0, 1, 2, 0, 1), IDLE],
        "0111110",
        "0111000",
    ),
    "the other way round": (
        [FIRST, MIDDLE, IDLE, (0, 1, 2, 0, 1), IDLE, (0, 1, 1, 0, 1), IDLE],
        "0111110",
        "0111110",
    ),
    "in one clock": ([FIRST, MIDDLE, (0, 1, 3, 0, 1), IDLE], "0110", "0110"),
    "twice the same": ([FIRST, (0, 1, 1, 0, 1), (0, 1, 1, 0, 1), (0, 1, 2, 0, 1), IDLE], "01110", "01000"),
    "inside the frame": ([FIRST, (1, 0, 1, 0, 1), (1, 0, 2, 0, 1), MIDDLE, IDLE], "01100", "01000"),
    "dropped": ([FIRST, MIDDLE, (0, 1, 0, 1, 1), IDLE], "0110", "0110"),
    "one in the clock of the next first beat": (
        [FIRST, (1, 1, 3, 0, 1), IDLE, (0, 1, 3, 0, 1), IDLE],
        "01110",
        "01110",
    ),
    "results without a frame": ([(0, 1, 3, 0, 1), IDLE, MIDDLE, IDLE], "0000", "0000"),
}


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def owes_until_all_results_have_left(dut):
    results, _ = await begin(dut)
    for name, (clocks, *busy) in SEQUENCES.items():
        await bench.reset(dut)
        seen = await play(
            dut, [(*a, done & (1 << results) - 1, drop, quiet) for *a, done, drop, quiet in clocks]
        )
        assert "".join(map(str, seen)) == busy[2 - results], name
    await bench.reset(dut)
    everything = (1 << results) - 1
    assert await play(dut, [FIRST, MIDDLE, IDLE, (0, 1, everything, 0, 1), IDLE]) == [0, 1, 1, 1, 0]


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def gives_up_a_lost_result(dut):
    _, bits = await begin(dut)
    limit = {9: 511}.get(bits, 2**bits - 1)  # 511: the default, docs/frames.md
    # The first beat's clock, `limit` quiet clocks that are counted, one clock until that takes effect.
    seen = await play(dut, [FIRST, *[IDLE] * (limit + 2)])
    assert seen == [0, *[1] * (limit + 1), 0]
    # A beat offered, or a frame that continues, restarts the count, however late.
    for other in ((0, 1, 0, 0, 0), NONE):
        await bench.reset(dut)
        seen = await play(dut, [FIRST, *[IDLE] * (limit - 1), other, *[IDLE] * (limit + 2)])
        assert seen == [0, *[1] * (2 * limit + 1), 0]
    await bench.reset(dut)  # an endless frame, an endless stall
    seen = await play(dut, [FIRST, *[NONE] * (3 * limit), *[(0, 1, 0, 0, 0)] * (3 * limit)])
    assert seen == [0, *[1] * (6 * limit)]


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def matches_model(dut):
    results, bits = await begin(dut)
    draw, twin = random.Random(bench.SEED), FrameOwed(results, bits)
    clocks = []
    for _ in range(6000):
        run = draw.choice((1, 1, 1, 2, 2**bits))
        kind = [int(draw.random() < p) for p in (0.1, 0.7, 0.05, 0.95)]
        done = draw.getrandbits(results) if draw.random() < 0.2 else 0
        clocks += [(kind[0], kind[1], done, kind[2], kind[3])] + [IDLE] * (run - 1)
    clocks = clocks[:20000]
    expected = twin.process(
        (taken, first, [done >> k & 1 for k in range(results)], drop, quiet)
        for taken, first, done, drop, quiet in clocks
    )
    assert await play(dut, clocks) == expected
    twin.reset()
    assert not twin.next(0, 1, [0] * results, 0, 1)


EVIDENCE = {"faults": {"inside": ["sensor_array", "u_owed."]}}

SPACE = lambda draw: {"Results": draw.randint(1, 3), "QuietBits": draw.randint(2, 6)}


@pytest.mark.parametrize("size", [{"Results": 2, "QuietBits": 4}, {}], ids=str)
def test_frame_owed(size):
    bench.run("common", "frame_owed", size)


def test_the_model_gives_up_after_511_quiet_clocks():
    """Busy from the clock after the first beat, while 511 are counted and in the one in which that takes
    effect."""
    owed = FrameOwed()
    owed.next(1, 1, [0], 0, 1)
    assert [bool(owed.next(0, 1, [0], 0, 1)) for _ in range(514)] == [True] * 512 + [False] * 2


test_refuses_illegal_parameters = refusals(
    "frame_owed", FrameOwed, {"Results": 0}, {"QuietBits": 1}, {"QuietBits": 17}
)
