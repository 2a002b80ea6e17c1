"""What a core sends, as ROS 2 messages: definitions, bytes and files against rosbags, units and frames by
hand; the node on a stand-in for rclpy. ROS itself is not installed: no message here has met a ROS node."""

import importlib.util
import json
import math
import subprocess
import sys
import time
import types
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.writer import Writer as OldWriter

from harness import rclpy_stand_in as stand_in
from meissner import cli, host
from meissner.builds import units
from meissner.builds.toolchain import ROOT
from meissner.host import foxglove_bridge, line, log, mcap_file, packets, ros, stamps, stream
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p

CLK_KHZ = 1000
KNOWN = units.Units(newtons_per_code=0.25, pitch_mm=2.0, volts_per_code=0.5)
TAXELS = np.array([[1, 2, 65535], [300, 0, 7]], np.uint16)
GAP = packets.Gap("the cable was out, größer", 1.5)
STARTED = 1_790_000_000_123_456_789


def sent():
    """(time, type, payload): a pressed and a released frame, an image, changes of two channels, the rest."""
    yield 1000, p.COP, p.cop_frame(8192, -16384, 12, True)
    yield 2000, p.COP, p.cop_frame(0, 0, 3, False)
    for part in p.image_chunks(9, TAXELS.ravel().tolist(), 4):
        yield 2000, p.IMAGE, part
    yield 4500, p.SLIP, p.slip_event(65535, 14, 3)
    yield 4510, p.CHANGE, p.state_change(7, 0x30201, 4, 3, True)
    yield 4520, p.STATES, p.states([1, 0, 3])[0]
    yield 4530, p.CLASS, p.class_change(3, p.NO_CLASS, 131_069)
    yield 4540, p.CLASS, p.class_change(1, 3, 70_000)
    yield 4600, p.HEALTH, p.health(4, 5)
    yield 4700, p.STATISTIC, p.statistic(2, 77)


def core_of(known=KNOWN, more=()):
    model = SimulatedCore(size=(2, 3), clk_khz=CLK_KHZ, features=["slip", "cop", "calibrate", "link"])
    core = host.Core(line.Pipe(model, "a line"), known, say=lambda _: None)
    for at, kind, payload in (*sent(), *more):
        model.say(kind, at, payload)
    return model, core


def messages(core, *more):
    """[(ns, topic, message)] of what the core sent, at 1 ms a thousand clocks."""
    convert, found = ros.Converter(core.units, core), []
    for item in [*core.packets(0.05), *more]:
        at = getattr(item, "time", 5000) * 1000
        found += [(at, *one) for one in convert.messages(at, item)]
    return [*found, (5_000_000, *convert.diagnostics(5_000_000))]


@pytest.fixture(scope="module")
def store():
    pytest.importorskip("rosbags", reason="rosbags is not installed: pip install rosbags")
    return stand_in.typestore()


def of(found, topic):
    return [message for _, where, message in found if where == topic]


def test_definitions_are_those_of_ros(store):
    """Fields and constants in their order, of every standard type; of our own, what rosbags reads in them."""
    kinds = set(ros.TOPICS.values())
    for top in ros.TOPICS.values():
        kinds |= {text.splitlines()[0] for text in ros.definition(top).split("MSG: ")[1:]}
    assert len(kinds) == 20 and "geometry_msgs/Vector3" in kinds
    from rosbags.typesys import get_types_from_msg

    for kind in kinds:
        name = ros.full_name(kind)
        constants, members = store.fielddefs[name]
        parsed = get_types_from_msg(ros.text_of(kind), name)[name]
        assert parsed == (constants, members), kind
        assert [field for field, _ in ros.fields(kind)] == [field for field, _ in members]


