"""Logs of a simulated core: the stream's data are in the .npz and in the .mcap, to the bit; MCAP is read
back with mcap-ros2's own decoder, message by message; clocks become time by the core's clock; a log that
cannot be written or read is refused completely; a replay finds every frame for which the engine gives
another result."""

import math
import time
import types
from unittest import mock

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from meissner import engines, host
from meissner.builds import units
from meissner.host import line, log, packets, stamps
from meissner.host.replay import changes, differences, replay
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p

CLK_KHZ = 1000
FRAMES = np.random.default_rng(1).integers(0, 65536, (4, 3, 4))
FRAMES[2] = 0


def items():
    """One packet of every kind; CoP and images of four frames, the last without CoP."""
    cop = engines.process_cop(FRAMES, "fixed")
    for k, frame in enumerate(FRAMES):
        at = 1000 * (k + 1)
        if k < 3:
            x, y, load, pressed = (int(cop[name][k]) for name in ("x", "y", "sum", "valid"))
            yield at, p.COP, p.cop_frame(x, y, load, pressed)
        for part in p.image_chunks(k, frame.ravel().tolist(), 5):
            yield at, p.IMAGE, part
    yield 4500, p.SLIP, p.slip_event(65535, (1 << 24) - 1, 3)
    yield 4510, p.CHANGE, p.state_change(7, 0x30201, 4, 3, True)
    yield 4520, p.STATES, p.states([1, 0, 3])[0]
    yield 4530, p.CLASS, p.class_change(2, 65535, 99_000)
    yield 4540, p.CLASS, p.class_change(65534, 2, (1 << 32) - 1)
    yield 4600, p.HEALTH, p.health((1 << 24) - 1, 255)
    yield 4700, p.STATISTIC, p.statistic(255, (1 << 32) - 1)


NOW = 1_790_000_000_123_456_789  # ns of UTC
STOPPED = types.SimpleNamespace(time_ns=lambda: NOW, monotonic=time.monotonic)


def logged(path, known=None, more=()):
    """Log a simulated core at the time ``NOW``; returns the logged packets."""
    model = SimulatedCore(size=(3, 4), clk_khz=CLK_KHZ)
    with (
        mock.patch.object(stamps, "time", STOPPED),
        host.Core(line.Pipe(model), known) as core,
        log.recording(path, core) as recording,
    ):
        for at, kind, payload in items():
            model.say(kind, at, payload)
        kept = [*core.packets(0.05), *more]
        for item in kept:
            recording.add(item)
    return kept


GAP = packets.Gap("the cable was out", 1.5)


@pytest.mark.parametrize("kind", ["npz", "mcap"])
def test_everything_is_in_the_log(tmp_path, kind):
    more = [GAP, packets.States(4530, None, 300, (2, 4))]
    kept = logged(tmp_path / f"a.{kind}", units.Units(newtons_per_code=0.25), more)
    assert len(kept) == 16
    found = log.read(tmp_path / f"a.{kind}")
    cop = engines.process_cop(FRAMES, "fixed")
    assert np.array_equal(found["image"], FRAMES) and found["image"].dtype == np.uint16
    assert list(found["image_number"]) == [0, 1, 2, 3]
    assert list(found["cop_time"]) == [1000, 2000, 3000]
    for name, own in (("x", "x"), ("y", "y"), ("load", "sum"), ("pressed", "valid")):
        assert np.array_equal(found[f"cop_{name}"], cop[own][:3])
    one = {
        name: found[name].tolist()
        for name in found
        if name.split("_")[0] in ("slip", "change", "state", "class", "health", "statistics")
        and "_ns" not in name
    }
    assert one == {
        **{"slip_time": [4500], "slip_channel": [65535], "slip_state": [3], "slip_p2p": [(1 << 24) - 1]},
        # All changes, and the start of a slip among them: from contact, never late.
        **{"change_time": [4500, 4510], "change_channel": [65535, 7], "change_state": [3, 4]},
        **{"change_before": [1, 3], "change_p2p": [(1 << 24) - 1, 0x30201], "change_late": [False, True]},
        **{"change_start": [True, False]},
        **{"state_time": [4520] * 3 + [4530] * 2, "state_channel": [0, 1, 2, 300, 301]},
        **{"state_state": [1, 0, 3, 2, 4]},
        **{"class_time": [4530, 4540], "class_label": [2, 65534], "class_before": [65535, 2]},
        "class_votes": [99_000, (1 << 32) - 1],
        **{"health_time": [4600], "health_taxel": [(1 << 24) - 1], "health_faults": [255]},
        **{"statistics_time": [4700], "statistics_index": [255], "statistics_value": [(1 << 32) - 1]},
    }
    assert list(found["gap_reason"]) == [GAP.reason] and list(found["gap_seconds"]) == [1.5]
    assert (int(found["clk_khz"]), float(found["newtons_per_code"])) == (CLK_KHZ, 0.25)
    assert int(found["min_load"]) == 1
    assert int(found["start_ns"]) == NOW
    # A clock is 1 us, so the time stamps differ by exactly that.
    assert np.array_equal(np.diff(found["cop_ns"]), [10**6, 10**6])
    start = int(found["start_ns"]) - 1000 * int(found["start_time"])
    assert list(found["slip_ns"]) == [start + 4500 * 1000]


