"""Mutants: a block's own tests run on copies of its netlist with one cell changed, and must fail.

A mutant is killed, shown equivalent, or survives; one that the solver does not decide survives. Mutants are
drawn from up to SETS parameter sets of the block's tests; a set whose tests take too long is left out.
``build/mutants/<block>-<set>/`` keeps the netlist of each.
"""

import json
import re
import sys
import time

from meissner.builds.toolchain import ROOT
from nightly import benches, equivalent, evidence, mutate, simulate

SETS = 4  # parameter sets of a block, evenly spread over its tests' list
POWERUPS = 8  # for counters, whose upper bits otherwise start as all ones or all zeros
COUNTS = "counts_over_the_whole_width"  # the test of bench.turn_over
FEWEST_A_SET = 25  # mutants per set; with fewer mutants, fewer sets
FEWEST, MOST = 100, 200  # limits for a ``whole`` block, which gets one mutant per line of its source
OTHERS = 25  # mutants of any other block
SEEDS = (1, 2, 3)
LIMIT_S = 30  # CPU time of a set's tests on the unchanged block, else the set is left out
DEAD = ("failed", "time", "stopped")  # the verdicts of a killed mutant


def blocks():
    return benches.blocks()


def parameter_sets(block, wanted=SETS, chosen=()):
    """The runs of the block's tests, grouped by equal parameters, the groups to try first at the front.

    ``wanted``: number of sets; few leave out the smallest sizes, with which the tests' lists begin.
    ``chosen``: positions in the tests' list, which replace this choice.
    """
    groups = {}
    for run in benches.runs(block):
        if not run["sources"] and run["block"] == block:  # runs with other sources test something else
            groups.setdefault(json.dumps(run["parameters"]), []).append(run)
    groups = list(groups.values())
    if chosen:
        return [groups[i] for i in chosen if i < len(groups)]
    half = len(groups) // 2 if wanted < SETS else 0
    first = {(k * len(groups) + half) // wanted for k in range(wanted)}
    return [groups[i] for i in sorted(first)] + [g for i, g in enumerate(groups) if i not in first]


def size_of(block):
    """The number of mutants that a block gets."""
    if not evidence.of(block, "mutants").get("whole"):
        return OTHERS
    lines = mutate.source_of(block).read_text().count("\n")
    return min(MOST, max(FEWEST, lines))


def one_set(runs, folder, count, limits, jobs=1, seeds=SEEDS):
    """(judged mutants of one parameter set, how many exist)."""
    block, stated = runs[0]["block"], evidence.of(runs[0]["block"], "mutants")
    mutants, known = mutate.netlist(runs[0], count, seeds, folder)
    if not mutants:
        return [], known
    simulate.build(runs[0], folder)
    alive = mutants
    for run in runs:
        simulate.judge(run, alive, folder, jobs, limit=stated.get("limit", LIMIT_S))
        alive = [mutant for mutant in alive if mutant.verdict == "survived"]
    for powerup in range(1, POWERUPS + 1):
        if alive and COUNTS in mutate.tests_of(runs[0]).read_text():
            simulate.judge(runs[0] | {"test_filter": COUNTS}, alive, folder, jobs, powerup=powerup)
            alive = [mutant for mutant in alive if mutant.verdict == "survived"]
    by_hand(alive, limits.equivalent(block))
    if alive := [mutant for mutant in alive if mutant.verdict == "survived"]:
        equivalent.classify(alive, folder, briefly=stated.get("unsolved", False))
    return mutants, known


def by_hand(mutants, judged):
    """Mark mutants as equivalent that a person has shown to be so: ``judged`` has (line, change)."""
    for mutant in mutants:
        own = re.search(rf"\bmsn_{mutant.block}\.sv:(\d+)", mutant.source)
        lines = mutate.source_of(mutant.block).read_text().splitlines()
        if own and (lines[int(own[1]) - 1].strip(), mutant.what) in judged:
            mutant.verdict = "equivalent"


def judged(mutants, least):
    """The facts of some mutants, and what of them breaks the limit ``least``."""
    equal = [mutant for mutant in mutants if mutant.verdict == "equivalent"]
    alive = [mutant for mutant in mutants if mutant.verdict not in ("equivalent", *DEAD)]
    asked = len(mutants) - len(equal)
    killed = asked - len(alive)
    survived = [
        f"{mutant.what} at {mutant.source or '?'}, {mutant.verdict} with {mutant.parameters or 'defaults'}"
        for mutant in alive
    ]
    short = f"{killed} of {asked} killed, {100 * killed / max(1, asked):.1f} %"
    broken = [short, *survived] if killed < least * asked or not mutants else []
    text = f"{short}; {len(equal)} equivalent"
    return {"text": text, "broken": broken, "survived": survived, "killed": killed, "equivalent": len(equal)}


def run(block, limits, jobs=1):
    """The facts of a block's mutants."""
    began = time.monotonic()
    sys.path.insert(0, str(ROOT / "tb"))
    chosen, count = evidence.of(block, "mutants").get("sets", ()), size_of(block)
    wanted = len(chosen) or min(SETS, -(-count // FEWEST_A_SET))
    groups = parameter_sets(block, wanted, chosen)
    wanted = min(wanted, len(groups))
    mutants, sets, slow, known = [], [], [], 0
    for number, runs in enumerate(groups):
        if len(sets) == wanted:
            break
        share = count // wanted + (len(sets) < count % wanted)
        try:
            found, there = one_set(runs, f"build/mutants/{block}-{number}", share, limits, jobs)
        except simulate.TooSlow:
            slow.append(runs[0]["parameters"])
            continue
        if found:  # else the block consists of wires only
            mutants += found
            known += there
            sets.append(runs[0]["parameters"])
    if not mutants and not slow:
        return {"text": "wires only", "broken": []}
    facts = judged(mutants, limits.killed())
    return facts | {"possible": known, "sets": sets, "slow": slow, "seconds": round(time.monotonic() - began)}
