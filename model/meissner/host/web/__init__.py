"""A page that shows a core while it runs: ``meissner live --web``, ``replay --web``, ``run SCENE --web``.

A panel of the page is one file of page/panels/: docs/host.md.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from meissner.host.web.hub import Hub
from meissner.host.web.server import PORT, TYPES, serving
from meissner.host.web.sources import OfCore, OfLog

__all__ = ["PORT", "OfCore", "OfLog", "Source", "beside", "serve"]


class Source(Protocol):
    hub: Hub
    stopped: bool

    def step(self) -> None:
        """Take what came, and send it to the viewers."""

    def write(self, name: str, value: int) -> int: ...


def play(source: Source, seconds: float | None = None) -> None:
    """Send what comes from ``source`` until it is stopped; one that has ended can still be looked at."""
    end = None if seconds is None else time.monotonic() + seconds
    while not source.stopped and (end is None or time.monotonic() < end):
        source.step()


def serve(source: Source, port: int, seconds: float | None, say: Callable[[str], object]) -> None:
    """Show ``source`` on a page until it is stopped or the seconds are over."""
    with serving(source.hub, source.write, port) as server:
        say(f"{source.hub.about['title']}: {server.url} (Ctrl-C ends it)")
        play(source, seconds)


@contextmanager
def beside(source: Source, port: int, say: Callable[[str], object]) -> Iterator[Callable[[bytes], None]]:
    """The same in a thread of its own, until the block ends; the function given links a report (HTML) to the
    page and returns when the source is stopped."""
    thread = threading.Thread(target=play, args=(source,), daemon=True)
    with serving(source.hub, source.write, port) as server:
        thread.start()
        say(f"{source.hub.about['title']}: {server.url}")

        def stay(report: bytes) -> None:
            server.files["/report.html"] = TYPES[".html"], report
            source.hub.ask(lambda: source.hub.remember("link", "report", "/report.html"))
            thread.join()

        try:
            yield stay
        finally:
            source.stopped = True
            thread.join()
