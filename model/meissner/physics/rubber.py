"""Pressure-conductive rubber, 6 mm square on two spiral electrodes, in series with 1 kOhm to 5 V.

    Vc   = 5 V / (1 + R·G)                       R = 1 kOhm, G the rubber's conductance
    G(F) : through the published points          5, 4, 3, 2 V at 0, 0.5, 1.0, 1.7 N
    dV   = k·v^n,  k = 1.55 - 0.27·Vi, n = 0.11  rise of Vc while the rubber shears at v mm/s
    G    = G(F, dV)·(1 + e(t))                   e: micro events of partial slip and stick-slip

Between the points log G is a monotone cubic of log F, beyond them a power law with the end slope.

Shear: with u = dV/k, du/dt = (v^n - u)·(v/X0 + 1/T0). While shearing, u reaches v^n within 0.01 mm; when
the shear stops, u falls within about 5 s to a residual. Both numbers are published. The papers disagree about
the residual. According to the high-sensitivity slip sensor's paper Vc returns to the initial state. According
to the CoP slip paper it converges to about 3 V from an initial 2 V, for steps of 1.4, 1.6 and 2.1 V, due to
hysteresis. So ``recovers``, the share of the step that is reversed, is a parameter: RESTORED, the default,
for the first, CONVERGED for the second. The latter is a share because the steps of that paper's Table I are
twice those of its own fit (see ORIGINS).

Pre-slip fluctuation: Cattaneo and Mindlin's contact. Under the tangential force T = q·mu·N only a core
of radius a·(1 - q)^(1/3) still sticks; the ring outside it slips. The slipped distance is the contact's
motion beyond that of a fully stuck one,

    S(q) = 3/2·(1 - (1 - q)^(2/3)) - q,   dS/dq = (1 - q)^(-1/3) - 1,

which starts flat and steepens without bound as q -> 1. Each patch of rubber that lets go is one event of
a Poisson process with the rate dS/dt; it suddenly divides some current paths and rings at the rubber's own
shear resonance. Only the inner part of the contact is pressed hard enough to conduct, so Vc shows the first
event when the ring reaches it: q = 1 - CONDUCTING_RADIUS^3 = 0.875 with that choice. The high-sensitivity
slip sensor fluctuates from 0.05 s of a static phase of 0.4 s on, PUBLISHED_ONSET; the q from which Vc shows
events is therefore a parameter (``first``), and the lead of a flag depends on it.

Not modelled: creep of the divider curve, spread between lots, temperature, wear, the spatial field of the
contact, a rate effect of shear on events, inertia of the plate. The fit for 0.01 to 3 mm/s is also used
outside these speeds. Hysteresis of the divider, 1/f noise of the carbon paths, hum and bursts of events are
options (physics.disturbances).
"""

from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import Floats, V, finite
from meissner.physics.front import LowPass

SUPPLY_V = 5.0
SERIES_OHM = 1000.0
POINTS = ((0.0, 5.0), (0.5, 4.0), (1.0, 3.0), (1.7, 2.0))  # newtons, volts: published
SHEAR_EXPONENT = 0.11  # published
SHEAR_LINE = (1.55, 0.27)  # published: k = 1.55 - 0.27·Vi
SHEAR_TAPER = 0.47  # V of k per V of Vi below the supply, to meet the line at 4 V; chosen
SHEAR_FULL_MM = 0.01  # published: the step is complete after this shear
# Standard deviation of the step between measurements, as a share of it: the largest of ten deviations of
# three measurements is published as 0.04 V, on average 1.68 times the true one; the step is 0.53 V.
SHEAR_SPREAD = 0.045
RECOVERY_S = 5.0  # published: stable by then
# Share of the step that is reversed. Published (high-sensitivity sensor): restored to the initial state.
RESTORED = 1.0
# Published (CoP slip): about 3 V from 2 V. One volt remains of 1.4, 1.6 and 2.1 V: 0.71, 0.63 and 0.48.
CONVERGED = 0.4

