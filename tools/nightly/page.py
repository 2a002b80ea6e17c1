"""The page of a nightly run, build/evidence/index.html: one file, readable on a desktop and on a phone."""

import datetime
import html
import subprocess

from meissner.builds import toolchain

STYLE = """
:root { color-scheme: light dark; --line: #8884; --bad: #c5221f; --good: #1e7e34; --late: #b06000; }
@media (prefers-color-scheme: dark) { :root { --bad: #ff7b72; --good: #56d364; --late: #e3b341; } }
body { font: 15px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 75rem; padding: 1rem; }
h1 { font-size: 1.4rem; margin: 0; } h2 { font-size: 1.1rem; margin: 2rem 0 .5rem; }
.of { opacity: .75; overflow-wrap: anywhere; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid var(--line); padding: .3rem .7rem .3rem 0; }
th, td { text-align: left; vertical-align: top; }
td.number, th.number { text-align: right; }
.bad { color: var(--bad); } .good { color: var(--good); } .late { color: var(--late); }
li, .blocks td { overflow-wrap: anywhere; } ul { padding-left: 1.2rem; } code { font-size: .9em; }
small { opacity: .75; }
@media (max-width: 45rem) {
  .blocks thead { display: none; }
  .blocks tr { display: block; border-bottom: 1px solid var(--line); padding: .5rem 0; }
  .blocks td { display: block; border: 0; padding: 0; }
  .blocks td:empty { display: none; }
  .blocks td[data-kind]::before { content: attr(data-kind) ": "; opacity: .75; }
}
"""


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


def index(of, rows, limits):
    """The page; ``of``: ``heading``; ``rows``: the checks as {kind, block, facts, seconds, cpu_s}."""
    done = [row for row in rows if row["facts"]]
    broken = [row for row in done if row["facts"]["broken"]]
    left = [row for row in rows if not row["facts"]]
    asked = f"{', '.join(of['blocks']) or 'all blocks'}" + (
        f", changed since {of['since']}" if of["since"] else ""
    )
    words = f"{len(done)} checks run, {len(broken)} break a limit, {len(left)} not reached"
    state = "bad" if broken else "late" if left else "good"
    parts = [
        f"<h1>Nightly checks: <span class={state}>{words}</span></h1>",
        f"<p class=of>{text(of['date'])}, commit <code>{text(of['commit'])}</code>"
        f"{' with changes that are not committed' if of['changed'] else ''}; {text(asked)}; "
        f"limits: tb/limits.toml; what each kind shows and does not show: docs/verification.md</p>",
    ]
    if of["shared"]:
        parts.append(f"<p class=late>{text(untouched(of['shared']))}</p>")
    if broken:
        lists = "".join(f"<li>{one(row)}{bullets(row['facts']['broken'])}</li>" for row in broken)
        parts.append(f"<h2 class=bad>Limits broken</h2><ul>{lists}</ul>")
    if left:
        parts.append(f"<h2 class=late>Not reached</h2><p>{', '.join(map(one, left))}</p>")
    parts += ["<h2>Kinds</h2>", kinds(rows), "<h2>Blocks</h2>", blocks(rows), "<h2>Exceptions in force</h2>"]
    parts.append(exceptions(limits.table))
    title = f"Nightly: {words}"
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{text(title)}</title>"
        f'<meta name=viewport content="width=device-width, initial-scale=1"><style>{STYLE}</style>'
        + "\n".join(parts) + "</html>\n"
    )  # fmt: skip


def text(words):
    return html.escape(str(words))


def one(row):
    return f"{row['kind']} of <code>{text(row['block'])}</code>"


def bullets(lines):
    more = f"<li>and {len(lines) - 40} more</li>" if len(lines) > 40 else ""
    return "<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines[:40]) + more + "</ul>"


def kinds(rows):
    """The table of kinds; a kind that was not asked for has no row."""
    lines = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        done = [row for row in own if row["facts"]]
        bad = sum(bool(row["facts"]["broken"]) for row in done)
        numbers = [
            len(done),
            bad,
            len(own) - len(done),
            *(round(sum(row[key] for row in own)) for key in TIMES),
        ]
        lines.append(
            f"<tr><td>{kind}</td>" + "".join(f"<td class=number>{n:,}</td>" for n in numbers) + "</tr>"
        )
    heads = ("run", "broken", "not reached", "seconds", "CPU s")
    head = "<th>kind</th>" + "".join(f"<th class=number>{name}</th>" for name in heads)
    return f"<div class=scroll><table><tr>{head}</tr>{''.join(lines)}</table></div>"


TIMES = ("seconds", "cpu_s")


def blocks(rows):
    """The table of blocks."""
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    known = {(row["kind"], row["block"]): row for row in rows}
    lines = []
    for block in sorted({row["block"] for row in rows}):
        cells = "".join(f'<td data-kind="{kind}">{cell(known.get((kind, block)))}</td>' for kind in kinds)
        lines.append(f"<tr><td><code>{text(block)}</code></td>{cells}</tr>")
    head = "".join(f"<th>{name}</th>" for name in ("block", *kinds))
    table = f"<table class=blocks><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"
    return f"<div class=scroll>{table}</div>"


def cell(row):
    if row is None:
        return ""
    if not row["facts"]:
        return "<span class=late>not reached</span>"
    state, said = ("bad", "broken") if row["facts"]["broken"] else ("good", "ok")
    took = f"<small>{row['seconds']:.0f} s</small>"
    return f"<span class={state}>{said}</span> {text(row['facts']['text'])} {took}"


def exceptions(table):
    """What tb/limits.toml excuses, with the reasons."""
    lines = []
    for kind, entry in table.items():
        for name, listed in entry.items():
            for row in listed if isinstance(listed, list) else ():
                values = [value for key, value in row.items() if key != "reason"]
                said = ", ".join(
                    ", ".join(value) if isinstance(value, list) else str(value) for value in values
                )
                lines.append(f"<li>{kind}, {name}: <code>{text(said)}</code>: {text(row['reason'])}</li>")
    waived = sum(table["coverage"]["waived"].values())
    lines.append(
        f"<li>coverage: up to {waived:,} points waived, with the reasons in tb/coverage/waivers.toml</li>"
    )
    return f"<ul>{''.join(lines)}</ul>"
