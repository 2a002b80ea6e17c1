"""msn_acquire with a stream, with msn_adc_single and with msn_adc_spi behind part models that check their
timing: the samples are the twin's for the codes that the part converted, on an exact grid; a stream passes
unchanged; absent parts give zeros; each error increments its own counter only."""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.frontend.adc_spi import AD7606, MAX11125, MCP3208, PARTS, AdcSpi
from parts import ad7606, mcp3208

COUNTERS = ("dropped", "overrun", "timeout", "mistagged", "over_range")


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def twin_of(dut):
    names = ("Channels", "AdcLanes", "ClkKhz", "SclkKhz", "AdcPeriod", "SampleBits", "PeriodBits")
    return Acquire(PARTS.get(number(dut, "Adc")), *(number(dut, name) for name in names))


def counts(dut):
    return {name: bench.read(getattr(dut, f"{name}_o")) for name in COUNTERS}


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    counters = ["dropped_o", "overrun_o", "timeout_o", "mistagged_o", "over_range_o"]
    await bench.turn_over(dut, *counters, wraps=False)


@bench.applies(lambda dut: not number(dut, "Adc"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.5])
async def a_stream_passes_as_it_comes(dut, rate):
    await bench.start(dut, cfg_enable_i=1, cfg_period_i=10, adc_miso_i=1, adc_busy_i=1)
    channels, bits = number(dut, "Channels"), number(dut, "SampleBits")
    top = 1 << bits - 1
    rng = np.random.default_rng(bench.SEED)
    x = np.concatenate([[[-top, top - 1]] * channels, rng.integers(-top, top, (channels, 200))], axis=1)
    beats = bench.frames(data=twin_of(dut).samples(x)[0])
    for n, beat in enumerate(beats):
        del beat["restart"]
        beat["last"] ^= n % 7 == 3  # damaged frames pass unchanged as well
    pauses = bench.gaps_and_stalls(rate)

    async def wander():
        """With a stream, pins and settings must not matter."""
        while True:
            for name in ("cfg_enable_i", "cfg_period_i", "adc_miso_i", "adc_busy_i"):
                port = getattr(dut, name)
                port.value = int(rng.integers(1 << len(port)))
            await RisingEdge(dut.clk_i)

    wandering = cocotb.start_soon(wander())
    assert await bench.stream(dut, beats, ["data~", "id", "last"], *pauses, hold=True) == beats
    wandering.cancel()
    pins = ("adc_cs_n", "adc_sclk", "adc_mosi", "adc_convst", "adc_reset", "convert")
    assert [bench.read(getattr(dut, f"{name}_o")) for name in pins] == [1, 0, 0, 0, 0, 1]
    assert not any(counts(dut).values())


