"""Each block and solver at the ends of its range, in a short form; the RTL of each block at the ends of its
parameters. Then whether these can fail: wrong results, parameters that are neither read nor refused."""

from fractions import Fraction
from itertools import combinations

import mpmath
import numpy as np
import pytest

from extremes import elaborations
from extremes.pairs import covering, wanted
from extremes.rows import Outside, Row, See, rows, run

SHORT = ("delay", "fifo", "round_sat")  # a quarter of a second per parameter set


@pytest.mark.parametrize("name", rows())
def test_row(name):
    run(name)


@pytest.mark.parametrize("block", SHORT)
def test_the_ends_of_parameters_are_read_or_refused(block):
    facts = elaborations.elaborate(block)
    assert not facts["finding"] and facts["taken"] >= 6


@pytest.mark.long
@pytest.mark.parametrize("block", sorted({*elaborations.named()} - {*SHORT}))
def test_the_ends_of_all_parameters_are_read_or_refused(block):
    assert not elaborations.elaborate(block)["finding"]


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


WIDTHS = """module msn_x #(
  parameter int unsigned A = 4,
  parameter int unsigned B = 4
) (input logic [7:0] in_i, output logic [7:0] out_o);
  if (A > 8 CHECK) begin : gen_check_a
    $fatal(1, "msn_x: A = %0d must fit", A);
  end
  assign out_o = 8'(in_i[A-1:0]) + 8'(in_i[B-1:0]);
endmodule
"""


@pytest.mark.parametrize(
    "check, ends, finds",
    [
        ("|| B > 8", {"A": [1, 8, 9], "B": [1, 9]}, "never taken: A = 9, B = 9"),
        ("|| B > 8", {"A": [1, 8], "B": [1, 8]}, ""),
        ("", {"A": [1, 8], "B": [1, 9]}, "SELRANGE"),
        ("|| A + B > 15", {"A": [1, 8], "B": [1, 8]}, ""),
    ],
)
def test_a_pair_that_is_neither_read_nor_refused_is_found(tmp_path, check, ends, finds):
    source = tmp_path / "msn_x.sv"
    source.write_text(WIDTHS.replace("CHECK", check))
    facts = elaborations.elaborate("x", source=source, ends_of=ends)
    assert finds in facts["finding"] and bool(finds) == bool(facts["finding"])
    if "15" in check:
        assert facts["apart"] == 1 and facts["taken"] == 3
