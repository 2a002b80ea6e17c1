"""msn_frame_filter against its model: complete frames pass; damage of every kind is dropped, counted once
and followed by a restart. Damage: missing, doubled, swapped samples; last early, late or lost."""

import random

import cocotb
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.frames import FrameFilter


def damaged_stream(channels, frames, rate, seed):
    """Ids and lasts of frames, a share ``rate`` of them damaged in a random way."""
    draw = random.Random(seed)
    beats = []
    for _ in range(frames):
        frame = [(c, c == channels - 1) for c in range(channels)]
        if draw.random() < rate:
            at = draw.randrange(channels)
            kind = draw.choice(["missing", "doubled", "wrong id", "early last", "lost last", "late last"])
            if kind == "missing":
                del frame[at]
            elif kind == "doubled":
                frame.insert(at, frame[at])
            elif kind == "wrong id":
                frame[at] = ((frame[at][0] + 1) % max(channels, 2), frame[at][1])
            elif kind == "early last":
                frame = [*frame[:at], (at, True)]
            elif kind == "lost last":
                frame[-1] = (channels - 1, False)
            else:
                frame = [*frame[:-1], (channels - 1, False), (channels - 1, True)]
        beats += frame
    return beats


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o")


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.4], stall_rate=[0.0, 0.5])
async def matches_model(dut, rate, stall_rate):
    channels = dut.Channels.value.to_unsigned()
    pairs = damaged_stream(channels, 300 if channels < 50 else 6, rate, bench.SEED)
    model = FrameFilter(channels)
    kept, restart = model.process(*zip(*pairs))
    await bench.start(dut)
    draw = random.Random(bench.SEED)
    data = [draw.getrandbits(len(dut.in_data_i)) for _ in pairs]
    beats = [{"data": d, "id": channel, "last": last} for d, (channel, last) in zip(data, pairs)]
    expected = [beat | {"restart": r} for beat, keep, r in zip(beats, kept, restart) if keep]
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, beats, ["data", "id", "last", "restart"], *pauses)
    assert got == expected
    assert bench.read(dut.damaged_o) == model.damaged
    assert (model.damaged == 0) == (rate == 0.0)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def takes_a_beat_that_nobody_takes_and_then_waits(dut):
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut)
    beats = [{"data": c, "id": c, "last": c == channels - 1} for c in range(channels)] * 2
    assert await bench.taken(dut, beats) == 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def restarts_after_reset_in_mid_frame(dut):
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut)
    frame = [{"data": c, "id": c, "last": c == channels - 1} for c in range(channels)]
    fields = ["data", "id", "last", "restart"]
    await bench.stream(dut, frame + frame[: channels - 1], fields)
    await bench.reset(dut)
    got = await bench.stream(dut, frame + frame, fields)
    assert got == [beat | {"restart": n < channels} for n, beat in enumerate(frame + frame)]
    assert bench.read(dut.damaged_o) == 0


def good(channels, mark):
    return [(mark + channel, channel, int(channel == channels - 1)) for channel in range(channels)]


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.7])
async def damage_meets_every_other_event(dut, stall_rate):
    """Damage right after a reset, right after damage, in a frame marked `restart`, in a frame's first and
    last beat, by a wrong number, by an early `last` and by a missing one: the frames that leave, and the
    count, are worked out by hand."""
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut)
    whole = lambda mark, restart: [(*beat, restart) for beat in good(channels, mark)]
    final = channels - 1
    wrong_last = 0 if final else 1
    script = [
        # beats in, beats out, frames counted so far
        ([(11, 1, 1)], [], 1),  # a frame of a single beat right after the reset
        ([(12, 1, 0), (13, 0, 1)], [], 2),  # right after damage; the later beats' numbers are right
        (good(channels, 20), whole(20, 1), 2),
        (good(channels, 40), whole(40, 0), 2),
        # only its last beat's number is wrong: the earlier beats have left
        (
            [*good(channels, 60)[:-1], (60 + final, wrong_last, 1)],
            [(60 + channel, channel, 0, 0) for channel in range(final)],
            3,
        ),
        # damage in the frame that restarts
        (
            [*good(channels, 80)[:-1], (80 + final, final, 0), (99, 0, 0), (98, final, 1)],
            [(80 + channel, channel, 0, 1) for channel in range(final)],
            4,
        ),
        (good(channels, 120), whole(120, 1), 4),
    ]
    if channels > 1:  # an early `last`
        script += [([(7, 0, 1)], [], 5), (good(channels, 140), whole(140, 1), 5)]
    bits = len(dut.in_data_i)
    fields = ["data", "id", "last", "restart"]
    for sent, left, count in script:
        beats = [dict(zip(fields, (data % (1 << bits), *rest))) for data, *rest in sent]
        pause = bench.pauses(stall_rate, "stalls")
        got = await bench.stream(dut, beats, fields, None, pause, drain=0)
        got += await bench.stream(dut, [], fields, drain=3)
        assert got == [dict(zip(fields, (data % (1 << bits), *rest))) for data, *rest in left], sent
        assert bench.read(dut.damaged_o) == count, sent


EVIDENCE = {
    "equivalence": {"size": {"Channels": 5}},
    # A frame of one beat that is lost is a whole frame: nothing can miss it.
    "faults": {"size": {"Channels": 5}},
}

SPACE = lambda draw: {"Channels": draw.randint(1, 40)}


@pytest.mark.parametrize("channels", [1, 2, 5, 8, 100])
def test_frame_filter(channels):
    bench.run("common", "frame_filter", {"Channels": channels})


test_refuses_illegal_parameters = refusals(
    "frame_filter", FrameFilter, {"Channels": 0}, alone=[{"DataBits": 0}]
)
