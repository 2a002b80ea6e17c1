"""msn_calibrate against its model, and the model against exact fractions: per taxel and row times column, all
lane counts, 1 x 1 to 256 x 256; gain 0 and full, offsets at both ends and above every sample, samples at both
ends; gaps and stalls; masks; calibrations swapped while frames pass; damage; resets; exact clocks."""

import random
from fractions import Fraction
from math import floor

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge

import bench
from meissner.twins.frontend.calibrate import Calibrate, forces, latency

FIELDS = ["data", "mask", "fits", "row_last", "last"]
IDLE = {"cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0}


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "GainShift", "Offset", "RowColumn")
    return Calibrate(*(getattr(dut, name).value.to_unsigned() for name in names))


def size_of(twin):
    table = twin.table
    return table.rows, table.columns, table.lanes, table.rows * table.row_beats


def length_of(dut):
    """Beats of a frame."""
    return size_of(twin_of(dut))[3]


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
    """Write an entire bank, an entry a clock, with pauses."""
    for of_row, word, lane, offset, gain in entries:
        while pause():
            dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0
            await bench.RisingEdge(dut.clk_i)
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word, gain
        dut.cfg_offset_i.value = offset & ((1 << twin.table.offset_bits) - 1)
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, int(of_row)
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


@bench.applies(lambda dut, stall_rate: not stall_rate or length_of(dut) <= 20000)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
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


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def no_frame_mixes_two_calibrations(dut, stall_rate):
    """A second bank is written while frames pass, and swapped in at critical beats of a frame."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
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
    reference, expected = twin_of(dut), []
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


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def frames_behind_damaged_ones_are_right(dut, stall_rate):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
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


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
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


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def keeps_accepted_beats_while_the_output_is_stalled(dut):
    """The follower sleeps until the block has long been full, then takes all; again and again."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
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


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated_and_frames_never_wait(dut):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, out_ready_i=1, **IDLE)
    await load(dut, twin, calibrations(twin.table, rng))
    await swap(dut, twin)
    await bench.clocks(dut, 5)
    beats = bench.unnumbered(samples(rng, twin, 6))
    seen, stated = [], latency(twin.table.row_column)
    for clock in range(len(beats) + stated + 2):
        dut.in_valid_i.value = int(clock < len(beats))
        bench.offer(dut, beats[min(clock, len(beats) - 1)])
        await bench.ReadOnly()
        assert dut.in_ready_o.value == 1, f"stalled at clock {clock}"
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert seen == [clock + stated for clock in range(len(beats))]


EVIDENCE = {
    "reference": {
        "against": "`Fraction`",
        "test": "tb/frontend/test_calibrate.py::test_model_against_fractions",
    },
    "equivalence": {"size": {"Rows": 3}, "defined": True, "boxes": True, "open": ["reset"]},
    "mutants": {"sets": [1]},
    "faults": {
        "size": {"Rows": 3, "RowColumn": 0},
        "settle": 3,
        # The tables, the bank in use and whether one is loaded keep a fault until they are written again.
        "driver": {"kept": "memory gains offsets rows bank loaded cfg_swapping"},
    },
}


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, gain_shift, offset, row_column",
    [
        (1, 1, 1, 17, 12, 1, 0),
        (3, 3, 2, 17, 1, 1, 0),
        (4, 7, 2, 18, 16, 0, 0),
        (5, 19, 8, 17, 24, 1, 1),
        (1, 1, 1, 17, 32, 1, 1),
        (4, 1, 4, 17, 20, 0, 1),
        (64, 64, 1, 17, 12, 1, 0),
        pytest.param(256, 256, 4, 17, 12, 1, 0, marks=pytest.mark.long),
        pytest.param(256, 256, 8, 17, 24, 1, 1, marks=pytest.mark.long),
    ],
)
def test_calibrate(rows, columns, lanes, sample_bits, gain_shift, offset, row_column):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": sample_bits}
    bench.run(
        "frontend", "calibrate", size | {"GainShift": gain_shift, "Offset": offset, "RowColumn": row_column}
    )


def test_model_against_fractions():
    """The formula in exact arithmetic, at the ends of every range, near ties and at random."""
    rng = np.random.default_rng(bench.SEED)
    for gain_bits, shift in ((16, 12), (16, 1), (16, 16), (32, 24), (32, 32)):
        top = (1 << gain_bits) - 1
        raw = np.r_[[-65536, 65535, 0, 1, -1, 7], rng.integers(-65536, 65536, 400)]
        offset = np.r_[[65535, -65536, 0, 0, 0, 6], rng.integers(-65536, 65536, 400)]
        gain = np.r_[[top, top, top, 1 << (shift - 1), 1 << (shift - 1), 0], rng.integers(0, top + 1, 400)]
        gain[-100:] = 1 << (shift - 1)  # exactly a half whenever raw - offset is odd
        got = forces(raw, offset, gain, shift, gain_bits=gain_bits)
        for r, o, g, f in zip(raw.tolist(), offset.tolist(), gain.tolist(), got.tolist()):
            exact = floor(Fraction((r - o) * g, 1 << shift) + Fraction(1, 2))
            assert f == min(max(exact, 0), 65535)


def test_model_in_frames_and_beats():
    """``next`` for complete frames and ``beat`` for each beat give the same."""
    rng = np.random.default_rng(1)
    twin = Calibrate(3, 5, 2)
    for entry in calibrations(twin.table, rng):
        twin.table.write(*entry[1:2], *entry[3:], entry[2])
    raw = rng.integers(-999, 9999, (2, 3, 5))
    mask = rng.random((3, 5)) < 0.3
    whole = twin.process(raw, mask)
    assert whole.any() and not whole[:, mask].any()
    beats = expected_of(twin, bench.lane_beats(raw, 2, 17, mask=np.broadcast_to(mask, raw.shape)))
    lanes = np.array([bench.lane_values(beat["data"], 2, 16) for beat in beats])
    assert np.array_equal(lanes.reshape(2, 3, 6)[:, :, :5], whole)


def test_refuses_illegal_parameters():
    assert "GainShift = 0" in bench.refuses("calibrate", {"GainShift": 0})
    assert "GainShift = 17" in bench.refuses("calibrate", {"GainShift": 17})
    for kinds, message in (
        ({"gain_shift": 0}, "gain_shift = 0"),
        ({"gain_shift": 17}, "gain_shift = 17"),
        ({"gain_shift": 33, "row_column": True}, "gain_shift = 33"),
        ({"lanes": 3}, "lanes = 3"),
    ):
        with pytest.raises(ValueError, match=message):
            Calibrate(4, 4, **kinds)
