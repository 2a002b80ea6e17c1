"""Disturbances of a rubber sensor other than slip; each is off unless a scene's condition enables it.

    hum          V + hum_v·sin(2·pi·HUM_HZ·t + phase)    mains on the leads, one phase per run
    flicker      G·(1 + n(t)),  S_n(f) = flicker²/(ln 10·f)     1/f noise: flicker rms in each decade
    hysteresis   F' = F·exp(h·(y - ln F)),  y the play of ln F, HYSTERESIS_WIDTH wide
    bursts       patches let go in groups of a geometric number, mean ``burst``, within about BURST_S

Play (backlash): y rises with ln F and stays when F turns, until ln F has fallen by the width. So Vc follows
the published curve, measured while loading, as long as the force rises; while it falls, Vc shows up to exp(h)
times the force, as unloading rubber does. Of a small reversal Vc still shows the part 1 - h.

Not modelled: harmonics of the mains, flicker that grows with the current, minor loops that creep.
"""

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, finite

HUM_HZ = 50.0
HYSTERESIS_WIDTH = 1.0  # of ln F, from one branch to the other
FORCE_FLOOR_N = 1e-3  # below this force no branch is remembered
BURST_S = 0.002  # mean delay of a burst's patches after its first

ORIGINS = {
    "HUM_HZ": ("chosen", "the mains where the papers were written in part: 50 Hz", "place of the hum's line"),
    "HYSTERESIS_WIDTH": (
        "chosen",
        "no paper gives the loop's shape",
        "how far a force must fall until Vc is on the unloading branch; grip_slip, hysteresis alone",
    ),
    "FORCE_FLOOR_N": ("chosen", "numerical: ln 0", "none"),
    "BURST_S": (
        "chosen",
        "the width of a third of a window; no paper counts events",
        "delay in grip_slip, correlated: events within a window add up in p2p",
    ),
}


@finite
def hum(time_s: ArrayLike, amplitude_v: float, rng: np.random.Generator) -> Floats:
    """Volts to add to Vc."""
    return amplitude_v * np.sin(2 * np.pi * HUM_HZ * np.asarray(time_s) + rng.uniform(0, 2 * np.pi))


@finite
def flicker(samples: int, rate_hz: float, share: float, rng: np.random.Generator) -> Floats:
    """Share of G to add [samples]: spectrum share²/(ln 10·f), from one period per run to Nyquist."""
    hertz = np.fft.rfftfreq(samples, 1.0 / rate_hz)
    density = np.zeros(len(hertz))
    density[1:] = share**2 / np.log(10.0) / hertz[1:]
    draw = rng.standard_normal((2, len(hertz)))
    spectrum = np.sqrt(density * rate_hz * samples / 4.0) * (draw[0] + 1j * draw[1])
    return np.fft.irfft(spectrum, samples)


@finite
def play(x: ArrayLike, width: float) -> Floats:
    """y[t] = max(x[t], min(x[t] + width, y[t-1])), y[-1] = x[0].

    Each step clamps y to [x, x + width]. Two clamps in sequence are again a clamp, so log2 of the length
    passes over all of x suffice.
    """
    low, high = np.array(x, dtype=float), np.asarray(x, dtype=float) + width
    high[0] = low[0]
    reach = 1
    while reach < len(low):
        before = low[:-reach].copy(), high[:-reach].copy()
        own = low[reach:].copy(), high[reach:].copy()
        low[reach:], high[reach:] = (np.clip(edge, *own) for edge in before)
        reach *= 2
    return low


@finite
def hysteresis(force_n: Floats, share: float) -> Floats:
    """The force that the divider curve shows for ``force_n`` [samples]."""
    logarithm = np.log(np.maximum(force_n, FORCE_FLOOR_N))
    return force_n * np.exp(share * (play(logarithm, HYSTERESIS_WIDTH) - logarithm))


@finite
def bursts(first_s: Floats, mean: float, until_s: float, rng: np.random.Generator) -> Floats:
    """Instants, ascending, before ``until_s``, of patches in bursts of ``mean`` beginning at ``first_s``."""
    sizes = rng.geometric(1.0 / mean, len(first_s))
    begins = np.cumsum(sizes) - sizes
    wait_s = rng.exponential(BURST_S, int(sizes.sum()))
    wait_s[begins] = 0.0
    times_s = np.sort(np.repeat(first_s, sizes) + wait_s)
    return times_s[times_s < until_s]
