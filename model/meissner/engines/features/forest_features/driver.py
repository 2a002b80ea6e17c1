"""msn_forest_features, Verilated."""

import ctypes

import numpy as np

from meissner.arrays import Ints
from meissner.engines import verilated
from meissner.engines.features.forest_features import TOP
from meissner.twins.slip.config import SAMPLE_BITS


@verilated.cached
def _open(channels: int, window: int) -> ctypes.CDLL:
    parameters = {"Channels": channels, "Window": window, "SampleBits": SAMPLE_BITS}
    lib = ctypes.CDLL(str(verilated.library(TOP, "forest_features_driver.cpp", parameters)))
    pointer, long = ctypes.c_void_p, ctypes.c_int64
    lib.forest_features.restype = long
    lib.forest_features.argtypes = [pointer, long, ctypes.c_int32, pointer, long]
    return lib


def features(x: Ints, window: int) -> Ints:
    """Features of codes ``x`` [channels, frames]."""
    channels, frames = x.shape
    samples = np.ascontiguousarray(np.asarray(x).T, dtype=np.int32)
    found = np.zeros((max(0, frames - window), window * channels), np.int32)
    clocks = _open(channels, window).forest_features(
        samples.ctypes.data, frames, channels, found.ctypes.data, found.size
    )
    if clocks < 0:
        raise RuntimeError("the core did not give the features of each window")
    return found.astype(np.int64)
