"""msn_pin_limits against the lists of tb/reference/pin_display.py: random frames, limits met exactly and
missed by one, sevenths that end in any clock, pauses, silent periods and bursts. At most `most` pins and no
pin for more than its duty in any seven sevenths, counted from what leaves."""

import random

import cocotb
import pytest

import bench
from reference.pin_display import Limits

SIZES = [{"Pins": 5, "AmplitudeBits": 2}, {"Pins": 35, "AmplitudeBits": 1}]
REST = {"running_i": 0, "begin_i": 0, "off_i": 0, "silent_i": 0, "burst_i": 1, "length_i": 0, "turn_i": 0}
REST |= {"cfg_top_i": 1, "cfg_most_i": 4095, "cfg_duty_i": 65535, "cfg_watchdog_i": 15, "frame_level_i": 0}


class Driven:
    """The block's surroundings: a store of frames, and the levels of each pass."""

    def __init__(self, dut):
        self.dut, self.frame, self.levels, self.done = dut, [0] * dut.Pins.value.to_unsigned(), [], 0
        self.read, self.whole, self.begun = [0, 0], True, 0

    async def clock(self, **pulses):
        dut = self.dut
        for name in ("begin_i", "off_i", "turn_i"):
            getattr(dut, name).value = pulses.get(name, 0)
        dut.frame_level_i.value = self.read[0]
        await bench.ReadOnly()
        self.read = [self.read[1], self.frame[min(bench.read(dut.frame_place_o), len(self.frame) - 1)]]
        if bench.high(dut.out_valid_o):
            self.levels.append(bench.read(dut.out_level_o))
            assert not self.whole or bench.high(dut.out_last_o) == (len(self.levels) == len(self.frame))
        self.done += bench.high(dut.frame_done_o)
        self.begun += bench.high(dut.frame_begun_o)
        busy = bench.high(dut.busy_o)
        await bench.RisingEdge(dut.clk_i)
        return busy

    async def run(self):
        """Until no pass is under way."""
        await self.clock()
        while await self.clock():
            pass

    async def period(self, length, **pulses):
        self.levels, self.done, self.begun = [], 0, 0
        self.dut.length_i.value = length
        await self.clock(begin_i=1, **pulses)
        self.dut.length_i.value = 4000  # valid in the clock of the beginning
        await self.run()
        assert self.done == 1 and self.begun == len(self.frame) + 2  # until the last level has come
        return self.levels


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(duty=[40, 250, 65535], watchdog=[1, 15])
async def follows_the_lists(dut, duty, watchdog):
    draw = random.Random(f"{bench.SEED} {duty} {watchdog}")
    pins, bits = dut.Pins.value.to_unsigned(), dut.AmplitudeBits.value.to_unsigned()
    await bench.start(dut, **REST | {"cfg_duty_i": duty, "cfg_watchdog_i": watchdog, "running_i": 1})
    drive, lists = Driven(dut), Limits(pins, bits)
    highest = (1 << bits) - 1
    dut.cfg_top_i.value = highest
    top, most, waits, silent, kinds, before, base, spent = highest, 4095, 0, True, set(), [0] * pins, 9, []
    for n in range(180):
        if draw.random() < 0.3:
            drive.frame = [min(draw.choice([0, 0, 1, 2, 3]), highest) for _ in range(pins)]
        if draw.random() < 0.1:
            drive.frame = [highest * (draw.random() < 0.9)] * pins
        if draw.random() < 0.1:
            most, top = draw.choice([0, 1, 3, pins - 1, pins, 4095]), min(draw.choice([0, 1, 2, 3]), highest)
            dut.cfg_most_i.value, dut.cfg_top_i.value = most, top
        length, turns, burst = base + draw.randint(0, 1), draw.random() < 0.25, draw.random() < 0.8
        silent = silent or draw.random() < 0.1
        dut.silent_i.value, dut.burst_i.value = silent, burst
        got = await drive.period(length, turn_i=turns)  # in the clock of the beginning: for the next pass
        expected, kept_off = lists.period(
            drive.frame, length, waits, top, most, duty, watchdog, burst, silent
        )
        assert got == expected, n
        assert bench.read(dut.pins_o) == len(lists.on) <= most and bench.read(dut.limited_o) == kept_off
        spent.append((lists.seventh, [length if level else 0 for level in before]))
        base, before, waits = draw.choice([1, 2, 9, 20]) if silent else base, got, turns
        kinds.add((bool(kept_off), bool(lists.on)))
        silent = draw.random() < 0.05
        if silent:  # a pause in the middle of a period, with sevenths that end in it
            await drive.clock(off_i=1)
            dut.running_i.value, dut.length_i.value = 0, 1
            await drive.run()
            lists.off(1, waits)
            spent.append((lists.seventh, [1 if level else 0 for level in before]))
            for _ in range(draw.choice([0, 1, 11])):
                await drive.clock(turn_i=1)
                await drive.run()
                lists.off(0, 1)
            assert bench.high(dut.idle_o) and bench.read(dut.pins_o) == 0
            waits, dut.running_i.value, before = 0, 1, [0] * pins
    assert (False, True) in kinds and ((True, True) in kinds or duty == 40)
    for pin in range(pins):  # a period's ticks are charged as it ends, as if it all lay in that seventh
        for last in range(lists.seventh):
            assert sum(row[pin] for seventh, row in spent if last - 7 <= seventh <= last) <= duty


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def meets_the_duty_exactly(dut):
    """Periods of 9 ticks are charged 10; the next one needs room for 11: at a duty of 51 the fifth is driven,
    at 50 not. The pin is on again after eight sevenths more."""
    pins = dut.Pins.value.to_unsigned()
    for duty, periods in ((50, 4), (51, 5)):
        await (bench.start(dut, **REST | {"running_i": 1}) if duty == 50 else bench.reset(dut))
        dut.cfg_duty_i.value, drive = duty, Driven(dut)
        drive.frame = [1] * pins
        got = [(await drive.period(9))[0] for _ in range(periods + 3)]
        assert got == [1] * periods + [0] * 3
        for seventh in range(8):
            await drive.clock(turn_i=1)
            assert (await drive.period(9))[0] == (seventh == 7), seventh


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def switches_off_a_pin_that_stays_on(dut):
    """With a watchdog of 2 at the third seventh that ends; a frame without it sets it free."""
    await bench.start(dut, **REST | {"running_i": 1, "cfg_watchdog_i": 2})
    drive, pins = Driven(dut), dut.Pins.value.to_unsigned()
    drive.frame = [1] + [0] * (pins - 1)
    for level in (1, 1, 1, 0, 0):
        assert await drive.period(2) == [level] + [0] * (pins - 1)
        await drive.clock(turn_i=1)
    assert bench.read(dut.limited_o) == 1
    drive.frame = [0] * pins
    await drive.period(2)
    drive.frame = [1] * pins
    assert await drive.period(2) == [1] * pins


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_period_may_end_within_its_pass(dut):
    """In any clock of it, with a seventh: the pass goes on, then another charges what was driven. The first
    seventh ends at rest."""
    pins, bits = dut.Pins.value.to_unsigned(), dut.AmplitudeBits.value.to_unsigned()
    await bench.start(dut, **REST | {"cfg_duty_i": 70})
    drive, lists, expected = Driven(dut), Limits(pins, bits), [1] * pins
    await drive.clock(turn_i=1)
    await drive.run()
    lists.off(0, 1)
    drive.frame = [1] * pins
    for clocks in (*range(pins + 6), 0, 0):
        turned = clocks % 3 == 1
        dut.running_i.value, drive.levels = 1, []
        expected, _ = lists.period(drive.frame, 9, 0, 1, 4095, 70, 15)
        dut.length_i.value = 9
        await drive.clock(begin_i=1)
        for _ in range(clocks):
            await drive.clock()
        dut.running_i.value, dut.length_i.value = 0, 11
        await drive.clock(off_i=1, turn_i=turned)
        await drive.run()
        assert drive.levels == expected, clocks
        lists.off(11, turned)
    assert expected == [0] * pins


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def sums_go_on_beyond_their_width(dut):
    """Eight sevenths of a period each have 8 x 7167 or 8 x 6000 ticks, ten more than 2^16. A pin that was on
    in all eight is off at a duty of as many and a period's room, less one. Also each `most`."""
    await bench.start(dut, **REST | {"running_i": 1})
    drive, pins = Driven(dut), dut.Pins.value.to_unsigned()
    drive.frame = [1] * pins
    for ticks in (7167, 6000):
        for n in range(30):
            dut.cfg_duty_i.value = 8 * ticks + ticks + 1 - (n == 27)
            assert (await drive.period(ticks - 1, turn_i=1))[0] == (n != 27), n
        await bench.reset(dut)
    for most in range(pins + 3):
        dut.cfg_most_i.value = most
        assert sum(await drive.period(1)) == min(most, pins)


