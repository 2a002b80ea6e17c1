"""Each block and solver at the ends of its range, in a short form. Then whether that can fail."""

from fractions import Fraction
from itertools import combinations

import mpmath
import numpy as np
import pytest

from extremes.pairs import covering, wanted
from extremes.rows import Outside, Row, See, rows, run


@pytest.mark.parametrize("name", rows())
def test_row(name):
    run(name)


def test_keeps_the_worst_error_and_its_place():
    see = See(Row("own", {"": "1/2 LSB"}, None))
    see.near(3, Fraction(13, 4), "first")
    see.near(3, Fraction(31, 12), "second")
    see.near(3, 3, "third")
    worst = see.worst[""]
    assert (see.cases, worst.error, worst.limit, worst.where) == (
        3,
        Fraction(5, 12),
        Fraction(1, 2),
        "second",
    )


@pytest.mark.parametrize(
    "wrong",
    [
        lambda see: see.near(3, Fraction(7, 2) + Fraction(1, 10**30), ""),
        lambda see: see.near(3, 4, "", limit=0),
        lambda see: see.near(float("nan"), 0, ""),
        lambda see: see.near(np.float64("inf"), 0, ""),
        lambda see: see.near(0, mpmath.mpf("inf"), ""),
        lambda see: see.between(1, Fraction(3, 2), Fraction(1, 4), 9, ""),
        lambda see: see.same([1], [2], ""),
        lambda see: see.refused(abs, -1),
        lambda see: see.all_near([1, 2], [1], [""]),
        lambda see: see.covering(lambda a: False, a=[1, 2]),
    ],
)
def test_a_wrong_result_is_found(wrong):
    with pytest.raises(Outside):
        wrong(See(Row("own", {"": "1/2 LSB"}, None)))


def test_pairs_are_all_covered_and_rows_few():
    axes = {"a": [1, 2, 3], "b": "xyz", "c": [0, 1, 2], "d": [True, False, None]}
    rows = covering(axes)
    seen = {((p, r[p]), (q, r[q])) for r in rows for p, q in combinations(axes, 2)}
    assert seen == {((p, x), (q, y)) for p, q in combinations(axes, 2) for x in axes[p] for y in axes[q]}
    assert 9 <= len(rows) <= 18, "of 81"
    assert rows == covering(axes)


def test_pairs_that_are_not_allowed_are_left_out():
    axes = {"a": [1, 2, 3], "b": [1, 2, 3], "c": [0, 1]}

    def rising(a, b, c):
        return a <= b

    rows = covering(axes, rising)
    assert all(row["a"] <= row["b"] for row in rows)
    seen = {((p, r[p]), (q, r[q])) for r in rows for p, q in combinations(axes, 2)}
    assert seen == wanted(axes, rising)
    assert len(seen) == 6 + 6 + 6
