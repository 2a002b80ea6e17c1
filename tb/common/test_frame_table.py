"""msn_frame_table against its model: one word to many, both banks, parts written one by one while the other
bank is read; restarts anywhere, with stalls; a word is valid two advances after a restart."""

import os
import random

import cocotb
import pytest
from cocotb.triggers import FallingEdge

import bench
from meissner.twins.common.frames import FrameTable


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(pause_rate=[0.0, 0.5])
async def matches_model(dut, pause_rate):
    words, parts, bits, banks, start = [
        getattr(dut, name).value.to_unsigned() for name in ("Words", "Parts", "PartBits", "Banks", "Start")
    ]
    draw = random.Random(bench.SEED)
    twin = FrameTable(words, parts, banks, start)
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    dut.advance_i.value = 0
    dut.restart_i.value = 1
    dut.write_i.value = 0
    await bench.RisingEdge(dut.clk_i)  # the first edge of all, before these values reach the block

    async def write(bank, word, strobes):
        data = [draw.getrandbits(bits) for _ in range(parts)]
        dut.write_bank_i.value, dut.write_word_i.value = bank, word
        dut.write_data_i.value = sum(value << (bits * p) for p, value in enumerate(data))
        dut.write_i.value = strobes
        for p in range(parts):
            if strobes >> p & 1:
                twin.write(bank, word, data[p], p)

    for bank in range(banks):
        for word in range(words):
            await write(bank, word, (1 << parts) - 1)
            await bench.RisingEdge(dut.clk_i)
    dut.write_i.value = 0
    for _ in range(30):
        bank = draw.randrange(banks)
        dut.restart_i.value, dut.bank_i.value = 1, bank
        twin.restart(bank)
        for _ in range(draw.randint(1, 3)):
            dut.advance_i.value = draw.getrandbits(1)
            await bench.RisingEdge(dut.clk_i)
        # a later change of the bank input must not affect the words
        dut.restart_i.value, dut.bank_i.value = 0, draw.choice([bank, 1 - bank])
        waited, due, expected = 0, draw.randint(1, 3 * words), None
        wanted = due
        while due:
            if banks == 2:
                await write(1 - bank, draw.randrange(words), draw.getrandbits(parts))
            await FallingEdge(dut.clk_i)
            valid = dut.out_valid_o.value == 1
            if valid and expected is None:
                assert waited == 2
                expected = sum(int(part) << (bits * p) for p, part in enumerate(twin.next(1)[0]))
            assert not valid or bench.read(dut.out_data_o) == expected
            if valid:  # bank_i as driven now; only the reader uses at_end_o
                here = bank == int(dut.bank_i.value) or banks == 1
                assert dut.at_end_o.value == (here and (wanted - due) % words == words - 1)
            waited += not valid
            take = valid and draw.random() >= pause_rate
            dut.advance_i.value = int(take or not valid)
            if take:
                due, expected = due - 1, None
            await bench.RisingEdge(dut.clk_i)
        dut.write_i.value = 0


