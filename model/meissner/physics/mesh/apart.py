"""One layer's response between contacts as a function of their distances: a table of two distances.

With d = j>-j<, s the smaller of j+j' and 2(N+1)-(j+j') (one-based), sinh products as differences of cosh:

    g_p(j, j') = h_p(d) - h_p(s),   h_p(v) = (exp(-tv) + exp(-t(2(N+1)-v))) / (2 sinh t (1 - exp(-2t(N+1))))
    2 cos p(i+1/2) cos p(i'+1/2) = cos p(i-i') + cos p(i+i'+1), of period 2M and even.

So T[u, v] = sum_p cos(pi p u / M) h_p(v) / M for u in 0..M, v in 0..N+1 gives an entry by four look-ups. The
table of green.py has one more index and needs only two look-ups, but N times the memory. Modes below
exp(-FADED) are left out: together they are less than UNIT / 500 of ``most``. The differences lose digits if
both electrodes are close compared with the free direction, so a layer more than twice as wide as it is long
uses rows of modes (lines.py).
"""

from typing import TYPE_CHECKING

import numpy as np

from meissner.arrays import Floats, Ints

if TYPE_CHECKING:
    from meissner.physics.mesh.green import Layer


FADED = 44.0
STEPS = 26  # columns in the first group with one number of modes; each next group is twice as long


def suits(free: int, along: int) -> bool:
    return free <= 2 * along


class Apart:
    """A Layer by its table of distances."""

    def __init__(self, layer: "Layer") -> None:
        free, end = layer.free, layer.along + 1
        self.free, self.end, self.ladder = free, end, layer.ladder
        turn = np.cos(np.pi / free * np.arange(2 * free)) / free
        half, mode = np.arange(free // 2 + 1, dtype=np.int32), np.arange(1, free, dtype=np.int32)
        cosine = turn[np.multiply.outer(half, mode) % (2 * free)]
        odd, even = np.ascontiguousarray(cosine[:, ::2]), np.ascontiguousarray(cosine[:, 1::2])
        self.table = np.zeros((free + 1, end + 1))
        start, step = 0, STEPS
        while start <= end:
            modes = int(layer.theta.searchsorted(FADED / start)) if start else free - 1
            place, theta = np.arange(start, min(start + step, end + 1)), layer.theta[:modes, None]
            wave = np.exp(-theta * place) + np.exp(-theta * (2 * end - place))
            wave /= layer.norm[:modes, None]
            sums, alternate = even[:, : modes // 2] @ wave[1::2], odd[:, : (modes + 1) // 2] @ wave[::2]
            self.table[free - half, start : place[-1] + 1] = sums - alternate  # cos p(pi - a) = (-1)^p cos pa
            self.table[half, start : place[-1] + 1] = sums + alternate
            start, step = start + step, 2 * step
        self.flat = self.table.reshape(-1)
        self.reach = layer.reach

    def most(self) -> float:
        """Upper bound of the sum of the magnitudes of any entry's terms: T[u, v] <= T[0, 0]."""
        return 4 * float(self.table[0, 0]) + float(self.reach().max())

    def between(self, across: Ints, along: Ints) -> Floats:
        """As Layer.between, for [..., K] places."""
        size, end = self.end + 1, self.end
        one, other = along[..., :, None] + 1, along[..., None, :] + 1
        apart, both = abs(one - other), one + other
        near = np.minimum(both, 2 * end - both)
        one, other = across[..., :, None], across[..., None, :]
        level, mirror = abs(one - other) * size, one + other + 1
        mirror = np.minimum(mirror, 2 * self.free - mirror) * size
        take = self.flat.take
        drop = take(level + apart) - take(level + near) + (take(mirror + apart) - take(mirror + near))
        low = (both - apart) >> 1
        return drop + self.ladder(low, low + apart)
