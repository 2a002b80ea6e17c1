"""Run all kinds of evidence again, then write docs/trust.md and README's paragraph about them.

    python tools/trust.py              every kind (hours), each recorded in docs/trust/<kind>.json
    python tools/trust.py faults       some kinds
    python tools/trust.py --due        only blocks whose evidence is missing or stale, changed blocks first,
                                       for 15 minutes [--minutes 90]; prints how many runs are left
    python tools/trust.py --due --list only list these runs, with the CPU seconds that they took last time
    python tools/trust.py --page       only write the pages from the records

Each kind has its own tools, which take --record. Exit code 1 if one of them failed. Evidence is shown as
stale if the digest of what it rests on (verify/revision.py) has changed since its record.
"""

import argparse
import importlib
import json
import subprocess
import sys
from collections.abc import Callable
from typing import NamedTuple

from meissner.builds import toolchain
from verify import benches, evidence, faults, formal, mutants_page, readme, record, sums
from verify import due as due_of

ROOT = toolchain.ROOT
PAGE = ROOT / "docs/trust.md"
README = ROOT / "README.md"
MARK = "Evidence: "  # the beginning of README's paragraph
KINDS = {  # {kind: its name}; a kind without a name has no column in the table of blocks
    "formal": "proofs",
    "mutants": "mutants",
    "coverage": "coverage",
    "faults": "faults",
    "equivalence": "netlist and reset",
}


class Step(NamedTuple):
    """One run of a tool for a kind of evidence."""

    kind: str
    command: str  # in tools/
    blocks: Callable[[], list[str]]  # the blocks that it gives evidence for
    jobs: bool = True  # whether it takes --jobs
    done: Callable[[dict], bool] = bool  # whether a block's facts contain its result


def proven():
    return sorted({proof.block for proof in formal.proofs().values()})


def broken(facts):
    """Whether all proofs in these facts have been tried on mutants."""
    return all("mutants" in row for row in facts.get("proofs", {}).values())


STEPS = (
    Step("formal", "formal.py", proven),
    Step("formal", "formal.py --mutants 50", proven, done=broken),
    Step("mutants", "mutants.py", benches.blocks),
    Step("coverage", "cover.py", benches.blocks),
    Step("faults", "faults.py", faults.blocks, jobs=False),
    Step("equivalence", "equivalence.py", benches.blocks),
)
STALE = "stale"
MINUTES = 15  # default of --due --minutes
WRITERS = {  # {kind: the module with its ``total``}, if that is not the tool with the kind's name
    **{"mutants": "verify.mutants_page", "coverage": "cover", "faults": "verify.faults"},
}
FAILED = {  # {kind: whether a block's facts contain a failure}
    "formal": lambda facts: any(row.get("failed") for row in facts["proofs"].values()),
    "coverage": lambda facts: sums.points([facts]).hit < sums.points([facts]).reachable,
    "faults": lambda facts: facts["silent"],
    "equivalence": lambda facts: not all(facts[key]["proven"] for key in sums.CELLS if key in facts),
}
BOXES = f"with {readme.BOXES}"
HEAD = """# Trust

`make trust` runs all the evidence and writes this page; `python tools/trust.py --page` writes it from the
records in docs/trust/. Each entry of a record has a digest, and is **stale** if the digest has changed
since. The digest contains

- the RTL of the block and of the blocks inside it, without comments;
- what the block's test states for the kind (`EVIDENCE`);
- for mutants, coverage and faults: the block's test, the files of tb/ that it
  imports, and the twin; for coverage also the block's other tests, its exclusions and its cover points;
- for proofs: the harnesses and their entries in tb/formal/proofs.toml;
- for faults: the driver and the converter models; for netlists: the models and maps of cells for Yosys;
- the pinned versions of Verilator, cocotb, Yosys, the solvers, NumPy and mcap, as far as the kind uses them.

It does not contain the code of the evidence tools themselves (except the files just named), nor the versions
of slang (pyslang), Python and the C++ compiler. After a change of these, run the kind again by its command.

A changed block also makes the evidence of the blocks around it stale, since they are simulated, proven and
fault-injected together with it. `make trust TRUST=--due` runs what is stale or missing, for at most
15 minutes (90 with `TRUST="--due --minutes 90"`). It begins with the changed blocks, those that contain no
other stale block, then runs the blocks around them; in each group the slowest run comes last. Evidence that
was not reached stays stale.
"""


def records():
    """{kind: the contents of docs/trust/<kind>.json}, for the kinds that are recorded."""
    paths = {kind: record.FOLDER / f"{kind}.json" for kind in KINDS}
    return {kind: json.loads(path.read_text()) for kind, path in paths.items() if path.exists()}


