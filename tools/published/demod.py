"""Errors of the forms of msn_am_demod by signal-to-noise ratio: a Markdown table, a plot with --picture FILE.

A carrier in a 12-bit converter, with an amplitude of 1000 codes or less if the noise needs the range, white
noise, 8 periods per measurement. Errors in % of the amplitude: the spread of single measurements at one
phase, and the bias of their mean over all phases (noise read as carrier). `phase` is the error that the phase
alone causes, without noise.
"""

import argparse

import numpy as np

from meissner.tradeoff.axes.demod import FORMS, PERIODS, figures, phase_error

SNR_DB = (60, 40, 30, 20, 10, 5, 0, -5, -10)


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
