"""The converter between the sensor's voltage and the core: noise, quantisation, over-range.

    code = clamp(floor((V + noise - low_v)/lsb + 1/2) + min_code),   lsb = (high_v - low_v)/2^bits

``min_code`` is 0 for a range that starts at 0 V (unsigned parts) and -2^(bits-1) for a symmetric one
(two's complement parts). The noise is the converter's own, white and Gaussian, one draw per sample.

Over-range depends on the input without the noise: V outside low_v .. high_v. A sensor that rests exactly at
full scale, as the unpressed divider does, is in range.

Not modelled: integral and differential non-linearity, offset and gain error, aperture jitter, channel
crosstalk, reference drift. What stands in front of the converter: meissner.physics.front.
"""

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
    "PARTS": ("datasheet", "bits and ranges of the parts; the noise is computed", "codes a volt"),
}
