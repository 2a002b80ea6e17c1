"""The centre of pressure on the three engines: fixed equals rtl in every array; float equals them in every
sum and in every position, except that a quotient next to a half may round differently. One taxel to
1024×1024, one lane and eight, rows that do not fill their last beat; full scale, all zero, one taxel at a
time, mirrored loads, exact halves; the definition in Python's fractions; the least load; refused input."""

from fractions import Fraction

import numpy as np
import pytest

from meissner import engines
from meissner.engines import rtl_cop

FIELDS = ("sum", "mx", "my", "x", "y", "valid")


def frames(rows, columns, count, seed=1):
    """Full scale, all zero, single taxels in the corners, one LSB, then random frames of every density."""
    rng = np.random.default_rng(seed)
    x = rng.integers(0, 65536, (count, rows, columns))
    x[8:] = x[8:] * (rng.random((count - 8, rows, columns)) < rng.random((count - 8, 1, 1)) ** 3)
    x[:8] = 0
    x[0] = 65535
    for k, (i, j) in enumerate([(0, 0), (0, -1), (-1, 0), (-1, -1)]):
        x[k + 2, i, j] = 65535
    x[6, rows // 2, columns // 2] = 1
    x[7, :, 0] = 65535
    return x


def same(a, b, fields=FIELDS):
    return [name for name in fields if not np.array_equal(a[name], b[name])] == []


@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 9), (9, 1), (2, 2), (25, 5), (63, 33), (64, 64)])
def test_engines_agree(rows, columns):
    x = frames(rows, columns, 60)
    results = {name: engines.process_cop(x, name) for name in engines.NAMES}
    fixed = results["fixed"]
    assert fixed["valid"].sum() > (50 if rows * columns > 99 else 10) and not fixed["valid"][1]
    assert fixed["x"].any() == (columns > 1) and fixed["y"].any() == (rows > 1)
    assert same(fixed, results["rtl"])
    assert same(fixed, results["float"], ("sum", "mx", "my", "valid"))
    for name in ("x", "y"):
        assert np.abs(fixed[name] - results["float"][name]).max() <= 1
        assert np.mean(fixed[name] != results["float"][name]) < 0.05
    for result in results.values():
        kinds = [result[name].dtype.str[1:] for name in FIELDS]
        assert kinds == ["i8", "i8", "i8", "i4", "i4", "b1"]


def test_the_largest_array():
    x = np.random.default_rng(3).integers(0, 65536, (2, 1024, 1024), dtype=np.uint16)
    x[1] = 65535
    results = [engines.process_cop(x, name) for name in engines.NAMES]
    assert results[0]["sum"][1] == 65535 << 20
    assert same(results[0], results[1]) and same(results[1], results[2])


def test_definition_in_fractions():
    x = frames(25, 5, 30, seed=7)
    result = engines.process_cop(x, "fixed")
    for k, frame in enumerate(x.tolist()):
        total = sum(map(sum, frame))
        mx = sum((2 * j - 4) * force for row in frame for j, force in enumerate(row))
        my = sum((24 - 2 * i) * sum(row) for i, row in enumerate(frame))
        assert (result["sum"][k], result["mx"][k], result["my"][k]) == (total, mx, my)
        for name, moment, span in (("x", mx, 4), ("y", my, 24)):
            value = Fraction(moment, span * total) * 16384 if total else 0
            nearest = int(abs(value) + Fraction(1, 2)) * (1 if value > 0 else -1)
            assert result[name][k] == nearest


@pytest.mark.parametrize("engine", engines.NAMES)
def test_mirrored_loads_and_halves_round_alike(engine):
    """x = ±1/32768, half a step, is ±1 (ties away from zero), left and right."""
    x = np.zeros((2, 1, 2), dtype=int)
    x[0, 0] = 16383, 16385  # (16385 - 16383) / 32768 = 1/16384: one step exactly
    x[1, 0] = 32767, 32769  # 2 / 65536 = half a step
    result = engines.process_cop(np.concatenate([x, x[:, :, ::-1]]), engine)
    assert result["x"].tolist() == [1, 1, -1, -1]
    assert not result["y"].any()


@pytest.mark.parametrize("engine", engines.NAMES)
def test_least_load(engine):
    x = np.zeros((4, 25, 5), dtype=int)
    x[1:, 0, 4] = 1, 99, 100
    result = engines.process_cop(x, engine, min_load=100)
    assert result["valid"].tolist() == [False, False, False, True]
    assert result["x"].tolist() == result["y"].tolist() == [0, 0, 0, 16384]
    assert result["sum"].tolist() == [0, 1, 99, 100]
    assert not engines.process_cop(x, engine, min_load=0)["valid"][0]


def test_lanes_follow_the_width():
    assert [rtl_cop.lanes(columns) for columns in (1, 5, 15, 16, 33, 1024)] == [1, 1, 1, 8, 8, 8]


@pytest.mark.parametrize("min_load", [-1, 1 << 18])
def test_refuses_a_least_load_that_no_register_holds(min_load):
    with pytest.raises(ValueError, match=f"min-load = {min_load} "):
        engines.process_cop(np.zeros((1, 2, 2), int), "float", min_load)
