"""One layer's response between few contacts on a mesh too large for tables: a row of modes for each line.

cos pd + cos pe = 2 cos p(i+1/2) cos p(i'+1/2), and g_p(j<, j>) of meissner.physics.mesh.green is a product of
a factor of j<, one of j> and exp(-t (j>-j<)). So a contact needs only the rows of its own two lines, and the
rest of the network does not matter. A pair needs only the modes that reach from one line to the other: each
omitted one is at most exp(-FADED) sqrt(g_p(j, j) g_p(j', j')), and by Cauchy and Schwarz all of them together
are less than UNIT / 20 of the scale that Layer.rounding refers to.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from meissner.arrays import Floats, Ints

if TYPE_CHECKING:
    from meissner.physics.mesh.green import Layer


CHUNK = 4_000_000  # modes times pairs evaluated in one step
FADED = 40.0
WIDER = 8  # pairs summed with the same number of modes differ in distance by at most this factor
KEPT = 1 << 21  # entries of rows cached for each direction, at most


class Rows:
    """``make(places)`` [places, modes], computed at the first use of a place and then cached."""

    def __init__(self, count: int, modes: int, make: Callable[[Ints], Floats]) -> None:
        self.make, self.keep = make, count * modes <= KEPT
        self.row = np.empty((count, modes) if self.keep else (0, modes))
        self.there = np.zeros(count, bool)

    def __getitem__(self, places: Ints) -> Floats:
        if not self.keep:
            return self.make(places)
        known = self.there[places]
        if not known.all():
            new = np.unique(places[~known])
            self.row[new], self.there[new] = self.make(new), True
        return self.row[places]


@lru_cache(maxsize=4)
def _pairs(scenes: int, contacts: int) -> tuple[Ints, Ints, Ints, Ints]:
    """For every pair of all scenes, its two contacts and the start of its scene's matrix; for every contact,
    the start of its scene's contacts."""
    first, second = np.triu_indices(contacts)
    start, pairs = np.arange(scenes), len(first)
    first, second = (np.add.outer(start * contacts, place).reshape(-1) for place in (first, second))
    return first, second, np.repeat(start * contacts**2, pairs), np.repeat(start * contacts, contacts)


class Lines:
    """A Layer by rows of its modes."""

    def __init__(self, layer: "Layer") -> None:
        self.free, self.theta, self.end, self.ladder = layer.free, layer.theta, layer.along + 1, layer.ladder
        self.scale = np.sqrt(2 / layer.free / layer.norm)
        self.mode = np.arange(1, layer.free)
        self.cosine = np.cos(np.pi / 2 * np.arange(-2 * self.free, 2 * self.free) / self.free)
        self.waves = Rows(layer.free, len(self.mode), self._waves)
        self.ends = Rows(self.end, len(self.mode), self._ends)

    def _waves(self, across: Ints) -> Floats:
        """cos(pi p (2i+1) / 2M), from a table of one period, times the square root of the mode's scale."""
        turned = (2 * across[:, None] + 1) * self.mode + 2 * self.free
        return self.cosine[turned % (4 * self.free)] * self.scale

    def _ends(self, place: Ints) -> Floats:
        """1 - exp(-2 t j): the part of a mode that remains at j lines from an electrode."""
        return -np.expm1(place[:, None] * (-2 * self.theta))

    def between(self, across: Ints, along: Ints) -> Floats:
        """As Layer.between, for [scenes, K] places."""
        scenes, contacts = across.shape
        most = max(1, CHUNK // max(1, contacts * self.free))
        if scenes > most:
            parts = [slice(start, start + most) for start in range(0, scenes, most)]
            return np.concatenate([self.between(across[part], along[part]) for part in parts])
        first, second, base, start = _pairs(scenes, contacts)
        order = along.argsort(axis=1).reshape(-1)  # so that the first of a pair has j<
        row, column = order[first], order[second]
        entries = base + row * contacts + column, base + column * contacts + row
        order += start
        across, along = across.reshape(-1)[order], along.reshape(-1)[order] + 1
        low = self.waves[across]
        high = low * self.ends[self.end - along]
        low *= self.ends[along]
        gap = along[second] - along[first]
        sums = self.ladder(along[first], along[second])
        ranked = gap.argsort(kind="stable")
        gap, first, second = gap[ranked], first[ranked], second[ranked]
        at = 0
        while at < len(gap):
            near = int(gap[at])
            modes = int(self.theta.searchsorted(FADED / near)) if near else len(self.theta)
            stop = min(int(gap.searchsorted(max(1, WIDER * near))), at + max(1, CHUNK // max(1, modes)))
            term = low[first[at:stop], :modes]
            if near:
                term *= np.exp(np.multiply.outer(gap[at:stop], -self.theta[:modes]))
            sums[ranked[at:stop]] += np.vecdot(term, high[second[at:stop], :modes])
            at = stop
        out = np.empty(scenes * contacts**2)
        for entry in entries:
            out[entry] = sums
        return out.reshape(scenes, contacts, contacts)
