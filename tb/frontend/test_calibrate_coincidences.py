"""Events that meet in one clock in msn_calibrate, with forces worked out by hand from the header's formula: a
swap requested at every clock around a frame's first and last beat, in mid-frame and twice; an entry written
in the clock of the request and right after the exchange; row x column: its credit with the FIFO exactly full
and exactly empty."""

import cocotb
import pytest

import bench

ROWS, COLUMNS, LANES, ROW_BEATS, BEATS = 3, 5, 2, 3, 9
TOP = 65535
CREDIT = 31  # beats that row x column takes while none leaves: 29 of credit and those taken before it shows


def row_column(dut):
    return bool(dut.RowColumn.value.to_unsigned())


def raw_of(frame, beat, lane):
    return 3000 + 211 * frame + 17 * beat + 5 * lane


# Gains are 1, 2, 3 .. times 4096; offsets of taxels differ in every beat and lane, otherwise in rows and
# columns.
def force(dut, level, frame, beat, lane):
    """(raw - offset) gain of the calibration ``level``; the unused lane of a row is calibrated too."""
    row, column = divmod(beat, ROW_BEATS)
    offset = 100 * row + 10 * column + lane if row_column(dut) else 11 * beat + lane
    return min((raw_of(frame, beat, lane) - offset - 7 * level) * (level + 1), TOP)


def entries(dut, level):
    """(of a row?, word, lanes, offset, gain) of an entire bank."""
    gain = 4096 * (level + 1)
    if not row_column(dut):
        return [
            (0, word, lane, 11 * word + lane + 7 * level, gain) for word in range(BEATS) for lane in (0, 1)
        ]
    columns = [(0, word, lane, 10 * word + lane, gain) for word in range(ROW_BEATS) for lane in (0, 1)]
    return columns + [(1, row, 0, 100 * row + 7 * level, 4096) for row in range(ROWS)]


class Line:
    """Runs single clocks and records what goes in and out, and in which clock."""

    def __init__(self, dut):
        self.dut, self.clock, self.taken, self.out = dut, 0, [], []

    def entry(self, of_row, word, lane, offset, gain):
        dut = self.dut
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, of_row
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word, gain
        dut.cfg_offset_i.value = offset & ((1 << len(dut.cfg_offset_i)) - 1)

    async def tick(self, beat=None, ready=1, swap=0, write=None):
        """One clock; returns whether ``beat`` (frame, number) went in. ``write``: one of ``entries``."""
        dut = self.dut
        dut.in_valid_i.value, dut.out_ready_i.value, dut.cfg_swap_i.value = int(beat is not None), ready, swap
        if write:
            self.entry(*write)
        else:
            dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0
        if beat is not None:
            frame, number = beat
            bits = len(dut.in_data_i) // LANES
            dut.in_data_i.value = bench.lane_word([raw_of(frame, number, lane) for lane in (0, 1)], bits)
            bench.offer(dut, {"mask": 0, **bench.marks(number, ROWS, ROW_BEATS)})
        await bench.ReadOnly()
        if ready and dut.out_valid_o.value == 1:
            forces = bench.lane_values(bench.read(dut.out_data_o), LANES, 16)
            marks = [bench.read(getattr(dut, f"out_{name}_o")) for name in ("fits", "row_last", "last")]
            self.out.append((*marks, *forces))
        took = beat is not None and dut.in_ready_o.value == 1
        if took:
            self.taken.append(self.clock)
        await bench.RisingEdge(dut.clk_i)
        self.clock += 1
        return took

    async def load(self, level):
        for entry in entries(self.dut, level):
            await self.tick(write=entry)

    async def swapped(self):
        """Request the swap between frames and wait until it is in effect."""
        await self.tick(swap=1)
        for _ in range(6):
            await self.tick()

    async def send(self, beats, swaps=(), writes=None):
        """Send ``beats`` without gaps; cfg_swap_i in the clocks ``swaps``, entries in those of ``writes``."""
        for beat in beats:
            while not await self.tick(
                beat, swap=int(self.clock in swaps), write=(writes or {}).get(self.clock)
            ):
                pass
        for _ in range(20):
            await self.tick()


def whole(*frames):
    return [(frame, number) for frame in frames for number in range(BEATS)]


def beats_of(dut, levels):
    """The output for frames 0, 1, .. with the calibrations ``levels``."""
    return [
        (
            *(1, int(number % ROW_BEATS == ROW_BEATS - 1), int(number == BEATS - 1)),
            *(force(dut, level, frame, number, lane) for lane in (0, 1)),
        )
        for frame, level in enumerate(levels)
        for number in range(BEATS)
    ]


async def begin(dut):
    """Reset; then level 0 is in use and level 1 is written."""
    await bench.reset(dut)
    line = Line(dut)
    await line.load(0)
    await line.swapped()
    await line.load(1)
    line.clock, line.taken, line.out = 0, [], []
    return line


