"""The page on this machine's own address: files, one endless response per viewer, and POST for settings.

Every request must name this machine as its host, and every POST the page itself as its origin: a page from
elsewhere in the same browser reaches neither, not even under a name that it points at 127.0.0.1.
"""

import errno
import json
import math
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from meissner.host.web.hub import Hub, encode

ADDRESS, PORT = "127.0.0.1", 8642
LOCAL = ("127.0.0.1", "localhost", "[::1]")
MOST_VIEWERS = 16
LONGEST = 4096  # bytes of a request's body
STALLED_S = 30.0  # after which a viewer that reads nothing is given up
BEAT_S = 1.0
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".LICENSE": "text/plain; charset=utf-8",
}
HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def _files(folder: Traversable, at: str = "/") -> Iterator[tuple[str, Traversable]]:
    for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
        if entry.is_dir():
            yield from _files(entry, f"{at}{entry.name}/")
        elif Path(entry.name).suffix in TYPES:
            yield f"{at}{entry.name}", entry


def page() -> dict[str, tuple[str, bytes]]:
    """{path: (type, content)}; every file of panels/ is in the page, in the order of their names."""
    folder = resources.files("meissner.host.web") / "page"
    found = {at: (TYPES[Path(at).suffix], file.read_bytes()) for at, file in _files(folder)}
    panels = [at for at in found if at.startswith("/panels/")]
    scripts = "\n".join(f'<script type="module" src="{at}"></script>' for at in panels)
    kind, index = found.pop("/index.html")
    return found | {"/": (kind, index.replace(b"<!-- panels -->", scripts.encode()))}


class Refusal(Exception):
    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


