"""Check blocks and solvers at and beyond the ends of their ranges against exact numbers (docs/extremes.md).

    python tools/extremes.py [--quick] [--jobs N] [--seed N] [--record] [ROW ...]     default: all rows
    python tools/extremes.py --page            the page from the record, without a run
    python tools/extremes.py --headers         write the error line into block headers where it differs
    python tools/extremes.py --elaborate [BLOCK ...]    elaborate the RTL with each pair of parameter ends

A row is a function in tb/extremes/; tools/verify/extremes.py describes its form. Stops with an error if a row
has a finding, or if nothing ran.
"""

import argparse
import json
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1] / "tb"))  # references

from meissner.builds import toolchain
from nightly import benches
from verify import elaborations, extremes, record

PAGE = toolchain.ROOT / "docs/extremes.md"
RECORD = record.FOLDER / "extremes.json"
COMMAND = "make extremes"
HEAD = """# Extremes

Each block that computes, and each solver, is tested at the ends of its range and beyond: zero, one LSB, full
scale, saturation, alternating full scale, the longest sums, the worst cancellation, wrap-around of time and
counters, the least and greatest value of each parameter and each pair of them, then random cases drawn by
hypothesis. The expected values are exact: integers, fractions and 50 digits of mpmath, computed from the
formulas of docs/ in `tb/reference/`, which imports nothing from the twins. The block's own tests show that a
twin equals its RTL bit for bit; the last column names the test that drives both. Verilator also elaborates
the RTL of each block with two or more parameters with each pair of parameter ends (`python tools/extremes.py
--elaborate`): every set that no check of the block refuses must elaborate without a warning.

`make extremes` runs everything and writes this page; `make test` runs a short form
(`tb/extremes/test_extremes.py`). An error beyond its bound, a NaN, an infinity, a NumPy warning, or a value
that should have been refused and was not is a finding. The block's header states the same bound, and a test
compares the two. A row is **stale** if its RTL, its twin, its cases or their references have changed since.

"""
SECTIONS = (("Blocks", True), ("Solvers", False))


def number(value):
    return "0" if not value else f"{value:.3g}"


def places(facts):
    """{quantity: (worst error, its bound, where)} of a row."""
    return {part: (w["error"], w["bound"], w["where"]) for part, w in facts["worst"].items()}


def summary(facts):
    """The result of a row in one cell."""
    return facts["finding"] or f"{facts['cases']} cases within their bounds"


def total(rows):
    """One sentence that sums up a list of rows."""
    wrong = sum(bool(facts["finding"]) for facts in rows)
    cases = sum(facts["cases"] for facts in rows)
    return f"{len(rows)} rows, {cases} cases, {wrong or 'no'} finding{'s' * (wrong != 1)}"


def link(test):
    path, _, name = test.partition("::")
    return f"[`{name}`](../{path})"


def table(known, blocks):
    """The Markdown table of the rows for blocks, or of the rows for solvers."""
    lines = ["| row | worst error | bound | where | cases | beyond the range | result | RTL |"]
    lines += ["|---|---|---|---|---|---|---|---|"]
    for name, row in extremes.rows().items():
        if (name in benches.blocks()) is not blocks:
            continue
        facts, result = known.get(name), "not run"
        worst = places(facts) if facts else {}
        if facts:
            result = "**finding**" if facts["finding"] else "passes"
            result += " (stale)" if facts["of"] != extremes.digest(name) else ""
        for part, bound in row.bounds.items():
            error, limit, where = worst.get(part, (0, 0, ""))
            first = part == next(iter(row.bounds))
            label = (f"`{'msn_' * blocks}{name}`" if first else "") + (f" {part}" if part else "")
            shown = "none" if row.limit(part) == 0 else bound
            if facts and limit and row.limit(part) != Fraction(repr(limit)):
                shown += f" ({number(limit)} there)"
            cells = [label, number(error) if facts else "", shown, where]
            cells += [str(facts["cases"]) if facts and first else "", row.ends if first else ""]
            cells += [result if first else "", ", ".join(map(link, row.rtl)) if first else ""]
            lines.append("| " + " | ".join(" ".join(c.split()).replace("|", "\\|") for c in cells) + " |")
    return "\n".join(lines)


def page(told):
    """docs/extremes.md as text, from the record."""
    known = told.get("blocks", {})
    text = HEAD
    if told:
        text += (
            f"`{told['command']}`, {told['date']}: {told['total']}; {told['seconds']:.0f} s of CPU time.\n"
        )
    for title, blocks in SECTIONS:
        text += f"\n## {title}\n\n{table(known, blocks)}\n"
    text += "\n## Blocks without arithmetic\n\n"
    text += "These blocks move words or join other blocks; their tests compare every word.\n\n"
    text += "| block | what it does |\n|---|---|\n"
    text += "".join(f"| `msn_{name}` | {why} |\n" for name, why in extremes.without().items())
    return text


