"""Engine ``float``: textbook float64 with PyWavelets, the reference for the other engines."""

from importlib import import_module

import numpy as np

from meissner.engines import COP_ONE, MAX_CODE
from meissner.inputs import MAX_FORCE

# The other functions of this engine, loaded on use, so that a scene imports only what it runs.
_IN = dict.fromkeys(("watch", "windows"), "float_slip")
_IN |= dict.fromkeys(("cop4", "cop4_of_volts", "cop_slip"), "float_cop4")


def __getattr__(name):
    if name in _IN:
        return getattr(import_module(f"meissner.engines.{_IN[name]}"), name)
    raise AttributeError(f"engine float has no {name}")


def cop(forces, min_load=1):
    """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns].

    The moments are integers below 2^53 and so exact; x and y can differ from the exact ones in the last
    bit, where the quotient lies closer to a half than float64 resolves.
    """
    frames, rows, columns = forces.shape
    total, mx, my = np.empty((3, frames))
    across, up = 2.0 * np.arange(columns) - (columns - 1), (rows - 1) - 2.0 * np.arange(rows)
    for k, frame in enumerate(forces):
        frame = frame.astype(np.float64)
        total[k], mx[k], my[k] = frame.sum(), frame.sum(axis=0) @ across, frame.sum(axis=1) @ up
    valid = (total > 0) & (total >= min_load)

    def position(moment, count):
        value = np.zeros(frames)
        if count > 1:
            np.divide(moment, (count - 1) * total, out=value, where=valid)
        return (np.sign(value) * np.floor(np.abs(value) * COP_ONE + 0.5)).astype(np.int32)

    return {
        **{name: value.astype(np.int64) for name, value in (("sum", total), ("mx", mx), ("my", my))},
        "x": position(mx, columns),
        "y": position(my, rows),
        "valid": valid,
    }


def demodulate(samples, carrier):
    """Amplitudes [...] of carriers [..., samples]: the Fourier sum at the carrier times the block's gain."""
    x = np.asarray(samples, dtype=np.float64)[..., carrier.skip :]
    turn = np.exp(-2j * np.pi * np.arange(x.shape[-1]) / carrier.block.samples_per_period)
    amplitude = 2 / x.shape[-1] * np.abs(x @ turn)
    return np.minimum(np.floor(amplitude * carrier.code_per_lsb + 0.5), MAX_CODE).astype(np.int64)


def calibrate(codes, calibration):
    """Forces of codes in float64, where every product and sum of these integers is exact."""
    force = (codes - calibration.offset.astype(float)) * calibration.gain / 2.0**calibration.gain_shift
    return np.where(calibration.dead, 0.0, np.clip(np.floor(force + 0.5), 0.0, float(MAX_FORCE)))
