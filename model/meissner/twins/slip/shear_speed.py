"""Bit-exact twin of rtl/slip/msn_shear_speed.sv: shear speed from the level of conductive rubber."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meissner.twins.common.exp2 import bound as exp2_bound
from meissner.twins.common.exp2 import exp2
from meissner.twins.common.log2 import bound as log2_bound
from meissner.twins.common.log2 import log2
from meissner.twins.shared import Stream, fits

# Flags in the order of their bits. With any of them the speed is 0.
FLAGS = ("unsettled", "range", "small", "denominator", "clipped", "rising", "fast", "saturated")
UNSETTLED, RANGE, SMALL, DENOMINATOR, CLIPPED, RISING, FAST, SATURATED = (1 << bit for bit in range(8))
K1_FRACTION, EXPONENT_FRACTION = 16, 11


@dataclass(frozen=True)
class ShearSize:
    """The RTL's parameters. A level is a sum of 2^(window_log2 + settle_log2) samples: see ``unit``."""

    sample_bits: int = 17
    window_log2: int = 6
    settle_log2: int = 3
    table_bits: int = 6
    fraction_bits: int = 16
    speed_bits: int = 24
    speed_fraction: int = 20

    def __post_init__(self):
        fits(self, sample_bits=(4, 24), window_log2=(1, 12), settle_log2=(0, 8))
        fits(self, speed_bits=(8, 32), speed_fraction=(0, 32))
        log2(1, self.level_bits + 1, self.table_bits, self.fraction_bits)  # its checks

    @property
    def level_bits(self):
        return self.sample_bits + self.window_log2 + self.settle_log2

    @property
    def unit(self):
        """Units of a level per code."""
        return 1 << self.window_log2 + self.settle_log2


@dataclass(frozen=True)
class ShearSettings:
    """The RTL's registers, integers; ``of`` computes them from volts, millimetres and seconds."""

    k0: int
    k1: int
    exponent: int
    vi_min: int
    vi_max: int
    noise: int
    still: int
    full: int
    limit: int
    travel: int

    @classmethod
    def of(cls, codes_per_v, rate_hz, size=None, **given):
        """Registers for a converter of ``codes_per_v`` at ``rate_hz``; default for all not ``given``.

        ``k0, k1, n``: dV = (k0 + k1 Vi) v^n; ``vi_min``, ``vi_max``, ``noise``, ``still``, ``full``
        in volts, ``limit`` in mm/s, ``travel`` in mm.
        """
        size = size or ShearSize()
        named = {"k0": 1.55, "k1": -0.27, "n": 0.11, "vi_min": 2.0, "vi_max": 4.0, "noise": 0.1}
        named |= {"still": 0.0025, "full": 4.99, "limit": 3.0, "travel": 0.01}
        if unknown := given.keys() - named.keys():
            raise ValueError(f"no such setting: {', '.join(sorted(unknown))}")
        named |= given
        per_v, one = codes_per_v * size.unit, 1 << size.speed_fraction
        window_s = (1 << size.window_log2) / rate_hz
        settings = cls(
            **{name: round(named[name] * per_v) for name in ("k0", "vi_min", "vi_max", "noise", "still")},
            k1=round(named["k1"] * (1 << K1_FRACTION)),
            exponent=round((1 << EXPONENT_FRACTION) / named["n"]),
            full=round(named["full"] * codes_per_v),
            limit=round(named["limit"] * one),
            travel=round(named["travel"] / window_s * one),
        )
        settings.check(size)
        return settings

    def check(self, size):
        """Raise ValueError for a value that its register cannot hold."""
        bits = {"k0": size.level_bits, "noise": size.level_bits, "still": size.level_bits}
        bits |= {"exponent": 16, "limit": size.speed_bits, "travel": 32}
        signed = {"k1": 18, "vi_min": size.level_bits, "vi_max": size.level_bits, "full": size.sample_bits}
        limits = {name: (0, (1 << width) - 1) for name, width in bits.items()}
        limits |= {name: (-1 << width - 1, (1 << width - 1) - 1) for name, width in signed.items()}
        fits(self, **limits)


def denominator(vi, settings):
    """floor(k0 + k1 Vi), in units of a level: int64."""
    return settings.k0 + (settings.k1 * np.asarray(vi, dtype=np.int64) >> K1_FRACTION)


def speed(rise, k, settings, size=None):
    """v = (rise / k)^(1/n) of ``rise``, ``k`` >= 1, int64 with ``speed_fraction`` bits of fraction.

    v = exp2((log2(rise) - log2(k)) exponent / 2^11), the product rounded half up; it saturates at
    2^speed_bits - 1. For the error's bound see ``bound``.
    """
    size = size or ShearSize()
    bits = size.level_bits + 1, size.table_bits, size.fraction_bits
    y = log2(rise, *bits) - log2(k, *bits)
    z = (y * settings.exponent + (1 << EXPONENT_FRACTION - 1)) >> EXPONENT_FRACTION
    return exp2(z, size.table_bits, size.fraction_bits, size.speed_bits, size.speed_fraction)


