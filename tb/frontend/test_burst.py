"""Bursts: every count and period that the registers of a small build can hold (0 is the greatest), starts
apart, back to back and within a burst; the mark of the first sample; a loss reported once per burst; reset in
the middle.
"""

import random

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refused
from meissner.twins.frontend.timing import triggers


async def watch(dut, starts, end, taken=(), lost=()):
    """Clocks before ``end`` of trigger_o, first_o and lost_o."""
    seen = {"trigger_o": [], "first_o": [], "lost_o": [], "spoiled_o": []}
    for clock in range(end):
        dut.start_i.value = int(clock in starts)
        dut.taken_i.value, dut.lost_i.value = int(clock in taken), int(clock in lost)
        await ReadOnly()
        for name, clocks in seen.items():
            if bench.read(getattr(dut, name)):
                clocks.append(clock)
        await RisingEdge(dut.clk_i)
    return seen


async def begin(dut):
    await bench.start(dut, start_i=0, taken_i=0, lost_i=0, cfg_count_i=1, cfg_period_i=1)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def triggers_as_the_model(dut):
    await begin(dut)
    draw = random.Random(bench.SEED)
    counts, periods = (1 << len(dut.cfg_count_i)), (1 << len(dut.cfg_period_i))
    for count in range(1, counts + 1):
        for period in range(1, periods + 1):
            await bench.reset(dut)
            dut.cfg_count_i.value, dut.cfg_period_i.value = count % counts, period % periods
            whole = count * period
            starts = [draw.randrange(3)]
            starts += [starts[0] + whole, starts[0] + 2 * whole + draw.randrange(1, 9)]
            starts += [starts[-1] + draw.randrange(1, whole + 1)]
            end = starts[-1] + whole + 5
            seen = await watch(dut, starts, end)
            assert seen["trigger_o"] == triggers(starts, count, period, end), (count, period, starts)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def marks_the_first_sample_and_tells_a_loss_once(dut):
    await begin(dut)
    dut.cfg_count_i.value, dut.cfg_period_i.value = 3, 3
    seen = await watch(dut, [2, 20], 40, taken=[7, 10, 13, 24], lost=[9, 11, 12, 26])
    assert seen["first_o"] == [*range(3, 8), *range(21, 25)]
    assert seen["lost_o"] == [9, 26]
    assert seen["spoiled_o"] == [*range(10, 21), *range(27, 40)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_start_meets_every_other_event(dut):
    """A start in the clock of a sample, of a trigger, of the last trigger, of a loss: the new burst is
    complete and its first sample is marked; a loss and a sample in one clock; a sample taken while none is
    marked."""
    await begin(dut)
    dut.cfg_count_i.value, dut.cfg_period_i.value = 3, 5

    async def scene(starts, **events):
        await bench.reset(dut)
        seen = await watch(dut, starts, 40, **events)
        return [seen[name] for name in ("trigger_o", "first_o", "lost_o", "spoiled_o")]

    whole = [4, 9, 14]
    assert await scene([3], taken=[7]) == [whole, [*range(4, 8)], [], []]
    # with the first sample of the previous burst, and with a later one
    assert await scene([3, 7], taken=[7, 13]) == [[4, 8, 13, 18], [*range(4, 14)], [], []]
    assert await scene([3, 12], taken=[7, 12]) == [[4, 9, 13, 18, 23], [*range(4, 8), *range(13, 40)], [], []]
    # in the clock that decides a trigger: only the new burst's comes; a clock before and after it
    assert await scene([3, 8], taken=[4]) == [[4, 9, 14, 19], [4, *range(9, 40)], [], []]
    assert (await scene([3, 7], taken=[4]))[0] == [4, 8, 13, 18]
    assert (await scene([3, 9], taken=[4]))[0] == [4, 9, 10, 15, 20]
    # with the last trigger's
    assert (await scene([3, 13]))[0] == [4, 9, 14, 19, 24]
    assert (await scene([3, 14]))[0] == [4, 9, 14, 15, 20, 25]
    # with a loss, which belongs to the previous burst: a first one, and a second one
    assert await scene([3, 11], taken=[4, 12], lost=[11]) == [[4, 9, 12, 17, 22], [4, 12], [11], []]
    assert (await scene([3, 11], lost=[6, 11]))[2:] == [[6], [*range(7, 12)]]
    assert (await scene([3, 11], lost=[6, 11, 12]))[2:] == [[6, 12], [*range(7, 12), *range(13, 40)]]
    # a loss with the first sample, and with the first trigger
    assert await scene([3], taken=[6], lost=[6]) == [whole, [4, 5, 6], [6], [*range(7, 40)]]
    assert (await scene([3], lost=[3]))[2:] == [[3], []]
    # a sample while none is marked
    assert await scene([3], taken=[1, 2, 3, 4, 5]) == [whole, [4], [], []]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_reset_ends_the_burst(dut):
    await begin(dut)
    dut.cfg_count_i.value, dut.cfg_period_i.value = 3, 3
    await watch(dut, [0], 3, lost=[1])
    await bench.reset(dut)
    seen = await watch(dut, [], 12, lost=[3])
    assert seen == {"trigger_o": [], "first_o": [], "lost_o": [3], "spoiled_o": [*range(4, 12)]}


EVIDENCE = {
    "faults": {"settle": 2, "driver": {"frame": "start_i"}},
}


def test_burst():
    bench.run("frontend", "burst", {"CountBits": 2, "PeriodBits": 3})


def test_refuses_illegal_parameters():
    assert "CountBits" in bench.refuses("burst", {"CountBits": 0})
    assert "PeriodBits" in bench.refuses("burst", {"PeriodBits": 25})
    refused(triggers, {"period": 0}, starts=[0], count=1, end=10)
