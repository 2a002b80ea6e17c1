"""The site of `make docs`: the pages of this folder, and the sources they link to as pages beside them.

Pages link to sources by relative path, as a forge shows them. `to_sources` turns such a link into one to
``src/PATH.html``, which `write_sources` writes at the end: the site needs no forge. Warnings are errors.
"""

import os
import posixpath
import re
from pathlib import Path

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound

import meissner
from meissner import scenes

ROOT = Path(__file__).parent.parent
PICTURES = ROOT / "build/gallery"  # of `make gallery`
TRY = ROOT / "build/wasm"  # of `make wasm`

project = "Meissner"
copyright = "the Meissner authors, Apache-2.0"
version = release = meissner.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["**/*.toml"]
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
html_theme = "furo"
html_title = "Meissner"
highlight_language = "none"
html_static_path = ["try", *(str(folder) for folder in (PICTURES, TRY) if folder.is_dir())]
html_copy_source = False
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings give shapes, units and types
napoleon_use_rtype = False
suppress_warnings = ["myst.header"]  # a page in parts begins its parts at the second level

PLAYED = """This is the core: its RTL, compiled to WebAssembly. Press and pull, or play a scene; move the
threshold.

<div id="try"></div>
<script defer src="_static/core.js"></script>
<script defer src="_static/scene.js"></script>
<script defer src="_static/try.js"></script>"""
UNMADE = "*`make wasm`, which needs Emscripten, puts the core itself here, to try in the browser.*"

LINK = re.compile(r"(?<!!)\[((?:[^][]|\[[^][]*\])+)\]\(([^)#:\s]+)(#[^)\s]*)?\)")
COMMAND = re.compile(r"^    ((?:\.venv/bin/|make |meissner |python |sudo |apt )\S.*?) {2,}(\S.*)$", re.M)
_linked = set()


def to_sources(app, name, text):
    """Links that leave docs/, or lead to what is no page, go to a page of the source."""
    here = posixpath.dirname(name)

    def link(found):
        words, path, place = found.groups()
        target = posixpath.normpath(posixpath.join("docs", here, path))
        if not (ROOT / target).exists() or (target.startswith("docs/") and target.endswith(".md")):
            return found[0]  # Sphinx says what is missing
        _linked.add(target)
        up = "../" * name.count("/")
        return f'<a href="{up}src/{target}.html{place or ""}">{words}</a>'

    def command(found):
        """What a command does, to its right in the page's text, gets a line of its own above it."""
        return f"    # {LINK.sub(lambda link: link[1], found[2])}\n    {found[1]}"

    parts = re.split(r"(^```.*?^```$)", text[0], flags=re.M | re.S)
    parts = [part if part.startswith("```") else LINK.sub(link, COMMAND.sub(command, part)) for part in parts]
    text[0] = "".join(parts)
    text[0] = text[0].replace("<!-- scenes -->", gallery() if name == "gallery" else "")
    text[0] = text[0].replace("<!-- try -->", PLAYED if (TRY / "core.js").exists() else UNMADE)


def gallery():
    """Every scene with its title, its command and, after `make gallery`, its picture."""
    found = []
    for name in scenes.names():
        scene = scenes.load(name)
        picture = PICTURES / f"{name}.png"
        title = f"{scene.title[0].upper()}{scene.title[1:]}" + "." * (not scene.title.endswith("?"))
        found.append(f"## {name}\n\n{title}\n\n    .venv/bin/meissner run {name}\n")
        if picture.exists():
            found.append(f'<a href="_static/{name}.png"><img src="_static/{name}.png" alt="{name}"></a>\n')
    return "\n".join(found)


def page(target):
    """A source, or a list of a folder, as HTML."""
    path = ROOT / target
    if path.is_dir():
        text = "\n".join(sorted(each.name for each in path.iterdir() if not each.name.startswith((".", "_"))))
        lexer = TextLexer()
    else:
        text = path.read_text("utf-8")
        try:
            lexer = get_lexer_for_filename(target)
        except ClassNotFound:
            lexer = TextLexer()
    return highlight(text, lexer, HtmlFormatter(full=True, title=target, linenos="inline"))


def write_sources(app, failed):
    if not failed and app.builder.format == "html":
        for target in sorted(_linked):
            out = Path(app.outdir) / "src" / f"{target}.html"
            os.makedirs(out.parent, exist_ok=True)
            out.write_text(page(target), "utf-8")


def setup(app):
    app.connect("source-read", to_sources)
    app.connect("build-finished", write_sources)
    # They show what other targets have made since.
    app.connect("env-get-outdated", lambda *_: ["index", "gallery"])
    return {"parallel_read_safe": False}
