"""Bit-exact twin of rtl/actuate/msn_grip.sv: the grip reflex, a command a control cycle. See docs/grip.md.

wish   of a finger  = (step << n) + (speed_gain * speed >> SPEED_SHIFT) for each of its windows over the
                      threshold; n: its windows over in a row just before it, up to boost
wish   of the hand  = the largest (any) or the smallest (weakest) of the fingers that work
goal                = command + wish    some working finger had a window over the threshold
                      command - decay   every finger was heard since the last cycle and none was over
                      command           otherwise: in doubt the grip holds
command             = goal, within [minimum, maximum], at most `rate` from where it was
"""

from dataclasses import dataclass, fields
from numbers import Integral

COMMAND_BITS = 16
PERIOD_BITS = 24
TIMER_BITS = 16
SPEED_BITS = 16
GAIN_BITS = 16
BOOST_BITS = 3
SPEED_SHIFT = 8
MAX_FINGERS = 8
MIN_PERIOD = 16  # clocks; a shorter one acts as this

RULES = ("any", "weakest")
MODES = ("position", "force")

# Bits of a command's ``fault``.
SILENT, UNHEALTHY, LIMIT, SETTINGS, UNARMED = 1, 2, 4, 8, 16

TOP = (1 << COMMAND_BITS) - 1


