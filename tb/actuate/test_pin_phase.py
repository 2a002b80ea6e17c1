"""msn_pin_phase against the loop of tb/reference/pin_display.py, clock by clock, with settings, faults and
frames that change in any clock. Frequencies by count: the mean to 0.001 Hz, each period to one clock, both
ends and beyond."""

import random
from itertools import pairwise

import cocotb
import pytest
from cocotb.utils import get_sim_time

import bench
from meissner.twins.actuate.pin_display import DisplaySize, increment_of
from reference.pin_display import WRAP, Phase

QUICK = {"ClkKhz": 520, "MinHz": 400, "MaxHz": 1000, "SlotBits": 3, "TickClocks": 20, "Ticks": 65}
QUIET = {"cfg_enable_i": 1, "cfg_increment_i": 0, "cfg_burst_period_i": 0, "cfg_burst_on_i": 0}
QUIET |= {"cfg_stop_i": 65535, "fault_i": 0, "frame_valid_i": 1, "idle_i": 1}
REST = ("running_o", "off_o", "begin_o", "step_o", "turn_o")


def value(dut, name):
    return getattr(dut, name).value.to_unsigned()


def limits(dut):
    hz = 1000 * value(dut, "ClkKhz")
    return tuple(value(dut, name) * WRAP // hz for name in ("MinHz", "MaxHz"))


def loop_of(dut):
    return Phase(*limits(dut), 1 << value(dut, "SlotBits"), value(dut, "TickClocks"), value(dut, "Ticks"))


quick = bench.applies(lambda dut: value(dut, "ClkKhz") == 520)


class Beside:
    """The loop beside the block: ``clock`` compares a clock of both, with the inputs ``asked``."""

    def __init__(self, dut, **asked):
        self.dut, self.loop, self.asked = dut, loop_of(dut), QUIET | asked
        self.put = {name: bench.putter(getattr(dut, name)) for name in QUIET}
        self.waited, self.ended, self.seen = 0, 0, set()

    def loops(self):
        loop, asked = self.loop, self.asked
        return loop.clock(
            *(asked[f"cfg_{name}_i"] for name in ("increment", "burst_period", "burst_on", "stop", "enable")),
            *(asked[name] for name in ("fault_i", "frame_valid_i", "idle_i")),
        )

    async def rest(self, clocks):
        """Clocks in which it does not run."""
        for name, given in self.asked.items():
            self.put[name](given)
        for _ in range(clocks):
            assert not self.loops()[0]
        await bench.clocks(self.dut, clocks)

    async def clock(self):
        dut, loop = self.dut, self.loop
        for name, given in self.asked.items():
            self.put[name](given)
        await bench.ReadOnly()
        was, held = loop.running, (loop.silent, loop.burst_on)
        begins, off, slot = self.loops()
        got = [bench.high(getattr(dut, name)) for name in REST]
        assert got == [was, off, begins, bench.high(dut.step_o) if off else slot is not None, loop.turned]
        if slot is not None:
            assert bench.read(dut.slot_o) == slot
        if was and self.waited > 1 and not off:
            assert (bench.high(dut.silent_o), bench.high(dut.burst_o)) == held
        if begins or off:
            self.ended = loop.length
        # With the beginning, and after the end until it is read.
        if begins or (self.waited == -1 and not was):
            assert bench.read(dut.length_o) == self.ended
        self.waited = (-1 if off else 0) if not was or off else self.waited + 1
        self.seen.add((was, off, begins))
        await bench.RisingEdge(dut.clk_i)


@quick
@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0005, 0.005, 0.05])
async def follows_the_loop(dut, rate):
    """Also: what runs is off in the clock of a fault, of no enable, and of frames that stop."""
    draw, (least, largest) = random.Random(f"{bench.SEED} {rate}"), limits(dut)
    await bench.start(dut, **QUIET)
    here = Beside(dut, cfg_increment_i=least)
    kinds = {
        "cfg_increment_i": lambda: draw.choice(
            [
                *(0, least - 1, least, largest, largest + 1, (1 << 32) - 1),
                *(largest - 1, largest - draw.randrange(1 << draw.randrange(1, 20))),
                *(draw.randint(least, largest), 1 << draw.randrange(32), draw.getrandbits(32)),
            ]
        ),
        "cfg_burst_period_i": lambda: draw.choice([0, 0, 1, 2, 5, 7, 1 << draw.randrange(12), 4095]),
        "cfg_burst_on_i": lambda: draw.choice([0, 1, 1, 2, 5, 9, 1 << draw.randrange(12), 4095]),
        "cfg_stop_i": lambda: draw.choice([0, 20, 200, 65535]),
        **{"fault_i": lambda: draw.random() < 0.2, "cfg_enable_i": lambda: draw.random() < 0.8},
        **{"frame_valid_i": lambda: draw.random() < 0.5, "idle_i": lambda: draw.random() < 0.8},
    }
    for _ in range(12000):
        for name, pick in kinds.items():
            if draw.random() < rate * (4 if name == "frame_valid_i" else 1):
                here.asked[name] = int(pick())
        await here.clock()
    assert {(True, True, False), (True, False, True), (False, False, False)} <= here.seen