def as_rosbags(store, kind, message):
    """The message as rosbags' class, field by field of rosbags' own definition."""
    given = {}
    for name, node in store.fielddefs[ros.full_name(kind)][1]:
        value = getattr(message, name)
        if node[0].name == "NAME":
            value = as_rosbags(store, node[1].replace("/msg/", "/"), value)
        elif isinstance(value, bytes):
            value = np.frombuffer(value, np.uint8)
        elif node[0].name == "SEQUENCE":
            value = [as_rosbags(store, node[1][0][1].replace("/msg/", "/"), one) for one in value]
        given[name] = value
    return store.types[ros.full_name(kind)](**given)


def test_bytes_are_those_of_rosbags(store):
    _, core = core_of()
    found = messages(core, GAP, packets.Reset(3, -1))
    assert {topic for _, topic, _ in found} == set(ros.TOPICS)
    for _, topic, message in found:
        kind = ros.TOPICS[topic]
        own = ros.serialised(kind, message)
        assert own == bytes(store.serialize_cdr(as_rosbags(store, kind, message), ros.full_name(kind))), topic


def test_the_bytes_of_dds_are_those_of_rosbags():
    """Cyclone DDS' own serialisation against ours, which the test above compares."""
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install 'meissner-touch[dds]'")
    from meissner.host import dds_bridge

    of = dds_bridge.classes()
    found = messages(core_of()[1], GAP, packets.Reset(3, -1))
    for _, topic, message in found:
        kind = ros.TOPICS[topic]
        sample = ros.made(kind, message, of, dds_bridge.leaf)
        assert sample.serialize(use_version_2=False) == ros.serialised(kind, message), topic
        package, name = kind.split("/")
        assert sample.__idl__.idl_transformed_typename == f"{package}::msg::dds_::{name}_"
    assert {topic for _, topic, _ in found} == set(ros.TOPICS)


def test_units_and_frames_by_hand():
    """2 × 3 taxels of 2 mm: 0.5 to the right is 1 mm, the lower edge -1 mm; 12 codes of 0.25 N are 3 N."""
    _, core = core_of()
    found = messages(core)
    [point] = of(found, "/tactile/cop")  # none of the frame that is not pressed
    assert (point.point.x, point.point.y, point.point.z) == (0.001, -0.001, 0.0)
    assert vars(point.header.stamp) == {"sec": 0, "nanosec": 1_000_000} and point.header.frame_id == "tactile"
    pressed, released = (one.wrench for one in of(found, "/tactile/wrench"))
    assert vars(pressed.force) == {"x": 0, "y": 0, "z": 3}
    assert vars(pressed.torque) == {"x": -0.003, "y": -0.003, "z": 0}  # r × F of (1, -1) mm and 3 N along z
    assert vars(released.force) == {"x": 0, "y": 0, "z": 0.75} and not any(vars(released.torque).values())
    [image] = of(found, "/tactile/image")
    assert (image.height, image.width, image.step, image.encoding, image.is_bigendian) == (
        2,
        3,
        6,
        "mono16",
        0,
    )
    assert image.data == bytes([1, 0, 2, 0, 255, 255, 44, 1, 0, 0, 7, 0])
    first, _, shown = of(found, "/tactile/frame")
    assert (first.ticks, first.x, first.y, first.load, first.has_image) == (1000, 0.5, -1.0, 12, False)
    assert (shown.ticks, shown.number, shown.has_image, shown.has_cop) == (2000, 9, True, False)
    assert shown.newtons_per_code == 0.25 and shown.header.stamp == image.header.stamp
    [slip], changes = of(found, "/tactile/slip"), of(found, "/tactile/state")
    assert changes[0] == slip and len(changes) == 2
    named = (slip.channel, slip.of_load, slip.state_name, slip.before_name, slip.start, slip.late)
    assert named == (65535, True, "gross", "contact", True, False)
    assert (slip.ticks, slip.p2p, round(slip.p2p_volts, 9)) == (4500, 14, round(7 / math.sqrt(2), 9))
    assert vars(slip.since_reset) == {"sec": 0, "nanosec": 4_500_000} and math.isnan(slip.p2p_newtons)
    other = changes[1]
    assert (other.channel, other.of_load, other.state, other.before) == (7, False, 4, 3)
    assert (other.state_name, other.before_name, other.late, other.start) == ("release", "gross", True, False)
    classes = [(one.ticks, one.label, one.before, one.votes) for one in of(found, "/tactile/class")]
    assert classes == [(4530, 3, 65535, 131_069), (4540, 1, 3, 70_000)]
    assert of(found, "/tactile/states")[0].states == bytes([1, 0, 3])
    assert of(found, "/tactile/statistics")[0].name == "time-outs"


