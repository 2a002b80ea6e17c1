"""All the evidence, one command: run each kind anew, then write docs/trust.md and README's line.

    python tools/trust.py              every kind (hours), each recorded in docs/trust/<kind>.json
    python tools/trust.py faults       some kinds
    python tools/trust.py --page       only the pages, from what is recorded

A kind is a tool of its own, tools/<kind>.py, that takes --record. Exit code 1 if one of them failed. What was
recorded before a block's RTL changed is told as of an earlier revision.
"""

import argparse
import json
import subprocess
import sys

from meissner import toolchain
from meissner.trust import benches, record

ROOT = toolchain.ROOT
PAGE = ROOT / "docs/trust.md"
README = ROOT / "README.md"
MARK = "Evidence: "  # how README's line begins
KINDS = {  # of the table's columns; the others are lines below it
    "formal": "proofs",
    "mutants": "mutants",
    "coverage": "coverage",
    "powerup": "power-up",
    "faults": "faults",
    "equivalence": "netlist and reset",
    "regress": "random regression",
    "fuzz": None,
}
TOOLS = {"coverage": "cover"}  # of another name: tools/coverage.py would hide the package
EARLIER = "of an earlier revision"
HEAD = """# Trust

One row for each block of rtl/rtl.f, in data-path order; an empty cell means that there is nothing of that
kind. Written by `make trust`, which runs everything, or by `python tools/trust.py --page` from what
docs/trust/ has recorded. "Of an earlier revision": the RTL of the block, or of one in it, has changed since.
"""


def records():
    """{kind: what docs/trust/<kind>.json says} of the kinds that are recorded."""
    paths = {kind: record.FOLDER / f"{kind}.json" for kind in KINDS}
    return {kind: json.loads(path.read_text()) for kind, path in paths.items() if path.exists()}


def total(told):
    """A kind's sentence of all blocks."""
    before = len(record.earlier(told))
    return told["total"] + (f" ({before} block{'s' * (before > 1)} {EARLIER})" if before else "")


def cell(told, block):
    """What a kind tells of a block."""
    text = told["blocks"].get(block, {}).get("summary", "")
    return f"{text} ({EARLIER})" if block in record.earlier(told) else text


def page(recorded):
    """docs/trust.md as text."""
    columns = [kind for kind in KINDS if KINDS[kind] and kind in recorded]
    lines = [HEAD, "| kind | all blocks | command | of |", "|---" * 4 + "|"]
    for kind, told in recorded.items():
        lines.append(f"| {KINDS[kind] or kind} | {total(told)} | `{told['command']}` | {told['date']} |")
    lines += ["", "| block | " + " | ".join(KINDS[kind] for kind in columns) + " |"]
    lines.append("|---" * (len(columns) + 1) + "|")
    for block in benches.blocks():
        lines.append("| " + " | ".join([block, *(cell(recorded[kind], block) for kind in columns)]) + " |")
    return "\n".join(lines) + "\n"


def summary(recorded):
    """README's line, one paragraph."""
    totals = "; ".join(map(total, recorded.values()))
    return f"{MARK}{totals} ([docs/trust.md](docs/trust.md), `make trust`)."


def strangers(recorded):
    """Sentences: what is recorded of blocks that are not there."""
    known = set(benches.blocks())
    return [
        f"docs/trust/{kind}.json has {name}, which rtl/rtl.f does not list"
        for kind, told in recorded.items()
        if KINDS[kind]
        for name in sorted(set(told["blocks"]) - known)
    ]


def write(recorded):
    PAGE.write_text(page(recorded))
    lines = README.read_text().splitlines()
    [place] = [i for i, line in enumerate(lines) if line.startswith(MARK)]
    README.write_text("\n".join([*lines[:place], summary(recorded), *lines[place + 1 :]]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--page", action="store_true", help="run nothing")
    options = parser.parse_args()
    if unknown := sorted(set(options.kinds) - set(KINDS)):
        parser.exit(2, f"trust: there is no {unknown[0]}; there are {', '.join(KINDS)}\n")
    failed = []
    for kind in [] if options.page else options.kinds or KINDS:
        print(f"== {kind}", flush=True)
        command = [sys.executable, f"tools/{TOOLS.get(kind, kind)}.py", "--record"]
        if subprocess.run(command, cwd=ROOT).returncode:
            failed.append(f"{kind} failed")
    recorded = records()
    failed += [f"{kind} was never recorded" for kind in KINDS if kind not in recorded]
    failed += strangers(recorded)
    write(recorded)
    print(summary(recorded))
    if failed:
        sys.exit("\n".join(failed))


if __name__ == "__main__":
    main()
