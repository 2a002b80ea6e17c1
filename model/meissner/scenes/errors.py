"""Errors of a centre of pressure, a load and an image compared with the true forces."""

import numpy as np


def errors(x, y, load, valid, true_load, true_x, true_y):
    """Position error (distance as a fraction of the range -1 to 1) and load error (fraction), per sample.

    NaN where nothing presses; the position's error also where the sensor gives no position.
    """
    pressed = np.asarray(true_load) > 0
    seen = pressed & valid
    position = np.where(seen, np.hypot(x - true_x, y - true_y) / 2, np.nan)
    safe = np.where(pressed, true_load, 1.0)
    return position, np.where(pressed, np.abs(load / safe - 1), np.nan)


def summarise(error):
    """Maximum and mean over the samples that have an error; None if none has."""
    error = error[~np.isnan(error)]
    if not len(error):
        return None
    return {"maximum": float(error.max()), "mean": float(error.mean())}


def percent(error):
    """A result of ``summarise`` in words."""
    if error is None:
        return "none"
    return f"{100 * error['mean']:.3g} % in the mean, {100 * error['maximum']:.3g} % at most"


def unevenness(image, dead=None):
    """Largest deviation of a cell from the mean of all, as a share of the mean; ``image`` [rows, columns]."""
    values = image if dead is None else image[~dead]
    return float(np.abs(values - values.mean()).max() / values.mean())
