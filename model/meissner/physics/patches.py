"""Contact patches that move over an array: each is a point force on an elastic cover over the taxels.

    line      from one place to another at a steady speed
    circle    around a centre, counter-clockwise from its right
    hold      in one place

Force over the run, as a share of ``force_n``: ``steady`` 1; ``press`` a half sine; ``step`` the two peaks of
a footstep (landing and push-off), sin(pi p) + sin(3 pi p)/3 scaled to a peak of 1.

Not modelled: friction, the cover's creep and hysteresis, crosstalk of the readout.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from meissner.arrays import Floats, finite
from meissner.physics import mesh_loads

_STEP_PEAK = 2 * np.sqrt(2) / 3
PROFILES: dict[str, Callable[[Floats], Floats]] = {
    "steady": np.ones_like,
    "press": lambda phase: np.sin(np.pi * phase),
    "step": lambda phase: (np.sin(np.pi * phase) + np.sin(3 * np.pi * phase) / 3) / _STEP_PEAK,
}
ORIGINS = {
    "PROFILES": (
        "chosen",
        "a steady finger, a tap, a foot's two humps; walk_25x5 stands for a walk on the net paper's 25×5",
        "walk_25x5, dense_64: where the load is least, and so the largest errors",
    ),
}


@finite
def place(patch: Mapping[str, Any], phase: Floats) -> tuple[Floats, Floats]:
    """x and y of a patch at ``phase`` (0 to 1 during the run)."""
    if patch["path"] == "line":
        (x0, y0), (x1, y1) = patch["from"], patch["to"]
        return x0 + (x1 - x0) * phase, y0 + (y1 - y0) * phase
    if patch["path"] == "circle":
        angle = 2 * np.pi * patch["turns"] * phase
        x, y = patch["centre"]
        return x + patch["radius"] * np.cos(angle), y + patch["radius"] * np.sin(angle)
    x, y = patch["at"]
    return np.full(np.shape(phase), x), np.full(np.shape(phase), y)


@finite
def forces(
    rows: int, columns: int, patches: Sequence[Mapping[str, Any]], phase: Floats, depth: float
) -> Floats:
    """Newtons on the taxels [frames, rows, columns] under all patches; ``depth``: of the cover, pitches."""
    total = np.zeros((len(phase), rows, columns))
    for patch in patches:
        x, y = place(patch, phase)
        force_n = patch["force_n"] * np.maximum(PROFILES[patch["profile"]](phase), 0.0)
        total += mesh_loads.press(rows, columns, x, y, force_n, depth)
    return total
