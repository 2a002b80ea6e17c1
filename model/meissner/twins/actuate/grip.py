"""Bit-exact twin of rtl/actuate/msn_grip.sv: the grip reflex, one command per control cycle (docs/grip.md).

wish   of a finger  = (step << n) + (speed_gain * speed >> SPEED_SHIFT) for each of its windows over the
                      threshold; n: the windows over just before it without a break, at most boost
wish   of the hand  = the largest (any) or the smallest (weakest) wish of the working fingers
goal                = command + wish    a working finger had a window over the threshold
                      command - decay   every finger had a decision since the last cycle, none was over
                      command           otherwise: in doubt the grip holds
command             = goal limited to [minimum, maximum] and to a change of at most `rate`
"""

from dataclasses import dataclass, fields
from numbers import Integral

from meissner.twins.shared import fits, one_of, within

COMMAND_BITS = 16
PERIOD_BITS = 24
TIMER_BITS = 16
SPEED_BITS = 16
GAIN_BITS = 16
BOOST_BITS = 3
SPEED_SHIFT = 8
MAX_FINGERS = 8
MIN_PERIOD = 16  # clocks; the RTL takes a shorter period as this

RULES = ("any", "weakest")
MODES = ("position", "force")

# Bits of a command's ``fault``.
SILENT, UNHEALTHY, LIMIT, SETTINGS, UNARMED = 1, 2, 4, 8, 16

TOP = (1 << COMMAND_BITS) - 1


@dataclass(frozen=True)
class GripConfig:
    """Settings of the reflex. ``step``, ``decay``, ``rate`` and the limits are in counts of the command.

    ``period``: clocks between cycles. ``rate``: the largest change per cycle. ``watchdog``: consecutive
    cycles without a decision after which a finger is silent. ``mode``: the output word is the change of the
    command ("position") or the command ("force"). ``immediate``: the first window over the threshold starts
    its period's cycle early. ``boost``: how many times the step doubles over consecutive windows over.
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
        limits = dict.fromkeys(("step", "decay", "minimum", "maximum", "rate"), (0, TOP))
        limits |= {"speed_gain": (0, (1 << GAIN_BITS) - 1), "watchdog": (1, (1 << TIMER_BITS) - 1)}
        limits |= {"period": (MIN_PERIOD, (1 << PERIOD_BITS) - 1), "boost": (0, (1 << BOOST_BITS) - 1)}
        for name in limits:
            value = getattr(self, name)
            if not isinstance(value, Integral) or isinstance(value, bool):
                raise ValueError(f"{name} = {value} must be an integer")
        fits(self, **limits)
        if self.minimum > self.maximum:
            raise ValueError(f"minimum = {self.minimum} must not be above maximum = {self.maximum}")
        one_of(RULES, rule=self.rule)
        one_of(MODES, mode=self.mode)
        if not isinstance(self.immediate, bool):
            raise ValueError(f"immediate = {self.immediate} must be true or false")

    @property
    def settings(self):
        """{name: value} of the block's ``cfg_`` inputs that these settings determine."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        found |= {"rule": RULES.index(self.rule), "mode": MODES.index(self.mode)}
        return {name: int(value) for name, value in found.items()}


@dataclass(frozen=True)
class Command:
    """The result of a cycle: the ``command``, its ``increment`` since the last one and the ``fault`` bits.

    ``valid``: False if no word is sent (mode "force", after a reset, until the hand's present force is set).
    ``word``: the output word, the increment or the command according to the mode. ``faulty``: fingers that
    the reflex ignores.
    """

    increment: int
    command: int
    fault: int
    valid: bool = True
    word: int = 0
    faulty: tuple = ()


