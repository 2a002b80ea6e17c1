"""Bit-exact twins of rtl/slip/msn_peak_to_peak.sv, running maximum minus minimum over a window, and of
msn_sliding_extremes.sv, maximum and minimum over a few delayed values."""

from math import ceil, log2

import numpy as np

from meissner.twins.shared import Stream, one_of, within
from meissner.twins.slip.config import check_channels

MASKED = np.iinfo(np.int64).min  # in a history: this detail is ignored


def check_window(span, hop):
    """Raise ValueError unless the RTL can be built with ``span`` and ``hop`` (in details)."""
    if span < 2 or span & (span - 1):
        raise ValueError(f"span = {span} details must be a power of two, 2 or more")
    if not 1 <= hop <= span:
        raise ValueError(f"hop = {hop} details must lie in 1 .. {span}")


def latency(span, hop):
    """Clocks from the last detail of a window to its peak-to-peak."""
    if hop == span:
        return 2
    return 3 if 2 * hop == span else 1 + ceil(log2(span) / 2)


def _lagged(x, lag, pick):
    """pick(x[k], x[k - lag]) along the last axis; x[k] alone where k < lag."""
    out = x.copy()
    pick(x[..., lag:], x[..., :-lag], out=out[..., lag:])
    return out


def _extremes(detail):
    """Maximum and minimum of each single detail; a MASKED one never changes an extreme."""
    return detail, np.where(detail == MASKED, ~MASKED, detail)


def _spread(high, low):
    return np.where(high == MASKED, 0, high - np.where(high == MASKED, 0, low))


def sliding(detail, span):
    """Maximum minus minimum over the last ``span`` details at each detail (fewer at the start).

    ``detail``: integers [..., n], MASKED ones are ignored; ``span``: a power of two. By doubling: a window of
    2L joins the windows of L now and L details ago, so log2(span) steps suffice.
    """
    high, low = _extremes(np.asarray(detail, dtype=np.int64))
    lag = 1
    while lag < span:
        if lag < high.shape[-1]:
            high, low = _lagged(high, lag, np.maximum), _lagged(low, lag, np.minimum)
        lag *= 2
    return _spread(high, low)


class PeakToPeak(Stream):
    """Running peak-to-peak of each channel, window by window.

        p2p = max d - min d over the window so far

    ``span``: details in a window, ``hop``: details from one window's start to the next. hop = span:
    tumbling windows; hop = span / 2: half-overlapping windows (the previous half and the current one);
    any other hop: the exact sliding window. Times and sizes are in details.
    """

    def __init__(self, channels=1, span=32, hop=32):
        check_window(span, hop)
        check_channels(channels)
        self.channels, self.span, self.hop = channels, span, hop
        self.part = hop if hop in (span, span // 2) else 1  # details between two restarts of the maximum
        self.reset()

    def reset(self):
        """Start a new history: the next detail is the first of a window."""
        self._count = 0
        self._kept = np.zeros((self.channels, 0), dtype=np.int64)

    def next(self, detail, mask=None):
        """Feed ``detail`` [channels, n]; returns (p2p [channels, n], end [n]).

        ``mask`` [channels, n]: details to ignore; a window with only such details has p2p 0. ``p2p`` is that
        of the current window so far; ``end``: this detail closes a window (the first closes at detail
        span - 1, then every hop).
        """
        detail = np.asarray(detail, dtype=np.int64)
        if mask is not None:
            detail = np.where(mask, MASKED, detail)
        kept = self._kept.shape[1]
        history = np.concatenate([self._kept, detail], axis=1)
        index = self._count + np.arange(detail.shape[1])
        p2p = sliding(history, self.span) if self.part == 1 else self._by_parts(history)
        self._count += detail.shape[1]
        self._kept = history[:, self._keep_from(history.shape[1]) :]
        end = (index >= self.span - 1) & ((index - (self.span - 1)) % self.hop == 0)
        return p2p[:, kept:], end

    def _keep_from(self, length):
        """Start of the history that later details still need, aligned to a part."""
        if self.part == 1:
            return max(0, length - (self.span - 1))
        first = self._count - length  # absolute index of the history's start, where a part begins
        needed = self._count // self.part * self.part - (self.span - self.part)
        return max(0, needed - first)

    def _by_parts(self, history):
        """Running p2p with extremes that restart every ``part`` details, joined with the previous part's."""
        length = history.shape[1]
        parts = -(-length // self.part)
        padded = np.zeros((self.channels, parts * self.part), dtype=np.int64)
        padded[:, :length] = history
        padded[:, length:] = history[:, -1:] if length else 0
        shaped = padded.reshape(self.channels, parts, self.part)
        highs, lows = _extremes(shaped)
        high = np.maximum.accumulate(highs, axis=2)
        low = np.minimum.accumulate(lows, axis=2)
        if self.part < self.span:
            high[:, 1:] = np.maximum(high[:, 1:], highs[:, :-1].max(axis=2, keepdims=True))
            low[:, 1:] = np.minimum(low[:, 1:], lows[:, :-1].min(axis=2, keepdims=True))
        return _spread(high, low).reshape(self.channels, -1)[:, :length]


def sliding_extremes(high, low, lag, taps):
    """Maximum of ``high`` and minimum of ``low`` over ``taps`` values ``lag`` apart.

        out_high(t) = max high(t - j lag),  out_low(t) = min low(t - j lag),  j = 0 .. taps-1

    ``high``, ``low``: integers [..., n]; values before the start are left out.
    Returns two int64 arrays of the same shape. ``taps``: 2 or 4.
    """
    one_of((2, 4), taps=taps)
    within(lag=(lag, 1, None))
    high, low = np.asarray(high, dtype=np.int64), np.asarray(low, dtype=np.int64)
    out_high, out_low = high.copy(), low.copy()
    for shift in range(lag, min(taps * lag, high.shape[-1]), lag):
        np.maximum(out_high[..., shift:], high[..., :-shift], out=out_high[..., shift:])
        np.minimum(out_low[..., shift:], low[..., :-shift], out=out_low[..., shift:])
    return out_high, out_low