def bound(exponent, size=None):
    """The largest relative error of the speed against (rise / k)^(1/n), before it is rounded to an lsb.

    It adds both logarithms' errors times 1/n = ``exponent`` / 2^11, the product's rounding and exp2's error.
    """
    size = size or ShearSize()
    below, above = log2_bound(size.level_bits + 1, size.table_bits, size.fraction_bits)
    power = (below + above) * exponent / (1 << EXPONENT_FRACTION) + 0.5 / (1 << size.fraction_bits)
    return 2.0**power * (1 + max(exp2_bound(size.table_bits, size.fraction_bits))) - 1


class Windows(NamedTuple):
    """A core's results for each window, int64 [windows]; ``vi``, ``rise``: levels, 0 with UNSETTLED."""

    speed: np.ndarray
    flags: np.ndarray
    vi: np.ndarray
    rise: np.ndarray


class ShearSpeed(Stream):
    """(speed, flags) of each window of 2^window_log2 samples, by the rules of docs/shear_speed.md.

    level = sum of the window's samples times 2^settle_log2
    Vi    = sum of 2^settle_log2 resting windows: within ``still`` of the reference, rise below ``noise``
    rise  = level - Vi;   v = (rise / (k0 + k1 Vi))^(1/n)
    """

    def __init__(self, settings, size=None):
        self.size = size or ShearSize()
        settings.check(self.size)
        self.settings = settings
        self.reset()

    def reset(self):
        """Forget the level, as after a restart."""
        self._x = np.zeros(0, dtype=np.int64)
        self._held = np.zeros(0, dtype=bool)
        self.seen = self.settled = False
        self.reference = self.vi = self.group = self.count = self.travel = 0

    def next(self, x, hold=None):
        """(speed, flags), int64, of the windows that the samples ``x`` complete; ``hold``: bool of each."""
        return self.windows(x, hold)[:2]

    def windows(self, x, hold=None):
        """The same with Vi and the rise, as ``Windows``."""
        x = np.asarray(x, dtype=np.int64)
        hold = np.zeros(x.shape, bool) if hold is None else np.asarray(hold, dtype=bool)
        self._x, self._held = np.concatenate([self._x, x]), np.concatenate([self._held, hold])
        count, length = len(self._x) >> self.size.window_log2, 1 << self.size.window_log2
        windows = self._x[: count * length].reshape(count, length)
        helds = self._held[: count * length].reshape(count, length).any(axis=1)
        clips = (windows >= self.settings.full).any(axis=1)
        self._x, self._held = self._x[count * length :], self._held[count * length :]
        found = [self._window(*each) for each in zip(windows.sum(axis=1).tolist(), helds, clips)]
        return Windows(*np.array(found, dtype=np.int64).reshape(-1, 4).T)

    def _window(self, total, held, clipped):
        with_, level = self.settings, total << self.size.settle_log2
        up = self.seen and level > self.reference + with_.still
        down = self.seen and level < self.reference - with_.still
        rise, k = level - self.vi, int(denominator(self.vi, with_))
        small = rise < with_.noise or rise <= 0
        settled = self.settled and not held and (clipped or not down)
        flags = CLIPPED * clipped
        if not settled:
            flags |= UNSETTLED
        elif not clipped:
            flags |= RANGE * (not with_.vi_min <= self.vi <= with_.vi_max)
            flags |= SMALL * small | DENOMINATOR * (k < 1)
        if flags:
            v = self.travel = 0
        else:
            v = int(speed(rise, k, with_, self.size))
            self.travel = 0 if up else min(self.travel + v, (1 << 32) - 1)
            flags |= RISING * (self.travel < with_.travel)
            flags |= FAST * (v > with_.limit) | SATURATED * (v == (1 << self.size.speed_bits) - 1)
        levels = (self.vi, rise) if settled else (0, 0)
        self._follow(total, held, clipped, up, down, settled, small)
        return 0 if flags else v, flags, *levels

    def _follow(self, total, held, clipped, up, down, settled, small):
        """Update the state after a window."""
        if held or clipped:
            self.count = 0
            if held:
                self.seen = self.settled = False
            return
        fresh = up or down or not self.seen
        count = 0 if fresh else self.count
        rests = not settled or small
        self.group = total + (self.group if count else 0)
        full = rests and count == (1 << self.size.settle_log2) - 1
        self.count = 0 if full or not rests else count + 1
        if full:
            self.vi = self.group
        if fresh or full:
            self.reference = total << self.size.settle_log2
        self.seen, self.settled = True, settled or full
