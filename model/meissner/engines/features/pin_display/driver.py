"""msn_pin_display, Verilated, with models of its drivers."""

import ctypes
from collections.abc import Hashable

import numpy as np

from meissner.arrays import Bools, Ints
from meissner.engines import verilated
from meissner.engines.features.pin_display import TOP
from meissner.twins.actuate.pin_display import PHASE_BITS, DisplaySettings, DisplaySize


@verilated.cached
def _open(*values: Hashable) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(verilated.library(TOP, "pin_display_driver.cpp", dict(values))))  # type: ignore[arg-type]
    pointer, long, number = ctypes.c_void_p, ctypes.c_int64, ctypes.c_int32
    lib.pin_display.restype = long
    lib.pin_display.argtypes = [pointer, long, *[number] * 4, pointer, long, *[pointer] * 3]
    return lib


def display(frames: Ints, size: DisplaySize, settings: DisplaySettings) -> tuple[Ints, Ints, Bools]:
    """Levels, start and limits of each period, as engines.Shown has them."""
    periods, pins = frames.shape
    sent = np.ascontiguousarray(frames, dtype=np.uint8)
    levels, limited = np.zeros((periods, pins), np.int32), np.zeros(periods, np.int32)
    starts = np.zeros(periods, np.int64)
    # A drive period, and what passes before the first.
    wait = 4 * size.lead + 8 * pins + 2 * ((1 << PHASE_BITS) // max(settings.increment, 1))
    given = np.array([*settings.settings.values()], np.int64)
    clocks = _open(*size.parameters.items()).pin_display(
        *(sent.ctypes.data, periods, pins, size.chains, size.chain_pins, size.chain_bits, given.ctypes.data),
        *(wait, levels.ctypes.data, starts.ctypes.data, limited.ctypes.data),
    )
    verilated.check_room(clocks)
    if clocks < 0:
        raise RuntimeError("the display did not show every frame")
    return levels.astype(np.int64), starts - starts[:1], limited > 0
