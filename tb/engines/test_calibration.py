"""The calibration: the fit against NumPy's polyfit cell by cell, the integers against Python's fractions, the
fitted line inverted by the core's formula; every form of a press recording; which cells are dead and which
are refused."""

from fractions import Fraction
from math import floor

import numpy as np
import pytest

from meissner import calibration, engines
from meissner.calibration import Calibration, cell_forces, fit


def recording(rows=4, columns=5, frames=60, seed=1, noise=2.0):
    """Codes of noisy lines; some forces are unknown."""
    rng = np.random.default_rng(seed)
    slope, intercept = rng.uniform(200, 900, (rows, columns)), rng.uniform(-500, 3000, (rows, columns))
    force_n = rng.uniform(0, 8, (frames, rows, columns))
    codes = np.rint(intercept + slope * force_n + noise * rng.standard_normal(force_n.shape)).astype(int)
    force_n[rng.random(force_n.shape) < 0.3] = np.nan
    return codes, force_n


def test_the_fit_is_least_squares():
    codes, force_n = recording()
    slope, intercept, explained = calibration.line(codes, force_n)
    answer, residual_n = fit(codes, force_n)
    for i in range(4):
        for j in range(5):
            known = ~np.isnan(force_n[:, i, j])
            f, c = force_n[known, i, j], codes[known, i, j]
            m, b = np.polyfit(f, c, 1)
            assert (slope[i, j], intercept[i, j]) == pytest.approx((m, b), rel=1e-9)
            assert explained[i, j] == pytest.approx(np.corrcoef(f, c)[0, 1] ** 2)
            assert residual_n[i, j] == pytest.approx(np.sqrt(np.mean(((c - b) / m - f) ** 2)))
            assert answer.offset[i, j] == floor(Fraction(b) + Fraction(1, 2))
            ideal = Fraction(1 << 12) / Fraction(m) / Fraction(answer.force_lsb_n)
            assert abs(answer.gain[i, j] - ideal) <= Fraction(1, 2) + Fraction(1, 10**6)
    assert not answer.dead.any() and answer.gain_shift == 12


def test_the_gains_use_their_registers():
    """The LSB is the finest of 1, 2, 5 times a power of ten that fits: the next finer one would not."""
    for seed in range(20):
        codes, force_n = recording(seed=seed)
        answer, _ = fit(codes, force_n)
        lsb_n = answer.force_lsb_n
        mantissa = float(f"{lsb_n:e}".split("e")[0])
        assert mantissa in (1, 2, 5)
        assert answer.gain.max() <= 65535 and 1.5 * np.nanmax(force_n) / lsb_n <= 65535
        finer = lsb_n / (2.5 if mantissa == 5 else 2)
        assert answer.gain.max() * lsb_n / finer > 65535 or 1.5 * np.nanmax(force_n) / finer > 65535


@pytest.mark.parametrize("engine", engines.NAMES)
def test_the_engines_calibrate_as_the_formula_says(engine):
    rng = np.random.default_rng(3)
    shape = (3, 3)
    for shift in (12,) if engine == "rtl" else (1, 12, 16):  # each shift is a build of its own
        lines = Calibration(
            offset=rng.integers(-65536, 65536, shape),
            gain=rng.integers(0, 65536, shape),
            gain_shift=shift,
            dead=rng.random(shape) < 0.2,
            force_lsb_n=0.001,
        )
        lines.gain[0, :3] = 0, 1, 65535
        lines.offset[0, :2] = -65536, 65535
        codes = rng.integers(-65536, 65536, (40, *shape))
        codes[0], codes[1] = -65536, 65535
        codes[2] = np.clip(lines.offset + 1, None, 65535)
        codes[3:20] = np.clip(lines.offset + rng.integers(-3, 40, (17, *shape)), -65536, 65535)
        got = engines.calibrate(codes, lines, engine)
        assert got.dtype == np.uint16
        for index in np.ndindex(codes.shape):
            place = index[1:]
            exact = Fraction(int(codes[index] - lines.offset[place]) * int(lines.gain[place]), 1 << shift)
            expected = min(max(floor(exact + Fraction(1, 2)), 0), 65535)
            assert got[index] == (0 if lines.dead[place] else expected)


def test_what_was_fitted_is_undone():
    codes, force_n = recording(noise=0.0)
    answer, _ = fit(codes, force_n)
    back = engines.calibrate(codes, answer, "fixed") * answer.force_lsb_n
    known = ~np.isnan(force_n)
    assert np.abs(back - force_n)[known].max() < 1.2 / 200 + 8 * 1e-4  # the code's and the offset's rounding


@pytest.mark.parametrize("engine", engines.NAMES)
def test_process_cop_of_codes(engine):
    codes, force_n = recording(rows=3, columns=3)
    answer, _ = fit(codes, force_n)
    result = engines.process_cop(codes, engine, 5, answer)
    forces = engines.calibrate(codes, answer, "fixed")
    expected = engines.process_cop(forces, engine, 5)
    assert all(np.array_equal(result[name], expected[name]) for name in expected)


def test_every_form_of_a_recording_says_the_same():
    shape = (9, 2, 2)
    each = np.arange(9.0)
    whole = cell_forces(each, shape)
    assert whole.shape == shape and (whole == each[:, None, None]).all()
    assert np.array_equal(cell_forces(whole, shape), whole)
    probed = np.array([[-1, -1], [0, 1], [0, 1], [1, 0], [1, 1], [1, 1], [0, 0], [-1, -1], [1, 0]])
    force = np.where((probed == -1).all(axis=1), 0.0, each)
    known = cell_forces(force, shape, probed)
    assert (known[[0, 7]] == 0).all()
    for k, (row, column) in enumerate(probed):
        if row >= 0:
            assert known[k, row, column] == each[k] and np.isnan(known[k]).sum() == 3


