"""msn_scan with a matrix and converters that check what they see.

The matrix watches its lines in every clock: never two rows at once; when a converter starts, row and group
must have been constant for exactly the settle time, or the test fails, and they must stay so for the hold
time. Every taxel has a different value in every frame. Converters answer as late and as unevenly as their
cycle allows, and sometimes not at all. Beats, ids, numbers and time stamps against the twin, over array
sizes, orders, stalls and sleep, settle 0 and maximum, over-range on every sample, reset in the middle of a
frame.
"""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from frontend.test_scan_buffer import stalls
from frontend.test_scan_plan import NAMES, random_settings
from harness.refusals import refused
from meissner.twins.frontend.scan import LATENCY, PIN_CLOCKS, Scan
from meissner.twins.frontend.scan_plan import START, Settings

COUNTERS = ("dropped", "overrun", "held", "lost")


def twin_of(dut):
    names = NAMES | {"sample_bits": "SampleBits", "depth": "Depth", "overlap": "Overlap"}
    return Scan(**{name: getattr(dut, port).value.to_unsigned() for name, port in names.items()})


def apply(dut, settings):
    """Put these at the block's input, with the scan off."""
    return members.Settings(dut, "scan_cfg", **vars(settings))


def counts(dut):
    return members.of("scan_status", bench.read(dut.status_o))


