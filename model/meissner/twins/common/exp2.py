"""Bit-exact twin of rtl/common/msn_exp2.sv: power of two of a signed number, by table and chord."""

from functools import cache
from math import isqrt

import numpy as np

from meissner.twins.common.log2 import ENTRY_BITS, TABLE_BITS, table
from meissner.twins.shared import within


@cache
def finest():
    """2^28 (2^(j/256) - 1) to nearest, for j = 0 .. 256: products of 2^(1/2), 2^(1/4) .. with 200 bits."""
    entries = []
    for j in range((1 << TABLE_BITS) + 1):
        x, root = 1 << 200 + (j >> TABLE_BITS), 2 << 200
        for bit in reversed(range(TABLE_BITS)):
            root = isqrt(root << 200)
            if j >> bit & 1:
                x = x * root >> 200
        entries.append(((x - (1 << 200)) + (1 << 199 - ENTRY_BITS)) >> 200 - ENTRY_BITS)
    return tuple(entries)


def bound(table_bits=6, fraction_bits=16):
    """(below, above): the largest relative error against 2^y, before the result is rounded to an lsb."""
    table(finest(), table_bits, fraction_bits)
    lsb = 2.0**-fraction_bits
    return lsb / 8 + lsb / 4 + 2.0**-29, lsb / 8 + 2.0**-29 + 0.0601 * 4.0**-table_bits


def exp2(y, table_bits=6, fraction_bits=16, out_bits=24, out_fraction=20):
    """2^out_fraction 2^(y / 2^fraction_bits), rounded half up, saturating at 2^out_bits - 1: int64.

        y = i + f;   T[j] = 2^(j/2^table_bits) - 1, j the leading bits of f, r the others
        out = 2^i (1 + T[j] + (T[j+1] - T[j]) r)     T has two bits more than f; the product is cut to them

    ``y``: signed integers of at most 32 bits. Exact where f = 0, apart from the output's half lsb. Elsewhere
    the error is within ``bound`` and that half lsb. As a share of the result: the chord is at most
    0.0601/4^table_bits too high; rounding (lsb = 2^-fraction_bits) adds lsb/8 + 2^-29 to both sides and
    lsb/4 more below. At the default: -0.00000573 .. +0.0000166.
    """
    within(out_bits=(out_bits, 2, 32), out_fraction=(out_fraction, 0, 32))
    t, d = table(finest(), table_bits, fraction_bits)
    y = np.asarray(y, dtype=np.int64)
    f = y & (1 << fraction_bits) - 1
    rest_bits = fraction_bits - table_bits
    j, r = f >> rest_bits, f & (1 << rest_bits) - 1
    mantissa = (1 << fraction_bits + 2) + t[j] + (d[j] * r >> rest_bits)
    # Shift right from the place where the leading bit is the output's highest; keep one more bit, to round.
    right = out_bits - 1 - out_fraction - (y >> fraction_bits)
    left = max(0, out_bits - (fraction_bits + 2))
    placed = mantissa << left >> np.clip(right + fraction_bits + 2 + left - out_bits, 0, 62)
    top = (1 << out_bits) - 1
    return np.where(right < 0, top, np.minimum((placed + 1) >> 1, top))
