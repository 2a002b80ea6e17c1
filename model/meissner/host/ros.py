"""A core's packets as ROS 2 messages, without ROS: docs/ros2.md lists the topics. MCAP files, the ROS node
and the bridges all send what ``Converter`` makes."""

import struct
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from meissner.builds.toolchain import ROOT
from meissner.builds.units import Units
from meissner.host import packets
from meissner.host.core import Core, Counts
from meissner.host.view import state_name
from meissner.twins.core import OF_LOAD
from meissner.twins.link.packet import NO_CLASS
from meissner.twins.slip.slip import State

FRAME_ID = "tactile"  # origin in the array's middle, x to the right, y up, z out of the surface

TOPICS = {
    "/tactile/image": "sensor_msgs/Image",
    "/tactile/frame": "meissner_msgs/TactileFrame",
    "/tactile/cop": "geometry_msgs/PointStamped",
    "/tactile/wrench": "geometry_msgs/WrenchStamped",
    "/tactile/slip": "meissner_msgs/SlipEvent",
    "/tactile/state": "meissner_msgs/SlipEvent",
    "/tactile/states": "meissner_msgs/ChannelStates",
    "/tactile/class": "meissner_msgs/ClassChange",
    "/tactile/health": "meissner_msgs/TaxelHealth",
    "/tactile/statistics": "meissner_msgs/CoreCounter",
    "/tactile/gap": "meissner_msgs/LineGap",
    "/tactile/reset": "meissner_msgs/CoreReset",
    "/diagnostics": "diagnostic_msgs/DiagnosticArray",
}

# Definitions of ROS's own messages: facts of common_interfaces, without their comments.
_STANDARD = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/PointStamped": "std_msgs/Header header\ngeometry_msgs/Point point",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Wrench": "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque",
    "geometry_msgs/WrenchStamped": "std_msgs/Header header\ngeometry_msgs/Wrench wrench",
    "sensor_msgs/Image": "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
    "uint8 is_bigendian\nuint32 step\nuint8[] data",
    "diagnostic_msgs/KeyValue": "string key\nstring value",
    "diagnostic_msgs/DiagnosticStatus": "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
    "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values",
    "diagnostic_msgs/DiagnosticArray": "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status",
}
_FORMATS = {"bool": "?", "byte": "B", "uint8": "B", "uint16": "H", "int32": "i", "uint32": "I"}
_FORMATS |= {"int64": "q", "uint64": "Q", "float64": "d"}
OK, WARN, ERROR = 0, 1, 2  # levels of a DiagnosticStatus
FAULTS = ((1, "dead"), (2, "railed"), (4, "blinking"))  # docs/link.md
# Counters of the line that mean a loss, and how a sentence names them.
_LOSSES = {
    "lost": "packets lost",
    "damaged": "frames damaged",
    "images_lost": "images lost",
    "images_unfit": "images of another size",
    "unread": "packets not taken in time",
    "gaps": "interruptions",
    "restarts": "resets of the core",
}
DIAGNOSE_NS = 10**9  # between two messages of /diagnostics

Message = SimpleNamespace


@cache
def text_of(kind: str) -> str:
    """The definition of a message ("package/Type")."""
    package, _, name = kind.partition("/")
    if package != "meissner_msgs":
        return _STANDARD[kind] + "\n"
    return Path(ROOT / f"ros2/meissner_msgs/msg/{name}.msg").read_text("utf-8")


@cache
def fields(kind: str) -> tuple[tuple[str, str], ...]:
    """(name, type) of each field of a message, without its constants."""
    lines = (line.partition("#")[0].split() for line in text_of(kind).splitlines())
    return tuple((words[1], words[0]) for words in lines if words and "=" not in words[1])


def is_message(kind: str) -> bool:
    return "/" in kind


def definition(kind: str) -> str:
    """The text of ``kind`` with every type that it refers to, as an MCAP schema needs it."""
    needed, text = [kind], ""
    for one in needed:
        text += f"{'=' * 80}\nMSG: {one}\n{text_of(one)}" if one != kind else text_of(one)
        inner = (of.removesuffix("[]") for _, of in fields(one))
        needed += [name for name in dict.fromkeys(inner) if is_message(name) and name not in needed]
    return text


def full_name(kind: str) -> str:
    """As ROS 2 writes it: "package/msg/Type"."""
    return kind.replace("/", "/msg/")


def serialised(kind: str, message: Message) -> bytes:
    """``message`` in CDR, little-endian. A value is aligned to its size, counted from behind the header."""
    out = bytearray(b"\0\1\0\0")
    _put(out, kind, message)
    return bytes(out)


