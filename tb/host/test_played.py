"""Scenes as a page plays them: which have something to show, and what their cores send, part by part, against
literals, plain loops, and the scene's own run."""

import tomllib

import numpy as np
import pytest

from meissner import scenes
from meissner.engines.features import function
from meissner.host import Core, packets, sensors, web
from meissner.host.line import Pipe
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.scenes import played
from meissner.scenes.hand import loop
from meissner.scenes.sensor import sensors as every_sensor
from meissner.twins.actuate.grip import Grip
from meissner.twins.core import OF_LOAD, of_electrodes
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Decoder

CLOCKS = 25_000_000  # of a simulated core in a second


class Played:
    """The core of a part, read as fast as the machine can."""

    def __init__(self, part):
        one = sensors.driven(part)
        source = sensors.together(one.source, sensors.statistics_source)
        self.core = SimulatedCore(source, settings=one.settings, size=one.size, level=one.level or 1)
        for name, value in one.status.items():
            self.core.report(name, value)
        self._decoder, self._rest = Decoder(), []

    def until(self, seconds, *kinds):
        """Packets of these kinds up to that time, since the last call."""
        while not self._rest or self._rest[-1].time <= seconds * CLOCKS:
            self._rest += self._decoder.next(self.core.read(16))
        found = [one for one in self._rest if one.time <= seconds * CLOCKS]
        self._rest = self._rest[len(found) :]
        return [one for one in found if one.kind in kinds]


def test_every_scene_with_something_to_show_is_played():
    """A core that ends at the demodulator has no packet for its amplitudes; every other one has."""
    makers = {name: played.played(scenes.load(name)) for name in scenes.names()}
    assert [name for name, found in makers.items() if not found] == ["capacitive_crosstalk"]
    assert {scenes.load(name).sensor for name, found in makers.items() if found} == {*every_sensor()}
    for name, found in makers.items():
        assert bool(found) == (
            set(scenes.load(name).features) > {"demod"} or "demod" not in scenes.load(name).features
        )


def test_a_page_has_the_settings_that_a_core_obeys():
    """And of a core without channels no states."""
    pipe = of_scenes("cop_load")
    source = web.OfCore(Core(Pipe(pipe), pipe.units), pipe.title)
    assert [one["name"] for one in source.hub.about["settings"]] == ["cop4.min_load"]
    assert source.hub.about["title"] == "cop_load, 95.2 times more slowly"  # 21 ms in 2 s
    source.step()
    assert source.hub.now["states"] == {} and pipe.states == []
    pipe = of_scenes("acrylic_slip")
    names = {one["name"] for one in web.OfCore(Core(Pipe(pipe), pipe.units), "").hub.about["settings"]}
    assert "slip.threshold" in names and {name.split(".")[0] for name in names} == {"slip"}


def test_a_scene_without_anything_to_show_is_refused_in_a_sentence():
    with pytest.raises(
        ValueError, match=r"capacitive_crosstalk has nothing to show.*but capacitive_crosstalk"
    ) as told:
        of_scenes("capacitive_crosstalk")
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "count, rate_hz, slow",
    [(400, 100_000, 500.0), (1, 1000, 250.0), (999, 1000, 2000 / 999), (1000, 1000, 1.0)],
)
def test_short_recordings_are_played_more_slowly(monkeypatch, count, rate_hz, slow):
    """In 2 s instead of less than 1 s, but not with fewer than four samples a second."""
    part = played.Classes(rate_hz=rate_hz, span=count, labels=np.zeros(count), votes=np.zeros(count))
    monkeypatch.setattr(played, "played", lambda scene: [lambda seed: part])
    [found], factor = played.parts(None, 1)
    assert factor == pytest.approx(slow, rel=1e-12) and found.rate_hz == pytest.approx(
        rate_hz / slow, rel=1e-12
    )


def test_a_least_load_that_is_written_is_obeyed():
    """Of loads 5, 6, 7 against 6; the frames repeat."""
    forces = np.array([[[5, 0]], [[0, 6]], [[7, 0]]], dtype=np.uint16)
    line = Played(played.Frames(rate_hz=10.0, span=3, forces=forces, min_load=6))
    found = line.until(0.45, p.COP, p.IMAGE)
    cops = [one.fields for one in found if one.kind == p.COP]
    assert [(one["load"], one["pressed"], one["x"]) for one in cops] == [
        (5, False, 0), (6, True, 16384), (7, True, -16384), (5, False, 0), (6, True, 16384)
    ]  # fmt: skip
    images = [list(one.fields["taxels"]) for one in found if one.kind == p.IMAGE]
    assert images == [[5, 0], [0, 6], [7, 0], [5, 0], [0, 6]]
    line.core.put("cop.min_load", 7)
    assert [one.fields["pressed"] for one in line.until(0.95, p.COP)] == [True, False, False, True, False]


def test_four_electrodes_send_what_the_whole_recording_gives():
    """The source goes block by block, so that registers can change; the twin of the core takes it whole."""
    [make] = played.played(scenes.load("cop_slip"))
    part = make(3)
    whole = of_electrodes(part.codes, part.config.registers, part.config.terms, part.lag, part.registers)
    line, seconds, clocks = Played(part), len(part.codes) / part.rate_hz, CLOCKS / part.rate_hz
    found = line.until(seconds - 0.5 / part.rate_hz, p.SLIP, p.CHANGE, p.COP)
    changes = [(one.time, one.payload) for one in found if one.kind != p.COP]
    assert changes == [(int(frame * clocks), payload) for frame, _, payload in whole.changes]
    assert len(whole.slip) == 1 and changes[0][1][:2] == OF_LOAD.to_bytes(2, "little")
    cops = [(one.time, one.payload) for one in found if one.kind == p.COP]
    every = round(part.rate_hz / sensors.COP_HZ)
    assert cops == [(int(frame * clocks), payload) for frame, payload in whole.cop[::every]]
    assert line.until(2 * seconds, p.SLIP)
    line.core.put("cop_slip.drop", 255)  # a load never falls by so much
    assert not line.until(3 * seconds, p.SLIP)


