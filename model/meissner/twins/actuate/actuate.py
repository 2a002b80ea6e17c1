"""Twin of rtl/actuate/msn_actuate.sv: what a core asks a hand to do, a control cycle at a time."""

from dataclasses import dataclass, field

from meissner.twins.actuate.finger_health import FingerHealth
from meissner.twins.actuate.grip import Grip, GripConfig


@dataclass(frozen=True)
class ActuateConfig:
    """Settings of the stage: the reflex', and those of msn_finger_health. ``divide``: of the pulses."""

    grip: GripConfig = field(default_factory=GripConfig)
    low: int = 0
    high: int = 4095
    rail: int = 8
    divide: int = 0

    @property
    def settings(self):
        """{register of the group grip: value}, the reflex enabled."""
        found = {"enable": 1} | self.grip.settings
        found |= {"low": self.low, "high": self.high, "rail": self.rail, "divide": self.divide}
        return found


class Actuate:
    """The stage of ``fingers`` fingers; ``start``: as of meissner.twins.actuate.grip.Grip."""

    def __init__(self, config=None, fingers=2, start=None):
        self.config = config or ActuateConfig()
        self.grip = Grip(self.config.grip, fingers, start)
        self.health = FingerHealth(fingers, self.config.low, self.config.high, self.config.rail)
        self.commands = self.tightenings = 0

    def next(self, samples, over, ends, lost=False, override=None, speeds=()):
        """The Command of the cycle that had ``samples`` [fingers, n] and decisions ``over`` [fingers, m].

        ``ends`` [m]: the decision is its window's last; ``speeds``: (place, finger, speed) in order, each
        reported before the decisions [:, place]; speed None: there is none.
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
