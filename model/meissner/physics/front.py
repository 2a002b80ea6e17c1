"""The analogue front of each converter: how much of an old voltage is still in a sample after a step.

A Butterworth low pass of first or second order with its corner at f Hz, after t seconds:

    order 1:   gain(g) = 1 / sqrt(1 + (g/f)^2)    left(t) = exp(-w),                   w = 2 pi f t
    order 2:   gain(g) = 1 / sqrt(1 + (g/f)^4)    left(t) = exp(-v) (cos v + sin v),   v = sqrt(2) pi f t

Order 2 is the solution of y'' + sqrt(2) w y' + w^2 y = 0 from y = 1, y' = 0 with w = 2 pi f: poles at
w (-1 +- i)/sqrt(2). Both orders are left(t) = Re(W exp(p t)), with (W, p) = (1, -w) or
(1 - i, w (i - 1)/sqrt(2)); |W| exp(Re(p) t) is never below |left|, and it never rises. The settling time is
that of this bound, since a filter of second order rings.

A filter is thus one complex state x with x' = p (x - u) for the voltage u, and the output Re(W x): exact for
any u that is constant or a straight line from instant to instant.

A multiplexed converter has no filter. Its sampling capacitor still holds the previous input when it is
switched to the next one, and keeps exp(-acquisition / ((source + switch) farads)) of it, whatever the settle
time; the pin itself follows its source through the capacitance of pin and line, a filter of first order.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from meissner.arrays import Floats, check_finite, finite

SOURCE_OHM = 100.0
PIN_F = 50e-12
LEAST_SETTLE_S = 1e-6


@dataclass(frozen=True)
class LowPass:
    """A Butterworth filter with ``corner_hz``, of ``order`` 1 or 2."""

    corner_hz: float
    order: int = 2

    def __post_init__(self) -> None:
        check_finite("corner_hz", self.corner_hz)
        if self.corner_hz <= 0:
            raise ValueError(f"corner_hz = {self.corner_hz:g} must be above 0")
        if self.order not in (1, 2):
            raise ValueError(f"order = {self.order} must be 1 or 2")

    @property
    def mode(self) -> tuple[complex, complex]:
        """(W, p) as above."""
        rate = 2 * math.pi * self.corner_hz
        return (1.0, -rate) if self.order == 1 else (1 - 1j, rate * (1j - 1) / math.sqrt(2))

    @finite
    def gain(self, hertz: float) -> float:
        return 1 / math.sqrt(1 + (hertz / self.corner_hz) ** (2 * self.order))

    @finite
    def left(self, seconds: float) -> float:
        """Share of the old voltage in what is sampled ``seconds`` after a step from it; may be negative."""
        size, pole = self.mode
        return float((size * np.exp(pole * seconds)).real)

    @finite
    def most_left(self, seconds: float) -> float:
        """The most that is left from ``seconds`` on: order 2 has its extremes exp(-k pi) at v = k pi."""
        turn = math.ceil(self.mode[1].imag * seconds / math.pi)
        return max(abs(self.left(seconds)), math.exp(-math.pi * turn) if turn else 0.0)

    @finite
    def settled_s(self, share: float) -> float:
        """Seconds after which the bound, so also what is left from then on, is at most ``share``."""
        size, pole = self.mode
        return math.log(abs(size) / share) / -pole.real if share < 1 else 0.0


@dataclass(frozen=True)
class Front:
    """Of one part: the corner of its filter for each range it has, {volts at full scale: Hz}, or a sampling
    capacitor of ``farad`` behind a switch of ``ohm``, connected for ``half_bits`` halves of an SCLK period.
    """

    corners_hz: tuple[tuple[float, float], ...] = ()
    order: int = 2
    ohm: float = 0.0
    farad: float = 0.0
    half_bits: int = 3


# By the beginning of a part's name; the longest that fits counts. docs/adc.md has the sources.
FRONTS = {
    "AD7606": Front(((5.0, 15e3), (10.0, 23e3))),
    "AD7606C": Front(tuple((volts, 220e3) for volts in (2.5, 5.0, 6.25, 10.0, 12.5))),
    "MCP3208": Front(ohm=1000.0, farad=20e-12),
    "MAX111": Front(ohm=300.0, farad=15e-12),
}


@dataclass(frozen=True)
class Path:
    """From the pin to the sample: a low pass, then a capacitor that keeps the share ``keep``."""

    about: str
    pin: LowPass
    keep: float = 0.0

    def left(self, *seconds: float) -> float:
        """Share of the old row that is left at most in a sample; ``seconds``: from the switch to each sample
        up to this one. Each keeps the share ``keep`` of the one before."""
        left = 1.0
        for at_s in seconds:
            left = self.pin.most_left(at_s) + self.keep * left
        return min(1.0, left)

    def needed_s(self, share: float) -> float:
        """Seconds that are enough for ``share``; infinite if the capacitor alone keeps as much."""
        return self.pin.settled_s(share - self.keep) if share > self.keep else math.inf


def front(part: str) -> Front:
    """The Front of a part, by its name."""
    names = [name for name in FRONTS if part.upper().startswith(name)]
    return FRONTS[max(names, key=len)]


@finite
def paths(
    part: str, volts: float | None = None, half_s: float = 1e-3, source_ohm: float = SOURCE_OHM
) -> list[Path]:
    """One Path for each range of the part that has its own corner.

    ``volts``: full scale, of which only the least range that holds it is taken; None: every range;
    ``half_s``: half a period of SCLK.
    """
    own = front(part)
    if own.farad:
        acquired = own.half_bits * half_s / ((source_ohm + own.ohm) * own.farad)
        pin = LowPass(1 / (2 * math.pi * max(source_ohm, 1e-3) * PIN_F), 1)
        return [Path(f"a source of {source_ohm:g} ohms", pin, math.exp(-min(acquired, 700.0)))]
    corners = own.corners_hz
    if volts is not None:
        corners = next(((one,) for one in corners if one[0] >= volts), corners[-1:])
    kinds: dict[float, list[str]] = {}
    for range_v, hertz in corners:
        kinds.setdefault(hertz, []).append(f"±{range_v:g}")
    return [
        Path(f"{' '.join(ranges)} V, {hertz / 1e3:g} kHz", LowPass(hertz, own.order))
        for hertz, ranges in kinds.items()
    ]


def half_code(bits: int) -> float:
    """Half a code as a share of the largest step."""
    return 0.5 ** (bits + 1)


class Stream:
    """Voltages [..., samples] of channels that are not scanned, as a part with a filter samples them.

    A voltage has held since the sample before; before the first one it was the same. Blocks of any length
    give the same as the whole. A part without a filter changes nothing: its channel's capacitor keeps less
    than 1e-15 of the sample before. Events between two samples: rubber.fluctuation.
    """

    def __init__(self, part: str, volts: float, rate_hz: float) -> None:
        own = front(part)
        self.low_pass = None if own.farad else paths(part, volts)[0].pin
        self.period_s = 1 / rate_hz
        self.state: Any = None

    def next(self, volts: Floats) -> Floats:
        if self.low_pass is None:
            return volts
        from scipy.signal import lfilter  # only scenes with such a part wait for it

        size, pole = self.low_pass.mode
        over = np.exp(pole * self.period_s)
        if self.state is None:
            self.state = volts[..., :1].astype(complex)
        states, _ = lfilter([1.0 - over], [1.0, -over], volts.astype(complex), zi=over * self.state)
        self.state = states[..., -1:]
        return (size * states).real


class Held:
    """What is sampled of pins that see ``volts`` [frames, places, pins], one place after the other.

    Each place is connected until the next one; of a complex state (see above) the share ``settled`` of what
    was before remains when a place is sampled, ``passed`` when the next one is connected, and ``idle`` of the
    time between two frames, in which the pins are at ``rest``, as before the first. The output is
    Re(size x). Blocks of any number of frames give the same as the whole.
    """

    def __init__(
        self, size: complex, settled: complex, passed: complex, idle: complex, rest: float = 0.0
    ) -> None:
        self.size, self.settled, self.passed, self.idle, self.rest = size, settled, passed, idle, rest
        self.first: Any = complex(rest)

    def next(self, volts: Floats) -> Floats:
        sampled = np.empty(volts.shape)
        # Frames from a state of 0, then what their own first states add: both by one recursion.
        state = np.zeros(volts[:, 0].shape, dtype=complex)
        for place in range(volts.shape[1]):
            to = volts[:, place]
            sampled[:, place] = (self.size * (to + (state - to) * self.settled)).real
            state = to + (state - to) * self.passed
        fades = self.size * self.settled * self.passed ** np.arange(volts.shape[1])[:, None]
        whole = self.passed ** volts.shape[1] * self.idle
        for frame, end in enumerate(self.rest + (state - self.rest) * self.idle):
            sampled[frame] += (fades * self.first).real
            self.first = end + whole * self.first
        return sampled


def held(low_pass: LowPass, settle_s: float, slot_s: float, idle_s: float = 0.0, rest: float = 0.0) -> Held:
    """The Held of a filter: places of ``slot_s``, sampled after ``settle_s``, then ``idle_s``."""
    size, pole = low_pass.mode
    settled, passed, idle = (complex(np.exp(pole * seconds)) for seconds in (settle_s, slot_s, idle_s))
    return Held(size, settled, passed, idle, rest)


ORIGINS = {
    "SOURCE_OHM": (
        "chosen",
        "an amplifier's output with its series resistor; a divider has its resistors in parallel",
        "MCP3208 at 2 MHz: half a code remains at 3.2 kohm",
    ),
    "PIN_F": (
        "chosen",
        "pin 7 pF, off channels of a multiplexer, 10 cm of trace",
        "settle of a multiplexed converter: 0.45 us to half a code of 12 bits at 1 kohm",
    ),
    "LEAST_SETTLE_S": (
        "chosen",
        "drivers, lines and multiplexer of a board; not the converter's",
        "the shortest settle time that is taken without a request",
    ),
    "FRONTS": (
        "datasheet",
        "docs/adc.md: figures, sources and what is unverified",
        "how long a row must settle (docs/scan.md)",
    ),
}
