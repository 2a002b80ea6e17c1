"""msn_pin_display with models of the drivers at its pins: every edge of every output in its clock, by the
twin; the two limits, pins at once and the duty in any window, from the outputs alone; faults, frames that
stop, damaged and too many frames, settings within a period. The twin against the lists of
tb/reference/pin_display.py."""

import random
import re
from collections import Counter
from fractions import Fraction
from itertools import pairwise

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge
from cocotb.utils import get_sim_time

import bench
from meissner.builds.toolchain import ROOT
from meissner.twins.actuate.pin_display import (
    DisplaySettings,
    DisplaySize,
    PinDisplay,
    high,
    increment_of,
    share,
)
from parts.hv507 import Hv507
from reference.pin_display import WRAP, Limits, Phase

SIZES = [
    DisplaySize(35, 1, 1, 1000, 500, 500, 1000, 40, 50),
    DisplaySize(9, 2, 3, 1000, 500, 150, 290, 40, 167),
]
IDLE = {"in_valid_i": 0, "in_data_i": 0, "in_last_i": 0, "fault_i": 0}


def size_of(dut):
    return next(size for size in SIZES if size.pins == dut.Pins.value.to_unsigned())


class Bench:
    """The block with drivers at its pins, and the twin beside it."""

    async def start(self, dut, settings):
        self.dut, self.size = dut, size_of(dut)
        if not hasattr(self, "drivers"):
            await bench.start(dut, **IDLE, cfg_enable_i=1, **self.inputs(settings))
        self.zero = get_sim_time("ns")
        lines = (dut.hv_clk_o, dut.hv_le_o, dut.hv_bl_o, dut.hv_pol_o)
        pass_time = lambda violation: None if str(violation)[:2] == "t_" else Hv507.fail(None, violation)
        drivers = self.size.chain_bits // 64
        self.drivers = [
            Hv507(dut.hv_data_o, *lines, drivers, k, report=pass_time) for k in range(self.size.chains)
        ]
        self.twin = PinDisplay(self.size, settings)
        return self

    @staticmethod
    def inputs(settings):
        return {f"cfg_{name}_i": value for name, value in settings.settings.items()}

    def set(self, settings):
        for name, value in self.inputs(settings).items():
            getattr(self.dut, name).value = value

    @property
    def clock(self):
        return round((get_sim_time("ns") - self.zero) / 10)

    async def frame(self, levels, last=None):
        """A frame; ``last``: place that has `last`, None: the last one."""
        for place, level in enumerate(levels):
            self.dut.in_valid_i.value, self.dut.in_data_i.value = 1, int(level)
            self.dut.in_last_i.value = place == (len(levels) - 1 if last is None else last)
            await bench.RisingEdge(self.dut.clk_i)
        self.dut.in_valid_i.value = self.dut.in_last_i.value = 0

    async def wrap(self):
        """The clock in which the next period begins at the pins."""
        await bench.RisingEdge(self.dut.wrap_o)
        return self.clock

    def changes(self, first):
        """[(clock, levels of all pins)] of the drivers' outputs after each change, from clock ``first``
        on."""
        times = sorted({round((ns - self.zero) / 10) for driver in self.drivers for ns, _ in driver.changes})
        found, before = [], None
        for time in times:
            last = [
                [v for ns, v in driver.changes if ns - self.zero <= 10 * time + 9][-1]
                for driver in self.drivers
            ]
            levels = tuple(v for chain in last for v in chain[: self.size.chain_pins])[: self.size.pins]
            if time >= first and levels != before:
                found.append((time, levels))
            before = levels
        return found

    def expected(self, periods):
        """The same by the twin."""
        found, before = [], (0,) * self.size.pins
        for period in periods:
            for slot, states in enumerate(high(period.levels, self.size.amplitude_bits).T):
                levels = tuple(states.astype(int).tolist())
                if levels != before:
                    found.append((period.start + period.slots[slot], levels))
                before = levels
        return found


