"""The contents of docs/trust/mutants.json in words and tables. A block's entry holds the mutants of its
netlist's cells, and under "source" those of its source text; either may be missing."""

from collections import Counter

from verify import sums


def parts(found):
    """The results for the cells and for the source, as far as they exist."""
    return [part for part in (found, found.get("source", {})) if "mutants" in part]


def both(found, key):
    """The sum of a count over both kinds."""
    return sum(part.get(key, 0) for part in parts(found))


def summary(found):
    """A block's cell in docs/trust.md."""
    drawn, killed, equal = (both(found, key) for key in ("mutants", "killed", "equivalent"))
    return f"{drawn} drawn, {killed} of {drawn - equal} killed, {equal} equivalent"


def total(blocks):
    """One line that sums up all blocks."""
    told = []
    for name, some in zip(("mutants of cells", "of source"), sums.kinds(blocks)):
        if some:
            of = sums.mutants(some)
            there = "" if of.there is None else f" of {of.there:,}"
            told.append(
                f"{of.drawn:,}{there} {name} drawn in {len(some)} blocks: {of.equivalent} shown equivalent, "
                f"{of.killed:,} of the other {of.drawn - of.equivalent:,} killed by the blocks' own tests"
            )
    return "; ".join(told)


COLUMNS = ("there", "mutants", "killed", "equivalent", "survived", "score", "seconds")


def table(told):
    """The results as Markdown: a row per block (cells, then source), then the survivors."""
    heads = [name for kind in ("cells", "source") for name in (f"{kind}: possible", "drawn", *COLUMNS[2:])]
    lines = [f"| block | {' | '.join(heads)} |", "|---" + "|--:" * len(heads) + "|"]
    every = [Counter(), Counter()]
    for name, found in told["blocks"].items():
        cells = []
        for count, part in zip(every, (found, found.get("source", {}))):
            row = {k: part[k] for k in ("mutants", "killed", "equivalent", "seconds", "there") if k in part}
            if "mutants" in part:
                row["survived"] = len(part["survived"])
            count.update(row)
            cells += _cells(row)
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    lines.append("| **all** | " + " | ".join([cell for count in every for cell in _cells(count)]) + " |")
    lines += ["", "Survivors. *different*: the solver found inputs that distinguish it from the block.", ""]
    for name, found in told["blocks"].items():
        for one in [one for part in parts(found) for one in part["survived"]]:
            at = " ".join(f"{k}={v}" for k, v in one["parameters"].items()) or "defaults"
            lines.append(f"- {name} ({at}): `{one['what']}` at {one['source'] or '?'}, {one['solver']}")
    return "\n".join(lines) + "\n"


def _cells(row):
    """The cells of one kind; empty if there are no results."""
    if "mutants" not in row:
        return [""] * len(COLUMNS)
    made = row["mutants"] - row["equivalent"]
    shown = {**row, "score": f"{100 * row['killed'] / max(1, made):.1f} %"}
    return [str(shown.get(column, "")) for column in COLUMNS]
