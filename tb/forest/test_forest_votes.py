"""msn_forest_votes against its model, and the model against literals: one class, two, and tables of many in
groups; leaves of several decisions mixed, one freed and begun again, leaves without votes; both banks; sums
up to 65535^2; the clocks of a leaf; a flush that keeps the sums. What goes with a valid, write or read is
wrong while that is low."""

import random

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.forest.forest import Forest, votes_of

IDLE = dict.fromkeys(("flush_i", "free_i", "write_i", "in_bank_i", "read_i"), 0)


def sizes(dut):
    names = ("Classes", "Leaves", "Banks", "Lanes", "Contexts")
    return [getattr(dut, name).value.to_unsigned() for name in names]


async def write(dut, draw, bank):
    """A table at random; rows and classes that do not exist are ignored, and so is what is not a write."""
    classes, leaves, *_ = sizes(dut)
    table = np.array([[draw.getrandbits(16) for _ in range(classes)] for _ in range(leaves)], np.uint16)
    dut.write_i.value, dut.write_bank_i.value = 1, bank
    places = [(row, label) for row in range(leaves) for label in range(classes)]
    beyond = [(leaves + draw.randrange(65536 - leaves), draw.randrange(65536)) for _ in range(20)]
    beyond += [(draw.randrange(leaves), classes + draw.randrange(65536 - classes)) for _ in range(20)]
    for row, label in [*places, (leaves, 0), (0, classes), (65535, 65535), *beyond]:
        dut.write_row_i.value, dut.write_class_i.value = row & 0xFFFF, label
        dut.write_data_i.value = int(table[row, label]) if (row, label) in places else draw.getrandbits(16)
        await bench.RisingEdge(dut.clk_i)
    dut.write_i.value, dut.write_row_i.value, dut.write_class_i.value = 0, leaves - 1, classes - 1
    dut.write_data_i.value = ~int(table[-1, -1]) & 0xFFFF
    return table


async def read(dut, context):
    """The votes of every class, read on top of a sum, which may wrap; without read_i they stay."""
    votes, draw = [], random.Random(f"{bench.SEED} {context}")
    for label in range(dut.Classes.value.to_unsigned()):
        before = draw.getrandbits(32)
        dut.read_context_i.value, dut.read_class_i.value, dut.read_sum_i.value = context, label, before
        dut.read_i.value = 1
        await bench.clocks(dut, 1)
        dut.read_class_i.value, dut.read_sum_i.value = draw.getrandbits(16), draw.getrandbits(32)
        dut.read_i.value = 0
        await bench.clocks(dut, 2)
        votes.append((bench.read(dut.read_votes_o) - before) % (1 << 32))
    return votes


