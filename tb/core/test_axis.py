"""msn_axis against its model, driven and read by an independent AXI master (cocotbext-axi): an array with all
its stages on one lane and on several, single channels, four electrodes; packets in order, none lost, with
stalls on both streams; registers read and written while frames pass, with settings in effect from one frame
on; errors; a calibration loaded during operation."""

import itertools
import logging
import random
import re
import zlib

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from cocotb.utils import get_sim_time
from cocotbext.axi import (
    AxiLiteBus,
    AxiLiteMaster,
    AxiResp,
    AxiStreamBus,
    AxiStreamFrame,
    AxiStreamSink,
    AxiStreamSource,
)

import bench
from core import pins
from forest.trees import forest
from meissner.builds.toolchain import ROOT
from meissner.forest import words
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Mesh
from meissner.twins import core
from meissner.twins.actuate.display import words as words_of
from meissner.twins.actuate.render import Render, RenderSettings
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.forest.classify import Classify
from meissner.twins.frontend.health import Limits
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.registers import RESET_BITS, reset_word
from meissner.twins.sensor.sensors import from_reset
from meissner.twins.slip.config import SlipConfig
from parts.hv507 import Hv507

GAIN = 5000
SLIP = SlipConfig(
    *(16, 16, 1, 300, 900, 1500, 1000, True),  # window, hop, level, thresholds, levels
    *(2, 1, 1),  # hold, refractory, blank
)
LIMITS = Limits()
CONTACT, STEP, TARE_LOG2 = 50, 3, 1
ELECTRODES = Cop4Config(Mesh(9, 9, 47.0, 1e4, 5.0, 1e4), Adc(16, -10.0, 10.0), 1.0)
COP_SLIP = CopSlipRegisters(drop=77, move=0, min_load=200, hold=3, refractory=2)
LAG = 4


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


class Axi:
    """The three interfaces, with stalls on the streams."""

    def __init__(self, dut, rate=0.0):
        logging.getLogger("cocotb").setLevel(logging.WARNING)
        self.dut, self.decoder, self.got = dut, Decoder(), []
        self.lite = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_i)
        self.source = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis"), dut.clk_i, dut.rst_i)
        self.sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk_i, dut.rst_i)
        if rate:
            for stream, pauses in zip((self.source, self.sink), bench.gaps_and_stalls(rate)):
                stream.set_pause_generator(iter(pauses, None))

    async def write(self, address, value):
        return (await self.lite.write(address, (value & 0xFFFFFFFF).to_bytes(4, "little"))).resp

    async def read(self, address):
        got = await self.lite.read(address, 4)
        return int.from_bytes(got.data, "little"), got.resp

    async def send(self, beats):
        """Send a frame: the lanes' samples of each beat."""
        words = [int(value) & 0xFFFFFFFF for beat in beats for value in beat]
        data = b"".join(word.to_bytes(4, "little") for word in words)
        await self.source.send(AxiStreamFrame(data))

    async def packets(self, quiet=3000):
        """All packets, until none came for ``quiet`` clocks and the input is empty."""
        found, waited = [], 0
        while waited < quiet:
            await bench.clocks(self.dut, 50)
            waited = 0 if not self.source.idle() else waited + 50
            while not self.sink.empty():
                data = bytes(self.sink.recv_nowait().tdata)
                assert zlib.crc32(data[:-4]) == int.from_bytes(data[-4:], "little")
                found += self.decoder.next(encode(data))
                waited = 0
        self.got += found
        assert self.decoder.damaged == 0 and bench.unbroken(self.got)
        return found


def of_kind(packets, kind):
    return [q.payload for q in packets if q.kind == kind]


def images(packets):
    found = []
    for q in packets:
        if q.kind == p.IMAGE:
            if q.fields["first"] == 0:
                found.append([])
            found[-1].extend(q.fields["taxels"])
    return found


class Size:
    """The sizes that a scan would give to the model."""

    def __init__(self, dut):
        self.rows, self.columns, self.lanes = (number(dut, name) for name in ("Rows", "Columns", "Lanes"))
        self.sample_bits = 17

    def beats_of(self, frame):
        """The lanes' samples of each beat of ``frame``; lanes past the last column must not count."""
        beside = np.full((self.rows, -self.columns % self.lanes), -9999)
        return np.hstack([frame, beside]).reshape(-1, self.lanes)


