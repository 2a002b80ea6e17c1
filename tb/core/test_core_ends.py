"""Settings wider than a core's registers, and words that it lacks, from the bus to the core's output.

3 rows of 5 columns in beats of two: 9 beats of a frame, 3 of a row, 20 bits of a load, 18 of a detail, 4 of a
time. Expected values are worked out here; values within the range are tried too. Wrapped values, where given,
are those that a core without saturation would use.
"""

import cocotb
import pytest
from cocotb.triggers import RisingEdge

import bench
from core import pins
from meissner.twins.link.registers import RESET_BITS, reset_word

ROWS, COLUMNS, LANES = 3, 5, 2
RESETS = {
    **{"calibrate.preset": 4096, "cop.min_load": 1, "tare.at_start": 0, "tare.step": 0},
    **{"slip.threshold": 100_000, "slip.contact_level": 500, "slip.release_level": 400},
}
SIZE = {
    "Array": 1,
    "Rows": ROWS,
    "Columns": COLUMNS,
    "Converters": LANES,
    "Uart": 0,
    "Image": 1,
    "Statistics": 0,
}
BUILD = SIZE | {"Window": 8, "Hop": 8, "TimerBits": 4, "Tare": 1, "TareLog2": 1, "SlipDepth": 8}
COP, IMAGE, SLIP = 2, 3, 1
AT = {  # from docs/registers.md
    **{"threshold": 0x200, "gross": 0x204, "contact_level": 0x208, "release_level": 0x20C, "hold": 0x214},
    **{"tare_load": 0x494, "tare_word": 0x498, "tare_zero": 0x49C, "tare_write": 0x4A0, "min_load": 0x600},
    **{"word": 0x504, "offset": 0x508, "gain": 0x50C, "write": 0x510, "swap": 0x514, "swapping": 0x518},
}


class Bench:
    def __init__(self, dut):
        self.dut, self.packets, self.byte = dut, [], bytearray()

    async def begin(self):
        dut = self.dut
        idle = {port._name: 0 for port in dut if port._name.endswith("_i") and port._name != "clk_i"}
        await bench.start(dut, **idle | {"out_ready_i": 1, "rx_i": 1})
        cocotb.start_soon(self._watch())
        await bench.clocks(dut, 100)
        return self

    async def _watch(self):
        while True:
            await RisingEdge(self.dut.clk_i)
            if self.dut.out_valid_o.value == 1:
                self.byte.append(bench.read(self.dut.out_data_o))
                if self.dut.out_last_o.value == 1:
                    self.packets.append(bytes(self.byte))
                    self.byte.clear()

    async def write(self, **values):
        for name, value in values.items():
            _, error = await pins.access(self.dut, True, AT[name], value)
            assert error == 0, name

    async def read(self, address):
        data, _ = await pins.access(self.dut, False, address)
        return data

    async def frame(self, codes, midway=None):
        """Send codes [rows][columns]; return the packets until the core is idle. ``midway``: awaited before
        beat 5."""
        dut, before = self.dut, len(self.packets)
        beats = -(-COLUMNS // LANES)
        for row in range(ROWS):
            for beat in range(beats):
                if midway and (row, beat) == (1, 2):
                    dut.in_valid_i.value = 0
                    await midway()
                lanes = [*codes[row], 0][beat * LANES : beat * LANES + LANES]
                dut.in_data_i.value = sum((code & 0x1FFFF) << 17 * lane for lane, code in enumerate(lanes))
                dut.in_id_i.value = row * beats + beat
                dut.in_last_i.value = int((row, beat) == (ROWS - 1, beats - 1))
                dut.in_valid_i.value = 1
                await RisingEdge(dut.clk_i)
                while dut.in_ready_o.value != 1:
                    await RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, 1700)  # a change of each taxel, too
        return self.packets[before:]

    async def image(self, codes, midway=None):
        """Forces [rows][columns] of a frame."""
        (image,) = [packet for packet in await self.frame(codes, midway) if packet[0] == IMAGE]
        taxels = [int.from_bytes(image[n : n + 2], "little") for n in range(13, len(image) - 4, 2)]
        assert len(taxels) == ROWS * COLUMNS
        return [taxels[n : n + COLUMNS] for n in range(0, len(taxels), COLUMNS)]


def flat(code):
    return [[code] * COLUMNS for _ in range(ROWS)]


