"""meissner.host.Core against a simulated core over a pty: registers by every name, settings in volts and
newtons, refusals, typed packets and images. Then faults of the line: the cable pulled in the middle of a
packet, a core that was reset, lost commands and answers, noise, another baud rate, a core without registers,
one of another version."""

import contextlib
import os
import time
from itertools import count

import numpy as np
import pytest

from meissner import host
from meissner.builds import units
from meissner.host import Gap, Image, NoAnswer, Refused, SlipEvent, line, names, packets
from meissner.host.pty import Pty
from meissner.host.sensors import array_source, blocks_of, settings_of, slip_source, together
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.twins.link import bridge, cobs
from meissner.twins.link import packet as p
from meissner.twins.link.uart import UartRx, levels
from meissner.twins.slip.slip import State

QUICK = {"timeout_s": 0.05, "retries": 1}


def simulated(*items, **settings):
    return SimulatedCore(list(items), **{"clk_khz": 1000, **settings})


def connected(pipe, **settings):
    return host.Core(line.Pipe(pipe), **settings)


def event(time_, channel=0, p2p=7, state=2):
    return time_, p.SLIP, p.slip_event(channel, p2p, state)


def until(core, wanted):
    """Packets up to and including the first for which ``wanted`` is true."""
    found = []
    for item in core.packets():
        found.append(item)
        if wanted(item):
            return found
    raise AssertionError(f"the line ended after {found[-3:]}")


def drained(core, pipe):
    """All packets that are on their way from a Pipe."""
    found = []
    while pipe.core._out or core.counts.bytes < pipe.delivered:
        found += core.packets(0)
    return found


class Pipe:
    """A simulated core whose traffic the test may drop or change."""

    def __init__(self, core):
        self.core = core
        self.to_host = self.to_core = lambda data: data
        self.delivered = 0

    def read(self, n):
        data = self.to_host(self.core.read(n))
        self.delivered += len(data)
        return data

    def write(self, data):
        self.core.write(self.to_core(data))


# Registers


def test_finds_the_core_over_a_pty():
    with Pty(simulated(size=(3, 5))) as pty, host.connect(pty.url) as core:
        assert core.features == names.FEATURES
        assert (core.units.rows, core.units.columns, core.units.clk_khz) == (3, 5, 1000)
        assert core["core.id"] == 0x4D534E52
        assert core["core.size"] == 5 << 16 | 3 and core["core.size.columns"] == 5


def test_the_same_through_pyserial():
    with Pty(simulated(size=(3, 5))) as pty, host.connect(f"serial:{pty.path}?baud=3000000") as core:
        assert core["core.size.rows"] == 3
        assert core.line.baud == 3_000_000


def test_every_register_by_name():
    model = simulated()
    core = connected(model)
    for name in core.names():
        place = names.place(name)
        if not place.writable:
            with pytest.raises(ValueError, match=f"{name} "):
                core[name] = 0
            core[name]
            continue
        most = place.field.most
        least, greatest = place.ends(core.build)
        # 0 last: some are written only while their block is off
        for value in (min(1, greatest), greatest >> 1, greatest, least, max(-1, least), 0):
            core[name] = value
            if place.field.kind == "setting":
                assert core[name] == value
                key = (place.group.name, place.register.name, place.field.name)
                assert model.registers._written[key] == value & most
        for value in (greatest + 1, least - 1):
            with pytest.raises(ValueError, match=f"{name} = {value} "):
                core[name] = value


def test_a_field_leaves_its_neighbours():
    place = names.place("core.size.columns")
    assert place.into(0xABCD1234, 7) == 0x00071234
    assert place.value(0xABCD1234) == 0xABCD
    assert names.place("slip.contact_level").value(0xFFFFF) == -1