@dataclass(frozen=True)
class GripConfig:
    """Settings of the reflex. ``step``, ``decay``, ``rate`` and the limits are in counts of the command.

    ``period``: clocks between cycles. ``rate``: the largest change in a cycle. ``watchdog``: a finger is
    silent from this many cycles in a row without a decision on. ``mode``: "position", the output word is the
    change of the command; "force", the command. ``immediate``: the first window over the threshold brings a
    period's cycle forward. ``boost``: how often the step doubles while windows over follow each other.
    """

    period: int = 1_000_000  # 10 ms at 100 MHz
    step: int = 256
    speed_gain: int = 0
    decay: int = 0
    minimum: int = 1024
    maximum: int = 60000
    rate: int = 2048
    watchdog: int = 20
    rule: str = "any"
    mode: str = "position"
    immediate: bool = False
    boost: int = 0

    def __post_init__(self):
        tops = dict.fromkeys(("step", "decay", "minimum", "maximum", "rate"), TOP)
        tops |= {"speed_gain": (1 << GAIN_BITS) - 1, "watchdog": (1 << TIMER_BITS) - 1}
        tops |= {"period": (1 << PERIOD_BITS) - 1, "boost": (1 << BOOST_BITS) - 1}
        lows = {"period": MIN_PERIOD, "watchdog": 1}
        for name, top in tops.items():
            value, low = getattr(self, name), lows.get(name, 0)
            if not isinstance(value, Integral) or isinstance(value, bool):
                raise ValueError(f"{name} = {value} must be an integer")
            if not low <= value <= top:
                raise ValueError(f"{name} = {value} must lie in {low} .. {top}")
        if self.minimum > self.maximum:
            raise ValueError(f"minimum = {self.minimum} must not be above maximum = {self.maximum}")
        for name, names in (("rule", RULES), ("mode", MODES)):
            if getattr(self, name) not in names:
                raise ValueError(f"{name} = {getattr(self, name)!r} must be one of {', '.join(names)}")
        if not isinstance(self.immediate, bool):
            raise ValueError(f"immediate = {self.immediate} must be true or false")

    @property
    def settings(self):
        """{name: value} of the block's ``cfg_`` inputs that it determines."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        found |= {"rule": RULES.index(self.rule), "mode": MODES.index(self.mode)}
        return {name: int(value) for name, value in found.items()}


@dataclass(frozen=True)
class Command:
    """What a cycle gives: ``increment`` since the last one, the ``command`` itself, the ``fault`` bits.

    ``valid``: False where no word leaves (mode "force", before the hand's present force was set after a
    reset). ``word``: what the output carries, the increment or the command by mode. ``faulty``: fingers that
    take no part.
    """

    increment: int
    command: int
    fault: int
    valid: bool = True
    word: int = 0
    faulty: tuple = ()


class Grip:
    """The reflex of ``fingers`` fingers. ``next`` is a cycle; ``decision``, ``report``, ``cycle`` its parts.

    Mode "position" begins at the minimum with an increment of 0. Mode "force" gives no word until the command
    was set by an override; ``start`` does it here: the command as if a host had set it.
    """

    def __init__(self, config=None, fingers=2, start=None):
        if not 1 <= fingers <= MAX_FINGERS:
            raise ValueError(f"fingers = {fingers} must lie in 1 .. {MAX_FINGERS}")
        self.config, self.fingers, self.start = config or GripConfig(), int(fingers), start
        if start is not None and not self.config.minimum <= start <= self.config.maximum:
            raise ValueError(f"start = {start} must lie in {self.config.minimum} .. {self.config.maximum}")
        self.reset()

    def reset(self):
        """All is forgotten: the hand stays where it is until the next command."""
        self.command, self.armed, self.fault = 0, None, UNARMED
        if self.start is not None:
            self.command, self.armed, self.fault = int(self.start), self.config.mode, 0
        self._speed_term = [0] * self.fingers
        self._quiet = [0] * self.fingers  # cycles in a row without a decision
        self._counted = [False] * self.fingers  # the window under way was over, and was counted
        self._streak = [0] * self.fingers  # windows over in a row before it
        self._clear()

    def _clear(self):
        self._wish = [0] * self.fingers
        self._over = [False] * self.fingers
        self._seen = [False] * self.fingers

    def report(self, finger, speed):
        """A shear speed of ``finger``, which stays until the next; None: the estimator flags it invalid."""
        if not 0 <= finger < self.fingers:
            return
        if speed is not None and not 0 <= speed < 1 << SPEED_BITS:
            raise ValueError(f"speed = {speed} must lie in 0 .. {(1 << SPEED_BITS) - 1}")
        term = 0 if speed is None else self.config.speed_gain * int(speed) >> SPEED_SHIFT
        self._speed_term[finger] = min(term, TOP)

    def decision(self, finger, over, end=True):
        """A decision about ``finger``; ``end``: its window's last. A window counts once, at its first."""
        if not 0 <= finger < self.fingers:
            return
        self._seen[finger] = True
        self._over[finger] |= bool(over)
        if over and not self._counted[finger]:
            step = self.config.step << min(self._streak[finger], self.config.boost)
            self._wish[finger] = min(self._wish[finger] + step + self._speed_term[finger], TOP)
        counted = self._counted[finger] or bool(over)
        if end:
            self._streak[finger] = self._streak[finger] + 1 if counted else 0
        self._counted[finger] = not end and counted

    def cycle(self, healthy=None, override=None):
        """The command of the cycle that ends now; ``override``: what a host asks instead of the reflex."""
        config = self.config
        healthy = [True] * self.fingers if healthy is None else healthy
        self._quiet = [
            0 if seen else min(n + 1, (1 << TIMER_BITS) - 1) for seen, n in zip(self._seen, self._quiet)
        ]
        silent = [n >= max(config.watchdog, 1) for n in self._quiet]
        faulty = [quiet or not well for quiet, well in zip(silent, healthy)]
        wishes = [wish for wish, bad in zip(self._wish, faulty) if not bad]
        wish = (max if config.rule == "any" else min)(wishes) if wishes else 0
        slips = any(over and not bad for over, bad in zip(self._over, faulty))
        falls = all(self._seen) and not any(self._over) and not any(faulty)
        self._clear()
        self._speed_term = [0 if bad else term for term, bad in zip(self._speed_term, faulty)]

        before, valid = self.command, True
        if self.armed == config.mode:
            goal = before
            if override is not None:
                goal = int(override)
            elif slips:
                goal = before + wish
            elif falls:
                goal = before - config.decay
            goal = min(max(goal, config.minimum), config.maximum)
            self.command = min(max(goal, before - config.rate), before + config.rate)
            increment = self.command - before
        else:  # the first since reset, or since the mode changed: whatever the hand does, it does not move
            increment = 0
            valid = config.mode == "position" or override is not None
            if valid:
                goal = config.minimum if config.mode == "position" else int(override)
                self.command = min(max(goal, config.minimum), config.maximum)
                self.armed = config.mode

        self.fault = SILENT * any(silent) | UNHEALTHY * (not all(healthy)) | UNARMED * (not valid)
        self.fault |= LIMIT * (valid and self.command >= config.maximum)
        self.fault |= SETTINGS * (config.minimum > config.maximum)
        word = increment if config.mode == "position" else self.command
        return Command(increment, self.command, self.fault, valid, word, tuple(faulty))

    def next(self, over, healthy=None, seen=None, speed=None, override=None):
        """A cycle's command. Of each finger: ``over``, its windows over the threshold since the last cycle;
        ``seen``, all its windows (None: one, or as many as over); ``healthy``; ``speed``, None if unknown.
        """
        seen = [max(int(count), 1) for count in over] if seen is None else seen
        speed = [None] * self.fingers if speed is None else speed
        healthy = [True] * self.fingers if healthy is None else healthy
        for name, values in (("over", over), ("seen", seen), ("healthy", healthy), ("speed", speed)):
            if len(values) != self.fingers:
                raise ValueError(f"{name} has {len(values)} values for {self.fingers} fingers")
        for finger, (count, windows, v) in enumerate(zip(over, seen, speed)):
            if not 0 <= count <= windows:
                raise ValueError(f"over = {count} must lie in 0 .. {windows}, the windows seen")
            self.report(finger, v)
            for n in range(int(windows)):
                self.decision(finger, n < count)
        return self.cycle(healthy, override)
