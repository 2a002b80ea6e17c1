"""The bridges as another program meets them: DDS topics in a second process that knows nothing of this code,
a websocket client of Foxglove's protocol. Neither has met ROS or Foxglove itself."""

import json
import os
import socket
import struct
import subprocess
import sys
import threading
from itertools import count

import numpy as np
import pytest
from mcap_ros2._dynamic import generate_dynamic

from harness import rclpy_stand_in as stand_in
from meissner import host
from meissner.builds import units
from meissner.host import foxglove_bridge, line, ros
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p

TAXELS = np.array([[1, 2, 65535], [300, 0, 7]], np.uint16)
CLK_KHZ = 1000


def endless(core):
    """An image and a slip of channel 5 every 10 ms of the core's clock; p2p is the threshold of then."""
    for k in count(1):
        at = 10_000 * k
        core.boundary()
        for part in p.image_chunks(k, TAXELS.ravel().tolist()):
            yield at, p.IMAGE, part
        yield at, p.SLIP, p.slip_event(5, core.registers.setting("slip", "threshold"), 2)


def connected():
    model = SimulatedCore(endless, size=(2, 3), clk_khz=CLK_KHZ, features=["slip", "cop", "link"], speed=1.0)
    return host.Core(line.Pipe(model, "a line"), units.Units(), say=lambda _: None)


READER = """
import sys
from dataclasses import dataclass
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

@dataclass
class Time_(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: types.int32
    nanosec: types.uint32

@dataclass
class Header_(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Time_
    frame_id: str

@dataclass
class Image_(IdlStruct, typename="sensor_msgs.msg.dds_.Image_"):
    header: Header_
    height: types.uint32
    width: types.uint32
    encoding: str
    is_bigendian: types.uint8
    step: types.uint32
    data: types.sequence[types.uint8]

participant = DomainParticipant(int(sys.argv[1]))
qos = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)
reader = DataReader(participant, Topic(participant, "rt/tactile/image", Image_, qos=qos), qos=qos)
for found in reader.take_iter(timeout=duration(seconds=500)):
    stamp = found.header.stamp
    print(stamp.sec, stamp.nanosec, found.serialize(use_version_2=False).hex(), flush=True)
    break
"""


def image(store, sec, nanosec):
    """The message by hand, as rosbags writes it."""
    of = store.types
    stamp = of["builtin_interfaces/msg/Time"](sec, nanosec)
    header = of["std_msgs/msg/Header"](stamp, "tactile")
    data = np.array([1, 0, 2, 0, 255, 255, 44, 1, 0, 0, 7, 0], np.uint8)
    message = of["sensor_msgs/msg/Image"](header, 2, 3, "mono16", 0, 6, data)
    return bytes(store.serialize_cdr(message, "sensor_msgs/msg/Image"))


@pytest.fixture
def loopback(monkeypatch):
    """DDS on this machine alone."""
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install 'meissner-touch[dds]'")
    interfaces = "<General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces></General>"
    peers = "<Peers><Peer address='localhost'/></Peers><ParticipantIndex>auto</ParticipantIndex>"
    peers = f"<Discovery>{peers}</Discovery>"
    monkeypatch.setenv(
        "CYCLONEDDS_URI", f"<CycloneDDS><Domain id='any'>{interfaces}{peers}</Domain></CycloneDDS>"
    )


def test_dds_is_read_by_a_second_process(loopback):
    from meissner.host import dds_bridge

    store, domain, said = stand_in.typestore(), 100 + os.getpid() % 100, []
    reader = subprocess.Popen([sys.executable, "-c", READER, str(domain)], stdout=subprocess.PIPE, text=True)
    core = connected()
    ended = threading.Thread(target=lambda: (reader.wait(), core.stop()))
    ended.start()
    dds_bridge.run(core, 500, domain, said.append)
    out = reader.stdout.read().split()
    ended.join()
    assert bytes.fromhex(out[2]) == image(store, int(out[0]), int(out[1]))
    assert said == [f"13 topics on DDS domain {domain}, experimental; Ctrl-C ends"]


class Client:
    """A websocket client with as much of RFC 6455 as this server needs."""

    def __init__(self, port, protocol):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=500)
        self.said, self.kept = "", b""
        lines = ["GET / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Upgrade: websocket", "Connection: Upgrade"]
        lines += ["Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Version: 13"]
        lines += [f"Sec-WebSocket-Protocol: {protocol}", "", ""]
        self.socket.sendall("\r\n".join(lines).encode())
        while not self.said.endswith("\r\n\r\n"):
            self.said += self._take(1).decode()

    def _take(self, count):
        found = b""
        while len(found) < count:
            more = self.socket.recv(count - len(found))
            assert more, "the server closed the line"
            found += more
        return found

    def say(self, **message):
        data = json.dumps(message).encode()
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
        self.socket.sendall(b"\x81" + size + bytes(4) + data)  # a mask of zeros

    def next(self):
        """A dict, or (subscription, ns, data)."""
        kind, size = self._take(2)
        if size > 125:
            size = int.from_bytes(self._take(2 if size == 126 else 8), "big")
        data = self._take(size)
        if kind == 0x81:
            return json.loads(data)
        assert kind == 0x82 and data[0] == 1, (kind, data[:9])
        return *struct.unpack("<IQ", data[1:13]), data[13:]

    def until(self, wanted):
        while not wanted(found := self.next()):
            pass
        return found


