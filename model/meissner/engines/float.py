"""Engine ``float``: textbook float64 with PyWavelets, the truth to measure the others against."""

import numpy as np
import pywt
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from meissner.engines import Watched
from meissner.slip.slip import Slip

# p2p of integer samples is an integer; rounding in the transform must not decide a comparison.
HALF_CODE = 0.5


def _coefficients(x, level):
    """Detail and sum in codes: PyWavelets' cD and cA of that level times sqrt(2)**level."""
    whole = x.shape[1] >> level << level
    approximation, detail, *_ = pywt.wavedec(
        x[:, :whole].astype(np.float64), "haar", mode="periodization", level=level
    )
    scale = np.sqrt(2.0) ** level
    return detail * scale, approximation * scale


def _running(detail, span, hop):
    """Peak-to-peak of the window that runs, at each detail, by SciPy's rank filters or window by window."""
    if hop not in (span, span // 2):
        shift = span // 2 - 1
        high = maximum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=-np.inf)
        low = minimum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=np.inf)
        return high - low
    p2p = np.empty_like(detail)
    for k in range(0, detail.shape[1], hop):
        seen = detail[:, max(0, k - (span - hop)) : k + hop]
        span_so_far = np.maximum.accumulate(seen, axis=1) - np.minimum.accumulate(seen, axis=1)
        p2p[:, k : k + hop] = span_so_far[:, -detail[:, k : k + hop].shape[1] :]
    return p2p


def first_crossing(x, config, start=0):
    """First detail, from number ``start`` on, at which the exact sliding window crosses; None if none does.

    The earliest that any detector with this wavelet, window and threshold can know; ``x``: [samples].
    """
    detail, _ = _coefficients(np.asarray(x)[None], config.level)
    span = config.window >> config.level
    shift = span // 2 - 1
    high = maximum_filter1d(detail[0], span, origin=shift, mode="nearest")
    low = minimum_filter1d(detail[0], span, origin=shift, mode="nearest")
    crossing = np.flatnonzero((high - low)[start:] > config.threshold + HALF_CODE)
    return start + int(crossing[0]) if len(crossing) else None


def watch(x, config, moving=None):
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    detail, total = _coefficients(x, config.level)
    group = 1 << config.level
    span, hop = config.window // group, config.hop // group
    p2p = _running(detail, span, hop)
    index = np.arange(detail.shape[1])
    twin = Slip(len(x), config)
    moving = None if moving is None else np.asarray(moving)[group - 1 :: group][: detail.shape[1]]
    # The states are logic, not arithmetic: the rules of the twin on this engine's own numbers.
    state = twin.process(p2p - HALF_CODE, np.rint(total), moving)
    return Watched(
        p2p=p2p,
        over=p2p > config.threshold + HALF_CODE,
        state=state,
        end=(index >= span - 1) & ((index - (span - 1)) % hop == 0),
        blanked=twin.blanked,
    )


def windows(x, config, count):
    """(p2p, slip, first) [channels, windows]: ``first`` is the detail of a tumbling window that crosses."""
    group = 1 << config.level
    span, hop = config.window // group, config.hop // group
    detail, _ = _coefficients(x, config.level)
    limit = config.threshold + HALF_CODE
    if hop != span:
        p2p = _running(detail, span, 1 if span > 2 else hop)[:, span - 1 :: hop]
        return p2p, p2p > limit, np.zeros(p2p.shape, dtype=np.int64)
    parts = detail[:, : count * span].reshape(len(x), count, span)
    running = np.maximum.accumulate(parts, axis=2) - np.minimum.accumulate(parts, axis=2)
    p2p = running[:, :, -1]
    return p2p, p2p > limit, np.argmax(running > limit, axis=2)
