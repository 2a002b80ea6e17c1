"""What a slip detector is asked to do: one value object for twins, engines and the RTL's parameters."""

from dataclasses import dataclass, fields
from numbers import Integral

MAX_CHANNELS = 4096
SAMPLE_BITS = 17
TIMER_BITS = 16


def check_channels(channels):
    """Raise ValueError for a number of channels that the blocks of the slip path cannot be built for."""
    if not 1 <= channels <= MAX_CHANNELS:
        raise ValueError(f"channels = {channels} must lie in 1 .. {MAX_CHANNELS}")


@dataclass(frozen=True)
class SlipConfig:
    """Settings of the slip path. Times count details (2**level samples), thresholds count codes.

    ``window`` and ``hop`` are in samples; ``threshold`` and ``gross_threshold`` in codes of the
    unnormalised level-``level`` detail, peak to peak, compared with ``>``; ``contact_level`` and
    ``release_level`` in codes of the level-``level`` sum (2**level samples).
    """

    window: int = 64
    hop: int = 64
    level: int = 1
    threshold: int = 40
    gross_threshold: int = 80
    contact_level: int = 0
    release_level: int = 0
    contact_rises: bool = True  # pressing raises the code
    hold: int = 0
    refractory: int = 0
    blank: int = 0

    def __post_init__(self):
        for name in (field.name for field in fields(self)):
            if not isinstance(getattr(self, name), Integral):
                raise ValueError(f"{name} = {getattr(self, name)} must be an integer")
        if self.level not in (1, 2, 3):
            raise ValueError(f"level = {self.level} must be 1, 2 or 3")
        step = 1 << self.level
        if self.window < 4 or self.window & (self.window - 1):
            raise ValueError(f"window = {self.window} must be a power of two, 4 or more")
        if self.window < 2 * step:
            raise ValueError(f"window = {self.window} must be at least {2 * step} at level {self.level}")
        if not step <= self.hop <= self.window or self.hop % step:
            raise ValueError(
                f"hop = {self.hop} must be a multiple of {step} from {step} to the window, {self.window}"
            )
        for name in ("threshold", "gross_threshold", "hold", "refractory", "blank"):
            if getattr(self, name) < 0:
                raise ValueError(f"{name} = {getattr(self, name)} must not be negative")
        detail_bits = SAMPLE_BITS + self.level  # the registers of the RTL
        limits = dict.fromkeys(("threshold", "gross_threshold"), 1 << detail_bits)
        limits |= dict.fromkeys(("contact_level", "release_level"), 1 << (detail_bits - 1))
        limits |= dict.fromkeys(("hold", "refractory", "blank"), 1 << TIMER_BITS)
        for name, limit in limits.items():
            if getattr(self, name) >= limit:
                raise ValueError(f"{name} = {getattr(self, name)} must be below {limit}")
        for name in ("contact_level", "release_level"):
            if getattr(self, name) < -limits[name]:
                raise ValueError(f"{name} = {getattr(self, name)} must not be below -{limits[name]}")
