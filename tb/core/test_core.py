"""msn_core from a converter's pins to the levels of the serial line, built from configurations as a user
writes them: an array, single channels, four electrodes, the smallest sensor. The packets are the model's for
the codes that the part converted, each with its convert start; commands are answered in between. The four
electrodes have no line: packets are bytes, the register bus is open, and a host that does not take packets
loses frames, not events. Faults of taxels, what each counter counts, every bit of every setting."""

import copy
import random
import re
from dataclasses import fields
from itertools import groupby, pairwise

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from cocotb.utils import get_sim_time

import bench
from core import core_by_hand, pins
from core.wires import OF_GLUE, SEEN, Ends, consumers
from meissner.builds import config, toolchain
from meissner.builds.build import Config, verilog
from meissner.twins import core
from meissner.twins.link import bridge
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.register_map import GROUPS
from meissner.twins.link.registers import Registers
from meissner.twins.link.registers import settings as all_settings
from meissner.twins.link.uart import levels
from parts.ad7606 import Ad7606
from parts.hv507 import Hv507
from parts.mcp3208 import Mcp3208
from parts.timing import changed

PERIOD_NS = 250
SLIP_V = {
    **{"window": 16, "hop": 16, "threshold_p2p_v": 0.3, "gross_threshold_p2p_v": 1.0, "contact_level_v": 1.0},
    **{"release_level_v": 0.5, "contact_rises": True, "hold_ms": 1.0, "refractory_ms": 1.0, "blank_ms": 1.0},
}
SLIP_N = {
    **{"window": 16, "hop": 16, "threshold_p2p_n": 0.3, "gross_threshold_p2p_n": 1.0, "contact_level_n": 0.8},
    **{"release_level_n": 0.4, "hold_ms": 0.0, "refractory_ms": 0.0, "blank_ms": 0.0},
}
ROWS, COLUMNS = 3, 7  # of the array; a conversion takes two columns
TAXELS = ROWS * COLUMNS
CASES = {
    "array": {
        "sensor": {"kind": "array", "rows": ROWS, "columns": COLUMNS},
        "adc": {"part": "MCP3208", "channels": 2, "volts": 5.0, "rate_hz": 500.5, "settle_us": 2.0},
        "array": {"health": True, "newtons_per_count": 1e-3 / 16},
        "health": {"edges": True},
        "slip": SLIP_N,
        "display": {"rows": 2, "columns": 3, "amplitude_bits": 3},
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
        "cop_slip": {"lag_ms": 2.0, "drop": 0.3, "move": 0.0, "min_load_n": 0.2, "hold_ms": 1.0},
        "link": {"baud": 1_000_000, "statistics": False},
    },
    "hand": {
        "sensor": {"kind": "channels", "channels": 2},
        "adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 4000.0},
        "slip": SLIP_V,
        "grip": {},
        "shear_speed": {},
        "forest": {"window": 2, "nodes": 64},
        "link": {"baud": 1_000_000, "statistics": False},
    },
    "smallest": {
        "sensor": {"kind": "channels", "channels": 1},
        "adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 5000.0},
        "slip": SLIP_V | {"serial": True},
        "link": {"baud": 500_000, "registers": False, "statistics": False, "slip_only": True},
    },
}
FRAMES = {"array": 24, "channels": 120, "electrodes": 90, "hand": 120, "smallest": 120}
COMMON = {"about": "of a test", "clock": {"mhz": 4.0}}
# Parameters that no configuration sets: a short queue, and one core without a line.
EXTRA = {"array": {"SlipDepth": 2}, "electrodes": {"SlipDepth": 2, "Uart": 0}, "hand": {"Uart": 0}}
# Short names and paths of the blocks inside.
INSIDE = {
    "registers": "u_registers",
    "link": "u_link",
    "chain": "u_slip",
    "flags": "u_slip.u_flags",
    "slip": "u_slip.gen_slip.u_slip_path",
    "moving": "u_slip.gen_slip.u_moving",
    "skid": "u_slip.gen_slip.gen_skid.u_skid",
    "array": "gen_array.u_sensor",
    "owed": "gen_cop4.u_sensor.u_owed",
    "electrodes": "gen_cop4.u_sensor.u_electrodes",
    "cop4": "gen_cop4.u_sensor.u_cop4",
    "cop_slip": "gen_cop4.u_sensor.gen_cop_slip.u_cop_slip",
    "changes": "u_link.gen_changes.u_changes",
    "sender": "u_link.gen_slip_only.u_link.u_packet_slip",
    "cobs": "u_link.gen_slip_only.u_link.u_cobs",
    "uart": "u_link.gen_slip_only.u_link.u_uart_tx",
}
PINS = {"channels": "gen_channels.u_sensor", "electrodes": "gen_cop4.u_sensor.u_channels"}
PINS["hand"] = PINS["smallest"] = PINS["channels"]
AT_PINS = {
    "acquire": "u_acquire",
    "gate": "gen_gate.u_frame_gate",
    "time": "gen_gate.gen_time_stamp.u_time_stamp",
}
PARTS = {  # parts whose wires a core has
    "array": ("array", "slip", "events", "flags", "link"),
    "channels": ("acquire", "gate", "channels", "slip", "events", "flags", "link"),
    "electrodes": ("acquire", "gate", "electrodes", "flags", "link"),
    "hand": ("acquire", "gate", "slip", "events", "flags", "link"),
    "smallest": ("acquire", "slip", "sender", "flags"),
}
IS = {  # rows, columns, groups of registers
    "array": (ROWS, COLUMNS, "slip scan health tare calibrate cop link display"),
    "channels": (1, 3, "adc slip link"),
    "electrodes": (1, 4, "adc cop4 cop_slip link"),
    "hand": (1, 2, "adc slip link grip shear_speed forest"),
}
ADDRESS = {
    f"{group.name}.{register.name}": register.address for group in GROUPS for register in group.registers
}


