"""Coverage of the RTL and of its twins: which points the blocks' own tests reach.

    python tools/cover.py [--record] [--no-run] [--long] [BLOCK ...]

Runs the tests of the given blocks (default: all) in builds with coverage counters (tb/runner.py), merges the
counts by source point over all instances and parameter sets, leaves out the points that
tb/coverage/waivers.toml excludes with a reason, and prints a row per block and every hole. Exits 1 if there
is a hole, or a waiver that has no reason, was hit after all, or matches nothing. ``--no-run`` reads the
counts of the previous run; ``--record`` merges the table into docs/trust/coverage.json. docs/coverage.md
states what is counted.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import coverage_points as points
from coverage_points import FOLDER, KINDS, ROOT
from verify import benches, evidence, record, sums

COUNTS = FOLDER / "counts"
TRACES = FOLDER / "python"
REVISIONS = FOLDER / "revisions.json"  # record.digest of each block at the time of its run


def tests_of(blocks):
    """The test files of ``blocks``, or of all stages."""
    if not blocks:
        return [*(f"tb/{stage}" for stage in points.STAGES), "tb/cli/test_cop4.py"]
    return [path.relative_to(ROOT).as_posix() for name in blocks for path in evidence.tests_of(name)]


def counted(blocks):
    """The folders of counts of ``blocks``, or of all: one for each test file (tb/runner.py)."""
    return [Path(file).stem.removeprefix("test_") for file in tests_of(blocks)] if blocks else ["*"]


def run(blocks, long, jobs):
    """Run the tests of ``blocks``, or of all, with coverage counters; return whether they passed."""
    for folder in [path for name in counted(blocks) for path in COUNTS.glob(name)]:
        shutil.rmtree(folder)
    traces = TRACES / "-".join(blocks or ["all"])
    shutil.rmtree(traces if blocks else TRACES, ignore_errors=True)
    traces.mkdir(parents=True)
    known = json.loads(REVISIONS.read_text()) if REVISIONS.exists() else {}
    fresh = {name: record.digest(name, "coverage") for name in blocks or benches.blocks()}
    REVISIONS.write_text(json.dumps(known | fresh))
    environment = {
        **os.environ,
        "MEISSNER_COVERAGE": str(COUNTS),
        "COVERAGE_PROCESS_START": str(points.RULES),
        "COVERAGE_FILE": str(traces / "data"),
    }
    spread = ["-n", str(jobs), "--dist", "worksteal"] if jobs > 1 else ["-p", "no:xdist"]
    command = [sys.executable, "-m", "pytest", *spread, *tests_of(blocks)]
    command += [] if long else ["-m", "not long"]
    return subprocess.run(command, cwd=ROOT, env=environment).returncode == 0


def percent(hit, reachable):
    return "  -  " if not reachable else f"{100 * hit / reachable:5.1f}"


def points_of(rows):
    """``rows`` in a few words: the share of reachable points that were hit, and how many were excluded."""
    hit, reachable, excluded = sums.points(rows)
    share = "100" if hit == reachable else f"{100 * hit / reachable:.2f}"
    left_out = f" ({100 * excluded / (reachable + excluded):.0f} % of all, {excluded:,}, excluded)"
    return f"{share} % of {reachable:,} points" + (left_out if excluded else "")


def total(rows):
    return f"coverage: {points_of(rows)} in {len(rows)} blocks"


def write(rows):
    """Merge ``rows`` into docs/trust/coverage.json as {kind of point: [hit, reachable, excluded]}."""
    revisions = json.loads(REVISIONS.read_text())
    fresh = {
        name: {kind: counts for kind, counts in row.items() if any(counts)} | {"of": revisions[name]}
        for name, row in rows.items()
        if "/" not in name
    }
    summary = lambda row: points_of([row])
    record.merge("coverage", "make coverage", fresh, summary, total, listed=benches.blocks())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK", help="without msn_; all if none is named")
    parser.add_argument("--no-run", action="store_true", help="judge the counts of the run before")
    parser.add_argument("--record", action="store_true", help="merge into docs/trust/coverage.json")
    parser.add_argument("--long", action="store_true", help="with the tests of `make test-long`")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    if refusal := evidence.refusal(arguments.blocks):
        parser.exit(2, f"cover: {refusal}\n")
    passed = arguments.no_run or run(arguments.blocks, arguments.long, arguments.jobs)
    paths = sorted(path for name in counted(arguments.blocks) for path in COUNTS.glob(f"{name}/*.dat"))
    traced = "*" if arguments.no_run else "-".join(arguments.blocks) or "*"
    traces = sorted(TRACES.glob(f"{traced}/data*"))
    if not paths or not traces:
        sys.exit("coverage: nothing was counted")
    texts = {}
    merged = points.merge(paths, lambda path: texts.setdefault(path, path.read_text().splitlines()))
    points.merge_twins(traces, merged)
    waivers = tomllib.loads(points.WAIVERS.read_text())["waiver"]
    blocks = arguments.blocks or [*benches.blocks(), *sorted(name for name in merged if "/" in name)]
    rows, holes, faults = points.judge(merged, waivers, blocks)
    print(f"{'block':20}" + "".join(f"{kind:>19}" for kind in KINDS))
    for name, row in rows.items():
        cells = (f"{percent(hit, some)} {hit:>5}/{some:<5}" for hit, some, _ in row.values())
        print(f"{name:20}" + "".join(f"{cell:>19}" for cell in cells))
    for line in (*holes, *faults):
        print(line)
    if arguments.record and passed:
        write(rows)
    if not passed or holes or faults:
        sys.exit(
            f"coverage: {len(holes)} holes, {len(faults)} faulty waivers"
            + ("" if passed else ", tests failed")
        )
    print(f"coverage: no hole in {len(rows)} block{'s' * (len(rows) != 1)}")


if __name__ == "__main__":
    main()
