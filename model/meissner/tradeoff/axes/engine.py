"""Engines: simulated samples per second against the error of peak to peak, in codes."""

import time

import numpy as np

from meissner import engines
from meissner.names import NAMES
from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.slip.config import SlipConfig

CHECKED = 64 * 200  # samples that ``_by_hand`` checks
CONFIG = SlipConfig(threshold=230)


def _samples(count):
    # Quiet noise that gives a slip in about one of a thousand windows, like a held object.
    return np.random.default_rng(1).integers(-60, 60, count)


def _by_hand(samples):
    """Peak to peak of d = x[2k] - x[2k+1] in each window of 64 samples, in plain integers."""
    found = []
    for start in range(0, len(samples) - 63, 64):
        d = [int(samples[at]) - int(samples[at + 1]) for at in range(start, start + 64, 2)]
        found.append(max(d) - min(d))
    return np.array(found)


def error(point):
    samples = _samples(CHECKED)
    got = engines.process_slip(samples, CONFIG, point["engine"])
    expected = _by_hand(samples)
    return {
        "p2p": float(np.abs(np.asarray(got["p2p"][0], float) - expected).max()),
        "decisions": int((got["slip"][0] != (expected > CONFIG.threshold)).sum()),
    }


def cost(point):
    samples = _samples(point["samples"])
    engines.process_slip(samples[:1000], CONFIG, point["engine"])  # build, warm up
    times = []
    for _ in range(point["repeats"]):
        began = time.process_time()
        engines.process_slip(samples, CONFIG, point["engine"])
        times.append(time.process_time() - began)
    rate = len(samples) / min(times)
    return {"msamples_s": rate / 1e6, "ns": 1e9 / rate}


AXES = (
    Axis(
        name="engine",
        title="Engines: error against simulated samples a second",
        about="float, fixed and rtl; one channel, windows of 64",
        values={"engine": tuple(NAMES)},
        shipped={"engine": "fixed"},
        runs={"samples": (5_000_000, 500_000), "repeats": (3, 1)},
        cost=cost,
        error=error,
        timed=("msamples_s", "ns"),
        figures=(
            Figure("ns", "time of a sample", "ns", judged=True),
            Figure("p2p", "error of peak to peak", "codes", judged=True),
            Figure("decisions", "wrong decisions"),
            Figure("msamples_s", "samples a second", "millions"),
        ),
        panels=(("ns", "p2p"),),
    ),
)
