"""msn_display: images to pins within the clocks of the budget, a host's words as a frame, faults of the
sensor, damaged frames of a host, a slip's octant. The model's words by hand."""

import random
import re
from itertools import pairwise
from operator import attrgetter

import cocotb
import numpy as np
import pytest
from cocotb.utils import get_sim_time

import bench
import members
from meissner.builds import config
from meissner.twins.actuate.display import DisplayConfig, words
from meissner.twins.actuate.pin_display import DisplaySettings, DisplaySize
from meissner.twins.actuate.render import RenderSettings
from parts.hv507 import Hv507
from reference.pin_display import stripes

SHAPE, GRID = (3, 4), (2, 5)
SIZE = DisplaySize(pins=10, amplitude_bits=2, clk_khz=4000)
SETTINGS = {"increment": SIZE.limits[1], "stop": 65535}
QUIET = {"image_valid_i": 0, "image_data_i": 0, "image_last_i": 0, "cop_valid_i": 0, "cop_i": 0, "slip_i": 0}
QUIET |= {"raised_i": 0, "octant_i": 0, "sensor_i": 0}
PERIOD = 10_000  # clocks, 400 Hz at 4 MHz


def word(host=False, render=None, **more):
    config = DisplayConfig(
        GRID, SIZE, DisplaySettings(**SETTINGS), render or RenderSettings(1, 100), host=host
    )
    settings = config.settings | more
    return members.word("display_cfg", {name: int(value) for name, value in settings.items()})


class Bench:
    async def start(self, dut, **how):
        self.dut = dut
        await bench.start(dut, cfg_i=word(**how), **QUIET)
        lines = (dut.hv_clk_o, dut.hv_le_o, dut.hv_bl_o, dut.hv_pol_o)
        slow = lambda violation: None if str(violation)[:2] == "t_" else Hv507.fail(None, violation)
        self.driver = Hv507(dut.hv_data_o, *lines, 1, report=slow)
        return self

    async def image(self, taxels):
        taxels = np.ravel(taxels)
        for place, taxel in enumerate(taxels):
            self.dut.image_valid_i.value, self.dut.image_data_i.value = 1, int(taxel)
            self.dut.image_last_i.value = place == len(taxels) - 1
            await bench.RisingEdge(self.dut.clk_i)
        self.dut.image_valid_i.value = self.dut.image_last_i.value = 0

    async def host(self, levels, cut=None, source=True):
        for each in words(levels)[:cut]:
            for strobe in (1, 0):
                self.dut.cfg_i.value = word(
                    host=source, levels_next=each & 0xFFFFFF, levels_last=each >> 24, levels_written=strobe
                )
                await bench.clocks(self.dut, 1 + 4 * (1 - strobe))

    @property
    def on(self):
        """The pins that are high now; outputs without a pin are low."""
        assert not any(self.driver.outputs[GRID[0] * GRID[1] :])
        return np.reshape(self.driver.outputs[: GRID[0] * GRID[1]], GRID)

    async def lit(self, periods, wait=4):
        """(clocks in which each pin is high in so many periods, rises of the first pin), after a ``wait``."""
        await bench.clocks(self.dut, wait * PERIOD)
        seen, points = len(self.driver.changes), [(get_sim_time("ns"), self.driver.outputs)]
        await bench.clocks(self.dut, periods * PERIOD)
        points += [*self.driver.changes[seen:], (get_sim_time("ns"), self.driver.outputs)]
        spans = [np.array(levels) * (b - a) / 10 for (a, levels), (b, _) in pairwise(points)]
        rises = sum(not a[0] and b[0] for (_, a), (_, b) in pairwise(points))
        return np.sum(spans, axis=0)[: GRID[0] * GRID[1]], rises

    async def shows(self, image):
        """{(row, column)} of the pins that are on after an image."""
        await self.image(image)
        clocks, _ = await self.lit(1, 2)
        return {tuple(pin) for pin in np.argwhere(clocks.reshape(GRID)).tolist()}

    @property
    def status(self):
        return members.of("display_status", bench.read(self.dut.status_o))


felt = bench.applies(lambda dut: dut.Image.value.to_unsigned() == 1)