# The netlist of `make mutants` is without what is only for simulation.
@bench.applies(lambda dut: "MEISSNER_MUTANTS" not in os.environ)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_word_that_is_written_as_it_is_read_shows(dut):
    """A word that is read in the clock of its write is undefined in the memories: in simulation the written
    parts read as the old value with every bit inverted, and as the new one after the next restart. Written
    before the read, in a clock without an advance: new. Written in the other bank, or a clock after the read:
    old."""
    parts, bits, banks, start = [
        getattr(dut, name).value.to_unsigned() for name in ("Parts", "PartBits", "Banks", "Start")
    ]
    top, every = (1 << bits) - 1, (1 << parts) - 1
    old = [(5 * part + 11) & top for part in range(parts)]
    new = [(3 * part + 6) & top for part in range(parts)]
    bench.Clock(dut.clk_i, 10, unit="ns").start()

    async def clock(restart=0, advance=0, write=None):
        """``write``: (values, strobes, bank) for the word ``start``."""
        dut.restart_i.value, dut.advance_i.value, dut.bank_i.value = restart, advance, banks - 1
        values, strobes, bank = write or (new, 0, banks - 1)
        dut.write_i.value, dut.write_bank_i.value, dut.write_word_i.value = strobes, bank, start
        dut.write_data_i.value = bench.lane_word(values, bits)
        await bench.RisingEdge(dut.clk_i)

    async def word():
        """The word shown after the previous clock's advance and this one's."""
        await clock(advance=1)
        await bench.ReadOnly()
        assert dut.out_valid_o.value == 1
        values = bench.lane_values(bench.read(dut.out_data_o), parts, bits)
        await bench.RisingEdge(dut.clk_i)
        return values

    for strobes in {1, every, every ^ 1} - {0}:
        here = lambda values, others, strobes=strobes: [
            values[part] if strobes >> part & 1 else others[part] for part in range(parts)
        ]
        write = (new, strobes, banks - 1)
        scenes = [
            ([(0, write), (1, None)], here(new, old)),
            ([(1, write)], here([top - value for value in old], old)),
            ([(0, None), (1, None)], here(new, old)),  # new from the next clock on
        ]
        if banks == 2:
            scenes.insert(1, ([(1, (new, strobes, 0))], None))
        await clock(restart=1, write=(old, every, banks - 1))
        for steps, expected in scenes:
            if steps != [(0, None), (1, None)]:
                await clock(restart=1, write=(old, every, banks - 1))
            await clock(restart=1)
            for advance, given in steps:
                await clock(advance=advance, write=given)
            assert await word() == (old if expected is None else expected), (strobes, steps)
        # Written a clock after the read.
        await clock(restart=1, write=(old, every, banks - 1))
        await clock(restart=1)
        await clock(advance=1)
        await clock(write=write)
        assert await word() == old, strobes


EVIDENCE = {
    "equivalence": {
        "size": {"Words": 3},
        "defined": True,
        "reset": {"clocks": 2, "alike": True, "reset": "restart_i"},
    },
    "faults": {"inside": ["calibrate", "u_beats."]},
}


@pytest.mark.parametrize(
    "words, parts, bits, banks, start",
    [
        (1, 1, 5, 2, 0),
        (2, 3, 4, 1, 1),
        (3, 2, 7, 2, 2),
        (53, 1, 41, 2, 0),  # slices of 36 and 5 bits
        (257, 2, 37, 2, 7),  # 514 words deep: slices of 18, 18 and 1 bits
        (512, 1, 3, 2, 9),  # the upper bit of the address selects the bank
        (64, 8, 9, 1, 8),
        (90, 1, 3, 2, 0),
        (128, 1, 1, 2, 5),
    ],
)
def test_frame_table(words, parts, bits, banks, start):
    size = {"Words": words, "Parts": parts, "PartBits": bits, "Banks": banks, "Start": start}
    bench.run("common", "frame_table", size)


def test_model_in_chunks():
    table = FrameTable(5, start=2)
    for word in range(5):
        table.write(0, word, word)
    assert [int(v) for v in table.next(4)[:, 0]] == [2, 3, 4, 0]
    assert [int(v) for v in table.next(3)[:, 0]] == [1, 2, 3]


def test_refuses_illegal_parameters():
    assert "Words = 0" in bench.refuses("frame_table", {"Words": 0})
    assert "Parts = 0" in bench.refuses("frame_table", {"Parts": 0})
    assert "Banks = 3" in bench.refuses("frame_table", {"Banks": 3})
    assert "Start = 4096" in bench.refuses("frame_table", {"Start": 4096})
    for size, message in (
        ((0,), "words = 0"),
        ((1, 0), "parts = 0"),
        ((1, 1, 3), "banks = 3"),
        ((4, 1, 1, 4), "start = 4"),
    ):
        with pytest.raises(ValueError, match=message):
            FrameTable(*size)
