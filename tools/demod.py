"""Which form of msn_am_demod at what signal-to-noise: Markdown table, and a picture with --picture FILE.

A carrier in a converter of 12 bits, 1000 codes or what its noise leaves room for, 8 periods a measurement,
white noise. Errors in % of the amplitude: the spread of single measurements at one phase, and the bias of
their mean over all phases, noise taken for carrier; `phase` is what the phase alone changes, without noise.
"""

import argparse

import numpy as np

from meissner.twins.frontend.am_demod import IQ, IQ_FAST, RECTIFIER, AmDemod

BITS, OFFSET, PERIODS = 12, 2048, 8
SNR_DB = (60, 40, 30, 20, 10, 5, 0, -5, -10)
PHASES, RUNS = 64, 400
FORMS = {"rectifier, offset known": None, "rectifier": RECTIFIER, "I/Q estimated": IQ_FAST, "I/Q": IQ}


def samples_of(n, snr_db):
    """Codes [phases, runs, samples] of noisy carriers and their amplitude; 4 sigma of noise fit the range."""
    rng = np.random.default_rng(1)
    ratio = np.sqrt(0.5) / 10 ** (snr_db / 20)  # noise, rms, by amplitude
    amplitude = min(1000.0, 2000 / (1 + 4 * ratio))
    phase = 2 * np.pi * (np.arange(PHASES) + 0.5) / PHASES
    time = 2 * np.pi * np.arange(n * PERIODS) / n
    noise = ratio * rng.standard_normal((PHASES, RUNS, n * PERIODS))
    codes = OFFSET + amplitude * (np.cos(time + phase[:, None])[:, None] + noise)
    return np.clip(np.rint(codes), 0, 2**BITS - 1).astype(np.int64), amplitude


def amplitudes(form, n, codes):
    """Amplitudes in codes."""
    if form is None:  # the plain precision rectifier, its zero set by hand
        return np.abs(codes - OFFSET).mean(axis=-1) * np.pi / 2
    demod = AmDemod(form, n)
    shift = max(0, int(np.ceil(np.log2(demod.gain(PERIODS) * 1.5 * 2 ** (BITS - 1) / 2**16))))
    return demod.amplitude(codes, shift)[0] * 2**shift / demod.gain(PERIODS)


def figures(form, n, snr_db):
    """Spread and bias in per cent."""
    codes, amplitude = samples_of(n, snr_db)
    got = amplitudes(form, n, codes) / amplitude
    return 100 * np.sqrt(got.var(axis=-1).mean()), 100 * (got.mean() - 1)


def phase_error(form, n):
    """Largest deviation from the mean over the phases, noise-free, in per cent."""
    got = amplitudes(form, n, samples_of(n, 200)[0][:, 0])
    return 100 * np.abs(got / got.mean() - 1).max()


def draw(curves, path):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for name, values in curves.items():
        axes[0].semilogy(SNR_DB, values[:, 0], marker="o", label=name)
        axes[1].plot(SNR_DB, values[:, 1], marker="o", label=name)
    for axis, title in zip(axes, ("spread of one measurement", "bias of the mean")):
        axis.set(xlabel="carrier to noise, dB per sample", ylabel="% of the amplitude", title=title)
        axis.grid(True, which="both", alpha=0.3)
    axes[1].set_ylim(-5, 60)
    axes[0].legend()
    figure.suptitle(f"Four samples a period, {PERIODS} periods")
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--picture", help="write a picture of the spread and the bias at 4 samples a period")
    options = parser.parse_args()
    curves = {}
    print("| form | N | phase | " + " | ".join(f"{db} dB" for db in SNR_DB) + " |")
    print("| --- | --- | --- |" + " --- |" * len(SNR_DB))
    for n in (4, 8, 16):
        for name, form in FORMS.items():
            cells = np.array([figures(form, n, db) for db in SNR_DB])
            text = " | ".join(f"{spread:.2f} {bias:+.2f}" for spread, bias in cells)
            print(f"| {name} | {n} | {phase_error(form, n):.2f} | {text} |")
            if n == 4:
                curves[name] = cells
        bound = 100 / np.sqrt(n * PERIODS) / 10 ** (np.array(SNR_DB) / 20)
        print(f"| least possible spread | {n} | | " + " | ".join(f"{b:.2f}" for b in bound) + " |")
    if options.picture:
        draw(curves, options.picture)


if __name__ == "__main__":
    main()