def test_a_field_that_is_written_leaves_its_neighbours():
    """health.use: user is bit 0, edges bit 1, both 1 after reset; calibrate.write: lanes 7:0, row bit 8."""
    model = simulated()
    core = connected(model)
    core["health.use.edges"] = 0
    assert core["health.use"] == 0b01 and core["health.use.user"] == 1
    core["health.use.user"] = 0
    core["health.use.edges"] = 1
    assert core["health.use"] == 0b10
    core["calibrate.write.lanes"] = 0xA5
    core["calibrate.write.row"] = 1
    assert core["calibrate.write"] == 0x1A5
    core["calibrate.write.lanes"] = 0x5A
    assert core["calibrate.write"] == 0x15A and core["calibrate.write.row"] == 1
    core["calibrate.write"] = 0x0FF
    assert (core["calibrate.write.lanes"], core["calibrate.write.row"]) == (0xFF, 0)


def test_a_field_leaves_its_neighbours_when_the_core_was_reset_before():
    """Its neighbours would read as reset values then, so earlier settings are restored before the write."""
    model = simulated()
    core = connected(model, say=lambda sentence: None)
    core["health.use.user"] = 0
    model.say(p.STATISTIC, 5000, p.statistic(0, 0))
    list(core.packets(0.05))
    model.restart()
    assert model.registers.setting("health", "use", "user") == 1
    core["health.use.edges"] = 0
    assert core["health.use"] == 0
    model.registers.commit()  # at a frame's start
    assert model.registers.setting("health", "use", "user") == 0


# For a core of 5 rows and 3 columns at level 2: 17 + 2 = 19 bits of a detail, 16 + 4 = 20 of a load (15
# taxels need 4), 15 words.
TOO_WIDE = {
    "slip.threshold": (0, 524_287),
    "slip.gross_threshold": (0, 524_287),
    "slip.keep_threshold": (0, 524_287),
    "slip.contact_level": (-262_144, 262_143),
    "slip.release_level": (-262_144, 262_143),
    "slip.hold": (0, 65_535),
    "cop.min_load": (0, 1_048_575),
    "tare.word": (0, 14),
    "calibrate.word": (0, 14),
    "calibrate.offset": (-65_536, 65_535),
    "cop4.p5": (-131_072, 131_071),
    "cop4.imbalance": (0, 262_143),
    "scan.settle": (0, 65_535),
}


@pytest.mark.parametrize("name", TOO_WIDE)
def test_values_wider_than_the_build_are_refused(name):
    core = connected(simulated(size=(5, 3), level=2))
    least, most = TOO_WIDE[name]
    for value in (least, most):
        core[name] = value
        assert core[name] == value
    for value in (least - 1, most + 1, 2**40):
        with pytest.raises(ValueError, match=f"{name} = {value} ") as told:
            core[name] = value
        assert "\n" not in str(told.value)
        with pytest.raises(ValueError):
            core.check(name, value)
    assert core[name] == most


def test_a_simulated_core_holds_what_another_host_writes():
    """As the RTL's registers, it cuts values to their width: another host wrote more than 18 bits and 20
    bits."""
    model = simulated(size=(3, 3))
    core = connected(model)
    core.build = None
    core["slip.threshold"], core["cop.min_load"], core["slip.contact_level"] = 262_444, 2**31, -200_000
    assert (core["slip.threshold"], core["cop.min_load"]) == (262_143, 1_048_575)
    assert core["slip.contact_level"] == -131_072
    model.boundary()
    config = model.slip_config()
    assert (config.threshold, config.contact_level) == (262_143, -131_072)


def test_settings_written_together_take_effect_with_one_frame():
    """Between any two of the writes a frame begins; the settings of before hold until the block ends."""
    model = simulated(size=(3, 3))
    core = connected(model)
    seen = lambda: (model.slip_config().threshold, model.slip_config().hold)
    core["slip.threshold"], core["slip.hold"] = 40, 3
    model.boundary()
    for end in (None, KeyError):
        core["slip.hold"] = 3
        model.boundary()
        before = seen()
        with contextlib.suppress(KeyError), core.together():
            core["slip.threshold"] += 10
            model.boundary()
            core["slip.hold"] = 7
            model.boundary()
            assert seen() == before and core["slip.hold"] == 7
            if end:
                raise end
        assert seen() == before
        model.boundary()
        assert seen() == (before[0] + 10, 7)


