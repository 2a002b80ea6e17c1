"""The speed of shear through a core's registers: write a lot of rubber, read the result of the last window.

    write_lot(core.__setitem__, Rubber(k0_v=1.6, k1=-0.28, n=0.115), codes_per_v)
    for one in speeds(core): print(one.speed_mm_s, one.flags)

Registers serve better than packets here: a control loop needs the newest speed only, the reflex in the core
gets every one, and the packet formats stay unchanged. ``windows`` counts, so that a host detects missed ones.
"""

from collections.abc import Callable
from dataclasses import dataclass

from meissner.host.core import Core
from meissner.twins.slip.shear_speed import FLAGS, ShearSettings
from meissner.twins.slip.shear_speeds import MAX_CHANNELS, SIZE


@dataclass(frozen=True)
class Rubber:
    """A lot of rubber: dV = (k0_v + k1 Vi) v^n, as ``meissner fit-rubber`` prints it."""

    k0_v: float = 1.55
    k1: float = -0.27
    n: float = 0.11


@dataclass(frozen=True)
class Speed:
    """The result of a channel's last window. ``speed_mm_s``: None if any of ``flags`` is set."""

    speed_mm_s: float | None
    flags: tuple[str, ...]


@dataclass(frozen=True)
class Levels:
    """The levels behind a window's speed, in volts; ``windows``: since the estimator was enabled."""

    vi_v: float
    rise_v: float
    windows: int


def write_lot(write: Callable[[str, int], object], rubber: Rubber, codes_per_v: float) -> None:
    """Give the estimator another lot; it forgets the levels it has learned.

    Parameters
    ----------
    write : callable
        Takes a register's name and value, as ``core.__setitem__`` does.
    codes_per_v : float
        Of the converter.
    """
    found = ShearSettings.of(codes_per_v, 1.0, SIZE, k0=rubber.k0_v, k1=rubber.k1, n=rubber.n, travel=0.0)
    write("shear_speed.enable", 0)
    for name in ("k0", "k1", "exponent"):
        write(f"shear_speed.{name}", getattr(found, name))
    write("shear_speed.enable", 1)


def of_word(word: int) -> Speed:
    """The Speed in a word of the registers ``channel0`` .. ``channel7``."""
    flags = tuple(name for bit, name in enumerate(FLAGS) if word >> 24 + bit & 1)
    return Speed(None if flags else (word & 0xFFFFFF) / (1 << SIZE.speed_fraction), flags)


def speeds(core: Core) -> list[Speed]:
    """The Speed of each channel of a meissner.host.core.Core, each from a single window."""
    count = min(core.units.columns or 1, MAX_CHANNELS)
    return [of_word(core[f"shear_speed.channel{channel}"]) for channel in range(count)]


def levels(core: Core, channel: int, codes_per_v: float, tries: int = 8) -> Levels:
    """The Levels of a channel, all from one window.

    Raises
    ------
    OSError
        If a window ends during each attempt.
    """
    core["shear_speed.select"] = channel
    for _ in range(tries):
        before = core["shear_speed.windows"]
        vi, rise = core["shear_speed.vi"], core["shear_speed.rise"]
        if core["shear_speed.windows"] == before:
            per_v = codes_per_v * SIZE.unit
            return Levels(vi / per_v, rise / per_v, before)
    raise OSError("a window ended during each attempt: the line is too slow to read its levels")
