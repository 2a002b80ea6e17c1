"""The resistor mesh against independent references: the papers' figures, sparse LU with an error bound, an
elimination without subtraction, 50-digit arithmetic; then the extremes of sizes, ratios, opens and shorts.

Small meshes are solved with mpmath, with powers of two as parameters so that the equations themselves are
exact and the bounds can be checked to the last digit. Timings are printed by
tools/published/mesh_figures.py, never asserted.
"""

import itertools

import mpmath
import numpy as np
import pytest

from meissner.physics import mesh_loads
from meissner.physics.mesh import Mesh, circuit, correction, green, lines, spread_out
from meissner.physics.mesh import mesh as engine
from meissner.physics.mesh.circuit import Circuit

NAMES = ("E1", "E2", "E3", "E4", "x", "y", "load")
SIZES = ((1, 1), (1, 6), (6, 1), (2, 2), (4, 3))


def table(solution):
    """[7, scenes]: the sensor's reported values."""
    return np.stack([np.atleast_1d(getattr(solution, name)) for name in NAMES])


def bounds(solution):
    return np.stack([np.atleast_1d(row) for row in solution.bound])


def points(m, n, count, seed, largest=5.0):
    load = np.zeros(m * n)
    rng = np.random.default_rng(seed)
    load[rng.choice(m * n, count, replace=False)] = rng.uniform(0.01, largest, count)
    return load.reshape(m, n)


SHORT = 1e6  # newtons: 4 milliohms


