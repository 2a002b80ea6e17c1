"""Engine ``float``: textbook float64 with PyWavelets, the reference for the other engines."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays, Floats, Ints
from meissner.engines import COP_ONE, MAX_CODE, Carrier
from meissner.engines.protocol import found_in
from meissner.inputs import MAX_FORCE

if TYPE_CHECKING:
    from meissner.calibration import Calibration


__getattr__ = found_in(
    dict.fromkeys(("watch", "windows"), "float_slip")
    | dict.fromkeys(("cop4", "cop4_of_volts", "cop_slip"), "float_cop4")
)


def cop(forces: NDArray[np.uint16], min_load: int = 1) -> Arrays:
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

    def position(moment: Floats, count: int) -> NDArray[np.int32]:
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


def demodulate(samples: Ints, carrier: Carrier) -> Ints:
    """Amplitudes [...] of carriers [..., samples]: the Fourier sum at the carrier times the block's gain."""
    x = np.asarray(samples, dtype=np.float64)[..., carrier.skip :]
    turn = np.exp(-2j * np.pi * np.arange(x.shape[-1]) / carrier.block.samples_per_period)
    amplitude = 2 / x.shape[-1] * np.abs(x @ turn)
    return np.minimum(np.floor(amplitude * carrier.code_per_lsb + 0.5), MAX_CODE).astype(np.int64)


def calibrate(codes: NDArray[np.int32], calibration: "Calibration") -> Floats:
    """Forces of codes in float64, where every product and sum of these integers is exact."""
    force = (codes - calibration.offset.astype(float)) * calibration.gain / 2.0**calibration.gain_shift
    return np.where(calibration.dead, 0.0, np.clip(np.floor(force + 0.5), 0.0, float(MAX_FORCE)))
