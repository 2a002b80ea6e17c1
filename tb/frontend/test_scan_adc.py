"""msn_scan_adc at the pins: matrix, column multiplexer and part models that check every limit of the parts.

When a part samples it asks the matrix, which answers with the taxel that the lines select at that moment, and
fails the test unless they have been constant for the settle time. Every taxel has a different code in every
conversion. Each step's clocks against the twin; a part that fails in mid-frame.
"""

import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge, ValueChange

import bench
from frontend.test_scan import apply, counts
from meissner.twins.frontend.adc_spi import AD7606, AD7606C, MAX11123, MAX11131, MCP3208, PARTS
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.frontend.scan_plan import Settings
from parts import ad7606, ad7606c, max1112x, mcp3208
from parts.timing import Line, now

CONVERSION_NS = {AD7606: (4017.3, 3512.0), AD7606C: (617.3, 512.0)}  # on lane 0, and on the other lanes


def twin_of(dut):
    value = lambda name: getattr(dut, name).value.to_unsigned()
    return ScanAdc(
        *(value(name) for name in ("Rows", "Columns", "Lanes")),
        PARTS[value("Part")],
        *(value(name) for name in ("Channels", "AdcLanes", "ClkKhz", "SclkKhz", "SampleBits")),
        *(value(name) for name in ("Depth", "ReadDuring")),
    )


