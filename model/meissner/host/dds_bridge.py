"""A core's stream on DDS topics as ROS 2 nodes write them, without ROS: experimental (docs/ros2.md)."""

from collections.abc import Callable
from functools import cache
from typing import Any

from meissner.host.core import Core
from meissner.host.ros import TOPICS, fields, made
from meissner.host.stream import stream

DOMAINS = 232  # the last one, which ROS 2 allows on Linux with few nodes
DEPTH = 10


def classes() -> Callable[[str], Any]:
    """A function that returns Cyclone DDS's class for a message ("package/Type")."""
    try:
        from cyclonedds.idl import make_idl_struct, types
    except ImportError:
        raise ValueError("the bridge to DDS needs cyclonedds: pip install 'meissner-touch[dds]'") from None
    sequence: Any = types.sequence
    basic = {name: getattr(types, name) for name in ("byte", "uint8", "uint16", "int32", "uint32")}
    basic |= {name: getattr(types, name) for name in ("int64", "uint64", "float64")}
    basic |= {"bool": bool, "string": str}

    @cache
    def of(kind: str) -> Any:
        members = {}
        for name, whole in fields(kind):
            one = whole.removesuffix("[]")
            inner = basic[one] if one in basic else of(one)
            members[name] = inner if one == whole else sequence[inner]
        package, name = kind.split("/")
        return make_idl_struct(f"{name}_", f"{package}.msg.dds_.{name}_", members)

    return of


def leaf(kind: str, value: Any) -> Any:
    """A value of a basic type as Cyclone DDS takes it."""
    return list(value) if kind == "uint8[]" else value


def run(core: Core, seconds: float | None, domain: int, say: Callable[[str], object]) -> None:
    """Write the stream until the line ends, or for ``seconds``."""
    if not 0 <= domain <= DOMAINS:
        raise ValueError(f"domain = {domain} must lie in 0 .. {DOMAINS}")
    of = classes()
    from cyclonedds.core import DDSException, Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration

    qos = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(DEPTH),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )
    try:
        participant = DomainParticipant(domain)
        writers = {
            topic: DataWriter(participant, Topic(participant, f"rt{topic}", of(kind), qos=qos), qos=qos)
            for topic, kind in TOPICS.items()
        }
    except DDSException as problem:
        raise OSError(f"DDS domain {domain} cannot be joined: {problem}") from None
    say(f"{len(writers)} topics on DDS domain {domain}, experimental; Ctrl-C ends")
    for found in stream(core, seconds):
        if found is not None:
            stamp, topic, message = found
            writers[topic].write(made(TOPICS[topic], message, of, leaf), stamp)
