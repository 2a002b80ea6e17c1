"""Bit-exact twin of rtl/common/msn_log2.sv: binary logarithm of an unsigned integer, by table and chord."""

from functools import cache

import numpy as np

from meissner.twins.shared import within

TABLE_BITS = 8  # index bits of the finest table; smaller tables take every second, fourth .. entry
ENTRY_BITS = 28  # fraction bits of its entries
REST_BITS = 17  # at most, for the place between two entries


def check_bits(table_bits, fraction_bits):
    """Raise ValueError unless the RTL can be built with this table and this fraction."""
    within(table_bits=(table_bits, 3, TABLE_BITS))
    within(fraction_bits=(fraction_bits, table_bits + 1, table_bits + 14))


@cache
def finest():
    """2^28 log2(1 + i/256) to nearest, for i = 0 .. 256: 64 squarings of 200 bits give a bit each."""
    entries = []
    for i in range((1 << TABLE_BITS) + 1):
        x, bits = ((1 << TABLE_BITS) + i) << 200 - TABLE_BITS, 0
        bits, x = divmod(x, 2 << 200) if i < 1 << TABLE_BITS else (1, 1 << 200)
        for _ in range(64):
            x = x * x >> 200
            bit = x >> 201
            bits, x = 2 * bits + bit, x >> bit
        entries.append((bits + (1 << 63 - ENTRY_BITS)) >> 64 - ENTRY_BITS)
    return tuple(entries)


def table(entries, table_bits, fraction_bits):
    """(T, D): every 2^(8 - table_bits)th entry, with two bits more than the fraction, and the differences."""
    check_bits(table_bits, fraction_bits)
    drop = ENTRY_BITS - fraction_bits - 2
    t = np.array(entries[:: 1 << TABLE_BITS - table_bits], dtype=np.int64)
    t = (t + (1 << drop - 1)) >> drop
    return t[:-1], np.diff(t)


def bound(in_bits=27, table_bits=6, fraction_bits=16):
    """(below, above): how far the result lies below and above log2(x) at most, as in the RTL's header."""
    table(finest(), table_bits, fraction_bits)
    lsb, cut = 2.0**-fraction_bits, in_bits - 1 - table_bits > REST_BITS
    above = lsb / 2 + lsb / 8 + 2.0**-29
    below = above + lsb / 4 + 0.1804 * 4.0**-table_bits
    return below + cut * 1.4427 * 2.0 ** -(table_bits + REST_BITS), above


def log2(x, in_bits=27, table_bits=6, fraction_bits=16):
    """2^fraction_bits log2(x): int64; x = 0 counts as 1.

        x = 2^e (1 + m);   T[i] = log2(1 + i/2^table_bits), i the leading bits of m, r the others
        out = e + T[i] + (T[i+1] - T[i]) r     T has two bits more, the product is cut to them; half up

    ``x``: integers 0 .. 2^in_bits - 1. Exact at powers of two; otherwise within ``bound``: the chord is at
    most 0.1804/4^table_bits too low; rounding (lsb = 2^-fraction_bits) adds at most lsb 5/8 + 2^-29 to both
    sides and lsb/4 more below. Bits of r beyond 17 are dropped, which adds 1.4427/2^(table_bits + 17) below.
    At the default: -0.0000576 .. +0.0000096.
    """
    within(in_bits=(in_bits, table_bits + 2, 48))
    t, d = table(finest(), table_bits, fraction_bits)
    x = np.maximum(np.asarray(x, dtype=np.int64), 1)
    e = sum(((x >> k) > 0).astype(np.int64) for k in range(1, in_bits))
    m = (x << in_bits - 1 - e) - (1 << in_bits - 1)
    rest_bits = in_bits - 1 - table_bits
    i, r = m >> rest_bits, m & (1 << rest_bits) - 1
    kept = min(rest_bits, REST_BITS)
    r = r >> rest_bits - kept
    return ((e << fraction_bits + 2) + t[i] + (d[i] * r >> kept) + 2) >> 2
