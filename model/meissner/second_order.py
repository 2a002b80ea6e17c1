"""A second-order term on the host for cells with a curved response, to correct the core's straight line.

    newtons = a + b·F + c·F^2      F: the core's force; 0 where F = 0

Least squares per cell, over the recording that the line itself was fitted to. The core keeps its line, its
centre of pressure and its load. A line through a curve that bends down crosses zero above rest, and the core
gives F = 0 below; no term on the host can restore what is cut off there: forces below about a.
"""

import numpy as np


def fit(forces, force_n):
    """(a, b, c) of each cell [rows, columns, 3]; 0, 0, 0 for a cell with F > 0 at fewer than three forces.

    ``forces``: F [frames, rows, columns] of a press recording; ``force_n``: its newtons, NaN where unknown
    (meissner.calibration.cell_forces).
    """
    forces, force_n = np.asarray(forces, float), np.broadcast_to(force_n, np.shape(forces))
    terms = np.zeros((*forces.shape[1:], 3))
    for cell in np.ndindex(forces.shape[1:]):
        f, newtons = forces[:, *cell], force_n[:, *cell]
        known = ~np.isnan(newtons) & (f > 0)
        if len(np.unique(newtons[known])) >= 3:
            largest = f[known].max()  # scaled to columns of similar size: c is small compared with a
            matrix = np.vander(f[known] / largest, 3, increasing=True)
            found = np.linalg.lstsq(matrix, newtons[known], rcond=None)[0]
            terms[cell] = found / largest ** np.arange(3)
    return terms


def newtons(forces, terms):
    """Newtons [..., rows, columns] of the core's forces F; never below 0."""
    forces = np.asarray(forces, float)
    a, b, c = np.moveaxis(terms, -1, 0)
    return np.where(forces > 0, np.maximum(a + (b + c * forces) * forces, 0.0), 0.0)
