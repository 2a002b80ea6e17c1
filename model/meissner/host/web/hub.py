"""What the page's viewers get: each packet encoded once, a bounded queue for each viewer, the last minutes.

A message of the stream, lowest bytes first: its length 32, that of its text 32, seconds since the page began
64 bits (float); the text, JSON; then arrays as the text's ``arrays`` lists them, [name, dtype, shape]. Text
and arrays are padded to 8 bytes. The kind of a packet's message is the name of its class, its other keys are
the packet's fields, so a packet of a new type needs nothing here. Packets of one type that hold only numbers
and follow each other come as the rows of one array, ``rows``, whose ``columns`` the text names; missing
numbers are NaN.
"""

import json
import secrets
import struct
import threading
import time
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import fields
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays
from meissner.builds.units import Units
from meissner.host import packets
from meissner.host.log import McapLog
from meissner.host.table import Facts, Table, items, joined
from meissner.host.unfinished_log import UnfinishedLog

ROOM = 4 << 20  # bytes that wait for a viewer; beyond it, the oldest are dropped and counted
RECENT_S, RECENT = 10.0, 8 << 20  # what a new viewer gets at once: seconds, bytes
HISTORY_S, HISTORY = 180.0, 48 << 20  # what can be saved
BLOCK_S = 1.0  # of a block of the history
ANSWER_S = 10.0  # that a viewer's request may take

Message = tuple[dict[str, Any], list[NDArray[Any]]]


def encode(t: float, head: Mapping[str, Any], arrays: list[NDArray[Any]] | None = None) -> bytes:
    text = json.dumps(head, separators=(",", ":")).encode()
    parts = [text, *(np.ascontiguousarray(array).tobytes() for array in arrays or ())]
    parts = [part + b" " * (-len(part) % 8) for part in parts]
    return b"".join([struct.pack("<IId", 16 + sum(map(len, parts)), len(parts[0]), t), *parts])


def _plain(value: Any) -> Any:
    """A field as JSON takes it; NaN and infinity are none."""
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def message(kind: str, given: Mapping[str, Any]) -> Message:
    """The text and the arrays of a packet or of another message."""
    head: dict[str, Any] = {"kind": kind}
    arrays, listed = [], []
    for name, value in given.items():
        if isinstance(value, np.ndarray):
            listed.append([name, value.dtype.str.lstrip("<|"), list(value.shape)])
            arrays.append(value)
        else:
            head[name] = _plain(value)
    return head | ({"arrays": listed} if listed else {}), arrays


class Viewer:
    """The queue of one viewer: ``put`` never waits."""

    def __init__(self, first: list[bytes]) -> None:
        self._waiting, self._size = deque(first), sum(map(len, first))
        self._ready = threading.Condition()
        self.dropped, self.closed = 0, False

    def put(self, data: bytes) -> None:
        with self._ready:
            self._waiting.append(data)
            self._size += len(data)
            while self._size > ROOM and len(self._waiting) > 1:
                self._size -= len(self._waiting.popleft())
                self.dropped += 1
            self._ready.notify()

    def take(self, timeout_s: float) -> bytes:
        """All that waits, after a wait of up to ``timeout_s``."""
        with self._ready:
            if not self._waiting and not self.closed:
                self._ready.wait(timeout_s)
            data = b"".join(self._waiting)
            self._waiting.clear()
            self._size = 0
        return data

    def close(self) -> None:
        with self._ready:
            self.closed = True
            self._ready.notify()


