"""Slip in textbook float64: ``watch`` and ``windows`` of engine ``float``, with PyWavelets and SciPy.

The states come from an independent loop on the times of past events and unrounded numbers.
"""

import numpy as np
import pywt
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from meissner.arrays import Bools, Floats, Ints
from meissner.engines import Watched, moving_of_details
from meissner.engines.protocol import Windows
from meissner.twins.slip.config import SlipConfig

NONE, CONTACT, INCIPIENT, GROSS, RELEASE = range(5)
# p2p of integer samples is an integer; rounding in the transform must not decide a comparison.
HALF_CODE = 0.5


def _coefficients(x: Ints, config: SlipConfig) -> tuple[Floats, Floats]:
    """Detail and sum in codes: PyWavelets' cD and cA of that level times sqrt(2)**level."""
    level = config.level
    whole = x.shape[1] >> level << level
    approximation, detail, *_ = pywt.wavedec(
        x[:, :whole].astype(np.float64), "haar", mode="periodization", level=level
    )
    scale = np.sqrt(2.0) ** level
    return detail * scale, approximation * scale


def _sliding(detail: Floats, span: int) -> Floats:
    """Maximum minus minimum over the last ``span`` details at each detail (fewer at the start)."""
    shift = span // 2 - 1
    high = maximum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=-np.inf)
    low = minimum_filter1d(detail, span, axis=1, origin=shift, mode="constant", cval=np.inf)
    return high - low


def _running(detail: Floats, span: int, hop: int) -> Floats:
    """Peak-to-peak of the current window at each detail, by SciPy's rank filters or window by window."""
    if hop not in (span, span // 2):
        return _sliding(detail, span)
    p2p = np.empty_like(detail)
    for k in range(0, detail.shape[1], hop):
        seen = detail[:, max(0, k - (span - hop)) : k + hop]
        span_so_far = np.maximum.accumulate(seen, axis=1) - np.minimum.accumulate(seen, axis=1)
        p2p[:, k : k + hop] = span_so_far[:, -detail[:, k : k + hop].shape[1] :]
    return p2p


def first_crossing(x: ArrayLike, config: SlipConfig, start: int = 0) -> int | None:
    """First detail, from number ``start`` on, at which the exact sliding window is over; None if none is.

    No detector with this wavelet, window and threshold can detect it earlier; ``x``: [samples].
    """
    detail, _ = _coefficients(np.asarray(x)[None], config)
    p2p = _sliding(detail, config.window >> config.level)[0]
    crossing = np.flatnonzero(p2p[start:] > config.threshold + HALF_CODE)
    return start + int(crossing[0]) if len(crossing) else None


def watch(x: Ints, config: SlipConfig, moving: Bools | None = None) -> Watched:
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


def windows(x: Ints, config: SlipConfig, count: int) -> Windows:
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


def states(p2p: Floats, level: Floats, config: SlipConfig, moving: Bools) -> tuple[NDArray[np.int8], int]:
    """States [channels, details] of p2p and level, and the number of details over while blanked or moving."""
    found, blanked = np.empty(p2p.shape, dtype=np.int8), 0
    for channel, (sizes, levels) in enumerate(zip(p2p.tolist(), level.tolist())):
        found[channel], count = _channel(sizes, levels, moving.tolist(), config)
        blanked += count
    return found, blanked


def _channel(
    sizes: list[float], levels: list[float], moving: list[bool], config: SlipConfig
) -> tuple[list[int], int]:
    sign = 1 if config.contact_rises else -1
    press, let_go = sign * config.contact_level, sign * config.release_level
    state, blanked, states = NONE, 0, []
    touched = slipped = calmed = left = -1  # the detail at which each last happened
    for now, (size, level, moves) in enumerate(zip(sizes, levels, moving)):
        pressed, lifted = sign * level >= press, sign * level < let_go
        over = size > config.threshold
        if state in (NONE, RELEASE):
            if pressed:
                state, touched, calmed = CONTACT, now, -1
            elif state == RELEASE and now - left > config.hold:
                state = NONE
        elif lifted:
            state, left = RELEASE, now
        elif state == CONTACT:
            fresh = calmed < 0 and now - touched <= config.blank
            deaf = calmed >= 0 and now - calmed <= config.refractory
            blanked += over and (moves or fresh)
            if over and not (moves or fresh or deaf):
                state, slipped = GROSS if size > config.gross_threshold else INCIPIENT, now
        else:
            blanked += over and moves
            kept = over or (config.keep_threshold is not None and size > config.keep_threshold)
            if kept and not moves:
                slipped = now
                state = GROSS if over and size > config.gross_threshold else state
            elif now - slipped > config.hold:
                state, calmed = CONTACT, now
        states.append(state)
    return states, blanked
