"""The converter between the sensor's voltage and the core: noise, quantisation, over-range.

    code = clamp(floor((V + noise - low_v)/lsb + 1/2) + min_code),   lsb = (high_v - low_v)/2^bits

``min_code`` is 0 for a range that starts at 0 V (unsigned parts) and -2^(bits-1) for a symmetric one
(two's complement parts). The noise is the converter's own, white and Gaussian, one draw per sample.

Over-range depends on the input without the noise: V outside low_v .. high_v. A sensor that rests exactly at
full scale, as the unpressed divider does, is in range.

Not modelled: integral and differential non-linearity, offset and gain error, aperture jitter, channel
crosstalk, reference drift. No scene models the converter's low pass (15 kHz or more, above their band); it
decides how fast an array can be scanned: ``LowPass``.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Bools, Floats, Ints, check_finite, finite


@dataclass(frozen=True)
class Adc:
    """An ideal converter with white noise of ``noise_v`` volts rms at its input."""

    bits: int
    low_v: float
    high_v: float
    noise_v: float = 0.0

    def __post_init__(self) -> None:
        if not 1 <= self.bits <= 24:
            raise ValueError(f"bits = {self.bits} must be from 1 to 24")
        if self.low_v not in (0, -self.high_v) or self.high_v <= 0:
            raise ValueError(f"the range {self.low_v} V to {self.high_v} V must start at 0 V or be symmetric")
        for name in ("low_v", "high_v", "noise_v"):
            check_finite(name, getattr(self, name))
        if self.noise_v < 0:
            raise ValueError(f"noise_v = {self.noise_v} must not be negative")

    @property
    def lsb_v(self) -> float:
        return (self.high_v - self.low_v) / (1 << self.bits)

    @property
    def min_code(self) -> int:
        return 0 if self.low_v == 0 else -(1 << self.bits - 1)

    @property
    def max_code(self) -> int:
        return self.min_code + (1 << self.bits) - 1

    @finite
    def convert(self, volts: ArrayLike, rng: np.random.Generator | None = None) -> tuple[Ints, Bools]:
        """Codes and over-range of ``volts``, of their shape; no noise without ``rng``."""
        volts = np.asarray(volts, dtype=float)
        over_range = (volts < self.low_v) | (volts > self.high_v)
        if rng is not None and self.noise_v:
            volts = volts + self.noise_v * rng.standard_normal(volts.shape)
        codes = np.floor((volts - self.low_v) / self.lsb_v + 0.5) + self.min_code
        return np.clip(codes, self.min_code, self.max_code).astype(np.int64), over_range

    @finite
    def volts_of(self, codes: ArrayLike) -> Floats:
        """The voltage at the centre of each code."""
        return (np.asarray(codes) - self.min_code) * self.lsb_v + self.low_v


@dataclass(frozen=True)
class LowPass:
    """A Butterworth filter of second order in front of the inputs, with ``corner_hz``.

        gain(f) = 1 / sqrt(1 + (f / corner)^4)
        left(t) = exp(-w) (cos w + sin w),  w = sqrt(2) pi corner t

    ``left``: the share of the old voltage in what is sampled ``t`` seconds after a step from it.
    """

    corner_hz: float

    def __post_init__(self) -> None:
        check_finite("corner_hz", self.corner_hz)
        if self.corner_hz <= 0:
            raise ValueError(f"corner_hz = {self.corner_hz:g} must be above 0")

    @finite
    def gain(self, hertz: float) -> float:
        return 1 / math.sqrt(1 + (hertz / self.corner_hz) ** 4)

    @finite
    def left(self, seconds: float) -> float:
        w = math.sqrt(2) * math.pi * self.corner_hz * seconds
        return math.exp(-w) * (math.cos(w) + math.sin(w))

    @finite
    def settled_s(self, share: float) -> float:
        """Seconds from which on the envelope sqrt(2) exp(-w), so ``left`` too, is at most ``share``."""
        return math.log(math.sqrt(2) / share) / (math.sqrt(2) * math.pi * self.corner_hz)


# MCP3208 at 5 V: typical SINAD 72 dB, THD -82 dB (DS21298, 1 kHz, 0.1 to 4.9 V). Without the distortion
# 0.404 mV rms remain; 0.352 mV of these are quantisation and 0.198 mV the part's own noise.
MCP3208_NOISE_V = 0.198e-3
# AD7606, +-5 V, no oversampling: typical SNR 89 dB of a full-scale sine is 0.1255 mV rms; 0.044 mV of these
# are quantisation and 0.117 mV the part's own noise.
AD7606_NOISE_V = 0.117e-3
# AD7606C-16, +-5 V, wide bandwidth: an SNR of 86 dB is 0.1772 mV rms, less 0.044 mV of quantisation.
AD7606C_NOISE_V = 0.172e-3
PARTS = {
    "MCP3208": Adc(bits=12, low_v=0.0, high_v=5.0, noise_v=MCP3208_NOISE_V),
    "AD7606": Adc(bits=16, low_v=-5.0, high_v=5.0, noise_v=AD7606_NOISE_V),
    "AD7606C-16": Adc(bits=16, low_v=-5.0, high_v=5.0, noise_v=AD7606C_NOISE_V),
}
# {part: {volts at full scale: corner}}: parts with an analogue low pass.
CORNERS_HZ = {"AD7606": {5.0: 15e3, 10.0: 23e3}, "AD7606C-16": {5.0: 220e3}}
SETTLED = 0.01  # share of the old row that a scan may read without a warning


@finite
def old_rows(part: str, settle_s: float, volts: float | None = None) -> list[dict[str, float]]:
    """For each range of a part with a low pass its ``range_v``, ``corner_hz`` and ``left``: the share of the
    old row in a taxel that is sampled ``settle_s`` after the lines were switched.

    ``volts``: full scale, of which only the least range that holds it is taken; None: every range.
    """
    corners = CORNERS_HZ.get(part.upper(), {})
    if volts is not None:
        wide = [range_v for range_v in corners if range_v >= volts] or list(corners)[-1:]
        corners = {range_v: corners[range_v] for range_v in wide[:1]}
    left = {range_v: abs(LowPass(hertz).left(settle_s)) for range_v, hertz in corners.items()}
    return [
        {"range_v": range_v, "corner_hz": hertz, "left": left[range_v]} for range_v, hertz in corners.items()
    ]


def unsettled(part: str, settle_s: float, rows: list[dict[str, float]]) -> str:
    """The sentence about ``old_rows``; empty if no more than SETTLED is left."""
    if max((row["left"] for row in rows), default=0.0) <= SETTLED:
        return ""
    shares = " or ".join(
        f"{100 * row['left']:.3g} % (±{row['range_v']:g} V, {row['corner_hz'] / 1e3:g} kHz)" for row in rows
    )
    needed = max(LowPass(row["corner_hz"]).settled_s(SETTLED) for row in rows)
    return (
        f"the {part.upper()}'s analogue low pass of second order leaves {shares} of the old row "
        f"{1e6 * settle_s:g} us after a switch, so the times are those of the digital side only; "
        f"{100 * SETTLED:g} % is left after {math.ceil(1e6 * needed)} us"
    )


ORIGINS = {
    "MCP3208_NOISE_V": (
        "computed",
        "DS21298: SINAD 72 dB, THD -82 dB, less the quantisation of 12 bits of 5 V",
        "a sixth of a code: less than the quantisation itself",
    ),
    "AD7606_NOISE_V": (
        "computed",
        "data sheet: SNR 89 dB of a full-scale sine at +-5 V, less the quantisation of 16 bits",
        "0.8 of a code; cop_slip: without difference_gain, or with five times as much, false alarms and "
        "wrong ways",
    ),
    "AD7606C_NOISE_V": (
        "chosen",
        "an SNR of 86 dB of a full-scale sine at ±5 V; the data sheet's first page: 92 dB at ±20 V",
        "1.1 codes",
    ),
    "CORNERS_HZ": (
        "datasheet",
        "Butterworth of second order, -3 dB: AD7606 15 kHz (±5 V), 23 kHz (±10 V); AD7606C-16, wide: 220 kHz",
        "how much of the old row an array reads (docs/scan.md)",
    ),
    "SETTLED": (
        "chosen",
        "as much of a neighbour as calibration leaves of a cell",
        "when a scan is warned of",
    ),
    "PARTS": ("datasheet", "bits and ranges of the parts; the noise is computed", "codes a volt"),
}
