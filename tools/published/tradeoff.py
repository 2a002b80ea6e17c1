"""Write docs/tradeoff.md, its pictures and the record that `meissner choose` reads:
`make figures FIGURES="tradeoff"`, a quarter of an hour on two idle cores. The sweep is in build/tradeoff.
"""

import json
import shutil

from meissner import pool
from meissner.builds.toolchain import ROOT
from meissner.tradeoff import page, sweep, table
from meissner.tradeoff.command import RECORD
from version import VERSION

PAGE, PICTURES = ROOT / "docs/tradeoff.md", ROOT / "docs/tradeoff"
ROWS = 14  # per table of the page
BEGIN = "<!-- from here on measured: make figures -->"
FOLDER = ROOT / "build/tradeoff"


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


def section(axis, rows):
    shown, count = cells(axis, rows)
    told = f"{len(shown)} of {count} rows. " if len(shown) < count else ""
    parts = [
        f"## {axis.title}",
        f"`meissner tradeoff --axis {axis.name}`: {page.verdict(axis, rows)}.",
        f"![{axis.title}: every point, the front and the shipped point](tradeoff/{axis.name}.png)",
        f"{told}Columns with one value in all rows are left out.",
        markdown(shown),
    ]
    return "\n\n".join(parts)


def record(results):
    """The record for `meissner choose`: every point of the axis slip, which alone it does not measure itself,
    with the judged figures. A front would lack points that are best behind one converter only."""
    judged = table.named("slip").judged
    of = lambda found: {key: found[key] for key in judged if key in found}
    points = [
        {"point": row["point"], "cost": of(row["cost"]), "error": of(row["error"])}
        for row in results["slip"]["points"]
    ]
    return {"slip": {"points": points}}


def text(before, heading, axes, rows):
    """The page's text; what stands above ``BEGIN`` stays."""
    said = f"{sum(map(len, rows.values()))} points, `meissner tradeoff`."
    parts = [before.partition(BEGIN)[0].strip(), BEGIN, heading, said]
    return "\n\n".join([*parts, *(section(axis, rows[axis.name]) for axis in axes)]) + "\n"


def write(heading):
    """Sweep every axis and write the page, its pictures and the record; returns the page's path."""
    axes = list(table.every().values())
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = sweep.run(axes, FOLDER, workers=pool.cores())
    page.write(FOLDER, axes, rows, {})
    PICTURES.mkdir(exist_ok=True)
    for axis in axes:
        shutil.copyfile(FOLDER / f"{axis.name}.png", PICTURES / f"{axis.name}.png")
    PAGE.write_text(text(PAGE.read_text("utf-8"), heading, axes, rows), "utf-8")
    found = {"version": VERSION, "figures": record(sweep.read(FOLDER))}
    RECORD.write_text(json.dumps(found, separators=(",", ":")) + "\n", "utf-8")
    return str(PAGE.relative_to(ROOT))
