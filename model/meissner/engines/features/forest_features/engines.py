"""``forest_features(x, window)``: int64 [frames - window, window * channels] of codes ``x`` [channels,
frames].

A row for each frame from number ``window`` on: the differences of successive frames, the oldest first, each
of all channels.
"""

import ctypes

import numpy as np

from meissner.arrays import Ints
from meissner.engines import verilated
from meissner.engines.features.forest_features import TOP
from meissner.inputs import SAMPLE_BITS
from meissner.twins.forest.forest_features import ForestFeatures


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


@verilated.cached
def _open(channels: int, window: int) -> ctypes.CDLL:
    parameters = {"Channels": channels, "Window": window, "SampleBits": SAMPLE_BITS}
    lib = ctypes.CDLL(str(verilated.library(TOP, "forest_features_driver.cpp", parameters)))
    pointer, long = ctypes.c_void_p, ctypes.c_int64
    lib.forest_features.restype = long
    lib.forest_features.argtypes = [pointer, long, ctypes.c_int32, pointer, long]
    return lib


def rtl(x: Ints, window: int) -> Ints:
    """By the Verilated module."""
    channels, frames = x.shape
    samples = np.ascontiguousarray(np.asarray(x).T, dtype=np.int32)
    found = np.zeros((max(0, frames - window), window * channels), np.int32)
    clocks = _open(channels, window).forest_features(
        samples.ctypes.data, frames, channels, found.ctypes.data, found.size
    )
    if clocks < 0:
        raise RuntimeError("the core did not give the features of each window")
    return found.astype(np.int64)


ENGINES = {"float": float_, "fixed": fixed, "rtl": rtl, "gate": verilated.of_gates(rtl)}
