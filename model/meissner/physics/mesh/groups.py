"""From a solver's unknowns to electrodes, position and load, with bounds: one class per solver.

Each has ``values`` [8, scenes], ``certificate()`` and ``fields()`` [2, scenes, m, n]; the scenes of a group
have the same number of contacts. Electrodes are derived from drops and rises, so small currents keep digits.
"""

import copy
from typing import TYPE_CHECKING, Self

import numpy as np

from meissner.arrays import Bools, Floats, Ints
from meissner.physics.mesh import contacts
from meissner.physics.mesh.circuit import Longs
from meissner.physics.mesh.green import UNIT
from meissner.physics.mesh.solution import Certificate

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


VOUCH = 1e-3  # sparse LU: a result with bounds beyond this fraction does not count as a measurement


def levers(mesh: "Mesh", row: Ints, column: Ints) -> tuple[Floats, Floats]:
    """Distances of contacts from the middle, in taxels: to the right, and upwards."""
    return column.astype(float) - (mesh.n - 1) / 2, (mesh.m - 1) / 2 - row.astype(float)


def assemble(mesh: "Mesh", c: Floats, right: Floats, up: Floats) -> Floats:
    """Values [8, scenes] from c = sum w and the levers' sums of w (siemens)."""
    V0 = mesh.V0
    rails = 1 + mesh.R0 * c
    per_volt, half = 2 * V0 / rails, V0 * mesh.R0 * c / rails
    lift_a, lift_b = mesh.lift
    tilt_a, tilt_b = per_volt * right * (lift_a / 2), per_volt * up * (lift_b / 2)
    out = np.empty((8, len(c)))
    out[0], out[2] = V0 - (half - tilt_a), V0 - (half + tilt_a)
    out[1], out[3] = half + tilt_b - V0, half - tilt_b - V0
    out[4] = right / c * (2 / (mesh.n - 1)) if mesh.n > 1 else 0
    out[5] = up / c * (2 / (mesh.m - 1)) if mesh.m > 1 else 0
    out[6], out[7] = mesh.k * c, per_volt * c
    return out


def spread(
    mesh: "Mesh", values: Floats, c: Floats, c_error: Floats, x_error: Floats, y_error: Floats
) -> Floats:
    """Bound rows [7, scenes] from bounds of c (siemens) and of x, y."""
    c_low = np.maximum(c - c_error, 0)
    current = values[7]
    current_error = 2 * mesh.V0 * c_error / ((1 + mesh.R0 * c) * (1 + mesh.R0 * c_low))
    rows = []
    lift_a, lift_b = mesh.lift
    for lift_, count, place, error in (
        (lift_a, mesh.n, values[4], x_error),
        (lift_b, mesh.m, values[5], y_error),
    ):
        moment = (count - 1) / 2 * (np.abs(place) * current_error + (current + current_error) * error)
        rows.append((mesh.R0 * current_error + lift_ * moment) / 2 + 16 * UNIT * mesh.V0)
    a, b = rows
    load = mesh.k * c_error * (1 + 1e-9) + 4 * UNIT * values[6]
    return np.stack([a, b, a, b, x_error, y_error, load])


