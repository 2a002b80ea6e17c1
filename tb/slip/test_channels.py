"""msn_channels from the pins of a real converter to the slip decision, with part models that check their
timing. The decisions must be the twin's for the codes that the part converted, each within 0.2 ms + 1 us of
the sample that crosses the threshold, on the first channel and on the last, at 10 kHz. Settings and periods
with every bit set, different for each detail and frame. The error counters, and a stream in place of a
converter, are left to the tests of the two blocks inside."""

from dataclasses import replace

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
import members
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.frontend.adc_spi import AD7606, MCP3208, PARTS, AdcSpi
from meissner.twins.slip.channels import of_codes
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.haar import haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import Slip, State
from parts import ad7606, mcp3208

RATE_HZ = 10_000
FIELDS = ("id", "state", "raised", "over", "p2p", "last", "end")
CONFIG = SlipConfig(
    threshold=300,
    gross_threshold=900,
    keep_threshold=150,
    contact_level=600,
    release_level=500,
    hold=4,
    blank=3,
)


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


class Rubber:
    """Codes per channel and conversion: pressed at 700 with a little noise; a test adds its steps to
    ``codes``."""

    def __init__(self, channels, frames):
        rng = np.random.default_rng(bench.SEED)
        self.codes = 700 + rng.integers(-3, 4, (8, frames + 50))
        self.count = [0] * 8

    def __call__(self, channel, time):
        index = self.count[channel]
        self.count[channel] += 1
        return int(self.codes[channel, index])


def put(dut, config):
    dut.cfg_i.value = members.slip_word(config)


def twin_of(dut):
    names = ("Channels", "AdcLanes", "ClkKhz", "SclkKhz", "AdcPeriod", "SampleBits", "PeriodBits")
    return Acquire(PARTS[number(dut, "Adc")], *(number(dut, name) for name in names))


