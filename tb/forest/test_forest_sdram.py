"""msn_forest_sdram at the pins of the SDRAM's part model: decisions against the model while one forest is
loaded and swapped in behind another; 400 trees of unlimited depth on rows of windows, with the clocks of
every row."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
import meissner
from forest.test_forest import FIELDS, beats, seen, swap
from forest.test_sdram import part
from forest.trees import forest, rows
from meissner.forest.place import loads, place
from meissner.twins.forest import sdram as twin

ROOM = {1: twin.BANK_WORDS, 2: twin.BANK_WORDS // 2}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


async def up(dut):
    await bench.start(dut, load_valid_i=0, swap_i=0)
    model = part(dut)
    await RisingEdge(dut.clk_i)
    while not bench.high(dut.up_o):
        await RisingEdge(dut.clk_i)
    return model


async def load(dut, table):
    """Write ``table`` [(kind, engine, address, data)]."""
    for kind, _, address, data in table:
        dut.load_valid_i.value, dut.load_kind_i.value = 1, kind
        dut.load_address_i.value, dut.load_data_i.value = address, data
        await ReadOnly()
        if not bench.high(dut.load_ready_o):
            await RisingEdge(dut.load_ready_o)
        await RisingEdge(dut.clk_i)
    dut.load_valid_i.value = 0


async def ask(dut, given):
    """The results of rows, however long they take."""
    count = len(given) * number(dut, "Classes")
    return seen(await bench.stream(dut, beats(given), FIELDS, count=count, drain=1_000_000))


def expected(model, q):
    """The beats of every row's result."""
    given = meissner.Forest(model)
    leaf, _ = given.walk(np.array(q), None)
    votes = model.leaves.astype(np.int64)[leaf].sum(1)
    last = votes.shape[1] - 1
    return [
        (label, int(vote), int(label == last), int(row.argmax()) if label == last else None, 0)
        for row in votes
        for label, vote in enumerate(row)
    ]


def small(dut, seed, trees=10):
    draw = random.Random(seed)
    made = forest(draw, number(dut, "Features"), number(dut, "Classes"), trees, leaves=9, span=1000)
    return made, rows(draw, made, 12, 2000)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def decides_while_another_forest_is_loaded(dut):
    """Each row has the old forest's result or the new one's, the old ones first; with one bank, rows wait for
    the new one: a row that comes while it is loaded has error 1."""
    await up(dut)
    banks, classes = number(dut, "Banks"), number(dut, "Classes")
    old, q = small(dut, 1)
    assert {found[4] for found in await ask(dut, q[:2])} == {1}
    await load(dut, loads(place(old, room=ROOM[banks])))
    await swap(dut)
    assert await ask(dut, q) == expected(old, q)
    new, _ = small(dut, 2, 16)
    busy = cocotb.start_soon(load(dut, loads(place(new, room=ROOM[banks]))))
    if banks == 2:
        seen = 0
        while not busy.done():
            assert await ask(dut, q) == expected(old, q)
            seen += 1
        assert seen > 1
    await busy
    asking = cocotb.start_soon(ask(dut, q * 4))
    await bench.clocks(dut, 300)
    await swap(dut)
    found, before, after = await asking, expected(old, q * 4), expected(new, q * 4)
    if banks == 2:
        turns = [at for at in range(0, len(found) + 1, classes) if found == before[:at] + after[at:]]
        assert len(turns) >= 1 and 0 < turns[-1] < len(found)
    else:
        assert {row[4] for row in found} <= {0, 1}
        assert all(one == other for one, other in zip(found, after) if one[4] == 0)
    assert await ask(dut, q) == expected(new, q)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_swap_waits_for_the_load_under_way(dut):
    """A swap in the very clocks in which the last node is written: the node is still written where it
    belongs."""
    model = await up(dut)
    given, q = small(dut, 3)
    table = loads(place(given, room=ROOM[number(dut, "Banks")]))
    nodes, rest = [row for row in table if row[0] == 0], [row for row in table if row[0] != 0]
    await load(dut, rest + nodes[:-1])
    _, _, address, data = nodes[-1]
    dut.load_valid_i.value, dut.load_kind_i.value = 1, 0
    dut.load_address_i.value, dut.load_data_i.value = address, data
    await bench.clocks(dut, 3)
    dut.swap_i.value = 1
    await RisingEdge(dut.clk_i)
    dut.swap_i.value = 0
    await ReadOnly()
    while not bench.high(dut.load_ready_o):
        assert bench.high(dut.swapping_o)
        await RisingEdge(dut.clk_i)
        await ReadOnly()
    await RisingEdge(dut.clk_i)
    dut.load_valid_i.value = 0
    await bench.clocks(dut, 20)
    assert not bench.high(dut.swapping_o)
    assert await ask(dut, q) == expected(given, q)
    assert model.counts["WRITE"] == len(nodes)


