"""Settings of a slip detector: one value object for twins, engines and the RTL's parameters."""

from dataclasses import dataclass, fields
from numbers import Integral

from meissner.twins.shared import fits, one_of, within

MAX_CHANNELS = 4096
SAMPLE_BITS = 17
TIMER_BITS = 16


def check_channels(channels):
    """Raise ValueError for a number of channels with which the blocks of the slip path cannot be built."""
    within(channels=(channels, 1, MAX_CHANNELS))


def register_limits(config, detail_bits, timer_bits):
    """{setting: (lowest, highest)} of the registers of ``detail_bits`` and ``timer_bits`` bits."""
    limits = dict.fromkeys(("threshold", "gross_threshold"), (0, (1 << detail_bits) - 1))
    if config.keep_threshold is not None:
        limits["keep_threshold"] = limits["threshold"]
    level = 1 << detail_bits - 1
    limits |= dict.fromkeys(("contact_level", "release_level"), (-level, level - 1))
    return limits | dict.fromkeys(("hold", "refractory", "blank"), (0, (1 << timer_bits) - 1))


@dataclass(frozen=True)
class SlipConfig:
    """Settings of the slip path. Times are in details (2**level samples), thresholds in codes.

    ``window`` and ``hop`` are in samples; ``threshold``, ``keep_threshold`` and ``gross_threshold`` in codes
    of the unnormalised level-``level`` detail, peak to peak, compared with ``>``; ``contact_level`` and
    ``release_level`` in codes of the level-``level`` sum (2**level samples). A raised flag also stays up
    above ``keep_threshold``; None: only above ``threshold``.
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
    keep_threshold: int | None = None

    def __post_init__(self):
        given = [field.name for field in fields(self)]
        if self.keep_threshold is None:
            given.remove("keep_threshold")
        for name in given:
            if not isinstance(getattr(self, name), Integral):
                raise ValueError(f"{name} = {getattr(self, name)} must be an integer")
        one_of((1, 2, 3), level=self.level)
        step = 1 << self.level
        if self.window < 4 or self.window & (self.window - 1):
            raise ValueError(f"window = {self.window} must be a power of two, 4 or more")
        if self.window < 2 * step:
            raise ValueError(f"window = {self.window} must be at least {2 * step} at level {self.level}")
        if not step <= self.hop <= self.window or self.hop % step:
            raise ValueError(
                f"hop = {self.hop} must be a multiple of {step} from {step} to the window, {self.window}"
            )
        fits(self, **register_limits(self, SAMPLE_BITS + self.level, TIMER_BITS))

    @property
    def settings(self):
        """The registers of the group slip that these settings determine, {name: value}."""
        built = ("window", "hop", "level")  # parameters of the RTL
        found = {field.name: getattr(self, field.name) for field in fields(self) if field.name not in built}
        return {name: int(value) for name, value in found.items() if value is not None}

    @property
    def keeps_above(self):
        """The peak-to-peak above which a raised flag stays up: never more than ``threshold``."""
        return self.threshold if self.keep_threshold is None else min(self.keep_threshold, self.threshold)


# The settings that are on or off, with their defaults.
SWITCHES = {field.name: field.default for field in fields(SlipConfig) if field.type is bool}
