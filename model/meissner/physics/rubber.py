"""Pressure-conductive rubber, 6 mm square on two spiral electrodes, in series with 1 kOhm to 5 V.

    Vc   = 5 V / (1 + R·G)                       R = 1 kOhm, G the rubber's conductance
    G(F) : through the published points          5, 4, 3, 2 V at 0, 0.5, 1.0, 1.7 N
    dV   = k·v^n,  k = 1.55 - 0.27·Vi, n = 0.11  rise of Vc while the rubber shears at v mm/s
    G    = G(F, dV)·(1 + e(t))                   e: micro events of partial slip and stick-slip

Between the points log G is a monotone cubic of log F, beyond them a power law with the end slope.

Shear: with u = dV/k, du/dt = (v^n - u)·(v/X0 + 1/T0). While shearing, u reaches v^n within 0.01 mm; after
it, u falls back within about 5 s. Both numbers are published.

Pre-slip fluctuation: Cattaneo and Mindlin's contact. Under the tangential force T = q·mu·N only a core
of radius a·(1 - q)^(1/3) still sticks; the ring outside it slips. The distance slipped is what the
contact moves beyond a fully stuck one,

    S(q) = 3/2·(1 - (1 - q)^(2/3)) - q,   dS/dq = (1 - q)^(-1/3) - 1,

which starts flat and steepens without bound as q -> 1. Each patch of rubber that lets go is one event of
a Poisson process with the rate dS/dt; each divides some current paths at once and rings at the rubber's
own shear resonance. Only the inner part of the contact is pressed hard enough to conduct, so the first
event that Vc shows is when the ring reaches it.

Not modelled: hysteresis and creep of the divider curve, spread between lots, temperature, wear, 1/f noise
of the carbon paths, the spatial field of the contact (events are independent), a rate effect of shear on
events, inertia of the plate, speeds outside the fit's 0.01 to 3 mm/s (used beyond it as it stands).
"""

from functools import cache
from itertools import pairwise

import numpy as np

SUPPLY_V = 5.0
SERIES_OHM = 1000.0
POINTS = ((0.0, 5.0), (0.5, 4.0), (1.0, 3.0), (1.7, 2.0))  # newtons, volts: published
SHEAR_EXPONENT = 0.11  # published
SHEAR_FULL_MM = 0.01  # published: the step is complete by then
RECOVERY_S = 5.0  # published: back at the start by then

# The plate moved about 0.1 mm while the force rose to slip (about 1.2 N at 2 N): published, as a reading.
STIFFNESS_N_MM = 12.0
# The published sensor is 2.0 mm thick with its electrodes; the rubber's share, its density and its loss
# factor (quality 3) are ordinary values for a filled silicone, chosen.
SIDE_MM, THICKNESS_MM, DENSITY_KG_M3, QUALITY = 6.0, 1.5, 1200.0, 3.0
# Quarter-wave shear resonance of a layer with that stiffness: sqrt(k·h/(A·rho))/(4·h), 3.4 kHz.
_MODULUS_PA = STIFFNESS_N_MM * THICKNESS_MM / SIDE_MM**2 * 1e6
RING_HZ = np.sqrt(_MODULUS_PA / DENSITY_KG_M3) / (4e-3 * THICKNESS_MM)
RING_S = QUALITY / (np.pi * RING_HZ)

CONDUCTING_RADIUS = 0.5  # of the contact's radius; chosen: events in the last eighth of the pull
PATCHES = 200  # that let go between the first event and the slip; chosen
# Standard deviation of log amplitude; chosen. The wait from the first event to one above the threshold
# rests on this and on PATCHES: 9 ms in the mean, 6 ms at 0.2 and 17 ms at 0.5, the maximum held near 0.04 V.
EVENT_SPREAD = 0.35
EVENT_SHARE = 0.0135  # median share of the conductance in one event; chosen to reach the published 0.04 V
SLIDING_SHARE = 0.5  # of EVENT_SHARE, in stick-slip; chosen: published as small
GROSS_SHARE = 25.0  # of EVENT_SHARE, when the last core lets go; chosen: published only as a drop of Vc

_FORCE, _VOLTS = np.array(POINTS[1:]).T
_LOG_FORCE = np.log(_FORCE)


@cache
def _curve():
    """log G over log F inside the published points, and its slopes at both ends."""
    from scipy.interpolate import PchipInterpolator  # here: what simulates no rubber does not wait for SciPy

    curve = PchipInterpolator(_LOG_FORCE, np.log((SUPPLY_V - _VOLTS) / _VOLTS / SERIES_OHM))
    return curve, curve(_LOG_FORCE[[0, -1]], 1)


