"""msn_cop_divide on a recorded force plate: a person stands on it for 32 s, eyes open and closed, 1 kHz. The
plate reports force, moments and its own centre of pressure, all as decimals, so that the integers here are
exactly what was recorded. The twin and msn_divide's twin are compared with exact rationals, and these with
the plate. Skipped with a message if the recordings are absent. docs/cop.md has the results: run
with -s."""

import csv
from fractions import Fraction

import numpy as np
import pytest

from meissner.twins.common.divide import divide
from meissner.twins.cop.cop import cop_divide
from published.recordings import find
from reference import exact

NAMES = ("eyesOpen_1", "eyesClosed_1")
SIDE = 128  # an array whose load is wide enough for micronewtons: 30 bits
# Metres between coordinates -1 and +1. It makes Mx = 127 (-My) / WIDTH a whole number of micronewton metres.
WIDTH = Fraction(254, 1000)


def micro(text):
    """A decimal of six digits as an integer number of millionths."""
    assert len(text.partition(".")[2]) == 6, text
    return int(text.replace(".", ""))


def plate():
    """S (micronewtons), Mx, My of the array that stands for the plate; the plate's own x, y (micrometres);
    [n] each.

    The centre of a wrench on the plate's surface is (-My, Mx) / Fz.
    """
    rows = []
    for name in NAMES:
        with open(find(f"acuna/{name}.csv"), newline="") as file:
            rows += [
                [micro(row[key]) for key in ("Fz", "Mx", "My", "CoPx", "CoPy")]
                for row in csv.DictReader(file)
            ]
    force, about_x, about_y, x, y = np.array(rows, dtype=np.int64).T
    span = (SIDE - 1) / WIDTH
    assert span.denominator == 1
    return force, -about_y * int(span), about_x * int(span), x, y


@pytest.fixture(scope="module")
def measured():
    try:
        return plate()
    except ValueError as absent:
        pytest.skip(str(absent))


@pytest.mark.parametrize("fraction_bits", [14, 20])
def test_twin_against_fractions_and_the_plate(measured, fraction_bits):
    force, mx, my, *own = measured
    assert len(force) == 64000 and force.min() > 8e8
    x, y, pressed = cop_divide(force, mx, my, SIDE, SIDE, fraction_bits)
    assert pressed.all()
    one = 1 << fraction_bits
    for got, moment, recorded, axis in ((x, mx, own[0], "x"), (y, my, own[1], "y")):
        assert np.array_equal(got, divide(moment, (SIDE - 1) * force, fraction_bits))
        ratios = zip(moment.tolist(), force.tolist())
        assert got.tolist() == [exact.away(Fraction(m * one, (SIDE - 1) * f)) for m, f in ratios]
        metres = float(WIDTH) / one * got
        off = np.abs(metres * 1e6 - recorded)
        # The plate's centre is rounded to a micrometre, ours to a step; the rest is rounding of its other
        # decimals.
        assert off.max() <= 0.5 + 0.5 * float(WIDTH) * 1e6 / one + 1e-3
        print(
            f"Q2.{fraction_bits} {axis}: {np.ptp(recorded) / 1e3:.1f} mm of travel, "
            f"off the plate's own centre by {off.mean():.3f} um in the mean, {off.max():.3f} um at most"
        )
