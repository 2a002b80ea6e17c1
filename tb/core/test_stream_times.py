"""Times of an array whose frames come on a stream, by value: every packet of a frame has the clock in which
the frame's first beat was taken, with frames back to back, with gaps inside them and with a sink that stalls.
Settings change between two frames only, counted in taxels. A frame without slip and images is followed by the
next one as soon as its centre of pressure has left. The bench counts clocks from the end of the reset.
"""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from core.test_axis import ELECTRODES, _electrodes
from meissner.twins import core
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.registers import RESET_BITS, reset_word
from meissner.twins.sensor.sensors import from_reset
from meissner.twins.slip.config import SlipConfig

GAIN = 700
SLIP = SlipConfig(8, 8, 1, 60, 5000, 900, 500, True, 3, 2, 1)
PATH = {"Level": SLIP.level, "Window": SLIP.window, "Hop": SLIP.hop}
SIZES = {
    "rows and columns": {"Rows": 16, "Columns": 32, "Lanes": 8, "RowColumn": 1, "GainShift": 20} | PATH,
    "taxels": {"Rows": 6, "Columns": 20, "Lanes": 4, "Health": 1, "Tare": 1} | PATH,
    "five lanes": {"Rows": 4, "Columns": 17, "Lanes": 5, "Health": 1, "Tare": 1} | PATH,
    "cop alone": {
        "Rows": 16,
        "Columns": 32,
        "Lanes": 8,
        "RowColumn": 1,
        "GainShift": 20,
        "Slip": 0,
        "Image": 0,
    },
}


SEEN = ("commit", "sample_valid", "sample_ready", "cop_valid")  # inside the core


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


class Watch:
    """Records inputs and outputs: the clocks of first and last beats, packets, commits."""

    def __init__(self, dut, stall=0.0):
        self.dut, self.stall = dut, stall
        self.clock, self.first, self.last, self.packets, self.commits = 0, [], [], [], []
        self.taxels, self.cops, self.midway = 0, 0, False
        self.decoder, self.bytes = Decoder(), bytearray()

    async def run(self):
        draw = random.Random(f"{bench.SEED} sink")
        dut, edge, settled = self.dut, RisingEdge(self.dut.clk_i), ReadOnly()
        names = ("tvalid", "tready", "tlast", "tdata")
        in_valid, in_ready, in_last, _ = (getattr(dut, f"s_axis_{name}") for name in names)
        out_valid, out_ready, out_last, out_data = (getattr(dut, f"m_axis_{name}") for name in names)
        commit, sample_valid, sample_ready, cop_valid = (getattr(dut.u_core, name) for name in SEEN)
        put_ready = bench.putter(out_ready)
        while True:
            put_ready(draw.random() >= self.stall)
            await settled
            if bench.read(in_valid) and bench.read(in_ready):
                if not self.midway:
                    self.first.append(self.clock)
                self.midway = not bench.read(in_last)
                if not self.midway:
                    self.last.append(self.clock)
            if bench.read(out_valid) and bench.read(out_ready):
                self.bytes.append(bench.read(out_data))
                if bench.read(out_last):
                    self.packets += self.decoder.next(encode(bytes(self.bytes)))
                    self.bytes.clear()
            if bench.read(commit):
                self.commits.append((self.taxels, self.cops, len(self.first), len(self.last)))
            self.taxels += bench.read(sample_valid) & bench.read(sample_ready)
            self.cops += bench.read(cop_valid)
            await edge
            self.clock = 0 if bench.read(dut.rst_i) else self.clock + 1


async def begin(dut, stall=0.0):
    idle = {"s_axis_tvalid": 0, "m_axis_tready": 0, "actuator_moving_i": 0}
    idle |= {f"s_axil_{name}": 0 for name in ("awvalid", "wvalid", "bready", "arvalid", "rready")}
    await bench.start(dut, **idle)
    watch = Watch(dut, stall)
    cocotb.start_soon(watch.run())
    await bench.clocks(dut, 700)
    return watch


