"""Finds the loaded taxels; in a large frame with few contacts, by one pass over its bits."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import LARGEST, Floats, Ints

LINE = 1024  # taxels tested together
LARGE = 32 * LINE  # from this many taxels on


def _check(load: NDArray[Any]) -> None:
    if load.size and not load.min() >= 0:
        if np.isnan(load).any():
            raise ValueError("load holds NaN: every taxel needs a number of newtons")
        raise ValueError("load holds a negative force: taxels can only be pressed")
    if load.size and not float(load.max()) <= LARGEST:
        raise ValueError(f"load holds {load.max():g} newtons: a taxel takes {LARGEST:g} at most")


def touched(load: NDArray[Any]) -> Ints:
    """Indices of what is above 0 in the flat array ``load``; ValueError if one is NaN, too large or negative.

    A line whose words have no bit set contains only +0 and is skipped.
    """
    whole = load.size // LINE
    if load.size >= LARGE:
        words = load[: whole * LINE].view(np.uint64).reshape(whole, LINE * load.itemsize // 8)
        lines = np.bitwise_or.reduce(words, axis=1).nonzero()[0]
        if 4 * len(lines) < whole:
            part = np.concatenate(
                [load[: whole * LINE].reshape(whole, LINE)[lines].reshape(-1), load[whole * LINE :]]
            )
            _check(part)
            line, place = np.divmod((part > 0).nonzero()[0], LINE)
            return np.append(lines, whole)[line] * LINE + place
    _check(load)
    return (load > 0).nonzero()[0]  # nonzero of booleans is ten times faster than of floats


def contacts_of(
    m: int, n: int, row: ArrayLike, column: ArrayLike, force: ArrayLike
) -> tuple[Ints, Floats, int, bool]:
    """(index through all scenes, newtons, number of scenes, whether a single one) of contacts with a force.

    Arguments: [K] or [scenes, K] each; the contacts are returned in the order of a frame's taxels.
    """
    row, column = np.asarray(row), np.asarray(column)
    try:
        newtons = np.asarray(force, float)
    except (TypeError, ValueError):
        raise ValueError("force must be an array of newtons") from None
    if not row.shape == column.shape == newtons.shape or newtons.ndim not in (1, 2):
        shapes = ", ".join(str(list(part.shape)) for part in (row, column, newtons))
        raise ValueError(
            f"row, column, force have the shapes {shapes}, must be [K] or [scenes, K], all three"
        )
    for name, place, count in (("row", row, m), ("column", column, n)):
        if place.dtype.kind not in "iu" and place.size:
            raise ValueError(f"{name} must hold whole numbers")
        if place.size and not 0 <= place.min() <= place.max() < count:
            raise ValueError(f"{name} holds {place.min()} to {place.max()}, must lie in 0 to {count - 1}")
    _check(newtons)
    single, scenes = newtons.ndim == 1, 1 if newtons.ndim == 1 else len(newtons)
    index = row.astype(np.int64, copy=False) * n + column
    if not single:
        index = index + np.arange(scenes)[:, None] * (m * n)
    index, newtons = index.reshape(-1), newtons.reshape(-1)
    order = index.argsort()
    index, newtons = index[order], newtons[order]
    if index.size and not np.diff(index).all():
        twice = int(index[:-1][np.diff(index) == 0][0])
        raise ValueError(f"row {twice // n % m}, column {twice % n} is given twice: add its forces")
    return index, newtons, scenes, single
