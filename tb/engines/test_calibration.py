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


def by_formula(code, lines, place):
    """F of a code, in exact arithmetic."""
    exact = Fraction(int(code - lines.offset[place]) * int(lines.gain[place]), 1 << lines.gain_shift)
    return 0 if lines.dead[place] else min(max(floor(exact + Fraction(1, 2)), 0), 65535)


def test_the_fit_is_least_squares():
    codes, force_n = recording()
    slope, intercept, explained = calibration.line(codes, force_n)
    answer, deviation_n = fit(codes, force_n)
    for i in range(4):
        for j in range(5):
            known = ~np.isnan(force_n[:, i, j])
            f, c = force_n[known, i, j], codes[known, i, j]
            m, b = np.polyfit(f, c, 1)
            assert (slope[i, j], intercept[i, j]) == pytest.approx((m, b), rel=1e-9)
            assert explained[i, j] == pytest.approx(np.corrcoef(f, c)[0, 1] ** 2)
            assert answer.offset[i, j] == floor(Fraction(b) + Fraction(1, 2))
            ideal = Fraction(1 << 12) / Fraction(m) / Fraction(answer.force_lsb_n)
            assert abs(answer.gain[i, j] - ideal) <= Fraction(1, 2) + Fraction(1, 10**6)
            # The deviation is that of the core's own integers.
            held = [by_formula(code, answer, (i, j)) * answer.force_lsb_n for code in c]
            assert deviation_n[i, j] == pytest.approx(np.sqrt(np.mean((held - f) ** 2)), rel=1e-9)
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
            assert got[index] == by_formula(codes[index], lines, index[1:])


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
    for rows, columns in ((2, 4), (4, 2)):  # the last cell, and one beyond it
        last = np.array([[rows - 1, columns - 1]])
        assert cell_forces([3.0], (1, rows, columns), last)[0, -1, -1] == 3.0
        for beyond in ([1, 0], [0, 1]):
            with pytest.raises(ValueError, match=f"outside {rows}×{columns}"):
                cell_forces([3.0], (1, rows, columns), last + beyond)
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


def even(*cells, forces=(0, 1, 2, 3, 4, 5, 6)):
    """A recording of one row of ``cells``, functions of the force on all of them."""
    force_n = np.array(forces, float)
    codes = np.stack([np.broadcast_to(np.rint(cell(force_n)), force_n.shape) for cell in cells], axis=-1)
    return codes[:, None].astype(int), cell_forces(force_n, (len(force_n), 1, len(cells)))


@pytest.mark.parametrize(
    "slope, largest, lsb, says",
    [
        (10_000, 5, 1.0, "too coarse for forces up to 5 N"),
        (10_000, 5, 0.1, r"gain of 4\.1 is rounded by more than 2 %"),
        (500, 100, 0.001, r"reaches 65\.53 N, the recording 100 N"),
        (100, 65.535, 0.001, None),  # 65535 codes of F are just enough
        (100, 65.536, 0.001, "reaches"),
        (19_980, 3, 0.01, r"gain of 20\.5 "),  # 21 is 2.4 % more
        (19_505, 3, 0.01, None),  # 21.0
        (100, 5, 0.5, None),  # a tenth of the largest force
        (100, 5, 0.501, "too coarse"),
        (100, 3, 4096 / (100 * 65535) * 1.000001, None),  # a gain of 65535
        (100, 3, 4096 / (100 * 65536), "a gain would not fit"),
        (100, 3, -1.0, "above 0"),
    ],
)
def test_an_lsb_that_makes_forces_wrong_is_refused_with_one_that_fits(slope, largest, lsb, says):
    recording = even(lambda n: 37 + slope * n, forces=largest * np.arange(5) / 4)
    if says is not None:
        with pytest.raises(ValueError, match=says) as problem:
            fit(*recording, lsb)
        lsb = float(str(problem.value).split("--lsb ")[1].removesuffix(" fits"))
    answer, deviation_n = fit(*recording, lsb)
    assert answer.force_lsb_n == lsb
    forces = [by_formula(code, answer, (0, 0)) * lsb for code in recording[0][:, 0, 0]]
    coarse = 0.02 * largest if says is None else 1e-3 * largest
    assert forces == pytest.approx(largest * np.arange(5) / 4, abs=max(coarse, lsb / 2 + 1 / slope))
    assert deviation_n[0, 0] == pytest.approx(np.sqrt(np.mean((forces - largest * np.arange(5) / 4) ** 2)))