@bench.applies(lambda dut: dut.Image.value.to_unsigned() == 0)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def stripes_move_where_a_slip_began_to_go(dut):
    """The octant in the sample that raises the slip; a frame for each centre of pressure."""
    here = await Bench().start(dut, render=RenderSettings(1, 0, 0, 1), octant=6)
    await bench.clocks(dut, 10)
    dut.raised_i.value, dut.octant_i.value, dut.slip_i.value = 1, 3, 1
    await bench.clocks(dut, 1)
    dut.raised_i.value, dut.octant_i.value = 0, 5
    for phase, octant in enumerate((3, 3, 3, 4, 4, 3)):
        if phase > 2:  # another slip begins
            dut.raised_i.value, dut.octant_i.value = 1, octant
            await bench.clocks(dut, 1)
            dut.raised_i.value, dut.octant_i.value = 0, 5
        dut.cop_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.cop_valid_i.value = 0
        await bench.RisingEdge(dut.hv_le_o)
        await bench.clocks(dut, PERIOD * (2 if phase == 0 else 1))
        seen = np.zeros(GRID, dtype=int)
        for _ in range(PERIOD // 50):
            await bench.clocks(dut, 50)
            seen |= here.on
        assert {tuple(pin) for pin in np.argwhere(seen).tolist()} == stripes(octant, phase, *GRID)


@felt
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def what_the_sensor_feels_is_on_the_pins_in_time(dut):
    """At most the clocks of the budget after the last taxel: computing, a drive period, the load."""
    here, draw = await Bench().start(dut), random.Random(bench.SEED)
    await here.image(np.zeros(SHAPE))
    await bench.clocks(dut, 2 * PERIOD + SIZE.lead + 400)
    twin = DisplayConfig(GRID, SIZE, render=RenderSettings(1, 100)).render_of(SHAPE)
    image = np.array([[0, 300, 0, 0], [0, 250, 0, 999], [7, 0, 0, 0]])
    await bench.clocks(dut, draw.randrange(PERIOD))
    await here.image(image)
    levels = twin.next(image)
    most = twin.clocks + PERIOD + SIZE.lead
    for clock in range(most + 1):  # noqa: B007
        await bench.ReadOnly()
        if here.on.any():
            break
        await bench.RisingEdge(dut.clk_i)
    assert 0 < clock <= most and here.on.tolist() == (levels > 0).tolist()


@felt
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_setting_of_the_drive_counts(dut):
    """Clocks in four periods of 10,000, each within a clock of the next; a level of 3 is high for a half."""
    here = await Bench().start(dut)
    await here.image(np.full(SHAPE, 999))
    for more, clocks, rises, pins, limited in (
        ({}, 20_000, 4, 10, 0),
        ({"top": 1}, 10_000, 4, 10, 0),
        ({"burst_period": 4, "burst_on": 3}, 15_000, 3, 10, 0),
        ({"increment": SETTINGS["increment"] // 2}, 20_000, 2, 10, 0),
        ({"most": 3}, 20_000, 4, 3, 1),
        ({"duty": 0}, 0, 0, 0, 1),
        ({"enable": 0}, 0, 0, 0, 0),
        ({"stop": 9}, 0, 0, 0, 0),
    ):
        dut.cfg_i.value = word(**more)
        high, risen = await here.lit(4)
        on = pins if clocks else 0
        assert np.abs(high - ([clocks] * on + [0] * (10 - on))).max() < 8 and risen == rises, more
        status = here.status
        running = int(not {"enable", "stop"} & set(more))
        assert (status["state_running"], status["state_limited"] if running else 0) == (running, limited), (
            more
        )
        assert status["state_pins"] == pins or "burst_on" in more, more


@felt
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_bit_has_its_wire(dut):
    """Random settings and samples at the ports of the blocks inside, whose own tests show what they do there;
    of a host's frame every level; each bit of health's counters is a fault."""
    here, draw = await Bench().start(dut), random.Random(bench.SEED)
    pins, render = (attrgetter(path)(dut) for path in ("gen_display.u_pins", "gen_display.u_render"))
    drive = ("enable", "increment", "burst_period", "burst_on", "top", "most", "duty", "watchdog", "stop")
    for _ in range(40):
        cfg, cop, data = (draw.getrandbits(len(port)) for port in (dut.cfg_i, dut.cop_i, dut.image_data_i))
        dut.cfg_i.value, dut.cop_i.value, dut.image_data_i.value = cfg, cop, data
        set_, felt_at = members.of("display_cfg", cfg), members.of("cop", cop)
        for port in (lines := (dut.image_valid_i, dut.image_last_i, dut.cop_valid_i, dut.slip_i)):
            port.value = draw.getrandbits(1)
        await bench.ReadOnly()
        wanted = {(pins, f"cfg_{name}_i"): set_[name] for name in drive}
        wanted |= {(render, f"cfg_{name}_i"): set_[name] for name in ("floor", "step", "marker", "cue")}
        wanted |= {(render, f"cop_{name}_i"): felt_at[name] & 0xFFFF for name in "xy"}
        wanted |= {(render, "octant_i"): set_["octant"], (render, "cop_pressed_i"): felt_at["pressed"]}
        wanted |= {(render, "in_data_i"): data}
        names = ("in_valid_i", "in_last_i", "cop_valid_i", "slip_i")
        wanted |= {(render, name): bench.read(port) for name, port in zip(names, lines)}
        for (block, name), value in wanted.items():
            assert bench.read(getattr(block, name)) == value, name
        await bench.RisingEdge(dut.clk_i)
    for name, value in ({"cfg_i": word()} | QUIET).items():
        getattr(dut, name).value = value
    await bench.reset(dut)
    counters = ("health_dead", "health_railed", "health_blinking")
    for name, bit in ((n, k) for n in counters for k in range(members.PLACES["status"][n][1])):
        dut.sensor_i.value = 1 << members.PLACES["status"][name][0] + bit
        await bench.ReadOnly()
        assert here.status["state_fault"] == 1, (name, bit)
        await bench.RisingEdge(dut.clk_i)
        dut.sensor_i.value = 0
        await bench.ReadOnly()
        assert here.status["state_fault"] == 0
        await bench.RisingEdge(dut.clk_i)
    for _ in range(12):
        levels, got = [[draw.getrandbits(8) for _ in range(GRID[1])] for _ in range(GRID[0])], []
        sent = cocotb.start_soon(here.host(levels))
        while len(got) < GRID[0] * GRID[1]:
            await bench.ReadOnly()
            if bench.high(pins.in_valid_i):
                got.append((bench.read(pins.in_data_i), bench.high(pins.in_last_i)))
            await bench.RisingEdge(dut.clk_i)
        assert got == [(level, at == 9) for at, level in enumerate(np.ravel(levels).tolist())]
        await sent


@felt
@cocotb.test(timeout_time=9, timeout_unit="ms")
async def a_centre_of_pressure_is_marked_and_a_slip_moves_by_the_register(dut):
    here = await Bench().start(dut, render=RenderSettings(1, 0, 1, 1), octant=6)
    for x, y, pressed, expected in ((3000, -9000, 1, {(1, 2)}), (-9000, 9000, 1, {(0, 1)}), (0, 0, 0, set())):
        dut.cop_valid_i.value = 1
        dut.cop_i.value = members.word("cop", {"x": x, "y": y, "pressed": pressed})
        await bench.clocks(dut, 1)
        dut.cop_valid_i.value = 0
        assert await here.shows(np.zeros(SHAPE)) == expected
    dut.slip_i.value = dut.raised_i.value = 1
    dut.octant_i.value = 3  # that only a core with a direction uses
    for phase in range(3):
        assert await here.shows(np.zeros(SHAPE)) == stripes(6, phase, *GRID)


@felt
@cocotb.test(timeout_time=9, timeout_unit="ms")
async def a_hosts_words_are_a_frame(dut):
    """A cut frame is dropped; the sensor's frames do not count, nor its faults, nor words while they did."""
    here = await Bench().start(dut)
    await here.host(np.full(GRID, 1), cut=1, source=False)
    await here.host(np.full(GRID, 3))
    await bench.clocks(dut, 2 * PERIOD + SIZE.lead + 400)
    assert here.on.all()
    numbers = np.random.default_rng(bench.SEED).integers(0, 256, GRID)
    for levels in (numbers, 255 - numbers):
        await here.host(levels)
        clocks, _ = await here.lit(4)
        expected = [0 if level == 0 else 5000 * (min(level, 3) + 1) for level in levels.ravel().tolist()]
        assert np.abs(clocks - expected).max() < 8
    levels = np.array([[255, 0, 1, 0, 2], [0, 3, 0, 0, 9]])
    await here.host(levels)
    await here.host(levels * 0, cut=2)
    await here.image(np.zeros(SHAPE))
    dut.sensor_i.value = members.word("status", {"scan_lost": 1, "health_dead": 2})
    await bench.RisingEdge(dut.hv_le_o)
    await bench.clocks(dut, PERIOD)
    seen = np.zeros(GRID, dtype=int)
    for _ in range(PERIOD // 50):
        await bench.clocks(dut, 50)
        seen |= here.on
    assert seen.tolist() == (levels > 0).tolist()
    status = here.status
    assert (status["size_rows"], status["size_columns"], status["size_bits"]) == (2, 5, 2)
    assert (status["state_running"], status["state_fault"], status["state_pins"]) == (1, 0, 5)
    assert (status["dropped"], status["faults"]) == (0, 0)
    await here.host(levels)  # it ends the frame that was cut: too long
    await bench.clocks(dut, 100)
    assert here.status["dropped"] == 1


@felt
@cocotb.test(timeout_time=9, timeout_unit="ms")
async def a_fault_of_the_sensor_switches_off(dut):
    """A lost conversion once, then a silent period; a taxel that health reports as long as it is reported."""
    here = await Bench().start(dut)
    await here.image(np.full(SHAPE, 500))
    await bench.clocks(dut, 2 * PERIOD + SIZE.lead + 400)
    once = ("scan_lost", "adc_timeout", "adc_mistagged")
    lasting = ("health_railed", "health_dead", "health_blinking")
    for name in once + lasting:
        assert bench.high(dut.hv_bl_o) and bench.high(dut.hv_pol_o) and not bench.high(dut.hv_dir_o)
        # A counter's lowest bits.
        dut.sensor_i.value = members.word("status", {name: 12 if name == "scan_lost" else 1})
        await bench.clocks(dut, 4)
        assert not bench.high(dut.hv_bl_o) and not here.on.any(), name
        await bench.clocks(dut, 2 * PERIOD + SIZE.lead)
        assert bench.high(dut.hv_bl_o) == (name in once)
        assert here.status["state_fault"] == (name in lasting)
        dut.cfg_i.value = word(health=0)
        await bench.clocks(dut, 2 * PERIOD + SIZE.lead)
        assert bench.high(dut.hv_bl_o) and not here.status["state_fault"]
        dut.sensor_i.value, dut.cfg_i.value = members.word("status", {}), word()
        await bench.clocks(dut, 2 * PERIOD + SIZE.lead)
    assert here.status["faults"] == len(once) * 2 + len(lasting)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "hv_clk_o", "hv_le_o", "hv_bl_o")


EVIDENCE = {
    "equivalence": {"boxes": True},
    "mutants": {"sets": [0], "unsolved": True},  # the other build has one test, of stripes
    "faults": {
        "none": "render, pin_display, fifo and width_converter, each done alone; its own upsets last for "
        "a clock, a host's frame, or until a slip begins"
    },
}


@pytest.mark.parametrize("sensor", [{}, {"Image": 0, "Directed": 1}], ids=("array", "electrodes"))
def test_display(sensor):
    size = {"Rows": SHAPE[0], "Columns": SHAPE[1], "PinRows": GRID[0], "PinColumns": GRID[1]}
    size |= {"AmplitudeBits": 2, "ClkKhz": 4000}
    bench.run("actuate", "display", size | sensor, inside=("msn_pin_display", "msn_render"))


def test_refuses_illegal_parameters():
    assert "Display = 1 must go with" in bench.refuses("display", {"Suits": 0})


def test_config_by_hand():
    config = DisplayConfig(GRID, SIZE, host=True, octant=5)
    names = "PinRows PinColumns PinChains AmplitudeBits"
    assert [config.parameters[name] for name in names.split()] == [2, 5, 1, 2]
    assert {"enable": 1, "source": 1, "octant": 5, "health": 1, "floor": 1}.items() <= config.settings.items()
    for wrong in ({"octant": 8}, {"grid": (2, 4)}, {"grid": (0, 9)}):
        with pytest.raises(ValueError, match=r"octant|2 x 4|rows"):
            DisplayConfig(**{"grid": GRID, "size": SIZE} | wrong)


def test_words_by_hand():
    """Three levels a word, the first lowest; a row ends its word; the last word says so."""
    assert words([[1, 2, 3, 4], [5, 6, 7, 255]]) == [0x030201, 0x04, 0x070605, 0x1_0000_FF]
    for wrong in (-1, 256, 0.5):
        with pytest.raises(ValueError, match="level"):
            words([[wrong, 0]])


PAD = {
    "about": "a",
    "clock": {"mhz": 24.0},
    "sensor": {"kind": "array", "rows": 2, "columns": 4},
    "adc": {"part": "MCP3208", "channels": 4, "volts": 5.0, "rate_hz": 100.0, "settle_us": 2.0},
    "array": {"health": False, "tare": False},
}
FINGERS = PAD | {"sensor": {"kind": "channels", "channels": 3}, "adc": {"part": "MCP3208", "volts": 5.0}}
FINGERS["adc"] |= {"rate_hz": 1000.0}
FINGERS["slip"] = {"window": 32, "threshold_p2p_v": 0.02, "gross_threshold_p2p_v": 0.1, "contact_rises": True}
FINGERS["slip"] |= {"contact_level_v": 1.5, "release_level_v": 1.0}
del FINGERS["array"]
WIRES = {
    **{"about": "a", "clock": {"mhz": 24.0}, "sensor": {"kind": "electrodes"}},
    "adc": {"part": "AD7606", "volts": 10.0, "rate_hz": 2000.0},
    "mesh": {"rows": 9, "columns": 9, "r_ohm": 47.0, "R0_ohm": 1e4, "V0_v": 5.0, "k_n_ohm": 1e4},
    "load": {"gain": 1.0, "lsb_n": 1e-3, "min_n": 0.05, "correction": "none"},
    "link": {"registers": True},
}
LIMITS = [  # the build, keys of [display] that are taken, one of them beyond, what the sentence names
    (PAD, {"rows": 1, "columns": 2}, {"columns": 1}, "2 pins"),
    (PAD, {"rows": 63, "columns": 65, "chains": 8, "amplitude_bits": 1}, {"rows": 64, "columns": 64}, "pins"),
    (PAD, {"rows": 7, "columns": 5, "chains": 7}, {"chains": 8}, "chains = 8 must all have pins"),
    (PAD, {"duty": 0.0003, "drive_hz": 400.0}, {"duty": 0.000275}, "duty = 0.000275 must be at least 0.0003"),
    (PAD, {"duty": 0.10005, "drive_hz": 1.0, "stop_s": 2.1}, {"duty": 0.1}, "duty = 0.1 must be at least"),
    (PAD, {"drive_hz": 1.0, "stop_s": 2.01}, {"stop_s": 2.0}, "stop_s = 2 must be above 2, two"),
    (PAD, {"duty": 1}, {"duty": 0}, "duty = 0 must be at least"),
    (PAD, {"most_pins": 1}, {"most_pins": 0}, "most_pins = 0"),
    (PAD, {"burst_s": 0.4, "burst_on_s": 0.4}, {"burst_on_s": 0}, "burst_on_s must be above 0"),
    (PAD, {"stop_s": 0.0105}, {"stop_s": 0.01}, "stop_s = 0.01 must be above 0.01"),
    (PAD, {"stop_s": 0.01, "source": "host"}, {"source": "sensor"}, "stop_s = 0.01"),
    (PAD, {"floor_codes": 65519}, {"floor_codes": 65520}, "floor_codes = 65520 must be at most 65519"),
    (FINGERS, {"floor_codes": 4095}, {"floor_codes": 4096}, "floor_codes = 4096 must be at most 4095"),
    (PAD, {"top": 1}, {"top": 0}, "top"),
    (WIRES, {"marker": True}, {"marker": False}, "electrodes must have marker = true or cue_frames above 0"),
    (WIRES, {"source": "host"}, {"source": "sensor"}, "electrodes must have marker = true"),
    (WIRES, {"marker": True}, {"cue_frames": 1}, "cue_frames = 1 must go with [cop_slip]"),
    (PAD, {"marker": True}, {"cue_frames": 255}, "cue_frames = 255 must go with [slip]"),
    (FINGERS, {"cue_frames": 1}, {"marker": True}, "marker = true must go with an array or electrodes"),
    (FINGERS, {"step_codes": 4095}, {"step_codes": 4096}, "step_codes = 4096 must be at most 4095"),
]


@pytest.mark.parametrize("build, taken, beyond, says", LIMITS, ids=[says for *_, says in LIMITS])
def test_a_display_that_could_never_show_anything_is_refused(build, taken, beyond, says):
    """A period of 400 Hz is 10 ticks, of 1 Hz 4000; the next needs room for two more; 10 s have 40,000."""
    config.read("a", build | {"display": taken})
    with pytest.raises(ValueError, match=re.escape(says)) as problem:
        config.read("a", build | {"display": taken | beyond})
    assert "[display]" in str(problem.value)


def test_limits_in_clocks():
    """At 24,001 kHz a tick has 6001 clocks: half of 10 s are 19,997 of them and a part. A pin is on from 1
    on; 5 s are three whole sevenths of 10 s."""
    build = FINGERS | {"clock": {"mhz": 24.001}, "display": {"stop_s": 2.0, "most_pins": 7}}
    build["display"] |= {"burst_s": 0.4, "burst_on_s": 0.1, "top": 3, "octant": 5, "cue_frames": 6}
    display = config.read("a", build).features["display"]
    assert 5 * 24_001_000 - 6001 < display.pins.duty * 6001 <= 5 * 24_001_000
    assert (display.pins.stop, display.pins.watchdog, display.render.floor) == (7999, 3, 1)
    assert (display.pins.burst_period, display.pins.burst_on, display.pins.top) == (92, 23, 3)
    assert (display.pins.most, display.octant, display.render.cue) == (7, 5, 6)
    assert display.pins.increment == round(230 * 2**40 / 24_001_000)
