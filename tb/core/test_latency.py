"""msn_core from the pins of a real converter to each decision on its port, with part models that check their
timing: the decisions are the twin's for the codes that the part converted, each within 0.2 ms + 1 us of the
sample that crosses the threshold, on the first channel and on the last, at 10 kHz. A long period is long."""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
import members
from core import pins
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.frontend.adc_spi import AD7606, MCP3208, PARTS
from meissner.twins.link.registers import RESET_BITS, reset_word
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip_path import decide
from parts import ad7606, mcp3208

RATE_HZ, FRAMES = 10_000, 90
SETTINGS = {"threshold": 300, "gross_threshold": 900, "keep_threshold": 150, "hold": 4, "blank": 3}
SETTINGS |= {"contact_level": 600, "release_level": 500}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


async def begin(dut, code):
    """Reset, with the part at the pins; returns the part."""
    idle = {"actuator_moving_i": 0, "in_valid_i": 0, "rx_i": 1, "bus_valid_i": 0, "out_ready_i": 1}
    for port, value in (idle | {"adc_miso_i": 0, "adc_busy_i": 0, "rst_i": 1}).items():
        getattr(dut, port).value = value
    Clock(dut.clk_i, 1_000_000_000 // number(dut, "ClkKhz"), unit="ps").start()
    await bench.clocks(dut, 3)
    lines = [dut.adc_cs_n_o, dut.adc_sclk_o]
    if PARTS[number(dut, "Adc")] is MCP3208:
        part = mcp3208.Mcp3208(*lines, dut.adc_mosi_o, dut.adc_miso_i, code)
    else:
        part = ad7606.Ad7606(*lines, dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, code)
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    return part


def expected_of(codes, acquire):
    """The decisions on the ports, detail by detail and channel by channel: (verdict, decision)."""
    config, last = SlipConfig(**SETTINGS), len(codes) - 1
    found = decide(acquire.samples(codes)[0], config)
    return [
        (
            {"valid": 1, "over": int(found.p2p[c, n] > config.threshold), "last": int(found.end[n]), "id": c},
            {
                "raised": int(found.raised[c, n]),
                "last": int(c == last),
                "state": int(found.state[c, n]),
                "p2p": int(found.p2p[c, n]),
                "id": c,
            },
        )
        for n in range(found.p2p.shape[1])
        for c in range(len(codes))
    ]


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def decides_in_time_at_the_pins(dut):
    """A pulse on the even sample of a pair (the worst case), first on channel 0, then on the last channel."""
    names = ("Channels", "AdcLanes", "ClkKhz", "SclkKhz", "AdcPeriod", "SampleBits")
    acquire = Acquire(PARTS[number(dut, "Adc")], *(number(dut, name) for name in names))
    channels, serial = acquire.channels, number(dut, "Serial")
    codes = 700 + np.random.default_rng(bench.SEED).integers(-3, 4, (8, FRAMES + 50))
    pulses = [(0, 40), (channels - 1, 71)]
    for channel, frame in pulses:
        codes[channel, frame] += 600
    count = [0] * 8

    def code(channel, time):
        count[channel] += 1
        return int(codes[channel, count[channel] - 1])

    part = await begin(dut, code)
    decisions, converts, period = [], [], acquire.clk_khz * 1000 // RATE_HZ
    while len(decisions) < FRAMES // 2 * channels:
        await ReadOnly()
        if dut.gen_channels.u_sensor.convert_o.value == 1:
            converts.append(get_sim_time("ps"))
        verdict = members.of("verdict", bench.read(dut.verdict_o))
        if verdict["valid"]:
            decision = members.of("decision", bench.read(dut.decision_o))
            decisions.append((get_sim_time("ps"), verdict, decision))
        await RisingEdge(dut.clk_i)
        assert len(converts) < FRAMES + 5, "decisions are missing"
    assert [found[1:] for found in decisions] == expected_of(codes[:channels, :FRAMES], acquire)
    assert set(np.diff(converts)) == {period * 1_000_000_000 // acquire.clk_khz}
    for channel, frame in pulses:
        if acquire.part is MCP3208:
            sampled = [1000 * time for c, _, time in part.conversions if c == channel][frame]
        else:
            sampled = converts[frame]
        over = [time for time, verdict, _ in decisions if verdict["id"] == channel and verdict["over"]]
        us = (next(time for time in over if time > sampled) - sampled) / 1e6
        dut._log.info(f"channel {channel}: decision {us:.2f} us after its sample")
        assert us <= 200 + 1
        if (channel, frame) == pulses[0] and not serial:  # the README's
            assert round(us) == {MCP3208: 107, AD7606: 106}[acquire.part]


@bench.applies(lambda dut: number(dut, "Registers"))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_long_period_is_long(dut):
    """For each bit of the period: one conversion, then none for long."""
    await begin(dut, lambda *_: 0)
    write = lambda name, value: pins.access(dut, True, pins.ADDRESS[name], value)
    for bit in range(12, 24):
        await write("adc.enable", 0)
        await bench.clocks(dut, 3000)
        await write("adc.period", 1 << bit)
        await write("adc.enable", 1)
        converts = 0
        for _ in range(4000):
            converts += dut.gen_channels.u_sensor.convert_o.value == 1
            await RisingEdge(dut.clk_i)
        assert converts == 1, f"period {1 << bit}"


SERIAL = {"Adc": 1, "ClkKhz": 8_000, "SclkKhz": 2_000, "SampleBits": 13, "Serial": 1}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Adc": 1, "Channels": 1, "ClkKhz": 8_000, "SclkKhz": 2_000},
        SERIAL,
        SERIAL
        | {"ClkKhz": 16_000, "TimerBits": 10, "AdcPeriod": 1_600, "SlipOnly": 1, "Registers": 0, "Uart": 1},
        {"Adc": 1, "Channels": 8, "ClkKhz": 16_000, "SclkKhz": 2_000},
        {"Adc": 2, "Channels": 8, "ClkKhz": 16_000, "SclkKhz": 8_000, "AdcLanes": 2},
    ],
)
def test_latency(parameters):
    period = parameters["ClkKhz"] * 1000 // RATE_HZ
    resets = {f"slip.{name}": value for name, value in SETTINGS.items()}
    word = reset_word(resets | {"adc.enable": 1, "adc.period": period})
    build = {"Uart": 0, "Statistics": 0, "SlipDepth": 2, "Resets": f"{RESET_BITS}'h{word:x}"}
    bench.run("core", "core", build | parameters, module="test_latency", inside=["msn_sensor_channels"])
