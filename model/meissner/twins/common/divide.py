"""Bit-exact twin of rtl/common/msn_divide.sv: quotient rounded to nearest, ties away from zero."""

import numpy as np

from meissner.twins.shared import one_of, within


def steps(fraction_bits=14, bits_per_clock=2):
    """Digits (clocks) of one division; its latency and its shortest period are one clock more."""
    within(fraction_bits=(fraction_bits, 1, 30))
    one_of((1, 2), bits_per_clock=bits_per_clock)
    return fraction_bits + 1 if bits_per_clock == 1 else (fraction_bits + 3) // 2


def divide(num, den, fraction_bits=14):
    """``num / den`` in Q2.fraction_bits, nearest, ties away from zero; |num| <= den, den > 0.

    It divides bit by bit, because the numerator shifted by the fraction would not fit in int64.
    """
    steps(fraction_bits)  # the same check
    num, den = np.broadcast_arrays(np.asarray(num, dtype=np.int64), np.asarray(den, dtype=np.int64))
    rest, quotient = np.abs(num), np.zeros(num.shape, dtype=np.int64)
    if (den < 1).any() or (rest > den).any():
        raise ValueError("the denominator must be positive and no less than the numerator")
    for _ in range(fraction_bits + 1):
        fits = 2 * rest >= den
        rest = 2 * rest - np.where(fits, den, 0)
        quotient = 2 * quotient + fits
    return np.sign(num) * ((quotient + 1) >> 1)