def load():
    return json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}


def keep(done, seed):
    """Merge rows into the record and write the page."""
    import datetime

    known = {name: facts for name, facts in load().get("blocks", {}).items() if name in extremes.rows()}
    merged = known | {
        name: {"of": of} | facts | {"summary": summary(facts)} for name, (of, facts) in done.items()
    }
    ordered = {name: merged[name] for name in sorted(merged)}
    told = {"command": COMMAND, "date": str(datetime.date.today()), "seed": seed}
    told |= {"total": total([*ordered.values()]), "seconds": sum(f["seconds"] for f in ordered.values())}
    RECORD.write_text(json.dumps(told | {"blocks": ordered}, indent=1) + "\n", "utf-8")
    PAGE.write_text(page(load()), "utf-8")


def header(path, line):
    """A source's text with the error line in its header, before the line with the twin's path if any."""
    text = path.read_text("utf-8")
    lines = [each for each in text.split("\n") if not each.startswith("// Error: ")]
    head = next(at for at, each in enumerate(lines) if not each.startswith("//"))
    at = next((k for k in range(head) if re.match(r"// Model: ", lines[k])), head)
    lines.insert(at, f"// {line}")
    return "\n".join(lines)


def wrong_headers():
    """{path: corrected text} of the blocks whose header differs from their row."""
    paths = {path.stem.removeprefix("msn_"): path for path in toolchain.sources()}
    found = {}
    for name, row in extremes.rows().items():
        if name in paths:
            text = header(paths[name], row.error)
            if text != paths[name].read_text("utf-8"):
                found[paths[name]] = text
    return found


def _run(given):
    name, long, seed = given
    return name, extremes.digest(name), extremes.run(name, long, seed)


def elaborate(blocks, jobs):
    """Elaborate each block's RTL at the ends of its parameters; print a line each, exit 1 on a finding."""
    known, wrong = elaborations.ends(), []
    if unknown := [name for name in blocks if name not in known]:
        sys.exit(f"extremes: {elaborations.ENDS.name} has no block {unknown[0]}")
    names = blocks or [*known]
    with ProcessPoolExecutor(jobs) as pool:
        for name, facts in zip(names, pool.map(elaborations.elaborate, names)):
            wrong += [name] if facts["finding"] else []
            words = facts["finding"] or f"{facts['apart']} pairs that no set may have"
            print(f"{name:20} {facts['taken']:4} read, {facts['refused']:3} refused  {words}", flush=True)
    print(f"{len(names)} blocks at the ends of their parameters, {len(wrong) or 'no'} findings")
    if wrong:
        sys.exit(f"extremes: there are findings in {', '.join(wrong)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("rows", nargs="*", metavar="ROW")
    parser.add_argument("--quick", action="store_true", help="the short form of make test")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", action="store_true", help=f"into {RECORD.name} and docs/{PAGE.name}")
    parser.add_argument("--page", action="store_true", help="write the page only")
    parser.add_argument("--headers", action="store_true", help="write the headers' lines only")
    parser.add_argument("--elaborate", action="store_true", help="the RTL at the ends of its parameters only")
    given = parser.parse_args()
    if given.elaborate:
        elaborate(given.rows, given.jobs)
        return
    if given.page:
        PAGE.write_text(page(load()), "utf-8")
        return
    if given.headers:
        for path, text in wrong_headers().items():
            path.write_text(text, "utf-8")
            print(path.relative_to(toolchain.ROOT))
        return
    if unknown := [name for name in given.rows if name not in extremes.rows()]:
        parser.exit(2, f"extremes: there is no row {unknown[0]}; there are {', '.join(extremes.rows())}\n")
    if not given.rows:
        extremes.without()  # ValueError for a block that has no row
    done, names = {}, given.rows or [*extremes.rows()]
    tasks = [(name, not given.quick, given.seed) for name in names]
    with ProcessPoolExecutor(given.jobs) as pool:
        for name, of, facts in pool.map(_run, tasks):
            done[name] = of, facts
            words = facts["finding"] or "; ".join(
                f"{part} {number(e)} of {number(b)}".strip() for part, (e, b, _) in places(facts).items()
            )
            print(f"{name:20} {facts['cases']:8} cases {facts['seconds']:7.1f} s  {words}", flush=True)
    facts = [each for _, each in done.values()]
    print(total(facts))
    if given.record:
        if given.quick:
            parser.exit(2, "extremes: only the long form is recorded\n")
        keep(done, given.seed)
    if not sum(each["cases"] for each in facts):
        sys.exit("extremes: nothing ran")
    if any(each["finding"] for each in facts):
        sys.exit("extremes: there are findings")


if __name__ == "__main__":
    main()
