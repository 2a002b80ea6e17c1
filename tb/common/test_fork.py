"""msn_fork: every word reaches both followers once and in order, whatever their stalls; one word a clock when
both are ready; a follower that took a word does not see it again while the other stalls; reset in between."""

import random

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.common.handshake import fork


async def run(dut, words, gap=0.0, stalls=(0.0, 0.0)):
    """The words that followers a and b took, and the clocks it took."""
    draw = random.Random(bench.SEED)
    taken, at, clock, offered = {"a": [], "b": []}, 0, 0, False
    while at < len(words):
        offered = offered or draw.random() >= gap
        dut.in_valid_i.value = int(offered)
        ready = {name: draw.random() >= stall for name, stall in zip("ab", stalls)}
        for name in "ab":
            getattr(dut, f"{name}_ready_i").value = int(ready[name])
        await ReadOnly()
        for name in "ab":
            valid = getattr(dut, f"{name}_valid_o").value == 1
            assert offered or not valid
            if valid and ready[name]:
                taken[name].append(words[at])
        if offered and dut.in_ready_o.value == 1:
            at, offered = at + 1, False
        clock += 1
        assert clock < 100 * len(words)
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    return taken["a"], taken["b"], clock


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.4], stalls=[(0.0, 0.0), (0.0, 0.5), (0.5, 0.0), (0.6, 0.6), (0.95, 0.1)])
async def gives_every_word_to_both_once(dut, gap, stalls):
    await bench.start(dut, a_ready_i=0, b_ready_i=0)
    words = list(range(300))
    a, b, clocks = await run(dut, words, gap, stalls)
    assert (a, b) == fork(words)
    if gap == 0 and stalls == (0.0, 0.0):
        assert clocks == len(words)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await bench.start(dut, a_ready_i=0, b_ready_i=0)
    for a, b in ((1, 0), (0, 1)):
        dut.in_valid_i.value, dut.a_ready_i.value, dut.b_ready_i.value = 1, a, b
        await RisingEdge(dut.clk_i)  # one follower has the word, the other does not
        await bench.reset(dut)
        await ReadOnly()
        assert dut.a_valid_o.value == 1 and dut.b_valid_o.value == 1
        await RisingEdge(dut.clk_i)
        await bench.reset(dut)


EVIDENCE = {}


def test_fork():
    bench.run("common", "fork")
