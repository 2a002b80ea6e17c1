"""``shear_speed(x, config, moving=None)``: speed and flags of each window of ``x`` [channels, samples].

``config``: ShearConfig; ``moving`` [samples]: the normal force changes. Returns two arrays [channels,
windows]: the speed in mm/s, 0 with any flag, and the flags of docs/shear_speed.md.
"""

import ctypes

import numpy as np

from meissner.arrays import Bools, Floats, Ints
from meissner.engines import verilated
from meissner.engines.features.shear_speed import TOP
from meissner.twins.link.registers import members, struct_bytes
from meissner.twins.slip import shear_speed as twin
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import SIZE, ShearConfig, ShearSpeeds

Found = tuple[Floats, Ints]  # speed, flags
WINDOW, REST = 1 << SIZE.window_log2, 1 << SIZE.settle_log2
ONE = 1 << SIZE.speed_fraction


def fixed(x: Ints, config: ShearConfig, moving: Bools | None = None) -> Found:
    """By the integer twin."""
    found = ShearSpeeds(config, len(x)).next(x, moving)
    return np.array([one.speed for one in found]) / ONE, np.array([one.flags for one in found])


def _float_channel(levels: Floats, high: Ints, held: Bools, given: ShearSettings) -> list[tuple[float, int]]:
    """The rules of docs/shear_speed.md on the means of windows, in codes and in floating point."""
    unit = SIZE.unit
    k0, noise, still = given.k0 / unit, given.noise / unit, given.still / unit
    k1, power = given.k1 / 65536, given.exponent / 2048
    least, most = given.vi_min / unit, given.vi_max / unit
    reference = vi = None
    resting: list[float] = []
    found: list[tuple[float, int]] = []
    travel = 0.0
    for level, top, hold in zip(levels, high, held):
        clipped = top >= given.full
        up = reference is not None and level > reference + still
        down = reference is not None and level < reference - still
        flags = twin.CLIPPED if clipped else 0
        if hold or vi is None or (down and not clipped):
            vi, v, flags = None, 0.0, flags | twin.UNSETTLED
        elif not clipped:
            rise, k = level - vi, k0 + k1 * vi
            flags |= (twin.RANGE if not least <= vi <= most else 0) | (twin.DENOMINATOR if k <= 0 else 0)
            flags |= twin.SMALL if rise < noise or rise <= 0 else 0
            v = 0.0 if flags else (rise / k) ** power
        small = vi is not None and level - vi < max(noise, 1e-9)
        if flags:
            travel = 0.0
        else:
            travel = 0.0 if up else travel + v
            flags |= (twin.RISING if travel < given.travel / ONE else 0) | (
                twin.FAST if v > given.limit / ONE else 0
            )
            flags |= twin.SATURATED if v >= 1 << SIZE.speed_bits - SIZE.speed_fraction else 0
        found.append((0.0 if flags else v, flags))
        if hold or clipped:
            resting = []
            reference = None if hold else reference
            continue
        if up or down or reference is None:
            reference, resting = level, []
        if vi is not None and not small:
            resting = []
            continue
        resting.append(level)
        if len(resting) == REST:
            vi, reference, resting = sum(resting) / REST, level, []
    return found


def float_(x: Ints, config: ShearConfig, moving: Bools | None = None) -> Found:
    """The same rules in textbook float, channel by channel."""
    count = x.shape[1] // WINDOW
    windows = np.asarray(x)[:, : count * WINDOW].reshape(len(x), count, WINDOW)
    moving = np.zeros(x.shape[1], bool) if moving is None else np.asarray(moving, bool)
    held = np.logical_or.reduce(moving[: count * WINDOW].reshape(count, WINDOW), axis=1)
    rows = [_float_channel(row.mean(axis=1), row.max(axis=1), held, config.shear) for row in windows]
    found = np.array(rows).reshape(len(x), count, 2)
    return found[..., 0], found[..., 1].astype(np.int64)


@verilated.cached
def _open(channels: int) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(verilated.library(TOP, "shear_driver.cpp", {"Channels": channels})))
    pointer, long = ctypes.c_void_p, ctypes.c_int64
    lib.shear_speeds.restype = long
    lib.shear_speeds.argtypes = [
        *(ctypes.c_char_p, long, pointer, long, ctypes.c_int32, pointer, pointer, long),
    ]
    return lib


def rtl(x: Ints, config: ShearConfig, moving: Bools | None = None) -> Found:
    """By the Verilated module."""
    channels, frames = x.shape
    values = {name: 0 for name in members("shear_speed")} | config.settings
    settings = struct_bytes("shear_speed", values, {})
    samples = np.ascontiguousarray(x.T, dtype=np.int32)
    moving = None if moving is None else np.ascontiguousarray(moving, dtype=np.uint8)
    words = np.zeros((frames // WINDOW + 1, channels), dtype=np.uint32)
    count = _open(channels).shear_speeds(
        *(settings, len(settings), samples.ctypes.data, frames, channels),
        *(None if moving is None else moving.ctypes.data, words.ctypes.data, frames // WINDOW),
    )
    verilated.check_room(count)
    if count != frames // WINDOW:
        raise RuntimeError(f"the core reported {count} windows instead of {frames // WINDOW}")
    words = words[:count].T
    return (words & 0xFFFFFF) / ONE, (words >> 24).astype(np.int64)


ENGINES = {"float": float_, "fixed": fixed, "rtl": rtl, "gate": verilated.of_gates(rtl)}