# Published: the plate moved about 0.1 mm while the force rose to slip. The force is not printed: 1.2 N under
# 2 N is chosen.
STIFFNESS_N_MM = 12.0
# The initial-slip sensor is 2.0 mm thick with its electrodes (published); the rubber's share of it, 1.5 mm,
# is chosen. The high-sensitivity sensor is 0.5 mm thick (published), which would ring at 5.9 kHz, above half
# the rate. Density and loss factor (quality 3) are ordinary values for a filled silicone, chosen.
SIDE_MM, THICKNESS_MM, DENSITY_KG_M3, QUALITY = 6.0, 1.5, 1200.0, 3.0


@finite
def ring(thickness_mm: float, quality: float) -> tuple[float, float]:
    """Hertz and decay in seconds of a layer of that stiffness: a quarter wave, sqrt(k·h/(A·rho))/(4·h)."""
    modulus_pa = STIFFNESS_N_MM * thickness_mm / SIDE_MM**2 * 1e6
    hz = np.sqrt(modulus_pa / DENSITY_KG_M3) / (4e-3 * thickness_mm)
    return hz, quality / (np.pi * hz)


RING_HZ, RING_S = ring(THICKNESS_MM, QUALITY)  # 3.4 kHz

CONDUCTING_RADIUS = 0.5  # of the contact's radius; chosen: events in the last eighth of the pull
PUBLISHED_ONSET = 0.12  # of the friction limit: published, 0.05 s of 0.4 s
PATCHES = 200  # that let go from the first event to the slip, if the first is at ONSET_RATIO; chosen
# Standard deviation of log amplitude; chosen. The wait from the first event to one above the threshold
# depends on it and on PATCHES: 9 ms on average, 6 ms at 0.2 and 17 ms at 0.5, the maximum kept near 0.04 V.
EVENT_SPREAD = 0.35
EVENT_SHARE = 0.0135  # median share of the conductance in one event; chosen to reach the published 0.04 V
SLIDING_SHARE = 0.5  # times EVENT_SHARE, in stick-slip; chosen: published as small
GROSS_SHARE = 25.0  # times EVENT_SHARE, when the last core lets go; chosen: published only as a drop of Vc

_FORCE, _VOLTS = np.array(POINTS[1:]).T
_LOG_FORCE = np.log(_FORCE)


@cache
def _curve() -> tuple[Callable[[V], V], Floats]:
    """log G over log F inside the published points, and its slopes at both ends."""
    from scipy.interpolate import PchipInterpolator  # imported here: only rubber needs to wait for SciPy

    curve = PchipInterpolator(_LOG_FORCE, np.log((SUPPLY_V - _VOLTS) / _VOLTS / SERIES_OHM))
    return curve, curve(_LOG_FORCE[[0, -1]], 1)


@finite
def conductance(force_n: V) -> V:
    """G(F) in siemens; 0 where nothing presses."""
    with np.errstate(divide="ignore"):
        log_force = np.log(np.maximum(force_n, 0.0))
    below = np.minimum(log_force - _LOG_FORCE[0], 0.0)
    above = np.maximum(log_force - _LOG_FORCE[-1], 0.0)
    inside = np.clip(log_force, _LOG_FORCE[0], _LOG_FORCE[-1])
    curve, slopes = _curve()
    return np.exp(curve(inside) + slopes[0] * below + slopes[1] * above)


def _divided(siemens: V) -> V:
    return SUPPLY_V / (1.0 + SERIES_OHM * siemens)


@finite
def divider_volts(siemens: V) -> V:
    """Vc for a conductance."""
    return _divided(siemens)


@finite
def rest_volts(force_n: V) -> V:
    """Vi: Vc under a normal force alone."""
    return _divided(conductance(force_n))


@finite
def shear_gain(rest_v: V) -> V:
    """k of the shear step. The published line holds from 2 to 4 V; above, it tapers to 0 at 5 V (chosen)."""
    return np.minimum(SHEAR_LINE[0] - SHEAR_LINE[1] * rest_v, SHEAR_TAPER * (SUPPLY_V - rest_v))


