"""Twin of rtl/actuate/msn_pin_display.sv and its parts, msn_pin_phase.sv, msn_pin_limits.sv and
msn_pin_shift.sv: which pins of a tactile display are driven in each drive period, and when each is high
(docs/pin_display.md).

increment            of a 40-bit phase at each clock; a drive period ends where the phase wraps
level L of a pin     0: low; else high in the first L + 1 of a period's 2**(amplitude_bits + 1) slots
"""

from dataclasses import dataclass, field, fields

import numpy as np

from meissner.twins.shared import fits, within

PHASE_BITS = 40
DRIVER_BITS = 64  # outputs of a driver, HV507
WORD = 8  # bits that msn_spi_shift sends at a time
PARTS = 7  # of the window of the duty
OVERHEAD = 48  # clocks of a load beside its pins and bits
LEVEL_BITS = 8  # of a frame


def increment_of(hz, clk_khz):
    """The setting for a drive frequency, int, float or fraction, to the nearest: within clk / 2**41."""
    numerator, denominator = hz.as_integer_ratio()
    clocks = 1000 * clk_khz * denominator
    return ((numerator << PHASE_BITS + 1) + clocks) // (2 * clocks)


@dataclass(frozen=True)
class DisplaySize:
    """Parameters of the block. ValueError where the slots of a period at ``max_hz`` are too short for a load.

    ``tick_clocks``: clocks of a tick, a quarter ms; ``ticks``: of a seventh of the window of 10 s.
    """

    pins: int = 100
    chains: int = 1
    amplitude_bits: int = 4
    clk_khz: int = 25_000
    sclk_khz: int = 8000
    min_hz: int = 1
    max_hz: int = 400
    tick_clocks: int = 0  # 0: from clk_khz
    ticks: int = 5715

    def __post_init__(self):
        fits(self, pins=(2, 4095), chains=(1, 8), amplitude_bits=(1, 6), min_hz=(1, self.max_hz))
        fits(self, ticks=(2, 5715), clk_khz=(1, None), sclk_khz=(1, None))
        within(max_hz=(self.max_hz, 1, 1000 * self.clk_khz // 513))
        if (self.chains - 1) * self.chain_pins >= self.pins:
            each = f"{self.chain_pins} of {self.pins} pins each"
            raise ValueError(f"chains = {self.chains} must all have pins, but the first have {each}")
        if not self.tick_clocks:
            object.__setattr__(self, "tick_clocks", -(-self.clk_khz // 4))
        within(tick_clocks=(self.tick_clocks, 1, 250 * self.clk_khz // self.max_hz))
        if self.slot_clocks < self.lead + 8:
            raise ValueError(
                f"amplitude_bits = {self.amplitude_bits}: a slot of {self.slot_clocks} clocks at "
                f"{self.max_hz} Hz must be at least {self.lead + 8}, a load of {self.pins} pins in "
                f"{self.chains} chain{'s' * (self.chains > 1)}"
            )
        if self.ticks * self.tick_clocks * self.min_hz < 1000 * self.clk_khz:
            raise ValueError(f"ticks = {self.ticks} must last a drive period at {self.min_hz} Hz or longer")

    @property
    def slots(self):
        """Slots of a drive period."""
        return 2 << self.amplitude_bits

    @property
    def half(self):
        """Clocks in half a period of the shift clock."""
        return max(1, -(-self.clk_khz // (2 * self.sclk_khz)))

    @property
    def chain_pins(self):
        """Pins of a chain; the last chain may have fewer."""
        return -(-self.pins // self.chains)

    @property
    def chain_bits(self):
        """Bits that a chain shifts: its drivers have 64 outputs each."""
        return -(-self.chain_pins // DRIVER_BITS) * DRIVER_BITS

    @property
    def load(self):
        """Clocks in which a chain is shifted."""
        return self.chain_bits // WORD * (WORD + 1) * 2 * self.half

    @property
    def lead(self):
        """Clocks from the phase's slot to the latch of it at the pins, the same for every slot."""
        return self.pins + self.load + OVERHEAD

    @property
    def limits(self):
        """The least and the largest increment: of min_hz and max_hz, rounded down, so that the increment
        nearest to min_hz is not below the least."""
        return tuple((hz << PHASE_BITS) // (1000 * self.clk_khz) for hz in (self.min_hz, self.max_hz))

    @property
    def slot_clocks(self):
        """Clocks of the shortest slot."""
        return ((1 << PHASE_BITS) // self.limits[1]) // self.slots

    @property
    def parameters(self):
        """Parameters of the block in Verilog."""
        own = {"pins": "Pins", "chains": "Chains", "amplitude_bits": "AmplitudeBits", "clk_khz": "ClkKhz"}
        own |= {"sclk_khz": "SclkKhz", "min_hz": "MinHz", "max_hz": "MaxHz"}
        own |= {"tick_clocks": "TickClocks", "ticks": "Ticks"}
        return {name: getattr(self, key) for key, name in own.items()}


@dataclass(frozen=True)
class DisplaySettings:
    """The block's inputs.

    ``increment``: of the phase, 0: off; below min_hz: off, above max_hz: as max_hz. ``burst_period``,
    ``burst_on``: in drive periods; a burst_period of 0: always on. ``top``: the highest level; ``most``: pins
    at once, the first of a frame; ``duty``: ticks that a pin is driven in any 10 s; ``watchdog``: a pin that
    is on for more than so many sevenths of 10 s is off until a frame has it off; ``stop``: ticks without a
    frame until all is off.
    """

    increment: int = 0
    burst_period: int = 0
    burst_on: int = 0
    top: int = 255
    most: int = 4095
    duty: int = 65535
    watchdog: int = 15
    stop: int = 65535

    def __post_init__(self):
        words = dict.fromkeys(("duty", "stop"), (0, 65535)) | dict.fromkeys(
            ("burst_period", "burst_on"), (0, 4095)
        )
        fits(self, increment=(0, (1 << 32) - 1), top=(0, 255), most=(0, 4095), watchdog=(0, 15), **words)

    @property
    def settings(self):
        """{name: value} of the block's ``cfg_`` inputs."""
        return {f.name: int(getattr(self, f.name)) for f in fields(self)}


@dataclass(frozen=True)
class Period:
    """A drive period: ``levels`` of the pins; ``start``: clock since reset in which it begins at the pins;
    ``clocks``: its length; ``slots``: the clock in it in which each slot begins; ``silent``: the first one
    after a pause or a change of the frequency; ``limited``: a limit keeps a pin off that the frame has on."""

    levels: np.ndarray
    start: int
    clocks: int
    slots: tuple[int, ...]
    silent: bool
    limited: bool


def high(levels, amplitude_bits):
    """Whether each pin is high in each slot of a drive period: bool [pins, slots]."""
    levels = np.asarray(levels)[:, None]
    return (levels > 0) & (np.arange(2 << amplitude_bits) <= levels)


def share(levels, amplitude_bits):
    """The share of a drive period in which each pin is high, from its beginning on."""
    return high(levels, amplitude_bits).mean(axis=1)


@dataclass
class PinDisplay:
    """The block. ``next`` is a drive period, from a wrap to the next; ``off`` a pause."""

    size: DisplaySize = field(default_factory=DisplaySize)
    settings: DisplaySettings = field(default_factory=DisplaySettings)

    def __post_init__(self):
        self.reset()

    def reset(self):
        pins = self.size.pins
        self.run = np.zeros(pins, dtype=np.int64)
        self.on = np.zeros(pins, dtype=bool)
        self.charged = np.zeros(
            (PARTS + 1, pins), dtype=np.int64
        )  # in the last sevenths, this one's at its number
        self.turns = 0  # sevenths that have ended
        self.frame = np.zeros(pins, dtype=np.int64)
        self.levels = self.frame
        self.increment = self.phase = self.begun = self.burst = self.length = 0
        self.wrap = 0  # clock of the next wrap

    def _ticks(self, clock):
        """Ticks up to and with ``clock``."""
        return (clock + 1) // self.size.tick_clocks

    def _turn(self, clock):
        """Move the window of the duty on, for each seventh that ends before ``clock``; whether one did."""
        before = self.turns
        while self.turns < self._ticks(clock - 1) // self.size.ticks:
            self.turns += 1
            self.charged[self.turns % len(self.charged)] = 0
        return self.turns > before

    def _close(self, clock):
        """Charge the period that ends in ``clock``."""
        self.length = self._ticks(clock) - self._ticks(self.begun)
        self.charged[self.turns % len(self.charged)] += np.where(self.on, self.length + 1, 0)
        self.on = np.zeros_like(self.on)

    def off(self, clock):
        """All pins are off from ``clock`` on: no enable, a fault of the sensor, or no frames."""
        if self.increment:
            self._turn(clock + 1)
            self._close(clock)
        self.increment = self.phase = self.burst = 0
        self.levels = np.zeros_like(self.frame)

    def on_again(self, clock):
        """The phase begins in ``clock``, at 0."""
        self._turn(clock)
        self.wrap = self.begun = clock

    def next(self, frame=None, settings=None):
        """The period that begins at the next wrap, with the newest complete ``frame`` [pins], None: as
        before.

        None if the frequency is 0: ``on_again`` begins anew.
        """
        size, clock = self.size, self.wrap
        self.settings = s = settings or self.settings
        least, largest = size.limits
        increment = min(s.increment, largest)
        if increment < least:
            self.off(clock)
            return None
        if frame is not None:
            self.frame = np.asarray(frame, dtype=np.int64)
            if self.frame.shape != (size.pins,):
                raise ValueError(f"frame has the shape {self.frame.shape}, which must be ({size.pins},)")
            within(**{f"level {p}": (v, 0, 255) for p, v in enumerate(self.frame.tolist())})
        silent = increment != self.increment
        turned, before = self._turn(clock), self.increment
        self._close(clock)
        self.increment, self.begun = increment, clock
        wanted = self.frame > 0
        self.run = np.where(wanted, np.minimum(self.run + turned, 15), 0)
        burst = s.burst_period == 0 or self.burst < s.burst_on
        self.burst = 0 if silent or self.burst + 1 >= s.burst_period else self.burst + 1
        may = wanted & (self.charged.sum(axis=0) + self.length + 2 <= s.duty) & (self.run <= s.watchdog)
        top = min(s.top, (1 << size.amplitude_bits) - 1)
        may &= top > 0
        may &= np.cumsum(may) <= s.most
        self.on = may & burst & (not silent)
        self.levels = np.where(self.on, np.minimum(self.frame, top), 0)
        # The first clock adds the increment of before.
        wraps = [(slot + 1 << PHASE_BITS) // size.slots for slot in range(size.slots)]
        slots = [1 - (self.phase + before - place) // increment for place in wraps]
        clocks = slots.pop()
        self.phase += before + (clocks - 1) * increment - (1 << PHASE_BITS)
        self.wrap = clock + clocks
        limited = bool((wanted & ~may).any())
        return Period(self.levels, clock + size.lead, clocks, (0, *slots), silent, limited)