def test_bits_that_no_field_has_are_refused():
    core = connected(simulated())
    with pytest.raises(ValueError, match=r"health\.use"):
        core["health.use"] = 4


def test_refuses_what_is_not_there():
    core = connected(simulated(features=["slip"]))
    with pytest.raises(ValueError, match=r"slip.threshold"):
        core["slip.treshold"]
    with pytest.raises(ValueError, match=r"without adc"):
        core["adc.enable"] = 1
    assert not any(name.startswith("adc.") for name in core.names())
    core.features.append("adc")  # FEATURES is wrong, so the core itself refuses
    with pytest.raises(ValueError, match=r"refused"):
        core["adc.enable"] = 1


def test_settings_in_volts_newtons_and_seconds():
    from meissner import scenes

    scene = scenes.load("acrylic_slip")
    model = of_scenes("acrylic_slip")
    core = connected(model, known=model.units)
    wanted, slip = scene.slip_config(), scene.slip
    for name, quantity, amount in (
        ("threshold", "volts", slip.threshold_p2p_v),
        ("gross_threshold", "volts", slip.gross_threshold_p2p_v),
        ("keep_threshold", "volts", slip.keep_threshold_p2p_v),
        ("contact_level", "volts", slip.contact_level_v),
        ("release_level", "volts", slip.release_level_v),
        ("hold", "seconds", slip.hold_ms / 1000),
        ("refractory", "seconds", slip.refractory_ms / 1000),
        ("blank", "seconds", slip.blank_ms / 1000),
    ):
        core[f"slip.{name}"] = 1
        code = core.set(f"slip.{name}", **{quantity: amount})
        assert core[f"slip.{name}"] == code == getattr(wanted, name)
    # The published divider gives 4 V under 0.5 N; a level is compared with the sum of two samples.
    assert core.set("slip.contact_level", newtons=0.5) == round(2 * 4.0 / scene.adc.lsb_v)
    assert core.set("adc.period", seconds=1e-4) == 2500
    core.units = units.Units(newtons_per_code=0.003)
    assert core.set("cop.min_load", newtons=0.5) == core["cop.min_load"] == 167
    # The samples are forces now: a threshold, and a level for the sum of two, in newtons.
    assert core.set("slip.threshold", newtons=0.05) == int(0.05 * 2**0.5 / 0.003)
    assert core.set("slip.contact_level", newtons=0.3) == 200
    event_ = p.slip_event(0, 10, 2)
    model.say(p.SLIP, 0, event_)
    (slipped,) = [item for item in core.packets(0.05) if isinstance(item, SlipEvent) and item.p2p == 10]
    assert (slipped.p2p_v, slipped.p2p_n) == (None, 10 * 0.003 / 2**0.5)
    with pytest.raises(ValueError, match=r"slip.hold .*seconds"):
        core.set("slip.hold", volts=1)
    with pytest.raises(ValueError, match="codes"):
        core.set("core.scratch", newtons=1)
    with pytest.raises(ValueError, match="finite"):
        core.set("cop.min_load", newtons=float("nan"))
    core.units = units.Units(rate_hz=1e9)
    with pytest.raises(ValueError, match=r"slip.hold"):
        core.set("slip.hold", seconds=100)
    core.units = units.Units()
    assert core.units.clk_khz == model.clk_khz
    for name, quantity in (("threshold", "volts"), ("contact_level", "newtons"), ("hold", "seconds")):
        with pytest.raises(ValueError, match=f"slip.{name}"):
            core.set(f"slip.{name}", **{quantity: 1})


