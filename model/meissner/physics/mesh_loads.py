"""The published mesh experiments as load arrays, and the cover that spreads a point over taxels."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, V, Values, finite

if TYPE_CHECKING:
    from meissner.physics.mesh import Mesh

K_PAPER = 4320.0  # newton ohms: 864 ohms at 5 N
SIX_R = (10.0, 47.0, 100.0, 150.0)  # ohms
SIX_TOTALS = (5.0, 10.0, 15.0, 20.0)  # newtons
TOUCHES = ("point", "cover", "two covers", "equal points", "uneven points")
TAXELS = 20_000_000  # in one step of ``touches``
COVER_RADIUS = 1.5  # pitches, of the hemisphere
LEAST_DEPTH = 0.25  # pitches, of a cover at its edge
TRIM = 0.02  # of the strongest taxel
SETTLED = 3.0  # time constants of the rubber in its published response time of 0.6 ms: 95 %
_MESH = "A High-Speed Mesh of Tactile Sensors"
ORIGINS = {
    "K_PAPER": (
        "published",
        f"{_MESH}: caption of table I, 864 ohms at 5 N",
        "every load in newtons; no position",
    ),
    "SIX_R": (
        "published",
        f"{_MESH}, IV-B",
        "cop_six_random, cop_one_point: one condition each",
    ),
    "SIX_TOTALS": (
        "published",
        f"{_MESH}, IV-C",
        "cop_six_random: one condition each",
    ),
    "TAXELS": (
        "chosen",
        "keeps the scenes of a fit of the correction below 2 GB",
        "no figure: time and memory alone",
    ),
    "COVER_RADIUS": (
        "chosen",
        f"{_MESH}, figure 14, shows a hemisphere over the elements and no size: it just covers taxels as "
        "wide as their pitch",
        "cop_circle: out of round by 0.05 % at 1.5, 26 % at 0.8, 1.3 % at 2.0",
    ),
    "LEAST_DEPTH": (
        "chosen",
        "with a cover of zero thickness at its edge the load would be a point",
        "cop_circle: only with a cover_radius below 0.56",
    ),
    "SETTLED": (
        "chosen",
        f"{_MESH}, figure 13, and the net's figure 10: 0.6 ms is read as 95 %, as the shear step's times are",
        "cop_impulse: load_error during the rise; response_s follows the scene's response_s whatever it is",
    ),
    "TRIM": (
        "chosen",
        "smaller loads only cost time",
        "docs/mesh.md: the corrections fitted for presses",
    ),
}


class MeshScene(NamedTuple):
    """A mesh and loads [scenes, m, n] in newtons."""

    mesh: "Mesh"
    load: Floats

    def truth(self) -> tuple[Floats, Floats, Floats]:
        """Total (N), x, y of each scene's loads, [scenes] each (eq. 4, 5, 27, 28)."""
        return true_centre(self.load)


def _published(m: int, n: int, r: float, load: Floats) -> MeshScene:
    from meissner.physics.mesh import Mesh  # here: arrays of taxels use this module without a mesh

    return MeshScene(Mesh(m, n, r, 10e3, 15.0, K_PAPER), load)


def places(count: int, first: float = -1.0) -> Floats:
    """Coordinates of ``count`` taxels, -1 to 1 (eq. 4; ``first`` = 1 for rows, eq. 5); 0 for one."""
    if count == 1:
        return np.zeros(1)
    return first - np.sign(first) * 2 * np.arange(count) / (count - 1)


