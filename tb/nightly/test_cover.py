"""Coverage finds what a test left out of a tiny module: branch, toggle, expression and cover point. A waiver
excludes the points it names and no others, and is reported if it has no reason, if its point was hit, or if
it matches nothing. A small block has no hole."""

import subprocess

import pytest

import bench
from meissner.builds import toolchain
from nightly import cover
from nightly.limits import Limits

MODULE = """module msn_tiny (input logic clk_i, input logic a, input logic b, output logic [1:0] y);
  always_ff @(posedge clk_i) begin
    if (a && b) y <= 2'd3;
    else y <= 2'd1;
  end
endmodule
"""
COVER = """module cover_tiny (input logic clk_i, input logic a);
  for (genvar k = 0; k < 2; k++) begin : gen_k
    `BIN(both, a == (k == 1))
  end
endmodule
bind msn_tiny cover_tiny u_cover (.*);
"""
MAIN = """#include "Vmsn_tiny.h"
#include "verilated.h"
#include "verilated_cov.h"
int main() {
  Vmsn_tiny top;
  for (int t = 0; t < 12; ++t) { top.clk_i = t & 1; top.a = 0; top.b = t >> 2 & 1; top.eval(); }
  Verilated::threadContextp()->coveragep()->write("tiny.dat");
}
"""


@pytest.fixture(scope="module")
def merged(tmp_path_factory):
    """The points of a module whose input ``a`` is never 1, so that ``y`` is never 3."""
    folder = tmp_path_factory.mktemp("tiny")
    (folder / "msn_tiny.sv").write_text(MODULE)
    (folder / "cover_tiny.sv").write_text(COVER)
    (folder / "main.cpp").write_text(MAIN)
    # Without optimisation, and so without precompiled headers: this takes the least time for one tiny model.
    plain = "OPT_FAST= OPT_SLOW= OPT_GLOBAL= VM_PARALLEL_BUILDS=0"
    command = ["verilator", "--cc", "--exe", "--build", "-MAKEFLAGS", plain, *bench.COVERAGE_FLAGS]
    for each in ([*command, "msn_tiny.sv", BIN, "cover_tiny.sv", "main.cpp"], ["obj_dir/Vmsn_tiny"]):
        subprocess.run(each, cwd=folder, env=toolchain.environment(), check=True, capture_output=True)
    return cover.merge([folder / "tiny.dat"], lambda path: MODULE.splitlines())["tiny"]


BIN = str(toolchain.ROOT / "tb/coverage/bin.svh")
HOLES = {
    "branch if @ if (a && b) y <= 2'd3; :5",
    "cover gen_k[1].both",
    "expr (a==1 && b==1) => 1 @ if (a && b) y <= 2'd3; :11",
    "toggle y[0]:1->0",
    "toggle a:0->1",
    "toggle a:1->0",
    "toggle y[1]:0->1",
    "toggle y[1]:1->0",
}


def judged(merged, *waivers):
    row, holes, faults = cover.judge(merged, waivers, "tiny")
    return row, {*holes}, faults


def test_sees_what_was_left_out(merged):
    row, holes, faults = judged(merged)
    assert holes == HOLES, merged
    assert not faults
    assert row["branch"] == [1, 2, 0]
    assert row["cover"] == [1, 2, 0]


def test_a_waiver_takes_out_what_it_names(merged):
    waiver = {"block": "tiny", "points": ["toggle y[{1..1}]:*", "branch if @ *"], "reason": "never"}
    row, holes, faults = judged(merged, waiver)
    assert holes == {hole for hole in HOLES if "y[1]" not in hole and "branch" not in hole}
    assert not faults
    assert row["branch"] == [1, 1, 1]
    assert row["toggle"][2] == 2


@pytest.mark.parametrize(
    "point, reason, words",
    [
        ("toggle y[1]:*", " ", "has no reason"),
        ("toggle y[2]:*", "none such", "matches nothing"),
        ("toggle b:0->1", "but it did", "was hit after all"),
        ("toggle *", "too much", "was hit after all"),
    ],
)
def test_a_faulty_waiver_is_reported(merged, point, reason, words):
    _, _, faults = judged(merged, {"block": "tiny", "points": [point], "reason": reason})
    assert len(faults) == 1 and words in faults[0], faults


def test_a_constant_may_come_up_once(merged):
    waiver = {"block": "tiny", "points": ["toggle y[1]:*"], "reason": "always 1", "rule": "constant"}
    up, down = ("toggle", "y[1]:0->1"), ("toggle", "y[1]:1->0")
    for counts, words in (
        ({up: 1, down: 0}, []),
        ({up: 2, down: 1}, ["was hit after all, 1 of 2: y[1]:1->0"]),
    ):
        row, _, faults = judged(counts, waiver)
        assert row["toggle"] == [0, 0, 2]
        assert [fault.split(": ", 2)[2] for fault in faults] == words


@pytest.mark.parametrize(
    "moved, left_out",
    [("11111111", 0), ("00000111", 5), ("00000101", 0), ("00000000", 0), ("00001110", 0), ("00000001", 7)],
)
def test_a_counters_upper_bits_are_left_out_if_the_lower_all_moved(moved, left_out):
    bits = {("toggle", f"n[{k}]:{way}"): int(moved[7 - k]) for k in range(8) for way in ("0->1", "1->0")}
    waiver = {"block": "tiny", "points": ["toggle n[*]:*"], "reason": "a counter", "rule": "counter"}
    row, _, faults = judged(bits, waiver)
    assert row["toggle"] == [2 * moved.count("1"), 16 - 2 * left_out, 2 * left_out]
    assert not faults


def test_more_waived_points_than_the_limit_break_it(merged, monkeypatch, tmp_path):
    rows = '[[waiver]]\nblock = "tiny"\npoints = ["toggle y[1]:*"]\nreason = "never"\n'
    (tmp_path / "waivers.toml").write_text(rows)
    monkeypatch.setattr(cover, "WAIVERS", tmp_path / "waivers.toml")
    for most, holes in ((2, len(HOLES) - 2), (1, len(HOLES) - 1)):  # with 1, a line about the limit more
        limits = Limits({"coverage": {"waived": {"tiny": most}}})
        assert len(cover.facts(merged, "tiny", limits, [])["broken"]) == holes


def test_a_trace_that_is_still_written_is_left_out(tmp_path):
    (tmp_path / "python").mkdir()
    names = ["data.vm.pid31173.XJP1kObx.HNQIp837rWOh", "data.vm.pid31187.XGifiRkx"]
    for name in names:
        (tmp_path / "python" / name).touch()
    assert [path.name for path in tmp_path.glob(cover.TRACES)] == names[:1]


def test_a_small_block_has_no_hole():
    assert cover.run("skid", Limits())["broken"] == []
