"""The (2mn+4) nodal equations of the mesh (eq. 8-10, 20-23) as a graph of conductances.

The unknowns are the nodes' drops: below +V0 in layer A and at E1, E3; *minus* the rise above -V0 in layer B
and at E2, E4. Voltages are in units of 2V0 and conductances in units of 1/r. Every equation then is
sum g (z_p - z_q - e) = 0 over the edges at a node, e = 1 across a contact, so small currents keep their
digits. A short merges its two nodes, and the source e = 1 between them moves into the resistors around it.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import SuperLU

    from meissner.physics.mesh.mesh import Mesh


LONG = np.longdouble
LONG_UNIT = float(np.finfo(LONG).eps)
GROUND = -1
Longs = NDArray[np.longdouble]


class Circuit:
    """One scene's network. ``load`` [m, n] in newtons, inf = shorted."""

    def __init__(self, mesh: "Mesh", load: Floats) -> None:
        m, n = mesh.m, mesh.n
        self.mesh, self.size = mesh, 2 * m * n + 4
        p, q, g = grid_edges(m, n, mesh.r / mesh.R0)
        loaded = np.flatnonzero(load > 0)
        force = load.reshape(-1)[loaded]
        with np.errstate(over="ignore", divide="ignore"):
            contact = mesh.r / (mesh.k / force)
        short = np.isinf(contact)
        keep = ~short & (contact > 0)
        kept = loaded[keep]
        self.p, self.q = np.concatenate([p, kept]), np.concatenate([q, kept + m * n])
        self.g = np.concatenate([g, contact[keep]])
        self.emf = np.concatenate([np.zeros(len(p)), np.ones(len(kept))])
        self.node, self.offset = np.arange(self.size), np.zeros(self.size)
        shorted = loaded[short]
        self.node[shorted + m * n] = shorted
        self.offset[shorted + m * n] = -1
        self.live = np.flatnonzero(self.node == np.arange(self.size))
        place = np.full(self.size + 1, GROUND)
        place[self.live] = np.arange(len(self.live))
        self.place = place[self.node]
        shift = np.append(self.offset, 0.0)
        self.emf -= shift[self.p] - shift[self.q]
        self.p, self.q = self.place[self.p], np.append(self.place, GROUND)[self.q]
        inside = self.p != self.q
        self.p, self.q, self.g, self.emf = (a[inside] for a in (self.p, self.q, self.g, self.emf))
        self.grounded = self.q == GROUND

    def matrix(self) -> "csc_array":
        """The assembled symmetric M-matrix, CSC."""
        from scipy import sparse  # imported here: only commands that solve a mesh wait for SciPy

        count = len(self.live)
        p, q, g = (a[~self.grounded] for a in (self.p, self.q, self.g))
        diagonal = np.bincount(self.p, self.g, count) + np.bincount(q, g, count)
        rows = np.concatenate([p, q, np.arange(count)])
        columns = np.concatenate([q, p, np.arange(count)])
        return sparse.csc_array((np.concatenate([-g, -g, diagonal]), (rows, columns)), (count, count))

    def imbalance(self, z: Longs, emf: Longs, emf_doubt: Floats) -> tuple[Longs, Floats]:
        """Residual current at each node, in extended precision, and a bound of this sum's own rounding."""
        across = np.append(z, LONG(0))
        drop = across[self.p] - across[self.q]
        flow = self.g * (emf - drop)
        scale = self.g * (np.abs(emf) + np.abs(drop) + emf_doubt).astype(float)
        left, size = np.zeros(len(z) + 1, LONG), np.zeros(len(z) + 1)
        np.add.at(left, self.p, flow)
        np.add.at(left, self.q, -flow)
        np.add.at(size, self.p, scale)
        np.add.at(size, self.q, scale)
        edges = np.bincount(self.p, minlength=len(z)) + np.bincount(self.q[~self.grounded], minlength=len(z))
        return left[:-1], (edges + 4) * LONG_UNIT * 1.01 * size[:-1]

    def factor(self) -> "SuperLU":
        from scipy.sparse import linalg

        return linalg.splu(self.matrix(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})

    def plain(self) -> Floats:
        """Drops [2mn+4] by a single sparse LU solve, for timing."""
        pull = np.bincount(self.p, self.g * self.emf, len(self.live))
        inner = ~self.grounded
        pull -= np.bincount(self.q[inner], (self.g * self.emf)[inner], len(self.live))
        return self.expand(self.factor().solve(pull))

    def lift(self, upper: Bools) -> Callable[[Longs], Longs]:
        """A function: residual currents [nodes] -> the common shift of each layer that balances its sum.

        Solved on conductances without subtraction; it restores what LU loses when wires are near-ideal.
        """
        side = np.append(~upper, False).astype(int)
        ends = side[self.p], side[self.q]
        ground = np.bincount(ends[0][self.grounded], self.g[self.grounded], 2)
        between = self.g[~self.grounded & (ends[0] != ends[1])].sum()
        whole = between * ground.sum() + ground[0] * ground[1]

        def shift(left: Longs) -> Longs:
            sums = np.array([left[upper].sum(), left[~upper].sum()])
            return ((sums * ground[::-1] + between * sums.sum()) / whole)[side[:-1]]

        return shift

    def refined(self) -> tuple[Longs, Longs, Floats, float, float]:
        """Sparse LU, refined and certified: (drops [2mn+4], their deviations from each layer's level [2mn+4],
        bound [2mn+4], condition, residual).

        The residual is formed edge by edge in extended precision, on deviations from the level of a layer's
        rails, so near-ideal wires cost no digits. Since A^-1 >= 0 (M-matrix), any u with A u >= |residual|
        bounds the error; u is solved for, and A u is checked including its roundings.
        """
        try:
            factor = self.factor()
        except RuntimeError:  # singular: its sums have rounded away all but the largest conductances
            nothing = np.zeros(len(self.place), LONG)
            return nothing, nothing, np.full(len(nothing), np.inf), float(np.finfo(float).max), 1.0
        emf: Longs = self.emf.astype(LONG)
        none = np.zeros(len(self.g))
        upper = np.isin(self.live, [self.size - 4, self.size - 2]) | (self.live < self.mesh.m * self.mesh.n)
        shift = self.lift(upper)

        def refine(z: Longs, emf: Longs, doubt: Floats, wanted: Any, steps: int) -> Longs:
            size = np.inf
            for _ in range(steps):
                z = z + shift(wanted + self.imbalance(z, emf, doubt)[0])
                left = wanted + self.imbalance(z, emf, doubt)[0]
                if not np.abs(left).max() < size / 2:
                    break
                size = np.abs(left).max()
                z = z + factor.solve(left.astype(float))
            return z + shift(wanted + self.imbalance(z, emf, doubt)[0])

        z = refine(np.zeros(len(self.live), LONG), emf, none, LONG(0), 2)
        rails = z[self.place[-4:]]
        base = np.where(upper, (rails[0] + rails[2]) / 2, (rails[1] + rails[3]) / 2)
        level = np.append(base, LONG(0))
        step = level[self.p] - level[self.q]
        doubt = np.where(step != 0, np.abs(emf) + np.abs(level[self.p]) + np.abs(level[self.q]), 0)
        emf, doubt = emf - step, doubt.astype(float)
        z = refine(z - base, emf, doubt, LONG(0), 12)
        left, slack = self.imbalance(z, emf, doubt)
        wanted = np.abs(left).astype(float) * (1 + 1e-15) + slack + np.finfo(float).tiny
        u = 1.01 * refine(np.zeros(len(z), LONG), none.astype(LONG), none, wanted.astype(LONG), 4)
        bound = np.full(len(z), np.inf)
        if (u > 0).all():
            carried, slack = self.imbalance(u, none.astype(LONG), none)
            ratio = ((-carried).astype(float) - slack) / wanted
            if ratio.min() > 0.1:
                bound = u.astype(float) / min(ratio.min(), 1) * (1 + 1e-9)
        from scipy.sparse import linalg

        stiff = linalg.onenormest(linalg.LinearOperator(factor.shape, factor.solve, factor.solve))
        condition = float(stiff * abs(self.matrix()).sum(0).max())
        residual = float(np.abs(left).max() / max((self.g * np.abs(self.emf)).max(), np.finfo(float).tiny))
        return self.expand(z + base), z[self.place], bound[self.place], condition, residual

    def expand(self, z: NDArray[Any]) -> NDArray[Any]:
        return z[self.place] + self.offset