@pytest.mark.parametrize("level", [1, 2, 3])
def test_a_threshold_in_volts_is_exact(level):
    """A peak-to-peak of exactly that many volts is not above the threshold, one code more is."""
    known = units.Units(volts_per_code=5 / 4096, level=level)
    for code in (1, 23, 139, 4000):
        volts = known.detail_volts(code)
        assert known.detail_code(volts * (1 + 1e-12)) == code
        assert known.detail_code(volts * (1 - 1e-9)) == code - 1


MINOR = names.CONSTANTS["core.version.minor"]
OTHERS = [(0, MINOR - 1), (0, MINOR + 1), (1, 0), (65535, 255)]


@pytest.mark.parametrize("version", OTHERS)
def test_another_version_is_refused(version, monkeypatch):
    sentence = f"version {version[0]}.{version[1]}"
    model = simulated()
    access = model.registers.access

    def other(write, address, *rest, **more):
        data, *left = access(write, address, *rest, **more)
        return (version[0] << 16 | version[1] << 8 if address == 4 else data), *left

    monkeypatch.setattr(model.registers, "access", other)
    with pytest.raises(Refused, match=sentence):
        connected(model)


def test_a_newer_minor_is_taken_from_major_1_on(monkeypatch):
    model = simulated()
    access = model.registers.access
    monkeypatch.setitem(names.CONSTANTS, "core.version.major", 1)

    def newer(write, address, *rest, **more):
        data, *left = access(write, address, *rest, **more)
        return (1 << 16 | 9 << 8 if address == 4 else data), *left

    monkeypatch.setattr(model.registers, "access", newer)
    assert connected(model)["core.id"]


def test_another_patch_is_taken(monkeypatch):
    monkeypatch.setitem(names.CONSTANTS, "core.version.patch", 9)
    assert connected(simulated())["core.id"]


def test_what_is_no_core_is_refused(monkeypatch):
    model = simulated()
    monkeypatch.setattr(model.registers, "access", lambda *_, **__: (0xDEADBEEF, False, set()))
    with pytest.raises(Refused, match="0xdeadbeef"):
        connected(model)


# Packets


def test_typed_packets_with_their_units():
    taxels = list(range(12))
    parts = [(90, p.IMAGE, part) for part in p.image_chunks(3, taxels, 5)]
    items = (
        event(50, 4, 26, 3),
        (60, p.COP, p.cop_frame(-16384, 8192, 1000, True)),
        parts[0],
        (95, p.HEALTH, p.health(7, 2)),
        parts[1],
        (96, 77, b"a type of the future"),
        (97, p.STATISTIC, p.statistic(2, 99)),
        parts[2],
    )
    model = simulated(size=(3, 4))
    known = units.Units(volts_per_code=0.001, newtons_per_code=0.01, pitch_mm=2.0)
    with Pty(model) as pty, host.connect(pty.url, known) as core:
        for at, kind, payload in items:
            model.say(kind, at, payload)
        found = until(core, lambda item: isinstance(item, Image))
    slip, cop, health, statistics, image = found
    assert slip == SlipEvent(50, 50e-6, 4, State.GROSS, 26, 26 * 0.001 / 2**0.5)
    assert cop == packets.CopFrame(60, 60e-6, -1.0, 0.5, 1000, True, -3.0, 1.0, 10.0)
    assert health == packets.Health(95, 95e-6, 7, 2)
    assert statistics == packets.Statistics(97, 97e-6, 2, 99)
    assert (image.number, image.time, image.newtons_per_code) == (3, 90, 0.01)
    assert np.array_equal(image.taxels, np.arange(12, dtype=np.uint16).reshape(3, 4))


