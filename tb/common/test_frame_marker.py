"""msn_frame_marker against its model: complete frames and every kind of damage (missing, doubled, wrong id,
early, lost and late last) in sizes from one beat up; the places and ends of rows; a damaged frame never looks
complete to a follower that counts beats, and each complete frame after it does."""

import random

import cocotb
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.frames import FrameMarker


def damaged_beats(beats, frames, rate, seed):
    """Ids and lasts of frames, a share ``rate`` of them damaged, and the frame that each beat belongs to."""
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
    await bench.turn_over(dut, "damaged_o", in_valid_i=0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.4])
async def matches_model(dut, rate):
    rows, row_beats = (getattr(dut, name).value.to_unsigned() for name in ("Rows", "RowBeats"))
    beats = rows * row_beats
    stream = damaged_beats(beats, 300 if beats < 50 else 8, rate, bench.SEED)
    twin = FrameMarker(rows, row_beats)
    draw = random.Random(bench.SEED)
    ports = [getattr(dut, f"out_{name}_o") for name in ("id", "fits", "row_last", "last")]
    await bench.start(dut, in_valid_i=0, out_ready_i=0)
    for reset_before in (False, True):
        if reset_before:  # in the middle of a frame
            await bench.reset(dut)
            twin.reset()
        for id_, last, _ in stream[: len(stream) - beats // 2]:
            expected, taken = None, False
            while not taken:
                offered, ready = draw.random() < 0.8, draw.random() < 0.8
                dut.in_valid_i.value, dut.out_ready_i.value = int(offered), int(ready)
                dut.in_id_i.value, dut.in_last_i.value = id_, int(last)
                taken = offered and ready
                expected = twin.next(id_, last) if taken else None
                await bench.ReadOnly()
                assert bench.read(dut.in_ready_o) == ready
                if taken or not offered:
                    assert bench.read(dut.out_valid_o) == (expected is not None)
                if expected:
                    assert [bench.read(port) for port in ports] == list(map(int, expected))
                await bench.RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, 2)
        assert bench.read(dut.damaged_o) == twin.damaged
        assert (twin.damaged == 0) == (rate == 0.0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def rows_end_where_they_end(dut):
    """Place and row-end mark of each beat of complete frames; a stalled beat keeps them."""
    rows, row_beats = (getattr(dut, name).value.to_unsigned() for name in ("Rows", "RowBeats"))
    await bench.start(dut, in_valid_i=1, out_ready_i=0)
    for _ in range(3):
        place = 0
        for row in range(rows):
            for column in range(row_beats):
                end = row == rows - 1 and column == row_beats - 1
                dut.in_id_i.value, dut.in_last_i.value = place, int(end)
                for ready in (0, 1):
                    dut.out_ready_i.value = ready
                    await bench.ReadOnly()
                    assert (dut.out_valid_o.value, dut.out_fits_o.value) == (1, 1)
                    assert bench.read(dut.out_id_o) == place
                    ends = bench.read(dut.out_row_last_o), bench.read(dut.out_last_o)
                    assert ends == (column == row_beats - 1, end)
                    await bench.RisingEdge(dut.clk_i)
                place += 1
    assert bench.read(dut.damaged_o) == 0


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3, "RowBeats": 3}},
    "faults": {"size": {"Rows": 3, "RowBeats": 3}},
}

SPACE = lambda draw: {"Rows": draw.randint(1, 8), "RowBeats": draw.randint(1, 8)}


@pytest.mark.parametrize("rows, row_beats", [(1, 1), (2, 1), (1, 3), (3, 3), (5, 20)])
def test_frame_marker(rows, row_beats):
    bench.run("common", "frame_marker", {"Rows": rows, "RowBeats": row_beats})


@pytest.mark.parametrize("beats", [1, 2, 3, 4, 9])
def test_no_damaged_frame_looks_whole_and_no_whole_one_is_lost(beats):
    """A follower that only counts beats between `last`s takes exactly the complete frames."""
    twin = FrameMarker(1, beats)
    stream = damaged_beats(beats, 2000, 0.4, 3)
    passed, kept, whole, received, places, frames_in, frames_out = [], [], [], [], [], 0, 0
    for id_, last, frame in stream:
        place = twin.next(id_, last)
        places.append(place)
        received.append((id_, last, frame))
        if last:
            in_order = [(i, e) for i, e, _ in received[:-1]] == [(b, False) for b in range(beats - 1)]
            if in_order:
                whole.append(frame)
            received = []
        if place:
            passed.append((frame, place))
            if place.last:
                if len(passed) == beats:
                    kept.append(frame)
                counts = [other.id for _, other in passed] == list(range(beats))
                assert all(other.fits for _, other in passed) == (len(passed) == beats and counts)
                assert place.fits == (len(passed) == beats)
                passed, frames_out = [], frames_out + 1
        frames_in += last
        assert frames_out == frames_in or not last, "one frame out for one in"
    assert kept == whole
    assert len(whole) < 1900
    ids, lasts, _ = zip(*stream)
    assert twin.process(ids, lasts) == places


test_refuses_illegal_parameters = refusals(
    "frame_marker", FrameMarker, {"Rows": 0}, {"RowBeats": 0}, rows=2, row_beats=2
)
