"""msn_calibration_table against its model: one taxel to a row-and-column array, all kinds of word; words
taken with pauses while the other bank is written; swaps in and between frames, at its first and last beat;
restarts after frames cut short; the clocks without a word; a reset."""

import random

import cocotb
import pytest
from cocotb.triggers import FallingEdge

import bench
from meissner.frontend.calibration_table import CalibrationTable


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "Offset", "RowColumn")
    return CalibrationTable(*(getattr(dut, name).value.to_unsigned() for name in names))


async def write_all(dut, twin, draw):
    """Fill the bank that is not in use with the ends of the range and random entries."""
    low, high = bench.width(twin.offset_bits)
    words = [(False, w, lane) for w in range(twin._beats.shape[2]) for lane in range(twin.lanes)]
    words += [(True, row, 0) for row in range(twin.rows) if twin.row_column]
    for of_row, word, lane in words:
        offset = draw.choice([low, high, draw.randint(low, high)])
        gain = draw.choice([0, 65535, draw.randint(0, 65535)])
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word, gain
        dut.cfg_offset_i.value = offset & ((1 << twin.offset_bits) - 1)
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, int(of_row)
        if of_row:
            twin.write_row(word, offset, gain)
        else:
            twin.write(word, offset, gain, lane)
        await bench.RisingEdge(dut.clk_i)
    dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pause_rate=[0.0, 0.5])
async def matches_model(dut, pause_rate):
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    quiet = {"cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0, "take_i": 0, "restart_i": 0}
    await bench.start(dut, last_i=0, **quiet)
    await FallingEdge(dut.clk_i)
    assert dut.loaded_o.value == 0
    beats, bits = twin.rows * twin.row_beats, len(dut.out_offset_o) // twin.lanes
    settle = 5 if twin.row_column else 3
    for bank in range(2):  # the second swap is taken up by the first frame
        await write_all(dut, twin, draw)
        dut.cfg_swap_i.value = 1
        await bench.RisingEdge(dut.clk_i)
        dut.cfg_swap_i.value = 0
        if bank == 0:
            twin.swap()
            await bench.clocks(dut, 2)
    swapping = True
    waited, cut, length = 0, False, beats
    for frame in range(24):
        cut = length != beats  # the frame before
        length = beats if frame % 3 else draw.randint(1, beats)
        writer = None
        for beat in range(length):
            while True:
                await FallingEdge(dut.clk_i)
                dut.cfg_swap_i.value = 0
                valid = dut.out_valid_o.value == 1
                take = valid and draw.random() >= pause_rate
                dut.take_i.value, dut.last_i.value = int(take), int(take and beat == length - 1)
                dut.restart_i.value = int(take and beat == length - 1 != beats - 1)
                waited += not valid
                if take:
                    break
            if beat == 0:
                assert waited <= (settle + 2 if swapping or cut else 0), f"waited {waited}"
                if swapping:
                    twin.swap()
                swapping = False
                if writer is None and frame % 2:
                    writer = cocotb.start_soon(write_all(dut, twin, draw))
            else:
                assert waited == 0
            waited = 0
            assert dut.loaded_o.value == 1
            offset, gain = (words.reshape(-1, twin.lanes)[beat] for words in twin.words())
            assert bench.lane_values(bench.read(dut.out_offset_o), twin.lanes, bits, True) == offset.tolist()
            assert bench.lane_values(bench.read(dut.out_gain_o), twin.lanes, twin_gain(twin)) == gain.tolist()
            if writer and writer.done() and draw.random() < 0.3 and not swapping:
                dut.cfg_swap_i.value = 1  # counts with this beat: the next frame is new
                swapping = True
        if writer:
            await bench.RisingEdge(dut.clk_i)
            dut.take_i.value = dut.restart_i.value = dut.cfg_swap_i.value = 0
            await writer
        elif draw.random() < 0.5:  # between frames
            await bench.RisingEdge(dut.clk_i)
            dut.take_i.value = dut.restart_i.value = 0
            dut.cfg_swap_i.value = int(not swapping)
            swapping = True
            await bench.RisingEdge(dut.clk_i)
            dut.cfg_swap_i.value = 0


def twin_gain(twin):
    return 32 if twin.row_column else 16


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, offset, row_column",
    [
        (1, 1, 1, 17, 1, 0),
        (3, 5, 2, 17, 1, 0),
        (4, 4, 1, 18, 0, 0),
        (1, 1, 1, 17, 1, 1),
        (7, 1, 4, 17, 0, 1),
        (5, 19, 8, 17, 1, 1),
        (6, 3, 1, 12, 1, 1),
    ],
)
def test_calibration_table(rows, columns, lanes, sample_bits, offset, row_column):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": sample_bits}
    bench.run("frontend", "calibration_table", size | {"Offset": offset, "RowColumn": row_column})


def test_model_of_rows_and_columns():
    table = CalibrationTable(2, 3, lanes=2, row_column=True)
    table.write(0, 10, 3, 1)
    table.write(1, -7, 5, 0)
    table.write_row(1, 100, 7)
    assert not table.loaded
    table.swap()
    offset, gain = table.words()
    assert table.loaded
    assert offset.tolist() == [[0, 10, -7, 0], [100, 110, 93, 100]]
    assert gain.tolist() == [[0, 0, 0, 0], [0, 21, 35, 0]]


def test_refuses_illegal_parameters():
    for name, value in {"Rows": 0, "Columns": 1025, "Lanes": 3, "SampleBits": 19}.items():
        assert f"{name} = {value}" in bench.refuses("calibration_table", {name: value})
    for size, message in (
        ((0, 1), "rows = 0"),
        ((1, 1025), "columns = 1025"),
        ((1, 1, 3), "lanes = 3"),
        ((1, 1, 1, 19), "sample_bits = 19"),
    ):
        with pytest.raises(ValueError, match=message):
            CalibrationTable(*size)
    with pytest.raises(ValueError, match="offset = 65536"):
        CalibrationTable(1, 1).write(0, 65536, 1)
    with pytest.raises(ValueError, match="gain = 65536"):
        CalibrationTable(1, 1).write(0, 0, 65536)