class Board:
    """The matrix and its parts; the block's output by clock."""

    def __init__(self, dut, settings):
        self.dut, self.settings, self.twin = dut, settings, twin_of(dut)
        self.scan = self.twin.scan
        self.clock_ns = 1e6 / self.twin.clk_khz
        self.moved = 0.0
        self.converted = 0.0
        self.number = -1  # of the conversion in progress
        self.converts, self.beats = [], []
        self.clock = 0
        self.shared = False  # the pins of lane 0 drive all parts, which convert as long as they like
        # Time wraps around to 0 in the middle of the frames.
        self.wrap = 3 * self.scan.frame_clocks(settings.settle) // 2 + self.twin.adc.start_clocks()

    def time(self, clock):
        return (clock - self.wrap) % (1 << 48)

    def code(self, lane, channel, time):
        """The value that the part on ``lane`` samples now from its input ``channel``."""
        rows = int(self.dut.row_o.value)
        assert rows & rows - 1 == 0
        settled = time - self.moved
        assert settled >= self.settings.settle * self.clock_ns - 0.01, f"settled for {settled} ns"
        row = rows.bit_length() - 1
        assert row >= 0, "no row is driven"
        column = self.scan.column(int(self.dut.group_o.value), channel, lane)
        return self.value(self.number, row, column)

    def value(self, number, row, column):
        bits = self.twin.part.data_bits
        return ((number * 4099 + row * 257 + column) * 2654435761 >> 5) % (1 << bits)

    async def watch_lines(self):
        last = (int(self.dut.row_o.value), int(self.dut.group_o.value))
        while True:
            await ValueChange(self.dut.row_o)
            lines = (int(self.dut.row_o.value), int(self.dut.group_o.value))
            if lines != last:
                self.moved = now()
            last = lines

    async def watch_group(self):
        while True:
            await ValueChange(self.dut.group_o)
            self.moved = now()

    async def start(self):
        dut, twin = self.dut, self.twin
        for name in ["rst", "out_ready", "adc_miso", "adc_busy", "now", "clk"]:
            getattr(dut, f"{name}_i").value = int(name == "rst")
        driven = {}
        settings = apply(dut, self.settings)
        Clock(dut.clk_i, 1_000_000_000 // twin.clk_khz, unit="ps").start()
        await bench.clocks(dut, 3)
        self.parts = []
        for lane in range(twin.lanes):
            pin = lambda name, width=1, lane=lane: Line(getattr(dut, f"adc_{name}"), lane, driven, width)
            own = lambda name, pin=pin: pin(name, lane=0) if self.shared else pin(name)
            code = lambda channel, time, lane=lane: self.code(lane, channel, time)
            if twin.part is MCP3208:
                part = mcp3208.Mcp3208(pin("cs_n_o"), pin("sclk_o"), pin("mosi_o"), pin("miso_i"), code)
            elif twin.part.has_busy:
                pins = [own("cs_n_o"), own("sclk_o"), *[own("mosi_o")] * bool(twin.part.setup)]
                pins += [pin("miso_i", twin.adc_lanes), own("convst_o"), pin("busy_i"), own("reset_o")]
                model = ad7606c.Ad7606c if twin.part.setup else ad7606.Ad7606
                lasts = None if self.shared else CONVERSION_NS[twin.part][min(lane, 1)]
                part = model(*pins, code, conversion_ns=lasts)
                part.draw.seed(lane)
            else:
                pins = [pin(name) for name in ("cs_n_o", "sclk_o", "mosi_o", "miso_i")]
                # A frame's first word samples too, but that code is not used.
                limits = max1112x.FAST if twin.part is MAX11131 else None
                part = max1112x.Max1112x(*pins, twin.part.data_bits, self.lenient(code), limits)
            self.parts.append(part)
        await bench.clocks(dut, 3)
        dut.rst_i.value = 0
        for task in (self.watch_lines(), self.watch_group(), self.count()):
            cocotb.start_soon(task)
        dut.out_ready_i.value = 1
        settings.put(enable=1)

    def lenient(self, code):
        """``code``, but 0 for samples that are not used: in a frame's first word and in words of a setup."""
        hold_ns = self.twin.adc.hold_clocks() * self.clock_ns

        def sample(channel, time):
            asked = self.clock_ns / 2 < time - self.converted < hold_ns
            return code(channel, time) if asked else 0

        return sample

    async def run(self, clocks):
        dut = self.dut
        for _ in range(clocks):
            dut.now_i.value = self.time(self.clock)
            await ReadOnly()
            if dut.convert_o.value == 1:
                self.converts.append(self.clock)
            if dut.out_valid_o.value == 1:
                fields = ("data", "id", "last", "user", "frame", "time")
                self.beats.append((self.clock, *(bench.read(getattr(dut, f"out_{f}_o")) for f in fields)))
            await RisingEdge(dut.clk_i)
            self.clock += 1

    async def count(self):
        """Count the triggers, including those that a part in its setup cannot follow."""
        while True:
            await ValueChange(self.dut.trigger)
            if int(self.dut.trigger.value):
                self.number += 1
                self.converted = now() + self.clock_ns

    def expected(self, conversions):
        """[(the number of a frame's first conversion, {id: (data, user)})]."""
        twin, scan = self.twin, self.scan
        frames = []
        mask = (1 << twin.sample_bits) - 1
        for number, conversion in enumerate(conversions):
            if conversion.first:
                frames.append((number, {}))
            for channel in range(twin.channels):
                beat = conversion.group * twin.channels + channel
                codes = [
                    self.value(number, conversion.row, scan.column(conversion.group, channel, lane))
                    for lane in range(twin.lanes)
                ]
                data, over = twin.adc.samples(codes)
                word = sum((int(v) & mask) << lane * twin.sample_bits for lane, v in enumerate(data))
                user = sum(int(o) << lane for lane, o in enumerate(over))
                if beat < scan.beats:
                    frames[-1][1][conversion.row * scan.beats + beat] = (word, user)
        return frames

    def check(self):
        conversions, _ = self.scan.schedule(self.settings, self.clock)
        begin = self.converts[0] - conversions[0].trigger
        assert self.converts == [begin + c.trigger for c in conversions][: len(self.converts)]
        frames = self.expected(conversions[: len(self.converts)])
        at = 0
        for index, (number, codes) in enumerate(frames[:-1]):  # the last may be incomplete
            part = self.beats[at : at + len(codes)]
            at += len(codes)
            assert [(beat[2], beat[1], beat[4]) for beat in part] == [(i, *codes[i]) for i in sorted(codes)]
            assert [beat[3] for beat in part] == [0] * (len(codes) - 1) + [1]
            assert {beat[5] for beat in part} == {index}
            assert {beat[6] for beat in part} == {self.time(self.converts[number])}
        assert not self.counted()
        busy, setup = self.twin.part.has_busy, bool(self.twin.part.setup)
        idle = ["mosi"] * (busy and not setup) + ["convst", "reset"] * (not busy)
        assert not any(bench.read(getattr(self.dut, f"adc_{name}_o")) for name in idle)

    def counted(self):
        """Names of the counters that are not 0."""
        return {name for name, count in counts(self.dut).items() if count}


async def board(dut, settings, clocks):
    made = Board(dut, settings)
    await made.start()
    await made.run(made.twin.adc.start_clocks() + clocks)
    await ReadOnly()
    return made


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "row_o", "convert_o", "adc_convst_o", "out_valid_o")


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(settle=[0, 23])
async def every_taxel_in_its_place_in_its_clock(dut, settle):
    twin = twin_of(dut)
    settings = Settings(settle=settle, interleave=settle > 0 and twin.scan.buffer.sorts)
    frame = twin.scan.frame_clocks(settle)
    made = await board(dut, settings, 2 * frame + 2 * twin.scan.slot(settle) + 40)
    made.check()
    assert len(made.beats) >= 2 * twin.rows * twin.scan.beats

    steps = twin.latency(settle, conversion_ns=CONVERSION_NS.get(twin.part, [0])[0])
    first = made.converts[0]
    per_frame = len(twin.scan.places())
    assert made.converts[1] - first == steps["slot"]
    assert made.converts[per_frame] - first == steps["frame"]
    assert made.beats[0][0] - first == steps["first_beat"]
    last = made.beats[twin.rows * twin.scan.beats - 1]
    if not settings.interleave or twin.rows % 2 == 0:  # otherwise the last row is not converted last
        assert last[0] - first == steps["last_beat"]
    us = [1000 * value / twin.clk_khz for value in (last[0] - first, steps["frame"])]
    dut._log.info(f"settle {settle}: frame {us[1]:.1f} us, first convert to last beat {us[0]:.1f} us")