class Matrix:
    """The array, its converters, and a record of the block's output."""

    def __init__(self, dut, settings):
        self.dut, self.settings = dut, settings
        self.twin = twin_of(dut)
        self.draw = random.Random(bench.SEED)
        self.stall = lambda: False
        self.lose = lambda conversion, lane: False  # whether the converter of this lane does not answer
        self.uneven = True
        self.over = lambda conversion, column: False
        self.clock = -1
        self.lines = (None, None)
        self.still = 0  # the clock of the lines' last change
        self.free = 0  # the first clock in which they may change
        self.triggers = []  # (clock at the pins, row, group, {(channel, lane): ..})
        self.coming = [[] for _ in range(self.twin.lanes)]  # per lane (clock of the offer, value, user)
        self.losing = [[] for _ in range(self.twin.lanes)]  # per lane the clocks of a lost strobe
        self.beats, self.held = [], None
        self.triggered = False
        self.origin = random.Random(f"{bench.SEED} {settings}").getrandbits(48)  # of time

    def time(self, clock):
        return (self.origin + clock) % (1 << 48)

    def value(self, row, column):
        """A different code for every taxel and conversion."""
        seed = (len(self.triggers) * 1_000_003 + row * 1009 + column) * 2654435761
        bits = self.twin.sample_bits
        return (seed >> 7) % (1 << bits) - (1 << bits - 1)

    def convert(self):
        """A conversion starts at the pins in this clock."""
        row, group = self.lines
        twin = self.twin
        settled = self.clock - self.still
        assert row is not None and settled == self.settings.settle, settled
        self.free = self.clock + twin.hold
        codes = {}
        number = len(self.triggers)
        # Uneven: the last sample may come as late as the cycle leaves time for the steps after it. With an
        # overlap, all this is as many clocks after the trigger, which was a clock ago.
        first = self.clock + max(1, twin.overlap)
        latest = first - 1 + twin.cycle - twin.channels - 6
        for lane in range(twin.lanes):
            lost = self.lose(number, lane)
            at = self.draw.randint(first, max(first, latest)) if self.uneven else first
            if lost:
                self.losing[lane].append(at)
            for channel in range(twin.channels):
                column = twin.column(group, channel, lane)
                code = (self.value(row, column), self.over(number, column))
                codes[channel, lane] = None if lost else code
                if not lost:
                    self.coming[lane].append((at + channel * (self.uneven and twin.cycle > 60), *code))
        self.triggers.append((self.clock, row, group, codes))

    async def run(self, clocks):
        dut, twin = self.dut, self.twin
        for _ in range(clocks):
            self.clock += 1
            mask = (1 << twin.sample_bits) - 1
            dut.now_i.value = self.time(self.clock)
            valid = data = user = lost = 0
            for lane in range(twin.lanes):
                noise = self.draw.getrandbits(twin.sample_bits)
                if self.coming[lane] and self.coming[lane][0][0] <= self.clock:
                    _, noise, over = self.coming[lane][0]
                    valid |= 1 << lane
                    user |= int(over) << lane
                data |= (noise & mask) << lane * twin.sample_bits
                if self.losing[lane] and self.losing[lane][0] == self.clock:
                    self.losing[lane].pop(0)
                    lost |= 1 << lane
            dut.in_valid_i.value, dut.in_data_i.value = valid, data
            dut.in_user_i.value, dut.in_lost_i.value = user, lost
            ready = not self.stall()
            dut.out_ready_i.value = int(ready)
            await ReadOnly()
            self.watch_lines()
            if self.triggered:
                self.convert()
            self.triggered = dut.trigger_o.value == 1
            for lane in range(twin.lanes):
                if valid >> lane & 1 and bench.read(dut.in_ready_o) >> lane & 1:
                    self.coming[lane].pop(0)
            self.take(ready)
            await RisingEdge(dut.clk_i)

    def watch_lines(self):
        rows = bench.read(self.dut.row_o)
        assert rows & rows - 1 == 0, f"rows {rows:b} at once"
        row = rows.bit_length() - 1 if rows else None
        group = self.dut.group_o.value  # undefined before the first trigger
        lines = (row, int(group) if group.is_resolvable else None)
        if lines != self.lines:
            assert self.clock >= self.free, "the lines changed while a converter needed them"
            if row is not None and self.lines[0] is not None:
                assert row == self.lines[0], "two rows without a pause"
            self.lines, self.still = lines, self.clock

    def take(self, ready):
        port = lambda field: bench.read(getattr(self.dut, f"out_{field}_o"))
        valid = port("valid")
        assert valid or self.held is None, "valid was withdrawn"
        if not valid:
            return
        beat = tuple(port(field) for field in ("data", "id", "last", "user", "frame", "time"))
        assert self.held in (None, beat), "payload changed while stalled"
        self.held = None if ready else beat
        if ready:
            self.beats.append((self.clock, *beat))

    async def start(self):
        settings = apply(self.dut, self.settings)
        self.dut.now_i.value = self.origin
        inputs = {f"in_{name}_i": 0 for name in ("valid", "data", "user", "lost")}
        await bench.start(self.dut, **inputs)
        await self.run(5)
        settings.put(enable=1)
        self.still = self.clock + 1
        self.begin = self.clock + 1

    async def stop(self):
        apply(self.dut, self.settings)
        self.stall = lambda: False
        slot = self.twin.slot(self.settings.settle)
        await self.run(2 * self.twin.frame_clocks(self.settings.settle) + 3 * slot + 100)
        await self.run(self.twin.rows * self.twin.beats + 20)
        await ReadOnly()
        self.counts = counts(self.dut)
        await RisingEdge(self.dut.clk_i)

    def beat(self, codes, channel):
        """(data, user) of one channel of a conversion, with the lanes joined as the block does."""
        twin = self.twin
        data = user = 0
        for lane in range(twin.lanes):
            value, over = codes[channel, lane] or (0, True)
            data |= (value & (1 << twin.sample_bits) - 1) << lane * twin.sample_bits
            user |= int(over) << lane
        return data, user

    def expected(self, order):
        """Frames as they should leave: [(first clock at the pins, beats)].

        ``order``: the conversions, from the plan's twin.
        """
        twin, frames = self.twin, []
        for (clock, row, group, codes), conversion in zip(self.triggers, order):
            if conversion.first:
                frames.append((clock, {}))
            for channel in range(twin.channels):
                beat = group * twin.channels + channel
                if beat < twin.beats:
                    frames[-1][1][row * twin.beats + beat] = self.beat(codes, channel)
        return frames

    def check(self, lossless=True):
        """All output is right and complete, and every missing frame was counted."""
        conversions, _ = self.twin.schedule(self.settings, self.clock + 1)
        order = conversions[: len(self.triggers)]
        if self.counts["held"] == 0:
            pins = [self.begin + c.trigger + PIN_CLOCKS for c in order]
            assert [trigger[0] for trigger in self.triggers] == pins
        places = [(row, group) for _, row, group, _ in self.triggers]
        assert places == [(c.row, c.group) for c in order], self.settings
        frames, dropped = self.expected(order), self.counts["dropped"]
        left = {}
        for _, data, index, last, user, number, time in self.beats:
            left.setdefault(number, []).append((index, data, user, last, time))
        assert list(left) == sorted(left)
        assert len(frames) == len(left) + dropped, "frames that are neither sent nor counted"
        for number, beats in left.items():
            clock, codes = frames[number]
            assert [index for index, *_ in beats] == sorted(codes), f"frame {number} is not whole"
            assert [last for *_, last, _ in beats] == [False] * (len(codes) - 1) + [True]
            assert {time for *_, time in beats} == {self.time(clock)}
            assert [(data, user) for _, data, user, *_ in beats] == [codes[i] for i in sorted(codes)]
        assert dropped == 0 or not lossless
        return frames