def windows(count, features=9, width=6, seed=4):
    """Rows of ``width`` frames of nine channels: noise, and with label 1 an offset of each channel that is
    half as large."""
    draw = np.random.default_rng(seed)
    label = draw.integers(0, 2, count)
    offset = 0.5 * label[:, None, None] * draw.normal(0, 1, (count, 1, features))
    return (draw.normal(0, 1, (count, width, features)) + offset).reshape(count, -1), label


async def timed(dut, q):
    """(results, clocks)."""
    asking, clock = cocotb.start_soon(ask(dut, q)), 0
    while not asking.done():
        await RisingEdge(dut.clk_i)
        clock += 1
    return asking.result(), clock


def trained(trees=400, rows=3546):
    """``trees`` trees with scikit-learn's defaults, and the rows that they were trained on."""
    from sklearn.ensemble import RandomForestClassifier

    x, y = windows(rows)
    return meissner.Forest(RandomForestClassifier(trees, random_state=1).fit(x, y)), x


@bench.applies(lambda dut: (number(dut, "Features"), number(dut, "Banks")) == (54, 1), long=True)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def time_to_load_400_trees(dut):
    """Every node, root and the number of trees, each offered as soon as the one before is taken, without the
    part model, which would take minutes: other tests load with it. By hand: a row opens, 3 clocks, four
    beats until clock 6, 2 until it closes, 3 until the next opens: 11 a node, and some refreshes."""
    await bench.start(dut, load_valid_i=0, swap_i=0)
    await RisingEdge(dut.up_o)
    forest, _ = trained()
    table = loads(place(forest.model))
    begun_ns = get_sim_time("ns")
    await load(dut, table)
    clocks = (get_sim_time("ns") - begun_ns) / 10
    nodes = forest.model.nodes
    dut._log.info(
        f"{nodes} nodes loaded in {clocks:.0f} clocks, {clocks / nodes:.2f} a node: "
        f"{clocks / 1e5:.1f} ms at 100 MHz"
    )
    assert 11 * nodes <= clocks <= 11.2 * nodes


@bench.applies(
    lambda dut, trees: (number(dut, "Features"), number(dut, "Banks")) == (54, 2),
    long=lambda trees: trees == 400,
)
@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(trees=[50, 400])
async def clocks_of_trees(dut, trees):
    """Trained with scikit-learn's defaults on 3546 rows; loaded into the part directly. Of 1000 rows that
    with the fewest nodes, the middle one and that with the most, alone and one after another."""
    model = await up(dut)
    ends = 54 + 4 * 28  # a row's beats; some nodes of the last walk, with no other beside it
    forest, x = trained(trees)
    fresh, _ = windows(1000, seed=5)
    steps = forest.steps(fresh).sum(1)
    chosen = fresh[np.argsort(steps)[[0, 500, -1]]]
    placed = place(forest.model, forest.steps(x[:500]).mean(0), ROOM[2])
    await load(dut, [row for row in loads(placed) if row[0] != 0])
    for base, nodes in placed.blocks:
        model.load(nodes, base + (1 << 19))  # the half that is loaded first
    await swap(dut)
    q = forest.quantise(chosen)[0].tolist()
    nodes = forest.steps(chosen).sum(1).tolist()
    for row, count in zip(q, nodes):
        before = model.counts["READ"]
        found, clock = await timed(dut, [row])
        assert found == expected(forest.model, [row]) and model.counts["READ"] - before == count
        dut._log.info(f"{count} nodes, {clock} clocks, {clock / count:.3f} a node, {clock / 1e5:.3f} ms")
        assert clock <= 4.2 * count + ends and clock <= 100_000
    found, clock = await timed(dut, q)
    each = clock / sum(nodes)
    dut._log.info(
        f"{forest.model.nodes} nodes, {steps.mean():.0f} a decision; in a row {each:.3f} clocks a node"
    )
    assert found == expected(forest.model, q) and clock <= 4.2 * sum(nodes) + ends


@pytest.mark.parametrize(
    "features, classes, banks, without",
    [
        (3, 3, 2, "400"),
        (4, 2, 1, "400"),
        (54, 2, 2, "400"),
        pytest.param(54, 2, 1, "none", marks=pytest.mark.long),
        pytest.param(54, 2, 2, "none", marks=pytest.mark.long),
    ],
)
def test_forest_sdram(features, classes, banks, without):
    given = {"Features": features, "Classes": classes, "Banks": banks, "PowerUpUs": 2}
    bench.run("forest", "forest_sdram", given, test_filter=f"^(?!.*trees={without})")


EVIDENCE = {"equivalence": {"boxes": True}, "faults": {"none": "as sdram; msn_forest has its own"}}


def test_refuses_illegal_parameters():
    assert "Walkers = 65" in bench.refuses("forest_sdram", {"Walkers": 65}, of="forest_engine")
    assert "ClkKhz = 19999" in bench.refuses("forest_sdram", {"ClkKhz": 19999}, of="sdram")
