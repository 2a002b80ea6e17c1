"""Text as any terminal can show it."""

import codecs
import sys

_INSTEAD = {"×": "x", "µ": "u", "°": "deg", "·": ".", "█": "#", "▓": "#", "▒": "+", "░": "."}


def plain(text):
    """``text`` in one line, what does not print as \\x1b: words of a file move no cursor and no margin."""
    escaped = (c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text))
    return "".join(escaped)


def _instead(error):
    return "".join(_INSTEAD.get(c, "?") for c in error.object[error.start : error.end]), error.end


def plain_streams():
    """Standard output and error do not fail on a character that their encoding lacks."""
    codecs.register_error("meissner", _instead)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="meissner")
