"""verify.source_mutants on a small text: every possible change, by hand; what is left unchanged; a text with
all changes selected by an input. And the tests of a real block detect a change of a constant, which needs a
copy of the block."""

import argparse

import pytest

import mutants as tool
from verify import source_mutants, source_netlist, source_text

SMALL = """
module own #(
  parameter int unsigned N = 5
) (
  input  logic       clk_i,
  input  logic [7:0] a_i, b_i,
  output logic [7:0] big_o, small_o,
  output logic       yes_o
);
  if (N > 77) begin : gen_check_n
    $fatal(1, "own: N = %0d", N);
  end
  localparam int unsigned K = N - 1;
  logic [7:0] p, q;
  if (N == 5) begin : gen_five
    two u_two (.clk_i, .x_i(a_i), .y_i(b_i), .more_i(yes_o), .p_o(p), .q_o(q));
  end else begin : gen_other
    assign p = 8'd33;
  end
  assign yes_o = a_i > b_i;
  assign big_o[K] = p <= 8'h0f;
  always_ff @(posedge clk_i) begin
    if (a_i == '0) small_o <= yes_o ? p : q - 8'd255;
  end
`ifndef SYNTHESIS
  always_comb assert (a_i != 8'd99);
`endif
endmodule
"""
TWO = """
module two (
  input  logic       clk_i,
  input  logic [7:0] x_i, y_i,
  input  logic       more_i,
  output logic [7:0] p_o, q_o
);
endmodule
"""
# Line, change, and whether it is where a constant is required.
EXPECTED = [
    (13, "operands: N - 1 -> 1 - N", True),
    (13, "one: 1 -> 2", True),
    (13, "one: 1 -> 0", True),
    (14, "one: 7 -> 8", True),
    (14, "one: 7 -> 6", True),
    (14, "one: 0 -> 1", True),
    (15, "comparison: N == 5 -> N != 5", True),
    (15, "one: 5 -> 6", True),
    (15, "one: 5 -> 4", True),
    (16, "ports: u_two .x_i .y_i -> .y_i .x_i", False),
    (16, "ports: u_two .p_o .q_o -> .q_o .p_o", False),
    (20, "comparison: a_i > b_i -> a_i >= b_i", False),
    (20, "one: a_i > b_i -> a_i > b_i + 1", False),
    (20, "operands: a_i > b_i -> b_i > a_i", False),
    (21, "comparison: p <= 8'h0f -> p < 8'h0f", False),
    (21, "operands: p <= 8'h0f -> 8'h0f <= p", False),
    (21, "one: 8'h0f -> 8'h10", False),
    (21, "one: 8'h0f -> 8'he", False),
    (23, "comparison: a_i == '0 -> a_i != '0", False),
    (23, "one: '0 -> 1'b1", False),
    (23, "operands: yes_o ? p : q - 8'd255 -> yes_o ? (q - 8'd255) : p", False),
    (23, "operands: q - 8'd255 -> 8'd255 - q", False),
    (23, "one: 8'd255 -> 8'd0", False),
    (23, "one: 8'd255 -> 8'd254", False),
]


@pytest.fixture
def listed(tmp_path):
    """The changes of SMALL for a given parameter."""
    paths = []
    for name, text in (("two.sv", TWO), ("own.sv", SMALL)):
        paths.append(tmp_path / name)
        paths[-1].write_text(text)

    def known(n=5):
        elaborated = source_mutants.elaborate(paths, "own", {"N": n})
        return source_mutants.changes(SMALL, elaborated)

    return known


def test_lists_every_change_of_a_text(listed):
    assert [(change.line, change.what, change.constant) for change in listed()] == EXPECTED


def test_leaves_alone_what_is_not_there_with_these_parameters(listed):
    """With another N there is no instance, but another constant."""
    lines = [change.what for change in listed(6) if change.line in (16, 18)]
    assert lines == ["one: 8'd33 -> 8'd34", "one: 8'd33 -> 8'd32"]


def test_one_change_alone(listed):
    known = {change.what: change for change in listed()}

    def line(what):
        text = source_text.alone(SMALL, known[what])
        [new] = set(text.splitlines()) - set(SMALL.splitlines())
        assert len(text.splitlines()) == len(SMALL.splitlines())
        return new.strip()

    ports = "two u_two (.clk_i, .x_i({}), .y_i({}), .more_i(yes_o), .p_o({}), .q_o({}));".format
    assert line(EXPECTED[9][1]) == ports("b_i", "a_i", "p", "q")
    assert line(EXPECTED[10][1]) == ports("a_i", "b_i", "q", "p")
    assert line(EXPECTED[0][1]) == "localparam int unsigned K = 1 - N;"
    assert line(EXPECTED[11][1]) == "assign yes_o = a_i >= b_i;"


