"""msn_taxel_table against its model: one taxel to rows that do not fill their lanes; words taken with
pauses while the other bank is written; swaps in and between frames, at a frame's first and last beat; frames
cut short; the clocks without a word; resets in mid-frame."""

import random

import cocotb
import pytest
from cocotb.triggers import FallingEdge

import bench
from harness.refusals import refusals, refused
from meissner.twins.frontend.calibrate import TaxelTable
from members import Settings

PRESET = 0xA9C5


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "Offset")
    twin = TaxelTable(*(getattr(dut, name).value.to_unsigned() for name in names))
    twin.preset = PRESET
    return twin


async def write_all(dut, settings, twin, draw):
    """Fill the bank that is not in use with the ends of the range and random entries; then write what is not
    there."""
    low, high = bench.width(min(17, twin.offset_bits))
    words = [(w, lane) for w in range(twin.beats) for lane in range(twin.lanes)]
    for word, lane in words:
        offset = draw.choice([low, high, draw.randint(low, high)])
        gain = draw.choice([0, 65535, draw.randint(0, 65535)])
        twin.write(word, offset, gain, lane)
        entry = {"word": word, "offset": offset, "gain": gain, "write_lanes": 1 << lane}
        await settings.pulse(dut.clk_i, write_written=1, **entry)
    for word in (twin.beats, twin.beats + (1 << 19) - 1):
        await settings.pulse(dut.clk_i, write_written=1, word=word, offset=77, gain=99, write_lanes=255)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pause_rate=[0.0, 0.5])
async def matches_model(dut, pause_rate):
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    settings = Settings(dut, "calibrate_cfg", preset=PRESET)
    await bench.start(dut, last_i=0, take_i=0)
    await FallingEdge(dut.clk_i)
    beats, bits = twin.rows * twin.row_beats, len(dut.out_offset_o) // twin.lanes
    for bank in range(2):  # the second swap takes effect with the first frame
        await write_all(dut, settings, twin, draw)
        await settings.pulse(dut.clk_i, swap=1)
        if bank == 0:
            twin.swap()
            await bench.clocks(dut, 2)
    swapping = True
    waited, cut, length = 0, False, beats
    for frame in range(24):
        cut = length != beats  # of the previous frame
        length = beats if frame % 3 else draw.randint(1, beats)
        writer = None
        for beat in range(length):
            while True:
                await FallingEdge(dut.clk_i)
                settings.put(swap=0)
                valid = dut.out_valid_o.value == 1
                take = valid and draw.random() >= pause_rate
                dut.take_i.value, dut.last_i.value = int(take), int(take and beat == length - 1)
                waited += not valid
                if take:
                    break
            if beat == 0:
                # Without a calibration it may have begun in the other bank, which it finds at the frame's
                # end.
                assert waited <= (5 if swapping or cut or not twin.loaded else 0), f"waited {waited}"
                assert waited == 2 or frame % 8 != 6, f"{waited} clocks after a reset"
                if swapping:
                    twin.swap()
                swapping = False
                if writer is None and frame % 2:
                    writer = cocotb.start_soon(write_all(dut, settings, twin, draw))
            else:
                assert waited == 0
            waited = 0
            offset, gain = (words.reshape(-1, twin.lanes)[beat].tolist() for words in twin.words())
            assert bench.lane_values(bench.read(dut.out_offset_o), twin.lanes, bits, True) == offset
            assert bench.lane_values(bench.read(dut.out_gain_o), twin.lanes, 16) == gain
            if frame % 8 == 5:
                if beat == length // 2:
                    break
            elif (not writer or writer.done()) and draw.random() < 0.3 and not swapping:
                settings.put(swap=1)  # taken with this beat: it applies to the next frame
                swapping = True
        if frame % 8 == 5:  # reset with a swap requested
            await bench.RisingEdge(dut.clk_i)
            dut.take_i.value = 0
            await writer
            await settings.pulse(dut.clk_i, swap=1)
            await bench.reset(dut)
            twin.reset()
            swapping, length = False, 0
        elif writer:
            await bench.RisingEdge(dut.clk_i)
            dut.take_i.value = 0
            settings.put(swap=0)
            await writer
        elif draw.random() < 0.5:  # between frames
            await bench.RisingEdge(dut.clk_i)
            dut.take_i.value = 0
            await settings.pulse(dut.clk_i, swap=int(not swapping))
            swapping = True


@bench.applies(bench.whole)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_reset_selects_the_first_bank(dut):
    """Whichever was in use before. A user sees only which bank a write goes to, and that is the other one, so
    the register itself is read: both values would do, but the twin and the proofs of the netlist know one."""
    settings = Settings(dut, "calibrate_cfg")
    await bench.start(dut, take_i=0, last_i=0)
    for swaps in range(3):
        await FallingEdge(dut.clk_i)
        assert bench.read(dut.bank) == 0, f"swap {swaps}"
        for _ in range(swaps):
            await settings.pulse(dut.clk_i, swap=1)
            await bench.clocks(dut, 4)
            await FallingEdge(dut.clk_i)
        assert bench.read(dut.bank) == swaps % 2
        await bench.reset(dut)


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3}, "defined": True},
    "faults": {"size": {"Rows": 3}, "inside": ["calibrate", "u_table."]},
}


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, offset",
    [(1, 1, 1, 17, 1), (3, 5, 2, 17, 1), (4, 4, 1, 18, 0), (4, 10, 3, 17, 1), (5, 19, 8, 17, 1)],
)
def test_taxel_table(rows, columns, lanes, sample_bits, offset):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes}
    bench.run("frontend", "taxel_table", size | {"SampleBits": sample_bits, "Offset": offset})


test_refuses_illegal_parameters = refusals(
    "taxel_table",
    TaxelTable,
    *({"Rows": 0}, {"Columns": 1025}, {"Lanes": 9}, {"SampleBits": 19}),
    rows=1,
    columns=1,
)


def test_refuses_entries_beyond_a_register():
    refused(TaxelTable(1, 1).write, {"offset": 65536, "gain": 1}, {"gain": 65536, "offset": 0}, word=0)
