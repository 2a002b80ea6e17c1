"""A four-wire mesh with parts missing: elements cut from the sheet, resistors cut, elements without rubber.

Cutting out an element removes its node in both layers and every resistor that ends there (net paper, VIII).
An element without rubber keeps its resistors but does not conduct between the layers (net paper, fig. 5 b): a
force on it is not sensed, and nothing else changes. Where nodes are missing, a coordinate is no longer
harmonic (eq. 6), so E1-E3 gives the first moment of h instead, the potential of the empty layer between E1 at
-1 and E3 at 1: a single pressed element is reported at h instead of x, apart from a common factor.
``harmonic`` gives h for both coordinates.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import LARGEST, Bools, Floats, Ints
from meissner.physics.mesh.circuit import GROUND, grid_edges

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


Wire = tuple[str, int, int] | tuple[str, int, int, str]


class Reading(NamedTuple):
    """What the four wires report, arrays [scenes]: volts, x, y by the constants of the uncut mesh, newtons.

    ``valid``: False where no current flows; x, y and load are 0 there.
    """

    E1: Floats
    E2: Floats
    E3: Floats
    E4: Floats
    x: Floats
    y: Floats
    load: Floats
    valid: Bools


class CutMesh:
    """``mesh`` without some of its parts.

    ``elements`` [m, n]: True where an element exists; ``rubber`` [m, n]: True where it has rubber; ``cut``:
    resistors that are cut. ("A" or "B", row, column) is the one to the right of that element in layer A or
    below it in layer B, with column -1 or row -1 for the one from E1 or E2. ("A", row, column, "across") is
    the one below it in layer A, ("B", row, column, "across") the one to the right of it in layer B. None:
    nothing is missing.
    """

    def __init__(
        self,
        mesh: "Mesh",
        elements: ArrayLike | None = None,
        rubber: ArrayLike | None = None,
        cut: Sequence[Wire] = (),
    ) -> None:
        m, n = mesh.m, mesh.n
        there = np.ones((m, n), bool) if elements is None else np.array(elements, bool)
        felt = np.ones((m, n), bool) if rubber is None else np.array(rubber, bool)
        for name, array in (("elements", there), ("rubber", felt)):
            if array.shape != (m, n):
                raise ValueError(f"{name} has shape {list(array.shape)}, must be [{m}, {n}]")
        self.mesh, self.elements, self.felt = mesh, there, felt
        p, q, g = grid_edges(m, n, mesh.r / mesh.R0)
        kept = np.concatenate([there.ravel(), there.ravel(), np.ones(5, bool)])  # the last one is ground
        keep = kept[p] & kept[q]
        ends = {(int(a), int(b)) for a, b in zip(np.minimum(p, q), np.maximum(p, q))}
        for wire in cut:
            pair = self._ends(*wire)
            if pair not in ends:
                raise ValueError(f"cut = {wire!r} names no resistor")
            keep &= ~((np.minimum(p, q) == pair[0]) & (np.maximum(p, q) == pair[1]))
        self.p, self.q, self.g = p[keep], q[keep], g[keep]

    def _ends(self, layer: str, row: int, column: int, way: str = "along") -> tuple[int, int]:
        m, n = self.mesh.m, self.mesh.n
        step = (0, 1) if (layer == "A") == (way == "along") else (1, 0)
        nodes = []
        for i, j in ((row, column), (row + step[0], column + step[1])):
            if layer == "A" and j in (-1, n):
                nodes.append(2 * m * n + (0 if j < 0 else 2))
            elif layer == "B" and i in (-1, m):
                nodes.append(2 * m * n + (1 if i < 0 else 3))
            else:
                nodes.append(i * n + j + (m * n if layer == "B" else 0))
        return min(nodes), max(nodes)

    def _solve(self, p: Ints, q: Ints, g: Floats, emf: Floats) -> Floats:
        """Drops [2mn+4] of sum g (z_p - z_q - emf) = 0; 0 at nodes without a path to ground."""
        from scipy import sparse  # imported here: only commands that solve a mesh wait for SciPy
        from scipy.sparse import csgraph, linalg

        size = 2 * self.mesh.m * self.mesh.n + 4
        q = np.where(q == GROUND, size, q)
        graph = sparse.csr_array((np.ones(len(p)), (p, q)), (size + 1, size + 1))
        islands = csgraph.connected_components(graph, directed=False)[1]
        live = np.flatnonzero(islands[:-1] == islands[-1])
        place = np.full(size + 1, -1)
        place[live] = np.arange(len(live))
        joined = place[p] >= 0
        p, q, g, emf = place[p[joined]], place[q[joined]], g[joined], emf[joined]
        inner, count = q >= 0, len(live)
        rows = np.concatenate([p, q[inner], p[inner], q[inner]])
        columns = np.concatenate([p, q[inner], q[inner], p[inner]])
        matrix = sparse.csc_array(
            (np.concatenate([g, g[inner], -g[inner], -g[inner]]), (rows, columns)), (count, count)
        )
        pull = np.bincount(p, g * emf, count) - np.bincount(q[inner], (g * emf)[inner], count)
        z = np.zeros(size)
        z[live] = linalg.splu(matrix).solve(pull)
        return z

    def solve(self, load: ArrayLike) -> Reading:
        """``Reading`` of loads [scenes, m, n] in newtons; a load without rubber or element is not sensed."""
        mesh, cells = self.mesh, self.mesh.m * self.mesh.n
        load = np.asarray(load, float)
        if (
            load.ndim != 3
            or load.shape[1:] != (mesh.m, mesh.n)
            or not ((load >= 0) & (load <= LARGEST)).all()
        ):
            raise ValueError(f"load must be [scenes, {mesh.m}, {mesh.n}] newtons, 0 to {LARGEST:g}")
        E = np.zeros((4, len(load)))
        for k, force in enumerate(load):
            pressed = np.flatnonzero((force > 0) & self.felt)
            p, q = np.concatenate([self.p, pressed]), np.concatenate([self.q, pressed + cells])
            g = np.concatenate([self.g, mesh.r * force.ravel()[pressed] / mesh.k])
            emf = np.concatenate([np.zeros(len(self.p)), np.ones(len(pressed))])
            E[:, k] = self._solve(p, q, g, emf)[-4:]
        # In units of 2V0: drops below +V0 at E1, E3; minus the rises above -V0 at E2, E4.
        drop1, rise2, drop3, rise4 = E * np.array([1, -1, 1, -1])[:, None]
        upper, lower = drop1 + drop3, rise2 + rise4
        # The current of an open layer is only rounding.
        valid = (upper > 1e-12) & (lower > 1e-12)
        safe = np.where(valid, upper, 1), np.where(valid, lower, 1)
        x = np.where(valid, mesh.Cx * (drop3 - drop1) / safe[0], 0)
        y = np.where(valid, mesh.Cy * (rise2 - rise4) / safe[1], 0)
        newtons = np.where(valid, mesh.Kf * upper / np.where(valid, 2 - upper - lower, 1), 0)
        rails = np.array([1, -1, 1, -1])[:, None] * mesh.V0
        E1, E2, E3, E4 = rails - 2 * mesh.V0 * E
        return Reading(E1, E2, E3, E4, x, y, newtons, valid)

    def harmonic(self) -> tuple[Floats, ...]:
        """(h_x, h_y) [m, n], NaN at cut elements; with R0 far above r a single pressed element is reported
        there, times one factor per axis."""
        m, n = self.mesh.m, self.mesh.n
        found = []
        for first, own in ((0, slice(0, m * n)), (1, slice(m * n, 2 * m * n))):
            rails = (2 * m * n + first, 2 * m * n + first + 2)
            held = np.full(2 * m * n + 4, np.nan)
            held[rails[0]], held[rails[1]] = (-1, 1) if first == 0 else (1, -1)
            value = self._held(held)[own].reshape(m, n)
            found.append(np.where(self.elements, value, np.nan))
        return tuple(found)

    def _held(self, held: Floats) -> Floats:
        """Potentials of a single layer with fixed electrodes; NaN at nodes connected to neither."""
        wires = self.q != GROUND
        p, q, g = self.p[wires], self.q[wires], self.g[wires]
        fixed = np.isfinite(held)
        ground = np.flatnonzero(fixed)
        # A wire to a fixed node is a wire to ground with that node's potential as its source.
        swap = fixed[p]
        p, q = np.where(swap, q, p), np.where(swap, p, q)
        free = ~fixed[p]
        p, q, g = p[free], q[free], g[free]
        emf = np.where(fixed[q], np.nan_to_num(held[q]), 0.0)
        z = self._solve(p, np.where(np.isin(q, ground), GROUND, q), g, emf)
        z[ground] = held[ground]
        return z
