"""The plate on the rubber: how it is pressed, and how a stage pulls it through a string and a load cell.

    T = K·v·t                          until T = mu_s·N: the contact sticks (in parts, see rubber)
    T = (mu_k + (mu_s - mu_k)·exp(-t/T0))·N  from then on, with stick-slip around it
    slip = v·t - T/K                   stage travel minus the stretch of string and rubber

Quasi-static: the string is so soft (30 mm of stage travel to the slip) that the rise takes 3 s at 2 N on
acrylic, as published, and proportionally longer with more load or friction.

A grip that follows the load: N = N0 + f·T, so the contact slips at T = mu·N0/(1 - mu·f), f below 1/mu. The
stick zone only shrinks (1/f > mu), so by Jaeger's superposition the slipped ring is that of Cattaneo and
Mindlin for q = T/(mu·N) under the present force. The follower ripples as the loading stage does.

Pressing: a raised-cosine ramp, plus a ripple of force while the loading stage moves. The ripple has no
content above 600 Hz, as published for a changing normal force.

Not modelled: inertia of the plate and its resonance with the string, static friction as the end of a stick
(its length is drawn, so with a drive as stiff as the rubber a long one exceeds mu_s·N), wear, humidity,
rotation, the dependence of friction on speed or load, vibration of the pulling stage, and friction
coefficients of a measured sample: the table has ordinary values against silicone rubber, chosen.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Bools, Floats, finite
from meissner.physics import rubber


@dataclass(frozen=True)
class Material:
    """Static and kinetic friction against the rubber, and the size of its micro events (acrylic is 1)."""

    mu_s: float
    mu_k: float
    fluctuation: float


# Published: cloth and paper have slightly smaller coefficients than acrylic, wood hardly differs. The
# numbers are chosen.
MATERIALS = {
    "acrylic": Material(0.70, 0.62, 1.0),
    "wood": Material(0.60, 0.53, 0.95),
    "cloth": Material(0.55, 0.49, 0.75),
    "paper": Material(0.50, 0.44, 0.7),
}

# Published: 3 s to the slip at 10 mm/s, 2 N, acrylic. String and rubber in series.
PULL_STIFFNESS_N_MM = MATERIALS["acrylic"].mu_s * 2.0 / 30.0
FRICTION_SPREAD = 0.03  # standard deviation from run to run, as a share; chosen
FALL_S = 0.04  # static to kinetic; chosen
RIPPLE_LIMIT_HZ = 600.0  # published
RIPPLE_N = 0.0055  # rms at full speed of loading; chosen to reach the published 0.005 V coefficient
FOLLOW_EDGE_S = 0.05  # time in which the follower's motor starts and stops; chosen

# Measured as for ORIGINS of rubber.
ORIGINS = {
    "MATERIALS": (
        "chosen",
        "friction: ordinary against silicone rubber, no paper gives any. Size of events: the initial-slip "
        "paper says slightly smaller for cloth and paper (IV-B, figs. 12 to 14)",
        "mu: how long a pull lasts, so lead and delay in proportion; fluctuation: as EVENT_SHARE, for its "
        "material",
    ),
    "PULL_STIFFNESS_N_MM": (
        "read off",
        "initial slip, fig. 4: 3 s to the slip at 10 mm/s under 2 N; with the chosen mu of acrylic",
        "how long a pull lasts: lead and delay in proportion",
    ),
    "FRICTION_SPREAD": (
        "chosen",
        "no paper gives a spread from run to run",
        "least lead: 253 ms at 0.1",
    ),
    "FALL_S": (
        "chosen",
        "no paper resolves the fall from static to kinetic",
        "none: delay and lead are the same at 0.01 and at 0.2",
    ),
    "RIPPLE_LIMIT_HZ": (
        "published",
        "initial slip, III-B and fig. 7: about 600 Hz is the highest when the normal force changes",
        "false alarms of normal_force, unmasked, 60 runs of load 2 N: 0; at 1200 Hz 31, at 2000 Hz 120",
    ),
    "RIPPLE_N": (
        "chosen",
        "to reach the initial-slip paper's +-0.005 V (IV-B, fig. 8) in the mean of runs",
        "false alarms of normal_force, unmasked, 60 runs of load 2 N: 0, and at 0.0083; at 0.011 20, at "
        "0.0165 120",
    ),
    "FOLLOW_EDGE_S": ("chosen", "so that the motor's start adds nothing above 600 Hz", "none seen"),
}


@dataclass(frozen=True)
class Pull:
    """One pull. ``slips_s``: instants of stick-slip after the whole contact lets go at ``gross_s``."""

    tension_n: Floats
    slip_mm: Floats
    shear_mm_s: Floats
    start_s: float
    gross_s: float
    slips_s: Floats
    bent: float = 0.0  # mu·f of a grip that follows

    @finite
    def time_of(self, ratio: ArrayLike) -> Floats:
        """The time at which the tension reaches ``ratio`` of the friction limit at that time."""
        ratio = np.asarray(ratio)
        part = ratio * (1.0 - self.bent) / (1.0 - self.bent * ratio)
        return self.start_s + part * (self.gross_s - self.start_s)


@finite
def rise_s(
    normal_n: float, speed_mm_s: float, material: str, follow: float = 0.0, spread: float = 1.0
) -> float:
    """Seconds from the start of the stage to the slip, at ``spread`` times the material's friction."""
    mu_s = MATERIALS[material].mu_s * spread
    return mu_s * normal_n / (1.0 - mu_s * follow) / (PULL_STIFFNESS_N_MM * speed_mm_s)


