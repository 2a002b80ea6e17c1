"""The engines of the pin display and of the rendering against plain loops of docs/pin_display.md: which pins
each drive period drives, when it begins, and the levels of images, centres and slips."""

from fractions import Fraction

import numpy as np
import pytest

from meissner.engines.features.pin_display import engines as of_pins
from meissner.engines.features.render import engines as of_render
from meissner.engines.features.render.engines import Felt
from meissner.twins.actuate.pin_display import DisplaySettings, DisplaySize, increment_of
from meissner.twins.actuate.render import RenderSettings

SIZE = DisplaySize(pins=5, amplitude_bits=1, clk_khz=1000)
EVERY = ["float", "fixed", pytest.param("rtl", marks=pytest.mark.long)]


@pytest.mark.parametrize("engine", EVERY)
@pytest.mark.parametrize(
    "hz, top, most, burst", [(230, 255, 4095, (0, 0)), (300, 1, 3, (4, 3)), (90, 0, 9, (3, 1))]
)
def test_which_pins_are_driven(engine, hz, top, most, burst):
    """The first period is silent; at most so many pins, the first ones; bursts begin with the second."""
    frames = np.random.default_rng(hz).choice([0, 0, 1, 2, 255], (9, 5))
    settings = DisplaySettings(increment_of(hz, 1000), burst[0], burst[1], top, most)
    levels, limited = [], []
    for k, frame in enumerate(frames.tolist()):
        shown, left, kept = [], most, 0
        for level in frame:
            may = level > 0 and left > 0 and top > 0
            left -= may
            kept += level > 0 and not may
            on = may and k > 0 and (burst[0] == 0 or (k - 1) % burst[0] < burst[1])
            shown.append(min(level, top, 1) if on else 0)
        levels.append(shown)
        limited.append(kept > 0)
    found = of_pins.ENGINES[engine](frames, SIZE, settings)
    assert found.levels.tolist() == levels and found.limited.tolist() == limited
    start = [(at - found.start[1]) for at in found.start[1:].tolist()]
    assert start == pytest.approx([k * 1e6 / hz for k in range(8)], abs=1)


def overlap(taxel, taxels, pin, pins):
    """The part of a side that lies under both, of the taxel."""
    low = max(Fraction(taxel, taxels), Fraction(pin, pins))
    high = min(Fraction(taxel + 1, taxels), Fraction(pin + 1, pins))
    return max(Fraction(0), high - low)


def level_of(image, row, column, grid, floor, step, top):
    rows, columns = len(image), len(image[0])
    mean = sum(
        image[r][c]
        * overlap(r, rows, row, grid[0])
        * overlap(c, columns, column, grid[1])
        * grid[0]
        * grid[1]
        for r in range(rows)
        for c in range(columns)
    )
    return 0 if mean < floor else top if step == 0 else min(top, 1 + int((mean - floor) // step))


@pytest.mark.parametrize("engine", EVERY)
@pytest.mark.parametrize("floor, step", [(20, 7), (1, 0)])
def test_an_image_on_pins(engine, floor, step):
    rng = np.random.default_rng(5)
    image, count, grid = rng.integers(0, 60, (4, 3, 4)), 4, (5, 3)
    none = np.zeros(count, dtype=np.int64)
    felt = Felt(image, none > 0, none, none > 0, np.zeros((count, 2), np.int64))
    found = of_render.ENGINES[engine](felt, grid, 3, RenderSettings(floor, step))
    for k, one in enumerate(image.tolist()):
        assert found[k].tolist() == [
            [level_of(one, r, c, grid, floor, step, 7) for c in range(3)] for r in range(5)
        ]


@pytest.mark.parametrize("engine", EVERY)
def test_a_centre_and_a_slip_on_pins(engine):
    """The pin under the centre, +y to row 0, none where nothing presses; stripes of a slip up and right, a
    step every second frame, and from the start again after a pause."""
    one = 1 << 14
    cop = np.array([[-one, one], [one, -one], [0, 0], [5000, -9000], [0, 0], *[[0, 0]] * 7])
    slip = np.array([0, 0, 0, 0, 0, 1, 1, 1, 1, 0, 1, 1], bool)
    valid = np.array([1, 1, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], bool)
    felt = Felt(None, slip, np.full(12, 1), valid, cop.astype(np.int64))
    found = of_render.ENGINES[engine](felt, (4, 6), 2, RenderSettings(marker=1, cue=2))
    where = [np.argwhere(frame == 3).tolist() for frame in found]
    # (16384 + 5000) * 6 / 32768 = 3.9 columns, (16384 + 9000) * 4 / 32768 = 3.1 rows.
    assert where[:5] == [[[0, 0]], [[3, 5]], [[2, 3]], [[3, 3]], []] and where[9] == []
    for frame, phase in ((5, 0), (6, 0), (7, 1), (8, 1), (10, 0), (11, 0)):
        stripes = [[r, c] for r in range(4) for c in range(6) if (c - r - phase) % 4 == 0]
        assert where[frame] == stripes