def test_a_stream_of_twins_is_what_the_engine_says():
    """Slip events and CoP received over a pty equal those of the fixed engine on the same samples."""
    from meissner import engines, scenes

    scene = scenes.load("acrylic_slip")
    codes = scenes.simulate(scene, 0, 3).codes
    config = scene.slip_config()
    frames = scenes.simulate(scenes.load("walk_25x5")).codes
    state = engines.load("fixed").watch(codes[None], config).state[0]
    slipping = (state == State.INCIPIENT) | (state == State.GROSS)
    rises = np.flatnonzero(slipping & ~np.concatenate([[False], slipping[:-1]]))
    cop = engines.process_cop(frames, "fixed")
    slips = slip_source(blocks_of(codes, config.level), scene.rate_hz, config.window, config.hop)
    source = together(slips, array_source(frames, 1000, image_every=10))
    settings = settings_of(config)
    end = 10**9
    model = SimulatedCore(
        together(source, lambda core: [(end, p.STATISTIC, p.statistic(0, 0))]),
        settings=settings,
        size=(25, 5),
        level=config.level,
    )
    with Pty(model) as pty, host.connect(pty.url, registers=False) as core:
        core.units = units.Units(clk_khz=25_000, rows=25, columns=5)
        found = until(core, lambda item: isinstance(item, packets.Statistics))
    slips = [item for item in found if isinstance(item, SlipEvent)]
    assert [item.time for item in slips] == [2500 * (2 * k + 1) for k in rises] and len(slips) > 0
    assert [item.state for item in slips] == list(state[rises])
    cops = [item for item in found if isinstance(item, packets.CopFrame)]
    assert [item.x * 16384 for item in cops] == list(cop["x"]) and [item.load for item in cops] == list(
        cop["sum"]
    )
    images = [item for item in found if isinstance(item, Image)]
    assert np.array_equal([item.taxels for item in images], frames[::10])
    assert (core.counts.lost, core.counts.damaged, core.counts.images_lost) == (0, 0, 0)


def test_a_threshold_written_while_it_runs_counts():
    codes = np.tile([0, 0, 30, 0], 20_000)  # peak-to-peak 30, repeated
    model = SimulatedCore(slip_source(blocks_of(codes, loop=True), 10_000), clk_khz=1000, speed=20.0)
    with Pty(model) as pty, host.connect(pty.url) as core:
        core["slip.contact_level"] = -1000
        core["slip.hold"] = 0
        core["slip.threshold"] = 29
        until(core, lambda item: isinstance(item, SlipEvent))
        core["slip.threshold"] = 30
        found, changed = [], core.now  # the block that is under way has 128 samples of 100 clocks
        while core["slip.threshold"] == 30 and core.now < changed + 300_000:
            found += core.packets(0)
        assert all(item.time <= changed + 12_800 for item in found if isinstance(item, SlipEvent))


def test_a_core_faster_than_the_machine_goes_slower():
    """A source with endless work and no packets: each read returns, and the next one continues from there."""
    turns = count()
    model = SimulatedCore(lambda core: ((k, None, b"") for k in turns), speed=1e6)
    assert model.read(1) == b""
    reached = next(turns)
    assert model.read(1) == b"" and next(turns) > reached + 1


@pytest.mark.parametrize("sized", [True, False])
def test_images_of_which_a_part_is_lost_are_counted(sized):
    images = [[(k, p.IMAGE, part) for part in p.image_chunks(k, range(12), 5)] for k in range(5)]
    del images[1][1], images[2][2], images[3][0]
    core = connected(simulated(*(part for image in images for part in image), size=(3, 4)), registers=False)
    if sized:
        core.units = units.Units(rows=3, columns=4)
    found = list(core.packets(0.1))
    assert [item.number for item in found] == [0, 4]
    assert [item.taxels.shape for item in found] == 2 * [(3, 4) if sized else (1, 12)]
    assert core.counts.images_lost == 3


@pytest.mark.parametrize("cut", [0, 1, 9, 21])
def test_joining_in_the_middle_of_a_packet_is_no_damage(cut):
    frames = b"".join(cobs.encode(p.packet(p.SLIP, k, k, p.slip_event(0, k, 2))) for k in range(5))
    model = simulated()
    model._out += frames[cut:]
    core = connected(model, registers=False)
    assert [item.time for item in core.packets(0.05)] == list(range(min(cut, 1), 5))
    assert (core.counts.damaged, core.counts.lost) == (0, 0)


