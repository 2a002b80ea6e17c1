"""msn_sensor_channels with frames on the stream: every sample at its place, a frame held until the previous
one is done, its time that of its first beat, settings changed only between frames; without the gate nothing
is held. At the pins: tb/frontend/test_acquire.py and tb/core."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.sensor.sensors import sensor_channels

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


@pytest.mark.parametrize("gate", [1, 0])
def test_sensor_channels(gate):
    bench.run("sensor", "sensor_channels", {"Adc": 0, "Channels": CHANNELS, "Gate": gate})