def conductance(force_n):
    """G(F) in siemens; 0 where nothing presses."""
    with np.errstate(divide="ignore"):
        log_force = np.log(np.maximum(force_n, 0.0))
    below = np.minimum(log_force - _LOG_FORCE[0], 0.0)
    above = np.maximum(log_force - _LOG_FORCE[-1], 0.0)
    inside = np.clip(log_force, _LOG_FORCE[0], _LOG_FORCE[-1])
    curve, slopes = _curve()
    return np.exp(curve(inside) + slopes[0] * below + slopes[1] * above)


def divider_volts(siemens):
    """Vc of a conductance."""
    return SUPPLY_V / (1.0 + SERIES_OHM * siemens)


def rest_volts(force_n):
    """Vi: Vc under a normal force alone."""
    return divider_volts(conductance(force_n))


def shear_gain(rest_v):
    """k of the shear step. The published line holds from 2 to 4 V; above, it tapers to 0 at 5 V (chosen)."""
    return np.minimum(1.55 - 0.27 * np.asarray(rest_v), 0.47 * (SUPPLY_V - rest_v))


def shear_step(rest_v, speed_mm_s):
    """dV = k·v^n, the full step at a steady shear speed."""
    return shear_gain(rest_v) * np.abs(speed_mm_s) ** SHEAR_EXPONENT


def shear_level(time_s, speed_mm_s):
    """u(t) = dV/k for a shear speed that changes in steps; one exponential per step."""
    time_s, speed_mm_s = np.asarray(time_s), np.asarray(speed_mm_s)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(speed_mm_s)) + 1, [len(time_s)]])
    level, start = np.zeros(len(time_s)), 0.0
    for first, last in pairwise(edges):
        speed = abs(speed_mm_s[first])
        # Three time constants are "complete" and "back": 95 % of the way.
        rate = 3.0 * (speed / SHEAR_FULL_MM + 1.0 / RECOVERY_S)
        target = speed**SHEAR_EXPONENT if speed else 0.0
        since = time_s[first:last] - time_s[max(first - 1, 0)]
        level[first:last] = target + (start - target) * np.exp(-rate * since)
        start = level[last - 1]
    return level


def slipped(ratio):
    """S(q): the distance slipped in the ring at q = tangential force / (mu · normal force)."""
    ratio = np.clip(ratio, 0.0, 1.0)
    return 1.5 * (1.0 - (1.0 - ratio) ** (2.0 / 3.0)) - ratio


ONSET_RATIO = 1.0 - CONDUCTING_RADIUS**3  # q at which the ring reaches conducting rubber


def event_ratios(rng):
    """The values of q, ascending, at which patches let go: a Poisson process with the rate dS."""
    grid = 1.0 - (1.0 - ONSET_RATIO) * np.linspace(1.0, 0.0, 512) ** 3  # dense where dS is steep
    count = max(1, rng.poisson(PATCHES))  # a contact that slips has let go somewhere first
    start, stop = slipped(ONSET_RATIO), slipped(1.0)
    return np.interp(np.sort(rng.uniform(start, stop, count)), slipped(grid), grid)


def event_shares(count, scale, rng):
    """Signed shares of the conductance: paths part and rejoin, so either sign, log-normal in size."""
    size = np.exp(EVENT_SPREAD * rng.standard_normal(count))
    return EVENT_SHARE * scale * size * rng.choice((-1.0, 1.0), count)


def fluctuation(times_s, shares, samples, rate_hz):
    """e(t): each event steps by its share and rings down, exp(-t/RING_S)·cos(2·pi·RING_HZ·t).

    One complex pole does all events; the first sample after each carries the phase it has by then, so
    that events keep their exact instants.
    """
    from scipy.signal import lfilter

    pole = (-1.0 / RING_S + 2j * np.pi * RING_HZ) / rate_hz
    position = np.asarray(times_s) * rate_hz
    index = np.ceil(position).astype(np.int64)
    kept = (index >= 0) & (index < samples)
    drive = (np.asarray(shares) * np.exp(pole * (index - position)))[kept]
    comb = np.bincount(index[kept], drive.real, samples) + 1j * np.bincount(index[kept], drive.imag, samples)
    return lfilter([1.0], [1.0, -np.exp(pole)], comb).real


def event_steps(vc, shares):
    """The step of Vc, in volts, that each event makes where Vc stands at ``vc``: dVc/dG·G = -Vc·(5-Vc)/5."""
    return -vc * (SUPPLY_V - vc) / SUPPLY_V * shares


def volts(force_n, level=None, share=None):
    """Vc under a normal force, with the shear level u(t) and the fluctuation e(t) where there are any."""
    vc = rest_volts(force_n)
    if level is not None:
        vc = vc + shear_gain(vc) * level
    if share is not None:
        ratio = (SUPPLY_V - vc) / vc * np.maximum(1.0 + share, 0.0)
        vc = SUPPLY_V / (1.0 + ratio)
    return vc
