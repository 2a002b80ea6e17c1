"""MCAP files of a core's packets, with the messages of meissner.host.ros: writer and reader."""

import io
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from meissner.builds.units import FRACTION_BITS, Units
from meissner.files import written
from meissner.host import packets
from meissner.host.core import Core
from meissner.host.ros import DIAGNOSE_NS, TOPICS, Converter, Message, definition, full_name, serialised
from meissner.host.unfinished_log import UnfinishedLog
from meissner.twins.link.packet import NO_CLASS

if TYPE_CHECKING:
    from mcap.records import McapRecord

Found = dict[str, str] | tuple[str, int, Any]  # facts, or topic, ns and message

METADATA = "meissner"
NO_FACTS = "it has no facts about a core's log"
# rosbag2's own words for a topic's quality of service: reliable, keep the last ten, volatile.
QOS = (
    "- history: 1\n  depth: 10\n  reliability: 1\n  durability: 2\n"
    + "".join(
        f"  {name}:\n    sec: 9223372036\n    nsec: 854775807\n"
        for name in ("deadline", "lifespan", "liveliness_lease_duration")
    )
    + "  liveliness: 1\n  avoid_ros_namespace_conventions: false\n"
)


class Writer:
    """``add`` takes packets with their time in ns, ``tell`` facts about the log, ``finish`` the final facts.

    Every topic is declared at once; /diagnostics is about ``core``. ``flush`` writes the packets so far as a
    chunk; a file that was cut off is readable up to the last chunk.
    """

    def __init__(self, file: UnfinishedLog, known: Units, core: Core | None) -> None:
        from mcap.writer import Writer

        self._writer = Writer(file)  # type: ignore[arg-type]  # it needs write and tell only
        self._writer.start(profile="ros2", library="meissner")
        schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        for topic, kind in TOPICS.items():
            if kind not in schemas:
                text = definition(kind).encode()
                schemas[kind] = self._writer.register_schema(full_name(kind), "ros2msg", text)
            self._channels[topic] = self._writer.register_channel(
                topic, "cdr", schemas[kind], {"offered_qos_profiles": QOS}
            )
        self._convert, self._count, self._core = Converter(known, core), 0, core
        self._newest_ns = self._diagnose_ns = 0

    def _write(self, stamp_ns: int, topic: str, message: Message) -> None:
        data = serialised(TOPICS[topic], message)
        self._writer.add_message(self._channels[topic], stamp_ns, data, stamp_ns, self._count)
        self._count += 1

    def add(self, stamp_ns: int, item: packets.Item | packets.Reset) -> None:
        for topic, message in self._convert.messages(stamp_ns, item):
            self._write(stamp_ns, topic, message)
        self._newest_ns = max(self._newest_ns, stamp_ns)
        if stamp_ns >= self._diagnose_ns or isinstance(item, packets.Gap):
            self._diagnose()

    def _diagnose(self) -> None:
        if self._core is None:
            return
        self._write(self._newest_ns, *self._convert.diagnostics(self._newest_ns))
        self._diagnose_ns = self._newest_ns + DIAGNOSE_NS

    def tell(self, facts: Mapping[str, float | None]) -> None:
        self._writer.add_metadata(METADATA, {name: str(value) for name, value in facts.items()})

    def flush(self) -> None:
        self._writer.flush()

    def finish(self, facts: Mapping[str, float | None]) -> None:
        if self._count:
            self._diagnose()
        self.tell(facts)
        self._writer.finish()


def read(path: str | Path) -> tuple[dict[str, str], list[tuple[int, packets.Item | packets.Reset]], bool]:
    """(facts, [(ns, packet)], whether it is complete) of a file that Writer wrote, positions and loads
    without physical units. A file that was cut off gives the content of its complete records."""
    facts: dict[str, str] = {}
    items: list[tuple[int, packets.Item | packets.Reset]] = []
    images: dict[int, Any] = {}  # those whose number comes in the next message
    with open(path, "rb") as file:
        whole = _whole(file)
        for found in _of_whole(file) if whole else _of_part(file):
            if isinstance(found, dict):
                facts |= found
                continue
            topic, stamp, message = found
            if topic == "/tactile/image":
                images[stamp] = message
            elif (item := _item(topic, stamp, message, images)) is not None:
                items.append((stamp, item))
    if not facts:
        raise ValueError(NO_FACTS)
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
    facts = [data.metadata for data in reader.iter_metadata() if data.name == METADATA]
    if not facts:
        raise ValueError(NO_FACTS)
    yield from facts
    for decoded in reader.iter_decoded_messages(log_time_order=False):
        yield decoded.channel.topic, decoded.message.log_time, decoded.decoded_message