async def send(dut, frames, lanes, gap=0.0, between=0):
    draw = random.Random(f"{bench.SEED} source")
    for frame in map(np.atleast_2d, frames):
        beats = np.pad(frame, ((0, 0), (0, -frame.shape[1] % lanes)), constant_values=999).reshape(-1, lanes)
        for n, beat in enumerate(beats):
            while draw.random() < gap:
                await RisingEdge(dut.clk_i)
            dut.s_axis_tvalid.value, dut.s_axis_tlast.value = 1, int(n == len(beats) - 1)
            dut.s_axis_tdata.value = sum(int(value) << 32 * k for k, value in enumerate(beat))
            while True:
                await ReadOnly()
                taken = bench.read(dut.s_axis_tready)
                await RisingEdge(dut.clk_i)
                if taken:
                    break
            dut.s_axis_tvalid.value = 0
        await bench.clocks(dut, between)


def samples_of(dut, frames):
    """Idle, then a contact on some taxels that slips now and then."""
    rng = np.random.default_rng(bench.SEED)
    shape = frames, number(dut, "Rows"), number(dut, "Columns")
    samples = rng.integers(100, 140, shape)
    contact = np.zeros(shape[1:], dtype=int)
    contact[1:3, 2:7] = 4000
    jumps = 900 * (rng.random(shape) < 0.08)
    samples[4:] += (contact + jumps * (contact > 0))[4:] if frames > 4 else 0
    return samples


def twin_of(dut):
    class Size:
        rows, columns, lanes = (number(dut, name) for name in ("Rows", "Columns", "Lanes"))
        sample_bits = 17

    tare = {"tare_log2": 1, "contact": 50, "step": 3} if number(dut, "Tare") else None
    limits = core.Limits() if number(dut, "Health") else None
    kinds = {"row_column": bool(number(dut, "RowColumn")), "gain_shift": number(dut, "GainShift")}
    return from_reset(Size, GAIN, limits, tare, **kinds)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0, 0), (0.4, 0.0, 0), (0.0, 0.0, 37), (0.0, 0.6, 4000)])
async def every_packet_carries_the_clock_of_its_frames_first_beat(dut, pace):
    gap, stall, between = pace
    watch = await begin(dut, stall)
    samples = samples_of(dut, 8 if between < 1000 else 14)
    slips = bool(number(dut, "Slip"))
    expected = core.of_array(twin_of(dut), samples, SLIP if slips else None)
    await send(dut, samples, number(dut, "Lanes"), gap, between)
    quiet, seen = 0, 0
    while quiet < 6000:
        await bench.clocks(dut, 500)
        quiet, seen = (quiet + 500 if len(watch.packets) == seen else 0), len(watch.packets)
    assert len(watch.first) == len(samples) and len(set(watch.first)) == len(samples)
    time_of = {frame: clock for frame, clock in enumerate(watch.first)}

    cops = [(q.time, q.payload) for q in watch.packets if q.kind == p.COP]
    of_frames = [(time_of[frame], payload) for frame, payload in expected.cop]
    assert set(cops) <= set(of_frames) and cops == sorted(cops)  # an unsent one is replaced by the next
    assert cops[-1] == of_frames[-1]
    if between >= 4000 and not stall:
        assert cops == of_frames
    got = [(q.time, q.payload) for q in watch.packets if q.kind == p.SLIP]
    assert got == [(time_of[frame], payload) for frame, payload in expected.slip]
    assert bool(got) == (slips and len(samples) > 8) or got
    images = {}
    for q in watch.packets:
        if q.kind == p.IMAGE:
            images.setdefault(q.time, []).extend(q.fields["taxels"])
    if number(dut, "Image"):
        assert images and all(
            time in watch.first and taxels == expected.images[watch.first.index(time)].tolist()
            for time, taxels in images.items()
        )


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.3])
async def settings_change_between_two_frames_only(dut, gap):
    watch = await begin(dut)
    samples = samples_of(dut, 7)
    await send(dut, samples, number(dut, "Lanes"), gap)
    await bench.clocks(dut, 5000)
    taxels = samples[0].size if number(dut, "Slip") or number(dut, "Image") else 0
    between = [at for at in watch.commits if at[2] > 0]
    assert len(between) >= len(samples) - 1
    for out, cops, begun, ended in between:
        assert begun == ended and out == begun * taxels and cops == begun, (out, cops, begun, ended)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_next_frame_waits_for_results_only(dut):
    """Clocks from a frame's last beat to the next one's first: the result's latency, then the gate opens. By
    the headers: calibration 15 clocks (rows and columns), CoP 3 + log2(8) + 8; one clock later no result is
    owed, and 2 clocks later the gate opens.
    """
    watch = await begin(dut)
    alone = not (number(dut, "Slip") or number(dut, "Image"))
    samples = samples_of(dut, 5)
    await send(dut, samples, number(dut, "Lanes"))
    await bench.clocks(dut, 3000)
    waits = [first - last for first, last in zip(watch.first[1:], watch.last)]
    if alone:
        assert waits == [15 + 3 + 3 + 8 + 1 + 2] * 4
    else:
        # One taxel a clock leaves at the tap: a frame takes at least as many clocks as taxels, and few more.
        periods = np.diff(watch.first)
        assert all(samples[0].size <= period <= samples[0].size + 64 for period in periods), periods


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0, 0), (0.4, 0.5, 0), (0.0, 0.0, 31)])
async def single_channels_carry_the_clock_of_their_frames_first_beat(dut, pace):
    gap, stall, between = pace
    watch = await begin(dut, stall)
    rng = np.random.default_rng(bench.SEED)
    shape = 160, number(dut, "Channels")
    samples = 1000 + rng.integers(-9, 10, shape) + 700 * (rng.random(shape) < 0.03)
    expected = core.of_channels(samples, SLIP).slip
    await send(dut, samples, 1, gap, between)
    await bench.clocks(dut, 3000)
    assert len(expected) > 5 and len(set(watch.first)) == len(samples)
    got = [(q.time, q.payload) for q in watch.packets if q.kind == p.SLIP]
    assert got == [(watch.first[frame], payload) for frame, payload in expected]
    changes = [q for q in watch.packets if q.kind == p.CHANGE]  # on a slow line some are late
    assert len(changes) > 5 and {q.time for q in changes} <= set(watch.first)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0, 300), (0.4, 0.0, 270)])
