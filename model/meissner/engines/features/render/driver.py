"""msn_render, Verilated."""

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from meissner.arrays import Ints
from meissner.engines import verilated
from meissner.engines.features.render import TOP
from meissner.twins.actuate.render import RenderSettings

if TYPE_CHECKING:
    from meissner.engines.features.render.engines import Felt

CLOCKS = 400  # of a pin at most, beside its taxels


@verilated.cached
def _open(shape: tuple[int, int] | None, grid: tuple[int, int], amplitude_bits: int) -> ctypes.CDLL:
    parameters = {"PinRows": grid[0], "PinColumns": grid[1], "AmplitudeBits": amplitude_bits}
    parameters |= {"Image": 0} if shape is None else {"Rows": shape[0], "Columns": shape[1]}
    lib = ctypes.CDLL(str(verilated.library(TOP, "render_driver.cpp", parameters)))
    pointer, long, number = ctypes.c_void_p, ctypes.c_int64, ctypes.c_int32
    lib.render.restype = long
    lib.render.argtypes = [pointer, long, number, pointer, pointer, number, long, pointer]
    return lib


def render(felt: "Felt", grid: tuple[int, int], amplitude_bits: int, settings: RenderSettings) -> Ints:
    """Levels [frames, rows, columns] of what a sensor felt."""
    shape = None if felt.image is None else felt.image.shape[1:]
    taxels = 0 if felt.image is None else felt.image[0].size
    image = (
        np.zeros(1, np.uint16) if felt.image is None else np.ascontiguousarray(felt.image, dtype=np.uint16)
    )
    own = np.stack([felt.slip, felt.octant, felt.valid, felt.cop[:, 0], felt.cop[:, 1]], axis=1)
    own = np.ascontiguousarray(own, dtype=np.int32)
    levels = np.zeros((felt.size, *grid), np.uint8)
    given, pins = np.array([*settings.settings.values()], np.int64), grid[0] * grid[1]
    clocks = _open(shape, grid, amplitude_bits).render(
        *(image.ctypes.data, felt.size, taxels, own.ctypes.data, given.ctypes.data, pins),
        *(64 + 4 * taxels + pins * (CLOCKS + taxels), levels.ctypes.data),
    )
    verilated.check_room(clocks)
    if clocks < 0:
        raise RuntimeError("the core did not give a level for each pin")
    return levels.astype(np.int64)