@bench.applies(lambda dut: bench.whole(dut) and dut.Pins.value.to_unsigned() == 5)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_upset_leaves_with_the_window(dut):
    """A bit of what a pass holds and writes, of a pass that drives all pins or of the rest after it. Eight
    sevenths later the duty is met exactly, by each pin."""
    names = "sum_a sum_b begun_b total_a run_a_n on_a charge seventh full fresh due closing reading compose"
    names += " turning valid last place write_place counted_n drives keeps_off"
    await bench.start(dut, **REST | {"running_i": 1})
    drive, pins, draw = Driven(dut), dut.Pins.value.to_unsigned(), random.Random(bench.SEED)
    on, off = [1] * pins, [0] * pins

    async def rests():
        drive.frame, dut.cfg_duty_i.value = off, 51
        for _ in range(9):
            await drive.clock(turn_i=1)
            await drive.period(9)

    await rests()
    for signal in [getattr(dut, name) for name in names.split()]:
        for bit in range(len(signal)):
            drive.frame, drive.whole = on, False
            for n in range(3):
                await drive.clock(begin_i=1, turn_i=n == 1)
                for _ in range(draw.randrange(pins + 6)):
                    await drive.clock()
                if n == 1:
                    signal.value = bench.read(signal) ^ 1 << bit
                await drive.run()
            drive.whole = True
            await rests()
            drive.frame = on
            assert [await drive.period(9) for _ in range(7)] == [on] * 5 + [off] * 2, (signal._name, bit)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "out_valid_o", "busy_o", "pins_o", "limited_o", "frame_done_o")


EVIDENCE = {
    "equivalence": {"size": {"Pins": 5, "AmplitudeBits": 2}},
    "mutants": {"unsolved": True},
    # Drive periods of twelve sevenths: another period than without the upset is driven, within the duty.
    "faults": {
        "size": {"Pins": 5, "AmplitudeBits": 2},
        "settle": 48,
        "driver": {"frame": "begin_i", "strobe": "out_valid_o", "rows": 9000},
    },
}


@pytest.mark.parametrize("parameters", SIZES)
def test_pin_limits(parameters):
    bench.run("actuate", "pin_limits", parameters)


def test_refuses_illegal_parameters():
    for wrong in ({"Pins": 1}, {"Pins": 4096}, {"AmplitudeBits": 7}):
        ((name, number),) = wrong.items()
        assert f"{name} = {number} must" in bench.refuses("pin_limits", wrong)
