"""The resistor mesh under the sensor: loads in newtons to electrode voltages, three solvers, one call."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import Floats, Ints
from meissner.physics.mesh.circuit import Circuit
from meissner.physics.mesh.constants import cop_constants
from meissner.physics.mesh.green import Layer
from meissner.physics.mesh.groups import Constant, Exact, Nodal
from meissner.physics.mesh.solution import Solution
from meissner.physics.mesh.spread_out import Iterated
from meissner.physics.mesh.touched import contacts_of, touched

SOLVERS = ("auto", "lu", "fast", "constant")
BATCH = 2_000_000  # contact pairs solved in one step
DENSE = 2000  # contacts; the fast solver iterates beyond this many, and
MODES = 200_000_000  # beyond this many terms of Green's functions that are too large to tabulate
SPARSE = 20_000  # taxels up to which auto takes sparse LU for many contacts
NARROW = tuple(map(np.dtype, ("f4", "f2", "u2", "u1")))
ALL = np.zeros(1, int)
Frame = Callable[[int], Floats]  # a scene's loads [m, n]


class Mesh:
    """An m x n mesh, with the register constants ``Cx``, ``Cy``, ``Kf`` of ``cop_constants``.

    Rows i count from top to bottom, columns j from left to right; E1 left, E3 right, E2 top, E4 bottom.

    Parameters
    ----------
    r, R0 : float
        Ohms of the layers' resistors and of the rails'.
    V0 : float
        Volts: the rails are +-V0.
    k : float
        Newton ohms: a taxel loaded with F newtons is a resistor k / F (eq. 24).
    """

    def __init__(
        self, m: int, n: int, r: float, R0: float = 10e3, V0: float = 15.0, k: float = 4320.0
    ) -> None:
        for name, count in (("m", m), ("n", n)):
            if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
                raise ValueError(f"{name} = {count!r} must be a whole number of taxels, 1 or more")
        for name, value in (("r", r), ("R0", R0), ("V0", V0), ("k", k)):
            number = np.asarray(value)
            if number.shape or number.dtype.kind not in "iuf" or not (number > 0 and np.isfinite(number)):
                raise ValueError(f"{name} = {value!r} must be a positive, finite number")
        self.m, self.n = int(m), int(n)
        self.r, self.R0, self.V0, self.k = float(r), float(R0), float(V0), float(k)
        self.Cx, self.Cy, self.Kf = cop_constants(self.m, self.n, self.r, self.R0, self.V0, self.k)
        # Ohms: E1-E3 = lift[0] sum(lever I), E2-E4 = lift[1] sum(lever I), levers in taxels; eq. 16, 17.
        self.lift = (
            2 / (2 * self.m / self.r + (self.n + 1) / self.R0),
            2 / (2 * self.n / self.r + (self.m + 1) / self.R0),
        )
        rail = 2 * self.R0 / self.r
        self.layer_a = Layer(self.m, self.n, rail / (rail + (self.n + 1) / self.m))
        self.kept: dict[
            tuple[tuple[int, ...], bytes, bytes], Floats
        ] = {}  # cache of meissner.physics.mesh.contacts
        square = self.m == self.n
        pull = rail / (rail + (self.m + 1) / self.n)
        self.layer_b = self.layer_a if square else Layer(self.n, self.m, pull)

    def __repr__(self) -> str:
        return f"Mesh({self.m}, {self.n}, r={self.r:g}, R0={self.R0:g}, V0={self.V0:g}, k={self.k:g})"

    def solve(self, load: ArrayLike, solver: str = "auto", tolerance: float = 0.0) -> Solution:
        """The Solution under a load.

        lu        the (2mn+4) nodal equations, sparse LU, refined and certified: the reference
        fast      exact; only the loaded taxels are unknown
        constant  eq. 25: no drop in the layers, so position and load are ideal
        auto      fast or lu, whichever is cheaper for the number of loaded taxels; constant where its own
                  rigorous bounds stay below ``tolerance`` (fraction of the load, and of the position's range)

        Parameters
        ----------
        load : numbers [m, n] or [scenes, m, n]
            Newtons, 0 to 1e12, which shorts a taxel. Arrays of float32, float16, uint16 and uint8 are read
            without a conversion.

        Raises
        ------
        ValueError
            For another shape, NaN, loads below 0 or above 1e12 and an unknown solver.
        """
        load, single = self._read(load)
        flat = load.reshape(-1)
        index = touched(flat)
        force = flat[index].astype(float, copy=False)
        return self._contacts(
            index, force, len(load), single, lambda scene: load[scene].astype(float), solver, tolerance
        )

    def press(
        self,
        row: ArrayLike,
        column: ArrayLike,
        force: ArrayLike,
        solver: str = "auto",
        tolerance: float = 0.0,
    ) -> Solution:
        """``solve`` for contacts only.

        Only ``lu`` makes a frame of all taxels; otherwise the cost depends on the number of contacts alone.

        Parameters
        ----------
        row, column, force : [K] or [scenes, K]
            Places of the contacts and the newtons on them.

        Raises
        ------
        ValueError
            Also for places outside the mesh and a taxel named twice in a scene.
        """
        index, force, scenes, single = contacts_of(self.m, self.n, row, column, force)

        size = self.m * self.n

        def frame(scene: int) -> Floats:
            load, here = np.zeros(size), index // size == scene
            load[index[here] % size] = force[here]
            return load.reshape(self.m, self.n)

        return self._contacts(index, force, scenes, single, frame, solver, tolerance)

    def _contacts(
        self,
        index: Ints,
        force: Floats,
        scenes: int,
        single: bool,
        frame: Frame,
        solver: str,
        tolerance: float,
    ) -> Solution:
        """A Solution from taxels ``index``, counted through all scenes, and ``force``; ``frame(scene)``: the
        loads [m, n] of a scene."""
        if solver not in SOLVERS:
            raise ValueError(f"solver = {solver!r} must be one of {', '.join(SOLVERS)}")
        if not tolerance >= 0:
            raise ValueError(f"tolerance = {tolerance!r} must not be negative")
        solution = Solution(self, scenes, single)
        with np.errstate(over="ignore", under="ignore", divide="ignore", invalid="ignore"):
            resistance = self.k / force
            if index.size and not resistance.max() < np.inf:  # conductance below the range of a double: open
                held = np.isfinite(resistance)
                index, resistance = index[held], resistance[held]
            if single:
                if index.size:
                    self._solve(solution, ALL, frame, index[None], resistance[None], solver, tolerance)
                return solution
            scene, place = np.divmod(index, self.m * self.n)
            counts = np.bincount(scene, minlength=scenes)
            ends = np.cumsum(counts)
            for count in np.unique(counts[counts > 0]):
                step = max(1, BATCH // int(count) ** 2)
                every = np.flatnonzero(counts == count)
                for start in range(0, len(every), step):
                    where = every[start : start + step]
                    part = (ends[where] - count)[:, None] + np.arange(count)
                    self._solve(solution, where, frame, place[part], resistance[part], solver, tolerance)
        return solution

    def _solve(
        self,
        solution: Solution,
        where: Ints,
        frame: Frame,
        place: Ints,
        resistance: Floats,
        solver: str,
        tolerance: float,
    ) -> None:
        """Solve scenes ``where`` with the same number of contacts: [scenes, K] places and resistances."""
        row, column = np.divmod(place, self.n)
        if solver == "constant" or (solver == "auto" and tolerance > 0):
            defined = resistance.min(-1) > 0
            if solver == "constant" and not defined.all():
                solution.refuse(where[~defined], "constant", "a short has no load at constant potential")
            chosen = defined
            if defined.any():
                group = Constant(self, row[defined], column[defined], resistance[defined])
                if solver == "auto":
                    bound, near = group.certificate().bound, defined.copy()
                    near[defined] = (bound[6] <= tolerance * group.values[6]) & (
                        np.maximum(bound[4], bound[5]) <= 2 * tolerance
                    )
                    chosen = near
                    group = Constant(self, row[near], column[near], resistance[near])
                solution.put(where[chosen], group.values, "constant", group)
            if solver == "constant":
                return
            left = ~chosen
            where, row, column, resistance = where[left], row[left], column[left], resistance[left]
            if not len(where):
                return
        method = self._method(row.shape[1], solver)
        if method == "contacts":
            every = Exact(self, row, column, resistance)
            solution.put(where, every.values, "fast", every)
            return
        for scene in range(len(where)):
            one = slice(scene, scene + 1)
            if method == "lu":
                nodal = Nodal(self, *Circuit(self, frame(where[scene])).refined())
                if not nodal.why or solver == "lu":
                    solution.put(where[one], nodal.values, "lu", nodal, nodal.why)
                    continue
            method_of = Exact if row.shape[1] <= DENSE else Iterated
            found = method_of(self, row[one], column[one], resistance[one])
            solution.put(where[one], found.values, "fast", found, found.why)

    def _method(self, contacts: int, solver: str) -> str:
        """contacts (dense), transforms (iterated) or lu; times are fitted on one core of a 2020s machine."""
        if solver == "lu":
            return "lu"
        tabulated = self.layer_a.tabulated and self.layer_b.tabulated
        dense = contacts <= DENSE and (tabulated or contacts**2 * (self.m + self.n) <= MODES)
        if solver == "auto" and self.m * self.n <= SPARSE:
            sparse = 1e-7 * (self.m * self.n) ** 1.6 + 1e-3
            return "contacts" if dense and contacts**3 * 3.5e-11 <= sparse else "lu"
        return "contacts" if dense else "transforms"

    def _read(self, load: ArrayLike) -> tuple[NDArray[Any], bool]:
        try:
            load = np.asarray(load)
            if load.dtype not in NARROW:  # narrow types are not converted: large frames are read faster
                load = load.astype(float, copy=False)
        except (TypeError, ValueError):
            raise ValueError("load must be an array of newtons") from None
        if load.ndim not in (2, 3) or load.shape[-2:] != (self.m, self.n):
            shape = f"[{self.m}, {self.n}] or [scenes, {self.m}, {self.n}]"
            raise ValueError(f"load has shape {list(load.shape)}, must be {shape}")
        return (load[None], True) if load.ndim == 2 else (load, False)