def test_arrays_from_before_some_packets_are_read(tmp_path):
    logged(tmp_path / "a.npz")
    arrays = log.read(tmp_path / "a.npz")
    added = ("reset_", "change_", "state_", "class_")
    np.savez(tmp_path / "old.npz", **{name: x for name, x in arrays.items() if not name.startswith(added)})
    found = log.read(tmp_path / "old.npz")
    assert found.keys() == arrays.keys() and not len(found["class_label"]) and len(found["slip_p2p"]) == 1


def test_missing_changes_are_counted_by_hand():
    """Channel 3 goes 0, 1, 2 and, what led there is missing, 4 from 1; channel 5 is first heard of in state
    1, and after a reset begins again."""
    columns = {"channel": [3, 5, 3, 3, 5, 5], "before": [0, 1, 1, 1, 2, 0], "state": [1, 2, 2, 4, 1, 1]}
    columns["ns"] = [1, 2, 3, 4, 5, 9]
    found = {f"change_{name}": np.array(values) for name, values in columns.items()}
    assert changes(found | {"reset_ns": np.array([7])}) == (6, 1)
    assert changes(found | {"reset_ns": np.array([], int)}) == (6, 2)


def test_mcap_ros2_support_reads_a_log(tmp_path):
    """Its own decoder, with the definitions in the file; test_ros.py has rosbags and the messages."""
    known = units.Units(newtons_per_code=0.25, pitch_mm=2.0)
    logged(tmp_path / "a.mcap", known, [GAP])
    with open(tmp_path / "a.mcap", "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        messages = list(reader.iter_decoded_messages(log_time_order=False))
        assert reader.get_header().profile == "ros2"
    of = {}
    for one in messages:
        of.setdefault(one.channel.topic, []).append((one.message.log_time, one.decoded_message))
    for found in of.values():
        told = [one.header.stamp.sec * 10**9 + one.header.stamp.nanosec for _, one in found]
        assert told == [at for at, _ in found]
    images = [one for _, one in of["/tactile/image"]]
    taxels = [np.frombuffer(one.data, "<u2").reshape(one.height, one.width) for one in images]
    assert np.array_equal(taxels, FRAMES) and images[0].encoding == "mono16"
    [slip] = [one for _, one in of["/tactile/slip"]]
    assert (slip.channel, slip.state_name, slip.p2p, slip.ticks) == (65535, "gross", (1 << 24) - 1, 4500)
    loads = [one.wrench.force.z for _, one in of["/tactile/wrench"]]
    assert loads == [0.25 * frame.sum() for frame in FRAMES[:3]]
    assert [status.name for status in of["/diagnostics"][-1][1].status] == [
        f"meissner: {name}" for name in ("line", "taxels", "core")
    ]
    logged(tmp_path / "b.mcap")
    assert math.isnan(log.read(tmp_path / "b.mcap")["newtons_per_code"])


class Kept:
    def __init__(self):
        self.stamps = []

    def add(self, stamp_ns, item):
        self.stamps.append(stamp_ns)

    def tell(self, facts):
        pass

    def flush(self, facts):
        pass


@pytest.mark.parametrize(
    "times, reset, wanted",
    [
        # Reset one hour after its first reset; the reset follows its last packet, and 0 is the reset's time.
        ((3_600_000_000, 5, 25), 1, (0, 1, 5_001, 25_001)),
        # The 48 bits wrap around: 5 clocks on, then one that waited.
        (((1 << 48) - 1, 4, (1 << 48) - 3, 6), None, (0, 5_000, -2_000, 7_000)),
    ],
)
def test_stamps_by_hand(times, reset, wanted):
    """The time stands still; a clock is 1 us."""
    model, kept = SimulatedCore(clk_khz=CLK_KHZ), Kept()
    core = host.Core(line.Pipe(model), say=lambda _: None)
    with mock.patch.object(stamps, "time", STOPPED):
        recording = log.Log(kept, core)
    for place, at in enumerate(times):
        if place == reset:
            model.restart()
        kind, payload = (
            (p.HEALTH, p.health(1, 1)) if place == 2 and not reset else (p.STATISTIC, p.statistic(0, 0))
        )
        model.say(kind, at, payload)
        with mock.patch.object(stamps, "time", STOPPED):
            for item in core.packets(0.05):
                recording.add(item)
    assert core.counts.restarts == (reset is not None)
    assert kept.stamps == [NOW + stamp for stamp in wanted]


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_a_log_that_fails_before_a_packet_leaves_nothing(tmp_path, name):
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))
    with pytest.raises(RuntimeError), log.recording(tmp_path / name, core):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_refuses_what_cannot_be_logged(tmp_path):
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))
    with (
        pytest.raises(ValueError, match=r"\.mcap"),
        log.recording(tmp_path / "a.txt", core),
    ):
        pass
    listened = host.Core(line.Pipe(SimulatedCore()), registers=False)
    with pytest.raises(ValueError, match="clock"), log.recording(tmp_path / "a.npz", listened):
        pass
    assert list(tmp_path.iterdir()) == []
    with (
        pytest.raises(ValueError, match=r"a.npz.part.rows"),
        log.recording(tmp_path / "a.npz", core) as kept,
    ):
        for shape in ((2, 3), (3, 2)):
            kept.add(packets.Image(0, None, 0, np.zeros(shape, np.uint16), None))
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz.part.rows"]
    assert log.read(tmp_path / "a.npz.part.rows")["image"].shape == (1, 2, 3)


