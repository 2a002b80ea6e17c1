"""``forest_features(x, window)``: int64 [frames - window, window * channels] of codes ``x`` [channels,
frames].

A row for each frame from number ``window`` on: the differences of successive frames, the oldest first, each
of all channels.
"""

import numpy as np

from meissner.arrays import Ints
from meissner.twins.forest.forest_features import ForestFeatures
from meissner.twins.slip.config import SAMPLE_BITS


def fixed(x: Ints, window: int) -> Ints:
    """By the integer twin."""
    return ForestFeatures(len(x), window, SAMPLE_BITS).next(x)


def float_(x: Ints, window: int) -> Ints:
    """By strides over the differences, in floats, which hold integers of 18 bits exactly."""
    steps = np.diff(np.asarray(x, float).T, axis=0)
    if len(steps) < window:
        return np.empty((0, window * len(x)), np.int64)
    seen = np.lib.stride_tricks.sliding_window_view(steps, window, axis=0)
    return np.rint(seen.swapaxes(1, 2).reshape(len(seen), -1)).astype(np.int64)


def rtl(x: Ints, window: int) -> Ints:
    """By the Verilated module; only here its builder is loaded."""
    from meissner.engines.features.forest_features.driver import features

    return features(x, window)


def gate(x: Ints, window: int) -> Ints:
    """By its netlist."""
    from meissner.engines import verilated

    return verilated.of_gates(rtl)(x, window)


ENGINES = {"float": float_, "fixed": fixed, "rtl": rtl, "gate": gate}
