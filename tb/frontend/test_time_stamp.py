"""msn_time_stamp against its model: frames of one to five samples that come in time, wait, or are dropped,
with a converter that continues meanwhile, and, read during the next conversion, has converted again before a
frame's first sample comes; reset."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.timing import time_stamps


def converter(draw, frames, channels):
    """Clocks (convert, valid, ready, last, read) of a converter whose follower sleeps now and then.

    A frame is dropped if the previous one still waits. A read begins before the next convert start and gives
    samples after it.
    """
    period = 4 * channels + 6
    queue, clocks, sleep = [], [], 0
    for now in range(frames * period):
        phase = now % period
        if phase == 3 and not queue and now > period:
            queue = [place == channels - 1 for place in range(channels)]
        if sleep == 0 and draw.random() < 0.03:
            sleep = draw.randrange(5 * period)
        ready = sleep == 0 and draw.random() < 0.7
        sleep = max(0, sleep - 1)
        valid = bool(queue)
        clocks.append((phase == 0, valid, ready, valid and queue[0], phase == period - 2))
        if valid and ready:
            queue.pop(0)
    return clocks


def stamp(clock):
    """A time of 48 bits, all of which change from clock to clock."""
    return (clock * 0x9E37_79B9_7F4A_7C15 >> 8) % (1 << 48)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(channels=[1, 2, 5])
async def matches_model(dut, channels):
    draw = random.Random(bench.SEED)
    clocks = converter(draw, 200, channels)
    await bench.start(dut, convert_i=0, read_i=0, valid_i=0, ready_i=0, last_i=0, now_i=0)
    during = bool(dut.ReadDuring.value)
    expected, found, first, show = time_stamps(clocks, during), [], True, False
    for now, (convert, valid, ready, last, read) in enumerate(clocks):
        values = {"now": stamp(now), "convert": convert, "valid": valid, "ready": ready, "last": last}
        values["read"] = read
        for name, value in values.items():
            getattr(dut, f"{name}_i").value = int(value)
        await ReadOnly()
        if show:  # throughout the frame, from the clock after its first sample was taken
            assert bench.read(dut.time_o) == stamp(expected[len(found) - 1])
        if valid and ready:
            if first:
                found.append(now)
            first, show = last, True
        await RisingEdge(dut.clk_i)
    assert len(found) > 50
    waits = [took - start for took, start in zip(found, expected)]
    period = 4 * channels + 6
    assert max(waits) > 3 * period, "no frame waited"
    # The frame that is taken at once has the convert start of 3 clocks ago, or the one before.
    assert min(waits) == 3 + during * period


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    idle = {"convert_i": 0, "read_i": 0, "valid_i": 0, "ready_i": 0, "last_i": 0}
    await bench.start(dut, now_i=5, **idle)
    dut.read_i.value = 1

    async def convert(now):
        """A convert start, and the read, which begins later."""
        dut.convert_i.value, dut.now_i.value = 1, now
        await RisingEdge(dut.clk_i)
        dut.convert_i.value = 0
        await RisingEdge(dut.clk_i)

    for ready in (0, 1):  # a first sample that waits; a frame in progress
        await convert(7)
        dut.valid_i.value, dut.ready_i.value = 1, ready
        await RisingEdge(dut.clk_i)
        dut.valid_i.value = 0
        await bench.reset(dut)
        await convert(99)
        dut.valid_i.value, dut.ready_i.value, dut.last_i.value = 1, 1, 1
        await RisingEdge(dut.clk_i)
        dut.valid_i.value = 0
        await ReadOnly()
        assert bench.read(dut.time_o) == 99
        await RisingEdge(dut.clk_i)
        await bench.reset(dut)


EVIDENCE = {
    # The recording also sets last_i in clocks that are no end of a frame.
    "faults": {"settle": 150, "driver": {"frame": "last_i"}},
}


@pytest.mark.parametrize("during", [0, 1])
def test_time_stamp(during):
    bench.run("frontend", "time_stamp", {"ReadDuring": during})
