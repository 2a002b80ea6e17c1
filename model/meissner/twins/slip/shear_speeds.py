"""Twin of rtl/slip/msn_shear_speeds.sv: shear speed of each channel, and the part that the reflex gets."""

from dataclasses import asdict, dataclass

import numpy as np

from meissner.twins.shared import fits, within
from meissner.twins.slip.shear_speed import ShearSettings, ShearSize, ShearSpeed

SIZE = ShearSize()  # the only size in the core
REPORT_SHIFT = 8  # from 2^-20 mm/s to the 2^-12 mm/s that the reflex takes
MAX_CHANNELS = 8
MAX_CYCLES = 255  # since a changed command; the count stops there


@dataclass(frozen=True)
class ShearConfig:
    """``shear``: ShearSettings for a batch of rubber; ``hold_cycles``: control cycles to hold the estimator
    after a changed command."""

    shear: ShearSettings
    hold_cycles: int = 0

    def __post_init__(self):
        self.shear.check(SIZE)
        fits(self, hold_cycles=(0, MAX_CYCLES))

    @property
    def settings(self):
        """{register of the group shear_speed: value}, with the estimator enabled."""
        return {"enable": 1} | asdict(self.shear) | {"hold_cycles": self.hold_cycles}


def report(speed, flags):
    """A window's speed for the reflex, in 2^-12 mm/s; None with any flag."""
    return None if flags else int(speed) >> REPORT_SHIFT


class ShearSpeeds:
    """``next`` takes complete frames, ``commanded`` the increments; ``last``: (speed, flags) by channel."""

    def __init__(self, config, channels):
        within(channels=(channels, 1, MAX_CHANNELS))
        self.config = config
        self.estimators = [ShearSpeed(config.shear, SIZE) for _ in range(channels)]
        self.last, self.windows, self.cycles = [(0, 1)] * channels, [0] * channels, MAX_CYCLES

    def commanded(self, increment):
        """A control cycle changed the command by ``increment``; None: the reflex has no command."""
        self.cycles = (
            MAX_CYCLES if increment is None else 0 if increment else min(MAX_CYCLES, self.cycles + 1)
        )

    def next(self, x, hold=None):
        """Windows (twins.slip.shear_speed) of each channel that ``x`` [channels, frames] completes.

        ``hold``: bool [frames], True where the normal force changes for another reason than the reflex.
        """
        x = np.asarray(x)
        hold = np.zeros(x.shape[1], bool) if hold is None else np.asarray(hold, bool)
        found = [
            one.windows(row, hold | (self.cycles < self.config.hold_cycles))
            for one, row in zip(self.estimators, x)
        ]
        for channel, windows in enumerate(found):
            self.windows[channel] += len(windows.flags)
            if len(windows.flags):
                self.last[channel] = int(windows.speed[-1]), int(windows.flags[-1])
        return found
