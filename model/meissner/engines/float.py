"""Engine ``float``: textbook float64 with PyWavelets, the reference for the other engines."""

import numpy as np
import pywt
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from meissner.engines import COP_ONE, MAX_CODE, Watched, moving_of_details
from meissner.engines.float_cop4 import cop4, cop4_of_volts, cop_slip  # noqa: F401 - of this engine
from meissner.engines.float_slip import states
from meissner.inputs import MAX_FORCE

# p2p of integer samples is an integer; rounding in the transform must not decide a comparison.
HALF_CODE = 0.5


def _coefficients(x, config):
    """Detail and sum in codes: PyWavelets' cD and cA of that level times sqrt(2)**level."""
    level = config.level
    whole = x.shape[1] >> level << level
    approximation, detail, *_ = pywt.wavedec(
        x[:, :whole].astype(np.float64), "haar", mode="periodization", level=level
    )
    scale = np.sqrt(2.0) ** level
    return detail * scale, approximation * scale


def _sliding(detail, span):
    """Maximum minus minimum over the last ``span`` details at each detail (fewer at the start)."""
    shift = span // 2 - 1
    high = maximum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=-np.inf)
    low = minimum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=np.inf)
    return high - low


def _running(detail, span, hop):
    """Peak-to-peak of the current window at each detail, by SciPy's rank filters or window by window."""
    if hop not in (span, span // 2):
        return _sliding(detail, span)
    p2p = np.empty_like(detail)
    for k in range(0, detail.shape[1], hop):
        seen = detail[:, max(0, k - (span - hop)) : k + hop]
        span_so_far = np.maximum.accumulate(seen, axis=1) - np.minimum.accumulate(seen, axis=1)
        p2p[:, k : k + hop] = span_so_far[:, -detail[:, k : k + hop].shape[1] :]
    return p2p


def first_crossing(x, config, start=0):
    """First detail, from number ``start`` on, at which the exact sliding window is over; None if none is.

    No detector with this wavelet, window and threshold can detect it earlier; ``x``: [samples].
    """
    detail, _ = _coefficients(np.asarray(x)[None], config)
    p2p = _sliding(detail, config.window >> config.level)[0]
    crossing = np.flatnonzero(p2p[start:] > config.threshold + HALF_CODE)
    return start + int(crossing[0]) if len(crossing) else None


def watch(x, config, moving=None):
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    detail, total = _coefficients(x, config)
    group = 1 << config.level
    span, hop = config.window // group, config.hop // group
    p2p = _running(detail, span, hop)
    index = np.arange(detail.shape[1])
    moving = moving_of_details(moving, config.level, detail.shape[1])
    moving = np.zeros(p2p.shape[1], bool) if moving is None else moving
    state, blanked = states(p2p - HALF_CODE, np.rint(total), config, moving)
    return Watched(
        p2p=p2p,
        over=p2p > config.threshold + HALF_CODE,
        state=state,
        end=(index >= span - 1) & ((index - (span - 1)) % hop == 0),
        blanked=blanked,
    )


def windows(x, config, count):
    """(p2p, slip, first) [channels, windows]; ``first``: a tumbling window's first detail over, else 0."""
    group = 1 << config.level
    span, hop = config.window // group, config.hop // group
    detail, _ = _coefficients(x, config)
    limit = config.threshold + HALF_CODE
    if hop != span:
        p2p = _running(detail, span, 1 if span > 2 else hop)[:, span - 1 :: hop]
        return p2p, p2p > limit, np.zeros(p2p.shape, dtype=np.int64)
    parts = detail[:, : count * span].reshape(len(x), count, span)
    running = np.maximum.accumulate(parts, axis=2) - np.minimum.accumulate(parts, axis=2)
    p2p = running[:, :, -1]
    return p2p, p2p > limit, np.argmax(running > limit, axis=2)


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
