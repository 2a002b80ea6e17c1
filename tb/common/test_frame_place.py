"""msn_frame_place against its model: whole frames, every kind of damage (missing, doubled, wrong id, early,
lost and late last) in every size from one beat on; and that a damaged frame never looks whole to a counter of
beats, while each whole frame behind it does."""

import random

import cocotb
import pytest

import bench
from meissner.twins.common.frame_place import FramePlace


def damaged_beats(beats, frames, rate, seed):
    """Ids and lasts of frames of which a share ``rate`` is damaged, and each beat's own frame."""
    draw = random.Random(seed)
    stream = []
    for frame in range(frames):
        part = [[b, b == beats - 1] for b in range(beats)]
        if draw.random() < rate:
            at = draw.randrange(beats)
            kind = draw.choice(["missing", "doubled", "wrong id", "early last", "lost last", "late last"])
            if kind == "missing":
                del part[at]
            elif kind == "doubled":
                part.insert(at, list(part[at]))
            elif kind == "wrong id":
                part[at][0] = (part[at][0] + 1) % max(beats, 2)
            elif kind == "early last":
                part = [*part[:at], [at, True]]
            elif kind == "lost last":
                part[-1][1] = False
            else:
                part = [*part[:-1], [beats - 1, False], *[[0, False]] * draw.randrange(3), [1 % beats, True]]
        stream += [(id_, last, frame) for id_, last in part]
    return stream


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", accept_i=0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.4])
async def matches_model(dut, rate):
    beats = dut.Beats.value.to_unsigned()
    stream = damaged_beats(beats, 300 if beats < 50 else 8, rate, bench.SEED)
    twin = FramePlace(beats)
    draw = random.Random(bench.SEED)
    await bench.start(dut, accept_i=0)
    for reset_before in (False, True):
        if reset_before:  # in the middle of a frame
            await bench.reset(dut)
            twin.reset()
        for id_, last, _ in stream[: len(stream) - beats // 2]:
            while draw.random() < 0.2:
                dut.accept_i.value, dut.in_last_i.value = 0, draw.getrandbits(1)
                await bench.RisingEdge(dut.clk_i)
            dut.accept_i.value, dut.in_id_i.value, dut.in_last_i.value = 1, id_, int(last)
            expected = twin.next(id_, last)
            await bench.ReadOnly()
            ports = [bench.read(getattr(dut, f"{name}_o")) for name in ("keep", "last", "fits", "whole")]
            assert ports == list(map(int, expected[1:]))
            assert not expected.fits or bench.read(dut.place_o) == expected.place
            await bench.RisingEdge(dut.clk_i)
        dut.accept_i.value = 0
        await bench.clocks(dut, 2)
        assert bench.read(dut.damaged_o) == twin.damaged
        assert (twin.damaged == 0) == (rate == 0.0)


SPACE = lambda draw: {"Beats": draw.randint(1, 60)}


@pytest.mark.parametrize("beats", [1, 2, 3, 9, 100])
def test_frame_place(beats):
    bench.run("common", "frame_place", {"Beats": beats})


@pytest.mark.parametrize("beats", [1, 2, 3, 4, 9])
def test_no_damaged_frame_looks_whole_and_no_whole_one_is_lost(beats):
    """A follower that only counts beats between `last`s takes exactly the whole frames."""
    twin = FramePlace(beats)
    stream = damaged_beats(beats, 2000, 0.4, 3)
    passed, kept, whole, received, places = [], [], [], [], []
    for id_, last, frame in stream:
        place = twin.next(id_, last)
        places.append(place)
        received.append((id_, last, frame))
        if last:
            in_order = [(i, e) for i, e, _ in received[:-1]] == [(b, False) for b in range(beats - 1)]
            if in_order:
                whole.append(frame)
            received = []
        if place.keep:
            passed.append(frame)
            if place.last:
                if len(passed) == beats:
                    kept.append(frame)
                passed = []
    assert kept == whole
    assert len(whole) < 1900
    ids, lasts, _ = zip(*stream)
    assert twin.process(ids, lasts) == places  # from anew


def test_refuses_illegal_parameters():
    assert "Beats = 0" in bench.refuses("frame_place", {"Beats": 0})
    with pytest.raises(ValueError, match="beats = 0"):
        FramePlace(0)