async def scan(dut, settings, clocks, **attributes):
    matrix = Matrix(dut, settings)
    for name, value in attributes.items():
        setattr(matrix, name, value)
    await matrix.start()
    await matrix.run(clocks)
    await matrix.stop()
    return matrix


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, *COUNTERS, wraps=False)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def every_taxel_is_read_settled_and_in_its_place(dut):
    twin = twin_of(dut)
    for interleave in (False, True):
        for settle in (0, 1, 7):
            settings = Settings(settle=settle, interleave=interleave and twin.buffer.sorts)
            matrix = await scan(dut, settings, START + 3 * twin.frame_clocks(settle))
            frames = matrix.check()
            assert len(frames) >= 3
            # The last frame against the taxels themselves, by the twin's layout.
            clock, _codes = frames[-1]
            samples = np.zeros((twin.rows, twin.columns), dtype=np.int64)
            over = np.zeros(samples.shape, dtype=bool)
            for at, row, group, got in matrix.triggers:
                if at >= clock:
                    for (channel, lane), (value, high) in got.items():
                        column = twin.column(group, channel, lane)
                        if column < twin.columns:
                            samples[row, column], over[row, column] = value, high
            beats = [beat[1:5] for beat in matrix.beats[-twin.rows * twin.beats :]]
            surplus = twin.beats * twin.lanes - twin.columns
            for beat, whole in zip(beats, twin.frame(samples, over), strict=True):
                bits = twin.sample_bits * (
                    twin.lanes - (surplus if beat[1] % twin.beats == twin.beats - 1 else 0)
                )
                assert (beat[0] & (1 << bits) - 1, *beat[1:3]) == whole[:3]
                assert twin.coordinates(beat[1])[0] < twin.rows


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def latency_is_the_twins(dut):
    """If converters answer evenly, each beat leaves LATENCY clocks after its sample arrived."""
    twin = twin_of(dut)
    matrix = await scan(dut, Settings(settle=2), START + twin.frame_clocks(2), uneven=False)
    matrix.check()
    first_beat = matrix.beats[0]
    first = max(1, twin.overlap)
    assert first_beat[0] == matrix.triggers[0][0] + first + LATENCY
    frame = twin.rows * twin.beats
    channel = (twin.beats - 1) % twin.channels
    last_trigger = matrix.triggers[len(twin.places()) - 1][0]
    assert matrix.beats[frame - 1][0] == last_trigger + first + channel + LATENCY


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def orders_and_rates(dut):
    """Random registers of every kind, with followers of every kind."""
    draw = random.Random(bench.SEED)
    twin = twin_of(dut)
    for number in range(bench.rounds(24)):
        settings = random_settings(draw, twin)
        # Early and late ticks: test_scan_plan. Here frames are back to back, or there is only one.
        period = draw.getrandbits(twin.period_bits) | 1 << 16 if number % 5 == 4 else 0
        settings = Settings(settings.settle, period, settings.interleave and twin.buffer.sorts)
        kind = ("ready", "stalls", "sleeps")[number % 3]
        clocks = min(6000, START + 3 * twin.frame_clocks(settings.settle))
        matrix = await scan(dut, settings, clocks, stall=stalls(kind, draw))
        if matrix.counts["held"]:
            continue  # the plan's twin does not model frames held up
        matrix.check(lossless=False)
        assert kind != "ready" or matrix.counts["dropped"] == 0


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_consumer_that_sleeps_loses_whole_frames_only(dut):
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    frame = twin.frame_clocks(1)
    state = {"until": 0, "asleep": False}
    matrix = Matrix(dut, Settings(settle=1))

    def asleep():
        if matrix.clock >= state["until"]:
            state["asleep"] = not state["asleep"]
            state["until"] = matrix.clock + draw.randint(1, 3 * frame)
        return state["asleep"]

    matrix.stall = asleep
    await matrix.start()
    await matrix.run(12 * frame)
    await matrix.stop()
    if twin.buffer.sorts:
        assert matrix.counts["dropped"] > 0 and matrix.counts["held"] == 0
        assert len(matrix.check(lossless=False)) >= 10
    else:
        assert matrix.counts["held"] > 0 or twin.rows * twin.beats < 2 * twin.buffer.depth
        numbers = [beat[5] for beat in matrix.beats]
        assert len(numbers) % (twin.rows * twin.beats) == 0
        ids = [beat[2] for beat in matrix.beats]
        assert ids == list(range(twin.rows * twin.beats)) * (len(ids) // (twin.rows * twin.beats))
        assert len(set(numbers)) + matrix.counts["dropped"] == len(matrix.triggers) / len(twin.places())


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def lost_conversions_are_marked_and_frames_stay_whole(dut):
    """Conversions lost at random, all of them, and of each lane in turn."""
    twin, draw = twin_of(dut), random.Random(bench.SEED)
    for lose in (
        lambda conversion, lane: draw.random() < 0.2,
        lambda conversion, lane: True,
        lambda conversion, lane: conversion % twin.lanes == lane,
    ):
        clocks = START + 4 * twin.frame_clocks(0)
        matrix = await scan(dut, Settings(), clocks, lose=lose)
        matrix.check()
        lost = sum(any(code is None for code in codes.values()) for *_, codes in matrix.triggers)
        assert matrix.counts["lost"] == lost
    assert lost == len(matrix.triggers)
    matrix = Matrix(dut, Settings())
    matrix.lose = lambda conversion, lane: True
    await matrix.start()
    for start in bench.carries(dut.lost) if bench.whole(dut) else ():
        dut.lost.value = now = start
        for _ in range(4 * twin.slot(0) + 40):
            await matrix.run(1)
            before, now = now, counts(dut)["lost"]
            assert (now - before) % 2**32 <= 1
            if now != start:
                break
        assert now != start


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def over_range_on_every_sample(dut):
    twin = twin_of(dut)
    matrix = await scan(dut, Settings(), START + twin.frame_clocks(0), over=lambda *_: True)
    matrix.check()
    assert {beat[4] for beat in matrix.beats} == {(1 << twin.lanes) - 1}


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_tick_that_comes_too_early_is_counted(dut):
    twin, settings = twin_of(dut), Settings(1, period=1)
    matrix = Matrix(dut, settings)
    await matrix.start()
    clocks = START + 4 * twin.slot(1)
    await matrix.run(clocks)
    await ReadOnly()
    assert counts(dut)["overrun"] == twin.schedule(settings, clocks - 1)[1] > 0  # counted a clock later
    await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=400, timeout_unit="ms")