async def electrodes_carry_the_clock_of_their_frames_first_beat(dut, pace):
    """A load that falls by half: each centre of pressure has its frame's clock, and so has the slip event."""
    gap, stall, between = pace
    watch = await begin(dut, stall)
    samples = _electrodes([2.0, 2.1, 2.0, 2.1, 2.0, 0.9, 0.8, 0.9, 0.8])
    await send(dut, samples, 1, gap, between)
    await bench.clocks(dut, 3000)
    assert [q.time for q in watch.packets if q.kind == p.COP] == watch.first
    slips = [q.time for q in watch.packets if q.kind == p.SLIP]
    assert slips == [watch.first[5]]  # the first whose load is half of that two frames (the lag) before


SINGLE = {
    "single_channels": {"Array": 0, "Image": 0, "Channels": 3} | PATH,
    "electrodes": {"Array": 0, "Image": 0, "Slip": 0, "Channels": 4, "Cop4": 1, "CopSlip": 1, "Lag": 2},
}


def build(parameters, select):
    settings = {"calibrate.preset": GAIN, "cop.min_load": 1, "tare.contact": 50, "tare.step": 3}
    settings |= {
        f"slip.{key}": int(value)
        for key, value in vars(SLIP).items()
        if key not in ("window", "hop", "level") and value is not None
    }
    settings |= {f"cop4.{key}": value for key, value in vars(ELECTRODES.registers).items()}
    settings |= {"cop_slip.drop": 77, "cop_slip.min_load": 200, "cop_slip.hold": 9, "cop_slip.refractory": 7}
    word = f"{RESET_BITS}'h{reset_word(settings):x}"
    given = {"Statistics": 0, "TareLog2": 1, "Resets": word, "Chunk": 60}
    inside = [f"msn_core.{name}" for name in SEEN]
    bench.run("core", "axis", parameters | given, select, module="test_stream_times", inside=inside)


@pytest.mark.parametrize("name", SIZES)
def test_stream_times(name):
    build(SIZES[name], r"(every_packet\w*|settings_change\w*|the_next_frame\w*)")


@pytest.mark.parametrize("name", SINGLE)
def test_single_stream_times(name):
    build(SINGLE[name], f"{name}_carry")
