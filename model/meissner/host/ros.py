"""ROS 2 messages in MCAP files, without ROS: definitions, writer, reader. Topics are in docs/host.md."""

import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any, BinaryIO

import numpy as np

from meissner.builds.toolchain import ROOT
from meissner.builds.units import FRACTION_BITS, Units
from meissner.host import packets
from meissner.host.table import START
from meissner.host.unfinished_log import UnfinishedLog
from meissner.twins.link.packet import NO_CLASS

Found = dict[str, str] | tuple[str, int, Any]  # facts, or topic, ns and message

FRAME_ID = "tactile"  # origin in the array's middle, x to the right, y up
METADATA = "meissner"

_DEFINITIONS = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/PointStamped": "std_msgs/Header header\ngeometry_msgs/Point point",
    "std_msgs/MultiArrayDimension": "string label\nuint32 size\nuint32 stride",
    "std_msgs/MultiArrayLayout": "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset",
    "std_msgs/Int64MultiArray": "std_msgs/MultiArrayLayout layout\nint64[] data",
    "std_msgs/Float64": "float64 data",
    "std_msgs/String": "string data",
}


def definition(name: str) -> str:
    """The text of ``name`` ("package/Type") with every type it refers to, as an MCAP schema needs it."""
    known = dict(_DEFINITIONS)
    known["meissner_msgs/TactileFrame"] = (ROOT / "host/msg/TactileFrame.msg").read_text("utf-8")
    needed, text = [name], ""
    for one in needed:
        text += f"{'=' * 80}\nMSG: {one}\n{known[one]}\n" if one != name else f"{known[one]}\n"
        kinds = (line.split()[0].removesuffix("[]") for line in known[one].splitlines() if line.strip())
        needed += [kind for kind in kinds if kind in known and kind not in needed]
    return text


