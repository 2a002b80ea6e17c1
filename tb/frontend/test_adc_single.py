"""msn_adc_single on a model of the part that checks its own timing: codes (corners of every bit, then random)
against the twin, with a follower that is ready, stalls or sleeps for frames; convert starts stay on the grid
throughout; each conversion gives a sample or is counted as dropped; latency; enable; reset at several clocks
of a frame."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refusals
from meissner.twins.frontend.adc_single import AdcSingle
from parts.mcp3208 import Mcp3208


class Codes:
    """Codes: corners of every bit first, then random."""

    def __init__(self):
        ones = [1 << bit for bit in range(12)]
        self.corners = [0, 4095, 0x555, 0xAAA, 2047, 2048, *ones, *(4095 ^ one for one in ones)]
        self.draw = random.Random(bench.SEED)

    def __call__(self, channel, time):
        return self.corners.pop(0) if self.corners else self.draw.randint(0, 4095)


class Harness:
    """The block, its part, and a record of events with their clocks."""

    def __init__(self, dut):
        self.dut = dut
        names = ("Channel", "ClkKhz", "SclkKhz", "Period", "SampleBits")
        self.twin = AdcSingle(*(getattr(dut, name).value.to_unsigned() for name in names))
        self.clock = 0
        self.converts, self.valids, self.takes, self.samples = [], [], [], []
        self.held = None

    async def start(self):
        dut = self.dut
        for name in ("rst_i", "cfg_enable_i", "out_ready_i", "adc_miso_i", "clk_i"):
            getattr(dut, name).value = int(name in ("rst_i", "cfg_enable_i"))
        Clock(dut.clk_i, 1_000_000_000 // self.twin.clk_khz // 2 * 2, unit="ps").start()
        await bench.clocks(dut, 3)
        self.part = Mcp3208(dut.adc_cs_n_o, dut.adc_sclk_o, dut.adc_mosi_o, dut.adc_miso_i, Codes())
        await bench.clocks(dut, 3)
        dut.rst_i.value = 0

    async def run(self, clocks, ready=lambda: True):
        dut = self.dut
        for _ in range(clocks):
            takes = bool(ready())
            dut.out_ready_i.value = int(takes)
            await ReadOnly()
            if dut.convert_o.value == 1:
                assert dut.adc_cs_n_o.value == 0
                self.converts.append(self.clock)
            valid = dut.out_valid_o.value == 1
            if valid:
                sample = (bench.read(dut.out_data_o), bench.read(dut.out_user_o))
                assert self.held in (None, sample), "a sample changed while it waited"
                if self.held is None:
                    self.valids.append(self.clock)
                if takes:
                    self.samples.append(sample)
                    self.takes.append(self.clock)
            assert valid or self.held is None, "a sample was withdrawn"
            self.held = sample if valid and not takes else None
            self.clock += 1
            await RisingEdge(dut.clk_i)

    def expected(self, conversions):
        values, user = self.twin.samples([code for _, code, _ in conversions])
        return [(int(v), int(u)) for v, u in zip(values, user)]


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    """A sample waits from the first clock on, so that the next one is dropped."""
    counters, inputs = ("dropped_o", "over_range_o"), {"adc_miso_i": 1, "cfg_enable_i": 1, "out_ready_i": 0}
    span = 3 * dut.Period.value.to_unsigned()
    await bench.turn_over(dut, *counters, span=span, wiggled=["out_ready_i"], again=False, **inputs)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """Codes of all ones, which nobody takes, and which are taken at once."""
    span = 3 * dut.Period.value.to_unsigned()
    await bench.start(dut, adc_miso_i=1, cfg_enable_i=1)
    await bench.counts_on(dut, "dropped_o", span=span, out_ready_i=0)
    await bench.counts_on(dut, "over_range_o", span=span, out_ready_i=1)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def sends_every_code_on_the_grid(dut, stall_rate):
    bench_ = Harness(dut)
    await bench_.start()
    stall = bench.pauses(stall_rate, "stalls")
    await bench_.run(60 * bench_.twin.period, lambda: not stall())
    done = [c for c in bench_.part.conversions if c[0] == bench_.twin.channel]
    assert done == bench_.part.conversions
    assert len(bench_.samples) >= 58
    assert bench_.samples == bench_.expected(done)[: len(bench_.samples)]
    assert set(np.diff(bench_.converts)) == {bench_.twin.period}
    assert {v - c for c, v in zip(bench_.converts, bench_.valids)} == {bench_.twin.latency}
    assert bench.read(dut.dropped_o) == 0
    assert bench.read(dut.over_range_o) == sum(user for _, user in bench_.samples) > 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def drops_whole_conversions_while_nobody_takes_the_sample(dut):
    """The follower wakes at every phase of a period; it never gets a mixture of two samples."""
    bench_ = Harness(dut)
    await bench_.start()
    period = bench_.twin.period
    draw = random.Random(bench.SEED)
    wakes = sorted(draw.randrange(60 * period) for _ in range(30))
    wakes += [(60 + 2 * n) * period + at for n, at in enumerate(range(-6, 7))]  # around the convert start
    await bench_.run(90 * period, lambda: bool(wakes) and bench_.clock >= wakes[0] and wakes.pop(0) >= 0)
    await bench_.run(bench_.twin.latency + 5)
    codes = bench_.expected(bench_.part.conversions)
    # In order, with gaps: each sample taken comes after the previous one.
    at = 0
    for sample in bench_.samples:
        at = codes.index(sample, at) + 1
    waits = list(zip(bench_.valids, bench_.takes))
    done = [c for c in bench_.converts if c + bench_.twin.latency < bench_.clock]
    # A sample taken in the last clock before convert_o makes room in time.
    lost = [c for c in done if any(valid < c <= taken for valid, taken in waits)]
    assert {taken - c for c in done for _, taken in waits} >= {-2, -1, 0, 1}
    assert bench.read(dut.dropped_o) == len(lost) > 10
    assert set(np.diff(bench_.converts)) == {period}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def rests_while_not_enabled(dut):
    """A frame in progress ends as usual, and the grid does not shift."""
    bench_ = Harness(dut)
    await bench_.start()
    period = bench_.twin.period
    await bench_.run(3 * period + period // 20)
    dut.cfg_enable_i.value = 0
    await bench_.run(3 * period)
    dut.cfg_enable_i.value = 1
    await bench_.run(3 * period)
    gaps = np.diff(bench_.converts) // period
    assert sorted(gaps)[-1] == 4 and (np.diff(bench_.converts) % period == 0).all()
    assert bench_.samples == bench_.expected(bench_.part.conversions)[: len(bench_.samples)]
    assert len(bench_.samples) >= len(bench_.converts) - 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset_in_mid_frame(dut):
    bench_ = Harness(dut)
    await bench_.start()
    period = bench_.twin.period
    for late in (1, bench_.twin.latency // 2, bench_.twin.latency - 1, bench_.twin.latency):
        await bench_.run(bench_.twin.period + late, lambda: False)
        await bench.reset(dut)
        bench_.held = None
        bench_.clock = 0
        bench_.converts, bench_.valids, bench_.samples = [], [], []
        begun = len(bench_.part.conversions)
        await bench_.run(4 * period + bench_.twin.latency + 2)
        assert bench_.converts[0] == period
        assert bench_.samples == bench_.expected(bench_.part.conversions[begun:])
        assert len(bench_.samples) == 4
        assert bench.read(dut.dropped_o) == 0


EVIDENCE = {
    "equivalence": {
        "reset": {"qualifiers": {"adc_mosi_o": "!adc_cs_n_o", "adc_sclk_o": "!adc_cs_n_o"}},
    },
    "faults": {"settle": 3, "driver": {"free": 12000, "part": 1}},
    "icarus": {
        "refused": "a parameter that a package's function makes of another package's functions: not evaluated"
    },
}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Channel": 0, "ClkKhz": 12_000, "SclkKhz": 2_000, "Period": 300, "SampleBits": 13},
        {"Channel": 6, "ClkKhz": 12_500, "SclkKhz": 1_000, "Period": 512, "SampleBits": 17},
        {"Channel": 1, "ClkKhz": 50_000, "SclkKhz": 2_000, "Period": 641, "SampleBits": 13},
    ],
)
def test_adc_single(parameters):
    bench.run("frontend", "adc_single", parameters)


test_refuses_illegal_parameters = refusals(
    "adc_single",
    AdcSingle,
    *({"Channel": 8}, {"ClkKhz": 0}, {"SclkKhz": 2001}, {"Period": 160}, {"SampleBits": 12}),
    {"SclkKhz": 9, "Period": 90_000},
    {"SclkKhz": 11, "Period": 90_000},  # a bit of 1092 clocks is enough, but 2048 are used
)