def test_without_units_no_metres_and_no_newtons():
    _, core = core_of(units.Units())
    found = messages(core)
    assert not of(found, "/tactile/cop") and not of(found, "/tactile/wrench")
    frame, slip = of(found, "/tactile/frame")[0], of(found, "/tactile/slip")[0]
    assert (frame.x, frame.load) == (0.5, 12) and math.isnan(frame.newtons_per_code)
    assert math.isnan(slip.p2p_volts)
    _, core = core_of(units.Units(newtons_per_code=0.25))  # a load, but nobody knows where
    wrench = of(messages(core), "/tactile/wrench")[0].wrench
    assert wrench.force.z == 3 and math.isnan(wrench.torque.x) and math.isnan(wrench.torque.y)


def test_diagnostics_by_hand():
    _, core = core_of()
    convert = ros.Converter(core.units, core)
    for item in core.packets(0.05):
        list(convert.messages(0, item))
    _, taxels, counters = convert.diagnostics(1)[1].status
    assert (taxels.level, taxels.message) == (1, "1 faulty taxel")
    assert [vars(one) for one in taxels.values] == [{"key": "row 1, column 1", "value": "dead, blinking"}]
    assert (counters.level, counters.message) == (1, "new: 77 time-outs")
    said, _, counters = convert.diagnostics(2)[1].status
    assert (said.level, said.message, said.hardware_id) == (0, "nothing lost", "a line")
    assert (counters.level, counters.message) == (0, "nothing dropped")
    core.counts.lost += 3
    core.counts.gaps += 1
    said = convert.diagnostics(3)[1].status[0]
    assert (said.level, said.message) == (1, "new: 3 packets lost, 1 interruptions")
    assert {"key": "lost", "value": "3"} in [vars(one) for one in said.values]
    assert convert.diagnostics(4)[1].status[0].level == 0
    core._lost(line.Gone("a line is gone"))
    assert (convert.diagnostics(5)[1].status[0].level, core.interrupted) == (2, "a line is gone")
    taxels = ros.Converter(core.units, core)
    list(taxels.messages(0, packets.Health(1, None, 4, 1, boot=core.counts.restarts)))
    list(taxels.messages(0, packets.Health(1, None, 5, 2, boot=core.counts.restarts + 1)))  # after a reset
    assert [one.key for one in taxels.diagnostics(0)[1].status[1].values] == ["row 1, column 2"]


def recorded(path, more=(GAP,)):
    _, core = core_of()
    fixed = types.SimpleNamespace(time_ns=lambda: STARTED, monotonic=time.monotonic)
    with mock.patch.object(stamps, "time", fixed), log.recording(path, core) as recording:
        for item in [*core.packets(0.05), *more]:
            recording.add(item)


def test_a_log_declares_every_topic(tmp_path):
    """Also without a packet; the schemas stand alone."""
    with log.recording(tmp_path / "none.mcap", host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))):
        pass
    with open(tmp_path / "none.mcap", "rb") as file:
        summary = make_reader(file).get_summary()
    schemas = {schema.id: schema for schema in summary.schemas.values()}
    found = {one.topic: schemas[one.schema_id].name for one in summary.channels.values()}
    assert found == {topic: ros.full_name(kind) for topic, kind in ros.TOPICS.items()}
    assert found["/tactile/image"] == "sensor_msgs/msg/Image" and summary.statistics.message_count == 0
    assert all("reliability: 1" in one.metadata["offered_qos_profiles"] for one in summary.channels.values())


