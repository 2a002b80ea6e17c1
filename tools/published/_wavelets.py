"""Data of the initial-slip paper's figures: recordings, their Haar details, their CWT (Morlet wavelet)."""

from functools import cache

import numpy as np
import pywt

from meissner import scenes
from meissner.interval import rate, words

SEEDS = range(1, 21)
THRESHOLD_V = 0.01
MORLET = "morl"
# Scales from 5 kHz, half the rate, to 125 Hz. At scale 1 the wavelet's centre is at 0.8125 of the rate.
SCALES = np.geomspace(1.625, 65, 48)
EDGE = 4000  # samples repeated before and after, so that the ends of a run make no steps


@cache
def recording(name, condition, seed=1):
    return scenes.simulate(scenes.load(name), condition, seed)


def converted(run):
    return run.scene.adc.volts_of(run.codes)


def details(run):
    """cD in volts and the time of the last sample of each pair."""
    even = len(run.codes) // 2 * 2
    return pywt.dwt(converted(run)[:even], "haar")[1], run.time_s[1:even:2]


@cache
def largest(name, condition):
    """For each seed: the largest coefficient while nothing slips, and from the first event to the slip."""
    rows = []
    for seed in SEEDS:
        run = scenes.simulate(scenes.load(name), condition, seed)
        coefficient, at = details(run)
        onset, gross = (np.inf if when is None else when for when in (run.onset_s, run.gross_s))
        quiet = np.abs(coefficient[at < onset]).max()
        rows.append((quiet, np.abs(coefficient[(at >= onset) & (at < gross)]).max(initial=0.0)))
    return np.array(rows).T


@cache
def at_the_slip(name, condition):
    """For each seed the largest coefficient within a millisecond of the slip of the whole contact."""
    found = []
    for seed in SEEDS:
        run = recording(name, condition, seed)
        coefficient, at = details(run)
        found.append(np.abs(coefficient[np.abs(at - run.gross_s) <= 1e-3]).max())
    return np.array(found)


@cache
def readings(name, condition, seeds=100):
    """Median milliseconds from the first event to the first coefficient beyond THRESHOLD_V and to the first
    peak to peak beyond twice that, in windows of 32; runs in which a coefficient is beyond it before."""
    delays, false = [], 0
    for seed in range(1, 1 + seeds):
        run = scenes.simulate(scenes.load(name), condition, seed)
        coefficient, at = details(run)
        windows = coefficient[: len(coefficient) // 32 * 32].reshape(-1, 32)
        spread = np.maximum.accumulate(windows, axis=1) - np.minimum.accumulate(windows, axis=1)
        false += bool((np.abs(coefficient[at < run.onset_s]) > THRESHOLD_V).any())
        beyond = np.abs(coefficient) > THRESHOLD_V, spread.ravel() > 2 * THRESHOLD_V
        delays.append(
            [at[: len(one)][one & (at[: len(one)] >= run.onset_s)][0] - run.onset_s for one in beyond]
        )
    literal, both = 1e3 * np.median(delays, axis=0)
    return literal, both, false


def volts(values):
    mean, low, high = values.mean(), values.min(), values.max()
    return f"largest of a run {mean:.4f} V in the mean ({low:.4f} to {high:.4f}), {len(values)} runs"


def crossed(values):
    return words(rate(int(np.count_nonzero(values > THRESHOLD_V)), len(values)))


@cache
def power(name, condition, hertz):
    """CWT power in V² at these frequencies, [frequencies, samples], of the converted samples."""
    run = recording(name, condition)
    scales = pywt.central_frequency(MORLET) * run.scene.rate_hz / np.array(hertz)
    held = np.pad(converted(run), EDGE, "edge")
    return pywt.cwt(held, scales, MORLET, method="fft")[0][:, EDGE:-EDGE] ** 2


def mean_power(name, condition, hertz, spans):
    """Mean power in the time spans (from, until)."""
    run = recording(name, condition)
    inside = np.zeros(len(run.time_s), dtype=bool)
    for first, last in spans:
        inside |= (run.time_s >= first) & (run.time_s < last)
    return power(name, condition, tuple(hertz))[:, inside].mean(axis=1)


def columns(found, count=400):
    """The maximum of each of ``count`` groups of neighbouring samples."""
    width = max(found.shape[1] // count, 1)
    kept = found[:, : found.shape[1] // width * width]
    return kept.reshape(len(found), -1, width).max(axis=2)


def first_flag(run):
    """The time when the peak-to-peak of 32 details first exceeds the threshold, from the first event on."""
    coefficient, at = details(run)
    blocks = coefficient[: len(coefficient) // 32 * 32].reshape(-1, 32)
    spread = np.maximum.accumulate(blocks, axis=1) - np.minimum.accumulate(blocks, axis=1)
    over = (spread.ravel() > 2 * THRESHOLD_V) & (at[: spread.size] >= run.onset_s)
    return float(at[np.argmax(over)]) if over.any() else None