@bench.applies(lambda dut: twin_of(dut).part.has_busy and twin_of(dut).lanes > 1, long=True)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def parts_that_share_their_lines_are_read_together(dut):
    """One CS, SCLK, CONVST and RESET for all parts, each of which converts as long as it likes."""
    settle = 5
    made = Board(dut, Settings(settle))
    made.shared = True
    await made.start()
    await made.run(made.twin.adc.start_clocks() + 3 * made.twin.scan.frame_clocks(settle))
    await ReadOnly()
    made.check()
    assert len(made.beats) >= 2 * made.twin.rows * made.twin.scan.beats
    assert len({part.draw.random() for part in made.parts}) == made.twin.lanes


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(turn=range(4))
async def settings_of_any_size(dut, turn):
    """Random orders, settle times and periods."""
    twin, draw = twin_of(dut), random.Random(4 * bench.SEED + turn)
    settle = draw.randrange(min(twin.scan.cycle, 1 << 16))
    period = (1 + turn % 2) * twin.scan.frame_clocks(settle) + draw.randrange(256)
    settings = Settings(settle, period, twin.scan.buffer.sorts and draw.random() < 0.5)
    made = await board(dut, settings, min(4 * period, 15_000))
    made.check()
    assert made.converts


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def long_times_are_long(dut):
    """Each bit of settle time and period above those of the other tests: no further conversion starts for
    long.

    Period bits are tested one by one if a frame is short; otherwise every second bit together, then the
    others."""
    twin = twin_of(dut)
    scan, slot = twin.scan, twin.scan.slot(1)
    frame = scan.frame_clocks(1) + slot
    bits = range(frame.bit_length(), 32)
    lone = [1 << bit for bit in bits]
    periods = lone if frame < 1000 else [sum(lone[::2]), sum(lone[1::2])]
    settles = range((2 * slot).bit_length(), 16)
    cases = [(Settings(1 << bit), 2 * slot) for bit in settles]
    cases += [(Settings(1, period), frame) for period in periods]
    made = await board(dut, cases[0][0], 0)
    for settings, watched in cases:
        await RisingEdge(dut.clk_i)
        apply(dut, made.settings)
        await bench.clocks(dut, 2 * slot)
        await bench.reset(dut)  # a conversion in its settle time would go on
        made.converted = float("-inf")  # nor are the words of the setup samples of a conversion before it
        made.settings = settings
        apply(dut, settings).put(enable=1)
        made.converts.clear()
        await made.run(twin.adc.start_clocks() + watched)
        await ReadOnly()
        told = [c for c in scan.schedule(settings, watched)[0] if c.trigger < watched - 20]
        assert len(made.converts) == len(told), settings


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(case=["nobody takes any", "a tick each clock"])
async def each_counter_counts_its_own(dut, case):
    """In the first case all samples are over-range, and the waiting beat is marked so."""
    twin = twin_of(dut)
    waits = case == "nobody takes any"
    settings = Settings(1) if waits else Settings(1, period=1)
    made = Board(dut, settings)
    if waits:
        bits = twin.part.data_bits
        made.value = lambda *_: 1 << bits - 1 if twin.part.signed else (1 << bits) - 1
    await made.start()
    dut.out_ready_i.value = int(not waits)
    clocks = 2 * twin.scan.frame_clocks(1) if waits else 0
    await made.run(twin.adc.start_clocks() + clocks + 3 * twin.scan.slot(1))
    await ReadOnly()
    assert made.counted() == {("dropped" if twin.scan.buffer.sorts else "held") if waits else "overrun"}
    if waits:
        assert bench.read(dut.out_user_o) == (1 << twin.lanes) - 1


