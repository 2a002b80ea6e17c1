"""Text that any terminal can show."""

import codecs
import sys

_INSTEAD = {"×": "x", "µ": "u", "–": "-", "°": "deg", "·": ".", "█": "#", "▓": "#", "▒": "+", "░": "."}


def plain(text):
    """``text`` in one line, with unprintable characters escaped (as \\x1b), so that it moves no cursor."""
    escaped = (c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text))
    return "".join(escaped)


def sides(shape):
    """A shape in words, as 3×4."""
    return "×".join(map(str, shape))


def columns(rows, numbers=False):
    """Rows of cells as lines of aligned columns; ``numbers``: all but the first column to the right."""
    rows = [["–" if cell is None else str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows)]
    sides = ["<", *[">" if numbers else "<"] * (len(widths) - 1)]
    return ["  ".join(map("{:{}{}}".format, row, sides, widths)).rstrip() for row in rows]


def _instead(error):
    return "".join(_INSTEAD.get(c, "?") for c in error.object[error.start : error.end]), error.end


def plain_streams():
    """Keep standard output and error from failing on a character that their encoding lacks."""
    codecs.register_error("meissner", _instead)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="meissner")
