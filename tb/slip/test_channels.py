"""msn_channels from the pins of a real converter to the slip decision, on the part models that check their
timing: the decisions are the twin's on the codes that the part converted, and each comes within 0.2 ms +
1 us of the sample that crosses, on the first channel and on the last, at 10 kHz. The counters of what went
wrong, and a stream in place of a converter, by the tests of the two blocks it is made of."""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
from meissner.frontend.acquire import Acquire
from meissner.frontend.adc_spi import AD7606, MCP3208, PARTS, AdcSpi
from meissner.slip.channels import of_codes
from meissner.slip.config import SlipConfig
from parts import ad7606, mcp3208

RATE_HZ = 10_000
CONFIG = SlipConfig(threshold=300, gross_threshold=900, contact_level=600, release_level=500, hold=4, blank=3)


class Rubber:
    """Codes per channel and conversion: pressed at 700 with a little noise, and steps where they are put."""

    def __init__(self, channels, frames):
        rng = np.random.default_rng(bench.SEED)
        self.codes = 700 + rng.integers(-3, 4, (8, frames + 50))
        self.count = [0] * 8

    def __call__(self, channel, time):
        index = self.count[channel]
        self.count[channel] += 1
        return int(self.codes[channel, index])


async def watch(dut, rubber, frames):
    """Run ``frames`` frames through the pins; returns the part, the decisions and the times of both."""
    value = lambda name: getattr(dut, name).value.to_unsigned()
    part = PARTS[value("Adc")]
    channels, clk_khz = value("Channels"), value("ClkKhz")
    names = "threshold gross_threshold contact_level release_level hold refractory blank contact_rises"
    for name in names.split():
        getattr(dut, f"cfg_{name}_i").value = int(getattr(CONFIG, name))
    for name in ("rst_i", "cfg_adc_enable_i", "actuator_moving_i", "adc_miso_i", "adc_busy_i", "in_valid_i"):
        getattr(dut, name).value = int(name == "rst_i")
    period = clk_khz * 1000 // RATE_HZ
    dut.out_ready_i.value = 1
    dut.cfg_adc_period_i.value = period
    Clock(dut.clk_i, 1_000_000_000 // clk_khz, unit="ps").start()
    await bench.clocks(dut, 3)
    pins = [dut.adc_cs_n_o, dut.adc_sclk_o]
    if part is MCP3208:
        model = mcp3208.Mcp3208(*pins, dut.adc_mosi_o, dut.adc_miso_i, rubber)
    else:
        model = ad7606.Ad7606(
            *pins, dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, rubber
        )
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    await bench.clocks(dut, 1 + 6 * clk_khz // 1000)
    dut.cfg_adc_enable_i.value = 1
    decisions, converts = [], []
    clock = 0
    while len(decisions) < frames // 2 * channels:
        assert clock < (frames + 5) * period, "decisions are missing"
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(get_sim_time("ns"))
        if dut.out_valid_o.value == 1:
            fields = [bench.read(getattr(dut, f"out_{f}_o")) for f in ("id", "state", "over", "p2p")]
            decisions.append((get_sim_time("ns"), *fields))
        await RisingEdge(dut.clk_i)
        clock += 1
    assert [bench.read(getattr(dut, f"{n}_o")) for n in ("dropped", "overrun", "timeout", "damaged")] == [
        0
    ] * 4
    return part, channels, model, decisions, converts


@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    counters = [
        "dropped_o",
        "overrun_o",
        "timeout_o",
        "mistagged_o",
        "over_range_o",
        "damaged_o",
        "blanked_o",
    ]
    await bench.turn_over(dut, *counters, wraps=False)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "adc_convst_o", "out_valid_o", "dropped_o", "damaged_o", "blanked_o")


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def decides_in_time_at_the_pins(dut):
    """A pulse on the even sample of a pair, the worst case, first on channel 0 and then on the last."""
    frames = 90
    channels = dut.Channels.value.to_unsigned()
    rubber = Rubber(channels, frames)
    pulses = [(0, 40), (channels - 1, 71)]
    for channel, frame in pulses:
        rubber.codes[channel, frame] += 600
    part, channels, model, decisions, converts = await watch(dut, rubber, frames)

    acquire = Acquire(part, channels, sample_bits=dut.SampleBits.value.to_unsigned())
    found = of_codes(rubber.codes[:channels, :frames], acquire, CONFIG)
    over = found.p2p > CONFIG.threshold
    rows = [row.T.ravel() for row in (found.state, over, found.p2p)]
    expected = [(n % channels, *(int(row[n]) for row in rows)) for n in range(len(decisions))]
    assert [decision[1:] for decision in decisions] == expected
    assert over.any(axis=1).sum() == len({channel for channel, _ in pulses})

    for channel, frame in pulses:
        if part is MCP3208:
            sampled = [time for c, _, time in model.conversions if c == channel][frame]
        else:
            sampled = converts[frame]
        over = [time for time, which, _, over, _ in decisions if which == channel and over]
        flagged = next(time for time in over if time > sampled)
        dut._log.info(f"channel {channel}: decision {(flagged - sampled) / 1000:.2f} us after its sample")
        assert flagged - sampled <= 200_000 + 1_000
    intervals = np.diff([round(1000 * time) for time in converts])  # whole picoseconds
    assert (intervals == round(1e12 / RATE_HZ)).all()


SMALLEST = {
    "Adc": 1,
    "Channels": 1,
    "ClkKhz": 16_000,
    "SclkKhz": 2_000,
    "SampleBits": 13,
    "Serial": 1,
    "TimerBits": 10,
    "AdcPeriod": 1_600,
}


@pytest.mark.parametrize(
    "part, parameters",
    [
        (MCP3208, {"Adc": 1, "Channels": 1, "ClkKhz": 8_000, "SclkKhz": 2_000}),
        (
            MCP3208,
            {"Adc": 1, "Channels": 1, "ClkKhz": 8_000, "SclkKhz": 2_000, "SampleBits": 13, "Serial": 1},
        ),
        (MCP3208, SMALLEST),
        (MCP3208, {"Adc": 1, "Channels": 8, "ClkKhz": 16_000, "SclkKhz": 2_000}),
        (AD7606, {"Adc": 2, "Channels": 8, "ClkKhz": 16_000, "SclkKhz": 8_000, "AdcLanes": 2}),
    ],
)
def test_channels(part, parameters):
    AdcSpi(part, parameters["Channels"], parameters.get("AdcLanes", 1), parameters["ClkKhz"])
    bench.run("slip", "channels", parameters)
    bench.run("frontend", "channels", parameters, "each_counter", "test_acquire")


def test_tags():
    parameters = {"Adc": 5, "Channels": 2, "ClkKhz": 32_000, "SclkKhz": 8_000}
    bench.run("frontend", "channels", parameters, "each_counter", "test_acquire")


@pytest.mark.parametrize(
    "parameters",
    [
        {"Channels": 1, "Serial": 1},
        {"Channels": 5, "Hop": 2},
        {"Channels": 3, "Window": 16, "Hop": 16, "Mask": 1},
    ],
)
def test_channels_of_a_stream(parameters):
    bench.run("slip", "channels", {"Adc": 0} | parameters, module="test_slip_path")


def test_refuses_a_mask_of_a_converters_samples():
    assert "Mask = 1" in bench.refuses("channels", {"Adc": 2, "Mask": 1})
    codes = np.zeros((1, 64), dtype=int)
    with pytest.raises(ValueError, match="a mask must go with a stream"):
        of_codes(codes, Acquire(MCP3208), CONFIG, mask=codes > 0)
