"""The short form of `make extremes`, and whether its tool can fail: rows made to be wrong, bounds in headers
that differ from the table's, a block without a row, a run without cases."""

import json
import re
from fractions import Fraction
from itertools import combinations

import mpmath
import numpy as np
import pytest

import extremes as tool
from meissner.builds import toolchain
from nightly import benches
from verify import elaborations, extremes
from verify.pairs import covering, wanted

NAMES = [*extremes.rows()]


@pytest.mark.parametrize("name", NAMES)
def test_row(name):
    facts = extremes.run(name)
    assert not facts["finding"], f"python tools/extremes.py --quick '{name}'"
    assert facts["cases"] > 0


def test_every_block_has_a_row_or_a_reason():
    without = extremes.without()
    assert not set(without) & set(NAMES)
    assert set(without) | set(NAMES) >= set(benches.blocks())
    assert all(re.match("moves |joins ", why) for why in without.values())


def test_a_block_that_computes_needs_a_row(monkeypatch):
    monkeypatch.setattr(extremes, "rows", lambda: {name: None for name in NAMES if name != "divide"})
    with pytest.raises(ValueError, match="msn_divide computes"):
        extremes.without()


def test_headers_have_the_bounds_of_the_table():
    assert {str(path) for path in tool.wrong_headers()} == set(), "python tools/extremes.py --headers"


def test_a_header_with_another_bound_is_found(tmp_path):
    source = tmp_path / "msn_x.sv"
    source.write_text("// SPDX\n//\n// Adds.\n// Error: none (docs/extremes.md).\n// Model: y.py\n\nmodule\n")
    line = "Error: at most 1/2 LSB (docs/extremes.md)."
    text = "// SPDX\n//\n// Adds.\n// Error: at most 1/2 LSB (docs/extremes.md).\n// Model: y.py\n\nmodule\n"
    assert tool.header(source, line) == text
    source.write_text(text)
    assert tool.header(source, line) == text


def test_the_rtl_tests_that_rows_name_are_there():
    for row in extremes.rows().values():
        for test in row.rtl:
            path, _, name = test.partition("::")
            assert re.search(rf"def {name}\b", (toolchain.ROOT / path).read_text("utf-8")), test


def test_the_page_is_that_of_the_record():
    """Except for the marks of rows that have become stale since."""

    def fresh(text):
        return text.replace(" (stale)", "")

    assert fresh(tool.PAGE.read_text("utf-8")) == fresh(tool.page(tool.load())), (
        "python tools/extremes.py --page"
    )
    told = json.loads(tool.RECORD.read_text("utf-8"))
    assert set(told["blocks"]) == set(NAMES)
    assert not [name for name, facts in told["blocks"].items() if facts["finding"]]


@pytest.fixture
def own(monkeypatch):
    """``own(body, bounds)``: the facts of a row that exists only in this test."""

    def run(body, bounds=None):
        row = extremes.Row("own", bounds or {"": "1/2 LSB"}, body)
        monkeypatch.setattr(extremes, "rows", lambda: {"own": row})
        return extremes.run("own")

    return run


def test_keeps_the_worst_error_and_its_place(own):
    def body(see):
        see.near(3, Fraction(13, 4), "first")
        see.near(3, Fraction(31, 12), "second")
        see.near(3, 3, "third")

    facts = own(body)
    assert (facts["finding"], facts["cases"]) == ("", 3)
    assert facts["worst"][""] == {"error": 5 / 12, "bound": 0.5, "where": "second"}