def grid_edges(m: int, n: int, rail: float) -> tuple[Ints, Ints, Floats]:
    """Edges (p, q, g) of both layers' resistors (g = 1) and of the four R0 (g = rail, q = ground)."""
    a = np.arange(m * n).reshape(m, n)
    b, e = a + m * n, 2 * m * n + np.arange(4)
    pairs = [(x[:, :-1], x[:, 1:]) for x in (a, b)] + [(x[:-1], x[1:]) for x in (a, b)]
    pairs += [(np.full(m, e[0]), a[:, 0]), (np.full(m, e[2]), a[:, -1])]
    pairs += [(np.full(n, e[1]), b[0]), (np.full(n, e[3]), b[-1])]
    p = np.concatenate([p.ravel() for p, _ in pairs] + [e])
    q = np.concatenate([q.ravel() for _, q in pairs] + [np.full(4, GROUND)])
    g = np.ones(len(p))
    g[-4:] = rail
    return p, q, g


def eliminate(circuit: Circuit) -> Floats:
    """Drops [2mn+4] by elimination without subtraction (after Grassmann, Taksar and Heyman), float64.

    It works on conductances and conductances to ground, never on an assembled diagonal, so each drop keeps
    its relative accuracy even in an ill-conditioned mesh. Dense: a reference for up to a few thousand nodes.
    Two right-hand sides, each >= 0: rails of A at 1 (gives B's rise), rails of B at 1 (gives A's drop).
    """
    mesh, cells = circuit.mesh, circuit.mesh.m * circuit.mesh.n
    order: Ints = np.arange(cells).reshape(mesh.m, mesh.n)
    order = (order.T if mesh.m < mesh.n else order).ravel()
    order = np.concatenate([np.stack([order, order + cells], 1).ravel(), 2 * cells + np.arange(4)])
    order = order[circuit.node[order] == order]
    size = len(order)
    rank = np.empty(size, int)
    rank[circuit.place[order]] = np.arange(size)
    W, ground, x = np.zeros((size, size)), np.zeros(size), np.zeros((size, 2))
    inner = ~circuit.grounded
    p, q = rank[circuit.p], rank[circuit.q[inner]]
    np.add.at(W, (p[inner], q), circuit.g[inner])
    W += W.T
    ground[p[~inner]] = circuit.g[~inner]
    x[[size - 4, size - 2], 0] = x[[size - 3, size - 1], 1] = circuit.g[~inner][0]
    band = int(np.abs(p[inner] - q)[(p[inner] < size - 4) & (q < size - 4)].max(initial=1))
    kept: list[tuple[Ints, Floats]] = []
    pivot = np.zeros(size)
    for s in range(size - 1):
        ahead = np.arange(s + 1, min(s + 1 + band, size - 4))
        ahead = np.concatenate([ahead, np.arange(max(s + 1, size - 4), size)])
        edge = W[s, ahead]
        used = edge > 0
        ahead, edge = ahead[used], edge[used]
        pivot[s] = edge.sum() + ground[s]
        share = edge / pivot[s]
        ground[ahead] += share * ground[s]
        x[ahead] += share[:, None] * x[s]
        block = np.outer(share, edge)
        np.fill_diagonal(block, 0)
        W[np.ix_(ahead, ahead)] += block
        kept.append((ahead, edge))
    x[-1] /= ground[-1]
    for s in range(size - 2, -1, -1):
        ahead, edge = kept[s]
        x[s] = (x[s] + edge @ x[ahead]) / pivot[s]
    values = x[rank[circuit.place]]
    upper = np.zeros(2 * cells + 4, bool)
    upper[:cells] = upper[2 * cells] = upper[2 * cells + 2] = True
    return np.where(upper, values[:, 1], -values[:, 0])