@bench.applies(lambda dut: twin_of(dut).part is not MCP3208)  # its missing answers cannot be detected
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_part_that_fails_spoils_no_frame(dut):
    """BUSY is stuck, or answers have wrong numbers, for a while: frames stay complete, lost samples are
    marked."""
    twin = twin_of(dut)
    settings = Settings(settle=1)
    slot, frame = twin.scan.slot(1), twin.scan.frame_clocks(1)
    made = Board(dut, settings)
    await made.start()
    await made.run(twin.adc.start_clocks() + frame + slot // 2)
    part = made.parts[-1]
    if twin.part.has_busy:
        part.hold_busy(0)
    else:
        part.spoil = lambda answer: answer ^ 0x4000
    await made.run(3 * slot)
    if twin.part.has_busy:
        part.hold_busy(None)
    else:
        part.spoil = None
    await made.run(3 * frame + 2 * slot)
    await ReadOnly()
    lost = counts(dut)["lost"]
    assert 2 <= lost <= 8
    beats = twin.rows * twin.scan.beats
    ids = [beat[2] for beat in made.beats]
    assert ids == [n % beats for n in range(len(ids))]
    assert len(ids) >= 3 * beats
    marked = [beat for beat in made.beats if beat[4] >> twin.lanes - 1 & 1]
    lane = lambda beat: beat[1] >> (twin.lanes - 1) * twin.sample_bits
    assert sum(lane(beat) == 0 for beat in marked) >= (lost - 1) * min(twin.channels, twin.scan.beats)
    conversions, _ = twin.scan.schedule(settings, made.clock)
    frames = made.expected(conversions[: len(made.converts)])
    whole = frames[len(ids) // beats - 1][1]
    final = made.beats[(len(ids) // beats - 1) * beats :][:beats]
    assert [(beat[2], beat[1], beat[4]) for beat in final] == [(i, *whole[i]) for i in sorted(whole)]


BUILDS = [
    {"Rows": 16, "Columns": 16, "Part": AD7606.number, "Channels": 8, "ClkKhz": 25_000},
    {"Rows": 3, "Columns": 3, "Part": MCP3208.number, "Channels": 3, "ClkKhz": 8_000, "SclkKhz": 2_000},
    {"Rows": 8, "Columns": 8, "Part": MAX11123.number, "Channels": 8, "ClkKhz": 25_000},
    {"Rows": 4, "Columns": 15, "Part": MAX11131.number, "Channels": 4, "Lanes": 2, "ClkKhz": 41_000},
    {"Rows": 3, "Columns": 32, "Part": AD7606.number, "Channels": 8, "Lanes": 2, "ClkKhz": 20_000},
    {"Rows": 2, "Columns": 28, "Part": MAX11123.number, "Channels": 3, "Lanes": 5, "ClkKhz": 50_000},
    {
        **{"Rows": 3, "Columns": 14, "Part": AD7606C.number, "Channels": 7, "Lanes": 2, "AdcLanes": 4},
        **{"ClkKhz": 8_000, "SclkKhz": 60_000},
    },
    {
        **{"Rows": 3, "Columns": 32, "Part": AD7606.number, "Channels": 8, "Lanes": 2, "AdcLanes": 2},
        **{"ClkKhz": 100_000, "ReadDuring": 1},
    },
    {"Rows": 4, "Columns": 16, "Part": AD7606.number, "ClkKhz": 20_000, "Depth": 32, "ReadDuring": 1},
    {
        **{"Rows": 3, "Columns": 5, "Part": MAX11123.number, "Channels": 1, "ClkKhz": 100_000},
        "Depth": 8,
    },
]


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3, "Columns": 3}, "defined": True, "boxes": True},
    "faults": {
        "size": {"Rows": 3, "Columns": 3},
        "driver": {
            "free": 40000,
            # Counters up to a scan's next row and frame, and the settle time in force until it.
            "late": "since_q count_q rest_q settle_q",
            "part": 1,
        },
    },
}


@pytest.mark.parametrize("parameters", BUILDS, ids=lambda p: "-".join(map(str, p.values())))
def test_scan_adc(parameters):
    bench.run("frontend", "scan_adc", parameters)


def test_16x16_with_one_ad7606_and_64x64_with_eight():
    """The goals of the design, computed by the twin that is checked at the pins."""
    small = ScanAdc(16, 16, 1, AD7606, 8, 2, 100_000)
    frame_us = small.latency(settle=500)["frame"] / 100
    assert frame_us < 1000
    large = ScanAdc(64, 64, 8, AD7606, 8, 2, 100_000)
    assert large.latency(settle=500)["last_beat"] / 100 < 1000


def test_twin_refuses_what_cannot_work():
    for bad in ({"part": None}, {"channels": 9}, {"rows": 0}, {"depth": 3}, {"adc_lanes": 3}):
        with pytest.raises((ValueError, AttributeError)):
            ScanAdc(**bad)