@pytest.fixture
def served():
    """(port, sentences) of the bridge before a simulated core, in a thread."""
    pytest.importorskip(
        "foxglove", reason="foxglove-sdk is not installed: pip install 'meissner-touch[foxglove]'"
    )
    said, core = [], connected()
    listening = threading.Event()
    arguments = (core, 500, "127.0.0.1:0", lambda text: (said.append(text), listening.set()))
    bridge = threading.Thread(target=foxglove_bridge.run, args=arguments)
    bridge.start()
    listening.wait(500)
    yield int(said[0].partition("127.0.0.1:")[2].partition(",")[0]), said
    core.stop()
    bridge.join()


def test_foxglove_gets_the_stream_and_sets_thresholds(served):
    port, said = served
    client = Client(port, "foxglove.sdk.v1")
    assert " 101 " in client.said.splitlines()[0]
    assert "parameters" in client.until(lambda one: one["op"] == "serverInfo")["capabilities"]
    channels = {}
    while len(channels) < len(ros.TOPICS):
        found = client.until(lambda one: one["op"] == "advertise")["channels"]
        channels |= {one["topic"]: one for one in found}
    for topic, kind in ros.TOPICS.items():
        one = channels[topic]
        assert (one["encoding"], one["schemaName"], one["schemaEncoding"]) == (
            "cdr",
            ros.full_name(kind),
            "ros2msg",
        )
        assert one["schema"] == ros.definition(kind)
    wanted = ("/tactile/image", "/tactile/slip")
    numbers = [{"id": k, "channelId": channels[topic]["id"]} for k, topic in enumerate(wanted)]
    client.say(op="subscribe", subscriptions=numbers)
    _, at, data = client.until(lambda one: isinstance(one, tuple) and one[0] == 0)
    sec, nanosec = struct.unpack_from("<iI", data, 4)
    assert at == sec * 10**9 + nanosec and data.endswith(TAXELS.tobytes())
    client.say(op="getParameters", parameterNames=["slip.threshold"], id="a")
    answer = client.until(lambda one: isinstance(one, dict) and one.get("id") == "a")["parameters"]
    assert [(one["name"], one["value"]) for one in answer] == [
        ("slip.threshold", (1 << 18) - 1)
    ]  # the widest of 18 bits
    client.say(op="setParameters", parameters=[{"name": "slip.threshold", "value": 321}], id="b")
    answer = client.until(lambda one: isinstance(one, dict) and one.get("id") == "b")["parameters"]
    assert [(one["name"], one["value"]) for one in answer] == [("slip.threshold", 321)]
    decode = make_decoder("/tactile/slip")
    client.until(lambda one: isinstance(one, tuple) and one[0] == 1 and decode(one[2]).p2p == 321)
    client.say(op="setParameters", parameters=[{"name": "slip.threshold", "value": 3.5}], id="c")
    warned = client.until(lambda one: isinstance(one, dict) and one["op"] == "status")
    assert "slip.threshold = 3.5 must be an integer" in warned["message"] and said[-1] == warned["message"]
    answer = client.until(lambda one: isinstance(one, dict) and one.get("id") == "c")["parameters"]
    assert answer[0]["value"] == 321
    client.say(op="getParameters", parameterNames=[], id="d")
    answer = client.until(lambda one: isinstance(one, dict) and one.get("id") == "d")["parameters"]
    assert {"slip.threshold", "slip.hold", "cop.min_load"} <= {one["name"] for one in answer}


def make_decoder(topic):
    return generate_dynamic(ros.full_name(ros.TOPICS[topic]), ros.definition(ros.TOPICS[topic]))[
        ros.full_name(ros.TOPICS[topic])
    ]


def test_an_old_client_and_a_taken_port_are_refused(served):
    port, _ = served
    assert " 400 " in Client(port, "foxglove.websocket.v1").said.splitlines()[0]
    with pytest.raises(OSError, match=rf"127.0.0.1:{port} cannot be listened on"):
        foxglove_bridge.run(connected(), 1, f"127.0.0.1:{port}", lambda _: None)
    for wrong in ("8765", ":8765", "a:b", "a:65536"):
        with pytest.raises(ValueError, match="listen-on"):
            foxglove_bridge.address(wrong)
    assert foxglove_bridge.address("[::1]:8765") == ("::1", 8765)
