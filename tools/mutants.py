"""Run each block's own tests on mutants of the block: killed, shown equivalent, or survived (with its line).

    python tools/mutants.py                  every block of rtl/rtl.f
    python tools/mutants.py haar divide      only these
    python tools/mutants.py --source haar    only mutants of the source text; --cells: of the netlist's cells
    python tools/mutants.py --seed 4 5 6     other mutants than those of the record
    python tools/mutants.py --record         put the results into docs/trust/mutants.json and docs/mutants.md

Exit code 1 if the tests of a block kill too few of the mutants that are not equivalent, if they fail on the
unchanged block, or if nothing ran. `build/mutants/<block>-<set>/` keeps the netlist of each parameter set.
"""

import argparse
import json
import re
import sys
import time
import tomllib
from collections import Counter

from meissner.builds.toolchain import ROOT
from meissner.builds.yowasp import ToolError, warm_up
from verify import benches, equivalence, evidence, mutants_page, mutate, record, simulate, source_netlist

PAGE = ROOT / "docs/mutants.md"
MARK = "<!-- written by make mutants: from here to the end -->\n"
LEAST = 0.95  # share of the non-equivalent mutants to kill; all of them where the tests state ``whole``
SETS = 4  # parameter sets of a block, evenly spread over its tests' list
POWERUPS = 8  # for counters, whose upper bits otherwise start as all ones or all zeros
COUNTS = "counts_over_the_whole_width"  # the test of bench.turn_over
FEWEST_A_SET = 25  # mutants per set; with fewer mutants, fewer sets
FEWEST, MOST = 100, 200  # limits for a ``whole`` block, which gets one mutant per line of its source
OTHERS = 25  # mutants of any other block; all blocks together take three CPU hours
SOURCE, SOURCE_SETS = 24, 2  # mutants of a block's source, and the number of sets they share
SEEDS = [1, 2, 3]
JUDGED = ROOT / "tb/verify/equivalent.toml"  # mutants judged by hand


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


def one_set(runs, number, count, options, kind=mutate):
    """(judged mutants of one parameter set, how many exist, seconds that the tests take on the unchanged
    block). ``kind``: the module that makes the mutants, mutate or source_netlist."""
    block = runs[0]["block"]
    folder = f"build/mutants/{block}-{number}"
    mutants, known = kind.netlist(runs[0], count, options.seed, folder)
    if not mutants:
        return [], known, 0.0
    simulate.build(runs[0], folder)
    seconds = 0.0
    alive = [mutant for mutant in mutants if mutant.verdict != "equivalent"]
    for run in runs:
        seconds += simulate.judge(run, alive, folder, options.jobs, limit=options.limit)
        alive = [mutant for mutant in alive if mutant.verdict == "survived"]
    for powerup in range(1, POWERUPS + 1):
        if alive and COUNTS in mutate.tests_of(runs[0]).read_text():
            simulate.judge(runs[0] | {"test_filter": COUNTS}, alive, folder, options.jobs, powerup=powerup)
            alive = [mutant for mutant in alive if mutant.verdict == "survived"]
    if alive:
        equivalence.classify(alive, folder, block, briefly=options.unsolved)
    by_hand(alive, block)
    return mutants, known, seconds


def by_hand(mutants, block):
    """Mark mutants as equivalent that a person has shown to be so, if their source line is unchanged."""
    judged = tomllib.loads(JUDGED.read_text())["mutant"]
    same = {(row["text"], row["change"]) for row in judged if row["block"] == block}
    lines = mutate.source_of(block).read_text().splitlines()
    for mutant in mutants:
        own = re.search(rf"\bmsn_{block}\.sv:(\d+)", mutant.source)
        if own and (lines[int(own[1]) - 1].strip(), mutant.what) in same:
            mutant.verdict = "equivalent"


def fitted(options, block, default):
    """``options`` for ``block``: its tests' values replace those that the user left at their ``default``."""
    stated = {
        key: value
        for key, value in evidence.of(block, "mutants").items()
        if key != "whole" and getattr(options, key) == default(key)
    }
    return argparse.Namespace(**vars(options) | stated)