def _header(stamp_ns: int) -> SimpleNamespace:
    stamp = SimpleNamespace(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return SimpleNamespace(stamp=stamp, frame_id=FRAME_ID)


def _array(labels: Iterable[str], values: Sequence[int]) -> SimpleNamespace:
    dims = [SimpleNamespace(label=",".join(labels), size=len(values), stride=len(values))]
    return SimpleNamespace(layout=SimpleNamespace(dim=dims, data_offset=0), data=values)


def _frame(
    stamp_ns: int, item: packets.CopFrame | packets.Image, newtons_per_code: float | None
) -> SimpleNamespace:
    frame = {"header": _header(stamp_ns), "ticks": item.time, "newtons_per_code": newtons_per_code or 0.0}
    cop = dict.fromkeys(("x", "y", "load"), 0) | {"has_cop": False, "pressed": False}
    image: dict[str, object] = dict.fromkeys(("rows", "columns", "number"), 0) | {"taxels": []}
    if isinstance(item, packets.Image):
        rows, columns = item.taxels.shape
        image = {
            "rows": rows,
            "columns": columns,
            "number": item.number,
            "taxels": item.taxels.ravel().tolist(),
        }
    else:
        x, y = (round(value * (1 << FRACTION_BITS)) for value in (item.x, item.y))
        cop = {"has_cop": True, "pressed": item.pressed, "x": x, "y": y, "load": item.load}
    return SimpleNamespace(**frame, **cop, **image)


class McapWriter:
    """``add`` takes packets with their time in ns, ``tell`` facts about the log, ``finish`` the final facts.

    ``flush`` writes the packets so far as a chunk; a file that was cut off is readable up to the last chunk.
    """

    def __init__(self, file: UnfinishedLog, known: Units) -> None:
        from mcap.records import Schema
        from mcap_ros2.writer import Writer

        self._writer = Writer(file)  # type: ignore[arg-type]  # it needs write and tell only
        self._schemas: dict[str, Schema] = {}
        self._known, self._count = known, 0

    def _write(self, stamp_ns: int, topic: str, kind: str, message: SimpleNamespace) -> None:
        if kind not in self._schemas:
            package, name = kind.split("/")
            self._schemas[kind] = self._writer.register_msgdef(f"{package}/msg/{name}", definition(kind))
        self._writer.write_message(topic, self._schemas[kind], message, stamp_ns, stamp_ns, self._count)
        self._count += 1

    def add(self, stamp_ns: int, item: packets.Item | packets.Reset) -> None:
        scale = self._known.newtons_per_code
        if isinstance(item, packets.CopFrame):
            self._write(
                stamp_ns, "/tactile/frame", "meissner_msgs/TactileFrame", _frame(stamp_ns, item, scale)
            )
            x = item.x if item.x_mm is None else item.x_mm / 1e3
            y = item.y if item.y_mm is None else item.y_mm / 1e3
            point = SimpleNamespace(x=x, y=y, z=0.0)
            message = SimpleNamespace(header=_header(stamp_ns), point=point)
            self._write(stamp_ns, "/tactile/cop", "geometry_msgs/PointStamped", message)
            load = float(item.load if item.load_n is None else item.load_n)
            self._write(stamp_ns, "/tactile/load", "std_msgs/Float64", SimpleNamespace(data=load))
        elif isinstance(item, packets.Image):
            self._write(
                stamp_ns, "/tactile/frame", "meissner_msgs/TactileFrame", _frame(stamp_ns, item, scale)
            )
        elif isinstance(item, packets.SlipEvent):
            values = {"channel": item.channel, "state": int(item.state), "p2p": item.p2p}
            self._numbers(stamp_ns, "/tactile/slip", item.time, values)
            self._change(stamp_ns, item, START["before"], late=False, start=True)
        elif isinstance(item, packets.StateChange):
            self._change(stamp_ns, item, before=int(item.before), late=item.late, start=False)
        elif isinstance(item, packets.States):
            values = {"first": item.first} | {f"state{k}": int(state) for k, state in enumerate(item.states)}
            self._numbers(stamp_ns, "/tactile/states", item.time, values)
        elif isinstance(item, packets.ClassChange):
            before = NO_CLASS if item.before is None else item.before
            values = {"label": item.label, "before": before, "votes": item.votes}
            self._numbers(stamp_ns, "/tactile/class", item.time, values)
        elif isinstance(item, packets.Health):
            values = {"taxel": item.taxel, "faults": item.faults}
            self._numbers(stamp_ns, "/tactile/health", item.time, values)
        elif isinstance(item, packets.Statistics):
            values = {"index": item.index, "value": item.value}
            self._numbers(stamp_ns, "/tactile/statistics", item.time, values)
        else:
            topic = "/tactile/gap" if isinstance(item, packets.Gap) else "/tactile/reset"
            self._write(stamp_ns, topic, "std_msgs/String", SimpleNamespace(data=json.dumps(asdict(item))))

    def _change(
        self,
        stamp_ns: int,
        item: packets.OfChannel,
        before: int,
        late: bool,
        start: bool,
    ) -> None:
        values = {"channel": item.channel, "state": int(item.state), "before": before, "p2p": item.p2p}
        values |= {"late": int(late), "start": int(start)}
        self._numbers(stamp_ns, "/tactile/state", item.time, values)

    def _numbers(self, stamp_ns: int, topic: str, ticks: int, values: dict[str, int]) -> None:
        values = {"ticks": ticks, **values}
        message = _array(values.keys(), list(values.values()))
        self._write(stamp_ns, topic, "std_msgs/Int64MultiArray", message)

    def tell(self, facts: Mapping[str, float | None]) -> None:
        self._writer.add_metadata(METADATA, {name: str(value) for name, value in facts.items()})

    def flush(self) -> None:
        self._writer._writer.flush()  # the ROS 2 writer has no flush of its own

    def finish(self, facts: Mapping[str, float | None]) -> None:
        self.tell(facts)
        self._writer.finish()


def read(path: str | Path) -> tuple[dict[str, str], list[tuple[int, packets.Item | packets.Reset]], bool]:
    """(facts, [(ns, packet)], whether it is complete) of a file that McapWriter wrote, positions and loads
    without physical units. A file that was cut off gives the content of its complete records."""
    facts: dict[str, str] = {}
    items: list[tuple[int, packets.Item | packets.Reset]] = []
    with open(path, "rb") as file:
        whole = _whole(file)
        for found in _of_whole(file) if whole else _of_part(file):
            if isinstance(found, dict):
                facts |= found
            else:
                topic, stamp, message = found
                items += [(stamp, item) for item in _items(topic, message)]
    if not facts:
        raise ValueError("it has no facts about a core's log")
    return facts, items, whole


def _whole(file: BinaryIO) -> bool:
    """Whether an MCAP file ends with the magic bytes of a finished one."""
    from mcap.writer import MCAP0_MAGIC

    size = file.seek(0, io.SEEK_END)
    file.seek(max(0, size - len(MCAP0_MAGIC)))
    end = file.read()
    file.seek(0)
    return end == MCAP0_MAGIC and size > len(MCAP0_MAGIC)


def _of_whole(file: BinaryIO) -> Iterator[Found]:
    """Facts, and (topic, ns, message) of each message."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    yield from (data.metadata for data in reader.iter_metadata() if data.name == METADATA)
    for decoded in reader.iter_decoded_messages(log_time_order=False):
        yield decoded.channel.topic, decoded.message.log_time, decoded.decoded_message


def _of_part(file: BinaryIO) -> Iterator[Found]:
    """The same for a file that was cut off: record by record, as far as they are complete."""
    from mcap.exceptions import EndOfFile
    from mcap.records import Channel, Message, Metadata, Schema
    from mcap.stream_reader import StreamReader
    from mcap_ros2.decoder import DecoderFactory

    factory = DecoderFactory()
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    decoders: dict[int, Callable[[bytes], Any]] = {}
    records = StreamReader(io.BytesIO(_whole_records(file)), validate_crcs=True).records
    while True:
        try:
            record = next(records, None)
        except EndOfFile:
            return
        if record is None:
            return
        if isinstance(record, Metadata) and record.name == METADATA:
            yield record.metadata
        elif isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
            decode = factory.decoder_for(record.message_encoding, schemas[record.schema_id])
            decoders |= {record.id: decode} if decode else {}
        elif isinstance(record, Message):
            message = decoders[record.channel_id](record.data)
            yield channels[record.channel_id].topic, record.log_time, message


def _whole_records(file: BinaryIO) -> bytes:
    """The file up to the end of its last complete record: 1 byte of kind, 8 of length, content."""
    data = file.read()
    end = 8  # bytes of magic
    while end + 9 <= len(data):
        following = end + 9 + int.from_bytes(data[end + 1 : end + 9], "little")
        if following > len(data):
            break
        end = following
    return data[:end]


def _items(topic: str, message: Any) -> Iterator[packets.Item | packets.Reset]:
    kind = topic.rpartition("/")[2]
    if kind == "frame" and message.has_cop:
        x, y = message.x / (1 << FRACTION_BITS), message.y / (1 << FRACTION_BITS)
        yield packets.CopFrame(
            message.ticks, None, x, y, message.load, message.pressed, x_mm=None, y_mm=None, load_n=None
        )
    elif kind == "frame":
        taxels = np.array(message.taxels, dtype=np.uint16).reshape(message.rows, message.columns)
        yield packets.Image(message.ticks, None, message.number, taxels, message.newtons_per_code or None)
    elif kind == "slip":
        ticks, channel, state, p2p = message.data
        yield packets.SlipEvent(ticks, None, channel, state, p2p, p2p_v=None)
    elif kind == "state":
        ticks, channel, state, before, p2p, late, start = message.data
        if not start:  # those are on the topic slip too
            yield packets.StateChange(ticks, None, channel, state, p2p, None, None, before, bool(late))
    elif kind == "states":
        ticks, first, *states = message.data
        yield packets.States(ticks, None, first, tuple(states))
    elif kind == "class":
        ticks, label, before, votes = message.data
        yield packets.ClassChange(ticks, None, label, None if before == NO_CLASS else before, votes)
    elif kind == "health":
        ticks, taxel, faults = message.data
        yield packets.Health(ticks, None, taxel, faults)
    elif kind == "statistics":
        ticks, index, value = message.data
        yield packets.Statistics(ticks, None, index, value)
    elif kind in ("gap", "reset"):
        yield (packets.Gap if kind == "gap" else packets.Reset)(**json.loads(message.data))
