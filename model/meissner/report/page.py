"""A report as one self-contained HTML file: verdict and picture first, then the numbers in words.

No table is wider than its page. A column's heading is a word or two, explained below the table; on a narrow
page a table of several columns becomes a list with each value beside the whole explanation. A picture that is
clicked, or chosen with Tab and the space bar, is shown larger in a frame that scrolls. The dark style inverts
pictures and keeps their hues: the white background becomes dark like the page, and each colour still matches
the name that a caption gives it.
"""

import base64
import html
from pathlib import Path

from meissner.report.words import cell, column, fact, heading, words

_STYLE = """
:root { color-scheme: light dark; --ink: #222; --paper: #fff; --soft: #555; --line: #ddd; }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  max-width: 72rem; margin: 1.5rem auto; padding: 0 1rem; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; }
.verdict { font-size: 1.15rem; margin: .5rem 0 1rem; padding-left: .8rem; border-left: 4px solid #0072b2; }
figure { margin: 1rem 0; } figcaption { color: var(--soft); } figcaption b { color: var(--ink); }
.zoom { display: block; overflow: auto; position: relative; cursor: zoom-in; margin-bottom: .4rem; }
.zoom input { position: absolute; opacity: 0; }
.zoom:focus-within { outline: 2px solid #0072b2; outline-offset: 2px; }
.zoom:has(:checked) { cursor: zoom-out; max-height: 90vh; }
img { display: block; max-width: 100%; height: auto; margin: 0 auto; }
.zoom :checked + img { max-width: none; width: max(100%, 68rem); }
.means { color: var(--soft); font-size: .9rem; margin: .4rem 0 0; padding: 0; list-style: none;
  columns: 2 24rem; }
.rows { font-size: .93rem; } .rows td:first-child { min-width: 6.5rem; }
.means i { color: var(--ink); font-style: normal; }
.table { overflow-x: auto; } table { border-collapse: collapse; max-width: 100%; }
th, td { padding: .25rem .8rem .25rem 0; text-align: left; vertical-align: top; font-weight: normal; }
thead th { vertical-align: bottom; color: var(--soft); border-bottom: 2px solid var(--ink); }
tbody th, td { border-bottom: 1px solid var(--line); } .facts th { color: var(--soft); width: 45%; }
@media (max-width: 48rem) {
  .means { display: none; } .rows { font-size: 1rem; } figcaption::after { content: " (tap to enlarge)"; }
  h1 { font-size: 1.25rem; } .verdict { font-size: 1.05rem; }
  .rows, .rows tbody, .rows tr, .rows td { display: block; } .rows thead { display: none; }
  .rows tr { padding: .4rem 0; border-bottom: 2px solid var(--line); }
  .rows td { display: flex; justify-content: space-between; gap: 1rem; padding-right: 0; border: 0; }
  .rows td::before { content: attr(data-label); color: var(--soft); font-weight: normal; }
  .rows td:first-child { font-weight: bold; }
}
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e8e8; --paper: #121212; --soft: #a8a8a8; --line: #3a3a3a; }
  .verdict { border-color: #56b4e9; } img { filter: invert(.93) hue-rotate(180deg); }
}
"""


def _rows(rows):
    """A list of dicts with equal keys as an HTML table, the keys in words."""
    # A heading depends on a value of its column: take the first that is not None.
    samples = {key: next((row[key] for row in rows if row[key] is not None), None) for key in rows[0]}
    heads = {key: html.escape(heading(key, sample)) for key, sample in samples.items()}
    columns = {key: html.escape(column(key, sample)) for key, sample in samples.items()}
    head = "".join(f'<th scope="col" title="{heads[key]}">{text}</th>' for key, text in columns.items())
    body = "".join(
        "<tr>"
        + "".join(f'<td data-label="{heads[key]}">{html.escape(cell(key, row[key]))}</td>' for key in heads)
        + "</tr>"
        for row in rows
    )
    means = "".join(
        f"<li><i>{text}</i>: {heads[key]}</li>"
        for key, text in columns.items()
        if text != heads[key].replace(",", "")
    )
    return (
        f'<div class="table"><table class="rows"><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>" + (f'<ul class="means">{means}</ul>' if means else "")
    )


def _facts(summary):
    """A dict as an HTML table of two columns, meaning and value."""
    body = "".join(
        f'<tr><th scope="row">{html.escape(words(key, value).label)}</th>'
        f"<td>{html.escape(fact(key, value))}</td></tr>"
        for key, value in summary.items()
    )
    return f'<div class="table"><table class="facts"><tbody>{body}</tbody></table></div>'


def _figure(picture):
    file, condition, shown = picture
    data = base64.b64encode(Path(file).read_bytes()).decode("ascii")
    condition, shown = html.escape(condition), html.escape(shown)
    kind = "gif" if Path(file).suffix == ".gif" else "png"
    return (
        f'<figure><label class="zoom"><input type="checkbox" aria-label="larger">'
        f'<img alt="{condition}: {shown}" src="data:image/{kind};base64,{data}"></label>'
        f"<figcaption><b>{condition}</b>: {shown}</figcaption></figure>"
    )


def write_html(path, summary, pictures=(), tables=None, title="Meissner", verdict=""):
    """Write one self-contained file: pictures and styles are embedded.

    ``verdict``: the sentence under the title. ``pictures``: (PNG path, condition, what is shown); the first
    follows the verdict. ``tables``: {heading: list of dicts with the same keys}. ``summary``: a dict, shown
    as two columns.
    """
    figures = [_figure(picture) for picture in pictures]
    parts = [f"<h1>{html.escape(title)}</h1>", f'<p class="verdict">{html.escape(verdict)}</p>', *figures[:1]]
    for name, rows in (tables or {}).items():
        if rows:
            parts.append(f"<h2>{html.escape(name)}</h2>{_rows(rows)}")
    parts.append(f"<h2>Summary</h2>{_facts(summary)}")
    if figures[1:]:
        parts += ["<h2>More pictures</h2>", *figures[1:]]
    page = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style></head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )
    Path(path).write_text(page, encoding="utf-8")
    return Path(path)
