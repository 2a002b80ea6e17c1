"""Events that meet in one clock in msn_calibrate_taxels and msn_calibrate_grid, with forces worked out by
hand from the headers' formula: a swap requested at every clock around a frame's first and last beat, in
mid-frame and twice; an entry written in the clock of the request and right after the exchange; frames damaged
at every beat, a swap requested meanwhile."""

import bench

ROWS, COLUMNS, LANES, ROW_BEATS, BEATS = 3, 5, 2, 3, 9
SIZE = {"Rows": ROWS, "Columns": COLUMNS, "Lanes": LANES, "SampleBits": 17}
TOP = 65535
QUIET = {"cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0}


def raw_of(frame, beat, lane):
    return 3000 + 211 * frame + 17 * beat + 5 * lane


def masked(frame, beat, lane):
    """Every seventh taxel, another one in each frame."""
    return (frame + 2 * beat + lane) % 7 == 3


def whole(*frames):
    return [(frame, number) for frame in frames for number in range(BEATS)]


class Line:
    """Runs single clocks and records what goes in and out, and in which clock.

    Of a block: ``offset`` of a taxel at level 0, ``entries`` of a bank, clocks that a swap takes: ``wait``.
    """

    wait = 0

    def __init__(self, dut):
        self.dut, self.clock, self.taken, self.out = dut, 0, [], []

    def entry(self, of_row, word, lane, offset, gain):
        dut = self.dut
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, of_row
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word, gain
        dut.cfg_offset_i.value = offset & ((1 << len(dut.cfg_offset_i)) - 1)

    async def tick(self, beat=None, ready=1, swap=0, write=None):
        """One clock; returns whether ``beat`` went in: (frame, number), and marks if its frame is damaged.
        ``write``: one of ``entries``."""
        dut = self.dut
        dut.in_valid_i.value, dut.out_ready_i.value, dut.cfg_swap_i.value = int(beat is not None), ready, swap
        if write:
            self.entry(*write)
        else:
            dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0
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
        """Send ``beats`` without gaps; cfg_swap_i in the clocks ``swaps``, entries in those of ``writes``."""
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


async def begin(kind, dut):
    """Reset; then level 0 is in use and level 1 is written."""
    await bench.reset(dut)
    line = kind(dut)
    await line.load(0)
    await line.swapped()
    await line.load(1)
    line.clock, line.taken, line.out = 0, [], []
    return line


async def a_swap_around_a_frames_first_and_last_beat(kind, dut):
    """Requested in the clock of a beat, before or after it, a swap takes effect with the first frame that
    begins in a later clock. ``wait`` clocks pass before that frame's first beat, and none elsewhere."""
    await bench.start(dut, **QUIET)
    line = await begin(kind, dut)
    await line.send(whole(0, 1, 2, 3))
    assert line.out == line.frames([0, 0, 0, 0])
    assert line.taken == list(range(line.taken[0], line.taken[0] + 4 * BEATS))
    begun = line.taken[::BEATS]
    met = set()
    for at in range(begun[1] - 2, begun[2] + 3):
        line = await begin(kind, dut)
        await line.send(whole(0, 1, 2, 3), swaps={at})
        first = 1 if at < begun[1] else 2 if at < begun[2] else 3
        assert line.out == line.frames([0] * first + [1] * (4 - first)), at - begun[1]
        gaps = [after - before - 1 for before, after in zip(line.taken, line.taken[1:])]
        assert all(gap == 0 for number, gap in enumerate(gaps) if number != first * BEATS - 1), at - begun[1]
        assert gaps[first * BEATS - 1] == kind.wait, at - begun[1]
        assert dut.cfg_swapping_o.value == 0
        met.add(first)
    assert met == {1, 2, 3}


async def swapping_until_the_frame_is_over(kind, dut):
    """cfg_swapping_o is set from the clock after the request to the one after the frame's last beat; a second
    request while the first is pending has no further effect."""
    await bench.start(dut, **QUIET)
    for again in (None, 2, BEATS - 2):
        line = await begin(kind, dut)
        seen = []
        for number in range(BEATS):
            assert await line.tick((0, number), swap=int(number in (1, again)))
            seen.append(bench.read(dut.cfg_swapping_o))
        for _ in range(3):
            await line.tick()
            seen.append(bench.read(dut.cfg_swapping_o))
        assert seen == [0, 0] + [1] * (BEATS - 1) + [0, 0]
        await line.send(whole(1))
        assert line.out == line.frames([0, 1])


async def an_entry_in_the_clock_of_the_request(kind, dut):
    """The last entry of a calibration, written in the clock of the swap request, belongs to it. An entry
    written while the first frame with it passes belongs to the next calibration."""
    await bench.start(dut, **QUIET)
    line = await begin(kind, dut)
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


async def frames_around_a_damaged_one(kind, dut):
    """A frame damaged at each of its beats, between whole ones. A swap requested in the clock of its first
    beat, of the broken one or of the extra one takes effect with the frame that follows."""
    await bench.start(dut, **QUIET)
    for broken in range(BEATS):
        beats = damaged(1, broken)
        for at in (None, *sorted({0, broken, len(beats) - 1})):
            line = await begin(kind, dut)
            await line.send(whole(0))
            for number, beat in enumerate(beats):
                assert await line.tick(beat, swap=int(number == at))
            await line.send(whole(2, 3))
            level = 0 if at is None else 1
            expected = line.came_out([*whole(0), *beats], 0) + line.came_out(whole(2, 3), level)
            assert line.out == expected, (broken, at)
