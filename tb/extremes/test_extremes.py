"""Each row in a short form. Then whether a row can fail, and whether the pairs of its
parameters are all there."""

from fractions import Fraction
from itertools import combinations

import mpmath
import numpy as np
import pytest

from extremes.pairs import covering
from extremes.rows import Outside, Row, See, rows, run


@pytest.mark.parametrize("name", rows())
def test_row(name):
    run(name)


def test_keeps_the_worst_error_and_its_place():
    see = See(Row("own", {"": "1/2 LSB"}, None))
    for exact, place in ((Fraction(13, 4), "first"), (Fraction(31, 12), "second"), (3, "third")):
        see.near(3, exact, place)
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
        lambda see: see.covering(lambda a: False, a=[1, 2]),
    ],
)
def test_a_wrong_result_is_found(wrong):
    with pytest.raises(Outside):
        wrong(See(Row("own", {"": "1/2 LSB"}, None)))


@pytest.mark.parametrize("allowed", [lambda **row: True, lambda a, b, **row: a <= b])
def test_every_pair_that_is_allowed_is_covered(allowed):
    axes = {"a": [1, 2, 3], "b": [1, 2, 3], "c": [0, 1, 2], "d": [True, False, None]}
    rows = covering(axes, allowed)
    assert all(allowed(**row) for row in rows) and 9 <= len(rows) <= 18, "of 81"
    seen = {((p, r[p]), (q, r[q])) for r in rows for p, q in combinations(axes, 2)}
    every = {((p, x), (q, y)) for p, q in combinations(axes, 2) for x in axes[p] for y in axes[q]}
    lacking = {(("a", x), ("b", y)) for x in axes["a"] for y in axes["b"] if not allowed(a=x, b=y)}
    assert seen == every - lacking and rows == covering(axes, allowed)