def array_twin(dut):
    size = Size(dut)
    tare = {"tare_log2": TARE_LOG2, "contact": CONTACT, "step": STEP} if number(dut, "Tare") else None
    limits = LIMITS if number(dut, "Health") else None
    kinds = {"row_column": bool(number(dut, "RowColumn")), "gain_shift": number(dut, "GainShift")}
    twin = from_reset(size, GAIN, limits, tare, **kinds)
    return twin, size


def pressing(rng, frames, size):
    """Samples [frames, rows, columns]: idle, then a contact that moves and sometimes jumps."""
    i, j = np.indices((size.rows, size.columns))
    zero = rng.integers(100, 400, (size.rows, size.columns))
    found = []
    for n in range(frames):
        level = 0 if n < 6 else 3000 + 700 * ((n // 9) % 2) * (n % 2)
        at = size.rows * (0.3 + 0.002 * n), size.columns * 0.6
        press = level * np.exp(-((i - at[0]) ** 2 + (j - at[1]) ** 2) / 3)
        found.append(zero + np.rint(press).astype(np.int64) + rng.integers(-3, 4, zero.shape))
    return np.array(found)


IDLE = {"s_axis_tvalid": 0, "m_axis_tready": 0, "actuator_moving_i": 0}
IDLE |= {f"s_axil_{name}": 0 for name in ("awvalid", "wvalid", "bready", "arvalid", "rready")}


async def begin(dut, rate=0.0):
    axi = Axi(dut, rate)
    await bench.start(dut, **IDLE)
    return axi


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    inputs = ["s_axis_tvalid", "s_axis_tdata", "s_axis_tlast", "m_axis_tready"]
    inputs += [f"s_axil_{channel}{port}" for channel in ("aw", "ar") for port in ("valid", "addr", "prot")]
    inputs += [f"s_axil_{port}" for port in ("wvalid", "wdata", "wstrb", "bready", "rready")]
    resting = ["m_axis_tvalid", "s_axil_bvalid", "s_axil_rvalid", "slip_o", "gross_o", "touched_o"]
    await bench.inputs_in_reset(dut, *resting, "pressed_o", also=inputs)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def ready_waits_for_no_valid_of_its_clock(dut):
    """In clocks of a stalled and a running stream, and in reset: tready stays, whatever the inputs become; in
    reset it is low."""
    names = ("s_axis_tvalid", "s_axis_tlast", "m_axis_tready", "s_axil_arvalid")
    await bench.start(dut, **IDLE)
    draw = random.Random(bench.SEED)
    given, seen = dict.fromkeys(names, 0), set()
    for _ in range(1500):
        reset = int(draw.random() < 0.03)
        dut.rst_i.value = reset
        if not given["s_axis_tvalid"]:
            given |= {"s_axis_tvalid": int(draw.random() < 0.6), "s_axis_tlast": int(draw.random() < 0.2)}
        given["m_axis_tready"] = draw.randrange(2)
        readies = set()
        await FallingEdge(dut.clk_i)
        for values in [*itertools.product((0, 1), repeat=len(names)), tuple(given.values())]:
            for name, value in zip(names, values):
                getattr(dut, name).value = value
            await Timer(1, "ps")
            readies.add(bench.read(dut.s_axis_tready))
        dut.s_axil_arvalid.value = 0
        assert len(readies) == 1, f"tready {readies}"
        seen.add((reset, *readies))
        await RisingEdge(dut.clk_i)
        given["s_axis_tvalid"] &= int(not reset and readies == {0})
    assert seen == {(0, 0), (0, 1), (1, 0)}


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def every_bit_of_the_bus_is_its_own(dut):
    """Words and single bytes to the scratch register; unused addresses with every bit set."""
    axi = await begin(dut)
    for word in (0x5555_5555, 0xAAAA_AAAA, 0):
        assert await axi.write(0x014, word) == AxiResp.OKAY
        assert await axi.read(0x014) == (word, AxiResp.OKAY)
    for byte in range(4):
        assert (await axi.lite.write(0x014 + byte, bytes([0xA5 + byte]))).resp == AxiResp.OKAY
    assert await axi.read(0x014) == (0xA8A7A6A5, AxiResp.OKAY)
    for address in (0x554, 0xAA8, 0xFFC):
        assert (await axi.read(address))[1] == AxiResp.SLVERR
        assert await axi.write(address, 0xFFFF_FFFF) == AxiResp.SLVERR


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.3])
async def every_packet_is_the_models(dut, rate):
    axi = await begin(dut, rate)
    rng = np.random.default_rng(bench.SEED)
    if number(dut, "Array"):
        twin, size = array_twin(dut)
        samples = pressing(rng, 40, size)
        expected = core.of_array(twin, samples, SLIP)
        for frame in samples:
            await axi.send(size.beats_of(frame))
            await bench.clocks(dut, 2200)  # until the line has taken all packets of the frame
        packets = await axi.packets()
        assert images(packets) == expected.images.tolist()
    elif number(dut, "Cop4"):
        load = np.abs(np.cumsum(rng.normal(0, 0.4, 120))) + 0.2
        load[40:43] *= 0.4
        load[90:] *= 0.5
        samples = _electrodes(load)
        expected = core.of_electrodes(samples, ELECTRODES.registers, None, LAG, COP_SLIP)
        for frame in samples:
            await axi.send(frame[:, None])
            await bench.clocks(dut, 250)
        packets = await axi.packets()
    else:
        channels = number(dut, "Channels")
        level = 1000 + rng.integers(-20, 21, (300, channels))
        samples = level + 600 * (rng.random((300, channels)) < 0.03)
        expected = core.of_channels(samples, SLIP)
        for frame in samples:
            await axi.send(frame[:, None])
        packets = await axi.packets()
    assert len(expected.slip) > 3 or len(expected.cop) > 0
    assert of_kind(packets, p.SLIP) == [payload for _, payload in expected.slip]
    assert of_kind(packets, p.COP) == [payload for _, payload in expected.cop]
    assert expected.slip, "nothing slipped"
    times = [q.time for q in packets if q.kind == p.COP]
    assert times == sorted(set(times))


