"""The roundness of a closed line of positions."""

import numpy as np


def circle(x, y):
    """The least-squares circle of points [n] and their deviation from it.

    ``centre_x``, ``centre_y``, ``radius``; ``deviation``: standard deviation of the points' radii;
    ``roundness``: the largest radius less the smallest, over the mean radius. Kasa's linear fit; ValueError
    unless at least three points are not on a line.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    terms = np.stack([x, y, np.ones_like(x)], axis=1)
    (a, b, _), _, rank, _ = np.linalg.lstsq(terms, x * x + y * y, rcond=1e-9)
    if rank < 3:
        raise ValueError("a circle needs three points that are not on a line")
    radii = np.hypot(x - a / 2, y - b / 2)
    return {
        "centre_x": float(a / 2),
        "centre_y": float(b / 2),
        "radius": float(radii.mean()),
        "deviation": float(radii.std()),
        "roundness": float(np.ptp(radii) / radii.mean()),
    }
