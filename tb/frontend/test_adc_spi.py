"""msn_adc_spi on models of the parts that check their own timing.

Every build runs the same tests: codes (corners of every bit, then random) against the twin, with a follower
that is ready, stalls, or sleeps for frames; convert starts exactly on the grid throughout; complete frames,
and each tick accounted for; latencies and the shortest period exactly those of the twin; enable, reset and
changed periods. The AD7606 builds also lose BUSY, the MAX1112x builds their setup and the right channel
numbers; some builds are started by triggers. Then each limit of the part models is tightened, to show that it
is checked: a broken limit fails the test.
"""

import random
from dataclasses import replace
from itertools import pairwise

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
from harness.refusals import refusals
from meissner.twins.frontend.adc_spi import AD7606, AD7606C, MAX11123, MAX11131, MCP3208, PARTS, AdcSpi
from parts import ad7606, ad7606c, max1112x, mcp3208
from parts.timing import TimingViolation, tightened

MCP_RULES = ["t_clk", "t_hi", "t_lo", "t_sucs", "t_csh", "t_su", "t_hd", "t_droop_max"]
MAX_RULES = ["t_cp", "t_cp_max", "t_ch", "t_cl", "t_css", "t_csw", "t_acq", "t_ds", "t_dh"]
AD_RULES = ["t_cycle", "t_convst_low", "t_convst_high", "t_busy_cs", "t_cs_busy", "t_sclk", "t_sclk_low"]
AD_RULES += ["t_sclk_high"]


RULES = {
    "mcp3208": (mcp3208.Limits(), MCP_RULES),
    "max11131": (max1112x.FAST, MAX_RULES),
    "ad7606c-16": (ad7606c.Limits(), [*AD_RULES, "t_csh", "t_css", "t_ds"]),
}


def limits_and_rules(dut):
    """Above 14.5 MHz, the limits of an AD7606 are those of a VDRIVE of 3.3 V or more."""
    part, fast = PARTS[dut.Part.value.to_unsigned()], dut.SclkKhz.value.to_unsigned() > 14_500
    if part is AD7606:
        return ad7606.Limits(**{"t_sclk": 1e6 / 17_000} if fast else {}), AD_RULES
    return RULES.get(part.name, (max1112x.Limits(), MAX_RULES))


def any_cycle(dut):
    """Limits of a part that may convert again at once; None for a part without a shortest cycle."""
    part = PARTS[dut.Part.value.to_unsigned()]
    return replace(limits_and_rules(dut)[0], t_cycle=0) if part.has_busy else None


def between_edges(dut):
    """A conversion in ns that ends between two clock edges of every build."""
    return 3503 if dut.Part.value.to_unsigned() == AD7606.number else 603


class Codes:
    """The code of a channel at its n-th conversion: corners first, in different order on each channel, then
    random."""

    def __init__(self, bits):
        top = (1 << bits) - 1
        ones = [1 << bit for bit in range(bits)]
        self.corners = [0, top, top >> 1, (top >> 1) + 1, 0x5555 & top, 0xAAAA & top, 1, top - 1]
        self.corners += ones + [top ^ one for one in ones]
        self.top = top
        self.draw = random.Random(bench.SEED)
        self.count = [0] * 8

    def __call__(self, channel, time):
        index = self.count[channel]
        self.count[channel] += 1
        if index < len(self.corners):
            return self.corners[(index + channel) % len(self.corners)]
        return self.draw.randint(0, self.top)


