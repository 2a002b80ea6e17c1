"""Events that meet in one clock in msn_calibrate, with forces worked out by hand from the header's formula: a
swap requested at every clock around a frame's first and last beat, in mid-frame and twice; an entry written
in the clock of the request and right after the exchange; frames damaged at every beat, a swap requested
meanwhile; by row and column the credit with the FIFO exactly full and exactly empty."""

import cocotb
import pytest

import bench
from members import Settings

ROWS, COLUMNS, LANES, ROW_BEATS, BEATS = 3, 5, 2, 3, 9
TOP = 65535
CREDIT = 31  # beats that go in while none leaves: 29 of credit and those taken before it shows


def row_column(dut):
    return dut.RowColumn.value.to_unsigned()


def raw_of(frame, beat, lane):
    return 3000 + 211 * frame + 17 * beat + 5 * lane


def masked(frame, beat, lane):
    """Every seventh taxel, another one in each frame."""
    return (frame + 2 * beat + lane) % 7 == 3


def whole(*frames):
    return [(frame, number) for frame in frames for number in range(BEATS)]


class Line:
    """Runs single clocks and records what goes in and out, and in which clock. Gains are 1, 2, 3 .. times 1.0
    with the level of a calibration. ``wait``: clocks that a swap takes."""

    def __init__(self, dut):
        self.dut, self.clock, self.taken, self.out = dut, 0, [], []
        self.settings, self.grid = Settings(dut, "calibrate_cfg"), row_column(dut)
        self.wait = 0 if self.grid else 3

    def offset(self, beat, lane):
        """Of a taxel at level 0."""
        row, column = divmod(beat, ROW_BEATS)
        return 100 * row + 10 * column + lane if self.grid else 11 * beat + lane

    def entries(self, level):
        """(of a row?, word, lane, offset, gain) of an entire bank."""
        gain = 4096 * (level + 1)
        if not self.grid:
            taxels = ((word, lane) for word in range(BEATS) for lane in (0, 1))
            return [(0, word, lane, 11 * word + lane + 7 * level, gain) for word, lane in taxels]
        columns = [(0, word, lane, 10 * word + lane, gain) for word in range(3) for lane in (0, 1)]
        return columns + [(1, row, 0, 100 * row + 7 * level, 4096) for row in range(3)]

    async def tick(self, beat=None, ready=1, swap=0, write=None):
        """One clock; returns whether ``beat`` went in: (frame, number), and marks if its frame is damaged.
        ``write``: one of ``entries``."""
        dut, settings = self.dut, {"swap": swap, "write_written": int(write is not None)}
        dut.in_valid_i.value, dut.out_ready_i.value = int(beat is not None), ready
        if write:
            of_row, word, lane, offset, gain = write
            settings |= {"write_row": of_row, "word": word, "write_lanes": 1 << lane}
            settings |= {"offset": offset, "gain": gain}
        self.settings.put(**settings)
        if beat is not None:
            frame, number, *marks = beat
            bits = len(dut.in_data_i) // LANES
            dut.in_data_i.value = bench.lane_word([raw_of(frame, number, lane) for lane in (0, 1)], bits)
            mask = sum(masked(frame, number, lane) << lane for lane in (0, 1))
            bench.offer(dut, {"mask": mask, **(marks[0] if marks else bench.marks(number, ROWS, ROW_BEATS))})
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
        for entry in self.entries(level):
            await self.tick(write=entry)

    async def swapped(self):
        """Request the swap between frames and wait until it is in effect."""
        await self.tick(swap=1)
        for _ in range(6):
            await self.tick()

    async def send(self, beats, swaps=(), writes=None):
        """Send ``beats`` without gaps; a swap in the clocks ``swaps``, entries in those of ``writes``."""
        for beat in beats:
            while not await self.tick(
                beat, swap=int(self.clock in swaps), write=(writes or {}).get(self.clock)
            ):
                pass
        for _ in range(20):
            await self.tick()

    def came_out(self, beats, level):
        """What ``beats`` give with the calibration ``level``."""
        found = []
        for frame, number, *marks in beats:
            of = marks[0] if marks else bench.marks(number, ROWS, ROW_BEATS)
            forces = (self.force(level, frame, number, lane) for lane in (0, 1))
            found.append((*(int(of[name]) for name in ("fits", "row_last", "last")), *forces))
        return found

    def frames(self, levels):
        """The output for frames 0, 1, .. with the calibrations ``levels``."""
        return [out for frame, level in enumerate(levels) for out in self.came_out(whole(frame), level)]

    def force(self, level, frame, beat, lane):
        """(raw - offset) gain, 0 if masked; the unused lane of a row is calibrated too."""
        if masked(frame, beat, lane):
            return 0
        offset = self.offset(beat, lane) + 7 * level
        return min((raw_of(frame, beat, lane) - offset) * (level + 1), TOP)