@finite
def true_centre(load: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Total (N), x and y of loads [..., m, n]; x = y = 0 where nothing presses."""
    load = np.asarray(load, float)
    total = load.sum((-2, -1))
    safe = np.where(total > 0, total, 1)
    x = (load.sum(-2) * places(load.shape[-1])).sum(-1) / safe
    y = (load.sum(-1) * places(load.shape[-2], 1.0)).sum(-1) / safe
    return total, x, y


@finite
def cop_one_point(r: float = 10.0) -> MeshScene:
    """41×41, one load in the middle, for the voltage surface (mesh paper, figures 5 and 7)."""
    load = np.zeros((1, 41, 41))
    load[0, 20, 20] = 5.0
    return _published(41, 41, r, load)


def cop_two_point() -> MeshScene:
    """5×5, r = 47 ohms: F1 at (-1, -1), F2 at (1, 1), 10 N in total, F2 from 0 to 10 N (figure 10)."""
    load = np.zeros((11, 5, 5))
    load[:, 4, 0] = 10 - np.arange(11)
    load[:, 0, 4] = np.arange(11)
    return _published(5, 5, 47.0, load)


def cop_load() -> MeshScene:
    """5×5, r = 47 ohms: equal loads at (0, 0) and (0.5, 0.5), 0 to 10 N each in steps of 0.5 N (fig. 11)."""
    load = np.zeros((21, 5, 5))
    load[:, 2, 2] = load[:, 1, 3] = np.arange(21) / 2
    return _published(5, 5, 47.0, load)


@finite
def random_points(
    m: int, n: int, count: int, totals: Sequence[float] | Floats, seed: int, split: str = "equal"
) -> Floats:
    """Loads [len(totals), m, n]: ``count`` distinct random taxels share each total (N).

    ``split``: "equal" shares, as the published averages suggest, or "random" ones (uniform, normalised).
    """
    if not 1 <= count <= m * n:
        raise ValueError(f"count = {count} must lie in 1 .. {m * n}")
    if split not in ("equal", "random"):
        raise ValueError(f"split = {split!r} must be equal or random")
    rng = np.random.default_rng(seed)
    load = np.zeros((len(totals), m * n))
    for scene, total in zip(load, totals):
        share = np.ones(count) if split == "equal" else rng.random(count)
        scene[rng.choice(m * n, count, replace=False)] = total * share / share.sum()
    return load.reshape(-1, m, n)


@finite
def cop_six_random(
    r: float, total: float, draws: int = 100, seed: int = 1, split: str = "equal"
) -> MeshScene:
    """41×41, six random points that share ``total`` newtons, ``draws`` times (figures 8 and 9)."""
    load = random_points(41, 41, 6, np.full(draws, float(total)), seed, split)
    return _published(41, 41, r, load)


@finite
def cover_kernel(row: V, column: V, depth: V) -> V:
    """Weight at offsets (row, column) of a point force on the cover, ``depth`` pitches above the taxels.

    g = depth^3 / (depth^2 + d^2)^(5/2): Boussinesq's normal stress under a point force on an elastic half
    space, the g of the net-structure paper's eq. 27; not normalised.
    """
    return (1 + (np.square(row) + np.square(column)) / depth**2) ** -2.5


@finite
def press(m: int, n: int, x: ArrayLike, y: ArrayLike, force: ArrayLike, depth: ArrayLike) -> Floats:
    """Loads [scenes, m, n] of forces (N) at (x, y) in -1..1 on a flat cover ``depth`` pitches thick.

    Eq. 27 for point forces; the complete force reaches the taxels (the part beyond an edge is shared
    by all in proportion to their own). ``x``, ``y``, ``force``, ``depth``: numbers or arrays [scenes].
    """
    x, y, force, depth = np.broadcast_arrays(
        *(np.atleast_1d(np.asarray(a, float)) for a in (x, y, force, depth))
    )
    if (np.abs(x) > 1).any() or (np.abs(y) > 1).any() or (force < 0).any() or not (depth > 0).all():
        raise ValueError("a press needs x and y in -1..1, a force of 0 or more and a cover with depth")
    column, row = (x + 1) * (n - 1) / 2, (1 - y) * (m - 1) / 2
    down = np.arange(m)[:, None] - row[:, None, None]
    right = np.arange(n) - column[:, None, None]
    share = cover_kernel(down, right, depth[:, None, None])
    return share * (force / share.sum((1, 2)))[:, None, None]


def _trim(load: Floats) -> Floats:
    """Set taxels below 2 % of the strongest to 0: they only cost time."""
    return np.where(load < TRIM * load.max((1, 2), keepdims=True), 0, load)


@finite
def touches(m: int, n: int, kind: str, seed: int, total: float | None = None) -> Floats:
    """Loads of one kind of touch: totals of 1-25 N to fit a correction, or ``total`` newtons to check it.

    ``kind``: one point; one press through a cover 2 pitches thick, or two; six points, equal or uneven.
    """
    if kind not in TOUCHES:
        raise ValueError(f"kind = {kind!r} must be one of: {', '.join(TOUCHES)}")
    rng = np.random.default_rng(seed)
    count = min({"cover": 200, "two covers": 1000}.get(kind, 4000), max(30, TAXELS // (m * n)))
    totals = rng.uniform(1, 25, count) if total is None else np.full(count, total)
    place = lambda: rng.uniform(-0.8, 0.8, count)
    if kind == "cover":
        return _trim(press(m, n, place(), place(), totals, 2.0))
    if kind == "two covers":
        share = rng.uniform(0.25, 0.75, count)
        first = press(m, n, place(), place(), totals * share, 2.0)
        return _trim(first + press(m, n, place(), place(), totals * (1 - share), 2.0))
    if kind == "point":
        return random_points(m, n, 1, totals, seed)
    split = {"equal points": "equal", "uneven points": "random"}[kind]
    return random_points(m, n, min(6, m * n), totals, seed, split)


@finite
def hemisphere_depth(x: Values, y: Values, radius: float, base: float) -> Values:
    """Height (pitches) of a hemispherical cover of ``radius`` (in -1..1 units) over the taxels at (x, y).

    ``base``: height at the middle; towards the edge it falls with the sphere, to a quarter pitch at least.
    """
    fall = 1 - (np.square(x) + np.square(y)) / radius**2
    return np.maximum(base * np.sqrt(np.maximum(fall, 0)), LEAST_DEPTH)


@finite
def stroke(m: int, n: int, force: float, circle: float, steps: int, cover_radius: float) -> Floats:
    """Loads [steps, m, n] of a fingertip (N) that draws a ``circle`` once on a hemispherical cover.

    Eq. 27 with the force at a point; the circle starts on the right and goes counter-clockwise. The cover's
    height over the middle is its radius: ``cover_radius`` in -1..1 units of the longer side.
    """
    angle = 2 * np.pi * np.arange(steps) / steps
    x, y = circle * np.cos(angle), circle * np.sin(angle)
    return press(m, n, x, y, force, hemisphere_depth(x, y, cover_radius, cover_radius * (max(m, n) - 1) / 2))


@finite
def cop_stroke(steps: int = 72, cover: float = COVER_RADIUS) -> MeshScene:
    """A fingertip draws a circle on a hemispherical cover over 3×3 taxels (mesh paper, figures 14, 15).

    The hemisphere just covers the taxels, which are as wide as their pitch: 1.5 pitches.
    """
    return _published(3, 3, 47.0, stroke(3, 3, 5.0, 0.5, steps, cover))
