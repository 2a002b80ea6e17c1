"""Inject faults into blocks and compare their output: state bits upset, samples lost, repeated or late,
`last` misplaced, a stalled follower, resets in every clock, a converter that hangs or is noisy.

    python tools/faults.py [--faults N] [--seed N] [--record] [BLOCK ...]     default: all that have state

A recording of a block's own tests drives the block; the run without the fault is the reference. See
docs/faults.md. Prints a line per block; stops with an error if a wrong result is undetected or nothing ran.
"""

import argparse
import collections
import json
import subprocess
import sys

from meissner.builds import toolchain
from verify import evidence, faults, record

TABLE = "## What was recorded\n\n"  # the page's last section


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK")
    parser.add_argument("--faults", type=int, default=200, help="bits upset per block")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", action="store_true", help="into docs/trust/faults.json, docs/faults.md")
    parser.add_argument("--show", action="store_true", help="each fault that is not masked")
    given = parser.parse_args()
    refusal = evidence.refusal(given.blocks)
    for name in () if refusal else given.blocks:
        if reason := faults.stated(name, "none", ""):
            refusal = f"no faults are injected into {name}: {reason}"
    if refusal:
        parser.exit(2, f"faults: {refusal}\n")
    names = given.blocks or faults.blocks()
    totals, silent, broken, done = collections.Counter(), [], [], {}
    for name in names:
        revision = record.digest(name, "faults")  # taken now: the sources may change during the run
        try:
            results = faults.inject(name, given.faults, given.seed)
        except (RuntimeError, subprocess.TimeoutExpired) as problem:
            print(f"{name:20} {str(problem).strip().splitlines()[0]}", flush=True)
            broken.append(name)
            continue
        counts = collections.Counter(result.outcome for result in results)
        counts["injected"] = len(results)
        totals += counts
        done[name] = {"of": revision} | {key: counts[key] for key in faults.COLUMNS}
        print(f"{name:20}", *(f"{key} {counts[key]:5}" for key in faults.COLUMNS), flush=True)
        for result in results:
            if result.outcome == "silent" or (given.show and result.outcome not in ("masked", "recovered")):
                print(f"    {result.kind} {result.where} at {result.at}: {result.outcome} {result.what}")
        silent += [f"{name}: {r.kind} {r.where} at {r.at}" for r in results if r.outcome == "silent"]
    print(f"{'all':20}", *(f"{key} {totals[key]:5}" for key in faults.COLUMNS))
    if given.record:
        known = record.merge("faults", "make faults", done, faults.summary, faults.total)
        page = toolchain.ROOT / "docs/faults.md"
        before = page.read_text().split(TABLE)[0]
        page.write_text(before + TABLE + faults.table(json.loads(known.read_text())["blocks"]))
    if not totals["injected"]:
        sys.exit("faults: nothing was injected")
    if silent or broken:
        sys.exit(f"faults: {len(silent)} undetected; not run: {', '.join(broken) or 'none'}")


if __name__ == "__main__":
    main()
