"""Bit-exact twin of rtl/common/msn_round_sat.sv: the one block that drops bits (rounds, saturates)."""

import numpy as np

from meissner.twins.shared import within


def round_sat(x, in_width, out_width, drop_bits, unsigned=False):
    """Drop ``drop_bits`` fraction bits (round half up), then saturate to the output's range.

        y = clip(floor(x / 2^drop_bits + 1/2), low, high)

    ``x``: integers of ``in_width`` signed bits; low, high: the limits of ``out_width`` bits, signed or not.
    """
    if not 1 <= drop_bits < in_width:
        raise ValueError(f"drop_bits = {drop_bits} must lie in 1 .. in_width-1 = {in_width - 1}")
    widest = in_width - drop_bits + 1 - unsigned
    within(out_width=(out_width, 1, widest))
    x = np.asarray(x, dtype=np.int64)
    if (x >> (in_width - 1) != x >> 63).any():  # the bits above are not all copies of the sign
        raise ValueError(f"x must fit {in_width} signed bits")
    rounded = ((x >> (drop_bits - 1)) + 1) >> 1
    bits = out_width - (not unsigned)
    low, high = (0 if unsigned else -(1 << bits)), (1 << bits) - 1
    return np.minimum(np.maximum(rounded, low), high)  # np.clip takes ten times as long on few numbers
