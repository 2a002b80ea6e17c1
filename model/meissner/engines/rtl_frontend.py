"""The front end of arrays on the Verilated msn_am_demod: engine ``rtl``'s ``demodulate``."""

import ctypes
from functools import cache

import numpy as np

from meissner.engines import verilated


@cache
def _open_demod(form, samples_per_period):
    parameters = {"Form": form, "SamplesPerPeriod": samples_per_period}
    lib = ctypes.CDLL(str(verilated.library("msn_am_demod", "demod_driver.cpp", parameters)))
    lib.demod_run.restype = ctypes.c_int64
    size = ctypes.c_int32
    lib.demod_run.argtypes = [ctypes.c_void_p, ctypes.c_int64, size, size, size, size, ctypes.c_void_p]
    return lib


def demodulate(samples, carrier):
    """Amplitudes [...] of carriers [..., samples]; ``carrier``: meissner.engines.Carrier."""
    block = carrier.block
    lib = _open_demod(block.form, block.samples_per_period)
    samples = np.ascontiguousarray(samples, dtype=np.int32)
    amplitudes = np.zeros(samples.shape[:-1], dtype=np.int64)
    periods = carrier.periods & (1 << block.period_bits) - 1  # 0 stands for all of them
    clocks = lib.demod_run(
        samples.ctypes.data,
        amplitudes.size,
        carrier.samples,
        periods,
        carrier.skip,
        carrier.shift,
        amplitudes.ctypes.data,
    )
    if clocks < 0:
        raise RuntimeError("the demodulator did not give one amplitude per carrier")
    return amplitudes