async def largest_settle(dut):
    twin = twin_of(dut)
    largest = (1 << twin.settle_bits) - 1
    settings = Settings(settle=largest)
    matrix = await scan(dut, settings, START + 2 * twin.slot(largest))
    matrix.check()
    assert len(matrix.triggers) >= 2


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def recovers_after_reset(dut):
    """Reset in mid-frame, with beats inside and a conversion in progress: lines low, then complete frames."""
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    frame = twin.frame_clocks(1)
    matrix = Matrix(dut, Settings(settle=1))
    matrix.stall = lambda: draw.random() < 0.6
    await matrix.start()
    for _ in range(5):
        await matrix.run(draw.randint(1, 2 * frame))
        dut.rst_i.value = 1
        await RisingEdge(dut.clk_i)
        dut.rst_i.value = 0
        # The converters are reset too: a conversion in progress gives nothing.
        matrix.coming = [[] for _ in range(twin.lanes)]
        matrix.losing = [[] for _ in range(twin.lanes)]
        matrix.beats, matrix.triggers, matrix.held = [], [], None
        matrix.clock += 1
        matrix.lines, matrix.free, matrix.triggered = (None, None), 0, False
        matrix.begin = matrix.clock + 1
        await ReadOnly()
        assert (dut.row_o.value, dut.out_valid_o.value) == (0, 0)
        await RisingEdge(dut.clk_i)
        matrix.clock += 1
    matrix.stall = lambda: False
    matrix.clock -= 1
    await bench.reset(dut)
    matrix.begin = matrix.clock + 1
    matrix.beats = []
    await matrix.run(START + 2 * frame)
    await matrix.stop()
    assert len(matrix.check()) >= 2