async def begin(dut, code, config, period):
    """Reset, with the part at the pins, which then converts immediately; returns the part."""
    part, clk_khz = twin_of(dut).part, number(dut, "ClkKhz")
    put(dut, config)
    for name in ("rst_i", "cfg_adc_enable_i", "actuator_moving_i", "adc_miso_i", "adc_busy_i", "in_valid_i"):
        getattr(dut, name).value = int(name == "rst_i")
    dut.out_ready_i.value = 1
    dut.cfg_adc_period_i.value = period
    Clock(dut.clk_i, 1_000_000_000 // clk_khz, unit="ps").start()
    await bench.clocks(dut, 3)
    pins = [dut.adc_cs_n_o, dut.adc_sclk_o]
    if part is MCP3208:
        model = mcp3208.Mcp3208(*pins, dut.adc_mosi_o, dut.adc_miso_i, code)
    else:
        model = ad7606.Ad7606(*pins, dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, code)
    await bench.clocks(dut, 3)
    dut.rst_i.value = 0
    await bench.clocks(dut, 1 + 6 * clk_khz // 1000)
    dut.cfg_adc_enable_i.value = 1
    return model


def decision(dut):
    return tuple(bench.read(getattr(dut, f"out_{name}_o")) for name in FIELDS)


def decisions_of(channels, **fields):
    """``fields`` [channels, details] in the form that ``decision`` returns."""
    last = np.arange(channels)[:, None] == channels - 1
    rows = bench.frames(last=np.broadcast_to(last, fields["p2p"].shape), **fields)
    return [tuple(row[name] for name in FIELDS) for row in rows]


def nothing_went_wrong(dut):
    return not any(bench.read(getattr(dut, f"{n}_o")) for n in ("dropped", "overrun", "timeout", "damaged"))


async def watch(dut, rubber, frames, config=CONFIG):
    """Run ``frames`` frames through the pins; returns the part, the decisions and the times of both."""
    channels, period = number(dut, "Channels"), number(dut, "ClkKhz") * 1000 // RATE_HZ
    model = await begin(dut, rubber, config, period)
    decisions, converts = [], []
    clock = 0
    while len(decisions) < frames // 2 * channels:
        assert clock < (frames + 5) * period, "decisions are missing"
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(get_sim_time("ns"))
        if dut.out_valid_o.value == 1:
            decisions.append((get_sim_time("ns"), *decision(dut)))
        await RisingEdge(dut.clk_i)
        clock += 1
    assert nothing_went_wrong(dut)
    return model, decisions, converts


@bench.starts_known
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
    """A pulse on the even sample of a pair (the worst case), first on channel 0, then on the last channel."""
    frames = 90
    acquire = twin_of(dut)
    channels = acquire.channels
    rubber = Rubber(channels, frames)
    pulses = [(0, 40), (channels - 1, 71)]
    for channel, frame in pulses:
        rubber.codes[channel, frame] += 600
    model, decisions, converts = await watch(dut, rubber, frames)
    found = of_codes(rubber.codes[:channels, :frames], acquire, CONFIG)
    over = found.p2p > CONFIG.threshold
    ends = np.broadcast_to(found.end, found.p2p.shape)
    fields = {"state": found.state, "raised": found.raised, "over": over, "p2p": found.p2p, "end": ends}
    expected = decisions_of(channels, **fields)[: len(decisions)]
    assert [decision[1:] for decision in decisions] == expected
    assert over.any(axis=1).sum() == len({channel for channel, _ in pulses})

    for channel, frame in pulses:
        if acquire.part is MCP3208:
            sampled = [time for c, _, time in model.conversions if c == channel][frame]
        else:
            sampled = converts[frame]
        over = [time for time, which, _, _, over, *_ in decisions if which == channel and over]
        flagged = next(time for time in over if time > sampled)
        us = (flagged - sampled) / 1000
        dut._log.info(f"channel {channel}: decision {us:.2f} us after its sample")
        assert us <= 200 + 1
        if (channel, frame) == pulses[0] and not number(dut, "Serial"):  # the README's
            assert round(us) == {MCP3208: 107, AD7606: 106}[acquire.part]
    intervals = np.diff([round(1000 * time) for time in converts])  # integer picoseconds
    assert (intervals == round(1e12 / RATE_HZ)).all()


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def is_blank_as_long_as_is_set(dut):
    """Pressed from the first detail on, over from the second: raised after the three that are blanked. The
    other times differ from the blank time."""
    rubber = Rubber(number(dut, "Channels"), 24)
    rubber.codes[0, 2] += 600
    _, decisions, _ = await watch(dut, rubber, 24, replace(CONFIG, hold=7, refractory=5, blank=3))
    of_first = [(state, over) for _, which, state, _, over, *_ in decisions if which == 0]
    assert of_first == [(State.CONTACT, 0)] + [(State.CONTACT, 1)] * 3 + [(State.INCIPIENT, 1)] * 8
    assert {state for _, which, state, *_ in decisions if which} <= {State.CONTACT}


def settings_of_any_bit(rng, p2p, total, bits, timer_bits):
    """Settings for one detail: close to a channel's values, or with a single bit set; half of them never
    release.

    ``p2p``, ``total``: the values of each channel in that detail.
    """
    bit = lambda: 1 << int(rng.integers(bits))
    near = lambda values: int(rng.choice(values)) - int(rng.integers(2))
    alone, rises = lambda: rng.random() < 0.25, rng.random() < 0.5
    thresholds = ("threshold", "gross_threshold", "keep_threshold")
    levels = {name: bit() if alone() else max(0, near(p2p)) for name in thresholds}
    for name in ("contact_level", "release_level"):
        levels[name] = bench.as_signed(bit(), bits) if alone() else near(total + 1)
    if rng.random() < 0.5:
        levels["release_level"] = bench.width(bits)[not rises]
    times = {
        name: int(rng.random() < some) << int(rng.integers(timer_bits))
        for name, some in (("hold", 0.25), ("refractory", 0.5), ("blank", 0.25))
    }
    return SlipConfig(contact_rises=rises, **levels, **times)


class Details:
    """Codes of all sizes, settings that change with each detail, and the twins' decisions, [channels,
    details]."""

    def __init__(self, acquire, window, level, sizes, count, serial):
        rng, group, bits = np.random.default_rng(bench.SEED), 1 << level, acquire.part.data_bits
        shape = acquire.channels, count * group
        size = np.repeat(rng.integers(0, bits, (shape[0], shape[1] // window + 1)), window, axis=1)
        middle = 0 if acquire.part.signed else 1 << bits - 1
        tremor = rng.integers(-1 << size, 1 << size)[:, : shape[1]]
        self.codes = (middle + tremor) % (1 << bits)
        detail, total = haar(acquire.samples(self.codes)[0], level)
        p2p, end = PeakToPeak(len(detail), window // group, window // group).process(detail)
        self.settings = [settings_of_any_bit(rng, p2p[:, n], total[:, n], *sizes) for n in range(count)]
        if serial:  # it starts its timers with the next detail, so times do not change
            self.settings = [replace(config, hold=3, refractory=2, blank=1) for config in self.settings]
        self.moving = (rng.random(count) < 0.1) & (np.arange(count) > 0)
        twin, state = Slip(len(detail), None), np.empty_like(p2p)
        for n, twin.config in enumerate(self.settings):
            state[:, n : n + 1] = twin.next(p2p[:, n : n + 1], total[:, n : n + 1], self.moving[n : n + 1])
        slips = np.isin(state, (State.INCIPIENT, State.GROSS))
        raised = slips & ~np.pad(slips, ((0, 0), (1, 0)))[:, :-1]
        over = p2p > [config.threshold for config in self.settings]
        ends = np.broadcast_to(end, p2p.shape)
        fields = {"state": state, "raised": raised, "over": over, "p2p": p2p, "end": ends}
        self.decisions, self.blanked = decisions_of(len(p2p), **fields), twin.blanked
        self.shown = [0] * len(p2p)

    def code(self, channel, _):
        """What a part's input is at its next conversion; after the last code it stays there."""
        if channel >= len(self.shown):
            return 0
        self.shown[channel] += 1
        return int(self.codes[channel, min(self.shown[channel], self.codes.shape[1]) - 1])


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def each_detail_has_settings_of_its_own(dut):
    """Close to the values they are compared with, and with each bit alone; each frame has its own period."""
    acquire = twin_of(dut)
    sizes = number(dut, "SampleBits") + number(dut, "Level"), number(dut, "TimerBits")
    channels, serial = acquire.channels, number(dut, "Serial")
    least = acquire.adc_period or acquire.adc.safe_period() + 70 * serial
    count = min(300, 50_000 // (3 * least))
    told = Details(acquire, number(dut, "Window"), number(dut, "Level"), sizes, count, serial)
    rng = np.random.default_rng(bench.SEED)
    periods = least + rng.integers(0, least, told.codes.shape[1] + 10)
    await begin(dut, told.code, told.settings[0], int(periods[0]))
    found, converts, clock = [], [], 0
    while len(found) < len(told.decisions):
        await ReadOnly()
        converted, decided = dut.convert_o.value == 1, dut.out_valid_o.value == 1
        if converted:
            converts.append(clock)
        if decided:
            found.append(decision(dut))
        await RisingEdge(dut.clk_i)
        if converted:
            dut.cfg_adc_period_i.value = int(periods[len(converts)])
        if decided and len(found) % channels == 0 and len(found) < len(told.decisions):
            put(dut, told.settings[len(found) // channels])
            dut.actuator_moving_i.value = int(told.moving[len(found) // channels])
        clock += 1
        assert clock < 3 * least * (len(converts) + 2), "a frame is missing"
    assert found == told.decisions
    if not acquire.adc_period:
        assert np.diff(converts).tolist() == periods[: len(converts) - 1].tolist()
    assert nothing_went_wrong(dut)
    await RisingEdge(dut.clk_i)
    assert bench.read(dut.blanked_o) == told.blanked


@bench.applies(lambda dut: not number(dut, "AdcPeriod"))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_long_period_is_long(dut):
    """For each period bit above those that the frames use: one conversion, then none for long."""
    acquire = twin_of(dut)
    least = acquire.adc.safe_period()
    await begin(dut, lambda *_: 0, CONFIG, 0)
    for bit in range((2 * least).bit_length(), acquire.period_bits):
        dut.cfg_adc_enable_i.value = 0
        await bench.clocks(dut, 2 * least)
        dut.cfg_adc_enable_i.value, dut.cfg_adc_period_i.value = 1, (1 << bit) + least
        converts = 0
        for _ in range(least + 20):
            await ReadOnly()
            converts += dut.convert_o.value == 1
            await RisingEdge(dut.clk_i)
        assert converts == 1, f"period {(1 << bit) + least}"


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


EVIDENCE = {
    "equivalence": {
        "size": {"Channels": 3},
        "reset_size": {"Channels": 1},
        "boxes": True,
        "open": ["reset"],
        "reset": {"qualifiers": {"adc_mosi_o": "!adc_cs_n_o"}},
    },
    "faults": {
        "size": {"Adc": 1, "Channels": 8},
        "short": {"Channels": 2, "Window": 4, "Hop": 4, "TimerBits": 3},
        "settle": 28,
        # Some channels are in contact, some are not.
        "driver": {
            "free": 60000,
            "part": 1,
            "late": "left_q",
            "set": "cfg_adc_period_i:160 slip.contact_level:d0 slip.release_level:c0",
        },
    },
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
    bench.run("slip", "channels", {"Adc": 0} | parameters, module="no_converter")


def test_refuses_a_mask_of_a_converters_samples():
    assert "Mask = 1" in bench.refuses("channels", {"Adc": 2, "Mask": 1})
    codes = np.zeros((1, 64), dtype=int)
    with pytest.raises(ValueError, match="a mask must go with a stream"):
        of_codes(codes, Acquire(MCP3208), CONFIG, mask=codes > 0)