@bench.applies(lambda dut: not number(dut, "Adc"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_stream_passes_without_a_clock_between(dut):
    """Valid and ready pass in the same clock, both ways."""
    await bench.start(dut, cfg_enable_i=0, cfg_period_i=0, adc_miso_i=0, adc_busy_i=0)
    for valid, ready in ((0, 0), (0, 1), (1, 0), (1, 1)):
        dut.in_valid_i.value, dut.out_ready_i.value = valid, ready
        await ReadOnly()
        assert (bench.read(dut.out_valid_o), bench.read(dut.in_ready_o)) == (valid, ready)
        await RisingEdge(dut.clk_i)


@bench.applies(lambda dut: number(dut, "Adc"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def samples_are_the_models_of_the_codes(dut):
    twin = twin_of(dut)
    part, channels = twin.part, twin.channels
    period = twin.adc_period or twin.adc.safe_period() + 10
    inputs = {"cfg_enable_i": 0, "cfg_period_i": period % (1 << twin.period_bits), "in_valid_i": 1}
    for name, value in ({"rst_i": 1, "adc_busy_i": 0, "out_ready_i": 1} | inputs).items():
        getattr(dut, name).value = value
    Clock(dut.clk_i, 1_000_000_000 // twin.clk_khz, unit="ps").start()
    await bench.clocks(dut, 3)
    frames = 30
    rng = np.random.default_rng(bench.SEED)
    codes = rng.integers(0, 1 << part.data_bits, (8, frames + 5))
    codes[:, 3], codes[:, 5] = 0, (1 << part.data_bits) - 1
    shown = [0] * 8

    def code(channel, _):
        shown[channel] += 1
        return int(codes[channel, shown[channel] - 1])

    pins = [dut.adc_cs_n_o, dut.adc_sclk_o]
    if part is MCP3208:
        mcp3208.Mcp3208(*pins, dut.adc_mosi_o, dut.adc_miso_i, code)
    else:
        ad7606.Ad7606(*pins, dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, code)
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    await bench.clocks(dut, 1 + 6 * twin.clk_khz // 1000)
    dut.cfg_enable_i.value = 1
    found, converts, clock = [], [], 0
    while len(found) < frames * channels:
        assert clock < (frames + 3) * period, "samples are missing"
        await ReadOnly()
        assert bench.read(dut.in_ready_o) == 0, "the stream is not there"
        if dut.convert_o.value == 1:
            converts.append(clock)
        if dut.out_valid_o.value == 1:
            data = bench.as_signed(bench.read(dut.out_data_o), twin.sample_bits)
            found.append((data, bench.read(dut.out_id_o), bench.read(dut.out_last_o)))
        await RisingEdge(dut.clk_i)
        clock += 1
    samples, over = twin.samples(codes[:channels, :frames])
    ends = [int(channel == channels - 1) for channel in range(channels)]
    assert found == [(int(samples[c, n]), c, ends[c]) for n in range(frames) for c in range(channels)]
    assert set(np.diff(converts)) == {period}
    await ReadOnly()
    assert counts(dut) == dict.fromkeys(COUNTERS, 0) | {"over_range": over.sum()}


@bench.applies(lambda dut: number(dut, "Adc"))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def each_counter_counts_its_own(dut):
    """No part at the pins, only levels: MISO stuck high, output not taken, too short a period, BUSY stuck
    low."""
    of = lambda name: getattr(dut, f"cfg_{name}_i" if hasattr(dut, f"cfg_{name}_i") else f"cfg_adc_{name}_i")
    serial = hasattr(dut, "Serial") and number(dut, "Serial")
    part = PARTS[number(dut, "Adc")]
    twin = AdcSpi(part, *(number(dut, name) for name in ("Channels", "AdcLanes", "ClkKhz", "SclkKhz")))
    period = twin.safe_period() + twin.watch_clocks + twin.start_clocks()  # a wrong tag triggers a new setup
    if serial:
        period += 66  # the previous frame's sample must be taken before a frame starts
    cases = [("over_range", period, 1), ("dropped", period, 0), ("overrun", 1, 1)]
    if part is AD7606:
        cases = [("timeout", period, 1)]
    if part is MAX11125:  # every answer has the number 15
        cases = [("mistagged", period, 1)]
    if number(dut, "AdcPeriod"):  # the period is no register, so overruns cannot occur
        period = number(dut, "AdcPeriod")
        cases = [("over_range", 0, 1), ("dropped", 0, 0)]
    inputs = {"actuator_moving_i": 0} if hasattr(dut, "actuator_moving_i") else {}
    await bench.start(dut, adc_miso_i=(1 << len(dut.adc_miso_i)) - 1, adc_busy_i=0, **inputs)
    for name, clocks, ready in cases:
        of("enable").value = 0
        await bench.reset(dut)
        dut.out_ready_i.value = ready
        of("period").value = clocks
        await bench.clocks(dut, twin.start_clocks())
        of("enable").value = 1
        await bench.clocks(dut, 30 * period)
        await ReadOnly()
        found = counts(dut)
        assert found.pop(name) > 0, name
        found.pop("over_range", None)  # a stuck MISO always counts as over-range
        if serial and name == "overrun":
            found.pop("dropped")  # back-to-back frames leave the serial path no time either
        assert not any(found.values()), (name, found)
        await RisingEdge(dut.clk_i)


CLOCKS = {"ClkKhz": 8_000, "SclkKhz": 2_000}
SINGLE = {"ClkKhz": 16_000, "SclkKhz": 2_000, "SampleBits": 13, "AdcPeriod": 1_600}


EVIDENCE = {
    "equivalence": {"boxes": True, "reset": {"qualifiers": {"adc_mosi_o": "!adc_cs_n_o"}}},
    "faults": {"size": {"Adc": 1, "Channels": 3}, "driver": {"free": 16000, "part": 1, "late": "left_q"}},
}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Adc": 0, "Channels": 5},
        {"Adc": 0, "Channels": 1, "SampleBits": 13},
        {"Adc": 1, "Channels": 1} | SINGLE,
        {"Adc": 1, "Channels": 3, "PeriodBits": 11} | CLOCKS,
        {"Adc": 2, "Channels": 8, "ClkKhz": 16_000, "SclkKhz": 8_000, "AdcLanes": 2},
    ],
)
def test_acquire(parameters):
    bench.run("frontend", "acquire", parameters)


def test_tags():
    parameters = {"Adc": 5, "Channels": 2, "ClkKhz": 32_000, "SclkKhz": 8_000}
    bench.run("frontend", "acquire", parameters, "each_counter")


@pytest.mark.parametrize(
    "part, channels, period", [(AD7606, 1, 5_000), (MCP3208, 2, 5_000), (MAX11125, 1, 5_000)]
)
def test_refuses_a_built_in_period(part, channels, period):
    given = {"Adc": part.number, "Channels": channels, "AdcPeriod": period}
    assert f"AdcPeriod = {period}" in bench.refuses("acquire", given)
    with pytest.raises(ValueError, match=f"adc_period = {period}"):
        Acquire(part, channels, adc_period=period)


def test_the_model_refuses_what_its_blocks_refuse():
    with pytest.raises(ValueError, match="period = 5"):
        Acquire(MCP3208, clk_khz=12_000, sclk_khz=2_000, adc_period=5, sample_bits=13)
    with pytest.raises(ValueError, match="lanes = 2"):
        Acquire(MCP3208, lanes=2)