def test_classes_are_told_once_each():
    labels, votes = np.array([-1, 4, 4, 0, 0]), np.array([-1, 70, 71, 90, 91])
    line = Played(played.Classes(rate_hz=10.0, span=5, labels=labels, votes=votes))
    found = line.until(0.85, p.CLASS)
    told = [(one.time, *(one.fields[name] for name in ("label", "told", "votes"))) for one in found]
    tenth = CLOCKS // 10
    assert told == [
        (tenth, 4, 65535, 70),
        (3 * tenth, 0, 4, 90),
        (6 * tenth, 4, 0, 70),
        (8 * tenth, 0, 4, 90),
    ]
    assert line.core.status["forest", "label", "value"] == 0


def test_pins_are_shown_when_they_change():
    """Times, levels, the number of pins that are on, and the drive, from tables."""
    frames = [(0.0, 100.0, np.array([[0, 1]])), (0.5, 230.0, np.array([[3, 2]]))]
    line = Played(played.Pins(rate_hz=1.0, span=0.75, frames=frames, bits=2))
    core = line.core
    assert [core.status["display", "size", name] for name in ("rows", "columns", "bits")] == [1, 2, 2]
    line.until(1.4)
    pins = [(one.time_s, one.time, one.levels.tolist(), one.most) for one in core.beside]
    assert pins == [
        (at, round(at * CLOCKS), levels, 3)
        for at, levels in ((0, [[0, 1]]), (0.5, [[3, 2]]), (0.75, [[0, 1]]), (1.25, [[3, 2]]))
    ]
    assert core.status["display", "state", "pins"] == 2 and core.status["display", "state", "running"] == 1
    # 230 Hz is 230 / 25 MHz of a period a clock, times 2^40.
    assert core.registers.setting("display", "increment") == round(230 * 2**40 / 25e6)


def test_a_hand_closes_its_own_loop_and_obeys_a_viewer():
    """Commands are those of the scene's own run, until they may not change any more."""
    table = tomllib.loads(scenes.source("grip_water"))
    table["world"] |= {"duration_s": 4.0, "hold_from_s": 1.0, "pour_start_s": 0.5}
    scene = scenes.build("grip_water", table)
    [make] = played.played(scene)
    line, seconds = Played(make(1)), 2.0
    changes, status = line.until(seconds, p.SLIP, p.CHANGE), line.core.status
    held = loop.hold(scene, scene.conditions[0], [1], (loop.FixedSlip, Grip))
    command, cycle = status["grip", "command", "value"], round(100 * seconds)
    assert changes and command in held.trace.command[cycle : cycle + 10].tolist()
    rises = (np.diff(held.trace.command[:cycle]) > 0).sum()
    assert status["grip", "tightenings", "value"] >= rises > 3
    assert line.core.registers.setting("slip", "threshold") > 0
    line.core.put("grip.rate", 0)  # no change in any cycle, from the next few on
    line.until(seconds + 0.1)
    command, cycle = status["grip", "command", "value"], cycle + 10
    assert set(held.trace.command[cycle : cycle + 90].tolist()) - {command}
    line.until(seconds + 1)
    assert status["grip", "command", "value"] == command


def test_the_speed_of_shear_is_in_its_registers():
    """That of the last window, or of one at most a block of samples away, as the whole recording gives it."""
    [make] = played.played(scenes.load("shear_speed"))
    part = make(1)
    mm_s, flags = (
        rows[0] for rows in function("fixed", "shear_speed")(part.codes.T, part.shear, part.moving)
    )
    whole = [[round(speed * 2**20), flag] for speed, flag in zip(mm_s.tolist(), flags.tolist())]
    line, seen = Played(part), set()
    for k in range(1, round(20 * part.span / part.rate_hz)):
        line.until(k / 20)
        status = [line.core.status["shear_speed", "channel0", name] for name in ("speed", "flags")]
        last = int(line.core.now / CLOCKS * part.rate_hz) // 64
        assert status in whole[max(0, last - 4) : last + 5], k
        seen.add(status[1])
    assert 0 in seen and len(seen) > 1
    line.core.speed = 1.0  # it waits for the clock from here on
    shown = web.OfCore(Core(Pipe(line.core)), "shear").hub.now["register"]
    assert shown["shear_speed.enable"] == 1 and shown["shear_speed.channel0"] == status[0] | status[1] << 24


KINDS = {  # of the packets that a scene's core must send, by its features
    "slip": packets.StateChange,
    "cop": packets.Image,
    "cop4": packets.CopFrame,
    "cop_slip": packets.SlipEvent,
}


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in scenes.names() if name != "capacitive_crosstalk"])
def test_every_scene_sends_what_its_features_promise(name):
    scene = scenes.load(name)
    pipe = of_scenes([scene], speed="1000")
    core = Core(Pipe(pipe), pipe.units)
    wanted = {KINDS[one] for one in scene.features if one in KINDS}
    wanted |= {packets.ClassChange} if name == "rope_pull" else set()
    seen, local, start = set(), set(), core.now
    for item in core.packets():
        seen.add(type(item))
        local |= {type(one) for one in pipe.beside}
        if wanted <= seen and (not {"pin_display", "render"} & {*scene.features} or sensors.Pins in local):
            break
        assert item.time < start + 300 * CLOCKS, (seen, local)