def frame_of(draw, size):
    kind = draw.random()
    if kind < 0.15:
        return [255] * size.pins
    return [draw.choice([0, 0, 1, 2, 5, 255]) if kind < 0.8 else 0 for _ in range(size.pins)]


@cocotb.test(timeout_time=9, timeout_unit="ms")
@cocotb.parametrize((("duty", "watchdog"), [(65535, 2), (120, 15)]))
async def every_edge_is_the_twins(dut, duty, watchdog):
    draw, size = random.Random(f"{bench.SEED} {duty} {watchdog}"), size_of(dut)
    least, largest = size.limits
    settings = DisplaySettings(
        increment=draw.randint(least, largest), duty=duty, watchdog=watchdog, most=size.pins
    )
    here = await Bench().start(dut, settings)
    frame, periods, most, changed = frame_of(draw, size), [], [], True
    await here.frame(frame)
    for n in range(40):
        clock = await here.wrap()
        if n == 0:
            here.twin.on_again(clock - size.lead)
        period = here.twin.next(frame, settings)
        assert period.start == clock and period.silent == changed
        periods.append(period)
        most.append((clock, settings.most))
        await bench.ReadOnly()
        assert (
            bench.read(dut.pins_o) == sum(period.levels > 0) and bench.read(dut.limited_o) == period.limited
        )
        await bench.RisingEdge(dut.clk_i)
        frame, changed = None, False
        if draw.random() < 0.6:
            frame = frame_of(draw, size)
            await here.frame(frame)
        if draw.random() < 0.3:
            words = {"most": draw.choice([0, 1, 4, size.pins]), "top": draw.choice([0, 1, 4, 255])}
            words |= {"burst_period": draw.choice([0, 3]), "burst_on": draw.choice([1, 2])}
            if draw.random() < 0.3:
                words["increment"] = draw.choice(
                    [least, largest, (1 << 32) - 1, draw.randint(least, largest)]
                )
            changed = min(words.get("increment", settings.increment), largest) != here.twin.increment
            settings = DisplaySettings(**(settings.settings | words))
            here.set(settings)
    await here.wrap()
    first = periods[0].start
    got = here.changes(first)
    assert [one for one in got if one[0] < periods[-1].start] == here.expected(periods[:-1])
    # The limits, from the outputs alone.
    at_once = max(sum(levels) for _, levels in got)
    assert all(sum(v) <= dict(most)[max(c for c, _ in most if c <= clock)] for clock, v in got)
    assert at_once > 0
    window = 7 * size.ticks * size.tick_clocks
    for pin in range(size.pins):
        driven = [
            (p.start, p.start + p.clocks)
            for p in periods[:-1]
            if any(v[pin] for clock, v in got if p.start <= clock < p.start + p.clocks)
        ]
        for _, end in driven:
            spent = sum(
                min(b, end) - max(a, end - window) for a, b in driven if min(b, end) > max(a, end - window)
            )
            assert spent <= duty * size.tick_clocks, (pin, end)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def the_latch_keeps_the_frequency(dut):
    """The clocks in which LE rises for a period, from the formula of the phase: the mean to 0.001 Hz, none a
    clock off, none drifts."""
    size = size_of(dut)
    hz = Fraction(9977 * size.max_hz + 23 * size.min_hz, 10_000)  # no whole number of clocks
    increment = increment_of(hz, size.clk_khz)
    assert abs(Fraction(increment * 1000 * size.clk_khz, WRAP) - hz) < Fraction(1, 1000)
    here, latched = await Bench().start(dut, DisplaySettings(increment)), []
    await here.frame([255] * size.pins)
    while len(latched) < 12:
        await bench.RisingEdge(dut.hv_le_o)
        await bench.ReadOnly()
        if bench.high(dut.wrap_o):
            latched.append(here.clock)
    assert {b - a for a, b in pairwise(latched[1:])} <= {WRAP // increment, WRAP // increment + 1}
    for n, clock in enumerate(latched[1:]):
        assert abs(clock - latched[1] - Fraction(n * WRAP, increment)) < 1, n


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def all_is_off_from_the_next_clock_on(dut):
    """A fault and no enable in any part of a period; after that a silent period, and the frame again."""
    size, draw = size_of(dut), random.Random(bench.SEED)
    settings = DisplaySettings(increment=size.limits[1])
    here = await Bench().start(dut, settings)
    await here.frame([255] * size.pins)
    await here.wrap()
    for name, level in (("fault_i", 1), ("cfg_enable_i", 0)) * 4:
        await here.wrap()
        await bench.clocks(dut, draw.randrange(size.slot_clocks * 2))
        getattr(dut, name).value = level
        await bench.clocks(dut, 2)
        assert not any(any(driver.outputs) for driver in here.drivers) and not bench.high(dut.running_o)
        begun = here.clock
        await bench.clocks(dut, draw.choice([1, 50, 3000]))
        getattr(dut, name).value = 1 - level
        first, second = await here.wrap(), await here.wrap()
        await bench.clocks(dut, 5)
        assert {clock for clock, _ in here.changes(begun)} == {
            second
        } and second - first <= size.slot_clocks * size.slots + 99
        assert sum(here.changes(begun)[-1][1]) == size.pins
    dut.rst_i.value = 1
    await bench.clocks(dut, 2)
    assert not any(any(driver.outputs) for driver in here.drivers)
    dut.rst_i.value = 0
    await bench.clocks(dut, 3 * size.slots * size.slot_clocks)
    assert not any(any(driver.outputs) for driver in here.drivers)  # no frame has come since the reset


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def all_is_off_when_frames_stop(dut):
    """In the clock after as many ticks as ``stop`` since the wrap that took the last frame."""
    size = size_of(dut)
    settings = DisplaySettings(increment=size.limits[1], stop=300)
    here = await Bench().start(dut, settings)
    await here.frame([255] * size.pins)
    taken = await here.wrap() - size.lead
    await here.frame([255] * (size.pins - 1))  # a damaged one does not count
    await FallingEdge(dut.hv_bl_o)
    off = here.clock - 1
    ticks = lambda clock: (clock + 1) // size.tick_clocks
    assert ticks(off - 1) - ticks(taken) == 300 and ticks(off - 2) - ticks(taken) == 299
    await bench.clocks(dut, 5000)
    assert not any(any(driver.outputs) for driver in here.drivers)
    await here.frame([255] * size.pins)
    await here.wrap()
    await here.wrap()
    await bench.clocks(dut, 2)
    assert sum(here.changes(0)[-1][1]) == size.pins
    dut.cfg_enable_i.value = 0  # a frame that comes meanwhile waits, however long
    await here.frame([255] * size.pins)
    await bench.clocks(dut, 301 * size.tick_clocks)
    assert not bench.high(dut.hv_bl_o)
    dut.cfg_enable_i.value, begun = 1, here.clock
    await here.wrap()
    await here.wrap()
    await bench.clocks(dut, 2)
    assert sum(here.changes(begun)[-1][1]) == size.pins
    dut.cfg_stop_i.value, begun = 65535, await here.wrap()
    await bench.clocks(dut, 2 * size.slot_clocks)
    dut.cfg_increment_i.value = size.limits[0] - 1  # frequency 0: off at the wrap, not before
    await FallingEdge(dut.hv_bl_o)
    period = -(-WRAP // size.limits[1])
    assert abs(here.clock - 1 - (begun - size.lead + period)) <= 1
    await bench.clocks(dut, 5000)
    assert not any(here.changes(0)[-1][1]) and not bench.high(dut.running_o)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def keeps_the_newest_whole_frame(dut):
    """Three frames in a period; one too short, one too long, one without an end."""
    size = size_of(dut)
    here = await Bench().start(dut, DisplaySettings(increment=size.limits[0]))
    one = lambda pin: [255 * (k == pin) for k in range(size.pins)]
    await here.frame(one(0))
    await here.wrap()
    for pin in (1, 2, 3):
        await here.frame(one(pin))
        await bench.clocks(dut, 5)
    await here.wrap()
    await bench.clocks(dut, 2)
    assert np.flatnonzero(here.changes(0)[-1][1]).tolist() == [3] and bench.read(dut.dropped_o) == 2
    await here.frame([255] * (size.pins - 1))
    await here.frame([255] * (size.pins + 1))
    await here.frame([255] * size.pins, last=-1)
    await bench.clocks(dut, 5)
    assert bench.read(dut.dropped_o) == 5
    await here.wrap()
    await bench.clocks(dut, 2)
    assert np.flatnonzero(here.changes(0)[-1][1]).tolist() == [3]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_frame_that_ends_as_the_last_one_is_read_again_waits(dut):
    """In any clock of the pass that finds a period's levels: the period shows the old frame whole."""
    size = size_of(dut)
    here = await Bench().start(dut, DisplaySettings(increment=size.limits[0]))
    half, period = size.pins // 2, -(-WRAP // size.limits[0])
    frames = [[255] * half + [0] * (size.pins - half), [0] * half + [255] * (size.pins - half)]
    await here.frame(frames[0])
    await here.wrap()
    for turn, place in enumerate((1, 2, half, size.pins - 2, size.pins)):
        begins = await here.wrap() - size.lead + period
        await bench.clocks(dut, begins + place - size.pins - here.clock)
        await here.frame(frames[1 - turn % 2])
        for shown in (frames[turn % 2], frames[1 - turn % 2]):
            await here.wrap()
            await bench.clocks(dut, 3)
            assert list(here.changes(0)[-1][1]) == [int(level > 0) for level in shown], place


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_frame_that_ends_about_a_wrap_counts_as_one(dut):
    """In any clock: all stays on until ``stop``, one and a half periods, after the wrap that takes it."""
    size = size_of(dut)
    period = -(-WRAP // size.limits[0])
    stop = 3 * period // (2 * size.tick_clocks)
    here = await Bench().start(dut, DisplaySettings(increment=size.limits[0], stop=stop))
    frame = [255] * size.pins
    await here.frame(frame)
    begun = await here.wrap() - size.lead
    for late in range(-3, 4):
        await bench.clocks(dut, begun + period + late - size.pins - here.clock)
        await here.frame(frame)
        await bench.clocks(dut, begun + 2 * period - 2 * size.pins - here.clock)
        assert bench.high(dut.running_o) and bench.high(dut.hv_bl_o), late
        await here.frame(frame)  # for the next wrap
        begun = await here.wrap() - size.lead


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(
        dut, "hv_clk_o", "hv_le_o", "hv_bl_o", "running_o", "pins_o", "limited_o", "dropped_o"
    )
    assert bench.high(dut.hv_pol_o) and not bench.high(dut.hv_dir_o)


EVIDENCE = {
    "equivalence": {"boxes": True},
    "faults": {
        "none": "instances and wires: image_store, pin_phase, pin_limits and pin_shift, each done alone"
    },
}


@pytest.mark.parametrize(
    "size", [SIZES[0], pytest.param(SIZES[1], marks=pytest.mark.long)], ids=lambda size: f"{size.pins}"
)
def test_pin_display(size):
    bench.run("actuate", "pin_display", size.parameters)


def test_refuses_what_cannot_be_shifted_in_time():
    """1,000 pins in one chain at 8 MHz: 1,024 bits and pauses take 144 us, a pass and the rest 22 us; a slot
    of three bits at 400 Hz has 156 us. Two chains halve the shift."""
    wide = {"pins": 1000, "clk_khz": 48_000}
    assert DisplaySize(**wide, amplitude_bits=2).lead == 1000 + 6912 + 48
    for more in ({"amplitude_bits": 3}, {"amplitude_bits": 4, "chains": 2}):
        size = wide | more
        with pytest.raises(ValueError, match=rf"amplitude_bits = {more['amplitude_bits']}: a slot of"):
            DisplaySize(**size)
        given = {
            "Pins": 1000,
            "ClkKhz": 48_000,
            "AmplitudeBits": more["amplitude_bits"],
            "Chains": more.get("chains", 1),
        }
        assert f"AmplitudeBits = {more['amplitude_bits']} makes slots of" in bench.refuses(
            "pin_display", given
        )
    assert DisplaySize(**wide, amplitude_bits=3, chains=2).half == 3
    for chains, pins in ((7, 35), (2, 2), (8, 50)):
        DisplaySize(pins=pins, chains=chains)
    with pytest.raises(ValueError, match="chains = 8 must all have pins"):
        DisplaySize(pins=35, chains=8)  # five a chain, so seven have all
    assert "some for each of the chains" in bench.refuses("pin_shift", {"Pins": 35, "Chains": 8})
    for wrong in (
        {"pins": 1},
        {"pins": 4096},
        {"chains": 9},
        {"chains": 4, "pins": 5},
        {"amplitude_bits": 7},
        {"ticks": 3999},
        {"min_hz": 401},
    ):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            DisplaySize(**wrong)
    for wrong in ({"watchdog": 16}, {"top": 256}, {"increment": 1 << 32}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            DisplaySettings(**wrong)


PAGE = [  # of docs/pin_display.md: pins, chains, MHz, us of a load and of Lead, most bits, us of their slot
    (100, 1, 25, 23, 29, 5, 39),
    (35, 1, 12, 12, 19, 5, 39),
    (1000, 1, 48, 144, 166, 2, 312),
    (1000, 4, 48, 36, 58, 4, 78),
]


@pytest.mark.parametrize("pins, chains, mhz, load, lead, bits, slot", PAGE)
def test_the_pages_table_of_loads(pins, chains, mhz, load, lead, bits, slot):
    """A clock's half by 8 MHz, 8 bits and a pause a word; a slot of 400 Hz and 2^(bits + 1) must have 8
    clocks more."""
    whole, half = -(-pins // chains // 64) * 64, -(-mhz // 16)
    clocks = whole // 8 * 9 * 2 * half
    assert [round(clocks / mhz), round((pins + clocks + 48) / mhz)] == [load, lead]
    assert int(mhz * 1e6 / 400 / 2 ** (bits + 1) / mhz) == slot
    size = DisplaySize(pins, chains, bits, 1000 * mhz)
    assert (size.load, size.lead) == (clocks, pins + clocks + 48)
    with pytest.raises(ValueError, match=f"amplitude_bits = {bits + 1}"):
        DisplaySize(pins, chains, bits + 1, 1000 * mhz)
    row = (
        rf"\| {pins:,}[^|]*, {chains} \| {mhz} MHz[^|]*\| {load} µs \| {lead} µs \| {bits} \([^|]*{slot} µs\)"
    )
    assert re.search(row, (ROOT / "docs/pin_display.md").read_text("utf-8"))


def test_when_a_pin_that_is_held_is_off():
    """The page: three sevenths of 5715 ticks, up to one more; at 230 Hz 17.4 ticks a period are charged 18.4,
    so that 20,000 hold 1087 periods."""
    size = DisplaySize(pins=2)
    for duty, watchdog, start, least, most in (
        (65535, 3, 1, 5.71, 5.72),
        (65535, 3, 35_700_000, 4.28, 4.29),
        (20_000, 3, 1, 4.72, 4.73),
        (12_000, 15, 1, 2.83, 2.84),
    ):
        settings = DisplaySettings(increment_of(230, 25_000), duty=duty, watchdog=watchdog)
        twin = PinDisplay(size, settings)
        twin.on_again(start)
        periods = [twin.next([1, 0])] + [twin.next() for _ in range(1400)]
        on = [period.start for period in periods if period.levels.any()]
        assert least < (on[-1] - on[0]) / 25e6 + 1 / 230 < most


def test_widths_of_pulses_by_hand():
    """One bit: half of the period, or nothing. Two bits: 2, 3 and 4 of 8 slots."""
    assert high([0, 1], 1).tolist() == [[False] * 4, [True, True, False, False]]
    assert share([0, 1, 2, 3], 2).tolist() == [0, 2 / 8, 3 / 8, 4 / 8]


def test_twin_at_a_frequency_of_0_and_with_a_wrong_frame():
    """Periods of 1000 clocks, 25 ticks; a pause charges the period before it, and a silent one follows. The
    first period, the silent one, has one clock more, as its first has no increment."""
    size, frame = SIZES[0], [1] * 35
    twin = PinDisplay(size, DisplaySettings(increment=size.limits[1], duty=3 * 26 + 28))
    twin.on_again(39)
    found = [twin.next(frame), twin.next(), twin.next()]
    assert [p.silent for p in found] == [True, False, False] and [p.clocks for p in found] == [
        1002,
        1000,
        1000,
    ]
    assert twin.next(settings=DisplaySettings(increment=size.limits[0] - 1)) is None and not twin.levels.any()
    assert twin.next(settings=DisplaySettings()) is None  # off as before
    twin.on_again(9999)
    again = DisplaySettings(increment=size.limits[1], duty=3 * 26 + 28)
    found = [twin.next(settings=again), *(twin.next() for _ in range(3))]
    assert [p.silent for p in found] == [True, False, False, False]
    assert [p.levels.all() for p in found] == [False, True, True, False]  # no room after four of 26 ticks
    with pytest.raises(ValueError, match=r"shape \(34,\), which must be \(35,\)"):
        twin.next(frame[1:])


@pytest.mark.parametrize("duty, watchdog", [(65535, 15), (1500, 15), (65535, 1), (3000, 3)])
def test_twin_against_the_lists(duty, watchdog):
    """At the full size, 230 Hz, 25 MHz: the phase clock by clock for three periods, the limits for 21 s."""
    size, draw = DisplaySize(pins=6), random.Random(bench.SEED)
    settings = DisplaySettings(increment_of(230, 25_000), 92, 60, 14, 4, duty, watchdog)
    twin, lists = PinDisplay(size, settings), Limits(6, 4)
    phase = Phase(*size.limits, size.slots, size.tick_clocks, size.ticks)
    words = (settings.increment, 92, 60, 65535)
    steps = []
    for clock in range(350_000 if duty == 1500 else 0):
        _, _, slot = phase.clock(*words)
        if slot is not None:
            steps.append((clock, slot))
    if steps:
        twin.on_again(steps[0][0])
        found = [twin.next([1] * 6) for _ in range(3)]
        assert steps[:96] == [(p.start - size.lead + k, n) for p in found for n, k in enumerate(p.slots)]
        twin.reset()
    twin.on_again(1000)
    seventh, frame, seen, before = 0, [0] * 6, Counter(), 0
    for n in range(5000):
        given = None
        if draw.random() < 0.01:
            frame = given = [draw.choice([0, 1, 9, 200]) for _ in range(6)]
        if n % 50 == 0:
            frame = given = [255, *frame[1:]]
        wrap = twin.wrap
        period = twin.next(given)
        now = wrap // 6250 // 5715  # sevenths that ended before this clock
        length = (wrap + 1) // 6250 - (before + 1) // 6250 if n else 0
        burst = n == 0 or (n - 1) % 92 < 60
        levels, kept_off = lists.period(frame, length, now > seventh, 14, 4, duty, watchdog, burst, n == 0)
        assert (period.levels.tolist(), period.limited) == (levels, kept_off), n
        seventh, before = now, wrap
        seen[bool(kept_off), any(levels)] += 1
    assert twin.wrap == 1000 + 1 - (-(5000 * WRAP) // settings.increment)
    assert len(seen) >= 3
