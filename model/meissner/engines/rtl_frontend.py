"""The front end of arrays on the Verilated blocks: ``demodulate`` and ``calibrate`` of engine ``rtl``."""

import ctypes

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import Ints
from meissner.calibration import Calibration
from meissner.engines import Carrier, verilated


@verilated.cached
def _open_demod(form: int, samples_per_period: int) -> ctypes.CDLL:
    parameters = {"Form": form, "SamplesPerPeriod": samples_per_period}
    lib = ctypes.CDLL(str(verilated.library("msn_am_demod", "demod_driver.cpp", parameters)))
    lib.demod_run.restype = ctypes.c_int64
    long = ctypes.c_int64
    lib.demod_run.argtypes = [ctypes.c_void_p, *[long] * 5, *[ctypes.c_int32] * 2, ctypes.c_void_p]
    return lib


def demodulate(samples: ArrayLike, carrier: Carrier) -> Ints:
    """Amplitudes [...] of carriers [..., samples]; ``carrier``: meissner.engines.Carrier."""
    block = carrier.block
    lib = _open_demod(block.form, block.samples_per_period)
    samples = np.ascontiguousarray(samples, dtype=np.int32)
    amplitudes = np.zeros(samples.shape[:-1], dtype=np.int64)
    periods = carrier.periods & (1 << block.period_bits) - 1  # 0 stands for 2**period_bits
    clocks = lib.demod_run(
        samples.ctypes.data,
        amplitudes.size,
        carrier.samples,
        periods,
        carrier.skip,
        carrier.shift,
        *(block.period_bits, block.skip_bits),
        amplitudes.ctypes.data,
    )
    verilated.check_room(clocks)
    if clocks < 0:
        raise RuntimeError("the demodulator did not give one amplitude per carrier")
    return amplitudes


@verilated.cached
def _open_calibrate(rows: int, columns: int, gain_shift: int) -> ctypes.CDLL:
    parameters = {"Rows": rows, "Columns": columns, "GainShift": gain_shift}
    lib = ctypes.CDLL(str(verilated.library("msn_calibrate", "calibrate_driver.cpp", parameters)))
    lib.calibrate_run.restype = ctypes.c_int64
    pointer = ctypes.c_void_p
    lib.calibrate_run.argtypes = [pointer, ctypes.c_int64, *[ctypes.c_int32] * 2, *[pointer] * 4]
    return lib


def calibrate(codes: NDArray[np.int32], calibration: Calibration) -> NDArray[np.uint16]:
    """Forces [frames, rows, columns] of codes; ``calibration``: meissner.calibration.Calibration."""
    frames, rows, columns = codes.shape
    lib = _open_calibrate(rows, columns, calibration.gain_shift)
    codes = np.ascontiguousarray(codes, dtype=np.int32)
    words = (calibration.offset, calibration.gain)
    offset, gain = (np.ascontiguousarray(values, dtype=np.int64) for values in words)
    mask = np.ascontiguousarray(calibration.dead, dtype=np.uint8)
    forces = np.zeros(codes.shape, dtype=np.uint16)
    pointers = [values.ctypes.data for values in (offset, gain, mask, forces)]
    clocks = lib.calibrate_run(codes.ctypes.data, frames, rows * columns, columns, *pointers)
    verilated.check_room(clocks)
    if clocks < 0:
        raise RuntimeError("the calibration did not give one force per code")
    return forces
