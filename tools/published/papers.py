"""Pages of docs/papers: each paper's figures and tables beside ours.

A page is a module of this folder with ``TITLE``; ``HEAD``, its first paragraphs; ``compute()``, which gives
its rows (tuples of HEADER's cells) and sections (Markdown) in the page's order; and optionally
``draw(folder)``, which writes pictures there and returns [(file name, caption)]. `make figures
FIGURES="rope_slip"` computes and writes one.
"""

import importlib

from meissner.builds.toolchain import ROOT
from published import markdown

FOLDER = ROOT / "docs/papers"
NAMES = ("capacitive_array", "cop_slip_and_net", "initial_slip", "optacon", "rope_slip", "shear_and_mesh")
HEADER = ("figure", "what", "published", "ours", "difference")


def page(name, heading, parts, pictures):
    """A page's text."""
    module = importlib.import_module(f"published.{name}")
    written = [f"# {module.TITLE}", heading, module.HEAD.strip()]
    written.append(
        f'`make figures FIGURES="{name}"` computes this page. [constants.md](../constants.md) has '
        "the constants of ours: where each is from, and what it affects."
    )
    rows = []
    for part in [*parts, ""]:
        if not isinstance(part, str):
            rows.append([cell or "–" for cell in part])
            continue
        if rows:
            written.append(markdown(HEADER, rows))
            rows = []
        written += [part] if part else []
    written += [f"![{caption}]({file})\n\n{caption}" for file, caption in pictures]
    return "\n\n".join(written) + "\n"


def write(name, heading):
    """Compute and write a page; returns its path."""
    module = importlib.import_module(f"published.{name}")
    parts = module.compute()
    pictures = module.draw(FOLDER) if hasattr(module, "draw") else []
    path = FOLDER / f"{name}.md"
    path.write_text(page(name, heading, parts, pictures), "utf-8")
    return str(path.relative_to(ROOT))
