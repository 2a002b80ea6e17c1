"""Write docs/tradeoff.md, its pictures and the record that `meissner choose` reads, from a finished sweep.

meissner tradeoff --out results/tradeoff         the sweep: about a quarter of an hour on two idle cores
python tools/tradeoff_page.py results/tradeoff        the page, docs/tradeoff/*.png and the package's record
"""

import argparse
import datetime
import json
import os
import shutil
from pathlib import Path

from meissner.builds.toolchain import ROOT
from meissner.tradeoff import page, sweep, table
from meissner.tradeoff.command import RECORD

PAGE, PICTURES = ROOT / "docs/tradeoff.md", ROOT / "docs/tradeoff"
ROWS = 14  # per table of the page
BEGIN = "<!-- from here on written by tools/tradeoff_page.py -->"


def cells(axis, rows):
    """(rows of an axis for the page, their number before thinning out): the front, evenly thinned out to
    ROWS, and the shipped point."""
    found = page.table(axis, rows, command=False)
    every = -(-len(found) // ROWS) if axis.judged else 1
    return [row for at, row in enumerate(found) if at % every == 0 or row.get("ships")], len(found)


def markdown(rows):
    """Rows of {column: value} as a Markdown table."""
    keys = list(rows[0])
    text = lambda value: {True: "yes", False: "**no**", None: "–"}.get(value, str(value))
    lines = [f"| {' | '.join(keys)} |", f"|{'---|' * len(keys)}"]
    return "\n".join([*lines, *(f"| {' | '.join(text(row[key]) for key in keys)} |" for row in rows)])


def section(axis, rows, quick):
    shown, count = cells(axis, rows)
    told = f"{len(shown)} of {count} rows. " if len(shown) < count else ""
    again = f"`meissner tradeoff{' --quick' * quick} --axis {axis.name}`"
    parts = [
        f"## {axis.title}",
        f"{again}: {page.verdict(axis, rows)}.",
        f"![{axis.title}: every point, the front and the shipped point](tradeoff/{axis.name}.png)",
        f"{told}Columns with one value in all rows are left out.",
        markdown(shown),
    ]
    return "\n\n".join(parts)


def record(results):
    """The record for `meissner choose`: the front and the shipped point of each axis."""
    kept = {}
    for name, entry in results.items():
        points = [row for row in entry["points"] if row["front"] or row["shipped"]]
        kept[name] = entry | {"points": points}
    return kept


def write(folder):
    results = sweep.read(folder)
    axes = [axis for axis in table.every().values() if axis.name in results]
    rows = {axis.name: results[axis.name]["points"] for axis in axes}
    quick = any(results[axis.name]["quick"] for axis in axes)
    PICTURES.mkdir(exist_ok=True)
    for axis in axes:
        shutil.copyfile(Path(folder) / f"{axis.name}.png", PICTURES / f"{axis.name}.png")
    count = sum(map(len, rows.values()))
    said = f"Measured on {datetime.date.today()}, {count} points, `meissner tradeoff{' --quick' * quick}`"
    said += f" on {len(os.sched_getaffinity(0))} cores."
    parts = [PAGE.read_text("utf-8").split(BEGIN)[0].strip(), BEGIN, said]
    parts += [f"{line}." for line in page.not_placed(axes, rows)]
    parts += [section(axis, rows[axis.name], results[axis.name]["quick"]) for axis in axes]
    PAGE.write_text("\n\n".join(parts) + "\n", "utf-8")
    RECORD.write_text(json.dumps(record(results), indent=None, separators=(",", ":")) + "\n", "utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="results of `meissner tradeoff`")
    write(parser.parse_args().folder)


if __name__ == "__main__":
    main()
