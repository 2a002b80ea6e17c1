"""Many loaded taxels on a large mesh: the contacts' equations by conjugate gradients, layers by transforms.

(diag(p) + Z) w = 1 as in ``contacts``; Z is never formed. Scaling by 1/sqrt(p + Z_kk) keeps opens and shorts
at a common magnitude. No layer's grid has an eigenvalue above 8, so Z >= r/4: the error of a sum c.w is at
most |c| |residual| in the norm of 1 / (p + r/4), with any taxels shorted.
"""

from typing import TYPE_CHECKING

import numpy as np

from meissner.arrays import Floats, Ints
from meissner.physics.mesh.green import UNIT
from meissner.physics.mesh.groups import Contacts
from meissner.physics.mesh.solution import Certificate

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


STEPS = 2000
TARGET, SETTLED = 1e-13, 1e-8  # residual over right-hand side: to stop at, and to accept


class Iterated(Contacts):
    """One scene; the same interface as ``Exact``."""

    def __init__(self, mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> None:
        super().__init__(mesh, row, column, resistance)
        self.place = (row * mesh.n + column)[0]
        reach = mesh.r * (mesh.layer_a.reach()[column] + mesh.layer_b.reach()[row])[0]
        scale = 1 / np.sqrt(resistance[0] + reach)
        left = scale.copy()
        v, direction, power = np.zeros_like(left), left.copy(), left @ left
        first = power
        for step in range(1, STEPS + 1):
            image = scale * self.times(scale * direction)
            gain = power / (direction @ image)
            v += gain * direction
            left -= gain * image
            if step % 50 == 0:
                left = scale - scale * self.times(scale * v)
            previous, power = power, left @ left
            if power <= TARGET**2 * first:
                break
            direction = left + power / previous * direction
        self.steps = step
        self.finish((scale * v)[None])
        self.why = "" if power <= SETTLED**2 * first else "the iteration did not settle: force sparse LU"
        if self.why:
            self.values[4:7] = 0

    def times(self, w: Floats) -> Floats:
        """(diag(p) + Z) w, both [K]."""
        mesh = self.mesh
        current: Floats = np.zeros(mesh.m * mesh.n)
        current[self.place] = w
        current = current.reshape(mesh.m, mesh.n)
        drop = mesh.layer_a.field(current) + mesh.layer_b.field(current.T).T
        return self.resistance[0] * w + mesh.r * drop.reshape(-1)[self.place]

    def certificate(self) -> Certificate:
        """Rounding of the transforms by the usual model: 8 roundings a stage, relative to the 2-norm."""
        mesh, w, c = self.mesh, self.w[0], self.c
        least = self.resistance[0] + mesh.r / 4
        gap = np.abs(1 - self.times(w)) + 4 * UNIT * self.resistance[0] * np.abs(w)
        largest = sum(((size + 1) / np.pi) ** 2 * 1.3 + size for size in (mesh.m, mesh.n))
        stages = 8 * np.log2(16 * mesh.m * mesh.n)
        transforms = stages * UNIT * mesh.r * largest * np.sqrt(w @ w)
        norm = np.sqrt((gap**2 / least).sum()) + transforms / np.sqrt(least.min())
        rounding = (len(w) + 8) * UNIT
        c_error = norm * np.sqrt((1 / least).sum()) + rounding * c
        errors = []
        for lever, place, size in self.axes():
            away = lever[0] * (2 / max(size - 1, 1)) - place[0] * (size > 1)
            bound = norm * np.sqrt((away**2 / least).sum()) / np.maximum(c - c_error, 1e-300)
            errors.append(np.minimum(bound + rounding, 2.0) if size > 1 else 0 * c)
        condition = np.array([1 + mesh.r * 2 * largest / least.min()])
        return Certificate(self.spread(c_error, *errors), condition, np.array([gap.max()]))
