"""Extremes of fits, intervals and the converter: values at the ends of codes and doubles."""

from fractions import Fraction

import mpmath
import numpy as np

from extremes.rows import row
from meissner import calibration, interval, second_order
from meissner.physics.adc import Adc
from reference import exact


@row("second order", {"": "1e-9 of the largest"})
def second_order_(see):
    for one in see.covering(
        top=[3, 100, 65535], a=[0.0, 1e-6, 5.0], b=[1e-6, 1.0, 1e3], c=[-1e-9, 0.0, 1e-6]
    ):
        forces = np.unique(np.linspace(1, one["top"], 7).astype(int))
        newtons = one["a"] + one["b"] * forces + one["c"] * forces**2.0
        terms = second_order.fit(forces[:, None, None], newtons[:, None, None])
        got = second_order.newtons(forces[:, None, None], terms)[:, 0, 0]
        largest = np.abs(newtons).max()
        for force, value in zip(forces.tolist(), got.tolist()):
            wanted = Fraction(one["a"]) + Fraction(one["b"]) * force + Fraction(one["c"]) * force**2
            see.near(value / largest, max(wanted, 0) / Fraction(largest), lambda: f"{one}, F {force}")
    see.same(
        second_order.fit(np.array([[[1.0]], [[2.0]]]), np.array([[[1.0]], [[2.0]]])).tolist(),
        [[[0.0] * 3]],
        "two forces",
    )
    see.same(
        second_order.newtons(
            np.array([[0, 65535]]), np.array([[[5.0, 1.0, 0.0], [0.0, -1.0, 0.0]]])
        ).tolist(),
        [[0.0, 0.0]],
        "F = 0, below 0",
    )


@row("calibration", {"": "1/2 LSB"})
def calibration_(see):
    """Lines at the ends of the codes: offset and gain are the integers nearest to the exact line."""
    for one in see.covering(slope=[1, 10, 1000, 20000], rest=[-65536, -1, 0, 1, 32768], shift=[8, 12, 16]):
        slope, rest, shift = one.values()
        newtons = [k / 4 for k in range(5)]  # up to 1 N, exact in doubles
        if any((slope * k) % 4 for k in range(5)) and slope != 1:
            continue
        scale = 4 if slope == 1 else 1
        codes = np.array([rest + slope * scale * k // 4 for k in range(5)])[:, None, None]
        if codes.max() > 65535:
            see.refused(calibration.check_codes, codes)
            continue
        known = np.array(newtons)[:, None, None]
        try:
            lines, _ = calibration.fit(codes, known, gain_shift=shift)
        except ValueError as problem:
            said = any(word in str(problem) for word in ("gain", "coarse", "range"))
            see.same(said, True, (one, str(problem)))
            continue
        see.near(int(lines.offset[0, 0]), rest, one)
        gain = Fraction(2**shift) / (slope * scale * Fraction(lines.force_lsb_n))
        see.near(int(lines.gain[0, 0]), gain, one)
        see.same(0 < int(lines.gain[0, 0]) < 65536, True, one)
    for bad in (
        np.full((5, 1, 1), 65536),
        np.full((5, 1, 1), -65537),
        np.full((5, 1, 1), np.nan),
        np.full((5, 1, 1), 0.5),
    ):
        see.refused(calibration.check_codes, bad)
    for force in (np.nan, np.inf, -1.0):
        see.refused(calibration.cell_forces, np.array([0.0, force]), (2, 1, 1))
    flat = np.zeros((5, 1, 1))
    see.refused(calibration.fit, flat.astype(int), flat)


@row("interval", {"": "1e-9 of the tail"})
def interval_(see):
    """The condition of Clopper and Pearson, with 50 digits: at the low end this count or more is 2.5 %
    likely.
    """
    tail = (1 - mpmath.mpf(interval.CONFIDENCE)) / 2

    def at_least(count, runs, share):
        share = mpmath.mpf(share)
        few = range(count) if count <= runs // 2 else range(count, runs + 1)
        parts = [mpmath.binomial(runs, k) * share**k * (1 - share) ** (runs - k) for k in few]
        return 1 - mpmath.fsum(parts) if count <= runs // 2 else mpmath.fsum(parts)

    for runs in (1, 2, 40, 700 if see.long else 100):
        for count in sorted({0, 1, runs // 3, runs - 1, runs}):
            low, high = interval.exact(count, runs)
            if count:
                see.near(at_least(count, runs, low) / tail, 1, (count, runs, "low"))
            else:
                see.near(low, 0, (count, runs))
            if count < runs:
                see.near((1 - at_least(count + 1, runs, high)) / tail, 1, (count, runs, "high"))
            else:
                see.near(high, 1, (count, runs))
    low, high = interval.exact(10**9, 2 * 10**9)
    see.near(low + high, 1, "half of 2e9")
    for bad in ((1, 0), (-1, 5), (6, 5)):
        see.refused(interval.exact, *bad)


@row("converter", {"": "1/2 LSB"})
def converter_(see):
    for bits in (1, 8, 12, 16, 24):
        for low, high in ((0.0, 5.0), (-5.0, 5.0), (-10.0, 10.0), (0.0, 1e-6), (-1e6, 1e6)):
            part = Adc(bits, low, high)
            lsb = (Fraction(high) - Fraction(low)) / 2**bits
            volts = [
                low,
                high,
                0.0,
                -1e12,
                1e12,
                5e-324,
                np.nextafter(high, 2 * high),
                np.nextafter(low, low - 1),
            ]
            volts += [
                float(Fraction(low) + lsb * (2 * k + 1) / 2 + off * lsb / 1000)
                for k in (0, 1, 2**bits // 2, 2**bits - 2)
                for off in (-1, 1)
            ]
            codes, over = part.convert(volts)
            for v, code, out in zip(volts, codes.tolist(), over.tolist()):
                value = (Fraction(v) - Fraction(low)) / lsb + part.min_code
                wanted = exact.held(value, Fraction(part.min_code), Fraction(part.max_code))
                see.near(code, wanted, (bits, low, high, v))
                see.same(out, not low <= v <= high, (bits, low, high, v))
    for bad in (
        (0, 0.0, 1.0),
        (25, 0.0, 1.0),
        (8, 1.0, 2.0),
        (8, 0.0, 0.0),
        (8, -1.0, 2.0),
        (8, 0.0, 1.0, -1.0),
    ):
        see.refused(Adc, *bad)