CODES = [[101 + 10 * row + column for column in range(COLUMNS)] for row in range(ROWS)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def says_its_bits_and_its_words(dut):
    core = await Bench(dut).begin()
    assert await core.read(0x018) == 17 << 24 | 20 << 16 | 4 << 8 | 18
    assert await core.read(0x01C) == 9
    await core.write(threshold=300_000)
    assert await core.read(0x200) == 262_143


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_least_load_is_held_at_its_end(dut):
    """15 taxels of 1000 are 15000. Wrapped, 2^20 would be 0, and 2^20 + 15000 the load itself."""
    core = await Bench(dut).begin()
    for least, pressed in (
        *((15_000, 1), (15_001, 0), (1 << 20, 0), (14_999, 1), ((1 << 20) + 15_000, 0), (2**32 - 1, 0)),
        *((0x40_0000, 0), (0, 1), ((1 << 20) - 1, 0), (1, 1)),
    ):
        await core.write(min_load=least)
        await core.frame(flat(1000))  # settings change between frames
        (cop,) = [packet for packet in await core.frame(flat(1000)) if packet[0] == COP]
        assert int.from_bytes(cop[14:19], "little") == 15_000
        assert cop[19] == bench.read(dut.pressed_o) == pressed, least


async def swings(core, frames):
    """Whether anything slips after each frame of codes that alternate: a detail of 700, then -700."""
    seen = []
    for n in range(frames):
        await core.frame(flat((1000, 300, 300, 1000)[n % 4]))
        seen.append(bench.read(core.dut.slip_o))
    return seen


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_threshold_is_held_at_its_end(dut):
    """Peak to peak is 1400. Wrapped, 262144 + 300 would be 300; 1400 does not slip, 1399 does."""
    core = await Bench(dut).begin()
    for threshold, slips in ((1400, 0), (262_444, 0), (1399, 1), (262_144, 0), (300, 1), (0xF_FFFF, 0)):
        await core.write(threshold=threshold, gross=0xF_FFFF)
        await core.frame(flat(0))  # released, which ends a raised slip
        await core.frame(flat(0))
        assert max(await swings(core, 16)) == slips, threshold


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def levels_are_held_at_both_ends(dut):
    """A group's sum is 2000. Wrapped, 262144 - 5 is -5, always contact; -262144 + 60000 is 60000, never
    contact."""
    core = await Bench(dut).begin()
    for contact, release, touched in (
        *((2000, 100, 1), (2001, 100, 0), (262_139, 100, 0), (131_072, 100, 0)),
        *((-202_144, -300_000, 1), (131_071, 100, 0), (-131_073, -131_073, 1)),
    ):
        await core.write(contact_level=0x7_FFFF, release_level=0x7_FFFF)
        for _ in range(4):
            await core.frame(flat(0))
        assert dut.touched_o.value == 0
        await core.write(contact_level=contact, release_level=release)
        for _ in range(4):
            await core.frame(flat(1000))
        assert bench.read(dut.touched_o) == touched, (contact, release)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_time_is_held_at_its_end(dut):
    """Four bits: wrapped, 16 would be 0; it is 15. Each detail of hold lasts two frames."""
    core, found = await Bench(dut).begin(), {}
    await core.write(threshold=1399, gross=0xF_FFFF, contact_level=-100, release_level=-101)
    for hold in (0, 14, 15, 16, 0xFFFF):
        await core.write(hold=hold)
        seen = await swings(core, 8)
        for _ in range(56):
            await core.frame(flat(300))
            seen.append(bench.read(dut.slip_o))
        assert seen[-1] == 0 and 1 in seen
        found[hold] = sum(seen)
    assert found[15] == found[14] + 2 == found[0] + 30
    assert found[16] == found[0xFFFF] == found[15]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def zeros_of_words_that_are_not_there_are_lost(dut):
    """Word 4, lane 1 is row 1, column 3. 9 is the first missing word; wrapped, 16 + 4 and 2^19 would be 4 and
    0."""
    core = await Bench(dut).begin()
    await core.write(tare_load=1)
    await core.frame(CODES)
    for word in range(9):
        await core.write(tare_word=word, tare_zero=0, tare_write=0b11)
    await core.write(tare_word=4, tare_zero=-5, tare_write=0b10)
    for word in (9, 15, 16, 20, 32, 1 << 19, (1 << 20) - 1):
        await core.write(tare_word=word, tare_zero=77, tare_write=0xFF)
    await core.write(tare_load=0)
    expected = [[*row] for row in CODES]
    expected[1][3] += 5
    assert await core.image(CODES) == expected
    await core.write(tare_load=1)
    await core.frame(CODES)
    await core.write(tare_word=8, tare_zero=77, tare_write=0b01, tare_load=0)
    expected[2][4] -= 77
    assert await core.image(CODES) == expected


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def gains_of_words_that_are_not_there_are_lost(dut):
    core = await Bench(dut).begin()
    for word in range(9):
        await core.write(word=word, offset=0, gain=4096, write=0b11)
    await core.write(word=8, gain=8192, write=0b01)
    for word in (9, 15, 16, 24, 1 << 19, (1 << 20) - 1):
        await core.write(word=word, gain=0, write=0xFF)
        await core.write(word=word, gain=0, write=0x100)
    await core.write(swap=1)
    await core.frame(CODES)
    expected = [[*row] for row in CODES]
    expected[2][4] *= 2
    assert await core.image(CODES) == expected


async def swapping_in_a_frame(dut, words, row_words):
    """A swap requested during a frame: calibrate.swapping is 1 until its last beat, then 0; the frame keeps
    its gains, the next one has the new ones: 2, 3, 4 for the beats of a row, 5 for word 1, lane 1."""
    core = await Bench(dut).begin()
    for word in range(words):
        await core.write(word=word, offset=-word, gain=4096 * (2 + word % 3), write=0b11)
    await core.write(word=1, offset=-1, gain=5 * 4096, write=0b10)
    for word in range(row_words):
        await core.write(word=word, offset=-10 * word, gain=4096, write=0x100)
    seen = []

    async def midway():
        seen.append(await core.read(AT["swapping"]))
        await core.write(swap=1)
        seen.append(await core.read(AT["swapping"]))
        await bench.clocks(dut, 90)
        seen.append(await core.read(AT["swapping"]))

    assert await core.image(CODES, midway) == CODES
    seen.append(await core.read(AT["swapping"]))
    assert seen == [0, 1, 1, 0]

    def force(row, column):
        beat, lane = divmod(column, LANES)
        offset = 10 * row + beat if row_words else 0  # taxel offsets are replaced by the zeros here
        gain = 5 if (beat, lane) == (1, 1) and (row_words or row == 0) else 2 + beat
        return (CODES[row][column] + offset) * gain

    expected = [[force(row, column) for column in range(COLUMNS)] for row in range(ROWS)]
    assert await core.image(CODES) == expected
    assert await core.read(AT["swapping"]) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def says_that_a_swap_waits(dut):
    await swapping_in_a_frame(dut, 9, 0)


def test_core_ends():
    word = f"{RESET_BITS}'h{reset_word(RESETS):x}"
    bench.run("core", "core", BUILD | {"Resets": word}, module="test_core_ends")


def test_core_ends_of_rows_and_columns():
    word = f"{RESET_BITS}'h{reset_word(RESETS):x}"
    given = SIZE | {"RowColumn": 1, "Slip": 0, "Resets": word}
    bench.run("core", "core", given, module="test_core_ends_row_column")


@pytest.mark.parametrize("bits", [0, 17])
def test_times_have_one_to_sixteen_bits(bits):
    assert f"TimerBits = {bits}" in bench.refuses("core", {"TimerBits": bits}, of="registers")


FOUR_WIRES = {"Cop4": 1, "Slip": 0, "Channels": 4}


@pytest.mark.parametrize("bits, kind", [(18, {}), (16, {"Array": 1}), (16, FOUR_WIRES), (18, FOUR_WIRES)])
def test_samples_have_at_most_seventeen_bits(bits, kind):
    said = bench.refuses("core", {"SampleBits": bits, **kind})
    assert f"SampleBits = {bits} must be at most 17, and 17 with Array or Cop4" in said


@pytest.mark.parametrize("kind", [{}, FOUR_WIRES])
def test_a_single_sensor_has_one_converter(kind):
    """The pins of a second one would be undriven."""
    said = bench.refuses("core", {"Converters": 2, **kind})
    assert "Converters = 2 must lie in 1 .. 8, and be 1 without Array" in said