async def begin(dut):
    """Reset; then level 0 is in use and level 1 is written."""
    await bench.reset(dut)
    line = Line(dut)
    await line.load(0)
    await line.swapped()
    await line.load(1)
    line.clock, line.taken, line.out = 0, [], []
    return line


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_swap_around_a_frames_first_and_last_beat(dut):
    """Requested in the clock of a beat, before or after it, a swap takes effect with the first frame that
    begins in a later clock. ``wait`` clocks pass before that frame's first beat, and none elsewhere."""
    await bench.start(dut, cfg_i=0)
    line = await begin(dut)
    await line.send(whole(0, 1, 2, 3))
    assert line.out == line.frames([0, 0, 0, 0])
    assert line.taken == list(range(line.taken[0], line.taken[0] + 4 * BEATS))
    begun = line.taken[::BEATS]
    met = set()
    for at in range(begun[1] - 2, begun[2] + 3):
        line = await begin(dut)
        await line.send(whole(0, 1, 2, 3), swaps={at})
        first = 1 if at < begun[1] else 2 if at < begun[2] else 3
        assert line.out == line.frames([0] * first + [1] * (4 - first)), at - begun[1]
        gaps = [after - before - 1 for before, after in zip(line.taken, line.taken[1:])]
        assert all(gap == 0 for number, gap in enumerate(gaps) if number != first * BEATS - 1), at - begun[1]
        assert gaps[first * BEATS - 1] == line.wait, at - begun[1]
        assert dut.status_o.value == 0
        met.add(first)
    assert met == {1, 2, 3}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def swapping_until_the_frame_is_over(dut):
    """The status is set from the clock after the request to the one after the frame's last beat; a second
    request while the first is pending has no further effect."""
    await bench.start(dut, cfg_i=0)
    for again in (None, 2, BEATS - 2):
        line = await begin(dut)
        seen = []
        for number in range(BEATS):
            assert await line.tick((0, number), swap=int(number in (1, again)))
            seen.append(bench.read(dut.status_o))
        for _ in range(3):
            await line.tick()
            seen.append(bench.read(dut.status_o))
        assert seen == [0, 0] + [1] * (BEATS - 1) + [0, 0]
        await line.send(whole(1))
        assert line.out == line.frames([0, 1])


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_entry_in_the_clock_of_the_request(dut):
    """The last entry of a calibration, written in the clock of the swap request, belongs to it. An entry
    written while the first frame with it passes belongs to the next calibration."""
    await bench.start(dut, cfg_i=0)
    line = await begin(dut)
    *most, last = line.entries(2)
    for entry in most:
        await line.tick(write=entry)
    await line.tick(write=last, swap=1)
    for _ in range(6):
        await line.tick()
    written = {line.clock + n: entry for n, entry in enumerate(line.entries(4))}
    line.out = []
    asked = line.clock + 2 * BEATS + 3  # within frame 2
    await line.send(whole(0, 1, 2, 3), swaps={asked}, writes=written)
    assert line.out == line.frames([2, 2, 2, 4])


def damaged(frame, broken):
    """The beats that msn_frame_marker passes of a frame that breaks at the beat ``broken``: too short, or, if
    the final one has no ``last``, one too long. The extra beat is at place 0."""
    beats = [(frame, number) for number in range(broken)]
    row_last, final = broken % ROW_BEATS == ROW_BEATS - 1, broken == BEATS - 1
    beats.append((frame, broken, {"fits": 0, "row_last": row_last, "last": not final}))
    return beats + [(frame, 0, {"fits": 0, "row_last": 0, "last": 1})] * final


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_around_a_damaged_one(dut):
    """A frame damaged at each of its beats, between whole ones. A swap requested in the clock of its first
    beat, of the broken one or of the extra one takes effect with the frame that follows."""
    await bench.start(dut, cfg_i=0)
    for broken in range(BEATS):
        beats = damaged(1, broken)
        for at in (None, *sorted({0, broken, len(beats) - 1})):
            line = await begin(dut)
            await line.send(whole(0))
            for number, beat in enumerate(beats):
                assert await line.tick(beat, swap=int(number == at))
            await line.send(whole(2, 3))
            level = 0 if at is None else 1
            expected = line.came_out([*whole(0), *beats], 0) + line.came_out(whole(2, 3), level)
            assert line.out == expected, (broken, at)


@bench.applies(row_column)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_credit_is_whole_after_full_and_empty(dut):
    """The output stalls for 100 clocks, then takes one beat now and then, then all; again and
    again. The credit is used up at 31 beats; when it is back to 28, 3 more go in before that is seen."""
    await bench.start(dut, cfg_i=0)
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
    assert line.out == line.frames([0] * frames)[:sent]


@pytest.mark.parametrize("by", [0, 1])
def test_calibrate_coincidences(by):
    size = {"Rows": ROWS, "Columns": COLUMNS, "Lanes": LANES, "SampleBits": 17, "RowColumn": by}
    bench.run("frontend", "calibrate", size, module="test_calibrate_coincidences")