@finite
def pull(
    time_s: Floats,
    normal_n: float,
    speed_mm_s: float,
    material: str,
    start_s: float,
    rng: np.random.Generator,
    stiffness_n_mm: float = PULL_STIFFNESS_N_MM,
    follow: float = 0.0,
) -> Pull:
    """Pull the plate under a normal force, the stage starting at ``start_s``.

    Parameters
    ----------
    time_s : [samples]
        Seconds.
    material : str
        Of MATERIALS.
    stiffness_n_mm : float
        Of string and rubber in series.
    follow : float
        Added newtons of grip per newton of pull.
    """
    kind = MATERIALS[material]
    spread = 1.0 + FRICTION_SPREAD * rng.standard_normal()
    mu_s, mu_k = kind.mu_s * spread, kind.mu_k * spread
    static_n, kinetic_n = mu_s * normal_n / (1.0 - mu_s * follow), mu_k * normal_n / (1.0 - mu_k * follow)
    gross_s = start_s + static_n / (stiffness_n_mm * speed_mm_s)
    travel_mm = speed_mm_s * np.maximum(time_s - start_s, 0.0)
    after_s = np.maximum(time_s - gross_s, 0.0)
    sliding = time_s >= gross_s

    # A stick lasts until shear has restored the tension that the rubber lost: (Ts - Tk)/stiffness of travel.
    stick_s = (static_n - kinetic_n) / rubber.STIFFNESS_N_MM / speed_mm_s
    count = max(2, int(1.5 * max(time_s[-1] - gross_s, 0.0) / stick_s) + 8)
    slips_s = gross_s + np.cumsum(stick_s * rng.gamma(2.0, 0.5, count))
    # While the plate sticks the string stretches at the stage's speed; each slip releases it. With so soft a
    # string this is less than a millinewton, which neither this load cell nor the published one shows.
    bounds = np.concatenate([[gross_s], slips_s])
    last_s = bounds[np.maximum(np.searchsorted(bounds, time_s, "right") - 1, 0)]
    saw_n = stiffness_n_mm * speed_mm_s * (time_s - last_s)

    sliding_n = kinetic_n + (static_n - kinetic_n) * np.exp(-after_s / FALL_S) + saw_n
    tension_n = np.where(sliding, sliding_n, stiffness_n_mm * travel_mm)
    slip_mm = np.where(sliding, travel_mm - tension_n / stiffness_n_mm, 0.0)
    # The rubber shears while the tension rises; when sliding it shears no further and recovers.
    pulling = (time_s >= start_s) & ~sliding
    shear_mm_s = np.where(pulling, stiffness_n_mm * speed_mm_s / rubber.STIFFNESS_N_MM, 0.0)
    slips_s = slips_s[slips_s <= time_s[-1]]
    return Pull(tension_n, slip_mm, shear_mm_s, start_s, gross_s, slips_s, mu_s * follow)


def _ripple(samples: int, rate_hz: float, rng: np.random.Generator) -> Floats:
    """White noise of unit rms, band-limited to below 600 Hz."""
    bins = np.fft.rfftfreq(samples, 1.0 / rate_hz)
    inside = np.count_nonzero(bins < RIPPLE_LIMIT_HZ - 10.0)  # the ramp's envelope widens it by a few Hz
    spectrum = np.zeros(len(bins), dtype=complex)
    spectrum[1:inside] = rng.standard_normal(inside - 1) + 1j * rng.standard_normal(inside - 1)
    noise = np.fft.irfft(spectrum, samples)
    return noise / np.std(noise)


@finite
def press(
    time_s: Floats, normal_n: float, ramps: Sequence[tuple[float, float]], rng: np.random.Generator
) -> tuple[Floats, Bools]:
    """The normal force (N) and whether the loading stage moves, [samples] each.

    Parameters
    ----------
    ramps : sequence of (start_s, length_s)
        Alternately up and down.
    """
    rate_hz = 1.0 / (time_s[1] - time_s[0])
    force_n = np.zeros(len(time_s))
    moving = np.zeros(len(time_s), dtype=bool)
    for number, (start_s, length_s) in enumerate(ramps):
        first, last = np.searchsorted(time_s, [start_s, start_s + length_s])
        place = (time_s[first:last] - start_s) / length_s
        rise = 0.5 - 0.5 * np.cos(np.pi * place)
        down = number % 2
        speed = np.sin(np.pi * place) ** 2
        ramp_n = normal_n * (1.0 - rise if down else rise)
        force_n[first:last] = ramp_n + RIPPLE_N * speed * _ripple(last - first, rate_hz, rng)
        force_n[last:] = 0.0 if down else normal_n
        moving[first:last] = True
    return np.maximum(force_n, 0.0), moving


@finite
def followed(time_s: Floats, normal_n: float, pull: Pull, follow: float, rng: np.random.Generator) -> Floats:
    """The normal force of a grip that follows the pull; its motor causes ripple until the contact slips."""
    first, last = np.searchsorted(time_s, [pull.start_s, pull.gross_s])
    since_s = np.minimum(time_s[first:last] - pull.start_s, pull.gross_s - time_s[first:last])
    speed = np.sin(np.pi / 2 * np.clip(since_s / FOLLOW_EDGE_S, 0.0, 1.0)) ** 2
    force_n = normal_n + follow * pull.tension_n
    rate_hz = 1.0 / (time_s[1] - time_s[0])
    force_n[first:last] += RIPPLE_N * speed * _ripple(last - first, rate_hz, rng)
    return np.maximum(force_n, 0.0)
