"""The page of a nightly run, build/evidence/index.html: one file, readable on a desktop and on a phone."""

import datetime
import subprocess

import numpy as np

from meissner.builds import toolchain
from meissner.report.page import write_html


def heading(kinds, blocks, since, shared):
    """What a run is of."""
    git = ["git", "log", "-1", "--format=%H %cs"]
    said = subprocess.run(git, cwd=toolchain.ROOT, capture_output=True, text=True).stdout.split()
    dirty = subprocess.run(["git", "status", "--porcelain"], cwd=toolchain.ROOT, capture_output=True).stdout
    return {
        "commit": said[0] if said else "unknown",
        "changed": bool(dirty),  # the working tree differs from the commit
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "kinds": list(kinds),
        "blocks": list(blocks),
        "since": since,
        "shared": shared,
    }


def untouched(shared):
    """The sentence about changed files that all blocks share."""
    if not shared:
        return "no changed file belongs to a block"
    names = ", ".join(shared[:5]) + (f" and {len(shared) - 5} more" if len(shared) > 5 else "")
    return (
        f"changed, but shared by all blocks and so selecting none: {names}; run the kinds concerned in full"
    )


def write(path, of, rows, limits):
    """Write the page; ``of``: ``heading``; ``rows``: the checks as {kind, block, facts, seconds, cpu_s}."""
    done = [row for row in rows if row["facts"]]
    broken = [row for row in done if row["facts"]["broken"]]
    left = [row for row in rows if not row["facts"]]
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    known = {(row["kind"], row["block"]): row for row in rows}
    tables = {
        "Limits broken": [
            {"check": name(row), "broken": line} for row in broken for line in row["facts"]["broken"]
        ],
        "Not reached": [{"check": name(row)} for row in left],
        "Kinds": [totals(kind, [row for row in rows if row["kind"] == kind]) for kind in kinds],
        "Blocks": [
            {"block": block} | {kind: cell(known.get((kind, block))) for kind in kinds}
            for block in sorted({row["block"] for row in rows})
        ],
        "Exceptions in force": exceptions(limits.table),
    }
    words = f"{len(done)} checks run, {len(broken)} break a limit, {len(left)} not reached"
    said = untouched(of["shared"]) + ". " if of["shared"] else ""
    said += "Limits: tb/limits.toml; what each kind shows and does not show: docs/verification.md"
    facts = {
        key: value or "all" if key == "blocks" else value for key, value in of.items() if key != "shared"
    }
    write_html(path, facts, (), tables, f"Nightly checks: {words}", said)


def name(row):
    return f"{row['kind']} of {row['block']}"


def totals(kind, own):
    """A row of the table of kinds; a kind that was not asked for has no row."""
    done = [row["facts"] for row in own if row["facts"]]
    counts = {"run": len(done), "broken": sum(bool(facts["broken"]) for facts in done)}
    times = {key: round(sum(row[key] for row in own)) for key in ("seconds", "cpu_s")}
    return {"kind": kind} | counts | {"not reached": len(own) - len(done)} | times


def cell(row):
    if row is None:
        return ""
    if not row["facts"]:
        return "not reached"
    return f"{'BROKEN' if row['facts']['broken'] else 'ok'}: {row['facts']['text']}, {row['seconds']:.0f} s"


def exceptions(table):
    """What tb/limits.toml excuses, with the reasons."""
    found = []
    for kind, entry in table.items():
        for key, rows in entry.items():
            for row in rows if isinstance(rows, list) else ():
                values = [value for name, value in row.items() if name != "reason"]
                said = ", ".join(str(one) for value in values for one in np.atleast_1d(value))
                found.append({"of": f"{kind}, {key}", "exception": said, "reason": row["reason"]})
    waived = f"up to {sum(table['coverage']['waived'].values()):,} points"
    return [*found, {"of": "coverage", "exception": waived, "reason": "tb/coverage/waivers.toml has them"}]