def _records(file: BinaryIO) -> "Iterator[McapRecord]":
    """The complete records of a file, in their order, also of one that was cut off."""
    from mcap.exceptions import EndOfFile
    from mcap.stream_reader import StreamReader

    with suppress(EndOfFile):
        yield from StreamReader(io.BytesIO(_whole_records(file)), validate_crcs=True).records


def _of_part(file: BinaryIO) -> Iterator[Found]:
    """As _of_whole for a file that was cut off: record by record, as far as they are complete."""
    from mcap.records import Channel, Message, Metadata, Schema
    from mcap_ros2.decoder import DecoderFactory

    factory = DecoderFactory()
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    decoders: dict[int, Callable[[bytes], Any]] = {}
    for record in _records(file):
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


def finish(path: str | Path, out: str | Path) -> int:
    """Write the complete records of the log ``path`` as a finished file, which any tool opens; returns the
    number of messages."""
    from mcap.records import Channel, Message, Metadata, Schema
    from mcap.writer import Writer

    ids: dict[tuple[type, int], int] = {}
    count = 0
    with open(path, "rb") as file, written(out) as into:
        writer = Writer(into)
        writer.start(profile="ros2", library="meissner")
        for one in _records(file):
            if isinstance(one, Schema) and (Schema, one.id) not in ids:  # a finished file repeats them
                ids[Schema, one.id] = writer.register_schema(one.name, one.encoding, one.data)
            elif isinstance(one, Channel) and (Channel, one.id) not in ids:
                schema = ids[Schema, one.schema_id]
                ids[Channel, one.id] = writer.register_channel(
                    one.topic, one.message_encoding, schema, one.metadata
                )
            elif isinstance(one, Message):
                channel = ids[Channel, one.channel_id]
                writer.add_message(channel, one.log_time, one.data, one.publish_time, one.sequence)
                count += 1
            elif isinstance(one, Metadata):
                writer.add_metadata(one.name, one.metadata)
        writer.finish()
    return count


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


def _values(message: Any) -> dict[str, Any]:
    """The numbers of a message by name. Logs from before the typed messages have named columns or JSON."""
    if hasattr(message, "layout"):
        return dict(zip(message.layout.dim[0].label.split(","), message.data))
    if hasattr(message, "data"):
        return dict(json.loads(message.data)) if isinstance(message.data, str) else {}
    return {name: getattr(message, name) for name in message.__slots__}


def _item(
    topic: str, stamp_ns: int, message: Any, images: dict[int, Any]
) -> packets.Item | packets.Reset | None:
    """The packet of a message; None for one that only repeats others. ``images``: by their stamp."""
    kind, values = topic.removeprefix("/tactile/"), _values(message)
    ticks: int = values.get("ticks", 0)
    if kind == "frame":
        return _frame_item(message, images.pop(stamp_ns, None))
    if kind == "slip" or (kind == "state" and not values["start"]):  # starts are on both topics
        channel, state, p2p = (values[name] for name in ("channel", "state", "p2p"))
        if kind == "slip":
            return packets.SlipEvent(ticks, None, channel, state, p2p, None)
        before, late = values["before"], bool(values["late"])
        return packets.StateChange(ticks, None, channel, state, p2p, None, None, before, late)
    if kind == "states":
        older = (value for name, value in values.items() if name[5:].isdecimal())
        return packets.States(ticks, None, values["first"], tuple(values.get("states", older)))
    if kind == "class":
        before = None if values["before"] == NO_CLASS else values["before"]
        return packets.ClassChange(ticks, None, values["label"], before, values["votes"])
    if kind == "health":
        return packets.Health(ticks, None, values["taxel"], values["faults"])
    if kind == "statistics":
        return packets.Statistics(ticks, None, values["index"], values["value"])
    if kind == "gap":
        return packets.Gap(values["reason"], values["seconds"])
    if kind == "reset":
        return packets.Reset(values["restarts"], values.get("min_load", -1))
    return None


def _frame_item(message: Any, image: Any) -> packets.CopFrame | packets.Image | None:
    scale = message.newtons_per_code
    older = hasattr(message, "taxels")  # such messages hold the image, and x and y in steps of 2^-14
    if message.has_cop:
        x, y = (value / (1 << FRACTION_BITS) if older else value for value in (message.x, message.y))
        return packets.CopFrame(message.ticks, None, x, y, message.load, message.pressed, None, None, None)
    if older:
        taxels = np.array(message.taxels, dtype=np.uint16).reshape(message.rows, message.columns)
    elif image is None:
        return None
    else:
        taxels = np.frombuffer(bytes(image.data), "<u2").reshape(image.height, image.width).astype(np.uint16)
    return packets.Image(message.ticks, None, message.number, taxels, scale if scale > 0 else None)
