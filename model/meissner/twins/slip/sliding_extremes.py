"""Bit-exact twin of rtl/slip/msn_sliding_extremes.sv: maximum and minimum over a few delayed values."""

import numpy as np

from meissner.twins.shared import one_of, within


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
