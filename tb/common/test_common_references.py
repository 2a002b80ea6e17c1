"""Small blocks of common/ by other methods than their models': digits, sums of shifts, frames cut at their
ends."""

import random

import numpy as np
import pytest

import bench
from common.test_frame_marker import damaged_beats
from meissner.twins.common.arithmetic import compare, constant_multiplier, multiply
from meissner.twins.common.frames import FrameFilter, FrameMarker, FrameOwed


@pytest.mark.parametrize("width", [1, 2, 5])
def test_compare_by_digits(width):
    """Numbers compare as their digits do, once the sign digit is inverted."""
    low, high = bench.width(width)
    digits = lambda value: f"{value - low:0{width}b}"
    for a in range(low, high + 1):
        for b in range(low, high + 1):
            assert compare(a, b, width) == (digits(a) > digits(b))


def shifted_sum(value, factor):
    """``value`` times ``factor`` by its binary digits, the highest first."""
    total = 0
    for digit in f"{factor:b}":
        total = total + total + (value if digit == "1" else 0)
    return total


def test_products_by_shifts_and_sums():
    draw = random.Random(bench.SEED)
    values = [0, 1, -1, 131071, -131072, *(draw.randrange(-131072, 131072) for _ in range(200))]
    for factor in (0, 1, 2, 3, 255, 65535, draw.randrange(65536)):
        assert constant_multiplier(values, factor).tolist() == [
            shifted_sum(value, factor) for value in values
        ]
        assert multiply(values, factor).tolist() == [shifted_sum(value, factor) for value in values]


def frames_by_their_ends(stream, beats):
    """For a stream of (id, last): which beats fit, which end a complete frame, how many frames are damaged.

    By docs/array.md: id counts the beats from 0, ``last`` marks the final one, whose id is not checked.
    """
    fits, whole, damaged, at = [], [], 0, 0
    while at < len(stream):
        good = 0
        for id_, last in stream[at : at + beats]:
            final = good == beats - 1
            if last != final or not (final or id_ == good):
                break
            good += 1
        fits += [True] * good
        whole += [n == beats - 1 for n in range(good)]
        at += good
        if good == beats or at == len(stream):
            continue
        damaged += 1
        while at < len(stream) and not stream[at][1]:  # skip to the end of the damaged frame
            at += 1
        at = min(at + 1, len(stream))
        fits += [False] * (at - len(fits))
        whole += [False] * (at - len(whole))
    return fits, whole, damaged


@pytest.mark.parametrize("rows, row_beats", [(1, 1), (2, 1), (1, 3), (2, 4)])
def test_places_by_the_frames_ends(rows, row_beats):
    beats = rows * row_beats
    stream = [(id_, last) for id_, last, _ in damaged_beats(beats, 500, 0.4, bench.SEED)]
    twin = FrameMarker(rows, row_beats)
    places = twin.process(*zip(*stream))
    fits, whole, damaged = frames_by_their_ends(stream, beats)
    assert [bool(place and place.fits) for place in places] == fits
    assert [bool(place and place.fits and place.last) for place in places] == whole
    assert [place.id for place in places if place and place.fits] == [
        id_ if not last else beats - 1 for (id_, last), fit in zip(stream, fits) if fit
    ]
    assert twin.damaged == damaged > 50 * (beats > 1)


@pytest.mark.parametrize("channels", [1, 2, 5])
def test_checked_frames_by_their_ends(channels):
    """By msn_frame_filter's header: a frame passes up to its first wrong sample, the next one restarts."""
    stream = [(id_, last) for id_, last, _ in damaged_beats(channels, 500, 0.4, bench.SEED)]
    twin = FrameFilter(channels)
    kept, restarts = twin.process(*zip(*stream))
    frames, expected, marks, damaged, restart = [[]], [], [], 0, True
    for one in stream:
        frames[-1].append(one)
        if one[1]:
            frames.append([])
    for frame in frames:
        right = [(n, n == channels - 1) for n in range(channels)]
        good = next((n for n, (is_, should) in enumerate(zip(frame, right)) if is_ != should), None)
        whole = frame == right
        good = len(frame) if good is None and len(frame) <= channels else channels if good is None else good
        expected += [n < good for n in range(len(frame))]
        marks += [restart] * len(frame)
        ended = bool(frame) and frame[-1][1]
        damaged += ended and not whole
        restart = ended and not whole
    assert (kept, restarts) == (expected, marks)
    assert twin.damaged == damaged > 50 * (channels > 1)
    assert np.any(restarts)


OWED = {  # by msn_frame_owed's header: two results, given up after three quiet clocks; one letter per clock
    # B first beat, b later beat, 0 and 1 results, d dropped, q quiet between frames, w stalled offer, . in a
    # frame
    "Bb0.1...": "01111000",
    "B10.Bb.d.": "01100111" + "0",
    "Bqqqqq": "011110",
    "Bqqwqqqqq": "011111110",
    "B.......0.1.": "0" + "1" * 10 + "0",
    "B01B01.": "0110110",
}


@pytest.mark.parametrize("clocks", OWED)
def test_owed_results_by_hand(clocks):
    twin, busy = FrameOwed(results=2, quiet_bits=2), ""
    for letter in clocks:
        done = [letter == "0", letter == "1"]
        first, quiet = letter in "Bqw", letter == "q"
        busy += "01"[twin.next(letter in "Bb", first, done, letter == "d", quiet)]
    assert busy == OWED[clocks]
