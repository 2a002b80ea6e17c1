"""Run the blocks' own tests with registers that power up with random values.

    python tools/powerup.py [--seeds 20] [--jobs 2] [--record] [BLOCK ...]

Each block starts ``--seeds`` times, each time with other values; the builds of its tests share the seeds
(tb/runner.py, ``powerups``). A register that needs a reset and has none makes a test fail. Exits 1 if a test
fails, or if a block has no test that simulates it.
"""

import argparse
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

from meissner.builds import toolchain
from nightly import benches, evidence
from verify import record

ROOT = toolchain.ROOT


def builds(path):
    """The tests in a file that simulate its block."""
    text = path.read_text()
    bodies = re.split(r"^def ", text, flags=re.M)[1:]
    functions = [body.split("(")[0] for body in bodies if "bench.run(" in body and body.startswith("test_")]
    # pyproject.toml sets -q, which lists one name per line; a second -q would print only their count.
    command = [sys.executable, "-m", "pytest", "-p", "no:xdist", "--collect-only"]
    command += ["-m", "not long and not big"]
    done = subprocess.run([*command, str(path)], cwd=ROOT, capture_output=True, text=True)
    names = [line for line in done.stdout.splitlines() if "::" in line]
    return [name for name in names if name.split("::")[1].split("[")[0] in functions]


def start(block, seeds):
    """Start a block ``seeds`` times; {"builds", "seeds", "passed"}."""
    path = ROOT / f"tb/{benches.stage_of(block)}/test_{block}.py"
    tests = builds(path)
    if not tests:
        return {"builds": 0, "seeds": 0, "passed": False}
    each = -(-seeds // len(tests))
    command = [sys.executable, "-m", "pytest", "-p", "no:xdist", *tests]
    passed = (
        subprocess.run(command, cwd=ROOT, env={**os.environ, "MEISSNER_POWERUP": str(each)}).returncode == 0
    )
    count = each * len(tests)
    return {"builds": len(tests), "seeds": count, "passed": passed}


def summary(row):
    """A block's cell in docs/trust.md."""
    return f"{row['seeds']} starts" if row["passed"] else "failed" if row["builds"] else "no test"


def total(rows):
    some, good = (sum(row[key] for row in rows) for key in ("seeds", "passed"))
    return f"power-up: {some:,} random starts, {good} of {len(rows)} blocks pass"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK", help="without msn_; all if none is named")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=2, help="blocks at a time")
    parser.add_argument("--record", action="store_true", help="into docs/trust/powerup.json")
    arguments = parser.parse_args()
    refusal = evidence.refusal(arguments.blocks)
    if refusal or arguments.seeds < 1:
        parser.exit(2, f"powerup: {refusal or '--seeds must be 1 or more'}\n")
    blocks = arguments.blocks or benches.blocks()
    rows = {}
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for block, row in zip(blocks, pool.map(lambda name: start(name, arguments.seeds), blocks)):
            rows[block] = row
            print(f"{block:20} {row['builds']:3} builds {row['seeds']:4} seeds", flush=True)
            if arguments.record:
                own = {block: row}, summary, total
                record.merge("powerup", "make powerup", *own, listed=benches.blocks())
    failed = [name for name, row in rows.items() if not row["passed"]]
    if failed:
        sys.exit(f"powerup: failed: {', '.join(failed)}")
    print(f"powerup: {len(rows)} blocks, none failed")


if __name__ == "__main__":
    main()
