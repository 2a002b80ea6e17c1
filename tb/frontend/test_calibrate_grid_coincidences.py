"""Events that meet in one clock in msn_calibrate_grid: frontend/calibrate_by_hand.py; and its credit with the
FIFO exactly full and exactly empty."""

import cocotb

import bench
from frontend import calibrate_by_hand as by_hand

CREDIT = 31  # beats that go in while none leaves: 29 of credit and those taken before it shows


class Grid(by_hand.Line):
    """Gains are 1, 2, 3 .. times 4096^2; offsets differ in rows and columns."""

    @staticmethod
    def offset(beat, lane):
        row, column = divmod(beat, by_hand.ROW_BEATS)
        return 100 * row + 10 * column + lane

    @staticmethod
    def entries(level):
        """(of a row?, word, lane, offset, gain) of an entire bank."""
        gain = 4096 * (level + 1)
        columns = [(0, word, lane, 10 * word + lane, gain) for word in range(3) for lane in (0, 1)]
        return columns + [(1, row, 0, 100 * row + 7 * level, 4096) for row in range(3)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_swap_around_a_frames_first_and_last_beat(dut):
    await by_hand.a_swap_around_a_frames_first_and_last_beat(Grid, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def swapping_until_the_frame_is_over(dut):
    await by_hand.swapping_until_the_frame_is_over(Grid, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_entry_in_the_clock_of_the_request(dut):
    await by_hand.an_entry_in_the_clock_of_the_request(Grid, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_around_a_damaged_one(dut):
    await by_hand.frames_around_a_damaged_one(Grid, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_credit_is_whole_after_full_and_empty(dut):
    """The output stalls for 100 clocks, then takes one beat now and then, then all; again and
    again. The credit is used up at 31 beats; when it is back to 28, 3 more go in before that is seen."""
    await bench.start(dut, **by_hand.QUIET)
    line = await by_hand.begin(Grid, dut)
    frames = 24
    beats, sent = by_hand.whole(*range(frames)), 0

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


def test_calibrate_grid_coincidences():
    bench.run("frontend", "calibrate_grid", by_hand.SIZE, module="test_calibrate_grid_coincidences")