def _put(out: bytearray, kind: str, value: Any) -> None:
    if kind in _FORMATS:
        size = struct.calcsize("<" + _FORMATS[kind])
        out += bytes(-(len(out) - 4) % size) + struct.pack("<" + _FORMATS[kind], value)
    elif kind == "string":
        data = value.encode() + b"\0"
        _put(out, "uint32", len(data))
        out += data
    elif kind.endswith("[]"):
        _put(out, "uint32", len(value))
        if isinstance(value, bytes):
            out += value
        else:
            for one in value:
                _put(out, kind[:-2], one)
    else:
        for name, of in fields(kind):
            _put(out, of, getattr(value, name))


def made(kind: str, message: Message, make: Callable[[str], Any], leaf: Callable[[str, Any], Any]) -> Any:
    """``message`` as an instance of another library's class.

    ``make``: the class of a type; ``leaf``: a value of a basic type, or a sequence of such, as it takes it.
    """
    given: dict[str, Any] = {}
    for name, of in fields(kind):
        value, inner = getattr(message, name), of.removesuffix("[]")
        if not is_message(of):
            given[name] = leaf(of, value)
        elif inner != of:
            given[name] = [made(inner, one, make, leaf) for one in value]
        else:
            given[name] = made(of, value, make, leaf)
    return make(kind)(**given)


