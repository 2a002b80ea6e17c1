"""Removes the layers' own voltage drop from the reported load (and a small part of the position's error).

Contacts that share a load F see the rails minus the drop of their currents in r, so 1/load = 1/F + z/k with a
mean resistance z = r zeta that depends on the place of the load. With N = 2V0-E1-E3 and D = E1+E3-E2-E4 (both
measured), eq. 29 becomes

    F = Kf N / (D - N p),    p = p0 + p1 X + p2 Y + p3 X^2 + p4 XY + p5 Y^2,   X = x^2, Y = y^2:

one more product upstream of the division that eq. 29 needs in any case. p = 2 (r/R0) zeta depends on neither
k nor V0. For the position, x' = x + x (N/D) (a0 + a1 X + a2 Y), and y' in the same way.

Cost in hardware: 8 products for the load (X, Y, five by Horner, N p), 3 more for N/D (a division) and each
coordinate; eleven 18-bit registers in addition to Cx, Cy, Kf; see meissner.twins.cop.cop4_correct.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats
from meissner.twins.cop.cop4_correct import COEFFICIENT_BITS, CorrectionRegisters

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


PLACE_TERMS = 3


def load_terms(x: ArrayLike, y: ArrayLike) -> Floats:
    X, Y = np.square(x), np.square(y)
    return np.stack([np.ones_like(X), X, Y, X * X, X * Y, Y * Y], -1)


def place_terms(x: ArrayLike, y: ArrayLike) -> Floats:
    return load_terms(x, y)[..., :PLACE_TERMS]


@dataclass(frozen=True)
class Correction:
    """Coefficients p [6] and ax, ay [3 each], all without unit, and the mesh constant Kf (newtons)."""

    p: Floats
    ax: Floats
    ay: Floats
    Kf: float

    def apply(self, x: ArrayLike, y: ArrayLike, load: ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Corrected (x, y, load) of the sensor's x, y (no unit) and load (N), of any equal shapes.

        Where 1 - load p / Kf <= 1/16 the load cannot have been that large: the factor saturates at 16.
        """
        x, y, load = (np.asarray(a, float) for a in (x, y, load))
        ratio = load / self.Kf
        left = np.maximum(1 - ratio * (load_terms(x, y) @ self.p), 1 / 16)
        terms = place_terms(x, y) * ratio[..., None]
        return x + x * (terms @ self.ax), y + y * (terms @ self.ay), load / left


def fit(mesh: "Mesh", load: Floats) -> Correction:
    """The ``Correction`` fitted to scenes [scenes, m, n] in newtons that represent the expected touches.

    Least squares of the load's relative error and of the position's error, with the mesh's own solver.
    At least 30 loaded scenes; a coordinate that is 0 by definition (one row or column) gets no terms.
    """
    from meissner.physics.mesh_loads import true_centre

    solution = mesh.solve(load)
    keep = solution.valid if not solution.single else np.array([])
    if np.sum(keep) < 30:
        raise ValueError("fitting a correction needs at least 30 loaded scenes")
    total, true_x, true_y = (a[keep] for a in true_centre(load))
    x, y, reported = solution.x[keep], solution.y[keep], solution.load[keep]
    wanted = mesh.Kf * (1 / reported - 1 / total) * total
    p = np.linalg.lstsq(load_terms(x, y) * total[:, None], wanted, rcond=1e-10)[0]
    terms = place_terms(x, y) * (reported / mesh.Kf)[:, None]
    ax = np.linalg.lstsq(terms * x[:, None], true_x - x, rcond=1e-10)[0]
    ay = np.linalg.lstsq(terms * y[:, None], true_y - y, rcond=1e-10)[0]
    return Correction(p, ax, ay, mesh.Kf)


def registers(correction: Correction) -> CorrectionRegisters:
    """``CorrectionRegisters`` of a ``Correction``, at the largest common shift with every p in range."""
    largest = np.abs(correction.p).max()
    if not 0 < largest < 2 ** (COEFFICIENT_BITS - 1):
        raise ValueError("the correction's coefficients do not fit 18-bit registers")
    top = 2 ** (COEFFICIENT_BITS - 1) - 1
    shift = min(int(np.floor(np.log2(top / largest))), 30)
    return CorrectionRegisters(tuple(int(v) for v in np.round(correction.p * 2.0**shift)), shift)