def through_rosbags(path, store):
    """{topic: [(ns, message as rosbags decodes it)]}, each with the definition in the file."""
    from rosbags.highlevel import AnyReader

    found = {}
    with AnyReader([path]) as reader:
        for connection, at, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            again = reader.typestore.serialize_cdr(message, connection.msgtype)
            assert bytes(again) == bytes(data)
            found.setdefault(connection.topic, []).append((at, bytes(data), message))
        topics = {connection.topic for connection in reader.connections}
    return topics, found


def test_rosbags_opens_and_converts_a_log_without_loss(tmp_path, store):
    recorded(tmp_path / "a.mcap")
    topics, found = through_rosbags(tmp_path / "a.mcap", store)
    assert topics == set(ros.TOPICS)
    assert [len(found[topic]) for topic in ("/tactile/frame", "/tactile/state", "/tactile/gap")] == [3, 2, 1]
    image = found["/tactile/image"][0][2]
    assert np.array_equal(image.data.view("<u2").reshape(2, 3), TAXELS)
    slip = found["/tactile/slip"][0][2]
    assert (slip.state_name, slip.ticks, slip.state == slip.GROSS) == ("gross", 4500, True)
    for kind in ("sqlite3", "mcap"):
        command = [sys.executable, "-m", "rosbags.convert", "--src", str(tmp_path / "a.mcap")]
        command += ["--dst", str(tmp_path / kind), "--dst-storage", kind]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        again = through_rosbags(tmp_path / kind, store)
        assert {topic: sorted(one[:2] for one in found[topic]) for topic in found} == {
            topic: sorted(one[:2] for one in again[1][topic]) for topic in again[1]
        }


