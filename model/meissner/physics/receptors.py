"""The four kinds of mechanoreceptive unit of a fingertip: what each detects, by frequency and contactor area.

    threshold (dB re 1 um peak) = knots of the channel, straight lines over log f
                                  + summation(area)             FA-II alone
    summation = 10 log10(SUMS_CM2 / area)                       below SUMS_CM2, 3 dB a doubling
              + slope log10(PLOTTED_CM2 / SUMS_CM2)             up to the area of the plotted curve

A displacement x(t) is detected where its part in each frequency, divided by the threshold there, adds up to 1
or more (``sensation``): a sine at its threshold gives exactly 1.

Not modelled: adaptation, temporal summation, age, temperature, masking between channels, where in the skin
the units lie, and the spread of persons (several dB).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Bools, Floats, finite


class Channel(NamedTuple):
    """A kind of unit: its psychophysical channel, receptor, receptive field, density and depth (table 1), and
    its threshold as (Hz, dB) knots. ``sums``: over the area of the contactor."""

    channel: str
    receptor: str
    field_mm2: float
    density_cm2: float
    depth: str
    knots: tuple[tuple[float, float], ...]
    sums: bool = False

    @property
    def units(self) -> float:
        """Units in whose receptive field a point of the skin lies."""
        return self.field_mm2 / 100 * self.density_cm2


CHANNELS = {
    "SA-I": Channel(
        *("NP III", "Merkel", 11.0, 60.0, "shallow"),
        ((0.4, 28.0), (3.0, 28.0), (10.0, 27.5), (20.0, 27.0), (40.0, 30.0), (100.0, 32.0), (500.0, 45.0)),
    ),
    "SA-II": Channel(
        *("NP II", "Ruffini", 59.0, 10.0, "deep"),
        (
            *((1.0, 63.0), (15.0, 38.0), (30.0, 31.5), (60.0, 25.0), (100.0, 19.5), (150.0, 15.5)),
            *((200.0, 12.0), (250.0, 10.0), (300.0, 10.5), (500.0, 18.0)),
        ),
    ),
    "FA-I": Channel(
        *("NP I", "Meissner", 13.0, 140.0, "shallow"),
        (
            *((0.1, 46.0), (0.4, 34.0), (1.0, 29.5), (3.0, 27.5), (10.0, 21.5), (20.0, 17.0), (30.0, 13.5)),
            *((40.0, 12.0), (60.0, 13.0), (100.0, 18.0), (200.0, 29.0), (500.0, 45.0)),
        ),
    ),
    "FA-II": Channel(
        *("P", "Pacini", 101.0, 20.0, "deep"),
        (
            *((1.0, 74.0), (10.0, 34.0), (20.0, 22.5), (40.0, 11.5), (60.0, 5.2), (80.0, 0.0)),
            *((100.0, -4.2), (120.0, -9.3), (150.0, -13.5), (200.0, -17.5), (250.0, -19.0)),
            *((300.0, -17.5), (400.0, -15.0), (500.0, -11.0)),
        ),
        True,
    ),
}
TIP_CM2, SMALLEST_CM2, PLOTTED_CM2 = 0.0007, 0.008, 2.9
SUMS_CM2, DECADE_DB = 0.1, 10.0
SLOW_HZ = 0.4
# dB a decade of area from SUMS_CM2 to PLOTTED_CM2.
SLOPES = {"fingertip": 3.3, "thenar": 10.0}
ORIGINS = {
    "CHANNELS": (
        "read off",
        "fields, densities, depths: table 1. Knots: the curves of Bolanowski et al. 1988 and Gescheider et "
        "al. 2001, their levels from memory to about 3 dB, unverified; within that placed so that figures 8 "
        "to 11 come out. FA-II falls by about 12 dB an octave from 40 Hz to its best, about 250 Hz: the "
        "abstract of Gescheider and Verrillo 1979, of Verrillo 1963",
        "every conclusion; docs/papers/optacon.md has what each moves by",
    ),
    "TIP_CM2": ("published", "Optacon-II paper, figure 12 and section 5.2", "conclusion 4"),
    "SMALLEST_CM2": (
        "published",
        "the same, after Gescheider et al.: the smallest contactor",
        "conclusion 4",
    ),
    "PLOTTED_CM2": (
        "published",
        "Bolanowski et al. 1988: their large contactor. That figure 11 plots its curve is our reading",
        "conclusion 3: with the curve of 0.008 cm2 FA-II is not reached at 120 Hz",
    ),
    "SUMS_CM2": (
        "published",
        "Gescheider et al. 2002, fingertip, 300 Hz, as a later paper cites them: 3 dB a doubling between "
        "0.025 and 0.10 cm2",
        "conclusion 4 with 0.008 cm2",
    ),
    "DECADE_DB": (
        "published",
        "abstract of Craig and Sherrick 1969: 3 dB a doubling of the area at 250 Hz; Verrillo, as a later "
        "paper cites him: on the thenar from 0.02 to 2.9 cm2, at 80 to 320 Hz, not at 25 and 40 Hz",
        "conclusion 4",
    ),
    "SLOW_HZ": (
        "published",
        "Bolanowski et al. 1988: the lowest frequency of their curves, also in the abstract",
        "a held pin: SA-I alone",
    ),
    "SLOPES": (
        "chosen",
        "thenar: 3 dB a doubling to 2.9 cm2, published; fingertip: less, without a number: abstract of "
        "Gescheider et al. 2002",
        "with 0.008 cm2 FA-II is reached at 230 Hz and 30 V with the fingertip's, at no voltage with the "
        "thenar's",
    ),
}


@finite
def summation_db(cm2: float, skin: str = "fingertip") -> float:
    """By how much FA-II's threshold for that contactor is above the plotted curve."""
    low, slope = min(cm2, SUMS_CM2), SLOPES[skin]
    return float(DECADE_DB * np.log10(SUMS_CM2 / low) + slope * np.log10(PLOTTED_CM2 / max(cm2, SUMS_CM2)))


