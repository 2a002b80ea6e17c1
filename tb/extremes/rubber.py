"""Extremes of the rubber's physics and of the fit of its constants, to the ends of doubles."""

from fractions import Fraction

import mpmath
import numpy as np

from extremes.rows import row
from meissner import fit_rubber
from meissner.physics import rubber


@row("rubber", {"": "2e-14", "the distance slipped": "1e-15"})
def rubber_(see):
    for force, volts in rubber.POINTS:
        see.near(float(rubber.rest_volts(force)) / 5, Fraction(volts) / 5, f"published, {force} N")
    forces = np.array([0.0, 5e-324, 1e-300, 1e-12, 0.1, 0.5, 1.0, 1.7, 10.0, 1e6, 1e12])
    volts = rubber.rest_volts(forces)
    see.same(
        bool(np.isfinite(volts).all() and (volts >= 0).all() and (volts <= 5).all()), True, "0 to 1e12 N"
    )
    see.same(bool((np.diff(volts) <= 0).all()), True, "more force, never more volts")
    for vi in (0.0, 2.0, 3.0, 4.0, 4.999, 5.0):
        k = min(
            mpmath.mpf("1.55") - mpmath.mpf("0.27") * mpmath.mpf(vi),
            mpmath.mpf("0.47") * (5 - mpmath.mpf(vi)),
        )
        for speed in (0.0, 5e-324, 1e-12, 0.01, 3.0, 1e6, 1e12):
            wanted = k * mpmath.power(mpmath.mpf(speed), mpmath.mpf("0.11"))
            got = float(rubber.shear_step(vi, speed))
            see.near(
                (got - wanted) / max(abs(wanted), mpmath.mpf("0.1")),
                0,
                (vi, speed),
                limit=Fraction(2, 10**14),
            )
    for q in (0.0, 5e-324, 1e-16, 1e-9, 1e-3, 0.12, 0.5, 0.875, 1 - 2.0**-53, 1.0):
        value = mpmath.mpf("1.5") * (1 - mpmath.power(1 - mpmath.mpf(q), mpmath.mpf(2) / 3)) - mpmath.mpf(q)
        see.near(float(rubber.slipped(q)), value, q, "the distance slipped")
    for q in (-1.0, 2.0, 1e12):
        see.near(float(rubber.slipped(q)), 0 if q < 0 else Fraction(1, 2), q, "the distance slipped")
    for rate in (1e-3, 1e4, 1e9):
        level = rubber.shear_level(np.arange(50) / rate, np.repeat([0.0, 1e-9, 3.0, 1e6, 0.0], 10))
        see.same(bool(np.isfinite(level).all() and (level >= 0).all()), True, f"{rate} Hz")


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
