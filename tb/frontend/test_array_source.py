"""msn_array_source: a stream passes unchanged, with the current clock as its time; from a converter, with or
without a carrier, complete frames come with the time of their first convert start, and the stream is ignored.
The contents of frames: tb/cop/test_array.py, at the pins."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.adc_spi import MAX11125, MCP3208
from meissner.twins.frontend.array_source import Stream

STREAM = {"Part": 0, "Rows": 3, "Columns": 5, "Converters": 2}
SCAN = {"Part": MCP3208.number, "Rows": 2, "Columns": 3, "Channels": 3, "ClkKhz": 16_000, "SclkKhz": 2000}
CARRIER = {"Part": MAX11125.number, "Rows": 2, "Columns": 3, "Demod": 1, "Channels": 1, "ClkKhz": 100_000}
CARRIER |= {"SamplePeriod": 320, "Periods": 2, "Skip": 2, "Shift": 0}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


async def begin(dut, **inputs):
    names = "now cfg_enable cfg_settle cfg_period cfg_interleave adc_miso adc_busy in_data in_id in_last"
    await bench.start(dut, **{f"{name}_i": 0 for name in names.split()} | inputs)


def counters(dut):
    return [bench.read(getattr(dut, f"{name}_o")) for name in ("dropped", "overrun", "held", "lost")]


@bench.applies(lambda dut: number(dut, "Part") == 0)
@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_stream_goes_through(dut):
    draw = random.Random(bench.SEED)
    await begin(dut, cfg_enable_i=1)
    twin = Stream(3, 5, 2)
    beats = [
        {"data": draw.getrandbits(34), "id": draw.randrange(9), "last": draw.getrandbits(1)}
        for _ in range(200)
    ]
    clocks = [draw.getrandbits(48) for _ in beats]
    for beat, (expected, now) in zip(beats, twin.samples(beats, clocks)):
        valid, ready = draw.getrandbits(1), draw.getrandbits(1)
        dut.in_valid_i.value, dut.out_ready_i.value, dut.now_i.value = valid, ready, now
        bench.offer(dut, beat)
        await ReadOnly()
        assert (bench.read(dut.out_valid_o), bench.read(dut.in_ready_o)) == (valid, ready)
        assert {name: bench.read(getattr(dut, f"out_{name}_o")) for name in beat} == expected
        assert (bench.read(dut.out_time_o), bench.read(dut.out_user_o)) == (now, 0)
        lines = [bench.read(getattr(dut, f"{name}_o")) for name in ("row", "group", "adc_sclk", "convert")]
        assert lines == [0] * 4 and bench.read(dut.adc_cs_n_o) == 3
        await RisingEdge(dut.clk_i)
    assert counters(dut) == [0] * 4


@bench.applies(lambda dut: number(dut, "Part") > 0)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_of_a_scan(dut):
    """The data line is high: codes of all ones, which as a carrier have no amplitude."""
    await begin(dut, cfg_enable_i=1, cfg_settle_i=5, adc_miso_i=1, in_valid_i=1, out_ready_i=1)
    carrier, per_frame = number(dut, "Demod"), 6
    value = 0 if carrier else 4095
    beats, converts, clock = [], [], 0
    while len(beats) < 3 * per_frame:
        clock += 1
        dut.now_i.value = 7 * clock
        dut.out_ready_i.value = 1
        await ReadOnly()
        assert bench.read(dut.in_ready_o) == 0
        if bench.read(dut.convert_o):
            converts.append(7 * clock)
        if bench.read(dut.out_valid_o):
            beats.append(
                [bench.read(getattr(dut, f"out_{name}_o")) for name in ("data", "id", "last", "time")]
            )
        await RisingEdge(dut.clk_i)
    assert [beat[:3] for beat in beats] == [[value, n, int(n == 5)] for n in range(per_frame)] * 3
    early = 7 if carrier else 0  # with a carrier the pin follows a register later
    times = [beat[3] + early for beat in beats]
    firsts = times[::per_frame]
    assert times == [time for time in firsts for _ in range(per_frame)]
    assert len(set(firsts)) == 3 and set(firsts) <= set(converts) and firsts[0] == converts[0]
    assert counters(dut) == [0, 0, 0, 18 if carrier else 0]  # that part tags its answers: wrong here


EVIDENCE = {"reference": {"moves": "frames of a scan or a stream"}, "faults": {"size": {"Part": 1}}}


@pytest.mark.parametrize("build", [STREAM, SCAN, CARRIER], ids=["stream", "scan", "carrier"])
def test_array_source(build):
    bench.run("frontend", "array_source", build)