SIZES = [
    {"Rows": 1, "Columns": 1, "Channels": 1, "Cycle": 12, "SettleBits": 6},
    {"Rows": 1, "Columns": 19, "Channels": 4, "Cycle": 30, "SettleBits": 6},
    {"Rows": 9, "Columns": 1, "Channels": 1, "Cycle": 20, "Hold": 12, "SettleBits": 6},
    {"Rows": 3, "Columns": 3, "Channels": 3, "Cycle": 70, "Hold": 60, "SettleBits": 8, "SampleBits": 13},
    {"Rows": 2, "Columns": 5, "Channels": 3, "Lanes": 2, "Cycle": 20, "SettleBits": 6, "SampleBits": 13},
    {"Rows": 8, "Columns": 8, "Channels": 1, "Lanes": 8, "Cycle": 20, "SettleBits": 6},
    {"Rows": 6, "Columns": 21, "Channels": 2, "Lanes": 4, "Cycle": 24, "SettleBits": 6},
    {"Rows": 3, "Columns": 10, "Channels": 3, "Lanes": 3, "Cycle": 24, "SettleBits": 6},
    {"Rows": 2, "Columns": 17, "Channels": 4, "Lanes": 5, "Cycle": 20, "SettleBits": 6},
    {"Rows": 3, "Columns": 78, "Channels": 6, "Lanes": 6, "Cycle": 20, "SettleBits": 6},
    {"Rows": 5, "Columns": 64, "Channels": 5, "Lanes": 7, "Cycle": 80, "SettleBits": 6, "Depth": 32},
    pytest.param(
        {"Rows": 16, "Columns": 16, "Channels": 8, "Cycle": 40, "SettleBits": 6, "Depth": 64},
        marks=pytest.mark.long,
    ),
    {"Rows": 5, "Columns": 14, "Channels": 4, "Lanes": 2, "Cycle": 80, "SettleBits": 6, "Depth": 16},
    # Samples come while the next conversion runs: a frame's time is that of a trigger before the last one.
    {
        "Rows": 5,
        "Columns": 14,
        "Channels": 4,
        "Lanes": 2,
        "Cycle": 80,
        "SettleBits": 6,
        "Depth": 16,
        "Overlap": 79,
    },
    {"Rows": 1, "Columns": 1, "Channels": 1, "Cycle": 12, "SettleBits": 6, "Overlap": 11},
    {"Rows": 3, "Columns": 21, "Channels": 2, "Lanes": 4, "Cycle": 24, "SettleBits": 6, "Overlap": 2},
]


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3}, "defined": True, "boxes": True},
    "faults": {"inside": ["scan_adc", "u_scan."]},
}


@pytest.mark.parametrize("parameters", SIZES, ids=lambda p: "-".join(map(str, p.values())))
def test_scan(parameters):
    bench.run("frontend", "scan", parameters)


WHOLE = ("over_range_on_every_sample", "largest_settle")  # the tests of large arrays


@pytest.mark.parametrize(
    "rows, columns, lanes, tests",
    [
        (64, 56, 8, WHOLE),
        (2, 1024, 4, WHOLE),
        pytest.param(256, 256, 8, WHOLE, marks=pytest.mark.long),
    ],
)
def test_scan_large(rows, columns, lanes, tests):
    parameters = {"Rows": rows, "Columns": columns, "Channels": 8, "Lanes": lanes, "Cycle": 16}
    bench.run("frontend", "scan", parameters | {"SettleBits": 6}, test_filter="|".join(tests))


def test_refuses_illegal_parameters():
    """Its own limit; the others belong to msn_scan_plan and msn_scan_buffer."""
    assert "SampleBits" in bench.refuses("scan", {"SampleBits": 1})
    for overlap in (1, 30):
        assert "Overlap" in bench.refuses("scan", {"Cycle": 30, "Overlap": overlap})
    wrong = [{"overlap": 30, "cycle": 30}, {"overlap": 1}, {"overlap": -1}]
    refused(Scan, {"sample_bits": 1}, *wrong, {"depth": 16}, {"rows": 0}, {"lanes": 9})


def test_twin_refuses_frames_of_another_size():
    with pytest.raises(ValueError, match="a frame is"):
        Scan(rows=3, columns=3, channels=3).frame(np.zeros((3, 4)), np.zeros((3, 4)))
