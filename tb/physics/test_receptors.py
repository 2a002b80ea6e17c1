"""The four channels, by hand: table 1, thresholds at and between their knots, the contactor's area, and what
a displacement in time does to each."""

import numpy as np
import pytest

from meissner.physics import receptors
from meissner.physics.receptors import CHANNELS, sensation, threshold_db

# Table 1: receptor, field in mm2, density per cm2, depth; and the units over a point, field times density.
TABLE_1 = {
    "SA-I": ("Merkel", 11, 60, "shallow", 6.6),
    "SA-II": ("Ruffini", 59, 10, "deep", 5.9),
    "FA-I": ("Meissner", 13, 140, "shallow", 18.2),
    "FA-II": ("Pacini", 101, 20, "deep", 20.2),
}


def test_table_1():
    for name, one in CHANNELS.items():
        own = one.receptor, one.field_mm2, one.density_cm2, one.depth, pytest.approx(one.units)
        assert own == TABLE_1[name], name
    assert [name for name, one in CHANNELS.items() if one.sums] == ["FA-II"]
    assert [one.channel for one in CHANNELS.values()] == ["NP III", "NP II", "NP I", "P"]


@pytest.mark.parametrize("name", CHANNELS)
def test_straight_lines_between_knots(name):
    """At a knot its value, half way between two on the log scale their mean; the ends go on."""
    (f0, t0), (f1, t1), *_ = knots = CHANNELS[name].knots
    at = lambda hz: float(threshold_db(name, hz, receptors.PLOTTED_CM2))
    assert [at(f) for f, _ in knots] == pytest.approx([t for _, t in knots])
    assert at(np.sqrt(f0 * f1)) == pytest.approx((t0 + t1) / 2)
    assert at(f0**2 / f1) == pytest.approx(2 * t0 - t1)
    (f0, t0), (f1, t1) = knots[-2:]
    assert at(f1**2 / f0) == pytest.approx(2 * t1 - t0)


def test_each_channel_is_the_most_sensitive_where_it_should_be():
    """Bolanowski et al.: NP III below 3 Hz, NP I to 40 Hz, P above; NP II nowhere with a large contactor."""
    best = lambda hz: min(CHANNELS, key=lambda name: float(threshold_db(name, hz, receptors.PLOTTED_CM2)))
    assert [best(hz) for hz in (0.4, 1, 5, 10, 20, 60, 150, 250, 500)] == 2 * ["SA-I"] + 3 * ["FA-I"] + 4 * [
        "FA-II"
    ]
    dips = {name: min(one.knots, key=lambda knot: knot[1])[0] for name, one in CHANNELS.items()}
    assert dips["FA-I"] == 40 and dips["FA-II"] == dips["SA-II"] == 250


def test_pacini_falls_by_12_db_an_octave():
    """From 40 Hz to its best at about 250 Hz, published; other knots are from memory."""
    high, low = threshold_db("FA-II", np.array([40.0, 250.0]), receptors.PLOTTED_CM2)
    assert (high - low) / np.log2(250 / 40) == pytest.approx(12, abs=1)


def test_the_area_of_the_contactor():
    """Ten times the area, 10 dB, below 0.1 cm2; above 3.3 dB a decade on the fingertip, 10 on the thenar.
    From 0.008 to 0.0007 cm2 10 log10(80 / 7) = 10.58 dB. No other channel has it."""
    of = receptors.summation_db
    assert of(0.001) - of(0.01) == pytest.approx(10) and of(0.0007) - of(0.008) == pytest.approx(
        10.5799, abs=1e-4
    )
    assert of(2.9) == of(2.9, "thenar") == 0 and of(0.29) == pytest.approx(3.3)
    assert of(0.1) == pytest.approx(3.3 * np.log10(29)) and of(0.0029, "thenar") == pytest.approx(30)
    for name in ("SA-I", "SA-II", "FA-I"):
        assert threshold_db(name, 20.0, 0.0007) == threshold_db(name, 20.0, 2.9)
    assert threshold_db("FA-II", 20.0, 0.0007) - threshold_db("FA-II", 20.0, 2.9) == pytest.approx(of(0.0007))


@pytest.mark.parametrize("name, hz", [("SA-I", 2.0), ("FA-I", 16.0), ("SA-II", 250.0), ("FA-II", 250.0)])
def test_a_sine_at_its_threshold_is_just_felt(name, hz):
    at = np.arange(8000) / 8000
    peak = 10 ** (float(threshold_db(name, hz)) / 20)
    sine = peak * np.sin(2 * np.pi * hz * at)
    assert np.abs(sensation(name, sine, 8000.0)).max() == pytest.approx(1, rel=1e-3)
    held = sensation(name, np.full(80, 10**1.4), 8000.0)  # 28 dB
    assert held == pytest.approx(1.0 if name == "SA-I" else 0.0, abs=1e-2)
    level = 20 * np.log10(peak)
    assert receptors.reached(name, hz, level + 1e-9) and not receptors.reached(name, hz, level - 1e-9)
