"""The capacitive pad against its principles: eq. 15 against Kirchhoff's law solved as a network, eq. 18 and
its limits, the tab's cubic, creep that recovers, crosstalk in a column, the carrier's samples."""

import numpy as np
import pytest

from meissner.physics import capacitive, footprints
from meissner.physics.capacitive import GRAM_N
from meissner.scenes.capacitive.scene import cell_mm, on_tabs

RNG = np.random.default_rng(4)


def test_the_output_is_kirchhoff_s_law_at_the_amplifier_s_input():
    """Unknowns: input voltage v and output u of an amplifier with u = -G v; complex, with every term."""
    for _ in range(200):
        cell, others, ref = 10.0 ** RNG.uniform(-13, -10, 3)
        hertz, gain = 10.0 ** RNG.uniform(4, 7), 10.0 ** RNG.uniform(0, 4)
        gain *= np.exp(1j * RNG.uniform(-np.pi / 2, 0))
        leak, at_input = 10.0 ** RNG.uniform(5, 10, 2)
        omega = 2j * np.pi * hertz
        into, back = omega * cell + 1 / leak, omega * ref
        node = into + back + omega * others + 1 / at_input
        _, u = np.linalg.solve([[node, -back], [gain, 1]], [7.0 * into, 0])
        got = capacitive.output_v(cell, others, gain, 7.0, ref, hertz, leak, at_input)
        assert got == pytest.approx(abs(u), rel=1e-9)


def test_eq_18_and_its_rule():
    others = np.array([0, 20, 40, 80]) * 1e-12
    gain = 200.0
    got = capacitive.output_v(1e-12, others, gain, 10.0)
    assert got == pytest.approx(10 * gain / (gain + others * 1e12 + 2))
    # The ideal output, and the output that the published rule G > 200 leaves at 80 pF.
    assert capacitive.output_v(1e-12, 80e-12, 1e9, 10.0) == pytest.approx(10.0, rel=1e-6)
    assert got[-1] == pytest.approx(7.092, abs=1e-3)
    # An amplifier whose gain lags by 90 degrees, as above its corner frequency, loses far less.
    assert capacitive.output_v(1e-12, 80e-12, -1j * gain, 10.0) == pytest.approx(9.2525, abs=1e-3)
    # Eq. 17: the higher the carrier, the smaller the effect of leakage.
    leaking = [capacitive.output_v(1e-12, 0, 1e12, 1.0, hertz=f, cell_ohm=10e6) - 1 for f in (1e4, 1e5, 2e5)]
    expected = [np.sqrt(1 + (2 * np.pi * f * 1e-12 * 10e6) ** -2.0) - 1 for f in (1e4, 1e5, 2e5)]
    assert leaking == pytest.approx(expected, rel=1e-6)


def test_a_tab_carries_its_force():
    force_n = np.linspace(0, 5, 101)
    u = capacitive.tab_height(force_n)
    shape = 1.4 / (4 * 0.75)
    modulus = capacitive.MODULUS_MPA * (1 + 2 * shape**2)
    assert np.pi / 4 * 1.4**2 * modulus / 3 * (u**-2.0 - u) == pytest.approx(force_n, abs=1e-12)
    assert u[0] == 1 and (np.diff(u) < 0).all() and u[-1] > 0
    # The axes of figure 8 run from 1800 to 2500 codes: 1900 at rest, 2450 under 100 g.
    assert capacitive.capacitance_ratio(100 * GRAM_N) == pytest.approx(2450 / 1900, abs=0.005)
    # Twice the stiffness under twice the force gives the same height; without tabs, nothing moves.
    assert capacitive.tab_height(2.0, 2.0) == pytest.approx(capacitive.tab_height(1.0))
    assert capacitive.capacitance_ratio(1.0, tab_mm=0.01) == pytest.approx(1, abs=1e-4)


def test_a_tab_s_answer_is_nearly_straight():
    """The response stays within 5 % of the span from the line from 0 to 150 g that the published calibration
    fits."""
    grams = np.linspace(0, 150, 51)
    ratio = capacitive.capacitance_ratio(grams * GRAM_N)
    off = ratio - np.polyval(np.polyfit(grams, ratio, 1), grams)
    assert 0.01 < np.abs(off).max() / np.ptp(ratio) < 0.05


def test_creep_sags_droops_and_comes_back():
    rate_hz = 20.0
    force_n = np.repeat([0.0, 1.0, 0.0], [20, 4000, 12000])
    answered = capacitive.creep(force_n, rate_hz)
    late = sum(share for share, _ in capacitive.CREEP)
    assert answered[0] == 0 and answered[20] == pytest.approx(1 - late)
    held, after = answered[20:4020], answered[4020:]
    assert (np.diff(held) >= 0).all() and held[-1] == pytest.approx(1, abs=0.01)
    assert (np.diff(after) <= 0).all() and after[-1] < 1e-3  # no permanent loss, so no classical hysteresis
    # Expansion is slower than contraction: after the same time, less of the late part has passed.
    k = 2
    assert (held[k] - held[0]) > 1.2 * (after[0] - after[k])