class Grip:
    """The reflex of ``fingers`` fingers. ``next`` is a cycle, made of ``decision``, ``report``, ``cycle``.

    Mode "position" begins at the minimum with an increment of 0. Mode "force" sends no word until an override
    sets the command; ``start`` sets it here, as a host would.
    """

    def __init__(self, config=None, fingers=2, start=None):
        within(fingers=(fingers, 1, MAX_FINGERS))
        self._config, self.fingers, self.start = config or GripConfig(), int(fingers), start
        if start is not None:
            within(start=(start, self.config.minimum, self.config.maximum))
        self.reset()

    @property
    def config(self):
        """The settings. Another mode resets the reflex: a command has no meaning in the other mode."""
        return self._config

    @config.setter
    def config(self, config):
        changed, self._config = config.mode != self._config.mode, config
        if changed:
            self.start = None
            self.reset()

    def reset(self):
        """Forget all state; the hand stays where it is until the next command."""
        self.command, self.armed, self.fault = 0, False, UNARMED
        if self.start is not None:
            self.command, self.armed, self.fault = int(self.start), True, 0
        self._speed_term = [0] * self.fingers
        self._quiet = [0] * self.fingers  # cycles in a row without a decision
        self._counted = [False] * self.fingers  # the current window was over and was counted
        self._streak = [0] * self.fingers  # consecutive windows over before the current one
        self._clear()

    def _clear(self):
        self._wish = [0] * self.fingers
        self._over = [False] * self.fingers
        self._seen = [False] * self.fingers

    def report(self, finger, speed):
        """A shear speed of ``finger``, valid until the next one; None: the estimator flags it as invalid."""
        if not 0 <= finger < self.fingers:
            return
        if speed is not None:
            within(speed=(speed, 0, (1 << SPEED_BITS) - 1))
        term = 0 if speed is None else self.config.speed_gain * int(speed) >> SPEED_SHIFT
        self._speed_term[finger] = min(term, TOP)

    def decision(self, finger, over, end=True):
        """A decision about ``finger``; ``end``: its window's last. A window counts once, when first over."""
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
        """The command of the cycle that ends now; ``override``: a host's command in place of the reflex's."""
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
        if self.armed:
            goal = before
            if override is not None:
                goal = int(override)
            elif slips:
                goal = before + wish
            elif falls:
                goal = before - config.decay
            self.command = self._limited(goal, before)
            increment = self.command - before
        else:  # the first cycle since reset or a change of mode: the hand does not move
            increment = 0
            valid = config.mode == "position" or override is not None
            if valid:
                goal = config.minimum if config.mode == "position" else int(override)
                self.command = min(max(goal, config.minimum), config.maximum)
                self.armed = True

        self.fault = SILENT * any(silent) | UNHEALTHY * (not all(healthy)) | UNARMED * (not valid)
        self.fault |= self._limits(valid)
        word = increment if config.mode == "position" else self.command
        return Command(increment, self.command, self.fault, valid, word, tuple(faulty))

    def _limited(self, goal, before):
        """The command towards ``goal`` from the command ``before``."""
        config = self.config
        goal = min(max(goal, config.minimum), config.maximum)
        return min(max(goal, before - config.rate), before + config.rate)

    def _limits(self, valid=True):
        """The faults that say how the command lies to the limits."""
        config = self.config
        at_limit = valid and self.command >= config.maximum
        return LIMIT * at_limit | SETTINGS * (config.minimum > config.maximum)

    def rest(self, cycles):
        """The increments of ``cycles`` in which every finger has a decision and none was over."""
        command, found = self.command, []
        for _ in range(cycles):
            found.append(self._limited(command - self.config.decay, command) - command)
            command += found[-1]
        return found

    def take(self, increments, ended):
        """Take cycles as ``rest`` gives them, with healthy fingers; ``ended``: a window of each ended.

        (increment, command, fault, 0 for no faulty finger) of each, as ``decision`` and ``cycle`` give them
        for an armed reflex whose windows were not over.
        """
        found = []
        for increment in increments:
            self.command += increment
            self.fault = self._limits()
            found.append((increment, self.command, self.fault, 0))
        self._quiet = [0] * self.fingers
        if ended:
            self._streak = [0] * self.fingers
        return found

    def next(self, over, healthy=None, seen=None, speed=None, override=None):
        """A cycle's command. For each finger: ``over``, its windows over the threshold since the last cycle;
        ``seen``, all its windows (None: one, or as many as over); ``healthy``; ``speed``, None if unknown.
        """
        seen = [max(int(count), 1) for count in over] if seen is None else seen
        speed = [None] * self.fingers if speed is None else speed
        healthy = [True] * self.fingers if healthy is None else healthy
        for name, values in (("over", over), ("seen", seen), ("healthy", healthy), ("speed", speed)):
            if len(values) != self.fingers:
                raise ValueError(f"{name} has {len(values)} values for {self.fingers} fingers")
        for finger, (count, windows, v) in enumerate(zip(over, seen, speed)):
            within(over=(count, 0, windows))
            self.report(finger, v)
            for n in range(int(windows)):
                self.decision(finger, n < count)
        return self.cycle(healthy, override)