@finite
def threshold_db(name: str, hz: ArrayLike, cm2: float = TIP_CM2, skin: str = "fingertip") -> Floats:
    """The threshold of a channel of CHANNELS for a contactor of that area; beyond the knots their last lines
    go on."""
    channel = CHANNELS[name]
    at, db = np.log2(np.array(channel.knots)[:, 0]), np.array(channel.knots)[:, 1]
    octave = np.log2(np.maximum(hz, 1e-3))
    found = np.interp(octave, at, db)
    ends = np.diff(db)[[0, -1]] / np.diff(at)[[0, -1]]
    found += ends[0] * np.minimum(octave - at[0], 0.0) + ends[1] * np.maximum(octave - at[-1], 0.0)
    return np.asarray(found + (summation_db(cm2, skin) if channel.sums else 0.0))


@finite
def reached(name: str, hz: ArrayLike, db: ArrayLike, cm2: float = TIP_CM2, skin: str = "fingertip") -> Bools:
    """Whether a sine of that peak in dB re 1 um is at or above the threshold."""
    return np.asarray(np.asarray(db) >= threshold_db(name, hz, cm2, skin))


@finite
def sensation(name: str, x_um: Floats, rate_hz: float, cm2: float = TIP_CM2) -> Floats:
    """Displacements [..., samples] of a periodic record over the channel's threshold. What is held counts for
    the slowly adapting units as SLOW_HZ does, for the others not at all."""
    hz = np.fft.rfftfreq(x_um.shape[-1], 1 / rate_hz)
    weight = 10 ** (-threshold_db(name, np.maximum(hz, SLOW_HZ), cm2) / 20)
    if not name.startswith("SA"):
        weight[0] = 0.0
    return np.fft.irfft(np.fft.rfft(x_um) * weight, x_um.shape[-1])
