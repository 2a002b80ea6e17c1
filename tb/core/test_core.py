"""msn_core from a converter's pins to the levels of the serial line, built from configurations as a user
writes them: an array, single channels, four electrodes, the smallest sensor. The packets are the model's of
the very codes that the part converted, each with its convert start; commands are answered in between."""

import copy
from itertools import pairwise

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge
from cocotb.utils import get_sim_time

import bench
from meissner import config, core
from meissner.build import verilog
from meissner.link import bridge
from meissner.link import packet as p
from meissner.link.decoder import Decoder
from meissner.link.uart_tx import levels
from parts.ad7606 import Ad7606
from parts.mcp3208 import Mcp3208
from parts.timing import changed

PERIOD_NS = 250
SLIP_V = {
    **{"window": 16, "hop": 16, "threshold_v": 0.3, "gross_threshold_v": 1.0, "contact_level_v": 1.0},
    **{"release_level_v": 0.5, "contact_rises": True, "hold_ms": 1.0, "refractory_ms": 1.0, "blank_ms": 1.0},
}
SLIP_N = {
    **{"window": 16, "hop": 16, "threshold_n": 0.3, "gross_threshold_n": 1.0, "contact_level_n": 0.8},
    **{"release_level_n": 0.4, "hold_ms": 1.0, "refractory_ms": 1.0, "blank_ms": 1.0},
}
CASES = {
    "array": {
        "sensor": {"kind": "array", "rows": 3, "columns": 3},
        "adc": {"part": "MCP3208", "channels": 3, "volts": 5.0, "rate_hz": 800.0, "settle_us": 2.0},
        "array": {"health": True, "newtons_per_count": 1e-3},
        "slip": SLIP_N,
        "link": {"baud": 1_000_000, "images": True, "statistics": False},
    },
    "channels": {
        "sensor": {"kind": "channels", "channels": 3},
        "adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 4000.0},
        "slip": SLIP_V,
        "link": {"baud": 1_000_000, "statistics": False},
    },
    "electrodes": {
        "sensor": {"kind": "electrodes"},
        "adc": {"part": "AD7606", "volts": 10.0, "rate_hz": 2000.0},
        "mesh": {"rows": 9, "columns": 9, "r_ohm": 47.0, "R0_ohm": 1e4, "V0_v": 5.0, "k_n_ohm": 1e4},
        "load": {"gain": 1.0, "lsb_n": 1e-3, "min_n": 0.05, "correction": "none"},
        "cop_slip": {"lag_ms": 2.0, "drop": 0.3, "move": 0.0, "min_n": 0.2, "hold_ms": 1.0},
        "link": {"baud": 1_000_000, "statistics": False},
    },
    "smallest": {
        "sensor": {"kind": "channels", "channels": 1},
        "adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 5000.0},
        "slip": SLIP_V | {"serial": True},
        "link": {"baud": 500_000, "registers": False, "statistics": False, "slip_only": True},
    },
}
FRAMES = {"array": 36, "channels": 120, "electrodes": 60, "smallest": 120}
COMMON = {"about": "of a test", "clock": {"mhz": 4.0}}


def configuration(name):
    return config.read(name, copy.deepcopy(COMMON | CASES[name]))


def case_of(dut):
    value = lambda name: dut.__getattr__(name).value.to_unsigned()
    for name in CASES:
        parameters = configuration(name).parameters
        if all(value(key) == given for key, given in parameters.items()):
            return name, configuration(name)
    raise AssertionError("built of none of the configurations")


