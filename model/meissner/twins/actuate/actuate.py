"""Twins of rtl/actuate/msn_actuate.sv: the hand's command, one per control cycle; msn_finger_health.sv: which
fingers have samples that can be trusted; msn_pwm.sv: a word as a pulse width."""

from dataclasses import dataclass, field

import numpy as np

from meissner.twins.actuate.grip import Grip, GripConfig
from meissner.twins.shared import within


def pwm(words, bits=16, divide=0):
    """The level of the pin in every clock, over one period for each of ``words``.

    A period is 2**bits - 1 steps of ``divide`` + 1 clocks; the pin is high in the first ``word`` steps, so
    0 is always low and 2**bits - 1 always high.
    """
    within(bits=(bits, 2, 16), divide=(divide, 0, (1 << 16) - 1))
    steps, levels = (1 << bits) - 1, []
    for word in words:
        within(word=(word, 0, steps))
        levels += [1] * (word * (divide + 1)) + [0] * ((steps - word) * (divide + 1))
    return levels


MOST = 255  # the count of consecutive samples saturates here


class FingerHealth:
    """A finger with ``rail`` consecutive samples at a rail (<= ``low`` or >= ``high``) is not healthy.

    ``rail`` = 0 disables the check. ``next`` continues where the last call ended; ``fingers`` may count the
    fingers of several hands side by side.
    """

    def __init__(self, fingers, low=0, high=4095, rail=8):
        within(rail=(rail, 0, MOST))
        self.low, self.high, self.rail = low, high, rail
        self.run = np.zeros(fingers, dtype=np.int64)

    def next(self, samples, lost=False):
        """Whether each finger was healthy from before ``samples`` [fingers, n] to their end: bool [fingers].

        ``lost``: the converter missed a frame in that time.
        """
        samples = np.asarray(samples)
        at_rail = (samples <= self.low) | (samples >= self.high)
        steps = np.arange(1, samples.shape[1] + 1)
        good = np.maximum.accumulate(np.where(at_rail, 0, steps), axis=1)  # last good one's place, 0: none
        runs = steps - good + np.where(good == 0, self.run[:, None], 0)
        longest = np.maximum(self.run, runs.max(axis=1, initial=0))
        if samples.shape[1]:
            self.run = np.minimum(runs[:, -1], MOST)
        well = np.full(len(self.run), not lost)
        return well & (longest < self.rail) if self.rail else well


@dataclass(frozen=True)
class ActuateConfig:
    """Settings of the reflex (``grip``), of msn_finger_health, and ``divide`` of msn_pwm."""

    grip: GripConfig = field(default_factory=GripConfig)
    low: int = 0
    high: int = 4095
    rail: int = 8
    divide: int = 0

    @property
    def settings(self):
        """{register of the group grip: value}, with the reflex enabled."""
        found = {"enable": 1} | self.grip.settings
        found |= {"low": self.low, "high": self.high, "rail": self.rail, "divide": self.divide}
        return found


class Actuate:
    """The stage for ``fingers`` fingers; ``start``: as in meissner.twins.actuate.grip.Grip."""

    def __init__(self, config=None, fingers=2, start=None):
        self.config = config or ActuateConfig()
        self.grip = Grip(self.config.grip, fingers, start)
        self.health = FingerHealth(fingers, self.config.low, self.config.high, self.config.rail)
        self.commands = self.tightenings = 0

    def next(self, samples, over, ends, lost=False, override=None, speeds=()):
        """The Command of a cycle with ``samples`` [fingers, n] and slip decisions ``over`` [fingers, m].

        ``ends`` [m]: whether a decision is the last of its window; ``speeds``: (place, finger, speed) in
        order, each reported before the decisions [:, place]; speed None: the speed is not known.
        """
        speeds = list(speeds)
        for place, end in enumerate(ends):
            while speeds and speeds[0][0] <= place:
                self.grip.report(*speeds.pop(0)[1:])
            for finger, row in enumerate(over):
                self.grip.decision(finger, bool(row[place]), bool(end))
        for _, finger, speed in speeds:
            self.grip.report(finger, speed)
        word = self.grip.cycle(self.health.next(samples, lost).tolist(), override)
        self.commands += word.valid
        self.tightenings += word.valid and word.increment > 0
        return word