def test_cells_without_enough_presses_are_named():
    codes, force_n = recording()
    force_n[:, 1, 2] = np.nan
    force_n[:, 3, 4] = np.where(force_n[:, 3, 4] < 4, 0.0, 5.0)  # two forces only
    force_n[:, 0, 0] = np.linspace(0, 1.5, 60)  # all within 0.2 of the largest
    with pytest.raises(ValueError, match=r"\(0, 0\), \(1, 2\), \(3, 4\)"):
        fit(codes, force_n)
    force_n[:, 0, 0] = np.linspace(0, 1.7, 60)
    with pytest.raises(ValueError, match=r"\(1, 2\), \(3, 4\)"):
        fit(codes, force_n)
    with pytest.raises(ValueError, match=r"30 cells"):
        fit(np.zeros((3, 5, 6), int), np.ones((3, 5, 6)))


def test_three_forces_are_enough_in_any_order():
    force_n = np.array([2.0, 0, 1, 1, 0, 2])[:, None, None] * np.ones((2, 2))
    answer, residual_n = fit(np.rint(50 + 1000 * force_n).astype(int), force_n)
    assert (answer.offset == 50).all() and residual_n.max() < 1e-12
    with pytest.raises(ValueError, match="presses"):
        fit(np.ones((6, 2, 2), int), 0 * force_n)


def test_dead_cells():
    codes, force_n = recording(rows=4, columns=5, frames=200)
    rng = np.random.default_rng(9)
    codes[:, 0, 0] = 1234  # stuck
    codes[:, 0, 1] = rng.integers(0, 4000, 200)  # noise
    codes[:, 0, 2] = 3000 - codes[:, 0, 2]  # falls with the force
    codes[:, 0, 3] = np.where(rng.random(200) < 0.5, 0, codes[:, 0, 3])  # drops to 0 at random
    codes[:, 0, 4] = np.rint(100 + 15 * np.nan_to_num(force_n[:, 0, 4]))  # too small a slope
    answer, residual_n = fit(codes, force_n)
    assert answer.dead[0].all() and not answer.dead[1:].any()
    assert (answer.gain[0] == 0).all() and (answer.offset[0] == 0).all() and np.isnan(residual_n[0]).all()
    assert not engines.calibrate(codes, answer, "fixed")[:, 0].any()
    with pytest.raises(ValueError, match="rises"):
        fit(-codes[:, 1:], force_n[:, 1:])


def test_an_offset_beyond_the_samples_is_refused():
    force_n = np.array([100.0, 120, 140])[:, None, None] * np.ones((1, 2))
    codes = np.rint(4000 * (force_n - 100)).astype(int) // 10
    with pytest.raises(ValueError, match=r"\(0, 0\)"):
        fit(codes * 5 - 60000, force_n)


def test_files(tmp_path):
    answer, _ = fit(*recording())
    with open(tmp_path / "cal.npz", "wb") as file:
        answer.save(file)
    back = calibration.load(tmp_path / "cal.npz")
    for name in ("offset", "gain", "dead"):
        assert np.array_equal(getattr(back, name), getattr(answer, name))
    assert (back.gain_shift, back.force_lsb_n) == (answer.gain_shift, answer.force_lsb_n)


CODES = np.zeros((3, 2, 2), int)
PROBED = np.array([[0, 0], [0, 1], [1, 0]])


@pytest.mark.parametrize(
    "force_n, probed, says",
    [
        (np.zeros(4), None, "shape"),
        (np.array([0, -1.0, 0]), None, "newtons"),
        (np.array([0, np.nan, 0]), None, "newtons"),
        (np.array([0, np.inf, 0]), None, "newtons"),
        (np.array(["a", "b", "c"]), None, "numbers"),
        (np.zeros((3, 2, 2)), PROBED, "probed"),
        (np.zeros(3), PROBED[:2], "probed"),
        (np.zeros(3), PROBED + 1.0, "probed"),
        (np.zeros(3), PROBED + 1, "2×2"),
        (np.zeros(3), PROBED - [[1, 0]], "2×2"),
        (np.ones(3), np.full((3, 2), -1), "probed"),
    ],
)
def test_a_bad_recording_gets_one_sentence(force_n, probed, says):
    with pytest.raises(ValueError, match=says):
        cell_forces(force_n, CODES.shape, probed)


def test_what_a_calibration_cannot_be():
    good = fit(*recording())[0]
    parts = {name: getattr(good, name) for name in ("offset", "gain", "gain_shift", "dead", "force_lsb_n")}
    for change, says in [
        ({"offset": good.offset - 70000}, "offsets"),
        ({"gain": good.gain - 65536}, "gains"),
        ({"gain_shift": 0}, "gain_shift"),
        ({"gain_shift": 17}, "gain_shift"),
        ({"dead": good.dead[:1]}, "shape"),
        ({"force_lsb_n": 0.0}, "force_lsb_n"),
        ({"force_lsb_n": float("nan")}, "force_lsb_n"),
    ]:
        with pytest.raises(ValueError, match=says):
            Calibration(**parts | change)
