"""Extremes of the converter and of the fit of the rubber's constants."""

from fractions import Fraction

import numpy as np

from extremes.rows import row
from meissner import fit_rubber
from meissner.physics.adc import Adc
from reference import exact


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
                -1e200,
                1e200,
                -np.inf,
                np.inf,
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
                value = (
                    Fraction(part.max_code if v > 0 else part.min_code)
                    if np.isinf(v)
                    else (Fraction(v) - Fraction(low)) / lsb + part.min_code
                )
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


@row("rubber fit", {"": "1e-9"})
def rubber_fit(see):
    """The fit recovers the constants of steps without noise, at the ends of the range that the check
    accepts."""
    fits = 0
    for one in see.covering(
        k0=[0.5, 1.55, 100.0],
        k1=[-0.1, 0.0, 0.27],
        n=[0.01, 0.11, 1.0, 4.0],
        slow=[1e-6, 0.01, 1.0],
        ratio=[10.0, 1e3],
    ):
        rest = np.array([2.0, 2.5, 3.0, 3.5, 4.0, 2.2, 3.3, 3.9])
        speed = one["slow"] * np.geomspace(1, one["ratio"], 8)[[0, 7, 3, 5, 1, 6, 2, 4]]
        step = (one["k0"] + one["k1"] * rest) * speed ** one["n"]
        try:
            found = fit_rubber.fit((rest, step, speed))
        except ValueError:  # refused with a sentence, except for the published ones
            see.same((one["k0"], one["k1"], one["n"]) == (1.55, -0.1, 0.11), False, one)
            continue
        fits += 1
        for name, value in zip(("k0", "k1", "n"), found.value):
            see.near(
                float(value),
                Fraction(one[name]),
                lambda: f"{name}, {one}",
                limit=Fraction(1, 10**9) * max(Fraction(one["k0"]), 1),
            )
    see.same(fits >= 8, True, f"{fits} fits")
    good = np.array([2.0, 3.0, 4.0, 2.0, 3.0])
    for bad in (
        (good, good * 0, good),
        (good, good, -good),
        (good, good, good * 0 + 1),
        (good * 0 + 2, good, good),
        (good[:2],) * 3,
    ):
        see.refused(fit_rubber.fit, bad)