class Hub:
    """Takes packets with their times as the writer of a meissner.host.log.Log does; ``send`` hands all since
    its last call to the viewers. One thread calls these; ``join``, ``leave``, ``ask`` and ``save`` are for
    the viewers' threads.

    ``about``: what a viewer learns first, with the page's title, the core's size and units.
    """

    def __init__(self, about: Mapping[str, Any], known: Units) -> None:
        self.about, self.known = dict(about), known
        self.session = secrets.token_hex(8)  # of this process: a page from before a restart notices
        self._lock = threading.Lock()
        self.viewers: list[Viewer] = []
        self._began: int | None = None
        self.newest_s = 0.0
        self._facts: dict[str, float | None] = {}
        self._out: list[bytes] = []
        self._rows: list[list[float]] = []  # of packets of one type that came one after the other
        self._rows_of: tuple[str, list[str]] = "", []  # their type and columns
        self._recent: deque[tuple[float, bytes]] = deque()
        self._recent_size = 0
        self._table, self._table_from = Table(), 0
        self._history: deque[tuple[int, Arrays, int]] = deque()  # begin in ns, arrays, bytes
        self.history_size = 0
        self._asked: SimpleQueue[tuple[Callable[[], Any], Future[Any]]] = SimpleQueue()
        self.now: dict[str, dict[Any, Any]] = {}  # the newest of what a viewer must know, by kind
        self._since: dict[str, float] = {}  # since when a register has its value
        self._forget()

    def _forget(self) -> None:
        self.now |= {"states": {}, "health": {}, "statistics": {}}
        self.now.pop("decided", None)

    # As a log's writer

    def add(self, stamp_ns: int, item: Any) -> None:
        if self._began is None:
            self._began = stamp_ns
        t = (stamp_ns - self._began) / 1e9
        self.newest_s = max(self.newest_s, t)
        with self._lock:
            self._note(t, item)
        given = {field.name: getattr(item, field.name) for field in fields(item)}
        head, arrays = message(type(item).__name__, given)
        values = [value for key, value in head.items() if key != "kind"]
        if arrays or not all(value is None or isinstance(value, int | float) for value in values):
            self._close_rows()
            self._out.append(encode(t, head, arrays))
        else:
            kind = head.pop("kind")
            if kind != self._rows_of[0]:
                self._close_rows()
                self._rows_of = kind, ["t", *head]
            self._rows.append([t, *(np.nan if value is None else float(value) for value in values)])
        if Table.takes(item):
            self._keep(stamp_ns, item)

    def tell(self, facts: Facts) -> None:
        self._facts = dict(facts)

    def flush(self, facts: Facts) -> None:
        self._facts = dict(facts)

    def _note(self, t: float, item: Any) -> None:
        """Called with the lock: a viewer that joins reads what is noted here."""
        if isinstance(item, packets.Reset):
            self._forget()
        elif isinstance(item, packets.OfChannel):
            self.now["states"][item.channel] = [int(item.state), item.p2p, t]
        elif isinstance(item, packets.States):
            for channel, state in enumerate(item.states, item.first):
                if self.now["states"].get(channel, [None])[0] != state:
                    self.now["states"][channel] = [int(state), None, t]
        elif isinstance(item, packets.ClassChange):
            self.now["decided"] = {"t": t, "label": item.label, "votes": item.votes}
        elif isinstance(item, packets.Health):
            self.now["health"][item.taxel] = item.faults
        elif isinstance(item, packets.Statistics):
            self.now["statistics"][item.name] = item.value

    def _keep(self, stamp_ns: int, item: Any) -> None:
        """Into the history, whose oldest block is dropped once it is too long or too large."""
        self._table_from = self._table_from or stamp_ns
        self._table.add(stamp_ns, item)
        if stamp_ns - self._table_from >= BLOCK_S * 1e9:
            self._close_block()
            with self._lock:
                begin = stamp_ns - HISTORY_S * 1e9
                while len(self._history) > 1 and (self.history_size > HISTORY or self._history[1][0] < begin):
                    self.history_size -= self._history.popleft()[2]

    def _close_block(self) -> None:
        arrays = self._table.new()
        size = sum(array.nbytes for array in arrays.values())
        with self._lock:
            self._history.append((self._table_from, arrays, size))
            self.history_size += size
        self._table, self._table_from = Table(), 0

    # To the viewers

    def event(self, kind: str, **given: Any) -> None:
        """A message that is no packet, at the time of the newest one; arrays as a packet's."""
        self._close_rows()
        self._out.append(encode(self.newest_s, *message(kind, given)))

    def remember(self, kind: str, key: str, value: Any) -> None:
        """The same for a value that new viewers get too; sent only if it is another one."""
        with self._lock:
            known = self.now.setdefault(kind, {})
            before = known.get(key)
            if key in known and before == value:
                return
            known[key] = value
            if kind == "register":
                self._since[key] = self.newest_s
        self.event(kind, name=key, value=value, before=before)

    def _close_rows(self) -> None:
        if self._rows:
            table, (kind, columns) = np.array(self._rows), self._rows_of
            head = {"kind": kind, "columns": columns, "arrays": [["rows", "f8", table.shape]]}
            self._out.append(encode(self._rows[-1][0], head, [table]))
            self._rows = []

    def send(self) -> None:
        self._close_rows()
        data = b"".join(self._out)
        self._out.clear()
        if not data:
            return
        with self._lock:
            self._recent.append((self.newest_s, data))
            self._recent_size += len(data)
            while len(self._recent) > 1 and (
                self._recent_size > RECENT or self._recent[0][0] < self.newest_s - RECENT_S
            ):
                self._recent_size -= len(self._recent.popleft()[1])
            for viewer in self.viewers:
                viewer.put(data)

    def join(self) -> tuple[bytes, Viewer]:
        """(the message with which a viewer's stream begins, its queue with the last seconds in it)."""
        with self._lock:
            viewer = Viewer([data for _, data in self._recent])
            self.viewers.append(viewer)
            first = self._recent[0][0] if self._recent else self.newest_s
            hello = {"kind": "hello", "session": self.session, **self.about, "now": self.now}
            return encode(self.newest_s, hello | {"first": first, "since": self._since}), viewer

    def leave(self, viewer: Viewer) -> None:
        with self._lock:
            self.viewers.remove(viewer)

    def ask(self, what: Callable[[], Any]) -> Any:
        """The result of ``what`` in the thread that has the core; TimeoutError if that takes too long."""
        future: Future[Any] = Future()
        self._asked.put((what, future))
        try:
            return future.result(ANSWER_S)
        finally:
            future.cancel()

    def answer(self) -> None:
        """Do what viewers asked for."""
        while True:
            try:
                what, future = self._asked.get_nowait()
            except Empty:
                return
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(what())
                except Exception as problem:
                    future.set_exception(problem)

    # The last minutes

    def save(self, begin_s: float, end_s: float, folder: Path) -> Path:
        """An MCAP file in ``folder`` of the packets from ``begin_s`` to ``end_s``; ValueError if there are
        none."""
        self.ask(lambda: self._close_block() if self._table_from else None)
        with self._lock:
            begin, end = ((self._began or 0) + round(at * 1e9) for at in (begin_s, end_s))
            begins = [at for at, *_ in self._history]
            first = max(0, bisect_right(begins, begin) - 1)
            blocks = [arrays for _, arrays, _ in list(self._history)[first : bisect_right(begins, end)]]
        found = [pair for pair in items(joined(blocks), self.known) if begin <= pair[0] <= end]
        if not any(not isinstance(item, packets.Reset) for _, item in found):
            raise ValueError(
                f"there is no packet from {begin_s:.3f} s to {end_s:.3f} s: the last minutes alone are kept"
            )
        path = folder / f"meissner-{time.strftime('%Y%m%d-%H%M%S', time.gmtime(begin / 1e9))}.mcap"
        spool = UnfinishedLog(path, McapLog.KIND)
        writer = McapLog(spool, self.known)
        writer.tell(self._facts)
        for stamp, item in found:
            writer.add(stamp, item)
        writer.finish(path, self._facts)
        return path
