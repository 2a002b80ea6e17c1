"""Bit-exact twin of rtl/actuate/msn_render.sv: a tactile image, a centre of pressure and a slip as a frame of
pin levels (docs/pin_display.md).

average of a pin   = sum of (overlap of taxel and pin) x / (rows columns)    areas, divided evenly
level              = 0 if the average is below `floor`, else 1 + floor((average - floor) / step), at most
                     the highest; step = 0: the highest
marker             the pin under the newest centre of pressure as the frame begins has the highest level
slip               in place of all this stripes, one pin wide, every fourth pin, that move where it slips
"""

from dataclasses import dataclass, field, fields

import numpy as np

from meissner.twins.shared import fits

UNIT = 1 << 14  # of a centre of pressure: Q2.14
# Of the octants, counter-clockwise from +x: steps of columns to the right and of rows upwards.
OCTANTS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
APART = 4  # pins from stripe to stripe


def overlaps(taxels, pins):
    """[pins, taxels] in units of 1 / pins of a taxel: how much of each taxel lies under each pin; rows sum to
    taxels.

    A side of ``taxels`` is divided evenly among ``pins``: pin i reaches from i taxels to (i + 1) taxels.
    """
    i, r = np.arange(pins)[:, None], np.arange(taxels)
    ends = np.minimum((i + 1) * taxels, (r + 1) * pins) - np.maximum(i * taxels, r * pins)
    return np.maximum(ends, 0)


def averages(image, pin_rows, pin_columns):
    """The numerators of the pins' averages; the denominator is the number of taxels."""
    image = np.asarray(image, dtype=np.int64)
    rows, columns = image.shape
    return overlaps(rows, pin_rows) @ image @ overlaps(columns, pin_columns).T


@dataclass(frozen=True)
class RenderSettings:
    """``floor``, ``step``: codes of force; ``marker``: 1: shows the centre of pressure; ``cue``: frames from
    step to step of the stripes, 0: a slip is not shown."""

    floor: int = 1
    step: int = 0
    marker: int = 0
    cue: int = 0

    def __post_init__(self):
        fits(self, floor=(0, 65535), step=(0, 65535), marker=(0, 1), cue=(0, 255))

    @property
    def settings(self):
        """{name: value} of the block's ``cfg_`` inputs."""
        return {f.name: int(getattr(self, f.name)) for f in fields(self)}


@dataclass
class Render:
    """``next`` is a frame. ``shape``: of the image, None without one; ``grid``: rows and columns of pins."""

    shape: tuple[int, int] | None = (16, 16)
    grid: tuple[int, int] = (5, 20)
    amplitude_bits: int = 4
    settings: RenderSettings = field(default_factory=RenderSettings)

    def __post_init__(self):
        self.reset()

    def reset(self):
        self.cue = self.phase = 0  # frames until the next step; place of the stripes

    @property
    def clocks(self):
        """From a frame's last taxel, or its centre of pressure, to the last pin's level, at most."""
        (rows, columns), (high, wide) = self.grid, self.shape or (0, 0)
        if self.shape is None:
            return 2 * rows * columns + 4
        pieces = (rows + high - 1) * (columns + wide - 1)  # overlaps of taxels and pins
        return pieces + rows * columns * (7 + (1 << self.amplitude_bits)) + 8

    def next(self, image=None, slip=False, octant=0, cop=None):
        """Levels [rows, columns] of the pins; ``cop``: (x, y) in Q2.14, None: nothing presses."""
        (rows, columns), s, top = self.grid, self.settings, (1 << self.amplitude_bits) - 1
        if slip and s.cue:
            return top * self._stripes(octant)
        self.cue = self.phase = 0
        levels = np.zeros(self.grid, dtype=np.int64)
        if self.shape is not None:
            image = np.asarray(image)
            if image.shape != self.shape:
                raise ValueError(f"image has the shape {image.shape}, which must be {self.shape}")
            rest = averages(image, rows, columns) - s.floor * image.size
            step = s.step * image.size
            levels = np.where(rest >= 0, np.minimum(1 + rest // step, top) if step else top, 0)
        if s.marker and cop is not None:
            x, y = cop
            row = min((UNIT - y) * rows >> 15, rows - 1)
            column = min((UNIT + x) * columns >> 15, columns - 1)
            levels[row, column] = top
        return levels

    def _stripes(self, octant):
        """Where the stripes are in this frame, bool [rows, columns]; they move on with the frames."""
        right, up = OCTANTS[octant]
        row, column = np.indices(self.grid)
        found = (right * column - up * row - self.phase) % APART == 0
        self.cue += 1
        if self.cue >= self.settings.cue:
            self.cue, self.phase = 0, (self.phase + 1) % APART
        return found
