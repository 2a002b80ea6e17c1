"""The lines to a core, all with one interface: ``read``, ``write``, ``close``, ``reopen``.

serial:/dev/ttyUSB0?baud=3000000     a serial port (3 Mbaud by default); /dev/tty... means the same
pty:/dev/pts/7                       a pseudo-terminal, as a simulated core offers
file:capture.bin                     the recorded bytes of a line, read only
sim:SCENE[+SCENE]                    a simulated core in this process: meissner.host.simulated
core:CONFIG                          the RTL of a configuration in this process, fed with a scene
"""

import os
import select
import termios
import time
import tomllib
import tty
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Protocol
from urllib.parse import parse_qs

from meissner.files import check_in

BAUD = 3_000_000


class Gone(OSError):
    """The line is interrupted (unplugged, closed); it may come back."""


class Ended(Exception):
    """No more bytes will come."""


class BytePipe(Protocol):
    """A core in this process, or one end of a line to it; neither method waits."""

    def read(self, n: int, /) -> bytes:
        """At most ``n`` bytes that the core sends now."""

    def write(self, data: bytes, /) -> None:
        """Bytes for the core."""


class Line(Protocol):
    """A line to a core: ``name`` for messages, ``baud`` None unless it is a serial port."""

    name: str
    baud: int | None

    def reopen(self) -> None:
        """Open it (again); OSError if that fails."""

    def read(self, timeout_s: float) -> bytes:
        """The bytes received, after a wait of up to ``timeout_s``; b"" if none came; raises Gone or Ended."""

    def write(self, data: bytes) -> None:
        """Send all bytes; raises Gone."""

    def close(self) -> None:
        """Close it; may be repeated."""


class Device:
    """A serial port (``baud``) or a pty (None)."""

    def __init__(self, path: str, baud: int | None = None) -> None:
        self.path, self.baud, self.name = path, baud, path
        self._close: Callable[[], None] | None = None
        self.reopen()

    def reopen(self) -> None:
        self.close()
        if self.baud is None:
            self._fd = fd = os.open(self.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            self._close = lambda: os.close(fd)
            if not os.isatty(self._fd):
                self.close()
                raise OSError(f"{self.path} is not a terminal")
            tty.setraw(self._fd, termios.TCSANOW)  # keeps bytes already received
        else:
            import serial

            # exclusive: two readers would each get half of the bytes
            port = serial.Serial(self.path, self.baud, timeout=0, exclusive=True)
            self._fd, self._close = port.fileno(), port.close

    def read(self, timeout_s: float) -> bytes:
        try:
            if not select.select([self._fd], [], [], max(0.0, timeout_s))[0]:
                return b""
            data = os.read(self._fd, 65536)
        except BlockingIOError:
            return b""
        except OSError as problem:
            raise Gone(f"{self.name} is gone: {problem.strerror or problem}") from None
        if not data:
            raise Gone(f"{self.name} is gone: the other end was closed")
        return data

    def write(self, data: bytes) -> None:
        try:
            while data:
                if not select.select([], [self._fd], [], 1.0)[1]:
                    raise Gone(f"{self.name} is stuck: it accepts no bytes")
                data = data[os.write(self._fd, data) :]
        except Gone:
            raise
        except OSError as problem:
            raise Gone(f"{self.name} is gone: {problem.strerror or problem}") from None

    def close(self) -> None:
        if self._close is not None:
            self._close()
        self._fd, self._close = -1, None


class File:
    """A capture; ``read`` raises Ended at its end."""

    baud: int | None = None

    def __init__(self, path: str | Path) -> None:
        self.name, self._path = str(path), path
        self.reopen()

    def reopen(self) -> None:
        self._file = Path(self._path).open("rb")  # noqa: SIM115 - closed by close

    def read(self, timeout_s: float) -> bytes:
        data = self._file.read(65536)
        if not data:
            raise Ended
        return data

    def write(self, data: bytes) -> None:
        raise ValueError(f"{self.name} is a file: a core's registers cannot be reached through it")

    def close(self) -> None:
        self._file.close()


class Pipe:
    """A core in this process."""

    baud: int | None = None

    def __init__(self, pipe: BytePipe, name: str = "the simulated core") -> None:
        self.pipe, self.name = pipe, name

    def reopen(self) -> None:
        pass

    def read(self, timeout_s: float) -> bytes:
        end = time.monotonic() + timeout_s
        while True:
            data = self.pipe.read(65536)
            left = end - time.monotonic()
            if data or left <= 0:
                return data
            time.sleep(min(left, 0.002))

    def write(self, data: bytes) -> None:
        self.pipe.write(data)

    def close(self) -> None:
        pass


def open_line(url: str, baud: int | None = None) -> Line:
    """The line that ``url`` names; ValueError in one sentence. ``baud``: used unless the url gives one."""
    kind, colon, rest = url.partition(":")
    if not colon and url.startswith("/dev/tty"):
        kind, rest = "serial", url
    path, _, query = rest.partition("?")
    options = {key: values[-1] for key, values in parse_qs(query, keep_blank_values=True).items()}
    try:
        if kind == "serial" and path and set(options) <= {"baud"}:
            rate = options.get("baud", str(baud or BAUD))
            if not rate.isdecimal() or not 300 <= int(rate) <= 100_000_000:
                raise ValueError(f"baud = {rate} must lie in 300 .. 100000000")
            return Device(path, int(rate))
        if kind == "pty" and path and not options:
            return Device(path)
        if kind == "file" and path and not options:
            return File(check_in(path) if Path(path).exists() else path)
        if kind == "sim" and set(options) <= {"speed"}:
            from meissner.host import simulated

            return Pipe(simulated.of_scenes(path, options.get("speed", "1")), url)
        if kind == "core" and path and not options:
            from meissner.builds import config
            from meissner.engines.rtl_core import CoreOnPins
            from meissner.scenes.core_stimulus import shown

            build = config.load(path)
            return Pipe(CoreOnPins(build, shown(build)), url)
    except OSError as problem:
        raise ValueError(f"{path} cannot be opened: {problem.strerror or problem}") from None
    raise ValueError(f"{url!r} is not a line; {_meant(url)}")


def _meant(text: str) -> str:
    """What was perhaps meant by a text that is no line, or else the lines there are."""
    from meissner import scenes
    from meissner.builds import config

    kind = Path(text).suffix
    with suppress(OSError, ValueError):
        table = tomllib.loads(Path(text).read_text("utf-8")) if kind == ".toml" else {}
        if isinstance(table.get("sensor"), str) or text in scenes.names():  # a configuration has [sensor]
            return f"it is a scene, which sim:{text} plays"
    if kind == ".toml" or text in config.names():
        return (
            f"it is a configuration: core:{text} simulates it; of a core that was built with it, name the "
            f"port (`meissner ports` lists them) and give --config {text}"
        )
    if kind in (".mcap", ".npz"):
        return f"it is a log, which `meissner replay {text}` plays"
    if Path(text).is_file():
        return f"a recorded line is file:{text}"
    known = "serial:/dev/ttyUSB0?baud=3000000, pty:/dev/pts/7, file:capture.bin, sim:SCENE and core:CONFIG"
    return f"the lines are {known}"
