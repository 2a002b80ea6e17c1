"""The results of a solved mesh."""

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Bools, Floats, Ints, Values

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


class Group(Protocol):
    """Solved scenes: a class of meissner.physics.mesh.groups."""

    def certificate(self) -> "Certificate": ...

    def fields(self) -> Floats: ...

    def only(self, keep: Bools) -> "Group": ...


class Bound(NamedTuple):
    """Rigorous bounds of |computed - exact|: each electrode in volts, x, y without unit, load in newtons."""

    E1: Floats
    E2: Floats
    E3: Floats
    E4: Floats
    x: Floats
    y: Floats
    load: Floats


class Certificate(NamedTuple):
    """Per scene: the bound's seven rows, the condition number and the residual of the solved system."""

    bound: Floats  # [7, scenes]
    condition: Floats
    residual: Floats


class Solution:
    """Electrodes, position and load of one scene (numbers) or a batch (arrays of length scenes).

    No value is NaN or infinite.

    Attributes
    ----------
    E1, E2, E3, E4 : volts
    x, y, load, current
        -1..1, newtons and amperes as the four electrodes report them (eq. 16-20, 29), evaluated on the
        drops, not on the rounded voltages.
    valid : bool
        False where there is no measurement: then x, y, load are 0, and ``why`` is the reason in a sentence.
    solver : str
        Its name.
    bound, condition, residual
        Computed on request; the residual is relative, of the solved system.
    Va, Vb : volts, [m, n] or [scenes, m, n]
        Of the layers' nodes, computed on request.
    """

    def __init__(self, mesh: "Mesh", scenes: int, single: bool) -> None:
        self.mesh, self.scenes, self.single = mesh, scenes, single
        self._values = np.zeros((8, scenes))
        self._values[0:3:2] = mesh.V0
        self._values[1:4:2] = -mesh.V0
        self._valid = np.zeros(scenes, bool)
        self._why = np.full(scenes, "no taxel is loaded", object)
        self._solver = np.full(scenes, "none", object)
        self._groups: list[tuple[Ints, Group]] = []

    def put(self, where: Ints, values: Floats, solver: str, group: Group, why: str = "") -> None:
        """Store ``values`` [8, len(where)] (E1..E4, x, y, load, current) of the scenes ``where``."""
        if not math.isfinite(values.sum()):
            good: Bools = np.logical_and.reduce(np.isfinite(values))
            bad = where[~good]
            self.refuse(bad, solver, "the numbers exceed double precision")
            where, values, group = where[good], values[:, good], group.only(good)
        self._values[:, where] = values
        self._valid[where] = not why
        self._why[where] = why
        self._solver[where] = solver
        if len(where):
            self._groups.append((where, group))

    def refuse(self, where: Ints, solver: str, why: str) -> None:
        """Mark scenes as without a measurement; they keep the electrodes of an unloaded mesh."""
        self._why[where], self._solver[where] = why, solver

    def _out(self, array: NDArray[Any]) -> Any:
        if not self.single:
            return array
        return array[0].item() if array.ndim == 1 and array.dtype != object else array[0]

    E1 = property(lambda self: self._out(self._values[0]))
    E2 = property(lambda self: self._out(self._values[1]))
    E3 = property(lambda self: self._out(self._values[2]))
    E4 = property(lambda self: self._out(self._values[3]))
    x = property(lambda self: self._out(self._values[4]))
    y = property(lambda self: self._out(self._values[5]))
    load = property(lambda self: self._out(self._values[6]))
    current = property(lambda self: self._out(self._values[7]))
    valid = property(lambda self: self._out(self._valid))
    why = property(lambda self: self._out(self._why))
    solver = property(lambda self: self._out(self._solver))

    @cached_property
    def _certificate(self) -> Certificate:
        bound, condition, residual = np.zeros((7, self.scenes)), np.ones(self.scenes), np.zeros(self.scenes)
        for where, group in self._groups:
            part = group.certificate()
            bound[:, where], condition[where], residual[where] = part
        limit = np.array([2 * self.mesh.V0] * 4 + [2, 2, np.finfo(float).max])
        return Certificate(np.where(np.isfinite(bound), bound, limit[:, None]), condition, residual)

    @property
    def bound(self) -> Bound:
        return Bound(*(self._out(row) for row in self._certificate.bound))

    @property
    def condition(self) -> Values:
        return self._out(self._certificate.condition)

    @property
    def residual(self) -> Values:
        return self._out(self._certificate.residual)

    @cached_property
    def _fields(self) -> Floats:
        mesh = self.mesh
        fields = np.empty((2, self.scenes, mesh.m, mesh.n))
        fields[0], fields[1] = mesh.V0, -mesh.V0
        for where, group in self._groups:
            fields[:, where] = group.fields()
        return fields

    @property
    def Va(self) -> Floats:
        return self._out(self._fields[0])

    @property
    def Vb(self) -> Floats:
        return self._out(self._fields[1])
