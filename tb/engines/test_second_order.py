"""The second-order term: a parabola is recovered exactly, F = 0 stays 0, too few forces give a term of 0; the
least squares against NumPy's polyfit, cell by cell."""

from fractions import Fraction

import numpy as np
import pytest

from meissner import second_order


def test_a_parabola_comes_back():
    """2 + F/8 + F^2/64 newtons at F = 4, 8, 16, 24: 11/4, 4, 8, 14, by hand."""
    forces = np.array([4, 8, 16, 24])[:, None, None]
    force_n = np.array([2.75, 4.0, 8.0, 14.0])[:, None, None]
    assert [
        float(2 + Fraction(f, 8) + Fraction(f * f, 64)) for f in (4, 8, 16, 24)
    ] == force_n.ravel().tolist()
    terms = second_order.fit(forces, force_n)
    assert terms[0, 0] == pytest.approx([2, 1 / 8, 1 / 64], rel=1e-10)
    assert second_order.newtons([[12]], terms)[0, 0] == pytest.approx(5.75)  # 2 + 3/2 + 9/4
    assert second_order.newtons([[0]], terms)[0, 0] == 0
    assert second_order.newtons([[1]], np.array([[[-3.0, 1.0, 0.5]]]))[0, 0] == 0  # -3/2: no force is below 0


def test_least_squares_of_each_cell_alone():
    rng = np.random.default_rng(7)
    forces = rng.integers(0, 20000, (50, 2, 3))
    forces[rng.random(forces.shape) < 0.2] = 0
    force_n = 0.1 + 1e-4 * forces * rng.uniform(0.8, 1.2, (2, 3)) + 3e-9 * forces**2.0
    force_n += 0.01 * rng.standard_normal(force_n.shape)
    force_n[rng.random(force_n.shape) < 0.3] = np.nan
    terms = second_order.fit(forces, force_n)
    for cell in np.ndindex(2, 3):
        known = ~np.isnan(force_n[:, *cell]) & (forces[:, *cell] > 0)
        expected = np.polyfit(forces[known, *cell], force_n[known, *cell], 2)[::-1]
        assert terms[cell] == pytest.approx(expected, rel=1e-6)


def test_too_few_forces_give_nothing():
    forces = np.array([0, 0, 100, 101, 200, 200])[:, None, None] * np.ones((1, 1, 2), int)
    force_n = np.array([0, 0, 1, 1, 2, 2.0])[:, None, None] * np.ones((1, 1, 2))
    force_n[5, 0, 1] = 3.0
    terms = second_order.fit(forces, force_n)
    assert not terms[0, 0].any() and terms[0, 1].any()
    assert second_order.newtons(forces[4], terms)[0, 0] == 0
