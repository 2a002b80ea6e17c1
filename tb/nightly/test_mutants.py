"""Mutants of quick blocks are all killed; weak tests leave survivors; a mutant that no test can distinguish
is shown equivalent, and one that a test can distinguish is not; tests that fail unchanged do not pass."""

import pytest

from nightly import equivalent, mutants, mutate, simulate
from nightly.limits import Limits


def one(block, count, folder, which=0, **changes):
    """The run of a parameter set and its mutants, built in ``folder``."""
    run = mutants.parameter_sets(block)[which][0] | changes
    found, _ = mutate.netlist(run, count, [3], f"build/mutants/{folder}")
    simulate.build(run, f"build/mutants/{folder}")
    return run, found


@pytest.mark.parametrize("block", ["round_sat", "skid", "fork", "sync"])
def test_quick_blocks_kill_theirs(block):
    runs = mutants.parameter_sets(block)[0]
    found, there = mutants.one_set(runs, f"build/mutants/{block}-quick", 6, Limits(), 2, [7])
    assert len(found) == 6 <= there
    facts = mutants.judged(found, 1)
    assert facts["broken"] == [] and facts["killed"] >= 4


def test_a_weak_test_leaves_survivors_that_the_solver_distinguishes():
    """Only the reset of msn_skid is tested: the solver finds how those mutants differ, and none is
    equivalent."""
    folder = "build/mutants/skid-weak"
    run, found = one("skid", 20, "skid-weak", test_filter="forgets_what")
    simulate.judge(run, found, folder, 2)
    alive = [mutant for mutant in found if mutant.verdict == "survived"]
    assert len(alive) > 3
    equivalent.classify(alive, folder)
    assert {mutant.verdict for mutant in alive} == {"different"}
    facts = mutants.judged(found, 0.95)
    assert facts["broken"] and len(facts["survived"]) == len(alive)


def test_shows_equivalence_and_never_of_a_killed_mutant():
    """With an output of one bit, most of the clipped value has no effect."""
    folder = "build/mutants/round_sat-equal"
    run, found = one("round_sat", 16, "round_sat-equal", which=2)
    simulate.judge(run, found, folder, 2)
    killed = [mutant for mutant in found if mutant.verdict == "failed"]
    alive = [mutant for mutant in found if mutant.verdict == "survived"]
    equivalent.classify(alive + killed[:8], folder)
    assert alive and {mutant.verdict for mutant in alive} == {"equivalent"}
    assert {mutant.verdict for mutant in killed[:8]} == {"different"}
    circuit = equivalent.bits(folder)
    for mutant in alive + killed[:8]:
        mutant.verdict = "undecided"
        equivalent.ask(mutant, folder, equivalent.from_any_state(circuit, mutant.number), search=False)
    assert {mutant.verdict for mutant in alive} == {"equivalent"}
    assert {mutant.verdict for mutant in killed[:8]} == {"undecided"}


def test_fails_when_the_tests_fail_unchanged():
    run, found = one("sync", 2, "sync-broken")
    with pytest.raises(simulate.BuildError, match="unchanged block fails"):
        simulate.judge(run | {"test_filter": "no_such_test"}, found, "build/mutants/sync-broken", 1)


def test_the_limit_is_a_share_of_those_that_are_not_equivalent():
    """19 of 20 are 95 %; one that the solver does not decide has survived, and no mutants are no evidence."""

    def some(**verdicts):
        found = [verdict for verdict, count in verdicts.items() for _ in range(count)]
        return [mutate.Mutant(n, "inv", "", "", verdict=verdict) for n, verdict in enumerate(found)]

    assert mutants.judged(some(failed=17, time=1, stopped=1, equivalent=5, undecided=1), 0.95)["broken"] == []
    assert mutants.judged(some(failed=18, equivalent=6, undecided=1), 0.95)["broken"]
    assert mutants.judged(some(failed=18, equivalent=6, different=1), 0.95)["broken"]
    assert mutants.judged([], 0.95)["broken"]


def test_a_person_may_show_equivalence_of_a_line_as_it_is():
    lines = mutate.source_of("skid").read_text().splitlines()
    line = lines.index("  assign in_ready_o  = !held;") + 1
    for text, block, what, same in (
        ("assign in_ready_o  = !held;", "skid", "inv A", True),
        ("assign in_ready_o  = !held;", "skid", "inv B", False),
        ("assign in_ready_o  = !held;", "fork", "inv A", False),
        ("assign in_ready_o  = held;", "skid", "inv A", False),
    ):
        row = {"block": "skid", "text": text, "change": "inv A", "reason": "none"}
        given = Limits({"mutants": {"equivalent": [row]}})
        source = f"msn_skid.sv:{line} msn_skid.sv:1"
        found = mutate.Mutant(1, what, source, "", block=block, verdict="undecided")
        mutants.by_hand([found], given.equivalent(block))
        assert found.verdict == ("equivalent" if same else "undecided"), (text, block, what)
