"""What the benches of msn_calibrate_taxels and msn_calibrate_grid share: streams of beats against the twin of
either."""

import random

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge

import bench

FIELDS = ["data", "mask", "fits", "row_last", "last"]
IDLE = {"cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0}


def values_of(dut):
    """The positional arguments of the twin of this build."""
    names = ("Rows", "Columns", "Lanes", "SampleBits", "GainShift", "Offset")
    return [getattr(dut, name).value.to_unsigned() for name in names]


def size_of(twin):
    table = twin.table
    return table.rows, table.columns, table.lanes, table.rows * table.row_beats


def calibrations(table, rng):
    """Entries (of a row?, word, lane, offset, gain) of an entire bank: ends of the range, gains near 1,
    random."""
    low, high = bench.width(table.offset_bits)
    one = 1 << 12
    words = [(False, w, lane) for w in range(table._beats.shape[2]) for lane in range(table.lanes)]
    words += [(True, row, 0) for row in range(table.rows) if table.row_column]
    offsets = rng.choice([low, high, 0, 1, -1, *rng.integers(low, high, 5)], len(words))
    offsets = np.where(rng.random(len(words)) < 0.7, rng.integers(low // 8, high // 8, len(words)), offsets)
    gains = rng.choice([0, 1, one, 65535, *rng.integers(0, 1 << 16, 5)], len(words))
    gains = np.where(rng.random(len(words)) < 0.7, rng.integers(one // 2, 2 * one, len(words)), gains)
    return [(*word, int(offset), int(gain)) for word, offset, gain in zip(words, offsets, gains)]


async def load(dut, twin, entries, pause=lambda: False):
    """Write an entire bank, an entry a clock, with pauses. Drives also what a block does not use of a write:
    the upper bits of a row's or column's number, or whether the write is a row's."""
    table = twin.table
    used = (
        max(1, (max(table.rows, table.row_beats) - 1).bit_length())
        if table.row_column
        else len(dut.cfg_word_i)
    )
    upper = (1 << len(dut.cfg_word_i)) - (1 << used)
    for number, (of_row, word, lane, offset, gain) in enumerate(entries):
        while pause():
            dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0
            await bench.RisingEdge(dut.clk_i)
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word | upper * (number % 2), gain
        dut.cfg_offset_i.value = offset & ((1 << twin.table.offset_bits) - 1)
        row = of_row if table.row_column else number % 2
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, int(row)
        if of_row:
            twin.table.write_row(word, offset, gain)
        else:
            twin.table.write(word, offset, gain, lane)
        await bench.RisingEdge(dut.clk_i)
    dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0


async def swap(dut, twin):
    dut.cfg_swap_i.value = 1
    await bench.RisingEdge(dut.clk_i)
    dut.cfg_swap_i.value = 0
    twin.swap()


def expected_of(twin, beats):
    """The model's output for a stream of beats."""
    table = twin.table
    got = []
    for beat in beats:
        raw = bench.lane_values(beat["data"], table.lanes, twin.sample_bits, signed=True)
        mask = bench.lane_values(beat["mask"], table.lanes, 1)
        found = twin.beat(np.array(raw), beat["id"], beat["last"], np.array(mask, bool))
        marks = {name: int(beat[name]) for name in ("mask", "fits", "row_last", "last")}
        got.append({"data": bench.lane_word(found, 16)} | marks)
    return got


def samples(rng, twin, count):
    """Frames of samples: both ends of the range, small ones, then random; a tenth of them masked."""
    rows, columns, lanes, _ = size_of(twin)
    low, high = bench.width(twin.sample_bits)
    shape = (count, rows, columns)
    x = np.where(rng.random(shape) < 0.5, rng.integers(low, high + 1, shape), rng.integers(-99, 999, shape))
    x[0], x[1 % count] = low, high
    return bench.lane_beats(x, lanes, twin.sample_bits, surplus=high, mask=rng.random(shape) < 0.1)


def count_frames(twin):
    return 4 if size_of(twin)[3] > 500 else 60 if size_of(twin)[3] < 20 else 12


async def matches_model(dut, twin, stall_rate):
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    beats = samples(rng, twin, 2)
    if size_of(twin)[3] < 5000:  # first without any calibration
        got = await bench.stream(dut, bench.unnumbered(beats), FIELDS)
        assert got == expected_of(twin, beats)
        assert not any(beat["data"] for beat in got)
    pauses = bench.gaps_and_stalls(stall_rate)
    for _ in range(2 if size_of(twin)[3] < 5000 else 1):
        await load(dut, twin, calibrations(twin.table, rng))
        await swap(dut, twin)
        beats = samples(rng, twin, count_frames(twin) if size_of(twin)[3] < 5000 else 2)
        got = await bench.stream(dut, bench.unnumbered(beats), FIELDS, *pauses)
        assert got == expected_of(twin, beats)
        assert any(beat["data"] for beat in got)


async def no_frame_mixes_two_calibrations(dut, twin, reference, stall_rate):
    """A second bank is written while frames pass, and swapped in at critical beats of a frame. ``reference``:
    a second twin, for the frames' expected forces."""
    rng = np.random.default_rng(bench.SEED)
    length = size_of(twin)[3]
    await bench.start(dut, **IDLE)
    draw = random.Random(bench.SEED)
    taken = 0

    async def writer(sets, at):
        """Write each set; frames that begin after the swap must be the first with the new one."""
        nonlocal taken
        for entries, place in zip(sets, at):
            await load(dut, twin, entries, lambda: draw.random() < 0.3)
            while True:
                await FallingEdge(dut.clk_i)
                takes = dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1
                if takes and taken % length == place:
                    break
            dut.cfg_swap_i.value = 1
            await FallingEdge(dut.clk_i)
            dut.cfg_swap_i.value = 0
            swaps.append(-(-taken // length))  # taken includes the beat of that clock
            # Only now may the bank that was in use be written.
            while dut.cfg_swapping_o.value == 1:
                await FallingEdge(dut.clk_i)
            await bench.RisingEdge(dut.clk_i)

    async def counter():
        nonlocal taken
        while True:
            await FallingEdge(dut.clk_i)
            takes = dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1
            await bench.RisingEdge(dut.clk_i)
            taken += takes

    places = sorted({0, 1 % length, length // 2, max(length - 2, 0), length - 1})
    sets = [calibrations(twin.table, rng) for _ in places]
    swaps = []
    cocotb.start_soon(counter())
    frames = int(len(sets) * (4 + len(sets[0]) * 2 / length)) + 4
    beats = samples(rng, twin, frames)
    task = cocotb.start_soon(writer(sets, places))
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, bench.unnumbered(beats), FIELDS, *pauses)
    await task
    assert len(swaps) == len(sets) and swaps[-1] < frames
    expected = []
    for frame in range(frames):
        for entries, first in zip(sets, swaps):
            if first == frame:
                for of_row, word, lane, offset, gain in entries:
                    if of_row:
                        reference.table.write_row(word, offset, gain)
                    else:
                        reference.table.write(word, offset, gain, lane)
                reference.swap()
        expected += expected_of(reference, beats[frame * length : (frame + 1) * length])
    assert got == expected


async def frames_behind_damaged_ones_are_right(dut, twin, stall_rate):
    rng = np.random.default_rng(bench.SEED)
    rows, _, _, length = size_of(twin)
    await bench.start(dut, **IDLE)
    await load(dut, twin, calibrations(twin.table, rng))
    await swap(dut, twin)
    beats = bench.damage(samples(rng, twin, 60 if length < 100 else 8), length, random.Random(bench.SEED))
    beats = bench.placed(beats, rows, length // rows)
    assert not all(beat["fits"] for beat in beats)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, bench.unnumbered(beats), FIELDS, *pauses)
    assert got == expected_of(twin, beats)


async def forgets_what_a_reset_interrupts(dut, twin):
    rng = np.random.default_rng(bench.SEED)
    length = size_of(twin)[3]
    await bench.start(dut, **IDLE)
    for cut in {1, length // 2 + 1, length}:
        await load(dut, twin, calibrations(twin.table, rng))
        await swap(dut, twin)
        beats = samples(rng, twin, 2)
        stalls = (lambda: True) if cut <= 3 else None  # so many beats fit while none is taken
        await bench.stream(dut, bench.unnumbered(beats[:cut]), FIELDS, stalls=stalls, drain=0)
        dut.cfg_swap_i.value = cut % 2  # a requested swap is discarded too
        await bench.RisingEdge(dut.clk_i)
        dut.cfg_swap_i.value = 0
        await bench.reset(dut)
        twin.reset()
        got = await bench.stream(dut, bench.unnumbered(beats), FIELDS)
        assert got == expected_of(twin, beats)
        assert not any(beat["data"] for beat in got)  # nothing is calibrated after a reset


async def keeps_accepted_beats_while_the_output_is_stalled(dut, twin):
    """The follower sleeps until the block has long been full, then takes all; again and again."""
    rng = np.random.default_rng(bench.SEED)
    length = size_of(twin)[3]
    await bench.start(dut, **IDLE)
    await load(dut, twin, calibrations(twin.table, rng))
    await swap(dut, twin)
    beats = samples(rng, twin, -(-300 // length))
    clock = 0

    def asleep():
        nonlocal clock
        clock += 1
        return clock % 200 < 120

    assert await bench.stream(dut, bench.unnumbered(beats), FIELDS, stalls=asleep, drain=100) == expected_of(
        twin, beats
    )


async def clocks_are_as_stated_and_frames_never_wait(dut, twin, stated):
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut, out_ready_i=1, **IDLE)
    await load(dut, twin, calibrations(twin.table, rng))
    await swap(dut, twin)
    await bench.clocks(dut, 5)
    beats = bench.unnumbered(samples(rng, twin, 6))
    seen = []
    for clock in range(len(beats) + stated + 2):
        dut.in_valid_i.value = int(clock < len(beats))
        bench.offer(dut, beats[min(clock, len(beats) - 1)])
        await bench.ReadOnly()
        assert dut.in_ready_o.value == 1, f"stalled at clock {clock}"
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert seen == [clock + stated for clock in range(len(beats))]