class Contacts:
    """Scenes with K contacts each: places and resistances (ohms) [scenes, K], then ``w`` (siemens)."""

    why = ""

    def __init__(self, mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> None:
        self.mesh, self.row, self.column, self.resistance = mesh, row, column, resistance
        self.right, self.up = levers(mesh, row, column)

    def finish(self, w: Floats) -> None:
        self.w, self.c = w, w.sum(-1)
        self.values = assemble(self.mesh, self.c, (w * self.right).sum(-1), (w * self.up).sum(-1))

    def only(self, keep: Bools) -> Self:
        """The same group with some of its scenes."""
        group = copy.copy(self)
        for name in ("row", "column", "resistance", "right", "up", "w", "c"):
            setattr(group, name, getattr(self, name)[keep])
        group.values = self.values[:, keep]
        return group

    def axes(self) -> tuple[tuple[Floats, Floats, int], tuple[Floats, Floats, int]]:
        return (self.right, self.values[4], self.mesh.n), (self.up, self.values[5], self.mesh.m)

    def spread(self, c_error: Floats, x_error: Floats, y_error: Floats) -> Floats:
        return spread(self.mesh, self.values, self.c, c_error, x_error, y_error)

    def fields(self) -> Floats:
        mesh = self.mesh
        current: Floats = np.zeros((len(self.c), mesh.m * mesh.n))
        scale = 2 * mesh.V0 / (1 + mesh.R0 * self.c)
        np.put_along_axis(current, self.row * mesh.n + self.column, self.w * scale[:, None], 1)
        current = current.reshape(-1, mesh.m, mesh.n)
        half = mesh.R0 / 2 * self.values[7][:, None, None]
        drop = mesh.r * mesh.layer_a.field(current) + half
        rise = mesh.r * np.swapaxes(mesh.layer_b.field(np.swapaxes(current, 1, 2)), 1, 2) + half
        return np.stack([mesh.V0 - drop, rise - mesh.V0])


class Exact(Contacts):
    """The fast solver, dense in the contacts."""

    def __init__(self, mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> None:
        super().__init__(mesh, row, column, resistance)
        self.finish(contacts.solve(mesh, row, column, resistance))

    def certificate(self) -> Certificate:
        mesh, c = self.mesh, self.c
        error, condition, residual = contacts.certify(mesh, self.row, self.column, self.resistance, self.w)
        count = error.shape[-1]
        c_error = error.sum(-1) + count * UNIT * c
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.where(c > c_error, c - c_error, 0)
            errors = []
            for lever, place, size in (
                (self.right, self.values[4], mesh.n),
                (self.up, self.values[5], mesh.m),
            ):
                away = np.abs(lever * (2 / max(size - 1, 1)) - place[:, None] * (size > 1))
                bound = (away * error).sum(-1) / low + (2 * count + 8) * UNIT
                errors.append(np.where(low > 0, np.minimum(bound, 2.0), 2.0) if size > 1 else 0 * c)
        return Certificate(self.spread(c_error, *errors), condition, residual)


class Constant(Contacts):
    """Eq. 25: each layer at one potential, so every contact sees the same voltage; undefined for shorts."""

    def __init__(self, mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> None:
        super().__init__(mesh, row, column, resistance)
        self.finish(1 / resistance)

    def certificate(self) -> Certificate:
        """Bounds against the full mesh, where these currents need q = w'Zw more power: c - cq/(c+q) <= exact
        c <= c (Thomson's principle); a moment about the centre errs by at most the energy norms' product."""
        mesh, w, c = self.mesh, self.w, self.c
        reach = mesh.r * (mesh.layer_a.reach()[self.column] + mesh.layer_b.reach()[self.row])
        root = (w * np.sqrt(reach)).sum(-1)
        c_error = c * root**2 / (c + root**2)
        gap = np.sqrt((w * reach).sum(-1)) * root
        errors = []
        for lever, place, size in self.axes():
            away = lever * (2 / max(size - 1, 1)) - place[:, None] * (size > 1)
            bound = np.sqrt((w * away**2).sum(-1)) * gap * (c + root**2) / c**2
            errors.append(np.minimum(bound + 64 * UNIT, 1 + np.abs(place)) if size > 1 else 0 * c)
        residual = (np.sqrt(reach) * root[:, None]).max(-1)
        c_error = c_error * (1 + 1e-9) + (w.shape[-1] + 4) * UNIT * c
        return Certificate(self.spread(c_error, *errors), np.ones(len(c)), residual)

    def fields(self) -> Floats:
        half = self.mesh.R0 / 2 * self.values[7][:, None, None] + np.zeros((1, self.mesh.m, self.mesh.n))
        return np.stack([self.mesh.V0 - half, half - self.mesh.V0])


class Nodal:
    """One scene by the (2mn+4) nodal equations; ``z`` and ``away`` as ``Circuit.refined`` gives them."""

    def __init__(
        self, mesh: "Mesh", z: Longs, away: Longs, bound: Floats, condition: float, residual: float
    ) -> None:
        self.mesh, self.z, self.numbers = mesh, z, (condition, residual)
        drop1, rise2, drop3, rise4 = z[-4:] * np.array([1, -1, 1, -1])
        top, low, drops = drop1 + drop3, rise2 + rise4, 2 * mesh.V0 * z[-4:]
        left = 2 - top - low
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y = mesh.Cx * (away[-2] - away[-4]) / top, mesh.Cy * (away[-1] - away[-3]) / low
            load = mesh.Kf * top / left
            current = top * 2 * mesh.V0 / mesh.R0
            rails = np.array([1, -1, 1, -1]) * mesh.V0
            self.values = np.array([*(rails - drops), x, y, load, current], float)[:, None]
            b = bound[-4:]
            sure = float(top) > b[0] + b[2] and float(low) > b[1] + b[3] and float(left) > b.sum()
            x_error = (mesh.Cx + abs(x)) * (b[0] + b[2]) / (top - b[0] - b[2])
            y_error = (mesh.Cy + abs(y)) * (b[1] + b[3]) / (low - b[1] - b[3])
            load_error = (mesh.Kf * (b[0] + b[2]) + load * b.sum()) / (left - b.sum())
            volts = 2 * mesh.V0 * b + 4 * UNIT * mesh.V0
            slack = 8 * UNIT * np.array([abs(x), abs(y), load])
            errors = np.array([*volts, x_error, y_error, load_error], float)
            errors[4:] += slack.astype(float)
            if not sure:
                errors[4:] = np.inf
        self.bound = errors[:, None]
        sure = sure and load_error <= VOUCH * load and max(x_error, y_error) <= 2 * VOUCH
        self.why = "" if sure else "sparse LU cannot vouch for three digits here: use the fast solver"
        if not sure:
            self.values[4:7] = 0

    def only(self, keep: Bools) -> Self:
        return self

    def certificate(self) -> Certificate:
        return Certificate(self.bound, *(np.array([number]) for number in self.numbers))

    def fields(self) -> Floats:
        mesh = self.mesh
        volts = 2 * mesh.V0 * self.z[:-4].astype(float).reshape(2, 1, mesh.m, mesh.n)
        return np.array([mesh.V0, -mesh.V0])[:, None, None, None] - volts
