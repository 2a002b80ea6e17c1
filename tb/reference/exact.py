"""Exact arithmetic for tb/extremes: the formulas of docs/ and of the headers in Python's integers, fractions
and mpmath at 50 digits. There are no widths, truncating shifts or NumPy: nothing can wrap around, and values
are rounded only where the formula rounds.
"""

from fractions import Fraction
from math import floor, isqrt

import mpmath

mpmath.mp.dps = 50
HALF = Fraction(1, 2)


def half_up(value):
    """Nearest integer, ties upwards."""
    return floor(Fraction(value) + HALF)


def away(value):
    """Nearest integer, ties away from zero."""
    value = Fraction(value)
    whole = floor(abs(value) + HALF)
    return whole if value >= 0 else -whole


def held(value, low, high):
    return max(low, min(high, value))


def signed(bits):
    """Least and greatest integer of ``bits`` bits."""
    return -(2 ** (bits - 1)), 2 ** (bits - 1) - 1


def ends(low, high):
    """The ends of a range, zero, the neighbours of these, the middles and the thirds."""
    near = {low, low + 1, low + 2, high - 2, high - 1, high, -1, 0, 1, low // 2, high // 2, (low + high) // 2}
    near |= {high // 3, 2 * high // 3}
    return sorted(value for value in near if low <= value <= high)


def log2(x):
    """50 digits; the block takes 0 as 1."""
    return mpmath.log(max(int(x), 1), 2)


def power(base, exponent):
    return mpmath.power(mpmath.mpf(base), exponent)


def root(square):
    """floor of the square root."""
    return isqrt(square)


def moments(frame):
    """S, Mx, My of a frame, a list of rows (docs/cop.md)."""
    m, n = len(frame), len(frame[0])
    total = sum(map(sum, frame))
    along = sum((2 * j - (n - 1)) * force for row in frame for j, force in enumerate(row))
    across = sum(((m - 1) - 2 * i) * force for i, row in enumerate(frame) for force in row)
    return total, along, across


def details(samples, level):
    """Haar details and sums, docs/slip.md: d = x[2k] - x[2k+1], a = x[2k] + x[2k+1], again on a."""
    sums = list(map(int, samples))
    found = []
    for _ in range(level):
        found = [sums[k] - sums[k + 1] for k in range(0, len(sums) - 1, 2)]
        sums = [sums[k] + sums[k + 1] for k in range(0, len(sums) - 1, 2)]
    return found, sums


def cop4(codes, r, correction=None):
    """x, y, load as rationals (docs/cop4.md), before their only rounding.

    ``r``: a dict of the registers; ``correction``: p0 .. p5, in units of 2^-(8 + shift_load).
    """
    e1, e2, e3, e4 = map(int, codes)
    n, m, d = r["rail"] - e1 - e3, r["rail"] + e2 + e4, e1 + e3 - e2 - e4

    def along(k, shift, difference, current):
        product, den = k * difference, current * 2**shift
        if current <= 0:
            return Fraction(0)
        return held(Fraction(product, den), Fraction(-1), Fraction(1))

    x = along(r["kx"], r["shift_x"], e1 - e3, n)
    y = along(r["ky"], r["shift_y"], e2 - e4, m)
    shift = 8 + r["shift_load"]
    top = held(n, 0, r["rail"])
    below = d * 2**shift
    if correction is not None:
        below = cop4_divisor(away(x * 2**14), away(y * 2**14), top, d, correction, shift)
    if below <= 0:
        load = Fraction(1) if r["kf"] * top > 0 else Fraction(0)
    else:
        load = min(Fraction(r["kf"] * top, below), Fraction(1))
    return x, y, load


def cop4_divisor(x, y, n, d, p, shift):
    """den = D 2^s - N p, with each division of the docs rounded down (msn_cop4_correct's header)."""
    big_x, big_y = x * x // 2**12, y * y // 2**12
    one = big_x * (p[1] + (p[3] * big_x + p[4] * big_y) // 2**16)
    two = big_y * (p[2] + p[5] * big_y // 2**16)
    return d * 2**shift - n * (p[0] + (one + two) // 2**16)


def true_divisor(x, y, n, d, p, shift):
    """The same without rounding: the polynomial of docs/mesh.md on the Q2.14 position."""
    big_x, big_y = (Fraction(value, 2**14) ** 2 for value in (x, y))
    poly = p[0] + p[1] * big_x + p[2] * big_y + p[3] * big_x**2 + p[4] * big_x * big_y + p[5] * big_y**2
    return d * Fraction(2) ** shift - n * poly


WEIGHTS = {4: [(1, 0)], 8: [(5, 2), (2, 5)], 16: [(5, 1), (4, 3), (3, 4), (1, 5)]}  # docs/demod.md


def demodulated(samples, per_period, form):
    """|M| before the shift as a rational; for the exact root (form 1), floor(2 |M|) / 2 (docs/demod.md)."""
    n = per_period
    periods = [samples[k : k + n] for k in range(0, len(samples), n)]
    if form == 0:
        return Fraction(sum(abs(p[k] - p[k + n // 2]) for p in periods for k in range(n // 2)))
    pairs = list(WEIGHTS[n])
    for _ in range(3):  # the other quarters, each turned by 90 degrees
        pairs += [(-s, c) for c, s in pairs[-(n // 4) :]]
    real = abs(sum(c * x for p in periods for (c, _), x in zip(pairs, p)))
    imaginary = abs(sum(s * x for p in periods for (_, s), x in zip(pairs, p)))
    if form == 1:
        return Fraction(isqrt(4 * (real**2 + imaginary**2)), 2)
    large, small = max(real, imaginary), min(real, imaginary)
    return Fraction(max(8 * 2 * large, 7 * 2 * large + 4 * 2 * small) // 8, 2)


def crc32(data):
    """The textbook's polynomial division, ISO-HDLC: reflected 04C11DB7, all ones before and after."""
    crc = 0xFFFFFFFF
    for byte in data:
        for place in range(8):
            bit = crc & 1 ^ byte >> place & 1
            crc >>= 1
            if bit:
                crc ^= int(f"{0x04C11DB7:032b}"[::-1], 2)
    return crc ^ 0xFFFFFFFF
