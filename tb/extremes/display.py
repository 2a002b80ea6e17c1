"""Extremes of rtl/actuate's pin display: frequencies at and beyond both ends, levels and limits at their
ends, images of one taxel a pin and of many, all zero and full scale."""

from fractions import Fraction

import numpy as np

from extremes.rows import row
from meissner.twins.actuate import pin_display, render
from reference.pin_display import WRAP, averages, level_of

SIZE = pin_display.DisplaySize(pins=3, clk_khz=12_000)


@row("pin_display", {"frequency": "0.001 Hz", "period": "1 clock", "": "0"})
def pin_display_(see):
    for clk_khz in (12_000, 25_000, 100_000, 200_000):
        for hz in (
            1,
            Fraction(4001, 1000),
            Fraction(399_999, 1000),
            400,
            *(see.random.uniform(1, 400) for _ in range(9)),
        ):
            got = Fraction(pin_display.increment_of(hz, clk_khz) * 1000 * clk_khz, WRAP)
            see.near(got, Fraction(hz), (clk_khz, hz), part="frequency", limit=Fraction(1, 1000))
    least, largest = SIZE.limits
    for increment in (0, least - 1, least, largest, largest + 1, (1 << 32) - 1):
        twin = pin_display.PinDisplay(SIZE, pin_display.DisplaySettings(increment))
        found = [twin.next([255, 1, 0]) for _ in range(4)]
        if increment < least:
            see.same(found, [None] * 4, increment)
            continue
        for period in found[1:]:
            length = Fraction(WRAP, min(increment, largest))
            see.near(period.clocks, length, increment, part="period", limit=1)
            see.same(period.levels.tolist(), [15, 1, 0], increment)
    for top, most, duty in (
        (0, 3, 65535),
        (255, 0, 65535),
        (255, 3, 0),
        (255, 3, 19),
        (255, 1, 20),
        (1, 3, 20),
    ):
        settings = pin_display.DisplaySettings(largest, top=top, most=most, duty=duty)
        twin = pin_display.PinDisplay(SIZE, settings)
        got = [twin.next([255] * 3).levels.tolist() for _ in range(2)][1]
        # A period of 400 Hz is 10 ticks: the next one needs room for 12.
        on = min(top, 15) if duty >= 12 else 0
        see.near(sum(level > 0 for level in got), min(most, 3) if on else 0, (top, most, duty))
        see.near(max(got), on if most else 0, (top, most, duty))
    for outside in (
        {"pins": 4096},
        {"amplitude_bits": 0},
        {"max_hz": 23_438},
        {"ticks": 5716},
        {"clk_khz": 1000},
    ):
        see.refused(pin_display.DisplaySize, **outside)
    for outside in ({"increment": -1}, {"top": 256}, {"most": 4096}, {"duty": 65536}, {"burst_on": 4096}):
        see.refused(pin_display.DisplaySettings, **outside)
    see.refused(twin.next, [256, 0, 0])
    see.refused(twin.next, [0, 0])


@row("render", {"": "0"})
def render_(see):
    for shape, grid in (
        ((1, 2), (1, 2)),
        ((1, 1024), (7, 5)),
        ((255, 257), (2, 1)),
        ((3, 3), (128, 128)),
        ((2, 1), (5, 20)),
    ):
        for kind in ("zero", "full", "one", "mixed") if shape[0] < 200 and grid[0] < 100 else ("full",):
            image = np.zeros(shape, dtype=int) if kind != "full" else np.full(shape, 65535)
            if kind == "one":
                image[-1, -1] = 65535
            elif kind == "mixed":
                image = np.random.default_rng(see.random.randrange(99)).integers(0, 65536, shape)
            means = None if kind == "full" else averages(image.tolist(), *grid)
            for floor, step in ((0, 0), (1, 1), (65535, 0), (65535, 65535), (0, 65535), (30_000, 777)):
                got = render.Render(shape, grid, 4, render.RenderSettings(floor, step)).next(image)
                for i, j in {(0, 0), (grid[0] - 1, grid[1] - 1), (grid[0] // 2, grid[1] // 2)}:
                    mean = 65535 if means is None else means[i][j]
                    see.near(
                        int(got[i, j]),
                        level_of(mean, floor, step, 15),
                        (shape, grid, kind, floor, step, i, j),
                    )
    for octant in range(8):
        twin = render.Render(None, (1, 2), 6, render.RenderSettings(cue=255))
        for _ in range(300):
            see.same(set(twin.next(slip=True, octant=octant).ravel().tolist()) <= {0, 63}, True, octant)
    for outside in ({"floor": -1}, {"step": 65536}, {"cue": 256}):
        see.refused(render.RenderSettings, **outside)
