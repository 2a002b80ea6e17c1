"""Bit-exact twin of rtl/frontend/msn_am_demod.sv: amplitude of a carrier, taxel by taxel."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.common import hypot
from meissner.twins.shared import fits, one_of, within

RECTIFIER, IQ, IQ_FAST = range(3)

# Weights in I and Q of the samples of a quarter period; each further quarter is rotated by 90 degrees.
WEIGHTS = {4: [(1, 0)], 8: [(5, 2), (2, 5)], 16: [(5, 1), (4, 3), (3, 4), (1, 5)]}


def references(samples_per_period):
    """The integer references of I and Q over one period, [2, samples]."""
    c, s = np.array(WEIGHTS[samples_per_period]).T
    return np.array([np.concatenate([c, -s, -c, s]), np.concatenate([s, c, -s, -c])])


@dataclass(frozen=True)
class AmDemod:
    """The block's parameters; ``form``: RECTIFIER, IQ or IQ_FAST."""

    form: int = IQ
    samples_per_period: int = 4
    lanes: int = 1
    channels: int = 64
    sample_bits: int = 17
    period_bits: int = 6
    skip_bits: int = 8

    def __post_init__(self):
        one_of((RECTIFIER, IQ, IQ_FAST), form=self.form)
        one_of(WEIGHTS, samples_per_period=self.samples_per_period)
        fits(self, lanes=(1, 8), channels=(self.lanes, 65536), sample_bits=(4, 18))
        if self.period_bits < 1 or self.sum_bits > 29:
            raise ValueError(
                f"period_bits = {self.period_bits} must be at least 1, and the sums at most 29 bits"
            )
        fits(self, skip_bits=(1, 32))

    @property
    def sum_bits(self):
        """Bits of |I|, |Q| and of the rectifier's sum."""
        pairs = self.samples_per_period // 2
        if self.form != RECTIFIER:
            pairs = int(np.abs(references(self.samples_per_period)[0]).sum()) // 2
        return self.sample_bits + (pairs - 1).bit_length() + self.period_bits

    @property
    def magnitude_clocks(self):
        if self.form == RECTIFIER:
            return 0
        return hypot.latency(self.sum_bits + 1, self.form == IQ)

    def latency(self, shift):
        """Clocks from a measurement's last sample to the amplitude of its lane 0."""
        return 5 + self.magnitude_clocks + shift

    def lane_clocks(self, shift):
        """Clocks from one lane's amplitude to the next lane's; also the shortest time per lane."""
        return max(self.magnitude_clocks, shift + 1)

    def gain(self, periods):
        """M, before the shift, of a carrier of amplitude 1, averaged over its phase."""
        n = self.samples_per_period
        if self.form == RECTIFIER:
            return periods * 2 * n / np.pi
        angles = 2 * np.pi * (np.arange(n) + (0.5 if n > 4 else 0)) / n
        exact = periods * float(references(n)[0] @ np.cos(angles))
        if self.form == IQ:
            return exact
        phases = np.linspace(0, np.pi / 4, 100_001)
        lines = np.maximum(np.cos(phases), 7 / 8 * np.cos(phases) + np.sin(phases) / 2)
        return exact * float(lines.mean())

    def amplitude(self, samples, shift, user=None):
        """Amplitude and over-range of measurements: (data, user), int64 and bool [...].

            rectifier    M = sum |x[n] - x[n + N/2]| over the first half of each period
            synchronous  I + jQ = sum (c + js)[n] x[n],  M = sqrt(I**2 + Q**2) or its estimate
            data = floor(M / 2**shift + 1/2), at most 2**(sample_bits - 1) - 1

        ``samples``: [..., periods * samples_per_period] in codes, settled; ``user``: their over-range flags.
        """
        x = np.asarray(samples, dtype=np.int64)
        n = self.samples_per_period
        limit = 1 << (self.sample_bits - 1)
        if x.shape[-1] < n or x.shape[-1] % n or x.shape[-1] > n << self.period_bits:
            raise ValueError(f"{x.shape[-1]} samples are not 1 .. 2**{self.period_bits} periods of {n}")
        if (x < -limit).any() or (x >= limit).any():
            raise ValueError(f"a sample does not fit {self.sample_bits} bits")
        within(shift=(shift, 0, 31))
        x = x.reshape(*x.shape[:-1], -1, n)
        if self.form == RECTIFIER:
            halves = x[..., n // 2 :] - x[..., : n // 2]
            doubled = 2 * np.abs(halves).sum(axis=(-1, -2))
        else:
            i, q = (np.abs((x * reference).sum(axis=(-1, -2))) for reference in references(n))
            doubled = hypot.hypot(2 * i, 2 * q, self.form == IQ)
        data = ((doubled >> shift) + 1) >> 1
        over = np.zeros(data.shape, bool) if user is None else np.asarray(user, bool).any(axis=-1)
        return np.minimum(data, limit - 1), over | (data >= limit)

    def process(self, beats, periods, skip, shift):
        """Results of a stream of samples: (amplitudes as dicts of the ports, number of aborted measurements).

        ``beats``: dicts with data and user (lists, a value per lane), start, id, last. A start ends the
        previous measurement, finished or not; samples after a finished measurement are ignored.
        """
        length = (periods or 1 << self.period_bits) * self.samples_per_period
        results, broken, taken, head = [], 0, None, None
        for beat in beats:
            if beat["start"]:
                broken += taken is not None
                taken, head = [], beat
                left = skip
            if taken is None:
                continue
            if left:
                left -= 1
                continue
            taken.append(beat)
            if len(taken) == length:
                data, user = (np.array([b[name] for b in taken]).T for name in ("data", "user"))
                amplitude, over = self.amplitude(data, shift, user)
                for lane in range(self.lanes):
                    last = bool(head["last"]) and lane == self.lanes - 1
                    results.append(
                        {
                            "data": int(amplitude[lane]),
                            "id": head["id"] + lane,
                            "last": int(last),
                            "user": int(over[lane]),
                        }
                    )
                taken = None
        return results, broken