def inside(name):
    """Paths of the blocks of a case: {short name: path}."""
    return INSIDE | {block: f"{PINS[name]}.{path}" for block, path in AT_PINS.items() if name in PINS}


# Settings of several bits that a host cannot write: with all bits from reset on one that is cut is missing.
FIXED = {f"{g.name}.{r.name}": f.most for g, r, f in all_settings() if not r.writable and f.width > 1}


class Strong(Config):
    """The greatest gain from reset on, 16 force codes per sample code; and all bits of what is fixed."""

    settings = property(lambda self: super().settings | {"calibrate.preset": 65535} | FIXED)


def configuration(name):
    build = config.read(name, copy.deepcopy(COMMON | CASES[name]))
    if name == "array":
        build = Strong(**{field.name: getattr(build, field.name) for field in fields(build)})
    return build


def parameters_of(name):
    return configuration(name).parameters | EXTRA.get(name, {})


def case_of(dut):
    value = lambda name: dut.__getattr__(name).value.to_unsigned()
    for name in CASES:
        if all(value(key) == given for key, given in parameters_of(name).items()):
            return name, configuration(name)
    raise AssertionError("built of none of the configurations")


def whole(decoder, data):
    """The packets of ``data``: none damaged, none missing."""
    found = decoder.next(data)
    assert decoder.damaged == 0 and bench.unbroken(found)
    return found


class Bus:
    """A host without a line: packets byte by byte, accesses on the open bus."""

    def __init__(self, dut, build):
        self.dut, self.data, self.frames = dut, bytearray(), bytearray()
        dut.out_ready_i.value = 1
        cocotb.start_soon(self._watch())

    async def _watch(self):
        """A byte must stay until it is taken; none is offered in the next clock."""
        while True:
            await RisingEdge(self.dut.out_valid_o)
            await ReadOnly()
            self.data.append(bench.read(self.dut.out_data_o))
            if self.dut.out_last_o.value == 1:
                self.frames += encode(bytes(self.data))
                self.data.clear()

    def forget(self):
        self.data.clear()

    def packets(self):
        return whole(Decoder(), bytes(self.frames))

    async def ask(self, asked, strobe=15, **_):
        """Perform accesses one after the other; (tag, status, address, data) of each."""
        answers = []
        for operation, tag, address, data in asked:
            found, error = await pins.access(self.dut, operation, address, data, strobe)
            answers.append((tag, bridge.BUS_ERROR if error else bridge.DONE, address, found))
        return answers