@finite
def shear_step(rest_v: V, speed_mm_s: V) -> V:
    """dV = k·v^n, the full step at a steady shear speed."""
    return shear_gain(rest_v) * np.abs(speed_mm_s) ** SHEAR_EXPONENT


@finite
def shear_level(time_s: ArrayLike, speed_mm_s: ArrayLike, recovers: float = RESTORED) -> Floats:
    """u(t) = dV/k for a shear speed that changes in steps; one exponential per step.

    ``recovers``: the share of u that is reversed when the shear stops.
    """
    time_s, speed_mm_s = np.asarray(time_s), np.asarray(speed_mm_s)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(speed_mm_s)) + 1, [len(time_s)]])
    level, start = np.zeros(len(time_s)), 0.0
    for first, last in pairwise(edges):
        speed = abs(speed_mm_s[first])
        # "Complete" and "stable" are taken as three time constants: 95 % of the way.
        rate = 3.0 * (speed / SHEAR_FULL_MM + 1.0 / RECOVERY_S)
        target = speed**SHEAR_EXPONENT if speed else (1.0 - recovers) * start
        since = time_s[first:last] - time_s[max(first - 1, 0)]
        level[first:last] = target + (start - target) * np.exp(-rate * since)
        start = level[last - 1]
    return level


@finite
def slipped(ratio: V) -> V:
    """S(q): the distance slipped in the ring at q = tangential force / (mu · normal force)."""
    ratio = np.clip(ratio, 0.0, 1.0)
    return 1.5 * (1.0 - (1.0 - ratio) ** (2.0 / 3.0)) - ratio


ONSET_RATIO = 1.0 - CONDUCTING_RADIUS**3  # q at which the ring reaches conducting rubber

