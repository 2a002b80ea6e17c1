"""Write the pages of docs/papers from records: each paper's figures and tables beside ours; mark stale ones.

    python tools/papers.py                     list the stale pages
    python tools/papers.py --record [NAME...]  compute and draw them, into docs/papers/NAME.json and .png
    python tools/papers.py --page              write the pages from the records

A page is a module of tools/published with ``TITLE``; ``HEAD``, its first paragraphs; ``compute()``, which
gives a list of ``Row`` and ``Table`` in the page's order; and optionally ``draw(folder)``, which writes
pictures there and returns [(file name, caption)].
"""

import argparse
import datetime
import importlib
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from meissner.builds import toolchain
from meissner.files import written
from published import Row
from verify import revision

FOLDER = toolchain.ROOT / "docs/papers"
NAMES = tuple(sorted(path.stem for path in (toolchain.ROOT / "tools/published").glob("[!_]*.py")))
HEADER = ("figure", "what", "published", "ours", "difference", "constants of ours")


def markdown(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def page(name, record, stale):
    """A page's text."""
    module = importlib.import_module(f"published.{name}")
    parts = [f"# {module.TITLE}", module.HEAD.strip()]
    parts.append(
        f"`python tools/papers.py --record {name}` computes this page"
        + (", and what it rests on has changed since: **stale**." if stale else ".")
        + " The constants are those of [constants.md](../constants.md): *published*, *read off* a figure, or "
        "*chosen*."
    )
    rows = []
    for part in record["parts"]:
        if "figure" in part:
            rows.append([part[key] or "–" for key in Row.__dataclass_fields__])
            continue
        if rows:
            parts.append(markdown(HEADER, rows))
            rows = []
        parts += [f"## {part['title']}", *([part["text"].strip()] if part["text"] else [])]
        if part["rows"]:
            parts.append(markdown(part["header"], part["rows"]))
    if rows:
        parts.append(markdown(HEADER, rows))
    parts += [f"![{caption}]({file})\n\n{caption}" for file, caption in record["pictures"]]
    return "\n\n".join(parts) + "\n"


def stale(record):
    return record["of"] != revision.of_files(record["rests_on"], "scenes")


def load(name):
    return json.loads((FOLDER / f"{name}.json").read_text("utf-8"))


def compute(name):
    """The contents of a page and the files it rests on; its pictures are written into docs/papers."""
    import measured_figures

    sys.addaudithook(measured_figures.watch)
    module = importlib.import_module(f"published.{name}")
    parts = [asdict(part) for part in module.compute()]
    with tempfile.TemporaryDirectory() as folder:
        pictures = module.draw(Path(folder)) if hasattr(module, "draw") else []
        for file, _ in pictures:
            with written(FOLDER / file) as picture:
                picture.write((Path(folder) / file).read_bytes())
    return {"rests_on": measured_figures.rests_on(None), "parts": parts, "pictures": pictures}


def record(names):
    """Record each page in its own process, so that it rests only on its own modules."""
    for name in names:
        environment = os.environ | {"PYTHONPATH": str(toolchain.ROOT / "tools")}
        subprocess.run([sys.executable, __file__, "--alone", name], check=True, env=environment)
        print(f"{name}: docs/papers/{name}.md", flush=True)


def alone(name):
    found = compute(name)
    found = {"of": revision.of_files(found["rests_on"], "scenes"), "date": str(datetime.date.today())} | found
    with written(FOLDER / f"{name}.json") as file:
        file.write((json.dumps(found, ensure_ascii=False, indent=1) + "\n").encode())


def pages(names=NAMES):
    for name in names:
        found = load(name)
        (FOLDER / f"{name}.md").write_text(page(name, found, stale(found)), "utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help=f"of {', '.join(NAMES)}; all if none is named")
    parser.add_argument("--record", action="store_true", help="compute, record, write the pages")
    parser.add_argument("--page", action="store_true", help="write the pages from the records")
    parser.add_argument("--alone", metavar="NAME", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if strange := [name for name in options.names if name not in NAMES]:
        parser.error(f"no page {strange[0]}; there are {', '.join(NAMES)}")
    FOLDER.mkdir(exist_ok=True)
    if options.alone:
        return alone(options.alone)
    names = options.names or NAMES
    if options.record:
        record(names)
    if options.record or options.page:
        return pages(names)
    for name in names:
        if stale(load(name)):
            print(f"{name}: python tools/papers.py --record {name}")


if __name__ == "__main__":
    main()