@pytest.mark.parametrize("largest, lsb", [(43.69, 0.001), (43.70, 0.002)])
def test_the_range_of_forces_is_half_as_much_again(largest, lsb):
    """65535 codes of 1 mN are 1.5 times 43.69 N. One code of the converter is 1 mN."""
    answer, _ = fit(*even(lambda n: 1000 * n, forces=largest * np.arange(5) / 4))
    assert (answer.force_lsb_n, answer.gain[0, 0]) == (lsb, round(4.096 / lsb))


def test_no_lsb_holds_cells_that_differ_by_too_much():
    """The median cell has 10 codes a newton and three thousand times as many are in one."""
    with pytest.raises(ValueError, match=r"rounded by more than 2 %.*\(0, 2\)$"):
        fit(*even(lambda n: n, lambda n: 10 * n, lambda n: 30_000 * n - 50_000, forces=np.arange(4)))


def curved(rows, columns, seed, noise=0.0, levels=25):
    """Cells that saturate, from a nearly straight one to one that is full at a quarter of the range."""
    rng = np.random.default_rng(seed)
    reach = rng.permutation(np.geomspace(0.08, 2.0, rows * columns)).reshape(rows, columns)
    force_n = np.repeat(np.linspace(0, 1.2, levels), 1 + 3 * (noise > 0))
    codes = 31 + 217 * (1 - np.exp(-force_n[:, None, None] / reach))
    return np.rint(codes + noise * rng.standard_normal(codes.shape)).astype(int), force_n


@pytest.mark.parametrize("rows, columns, noise", [(4, 5, 0.0), (4, 5, 1.5), (28, 56, 1.0)])
def test_cells_that_bend_are_not_dead(rows, columns, noise):
    """A full press reads its load, by the tables; each line starts at rest, so no touch is lost."""
    codes, force_n = curved(rows, columns, 5, noise)
    answer, deviation_n = fit(codes, cell_forces(force_n, codes.shape))
    assert not answer.dead.any() and answer.bent.mean() > 0.7 and np.isfinite(deviation_n).all()
    assert not answer.bent[(deviation_n < 0.01)].any()
    forces = engines.calibrate(codes, answer, "fixed").astype(np.int64)
    load_n = answer.load_n(codes, forces.sum(axis=(1, 2)))
    cells = rows * columns
    at_full = force_n == force_n.max()
    # With noise, a full cell reads a mean of the forces that fill it, which nothing can tell apart.
    assert load_n[at_full].mean() / cells == pytest.approx(1.2, rel=0.01 if noise == 0 else 0.1)
    low = (force_n > 0.04) & (force_n < 0.6)
    assert np.abs(load_n[low] / cells - force_n[low]).max() < 0.06
    strongly = answer.bent & (deviation_n > 0.1)
    assert (forces[force_n > 0.04][:, strongly].min(axis=0) > 0).all()
    # The line's own deviation is stated, cell by cell.
    own = np.sqrt(((forces * answer.force_lsb_n - force_n[:, None, None]) ** 2).mean(axis=0))
    assert deviation_n == pytest.approx(own, rel=1e-9)


def pooled(codes, force):
    """{code: newtons} of the non-falling curve, by the pool-adjacent-violators rule in a plain loop."""
    blocks = []  # codes, sum of forces, number of readings
    for code in sorted(set(codes.tolist())):
        own = force[codes == code]
        blocks.append(([code], Fraction(own.sum()), len(own)))
        while len(blocks) > 1 and blocks[-2][1] / blocks[-2][2] > blocks[-1][1] / blocks[-1][2]:
            last = blocks.pop()
            blocks[-1] = tuple(a + b for a, b in zip(blocks[-1], last))
    return {code: float(total / count) for each, total, count in blocks for code in each}


