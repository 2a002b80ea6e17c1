"""Recorded steps: plantar pressure over time, 63×33 taxels at 500 Hz, 10 subjects of 60 trials.

Pataky et al. (2008), doi 10.1016/j.jbiomech.2008.03.034. The arrays are in the PyPI package jiku-data, which
is read as data only: none of its code runs, so its dependencies are not installed. Counts and places are as
recorded: the heel is in the upper rows.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

DATASET, SUBJECTS, TRIALS = "SpeedPP2DS", 10, 60
ORIGINS = {
    "SUBJECTS": ("published", "Pataky et al. 2008: the data set", "which recordings there are"),
    "TRIALS": ("published", "Pataky et al. 2008: the data set", "which recordings there are"),
}


def step(subject: int, trial: int) -> NDArray[np.uint16]:
    """One step, uint16 [frames, 63, 33], from the frame before the first load to the frame after the last."""
    found = find_spec("jikudata")
    if found is None or not found.submodule_search_locations or find_spec("h5py") is None:
        raise ValueError(
            "the recorded steps need jiku-data and h5py: pip install 'meissner-touch[recordings]'"
        )
    import h5py

    folder = Path(found.submodule_search_locations[0]) / "datasets" / DATASET / "data_y"
    with h5py.File(folder / f"subj{subject:03}.h5", "r") as file:
        frames = np.moveaxis(file[f"img{trial:03}"][()], -1, 0)
    loaded = np.flatnonzero(frames.any(axis=(1, 2)))
    return np.ascontiguousarray(frames[max(loaded[0] - 1, 0) : loaded[-1] + 2])
