"""The centre of pressure on the Verilated msn_cop: ``cop`` of engine ``rtl``."""

import ctypes

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays, Ints
from meissner.engines import verilated
from meissner.engines.protocol import Waves
from meissner.twins.cop.cop import sum_bits
from meissner.twins.shared import index_width

WIDE = 16  # from this many columns on, eight lanes simulate faster than one
TRACE_CLK_KHZ = 100_000
TRACE_BEATS = 2000  # at the end: a VCD of a few megabytes


class _Results(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_void_p) for name in ("sum", "mx", "my", "x", "y", "valid"))


def lanes(columns: int) -> int:
    """Columns per beat of a build for this many columns."""
    return 8 if columns >= WIDE else 1


@verilated.cached
def _open(rows: int, columns: int, trace: bool = False) -> ctypes.CDLL:
    parameters = {"Rows": rows, "Columns": columns, "Lanes": lanes(columns)}
    lib = ctypes.CDLL(str(verilated.library("msn_cop", "cop_driver.cpp", parameters, trace)))
    lib.cop_run.restype = ctypes.c_int64
    size, wide = ctypes.c_int32, ctypes.c_int64
    lib.cop_run.argtypes = [
        *(ctypes.c_void_p, wide, size, size, wide, size, ctypes.c_void_p),
        *(ctypes.c_char_p, wide, wide),
    ]
    return lib


def _signed(values: NDArray[np.uint64], bits: int) -> Ints:
    """Two's complement of ``bits`` bits in uint64, sign-extended to int64."""
    spare = 64 - bits
    return values.view(np.int64) << spare >> spare


def cop(forces: NDArray[np.uint16], min_load: int = 1, waves: Waves = None) -> Arrays:
    """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns].

    ``waves``: path of a VCD file for the last TRACE_BEATS beats and the computation after them.
    """
    frames, rows, columns = forces.shape
    lib = _open(rows, columns, waves is not None)
    beats = frames * rows * -(-columns // lanes(columns))
    forces = np.ascontiguousarray(forces, dtype=np.uint16)
    wide, narrow = (np.zeros((count, frames), kind) for count, kind in ((3, np.uint64), (2, np.int16)))
    valid = np.zeros(frames, dtype=np.uint8)
    pointers = [row.ctypes.data for row in (*wide, *narrow, valid)]
    count = lib.cop_run(
        *(forces.ctypes.data, frames, rows, columns, min_load, sum_bits(rows, columns)),
        ctypes.byref(_Results(*pointers)),
        *(None if waves is None else str(waves).encode(), min(TRACE_BEATS, beats), TRACE_CLK_KHZ),
    )
    verilated.check_room(count)
    if count < 0:
        raise RuntimeError("the core did not give one result per frame")
    bits = sum_bits(rows, columns)
    mx_bits, my_bits = (bits + index_width(n) for n in (columns, rows))
    return {
        "sum": wide[0].view(np.int64),
        "mx": _signed(wide[1], mx_bits),
        "my": _signed(wide[2], my_bits),
        "x": narrow[0].astype(np.int32),
        "y": narrow[1].astype(np.int32),
        "valid": valid.astype(bool),
    }


def shown(load: Ints, shape: tuple[int, int]) -> slice:
    """Frames for ``waves``: as many as fit the VCD, the last being that with the largest ``load``."""
    rows, columns = shape
    count = max(1, TRACE_BEATS // (rows * -(-columns // lanes(columns))))
    last = int(np.argmax(load)) + 1
    return slice(max(0, last - count), last)
