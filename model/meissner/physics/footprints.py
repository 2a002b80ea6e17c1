"""Where small objects touch a pad of 15 mm: the published objects; sizes that are not given are chosen.

Each object is a list of pieces in millimetres from the pad's centre, x to the right and y up: bars (rotated
by degrees, counter-clockwise), discs and rings. They touch flat, with an even pressure.
"""

import numpy as np

from meissner.arrays import Bools, Floats, finite

Piece = tuple[str, float, float, list[float]]  # "bar" or "ring", place, sizes
STEP_MM = 0.2  # of the points that sample the area


@finite
def bar(x_mm: float, y_mm: float, wide_mm: float, high_mm: float, degrees: float = 0.0) -> Piece:
    return "bar", x_mm, y_mm, [wide_mm, high_mm, degrees]


@finite
def ring(x_mm: float, y_mm: float, outer_mm: float, inner_mm: float = 0.0) -> Piece:
    """``outer_mm``, ``inner_mm``: diameters."""
    return "ring", x_mm, y_mm, [outer_mm, inner_mm]


def _rows_of_pins(degrees: float) -> list[Piece]:
    """A socket with two rows of four contacts, 7.62 mm apart, each a plastic bar with its pins."""
    x, y = -np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return [bar(away * x, away * y, 4 * 2.54, 2.0, degrees) for away in (-3.81, 3.81)]


# The gap of the part with two edges (3 mm) and the six pins of the connector are published; the rest is
# chosen: an 8-pin socket 7.62 mm apart, an M4 bolt on its side, an M5 washer, a connector of 2 × 3 barrels.
SHAPES = {
    "edge": [bar(0.0, 0.95, 14.0, 1.2, 4.0)],
    "upright edge": [bar(0.95, 0.0, 1.2, 13.3)],
    "IC socket": _rows_of_pins(45.0),
    "opposite socket": _rows_of_pins(-45.0),
    "two edges": [bar(0.0, 2.85, 13.0, 1.5), bar(0.0, -2.85, 13.0, 3.9)],
    "bolt": [bar(-4.2, 0.0, 3.0, 7.0), bar(2.0, 0.0, 9.4, 1.6)],
    "washer": [ring(0.0, 0.0, 10.0, 5.3)],
    "connector": [ring(x, y, 3.2) for x in (-4.75, 0.0, 4.75) for y in (-2.4, 2.4)],
}
ORIGINS = {
    "STEP_MM": ("chosen", "a tenth of a cell's pitch", "capacitive_shapes: the edges of its images"),
    "SHAPES": (
        "published",
        "Performance Analysis of a Tactile Sensor: which objects, the gap of 3 mm, six pins; sizes chosen: "
        "8-pin socket, M4 bolt, M5 washer, 2 by 3 barrels",
        "capacitive_shapes: every image; position and load errors of its rows",
    ),
}


ORIGINS = {
    "STEP_MM": ("chosen", "finer than a tab", "areas within 5 % of the outlines"),
    "SHAPES": (
        "chosen",
        "002, figures 9 to 13: kinds of objects, both diagonals, 6 pins and the gap of 3 mm published",
        "the images of capacitive_shapes; the gap of one row",
    ),
}


def _within(piece: Piece, x_mm: Floats, y_mm: Floats) -> Bools:
    """Whether each point lies in the piece."""
    kind, x0, y0, sizes = piece
    x, y = x_mm - x0, y_mm - y0
    if kind == "ring":
        outer, inner = sizes
        return (np.hypot(x, y) <= outer / 2) & (np.hypot(x, y) >= inner / 2)
    wide, high, degrees = sizes
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (np.abs(x * cos + y * sin) <= wide / 2) & (np.abs(y * cos - x * sin) <= high / 2)


@finite
def points(shape: str, reach_mm: float = 12.0) -> tuple[Floats, Floats, Floats]:
    """(x_mm, y_mm, area_mm2): points that sample the area touched by the object."""
    steps = np.arange(-reach_mm + STEP_MM / 2, reach_mm, STEP_MM)
    x_mm, y_mm = (axis.ravel() for axis in np.meshgrid(steps, steps))
    touched = np.any([_within(piece, x_mm, y_mm) for piece in SHAPES[shape]], axis=0)
    return x_mm[touched], y_mm[touched], np.full(touched.sum(), STEP_MM**2)


def outlines(shape: str) -> list[Floats]:
    """Closed lines [points, 2] in millimetres around each piece."""
    lines = []
    for kind, x0, y0, sizes in SHAPES[shape]:
        if kind == "ring":
            angle = np.linspace(0, 2 * np.pi, 61)
            circle = np.stack([np.cos(angle), np.sin(angle)], axis=1) / 2
            lines += [(x0, y0) + size * circle for size in sizes if size > 0]
        else:
            wide, high, degrees = sizes
            corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * (wide / 2, high / 2)
            cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            lines.append(corners @ np.array([[cos, sin], [-sin, cos]]) + (x0, y0))
    return lines