class Line:
    """Levels of tx_o, one a clock, from its edges."""

    def __init__(self, dut):
        self.dut, self.edges = dut, []
        cocotb.start_soon(self._watch())

    async def _watch(self):
        while True:
            await changed(self.dut.tx_o)
            self.edges.append((get_sim_time("ns"), int(self.dut.tx_o.value)))

    def bytes(self, bit_ns):
        """8 bits, none parity, 1 stop, sampled in the middle of each bit."""
        found, busy = bytearray(), 0
        times = np.array([time for time, _ in self.edges])
        for time, level in self.edges:
            if level == 0 and time >= busy:
                middles = time + bit_ns * (np.arange(1, 9) + 0.5)
                places = np.searchsorted(times, middles, side="right") - 1
                found.append(sum(self.edges[place][1] << bit for bit, place in enumerate(places)))
                busy = time + 9.5 * bit_ns
        return bytes(found)


class Sensor:
    """Codes in the order they are converted, kept by frame; ``starts``: convert starts, in clocks."""

    def __init__(self, dut, build, codes):
        self.dut, self.build, self.codes, self.taken = dut, build, codes, []
        pins = [dut.adc_cs_n_o, dut.adc_sclk_o]
        if build.part.has_busy:
            self.part = Ad7606(
                *(*pins, dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, self.code),
                conversion_ns=3995,
            )
        else:
            self.part = Mcp3208(*pins, dut.adc_mosi_o, dut.adc_miso_i, self.code)

    def code(self, channel, _):
        per_frame = 8 if self.build.part.has_busy else self.codes[0].size
        frame, place = divmod(len(self.taken), per_frame)
        flat = self.codes[min(frame, len(self.codes) - 1)].ravel()
        if self.build.kind == "array":
            row = bench.read(self.dut.row_o).bit_length() - 1
            place = row * self.build.sensor["columns"] + channel
        code = int(flat[place]) if place < len(flat) else 0
        self.taken.append(code)
        return code & (1 << self.build.part.data_bits) - 1