def test_unread_packets_are_bounded(monkeypatch):
    monkeypatch.setattr("meissner.host.core.UNREAD", 10)
    model = simulated()
    core = connected(model)
    for k in range(25):
        model.say(*[event(k)[i] for i in (1, 0, 2)])
    core["core.id"]
    assert [item.time for item in core.packets(0.05)] == list(range(15, 25))
    assert core.counts.unread == 15


# Faults of the line


def test_a_file_is_read_to_its_end(tmp_path):
    frames = [
        cobs.encode(p.packet(kind, k, at, body)) for k, (at, kind, body) in enumerate(map(event, range(9)))
    ]
    frames[4] = frames[4][:7]  # half a packet
    (tmp_path / "capture.bin").write_bytes(b"".join(frames))
    with host.connect(f"file:{tmp_path}/capture.bin") as core:
        assert [item.time for item in core.packets()] == [0, 1, 2, 3, 5, 6, 7, 8]
        assert (core.counts.lost, core.counts.damaged) == (1, 1)
        with pytest.raises(ValueError, match="listened"):
            core["core.id"]


@pytest.mark.parametrize(
    "url, sentence",
    [
        ("telepathy", "telepathy"),
        ("serial:/dev/there_is_none", "opened"),
        ("serial:/dev/ttyX?baud=fast", "baud = fast"),
        ("serial:/dev/ttyX?speed=1", "ttyX"),
        ("pty:/dev/there_is_none", "opened"),
        ("pty:/dev/null", "opened"),
        ("file:there_is_none", "opened"),
        ("sim:no_scene", "no_scene"),
        ("sim:capacitive_crosstalk", "nothing to show"),
        ("sim:?speed=0", "speed = 0"),
    ],
)
def test_what_is_no_line_is_refused(url, sentence):
    with pytest.raises(ValueError, match=sentence):
        host.connect(url)


def test_unplugged_in_the_middle_of_a_packet(tmp_path):
    """The pty closes after half a packet; the same name reappears; the gap is counted."""
    name, said = tmp_path / "core", []
    pipe = Pipe(simulated())
    first = Pty(pipe)
    name.symlink_to(first.path)
    with host.connect(f"pty:{name}", say=said.append) as core:
        core["slip.threshold"] = 77
        for at in range(3):
            pipe.core.say(p.SLIP, at, event(at)[2])
        pipe.core._out = pipe.core._out[:-9]
        assert [item.time for item in drained(core, pipe)] == [0, 1]
        name.unlink()  # first, because the number may be reused
        first.unplug()
        assert list(core.packets(0.2)) == []
        assert "is gone" in said[0] and "trying to open it again" in said[0] and len(said) == 1
        second = Pty(pipe)
        name.symlink_to(second.path)
        (gap,) = until(core, lambda item: isinstance(item, Gap))
        assert "is gone" in gap.reason and gap.seconds > 0.1
        assert "is back after" in said[1]
        pipe.core.say(*(p.SLIP, 9, event(9)[2]))
        assert until(core, lambda item: True)[0].time == 9
        counts = core.counts
        assert (counts.gaps, counts.damaged, counts.lost, counts.restarts) == (1, 1, 1, 0)
        assert counts.gap_s == gap.seconds
        assert core["slip.threshold"] == 77
        second.unplug()


def test_unplugged_while_a_register_is_read(tmp_path):
    name = tmp_path / "core"
    pipe = Pipe(simulated())
    first = Pty(pipe)
    name.symlink_to(first.path)
    with host.connect(f"pty:{name}", say=lambda _: None, give_up_s=0.3) as core:
        name.unlink()  # first, because the number may be reused
        first.unplug()
        with pytest.raises(NoAnswer, match=r"0.3 s"):
            core["core.id"]
        with Pty(pipe) as second:
            name.symlink_to(second.path)
            core.give_up_s = float("inf")
            assert core["core.id"] == 0x4D534E52
            assert core.counts.gaps == 1