class Line:
    """A host on the serial line: it keeps the edges of tx_o."""

    def __init__(self, dut, build):
        self.dut, self.edges = dut, []
        self.clk_hz, self.baud = 1000 * build.clk_khz, build.link.baud
        cocotb.start_soon(self._watch())

    async def _watch(self):
        while True:
            await changed(self.dut.tx_o)
            self.edges.append((get_sim_time("ns"), bench.read(self.dut.tx_o)))

    def forget(self):
        self.edges.clear()

    def packets(self):
        return whole(Decoder(), self.bytes())

    async def send(self, data):
        await Timer(PERIOD_NS // 2, "ns")
        for level, run in groupby(levels(data, self.clk_hz, self.baud)):
            self.dut.rx_i.value = level
            await Timer(PERIOD_NS * len(list(run)), "ns")

    async def ask(self, asked, rest=500):
        """Send commands with ``rest`` clocks after each; (tag, status, address, data) of their answers."""
        for ask in asked:
            await self.send(bridge.command(*ask))
            await Timer(PERIOD_NS * rest, "ns")
        await bench.clocks(self.dut, 3000)
        return [tuple(q.fields.values()) for q in self.packets() if q.kind == p.ANSWER][-len(asked) :]

    def bytes(self):
        """8 data bits, no parity, 1 stop bit, sampled in the middle of each bit; an unfinished byte is left
        out."""
        starts, busy, bit_ns = [], 0, 1e9 / self.baud
        last = get_sim_time("ns") - 9.5 * bit_ns
        for time, level in self.edges:
            if level == 0 and busy <= time <= last:
                starts.append(time)
                busy = time + 9.5 * bit_ns
        if not starts:
            return b""
        times, levels = (np.array(column) for column in zip(*self.edges))
        middles = np.array(starts)[:, None] + bit_ns * (np.arange(1, 9) + 0.5)
        places = np.searchsorted(times, middles, side="right") - 1
        return (levels[places] << np.arange(8)).sum(axis=1).astype(np.uint8).tobytes()


class Sensor:
    """Codes in the order of conversion, kept by frame; ``starts``: convert starts, in clocks."""

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

    @property
    def per_frame(self):
        if self.build.kind == "array":
            return len(self.build.scan.scan.places()) * self.build.scan.channels
        return 8 if self.build.part.has_busy else self.build.channels

    def code(self, channel, _):
        frame, place = divmod(len(self.taken), self.per_frame)
        codes = self.codes[min(frame, len(self.codes) - 1)]
        if self.build.kind == "array":
            row = bench.read(self.dut.row_o).bit_length() - 1
            column = self.build.scan.scan.column(bench.read(self.dut.group_o), channel, 0)
            code = int(codes[row, column]) if column < codes.shape[1] else 0
        else:
            code = int(codes[place]) if place < len(codes) else 0
        self.taken.append(code)
        return code & (1 << self.build.part.data_bits) - 1


def pressed(build, newtons, places):
    """Codes of the four electrodes [frames, 4], with one place [row, column] pressed in each frame."""
    load = np.zeros((len(newtons), 9, 9))
    load[np.arange(len(newtons)), places[:, 0], places[:, 1]] = newtons
    solved = build.cop4.mesh.solve(load)
    return build.cop4.convert(np.stack([solved.E1, solved.E2, solved.E3, solved.E4], axis=1))


def codes_of(name, build, frames):
    """The codes that the sensor gives, [frames, ...]."""
    rng = np.random.default_rng(bench.SEED)
    if name == "array":
        i, j = np.indices((ROWS, COLUMNS))
        press = 1500 * np.exp(-((i - 0.6) ** 2 + (j - 3.2) ** 2) / 1.5)
        n = np.arange(frames)[:, None, None]
        shape = 100 + 40 * i + rng.integers(-2, 3, (frames, ROWS, COLUMNS))
        codes = shape + np.rint(press * (n >= 12) * (1 + 0.5 * ((n // 11) % 2) * (n % 2))).astype(np.int64)
        codes[20:26] = rng.choice([0, 4095], (6, ROWS, COLUMNS))
        codes[22] = 4095
        return codes
    if name == "electrodes":  # a press that slips, presses anywhere, then random codes of the full range
        newtons = 1 + 0.02 * np.arange(frames)
        newtons[30:] *= 0.5
        newtons[44:] *= 0.4
        places = np.full((frames, 2), (4, 2))
        newtons[60:], places[60:] = (
            10 ** rng.uniform(-0.3, 2, frames - 60),
            rng.integers(0, 9, (frames - 60, 2)),
        )
        codes = pressed(build, newtons, places)
        codes[frames - 6 :] = rng.integers(-32768, 32768, (6, 4))
        return codes
    steps = 400 * (rng.random((frames, build.channels)) < 0.05) + 900 * (
        rng.random((frames, build.channels)) < 0.01
    )
    codes = 1500 + rng.integers(-9, 10, steps.shape) + steps
    if name == "channels":  # pulled in all channels, and released for a while
        codes[40], codes[70:84] = 3600, 60
    return codes


async def begin(dut, name, build):
    idle = {"actuator_moving_i": 0, "in_valid_i": 0, "rx_i": 1, "bus_valid_i": 0, "out_ready_i": 1}
    host = (Line if dut.Uart.value.to_unsigned() else Bus)(dut, build)
    for port, value in (idle | {"adc_miso_i": 0, "adc_busy_i": 0, "rst_i": 1}).items():
        getattr(dut, port).value = value
    Clock(dut.clk_i, PERIOD_NS, unit="ns").start()
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    host.forget()  # edges and bytes of the previous test
    starts = []

    async def watch():
        while True:
            await RisingEdge(dut.convert)
            starts.append(round(get_sim_time("ns") / PERIOD_NS))

    sensor = Sensor(dut, build, codes_of(name, build, FRAMES[name] + 8))
    cocotb.start_soon(watch())
    return host, sensor, starts


async def begin_idle(dut):
    """(Name of the case, host) of a core whose converters are off and whose pipeline is empty."""
    name, build = case_of(dut)
    host, *_ = await begin(dut, name, build)
    await write(host, {"scan.enable" if name == "array" else "adc.enable": 0}, rest=8 * 700)
    await bench.clocks(dut, 8000)
    return name, host


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    """The time wraps around from its greatest value; both ends of every wire, with registers at ones, then
    reset."""
    name, _ = case_of(dut)
    ends, draw = Ends(dut, inside(name), PARTS[name]), random.Random(bench.SEED)
    inputs = [port for port in dut if port._name.endswith("_i") and port._name not in ("clk_i", "rst_i")]
    for port in (*inputs, dut.rst_i):
        port.value = 0
    await Timer(1, "ns")
    ends.check()
    time = bench.read(dut.now)
    assert bench.ONES.lstrip("+") not in cocotb.plusargs or time == 2**48 - 1
    Clock(dut.clk_i, PERIOD_NS, unit="ns").start()
    for clock in range(120):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        time = 0 if 40 <= clock < 44 else (time + 1) % 2**48
        assert bench.read(dut.now) == time
        ends.check()
        await FallingEdge(dut.clk_i)
        dut.rst_i.value = int(39 <= clock < 43)
        for port in inputs:
            port.value = draw.getrandbits(len(port))
    for start in bench.carries(dut.now) if bench.whole(dut) else ():
        dut.u_link.now_o.value = start
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        assert bench.read(dut.now) == (start + 1) % 2**48
        await FallingEdge(dut.clk_i)
    await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    flags = ("slip_o", "gross_o", "touched_o", "pressed_o")
    await bench.inputs_in_reset(dut, *flags, "out_valid_o", "row_o", "adc_convst_o")
    assert dut.tx_o.value == 1


def watch_wires(dut, name, *strobes):
    """Check that both ends of every wire agree when one of ``strobes`` that this core has rises.

    Also clock by clock for a while when an event comes and when it stalls, with other beats waiting.
    """
    ends = Ends(dut, inside(name), PARTS[name])

    async def watch(edge, times, span):
        for _ in range(times):
            await edge
            for clock in range(span):
                if clock:
                    await RisingEdge(dut.clk_i)
                await ReadOnly()
                ends.check()

    for strobe in strobes:
        if ends.knows(strobe):
            cocotb.start_soon(watch(RisingEdge(ends.handle(strobe)), times=100, span=1))
    if ends.knows("link.decision_ready_o"):
        cocotb.start_soon(watch(RisingEdge(ends.handle("link.decision_valid_i")), times=20, span=30))
        for ready in ("link.decision_ready_o", "slip.in_ready_o"):
            if ends.knows(ready):
                cocotb.start_soon(watch(FallingEdge(ends.handle(ready)), times=10, span=30))


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def packets_are_the_models_of_the_codes_at_the_pins(dut):
    name, build = case_of(dut)
    host, sensor, starts = await begin(dut, name, build)
    watch_wires(dut, name, "flags.in_valid_i", "slip.in_valid_i", "link.cop_valid_i")
    frames = FRAMES[name]
    await bench.clocks(dut, frames * build.period_clocks)
    got = host.packets()

    samples = sensor.codes[:frames]
    expected = core.expected(build, samples)
    # More taxels change in one detail than the short queue holds, so only the starts are those of the model.
    kinds = (p.SLIP,) if name == "array" else (p.SLIP, p.CHANGE)
    host_has = dict.fromkeys(range(TAXELS), 0) | {core.OF_LOAD: 0}
    for q in got:
        if q.kind == p.CHANGE:
            assert q.fields["told"] == host_has[q.fields["channel"]] != q.fields["state"]
        if q.kind in (p.SLIP, p.CHANGE):
            host_has[q.fields["channel"]] = q.fields["state"]
    events = [(frame, (kind, payload)) for frame, kind, payload in expected.changes if kind in kinds]
    mine = [(q.time, (q.kind, q.payload)) for q in got if q.kind in kinds]
    assert len(mine) > 1 and len(expected.slip) > 1
    assert [payload for _, payload in mine] == [payload for _, payload in events][: len(mine)]
    assert len(mine) >= len(events) - 3  # the last ones may still be on their way
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


@bench.applies(lambda dut: case_of(dut)[0] in ("channels", "smallest"))
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def an_events_first_bit_comes_within_20_clocks_of_its_sample(dut):
    """If the line is idle."""
    name, build = case_of(dut)
    line, _, _ = await begin(dut, name, build)
    offered = []

    async def watch():
        while True:
            await RisingEdge(dut.sample_valid)
            offered.append(round(get_sim_time("ns") / PERIOD_NS))

    cocotb.start_soon(watch())
    await bench.clocks(dut, FRAMES[name] * build.period_clocks)
    falls = [round(time / PERIOD_NS) for time, level in line.edges if level == 0]
    quiet = 30 * build.clk_khz * 1000 / build.link.baud
    first = [now for before, now in pairwise([-1000, *falls]) if now - before > quiet]
    waits = {now - max(at for at in offered if at < now) for now in first}
    dut._log.info(f"clocks from a sample to the line's first bit: {sorted(waits)}")
    assert len(first) > 3 and max(waits) == {"channels": 10, "smallest": 19}[name]  # the README's


@bench.applies(lambda dut: case_of(dut)[1].link.registers)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def commands_are_answered_while_it_measures(dut):
    name, build = case_of(dut)
    host, *_ = await begin(dut, name, build)
    asked = [(bridge.READ, 1, 0x000, 0), (bridge.READ, 2, 0x010, 0), (bridge.WRITE, 3, 0x014, 0xCAFE1234)]
    asked += [(bridge.READ, 4, 0x014, 0), (bridge.READ, 5, 0xFFC, 0)]
    asked += [(bridge.READ, 6, 0x008, 0), (bridge.READ, 7, 0x00C, 0)]
    answers = await host.ask(asked, rest=8 * 700)
    assert [answer[:3] for answer in answers] == [
        (1, bridge.DONE, 0x000),
        (2, bridge.DONE, 0x010),
        (3, bridge.DONE, 0x014),
        (4, bridge.DONE, 0x014),
        (5, bridge.BUS_ERROR, 0xFFC),
        (6, bridge.DONE, 0x008),
        (7, bridge.DONE, 0x00C),
    ]
    assert [answers[place][3] for place in (0, 1, 3)] == [0x4D534E52, build.clk_khz, 0xCAFE1234]
    rows, columns, groups = IS[name]
    assert answers[6][3] == columns << 16 | rows
    assert answers[5][3] == sum(1 << n for n, group in enumerate(GROUPS[1:]) if group.name in groups.split())


async def read(host, *names, **how):
    """Values of registers, given as "group.register"."""
    asked = [(bridge.READ, tag, ADDRESS[name], 0) for tag, name in enumerate(names)]
    answers = await host.ask(asked, **how)
    assert [answer[:3] for answer in answers] == [(tag, bridge.DONE, at) for _, tag, at, _ in asked]
    return [answer[3] for answer in answers]


async def write(host, values, **how):
    asked = [(bridge.WRITE, tag, ADDRESS[name], value) for tag, (name, value) in enumerate(values.items())]
    answers = await host.ask(asked, **how)
    assert [answer[:3] for answer in answers] == [(tag, bridge.DONE, at) for _, tag, at, _ in asked]


# Bits that these builds have for settings held to them: a detail's 17 and the level's, a load's 16 and those
# that number the taxels.
HELD = {
    "array": {"detail": 18, "timer": 16, "load": 21, "offset": 17},
    "electrodes": {"detail": 18, "timer": 16, "load": 18, "offset": 17},
    "hand": {"detail": 18, "timer": 16, "load": 17, "offset": 17},
}


@bench.applies(lambda dut: case_of(dut)[0] in HELD)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def every_bit_of_every_setting_is_kept(dut):
    """Each setting reads back as written and arrives, as its reset value did, with all its bits at every
    block that uses it. The enables are written first, which stops the conversions."""
    name, build = case_of(dut)
    host, *_ = await begin(dut, name, build)
    watch_wires(dut, name, "registers.pending_o")
    (features,) = await read(host, "core.features", rest=8 * 700)
    present = [group.name for place, group in enumerate(GROUPS[1:]) if features >> place & 1]
    assert present == IS[name][2].split()
    optional = [group.name for group in GROUPS if group.feature and group.name in present]
    twin = Registers(optional, build.parameters["Resets"], HELD[name])
    fields = {f"{g.name}.{r.name}.{f.name}": f for g, r, f in all_settings() if g.name in ("core", *present)}
    places = [place for place in consumers(dut) if place[3] in fields]
    used = {setting for *_, setting, at_block in places if at_block}
    assert used.isdisjoint(OF_GLUE) and used | set(OF_GLUE) >= set(fields), set(fields) - used - set(OF_GLUE)
    for port, _, bits, setting, _ in places:
        field = fields[setting]
        assert bits >= HELD[name].get(field.held_to, field.width), f"{port._path} cuts {setting}"

    def arrived():
        for port, low, bits, setting, _ in places:
            value, got = twin.setting(*setting.split(".")), bench.read(port) >> low & (1 << bits) - 1
            assert got == value & (1 << bits) - 1, f"{setting} = {value:x} is {got:x} at {port._path}"

    async def write_all(word_of, registers):
        asked, expected = [], []
        for tag, register in enumerate(registers):
            data, word = twin.access(False, register.address)[0], word_of(register)
            word = ~data & 0xFFFF_FFFF if word is None else word
            for operation in (bridge.WRITE, bridge.READ):
                asked.append((operation, tag & 255, register.address, word))
                data, error, _ = twin.access(operation == bridge.WRITE, register.address, word)
                expected.append((tag & 255, int(error), register.address, data))
        asked += [(bridge.READ, 0, address, 0) for address in (0x001, 0x002, 0x555, 0xAAA)]
        expected += [(0, bridge.BUS_ERROR, address, 0) for address in (0x001, 0x002, 0x555, 0xAAA)]
        assert await host.ask(asked[:4], rest=8 * 700) + await host.ask(asked[4:]) == expected

    async def commit():
        assert twin.pending
        await bench.clocks(dut, 200)  # a frame boundary comes even without frames
        twin.commit()
        arrived()

    arrived()
    registers = [r for g in GROUPS if g.name in ("core", *present) for r in g.registers]
    registers = [r for r in registers if any(field.kind == "setting" for field in r.fields)]
    registers.sort(key=lambda register: register.name not in ("enable", "images"))
    await write_all(lambda register: None, registers)  # every bit inverted
    # core.hold was written among them: what waits for a frame's start waits on, until the host releases it.
    assert not twin.pending
    twin.access(True, ADDRESS["core.hold"], 0)
    await write(host, {"core.hold": 0})
    await commit()
    # Most values were beyond the build's range and saturated. Now values within it, and not all bits alike.
    draw, wide = random.Random(bench.SEED), [r for r in registers if max(f.width for f in r.fields) > 1]
    words = {register.address: draw.getrandbits(32) for register in wide}
    for invert in (0, 0xFFFF_FFFF):

        def within(register, invert=invert):
            (held, *_) = {field.held_to for field in register.fields}
            bits = HELD[name].get(held, 32)
            word = (words[register.address] ^ invert) & (1 << bits) - 1
            return word | -(word >> bits - 1 << bits) & 0xFFFF_FFFF if register.fields[0].signed else word

        await write_all(within, wide)
        await commit()
    if name == "electrodes":
        for byte in range(4):
            ask = (bridge.WRITE, 0, ADDRESS["core.scratch"], 0x0101_0101 * (0xA5 + byte))
            await host.ask([ask], strobe=1 << byte)
        assert await read(host, "core.scratch") == [0xA8A7_A6A5]


def test_every_group_of_registers_is_in_a_core_whose_settings_are_followed():
    text = (toolchain.ROOT / "rtl/registers.rdl").read_text("utf-8")
    groups = set(re.findall(r"^ +\} (\w+) @ 0x", text, re.M))
    assert groups == {group.name for group in GROUPS} and len(groups) >= 13
    assert groups == {"core"} | {group for name in HELD for group in IS[name][2].split()}


@bench.applies(lambda dut: case_of(dut)[0] in ("array", "electrodes") and bench.whole(dut))
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def a_lost_result_is_given_up_after_511_clocks(dut):
    """docs/frames.md; with the converters off."""
    name, _ = await begin_idle(dut)
    owed = (dut.gen_array if name == "array" else dut.gen_cop4).u_sensor.u_owed
    await FallingEdge(dut.clk_i)
    owed.owed.value = 1
    busy = 0
    for _ in range(600):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        busy += bench.read(owed.busy_o)
    assert busy == 511


@bench.applies(lambda dut: case_of(dut)[0] == "electrodes", long=True)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def what_a_host_does_not_take_is_counted(dut):
    """Every conversion gives a CoP frame, or is counted as dropped, timed out or replaced."""
    name, build = case_of(dut)
    host, sensor, starts = await begin(dut, name, build)
    counters = [
        "adc.dropped",
        "adc.timeout",
        "link.cop_dropped",
        "adc.overrun",
        "adc.over_range",
        "adc.mistagged",
    ]
    codes = pressed(build, np.where(np.arange(80) // 4 % 2, 0.5, 2.0), np.full((80, 2), (4, 2)))
    codes[2] = 32767, -32768, 32767, -32768
    sensor.codes = codes
    await write(host, {"adc.period": 400})
    await bench.clocks(dut, 2200 + 12 * 400)
    assert await read(host, *counters) == [0, 0, 0, 0, 4, 0]
    dut.out_ready_i.value = 0
    await bench.clocks(dut, 50 * 400)
    dropped, *others, replaced = await read(host, *counters[:3])
    assert dropped > 3 and others == [0] and replaced > 3
    dut.out_ready_i.value = 1
    sensor.part.hold_busy(0)
    await bench.clocks(dut, 6000)
    sensor.part.hold_busy(None)
    await bench.clocks(dut, 6000)
    await write(host, {"adc.period": 100})
    await bench.clocks(dut, 4000)
    await write(host, {"adc.enable": 0})
    await bench.clocks(dut, 4000)
    dropped, timeout, replaced, overrun, over_range, mistagged = await read(host, *counters)
    assert timeout > 0 and overrun > 10 and (over_range, mistagged) == (4, 0)
    got = host.packets()
    cops = [q for q in got if q.kind == p.COP]
    assert len(starts) == len(cops) + dropped + timeout + replaced
    assert sum(q.kind in (p.SLIP, p.CHANGE) for q in got) > 5
    assert await read(host, "link.packets") == [len(got)]


@bench.applies(lambda dut: case_of(dut)[0] == "array")
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def faults_are_told_and_every_counter_counts_its_own(dut):
    """Frames as fast as the part allows, in stages; the scan is off between them."""
    name, build = case_of(dut)
    host, sensor, starts = await begin(dut, name, build)
    twin, given = core.array_of(build), []
    i, j = np.indices((ROWS, COLUMNS))
    even, quiet = (i + j) % 2 == 0, 100 + 40 * i
    done = lambda: len(sensor.taken) // sensor.per_frame

    async def stage(codes, frames=0, rest=500, **settings):
        """Scan ``codes``, repeating the last ones until the scan stops; return the codes converted."""
        before = done()
        sensor.codes = [codes[0]] * before + list(codes)
        await write(host, settings | {"scan.enable": 1})
        while done() < before + max(frames, len(codes)):
            await bench.clocks(dut, 500)
        await write(host, {"scan.enable": 0}, rest=rest)
        await bench.clocks(dut, 3000)
        taken = np.array(sensor.taken[before * sensor.per_frame :]).reshape(-1, ROWS, COLUMNS + 1)
        return taken[:, :, :COLUMNS]  # the last conversion of a row has a channel without a column

    def expect(samples):
        forces, _ = twin.forces(samples)
        given.extend(zip(forces, zip(*twin.cops(forces))))

    expect(await stage([quiet], 18, **{"scan.period": 0}))
    assert await read(host, "tare.tared", "tare.refused") == [1, 0] == [twin.tare.tared, twin.tare.refused]

    # Even taxels move, then odd ones: without the others and never with them; the limits make all count as
    # railed.
    moves = [quiet] * 4 + [quiet + 50 * even] * 4 + [quiet + 50] * 10
    limits = {"high": 0, "jump": 20, "still": 1, "rail": 1, "blink": 16}
    for key, value in limits.items():
        setattr(twin.health.limits, key, value)
    expect(await stage(moves, **{f"health.{key}": value for key, value in limits.items()}))
    faults = ("health.dead", "health.railed", "health.blinking")
    assert (
        await read(host, *faults)
        == [TAXELS] * 3
        == [twin.health.dead, twin.health.railed, twin.health.blinking]
    )
    twin.health.report()
    before = len(host.packets())
    # Slow enough that the CoP frames, which have priority, do not fill the line.
    expect(await stage([quiet], 12, **{"health.report": 1, "scan.period": 3300}))
    told = [tuple(q.fields.values()) for q in host.packets()[before:] if q.kind == p.HEALTH]
    assert sorted(told) == [(taxel, 7) for taxel in range(TAXELS)]

    limits = dict.fromkeys(limits, 0) | {"high": 65535}
    for key, value in limits.items():
        setattr(twin.health.limits, key, value)
    twin.health.clear()
    twin.tare.tare()
    settings = {f"health.{key}": value for key, value in limits.items()}
    settings |= {"health.clear": 1, "tare.average": 1, "scan.period": 0}
    settings |= {"calibrate.swap": 1, "link.images": 0}
    rng = np.random.default_rng(bench.SEED)
    gains = rng.integers(1, 65536, TAXELS)
    for word, (offset, gain) in enumerate(zip(rng.integers(-900, 900, TAXELS), gains)):
        twin.calibrate.table.write(word, offset, gain)
        entry = {"word": word, "offset": int(offset) & 0x1FFFF, "gain": int(gain), "write": 1}
        await write(host, {f"calibrate.{key}": value for key, value in entry.items()})
    await write(host, {"calibrate.word": 2, "calibrate.write": 0x100})  # a row's, which this build lacks
    twin.calibrate.swap()
    unseen = await stage([quiet + 900], 2, **settings)
    expect(unseen)
    assert await read(host, *faults, "tare.refused") == [0, 0, 0, 1]
    assert twin.tare.refused == 1

    twin.tare.load(True)
    swallowed = len(await stage([quiet], 2, **{"tare.load": 1, "link.images": 1}))
    assert await read(host, "tare.swallowed") == [swallowed]
    await write(host, {"tare.load": 0})

    # All slip at once: more events than the queue holds wait for the line, and the scan waits for them.
    assert dut.pressed_o.value == 1
    settings = {"slip.contact_level": 0, "slip.threshold": 0, "scan.period": 1, "cop.min_load": (1 << 21) - 1}
    watch_wires(dut, name)
    # The answer follows an event of each taxel.
    unchecked = rng.integers(200, 4000, (40, ROWS, COLUMNS))
    lost = len(await stage(unchecked, rest=1000 * TAXELS, **settings))
    assert dut.pressed_o.value == 0
    spoilt = bytearray(bridge.command(bridge.READ, 0, 0))
    spoilt[3] ^= 2
    await host.send(bytes(spoilt))
    await bench.clocks(dut, 3000)
    counters = ("scan.dropped", "link.cop_dropped", "link.image_dropped", "link.rejected", "scan.overrun")
    dropped, cop_dropped, image_dropped, rejected, overrun = await read(host, *counters)
    assert dropped > 0 and cop_dropped > 0 and image_dropped > 0 and rejected == 1 and overrun > 100
    assert await read(host, "scan.held", "scan.lost", "cop.damaged") == [0, 0, 0]
    got = host.packets()
    cops, images = ([q for q in got if q.kind == kind] for kind in (p.COP, p.IMAGE))
    for packets, replaced in ((cops, cop_dropped), (images, image_dropped + len(unseen))):
        assert len(packets) + replaced + dropped + swallowed == done() == len(given) + swallowed + lost
    first = starts[:: sensor.per_frame // build.scan.channels]
    offset = first[0] - min(q.time for q in cops)
    frame_of = {start - offset: frame for frame, start in enumerate(first)}
    for q in cops:
        if frame_of[q.time] < len(given):
            assert q.payload == p.cop_frame(*map(int, given[frame_of[q.time]][1]))
    for q in images:
        if frame_of[q.time] < len(given):
            assert list(q.fields["taxels"]) == given[frame_of[q.time]][0].ravel().tolist()

    host.edges.clear()
    sensor.part.report = lambda violation: None  # the reset may break off a transfer
    await bench.reset(dut)
    counters = ("scan.dropped", "link.rejected", "tare.refused", "tare.swallowed")
    assert await read(host, *counters, rest=8 * 700) == [0] * 4


@bench.applies(lambda dut: case_of(dut)[0] == "array" and bench.whole(dut))
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def what_cannot_be_trusted_turns_all_pins_off(dut):
    """At the drivers' outputs, in the clocks after the cause: a converter that does not answer, a taxel at
    the rail, no enable, a reset. The drivers' model refuses blanking with polarity low at
    any time."""
    name, build = case_of(dut)
    host, sensor, _ = await begin(dut, name, build)
    late = lambda violation: None if str(violation)[:2] == "t_" else Hv507.fail(None, violation)
    lines = [getattr(dut, f"hv_{pin}_o") for pin in ("data", "clk", "le", "bl", "pol")]
    driver = Hv507(*lines, 1, report=late)
    array, wait = dut.gen_array.u_sensor, lambda clocks: Timer(PERIOD_NS * clocks, "ns")
    rests = 100 + 40 * np.indices((ROWS, COLUMNS))[0]
    sensor.codes = [rests] * 18 + [rests + 900]
    settings = {"link.images": 0, "scan.period": 2500, "health.still": 0, "health.blink": 0, "health.rail": 1}
    await write(host, settings | {"display.increment": (1 << 32) - 1}, rest=1500)

    async def drives():
        """Wait until all pins are on."""
        while sum(driver.outputs) != 6:
            await FallingEdge(dut.hv_le_o)
            await RisingEdge(dut.clk_i)
        assert bench.high(dut.hv_bl_o)

    async def off(cause, clocks=4):
        await wait(clocks)
        assert not any(driver.outputs) and not bench.high(dut.hv_bl_o), cause

    await wait(18 * 2500)  # frames, to tare
    await drives()
    await FallingEdge(dut.clk_i)
    lost = array.gen_adc.u_scan_adc.u_scan.lost
    lost.value = bench.read(lost) + 1
    await off("no answer")
    assert any(driver.latches)  # it is the blanking that turns them off
    await drives()
    railed = rests + 900
    railed[1, 2] = 4095
    sensor.codes.append(railed)
    while not bench.read(array.u_forces.gen_health.u_health.railed_count):
        await wait(200)
    await off("rail", 250)
    sensor.codes.append(rests + 900)
    await write(host, {"health.clear": 1}, rest=1500)
    await drives()
    await write(host, {"display.enable": 0}, rest=1500)
    await off("enable", 1)
    await write(host, {"display.enable": 1}, rest=1500)
    await drives()
    sensor.part.report = lambda violation: None  # the reset may break off a transfer
    await RisingEdge(dut.clk_i)
    dut.rst_i.value = 1
    await off("reset", 2)
    dut.rst_i.value = 0
    await off("no frame yet", 300)


@bench.applies(lambda dut: case_of(dut)[0] in ("array", "channels", "hand") and bench.whole(dut))
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def every_bit_of_a_counter_reaches_its_register(dut):
    """By values put where they are counted, also for counters whose faults these parts do not have."""
    name, host = await begin_idle(dut)
    path = dut.u_slip.gen_slip.u_slip_path.gen_parallel
    sources = {
        "slip.damaged": path.u_frame_filter.damaged_o,
        "slip.blanked": path.u_slip.blanked_o,
    }
    if name != "hand":
        sources["link.rejected"] = dut.u_link.gen_registers.u_bridge.rejected_o
    if name == "array":
        array, packet = dut.gen_array.u_sensor, dut.u_link.gen_packets.u_packet
        scan = array.gen_adc.u_scan_adc.u_scan
        sources |= {"scan.dropped": scan.u_buffer.dropped_o, "scan.overrun": scan.u_plan.overrun_o}
        sources |= {"scan.held": scan.u_plan.held_o, "scan.lost": scan.lost}
        kinds = ("tared", "refused", "swallowed")
        sources |= {
            f"tare.{kind}": getattr(array.u_forces.gen_tare.u_tare, f"{kind}_count") for kind in kinds
        }
        sources["cop.damaged"] = array.u_forces.u_cop.u_accumulate.damaged_o
        sources["link.cop_dropped"] = packet.cop_dropped_o
        sources["link.image_dropped"] = packet.gen_image.u_chunks.u_store.dropped_o
    else:
        spi = dut.gen_channels.u_sensor.u_acquire.gen_adc.u_adc_spi
        kinds = ("dropped", "overrun", "timeout", "mistagged", "over_range")
        sources |= {f"adc.{kind}": getattr(spi, f"{kind}_o") for kind in kinds}
    if name == "hand":
        reflex, shear = dut.u_actuate.gen_grip, dut.u_shear_speeds.gen_shear_speed
        names = "written label best decisions changes missed absent late broken"
        sources |= {f"forest.{name}": getattr(dut.u_classify.gen_forest, name) for name in names.split()}
        sources |= {"grip.commands": reflex.commands, "grip.tightenings": reflex.tightenings}
        sources |= {
            f"grip.{kind}": getattr(reflex.u_grip, f"out_{kind}_o") for kind in ("command", "increment")
        }
        sources |= {f"grip.{kind}": getattr(reflex.u_grip, f"{kind}_o") for kind in ("fault", "faulty")}
    for turn in (0, 1, 0):
        values = pins.put(sources, turn)
        assert await read(host, *sources) == list(values.values())
    for turn in (0, -1) if name == "hand" else ():
        draw, words = random.Random(bench.SEED), {}
        for kind in ("last", "pairs", "windows"):
            bits = len(getattr(shear, kind))
            words[kind] = (draw.getrandbits(bits) ^ turn) & (1 << bits) - 1
            getattr(shear, kind).value = words[kind]
        for channel in range(8):
            await write(host, {"shear_speed.select": channel})
            last = words["last"] >> 32 * (7 - channel) & 0xFFFF_FFFF  # speed and flags
            pair = words["pairs"] >> 53 * channel & (1 << 53) - 1  # Vi and rise
            expected = [(last & 0xFF) << 24 | last >> 8, pair >> 27, pair & (1 << 27) - 1]
            expected.append(words["windows"] >> 32 * channel & 0xFFFF_FFFF)
            names = (f"channel{channel}", "vi", "rise", "windows")
            assert await read(host, *(f"shear_speed.{one}" for one in names)) == expected


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
    "mutants": {"sets": [0], "limit": 100, "unsolved": True},
    "faults": {
        "program": {"Uart": 0},
        # Its image is sent while the next frame is scanned.
        "settle": 2,
        "driver": {
            "free": 100000,
            # Counters up to a scan's next row and frame, and the settle time in force until it.
            "late": "since_q count_q rest_q settle_q",
            "part": 1,
            "packets": 1,
            "writes": 25,
        },
        "kept_inside": {"u_calibrate": "calibrate", "u_tare": "tare", "u_health": "health"},
        "keeps_settings": True,
        # Each write at 25 clocks of a frame (docs/registers.md).
        "writes": [
            {
                "before": "504:0,508:0,50c:900,510:1 504:1,508:3,50c:a23,510:1 "
                "504:2,508:6,50c:b46,510:1 504:3,508:9,50c:c69,510:1 "
                "504:4,508:c,50c:d8c,510:1 504:5,508:f,50c:eaf,510:1 "
                "504:6,508:12,50c:fd2,510:1 504:7,508:15,50c:10f5,510:1 "
                "504:8,508:18,50c:1218,510:1",
                "write": "514:1",  # calibration: the other table
            },
            {"write": "600:7fffffff"},  # least load
            {"write": "30c:1", "same": 1},  # scan: even rows first, the same frame
            {"write": "304:40", "same": 1},  # scan: longer to settle
            {"before": "900:0", "write": "900:1", "same": 1},  # images
            {"write": "14:12345678", "same": 1},  # without effect
        ],
    },
}


@pytest.mark.parametrize("name", CASES)
def test_core(name):
    bench.run("core", "core", verilog(parameters_of(name)), inside=SEEN)


@pytest.mark.parametrize("name", core_by_hand.BUILDS)
def test_core_of_a_stream(name):
    bench.run("core", "core", core_by_hand.BUILDS[name], module="core_by_hand", inside=SEEN)


def test_what_a_configuration_leaves_out_the_model_leaves_out():
    """Without calibration and tare, forces are the codes; without slip, the frames are the same and there are
    no events."""
    plain = copy.deepcopy(COMMON | CASES["array"])
    plain["array"] = {"tare": False, "newtons_per_count": 1e-3}
    del plain["slip"], plain["health"]
    codes = codes_of("array", configuration("array"), 40)[:6]
    found = core.expected(config.read("plain", plain), codes)
    assert found.images.tolist() == codes.reshape(6, TAXELS).tolist() and not found.slip
    loads = [int.from_bytes(payload[6:11], "little") for _, payload in found.cop]
    assert loads == codes.sum(axis=(1, 2)).tolist()

    without = copy.deepcopy(COMMON | CASES["electrodes"])
    del without["cop_slip"]
    build = configuration("electrodes")
    codes = codes_of("electrodes", build, FRAMES["electrodes"])
    whole, found = core.expected(build, codes), core.expected(config.read("without", without), codes)
    assert found.cop == whole.cop and whole.slip and not found.slip