class Handler(BaseHTTPRequestHandler):
    server: "Server"
    protocol_version = "HTTP/1.1"
    timeout = STALLED_S
    server_version, sys_version = "meissner", ""

    def log_message(self, *_: object) -> None:
        pass

    def do_GET(self) -> None:
        self._serve(self._get)

    def do_POST(self) -> None:
        self._serve(self._post)

    def _serve(self, what: Callable[[], None]) -> None:
        if self.server.closing:  # asked over a connection from before
            self.close_connection = True
            return
        try:
            host = self.headers.get("Host", "")
            if host.rpartition(":")[0] not in LOCAL and host not in LOCAL:
                raise Refusal(
                    HTTPStatus.FORBIDDEN,
                    f"this page is for viewers on this machine alone: open it as http://{ADDRESS}, "
                    f"not as {host[:80]!r}",
                )
            what()
        except Refusal as refusal:
            self.close_connection = True
            self._answer(refusal.status, {"error": str(refusal)})
        except (ConnectionError, TimeoutError):  # the viewer is gone
            self.close_connection = True

    def _answer(self, status: HTTPStatus, value: object) -> None:
        self._send(status, "application/json", json.dumps(value).encode())

    def _send(self, status: HTTPStatus, kind: str, body: bytes, **more: str) -> None:
        self.send_response(status)
        headers = HEADERS | {"Content-Type": kind, "Content-Length": str(len(body))}
        headers |= {name.replace("_", "-"): value for name, value in more.items()}
        if self.close_connection:
            headers["Connection"] = "close"
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def _get(self) -> None:
        path = self.path.partition("?")[0]
        if path == "/stream":
            self._stream()
        elif path in self.server.files:
            self._send(HTTPStatus.OK, *self.server.files[path])
        else:
            raise Refusal(HTTPStatus.NOT_FOUND, f"there is no {path[:80]}")

    def _stream(self) -> None:
        hub, self.close_connection = self.server.hub, True
        if len(hub.viewers) >= MOST_VIEWERS:
            raise Refusal(HTTPStatus.SERVICE_UNAVAILABLE, f"{MOST_VIEWERS} viewers are connected already")
        hello, viewer = hub.join()
        try:
            self.send_response(HTTPStatus.OK)
            for name, value in (HEADERS | {"Content-Type": "application/octet-stream"}).items():
                self.send_header(name, value)
            self.send_header("Connection", "close")
            self.end_headers()
            self.wfile.write(hello)
            dropped = 0
            while not viewer.closed:
                data = viewer.take(BEAT_S)
                if viewer.dropped != dropped or not data:  # the latter: is the viewer still there?
                    dropped = viewer.dropped
                    data += encode(hub.newest_s, {"kind": "dropped", "count": dropped})
                self.wfile.write(data)
        finally:
            hub.leave(viewer)

    def _post(self) -> None:
        host, origin = self.headers.get("Host", ""), self.headers.get("Origin")
        if origin != f"http://{host}":
            raise Refusal(
                HTTPStatus.FORBIDDEN,
                f"settings are changed from the page alone, not from {(origin or 'elsewhere')[:80]}",
            )
        action = {"/set": self._set, "/save": self._save}.get(self.path)
        if action is None:
            raise Refusal(HTTPStatus.NOT_FOUND, f"there is no {self.path[:80]}")
        if self.headers.get_content_type() != "application/json":
            raise Refusal(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "the body must be application/json")
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > LONGEST:
            raise Refusal(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the body must have a length of at most {LONGEST} bytes"
            )
        try:
            given = json.loads(self.rfile.read(int(length)))
            if not isinstance(given, dict):
                raise ValueError
        except ValueError:
            raise Refusal(HTTPStatus.BAD_REQUEST, "the body must be a JSON object") from None
        try:
            action(given)
        except (ValueError, OSError) as problem:
            if isinstance(problem, ConnectionError):
                raise
            sentence = str(problem) or "the core did not answer in time"
            raise Refusal(HTTPStatus.BAD_REQUEST, sentence) from None

    def _set(self, given: dict[str, Any]) -> None:
        name, value = given.get("name"), given.get("value")
        if not isinstance(name, str) or type(value) is not int or set(given) != {"name", "value"}:
            raise ValueError('a setting is {"name": "slip.threshold", "value": 40}, with an integer')
        self._answer(HTTPStatus.OK, {"name": name, "value": self.server.write(name, value)})

    def _save(self, given: dict[str, Any]) -> None:
        ends: list[Any] = [given.get("begin"), given.get("end")]
        if set(given) != {"begin", "end"} or not all(
            type(end) in (int, float) and math.isfinite(end) and abs(end) < 1e9 for end in ends
        ):
            raise ValueError('what to save is {"begin": 1.5, "end": 9}, in seconds of the page')
        with tempfile.TemporaryDirectory() as folder:
            path = self.server.hub.save(ends[0], ends[1], Path(folder))
            body = path.read_bytes()
        self._send(
            HTTPStatus.OK,
            "application/octet-stream",
            body,
            Content_Disposition=f'attachment; filename="{path.name}"',
        )


class Server(ThreadingHTTPServer):
    """``write(name, value)``: sets a register, called in a viewer's thread; returns what it reads back."""

    daemon_threads, block_on_close = True, False
    request_queue_size = 32

    def __init__(self, hub: Hub, write: Callable[[str, int], int], port: int = PORT) -> None:
        self.hub, self.write, self.files, self.closing = hub, write, page(), False
        contents = b"".join(content for _, content in self.files.values())
        hub.about["page"] = sha256(contents).hexdigest()  # a page of another version loads itself again
        try:
            super().__init__((ADDRESS, port), Handler)
        except OverflowError:
            raise ValueError(f"web-port = {port} must lie in 0 .. 65535") from None
        except OSError as problem:
            if problem.errno == errno.EADDRINUSE:
                raise ValueError(
                    f"port {port} of {ADDRESS} is in use, by another page perhaps: choose --web-port"
                ) from None
            raise ValueError(f"port {port} of {ADDRESS} cannot be opened: {problem.strerror}") from None

    @property
    def url(self) -> str:
        return f"http://{ADDRESS}:{self.server_address[1]}/"

    def handle_error(self, *_: object) -> None:
        """A viewer that goes away is no error; others appear in its answer."""


@contextmanager
def serving(hub: Hub, write: Callable[[str, int], int], port: int = PORT) -> Iterator[Server]:
    with Server(hub, write, port) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.closing = True
            server.shutdown()
            for viewer in list(hub.viewers):
                viewer.close()