QUIET = {"cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_swap_around_a_frames_first_and_last_beat(dut):
    """Requested in the clock of a beat, before or after it, a swap takes effect with the first frame that
    begins in a later clock. Three clocks pass before that frame's first beat, and none elsewhere; row x
    column never stalls."""
    await bench.start(dut, **QUIET)
    line = await begin(dut)
    await line.send(whole(0, 1, 2, 3))
    assert line.out == beats_of(dut, [0, 0, 0, 0])
    assert line.taken == list(range(line.taken[0], line.taken[0] + 4 * BEATS))
    begun = line.taken[::BEATS]
    met = set()
    for at in range(begun[1] - 2, begun[2] + 3):
        line = await begin(dut)
        await line.send(whole(0, 1, 2, 3), swaps={at})
        first = 1 if at < begun[1] else 2 if at < begun[2] else 3
        assert line.out == beats_of(dut, [0] * first + [1] * (4 - first)), at - begun[1]
        gaps = [after - before - 1 for before, after in zip(line.taken, line.taken[1:])]
        assert all(gap == 0 for number, gap in enumerate(gaps) if number != first * BEATS - 1), at - begun[1]
        assert gaps[first * BEATS - 1] == (0 if row_column(dut) else 3), at - begun[1]
        assert dut.cfg_swapping_o.value == 0
        met.add(first)
    assert met == {1, 2, 3}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def swapping_until_the_frame_is_over(dut):
    """cfg_swapping_o is set from the clock after the request to the one after the frame's last beat; a second
    request while the first is pending has no further effect."""
    await bench.start(dut, **QUIET)
    for again in (None, 2, BEATS - 2):
        line = await begin(dut)
        seen = []
        for number in range(BEATS):
            assert await line.tick((0, number), swap=int(number in (1, again)))
            seen.append(bench.read(dut.cfg_swapping_o))
        for _ in range(3):
            await line.tick()
            seen.append(bench.read(dut.cfg_swapping_o))
        assert seen == [0, 0] + [1] * (BEATS - 1) + [0, 0]
        await line.send(whole(1))
        assert line.out == beats_of(dut, [0, 1])


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_entry_in_the_clock_of_the_request(dut):
    """The last entry of a calibration, written in the clock of the swap request, belongs to it. An entry
    written while the first frame with it passes belongs to the next calibration."""
    await bench.start(dut, **QUIET)
    line = await begin(dut)
    *most, last = entries(dut, 2)
    for entry in most:
        await line.tick(write=entry)
    await line.tick(write=last, swap=1)
    for _ in range(6):
        await line.tick()
    written = {line.clock + n: entry for n, entry in enumerate(entries(dut, 4))}
    line.out = []
    asked = line.clock + 2 * BEATS + 3  # within frame 2
    await line.send(whole(0, 1, 2, 3), swaps={asked}, writes=written)
    assert line.out == beats_of(dut, [2, 2, 2, 4])


@bench.applies(row_column)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_credit_is_whole_after_full_and_empty(dut):
    """Row x column: the output stalls for 100 clocks, then takes one beat now and then, then all; again and
    again. The credit is used up at 31 beats; when it is back to 28, 3 more go in before that is seen."""
    await bench.start(dut, **QUIET)
    line = await begin(dut)
    frames = 24
    beats, sent = whole(*range(frames)), 0

    async def clocks(count, ready=0, offer=True):
        nonlocal sent
        for _ in range(count):
            sent += await line.tick(beats[sent] if offer else None, ready=ready)

    for rounds in range(3):
        before = sent
        await clocks(100)
        assert sent - before == CREDIT
        for one in range(1, 36):  # each place of the ring
            await clocks(1, ready=1)
            await clocks(rounds + 5)  # until the place is returned and the next beat is let in
            assert sent - before == CREDIT + one // 3 * 3, one
        for _ in range(80):
            await clocks(1, ready=1, offer=False)
        assert len(line.out) == sent
        await clocks(3, ready=1, offer=False)  # empty for some clocks, then a single beat
        await clocks(1, ready=1)
        await clocks(14, ready=1, offer=False)
        assert (len(line.out), bench.read(dut.out_valid_o)) == (sent - 1, 0)
        await clocks(1, ready=1, offer=False)
        await clocks(1, ready=1, offer=False)
        assert len(line.out) == sent
    assert line.out == beats_of(dut, [0] * frames)[:sent]


@pytest.mark.parametrize("grid", [0, 1])
def test_calibrate_coincidences(grid):
    size = {"Rows": ROWS, "Columns": COLUMNS, "Lanes": LANES, "SampleBits": 17}
    size |= {"GainShift": 24 if grid else 12, "RowColumn": grid}
    bench.run("frontend", "calibrate", size, module="test_calibrate_coincidences")