def test_refuses_what_is_no_log(tmp_path):
    logged(tmp_path / "good.mcap")
    logged(tmp_path / "good.npz")
    whole = (tmp_path / "good.mcap").read_bytes()
    rng = np.random.default_rng(1)
    (tmp_path / "cut.mcap").write_bytes(whole[:50])
    (tmp_path / "none.mcap").write_bytes(b"no MCAP at all")
    (tmp_path / "empty.mcap").write_bytes(b"")
    (tmp_path / "none.npz").write_bytes(rng.bytes(500))
    np.savez(tmp_path / "other.npz", x=[1])
    arrays = log.read(tmp_path / "good.npz")
    np.savez(tmp_path / "short.npz", **arrays | {"cop_x": arrays["cop_x"][:1]})
    np.savez(tmp_path / "flat.npz", **arrays | {"image": arrays["image"].reshape(4, 12)})
    np.savez(tmp_path / "odd.npz", **arrays | {"image": arrays["image"].astype(float)})
    for name in (
        "cut.mcap",
        "none.mcap",
        "empty.mcap",
        "none.npz",
        "other.npz",
        "short.npz",
        "flat.npz",
        "odd.npz",
    ):
        with pytest.raises(ValueError, match=name):
            log.read(tmp_path / name)
    (tmp_path / "cut.npz").write_bytes((tmp_path / "good.npz").read_bytes()[:-30])
    for name, sentence in (
        ("absent.npz", "there is no file"),
        ("x.csv", "no file"),
        ("cut.npz", "cut.npz is cut off or damaged"),
    ):
        with pytest.raises(ValueError, match=sentence):
            log.read(tmp_path / name)
    for at in rng.integers(0, len(whole), 60):  # one bit flipped anywhere: read or refused
        wrong = bytearray(whole)
        wrong[at] ^= 1 << int(rng.integers(0, 8))
        (tmp_path / "wrong.mcap").write_bytes(wrong)
        try:
            log.read(tmp_path / "wrong.mcap")
        except ValueError as problem:
            assert "\n" not in str(problem)


@pytest.mark.parametrize("engine", engines.NAMES)
def test_replay(tmp_path, engine):
    logged(tmp_path / "a.mcap")
    found = log.read(tmp_path / "a.mcap")
    result = replay(found, engine)
    assert differences(result) == (3, 0, {"x": 0, "y": 0, "load": 0, "pressed": 0})
    assert list(result["logged"]) == [True, True, True, False]
    told = {f"cop_{name}": [11 + k, 21 + k, 31 + k] for k, name in enumerate(("x", "y", "load", "pressed"))}
    result = replay(found | {name: np.array(values) for name, values in told.items()}, engine)
    assert {name: result[f"logged_{name[4:]}"].tolist() for name in told} == {
        name: [*values, 0] for name, values in told.items()
    }
    found["cop_x"][1] += 3
    found["cop_load"][0] -= 5
    assert differences(replay(found, engine)) == (3, 2, {"x": 3, "y": 0, "load": 5, "pressed": 0})
    assert differences(replay(found, engine, min_load=10**6))[1] == 2


def test_replay_of_a_log_without_images(tmp_path):
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))
    with log.recording(tmp_path / "a.npz", core):
        pass
    with pytest.raises(ValueError, match="no image"):
        replay(log.read(tmp_path / "a.npz"), "fixed")
