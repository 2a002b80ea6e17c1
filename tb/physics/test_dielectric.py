"""Tabs against a flat sheet: Hooke's three equations in exact fractions, the tab's law at heights worked out
by hand, the rise of capacitance against the physics of the scenes, eq. 16 and 17 against Kirchhoff's law."""

from fractions import Fraction

import numpy as np
import pytest

from meissner.physics import capacitive, dielectric


def strains(s_x, s_y, s_z, v, modulus):
    """Hooke's law along the three axes, as printed in textbooks."""
    return [(a - v * (b + c)) / modulus for a, b, c in ((s_x, s_y, s_z), (s_y, s_x, s_z), (s_z, s_x, s_y))]


@pytest.mark.parametrize("v", [Fraction(0), Fraction(1, 4), Fraction(2, 5), Fraction(1, 2)])
def test_a_confined_cube_keeps_its_sides(v):
    stress, modulus = Fraction(6), Fraction(10)
    lateral = stress * v / (1 - v)
    along, *sides = strains(stress, lateral, lateral, v, modulus)
    assert sides == [0, 0]
    assert along == dielectric.strain_confined(stress, v, modulus)


def test_rubber_that_keeps_its_volume_feels_nothing_without_tabs():
    """By hand: at v = 1/4 a strain of 1/2."""
    assert dielectric.strain_confined(Fraction(6), Fraction(1, 4), Fraction(10)) == Fraction(1, 2)
    assert dielectric.strain_confined(Fraction(6), Fraction(1, 2), Fraction(10)) == 0
    assert dielectric.rise_without_tabs(150.0, 0.5) == 0
    # 1.539 mm2 under 1.4709975 N is 0.95557 MPa; v = 2/5 leaves 7/15 of that: 44.59 % thinner.
    assert dielectric.rise_without_tabs(150.0, 0.4) == pytest.approx(1 / (1 - 0.445935) - 1, rel=1e-4)


def test_what_halves_a_tab():
    """u = 1/2: 1/u^2 - u = 7/2. Height 0.75: S = 7/15, E' = 323/225; 0.25: S = 7/5, E' = 123/25 MPa."""
    for tab_mm, stiff_mpa, share in ((0.75, 323 / 225, 0.6), (0.25, 123 / 25, 1 / 3)):
        newtons = 0.49 * np.pi * stiff_mpa / 3 * 3.5
        assert dielectric.force_for(share, tab_mm) == pytest.approx(newtons / 9.80665e-3, rel=1e-12)
        assert capacitive.tab_height(newtons, tab_mm=tab_mm) == pytest.approx(0.5)
        assert dielectric.rise(newtons / 9.80665e-3, tab_mm) == pytest.approx(share)
    # At u = 0 the tab has no height: 1.0 mm over 0.25 mm is four times the capacitance, and no force exceeds
    # that.
    assert np.isinf(dielectric.force_for(3.0, 0.75)) and np.isfinite(dielectric.force_for(2.999, 0.75))
    assert np.isinf(dielectric.force_for(1.0, 0.25)) and np.isfinite(dielectric.force_for(0.999, 0.25))


def test_the_flattest_tab_has_seven_times_the_range():
    """The rise that 100 g cause on the highest tab takes 702 g on the flattest; 100 g cause a fifth of it
    there."""
    share = dielectric.rise(100.0, 0.75)
    assert share == pytest.approx(0.2886, abs=1e-4)
    assert dielectric.force_for(share, np.array([0.25, 0.5, 0.75])) == pytest.approx(
        [702.5, 166.1, 100], abs=0.1
    )
    assert dielectric.rise(100.0, 0.25) == pytest.approx(0.0605, abs=1e-4)


def test_eq_16_and_17():
    hertz = 0.75 / (2 * np.pi * 1e6 * 1e-12)  # w·R·C = 3/4: sqrt(1 + 16/9) = 5/3
    assert dielectric.leaking_v(10.0, hertz, 1e6) == pytest.approx(50 / 3)
    assert dielectric.leaking_v(10.0, hertz, np.inf) == pytest.approx(10.0)
    assert dielectric.leaking_v(9.0, 1e5, np.inf, cell_f=2e-12, ref_f=3e-12) == pytest.approx(6.0)
    for cell_ohm in (1e5, 3e6):
        whole = capacitive.output_v(1e-12, 7e-12, 1e9, 10.0, hertz=2e5, cell_ohm=cell_ohm)
        assert dielectric.leaking_v(10.0, 2e5, cell_ohm) == pytest.approx(whole, rel=1e-6)
