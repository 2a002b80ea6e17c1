"""Bit-exact twin of rtl/common/msn_round_sat.sv: the one block that loses bits."""

import numpy as np


def round_sat(x, in_width, out_width, drop_bits, unsigned=False):
    """Drop ``drop_bits`` fraction bits (round half up), then hold at the ends of the output's range.

        y = clip(floor(x / 2^drop_bits + 1/2), low, high)

    ``x``: integers of ``in_width`` signed bits; low, high: those of ``out_width`` bits, signed or not.
    """
    if not 1 <= drop_bits < in_width:
        raise ValueError(f"drop_bits = {drop_bits} must lie in 1 .. in_width-1 = {in_width - 1}")
    widest = in_width - drop_bits + 1 - unsigned
    if not 1 <= out_width <= widest:
        raise ValueError(f"out_width = {out_width} must lie in 1 .. {widest}")
    x = np.asarray(x, dtype=np.int64)
    if np.any(x != np.clip(x, -(1 << (in_width - 1)), (1 << (in_width - 1)) - 1)):
        raise ValueError(f"x must fit {in_width} signed bits")
    rounded = ((x >> (drop_bits - 1)) + 1) >> 1
    if unsigned:
        return np.clip(rounded, 0, (1 << out_width) - 1)
    return np.clip(rounded, -(1 << (out_width - 1)), (1 << (out_width - 1)) - 1)
