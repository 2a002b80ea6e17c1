"""Coverage of the RTL and of its twins: what the blocks' own tests reach, point by point.

    python tools/coverage.py [--record] [--no-run] [--long] [BLOCK ...]

Runs the tests of the blocks named, or of all, in builds that count (tb/bench.py), merges the counts by point
of the source over all instances and parameter sets, leaves out what tb/coverage/waivers.toml excludes, each
with its reason, and prints a row per block and every hole. Exits 1 if there is a hole, a waiver without
reason, one that was hit after all or one that matches nothing. ``--no-run`` reads the counts of the run
before; ``--record`` merges the table into docs/trust/coverage.json. docs/coverage.md says what is counted.
"""

import argparse
import datetime
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib

import coverage_points as points
from coverage_points import BLOCKS, FOLDER, KINDS, ROOT
from meissner import toolchain

COUNTS = FOLDER / "counts"
TRACES = FOLDER / "python"
RECORD = ROOT / "docs/trust/coverage.json"


def tests_of(blocks):
    """The test files of ``blocks``, or of all stages."""
    if not blocks:
        return [*(f"tb/{stage}" for stage in (*points.TWINS, "core")), "tb/cli/test_cop4.py"]
    stages = {path.stem.removeprefix("msn_"): path.parent.name for path in toolchain.sources()}
    return [f"tb/{stages[name].replace('rtl', 'core')}/test_{name}.py" for name in blocks]


def run(blocks, long, jobs):
    """Run the tests of ``blocks``, or of all, counting; whether they passed."""
    for name in blocks or [""]:
        shutil.rmtree(COUNTS / name, ignore_errors=True)
    traces = TRACES / "-".join(blocks or ["all"])
    shutil.rmtree(traces if blocks else TRACES, ignore_errors=True)
    traces.mkdir(parents=True)
    environment = {
        **os.environ,
        "MEISSNER_COVERAGE": str(COUNTS),
        "COVERAGE_PROCESS_START": str(points.RULES),
        "COVERAGE_FILE": str(traces / "data"),
    }
    spread = ["-n", str(jobs), "--dist", "worksteal"] if jobs > 1 else ["-p", "no:xdist"]
    # Without tools/ in the path: simulators would take this file for the package of the same name.
    command = [sys.executable, "-m", "pytest", "-o", "pythonpath=tb", *spread, *tests_of(blocks)]
    command += [] if long else ["-m", "not long"]
    return subprocess.run(command, cwd=ROOT, env=environment).returncode == 0


def percent(hit, reachable):
    return "  -  " if not reachable else f"{100 * hit / reachable:5.1f}"


def summary(rows):
    """``rows`` in a few words: points hit of those reachable, and how many were left out."""
    hit, reachable, excluded = (sum(kinds[at] for row in rows for kinds in row.values()) for at in range(3))
    share = "100" if hit == reachable else f"{100 * hit / reachable:.2f}"
    return f"{share} % of {reachable:,} points" + (f", {excluded:,} excluded" if excluded else "")


def record(rows):
    """Merge ``rows`` into docs/trust/coverage.json; each kind of points: hit, reachable, excluded."""
    old = json.loads(RECORD.read_text())["blocks"] if RECORD.exists() else {}
    fresh = {
        name: {kind: counts for kind, counts in row.items() if any(counts)} | {"summary": summary([row])}
        for name, row in rows.items()
        if "/" not in name and not name.endswith("pkg")
    }
    blocks = dict(sorted((old | fresh).items()))
    kinds = [{kind: row[kind] for kind in KINDS if kind in row} for row in blocks.values()]
    entry = {
        "command": "make coverage",
        "date": datetime.date.today().isoformat(),
        "total": f"coverage: {summary(kinds)} in {len(blocks)} blocks",
        "blocks": blocks,
    }
    RECORD.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(entry, indent=1)
    RECORD.write_text(re.sub(r"\[\s+(\d+),\s+(\d+),\s+(\d+)\s+\]", r"[\1, \2, \3]", text) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK", help="without msn_; all if none is named")
    parser.add_argument("--no-run", action="store_true", help="judge the counts of the run before")
    parser.add_argument("--record", action="store_true", help=f"merge into {RECORD.relative_to(ROOT)}")
    parser.add_argument("--long", action="store_true", help="with the tests of `make test-long`")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    strange = [name for name in arguments.blocks if name not in BLOCKS]
    if strange:
        print(f"no block {strange[0]} in rtl/rtl.f")
        sys.exit(2)
    passed = arguments.no_run or run(arguments.blocks, arguments.long, arguments.jobs)
    wanted = arguments.blocks or ["*"]
    paths = sorted(path for name in wanted for path in COUNTS.glob(f"{name}/*.dat"))
    traced = "*" if arguments.no_run else "-".join(arguments.blocks) or "*"
    traces = sorted(TRACES.glob(f"{traced}/data*"))
    if not paths or not traces:
        sys.exit("coverage: nothing was counted")
    texts = {}
    merged = points.merge(paths, lambda path: texts.setdefault(path, path.read_text().splitlines()))
    points.merge_twins(traces, merged)
    waivers = tomllib.loads(points.WAIVERS.read_text())["waiver"]
    blocks = arguments.blocks or [*BLOCKS, *sorted(name for name in merged if "/" in name)]
    rows, holes, faults = points.judge(merged, waivers, blocks)
    print(f"{'block':20}" + "".join(f"{kind:>19}" for kind in KINDS))
    for name, row in rows.items():
        cells = (f"{percent(hit, some)} {hit:>5}/{some:<5}" for hit, some, _ in row.values())
        print(f"{name:20}" + "".join(f"{cell:>19}" for cell in cells))
    for line in (*holes, *faults):
        print(line)
    if arguments.record and passed:
        record(rows)
    if not passed or holes or faults:
        sys.exit(
            f"coverage: {len(holes)} holes, {len(faults)} faulty waivers"
            + ("" if passed else ", tests failed")
        )
    print(f"coverage: no hole in {len(rows)} blocks")


if __name__ == "__main__":
    main()
