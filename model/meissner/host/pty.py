"""A pseudo-terminal in front of a pipe, so that anything with a core's protocol opens like a serial port.
A pty that nobody reads stalls the pipe.
"""

import os
import select
import threading
import tty
from typing import Self

from meissner.host.line import BytePipe

BLOCK = 4096
POLL_S = 0.002


class Pty:
    """``url`` is for ``meissner.host.connect``; a thread moves the bytes until ``unplug``."""

    def __init__(self, pipe: BytePipe) -> None:
        self.pipe = pipe
        self._core, self._host = os.openpty()
        tty.setraw(self._host)
        os.set_blocking(self._core, False)
        self.path = os.ttyname(self._host)
        self.url = f"pty:{self.path}"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._pump, daemon=True)
        self._thread.start()

    def _pump(self) -> None:
        waiting = b""
        while not self._stop.is_set():
            waiting = waiting or self.pipe.read(BLOCK)
            readable, writable, _ = select.select([self._core], [self._core] if waiting else [], [], POLL_S)
            if readable:
                self.pipe.write(os.read(self._core, BLOCK))
            if writable:
                waiting = waiting[os.write(self._core, waiting) :]
            elif waiting and not readable:
                self._stop.wait(POLL_S)

    def unplug(self) -> None:
        """Close both ends, as if the cable were pulled: the host reports an interruption."""
        if not self._stop.is_set():
            self._stop.set()
            self._thread.join()
            os.close(self._core)
            os.close(self._host)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()