def test_a_core_that_was_reset_is_set_up_again(tmp_path):
    """One reset while the cable was out (the new clock may exceed the old one), one while it was in."""
    name, said = tmp_path / "core", []
    pipe = Pipe(simulated())
    first = Pty(pipe)
    name.symlink_to(first.path)
    with host.connect(f"pty:{name}", say=said.append) as core:
        core["slip.threshold"] = 77
        core["tare.write"] = 1
        core["tare.average"] = 1
        name.unlink()  # first, because the number may be reused
        first.unplug()
        pipe.core.restart()
        acted, write = [], pipe.core.registers._write

        def watched(group, register, *rest):
            done = write(group, register, *rest)
            acted.extend(done[1])
            return done

        pipe.core.registers._write = watched
        pipe.core._now = 10**9
        second = Pty(pipe)
        name.symlink_to(second.path)
        until(core, lambda item: isinstance(item, Gap))
        list(core.packets(0.05))
        assert pipe.core.registers.access(False, names.place("slip.threshold").address)[0] == 77
        assert acted == [], "a register that acts when it is written was written again"
        assert core.counts.restarts == 1 and any("was reset" in sentence for sentence in said)
        until_quiet(core)
        lost = core.counts.lost
        pipe.core.restart()
        assert core["slip.threshold"] == 77
        assert (core.counts.restarts, core.counts.lost) == (2, lost)
        second.unplug()


def until_quiet(core):
    while list(core.packets(0.05)):
        pass


def test_lost_commands_and_answers_are_repeated_with_the_same_tag():
    pipe, seen = Pipe(simulated()), []
    core = connected(pipe, timeout_s=0.02)
    lose = iter([True, True, False])

    def to_core(data):
        seen.append(data)
        return b"" if next(lose, False) else data

    pipe.to_core = to_core
    core["slip.threshold"] = 5
    assert len(seen) == 3 and len(set(seen)) == 1
    assert core.counts.retries == 2
    answers = iter([True, False])
    pipe.to_core = lambda data: data
    pipe.to_host = lambda data: b"" if data and next(answers, False) else data
    assert core["slip.threshold"] == 5
    assert core.counts.retries == 3
    queue, last = [], b""

    def twice(data):
        """Repeats each answer just before the next one, which must not be taken for the next one."""
        nonlocal last
        if data:
            queue.extend((last, data))
            last = data
        return queue.pop(0) if queue else b""

    pipe.to_host = twice
    core["slip.threshold"] = 6
    for _ in range(3):
        assert (core["slip.threshold"], core["core.id"]) == (6, 0x4D534E52)


def test_an_answer_about_another_register_is_not_taken():
    """Tags repeat after 256 commands: an answer with the expected tag but another address is an old one."""
    pipe, old, held = Pipe(simulated()), bytearray(), bytearray()
    core = connected(pipe)

    def to_core(data):
        [(_, tag, address, _)], _ = bridge.accesses(data)
        payload = bridge.answer(tag, bridge.DONE, address ^ 4, 99)
        old[:] = cobs.encode(p.packet(p.ANSWER, 0, core.now, payload))
        return data

    def to_host(data):  # the old answer alone, the rest later
        held.extend(data)
        first = old or held
        data = bytes(first)
        first.clear()
        return data

    pipe.to_core, pipe.to_host = to_core, to_host
    core["slip.threshold"] = 6
    assert (core["slip.threshold"], core["core.id"]) == (6, 0x4D534E52)
    assert core.counts.restarts == 0


