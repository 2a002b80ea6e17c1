"""Numbers in ROS 2 messages: an MCAP file, and bags whose messages a library has read."""

import io
from collections.abc import Iterator
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meissner.readers.table import Column, Table

_SKIPPED = ("header", "layout", "stamp", "seq")
_IMAGES = {"mono8": "u1", "8UC1": "u1", "mono16": "u2", "16UC1": "u2", "16SC1": "i2", "32FC1": "f4"}


class Collected:
    """``add`` messages; ``table``: the numbers of one topic.

    Images come before arrays and these before single numbers; of several alike a topic must be named.
    """

    def __init__(self, path: Path, how: str) -> None:
        self.path, self.how = path, how
        self.found: dict[tuple[int, str], list[tuple[int, NDArray[Any]]]] = {}
        self.kinds: dict[str, str] = {}

    def add(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        self.kinds[topic] = kind
        header = getattr(message, "header", None)
        stamp = getattr(header, "stamp", None)
        own = 0 if stamp is None else stamp.sec * 10**9 + getattr(stamp, "nanosec", getattr(stamp, "nsec", 0))
        for rank, name, values in _numbers(message):
            self.found.setdefault((rank, f"{topic}{name}"), []).append((own or stamp_ns, values))

    def _numbers(self, chosen: list[tuple[int, str]]) -> Table:
        """Single numbers that are named, a column each."""
        rows = [self.found[key] for key in chosen]
        time = np.array([[stamp for stamp, _ in each] for each in rows], np.int64)
        if (time != time[0]).any():
            raise ValueError(f"{self.path}: {', '.join(name for _, name in chosen[:8])} do not come together")
        columns = [
            Column(name, "", np.array([value for _, value in each])) for (_, name), each in zip(chosen, rows)
        ]
        stamps = Column("stamps", "s", (time[0] - time[0, 0]) * 1e-9)
        topics = ", ".join(dict.fromkeys(name.split(".")[0] for _, name in chosen))
        return Table([stamps, *columns], f"{self.how}, topic {topics}", topic=True)

    def table(self, wanted: tuple[str, ...]) -> Table:
        """The Table of the topic in ``wanted``, or of the only one with images or arrays."""
        wanted = tuple(part.strip() for entry in wanted for part in entry.split(","))
        named = [key for part in wanted for key in self.found if part in (key[1], key[1].split(".")[0])]
        chosen = [*dict.fromkeys(named)]
        if wanted and {rank for rank, _ in chosen} == {3} and len({len(self.found[k]) for k in chosen}) == 1:
            return self._numbers(chosen)
        if not chosen and self.found:
            best = min(rank for rank, _ in self.found)
            chosen = [key for key in self.found if key[0] == best]
        if not chosen:
            topics = ", ".join(f"{topic} ({kind})" for topic, kind in list(self.kinds.items())[:4])
            raise ValueError(f"{self.path} holds no numbers" + (f", only {topics}" if topics else ""))
        if len(chosen) > 1:
            names = ", ".join(name for _, name in chosen[:8])
            raise ValueError(f"{self.path} has numbers in {names}: choose one with --column")
        (rank, name) = chosen[0]
        rows = self.found[chosen[0]]
        if len({values.shape for _, values in rows}) > 1:
            sizes = sorted({values.shape for _, values in rows})[:2]
            raise ValueError(
                f"{self.path}: the messages of {name} change their size, {sizes[0]} and {sizes[1]}"
            )
        values = np.stack([values for _, values in rows])
        stamps = np.array([stamp for stamp, _ in rows], np.int64)
        time = Column("stamps", "s", (stamps - stamps[0]) * 1e-9)
        body = values if values.ndim == 3 else np.moveaxis(values, 0, -1)
        return Table([time, Column(name, "", body)], f"{self.how}, topic {name}", frames=rank < 2, topic=True)


def _fields(message: Any) -> list[str]:
    names = getattr(message, "__slots__", None) or getattr(message, "__dict__", {})
    return [name for name in names if not name.startswith("_") and name not in _SKIPPED]


def _numbers(message: Any, path: str = "") -> Iterator[tuple[int, str, NDArray[Any]]]:
    """(0 of a TactileFrame, 1 of an image, 2 of an array, 3 of a single number; field; values)."""
    names = _fields(message)
    if {"rows", "columns", "taxels"} <= {*names}:
        if len(message.taxels):
            yield 0, path, np.asarray(message.taxels).reshape(message.rows, message.columns)
        return
    if {"height", "width", "encoding", "data"} <= {*names}:
        if message.encoding in _IMAGES:
            kind = np.dtype(_IMAGES[message.encoding]).newbyteorder("<>"[bool(message.is_bigendian)])
            lines = np.frombuffer(bytes(message.data), "u1").reshape(message.height, message.step)
            row = np.ascontiguousarray(lines[:, : message.width * kind.itemsize])
            yield 1, path, row.view(kind).astype(kind.newbyteorder("="))
        return
    for name in names:
        value = getattr(message, name)
        where = path if name == "data" else f"{path}.{name}"
        if isinstance(value, bytes | bytearray | memoryview):
            value = np.frombuffer(value, np.uint8)  # uint8[]
        if {"format", "point_step"} & {*names} and getattr(value, "dtype", None) == np.uint8:
            continue  # a compressed image, a cloud of points
        if isinstance(value, bool | np.bool_ | str | bytes):
            continue
        if isinstance(value, int | float | np.number):
            yield 3, where, np.asarray(value)
        elif isinstance(value, np.ndarray | list | tuple):
            values = (
                np.asarray(value) if len(value) and not hasattr(value[0], "__dict__") else np.zeros(0, "U")
            )
            if values.dtype.kind not in "iuf":
                continue
            sizes = [dim.size for dim in getattr(getattr(message, "layout", None), "dim", [])]
            if len(sizes) == 2 and np.prod(sizes) == values.size:
                yield 1, where, values.reshape(sizes)
            else:
                yield 2, where, values
        elif _fields(value):
            yield from _numbers(value, where)


def mcap(path: Path, wanted: tuple[str, ...]) -> Table:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    found, factory, other = Collected(path, "MCAP"), DecoderFactory(), set()
    with path.open("rb") as file, redirect_stdout(io.StringIO()):  # a parser prints what it does not know
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            decode = factory.decoder_for(channel.message_encoding, schema)
            if decode is None:
                other.add(f"{channel.topic} ({channel.message_encoding})")
                continue
            found.add(channel.topic, schema.name, message.log_time, decode(message.data))
    if other and not found.kinds:
        raise ValueError(f"{path} holds no ROS 2 messages, only {', '.join(sorted(other)[:4])}")
    return found.table(wanted)
