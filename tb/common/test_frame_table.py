"""msn_frame_table against its model: one word to many, both banks, parts written one by one while the other
bank is read; restarts anywhere, with stalls; a word is valid two advances after a restart; one that is
written as it is read is marked."""

import random

import cocotb
import pytest
from cocotb.triggers import FallingEdge

import bench
from harness.refusals import refusals
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
    for _ in range(bench.rounds(30)):
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


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def marks_a_word_that_is_written_as_it_is_read(dut):
    """A plain loop: writes to every bank, mostly of the word that is read or the one before or after it,
    restarts and pauses. A marked word is undefined; any other is what was last written before it was read."""
    words, parts, bits, banks, start = [
        getattr(dut, name).value.to_unsigned() for name in ("Words", "Parts", "PartBits", "Banks", "Start")
    ]
    draw = random.Random(bench.SEED)
    memory = [[None] * parts for _ in range(words * banks)]
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    read, shown, seen = None, None, set()  # (values, spoilt) of the word in flight and of the one that waits
    bank = place = 0
    for clock in range(600):
        restart, advance = clock == 0 or draw.random() < 0.05, draw.random() < 0.6
        given, strobes = draw.randrange(banks), draw.randrange(1 << parts)
        near, other = (place + draw.choice([-1, 0, 0, 1])) % words, draw.randrange(banks)
        values = [draw.getrandbits(bits) for _ in range(parts)]
        dut.restart_i.value, dut.bank_i.value, dut.advance_i.value = int(restart), given, int(advance)
        dut.write_i.value, dut.write_bank_i.value, dut.write_word_i.value = strobes, other, near
        dut.write_data_i.value = bench.lane_word(values, bits)
        await FallingEdge(dut.clk_i)
        if clock > 0:
            assert dut.out_valid_o.value == int(shown is not None)
        if clock > 0 and shown is not None:
            word, spoilt = shown
            assert dut.out_spoilt_o.value == int(spoilt)
            found = bench.lane_values(bench.read(dut.out_data_o), parts, bits) if not spoilt else []
            assert all(known is None or known == is_ for known, is_ in zip(word, found)), clock
            seen.add((spoilt, bank == other, near == place))
        await bench.RisingEdge(dut.clk_i)
        address = bank * words + place
        if advance:
            hit = strobes != 0 and (bank, place) == (other, near)
            read, shown = ([*memory[address]], hit), read
            place = (place + 1) % words
        for part, value in enumerate(values):
            if strobes >> part & 1:
                memory[other * words + near][part] = value
        if restart:
            bank, place, read, shown = given, start, None, None
    assert {spoilt for spoilt, *_ in seen} == {False, True}


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


test_refuses_illegal_parameters = refusals(
    "frame_table", FrameTable, {"Words": 0}, {"Parts": 0}, {"Banks": 3}, {"Start": 4096}, words=4
)