def codes_of(name, build, frames):
    """What the sensor gives, [frames, ...]."""
    rng = np.random.default_rng(bench.SEED)
    if name == "array":
        i, j = np.indices((3, 3))
        press = 1500 * np.exp(-((i - 0.6) ** 2 + (j - 1.2) ** 2) / 1.5)
        n = np.arange(frames)[:, None, None]
        shape = 100 + 40 * i + rng.integers(-2, 3, (frames, 3, 3))
        return shape + np.rint(press * (n >= 12) * (1 + 0.5 * ((n // 11) % 2) * (n % 2))).astype(np.int64)
    if name == "electrodes":
        newtons = 1 + 0.02 * np.arange(frames)
        newtons[30:] *= 0.5
        newtons[44:] *= 0.4
        load = np.zeros((frames, 9, 9))
        load[:, 4, 2] = newtons
        solved = build.cop4.mesh.solve(load)
        return build.cop4.convert(np.stack([solved.E1, solved.E2, solved.E3, solved.E4], axis=1))
    steps = 400 * (rng.random((frames, build.channels)) < 0.05) + 900 * (
        rng.random((frames, build.channels)) < 0.01
    )
    return 1500 + rng.integers(-9, 10, steps.shape) + steps


async def begin(dut, name, build):
    idle = {"actuator_moving_i": 0, "in_valid_i": 0, "rx_i": 1, "bus_valid_i": 0, "out_ready_i": 0}
    line = Line(dut)
    for port, value in (idle | {"adc_miso_i": 0, "adc_busy_i": 0, "rst_i": 1}).items():
        getattr(dut, port).value = value
    Clock(dut.clk_i, PERIOD_NS, unit="ns").start()
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    starts = []

    async def watch():
        while True:
            await RisingEdge(dut.convert)
            starts.append(round(get_sim_time("ns") / PERIOD_NS))

    sensor = Sensor(dut, build, codes_of(name, build, FRAMES[name] + 8))
    cocotb.start_soon(watch())
    return line, sensor, starts


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def packets_are_the_models_of_the_codes_at_the_pins(dut):
    name, build = case_of(dut)
    line, sensor, starts = await begin(dut, name, build)
    frames = FRAMES[name]
    await bench.clocks(dut, frames * build.period_clocks)
    bit_ns = 1e9 / build.link["baud"]
    decoder = Decoder()
    got = decoder.next(line.bytes(bit_ns))
    assert (decoder.damaged, decoder.missed) == (0, 0) and got

    samples = sensor.codes[:frames]
    expected = core.expected(build, samples)
    events = [(frame, payload) for frame, payload in expected.slip]
    mine = [(q.time, q.payload) for q in got if q.kind == p.SLIP]
    assert len(mine) > 1
    assert [payload for _, payload in mine] == [payload for _, payload in events][: len(mine)]
    assert len(mine) >= len(events) - 3  # the last ones may be under way
    per_frame = len(build.scan.scan.places()) if build.kind == "array" else 1
    first = starts[::per_frame]
    offsets = {first[frame] - time for (time, _), (frame, _) in zip(mine, events)}
    assert len(offsets) == 1, f"times are not those of the convert starts: {sorted(offsets)}"
    if build.kind != "channels":
        cops = [(q.time, q.payload) for q in got if q.kind == p.COP]
        assert [payload for _, payload in cops] == [payload for _, payload in expected.cop][: len(cops)]
        assert len(cops) >= frames - 4
        assert {first[n] - time for n, (time, _) in enumerate(cops)} == offsets
    if build.kind == "array":
        images = [q for q in got if q.kind == p.IMAGE]
        assert [list(q.fields["taxels"]) for q in images] == expected.images[: len(images)].tolist()
        assert len(images) >= frames - 4
        assert {first[n] - q.time for n, q in enumerate(images)} == offsets


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def an_events_first_bit_comes_within_20_clocks_of_its_sample(dut):
    """With nothing under way on the line."""
    name, build = case_of(dut)
    if name not in ("channels", "smallest"):
        return
    line, _, _ = await begin(dut, name, build)
    offered = []

    async def watch():
        while True:
            await RisingEdge(dut.sample_valid)
            offered.append(round(get_sim_time("ns") / PERIOD_NS))

    cocotb.start_soon(watch())
    await bench.clocks(dut, FRAMES[name] * build.period_clocks)
    falls = [round(time / PERIOD_NS) for time, level in line.edges if level == 0]
    quiet = 30 * build.clk_khz * 1000 / build.link["baud"]
    first = [now for before, now in pairwise([-1000, *falls]) if now - before > quiet]
    waits = {now - max(at for at in offered if at < now) for now in first}
    dut._log.info(f"clocks from a sample to the line's first bit: {sorted(waits)}")
    assert len(first) > 3 and max(waits) <= 20


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def commands_are_answered_while_it_measures(dut):
    name, build = case_of(dut)
    if not build.link["registers"]:
        return
    line, *_ = await begin(dut, name, build)
    asked = [(bridge.READ, 1, 0x000, 0), (bridge.READ, 2, 0x010, 0), (bridge.WRITE, 3, 0x014, 0xCAFE1234)]
    asked += [(bridge.READ, 4, 0x014, 0), (bridge.READ, 5, 0xFFC, 0)]
    for ask in asked:
        for level in levels(bridge.command(*ask), build.clk_khz * 1000, build.link["baud"]):
            dut.rx_i.value = level
            await RisingEdge(dut.clk_i)
        await bench.clocks(dut, 8 * 700)
    bit_ns = 1e9 / build.link["baud"]
    got = Decoder().next(line.bytes(bit_ns))
    answers = [tuple(q.fields.values()) for q in got if q.kind == p.ANSWER]
    assert [answer[:3] for answer in answers] == [
        (1, bridge.DONE, 0x000),
        (2, bridge.DONE, 0x010),
        (3, bridge.DONE, 0x014),
        (4, bridge.DONE, 0x014),
        (5, bridge.BUS_ERROR, 0xFFC),
    ]
    assert [answers[place][3] for place in (0, 1, 3)] == [0x4D534E52, build.clk_khz, 0xCAFE1234]


@pytest.mark.parametrize("name", CASES)
def test_core(name):
    bench.run("core", "core", verilog(configuration(name).parameters))
