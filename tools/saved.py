"""The time that each scene saves against a run with everything on (docs/scenes.md), recorded in
model/meissner/scenes/saved.json.

    python tools/saved.py                             list the rows that are stale or absent
    python tools/saved.py --page                      write the table of docs/scenes.md from the record
    python tools/saved.py --record ENGINE [ROW...]    measure these rows; the stale ones if none is named

A row is a scene, or a part of everything on (``full: cop_slip``, ``full: core: full``). Each row is measured
in its own process, like ``meissner run SCENE --engine E --full``, and recorded immediately with a digest of
the files it rests on: those imported and read, and the RTL that ran. ENGINE: fixed, or rtl (builds cores).
"""

import argparse
import datetime
import hashlib
import json
import re
import subprocess
import sys

import measured_figures
from meissner import engines, scenes
from meissner.builds import toolchain
from meissner.scenes import full, parts
from verify import revision

FILE = toolchain.ROOT / measured_figures.SAVED
PAGE = toolchain.ROOT / "docs/scenes.md"
ENGINES = ("fixed", "rtl")
FULL, CORE = "full: ", "core: full"
TABLE = """| scene | fixed, ms for a second | times faster | rtl, ms for a second | times faster |
|---|---|---|---|---|
"""


def rows():
    """Every row's name: the parts of everything on, then the scenes."""
    return [*(FULL + name for name, _ in full.EVERYTHING), FULL + CORE, *scenes.names()]


def load():
    return json.loads(FILE.read_text("utf-8")) if FILE.exists() else {}


def place(row):
    """The place of a row in its engine's record: (part, name)."""
    return ("full", row.removeprefix(FULL)) if row.startswith(FULL) else ("scenes", row)


def entry(told, engine, row):
    """The recorded entry of a row, or None."""
    part, name = place(row)
    return told.get(engine, {}).get(part, {}).get(name)


def own(row):
    """Files that a row does not share with other rows of its sensor."""
    name = row.removeprefix(FULL)
    if name == CORE:
        return []
    return [str(path.relative_to(toolchain.ROOT)) for path in (FILE.parent).glob(f"*/{name}.toml")]


def digest(told, row, shared):
    files = told.get("rests_on", {}).get(shared)
    return files and revision.of_files([*files, *own(row)], "scenes")


def stale(told, engine, row):
    """Whether a row's record is of another revision or missing."""
    found = entry(told, engine, row)
    return not found or not found.get("of") or found["of"] != digest(told, row, found["rests_on"])


def one(engine, row):
    """Measure a row in this process: {ms, rests_on}."""
    sys.addaudithook(measured_figures.watch)
    name = row.removeprefix(FULL)
    if name == CORE:
        ms, tops = full.core_cost(engine), ["msn_core"]
    else:
        condition = dict(full.EVERYTHING)[name] if row.startswith(FULL) else 0
        scene = scenes.load(name)
        ms = full.cost(scene, engine, condition)
        tops = [parts.FEATURES[feature].top for feature in scene.features]
    files = set(measured_figures.rests_on(None)) - {"tools/saved.py", "tools/measured_figures.py"}
    files = {file for file in files if not file.endswith(f"/{name}.toml")}
    if engine in engines.VERILATED:
        files |= {str(p.relative_to(toolchain.ROOT)) for top in tops for p in toolchain.sources_of(top)}
    return {"ms": ms, "rests_on": sorted(files)}


def record(engine, row):
    """Measure a row in another process and record it."""
    command = [sys.executable, __file__, "--one", engine, row]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    told, files = load(), found["rests_on"]
    shared = hashlib.sha256("\n".join(files).encode()).hexdigest()[:8]
    told.setdefault("rests_on", {})[shared] = files
    part, name = place(row)
    kept = {"ms": found["ms"], "on": str(datetime.date.today()), "of": digest(told, row, shared)}
    told.setdefault(engine, {}).setdefault(part, {})[name] = kept | {"rests_on": shared}
    used = {
        e["rests_on"] for each in ENGINES for r in rows() if (e := entry(told, each, r)) and e["rests_on"]
    }
    told["rests_on"] = {key: value for key, value in told["rests_on"].items() if key in used}
    FILE.write_text(json.dumps(told, indent=1, sort_keys=True) + "\n", "utf-8")
    return found["ms"]


def number(value):
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def cells(told, row, everything):
    """The cells of a row for each engine, marked where they are stale."""
    found = []
    for engine in ENGINES:
        kept = entry(told, engine, row)
        mark = " (stale)" if kept and stale(told, engine, row) else ""
        found.append(number(kept["ms"]) + mark if kept else "")
        whole, late = everything[engine]
        found.append(number(whole / kept["ms"]) + " (stale)" * (late or bool(mark)) if kept and whole else "")
    return found


def table(told):
    """Markdown table: everything on, then each scene and its ratio to everything on."""
    everything, head = {}, ["everything on"]
    for engine in ENGINES:
        every = [row for row in rows() if row.startswith(FULL)]
        kept = [entry(told, engine, row) for row in every]
        late = any(stale(told, engine, row) for row in every)
        everything[engine] = (sum(each["ms"] for each in kept) if all(kept) else None), late
        head += [number(everything[engine][0]) + " (stale)" * late if all(kept) else "", "1" * all(kept)]
    lines = [head] + [[f"`{row}`", *cells(told, row, everything)] for row in scenes.names()]
    return TABLE + "".join(f"| {' | '.join(line)} |\n" for line in lines)


def page(text, told):
    """docs/scenes.md with its table from the record."""
    found = re.subn(re.escape(TABLE) + r"(\|.*\n)+", lambda _: table(told), text)
    if found[1] != 1:
        raise ValueError(f"{PAGE.name} has {found[1]} tables of what scenes save, must have one")
    return found[0]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--record", metavar="ENGINE", choices=ENGINES)
    parser.add_argument("--one", metavar="ENGINE", choices=ENGINES, help=argparse.SUPPRESS)
    parser.add_argument("--page", action="store_true")
    parser.add_argument("rows", nargs="*", metavar="ROW")
    wanted = parser.parse_args()
    if unknown := [row for row in wanted.rows if row not in rows()]:
        parser.exit(2, f"saved: there is no row '{unknown[0]}'; there are {', '.join(rows())}\n")
    if wanted.one:
        print(json.dumps(one(wanted.one, wanted.rows[0])))
    elif wanted.record:
        told = load()
        for row in wanted.rows or [row for row in rows() if stale(told, wanted.record, row)]:
            print(f"{wanted.record} {row}: {record(wanted.record, row):g} ms", flush=True)
    elif not wanted.page:
        told = load()
        late = {engine: [row for row in rows() if stale(told, engine, row)] for engine in ENGINES}
        for engine in ENGINES:
            for row in late[engine]:
                print(f"{engine} {row}: {'stale' if entry(told, engine, row) else 'absent'}")
            print(f"{engine}: {len(late[engine])} of {len(rows())} rows stale or absent")
    if wanted.page or wanted.record:
        PAGE.write_text(page(PAGE.read_text("utf-8"), load()), "utf-8")


if __name__ == "__main__":
    main()