# Delay: median time from the first event to the flag; lead: least time from the flag to the slip; both over
# the first 60 seeds of acrylic_slip with only that constant changed. Unchanged: 4.3 ms and 325 ms.
ORIGINS = {
    "SUPPLY_V": ("published", "slip papers, structure: 5 V", "codes per volt: every threshold in codes"),
    "SERIES_OHM": (
        "published",
        "slip papers, structure: 1 kOhm",
        "none: only the ratio to the rubber counts",
    ),
    "POINTS": (
        "published",
        "shear (journal), 4.2 and 4.3 and fig. 13; CoP slip, IV: 5, 4, 3, 2 V at 0, 0.5, 1.0, about 1.7 N",
        "volts of an event and of the ripple; between and beyond the points the curve is chosen (monotone, "
        "power law): 3 and 4 N lie beyond",
    ),
    "SHEAR_EXPONENT": (
        "published",
        "shear (journal), table 2 and eq. 5: 0.11; its row of 2 V has 0.12",
        "size of the shear step; no flag depends on it (too slow for the detail)",
    ),
    "SHEAR_LINE": (
        "published",
        "shear (journal), eq. 4 and fig. 15; CoP slip, eq. 2. The steps of Table 1 are twice as large",
        "size of the shear step; drop of the load in cop_slip",
    ),
    "SHEAR_TAPER": (
        "chosen",
        "keeps Vc below the supply: from the end of the line, 0.47 V at 4 V, the step falls linearly to 0",
        "shear step under less than 0.5 N, which no scene has while it shears",
    ),
    "SHEAR_FULL_MM": (
        "published",
        "shear (journal), 3.2 and fig. 8; high-sensitivity sensor, II, III: by 0.01 mm or less; that this is "
        "95 % of an exponential is chosen",
        "rise of the shear step",
    ),
    "SHEAR_SPREAD": (
        "computed",
        "shear (journal), 4.1 and fig. 8: at most 0.04 V in ten deviations of three measurements; that it "
        "is a share of the step is chosen",
        "the scenes of sensor shear: intervals of k and n, and how wrong the speed of one step is",
    ),
    "RECOVERY_S": (
        "published",
        "CoP slip, IV: about 5 s to the stable value; that this is 95 % of an exponential is chosen",
        "Vc after a shear stops; no flag",
    ),
    "RESTORED": (
        "published",
        "high-sensitivity sensor, II: restored to the initial state; CoP slip disagrees (CONVERGED)",
        "Vc after a shear stops; delay and lead are the same with either",
    ),
    "CONVERGED": (
        "computed",
        "CoP slip, IV: Vc converges to about 3 V from 2 V, after table I's steps of 1.4, 1.6 and 2.1 V: "
        "0.29, 0.38, 0.52 of them reversed; 0.4, near their mean, is chosen",
        "Vc after a shear stops, where a scene asks for it (recovers = 0.4)",
    ),
    "STIFFNESS_N_MM": (
        "read off",
        "shear (journal), 3.2: about 0.1 mm while the force rises to slip, which is not printed; 1.2 N under "
        "2 N is chosen. The "
        "high-sensitivity sensor's text has 0.2 mm, which would be 6",
        "ring (2.4 kHz at 6, 4.8 kHz at 24); delay 2.7 ms at 6, 29.7 ms at 24, lead 314 and 194 ms",
    ),
    "SIDE_MM": ("published", "slip papers, structure: 6 mm x 6 mm", "the ring's frequency"),
    "THICKNESS_MM": (
        "chosen",
        "share of the initial-slip sensor's published 2.0 mm with electrodes. 0.5 mm IS published: "
        "the high-sensitivity sensor (III; so cited by the initial-slip paper), the rubber of CoP slip (V)",
        "ring 5.9 kHz at 0.5, above half the rate: delay 21.7 ms, lead 278 ms",
    ),
    "DENSITY_KG_M3": (
        "chosen",
        "ordinary for a filled silicone; no paper gives it",
        "ring 3.7 kHz at 1000, 3.0 kHz at 1500: 5.5 and 3.6 ms, lead 287 and 278 ms",
    ),
    "QUALITY": (
        "chosen",
        "ordinary for a filled silicone; no paper gives it",
        "delay 0.4 ms at 10 and 38.9 ms at 1, lead 339 and 205 ms: the largest of all",
    ),
    "RING_HZ": (
        "computed",
        "quarter-wave shear resonance of STIFFNESS, THICKNESS, SIDE and DENSITY; published only that 1 kHz "
        "and more appear before slip",
        "share of an event that the detail sees: all delays",
    ),
    "RING_S": ("computed", "QUALITY/(pi RING_HZ)", "as QUALITY"),
    "CONDUCTING_RADIUS": (
        "chosen",
        "no paper says how much of the contact conducts; it puts the first event at 0.875 of the limit",
        "delay 2.9 ms and lead 62 ms at 0.3 (0.973 of the limit), 18.7 and 853 ms at 0.7 (0.657)",
    ),
    "PUBLISHED_ONSET": (
        "read off",
        "high-sensitivity sensor, III-D and fig. 9: from about 0.05 s on, of a static phase of 0.4 s",
        "slip_first_event: lead 2415 ms in the median, against 364 ms at 0.875 (100 seeds)",
    ),
    "PATCHES": (
        "chosen",
        "no paper counts events",
        "delay 73.5 ms at 20 and 0.7 ms at 2000, lead 14 and 339 ms",
    ),
    "EVENT_SPREAD": (
        "chosen",
        "no paper gives a distribution",
        "delay 3.9 ms at 0.2 and 3.6 ms at 0.5, lead 287 and 328 ms",
    ),
    "EVENT_SHARE": (
        "chosen",
        "to reach the initial-slip paper's +-0.04 V (IV-B, fig. 9) in the mean of runs",
        "delay 139 ms and lead 6 ms at half, with the state at contact in 29 % of the sliding; delay 0.4 ms "
        "at twice",
    ),
    "SLIDING_SHARE": (
        "chosen",
        "published only as small changes while sliding (shear, fig. 5; high-sensitivity sensor, fig. 8)",
        "share of the sliding in which the state says contact: 29 % at 0.25, none at 0.5; neither delay nor "
        "lead changes",
    ),
    "GROSS_SHARE": (
        "chosen",
        "published only as a drop of Vc when the plate begins to slide (shear, fig. 5)",
        "state gross at the slip; neither delay nor lead, which are the same without it",
    ),
    "ONSET_RATIO": ("computed", "1 - CONDUCTING_RADIUS^3", "as CONDUCTING_RADIUS"),
}


