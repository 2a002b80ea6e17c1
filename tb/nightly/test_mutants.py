"""tools/mutants.py: mutants of quick blocks are all killed; weak tests leave survivors; a mutant that no test
can distinguish is shown equivalent, and one that a test can distinguish is not; a run without tests, or whose
tests fail unchanged, does not pass."""

import argparse
import subprocess
import sys
import tomllib
from pathlib import Path

import mutants as tool
import pytest

from meissner.builds.toolchain import ROOT
from verify import after_reset, benches, contract, equivalence, evidence, mutate, simulate

OPTIONS = argparse.Namespace(samples=6, seed=[7], jobs=2, limit=5, sets=[], unsolved=False)


def one(block, count, folder, which=0, **changes):
    """The run of a parameter set and its mutants, built in ``folder``."""
    run = tool.parameter_sets(block)[which][0] | changes
    found, _ = mutate.netlist(run, count, [3], f"build/mutants/{folder}")
    simulate.build(run, f"build/mutants/{folder}")
    return run, found


@pytest.mark.parametrize("block", ["round_sat", "skid", "fork", "sync"])
def test_quick_blocks_kill_theirs(block):
    runs = tool.parameter_sets(block)[0]
    found, there, _ = tool.one_set(runs, "quick", OPTIONS.samples, OPTIONS)
    assert len(found) == OPTIONS.samples <= there
    told = tool.entry(found, [], [], 0)
    assert told["survived"] == []
    assert told["killed"] >= OPTIONS.samples - 2


def test_a_large_block_has_options_of_its_own():
    """Their names are those of options and of blocks, and options of the command line take precedence."""
    default = vars(OPTIONS).get
    large = {block: evidence.of(block, "mutants") for block in benches.blocks()}
    assert large["array"] == {"sets": [1], "limit": 60, "unsolved": True}
    for block, stated in large.items():
        options = {key: value for key, value in stated.items() if key != "whole"}
        assert vars(tool.fitted(OPTIONS, block, default)) == vars(OPTIONS) | options
    asked = argparse.Namespace(**vars(OPTIONS) | {"limit": 7})
    assert tool.fitted(asked, "array", default).limit == 7
    assert tool.fitted(OPTIONS, "skid", default) == OPTIONS


def test_a_weak_test_leaves_survivors_that_the_solver_distinguishes():
    """Only the reset of msn_skid is tested: the solver finds how those mutants differ, and none is
    equivalent."""
    folder = "build/mutants/skid-weak"
    run, found = one("skid", 20, "skid-weak", test_filter="forgets_what")
    simulate.judge(run, found, folder, 2)
    alive = [mutant for mutant in found if mutant.verdict == "survived"]
    assert len(alive) > 3
    equivalence.classify(alive, folder)
    assert {mutant.verdict for mutant in alive} == {"different"}
    told = tool.entry(found, [run["parameters"]], [], 0)
    assert not tool.good("skid", told)
    assert len(told["survived"]) == len(alive)


def test_shows_equivalence_and_never_of_a_killed_mutant():
    """With an output of one bit, most of the clipped value has no effect."""
    folder = "build/mutants/round_sat-equal"
    run, found = one("round_sat", 16, "round_sat-equal", which=2)
    simulate.judge(run, found, folder, 2)
    killed = [mutant for mutant in found if mutant.verdict == "failed"]
    alive = [mutant for mutant in found if mutant.verdict == "survived"]
    equivalence.classify(alive + killed[:8], folder)
    assert alive and {mutant.verdict for mutant in alive} == {"equivalent"}
    assert {mutant.verdict for mutant in killed[:8]} == {"different"}
    equivalence.judge(alive + killed[:8], folder, after_reset.write_all, search=False)
    assert {mutant.verdict for mutant in alive} == {"equivalent"}
    assert {mutant.verdict for mutant in killed[:8]} == {"undecided"}


def test_shows_equivalence_under_a_contract():
    """A pipelined divider that also accepts invalid inputs, and mutants that its tests kill."""
    folder = "build/mutants/divide-contract"
    [run] = [
        run for run in benches.runs("divide") if list(run["parameters"].values()) == ["12", "5", "1", "1"]
    ]
    found, _ = mutate.netlist(run, 47, [1], folder)
    circuit = after_reset.bits(folder)
    [same] = [mutant for mutant in found if mutant.what == "const1 logic_and A[0]"]
    assert contract.same(circuit, same.number)
    assert not contract.same(circuit, found[1].number)


@pytest.mark.long
def test_shows_equivalence_by_what_is_proven_first():
    """A window's places are counted in another order with the same end, which nothing can distinguish."""
    folder = Path("build/mutants/peak_to_peak-lemmas")
    run = tool.parameter_sets("peak_to_peak")[0][0]
    found, _ = mutate.netlist(run, 600, [1], folder)
    circuit = after_reset.bits(folder)
    [same] = [mutant for mutant in found if mutant.what == "cnot1 ternary Y[4] by [0] gen_parts.place[4]"]
    for mutant in (same, found[0]):
        equivalence.judge_by_lemmas(mutant, circuit, folder)
    assert (same.verdict, found[0].verdict) == ("equivalent", "undecided")


def test_a_person_may_show_equivalence_of_a_line_as_it_is(tmp_path, monkeypatch):
    judged = tmp_path / "equivalent.toml"
    monkeypatch.setattr(tool, "JUDGED", judged)
    row = '[[mutant]]\nblock = "skid"\ntext = "{}"\nchange = "inv A"\nreason = "none"\n'.format
    line = mutate.source_of("skid").read_text().splitlines().index("  assign in_ready_o  = !held;") + 1
    for text, block, what, same in (
        ("assign in_ready_o  = !held;", "skid", "inv A", True),
        ("assign in_ready_o  = !held;", "skid", "inv B", False),
        ("assign in_ready_o  = !held;", "fork", "inv A", False),
        ("assign in_ready_o  = held;", "skid", "inv A", False),
    ):
        judged.write_text(row(text))
        found = mutate.Mutant(1, what, f"msn_skid.sv:{line} msn_skid.sv:1", "", "undecided")
        tool.by_hand([found], block)
        assert found.verdict == ("equivalent" if same else "undecided"), (text, block, what)


def test_every_reason_is_of_a_line_that_is_there():
    for row in tomllib.loads(tool.JUDGED.read_text())["mutant"]:
        assert row["text"] in map(str.strip, mutate.source_of(row["block"]).read_text().splitlines()), row
        assert row.keys() == {"block", "text", "change", "reason"} and row["reason"]


def test_fails_when_the_tests_fail_unchanged():
    run, found = one("sync", 2, "sync-broken")
    with pytest.raises(simulate.BuildError, match="unchanged block fails"):
        simulate.judge(run | {"test_filter": "no_such_test"}, found, "build/mutants/sync-broken", 1)


def test_command_refuses_a_block_that_is_not_there():
    done = subprocess.run(
        [sys.executable, "tools/mutants.py", "nonsense"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr == "mutants: rtl/rtl.f has no block nonsense\n"


def test_every_block_has_parameter_sets():
    """A block gets mutants as soon as it is listed."""
    tested = {run["block"] for run in benches.runs() if not run["sources"]}
    assert tested >= set(benches.blocks())