def test_a_table_is_the_pooled_curve_with_the_recordings_ends():
    codes, force_n = curved(2, 3, 8, noise=4.0, levels=9)
    answer, _ = fit(codes, cell_forces(force_n, codes.shape))
    assert answer.bent.sum() >= 3
    for at in np.argwhere(answer.bent):
        found = pooled(codes[:, *at], force_n)
        table = np.interp([-999, *found, 9999], answer.knot_codes[:, *at], answer.knot_n[:, *at])
        expected = [0.0, 0.0, *list(found.values())[1:-1], 1.2, 1.2]
        assert table == pytest.approx(expected, abs=1e-12)


def test_many_readings_of_one_force_pool_to_that_force():
    """A mean of equal numbers may exceed them in its last bit; the table still ends at the largest."""
    for top in np.random.default_rng(4).uniform(1, 2, 20):
        newtons = np.repeat([0.0, 0.1, 0.3, 0.7, top], 37)
        codes = np.repeat([10, 400, 600, 700, 730], 37)[:, None, None] + np.arange(185)[:, None, None] % 3
        answer, _ = fit(codes, cell_forces(newtons, codes.shape))
        assert answer.bent.all() and answer.knot_n[-1, 0, 0] == top


def test_a_noisy_straight_cell_has_no_table():
    for seed in range(10):
        codes, force_n = recording(noise=300.0, seed=seed)
        assert not fit(codes, force_n)[0].bent.any()


@pytest.mark.parametrize("broken", [3, 7, 30])
def test_a_weak_cell_is_judged_by_those_that_work(broken):
    """However many cells are broken: 0.09 of what a working cell rises is dead, 0.11 is not."""
    rng = np.random.default_rng(broken)
    kinds = [lambda n: 0 * n + 512, lambda n: 900 - 20 * n, lambda n: 300 + rng.integers(-9, 10, n.shape)]
    cells = [kinds[k % 3] for k in range(broken)]
    cells += [
        lambda n: 90 + 9 * n,
        lambda n: 11 * n,
        lambda n: 50 + 100 * n,
        lambda n: 100 * n,
        lambda n: 7 + 102 * n,
    ]
    answer, _ = fit(*even(*cells, forces=np.repeat(np.arange(7), 5)))
    assert answer.dead[0].tolist() == [True] * (broken + 1) + [False] * 4


def test_the_order_of_presses_and_presses_made_twice_change_nothing():
    codes, force_n = curved(3, 4, 2)
    known = cell_forces(force_n, codes.shape)
    order = np.random.default_rng(1).permutation(len(codes))
    once, twice = fit(codes, known)[0], fit(codes[np.r_[order, order]], known[np.r_[order, order]])[0]
    for name in ("offset", "gain", "dead", "knot_codes", "knot_n"):
        assert np.allclose(getattr(once, name), getattr(twice, name), rtol=1e-12, equal_nan=True), name


def test_cells_that_all_fall_get_their_own_sentence():
    with pytest.raises(ValueError, match="all fall, and gains are positive"):
        fit(*even(lambda n: 900 - 80 * n, lambda n: 800 - 60 * n))


@pytest.mark.parametrize(
    "codes, bits, found",
    [
        ([0, 4095], None, (None, 4095)),
        ([0, 4094], None, (None, None)),
        ([100, 65535], None, (None, 65535)),
        ([0, 127], None, (None, 127)),
        ([0, 63], None, (None, None)),  # no converter has so few
        ([-2048, 2047], None, (-2048, 2047)),
        ([-2047, 1000], None, (None, None)),
        ([-128, 5], None, (-128, None)),
        ([0, 4095], 14, (None, 16383)),
        ([-5, 100], 12, (-2048, 2047)),
        ([0, 100], 12, (None, 4095)),
    ],
)
def test_the_ends_of_a_converter(codes, bits, found):
    assert calibration.ends(np.array(codes), bits) == found


@pytest.mark.parametrize(
    "codes, bits", [([0, 4096], 12), ([-2049, 0], 12), ([-1, 2048], 12), ([0], 0), ([0], 18)]
)
def test_what_a_converter_of_so_many_bits_does_not_have(codes, bits):
    with pytest.raises(ValueError, match="bits"):
        calibration.ends(np.array(codes), bits)


