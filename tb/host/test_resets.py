"""A reset of the core is a place in the stream: every packet belongs to the boot that sent it, wherever the
reader is and however the bytes arrive, lost packets are counted right, and a log of several boots replays
without a difference. The bytes are made from docs/link.md alone."""

import itertools
import random
import struct
import zlib

import numpy as np
import pytest

from meissner import cli, host
from meissner.builds import units
from meissner.host import boots as boots_module
from meissner.host import line, log, packets, view
from meissner.host.pty import Pty
from meissner.host.replay import differences, replay
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Packet
from meissner.twins.slip.slip import State

KNOWN = units.Units(clk_khz=1000, rows=2, columns=3)
PERIOD = 100_000


class Boots:
    """A line's packets: (bytes, boot, number, kind); two parts for each image."""

    def __init__(self):
        self.packets, self.boot, self.number = [], -1, 0

    def reset(self, torn=0):
        """``torn``: bytes of the last packet that the line still carried."""
        if torn:
            data, *rest = self.packets[-1]
            self.packets[-1] = (data[:torn], *rest)
        self.boot, self.number = self.boot + 1, 0
        return self

    def put(self, kind, ticks, payload):
        body = bytes([kind, self.number % 256]) + ticks.to_bytes(6, "little") + payload
        body += zlib.crc32(body).to_bytes(4, "little")
        frame, run = bytearray(), 1
        for byte in body:
            frame.append(byte or run)
            run = run + 1 if byte else 1
        data = b"\0" + bytes(frame) + bytes([run]) + b"\0"
        self.packets.append((data, self.boot, self.number, kind))
        self.number += 1

    def cop(self, ticks):
        load = 1000 * self.boot + ticks // PERIOD
        self.put(2, ticks, bytes(6) + load.to_bytes(5, "little") + b"\1")

    def part(self, ticks, number, first):
        taxels = (self.boot, number, ticks // PERIOD)
        head = bytes([number % 256, first == 3]) + first.to_bytes(3, "little")
        self.put(3, ticks, head + struct.pack("<3H", *taxels))

    def statistic(self, ticks):
        self.put(5, ticks, struct.pack("<BI", 2, self.boot))

    def frames(self, count, first=500, every=4, images=True):
        for k in range(count):
            at = first + k * PERIOD
            self.cop(at)
            if images:
                self.part(at, k, 0)
                self.part(at, k, 3)
            if every and k % every == 0:
                self.statistic(at + 900)
        return self

    def drop(self, *places):
        """Lose these packets."""
        self.packets = [item for k, item in enumerate(self.packets) if k not in places]
        return self

    @property
    def data(self):
        return b"".join(data for data, *_ in self.packets)


class Bytes:
    """A line that carries ``data``, ``n`` bytes a read, and ends."""

    name, baud = "the line", None

    def __init__(self, data, n=1 << 20):
        self.reads = iter([data[at : at + n] for at in range(0, len(data), n)])

    def read(self, timeout_s):
        some = next(self.reads, None)
        if some is None:
            raise line.Ended
        return some


def listening(data, n=1 << 20, said=None):
    return host.Core(Bytes(data, n), KNOWN, registers=False, say=[].append if said is None else said.append)


def boots(*lengths, **settings):
    stream = Boots()
    for length in lengths:
        stream.reset().frames(length, **settings)
    return stream


def torn(size, count=3):
    """Two boots; of the last packet of the first, a part of an image, the line carried data[:size]."""
    stream = Boots().reset().frames(count, every=0).reset(size)
    return stream.frames(count, every=0)


def only(kind, *times):
    """A boot for each tuple of times, with packets of one kind."""
    stream = Boots()
    for boot in times:
        stream.reset()
        for k, at in enumerate(boot):
            if kind == "image":
                stream.part(at, k, 0)
                stream.part(at, k, 3)
            else:
                getattr(stream, kind)(at)
    return stream


# name: (stream, packets lost, frames damaged, images lost)
CASES = {
    "equal ticks": (boots(5, 5), 0, 0, 0),
    "the second is longer": (boots(3, 9), 0, 0, 0),
    "one frame each": (boots(1, 1, 1, 1), 0, 0, 0),
    "many": (boots(*range(1, 40)), 0, 0, 0),
    "without statistics": (boots(4, 4, every=0), 0, 0, 0),
    "only CoP": (boots(4, 4, 4, every=0, images=False), 0, 0, 0),
    "one CoP each": (only("cop", (9,), (9,), (9,)), 0, 0, 0),
    "one CoP each, later": (only("cop", (9,), (700,), (9,)), 0, 0, 0),
    "one image each": (only("image", (9,), (9,), (9,)), 0, 0, 0),
    "one statistic each": (only("statistic", (9,), (9,), (9,)), 0, 0, 0),
    "the last packet": (only("cop", (9, 500, 1000), (9,)), 0, 0, 0),
    "after the first packet": (only("cop", (9,), (9, 500, 1000)), 0, 0, 0),
    "a boot of 256 packets": (only("cop", range(1, 257), (50, 60)), 0, 0, 0),
    "a long boot": (boots(200, 200), 0, 0, 0),
    "number 255, then 0": (only("statistic", range(0, 256000, 1000), (5,)), 0, 0, 0),
    "in the middle of an image": (boots(3, 3, every=0).drop(8), 0, 0, 1),
    "the first two lost": (boots(3, 3, every=0).drop(9, 10), 2, 0, 1),
    "the first CoP lost": (boots(3, 3, every=0).drop(9), 1, 0, 0),
    "the last three lost": (boots(3, 3, every=0).drop(6, 7, 8), 0, 0, 0),
    "an image lost in each": (boots(3, 4, every=0).drop(4, 5, 10, 11), 4, 0, 2),
    "torn": (torn(9), 0, 1, 1),
    "torn behind its first byte": (torn(1), 0, 0, 1),
    "torn before its last byte": (torn(-1), 0, 0, 0),
}


def boot_of(item):
    """The boot that made the packet, as its payload says."""
    if isinstance(item, packets.CopFrame):
        return item.load // 1000
    return int(item.taxels[0, 0]) if isinstance(item, packets.Image) else item.value


@pytest.mark.parametrize("n", [1 << 20, 1, 13])
@pytest.mark.parametrize("case", CASES)
def test_every_packet_belongs_to_its_boot(case, n):
    stream, lost, damaged, images_lost = CASES[case]
    core = listening(stream.data, n)
    found = list(core.packets())
    seen = [item.boot for item in found]
    assert seen == [boot_of(item) for item in found] and seen[-1] == core.counts.restarts == stream.boot
    assert (core.counts.lost, core.counts.damaged) == (lost, damaged)
    assert core.counts.images_lost == images_lost
    # Every packet is there but those of images of which a part is missing.
    single = [b for data, b, _, kind in stream.packets if kind != 3 and data[-1:] == b"\0"]
    parts = [b for data, b, _, kind in stream.packets if kind == 3 and data[-2:] > b"\0"]
    assert sorted(seen)[: len(seen)] == seen and len(seen) - len(single) in (
        len(parts) // 2,
        (len(parts) - 1) // 2,
    )


@pytest.mark.parametrize("seed", range(20))
def test_lost_packets_are_no_reset(seed):
    """In one boot any packets may be lost and images come late; only what is lost is counted."""
    rng = random.Random(seed)
    print(f"seed {seed}")
    stream = Boots().reset().frames(400)
    gone = sorted(rng.sample(range(1, 1299), rng.choice([3, 30, 600])))
    core = listening(stream.drop(*gone).data)
    assert not any(item.boot for item in core.packets())
    numbers = [number for _, _, number, _ in stream.packets]
    assert core.counts.lost == sum((b - a - 1) % 256 for a, b in itertools.pairwise(numbers)) > 0
    assert core.counts.restarts == 0


@pytest.mark.parametrize(
    "last, since, first",
    [
        (239, 16 * 600 - 1, True),  # 16 packets of 15 bytes, 10 bits of 4 clocks each, in fewer clocks
        (239, 16 * 600, False),
        (240, 1, False),  # 15 packets may be noise
        (5, 250 * 600 - 1, True),
        (5, 250 * 600, False),
    ],
)
def test_number_0_sooner_than_the_line_could_carry_what_is_missing(last, since, first):
    seen = boots_module.Boots()
    seen.next(Packet(p.COP, last, 1_000_000, b"", {}))
    assert seen.next(Packet(p.HEALTH, 0, 1_000_000 + since, b"", {})) == (first, 0 if first else 255 - last)


def test_the_time_wraps_without_a_reset():
    """2^48 clocks end between two frames, and an image of the frame before comes after the CoP behind it."""
    stream, end = Boots().reset(), 1 << 48
    for at in (end - 2 * PERIOD, end - PERIOD, 5, PERIOD):
        stream.cop(at)
        stream.statistic(at + 1)
    core = listening(stream.data)
    assert len(list(core.packets())) == 8 and (core.counts.restarts, core.counts.lost) == (0, 0)


def test_a_reset_is_where_it_was_although_the_program_took_no_packets(monkeypatch):
    """Of 30 packets the newest 8 are kept, and each is still of its boot."""
    monkeypatch.setattr(host.core, "UNREAD", 8)
    for first, second in ((20, 10), (3, 27), (26, 4)):
        core = listening(only("cop", range(100, 100 + first), range(100, 100 + second)).data)
        boot = [item.boot for item in core.packets()]
        assert boot == [0] * max(0, 8 - second) + [1] * min(8, second) and core.counts.unread == 30 - 8


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
@pytest.mark.parametrize("lengths", [(5, 5), (50, 3), (1, 1, 1, 1), (2, 30, 7)])
def test_a_log_of_several_boots(tmp_path, name, lengths):
    """A boot lasts up to 5 s and is read at once: its times still lie before those of the next boot."""
    stream = boots(*lengths)
    core = listening(stream.data)
    with log.recording(tmp_path / name, core) as recording:
        for item in core.packets():
            recording.add(item)
    found = log.read(tmp_path / name)
    assert found["reset_restarts"].tolist() == list(range(1, len(lengths)))
    assert found["reset_min_load"].tolist() == [-1] * (len(lengths) - 1) and "min_load" not in found
    for kind, own in (("cop", found["cop_load"] // 1000), ("image", found["image"][:, 0, 0])):
        assert (
            log.boots(found, kind).tolist()
            == own.tolist()
            == np.repeat(range(len(lengths)), lengths).tolist()
        )
        ns = found[f"{kind}_ns"]
        assert np.all(np.diff(ns) > 0)
        for boot in range(len(lengths)):  # in a boot the core's clock of 1 MHz counts
            inside = log.boots(found, kind) == boot
            assert np.diff(ns[inside]).tolist() == [1000 * PERIOD] * (lengths[boot] - 1)
    assert (found["lost"], found["images_lost"], found["restarts"]) == (0, 0, len(lengths) - 1)


def test_frames_of_equal_time_are_compared_within_their_boot():
    """Two boots of two frames with the same ticks; in the second, one CoP of the log is wrong."""
    images = np.array([[[1, 2]], [[3, 4]], [[50, 70]], [[70, 50]]], np.uint16)
    x = [5461, 2341, 2731, -2731]  # 16384·(b - a)/(a + b), halves away from zero
    rows = {"image": images, "reset_ns": np.array([25]), "reset_min_load": np.array([-1])}
    for kind in ("image", "cop"):
        rows |= {f"{kind}_time": np.array([100, 200, 100, 200]), f"{kind}_ns": np.array([10, 20, 30, 40])}
    rows |= {"cop_x": np.array(x), "cop_y": np.zeros(4, int), "cop_pressed": np.ones(4, bool)}
    rows |= {"cop_load": np.array([3, 7, 120, 120])}
    result = replay(rows, "fixed")
    assert differences(result) == (4, 0, {"x": 0, "y": 0, "load": 0, "pressed": 0})
    assert (result["boot"].tolist(), result["logged_x"].tolist()) == ([0, 0, 1, 1], x)
    rows["cop_x"][2] -= 9
    assert differences(replay(rows, "fixed"))[:2] == (4, 1)


CONFIG = """
about = "2 x 3"
[clock]
mhz = 1.0
[sensor]
kind = "array"
rows = 2
columns = 3
[adc]
part = "MCP3208"
volts = 5.0
rate_hz = 100.0
[array]
tare = false
newtons_per_count = 0.001
[link]
images = true
registers = false
baud = 250000
"""


def test_the_log_keeps_the_least_load_of_the_configuration(tmp_path, monkeypatch, capsys):
    """least_n of 0.5 N are 500 codes. Frames of 499 and 500 codes, then the same after a reset."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(CONFIG + "[cop]\nmin_load_n = 0.5\n")
    stream = Boots()
    for _ in range(2):
        stream.reset()
        for k, load in enumerate((499, 500)):
            at, x = PERIOD * (k + 1), 16384 * (load >= 500)  # all in the last column, lower row
            place = x.to_bytes(3, "little") + (-x).to_bytes(3, "little", signed=True)
            stream.put(2, at, place + load.to_bytes(5, "little") + bytes([load >= 500]))
            stream.put(3, at, bytes([k, 1, 0, 0, 0]) + struct.pack("<6H", 0, 0, 0, 0, 0, load))
    (tmp_path / "a.bin").write_bytes(stream.data)
    for name in ("a.npz", "a.mcap"):
        cli.main(["log", "file:a.bin", "--config", "mine.toml", "--out", name])
        found = log.read(name)
        assert (found["min_load"], found["reset_min_load"].tolist()) == (500, [500])
        for more, differ, valid in (
            ([], 0, [0, 1]),
            (["--min-load", "499"], 2, [1, 1]),
            (["--min-load", "0"], 2, [1, 1]),
            (["--min-load", "501"], 2, [0, 0]),
        ):
            capsys.readouterr()
            cli.main(["replay", name, "--out", "out.npz", "--overwrite", *more])
            assert (
                f"4 with the core's own centre of pressure, of which {differ} differ"
                in capsys.readouterr().out
            )
            assert np.load("out.npz")["valid"].tolist() == 2 * valid
    (tmp_path / "plain.toml").write_text(CONFIG)  # 0 N is known, too
    cli.main(["log", "file:a.bin", "--config", "plain.toml", "--out", "b.npz"])
    assert (log.read("b.npz")["min_load"], log.read("b.npz")["reset_min_load"].tolist()) == (0, [0])


def test_each_boot_is_replayed_with_its_own_least_load(tmp_path):
    """Another host had set 10 codes before; the reset core has its 4 again, and this log asks for them."""
    model = SimulatedCore(size=(1, 2), clk_khz=1000, settings={"cop.min_load": 4})
    core = host.Core(line.Pipe(model), say=lambda _: None)
    model.registers.access(True, host.names.place("cop.min_load").address, 10)
    model.boundary()
    with log.recording(tmp_path / "a.npz", core) as recording:
        for least in (10, 4):
            for k, load in enumerate((3, 4, 9, 10)):
                pressed = load >= least
                model.say(p.COP, 100 * k + 50, p.cop_frame(16384 * pressed, 0, load, pressed))
                model.say(p.IMAGE, 100 * k + 50, p.image_chunks(k, [0, load])[0])
            for item in core.packets(0.0):
                recording.add(item)
            model.restart()
    found = log.read(tmp_path / "a.npz")
    assert (found["min_load"], found["reset_min_load"].tolist()) == (10, [4])
    result = replay(found, "fixed")
    assert differences(result)[:2] == (8, 0)
    assert result["valid"].tolist() == [0, 0, 0, 1, 0, 1, 1, 1]


def test_what_comes_while_a_line_is_greeted_is_of_the_next_boot(tmp_path):
    """The cable is out, the core is reset and its clock is beyond the old one: only core.scratch shows it.
    Packets that arrive before that is read lie behind the gap and the reset, and none but those are lost."""
    model, name = SimulatedCore(clk_khz=1000), tmp_path / "core"
    first = Pty(model)
    name.symlink_to(first.path)
    with host.connect(f"pty:{name}", say=lambda _: None) as core:
        model.say(p.COP, 40, p.cop_frame(0, 0, 1, 1))
        assert [item.load for item in core.packets(5.0) if core.stop() is None] == [1]
        core._ended = False
        name.unlink()  # first, because the number may be reused
        first.unplug()
        model.restart()
        model._number = 3  # three packets went into the open cable
        model.say(p.COP, 4000, p.cop_frame(0, 0, 2, 1))
        with Pty(model) as second:
            name.symlink_to(second.path)
            found = []
            for item in core.packets(60.0):
                found.append(item)
                if isinstance(item, packets.CopFrame):
                    break
        assert [type(item) for item in found] == [packets.Gap, packets.CopFrame] and found[1].boot == 1
        assert (core.counts.lost, core.counts.restarts, core.counts.gaps) == (3, 1, 1)


def test_a_view_forgets_the_last_boot():
    core = listening(b"")
    shown = view.View(core)
    shown.add(packets.CopFrame(5, None, 0.0, 0.0, 3, True, None, None, None))
    shown.add(packets.Health(5, None, 12, 5))
    shown.add(packets.SlipEvent(5, None, 2, 3, 9, None))
    assert shown.add(packets.Statistics(5, None, 0, 7, boot=1)) == "the core was reset"
    assert shown.line().startswith("no centre of pressure yet; 1 slip event, 0 in contact, 0 slipping;")
    assert (shown.states, shown.health, list(shown.statistics.values())) == ({}, {}, [7])
    line = "the core was reset\n6 clocks: slip, channel 1, gross, peak-to-peak 9"
    assert shown.add(packets.SlipEvent(6, None, 1, State.GROSS, 9, None, boot=2)) == line


@pytest.mark.parametrize("lengths, times", [((3, 3), ""), ((3, 3, 3, 3), " 3 times")])
def test_a_listener_says_that_the_core_was_reset(lengths, times):
    said = []
    list(listening(boots(*lengths).data, said=said).packets())
    assert said == [f"the core on the line was reset{times}"]
