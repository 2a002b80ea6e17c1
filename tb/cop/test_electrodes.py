"""msn_electrodes against its model: frames back to back, gaps and stalls, every kind of damage, reset;
the model against hand-written frames."""

import random

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.cop.cop4 import electrodes

FIELDS = ["e1~", "e2~", "e3~", "e4~"]


def frames(rng, count, bits):
    """Beats (data, id, last) of complete frames; the first ones at both ends of the range."""
    low, high = bench.width(bits)
    values = rng.integers(low, high + 1, (count, 4))
    values[0], values[1] = (low, high, low, high), (high, low, low, low)
    return [(int(v), place, int(place == 3)) for row in values for place, v in enumerate(row)]


async def check(dut, beats, gap=0.0, stall=0.0):
    given = [dict(zip(("data", "id", "last"), beat)) for beat in beats]
    await bench.clocks(dut, 1)
    before = bench.read(dut.damaged_o)
    got = await bench.stream(dut, given, FIELDS, *bench.gaps_and_stalls(gap, stall))
    found, lost = electrodes(beats, len(dut.in_data_i))
    assert [tuple(row.values()) for row in got] == found
    assert bench.read(dut.damaged_o) - before == lost
    return found, lost


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", in_id_i=0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.4], stall=[0.0, 0.6])
async def matches_model(dut, gap, stall):
    await bench.start(dut)
    beats = frames(np.random.default_rng(bench.SEED), 60, len(dut.in_data_i))
    found, lost = await check(dut, beats, gap, stall)
    assert (len(found), lost) == (60, 0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def leaves_out_what_is_no_frame(dut):
    await bench.start(dut)
    rng, draw = np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    beats = frames(rng, 200, len(dut.in_data_i))
    for _ in range(60):
        at = draw.randrange(len(beats) - 8)
        data, channel, last = beats[at]
        beats[at : at + 1] = draw.choice(
            [[], [(data, channel, last)] * 2, [(data, channel ^ 1, last)], [(data, channel, 1 - last)]]
        )
    beats += [(0, 0, 1), *frames(rng, 3, len(dut.in_data_i))]
    found, lost = await check(dut, beats, 0.2, 0.2)
    assert len(found) > 80 and lost > 30
    for _ in range(4):  # one at a time, as an error of the count may cancel over an even number
        await check(dut, [(0, 0, 1)])


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await bench.start(dut)
    beats = frames(np.random.default_rng(bench.SEED), 3, len(dut.in_data_i))
    for cut in range(1, 5):
        given = [dict(zip(("data", "id", "last"), beat)) for beat in beats[:cut]]
        await bench.stream(dut, given, FIELDS, stalls=lambda: True, drain=0)
        await bench.reset(dut)
        await check(dut, beats)
    assert bench.read(dut.damaged_o) == 0


# By hand: (data, id, last) of each beat, the frames that come out, and the number of damaged frames.
WHOLE = [(7, 0, 0), (-6, 1, 0), (5, 2, 0), (-4, 3, 1)]
FRAME = (7, -6, 5, -4)
LITERALS = {
    "whole": (WHOLE, [FRAME], 0),
    "two": (WHOLE + WHOLE, [FRAME, FRAME], 0),
    **{
        f"wrong number at {at}": (
            [(data, wrong if place == at else place, last) for data, place, last in WHOLE] + WHOLE,
            [FRAME],
            1,
        )
        for at, wrong in ((0, 1), (0, 3), (1, 0), (1, 2), (2, 3), (3, 2), (3, 0))
    },
    "first one missing": (WHOLE[1:] + WHOLE, [FRAME], 1),
    "third one missing": (WHOLE[:2] + WHOLE[3:] + WHOLE, [FRAME], 1),
    "last one missing": (WHOLE[:3] + WHOLE + WHOLE, [FRAME], 1),  # ends with the next frame's last
    "last one only": (WHOLE[3:] + WHOLE, [FRAME], 1),
    "one too many": ([*WHOLE[:3], (-4, 3, 0), (9, 0, 1), *WHOLE], [FRAME], 1),
    "last too early": ([(7, 0, 0), (-6, 1, 1), *WHOLE], [FRAME], 1),
    "each on its own": ([(data, 0, 1) for data, _, _ in WHOLE] + WHOLE, [FRAME], 4),
    "begun and right so far": (WHOLE[:3], [], 0),
    "begun and wrong": (WHOLE[1:3], [], 1),
}


@pytest.mark.parametrize("name", LITERALS)
def test_frames_by_hand(name):
    beats, found, lost = LITERALS[name]
    assert electrodes(beats) == (found, lost)


EVIDENCE = {"faults": {"settle": 2}}

SPACE = lambda draw: {"SampleBits": draw.randint(2, 20)}


@pytest.mark.parametrize("bits", [17, 2])
def test_electrodes(bits):
    bench.run("cop", "electrodes", {"SampleBits": bits})


def test_refuses_illegal_parameters():
    assert "SampleBits = 1" in bench.refuses("electrodes", {"SampleBits": 1})
    with pytest.raises(ValueError, match="sample_bits = 1"):
        electrodes([], 1)
