"""A pin on the tip of a piezo bimorph, free and under a finger, driven by pulses; and a laser that measures
it.

    Zp(w) = k - m w^2 + j w c        k = 3 E I / L^3,  I = b t^3 / 12,  m = 33/140 rho b t L + PIN_MG
    Zs(w) = A B / (A + B)            skin: A = kc + j w cc to a mass of tissue, B = kg - M w^2 + j w cg
    x(w)  = k x0 U(w) / Zp           free;  under a finger  k x0 U(w) / (Zp + s Zs),  s = (V / 30 V)^STIFFENS
    x0    = 3 d31 L^2 / t^2          metres a volt of a bimorph whose halves are in parallel

U(t) is a train of pulses between 0 and V, since the drivers only switch. A finger presses the pin onto its
stop as PRELOAD_V volts would pull it there, and the stop holds it at 0:

    x(t) = max(0, x of U alone - PRELOAD_V x(0) / U(0))

So a slow drive moves the pin by V - PRELOAD_V, while a fast one does not let it reach the stop. The further
out the pin is, the more skin takes part, by s. For both, displacement under a finger is not proportional to
the voltage. Tissue on its spring takes the pin's motion up best at sqrt((kc + kg) / M): there is the dip.

About five numbers are published (meissner.scenes.optacon.published); PIN_MG, kg, kc, cc, M and cg are
fitted to them. What lies between is qualitative: a finger is no lumped mass.

Not modelled: hysteresis and creep of the ceramic, higher modes of the beam, the guide's friction but as
damping, the pin leaving the skin, neighbours through skin and plate.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import Floats, finite

LENGTH_MM, WIDTH_MM, THICKNESS_MM = 37.0, 1.05, 0.55
MODULUS_PA, DENSITY, D31 = 60e9, 7800.0, 274e-12
PIN_MG, DAMPING = 98.7, 0.6
PRELOAD_V, STIFFENS, STANDARD_V = 4.5, 0.08, 30.0
DECIBEL_UM = 1.0
TILT_DB = 0.2


class Skin(NamedTuple):
    """Newtons a metre and newton seconds a metre of the skin's two springs and dampers; grams of tissue."""

    kc: float
    cc: float
    kg: float
    cg: float
    grams: float


SKIN = Skin(kc=4400.0, cc=0.133, kg=9.521, cg=1.085, grams=4.575)
# Of the laser: samples a second, micrometres; of a measurement: periods, repetitions.
LASER_HZ, LASER_UM, PERIODS, REPETITIONS = 2000.0, 0.1, 50, 5
DRIFT_UM, SCATTER_DB, SPREAD_DB = 3.0, 0.3, 0.4
POINTS = 4096
ORIGINS = {
    "LENGTH_MM": ("published", "Optacon-II paper, 3.1.1; that all of it is free is chosen", "k, x0 and m"),
    "WIDTH_MM": ("published", "the same", "k and m alike"),
    "THICKNESS_MM": ("published", "the same", "k, x0 and m"),
    "MODULUS_PA": (
        "chosen",
        "soft PZT, 50 to 70 GPa",
        "free_db at 230 Hz 20.7 at 50, 23.8 at 70 GPa; PIN_MG and SKIN are in proportion to it",
    ),
    "DENSITY": ("chosen", "PZT", "PIN_MG takes it up"),
    "D31": (
        "chosen",
        "soft PZT: 171 (5A) to 274 pC/N (5H)",
        "the free pin below 100 Hz in proportion; kg, as 33 um under a finger are published",
    ),
    "PIN_MG": ("chosen", "fitted: 22.2 dB at 230 Hz and 30 V, free", "above_db of optacon_free"),
    "DAMPING": (
        "chosen",
        "the paper reports no resonance of the free pin",
        "the free pin about 100 Hz: 0.2 gives a peak of 45 dB at 90 Hz",
    ),
    "PRELOAD_V": (
        "chosen",
        "the paper: not proportional to the voltage under a finger",
        "conclusion 1 at 10 V: without it FA-I is reached at 10 V from 9 to 30 Hz",
    ),
    "STIFFENS": (
        "chosen",
        "the paper: not proportional at each frequency, without a number",
        "10 V and 50 V beside 30 V from 100 Hz on: 0.7 and -0.3 dB off proportion, in the mean",
    ),
    "STANDARD_V": (
        "published",
        "the voltage of figures 6 and 14, to which SKIN is fitted",
        "the unit of STIFFENS",
    ),
    "DECIBEL_UM": ("published", "every figure: peak in dB re 1.0 um", "the unit"),
    "TILT_DB": ("published", "4.2: from above and from below 0.2 dB apart", "below_db of optacon_free"),
    "SKIN": (
        "chosen",
        "fitted: 33 um and 0.8 um in bursts, the dip at 150 Hz; the fall from 20 to 120 Hz so that "
        "conclusions 1 and 3 hold",
        "figures 8 to 11 and 14; docs/papers/optacon.md",
    ),
    "LASER_HZ": ("published", "3.1.2", "a single 230 Hz peak up to 0.58 dB low"),
    "LASER_UM": ("published", "3.1.2: resolution", "0.1 um is 1 dB of 0.8 um; the mean of 50 peaks less"),
    "PERIODS": ("published", "4.1", "how sure a peak is"),
    "REPETITIONS": ("published", "4.1: 5; ours: figure 6 one, 8 to 11 their mean", "the same"),
    "DRIFT_UM": ("chosen", "the paper removes a drift of no stated size", "none: it is removed"),
    "SCATTER_DB": ("computed", "of one reading: with it two series correlate by 0.996", "correlation"),
    "SPREAD_DB": (
        "chosen",
        "standard deviation from pin to pin; the paper measures 5 and shows the mean",
        "spread",
    ),
    "POINTS": ("chosen", "numerical: a period's samples, and so the highest harmonic", "none"),
}