def test_a_log_that_is_cut_still_opens(tmp_path):
    """At many lengths: what is complete is read, and an image comes with its number or not at all."""
    with mock.patch.object(log, "FLUSH_S", -1.0):
        recorded(tmp_path / "a.mcap")
    whole, most = (tmp_path / "a.mcap").read_bytes(), 0
    for end in range(len(whole) // 3, len(whole), 97):
        (tmp_path / "cut.mcap").write_bytes(whole[:end])
        try:
            found = log.read(tmp_path / "cut.mcap")
        except ValueError:
            assert not most
            continue
        assert found["partial"] and len(found["image"]) == len(found["image_number"])
        count = sum(len(found[f"{kind}_ns"]) for kind in ("cop", "image", "change", "state", "gap"))
        assert count >= most
        most = count
    assert most == 2 + 1 + 2 + 3 + 1
    assert np.array_equal(found["image"][0], TAXELS)


def test_an_unfinished_log_is_finished_for_other_tools(tmp_path, store, monkeypatch, capsys):
    """rosbags refuses a file without its end; finished, it has every message up to the cut."""
    from rosbags.highlevel import AnyReader, AnyReaderError

    with mock.patch.object(log, "FLUSH_S", -1.0):  # one chunk per packet
        recorded(tmp_path / "a.mcap")
    whole = (tmp_path / "a.mcap").read_bytes()
    monkeypatch.chdir(tmp_path)
    with open("a.mcap", "rb") as file:
        chunk = make_reader(file).get_summary().chunk_indexes[-2]
    Path("cut.mcap").write_bytes(whole[: chunk.chunk_start_offset + chunk.chunk_length - 1])
    with pytest.raises(AnyReaderError), AnyReader([Path("cut.mcap")]):
        pass
    counts = []
    for name in ("cut.mcap", "a.mcap"):
        cli.main(["replay", name, "--out", f"whole_{name}"])
        topics, found = through_rosbags(Path(f"whole_{name}"), store)
        assert topics == set(ros.TOPICS)
        with open(f"whole_{name}", "rb") as file:
            assert len(make_reader(file).get_summary().channels) == len(ros.TOPICS)
        counts.append(sum(map(len, found.values())))
        assert capsys.readouterr().out == f"{counts[-1]} messages of {name}; whole_{name}\n"
        again, first = log.read(f"whole_{name}"), log.read(name)
        assert "partial" not in again and ("partial" in first) == (name == "cut.mcap")
        assert all(np.array_equal(again[key], first[key]) for key in again)
    assert 10 < counts[0] < counts[1]
    assert through_rosbags(Path("a.mcap"), store)[1].keys() == found.keys()
    recorded(tmp_path / "b.npz")
    for given in (("b.npz", "--out", "b.mcap"), ("a.mcap", "--out", "a.mcap", "--overwrite")):
        with pytest.raises(SystemExit):
            cli.main(["replay", *given])
    assert capsys.readouterr().err.splitlines() == [
        "meissner: b.npz is no MCAP file, so --out cannot be one: name a .npz or .csv file",
        "meissner: a.mcap is an input of this command: name another output",
    ]
    assert (tmp_path / "a.mcap").read_bytes() == whole and not Path("b.mcap").exists()


OLD_FRAME = """std_msgs/Header header
uint64 ticks
bool has_cop
bool pressed
int32 x
int32 y
uint64 load
uint32 rows
uint32 columns
uint8 number
uint16[] taxels
float64 newtons_per_code
"""
OLD_NUMBERS = """std_msgs/MultiArrayLayout layout
int64[] data
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""
OLD_HEADER = """MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
OLD = (  # topic, names of the columns, a row
    ("slip", "ticks,channel,state,p2p", [40, 1, 2, 70]),
    ("state", "ticks,channel,state,before,p2p,late,start", [40, 1, 2, 1, 70, 0, 1]),
    ("state", "ticks,channel,state,before,p2p,late,start", [50, 1, 4, 2, 60, 1, 0]),
    ("states", "ticks,first,state0,state1", [55, 3, 1, 4]),
    ("class", "ticks,label,before,votes", [57, 3, 65535, 8]),
    ("health", "ticks,taxel,faults", [60, 5, 4]),
    ("statistics", "ticks,index,value", [70, 2, 9]),
)


def test_a_log_from_before_the_typed_messages_is_read(tmp_path):
    """As such a log was: images and CoP in TactileFrame, named columns of numbers, JSON."""
    rule = "=" * 80 + "\nMSG: "
    with open(tmp_path / "old.mcap", "wb") as file:
        old = OldWriter(file)
        old.add_metadata("meissner", {"clk_khz": "1000", "min_load": "4", "newtons_per_code": "nan"})
        kinds = {
            name: old.register_msgdef(f"{package}/msg/{name}", text.replace("MSG: ", rule))
            for package, name, text in (
                ("meissner_msgs", "TactileFrame", OLD_FRAME + OLD_HEADER),
                ("std_msgs", "Int64MultiArray", OLD_NUMBERS),
                ("std_msgs", "String", "string data\n"),
                ("std_msgs", "Float64", "float64 data\n"),
            )
        }
        header = {"stamp": {"sec": 0, "nanosec": 5}, "frame_id": "tactile"}
        frame = {"header": header, "ticks": 10, "newtons_per_code": 0.0}
        cop = {"has_cop": True, "pressed": True, "x": -3, "y": 16384, "load": 99, "taxels": []}
        old.write_message("/tactile/frame", kinds["TactileFrame"], frame | cop, 5)
        old.write_message("/tactile/load", kinds["Float64"], {"data": 99.0}, 5)
        image = {"rows": 2, "columns": 3, "number": 8, "taxels": TAXELS.ravel().tolist()}
        old.write_message("/tactile/frame", kinds["TactileFrame"], frame | image, 5)
        for topic, labels, row in OLD:
            dim = [{"label": labels, "size": len(row), "stride": len(row)}]
            message = {"layout": {"dim": dim, "data_offset": 0}, "data": row}
            old.write_message(f"/tactile/{topic}", kinds["Int64MultiArray"], message, 6)
        for topic, said in (
            ("gap", {"reason": "out", "seconds": 2.5}),
            ("reset", {"restarts": 1, "min_load": 6}),
        ):
            old.write_message(f"/tactile/{topic}", kinds["String"], {"data": json.dumps(said)}, 7)
        old.finish()
    found = log.read(tmp_path / "old.mcap")
    wanted = {
        **{"cop_x": [-3], "cop_y": [16384], "cop_load": [99], "image_number": [8], "slip_p2p": [70]},
        **{"change_state": [2, 4], "change_before": [1, 2], "change_late": [False, True]},
        **{"state_channel": [3, 4], "state_state": [1, 4], "health_taxel": [5], "statistics_value": [9]},
        **{"class_label": [3], "class_before": [65535], "class_votes": [8]},
        **{"gap_reason": ["out"], "gap_seconds": [2.5], "reset_min_load": [6], "change_start": [True, False]},
    }
    assert {name: found[name].tolist() for name in wanted} == wanted
    assert np.array_equal(found["image"][0], TAXELS) and int(found["min_load"]) == 4
    [first] = [one for _, one in mcap_file.read(tmp_path / "old.mcap")[1] if hasattr(one, "votes")]
    assert first.before is None


def test_live_stamps_by_hand():
    """A clock is 1 us; the machine's time is set before each packet, whose stamp must be the third number."""
    ms = 10**6
    model = SimulatedCore(clk_khz=CLK_KHZ)
    core = host.Core(line.Pipe(model), registers=False, say=lambda _: None)
    core.units = units.Units(clk_khz=CLK_KHZ)
    now = [0]
    fixed = types.SimpleNamespace(time_ns=lambda: now[0])
    with mock.patch.object(stamps, "time", fixed):
        stamp = stamps.Stamps(core, follow=True)
        for at_us, now[0], wanted in (
            (1000, 100 * ms, 100 * ms),  # the first is taken as of now
            (2000, 100 * ms + ms // 2, 100 * ms + ms // 2),  # came early: the first one had waited
            (3000, 102 * ms + ms // 2, 101 * ms + ms // 2 + 400),  # 1 ms late; 2 ms passed, 200 ppm of drift
            (4000, 102 * ms + ms // 2 + 400, 102 * ms + ms // 2 + 400),  # in time
            (5000, 1103 * ms + ms // 2 + 400, 103 * ms + ms // 2 + 400 + 200_200),  # 1 s late is only late
            (6000, 3000 * ms, 3000 * ms),  # the core's clock stood still
        ):
            [(got, _)] = stamp.next(packets.Statistics(at_us, None, 0, 0))
            assert got == wanted, (at_us, got - wanted)


def node_class(monkeypatch, store):
    """The node's module, imported with the stand-in in place of rclpy."""
    rclpy = stand_in.install(monkeypatch, store)
    path = ROOT / "ros2/meissner_ros/meissner_ros/node.py"
    spec = importlib.util.spec_from_file_location("meissner_node", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return rclpy, module


def test_the_node_publishes_every_message(monkeypatch, store):
    """Through classes that refuse a wrong field, type or range; bytes as the converter's own."""
    rclpy, module = node_class(monkeypatch, store)
    _, core = core_of()
    monkeypatch.setattr(module.host, "connect", lambda *_, **__: core)
    node = module.TactileNode()
    never = {"/tactile/gap", "/tactile/reset"}
    wanted = {topic if topic == "/diagnostics" else topic[1:] for topic in set(ros.TOPICS) - never}
    monkeypatch.setattr(rclpy, "ok", lambda: not wanted <= {topic for topic, _ in node.published})
    node.run()  # ends with ROS
    found = {}
    for topic, message in node.published:
        found.setdefault(topic, []).append(message)
    assert set(found) == wanted
    for message in (one for every in found.values() for one in every):
        store.serialize_cdr(stand_in.plain(store, message), message.KIND)
    assert found["tactile/slip"][0].state_name == "gross"
    assert bytes(found["tactile/image"][0].data) == TAXELS.tobytes()
    assert found["/diagnostics"][0].status[1].level == b"\1"
    for item in (GAP, packets.Reset(3, -1)):
        [(topic, message)] = ros.Converter(core.units, core).messages(0, item)
        module.made(ros.TOPICS[topic], message, module.message_class, module.leaf)


def test_the_stand_in_refuses_what_rclpy_refuses(monkeypatch, store):
    _, module = node_class(monkeypatch, store)
    for kind, given in (
        ("geometry_msgs/Vector3", {"x": 1.0, "y": 2.0, "z": 3}),  # an integer is no float
        ("geometry_msgs/Vector3", {"x": 1.0, "y": 2.0}),
        ("geometry_msgs/Vector3", {"x": 1.0, "y": 2.0, "z": 3.0, "w": 4.0}),
        ("builtin_interfaces/Time", {"sec": 1 << 31, "nanosec": 0}),
        ("builtin_interfaces/Time", {"sec": 0, "nanosec": -1}),
        ("std_msgs/Header", {"stamp": None, "frame_id": "a"}),
        ("diagnostic_msgs/KeyValue", {"key": "a", "value": 1}),
    ):
        with pytest.raises(AssertionError):
            module.message_class(kind)(**given)


def test_the_nodes_parameters_are_the_cores_thresholds(monkeypatch, store):
    _, module = node_class(monkeypatch, store)
    _, core = core_of()
    core["slip.threshold"] = 55
    monkeypatch.setattr(module.host, "connect", lambda *_, **__: core)
    monkeypatch.setattr(module.Node, "overrides", {"cop.min_load": 9})
    node = module.TactileNode()
    assert node.parameters["slip.threshold"].value == 55 and core["cop.min_load"] == 9
    assert {
        "slip.hold",
        "slip.contact_level",
    } <= node.parameters.keys() and "cop4.min_load" not in node.parameters
    assert node.set_parameters(slip__threshold=40, slip__hold=3).successful
    assert (core["slip.threshold"], core["slip.hold"]) == (40, 3)
    largest = core.check("slip.threshold").ends(core.build)[1]
    for given, why in (
        ({"slip__hold": 4, "slip__threshold": largest + 1}, "slip.threshold"),
        ({"slip__hold": 4.5}, "slip.hold = 4.5 must be an integer"),
        ({"port": "sim:"}, "port is read when the node starts"),
    ):
        refused = node.set_parameters(**given)
        assert not refused.successful and why in refused.reason
    assert (core["slip.threshold"], core["slip.hold"]) == (40, 3)  # all or none
    core._lost(line.Gone("a line is gone"))
    core._try_at = math.inf
    assert not node.set_parameters(slip__hold=5).successful


def test_thresholds_that_read_back_otherwise_are_put_back():
    model, core = core_of()
    core["slip.hold"] = 2
    core.build |= {"timer": 32}  # the host believes in wider registers
    model.registers.widths["timer"] = 4
    with pytest.raises(ValueError, match=r"slip.hold reads back 15 where 99 was written"):
        stream.set_thresholds(core, {"slip.hold": 99, "slip.blank": 1})
    assert (core["slip.hold"], core["slip.blank"]) == (2, 0)
    assert stream.thresholds(host.Core(line.Pipe(model), registers=False)) == []
    for wrong in (
        {"slip.events": 1},
        {"adc.period": 9},
        {"slip.hold": "3"},
        {"slip.hold": math.nan},
        {"slip.hold": True},
    ):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            stream.set_thresholds(core, wrong)


def test_the_layout_shows_what_is_sent():
    layout = json.loads(foxglove_bridge.LAYOUT.read_text("utf-8"))
    shown = []
    for panel in layout["configById"].values():
        shown += [path["value"] for path in panel.get("paths", [])]
        shown += [panel[key] for key in ("topicPath", "topicToRender") if key in panel]
        shown += [panel["imageMode"]["imageTopic"]] if "imageMode" in panel else []
    assert len(shown) == 8
    for path in shown:
        topic, *names = path.replace("{channel==0}", "").split(".")
        kind = ros.TOPICS[topic]
        for name in names:
            kind = dict(ros.fields(kind))[name]
    text = json.dumps(layout["layout"])
    assert all(f'"{panel}"' in text for panel in layout["configById"])


def test_the_packages_are_whole(monkeypatch, store):
    """What colcon would read: every message is built, every import of the node is required, the entry point
    exists, and the launch file names what the node declares; run with stand-ins for setuptools and launch."""
    import runpy
    from xml.etree import ElementTree

    folder = ROOT / "ros2"
    built = (folder / "meissner_msgs/CMakeLists.txt").read_text("utf-8")
    own = {f"msg/{path.name}" for path in (folder / "meissner_msgs/msg").glob("*.msg")}
    assert {line.strip(' "') for line in built.splitlines() if ".msg" in line} == own
    needed = {}
    for name in ("meissner_msgs", "meissner_ros"):
        package = ElementTree.parse(folder / name / "package.xml").getroot()
        assert (package.get("format"), package.findtext("name")) == ("3", name)
        needed[name] = {one.text for one in package if one.tag.endswith("depend")}
    kinds = {kind.split("/")[0] for kind in ros.TOPICS.values()}
    assert needed["meissner_ros"] >= kinds | {"rclpy", "rcl_interfaces", "launch_ros"}
    assert needed["meissner_msgs"] >= {"std_msgs", "builtin_interfaces", "rosidl_default_generators"}
    _, module = node_class(monkeypatch, store)
    made = types.SimpleNamespace()
    monkeypatch.setattr("setuptools.setup", lambda **given: vars(made).update(given))
    monkeypatch.chdir(folder / "meissner_ros")
    runpy.run_path("setup.py")
    assert made.entry_points["console_scripts"] == ["meissner = meissner_ros.node:main"] and module.main
    files = [name for _, names in made.data_files for name in names]
    assert len(files) == 4 and all((folder / "meissner_ros" / name).is_file() for name in files)

    def keep(*given, **named):
        return types.SimpleNamespace(given=given, **named)

    for name, words in {
        "ament_index_python.packages": ["get_package_share_directory"],
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument"],
        "launch.substitutions": ["LaunchConfiguration"],
        "launch_ros.actions": ["Node"],
        "launch_ros.parameter_descriptions": ["ParameterValue"],
    }.items():
        stand = types.ModuleType(name)
        vars(stand).update(dict.fromkeys(words, keep))
        monkeypatch.setitem(sys.modules, name, stand)
    vars(sys.modules["ament_index_python.packages"])["get_package_share_directory"] = lambda name: f"/{name}"
    launch = runpy.run_path("launch/meissner.launch.py")["generate_launch_description"]()
    *declared, node = launch.given[0]
    assert (node.package, node.executable) == ("meissner_ros", "meissner")
    monkeypatch.setattr(module.host, "connect", lambda *_, **__: core_of()[1])
    parameters = module.TactileNode().parameters
    assert set(node.parameters[1]) <= parameters.keys()
    assert {one.given[0] for one in declared} == {*node.parameters[1], "thresholds"}


def test_the_node_says_in_a_sentence_why_it_ends(monkeypatch, store, capsys):
    _, module = node_class(monkeypatch, store)
    monkeypatch.setattr(module.Node, "overrides", {"port": "telepathy"})
    assert module.main() == 2
    assert "'telepathy' is not a line" in capsys.readouterr().err
