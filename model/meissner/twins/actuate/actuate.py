"""Twin of rtl/actuate/msn_actuate.sv: the hand's command, one per control cycle."""

from dataclasses import dataclass, field

from meissner.twins.actuate.finger_health import FingerHealth
from meissner.twins.actuate.grip import Grip, GripConfig


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