@quick
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_seventh_ends_in_any_clock_of_a_start_of_a_wrap_and_of_an_end(dut):
    """A seventh has 1300 clocks, a period at 800 Hz 650."""
    await bench.start(dut, **QUIET | {"cfg_enable_i": 0})
    for early in range(-3, 8):
        await bench.reset(dut)
        here = Beside(dut, cfg_increment_i=-(-WRAP // 650), cfg_enable_i=0)
        await here.rest(1300 + early - 5)
        here.asked["cfg_enable_i"] = 1
        for _ in range(10):
            await here.clock()
        await bench.reset(dut)
        here = Beside(dut, cfg_increment_i=-(-WRAP // 650), cfg_enable_i=0)
        await here.rest(650 + early - 3)
        here.asked["cfg_enable_i"] = 1
        for _ in range(660):
            await here.clock()
        await bench.reset(dut)
        here = Beside(dut, cfg_increment_i=-(-WRAP // 650), cfg_enable_i=0)
        await here.rest(1270)
        for n in range(50):
            here.asked["cfg_enable_i"] = int(n < 28 + early)
            await here.clock()


@quick
@cocotb.test(timeout_time=3, timeout_unit="ms")
async def bursts_are_counted_in_periods(dut):
    """By hand; the first period after a start and after a change of the frequency is silent."""
    least, largest = limits(dut)
    await bench.start(dut, **QUIET | {"cfg_increment_i": largest})
    for period, on, slower, expected in (
        (5, 2, 0, "1 11000 11000 110"),
        (3, 1, 0, "0 100 100 1"),  # in the fourth period: over
        (11, 9, 0, "11111111 00 11111111100 1111"),  # in the second one
        (2, 1, 1, "0 10 10 10 1"),  # in the fifth: over; another frequency, so the next begins again
        (150, 149, 0, "1" + 149 * "1" + "0" + "11"),
        (0, 0, 1, "111"),
        (1, 1, 1, "111"),
        (4, 4, 1, "1111 111"),
        (4, 0, 1, "0000"),
    ):
        dut.cfg_burst_period_i.value, dut.cfg_burst_on_i.value = period, on
        dut.cfg_increment_i.value = least if slower else largest
        got = ""
        for _ in expected.replace(" ", ""):
            await bench.RisingEdge(dut.begin_o)
            await bench.clocks(dut, 2)
            got += str(int(bench.high(dut.burst_o)))
        assert got == expected.replace(" ", ""), (period, on)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(share=[0.0, 0.37, 1.0])
async def keeps_the_frequency(dut, share):
    """Mean and single periods, by the clocks of ``begin_o``."""
    least, largest = limits(dut)
    increment = round(least + share * (largest - least))
    await bench.start(dut, **QUIET | {"cfg_increment_i": increment})
    times, slots, edge, now = [], 0, bench.RisingEdge(dut.clk_i), 0
    while len(times) <= 20:
        await bench.ReadOnly()
        if bench.high(dut.begin_o):
            assert not times or slots == 1 << value(dut, "SlotBits")
            times.append(now)
            slots = 0
        slots += bench.high(dut.step_o)
        now += 1
        await edge
    exact = WRAP / increment
    lengths = [b - a for a, b in pairwise(times[1:])]
    assert {abs(length - exact) < 1 for length in lengths} == {True}
    assert abs(times[-1] - times[1] - exact * len(lengths)) < 1


@quick
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stop=[3, 0x2C35])
async def is_off_with_the_tick_of_stop(dut, stop):
    """Ticks that end after the clock of the wrap that takes the last frame."""
    _, largest = limits(dut)
    clocks, ticks = lambda: round(get_sim_time("ns")) // 10, value(dut, "TickClocks")
    await bench.start(dut, **QUIET | {"cfg_increment_i": largest, "cfg_stop_i": stop})
    zero = clocks()
    for _ in range(3):
        await bench.RisingEdge(dut.begin_o)
    taken = clocks() - zero
    await bench.clocks(dut, 1)
    dut.frame_valid_i.value = 0
    await bench.RisingEdge(dut.off_o)
    assert clocks() - zero == (taken + 1) // ticks * ticks + stop * ticks


@bench.applies(lambda dut: value(dut, "ClkKhz") == 520 and bench.whole(dut))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_period_that_does_not_end_is_ended(dut):
    """An upset leaves the phase without an increment: all is off with the 6144th tick, later than the longest
    period ends, though frames go on; then periods begin again."""
    _, largest = limits(dut)
    clocks = lambda: round(get_sim_time("ns")) // 10
    await bench.start(dut, **QUIET | {"cfg_increment_i": largest})
    await bench.RisingEdge(dut.begin_o)
    await bench.clocks(dut, 2)
    begun, to_tick = clocks(), value(dut, "TickClocks") - 1 - bench.read(dut.tick_clocks)
    dut.increment.value = 0
    await bench.RisingEdge(dut.off_o)
    assert clocks() - begun == to_tick + 6143 * value(dut, "TickClocks")
    await bench.RisingEdge(dut.begin_o)
    begun = clocks()
    await bench.RisingEdge(dut.begin_o)
    assert clocks() - begun in (WRAP // largest + 1, WRAP // largest + 2)


@quick
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "running_o", "off_o", "begin_o", "step_o")


EVIDENCE = {
    "equivalence": {
        "size": {"ClkKhz": 520, "MinHz": 400, "MaxHz": 1000, "SlotBits": 3, "TickClocks": 20, "Ticks": 65}
    },
    "faults": {
        "size": {"ClkKhz": 520, "MinHz": 400, "MaxHz": 1000, "SlotBits": 3, "TickClocks": 20, "Ticks": 65},
        "settle": 1200,
        # All begins again where a fault, in place of a frame, has switched it off. Where in time the sevenths
        # end is arbitrary: an upset that moves them moves them for good.
        "driver": {"frame": "fault_i", "kept": "tick_clocks ticks", "rows": 12000},
    },
}


@pytest.mark.parametrize("parameters", [QUICK])
def test_pin_phase(parameters):
    bench.run("actuate", "pin_phase", parameters)


def test_refuses_illegal_parameters():
    for wrong in (
        {"ClkKhz": 0},
        {"MinHz": 401},
        {"SlotBits": 8},
        {"Ticks": 3999},
        {"Ticks": 5716},
        {"TickClocks": 15_626},
        {"MaxHz": 48_829},
        {"MaxHz": 1000, "ClkKhz": 512},  # an increment of 32 bits
    ):
        name, number = next(iter(wrong.items()))
        assert f"{name} = {number} must" in bench.refuses("pin_phase", wrong)
    with pytest.raises(ValueError, match="max_hz = 1000 must"):
        DisplaySize(pins=2, clk_khz=512, max_hz=1000)


@pytest.mark.parametrize("clk_khz", [12_000, 25_000, 48_000, 100_000])
def test_every_frequency_is_met_within_a_thousandth(clk_khz):
    """The mean is increment clk / 2^40: the nearest increment is within 2^-41 clk, 0.00005 Hz at 100 MHz."""
    draw = random.Random(bench.SEED)
    for hz in (1, 230, 400, *(round(draw.uniform(1, 400), 4) for _ in range(200))):
        assert abs(increment_of(hz, clk_khz) * 1000 * clk_khz / WRAP - hz) < 0.001
    least, largest = DisplaySize(clk_khz=clk_khz).limits
    assert least <= increment_of(1, clk_khz) <= least + 1  # or 1 Hz would be off
    assert largest <= increment_of(400, clk_khz) <= largest + 1  # which counts as the largest