def split(told, kind):
    """([facts of the blocks whose evidence is current], [names of the blocks whose evidence is stale])."""
    before = record.stale(told, kind)
    return [facts for name, facts in told["blocks"].items() if name not in before], before


def failures(kind, told):
    """Names of the blocks whose current evidence of the kind is that something failed."""
    before = record.stale(told, kind)
    bad = FAILED.get(kind, lambda facts: False)
    return [name for name, facts in told["blocks"].items() if name not in before and bad(facts)]


def total(kind, told):
    """A kind's sentence: of the blocks with current evidence, which failed, how many are stale."""
    bad = failures(kind, told)
    return _counted(kind, told) + (f"; **not passed: {', '.join(bad)}**" if bad else "")


def _counted(kind, told):
    """The sentence about the blocks with current evidence, and how many are stale and not counted."""
    current, before = split(told, kind)
    if not before:
        return told["total"]
    words = f"{len(before)} block{'s' * (len(before) > 1)} {STALE}, not counted"
    if not current:
        return f"{KINDS.get(kind) or kind}: none current ({words})"
    return f"{sentence_of(kind)(current)} ({words})"


def sentence_of(kind):
    """The function that sums up a list of blocks' facts in a sentence."""
    return importlib.import_module(WRITERS.get(kind, kind)).total


def cell(kind, told, block):
    """The table's cell for a kind and a block."""
    text = told["blocks"].get(block, {}).get("summary", "")
    return f"{text} ({STALE})" if block in record.stale(told, kind) else text


def left_out(recorded):
    """{kind: sentences} on what each kind does not show, with numbers from its records."""

    def facts(kind):
        return recorded.get(kind, {"blocks": {}})["blocks"].values()

    parts = [part for row in facts("mutants") for part in mutants_page.parts(row)]
    drawn, survived = [part["mutants"] for part in parts], sum(len(part["survived"]) for part in parts)
    counts = [kind for row in facts("coverage") for kind in row.values() if isinstance(kind, list)]
    excluded = sum(left for _, _, left in counts)
    around = sum(
        any("around" in row.get(key, {}) for key in ("ecp5", "ice40")) for row in facts("equivalence")
    )
    resets = [row["reset"] for row in facts("equivalence") if "reset" in row]
    bounded = sum(not row["proven"] and bool(row.get("clocks")) for row in resets)
    unproven = sum(not row["proven"] for row in resets) - bounded
    listed = len(benches.blocks())
    return {
        "formal": f"{len(facts('formal'))} of {listed} blocks have proofs, at the parameters and under the "
        "assumptions in [formal.md](formal.md). No proof spans two blocks, except where the guarantee of one "
        "is an assumption of another.",
        "mutants": f"The mutants are a sample: {min(drawn, default=0)} to {max(drawn, default=0)} of each "
        f"kind for a block. {survived} survived; [mutants.md](mutants.md) lists them.",
        "coverage": f"{excluded:,} points are excluded, each with a reason in tb/coverage/waivers.toml. A "
        "test reached each covered point, but need not have checked it.",
        "faults": "One fault at a time is injected, at sampled places and clocks "
        "([faults.md](faults.md)). Until a block has recovered, its data may be wrong and unreported.",
        "equivalence": f"The netlists are proven {BOXES}: block RAM, LUT RAM and DSP cells are only "
        f"simulated. In {around} blocks inner blocks are black boxes; each has its own proof, not always "
        "with the same parameters. Each block is proven with one set of parameters; place and route is not "
        f"covered. For {bounded} blocks the reset is shown for a limited number of clocks only, for "
        f"{unproven} it is open ([equivalence.md](equivalence.md)).",
    }


def page(recorded):
    """docs/trust.md as text."""
    columns = [kind for kind in KINDS if KINDS[kind] and kind in recorded]
    lines = [HEAD, "| kind | all blocks | command | recorded |", "|---" * 4 + "|"]
    for kind, told in recorded.items():
        words = KINDS[kind] or kind, total(kind, told), f"`{told['command']}`", told["date"]
        lines.append(f"| {' | '.join(words)} |")
    lines += ["", "## What the evidence does not show", ""]
    limits = left_out(recorded)
    lines += [f"- **{(KINDS[kind] or kind).capitalize()}**: {limits[kind]}" for kind in recorded]
    lines += ["", "## Blocks", "", "In the order of rtl/rtl.f. An empty cell: no evidence of that kind.", ""]
    lines.append("| block | " + " | ".join(KINDS[kind] for kind in columns) + " |")
    lines.append("|---" * (len(columns) + 1) + "|")
    for block in benches.blocks():
        cells = [cell(kind, recorded[kind], block) for kind in columns]
        lines.append("| " + " | ".join([block, *cells]) + " |")
    return "\n".join(lines) + "\n"