async def give(dut, leaf, context, none=False):
    """One leaf; the clocks that it took."""
    dut.in_valid_i.value, dut.in_leaf_i.value = 1, leaf
    dut.in_context_i.value, dut.in_none_i.value = context, int(none)
    took, ready = 0, False
    while not ready:
        await bench.ReadOnly()
        ready, took = bench.high(dut.in_ready_o), took + 1
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    dut.in_leaf_i.value, dut.in_none_i.value = ~leaf & 0xFFFF, 1 - none
    return took


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.4])
async def matches_model(dut, gap):
    classes, leaves, banks, lanes, contexts = sizes(dut)
    draw, stop = random.Random(bench.SEED), bench.pauses(gap, "gaps")
    await bench.start(dut, **IDLE)
    for bank in range(banks):
        table = await write(dut, draw, bank)
        dut.in_bank_i.value = bank
        await bench.reset(dut)
        sums, counted, seen = np.zeros((contexts, classes), np.int64), [0] * contexts, [0] * contexts

        async def watch(seen=seen):
            while True:
                await bench.ReadOnly()
                now = bench.read(dut.counted_o)
                for context in range(contexts):
                    seen[context] += now >> context & 1
                await bench.RisingEdge(dut.clk_i)

        watching = cocotb.start_soon(watch())
        for turn in range(5):
            for _ in range(60):
                context, none = draw.randrange(contexts), draw.random() < 0.2
                leaf = draw.randrange(65536 if classes == 2 else leaves)
                assert await give(dut, leaf, context, none) == -(-classes // lanes)
                counted[context] += 1
                if not none:
                    sums[context] += votes_of(np.array(leaf), None if classes == 2 else table)
                while stop():
                    await bench.RisingEdge(dut.clk_i)
            await bench.clocks(dut, 6)
            assert seen == counted
            for context in range(contexts):
                assert await read(dut, context) == sums[context].tolist()
            gone = [context for context in range(contexts) if context == turn or draw.random() < 0.4]
            dut.free_i.value, sums[gone] = sum(1 << context for context in gone), 0
            await bench.RisingEdge(dut.clk_i)
            dut.free_i.value = 0
            await bench.RisingEdge(dut.clk_i)
            for context in gone:
                assert await read(dut, context) == [0] * classes
        watching.cancel()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_flush_keeps_the_sums_and_a_reset_does_not(dut):
    classes, leaves, _, lanes, _ = sizes(dut)
    await bench.start(dut, **IDLE)
    table = await write(dut, random.Random(bench.SEED + 1), 0)
    of = lambda leaf: votes_of(np.array(leaf), None if classes == 2 else table).tolist()
    await give(dut, leaves - 1, 1)
    await bench.clocks(dut, 6)
    for ahead in range(1 if classes == 2 else 3):  # a leaf on its way is discarded, in each stage
        dut.in_valid_i.value, dut.in_leaf_i.value, dut.in_context_i.value = 1, 0, 0
        dut.in_none_i.value = 0
        for clock in range(ahead + 1):
            dut.flush_i.value = int(clock == ahead)
            await bench.RisingEdge(dut.clk_i)
            dut.in_valid_i.value = 0
        dut.flush_i.value = 0
        await bench.clocks(dut, 6)
        assert await read(dut, 1) == of(leaves - 1)
        assert await read(dut, 0) == [0] * classes
    assert await give(dut, 0, 0) == -(-classes // lanes)
    await bench.clocks(dut, 6)
    assert await read(dut, 0) == of(0)
    await bench.reset(dut)
    assert await read(dut, 1) == await read(dut, 0) == [0] * classes


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def adds_over_the_whole_width(dut):
    """65535 trees with all votes for a class: 65535^2, the greatest sum. Of a table all classes at once. Then
    a leaf without votes begins again from 0."""
    classes, leaves, _, lanes, contexts = sizes(dut)
    await bench.start(dut, **IDLE)
    dut.write_i.value, dut.write_row_i.value, dut.write_bank_i.value = 1, leaves - 1, 0
    dut.write_data_i.value = 65535
    for label in range(classes):
        dut.write_class_i.value = label
        await bench.RisingEdge(dut.clk_i)
    dut.write_i.value = 0
    dut.in_leaf_i.value, dut.in_none_i.value = (65535 if classes == 2 else leaves - 1), 0
    groups = -(-classes // lanes)
    chosen = range(contexts) if contexts * groups <= 4 else [1]
    for context in chosen:
        dut.in_context_i.value, dut.in_valid_i.value = context, 1
        await bench.clocks(dut, 65535 * groups)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, 6)
    most = [0, 65535**2] if classes == 2 else [65535**2] * classes
    assert [await read(dut, context) for context in chosen] == [most] * len(chosen)
    dut.free_i.value = (1 << contexts) - 1
    await bench.RisingEdge(dut.clk_i)
    dut.free_i.value = 0
    for context in chosen:
        await give(dut, 0, context, none=True)
    await bench.clocks(dut, 6)
    assert [await read(dut, context) for context in chosen] == [[0] * classes] * len(chosen)


EVIDENCE = {"faults": {"none": "no frames: a sum lasts until its decision is freed; done in msn_forest"}}

SPACE = lambda draw: {
    "Classes": draw.randint(1, 40),
    "Leaves": draw.randint(1, 40),
    "Banks": draw.randint(1, 2),
    "Lanes": 1 << draw.randint(0, 4),
    "Contexts": 1 << draw.randint(1, 4),
}


@pytest.mark.parametrize(
    "classes, leaves, banks, lanes, contexts",
    [(2, 1, 1, 4, 4), (3, 5, 2, 4, 2), (21, 3, 1, 8, 4), (1, 4, 2, 1, 4), (5, 7, 2, 4, 8), (2, 1, 2, 1, 16)],
)
def test_forest_votes(classes, leaves, banks, lanes, contexts):
    size = {"Classes": classes, "Leaves": leaves, "Banks": banks, "Lanes": lanes, "Contexts": contexts}
    bench.run("forest", "forest_votes", size)


def test_votes_by_hand():
    assert votes_of(np.array([0, 1, 65535]), None).tolist() == [[65535, 0], [65534, 1], [0, 65535]]
    table = np.array([[1, 2, 65532], [7, 65500, 28]], np.uint16)
    assert votes_of(np.array([1, 0]), table).tolist() == [[7, 65500, 28], [1, 2, 65532]]


test_refuses_illegal_parameters = refusals(
    "forest_votes",
    Forest,
    {"Classes": 0},
    {"Leaves": 0},
    {"Leaves": 65537},
    {"Banks": 0},
    alone=({"Lanes": 3}, {"Lanes": 128}, {"Contexts": 1}, {"Contexts": 6}),
    **dict.fromkeys(("features", "classes", "trees", "nodes", "leaves"), 1),
)