def patterns(m, n):
    """Loads at the ends of the range, by name."""
    equal = np.full((m, n), 4.0)
    tiny = np.full((m, n), 65535.0)
    tiny[0, 0] = 1.0
    short, shorts = equal.copy(), np.full((m, n), SHORT)
    short[m // 2, n // 2] = SHORT
    lone = np.zeros((m, n))
    lone[-1, 0] = SHORT
    return {"equal": equal, "corner": tiny, "short": short, "all short": shorts, "lone short": lone}


def finite(solution):
    values = [table(solution), bounds(solution), solution.Va, solution.Vb]
    values += [solution.condition, solution.residual, solution.current]
    return all(np.isfinite(value).all() for value in values)


def precise(given, digits):
    """Drops [2mn+4] as mpmath numbers of ``digits`` digits: slow, for at most a few dozen nodes."""
    with mpmath.workdps(digits):
        size = len(given.live)
        A, b = mpmath.zeros(size), mpmath.zeros(size, 1)
        for p, q, g, emf in zip(given.p.tolist(), given.q.tolist(), given.g, given.emf):
            g, emf = mpmath.mpf(float(g)), mpmath.mpf(float(emf))
            A[p, p] += g
            b[p] += g * emf
            if q != circuit.GROUND:
                A[q, q] += g
                A[p, q] -= g
                A[q, p] -= g
                b[q] -= g * emf
        z = mpmath.lu_solve(A, b)
        return [z[int(s)] + mpmath.mpf(float(o)) for s, o in zip(given.place, given.offset)]


def exactly(mesh, load):
    """E1..E4, x, y, load as 50-digit numbers, by eq. 16-20 and 29 on the 50-digit voltages."""
    with mpmath.workdps(60):
        z = precise(Circuit(mesh, load), 60)[-4:]
        volts, V0 = 2 * mpmath.mpf(mesh.V0), mpmath.mpf(mesh.V0)
        E = [V0 - volts * z[0], -V0 - volts * z[1], V0 - volts * z[2], -V0 - volts * z[3]]
        rail = mpmath.mpf(mesh.R0) / mpmath.mpf(mesh.r)
        c = [
            (2 * a * rail + b + 1) / (b - 1) if b > 1 else mpmath.mpf(0)
            for a, b in ((mesh.m, mesh.n), (mesh.n, mesh.m))
        ]
        x = c[0] * (E[0] - E[2]) / (2 * V0 - E[0] - E[2])
        y = c[1] * (E[1] - E[3]) / (2 * V0 + E[1] + E[3])
        force = 2 * mpmath.mpf(mesh.k) / mpmath.mpf(mesh.R0) * (2 * V0 - E[0] - E[2])
        return [*E, x, y, force / (E[0] + E[2] - E[1] - E[3])]


def test_one_point_reproduces_the_published_voltage_drop():
    scene = mesh_loads.cop_one_point(r=10.0)
    solution = scene.mesh.solve(scene.load, "lu")
    assert 0.018 < (solution.E1 - solution.Va.min((1, 2)))[0] < 0.023  # "less than 0.02 V"
    assert solution.x[0] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("split", ["equal", "random"])
def test_six_random_points_reproduce_the_published_errors(split):
    for total in mesh_loads.SIX_TOTALS:
        scene = mesh_loads.cop_six_random(10.0, total, split=split)
        solution, (force, x, y) = scene.mesh.solve(scene.load), scene.truth()
        position = np.hypot(solution.x - x, solution.y - y) / 2
        assert position.max() < 0.005
        assert (1 - solution.load / force).mean() < 0.025
    assert (1 - solution.load / force).mean() > 0.018  # "within 2 %" at 20 N
    scene = mesh_loads.cop_six_random(150.0, 20.0, split=split)
    wrong = 1 - scene.mesh.solve(scene.load).load / scene.truth()[0]
    assert 0.2 < wrong.mean() < 0.3


def test_two_point_scenes_follow_the_line_and_the_droop():
    scene = mesh_loads.cop_two_point()
    solution, (total, x, y) = scene.mesh.solve(scene.load), scene.truth()
    assert np.allclose(total, 10) and np.allclose(x, np.linspace(-1, 1, 11)) and np.allclose(x, y)
    assert np.abs(solution.x - x).max() < 0.03 and np.abs(solution.x - solution.y).max() < 1e-12
    scene = mesh_loads.cop_load()
    solution, (total, x, y) = scene.mesh.solve(scene.load), scene.truth()
    assert np.allclose(x[1:], 0.25) and np.allclose(y[1:], 0.25) and total[-1] == 20
    droop = 1 - solution.load[1:] / total[1:]
    assert (np.diff(droop) > 0).all() and 0.13 < droop[-1] < 0.15
    assert not solution.valid[0] and solution.why[0] == "no taxel is loaded"


@pytest.mark.parametrize(
    "m,n,r,count", [(41, 41, 10, 6), (41, 41, 150, 6), (30, 17, 47, 40), (3, 60, 100, 9)]
)
def test_fast_equals_the_reference(m, n, r, count):
    mesh, load = Mesh(m, n, r), points(m, n, count, seed=count)
    fast, reference = mesh.solve(load, "fast"), mesh.solve(load, "lu")
    assert fast.valid and reference.valid and (fast.solver, reference.solver) == ("fast", "lu")
    assert np.allclose(table(fast), table(reference), rtol=1e-9, atol=0)
    assert np.allclose(fast.Va, reference.Va, rtol=1e-11) and np.allclose(fast.Vb, reference.Vb, rtol=1e-11)
    assert (np.abs(table(fast) - table(reference)) <= bounds(fast) + bounds(reference)).all()


def test_elimination_without_subtraction_agrees_at_full_size():
    mesh, load = Mesh(41, 41, 10.0), points(41, 41, 6, seed=3)
    rails = circuit.eliminate(Circuit(mesh, load))[-4:]
    fast = mesh.solve(load, "fast")
    volts = np.array([15, -15, 15, -15]) - 30 * rails
    assert np.allclose(volts, [fast.E1, fast.E2, fast.E3, fast.E4], rtol=1e-12)


def no_measurement_but_fast():
    """R0 is 2^70 times r: in double precision the rails' conductances vanish beside the wires'."""
    mesh, load = Mesh(1, 4, 2.0**-30, 2.0**40, 16.0, 4096.0), np.full((1, 4), 4.0)
    lu, auto = mesh.solve(load, "lu"), mesh.solve(load)
    assert (lu.valid, lu.load) == (False, 0.0) and finite(lu)
    assert lu.why == "sparse LU cannot vouch for three digits here: use the fast solver"
    assert (auto.valid, auto.solver) == (True, "fast")
    assert auto.load == pytest.approx(16.0, rel=1e-11)
    return lu


def test_a_factor_without_digits_is_no_measurement_and_auto_takes_another_solver():
    no_measurement_but_fast()


def test_a_singular_factor_is_no_measurement(monkeypatch):
    """Rounding in the processor decides whether the factor is singular or nearly so: here SuperLU refuses
    it."""

    def refuse(circuit):
        raise RuntimeError("Factor is exactly singular")

    monkeypatch.setattr(Circuit, "factor", refuse)
    assert no_measurement_but_fast().E1 == 16.0


def test_a_batch_equals_its_scenes():
    mesh, rng = Mesh(7, 9, 47.0), np.random.default_rng(5)
    loads = np.stack([points(7, 9, count, seed=count) if count else np.zeros((7, 9)) for count in range(12)])
    loads = loads[rng.permutation(12)]
    batch = mesh.solve(loads)
    for scene, load in enumerate(loads):
        single = mesh.solve(load)
        assert np.allclose(table(single)[:, 0], table(batch)[:, scene], rtol=1e-13)
        assert single.valid == batch.valid[scene] and single.why == batch.why[scene]
        assert np.allclose(single.Va, batch.Va[scene], rtol=1e-13)
        assert isinstance(single.E1, float) and single.Va.shape == (7, 9)
    assert mesh.solve(np.zeros((0, 7, 9))).E1.shape == (0,)


@pytest.mark.parametrize("size,power", list(itertools.product(SIZES, (-30, 0, 30))))
def test_fifty_digits_lie_within_the_bounds(size, power):
    m, n = size
    mesh = Mesh(m, n, 2.0 ** (10 + power), 2.0**13, 16.0, 2.0**12)
    rng = np.random.default_rng(power + 50)
    cases = [*patterns(m, n).values(), 2.0 ** rng.integers(-3, 4, (m, n)) * (rng.random((m, n)) < 0.6)]
    for load in cases:
        load = np.where(load == 65535.0, 65536.0, load)
        if not load.any():
            continue
        truth = exactly(mesh, load)
        for solver in ("fast", "lu", "constant"):
            solution = mesh.solve(load, solver)
            if not solution.valid:
                assert solver != "fast" and solution.why and (solver != "lu" or power)
                continue
            for got, want, bound in zip(table(solution)[:, 0], truth, bounds(solution)[:, 0]):
                assert abs(mpmath.mpf(float(got)) - want) <= bound
                if solver == "fast":
                    assert abs(mpmath.mpf(float(got)) - want) <= 1e-12 * (1 + abs(want))
        reference = circuit.eliminate(Circuit(mesh, load))
        drops = precise(Circuit(mesh, load), 60)
        worst = max(abs(mpmath.mpf(float(a)) / b - 1) for a, b in zip(reference, drops) if b)
        assert worst < 1e-14


@pytest.mark.parametrize("size", SIZES)
def test_no_ratio_of_resistances_breaks_a_number(size):
    m, n = size
    for ratio, R0 in itertools.product(10.0 ** np.arange(-9, 10, 3), (1e-3, 1e4, 1e9)):
        mesh = Mesh(m, n, 864 * ratio, R0)
        for load in patterns(m, n).values():
            fast, reference = mesh.solve(load, "fast"), mesh.solve(load, "lu")
            constant = mesh.solve(load, "constant")
            assert fast.valid and finite(fast) and finite(reference) and finite(constant)
            assert fast.bound.load <= 1e-9 * fast.load
            if reference.valid:
                slack = bounds(fast) + bounds(reference)
                assert (np.abs(table(fast) - table(reference)) <= slack * (1 + 1e-6) + 1e-14).all()
            else:
                assert reference.why and reference.load == 0
    for load in (1e-320, 1e-300, 1e12):
        mesh = Mesh(m, n, 10.0)
        solution = mesh.solve(np.full((m, n), load))
        assert finite(solution) and (solution.valid or solution.why)


def test_nothing_pressed_and_shorts_are_answers():
    mesh = Mesh(3, 3, 10.0)
    for solver in engine.SOLVERS:
        solution = mesh.solve(np.zeros((3, 3)), solver)
        assert not solution.valid and solution.why == "no taxel is loaded" and finite(solution)
        assert (solution.E1, solution.E2, solution.x, solution.load) == (15, -15, 0, 0)
    load = np.zeros((2, 3, 3))
    load[0, 0, 2], load[1, 1, 1] = SHORT, 1.0
    solution = mesh.solve(load)
    assert solution.valid.all() and solution.x[0] == pytest.approx(1) and solution.y[0] == pytest.approx(1)
    lost = Mesh(3, 3, 10.0, k=5e-324).solve(1e6 * load, "constant")  # k / F is less than any double
    assert not lost.valid[0] and "short" in lost.why[0]
    for solver in engine.SOLVERS:
        for newtons in (np.inf, 1.0001e12, 1e300):
            load[1, 2, 0] = newtons
            with pytest.raises(ValueError, match="1e\\+12 at most"):
                mesh.solve(load, solver)


def test_a_thousand_squared_is_direct():
    mesh = Mesh(1024, 1024, 10.0)
    load = points(1024, 1024, 6, seed=2)
    solution = mesh.solve(np.stack([load, load[:, ::-1], load[::-1], load.T]), "fast")
    assert solution.valid.all() and (solution.bound.load < 1e-9 * solution.load).all()
    assert np.allclose(solution.load, solution.load[0], rtol=1e-12)
    assert solution.x[1] == pytest.approx(-solution.x[0], rel=1e-11)
    assert solution.y[2] == pytest.approx(-solution.y[0], rel=1e-11)
    assert solution.x[3] == pytest.approx(-solution.y[0], rel=1e-11)
    assert mesh.solve(load).solver == "fast"


def test_tables_and_direct_sums_are_the_same(monkeypatch):
    loads = np.stack([points(41, 23, 6, seed) for seed in range(8)])
    tabulated = Mesh(41, 23, 47.0).solve(loads, "fast")
    monkeypatch.setattr(green, "TABLE_LIMIT", 0)
    monkeypatch.setattr(lines, "CHUNK", 1000)
    assert np.allclose(table(Mesh(41, 23, 47.0).solve(loads, "fast")), table(tabulated), rtol=1e-12)


def test_many_contacts_by_transforms_equal_the_reference(monkeypatch):
    monkeypatch.setattr(engine, "DENSE", 0)
    mesh, load = Mesh(20, 30, 47.0), np.random.default_rng(4).random((20, 30)) * 3
    load[3, 4] = 1e6
    fast, reference = mesh.solve(load, "fast"), mesh.solve(load, "lu")
    assert np.allclose(table(fast), table(reference), rtol=1e-9)
    assert np.allclose(fast.Va, reference.Va, rtol=1e-9) and fast.bound.load < 1e-8 * fast.load
    assert (np.abs(table(fast) - table(reference)) <= bounds(fast) + bounds(reference)).all()


def test_constant_potential_is_ideal_and_knows_its_error():
    for r in (0.01, 10.0, 150.0):
        scene = mesh_loads.cop_six_random(r, 20.0, draws=20)
        constant, exact = scene.mesh.solve(scene.load, "constant"), scene.mesh.solve(scene.load)
        total, x, y = scene.truth()
        assert np.allclose(constant.load, total) and np.allclose(constant.x, x) and np.allclose(constant.y, y)
        assert (np.abs(table(constant) - table(exact)) <= bounds(constant)).all()
    assert (Mesh(41, 41, 0.01).solve(scene.load, tolerance=0.01).solver == "constant").all()
    assert (scene.mesh.solve(scene.load, tolerance=0.01).solver == "fast").all()
    assert np.ptp(constant.Va, axis=(1, 2)).max() == 0


def test_auto_follows_what_is_loaded():
    mesh = Mesh(41, 41, 10.0)
    assert mesh.solve(points(41, 41, 6, 1)).solver == "fast"
    assert mesh.solve(np.ones((41, 41))).solver == "lu"
    assert mesh.solve(np.zeros((41, 41))).solver == "none"


def test_constants_turn_voltages_into_the_report():
    for m, n in ((5, 5), (7, 3), (1, 6), (6, 1), (1, 1)):
        mesh = Mesh(m, n, 47.0)
        s = mesh.solve(points(m, n, min(3, m * n), seed=9), "lu")
        assert mesh.Cx * (s.E1 - s.E3) / (30 - s.E1 - s.E3) == pytest.approx(s.x, abs=1e-9)
        assert mesh.Cy * (s.E2 - s.E4) / (30 + s.E2 + s.E4) == pytest.approx(s.y, abs=1e-9)
        assert mesh.Kf * (30 - s.E1 - s.E3) / (s.E1 + s.E3 - s.E2 - s.E4) == pytest.approx(s.load, rel=1e-9)
        assert (mesh.Cx == 0) == (n == 1) and (mesh.Cy == 0) == (m == 1)
        assert s.current * mesh.R0 == pytest.approx(30 - s.E1 - s.E3) == pytest.approx(30 + s.E2 + s.E4)


def test_physics_holds():
    mesh, load = Mesh(9, 6, 100.0), points(9, 6, 20, seed=6)
    solution = mesh.solve(load)
    assert (np.abs([solution.Va, solution.Vb]) <= 15).all() and (solution.Va >= solution.Vb).all()
    harder = np.repeat(load[None], 54, 0)
    harder[np.arange(54), np.arange(54) // 6, np.arange(54) % 6] += 1.0
    assert (mesh.solve(harder).load > solution.load).all()  # Rayleigh
    assert solution.load < load.sum()
    other = mesh.solve(load, "fast")
    scaled = Mesh(9, 6, 400.0, 40e3, 15.0, 4 * 4320.0).solve(load, "fast")
    assert (table(scaled) == table(other)).all()  # bit for bit, because it is scaled by powers of four
    for R0 in (1e3, 1e6):  # the papers' section IV-D: R0 does not matter
        assert Mesh(9, 6, 100.0, R0).solve(load).load == pytest.approx(solution.load, rel=1e-4)


@pytest.mark.parametrize(
    "arguments",
    [
        *((0, 5, 10), (5, -1, 10), (2.5, 5, 10), (True, 5, 10), (5, 5, 0), (5, 5, -1), (5, 5, np.nan)),
        *((5, 5, 10, 0), (5, 5, 10, np.inf), (5, 5, 10, 1e4, 0), (5, 5, 10, 1e4, 15, -1), (5, 5, "10")),
    ],
)
def test_impossible_meshes_are_refused(arguments):
    with pytest.raises(ValueError, match="must be a"):
        Mesh(*arguments)


def test_impossible_loads_are_refused():
    mesh = Mesh(2, 3, 10.0)
    cases = [(np.full((2, 3), np.nan), "NaN"), (-np.ones((2, 3)), "negative"), (np.ones((3, 2)), "shape")]
    cases += [
        (np.ones(6), "shape"),
        (np.ones((1, 1, 2, 3)), "shape"),
        ("press", "array"),
        ([[1], [1, 2]], "array"),
    ]
    for load, word in cases:
        with pytest.raises(ValueError, match=word):
            mesh.solve(load)
    for keywords in ({"solver": "magic"}, {"tolerance": -1}, {"tolerance": np.nan}):
        with pytest.raises(ValueError, match="must"):
            mesh.solve(np.ones((2, 3)), **keywords)


def test_covers_spread_a_force_without_losing_any():
    load = mesh_loads.press(5, 7, [0.0, 1.0, -0.3], [0.0, -1.0, 0.4], 5.0, 1.5)
    assert np.allclose(load.sum((1, 2)), 5) and load[0].argmax() == 2 * 7 + 3 and load[1].argmax() == 34
    assert np.allclose(load[0], load[0][::-1, ::-1])
    scene = mesh_loads.cop_stroke()
    solution = scene.mesh.solve(scene.load)
    radius = np.hypot(solution.x, solution.y)
    assert np.ptp(radius) < 0.1 * radius.mean()  # "a neat locus"
    for bad in ((0, 2, 5, 1), (0, 0, -1, 1), (0, 0, 1, 0)):
        with pytest.raises(ValueError, match="press"):
            mesh_loads.press(5, 5, *bad)
    with pytest.raises(ValueError, match="count"):
        mesh_loads.random_points(2, 2, 5, [1.0], 1)


def held_out(kind, seed, count):
    rng = np.random.default_rng(seed)
    total = rng.uniform(1, 25, count) if seed == 1 else np.full(count, 20.0)
    if kind == "press":
        return mesh_loads.press(
            41, 41, rng.uniform(-0.8, 0.8, count), rng.uniform(-0.8, 0.8, count), total, 2
        )
    return mesh_loads.random_points(41, 41, {"six": 6, "one": 1}[kind], total, seed)


@pytest.mark.parametrize(
    "kind,before,after", [("six", 0.21, 0.03), ("one", 0.5, 0.012), ("press", 0.33, 0.002)]
)
def test_correction_removes_the_systematic_error(kind, before, after):
    mesh = Mesh(41, 41, 150.0)
    learn, check = (held_out(kind, seed, 40 if kind == "press" else 2000) for seed in (1, 2))
    if kind == "press":  # far taxels with little force would only cost time
        learn, check = (np.where(a < 0.02 * a.max((1, 2), keepdims=True), 0, a) for a in (learn, check))
    fix, solution = correction.fit(mesh, learn), mesh.solve(check)
    total, x, y = mesh_loads.true_centre(check)
    new_x, new_y, new_load = fix.apply(solution.x, solution.y, solution.load)
    assert (1 - solution.load / total).mean() > before
    assert np.abs(new_load / total - 1).mean() < after
    old = np.hypot(solution.x - x, solution.y - y).mean()
    assert np.hypot(new_x - x, new_y - y).mean() <= 0.9 * old + 1e-12
    # The integer stage: 16-bit codes of 2V0 - E1 - E3 and E1 + E3 - E2 - E4, Q2.14 coordinates.
    code = 2.0**16 / 60
    N, D = ((30 - solution.E1 - solution.E3), (solution.E1 + solution.E3 - solution.E2 - solution.E4))
    codes = [np.round(v * code * 64).astype(np.int64) for v in (N, D)]
    stage = correction.registers(fix)
    divisor = stage.divisor(np.round(solution.x * 16384), np.round(solution.y * 16384), *codes)
    integer = fix.Kf * codes[0] / (divisor / 2.0**stage.shift)
    assert np.abs(integer / new_load - 1).max() < 5e-4
    assert max(abs(p) for p in stage.p) < 2 ** (18 - 1)


def test_three_numbers_cannot_tell_a_cluster_from_a_ring():
    """20 N and 15 N with the same E1..E4: no correction from I_all, x, y can suit both."""
    mesh = Mesh(41, 41, 150.0)
    cluster, ring = np.zeros((2, 41, 41))
    cluster[19:22:2, 18:23:2] = 20 / 6
    ring[[10, 30, 14, 26, 14, 26], [20, 20, 10, 10, 30, 30]] = 1
    wanted, low, high = mesh.solve(cluster).load, 0.5, 20 / 6
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if mesh.solve(ring * middle).load < wanted else (low, middle)
    same, other = mesh.solve(cluster), mesh.solve(ring * low)
    assert np.allclose(table(same)[:4], table(other)[:4], atol=1e-12)
    print(f"the ring weighs {6 * low:.2f} N, the cluster 20 N")
    assert 6 * low < 0.8 * 20


def test_corrections_need_scenes():
    with pytest.raises(ValueError, match="at least 30"):
        correction.fit(Mesh(3, 3, 10.0), np.ones((3, 3, 3)))
    with pytest.raises(ValueError, match="at least 30"):
        correction.fit(Mesh(3, 3, 10.0), np.ones((3, 3)))
    with pytest.raises(ValueError, match="18-bit"):
        correction.registers(correction.Correction(np.full(6, 1e6), np.zeros(3), np.zeros(3), 1.0))


def test_an_unsettled_iteration_is_no_measurement(monkeypatch):
    monkeypatch.setattr(engine, "DENSE", 0)
    monkeypatch.setattr(spread_out, "STEPS", 2)
    solution = Mesh(20, 20, 1e6).solve(points(20, 20, 200, seed=1), "fast")
    assert not solution.valid and "settle" in solution.why and solution.load == 0 and finite(solution)