def stiffness() -> float:
    """k of the cantilever's tip, N/m."""
    inertia = WIDTH_MM * THICKNESS_MM**3 / 12 * 1e-12
    return 3 * MODULUS_PA * inertia / (LENGTH_MM * 1e-3) ** 3


def mass() -> float:
    """m of the tip, kg: the beam's share and the pin."""
    beam = DENSITY * LENGTH_MM * WIDTH_MM * THICKNESS_MM * 1e-9
    return 33 / 140 * beam + PIN_MG * 1e-6


def per_volt() -> float:
    """x0: the free tip's displacement by a steady volt, um."""
    return 3e6 * D31 * (LENGTH_MM / THICKNESS_MM) ** 2


@finite
def transfer(hz: ArrayLike, finger: bool, volts: float = STANDARD_V) -> NDArray[np.complex128]:
    """Micrometres a volt at the tip of a drive at these frequencies, of pulses of so many ``volts``."""
    w = 2 * np.pi * np.asarray(hz, float)
    k, m = stiffness(), mass()
    z = k - m * w**2 + 2j * DAMPING * np.sqrt(k * m) * w
    if finger:
        local = SKIN.kc + 1j * w * SKIN.cc
        ground = SKIN.kg - SKIN.grams * 1e-3 * w**2 + 1j * w * SKIN.cg
        z = z + (volts / STANDARD_V) ** STIFFENS * local * ground / (local + ground)
    return np.asarray(k * per_volt() / z)


def lifted(x_um: Floats, finger: bool, volts: float) -> Floats:
    """The displacement with the stop, of one that a linear pin would have."""
    if not finger:
        return x_um
    return np.maximum(x_um - PRELOAD_V * float(transfer(0.0, True, volts).real), 0.0)


@finite
def moved(volts: Floats, rate_hz: float, finger: bool) -> Floats:
    """Displacement in um by volts [..., samples] of a periodic record of pulses, all of the same height."""
    most = float(volts.max(initial=0.0)) or STANDARD_V
    lines = np.fft.rfft(volts) * transfer(np.fft.rfftfreq(volts.shape[-1], 1 / rate_hz), finger, most)
    return lifted(np.fft.irfft(lines, volts.shape[-1]), finger, most)


@finite
def period(hz: float, volts: float, finger: bool, width: float = 0.5, points: int = POINTS) -> Floats:
    """Displacement in um over a period of a steady drive, with its mean: harmonics of pulses of ``width``."""
    n = np.arange(1, points // 2)
    lines = np.zeros(points // 2 + 1, complex)
    lines[0] = width
    lines[1:-1] = np.sin(np.pi * n * width) / (np.pi * n)
    lines *= volts * points * transfer(hz * np.arange(len(lines)), finger, volts)
    return lifted(np.fft.irfft(lines, points), finger, volts)


@finite
def in_db(um: Floats) -> Floats:
    return np.asarray(20 * np.log10(np.maximum(um, 1e-6) / DECIBEL_UM))


@finite
def peak_db(hz: float, volts: float, finger: bool) -> float:
    """The true peak of a steady drive, half of what it moves from end to end."""
    return float(in_db(np.array(np.ptp(period(hz, volts, finger)) / 2)))


@finite
def by_laser(wave_um: Floats, hz: float, rng: np.random.Generator, periods: int = PERIODS) -> Floats:
    """The laser's samples over that many periods of a ``wave_um`` whose phase it does not know, with
    drift."""
    count = int(periods * LASER_HZ / hz)
    place = (rng.random() + np.arange(count) * hz / LASER_HZ) % 1.0 * len(wave_um)
    low = place.astype(int)
    ahead = np.append(wave_um, wave_um[0])
    x = ahead[low] + (place - low) * (ahead[low + 1] - ahead[low])
    x = x + DRIFT_UM * rng.standard_normal() * np.linspace(-0.5, 0.5, count)
    return np.asarray(LASER_UM * np.rint(x / LASER_UM))


@finite
def peaks(samples: Floats, hz: float) -> Floats:
    """The peak of each period, half of what it moves from end to end; without the drift, a line through
    all."""
    at = np.arange(len(samples)) - (len(samples) - 1) / 2
    x = samples - at * (at * samples).sum() / (at * at).sum()
    first = np.ceil(np.arange(int(len(samples) * hz / LASER_HZ + 1e-6)) * LASER_HZ / hz - 1e-9).astype(int)
    return (np.maximum.reduceat(x, first) - np.minimum.reduceat(x, first)) / 2


@finite
def measured_db(wave_um: Floats, hz: float, rng: np.random.Generator) -> float:
    """Mean peak of one measurement of a period's wave, in dB re 1 um, with the reading's scatter."""
    mean = peaks(by_laser(wave_um, hz, rng), hz).mean()
    return float(in_db(mean) + SCATTER_DB * rng.standard_normal())
