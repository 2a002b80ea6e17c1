"""msn_grid_table against its model: one taxel to rows that do not fill their lanes; beats with pauses
and without, exactly six clocks later, while the other bank is written; swaps at every beat of a frame and
between frames; damaged frames, too short and too long; resets in mid-frame, with a swap requested, to another
preset."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge

import bench
from harness.refusals import refusals, refused
from meissner.twins.frontend.calibrate import GridTable
from members import Settings

LATENCY = 6
PRESETS = 0xA9C5, 0x563A  # in turn from reset to reset: each bit once 1, once 0


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "Offset")
    twin = GridTable(*(getattr(dut, name).value.to_unsigned() for name in names))
    twin.preset = PRESETS[0]
    return twin


def entries(twin, draw):
    """Random contents of a bank, with the ends of the range: (of a row?, word, lane, offset, gain)."""
    low, high = bench.width(twin.offset_bits)
    words = [(False, w, lane) for w in range(twin.row_beats) for lane in range(twin.lanes)]
    words += [(True, row, 0) for row in range(twin.rows)]
    return [
        (
            *word,
            draw.choice([low, high, draw.randint(low, high)]),
            draw.choice([0, 65535, draw.randint(0, 65535)]),
        )
        for word in words
    ]


async def write(dut, settings, found, twin, number):
    """Write a bank, then what is not there: the first place too many, and one with the low bits of place 0
    and, from bank to bank, another of the high ones. Beats up to the later swap request belong to the old
    bank."""
    beyond = []
    for row, count in ((1, twin.rows), (0, twin.row_beats)):
        bits = range(19, count.bit_length() - 1, -1)
        beyond += [(row, word, 0, 77, 99) for word in (count, 1 << bits[number % len(bits)])]
    for of_row, word, lane, offset, gain in found + beyond:
        entry = {"word": word, "offset": offset, "gain": gain, "write_lanes": 1 << lane}
        settings.put(write_written=1, write_row=of_row, **entry)
        await FallingEdge(dut.clk_i)
    settings.put(write_written=0)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pause_rate=[0.0, 0.5])
async def matches_model(dut, pause_rate):
    """A swap is requested at every beat of a frame in turn, and now and then between two frames."""
    twin, draw = twin_of(dut), random.Random(bench.SEED)
    settings = Settings(dut, "calibrate_cfg", preset=PRESETS[0])
    await bench.start(dut, take_i=0, last_i=0)
    await FallingEdge(dut.clk_i)
    beats = twin.rows * twin.row_beats
    due, asked, writer, midway, number, length = [], None, None, False, 0, beats
    bits = len(dut.out_offset_o) // twin.lanes
    frame = swaps = clock = 0
    resets = {20, 33, 47}
    while frame < 120 + beats:
        if resets and frame >= min(resets) and (midway or beats == 1):
            resets.remove(min(resets))
            dut.take_i.value = 0
            settings.put(swap=0)
            if writer:
                await writer
            settings.put(swap=1)
            await FallingEdge(dut.clk_i)
            settings.put(swap=0)
            dut.rst_i.value = 1
            await FallingEdge(dut.clk_i)
            dut.rst_i.value = 0
            twin.reset()
            twin.preset = PRESETS[len(resets) % 2 - 1]
            settings.put(preset=twin.preset)
            due, asked, writer, midway, number = [], None, None, False, 0
        # The beat taken LATENCY clocks ago.
        if due and due[0][0] == clock:
            _, offset, gain = due.pop(0)
            assert bench.lane_values(bench.read(dut.out_offset_o), twin.lanes, bits, True) == offset
            assert bench.lane_values(bench.read(dut.out_gain_o), twin.lanes, 32) == gain
        # A swap requested in an earlier clock takes effect with the next frame's first beat.
        assert bench.read(dut.status_o) == (asked is not None)
        if asked is not None and not midway:
            for entry in asked:
                twin.put(*entry)
            twin.swap()
            asked, writer = None, None
        take = draw.random() >= pause_rate
        last = number == length - 1
        # As msn_frame_marker marks them: a beat with an early last does not fit, nor the final one without
        # last, nor the one after it, whose place is 0 again.
        place = number % beats
        dut.take_i.value, dut.last_i.value = int(take), int(take and last)
        dut.fits_i.value = int(number < beats and last == (number == beats - 1))
        dut.row_last_i.value = int(place % twin.row_beats == twin.row_beats - 1)
        settings.put(swap=0)
        if writer is None and dut.status_o.value == 0:
            found = entries(twin, draw)
            writer = cocotb.start_soon(write(dut, settings, found, twin, swaps))
        elif writer and writer.done() and asked is None and (number == frame % beats or draw.random() < 0.02):
            settings.put(swap=1)
            asked = found
            swaps += 1
        if take:
            offset, gain = (words.reshape(-1, twin.lanes)[place].tolist() for words in twin.words())
            due.append((clock + LATENCY, offset, gain))
            midway, number = not last, 0 if last else number + 1
            if last:
                frame += 1
                length = beats if frame % 3 else draw.choice([draw.randint(1, beats), beats + 1])
        clock += 1
        await FallingEdge(dut.clk_i)
    assert swaps > 10 and not resets


EVIDENCE = {
    "equivalence": {"size": {"Rows": 6}, "defined": True},
    "faults": {
        "size": {"Rows": 6},
        "settle": 3,  # frames of a single beat end while a word is in the six stages
        # The tables, what is written to them, the bank in use and whether one is loaded keep a fault until
        # they are written again.
        "driver": {"frame": "last_i", "kept": "memory bank loaded swapping write word entry"},
    },
}


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, offset",
    [
        (1, 1, 1, 17, 1),
        (8, 1, 4, 17, 0),
        (5, 27, 8, 17, 1),
        (6, 3, 1, 12, 1),
        (3, 15, 7, 17, 1),
        (2, 40, 2, 18, 1),
    ],
)
def test_grid_table(rows, columns, lanes, sample_bits, offset):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes}
    bench.run("frontend", "grid_table", size | {"SampleBits": sample_bits, "Offset": offset})


def test_model_of_rows_and_columns():
    grid = GridTable(2, 3, lanes=2)
    grid.write(0, 10, 3, 1)
    grid.write(1, -7, 5, 0)
    grid.write_row(1, 100, 7)
    grid.put(True, 2, slice(None), 1, 1)  # there is no row 2, no word 2: ignored
    grid.put(False, 2, slice(None), 1, 1)
    grid.preset = 3
    assert [words.tolist() for words in grid.words()] == [[[0] * 4] * 2, [[12288] * 4] * 2]
    grid.swap()
    offset, gain = grid.words()
    assert offset.tolist() == [[0, 10, -7, 0], [100, 110, 93, 100]]
    assert gain.tolist() == [[0, 0, 0, 0], [0, 21, 35, 0]]
    assert not np.any(GridTable(2, 3, offset=False).words()[0])


test_refuses_illegal_parameters = refusals(
    "grid_table",
    GridTable,
    *({"Rows": 0}, {"Columns": 1025}, {"Lanes": 9}, {"SampleBits": 19}),
    rows=1,
    columns=1,
)


def test_refuses_entries_beyond_a_register():
    refused(GridTable(1, 1).write, {"offset": 32768, "gain": 1}, {"gain": 65536, "offset": 0}, word=0)
    refused(GridTable(1, 1).write_row, {"gain": 65536}, row=0, offset=0)
