"""``render(felt, grid, amplitude_bits, settings)``: levels [frames, rows, columns] of the pins of ``grid``.

``felt``: Felt; ``settings``: RenderSettings.
"""

from dataclasses import dataclass

import numpy as np

from meissner.arrays import Bools, Ints
from meissner.twins.actuate.render import APART, OCTANTS, UNIT, Render, RenderSettings

Grid = tuple[int, int]


@dataclass(frozen=True)
class Felt:
    """What a sensor reports, frame by frame: ``image`` [frames, rows, columns], None without one; ``slip``,
    ``octant``, ``valid`` [frames]; ``cop`` [frames, 2] in Q2.14 where ``valid``."""

    image: Ints | None
    slip: Bools
    octant: Ints
    valid: Bools
    cop: Ints

    def __getitem__(self, part: slice) -> "Felt":
        image = None if self.image is None else self.image[part]
        return Felt(image, self.slip[part], self.octant[part], self.valid[part], self.cop[part])

    @property
    def size(self) -> int:
        return len(self.slip)


def fixed(felt: Felt, grid: Grid, amplitude_bits: int, settings: RenderSettings) -> Ints:
    """By the integer twin."""
    twin = Render(None if felt.image is None else felt.image.shape[1:], grid, amplitude_bits, settings)
    found = np.zeros((felt.size, *grid), dtype=np.int64)
    for k in range(felt.size):
        image = None if felt.image is None else felt.image[k]
        cop = tuple(felt.cop[k].tolist()) if felt.valid[k] else None
        found[k] = twin.next(image, bool(felt.slip[k]), int(felt.octant[k]), cop)
    return found


def _resampled(image: Ints, grid: Grid) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    """Means over the pins' areas [frames, rows, columns], by the integral of the image along each side."""
    found = np.asarray(image, float)
    for axis, pins in zip((1, 2), grid):
        taxels = found.shape[axis]
        edges = np.linspace(0, taxels, pins + 1)
        whole = np.insert(np.cumsum(found, axis), 0, 0.0, axis)
        low = np.minimum(edges.astype(int), taxels - 1)
        rest = (edges - low).reshape([-1 if k == axis else 1 for k in range(3)])
        at = whole.take(low, axis) + rest * (whole.take(low + 1, axis) - whole.take(low, axis))
        found = np.diff(at, axis=axis) * pins / taxels
    return found


def float_(felt: Felt, grid: Grid, amplitude_bits: int, settings: RenderSettings) -> Ints:
    """The same rules in floats; a mean within 1e-9 of a limit counts as on it."""
    top, found = 2**amplitude_bits - 1, np.zeros((felt.size, *grid), dtype=np.int64)
    if felt.image is not None:
        above = _resampled(felt.image, grid) - settings.floor + 1e-9
        steps = above // settings.step if settings.step else np.full(above.shape, top)
        found = np.where(above >= 0, np.minimum(1 + steps, top), 0).astype(np.int64)
    if settings.marker:
        share = np.stack([(UNIT - felt.cop[:, 1]) / 2 / UNIT, (UNIT + felt.cop[:, 0]) / 2 / UNIT], axis=1)
        place = np.minimum(np.floor(share * grid), np.array(grid) - 1).astype(int)
        at = np.flatnonzero(felt.valid)
        found[at, place[at, 0], place[at, 1]] = top
    row, column = np.indices(grid)
    shown = 0
    for k in np.flatnonzero(felt.slip) if settings.cue else ():
        shown = shown + 1 if k and felt.slip[k - 1] else 0
        right, up = OCTANTS[felt.octant[k]]
        found[k] = top * ((right * column - up * row - shown // settings.cue) % APART == 0)
    return found


def rtl(felt: Felt, grid: Grid, amplitude_bits: int, settings: RenderSettings) -> Ints:
    """By the Verilated module; only here its builder is loaded."""
    from meissner.engines.features.render.driver import render

    return render(felt, grid, amplitude_bits, settings)


def gate(felt: Felt, grid: Grid, amplitude_bits: int, settings: RenderSettings) -> Ints:
    """By its netlist."""
    from meissner.engines import verilated

    return verilated.of_gates(rtl)(felt, grid, amplitude_bits, settings)


ENGINES = {"float": float_, "fixed": fixed, "rtl": rtl, "gate": gate}
