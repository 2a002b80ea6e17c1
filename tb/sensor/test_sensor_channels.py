"""msn_sensor_channels with frames on the stream: every sample at its place, a frame held until the previous
one is done, its time that of its first beat, settings changed only between frames; without the gate nothing
is held. At the pins of an AD7606, read after or during the next conversion, a frame's time is its own convert
start; other parts: tb/frontend/test_acquire.py and tb/core."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.frontend.adc_spi import AD7606
from meissner.twins.sensor.sensors import sensor_channels
from parts.ad7606 import Ad7606

CHANNELS, FRAMES = 3, 24


def samples():
    rng = np.random.default_rng(bench.SEED)
    given = rng.integers(-65536, 65536, (FRAMES, CHANNELS))
    given[0] = (65535, -65536, -1)
    return given


async def run(dut, given, gap=0.0, stall=0.0, busy=0, pending=0.0):
    """Output beats (value, id, first, last); each frame's time; (beats out, busy clocks left) at each
    commit."""
    draw, sink = random.Random(f"{bench.SEED} in"), random.Random(f"{bench.SEED} out")
    idle = dict.fromkeys(
        ("cfg_i", "pending_i", "busy_i", "adc_miso_i", "adc_busy_i", "in_data_i", "in_id_i"), 0
    )
    await bench.start(dut, **idle, in_last_i=0, now_i=0, sample_ready_i=0)
    beats = [
        (value, place, int(place == CHANNELS - 1))
        for row in given.tolist()
        for place, value in enumerate(row)
    ]
    out, times, commits, sent, left, clock, held, waits = [], [], [], 0, 0, 0, False, 0
    while len(out) < len(beats):
        offer = held or (sent < len(beats) and draw.random() >= gap)
        value, ident, last = beats[min(sent, len(beats) - 1)]
        dut.in_valid_i.value, dut.in_data_i.value = int(offer), value & 0x1FFFF
        dut.in_id_i.value, dut.in_last_i.value = ident, last
        ready = sink.random() >= stall
        waits = waits or sink.random() < pending
        dut.sample_ready_i.value, dut.busy_i.value, dut.pending_i.value = (
            int(ready),
            int(left > 0),
            int(waits),
        )
        dut.now_i.value = now = 7 + 3 * clock
        await ReadOnly()
        if dut.commit_o.value == 1:
            commits.append((len(out), left))
            waits = False
        left = max(0, left - 1)
        if dut.sample_valid_o.value == 1 and ready:
            beat = [bench.read(getattr(dut, f"sample_{name}_o")) for name in ("data", "id", "first", "last")]
            beat[0] = bench.as_signed(beat[0], 17)
            if len(out) % CHANNELS == 0:
                times.append(now)
            else:
                assert bench.read(dut.time_o) == (times[-1] if bench.read(dut.Gate) else 0)
            out.append(tuple(beat))
            left = busy if beat[3] else max(left, 1)
        took = offer and dut.in_ready_o.value == 1
        held = offer and not took
        sent += took
        await RisingEdge(dut.clk_i)
        clock += 1
        assert clock < 20_000
    assert bench.read(dut.status_o) == 0
    return out, times, commits


def stream(dut):
    return not bench.read(dut.Adc)


@bench.applies(stream)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0, 1), (0.3, 0.0, 9), (0.0, 0.5, 1), (0.4, 0.4, 23)], pending=[0.0, 0.05])
async def frames_come_one_at_a_time_with_their_time(dut, pace, pending):
    gap, stall, busy = pace
    given = samples()
    out, times, commits = await run(dut, given, gap, stall, busy, pending)
    gate = bench.read(dut.Gate)
    should = sensor_channels(Acquire(channels=CHANNELS), given).reshape(-1).tolist()
    firsts = [int(gate and place % CHANNELS == 0) for place in range(len(should))]
    ids = [place % CHANNELS for place in range(len(should))]
    assert out == list(zip(should, ids, firsts, [int(place == CHANNELS - 1) for place in ids]))
    assert len(set(times)) == FRAMES
    assert {taken for taken, _ in commits} >= (set(range(CHANNELS, len(should), CHANNELS)) if gate else set())
    assert gate or not commits
    assert all(taken % CHANNELS == 0 and left == 0 for taken, left in commits), commits


@bench.applies(lambda dut: not stream(dut))
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall=[0, 150])
async def a_frame_has_its_own_convert_start(dut, stall):
    """At the shortest period: read during the next conversion, that has begun before a frame's first sample
    comes; now and then the follower waits ``stall`` clocks in the middle of a frame."""
    during = bool(bench.read(dut.ReadDuring))
    twin = Acquire(AD7606, CHANNELS, clk_khz=25_000, read_during=during)
    period, codes = twin.adc.safe_period(), []

    def code(channel, _):
        codes.append((len(codes) * 2654435761 >> 7) % 65535 + 1)
        return codes[-1] % 65536

    inputs = dict.fromkeys(("pending_i", "busy_i", "adc_miso_i", "adc_busy_i", "in_valid_i", "now_i"), 0)
    for name, value in (inputs | {"rst_i": 1, "sample_ready_i": 1}).items():
        getattr(dut, name).value = value
    dut.cfg_i.value = members.word("cfg", {"adc_enable": 1, "adc_period": period})
    Clock(dut.clk_i, 40, unit="ns").start()
    await bench.clocks(dut, 3)
    names = ("cs_n_o", "sclk_o", "miso_i", "convst_o", "busy_i", "reset_o")
    pins = [getattr(dut, f"adc_{name}") for name in names]
    Ad7606(*pins, code)
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    converts, found, overlaps, still = [], [], 0, 0
    for clock in range(twin.adc.start_clocks() + 30 * period):
        dut.now_i.value = now = bench.time(clock)
        dut.sample_ready_i.value = int(still == 0)
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(now)
        if dut.sample_valid_o.value == 1 and not still:
            ident, value = bench.read(dut.sample_id_o), bench.as_signed(bench.read(dut.sample_data_o), 17)
            if ident:  # time_o holds from the clock after the first sample
                found[-1] = (*found[-1][:1], bench.read(dut.time_o))
            else:
                overlaps += len(converts) - len(found) > 1
                found.append((value, None))
            still = stall * (ident == 1 and len(found) % 5 == 0)
        still = max(0, still - 1)
        await RisingEdge(dut.clk_i)
    starts = {twin.samples([first])[0][0]: now for first, now in zip(codes[::8], converts)}
    assert [starts[value] for value, _ in found[:-1]] == [time for _, time in found[:-1]]
    assert len(found) > 20 and len(starts) == len(converts)
    assert (overlaps > 15) == during or stall


@bench.applies(stream)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_converter_that_is_not_there_rests(dut):
    await bench.start(
        dut, cfg_i=members.word("cfg", {"adc_enable": 1, "adc_period": 5}), adc_miso_i=1, adc_busy_i=1
    )
    for _ in range(20):
        await ReadOnly()
        pins = [
            bench.read(getattr(dut, f"adc_{pin}_o")) for pin in ("cs_n", "sclk", "mosi", "convst", "reset")
        ]
        assert pins == [1, 0, 0, 0, 0]
        await RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
}


PINS = {"Adc": 2, "ClkKhz": 25_000, "SclkKhz": 14_500}


@pytest.mark.parametrize(
    "given",
    [{"Adc": 0}, {"Adc": 0, "Gate": 0}, PINS | {"ReadDuring": 0}, PINS | {"ReadDuring": 1}],
    ids=lambda given: "-".join(map(str, given.values())),
)
def test_sensor_channels(given):
    bench.run("sensor", "sensor_channels", {"Channels": CHANNELS, "Gate": 1} | given)
