"""Events that meet in one clock in msn_calibrate_taxels: frontend/calibrate_by_hand.py."""

import cocotb

import bench
from frontend import calibrate_by_hand as by_hand


class Taxels(by_hand.Line):
    """Gains are 1, 2, 3 .. times 4096; offsets differ in every beat and lane."""

    wait = 3

    @staticmethod
    def offset(beat, lane):
        return 11 * beat + lane

    @staticmethod
    def entries(level):
        """(of a row?, word, lane, offset, gain) of an entire bank."""
        gain = 4096 * (level + 1)
        return [(0, word, lane, 11 * word + lane + 7 * level, gain) for word in range(9) for lane in (0, 1)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_swap_around_a_frames_first_and_last_beat(dut):
    await by_hand.a_swap_around_a_frames_first_and_last_beat(Taxels, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def swapping_until_the_frame_is_over(dut):
    await by_hand.swapping_until_the_frame_is_over(Taxels, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_entry_in_the_clock_of_the_request(dut):
    await by_hand.an_entry_in_the_clock_of_the_request(Taxels, dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_around_a_damaged_one(dut):
    await by_hand.frames_around_a_damaged_one(Taxels, dut)


def test_calibrate_taxels_coincidences():
    bench.run("frontend", "calibrate_taxels", by_hand.SIZE, module="test_calibrate_taxels_coincidences")
