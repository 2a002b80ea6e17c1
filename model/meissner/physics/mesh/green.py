"""The drops in one layer of the mesh due to the currents drawn from it, in closed form (units of r).

A layer is a grid of equal resistors. One direction is *free* (open ends, eq. 7), the other runs *along*
from electrode to electrode (eq. 10). Cosines diagonalise the free direction; along, mode p >= 1 sees both
electrodes as fixed, because a cosine carries no net current, and has

    g_p(j, j') = sinh(t j<) sinh(t (N+1-j>)) / (sinh t sinh t(N+1)),    t = 2 asinh(sin(pi p / 2M)).

Mode 0 is a ladder that ends in R0 on both sides. Its drop is R0/2 times the total current, which the caller
keeps separate (so R0 >> r costs no digits), plus H below: positive definite, written without subtractions.
"""

import numpy as np

from meissner.arrays import Floats, Ints
from meissner.physics.mesh.apart import Apart, suits
from meissner.physics.mesh.lines import Lines

UNIT = np.finfo(float).eps / 2
TABLE_LIMIT = 3_000_000  # entries of a table of three indices
APART_LIMIT = 3_000_000  # entries of a table of two distances; beyond it the modes are summed for each pair


class Layer:
    """Green's function of one layer: ``free`` nodes across, ``along`` nodes between the electrodes.

    ``pull`` = 2 R0 / (2 R0 + (along+1) r / free), 0 for R0 = 0 and towards 1 for R0 >> r.
    Indices are zero-based. Results are drops in volts per ampere, in units of r; source: eq. 1-10.
    """

    def __init__(self, free: int, along: int, pull: float) -> None:
        self.free, self.along, self.pull = free, along, pull
        self.theta = 2 * np.arcsinh(np.sin(np.pi * np.arange(1, free) / (2 * free)))
        self.norm = 2 * np.sinh(self.theta) * -np.expm1(-2 * self.theta * (along + 1))
        self._large: Apart | Lines | None = None
        self._table: Floats | None = None
        self._reach: Floats | None = None

    def _modes(self, low: Ints, high: Ints) -> Floats:
        """g_p(low, high) for all modes p >= 1 in a new last axis; one-based, low <= high."""
        low, high = low[..., None], high[..., None]
        end = self.along + 1
        left, right = np.expm1(-2 * self.theta * low), np.expm1(-2 * self.theta * (end - high))
        return np.exp(-self.theta * (high - low)) * left * right / self.norm

    def ladder(self, low: Ints, high: Ints) -> Floats:
        """H: the drop of mode 0 beyond R0/2 times the current, one-based."""
        end = self.along + 1
        tilt = (low - end / 2) * (high - end / 2) * self.pull
        return (low * (end - high) + tilt) / (end * self.free)

    @property
    def tabulated(self) -> bool:
        return 2 * self.free * self.along**2 <= TABLE_LIMIT

    @property
    def by_distance(self) -> bool:
        fits = (self.free + 1) * (self.along + 2) <= APART_LIMIT and suits(self.free, self.along)
        return fits and not self.tabulated

    @property
    def large(self) -> Apart | Lines:
        """The method for a layer too large for a table of three indices."""
        if self._large is None:
            self._large = Apart(self) if self.by_distance else Lines(self)
        return self._large

    def table(self) -> Floats:
        """[2 free, along, along]: half of H plus the sum of modes for a cosine argument, period 2 free."""
        if self._table is None:
            place = np.arange(1, self.along + 1)
            low, high = np.minimum.outer(place, place), np.maximum.outer(place, place)
            turn = np.multiply.outer(np.arange(self.free + 1), np.arange(1, self.free)) % (2 * self.free)
            cosine = np.cos(np.pi * turn / self.free) / self.free
            sums = cosine @ self._modes(low, high).reshape(self.along**2, self.free - 1).T
            sums += self.ladder(low, high).ravel() / 2
            self._table = np.concatenate([sums, sums[-2:0:-1]])
        return self._table

    def between(self, across: Ints, along: Ints) -> Floats:
        """Drop at each contact per ampere at every other: two [..., K] index arrays -> [..., K, K]."""
        if self.tabulated:
            table, size = self.table(), self.along**2
            level = across * size
            first, second = (level + along * self.along)[..., :, None], along[..., None, :]
            level = level[..., None, :]
            gap = first - (level - second)  # below 0 it indexes from the table's end: one period later
            return table.take(gap) + table.take(first + (level + second + size))
        contacts = across.shape[-1]
        drop = self.large.between(across.reshape(-1, contacts), along.reshape(-1, contacts))
        return drop.reshape(*across.shape, contacts)

    def reach(self) -> Floats:
        """[along]: an upper bound of a contact's drop per own ampere; sqrt(reach reach') bounds the sum of
        the magnitudes of an entry's terms in ``between``, except by distance (see ``terms``)."""
        if self._reach is None:
            place = np.arange(1, self.along + 1)
            self._reach = self.ladder(place, place) + 2 * self._modes(place, place).sum(-1) / self.free
        return self._reach

    def terms(self) -> Floats:
        """[along]: sqrt(terms terms') bounds the sum of the magnitudes of any entry's terms."""
        large = self.large if self.by_distance else None
        return np.full(self.along, large.most()) if isinstance(large, Apart) else self.reach()

    @property
    def rounding(self) -> float:
        """|error of an entry of between| <= rounding * sqrt(terms terms'): free+64 roundings.

        ``free`` for the sum of as many terms in any order, 64 for the term itself with functions accurate to
        4 ulp; the exponential's argument t d adds at most 4/e, since x exp(-x) <= 1/e.
        """
        return (self.free + 64) * UNIT

    def field(self, current: Floats) -> Floats:
        """Drop at every node [..., free, along] for currents drawn [..., free, along], without R0/2."""
        from scipy import fft  # imported here: only commands that solve a mesh wait for SciPy

        free, along = self.free, self.along
        cosine = 4 * np.sin(np.pi * np.arange(free) / (2 * free)) ** 2
        sine = 4 * np.sin(np.pi * np.arange(1, along + 1) / (2 * (along + 1))) ** 2
        modes = fft.dct(fft.dst(current, type=1, axis=-1), type=2, axis=-2)
        modes /= cosine[:, None] + sine
        drop = fft.idst(fft.idct(modes, type=2, axis=-2), type=1, axis=-1)
        lever = np.arange(1, along + 1) - (along + 1) / 2
        pulled = (current.sum(-2) * lever).sum(-1) * self.pull / ((along + 1) * free)
        return drop + pulled[..., None, None] * lever
