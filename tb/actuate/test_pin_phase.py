"""msn_pin_phase against the loop of tb/reference/pin_display.py, clock by clock, with settings, faults and
frames that change in any clock. Frequencies by count: the mean to 0.001 Hz, each period to one clock, both
ends and beyond."""

import random
from itertools import pairwise

import cocotb
import pytest

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


@quick
@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0005, 0.005, 0.05])
async def follows_the_loop(dut, rate):
    """Also: what runs is off in the clock of a fault, of no enable, and of frames that stop."""
    draw, (least, largest) = random.Random(f"{bench.SEED} {rate}"), limits(dut)
    await bench.start(dut, **QUIET)
    loop, put = loop_of(dut), {name: bench.putter(getattr(dut, name)) for name in QUIET}
    asked = {"cfg_increment_i": least, **{name: QUIET[name] for name in QUIET if name != "cfg_increment_i"}}
    kinds = {
        "cfg_increment_i": lambda: draw.choice(
            [0, least - 1, least, largest, largest + 1, draw.randint(least, largest)]
        ),
        "cfg_burst_period_i": lambda: draw.choice([0, 1, 2, 5, 7]),
        "cfg_burst_on_i": lambda: draw.choice([0, 1, 2, 5, 9]),
        "cfg_stop_i": lambda: draw.choice([0, 20, 200, 65535]),
        **{"fault_i": lambda: draw.random() < 0.2, "cfg_enable_i": lambda: draw.random() < 0.8},
        **{"frame_valid_i": lambda: draw.random() < 0.5, "idle_i": lambda: draw.random() < 0.8},
    }
    seen, waited, ended = set(), 0, 0
    for _ in range(12000):
        for name, pick in kinds.items():
            if draw.random() < rate * (4 if name == "frame_valid_i" else 1):
                asked[name] = int(pick())
        for name, given in asked.items():
            put[name](given)
        await bench.ReadOnly()
        was = loop.running
        held = loop.silent, loop.burst_on
        begins, off, slot = loop.clock(
            *(asked[f"cfg_{name}_i"] for name in ("increment", "burst_period", "burst_on", "stop", "enable")),
            *(asked[name] for name in ("fault_i", "frame_valid_i", "idle_i")),
        )
        got = [bench.high(getattr(dut, name)) for name in REST]
        assert got == [was, off, begins, bench.high(dut.step_o) if off else slot is not None, loop.turned]
        if slot is not None:
            assert bench.read(dut.slot_o) == slot
        if was and waited > 1 and not off:
            assert (bench.high(dut.silent_o), bench.high(dut.burst_o)) == held
        if begins or off:
            ended = loop.length
        if begins or (waited == -1 and not was):  # with the beginning, and after the end until it is read
            assert bench.read(dut.length_o) == ended
        waited = (-1 if off else 0) if not was or off else waited + 1
        seen.add((was, off, begins))
        await bench.RisingEdge(dut.clk_i)
    assert {(True, True, False), (True, False, True), (False, False, False)} <= seen


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
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "running_o", "off_o", "begin_o", "step_o")


EVIDENCE = {
    "equivalence": {
        "size": {"ClkKhz": 520, "MinHz": 400, "MaxHz": 1000, "SlotBits": 3, "TickClocks": 20, "Ticks": 65}
    },
    "faults": {
        "none": "no frames: an upset of the phase moves one wrap, of a counter one seventh or one burst"
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
    ):
        ((name, number),) = wrong.items()
        assert f"{name} = {number} must" in bench.refuses("pin_phase", wrong)


@pytest.mark.parametrize("clk_khz", [12_000, 25_000, 48_000, 100_000])
def test_every_frequency_is_met_within_a_thousandth(clk_khz):
    """The mean is increment clk / 2^40: the nearest increment is within 2^-41 clk, 0.00005 Hz at 100 MHz."""
    draw = random.Random(bench.SEED)
    for hz in (1, 230, 400, *(round(draw.uniform(1, 400), 4) for _ in range(200))):
        assert abs(increment_of(hz, clk_khz) * 1000 * clk_khz / WRAP - hz) < 0.001
    least, largest = DisplaySize(clk_khz=clk_khz).limits
    assert least <= increment_of(1, clk_khz) <= least + 1  # or 1 Hz would be off
    assert largest <= increment_of(400, clk_khz) <= largest + 1  # which counts as the largest