def summary(recorded):
    """README's paragraph, on one line."""
    found = {kind: split(recorded.get(kind, {"blocks": {}}), kind) for kind in readme.KINDS}
    current = {kind: facts for kind, (facts, _) in found.items()}
    bad = {KINDS[kind] or kind: failures(kind, told) for kind, told in recorded.items()}
    return MARK + readme.paragraph(current, {kind: len(before) for kind, (_, before) in found.items()}, bad)


def strangers(recorded):
    """A sentence for each recorded block that does not exist."""
    known = set(benches.blocks())
    return [
        f"docs/trust/{kind}.json has {name}, which rtl/rtl.f does not list"
        for kind, told in recorded.items()
        if KINDS[kind]
        for name in sorted(set(told["blocks"]) - known)
    ]


def due(step):
    """The blocks for which the evidence of ``step`` is missing or stale."""
    told = records().get(step.kind, {"blocks": {}})
    kept = {name for name, facts in told["blocks"].items() if step.done(facts)}
    kept -= set(record.stale(told, step.kind))
    return [name for name in step.blocks() if name not in kept]


def due_pieces(kinds):
    """The runs that are due, in order."""
    listed = [(step, due(step)) for step in STEPS if step.kind in kinds]
    return due_of.pieces(listed, records())


def run_due(kinds, jobs, minutes):
    """Run what is due for so many minutes (0: until all is done); a sentence for each failed run."""
    failed = []

    def one(piece, rest):
        told = command_of(piece.step, [piece.block], jobs)
        print("==", *told, flush=True)
        code = due_of.limited(told, rest)
        if code:
            failed.append(f"{' '.join(told[:-1])} failed")
        if code is None:
            failed.append(f"{' '.join(told)} did not end in time")

    left = due_of.within(due_pieces(kinds), 60 * minutes or None, one)
    if left:
        words = f"{left[0].step.kind} of {left[0].block}"
        print(f"{len(left)} runs are still due, from {words} on: their evidence stays stale or missing")
    return failed


def command_of(step, names, jobs):
    """The words of a step's command for the blocks ``names``; for all blocks if the list is empty."""
    return f"tools/{step.command}".split() + names + ["--record"] + step.jobs * ["--jobs", str(jobs)]


def run(step, names, jobs):
    """Run ``step`` for the blocks ``names``, or for all; a list with a sentence if it failed."""
    command = command_of(step, names, jobs)
    print("==", *command, flush=True)
    failed = subprocess.run([sys.executable, *command], cwd=ROOT).returncode
    return [f"{' '.join(command)} failed"] if failed else []


def write(recorded):
    PAGE.write_text(page(recorded))
    lines = README.read_text().splitlines()
    [place] = [i for i, line in enumerate(lines) if line.startswith(MARK)]
    README.write_text("\n".join([*lines[:place], summary(recorded), *lines[place + 1 :]]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--due", action="store_true", help="only what is missing or stale")
    parser.add_argument("--minutes", type=float, help="of --due; 0: until all is done")
    parser.add_argument("--list", action="store_true", help="of --due: run nothing")
    parser.add_argument("--page", action="store_true", help="run nothing")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    if unknown := sorted(set(options.kinds) - set(KINDS)):
        parser.exit(2, f"trust: there is no {unknown[0]}; there are {', '.join(KINDS)}\n")
    if refusal := evidence.refusal([]):
        parser.exit(2, f"trust: {refusal}\n")
    if not options.due and (options.list or options.minutes is not None):
        parser.exit(2, "trust: --minutes and --list are of --due\n")
    failed, kinds = [], options.kinds or KINDS
    if options.list:
        for piece in due_pieces(kinds):
            rank = "around what is stale" if piece.around else ""
            print(f"{piece.step.command:26} {piece.block:20} {piece.seconds:6.0f} s {rank}".rstrip())
        return
    if options.due:
        failed += run_due(kinds, options.jobs, MINUTES if options.minutes is None else options.minutes)
    for step in () if options.page or options.due else STEPS:
        if step.kind in kinds:
            failed += run(step, [], options.jobs)
    recorded = records()
    failed += [f"{kind} was never recorded" for kind in KINDS if kind not in recorded]
    failed += strangers(recorded)
    write(recorded)
    print(summary(recorded))
    if failed:
        sys.exit("\n".join(failed))


if __name__ == "__main__":
    main()