@pytest.mark.parametrize(
    "low, high, rest, slope",
    [
        (0, 4095, 100, 600),
        (0, 255, 0, 55),
        (-2048, 2047, -2000, 613),
        (0, 65535, 33, 9000),
        (-32768, 32767, -9, 5100),
    ],
)
def test_presses_at_the_converters_end_do_not_count(low, high, rest, slope):
    """0 to 10 N of which the upper ones clip, also in one press only; 1 N reads 1 N."""
    clipped = lambda n: np.clip(rest + slope * n, low, high)
    for count in (11, int((high - rest) / slope) + 2):
        codes, force_n = even(clipped, lambda n: clipped(0.9 * n), forces=np.arange(count))
        found = calibration.ends(codes)
        assert found == (None, high)
        answer, deviation_n = fit(codes, force_n, low=found[0], high=found[1])
        assert not answer.dead.any() and deviation_n.max() < 0.02
        assert by_formula(rest + slope, answer, (0, 0)) * answer.force_lsb_n == pytest.approx(1, abs=0.01)
        assert fit(codes, force_n)[1].max() > 0.02  # with them the line is another


def test_a_rest_below_the_converters_range_does_not_count_either():
    """Signed codes: the unpressed cell would be at -2300, and 8 N beyond 2047."""
    codes, force_n = even(lambda n: np.clip(-2300 + 600 * n, -2048, 2047), forces=np.arange(9))
    assert calibration.ends(codes) == (-2048, 2047)
    answer, deviation_n = fit(codes, force_n, low=-2048, high=2047)
    assert answer.offset[0, 0] == -2300 and deviation_n[0, 0] < 0.001
    assert next(calibration._besides(codes, force_n, answer, -2048, 2047)) == (
        "left out: 2 readings at the converter's end, code -2048 or 2047, from 0 N on"
    )


def test_cells_at_the_converters_end_from_rest_or_the_first_press_on():
    """One that never leaves it is dead; one with too few presses below it is masked, too; both are named."""
    cells = (lambda n: 40 + 90 * n, lambda n: 0 * n + 1023, lambda n: np.minimum(10 + 600 * n, 1023))
    codes, force_n = even(*cells)
    answer, _ = fit(codes, force_n, high=1023)
    assert answer.dead.tolist() == [[False, True, True]]
    told = list(calibration._besides(codes, force_n, answer, None, 1023))
    assert told == [
        "left out: 5 readings at the converter's end, code 1023, from 2 N on",
        "masked, with too few presses below the converter's end (row, column): (0, 2)",
        "dead (row, column): (0, 1)",
    ]
    with pytest.raises(ValueError, match="below the converter's end"):
        fit(codes[:, :, 2:], force_n[:, :, 2:], high=1023)


def test_a_damaged_table_is_no_calibration(tmp_path):
    codes, force_n = curved(3, 4, 2)
    good, _ = fit(codes, cell_forces(force_n, codes.shape))
    with open(tmp_path / "good.npz", "wb") as file:
        good.save(file)
    back, kept = calibration.load(tmp_path / "good.npz"), dict(np.load(tmp_path / "good.npz"))
    assert np.array_equal(back.knot_n, good.knot_n, equal_nan=True) and back.bent.sum() > 5
    bent = np.argwhere(good.bent)[0]
    for name, at, value in [
        ("knot_codes", (3, *bent), np.nan),
        ("knot_codes", (3, *bent), np.inf),
        ("knot_codes", (3, *bent), -1e6),
        ("knot_n", (3, *bent), 99.0),
        ("knot_n", (0, *bent), -1.0),
        ("knot_n", (slice(None), *bent), np.nan),
    ]:
        wrong = kept | {name: kept[name].copy()}
        wrong[name][at] = value
        np.savez(tmp_path / "bad.npz", **wrong)
        with pytest.raises(ValueError, match="knot"):
            calibration.load(tmp_path / "bad.npz")
    for change in (
        {"knot_n": kept["knot_n"][:5]},
        {"knot_n": kept["knot_n"][:, :2]},
        {"knot_n": kept["gain"]},
    ):
        np.savez(tmp_path / "bad.npz", **kept | change)
        with pytest.raises(ValueError, match="knot"):
            calibration.load(tmp_path / "bad.npz")
    del kept["knot_n"]
    np.savez(tmp_path / "bad.npz", **kept)
    with pytest.raises(ValueError, match="both"):
        calibration.load(tmp_path / "bad.npz")