def _point(newtons, mesh=ELECTRODES.mesh):
    load = np.zeros((mesh.m, mesh.n))
    load[mesh.m // 2, mesh.n // 3] = newtons
    return load


def _electrodes(newtons):
    solved = ELECTRODES.mesh.solve(np.array([_point(value) for value in newtons]))
    volts = np.stack([solved.E1, solved.E2, solved.E3, solved.E4], axis=1)
    return ELECTRODES.convert(volts)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def says_what_it_is_and_refuses_what_it_has_not(dut):
    axi = await begin(dut)
    assert (await axi.read(0x000))[0] == 0x4D534E52
    rows = number(dut, "Rows") if number(dut, "Array") else 1
    columns = number(dut, "Columns") if number(dut, "Array") else number(dut, "Channels")
    assert (await axi.read(0x00C))[0] == columns << 16 | rows
    features = (await axi.read(0x008))[0]
    array, cop4 = number(dut, "Array"), number(dut, "Cop4")
    bits = (0, number(dut, "Slip"), 0, number(dut, "Health"), number(dut, "Tare"), array, array, cop4)
    bits += (number(dut, "CopSlip"), 1, number(dut, "Grip"), number(dut, "ShearSpeed"), number(dut, "Forest"))
    bits += (number(dut, "Display"),)
    assert features == sum(bit << place for place, bit in enumerate(bits))
    for place, address in enumerate(
        (0x100, 0x200, 0x300, 0x400, 0x480, 0x500, 0x600, 0x700, 0x800, 0x900, 0xA00, 0xB00, 0xC00, 0xD00)
    ):
        resp = (await axi.read(address))[1]
        assert resp == (AxiResp.OKAY if bits[place] else AxiResp.SLVERR), hex(address)
    assert await axi.write(0x000, 1) == AxiResp.SLVERR


@bench.applies(lambda dut: number(dut, "Grip"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_hand_gets_words_and_pulses(dut):
    """A force of 41 counts set by a host, in each period of 300 clocks; the pulse is as wide."""
    axi = await begin(dut)
    settings = {0xA04: 300, 0xA10: 7, 0xA14: 900, 0xA18: 65535, 0xA24: 1, 0xA2C: 1, 0xA30: 41, 0xA00: 1}
    for address, value in settings.items():
        assert await axi.write(address, value) == AxiResp.OKAY
    at = []
    for clock in range(1000):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        if dut.grip_valid_o.value == 1:
            at.append(clock)
            assert bench.read(dut.grip_word_o) == 41
    assert [later - one for one, later in itertools.pairwise(at)] == [300] * (len(at) - 1) and len(at) >= 3
    await RisingEdge(dut.pwm_o)
    rose = get_sim_time("ns")
    await FallingEdge(dut.pwm_o)
    assert (get_sim_time("ns") - rose) / 10 == 41


@bench.applies(lambda dut: number(dut, "Slip"))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_threshold_written_while_frames_pass_holds_from_one_frame_on(dut):
    axi = await begin(dut)
    rng = np.random.default_rng(bench.SEED)
    array = number(dut, "Array")
    if array:
        twin, size = array_twin(dut)
        samples = pressing(rng, 40, size)
        flat = core.of_array(twin, samples).images
    else:
        flat = 1000 + rng.integers(-200, 201, (300, number(dut, "Channels")))
        samples = flat
    for n, frame in enumerate(samples):
        await axi.send(size.beats_of(frame) if array else frame[:, None])
        if n == len(samples) // 2:
            assert await axi.write(0x200, 60) == AxiResp.OKAY
        await bench.clocks(dut, 20)
    got = of_kind(await axi.packets(), p.SLIP)
    whole = [payload for _, payload in core.of_channels(flat, SLIP).slip]
    changed = [core.of_channels(flat, SLIP, change=(frame, 60)).slip for frame in range(0, len(flat), 2)]
    assert got != whole, "nothing changed"
    assert got in [[payload for _, payload in events] for events in changed]


@bench.applies(lambda dut: number(dut, "Array"))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_calibration_is_loaded_while_it_runs(dut):
    axi = await begin(dut)
    rng = np.random.default_rng(bench.SEED)
    twin, size = array_twin(dut)
    samples = pressing(rng, 24, size)
    table, row_column = twin.calibrate.table, number(dut, "RowColumn")
    words = -(-size.columns // size.lanes) * (1 if row_column else size.rows)
    write = {"word": 0x504, "offset": 0x508, "gain": 0x50C, "write": 0x510, "swap": 0x514}
    for frame in samples[:8]:
        await axi.send(size.beats_of(frame))
    before = core.of_array(twin, samples[:8])
    got = images(await axi.packets())
    for word in range(words):
        for lane in range(size.lanes):
            gain, offset = (
                int(rng.integers(2000, 9000)),
                0 if number(dut, "Tare") else int(rng.integers(-99, 99)),
            )
            table.write(word, offset, gain, slice(lane, lane + 1))
            for name, value in (("word", word), ("offset", offset), ("gain", gain), ("write", 1 << lane)):
                assert await axi.write(write[name], value) == AxiResp.OKAY
    for row in range(size.rows if row_column else 0):
        gain = int(rng.integers(3000, 5000))
        table.write_row(row, 7, gain)
        for name, value in (("word", row), ("offset", 7), ("gain", gain), ("write", 0x100)):
            await axi.write(write[name], value)
    await axi.write(write["swap"], 1)
    table.swap()
    for frame in samples[8:]:
        await axi.send(size.beats_of(frame))
        await bench.clocks(dut, 2200)
    after = core.of_array(twin, samples[8:])
    got += images(await axi.packets())
    expected = before.images.tolist() + after.images.tolist()
    assert got[-len(after.images) :] == expected[-len(after.images) :]
    assert all(image in expected[: len(before.images)] for image in got[: -len(after.images)])


@bench.applies(lambda dut: number(dut, "Rows") == 24)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_calibration_written_right_after_a_reset_is_kept(dut):
    """By hand: gains of 1, 2 and 3 for samples of 1000 + taxel, written from the first clock on; the frame
    before the swap has the preset gain of 5000 / 4096."""
    axi, taxels = await begin(dut), 24 * 20
    for word in range(taxels):
        for address, value in ((0x504, word), (0x508, 0), (0x50C, 4096 * (1 + word % 3)), (0x510, 1)):
            assert await axi.write(address, value) == AxiResp.OKAY
    for swap in (0, 1):
        assert await axi.write(0x514, swap) == AxiResp.OKAY
        await axi.send([[1000 + taxel] for taxel in range(taxels)])
        await bench.clocks(dut, 6000)
    first, second = images(await axi.packets())
    assert first == [((1000 + taxel) * 5000 + 2048) // 4096 for taxel in range(taxels)]
    assert second == [(1000 + taxel) * (1 + taxel % 3) for taxel in range(taxels)]


@bench.applies(lambda dut: number(dut, "Array"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_image_is_of_one_frame(dut):
    """link.images switched off and on in frames of one value each, between them and at every beat: an image
    has its frame's value in all taxels, and the images are those of the frames that began while it was on."""
    axi, size, due = await begin(dut), Size(dut), []
    beats = size.rows * -(-size.columns // size.lanes)
    taken = 0

    async def count():
        nonlocal taken
        while True:
            await FallingEdge(dut.clk_i)
            taken += dut.s_axis_tvalid.value == 1 and dut.s_axis_tready.value == 1

    async def send(value):
        await axi.send([[value] * size.lanes] * beats)

    cocotb.start_soon(count())
    await axi.write(0x500, 4096)  # the preset gain, 1.0
    if number(dut, "Tare"):  # its first averaging ends, then every zero is 0 and stays
        for _ in range(4):
            await send(0)
        await axi.packets()
        for address, value in ((0x480, 65535), (0x484, 0), (0x494, 1)):
            await axi.write(address, value)
        await bench.clocks(dut, 30)
        for word in range(beats):
            for address, value in ((0x498, word), (0x49C, 0), (0x4A0, 255)):
                await axi.write(address, value)
        await axi.write(0x494, 0)
    on, draw = 1, np.random.default_rng(bench.SEED)
    for n, place in enumerate([*range(beats), *draw.integers(0, beats, 7)] * 2, 1):
        on_before, on = on, 1 - on
        if place == 0:
            await axi.write(0x900, on)
            await send(100 * n)
        else:
            taken, sending = 0, cocotb.start_soon(send(100 * n))
            while taken < place:
                await RisingEdge(dut.clk_i)
            axi.source.pause = True
            await axi.write(0x900, on)
            axi.source.pause = False
            await sending
        due += [100 * n] if (on_before if place else on) else []
        await bench.clocks(dut, 1500)
    got = images(await axi.packets())
    assert [image for image in got if len(set(image)) > 1] == []
    assert [image[0] for image in got][-len(due) :] == due
    assert len(got) == len(due)


@bench.applies(lambda dut: number(dut, "Display"), long=True)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def what_it_feels_and_a_hosts_frame_are_on_pins(dut):
    """By the model, at the drivers' outputs; the limits can be read only, a damaged taxel is a fault."""
    axi = await begin(dut)
    slow = lambda violation: None if str(violation)[:2] == "t_" else Hv507.fail(None, violation)
    driver = Hv507(
        *(getattr(dut, f"hv_{pin}_o") for pin in ("data", "clk", "le", "bl", "pol")), 1, report=slow
    )
    size, grid, period = Size(dut), (2, 5), 10_000  # 400 Hz at 4 MHz

    async def shown():
        seen = np.zeros(10, dtype=int)
        for _ in range(2 * period // 100):
            await bench.clocks(dut, 100)
            seen |= driver.outputs[:10]
        assert not any(driver.outputs[10:])
        return seen.reshape(grid).tolist()

    for name, value in {"increment": 1 << 31, "octant": 2, "enable": 1}.items():
        assert await axi.write(pins.ADDRESS[f"display.{name}"], value) == AxiResp.OKAY
    for name in ("most", "duty", "watchdog", "stop", "size", "state"):
        assert await axi.write(pins.ADDRESS[f"display.{name}"], 1) == AxiResp.SLVERR
    assert (await axi.read(pins.ADDRESS["display.size"]))[0] == 2 << 16 | 5 << 8 | 2
    image = np.arange(size.rows * size.columns).reshape(size.rows, size.columns) % 7 * 40
    for _ in range(2):
        await axi.send(size.beats_of(image))
        [forces] = images(await axi.packets())
        floor = int(np.mean(forces))
        assert await axi.write(pins.ADDRESS["display.floor"], floor) == AxiResp.OKAY
    twin = Render(image.shape, grid, 2, RenderSettings(floor))
    levels = twin.next(np.reshape(forces, image.shape))
    assert 0 < (levels > 0).sum() < 10
    await bench.clocks(dut, 2 * period)
    assert await shown() == (levels > 0).tolist()
    state, _ = await axi.read(pins.ADDRESS["display.state"])
    assert state == 1 | int((levels > 0).sum()) << 8
    assert await axi.write(pins.ADDRESS["display.source"], 1) == AxiResp.OKAY
    frame = np.array([[0, 255, 0, 1, 0], [2, 0, 0, 0, 3]])
    for word in words_of(frame):
        assert await axi.write(pins.ADDRESS["display.levels"], word) == AxiResp.OKAY
    await bench.clocks(dut, period)
    assert await shown() == (frame > 0).tolist()
    assert await axi.write(pins.ADDRESS["display.enable"], 0) == AxiResp.OKAY
    assert not bench.high(dut.hv_bl_o) and bench.high(dut.hv_pol_o) and not any(driver.outputs)


@bench.applies(lambda dut: number(dut, "Forest"), long=True)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_forest_decides_and_the_hand_closes(dut):
    """Loaded over the registers: from frames to forces, differences, classes, packets with their frames'
    times, and to the reflex, which closes by a step for each decision for class 1."""
    axi = await begin(dut)
    twin, size = array_twin(dut)
    samples = pressing(np.random.default_rng(bench.SEED), 40, size)
    forces = core.of_array(twin, samples).images
    classify, draw, slips = (
        Classify(9, slip=0b10, grip=True, **FOREST, engines=2),
        random.Random(bench.SEED),
        0,
    )
    while not 4 < slips < 34:  # a forest that this press tells apart
        loads = words.loads(forest(draw, 18, 3, 8, leaves=9, span=300, depth=3), 2)
        classify.reset()
        for row in loads:
            classify.load(*row)
        classify.swap()
        decisions = classify.next(forces.T)
        slips = sum(of.slips for _, of in decisions)
    for kind, engine, address, data in loads:
        label, place = (address >> 16, address & 0xFFFF) if kind == words.VOTE else (0, address)
        registers = {0xC10: kind | engine << 2 | label << 8, 0xC14: place, 0xC18: data >> 32, 0xC1C: data}
        for at, value in registers.items():
            assert await axi.write(at, value) == AxiResp.OKAY
    assert await axi.read(0xC2C) == (len(loads), AxiResp.OKAY)
    settings = {
        0xC38: 0b10,
        0xC3C: 1,
        0xA04: 300,
        0xA08: 50,
        0xA10: 1000,
        0xA18: 65535,
        0xA1C: 65535,
        0xA00: 1,
    }
    for at, value in (settings | {0xC24: 1}).items():
        assert await axi.write(at, value) == AxiResp.OKAY
    await bench.clocks(dut, 700)
    for frame in samples:
        await axi.send(size.beats_of(frame))
        await bench.clocks(dut, 2200)
    packets = await axi.packets()
    expected = [(frame, p.class_change(*of.change)) for frame, of in decisions if of.change]
    starts = [q.time for q in packets if q.kind == p.COP]
    assert [(starts.index(q.time), q.payload) for q in packets if q.kind == p.CLASS] == expected
    assert len(expected) > 4 and len(decisions) == 38
    names = ("label", "best", "decisions", "changes", "missed", "absent", "late", "broken")
    told = [(await axi.read(pins.ADDRESS[f"forest.{name}"]))[0] for name in names]
    assert told == [classify.label, classify.best, 38, classify.changes, 0, 0, 0, 0]
    assert (await axi.read(0xA44))[0] == 1000 + 50 * slips and (await axi.read(0xA58))[0] == slips


FOREST = {"features": 18, "bits": 12, "classes": 3, "trees": 5, "nodes": 64, "leaves": 9}
SETTINGS = {
    "calibrate.preset": GAIN,
    "cop.min_load": 1,
    **{
        f"slip.{key}": int(value)
        for key, value in vars(SLIP).items()
        if key not in ("window", "hop", "level") and value is not None
    },
    "tare.contact": CONTACT,
    "tare.step": STEP,
    **{
        f"health.{key}": int(getattr(LIMITS, key))
        for key in ("band", "jump", "low", "high", "still", "rail", "blink")
    },
    "health.use.user": int(LIMITS.over_range_enable),
    "health.use.edges": int(LIMITS.edges),
    **{f"cop4.{key}": value for key, value in vars(ELECTRODES.registers).items()},
    **{f"cop_slip.{key}": value for key, value in vars(COP_SLIP).items()},
}
PATH = {"Level": SLIP.level, "Window": SLIP.window, "Hop": SLIP.hop}
PINS = {"Display": 1, "PinRows": 2, "PinColumns": 5, "AmplitudeBits": 2, "ClkKhz": 4000}
BUILDS = {
    "array": {"Rows": 4, "Columns": 6, "Lanes": 2, "Health": 1, "Tare": 1, "Chunk": 16} | PATH,
    "array-3": {"Rows": 3, "Columns": 7, "Lanes": 3, "Health": 1, "Tare": 1, "Chunk": 16} | PATH,
    "array-lane": {"Rows": 3, "Columns": 3, "Lanes": 1, "Tare": 1, "Forest": 1, "ForestEngines": 2, "Grip": 1}
    | {f"Forest{name.capitalize()}": value for name, value in FOREST.items()}
    | PATH,
    "array-plain": {"Rows": 3, "Columns": 8, "Lanes": 8, "RowColumn": 1, "GainShift": 24} | PATH | PINS,
    "channels": {"Array": 0, "Image": 0, "Channels": 3, "Grip": 1, "ShearSpeed": 1} | PATH,
    "electrodes": {"Array": 0, "Image": 0, "Slip": 0, "Channels": 4, "Cop4": 1, "CopSlip": 1, "Lag": LAG},
}


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
    "mutants": {"limit": 60, "unsolved": True},
    "faults": {"none": "the core behind msn_axil, both done alone"},
}


GIVEN = {"Statistics": 0, "TareLog2": TARE_LOG2, "Resets": f"{RESET_BITS}'h{reset_word(SETTINGS):x}"}


@pytest.mark.parametrize("name", BUILDS)
def test_axis(name):
    bench.run("core", "axis", BUILDS[name] | GIVEN)


def test_axis_after_a_reset():
    size = {"Rows": 24, "Columns": 20, "Slip": 0} | GIVEN
    bench.run("core", "axis", size, "a_calibration_written_right_after_a_reset_is_kept")


def test_it_has_every_feature_of_the_core():
    """Except those that need a converter's pins, and the outputs that AXI replaces."""
    declared = re.compile(r"^  parameter +bit +(\w+)", re.MULTILINE)
    core_text, axis_text = ((ROOT / f"rtl/msn_{name}.sv").read_text() for name in ("core", "axis"))
    own = set(declared.findall(core_text)) - {
        "Demod",
        "Serial",
        "Registers",
        "Uart",
        "SlipOnly",
        "ReadDuring",
        "ForestSdram",
    }
    assert own == set(declared.findall(axis_text)) and len(own) >= 12
    for name in own:
        assert f".{name}({name})" in axis_text, name


@pytest.mark.parametrize(
    "parameters, sentence",
    [
        ({"Cop4": 1}, "Array = 1 must go without Cop4"),
        ({"Array": 0, "Image": 0, "Cop4": 1, "Channels": 4}, "Cop4 must go with"),
        ({"Array": 0, "Image": 1}, "must go with Array = 1"),
        ({"Array": 0, "Image": 0, "CopSlip": 1}, "CopSlip and Correct with Cop4"),
        ({"Lanes": 9}, "Converters = 9 must lie in 1 .. 8"),
    ],
)
def test_refuses_illegal_parameters(parameters, sentence):
    command = bench.refuses("axis", parameters, of="core")
    assert sentence in command
