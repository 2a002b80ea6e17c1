"""Form of the demodulator and samples per carrier period, against spread, bias and phase error."""

from functools import lru_cache

import numpy as np

from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.frontend.am_demod import IQ, IQ_FAST, RECTIFIER, AmDemod

BITS, OFFSET, PERIODS = 12, 2048, 8
PHASES, RUNS = 64, 400
FORMS = {"rectifier, offset known": None, "rectifier": RECTIFIER, "I/Q estimated": IQ_FAST, "I/Q": IQ}


@lru_cache(maxsize=4)
def samples_of(n, snr_db, periods=PERIODS, runs=RUNS):
    """(codes [phases, runs, samples] of noisy carriers, amplitude); 4 sigma of noise fit the range."""
    rng = np.random.default_rng(1)
    ratio = np.sqrt(0.5) / 10 ** (snr_db / 20)  # rms noise over amplitude
    amplitude = min(1000.0, 2000 / (1 + 4 * ratio))
    phase = 2 * np.pi * (np.arange(PHASES) + 0.5) / PHASES
    time = 2 * np.pi * np.arange(n * periods) / n
    noise = ratio * rng.standard_normal((PHASES, runs, n * periods))
    codes = OFFSET + amplitude * (np.cos(time + phase[:, None])[:, None] + noise)
    return np.clip(np.rint(codes), 0, 2**BITS - 1).astype(np.int64), amplitude


def shift_of(demod, periods=PERIODS):
    return max(0, int(np.ceil(np.log2(demod.gain(periods) * 1.5 * 2 ** (BITS - 1) / 2**16))))


def amplitudes(form, n, codes, periods=PERIODS):
    """The demodulated amplitudes in codes."""
    if form is None:  # the plain precision rectifier with known zero
        return np.abs(codes - OFFSET).mean(axis=-1) * np.pi / 2
    demod = AmDemod(form, n)
    shift = shift_of(demod, periods)
    return demod.amplitude(codes, shift)[0] * 2**shift / demod.gain(periods)


def figures(form, n, snr_db, periods=PERIODS, runs=RUNS):
    """(spread, bias) in per cent of the amplitude."""
    codes, amplitude = samples_of(n, snr_db, periods, runs)
    got = amplitudes(form, n, codes, periods) / amplitude
    return 100 * np.sqrt(got.var(axis=-1).mean()), 100 * (got.mean() - 1)


def phase_error(form, n, periods=PERIODS):
    """Largest deviation from the mean over all phases, without noise, in per cent."""
    got = amplitudes(form, n, samples_of(n, 200, periods, 1)[0][:, 0], periods)
    return 100 * np.abs(got / got.mean() - 1).max()


def error(point):
    form, n, periods = FORMS[point["form"]], point["samples"], point["periods"]
    spread, bias = figures(form, n, 20, periods, point["runs"])
    phase = phase_error(form, n, periods)
    return {
        "spread": float(spread),
        "phase": float(phase),
        "both": float(np.hypot(spread, phase)),
        "bias": float(bias),
        "bias_weak": float(figures(form, n, 0, periods, point["runs"])[1]),
    }


def cost(point):
    demod = AmDemod(FORMS[point["form"]], point["samples"])
    return {
        "measured": point["samples"] * point["periods"],
        "clocks": demod.latency(shift_of(demod, point["periods"])),
    }


AXES = (
    Axis(
        name="demod",
        title="Demodulator of a carrier's amplitude",
        about="4, 8 or 16 samples a period, 1 to 64 periods",
        values={
            "form": ("rectifier", "I/Q estimated", "I/Q"),
            "samples": (4, 8, 16),
            "periods": (1, 2, 4, 8, 16),
        },
        quick={"periods": (4, 8)},
        shipped={"form": "I/Q", "samples": 4, "periods": 4},
        runs={"runs": (400, 40)},
        legal=lambda point: point["samples"] in (4, 8, 16) and 1 <= point["periods"] <= 64,
        cost=cost,
        error=error,
        figures=(
            Figure("measured", "samples of a measurement", "samples", judged=True),
            Figure("clocks", "last sample to amplitude", "clocks", judged=True),
            Figure("both", "spread at 20 dB and phase together", "% of the amplitude", judged=True),
            Figure("spread", "spread of one measurement, 20 dB", "%"),
            Figure("phase", "by the phase alone, largest", "%"),
            Figure("bias", "bias of the mean, 20 dB", "%"),
            Figure("bias_weak", "the same, 0 dB", "%"),
        ),
        panels=(("measured", "both"), ("clocks", "both")),
    ),
)