def test_changes_together_each_behind_its_number(listed):
    """An outer change contains the inner ones where it is not selected; outputs are exchanged by wires."""
    chosen = [change for change in listed() if change.line in (13, 16, 20, 23) and not change.constant]
    text = source_text.together(SMALL, dict(enumerate(chosen, 1)), 4)
    for line in (
        ", input logic [3:0] mutsel",
        "  assign yes_o = (mutsel == 5 ? (b_i > a_i) : ((mutsel == 4 ? (a_i > b_i + 1) : "
        "((mutsel == 3 ? (a_i >= b_i) : (a_i > b_i))))));",
    ):
        assert line in text.splitlines()
    assert ".x_i((mutsel == 1 ? (b_i) : (a_i))), .y_i((mutsel == 1 ? (a_i) : (b_i)))" in text
    [instance] = [line for line in text.splitlines() if "two u_two" in line]
    wire = instance.split()[2].rstrip(";")
    other = wire.removesuffix("p_o") + "q_o"
    assert f"logic [7:0] {wire}; assign p = mutsel == 2 ? {other} : {wire};" in instance
    assert f"logic [7:0] {other}; assign q = mutsel == 2 ? {wire} : {other};" in instance
    assert f".p_o({wire}), .q_o({other})" in instance
    outer = "(mutsel == 8 ? (yes_o ? (q - 8'd255) : p) : (yes_o ? p : "
    assert f"small_o <= {outer}(mutsel == 9 ? (8'd255 - q) : (q - " in text


def test_a_connection_that_has_only_a_name_gets_an_expression():
    text = "module own (\n  input logic x_i, y_i\n);\n  two u_two (.x_i, .y_i(!y_i));\nendmodule\n"
    place = text.index("u_two")
    elaborated = source_mutants.Elaborated([], {place: {"x_i": ("In", 1), "y_i": ("In", 1)}})
    [change] = source_mutants.changes(text, elaborated)
    assert "two u_two (.x_i(!y_i), .y_i(x_i));" in source_text.alone(text, change)
    both = "two u_two (.x_i((mutsel == 1 ? (!y_i) : (x_i))), .y_i((mutsel == 1 ? (x_i) : (!y_i))));"
    assert both in source_text.together(text, {1: change}, 1)


@pytest.mark.parametrize(
    ("literal", "others"),
    [
        ("0", ["1"]),
        ("12_000", ["12001", "11999"]),
        ("1'b0", ["1'b1"]),
        ("2'd3", ["2'd0", "2'd2"]),
        ("4'sd7", ["4'sd8", "4'sd6"]),
        ("9'h100", ["9'h101", "9'hff"]),
        ("'0", ["1'b1"]),
        ("'1", []),
        ("2'b1x", []),
    ],
)
def test_the_neighbours_of_a_number(literal, others):
    assert source_mutants.neighbours(literal) == others


def test_draws_every_kind_first_and_otherwise_by_its_seed(listed):
    known = listed()
    kinds = {(change.kind, change.constant) for change in known}
    some = source_mutants.draw(known, len(kinds), 1)
    assert {(change.kind, change.constant) for change in some} == kinds
    assert source_mutants.draw(known, len(kinds), 1) == some
    assert source_mutants.draw(known, len(kinds), 2) != some
    assert sorted(source_mutants.draw(known, 99, 3), key=known.index) == known


def test_a_real_block_kills_changes_of_both_sorts():
    """msn_delay, seven steps deep: a changed constant has a copy of the block, the others share one text;
    changing a limit between two forms of the block that keeps this size in its form has no effect."""
    options = argparse.Namespace(seed=[1, 2], jobs=2, limit=5, unsolved=True)
    runs = tool.parameter_sets("delay", 2)[1]
    assert runs[0]["parameters"]["Depth"] == "7"
    found, known, _ = tool.one_set(runs, "source-test", 99, options, source_netlist)
    assert known >= len(found) > 6
    verdicts = {mutant.what: mutant.verdict for mutant in found}
    assert verdicts["one: 3 -> 4"] == verdicts["one: 1'b1 -> 1'b0"] == "failed"
    assert verdicts["one: 4 -> 5"] == verdicts["comparison: Depth <= 4 -> Depth < 4"] == "equivalent"


def test_lint_refuses_a_change_that_loses_a_bit():
    run = tool.parameter_sets("skid")[0][0]
    source = source_netlist.Source(run, "build/mutants/skid-lint")
    known = {change.what: change for change in source.changes}
    assert not source.refused(known["operands: held ? kept : in_data_i -> held ? in_data_i : kept"])
    assert source.refused(known["one: 0 -> 1"])
