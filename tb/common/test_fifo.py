"""msn_fifo against its model: every entry once and in order, with gaps and stalls; its capacity; one entry a
clock; its latency; empty after a reset at any fill."""

import random

import cocotb
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.handshake import fifo


def beats_of(dut, count):
    draw = random.Random(bench.SEED)
    return [{"data": draw.getrandbits(len(dut.in_data_i))} for _ in range(count)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.5, 0.9], stall_rate=[0.0, 0.5, 0.9])
async def matches_model(dut, gap_rate, stall_rate):
    await bench.start(dut)
    beats = beats_of(dut, 300)
    got = await bench.stream(dut, beats, ["data"], *bench.gaps_and_stalls(gap_rate, stall_rate))
    assert [b["data"] for b in got] == fifo([b["data"] for b in beats], width=len(dut.in_data_i))


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(every=[1, 4])
async def holds_its_depth_and_two(dut, every):
    """Offered in each clock, or in every fourth: a place that stays free for a while is still taken. half_o:
    at least half the places of the memory are, without the two registers."""
    depth = dut.Depth.value.to_unsigned()
    await bench.start(dut, in_data_i=0)
    taken = seen = 0
    for clock in range(every * (depth + 20)):
        offered = clock % every == every - 1
        dut.in_valid_i.value = int(offered)
        dut.in_data_i.value = taken & ((1 << len(dut.in_data_i)) - 1)
        await bench.ReadOnly()
        if offered and every == 4:
            assert dut.half_o.value == (taken - 2 >= depth // 2)
        taken += offered and dut.in_ready_o.value == 1
        await bench.RisingEdge(dut.clk_i)
    assert taken == depth + 2
    dut.in_valid_i.value = 0
    dut.out_ready_i.value = 1
    for clock in range(depth + 20):
        await bench.ReadOnly()
        # One leaves in each clock, and its place in the memory was free two clocks before.
        assert dut.half_o.value == (depth - clock >= depth // 2)
        if dut.out_valid_o.value == 1:
            assert bench.read(dut.out_data_o) == seen & ((1 << len(dut.in_data_i)) - 1)
            seen += 1
        await bench.RisingEdge(dut.clk_i)
    assert seen == taken


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def half_counts_the_words_of_the_memory(dut):
    """Around half, clock by clock: the memory's words pass through two registers, and each takes the next one
    as soon as its own leaves."""
    depth, draw = dut.Depth.value.to_unsigned(), random.Random(bench.SEED)
    await bench.start(dut, in_data_i=0)
    stored, first, last, seen = 0, False, False, set()
    for _ in range(1200 + 2 * depth):
        off = stored - depth // 2
        valid = draw.random() < (0.95 if off < -2 else 0.2 if off > 2 else 0.6)
        ready = draw.random() < 0.6
        dut.in_valid_i.value, dut.out_ready_i.value = int(valid), int(ready)
        await bench.ReadOnly()
        found = tuple(bench.read(port) for port in (dut.half_o, dut.in_ready_o, dut.out_valid_o))
        assert found == (stored >= depth // 2, stored < depth, last)
        put, free = valid and stored < depth, ready or not last
        get = stored > 0 and (free or not first)
        seen.add((off, put, get))
        last, first = (first, get) if free else (last, get or first)
        stored += put - get
        await bench.RisingEdge(dut.clk_i)
    assert len({(off, put, get) for off, put, get in seen if off in (-1, 0)}) == (6 if depth == 2 else 8)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def clocks_are_as_stated_and_reset_empties(dut):
    await bench.start(dut, out_ready_i=1, in_data_i=1)
    for fill in range(8):
        seen = []
        for clock in range(20):
            dut.in_valid_i.value = int(clock < 5)
            await bench.ReadOnly()
            seen.append(int(dut.out_valid_o.value))
            await bench.RisingEdge(dut.clk_i)
        assert seen == [0] * 3 + [1] * 5 + [0] * 12
        dut.out_ready_i.value = 0
        dut.in_valid_i.value = 1
        await bench.clocks(dut, fill)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        dut.out_ready_i.value = 1


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def exactly_full_and_empty_for_longer_than_it_is_deep(dut):
    """Kept full: a word is taken the clock after one leaves, and no other; repeated for every place of the
    ring. Then kept empty: a word leaves three clocks after it was taken."""
    depth, top = dut.Depth.value.to_unsigned(), (1 << len(dut.in_data_i)) - 1
    word = lambda n: (7 * n + 1) & top
    await bench.start(dut, in_data_i=0)
    put = got = 0

    async def clock(valid, ready):
        """One clock; returns (a word went in, a word came out) and checks that words come out in order."""
        nonlocal put, got
        dut.in_valid_i.value, dut.out_ready_i.value = valid, ready
        dut.in_data_i.value = word(put) if valid else ~word(put) & top
        await bench.ReadOnly()
        took, gave = valid & bench.read(dut.in_ready_o), ready & bench.read(dut.out_valid_o)
        if gave:
            assert bench.read(dut.out_data_o) == word(got), got
        put, got = put + took, got + gave
        await bench.RisingEdge(dut.clk_i)
        return took, gave

    for _ in range(2 * depth + 9):
        await clock(1, 0)
    assert put == depth + 2
    for _ in range(2 * depth + 1):  # each word that leaves makes room for one in the next clock
        assert await clock(1, 1) == (0, 1)
        assert await clock(1, 0) == (1, 0)
        for _ in range(3):
            assert await clock(1, 0) == (0, 0)
    for _ in range(2 * depth + 1):  # full, and read in every clock: no word is lost or repeated
        await clock(1, 1)
    while got < put:
        await clock(0, 1)
    for _ in range(2 * depth + 3):
        assert await clock(0, 1) == (0, 0)
    for _ in range(2 * depth + 1):
        assert [await clock(n == 0, 1) for n in range(4)] == [(1, 0), (0, 0), (0, 0), (0, 1)]
    assert put == got


EVIDENCE = {
    "equivalence": {"size": {"Depth": 16}},
    "faults": {"settle": 24},
}

SPACE = lambda draw: {"Depth": 1 << draw.randint(1, 8), "Width": draw.randint(1, 91)}


@pytest.mark.parametrize("depth, width", [(2, 1), (16, 91), (256, 24)])
def test_fifo(depth, width):
    bench.run("common", "fifo", {"Depth": depth, "Width": width})


test_refuses_illegal_parameters = refusals(
    "fifo", fifo, {"Depth": 0}, {"Depth": 1}, {"Depth": 3}, {"Width": 0}, entries=[]
)