class Harness:
    """The master, its part, and a record of all events by clock."""

    def __init__(self, dut, limits=None, report=None, conversion_ns=None, upset=False):
        self.dut, self.upset = dut, upset
        value = lambda name: getattr(dut, name).value.to_unsigned()
        self.twin = AdcSpi(
            PARTS[value("Part")],
            *(value(name) for name in ("Channels", "Lanes", "ClkKhz", "SclkKhz", "SampleBits", "PeriodBits")),
            read_during=bool(value("ReadDuring")),
        )
        limits = limits or limits_and_rules(dut)[0]
        pins = [dut.adc_cs_n_o, dut.adc_sclk_o]
        codes = Codes(self.twin.part.data_bits)
        for name in ["rst", "cfg_enable", "trigger", "out_ready", "adc_miso", "adc_busy", "wait", "clk"]:
            getattr(dut, f"{name}_i").value = int(name == "rst")
        dut.cfg_period_i.value = 1
        if self.twin.part is MCP3208:
            make = lambda: mcp3208.Mcp3208(*pins, dut.adc_mosi_o, dut.adc_miso_i, codes, limits, report)
        elif self.twin.part.tagged:
            pins += [dut.adc_mosi_o, dut.adc_miso_i, self.twin.part.data_bits]
            make = lambda: max1112x.Max1112x(*pins, codes, limits, report)
        else:
            pins += [dut.adc_mosi_o] * bool(self.twin.part.setup)
            pins += [dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o]
            model = ad7606c.Ad7606c if self.twin.part.setup else ad7606.Ad7606
            make = lambda: model(*pins, codes, limits, report, conversion_ns)
        self.make = make
        self.clock = -1
        self.converts = []  # clocks of convert_o
        self.times = []  # the same times in ns
        self.reads = []  # clocks of read_o
        self.losses = []  # clocks of lost_o
        self.busy_low = []  # clocks at whose end BUSY had fallen
        self.beats = []  # (clock, data, id, last, user) taken
        self.offered = []  # clocks in which a sample was first offered
        self.held = None
        self.stall = lambda: False

    async def start(self, period=None):
        dut = self.dut
        Clock(dut.clk_i, 1_000_000_000 // self.twin.clk_khz, unit="ps").start()
        await bench.clocks(dut, 3)
        self.part = self.make()
        if self.twin.part is MCP3208 and not self.upset:
            cocotb.start_soon(self.hear_commands())
        await bench.clocks(dut, 3)
        dut.rst_i.value = 0
        self.period = period or self.twin.safe_period() + 13
        dut.cfg_period_i.value = self.period
        await self.rest()
        dut.cfg_enable_i.value = 1

    async def hear_commands(self):
        """Check that every word on MOSI is the command of a channel, also words that the part ignores."""
        dut, part = self.dut, self.twin.part
        known = [f"{part.command(channel):016b}"[: part.data_bits] for channel in range(self.twin.channels)]
        cs_n, mosi, heard = dut.adc_cs_n_o, dut.adc_mosi_o, ""

        async def bits():  # one permanent task: First would create three per bit
            nonlocal heard
            while True:
                await RisingEdge(dut.adc_sclk_o)
                heard += "" if bench.read(cs_n) else str(mosi.value)

        cocotb.start_soon(bits())
        while True:
            await FallingEdge(cs_n)
            heard = ""
            await RisingEdge(cs_n)
            heard += str(mosi.value)
            assert len(heard) <= part.word_bits or heard[: part.data_bits] in known

    async def rest(self):
        """Wait from the end of reset until the part can convert, at least 6 us."""
        await bench.clocks(self.dut, 1 + max(6 * self.twin.clk_khz // 1000, self.twin.start_clocks()))

    async def run(self, clocks):
        """Let ``clocks`` pass and watch. Returns just after a rising clock edge."""
        dut, edge, settled = self.dut, RisingEdge(self.dut.clk_i), ReadOnly()
        put_ready, has_busy = bench.putter(dut.out_ready_i), self.twin.part.has_busy
        convert, convst, cs_n, lost = dut.convert_o, dut.adc_convst_o, dut.adc_cs_n_o, dut.lost_o
        read = dut.read_o
        out_valid, tagged = dut.out_valid_o, (dut.out_id_o, dut.out_last_o, dut.out_user_o)
        busy = 0
        for _ in range(clocks):
            self.clock += 1
            ready = not self.stall()
            put_ready(ready)
            await settled
            if bench.high(convert):
                self.converts.append(self.clock)
                self.times.append(get_sim_time("ps") / 1000)
                launched = bench.high(convst) if has_busy else cs_n.value == 0
                assert launched or self.upset, "convert_o without a conversion"
            assert has_busy or bench.read(convst) == 0, "CONVST of a part that has none"
            if bench.high(read):
                self.reads.append(self.clock)
                assert self.upset or not bench.read(cs_n), "read_o without a read"
            if bench.high(lost):
                self.losses.append(self.clock)
            valid = bench.high(out_valid)
            assert valid or self.held is None, "valid was withdrawn while stalled"
            if valid:
                beat = (
                    bench.as_signed(bench.read(dut.out_data_o), self.twin.sample_bits),
                    *(bench.read(port) for port in tagged),
                )
                assert self.held in (None, beat), f"payload changed while stalled: {self.held} -> {beat}"
                if self.held is None:
                    self.offered.append(self.clock)
                self.held = None if ready else beat
                if ready:
                    self.beats.append((self.clock, *beat))
            await edge
            if has_busy:
                level = bench.read(dut.adc_busy_i)
                if busy and not level:
                    self.busy_low.append(self.clock)
                busy = level

    async def frames(self, count):
        """Watch ``count`` periods, then the end of the last frame."""
        await self.run(count * self.period)

    async def stop(self):
        """Disable new frames and drain."""
        self.dut.cfg_enable_i.value = 0
        self.stall = lambda: False
        await self.run(self.twin.safe_period() + self.twin.watch_clocks + 20)

    def counters(self):
        names = ("dropped_o", "overrun_o", "timeout_o", "mistagged_o")
        return tuple(getattr(self.dut, name).value.to_unsigned() for name in names)

    def converted(self):
        """The codes of each conversion, by frame, as the part gave them."""
        channels = self.twin.channels
        if self.twin.part.has_busy:
            return [codes[:channels] for codes in self.part.frames]
        log = self.part.conversions
        if self.twin.part.tagged:  # a frame's first word only asks; its answer is to an earlier word
            begins = [next(n for n, entry in enumerate(log) if entry[2] >= time) for time in self.times]
            log = [entry for begin in begins for entry in log[begin + 1 : begin + 1 + channels]]
        assert [channel for channel, _, _ in log] == [n % channels for n in range(len(log))]
        return [[code for _, code, _ in log[n : n + channels]] for n in range(0, len(log), channels)]

    def check(self, lost=()):
        """Every frame came out complete and right, or was dropped because one was waiting; returns the number
        dropped.

        ``lost``: numbers of the frames that timed out or had a wrong tag.
        """
        channels = self.twin.channels
        frames = self.converted()
        assert len(frames) == len(self.converts)
        assert len(self.beats) % channels == 0, "a frame is not whole"
        taken = [self.beats[n : n + channels] for n in range(0, len(self.beats), channels)]
        kept = dropped = 0
        assert len(self.reads) == len(frames) - len(lost) * self.twin.part.has_busy
        reads = iter(self.reads)
        for number, (begin, codes) in enumerate(zip(self.converts, frames)):
            # The frame starts a clock before convert_o (read_o); a sample taken up to then has made room.
            if self.twin.read_during:
                begin = 0 if number in lost else next(reads)
            waiting = kept and taken[kept - 1][-1][0] > begin - 1
            if waiting:
                dropped += number not in lost
                continue
            if number in lost:
                continue
            assert kept < len(taken), f"frame {number} is missing"
            data, over = self.twin.samples(codes)
            last = [channel == channels - 1 for channel in range(channels)]
            expected = [(*row,) for row in zip(data.tolist(), range(channels), last, over.tolist())]
            assert [beat[1:] for beat in taken[kept]] == expected, f"frame {number} of codes {codes}"
            kept += 1
        assert kept == len(taken), "more frames came out than went in"
        assert self.counters()[0] == dropped
        assert self.counters()[2] + self.counters()[3] == len(lost)
        # With ticks a few clocks apart, an overrun and the bad end of a frame may share one strobe.
        assert len(self.losses) == sum(self.counters()) or self.counters()[1]
        assert self.dut.over_range_o.value.to_unsigned() == sum(beat[4] for beat in self.beats)
        return dropped

    def on_grid(self, clocks=None):
        """Every interval between convert starts is exactly a period."""
        clocks = clocks or self.converts
        assert len(clocks) > 1
        intervals = {b - a for a, b in pairwise(clocks)}
        assert intervals == {self.period}, f"convert starts {intervals} apart, not {self.period}"


def sleepy(draw, clocks):
    """A stall pattern: ready for up to ``clocks``, then stalled for up to ``clocks``, and so on."""
    state = {"left": 0, "stalled": True}

    def stall():
        if state["left"] == 0:
            state["stalled"] = not state["stalled"]
            state["left"] = draw.randint(1, clocks)
        state["left"] -= 1
        return state["stalled"]

    return stall


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    """Ticks before any reset, in an undefined state: each counts as an overrun."""
    inputs = {"cfg_period_i": 9, "adc_miso_i": 0, "adc_busy_i": 0, "wait_i": 0}
    wiggled = ["cfg_enable_i", "trigger_i", "out_ready_i"]
    part = PARTS[dut.Part.value.to_unsigned()]
    still = ["dropped_o", *["timeout_o"] * part.has_busy, *["mistagged_o"] * part.tagged]
    counters = ("over_range_o", "overrun_o")
    await bench.turn_over(dut, *counters, wiggled=wiggled, still=still, again=False, **inputs)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """Frames that nobody takes; ticks without a pause; a BUSY that never rises, or rises and falls; answers
    with the wrong channel's number."""
    part, often = PARTS[dut.Part.value.to_unsigned()], {"span": 20_000}
    inputs = {"cfg_period_i": 1, "trigger_i": 1, "adc_busy_i": 0, "out_ready_i": 0, "wait_i": 0}
    await bench.start(dut, cfg_enable_i=1, adc_miso_i=(1 << len(dut.adc_miso_i)) - 1, **inputs)
    while not bench.high(dut.ready_o):
        await RisingEdge(dut.clk_i)
    await bench.counts_on(dut, "overrun_o", **often)
    if part.has_busy:
        await bench.counts_on(dut, "timeout_o", **often)
    wiggled = ["adc_busy_i"] * part.has_busy
    await bench.counts_on(dut, "mistagged_o" if part.tagged else "dropped_o", wiggled=wiggled, **often)
    await bench.counts_on(dut, "over_range_o", strobe="over_q")


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(consumer=["ready", "stalls", "sleeps"])
async def every_code_arrives_on_the_grid(dut, consumer):
    harness = Harness(dut)
    await harness.start()
    draw = random.Random(bench.SEED)
    harness.stall = {
        "ready": lambda: False,
        "stalls": lambda: draw.random() < 0.7,
        "sleeps": sleepy(draw, 3 * harness.period),
    }[consumer]
    count = 60 if consumer == "ready" else 30
    await harness.frames(count)
    harness.on_grid()
    assert len(harness.converts) == count
    await harness.stop()
    dropped = harness.check()
    if consumer != "stalls":  # stalls can drop a frame: two lanes leave little time before the next one
        assert (dropped > 0) == (consumer == "sleeps"), f"{dropped} dropped"
    assert harness.counters()[1:] == (0, 0, 0)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def drops_whole_frames_around_every_clock_of_a_start(dut):
    """The last sample is taken just before, in, or just after the clock in which the next frame starts."""
    harness = Harness(dut, conversion_ns=between_edges(dut))
    await harness.start()
    period, ticks = harness.period, 4
    for offset in range(-3, 4):
        # A tick is one clock before convert_o, a read one before read_o: find the grid, then let the follower
        # wake around the coming one.
        harness.stall = lambda: False
        await harness.run(2 * period)
        tick = (harness.reads if harness.twin.read_during else harness.converts)[-1] - 1 + ticks * period
        opens = tick + offset - (harness.twin.channels - 1)  # the last sample leaves at tick + offset
        harness.stall = lambda opens=opens: harness.clock < opens
        await harness.run(tick + 2 * period - harness.clock)
    await harness.stop()
    assert harness.check() > 0
    harness.on_grid()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def latency_is_the_twins(dut):
    harness = Harness(dut)
    await harness.start()
    await harness.frames(5)
    await harness.stop()
    origins = harness.busy_low if harness.twin.part.has_busy else harness.converts
    assert len(origins) == len(harness.converts) == 5
    expected = [origin + clocks for origin in origins for clocks in harness.twin.latencies()]
    assert [beat[0] for beat in harness.beats] == expected


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(short=[0, 1])
async def shortest_period_is_the_twins(dut, short):
    """At the twin's minimum nothing is lost; with a clock less, every second tick or frame is lost and
    counted."""
    ns = 4017.3 if dut.Part.value.to_unsigned() == AD7606.number else 617.3
    harness = Harness(dut, limits=any_cycle(dut), conversion_ns=ns)
    await harness.start(harness.twin.minimum_period(ns) - short)
    await harness.frames(12)
    clocks = harness.converts[:]
    dropped, overrun, *_ = harness.counters()
    # With two lanes samples may still leave when the transfer is over: then frames are lost instead of ticks.
    harness.period *= 2 if overrun else 1
    harness.on_grid(clocks)
    assert len(clocks) + overrun == 12
    assert abs(dropped + overrun - 6 * short) <= (short if dropped else 0)
    assert not (dropped and overrun)
    await harness.stop()
    harness.check()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def every_bit_of_a_period_is_waited_for(dut):
    """A tick that came too early would fall within the running frame and count as an overrun."""
    harness = Harness(dut)
    await harness.start()
    await harness.stop()
    before = len(harness.converts)
    bits = range(harness.twin.safe_period().bit_length(), harness.twin.period_bits)
    for bit in bits:
        dut.cfg_period_i.value = (1 << bit) + 1  # the remaining count then has only this bit
        dut.cfg_enable_i.value = 1
        await harness.run(8)
        await harness.stop()
    assert harness.counters()[1] == 0
    assert len(harness.converts) == before + len(bits)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_very_short_period_only_loses_ticks(dut):
    """Ticks every 3 clocks: conversions stay on the grid of 3, frames stay right, the other ticks are
    counted."""
    harness = Harness(dut, limits=any_cycle(dut))
    await harness.start(3)
    clocks = 6 * harness.twin.safe_period() // 3 * 3
    await harness.run(clocks)
    overrun = harness.counters()[1]
    converts = len(harness.converts)
    assert {(b - harness.converts[0]) % 3 for b in harness.converts} == {0}
    assert abs(clocks // 3 - converts - overrun) <= 1
    assert converts >= 6
    await harness.stop()
    dropped = harness.check()
    # A tick may come before all samples that arrived together have left.
    assert dropped == 0 or harness.twin.lanes > 1 or harness.twin.part.tagged


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def enable_ends_after_a_whole_frame_and_starts_at_once(dut):
    harness = Harness(dut)
    await harness.start()
    draw = random.Random(bench.SEED)
    for _ in range(6):
        await harness.run(draw.randint(1, 2 * harness.period))
        dut.cfg_enable_i.value = 0
        await harness.run(1)
        before = len(harness.converts)
        await harness.run(2 * harness.period + draw.randint(0, 50))
        assert len(harness.converts) == before, "converted while off"
        dut.cfg_enable_i.value = 1
        start = harness.clock + 1  # the first clock with enable
        await harness.run(3)
        assert harness.converts[-1] == start + 1
    await harness.frames(2)
    await harness.stop()
    assert harness.check() == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_new_period_holds_from_the_next_tick(dut):
    harness = Harness(dut)
    await harness.start()
    periods = [harness.period + extra for extra in (0, 100, 1, 7)]
    for period in periods[1:]:
        await harness.run(periods[0] // 2)
        dut.cfg_period_i.value = period
        while len(harness.converts) < 1 + periods.index(period):
            await harness.run(1)
    await harness.run(2 * harness.period)
    intervals = [b - a for a, b in pairwise(harness.converts)]
    assert intervals[: len(periods)] == periods
    await harness.stop()
    assert harness.check() == 0


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def goes_on_after_an_upset(dut):
    """In any clock of a frame, of the state (also to codes that no state has), of the shifter and more:
    every tick gives a complete frame or a loss, and a period later the frames are right and in time."""
    reports, draw = [], random.Random(bench.SEED)
    harness = Harness(dut, report=reports.append, upset=True)
    part, channels = harness.twin.part, harness.twin.channels
    await harness.start(harness.twin.safe_period() + 13 + len(part.setup) * part.cs_clocks(harness.twin.half))
    during = harness.twin.read_during
    if during:  # each stretch begins between the samples of two frames, while the second is converted
        await harness.run(harness.twin.busy_least + 4)
    upsets = [(dut.state_q, code) for code in range(8)]
    upsets += [(each, level) for each in (dut.open_q, dut.bad_q) for level in (0, 1)]
    upsets += [(each, (1 << len(each)) - 1) for each in (dut.word_q, dut.drop_q)]
    if hasattr(dut, "u_shift"):
        upsets += [(each, level) for each in (dut.u_shift.run_o, dut.u_shift.spi_cs_n_o) for level in (0, 1)]
    for register, value in upsets:
        for at in (draw.randrange(3), draw.randrange(3, harness.period)):
            sent, lost = len(harness.beats), len(harness.losses)
            risen = part.has_busy and harness.part.reset_rose
            await harness.run(at)
            register.value = value
            ends = (register._name, value) == ("run_o", 0)  # the frame, and nothing after it
            await harness.run((1 if ends else 2) * harness.period - at)
            what = register._name, value, at
            ids, lost = [beat[2] for beat in harness.beats[sent:]], len(harness.losses) - lost
            starts = [n for n, channel in enumerate(ids) if channel == 0]
            pieces = [ids[start:end] for start, end in pairwise([*starts, len(ids)])]
            whole = pieces.count([*range(channels)])
            # A part's long reset loses the tick in the stretch's last clocks, too, and at once.
            resets = during and bool(part.setup) and harness.part.reset_rose != risen
            if register._name in ("state_q", "run_o"):
                assert whole + lost == 2 - ends + resets, what
                # The words of a plain part go on.
                assert not (part is MCP3208 and register is dut.state_q and value > 1 and at and lost), what
            # A setup in mid-frame ends one whose samples leave one by one.
            cut = register is not dut.state_q or (value == 1 and part.has_busy and part.setup)
            assert len(pieces) == whole or cut, what
            if register is dut.state_q and value == 0:  # Reset: the part is reset and set up as after rst_i
                await harness.run(-(-harness.twin.start_clocks() // harness.period) * harness.period)
            reports.clear()
            sent = len(harness.beats)
            await harness.run(harness.period)
            assert not reports, (what, reports)
            if part.has_busy:
                codes = harness.part.frames[-1 - during][:channels]
            else:
                codes = [code for _, code, _ in harness.part.conversions[-channels:]]
            data, _ = harness.twin.samples(codes)
            expected = list(zip(data.tolist(), range(channels)))
            assert [beat[1:3] for beat in harness.beats[sent:]] == expected, what


@bench.applies(lambda dut: dut.Channels.value.to_unsigned() == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_long_period_brings_one_frame(dut):
    """Periods with every second bit, the others, and all bits: one frame, and the next when enabled again."""
    harness = Harness(dut)
    await harness.start()
    await harness.stop()
    for ones in (0x5555_5555, 0xAAAA_AAAA, 0xFFFF_FFFF):
        dut.cfg_period_i.value = ones & (1 << harness.twin.period_bits) - 1
        dut.cfg_enable_i.value = 1
        before = len(harness.converts)
        await harness.run(3 * harness.twin.safe_period())
        assert len(harness.converts) == before + 1
        await harness.stop()
    assert harness.check() == 0


# 2^24 clocks would take minutes, so only builds with few bits run this.
@bench.applies(lambda dut: dut.PeriodBits.value.to_unsigned() <= 16)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def period_0_is_the_longest(dut):
    harness = Harness(dut)
    await harness.start()
    harness.period = 1 << harness.twin.period_bits
    dut.cfg_period_i.value = 0
    await harness.run(2 * harness.period)
    harness.on_grid()


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(moment=range(5))
async def recovers_after_reset(dut, moment):
    """Reset in the middle of a frame, with samples waiting: the pins are idle, and the next frames are
    right."""
    harness = Harness(dut)
    await harness.start()
    draw = random.Random(bench.SEED + moment)
    harness.stall = lambda: draw.random() < 0.9
    await harness.run(harness.period + draw.randint(1, harness.period))
    dut.rst_i.value = 1
    dut.cfg_enable_i.value = 0
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert (dut.out_valid_o.value, dut.adc_cs_n_o.value, dut.adc_convst_o.value) == (0, 1, 0)
    assert dut.adc_sclk_o.value == int(harness.twin.part is not MCP3208)
    assert dut.adc_reset_o.value == int(harness.twin.part.has_busy)
    assert harness.counters() == (0, 0, 0, 0)
    await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0
    if harness.twin.part is MCP3208:
        await bench.clocks(dut, 6 * harness.twin.clk_khz // 1000)
    harness.part.frames, harness.part.conversions = [], []
    harness.converts, harness.times, harness.losses, harness.reads = [], [], [], []
    harness.beats, harness.held = [], None
    harness.stall = lambda: False
    dut.cfg_enable_i.value = 1
    await harness.run(harness.twin.start_clocks())  # no wait for a running conversion: RESET ends it
    assert not harness.converts
    await harness.frames(3)
    await harness.stop()
    assert harness.check() == 0
    assert len(harness.beats) == 3 * harness.twin.channels


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_first_tick_waits_until_the_part_is_ready(dut):
    """Enabled since reset: the first conversion starts once the part's power-up sequence is done."""
    harness = Harness(dut)
    Clock(dut.clk_i, 1_000_000_000 // harness.twin.clk_khz, unit="ps").start()
    await bench.clocks(dut, 3)
    harness.part = harness.make()
    await bench.clocks(dut, 3)
    dut.cfg_enable_i.value = 1
    harness.period = harness.twin.safe_period() + 13
    dut.cfg_period_i.value = harness.period
    dut.rst_i.value = 0
    await harness.run(harness.twin.start_clocks() + 1)
    assert not harness.converts
    await harness.run(3)
    assert harness.converts == [harness.twin.start_clocks() + 1]
    await harness.frames(3)
    await harness.stop()
    assert harness.check() == 0
    if harness.twin.part.setup:
        asked = [harness.twin.part.command(n) for n in range(harness.twin.words)]
        setup = harness.twin.part.setup_words(harness.twin.lanes)
        assert harness.part.words[: len(setup) + len(asked)] == [*setup, *asked]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(level=[0, 1], asleep=[False, True])
async def busy_that_does_not_answer_times_out(dut, level, asleep):
    """BUSY is stuck for a few frames: each times out and is counted, and the next frame is right."""
    harness = Harness(dut)
    await harness.start(harness.twin.safe_period() + harness.twin.watch_clocks)
    await harness.frames(3)
    if asleep:  # a frame waits, so those that time out would have been dropped: they must be counted once
        harness.stall = lambda: True
        await harness.frames(1)
    before = len(harness.converts)
    harness.part.hold_busy(level)
    await harness.frames(3)
    harness.stall = lambda: False
    await harness.frames(1)
    assert harness.counters()[2] == 4
    assert dut.adc_cs_n_o.value == 1, "read what was not converted"
    harness.part.hold_busy(None)
    await harness.frames(4)
    await harness.stop()
    harness.on_grid()
    assert harness.check(lost=range(before, before + 4)) == 0
    assert harness.counters()[2] == 4
    assert len(harness.beats) == (before + 4) * harness.twin.channels


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def busy_timeout_is_the_twins(dut):
    harness = Harness(dut)
    await harness.start(3 * harness.twin.watch_clocks)
    harness.part.hold_busy(0)
    while not harness.converts:
        await harness.run(1)
    await harness.run(harness.twin.watch_clocks - 1)
    assert harness.counters()[2] == 0
    await harness.run(1)
    assert harness.counters()[2] == 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(after=[1, 0])
async def busy_timeout_leaves_the_next_tick_alone(dut, after):
    """A tick in the first clock after a timeout still makes a legal CONVST pulse, and no tick is lost; a tick
    in the clock of the timeout is lost."""
    harness = Harness(dut, limits=any_cycle(dut))
    await harness.start(harness.twin.watch_clocks + after)
    harness.part.hold_busy(0)
    await harness.frames(6)
    assert harness.counters() == ((0, 0, 5, 0) if after else (0, 3, 3, 0))
    harness.period *= 1 if after else 2
    harness.on_grid()
    await harness.stop()
    harness.check(lost=range(len(harness.converts)))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def busy_released_late_is_not_taken_for_an_answer(dut):
    """BUSY is stuck high and falls while the next frame waits for it: this must not give a frame."""
    harness = Harness(dut)
    await harness.start(harness.twin.safe_period() + harness.twin.watch_clocks)
    await harness.frames(2)
    harness.part.hold_busy(1)
    await harness.frames(1)
    await harness.run(harness.twin.watch_clocks // 2)
    dut.adc_busy_i.value = 0
    await harness.run(harness.period - harness.twin.watch_clocks // 2)
    harness.part.hold_busy(None)
    await harness.frames(2)
    await harness.stop()
    harness.check(lost=(2, 3))


class Extremes:
    """Conversions in turn as short and as long as can be, in place of a model's ``draw``."""

    def __init__(self):
        self.short = False

    def uniform(self, least, most):
        if least < 100:  # the delay of BUSY's rise
            return most
        self.short = not self.short
        return least if self.short else most


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def busy_of_others_is_waited_for(dut):
    """The read begins when the last BUSY has passed its synchroniser, at wait_i as at its own; one that is
    still high after the longest conversion is not waited for."""
    harness = Harness(dut, conversion_ns=between_edges(dut))
    await harness.start(harness.twin.safe_period() + harness.twin.watch_clocks)
    most = harness.twin.part.conversion_max_ns * harness.twin.clk_khz // 1_000_000
    own = between_edges(dut) * harness.twin.clk_khz // 1_000_000
    for until in (0, own + 1, own + 2, own + 3, most, most + 1, most + 2, most + 9):
        before, reads = len(harness.converts), len(harness.reads)
        while len(harness.converts) == before:
            await harness.run(1)
        dut.wait_i.value = 1
        await harness.run(until - 1)  # wait_i is high in clocks 1 to until - 1 of the conversion
        dut.wait_i.value = 0
        await harness.run(harness.period - until - 2)
        # In clock own + 2 the synchroniser shows BUSY low; read_o is a clock later.
        (read,) = harness.reads[reads:]
        assert read - harness.converts[-1] == min(max(own + 2, until), most + 2) + 1, until
    await harness.stop()
    assert harness.check() == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(short=[False, True])
async def reading_during_conversions_spans_convst(dut, short):
    """At the twin's shortest period for every part, longest and shortest conversions in turn lose nothing and
    break no limit, and frames overlap. A clock less than the transfer takes loses ticks, but no data."""
    harness = Harness(dut, limits=any_cycle(dut))
    twin = harness.twin
    await harness.start(twin.minimum_period() - 1 if short else twin.safe_period())
    harness.part.draw = Extremes()
    await harness.frames(40)
    await harness.stop()
    dropped, overrun, *others = harness.counters()
    assert (dropped, *others) == (0, 0, 0)
    # The longest conversion here is 50 ns shorter than the twin's, so a clock less may still suffice.
    longest = int(harness.part.limits.t_conv_most) * twin.clk_khz // 1_000_000
    assert (overrun > 0) == (longest + 3 + twin.guard_clocks() > harness.period)
    assert harness.check() == 0
    ends = [beat[0] for beat in harness.beats if beat[3]]
    assert sum(end > start for end, start in zip(ends, harness.converts[1:])) > 10


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def reading_stops_no_conversion_that_answers_too_early(dut):
    """BUSY falls during the read of the frame before: it is given up and counted, and so is the frame that is
    read meanwhile, whose last samples are not sent; the next frames are right."""
    reports = []
    harness = Harness(dut, report=reports.append)
    twin = harness.twin
    await harness.start(twin.safe_period())  # or reads end before the next conversion
    harness.part.draw = Extremes()
    await harness.frames(4)
    while bench.read(dut.adc_cs_n_o) or not bench.read(dut.adc_busy_i):  # reading and converting
        await harness.run(1)
    await harness.run(1)
    harness.part.hold_busy(0)
    await harness.run(4)
    assert harness.counters() == (0, 0, 1, 0)
    await harness.run(harness.period // 2)
    harness.part.hold_busy(None)
    await harness.frames(4)
    assert harness.counters() == (1, 0, 1, 0)
    before = len(harness.beats) // twin.channels
    await harness.frames(3)
    await harness.stop()
    harness.on_grid()
    tail = harness.beats[-3 * twin.channels :]
    codes = [code for frame in harness.converted()[-3:] for code in frame]
    assert before and [beat[1] for beat in tail] == twin.samples(codes)[0].tolist()
    assert {str(report) for report in reports} <= {"rule: BUSY falls during a read"}


@bench.applies(lambda dut, spoilt: spoilt <= dut.Channels.value.to_unsigned(), long=lambda spoilt: spoilt > 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(spoilt=range(1, 9), asleep=[False, True])
async def tag_of_another_channel_loses_the_frame(dut, spoilt, asleep):
    """One answer of a frame has a wrong number: the entire frame is lost and the part is set up again."""
    harness = Harness(dut)
    await harness.start(2 * harness.twin.safe_period() + 2 * harness.twin.start_clocks())
    await harness.frames(2)
    for bit in range(12, 16):
        if asleep:  # a frame waits, so the spoilt one would be dropped in any case, and counts as dropped
            harness.stall = lambda: True
            await harness.frames(1)
        left = iter(range(harness.twin.words))
        spoil = lambda answer, left=left, bit=bit: answer ^ (next(left, None) == spoilt) << bit
        harness.part.spoil = spoil
        setups = harness.part.words.count(0x0040)
        await harness.run(harness.period - 20)
        harness.stall = lambda: False
        await harness.run(20)
        assert harness.part.words.count(0x0040) == setups + 1
        harness.part.spoil = None
        await harness.frames(1)
    await harness.stop()
    harness.on_grid()
    assert harness.check(lost=() if asleep else range(2, 10, 2)) == 4 * asleep
    assert harness.counters() == ((4, 0, 0, 0) if asleep else (0, 0, 0, 4))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def tag_shows_a_part_that_lost_its_setup(dut):
    """The supply dips and the registers are lost. That frame is lost, and ticks are counted as overruns while
    the part is set up again. Commands before the new setup break the part's rules, which it reports."""
    reports = []
    harness = Harness(dut, report=reports.append)
    await harness.start()
    for extra in (0, 5, 11):
        await harness.frames(2)
        await harness.run(extra)
        harness.part.power_up()
        while harness.part.channel is None:
            await harness.run(1)
    await harness.frames(3)
    await harness.stop()
    dropped, overrun, _, mistagged = harness.counters()
    assert mistagged >= 3 and overrun >= 1
    assert dropped == 0
    frames = len(harness.beats) // harness.twin.channels
    assert frames == len(harness.converts) - mistagged
    assert len(harness.losses) == overrun + mistagged
    assert frames >= 6
    assert {str(report).split(":")[0] for report in reports} == {"setup"}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def triggers_start_conversions(dut):
    """A conversion starts in the clock after each trigger; each trigger gives samples or one lost_o."""
    harness = Harness(dut, limits=any_cycle(dut))
    await harness.start(1)  # a period that must not matter
    draw = random.Random(bench.SEED)
    cycle = harness.twin.cycle_clocks()
    triggers, _early = [], 0
    for gap in [cycle] * 6 + [cycle + draw.randint(0, 50) for _ in range(10)] + [7, cycle - 7, 1, cycle]:
        dut.trigger_i.value = 1
        triggers.append(harness.clock + 1)
        await harness.run(1)
        dut.trigger_i.value = 0
        if gap > 1:
            await harness.run(gap - 1)
    dut.cfg_enable_i.value = 0
    dut.trigger_i.value = 1  # no effect without enable
    await harness.run(cycle)
    dut.trigger_i.value = 0
    await harness.stop()
    too_early = [17, 19]  # 7 clocks and 1 clock after the trigger before
    assert harness.converts == [clock + 1 for n, clock in enumerate(triggers) if n not in too_early]
    assert harness.counters() == (0, len(too_early), 0, 0)
    assert harness.losses == [triggers[n] + 1 for n in too_early]
    assert harness.check() == 0
    if harness.twin.part.has_busy:  # the longest conversion and the timeout end within the cycle
        assert cycle >= harness.twin.watch_clocks + (harness.twin.channels, 1)[harness.twin.read_during]


# With BUSY all channels are sampled as CONVST rises.
@bench.applies(lambda dut: not PARTS[dut.Part.value.to_unsigned()].has_busy)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def hold_is_over_when_the_last_channel_was_sampled(dut):
    """The last sample is taken before hold_clocks after convert_o, and less than about a clock before."""
    harness = Harness(dut)
    await harness.start()
    await harness.frames(3)
    await harness.stop()
    clock_ns = 1e6 / harness.twin.clk_khz
    hold = harness.twin.hold_clocks() * clock_ns
    channels = harness.twin.channels
    begins = [
        next(n for n, entry in enumerate(harness.part.conversions) if entry[2] >= t) for t in harness.times
    ]
    for time, begin in zip(harness.times, begins):
        last = harness.part.conversions[begin + channels - 1 + harness.twin.part.tagged]
        assert 0 < hold - (last[2] - time) <= 1.01 * clock_ns


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def busy_part_gets_its_reset(dut):
    """RESET is high for long enough, and ends long enough before the first CONVST: both limits are
    checked."""
    reports = []
    harness = Harness(dut, report=reports.append)
    await harness.start()
    await harness.frames(1)
    assert not reports
    limits, part = harness.part.limits, harness.twin.part
    for rule in ("t_reset", "t_reset_convst", *["t_dh"] * bool(part.setup)):
        reports.clear()
        harness.part.limits = tightened(limits, rule)
        await bench.reset(dut)
        await harness.run(harness.twin.start_clocks() + 5)
        assert {str(report).split(":")[0] for report in reports} == {rule}
    clock_ns = 1e6 / harness.twin.clk_khz
    assert harness.part.reset_fell - harness.part.reset_rose >= part.reset_ns
    assert harness.part.convst_rose - harness.part.reset_fell >= part.start_ns - clock_ns


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def every_limit_of_the_part_is_checked(dut):
    """With one limit tightened beyond reach, the part reports this limit and no other."""
    harness = Harness(dut)
    limits, rules = limits_and_rules(dut)
    reports = []
    harness = Harness(dut, limits=limits, report=reports.append)
    await harness.start()
    await harness.frames(2)
    assert not reports
    for rule in rules:
        reports.clear()
        harness.part.limits = tightened(limits, rule)
        await harness.frames(2)
        assert reports, f"{rule} is not checked"
        names = {str(report).split(":")[0] for report in reports}
        assert names == {rule}, f"{rule} was tightened, {names} reported"


@cocotb.test(timeout_time=20, timeout_unit="ms", expect_error=TimingViolation)
async def a_broken_limit_fails_the_test(dut):
    limits, rules = limits_and_rules(dut)
    harness = Harness(dut, limits=tightened(limits, "t_sclk" if "t_sclk" in rules else rules[1]))
    await harness.start()
    await harness.frames(2)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def too_slow_a_part_is_misread(dut):
    """A DOUT later than the sampling point gives wrong codes, so the models' delays have an effect."""
    harness = Harness(dut)
    late = 2 * harness.twin.half * 1e6 / harness.twin.clk_khz  # an entire bit
    if harness.twin.part is MCP3208:
        limits = mcp3208.Limits(t_do=late)
    elif harness.twin.part.tagged:
        limits = replace(limits_and_rules(dut)[0], t_dot=late)
    else:
        limits = replace(limits_and_rules(dut)[0], t_sclk_dout=late, t_cs_dout=late)
    harness = Harness(dut, limits=limits)
    await harness.start()
    await harness.frames(8)
    await harness.stop()
    if harness.twin.part.tagged:
        assert harness.counters()[3] > 0 and len(harness.beats) < 8 * harness.twin.channels
    else:
        with pytest.raises(AssertionError, match="of codes"):
            harness.check()


BUILDS = [
    {"Part": 1, "Channels": 1, "ClkKhz": 25_000, "SclkKhz": 2_000},
    pytest.param(
        {"Part": 1, "Channels": 4, "ClkKhz": 12_500, "SclkKhz": 1_000, "SampleBits": 13},
        marks=pytest.mark.long,
    ),
    {"Part": 1, "Channels": 8, "ClkKhz": 8_000, "SclkKhz": 2_000},
    {"Part": 2, "Channels": 2, "ClkKhz": 100_000, "SclkKhz": 14_500, "SampleBits": 16},
    {"Part": 2, "Channels": 3, "ClkKhz": 8_000, "SclkKhz": 14_500},
    {"Part": 2, "Channels": 8, "ClkKhz": 25_000, "SclkKhz": 14_500},
    pytest.param(
        {"Part": 2, "Channels": 5, "Lanes": 2, "ClkKhz": 50_000, "SclkKhz": 10_000}, marks=pytest.mark.long
    ),
    {"Part": 2, "Channels": 6, "Lanes": 2, "ClkKhz": 25_000, "SclkKhz": 14_500},
    {"Part": 2, "Channels": 7, "Lanes": 2, "ClkKhz": 12_500, "SclkKhz": 14_500, "PeriodBits": 16},
    {"Part": 2, "Channels": 8, "Lanes": 2, "ClkKhz": 25_000, "SclkKhz": 14_500},
    {"Part": 2, "Channels": 8, "Lanes": 2, "ClkKhz": 25_000, "SclkKhz": 14_500, "ReadDuring": 1},
    {"Part": 2, "Channels": 5, "Lanes": 2, "ClkKhz": 100_000, "SclkKhz": 17_000, "ReadDuring": 1},
    {"Part": 2, "Channels": 3, "ClkKhz": 8_000, "SclkKhz": 14_500, "ReadDuring": 1, "PeriodBits": 16},
    {"Part": 6, "Channels": 8, "Lanes": 8, "ClkKhz": 25_000, "SclkKhz": 60_000, "ReadDuring": 1},
    {"Part": 3, "Channels": 8, "ClkKhz": 8_000, "SclkKhz": 16_000},
    {"Part": 4, "Channels": 1, "ClkKhz": 100_000, "SclkKhz": 16_000, "PeriodBits": 13},
    {"Part": 5, "Channels": 5, "ClkKhz": 16_000, "SclkKhz": 6_000},
    {"Part": 7, "Channels": 8, "ClkKhz": 41_000, "SclkKhz": 48_000},
    {"Part": 6, "Channels": 2, "ClkKhz": 2_860, "SclkKhz": 1_000},  # hardly more than two clocks of BUSY
    pytest.param(
        {"Part": 6, "Channels": 5, "Lanes": 2, "ClkKhz": 40_000, "SclkKhz": 60_000}, marks=pytest.mark.long
    ),
    {"Part": 6, "Channels": 7, "Lanes": 4, "ClkKhz": 8_000, "SclkKhz": 60_000},
    {"Part": 6, "Channels": 8, "Lanes": 8, "ClkKhz": 6_000, "SclkKhz": 60_000},
]


EVIDENCE = {
    "equivalence": {
        "reset": {"qualifiers": {"adc_mosi_o": "!adc_cs_n_o"}, "joined": (("state_q", "!convert_o"),)}
    },
    "faults": {
        "driver": {"free": 16000, "part": 1, "late": "left_q"},
        "more": [{"Part": 2, "ReadDuring": 1}],
    },
    "icarus": {
        "refused": "a parameter that a package's function makes of another package's functions: not evaluated"
    },
}


@pytest.mark.parametrize("parameters", BUILDS, ids=lambda p: "-".join(map(str, p.values())))
def test_adc_spi(parameters):
    skipped = ["triggers_"]
    skipped += [] if PARTS[parameters["Part"]].has_busy else ["busy_"]
    # Upsets of the others are in test_adc_spi_with_upsets_of_its_shifter, and those of its shifter with them.
    skipped += [] if parameters.get("ReadDuring") or parameters["Part"] > 5 else ["goes_on_"]
    skipped += [] if parameters.get("ReadDuring") else ["reading_"]
    skipped += [] if PARTS[parameters["Part"]].tagged else ["tag_"]
    bench.run("frontend", "adc_spi", parameters, test_filter=rf"^(?!.*({'|'.join(skipped)}))")


@pytest.mark.parametrize(
    "parameters",
    [
        {"Part": 1, "Channels": 2, "ClkKhz": 25_000, "SclkKhz": 1_000},
        {"Part": 1, "Channels": 3, "ClkKhz": 25_000, "SclkKhz": 1_000},
        {"Part": 2, "Channels": 8, "Lanes": 2, "ClkKhz": 25_000, "SclkKhz": 14_500},
        {"Part": 2, "Channels": 8, "Lanes": 2, "ClkKhz": 25_000, "SclkKhz": 14_500, "ReadDuring": 1},
        {"Part": 4, "Channels": 8, "ClkKhz": 25_000, "SclkKhz": 16_000},
        {"Part": 6, "Channels": 8, "Lanes": 8, "ClkKhz": 6_000, "SclkKhz": 60_000},
    ],
    ids=lambda p: "-".join(map(str, p.values())),
)
def test_adc_spi_with_triggers(parameters):
    bench.run("frontend", "adc_spi", parameters | {"Trigger": 1}, test_filter="triggers_")


@pytest.mark.parametrize(
    "parameters",
    [
        {"Part": 1, "Channels": 3, "ClkKhz": 8_000, "SclkKhz": 2_000},
        {"Part": 2, "Channels": 6, "Lanes": 2, "ClkKhz": 12_500, "SclkKhz": 14_500},
        {"Part": 4, "Channels": 2, "ClkKhz": 16_000, "SclkKhz": 16_000},
    ],
    ids=lambda p: "-".join(map(str, p.values())),
)
def test_adc_spi_with_upsets_of_its_shifter(parameters):
    bench.run("frontend", "adc_spi", parameters, test_filter="goes_on_", inside=["msn_spi_shift"])


test_refuses_illegal_parameters = refusals(
    "adc_spi",
    lambda part=1, **given: AdcSpi(PARTS.get(part), **given),
    *({"Part": 0}, {"Part": 8}, {"Channels": 0}, {"Channels": 9}, {"Lanes": 0}, {"Lanes": 2}),
    *({"ClkKhz": 400_001}, {"SclkKhz": 2_001}, {"SclkKhz": 0}, {"SclkKhz": 9}, {"SampleBits": 12}),
    *({"Lanes": 3, "Part": 2}, {"Lanes": 2, "Part": 2, "Channels": 4}, {"SclkKhz": 17_001, "Part": 2}),
    *({"SclkKhz": 1000, "ClkKhz": 19}, {"SampleBits": 15, "Part": 2}, {"Lanes": 2, "Part": 3}),
    *({"SclkKhz": 16_001, "Part": 3}, {"SclkKhz": 150, "Part": 3}, {"SampleBits": 12, "Part": 5}),
    *({"Lanes": 3, "Part": 6}, {"Lanes": 16, "Part": 6}, {"Lanes": 8, "Part": 6, "Channels": 1}),
    *({"SclkKhz": 48_001, "Part": 7}, {"SclkKhz": 470, "Part": 7}, {"Lanes": 2, "Part": 7}),
    *({"Lanes": 4, "Part": 6, "Channels": 2}, {"SclkKhz": 60_001, "Part": 6}, {"PeriodBits": 33}),
    *({"ReadDuring": 1}, {"ReadDuring": 1, "Part": 3}, {"ClkKhz": 2_857, "Part": 6}),
    *({"ClkKhz": 1_000, "Part": 6, "ReadDuring": 1}, {"ClkKhz": 476, "Part": 2}),
)


@pytest.mark.parametrize("part", PARTS.values(), ids=lambda part: part.name)
def test_twin_knows_every_code(part):
    data, over = AdcSpi(part).samples(range(1 << part.data_bits))
    assert len(set(data.tolist())) == 1 << part.data_bits
    assert sorted(data[over].tolist()) == [data.min(), data.max()]
    assert data[1] == 1
    assert data[-1] == (-1 if part.signed else (1 << part.data_bits) - 1)


def test_twin_knows_every_command():
    """Start bit, single-ended, channel; the AD7606 has no DIN, an AD7606C keeps sending while it reads 0."""
    assert [f"{MCP3208.command(n):016b}" for n in range(8)] == [f"11{n:03b}" + 11 * "0" for n in range(8)]
    assert [part.command(n) for part in (AD7606, AD7606C) for n in range(8)] == [0] * 16


@pytest.mark.parametrize("part", PARTS.values(), ids=lambda part: part.name)
def test_twin_never_exceeds_the_parts_clock(part):
    for clk_khz in (3_000, 12_000, 25_000, 27_000, 48_000, 50_000, 100_000, 133_000):
        for sclk_khz in (max(100, 2 * part.sclk_min_khz), 1_000, part.sclk_max_khz):
            twin = AdcSpi(part, clk_khz=clk_khz, sclk_khz=sclk_khz)
            assert clk_khz <= 2 * twin.half * sclk_khz
            assert (2 * twin.half - 1) * 1e6 / clk_khz >= part.access_ns


@pytest.mark.parametrize(
    "part, clk_khz, half",
    [
        (AD7606, 27_000, 1),  # 30 + 7 ns are 0.999 clocks, so one; 14.5 MHz needs 0.93
        (AD7606, 27_028, 2),  # 1.00004 clocks, so two: sampled in the third, the bit's last but one
        (AD7606, 29_000, 2),
        (AD7606, 50_000, 2),
        (MAX11123, 32_000, 1),  # 17 + 7 ns are 0.77 clocks
        (MAX11123, 32_001, 2),  # 16 MHz
        (AD7606C, 37_037, 1),  # 20 + 7 ns are 0.999999 clocks
        (AD7606C, 37_038, 2),
        (AD7606C, 100_000, 2),  # three clocks, so 25 MHz
        (MAX11131, 41_666, 1),  # 17 + 7 ns are 0.99998 clocks: 20.8 MHz
        (MAX11131, 41_667, 2),
        (MAX11131, 125_000, 2),  # 3 clocks: 31.25 MHz
        (MAX11131, 125_001, 3),
        (MCP3208, 48_000, 12),  # 2 MHz; 200 + 7 ns are 9.94 clocks
    ],
)
def test_half_a_bit_by_hand(part, clk_khz, half):
    """docs/adc.md: 2·half - 1 clocks last at least the access time and 7 ns of round trip."""
    assert AdcSpi(part, channels=1, clk_khz=clk_khz, sclk_khz=part.sclk_max_khz).half == half


@pytest.mark.parametrize(
    "clk_khz, clocks", [(4_000, 64), (12_000, 128), (25_000, 256), (48_000, 512), (100_000, 1024)]
)
def test_busy_is_waited_for_as_long_as_the_page_says(clk_khz, clocks):
    """docs/adc.md: the smallest power of two that lasts 8.4 µs, here 33.6, 100.8, 210, 403.2, 840 clocks."""
    assert AdcSpi(AD7606, clk_khz=clk_khz).watch_clocks == clocks


@pytest.mark.parametrize("clk_khz, clocks", [(25_000, 2), (40_000, 2), (40_001, 3), (100_000, 4)])
def test_inputs_stay_as_long_as_the_page_says(clk_khz, clocks):
    """docs/adc.md: 25 ns after CONVST, which rises in the first of these clocks; 1.0 clocks at 40 MHz."""
    assert [AdcSpi(part, clk_khz=clk_khz).hold_clocks() for part in (AD7606, AD7606C)] == [clocks, clocks]


@pytest.mark.parametrize("lanes, word", [(1, 0x0200), (2, 0x0208), (4, 0x0210), (8, 0x0218)])
def test_lanes_are_a_field_of_a_register(lanes, word):
    """docs/adc.md: 0, 1, 2, 3 in bits 4:3 of register 2; the other setup words do not know the lanes."""
    others = [0x0311, 0x0411, 0x0511, 0x0611, 0x07FF, 0]
    assert list(AD7606C.setup_words(lanes)) == [0x4200, word, *others]