def test_a_core_that_does_not_answer():
    pipe = Pipe(simulated())
    pipe.to_core = lambda data: b""
    with pytest.raises(NoAnswer, match="nothing received"):
        connected(pipe, **QUICK)
    pipe = Pipe(simulated(*map(event, range(1000))))
    pipe.to_core = lambda data: b""
    with pytest.raises(NoAnswer, match=r"does not answer"):
        connected(pipe, **QUICK)
    core = connected(simulated(*map(event, range(1000))), registers=False)
    assert len(list(core.packets(0.2))) == 1000


def test_another_baud_rate_is_named():
    """A 3 Mbaud line received at other rates, bit by bit, through the twins of both UARTs."""
    sent = b"".join(cobs.encode(p.packet(p.SLIP, k, k, p.slip_event(k, 9, 2))) for k in range(60))
    line_ = levels(sent, 12_000_000, 3_000_000)
    for baud in (1_000_000, 921_600, 2_000_000):
        heard = bytes(byte for _, byte in UartRx(12_000_000, baud).process(line_) if byte is not None)
        model = simulated()
        pipe = Pipe(model)
        pipe.to_host = lambda data, heard=heard: heard
        with pytest.raises(NoAnswer, match=r"baud"):
            connected(pipe, **QUICK)


def test_noise_is_reported_once_until_packets_come_again():
    rng, said = np.random.default_rng(1), []
    pipe = Pipe(simulated())
    core = connected(pipe, say=said.append)
    pipe.to_host = lambda data: rng.bytes(500)
    for _ in range(20):
        list(core.packets(0))
    assert len(said) == 1 and "no valid packet" in said[0]
    pipe.to_host = lambda data: data
    pipe.core.say(p.SLIP, 0, event(0)[2])
    until(core, lambda item: True)
    pipe.to_host = lambda data: rng.bytes(500)
    for _ in range(20):
        list(core.packets(0))
    assert len(said) == 2 and core.counts.damaged > 50


def test_noise_costs_no_more_than_the_packets_it_touches():
    rng = np.random.default_rng(2)
    items = [event(k, k % 7, k) for k in range(3000)]
    model = simulated(*items)
    pipe = Pipe(model)

    def noisy(data):
        data = bytearray(data)
        for at in np.flatnonzero(rng.random(len(data)) < 1e-3):
            data[at] ^= 1 << int(rng.integers(0, 8))
        return bytes(data)

    pipe.to_host = noisy
    core = connected(pipe, registers=False)
    found = [item for _ in range(3) for item in core.packets(0)]
    sent = {(at, k % 7, k) for k, (at, _, _) in enumerate(items)}
    assert all((item.time, item.channel, item.p2p) in sent for item in found)
    assert len(found) + core.counts.lost == 3000 and 0 < core.counts.lost < 120


def test_a_pty_that_nobody_reads_holds_the_core():
    model = simulated(*map(event, range(2000)))
    with Pty(model) as pty, host.connect(pty.url, registers=False) as core:
        time.sleep(0.1)
        assert model._next is not None or len(model._out), "2000 packets do not fit into a pty"
        assert [item.time for item in until(core, lambda item: item.time == 1999)] == list(range(2000))


def test_no_descriptor_stays_open():
    def count():
        return len(os.listdir("/proc/self/fd"))

    before = count()
    for _ in range(5):
        with Pty(simulated()) as pty, host.connect(pty.url) as core:
            assert core["core.id"]
        with pytest.raises(NoAnswer):
            pipe = Pipe(simulated())
            pipe.to_core = lambda data: b""
            with Pty(pipe) as pty:
                host.connect(pty.url, **QUICK)
    assert count() == before


def test_what_waited_is_no_reset():
    """A health event sent after a later answer, and an image much older than it, must not be taken for a
    reset."""
    model = simulated(event(10_000))
    core = connected(model)
    core["core.id"]
    model.say(p.HEALTH, 9_000, p.health(1, 1))
    model.say(p.IMAGE, 10, p.image_chunks(0, [1])[0])
    assert len(list(core.packets(0.05))) == 2
    assert core.counts.restarts == 0 and core.now == 10_000