def _time(ns: int) -> Message:
    return Message(sec=ns // 10**9, nanosec=ns % 10**9)


def _known(value: float | None) -> float:
    return float("nan") if value is None else float(value)


class Converter:
    """``messages`` of each packet of a core with the units ``known``; ``diagnostics`` about ``core``, whose
    units may change while it runs."""

    def __init__(self, known: Units, core: Core | None = None, frame_id: str = FRAME_ID) -> None:
        self._known, self._core, self._frame_id = known, core, frame_id
        self._boot = core.counts.restarts if core else 0
        self._faults: dict[int, int] = {}
        self._counters: dict[str, int] = {}
        self._told, self._told_counters = Counts(), dict[str, int]()

    @property
    def _units(self) -> Units:
        return self._core.units if self._core else self._known

    def _header(self, stamp_ns: int) -> Message:
        return Message(stamp=_time(stamp_ns), frame_id=self._frame_id)

    def messages(self, stamp_ns: int, item: packets.Item | packets.Reset) -> Iterator[tuple[str, Message]]:
        """(topic, message) of a packet, whose time in UTC is ``stamp_ns``."""
        if isinstance(item, packets.OfBoot) and item.boot != self._boot:
            self._boot = item.boot
            self._faults.clear()
            self._counters.clear()
            self._told_counters = {}
        header = self._header(stamp_ns)
        if isinstance(item, packets.CopFrame):
            yield from self._cop(header, item)
        elif isinstance(item, packets.Image):
            yield from self._image(header, item)
        elif isinstance(item, packets.SlipEvent | packets.StateChange):
            yield from self._change(header, item)
        else:
            yield from self._other(header, item)

    def _frame(self, header: Message, ticks: int, **given: object) -> tuple[str, Message]:
        none: dict[str, object] = {"has_cop": False, "pressed": False, "x": 0.0, "y": 0.0, "load": 0}
        none |= {"has_image": False, "number": 0}
        scale = _known(self._units.newtons_per_code)
        return "/tactile/frame", Message(header=header, ticks=ticks, newtons_per_code=scale, **none | given)

    def _cop(self, header: Message, item: packets.CopFrame) -> Iterator[tuple[str, Message]]:
        values = {"pressed": item.pressed, "x": item.x, "y": item.y, "load": item.load}
        yield self._frame(header, item.time, has_cop=True, **values)
        x, y = (None if mm is None else mm / 1e3 for mm in (item.x_mm, item.y_mm))
        if item.pressed and x is not None and y is not None:
            yield "/tactile/cop", Message(header=header, point=Message(x=x, y=y, z=0.0))
        if item.load_n is not None:
            force = Message(x=0.0, y=0.0, z=float(item.load_n))
            if not item.pressed:
                x = y = 0.0
            # (x, y, 0) × (0, 0, load)
            turn = Message(x=_known(y) * force.z, y=-_known(x) * force.z, z=0.0)
            yield "/tactile/wrench", Message(header=header, wrench=Message(force=force, torque=turn))

    def _image(self, header: Message, item: packets.Image) -> Iterator[tuple[str, Message]]:
        rows, columns = item.taxels.shape
        yield (
            "/tactile/image",
            Message(
                header=header,
                height=rows,
                width=columns,
                encoding="mono16",
                is_bigendian=0,
                step=2 * columns,
                data=item.taxels.astype("<u2").tobytes(),
            ),
        )
        yield self._frame(header, item.time, has_image=True, number=item.number)

    def _change(
        self, header: Message, item: packets.SlipEvent | packets.StateChange
    ) -> Iterator[tuple[str, Message]]:
        start = isinstance(item, packets.SlipEvent)
        before, late = (
            (State.CONTACT, False) if isinstance(item, packets.SlipEvent) else (item.before, item.late)
        )
        clk_khz = self._units.clk_khz or 0
        message = Message(
            header=header,
            ticks=item.time,
            since_reset=_time(item.time * 10**6 // clk_khz if clk_khz else 0),
            channel=item.channel,
            of_load=item.channel == OF_LOAD,
            state=int(item.state),
            state_name=state_name(item.state),
            before=int(before),
            before_name=state_name(before),
            start=start,
            late=late,
            p2p=item.p2p,
            p2p_volts=_known(item.p2p_v),
            p2p_newtons=_known(item.p2p_n),
        )
        if start:
            yield "/tactile/slip", message
        yield "/tactile/state", message

    def _other(self, header: Message, item: packets.Item | packets.Reset) -> Iterator[tuple[str, Message]]:
        given: dict[str, object]
        if isinstance(item, packets.Gap):
            given = {"reason": item.reason, "seconds": float(item.seconds)}
            yield "/tactile/gap", Message(header=header, **given)
        elif isinstance(item, packets.Reset):
            given = {"restarts": item.restarts, "min_load": item.min_load}
            yield "/tactile/reset", Message(header=header, **given)
        elif isinstance(item, packets.States):
            given = {"first": item.first, "states": bytes(map(int, item.states))}
            yield "/tactile/states", Message(header=header, ticks=item.time, **given)
        elif isinstance(item, packets.ClassChange):
            before = NO_CLASS if item.before is None else item.before
            given = {"label": item.label, "before": before, "votes": item.votes}
            yield "/tactile/class", Message(header=header, ticks=item.time, **given)
        elif isinstance(item, packets.Health):
            self._faults[item.taxel] = item.faults
            given = {"taxel": item.taxel, "faults": item.faults}
            yield "/tactile/health", Message(header=header, ticks=item.time, **given)
        elif isinstance(item, packets.Statistics):
            self._counters[item.name] = item.value
            given = {"index": item.index, "name": item.name, "value": item.value}
            yield "/tactile/statistics", Message(header=header, ticks=item.time, **given)

    def diagnostics(self, stamp_ns: int) -> tuple[str, Message]:
        """The state of the line, of the taxels and of the core's counters; what grew since the last call is
        a warning, an interrupted line an error."""
        assert self._core
        status = [self._of_line(self._core), self._of_taxels(), self._of_counters()]
        for one in status:
            one.hardware_id = self._core.line.name
        return "/diagnostics", Message(header=self._header(stamp_ns), status=status)

    def _status(self, name: str, level: int, says: str, values: Iterable[tuple[str, object]]) -> Message:
        return Message(
            level=level,
            name=f"meissner: {name}",
            message=says,
            hardware_id="",
            values=[Message(key=key, value=str(value)) for key, value in values],
        )

    def _of_line(self, core: Core) -> Message:
        counts, before = asdict(core.counts), asdict(self._told)
        self._told = Counts(**counts)
        new = [
            f"{counts[name] - before[name]} {what}"
            for name, what in _LOSSES.items()
            if counts[name] > before[name]
        ]
        level, says = (WARN, "new: " + ", ".join(new)) if new else (OK, "nothing lost")
        if core.interrupted:
            level, says = ERROR, core.interrupted
        return self._status("line", level, says, counts.items())

    def _of_taxels(self) -> Message:
        faulty = {taxel: faults for taxel, faults in sorted(self._faults.items()) if faults}
        columns = self._units.columns
        values = []
        for taxel, faults in faulty.items():
            place = f"row {taxel // columns}, column {taxel % columns}" if columns else f"taxel {taxel}"
            values.append((place, ", ".join(what for bit, what in FAULTS if faults & bit)))
        says = f"{len(faulty)} faulty taxel{'s' * (len(faulty) != 1)}" if faulty else "no faulty taxel"
        return self._status("taxels", WARN if faulty else OK, says, values)

    def _of_counters(self) -> Message:
        before, self._told_counters = self._told_counters, dict(self._counters)
        new = [
            f"{value - before.get(name, 0)} {name}"
            for name, value in self._counters.items()
            if value > before.get(name, 0)
        ]
        says = "new: " + ", ".join(new) if new else "nothing dropped"
        return self._status("core", WARN if new else OK, says, self._counters.items())
