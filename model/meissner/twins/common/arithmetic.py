"""Bit-exact twins of the blocks of rtl/common that are one operation of integers:

multiply               msn_multiply.sv               a signed by an unsigned number
constant_multiplier    msn_constant_multiplier.sv    by a constant
compare                msn_compare.sv                signed comparison
round_sat              msn_round_sat.sv              the one block that drops bits (rounds, saturates)
"""

import numpy as np

from meissner.twins.shared import within


def multiply(a, b, a_width=18, b_width=16):
    """Exact product of ``a``, signed integers of ``a_width`` bits, and ``b``, unsigned, ``b_width`` bits."""
    within(a_width=(a_width, 2, 18), b_width=(b_width, 1, 17))
    return np.asarray(a, dtype=np.int64) * np.asarray(b, dtype=np.int64)


def constant_multiplier(x, constant):
    """``constant * x``, exact; ``constant``: 0 .. 65535."""
    within(constant=(constant, 0, 65535))
    return np.asarray(x, dtype=np.int64) * constant


def compare(a, b, width):
    """True where a > b; ``a`` and ``b`` are integers of ``width`` signed bits."""
    within(width=(width, 1, None))
    a, b = np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64)
    limit = 1 << (width - 1)
    for x in (a, b):
        if x.size and (x.min() < -limit or x.max() >= limit):
            raise ValueError(f"numbers must lie in {-limit} .. {limit - 1}")
    return a > b


def round_sat(x, in_width, out_width, drop_bits, unsigned=False):
    """Drop ``drop_bits`` fraction bits (round half up), then saturate to the output's range.

        y = clip(floor(x / 2^drop_bits + 1/2), low, high)

    ``x``: integers of ``in_width`` signed bits; low, high: the limits of ``out_width`` bits, signed or not.
    """
    within(drop_bits=(drop_bits, 1, in_width - 1))
    within(out_width=(out_width, 1, in_width - drop_bits + 1 - unsigned))
    x = np.asarray(x, dtype=np.int64)
    if (x >> (in_width - 1) != x >> 63).any():  # the bits above are not all copies of the sign
        raise ValueError(f"x must fit {in_width} signed bits")
    rounded = ((x >> (drop_bits - 1)) + 1) >> 1
    bits = out_width - (not unsigned)
    low, high = (0 if unsigned else -(1 << bits)), (1 << bits) - 1
    return np.minimum(np.maximum(rounded, low), high)  # np.clip takes ten times as long on few numbers
