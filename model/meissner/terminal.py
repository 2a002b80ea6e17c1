"""Text that any terminal can show."""

import codecs
import sys

_INSTEAD = {"×": "x", "µ": "u", "°": "deg", "·": ".", "█": "#", "▓": "#", "▒": "+", "░": "."}


def plain(text):
    """``text`` in one line, with unprintable characters escaped (as \\x1b), so that it moves no cursor."""
    escaped = (c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text))
    return "".join(escaped)


def _instead(error):
    return "".join(_INSTEAD.get(c, "?") for c in error.object[error.start : error.end]), error.end


def plain_streams():
    """Keep standard output and error from failing on a character that their encoding lacks."""
    codecs.register_error("meissner", _instead)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="meissner")
