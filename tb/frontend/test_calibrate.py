"""msn_calibrate against its model, and the model against exact fractions: per taxel and by row and column,
all lane counts, 1 x 1 to 256 x 256; gain 0 and full, offsets at both ends and above every sample, samples at
both ends; gaps and stalls; masks; calibrations swapped while frames pass; damage; resets; exact clocks."""

import random
from fractions import Fraction
from math import floor

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, RisingEdge

import bench
from harness.refusals import refusals, refused
from meissner.twins.frontend.calibrate import Calibrate, forces, latency
from members import Settings

FIELDS = ["data", "mask", "fits", "row_last", "last"]
PRESET = 4000


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "RowColumn", "Offset", "GainShift")
    twin = Calibrate(*(number(dut, name) for name in names))
    twin.table.preset = PRESET
    return twin


def length_of(dut):
    """Beats of a frame."""
    return number(dut, "Rows") * -(-number(dut, "Columns") // number(dut, "Lanes"))


def calibrations(table, rng):
    """Entries (of a row?, word, lane, offset, gain) of an entire bank: ends of the range, gains near 1,
    random."""
    low, high = bench.width(table.offset_bits)
    low, high, one = max(low, -65536), min(high, 65535), 1 << 12  # a register has 17 bits
    words = [(False, w, lane) for w in range(table.beats) for lane in range(table.lanes)]
    words += [(True, row, 0) for row in range(table.rows) if table.row_column]
    offsets = rng.choice([low, high, 0, 1, -1, *rng.integers(low, high, 5)], len(words))
    offsets = np.where(rng.random(len(words)) < 0.7, rng.integers(low // 8, high // 8, len(words)), offsets)
    gains = rng.choice([0, 1, one, 65535, *rng.integers(0, 1 << 16, 5)], len(words))
    gains = np.where(rng.random(len(words)) < 0.7, rng.integers(one // 2, 2 * one, len(words)), gains)
    return [(*word, int(offset), int(gain)) for word, offset, gain in zip(words, offsets, gains)]


def written(table, of_row, word, lane, offset, gain):
    """The members of calibrate_cfg that write this entry; the lanes of a row's entry are not used."""
    lanes = 0xFF if of_row else 1 << lane
    return {
        **{"word": word, "offset": offset, "gain": gain},
        **{"write_lanes": lanes, "write_row": of_row, "write_written": 1},
    }


class Stream:
    """A block with its twin and its settings."""

    async def begin(self, dut, **inputs):
        self.dut, self.twin, self.rng = dut, twin_of(dut), np.random.default_rng(bench.SEED)
        self.settings = Settings(dut, "calibrate_cfg", preset=PRESET)
        self.length = length_of(dut)
        await bench.start(dut, **inputs)
        return self

    async def load(self, entries=None, pause=lambda: False):
        """Write an entire bank, an entry a clock, with pauses."""
        twin = self.twin
        for entry in calibrations(twin.table, self.rng) if entries is None else entries:
            while pause():
                await RisingEdge(self.dut.clk_i)
            twin.table.put(*entry)
            await self.settings.pulse(self.dut.clk_i, **written(twin.table, *entry))
        table = twin.table  # what is not there is not written, nor a row's entry to a table of taxels
        for of_row, word in ((0, table.beats), (1, table.rows * table.row_column)):
            refused = {"write_lanes": 255, "write_row": of_row, "word": word, "write_written": 1}
            await self.settings.pulse(self.dut.clk_i, gain=0x5A5A, **refused)

    async def swap(self):
        """Request it in the clock of one more entry, which still belongs to the calibration."""
        entry = calibrations(self.twin.table, self.rng)[0]
        self.twin.table.put(*entry)
        await self.settings.pulse(self.dut.clk_i, swap=1, **written(self.twin.table, *entry))
        self.twin.swap()

    def samples(self, count):
        """Frames of samples: both ends of the range, small ones, then random; a tenth of them masked."""
        table, bits = self.twin.table, self.twin.sample_bits
        (low, high), shape = bench.width(bits), (count, table.rows, table.columns)
        wide = self.rng.integers(low, high + 1, shape)
        x = np.where(self.rng.random(shape) < 0.5, wide, self.rng.integers(-99, 999, shape))
        x[0], x[1 % count] = low, high
        return bench.lane_beats(x, table.lanes, bits, surplus=high, mask=self.rng.random(shape) < 0.1)

    async def send(self, beats, *pauses, **options):
        return await bench.stream(self.dut, bench.unnumbered(beats), FIELDS, *pauses, **options)


def expected_of(twin, beats):
    """The model's output for a stream of beats."""
    lanes, got = twin.table.lanes, []
    for beat in beats:
        raw = bench.lane_values(beat["data"], lanes, twin.sample_bits, signed=True)
        mask = bench.lane_values(beat["mask"], lanes, 1)
        found = twin.beat(np.array(raw), beat["id"], beat["last"], np.array(mask, bool))
        marks = {name: int(beat[name]) for name in ("mask", "fits", "row_last", "last")}
        got.append({"data": bench.lane_word(found, 16)} | marks)
    return got


@bench.applies(lambda dut, stall_rate: not stall_rate or length_of(dut) <= 20000)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    line = await Stream().begin(dut)
    big = line.length >= 5000
    if not big:  # first without any calibration
        beats = line.samples(2)
        got = await line.send(beats)
        assert got == expected_of(line.twin, beats)
        assert any(beat["data"] for beat in got)
    pauses = bench.gaps_and_stalls(stall_rate)
    for _ in range(1 if big else 2):
        await line.load()
        await line.swap()
        beats = line.samples(2 if big else 4 if line.length > 500 else 60 if line.length < 20 else 12)
        got = await line.send(beats, *pauses)
        assert got == expected_of(line.twin, beats)
        assert any(beat["data"] for beat in got)


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def no_frame_mixes_two_calibrations(dut, stall_rate):
    """A second bank is written while frames pass, and swapped in at critical beats of a frame."""
    line, draw, taken = await Stream().begin(dut), random.Random(bench.SEED), 0
    length, swaps = line.length, []

    async def counter():
        nonlocal taken
        while True:
            await FallingEdge(dut.clk_i)
            takes = dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1
            await RisingEdge(dut.clk_i)
            taken += takes

    async def writer(sets, at):
        """Write each set; frames that begin after the swap must be the first with the new one."""
        for entries, place in zip(sets, at):
            await line.load(entries=entries, pause=lambda: draw.random() < 0.3)
            while True:
                await FallingEdge(dut.clk_i)
                takes = dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1
                if takes and taken % length == place:
                    break
            line.settings.put(swap=1)
            await FallingEdge(dut.clk_i)
            line.settings.put(swap=0)
            swaps.append(-(-taken // length))  # taken includes the beat of that clock
            # Only now may the bank that was in use be written.
            while dut.status_o.value == 1:
                await FallingEdge(dut.clk_i)
            await RisingEdge(dut.clk_i)

    places = sorted({0, 1 % length, length // 2, max(length - 2, 0), length - 1})
    sets = [calibrations(line.twin.table, line.rng) for _ in places]
    cocotb.start_soon(counter())
    frames = int(len(sets) * (4 + len(sets[0]) * 2 / length)) + 4
    beats = line.samples(frames)
    task = cocotb.start_soon(writer(sets, places))
    got = await line.send(beats, *bench.gaps_and_stalls(stall_rate))
    await task
    assert len(swaps) == len(sets) and swaps[-1] < frames
    expected, twin = [], twin_of(dut)
    for frame in range(frames):
        for entries, first in zip(sets, swaps):
            if first == frame:
                for entry in entries:
                    twin.table.put(*entry)
                twin.swap()
        expected += expected_of(twin, beats[frame * length : (frame + 1) * length])
    assert got == expected


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def frames_behind_damaged_ones_are_right(dut, stall_rate):
    line = await Stream().begin(dut)
    length, rows = line.length, line.twin.table.rows
    await line.load()
    await line.swap()
    beats = bench.damage(line.samples(60 if length < 100 else 8), length, random.Random(bench.SEED))
    beats = bench.placed(beats, rows, length // rows)
    assert not all(beat["fits"] for beat in beats)
    assert await line.send(beats, *bench.gaps_and_stalls(stall_rate)) == expected_of(line.twin, beats)


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    line = await Stream().begin(dut)
    for cut in {1, line.length // 2 + 1, line.length}:
        await line.load()
        await line.swap()
        beats = line.samples(2)
        stalls = (lambda: True) if cut <= 3 else None  # so many beats fit while none is taken
        await line.send(beats[:cut], stalls=stalls, drain=0)
        await line.settings.pulse(dut.clk_i, swap=cut % 2)  # a requested swap is discarded too
        await bench.reset(dut)
        line.twin.reset()
        got = await line.send(beats)
        assert got == expected_of(line.twin, beats)
        assert any(beat["data"] for beat in got)  # with the preset gain again


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def keeps_accepted_beats_while_the_output_is_stalled(dut):
    """The follower sleeps until the block has long been full, then takes all; again and again."""
    line, clock = await Stream().begin(dut), 0
    await line.load()
    await line.swap()
    beats = line.samples(-(-300 // line.length))

    def asleep():
        nonlocal clock
        clock += 1
        return clock % 200 < 120

    assert await line.send(beats, stalls=asleep, drain=100) == expected_of(line.twin, beats)


@bench.applies(lambda dut: bench.whole(dut) and number(dut, "RowColumn") and length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_upset_of_the_credit_is_over_when_the_block_is_empty(dut):
    """Each bit of it while nothing is inside; and all of it used up while the output stalls: no beat is lost,
    and the frames that follow are right and do not wait."""
    line = await Stream().begin(dut)
    owed = dut.gen_grid.owed
    beats = line.samples(-(-60 // line.length))
    for bit in range(len(owed)):
        await bench.clocks(dut, 30)
        owed.value = bench.read(owed) ^ 1 << bit
        await bench.clocks(dut, 2)
        assert await line.send(beats) == expected_of(line.twin, beats), bit
    clock = 0

    def asleep():
        nonlocal clock
        clock += 1
        if clock == 50:
            owed.value = 2 ** len(owed) - 1
        return clock < 100

    assert await line.send(beats, stalls=asleep, drain=100) == expected_of(line.twin, beats)
    assert await line.send(beats) == expected_of(line.twin, beats)


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated_and_frames_never_wait(dut):
    line, seen = await Stream().begin(dut, out_ready_i=1), []
    stated = latency(line.twin.table.row_column)
    await line.load()
    await line.swap()
    await bench.clocks(dut, 5)
    beats = bench.unnumbered(line.samples(6))
    for clock in range(len(beats) + stated + 2):
        dut.in_valid_i.value, dut.out_ready_i.value = int(clock < len(beats)), 1
        bench.offer(dut, beats[min(clock, len(beats) - 1)])
        await bench.ReadOnly()
        assert dut.in_ready_o.value == 1, f"stalled at clock {clock}"
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await RisingEdge(dut.clk_i)
    assert seen == [clock + stated for clock in range(len(beats))]


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3}, "defined": True, "boxes": True},
    "mutants": {"sets": [1, 5]},
    "faults": {
        "size": {"Rows": 3},
        "more": [{"Rows": 5, "RowColumn": 1}],
        "settle": 3,
        # The tables, the bank in use and whether one is loaded keep a fault until they are written again.
        "driver": {"kept": "memory bank loaded swapping"},
    },
}
BIG = pytest.mark.long


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, row_column, offset, gain_shift",
    [
        (1, 1, 1, 17, 0, 1, 12),
        (3, 3, 2, 17, 0, 1, 1),
        (4, 7, 2, 18, 0, 0, 16),
        (3, 14, 6, 17, 0, 1, 11),
        (64, 64, 1, 17, 0, 1, 12),
        pytest.param(256, 256, 4, 17, 0, 1, 12, marks=BIG),
        (5, 19, 8, 17, 1, 1, 24),
        (1, 1, 1, 17, 1, 1, 32),
        (4, 1, 4, 17, 1, 0, 20),
        (3, 17, 5, 18, 1, 0, 22),
        pytest.param(256, 256, 8, 17, 1, 1, 24, marks=BIG),
    ],
)
def test_calibrate(rows, columns, lanes, sample_bits, row_column, offset, gain_shift):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": sample_bits}
    kind = {"RowColumn": row_column, "Offset": offset, "GainShift": gain_shift}
    bench.run("frontend", "calibrate", size | kind)


@pytest.mark.parametrize("bits, shift", [(16, 1), (16, 12), (16, 16), (32, 1), (32, 24), (32, 32)])
def test_model_against_fractions(bits, shift):
    """The formula in exact arithmetic, at the ends of every range, near ties and at random."""
    rng, top = np.random.default_rng(bench.SEED), (1 << bits) - 1
    raw = np.r_[[-65536, 65535, 0, 1, -1, 7], rng.integers(-65536, 65536, 400)]
    offset = np.r_[[65535, -65536, 0, 0, 0, 6], rng.integers(-65536, 65536, 400)]
    gain = np.r_[[top, top, top, 1 << (shift - 1), 1 << (shift - 1), 0], rng.integers(0, top + 1, 400)]
    gain[-100:] = 1 << (shift - 1)  # exactly a half whenever raw - offset is odd
    got = forces(raw, offset, gain, shift, gain_bits=bits)
    for r, o, g, f in zip(raw.tolist(), offset.tolist(), gain.tolist(), got.tolist()):
        exact = floor(Fraction((r - o) * g, 1 << shift) + Fraction(1, 2))
        assert f == min(max(exact, 0), 65535)


@pytest.mark.parametrize("row_column", [False, True])
def test_model_in_frames_and_beats(row_column):
    """``next`` for complete frames and ``beat`` for each beat give the same."""
    rng, twin = np.random.default_rng(1), Calibrate(3, 5, 2, row_column=row_column)
    for entry in calibrations(twin.table, rng):
        twin.table.put(*entry)
    raw = rng.integers(-999, 9999, (2, 3, 5))
    mask = rng.random((3, 5)) < 0.3
    whole = twin.process(raw, mask)
    assert whole.any() and not whole[:, mask].any()
    beats = expected_of(twin, bench.lane_beats(raw, 2, 17, mask=np.broadcast_to(mask, raw.shape)))
    lanes = np.array([bench.lane_values(beat["data"], 2, 16) for beat in beats])
    assert np.array_equal(lanes.reshape(2, 3, 6)[:, :, :5], whole)


def test_the_preset_by_hand():
    """1.5 times the sample, at any size, until the first swap; by row and column 1.5 times 1.0."""
    for row_column in (False, True):
        twin = Calibrate(2, 3, 2, row_column=row_column)
        assert not twin.next(np.full((1, 2, 3), 500)).any()
        twin.table.preset = 6144
        assert twin.next(np.array([[[7, -7, 500], [1, 60000, 3]]])).tolist() == [
            [[11, 0, 750], [2, 65535, 5]]
        ]
        twin.swap()
        assert not twin.next(np.full((1, 2, 3), 500)).any()  # nothing was written


test_refuses_illegal_parameters = refusals(
    "calibrate",
    Calibrate,
    *({"GainShift": shift, "RowColumn": by} for by, most in ((0, 16), (1, 32)) for shift in (0, most + 1)),
    rows=4,
    columns=4,
)


def test_the_twin_refuses_what_its_table_refuses():
    for row_column in (0, 1):
        cases = ({"lanes": 9}, {"sample_bits": 18}, {"sample_bits": 19, "offset": False})
        refused(Calibrate, *cases, rows=4, columns=4, row_column=row_column)
