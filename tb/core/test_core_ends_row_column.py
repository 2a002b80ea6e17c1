"""Gains of rows and columns in a core of 3 rows of 5 columns, in beats of two: with the default of GainShift,
4096 is a gain of one in both; offsets have 16 bits; writes to missing words of rows and columns are
ignored."""

import cocotb

from core.test_core_ends import CODES, Bench, swapping_in_a_frame


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def forces_are_the_codes_by_default(dut):
    core = await Bench(dut).begin()
    assert await core.image(CODES) == CODES
    assert await core.read(0x018) == 16 << 24 | 20 << 16 | 16 << 8 | 18
    assert await core.read(0x01C) == 9


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def words_that_are_not_there_are_lost(dut):
    """A row has three beats, and there are three rows: word 3 is missing in both; 4 and 16 have low bits of
    0."""
    core = await Bench(dut).begin()
    for word in range(3):
        await core.write(word=word, offset=0, gain=4096, write=0b11)
        await core.write(word=word, offset=0, gain=4096, write=0x100)
    await core.write(word=2, gain=8192, write=0b01)
    for word in (3, 4, 8, 9, 16, 1 << 19, (1 << 20) - 1):
        await core.write(word=word, offset=-50, gain=0, write=0x0FF)
        await core.write(word=word, offset=-50, gain=0, write=0x100)
    await core.write(swap=1)
    await core.frame(CODES)
    expected = [[*row[:4], 2 * row[4]] for row in CODES]
    assert await core.image(CODES) == expected
    for word in range(3):
        await core.write(word=word, offset=0, gain=4096, write=0b11)
        await core.write(word=word, offset=0, gain=12_288 if word == 2 else 4096, write=0x100)
    await core.write(swap=1)
    await core.frame(CODES)
    assert await core.image(CODES) == [*CODES[:2], [3 * code for code in CODES[2]]]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_offset_is_held_at_both_ends(dut):
    """Column 1 is word 0, lane 1: -40000 becomes -32768 (wrapped: 25536), 40000 becomes 32767. Row offsets
    add."""
    core = await Bench(dut).begin()
    for word in range(3):
        await core.write(word=word, offset=0, gain=4096, write=0x100)
        await core.write(word=word, offset=0, gain=4096, write=0b11)
    await core.write(word=0, offset=-40_000, write=0b10, swap=1)
    await core.frame(CODES)
    assert await core.image(CODES) == [[row[0], row[1] + 32_768, *row[2:]] for row in CODES]
    for word in range(3):
        await core.write(word=word, offset=-30_000 if word == 1 else 0, gain=4096, write=0x100)
        await core.write(word=word, offset=0, gain=4096, write=0b11)
    await core.write(word=0, offset=40_000, write=0b10, swap=1)
    await core.frame(CODES)
    expected = [[*row] for row in CODES]
    expected[1] = [code + 30_000 for code in CODES[1]]
    for row, more in enumerate((0, 30_000, 0)):
        expected[row][1] = max(0, CODES[row][1] + more - 32_767)
    assert await core.image(CODES) == expected


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def says_that_a_swap_waits(dut):
    await swapping_in_a_frame(dut, 3, 3)