@pytest.mark.parametrize(
    "body, says",
    [
        (
            lambda see: see.near(3, Fraction(7, 2) + Fraction(1, 10**30), "here"),
            "off 3.5, bound 0.5, at here",
        ),
        (lambda see: see.near(3, 4, "here", limit=0), "bound 0, at here"),
        (lambda see: see.near(float("nan"), 0, "here"), "nan is no number"),
        (lambda see: see.near(np.float64("inf"), 0, "here"), "inf is no number"),
        (lambda see: see.near(0, mpmath.mpf("inf"), "here"), "inf is no number"),
        (lambda see: see.between(1, Fraction(3, 2), Fraction(1, 4), 9, "here"), "bound 0.25"),
        (lambda see: see.same([1], [2], "here"), r"\[1\] is not \[2\]"),
        (lambda see: see.refused(abs, -1), "was not refused"),
        (lambda see: see.all_near([1, 2], [1], ["here"]), "2 results for 1"),
        (lambda see: None, "0 cases"),
        (lambda see: [][0], "IndexError"),
        (lambda see: see.near(np.float64(1) / np.float64(0), 0, "here"), "divide by zero"),
        (lambda see: see.covering(lambda a: False, a=[1, 2]), "no combination"),
    ],
)
def test_finds(own, body, says):
    assert re.search(says, own(body)["finding"])


def test_finds_a_part_that_no_case_has(own):
    facts = own(lambda see: see.near(1, 1, "", "x"), {"x": "1 LSB", "load": "1 LSB"})
    assert "no number for ['load']" in facts["finding"]


def test_hypothesis_draws_and_finds(own):
    import hypothesis.strategies as st

    def body(see):
        see.given(lambda x: see.near(x if x < 77 else x + 1, x, str(x)), x=st.integers(0, 1000))

    facts = own(body)
    assert "bound 0.5, at 77" in facts["finding"], "the least"
    assert facts["cases"] > 1


def test_a_run_of_nothing_has_failed(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["extremes.py"])
    monkeypatch.setattr(extremes, "rows", dict)
    monkeypatch.setattr(extremes, "without", dict)
    with pytest.raises(SystemExit, match="nothing ran"):
        tool.main()


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


def test_stale_rows_are_marked(monkeypatch):
    told = tool.load()
    told["blocks"]["divide"] = told["blocks"]["divide"] | {"of": "before"}
    [line] = [line for line in tool.page(told).splitlines() if "| `msn_divide`" in line and "LSB" in line]
    assert "passes (stale)" in line


SHORT = ("delay", "fifo", "round_sat")  # a quarter of a second per parameter set


def test_every_block_with_two_parameters_has_their_ends():
    table = elaborations.ends()
    assert set(table) | set(elaborations.BY_ROWS) <= set(benches.blocks()) and len(table) >= 50
    assert not set(table) & set(elaborations.BY_ROWS)
    assert elaborations.parameters("round_sat") == ["InWidth", "OutWidth", "DropBits", "Unsigned"]
    for row in elaborations.BY_ROWS:
        text = (toolchain.ROOT / extremes.rows()[row].source).read_text("utf-8")
        assert re.search(rf'see\.elaborates\(\s*"{row}"', text), row


def test_a_block_that_the_table_does_not_name_is_read_as_its_tests_build_it(monkeypatch, tmp_path):
    """The smallest and largest values of SIZES in tb/common/test_round_sat.py, read by hand."""
    lines = elaborations.ENDS.read_text("utf-8").splitlines()
    named = [line for line in lines if not line.startswith("round_sat ")]
    assert len(named) == len(lines) - 1
    (tmp_path / "ends.toml").write_text("\n".join(named), "utf-8")
    monkeypatch.setattr(elaborations, "ENDS", tmp_path / "ends.toml")
    ends = {"InWidth": [9, 51], "OutWidth": [1, 16], "DropBits": [1, 24], "Unsigned": [0, 1]}
    assert elaborations.ends()["round_sat"] == ends


@pytest.mark.parametrize("block", SHORT)
def test_the_ends_of_parameters_are_read_or_refused(block):
    facts = elaborations.elaborate(block)
    assert not facts["finding"] and facts["taken"] >= 6, f"python tools/extremes.py --elaborate {block}"


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
