"""Exact arithmetic for tb/extremes: Python's integers, fractions and mpmath at 50 digits."""

from fractions import Fraction
from math import floor

import mpmath

mpmath.mp.dps = 50


def half_up(value):
    """Nearest integer, ties upwards."""
    return floor(Fraction(value) + Fraction(1, 2))


def held(value, low, high):
    return max(low, min(high, value))


def signed(bits):
    """Least and greatest integer of ``bits`` bits."""
    return -(2 ** (bits - 1)), 2 ** (bits - 1) - 1
