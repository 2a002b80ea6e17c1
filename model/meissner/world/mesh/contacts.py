"""The fast exact solver: only the loaded taxels are unknown.

K contacts with resistances p draw the currents I. Each layer's drop at each contact is its Green's function
times I, so (diag(p) + Z + R0) I = 2V0, with Z = r (layer A + layer B) and R0 the same in every entry. With

    (diag(p) + Z) w = 1,   c = sum w:   I = 2V0 w / (1 + R0 c),   reported load = k c,   x = sum(x w) / c,

R0 drops out of the load and the position exactly (as published) and out of the conditioning.
"""

from dataclasses import dataclass

import numpy as np

from meissner.world.mesh.green import UNIT


@dataclass
class Currents:
    """Solved scenes with K contacts each; every array [scenes, K] unless said otherwise."""

    mesh: object
    row: np.ndarray
    column: np.ndarray
    resistance: np.ndarray  # ohms; 0 is a short
    w: np.ndarray  # siemens, current per volt between the rails behind R0

    def matrix(self):
        """diag(p) + Z [scenes, K, K] in ohms."""
        mesh = self.mesh
        Z = mesh.layer_a.between(self.row, self.column)
        Z += mesh.layer_b.between(self.column, self.row)
        Z *= mesh.r
        count = Z.shape[-1]
        Z.reshape(len(Z), -1)[:, :: count + 1] += self.resistance
        return Z

    def solve(self):
        M = self.matrix()
        scale = 1 / np.sqrt(M.reshape(len(M), -1)[:, :: M.shape[-1] + 1])
        M *= scale[:, :, None]
        M *= scale[:, None, :]
        self.w = scale * np.linalg.solve(M, scale[..., None])[..., 0]
        return self

    def certify(self):
        """Rigorous |w - exact| [scenes, K], condition [scenes], residual [scenes].

        With R near the inverse of the scaled matrix M and q >= |1 - RM|, |error| <= |R residual| / (1 - q),
        every norm taken with the rounding of Z, of the products and of R's use added.
        """
        mesh, M = self.mesh, self.matrix()
        count = M.shape[-1]
        scale = 1 / np.sqrt(np.diagonal(M, axis1=1, axis2=2))
        reach_a = np.sqrt(mesh.layer_a.reach()[self.column] * mesh.r)
        reach_b = np.sqrt(mesh.layer_b.reach()[self.row] * mesh.r)
        doubt = mesh.layer_a.rounding * reach_a[:, :, None] * reach_a[:, None, :]
        doubt += mesh.layer_b.rounding * reach_b[:, :, None] * reach_b[:, None, :]
        doubt += 4 * UNIT * np.abs(M)
        both = scale[:, :, None] * scale[:, None, :]
        M, doubt, v = M * both, doubt * both, self.w / scale
        doubt += 2 * UNIT * np.abs(M)
        R = np.linalg.inv(M)
        gamma = (count + 3) * UNIT
        q = np.abs(np.eye(count) - R @ M) + np.abs(R) @ (doubt + gamma * np.abs(M)) + gamma
        q = q.sum(-1).max(-1) * (1 + 1e-9)
        gap = scale - (M @ v[..., None])[..., 0]
        slack = (np.abs(M) * gamma + doubt) @ np.abs(v)[..., None]
        worst = np.abs(gap)[..., None] + slack + 2 * UNIT * scale[..., None]
        error = (np.abs(R) @ worst)[..., 0].max(-1) * (1 + 1e-9)
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.where(q < 1, error / (1 - q), np.inf)
        error = error[:, None] * scale + 2 * UNIT * np.abs(self.w)
        condition = np.abs(M).sum(-1).max(-1) * np.abs(R).sum(-1).max(-1)
        residual = (np.abs(gap) / (np.abs(M) @ np.abs(v)[..., None])[..., 0]).max(-1)
        return error, condition, residual
