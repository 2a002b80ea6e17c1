"""The fast exact solver: only the loaded taxels are unknown.

K contacts with resistances p draw the currents I. Each layer's drop at each contact is its Green's function
times I, so (diag(p) + Z + R0) I = 2V0, with Z = r (layer A + layer B) and R0 the same in every entry. With

    (diag(p) + Z) w = 1,   c = sum w:   I = 2V0 w / (1 + R0 c),   reported load = k c,   x = sum(x w) / c,

R0 cancels in the report, as published, except for the tilt between two rails (``pull``, 1 for R0 >> r), and
never affects the conditioning.
"""

from typing import TYPE_CHECKING

import numpy as np

from meissner.arrays import Floats, Ints
from meissner.physics.mesh.green import UNIT

if TYPE_CHECKING:
    from meissner.physics.mesh.mesh import Mesh


KEPT = 8  # sets of places in the cache
LARGEST = 100_000  # entries of a cached matrix, at most


def drops(mesh: "Mesh", row: Ints, column: Ints) -> Floats:
    """Z / r [scenes, K, K]. For a mesh without tables the results of the last few sets of places are cached,
    since a touch whose force changes presses the same taxels."""
    if mesh.layer_a.tabulated and mesh.layer_b.tabulated:
        Z = mesh.layer_a.between(row, column)
        Z += mesh.layer_b.between(column, row)
        return Z
    places = row.shape, row.tobytes(), column.tobytes()
    Z = mesh.kept.pop(places, np.zeros(0))
    if not Z.size:
        if mesh.layer_a is mesh.layer_b:
            across, along = np.concatenate([row, column]), np.concatenate([column, row])
            both = mesh.layer_a.between(across, along)
            Z = both[: len(row)] + both[len(row) :]
        else:
            Z = mesh.layer_a.between(row, column) + mesh.layer_b.between(column, row)
        if len(mesh.kept) >= KEPT:
            del mesh.kept[next(iter(mesh.kept))]  # the least recently used
    if Z.size <= LARGEST:
        mesh.kept[places] = Z
    return Z


def matrix(mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> Floats:
    """diag(p) + Z [scenes, K, K] in ohms; all arguments [scenes, K], resistance in ohms, 0 for a short."""
    Z = mesh.r * drops(mesh, row, column)
    Z.reshape(len(Z), -1)[:, :: Z.shape[-1] + 1] += resistance
    return Z


def solve(mesh: "Mesh", row: Ints, column: Ints, resistance: Floats) -> Floats:
    """w [scenes, K] in siemens: each contact's current per volt between the rails behind R0."""
    M = matrix(mesh, row, column, resistance)
    scale = 1 / np.sqrt(M.reshape(len(M), -1)[:, :: M.shape[-1] + 1])
    M *= scale[:, :, None]
    M *= scale[:, None, :]
    return scale * np.linalg.solve(M, scale[..., None])[..., 0]


def certify(
    mesh: "Mesh", row: Ints, column: Ints, resistance: Floats, w: Floats
) -> tuple[Floats, Floats, Floats]:
    """Rigorous |w - exact| [scenes, K], condition [scenes], residual [scenes].

    With R near the inverse of the scaled matrix M and q >= |1 - RM|: |error| <= |R residual| / (1 - q). Every
    norm includes the rounding of Z, of the products and of the use of R.
    """
    M = matrix(mesh, row, column, resistance)
    count = M.shape[-1]
    scale = 1 / np.sqrt(np.diagonal(M, axis1=1, axis2=2))
    reach_a = np.sqrt(mesh.layer_a.terms()[column] * mesh.r)
    reach_b = np.sqrt(mesh.layer_b.terms()[row] * mesh.r)
    doubt = mesh.layer_a.rounding * reach_a[:, :, None] * reach_a[:, None, :]
    doubt += mesh.layer_b.rounding * reach_b[:, :, None] * reach_b[:, None, :]
    doubt += 4 * UNIT * np.abs(M)
    both = scale[:, :, None] * scale[:, None, :]
    M, doubt, v = M * both, doubt * both, w / scale
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
    error = error[:, None] * scale + 2 * UNIT * np.abs(w)
    condition = np.abs(M).sum(-1).max(-1) * np.abs(R).sum(-1).max(-1)
    residual = (np.abs(gap) / (np.abs(M) @ np.abs(v)[..., None])[..., 0]).max(-1)
    return error, condition, residual