def test_a_line_leaves_4_g_and_a_parabola_a_third():
    """Without noise: a cell in a complete column with its amplifier, 0 to 150 g on the cover above it."""
    pad = capacitive.build_pad(8, 8, np.random.default_rng(1))
    place = on_tabs(*cell_mm(3, 4), np.linspace(0, 150, 151) * GRAM_N)
    volts, grams = pad.amplitude_v(place, 200.0, 5.0)[:, 3, 4], np.arange(151.0)
    slope, rest = np.polyfit(grams[::25], volts[::25], 1)
    read = (volts - rest) / slope
    assert read[[0, 75, 150]] - [0, 75, 150] == pytest.approx([-4.1, 3.3, -4.0], abs=0.1)
    bent = np.polyval(np.polyfit(read[::25], grams[::25], 2), read)
    assert np.abs(bent - grams).max() == pytest.approx(0.35, abs=0.02)


def test_a_twentieth_of_a_fast_press_is_late():
    """At the tops of four cycles of one second: 5.5, 5.3, 5.1 and 5.0 %, on average 5.2 %."""
    cycle = np.tile(1 - np.abs(1 - 2 * np.arange(50) / 50), 4)
    late = 1 - capacitive.creep(cycle, 50.0)[25::50]
    assert late == pytest.approx([0.055, 0.053, 0.051, 0.050], abs=5e-4)
    assert late.mean() == pytest.approx(0.052, abs=5e-4)


def test_creep_is_one_exponential_a_term(monkeypatch):
    monkeypatch.setattr(capacitive, "CREEP", ((0.3, 0.5),))
    answered = capacitive.creep(np.full((50, 2), 2.0), 10.0)
    assert answered[:, 1] == pytest.approx(2 * (1 - 0.3 * np.exp(-np.arange(50) / 5)))


def test_a_press_takes_from_its_column_and_from_no_other():
    pad = capacitive.build_pad(8, 8, np.random.default_rng(1))
    force_n = np.zeros((8, 8))
    rest_v = pad.amplitude_v(force_n, 200.0, 5.0)
    force_n[2, 5] = 1.0
    change = pad.amplitude_v(force_n, 200.0, 5.0) / rest_v - 1
    assert change[2, 5] > 0.2
    beside = np.delete(change[:, 5], 2)
    assert (beside < -1e-4).all() and beside.min() > -0.01
    assert np.abs(np.delete(change, 5, axis=1)).max() == 0
    # By the formula, with every other cell of the column as an unselected cell.
    c = pad.capacitance_f(force_n)
    others = c[:, 5].sum() - c[4, 5] + pad.stray_f
    expected = 5 * 200 * c[4, 5] / (200 * pad.ref_f[5] + others + pad.ref_f[5] + c[4, 5])
    assert pad.amplitude_v(force_n, 200.0, 5.0)[4, 5] == pytest.approx(expected)


def test_the_carrier_settles_to_its_amplitude():
    amplitude_v, before_v = np.array([1.0, 3.0]), np.array([2.0, 0.0])
    n = np.arange(64)
    got = capacitive.carrier(amplitude_v, 64, 8, phase=0.3, before_v=before_v, settle_samples=4.0)
    expected = np.sin(2 * np.pi * n / 8 + 0.3) * (
        amplitude_v[:, None] + (before_v - amplitude_v)[:, None] * np.exp(-n / 4)
    )
    assert got.shape == (2, 64) and got == pytest.approx(expected)
    assert capacitive.carrier(1.0, 16, 4) == pytest.approx(np.sin(np.pi / 2 * np.arange(16)))


def test_the_published_cell_is_more_than_its_plates():
    """The paper's 1 pF does not follow from its dimensions: flat plates give 0.06 to 0.11 pF."""
    assert capacitive.plate_f(1.0) == pytest.approx(0.057e-12, rel=0.01, abs=0)
    assert capacitive.plate_f(0.5) == pytest.approx(0.114e-12, rel=0.01, abs=0)


@pytest.mark.parametrize("shape", footprints.SHAPES)
def test_footprints_have_the_area_of_their_outlines(shape):
    x, y, area = footprints.points(shape)
    assert np.abs(np.stack([x, y])).max() < 8
    pieces = footprints.SHAPES[shape]
    bars = [p[3][0] * p[3][1] for p in pieces if p[0] == "bar"]
    rings = [np.pi / 4 * (p[3][0] ** 2 - p[3][1] ** 2) for p in pieces if p[0] == "ring"]
    assert area.sum() == pytest.approx(sum(bars) + sum(rings), rel=0.05)
    for line in footprints.outlines(shape):
        assert line[0] == pytest.approx(line[-1])


def test_the_two_edges_are_3_mm_apart():
    _, y, _ = footprints.points("two edges")
    gaps = np.diff(np.unique(y))
    assert gaps.max() == pytest.approx(3.0, abs=footprints.STEP_MM + 1e-9)


def test_every_cell_has_its_own_stiffness():
    pad = capacitive.build_pad(8, 8, np.random.default_rng(2))
    assert pad.stiffness.std() == pytest.approx(capacitive.STIFFNESS_SPREAD, rel=0.3)
    force_n = np.full((8, 8), 1.2)
    expected = [
        pad.rest_f[i, j] * capacitive.capacitance_ratio(1.2 / pad.stiffness[i, j])
        for i in range(8)
        for j in range(8)
    ]
    assert pad.capacitance_f(force_n).ravel() == pytest.approx(np.array(expected), rel=1e-12, abs=0)