@finite
def event_ratios(rng: np.random.Generator, first: float = ONSET_RATIO, share: float = 1.0) -> Floats:
    """The values of q, ascending, at which patches let go: a Poisson process with the rate dS.

    ``first``: q from which Vc shows them, always as many per slipped distance. ``share``: of all patches.
    """
    grid = 1.0 - (1.0 - first) * np.linspace(1.0, 0.0, 512) ** 3  # dense where dS is steep
    start, stop = slipped(first), slipped(1.0)
    mean = PATCHES * ((stop - start) / (stop - slipped(ONSET_RATIO))) * share
    count = max(1, rng.poisson(mean))  # a contact slips only after a patch has let go
    return np.interp(np.sort(rng.uniform(start, stop, count)), slipped(grid), grid)


@finite
def event_shares(count: int, scale: float, rng: np.random.Generator) -> Floats:
    """Signed shares of the conductance, log-normal in size; either sign, since paths part and rejoin."""
    size = np.exp(EVENT_SPREAD * rng.standard_normal(count))
    return EVENT_SHARE * scale * size * rng.choice((-1.0, 1.0), count)


@finite
def fluctuation(
    times_s: ArrayLike, shares: ArrayLike, samples: int, rate_hz: float, low_pass: LowPass | None = None
) -> Floats:
    """e(t): each event steps by its share and rings down, exp(-t/RING_S)·cos(2·pi·RING_HZ·t).

    One complex pole computes all events; the first sample after each has the phase reached by then, so events
    keep their exact instants. Behind a ``low_pass``, with its W and p of meissner.physics.front, and s the
    pole of the ring, an event of size 1 is exactly Re(W (a exp(st) + b exp(s*t) - (a + b) exp(pt)) / 2) with
    a = p/(p - s), b = p/(p - s*).
    """
    from scipy.signal import lfilter

    pole = -1.0 / RING_S + 2j * np.pi * RING_HZ
    position = np.asarray(times_s) * rate_hz
    index = np.ceil(position).astype(np.int64)
    kept = (index >= 0) & (index < samples)

    def rung(pole: complex) -> NDArray[np.complex128]:
        per_sample = pole / rate_hz
        drive = (np.asarray(shares) * np.exp(per_sample * (index - position)))[kept]
        comb = np.bincount(index[kept], drive.real, samples) + 1j * np.bincount(
            index[kept], drive.imag, samples
        )
        return lfilter([1.0], [1.0, -np.exp(per_sample)], comb)

    if low_pass is None:
        return rung(pole).real
    size, own = low_pass.mode
    a, b = own / (own - pole), own / (own - pole.conjugate())
    ring = rung(pole)
    return (size / 2 * (a * ring + b * ring.conjugate() - (a + b) * rung(own))).real


@finite
def event_steps(vc: V, shares: V) -> V:
    """The step of Vc, in volts, due to each event when Vc is ``vc``: dVc/dG·G = -Vc·(5-Vc)/5."""
    return -vc * (SUPPLY_V - vc) / SUPPLY_V * shares


@finite
def volts(force_n: V, level: V | None = None, share: V | None = None) -> V:
    """Vc in volts.

    Parameters
    ----------
    force_n : float or array
        Normal force, newtons.
    level, share : like ``force_n``, optional
        The shear level u(t) and the fluctuation e(t).
    """
    vc = rest_volts(force_n)
    if level is not None:
        vc = vc + shear_gain(vc) * level
    if share is not None:
        ratio = (SUPPLY_V - vc) / vc * np.maximum(1.0 + share, 0.0)
        vc = SUPPLY_V / (1.0 + ratio)
    return vc