def one_block(block, options):
    """The block's entry of docs/trust/mutants.json: mutants of its cells, and under "source" of its text."""
    found = {"of": record.digest(block, "mutants")}
    if options.cells:
        count = options.samples or size_of(block)
        found |= one_kind(block, options, mutate, count, min(SETS, -(-count // FEWEST_A_SET)))
    if options.source:
        count = options.samples or SOURCE
        found["source"] = one_kind(block, options, source_netlist, count, min(SOURCE_SETS, count))
    return found


def one_kind(block, options, kind, count, wanted):
    """The results of mutants that the module ``kind`` makes of a block, over ``wanted`` of its sets."""
    began = time.monotonic()
    wanted = len(options.sets) or wanted
    groups = parameter_sets(block, wanted, options.sets)
    wanted = min(wanted, len(groups))
    mutants, sets, slow, known = [], [], [], 0
    for number, runs in enumerate(groups):
        if len(sets) == wanted:
            break
        share = count // wanted + (len(sets) < count % wanted)
        name = f"source-{number}" if kind is source_netlist else number
        try:
            judged, there, seconds = one_set(runs, name, share, options, kind)
        except simulate.TooSlow:
            slow.append(runs[0]["parameters"])
            continue
        if not judged:  # the block consists of wires only
            continue
        mutants += judged
        known += there
        sets.append(runs[0]["parameters"])
        tally = Counter(mutant.verdict for mutant in judged)
        print(f"  {runs[0]['parameters'] or 'defaults'}: {dict(tally)}, tests {seconds:.1f} s", flush=True)
        for one in entry(judged, [], [], 0)["survived"]:
            print(f"    {one['what']} at {one['source']}, {one['solver']}", flush=True)
    drawn = {"there": known, "seeds": options.seed}
    return drawn | entry(mutants, sets, slow, time.monotonic() - began)


def entry(mutants, sets, slow, seconds):
    killed = [m for m in mutants if m.verdict in ("failed", "time", "stopped")]
    equal = [m for m in mutants if m.verdict == "equivalent"]
    alive = [m for m in mutants if m not in killed and m not in equal]
    score = len(killed) / max(1, len(mutants) - len(equal))
    return {
        "mutants": len(mutants),
        "killed": len(killed),
        "of these stopped": dict(Counter(m.verdict for m in killed if m.verdict != "failed")),
        "equivalent": len(equal),
        "survived": [
            {"what": m.what, "source": m.source, "solver": m.verdict, "parameters": m.parameters}
            for m in alive
        ],
        "score": round(score, 4),
        "sets": sets,
        "too slow": slow,
        "seconds": round(seconds),
    }


def good(block, found):
    least = 1 if evidence.of(block, "mutants").get("whole") else LEAST
    return all(part["score"] >= least for part in mutants_page.parts(found))


def write(block, found):
    """Merge the results of a block into the record and rewrite the page's table."""
    own = {block: found}, mutants_page.summary, mutants_page.total
    path = record.merge("mutants", "make mutants", *own, join=dict.__or__, listed=benches.blocks())
    prose = PAGE.read_text().split(MARK)[0]
    PAGE.write_text(prose + MARK + "\n" + mutants_page.table(json.loads(path.read_text())))


def told(name, part):
    """The line printed for a block and a kind of mutants."""
    row = {k: part[k] for k in ("there", "mutants", "killed", "equivalent", "seconds")}
    print(f"{name}: {row}, survived {len(part['survived'])}, {100 * part['score']:.1f} %", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("block", nargs="*", help="without msn_; all if none is named")
    parser.add_argument("--source", action="store_true", help="only mutants of the source text")
    parser.add_argument("--cells", action="store_true", help="only mutants of the netlist's cells")
    parser.add_argument(
        "--samples", type=int, help="mutants per block of a kind, in place of 25, or 100 to 200, and 24"
    )
    parser.add_argument(
        "--sets", type=int, nargs="+", default=[], help="parameter sets, by place in its tests"
    )
    parser.add_argument("--seed", type=int, nargs="+", default=SEEDS, help="of the choice of mutants")
    parser.add_argument("--jobs", type=int, default=2, help="mutants that run at a time")
    parser.add_argument("--limit", type=float, default=30, help="seconds of a set's tests, else passed over")
    parser.add_argument("--unsolved", action="store_true", help="ask the solver of a single clock only")
    parser.add_argument(
        "--record", action="store_true", help="write docs/trust/mutants.json and docs/mutants.md"
    )
    options = parser.parse_args()
    if not (options.source or options.cells):
        options.source = options.cells = True
    if refusal := evidence.refusal(options.block):
        parser.exit(2, f"mutants: {refusal}\n")
    warm_up()
    sys.path.insert(0, str(ROOT / "tb"))
    results, wrong = {}, []
    for block in options.block or benches.blocks():
        try:
            found = one_block(block, fitted(options, block, parser.get_default))
        except (simulate.BuildError, ToolError) as error:
            print(f"{block}: FAILED, {error}\n{getattr(error, 'tail', '')}", flush=True)
            wrong.append(block)
            continue
        for name, part in (("cells", found), ("source", found.get("source", {}))):
            if "mutants" in part:
                told(f"{block}, {name}", part)
        if mutants_page.both(found, "mutants"):
            results[block] = found
        if block not in results or not good(block, found):
            wrong.append(block)
        if options.record and block in results:
            write(block, found)
    if wrong:
        print(f"short of its target: {' '.join(wrong)}")
    sys.exit(bool(wrong) or not results)


if __name__ == "__main__":
    main()
