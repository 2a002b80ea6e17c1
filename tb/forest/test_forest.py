"""msn_forest against its model, and the model against a plain loop over the nodes of F.json: one class, two,
three and 100; one node, trees that are one leaf, a depth of 60; features at both ends and at thresholds
exactly, one below and one above; several engines, one bank and two, both ends of a memory; swaps while rows
come; rows of a wrong length; nodes and leaves that cannot be, of each engine; clocks counted; memories
outside that answer in any order, late or never."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from forest.trees import decide, forest, moved, rows, tree
from harness.refusals import refusals
from meissner.forest import words
from meissner.twins.forest import forest as twin

FIELDS = ["id", "votes", "last", "class", "error"]
NAMES = ["Features", "FeatureBits", "Classes", "Trees", "Nodes", "Leaves", "Engines", "Banks", "Outside"]


def sizes(dut):
    return {name: getattr(dut, name).value.to_unsigned() for name in NAMES}


def twin_of(size):
    keys = ("features", "feature_bits", "classes", "trees", "nodes", "leaves", "engines", "banks", "outside")
    return twin.Forest(**{key: size[name] for key, name in zip(keys, NAMES)})


def span_of(size):
    return 1 << size["FeatureBits"] - 1


def drawn(draw, size, trees=None, **shape):
    """A forest that fits the build."""
    count = trees or min(size["Trees"] * size["Engines"], 20)
    leaves, span = min(9, size["Leaves"]), span_of(size)
    most = size["Nodes"] * size["Engines"] // count
    shape = {"depth": max(min(6, most.bit_length() - 1), 0)} | shape
    return forest(draw, size["Features"], size["Classes"], count, leaves=leaves, span=span - 2, **shape)


def beats(given):
    return [{"data": value, "last": at == len(row) - 1} for row in given for at, value in enumerate(row)]


def results(found):
    """The beats of the output that belong to a twin's decisions; the class counts at the last beat."""
    last = found.votes.shape[1] - 1
    return [
        (label, int(vote), int(label == last), int(index) if label == last else None, int(error))
        for index, votes, error in zip(found.index, found.votes, found.error)
        for label, vote in enumerate(votes)
    ]


def seen(got):
    return [(b["id"], b["votes"], b["last"], b["class"] if b["last"] else None, b["error"]) for b in got]


def quiet(dut):
    return {"load_valid_i": 0, "swap_i": 0} | (
        {} if dut.Outside.value else {"req_ready_i": 0, "rsp_valid_i": 0}
    )


async def load(dut, model, table):
    """Write ``table`` [(kind, engine, address, data)] to the block and to the twin ``model``."""
    for kind, engine, address, data in table:
        dut.load_valid_i.value = 1
        dut.load_kind_i.value, dut.load_engine_i.value = kind, engine
        dut.load_address_i.value, dut.load_data_i.value = address, data
        await ReadOnly()
        while not bench.high(dut.load_ready_o):
            await RisingEdge(dut.clk_i)
            await ReadOnly()
        await RisingEdge(dut.clk_i)
        if model:
            model.load(kind, engine, address, data)
    dut.load_valid_i.value = 0  # and what waits there now would leave no tree
    dut.load_kind_i.value, dut.load_engine_i.value = twin.COUNT, 0
    dut.load_address_i.value, dut.load_data_i.value = 0, 0


async def swap(dut, model=None):
    dut.swap_i.value = 1
    await RisingEdge(dut.clk_i)
    await swapped(dut, model)


async def swapped(dut, model):
    """Until what was asked for is done."""
    dut.swap_i.value = 0
    await ReadOnly()
    while bench.high(dut.swapping_o):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
    await RisingEdge(dut.clk_i)
    if model:
        model.swap()


def loads(size, given, at_end=False):
    """The writes of ``given``, a model of the importers; ``at_end``: up to the last node of the memory."""
    table = words.loads(given, size["Engines"])
    end = max((row[2] for row in table if row[0] == twin.NODE), default=0)
    return moved(table, size["Nodes"] - 1 - end) if at_end else table


async def put(dut, model, given, at_end=False):
    """Load and swap in ``given``."""
    await load(dut, model, loads(sizes(dut), given, at_end))
    await swap(dut, model)


async def ask(dut, given, *pauses):
    """The results of rows."""
    count = len(given) * dut.Classes.value.to_unsigned()
    return seen(await bench.stream(dut, beats(given), FIELDS, *pauses, count=count, drain=9000))


async def check(dut, model, given, *pauses):
    """The block's results of rows are those of ``model``, beat by beat."""
    found, expected = await ask(dut, given, *pauses), results(model.next(given))
    wrong = [(at, *pair) for at, pair in enumerate(zip(found, expected)) if pair[0] != pair[1]]
    assert not wrong and len(found) == len(expected), (len(wrong), len(found), wrong[:4])


def inside(dut):
    return dut.Outside.value == 0


def long_enough(dut, nodes=40):
    return dut.Nodes.value.to_unsigned() >= nodes


async def noise(dut):
    """What comes at the ports of a memory outside, of which nothing is asked."""
    draw = random.Random(bench.SEED)
    while True:
        for name in ("req_ready_i", "rsp_valid_i", "rsp_tag_i", "rsp_data_i"):
            getattr(dut, name).value = draw.getrandbits(len(getattr(dut, name)))
        await RisingEdge(dut.clk_i)
        assert bench.read(dut.req_valid_o) == 0


# Before a reset rows may never end: two contexts are soon full of them, and no further row is looked at.
@bench.applies(lambda dut: dut.Contexts.value.to_unsigned() > 2)
@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", span=400, **quiet(dut))


@bench.applies(inside)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.5])
async def matches_model(dut, rate):
    size, draw = sizes(dut), random.Random(bench.SEED)
    await bench.start(dut, **quiet(dut))
    cocotb.start_soon(noise(dut))
    model = twin_of(size)
    for number in range(3):
        given = drawn(draw, size)
        await put(dut, model, given, at_end=number == 1)
        q = rows(draw, given, 40, span_of(size))
        await check(dut, model, q, *bench.gaps_and_stalls(rate))


@bench.applies(lambda dut: inside(dut) and dut.Classes.value.to_unsigned() > 1 and long_enough(dut))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def decides_by_the_old_forest_or_the_new_one(dut):
    """Rows all the time, and forests swapped as fast as they load. Each decision is one forest's, and the
    forests come in their order; with one bank error 1 in between."""
    size, draw = sizes(dut), random.Random(bench.SEED + 1)
    await bench.start(dut, **quiet(dut))
    forests = [drawn(draw, size) for _ in range(4)]
    span = span_of(size)
    q = [[draw.randint(-span, span - 1) for _ in range(size["Features"])] for _ in range(400)]
    expected, model = [], twin_of(size)
    for each in [None, *forests]:
        if each:
            for row in words.loads(each, size["Engines"]):
                model.load(*row)
            model.swap()
        expected.append(results(model.next(q)))

    async def change():
        for each in forests:
            await load(dut, None, words.loads(each, size["Engines"]))
            await swap(dut)
        if size["Banks"] == 1:  # of nothing: the forest stays
            await bench.clocks(dut, 100)
            await swap(dut)

    changing = cocotb.start_soon(change())
    got = await ask(dut, q, *bench.gaps_and_stalls(0.1))
    await changing
    now, used, step = 0, set(), size["Classes"]
    for start in range(0, len(got), step):
        found = got[start : start + step]
        if found[0][4] == twin.ABSENT:
            assert now == 0 or size["Banks"] == 1
            continue
        while now < 4 and found != expected[now][start : start + step]:
            now += 1
        assert found == expected[now][start : start + step]
        used.add(now)
    assert 4 in used and (len(used) >= 3 or size["Banks"] == 1)


@bench.applies(inside)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def swaps_in_the_clock_of_the_last_write(dut):
    """A write of each kind."""
    size, draw = sizes(dut), random.Random(bench.SEED + 9)
    await bench.start(dut, **quiet(dut))
    model = twin_of(size)
    for kind in (twin.COUNT, twin.NODE, twin.ROOT, *[twin.VOTE] * (size["Classes"] != 2)):
        given = drawn(draw, size)
        *table, last = sorted(loads(size, given), key=lambda row, kind=kind: row[0] == kind)
        await load(dut, model, table)
        dut.swap_i.value = 1
        await load(dut, model, [last])
        await swapped(dut, model)
        await check(dut, model, rows(draw, given, 10, span_of(size)))


@bench.applies(inside)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def decides_by_the_forest_or_by_none(dut):
    """Rows all the time, and its trees taken away and given back: a row has the forest's votes or error 1."""
    size, draw = sizes(dut), random.Random(bench.SEED + 10)
    await bench.start(dut, **quiet(dut))
    model, given = twin_of(size), drawn(draw, size)
    await put(dut, model, given)
    q = rows(draw, given, 150, span_of(size))
    counts = [row for row in loads(size, given) if row[0] == twin.COUNT]

    async def change():
        for number in range(40):
            await load(dut, None, [(*row[:3], row[3] * (number % 2)) for row in counts])
            await swap(dut)
            await bench.clocks(dut, draw.randint(1, 60))

    changing = cocotb.start_soon(change())
    got, expected, step = await ask(dut, q), results(model.next(q)), size["Classes"]
    changing.cancel()
    none = [
        (label, 0, label == step - 1, 0 if label == step - 1 else None, twin.ABSENT) for label in range(step)
    ]
    found = [got[at : at + step] for at in range(0, len(got), step)]
    wrong = [(at, one) for at, one in enumerate(found) if one not in (none, expected[at * step :][:step])]
    assert not wrong, wrong[:9]
    assert 5 < found.count(none) < len(q) - 5


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reports_that_there_is_no_forest(dut):
    """After a reset, with and without a swap, and with a forest of no trees."""
    size = sizes(dut)
    await bench.start(dut, **quiet(dut))
    row, model = [[1] * size["Features"]], twin_of(size)
    await check(dut, model, row)
    await swap(dut, model)
    await check(dut, model, row)
    assert model.next(row).error.tolist() == [1]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def leaves_out_rows_of_a_wrong_length(dut):
    """Whole rows, one beat too few, one too many, two rows in one, and single beats."""
    size, draw = sizes(dut), random.Random(bench.SEED + 2)
    _, model, _ = await started(dut, draw)
    features, sent = size["Features"], []
    for _ in range(60):
        length = draw.choice([features] * 3 + [features - 1, features + 1, 2 * features, 1, 3 * features + 1])
        sent += beats([[draw.randint(-9, 9) for _ in range(length)]]) if length else []
    q = [row for row in (model.beat(each["data"], each["last"]) for each in sent) if row]
    assert len(q) < 60 or features == 1
    got = await bench.stream(dut, sent, FIELDS, *bench.gaps_and_stalls(0.2), drain=600)
    assert seen(got) == results(model.next(q))
    assert bench.read(dut.damaged_o) == model.damaged > 5


@bench.applies(lambda dut: inside(dut) and long_enough(dut))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def reports_nodes_and_leaves_that_cannot_be(dut):
    """A tree of any engine has no vote if it goes back, to itself, beyond the memory, or to a feature or a
    leaf that does not exist; the memory may be read in any of them, and the next row is decided again."""
    size = sizes(dut)
    await bench.start(dut, **quiet(dut))
    nodes, leaves, features, engines = (size[name] for name in ("Nodes", "Leaves", "Features", "Engines"))
    word = lambda kind, feature, low, high=0: kind << 62 | feature << 54 | high << 48 | low
    bad = {
        "whole": [word(0, 0, 12), word(3, 0, 0), word(3, features - 1, leaves - 1 << 16 | leaves - 1)],
        "one leaf too many": [word(3, 0, leaves << 16 | leaves)],
        "back": [word(1, 0, 0), word(0, 0, 0)],
        "to itself": [word(1, 0, 0), word(0, 0, 11)],
        "beyond": [word(0, 0, nodes), word(3, 0, 0)],
        "far beyond": [word(0, 0, 1 << 31 | 12), word(3, 0, 0)],
        "one feature too many": [word(3, features, 0)],
    }
    names = [*bad, *["back"] * engines]
    for number, name in enumerate(names[: max(len(bad), engines + 2)]):
        model, at = twin_of(size), number % engines
        table = [(twin.NODE, at, 0, word(3, 0, 0)), (twin.ROOT, at, 0, 10)]
        table += [(twin.COUNT, engine, 0, int(engine == at)) for engine in range(engines)]
        table += [(twin.NODE, at, 10 + place, each) for place, each in enumerate(bad[name])]
        table += [
            (twin.VOTE, 0, label << 16 | row, 5 * label + row)
            for label in range(size["Classes"])
            for row in (0, leaves - 1)
        ]
        model.bank = bench.read(dut.req_bank_o)
        await load(dut, model, table)
        await swap(dut, model)
        q = [[-5] * features, *[[5] * features] * 4]  # one of each context goes right
        found = model.next(q)
        assert await ask(dut, q) == results(found), name
        seen_ = set(found.error.tolist())
        if name == "whole":
            assert seen_ == {0}
        elif size["Classes"] != 2 or name != "one leaf too many":
            if name == "one feature too many" and features & features - 1 == 0 and features > 1:
                continue  # block RAM keeps no bit for it
            assert twin.BROKEN in seen_, name


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def ignores_loads_of_what_does_not_exist(dut):
    size, draw = sizes(dut), random.Random(bench.SEED + 4)
    memory, model, given = await started(dut, draw)
    table, engines = words.loads(given, size["Engines"]), range(size["Engines"], 1 << len(dut.load_engine_i))
    beyond = lambda end, bits: [end, *(1 << bit for bit in range(end.bit_length(), bits))]
    table += [(twin.NODE, 0, address, draw.getrandbits(64)) for address in beyond(size["Nodes"], 32)]
    table += [(twin.ROOT, 0, address, 1) for address in beyond(size["Trees"], 32)]
    table += [(twin.COUNT, 0, 0, count) for count in beyond(size["Trees"] + 1, 32)]
    table += [(twin.VOTE, 0, label << 16, 77) for label in beyond(size["Classes"], 16)]
    if size["Leaves"] < 65536:
        table += [(twin.VOTE, 0, row, 78) for row in beyond(size["Leaves"], 16)]
    table += [(kind, engine, 0, 0) for kind in (twin.NODE, twin.ROOT, twin.COUNT) for engine in engines]
    if memory:
        memory.load(0, table)
    await load(dut, model, table)
    await swap(dut, model)
    q = rows(draw, given, 10, span_of(size))
    await check(dut, model, q)
    assert [votes.tolist() for votes in model.next(q).votes] == [decide(given, row)[0] for row in q]


@bench.applies(inside)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    size, draw = sizes(dut), random.Random(bench.SEED + 5)
    await bench.start(dut, **quiet(dut))
    for cut in (1, 3, 17, 29, 40, 77):
        model, given = twin_of(size), drawn(draw, size)
        await put(dut, model, given)
        q = rows(draw, given, 8, span_of(size))
        sending = cocotb.start_soon(ask(dut, q, None, lambda: True))
        await bench.clocks(dut, cut)
        sending.cancel()
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        model.reset()
        await check(dut, model, q[:2])
        await put(dut, model, given)
        await check(dut, model, q)
        assert bench.read(dut.damaged_o) == 0
        await bench.reset(dut)


def has_room_for_all(dut):
    walkers, contexts = (getattr(dut, name).value.to_unsigned() for name in ("Walkers", "Contexts"))
    return inside(dut) and walkers >= 14 and contexts >= 4 and long_enough(dut, 300)


@bench.applies(has_room_for_all)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(shape=["even", "one deep", "shallow"])
async def compares_a_node_in_nearly_every_clock(dut, shape):
    """Rows without a pause: at least 95 % of one node a clock and engine, counted from the first node of the
    third row to the last of the last but two; for trees alike, one of 60 nodes in a row among short ones,
    and a depth of 3, as many for each engine."""
    size, draw = sizes(dut), random.Random(bench.SEED + 6)
    engines, features = size["Engines"], size["Features"]
    each = {"even": (12, dict(depth=4, stop=0)), "one deep": (30, dict(depth=3, stop=0)), "shallow": (24, {})}
    count, more = each[shape]
    more = more or dict(depth=3, stop=0)
    span, leaves = span_of(size), min(9, size["Leaves"])
    make = lambda **shape: tree(draw, features, leaves, span - 2, **shape)
    trees = [make(**more) for _ in range(count * engines)]
    if shape == "one deep":
        trees[-engines:] = [make(depth=60, chain=True) for _ in range(engines)]
    given = forest(draw, features, size["Classes"], trees, leaves=leaves)
    model = twin_of(size)
    await bench.start(dut, **quiet(dut))
    await put(dut, model, given)
    q = [[draw.randint(-span, span - 1) for _ in range(features)] for _ in range(24)]
    clocks = []

    async def watch():
        while True:
            await ReadOnly()
            clocks.append(bench.read(dut.step_o).bit_count())
            await RisingEdge(dut.clk_i)

    watching = cocotb.start_soon(watch())
    await check(dut, model, q)
    watching.cancel()
    steps = [decide(given, row)[2] for row in q]
    assert sum(clocks) == sum(steps)
    passed = np.cumsum(clocks)
    first, last = np.searchsorted(passed, [sum(steps[:3]), sum(steps[:-3])])
    share = (passed[last] - passed[first]) / (last - first) / engines
    dut._log.info(f"{shape}: {share:.4f} of the clocks of {engines} engines compare a node")
    assert share >= 0.95


class Memory:
    """The memories outside: words of each bank and engine; answers in any order, ``latency`` clocks or more
    after the request, and, if asked for, a second time with other data."""

    def __init__(self, dut, draw, latency, ready=1.0, doubled=0.0):
        self.dut, self.draw, self.latency = dut, draw, latency
        self.ready, self.doubled = ready, doubled
        self.words = [{}, {}]  # of each bank: {engine: {address: word}}
        self.waiting = [[] for _ in range(dut.Engines.value.to_unsigned())]
        self.clock, self.asked = 0, 0
        self.held = lambda number, engine: 0  # further clocks for the request of this number
        self.running = cocotb.start_soon(self.run())

    def load(self, bank, table):
        self.words[bank] = {
            (engine, address): data for kind, engine, address, data in table if kind == twin.NODE
        }

    async def run(self):
        dut, draw = self.dut, self.draw
        engines = len(self.waiting)
        address_bits, tag_bits = len(dut.req_address_o) // engines, len(dut.req_tag_o) // engines
        while True:
            ready = sum((draw.random() < self.ready) << engine for engine in range(engines))
            dut.req_ready_i.value = ready
            valid, tags, data = 0, 0, 0
            for engine, pending in enumerate(self.waiting):
                due = [entry for entry in pending if entry[0] <= self.clock]
                due = [entry for entry in due if entry[0] < 0] or due
                tag, word = draw.getrandbits(tag_bits), draw.getrandbits(64)
                if due:
                    entry = draw.choice(due)
                    pending.remove(entry)
                    _, tag, word = entry
                    valid |= 1 << engine
                    if entry[0] >= 0 and draw.random() < self.doubled:
                        pending.append((-1, tag, draw.getrandbits(64)))
                tags |= tag << tag_bits * engine
                data |= word << 64 * engine
            dut.rsp_valid_i.value, dut.rsp_tag_i.value, dut.rsp_data_i.value = valid, tags, data
            await ReadOnly()
            asked, bank = bench.read(dut.req_valid_o) & ready, bench.read(dut.req_bank_o)
            for engine, pending in enumerate(self.waiting):
                if asked >> engine & 1:
                    address = bench.lane_values(bench.read(dut.req_address_o), engines, address_bits)[engine]
                    tag = bench.lane_values(bench.read(dut.req_tag_o), engines, tag_bits)[engine]
                    word = self.words[bank].get((engine, address), draw.getrandbits(64))
                    due = self.clock + self.latency() + self.held(self.asked, engine)
                    pending.append((due, tag, word))
                    self.asked += 1
            await RisingEdge(dut.clk_i)
            self.clock += 1


def outside(dut):
    return dut.Outside.value == 1


async def started(dut, draw, latency=lambda: 2, **how):
    """(memory, model, forest): a block with a forest in use, behind a memory that answers after ``how``; None
    if that is inside."""
    size = sizes(dut)
    await bench.start(dut, **quiet(dut))
    memory = Memory(dut, draw, latency, **how) if outside(dut) else None
    model, given = twin_of(size), drawn(draw, size)
    table = words.loads(given, size["Engines"])
    if memory:
        memory.load(1, table)
    await load(dut, model, table)
    await swap(dut, model)
    return memory, model, given


@bench.applies(outside)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(how=["at once", "any order", "slow", "twice"])
async def reads_a_memory_that_answers_in_any_order(dut, how):
    draw = random.Random(f"{bench.SEED} {how}")
    ways = {
        "at once": {"latency": lambda: 1},
        "any order": {"latency": lambda: draw.randint(1, 40), "ready": 0.6},
        "slow": {"latency": lambda: draw.randint(30, 33), "ready": 0.25},
        "twice": {"latency": lambda: draw.randint(1, 9), "doubled": 0.3},
    }
    memory, model, given = await started(dut, draw, **ways[how])
    q = rows(draw, given, 40, span_of(sizes(dut)))
    await check(dut, model, q, *bench.gaps_and_stalls(0.2))
    size, full = sizes(dut), {}
    if how == "at once":  # the memory nearly full: trees of 63 nodes
        full = {"trees": min(size["Trees"], size["Nodes"] // 63) * size["Engines"], "depth": 6, "stop": 0}
    table = loads(size, drawn(draw, size, **full), at_end=True)
    memory.load(0, table)
    await load(dut, model, table)
    await swap(dut, model)
    await check(dut, model, q)
    memory.running.cancel()


def held(late, place, clocks):
    """The first request of the engine ``late`` from this one on waits so many clocks."""
    once = iter([clocks])
    return lambda number, engine: next(once, 0) if engine == late and number >= place else 0


@bench.applies(outside)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def reports_a_memory_that_answers_late_or_never(dut):
    """One read of any engine is not answered for long, in any place of a decision. The rows before have their
    results, and those that are complete when the time has passed; its own and all after have error 2 and no
    votes, until the answer comes, which may take 16 times as long. Without one rows are decided on again
    after that time."""
    size, draw = sizes(dut), random.Random(bench.SEED + 8)
    limit, classes = dut.Timeout.value.to_unsigned(), size["Classes"]
    for number in range(max(4, size["Engines"])):
        place, late = (5, 11, 25, 160)[number % 4], number % size["Engines"]
        memory, model, given = await started(dut, draw, latency=lambda: draw.randint(1, 6))
        q = rows(draw, given, 30, span_of(size))
        expected, lost = results(model.next(q)), results(model.next(q[:1]))
        lost = [(label, 0, last, 0 if last else None, twin.LATE) for label, _, last, _, _ in lost]
        memory.held = held(late, place, 12 * limit)
        got, now = await ask(dut, q), []
        for start in range(0, len(got), classes):
            found = got[start : start + classes]
            now.append(found == lost)
            assert found in (lost, expected[start : start + classes])
        first = now.index(True)
        assert all(now[first + dut.Contexts.value.to_unsigned() :]) and not all(now), now
        await bench.clocks(dut, 13 * limit)
        await check(dut, model, q)
        memory.held = held(late, memory.asked + 2, 10**9)
        got = await ask(dut, q)
        await bench.clocks(dut, limit)
        begun = memory.clock
        assert got[-classes:] == lost == await ask(dut, q[:1]) and memory.clock - begun < limit  # at once
        await bench.clocks(dut, 17 * limit)
        await check(dut, model, q)
        memory.running.cancel()
        await bench.reset(dut)


EVIDENCE = {
    "equivalence": {"boxes": True, "reset_size": {"Nodes": 1}},
    "mutants": {"sets": [6, 7], "unsolved": True},  # without the nodes, too many bits for the solver
    "faults": {
        "size": {"Banks": 1},
        "short": {"Timeout": 128},
        "settle": 6,  # the rows under way, the one that comes in, the one that leaves
        # A write of a load that is lost is kept until the next load; msn_classify's `written` counts them.
        "driver": {
            "quiet": "req_",
            "kept": "memory counts absent load_ loading",
            "skip": "lost,gone",
            "error": "out_error_o",
        },
    },
}

TOPS = {
    "two classes": {},
    "one engine, one bank": {"Banks": 1, "Features": 3, "FeatureBits": 12, "Nodes": 300, "Contexts": 2},
    "wine": {"Classes": 3, "Features": 13, "Engines": 2, "Leaves": 50, "Banks": 1},
    "many classes": {
        "Classes": 100,
        "Features": 5,
        "Nodes": 256,
        "Leaves": 9,
        "Trees": 20,
        "Lanes": 8,
        "Engines": 3,
    },
    "one class": {"Classes": 1, "Features": 2, "FeatureBits": 2, "Nodes": 64, "Trees": 7, "Leaves": 3},
    "one node": {"Nodes": 1, "Trees": 1, "Features": 1, "Walkers": 1, "Banks": 1, "Leaves": 1},
    "outside": {"Outside": 1, "Engines": 8, "Timeout": 70, "Nodes": 512, "Walkers": 11, "Trees": 30},
    "outside, three classes": {"Outside": 1, "Classes": 3, "Timeout": 100, "Banks": 2, "Contexts": 2},
    "eight engines": {"Engines": 8, "Nodes": 512, "Trees": 40, "Features": 9, "FeatureBits": 18},
}


@pytest.mark.parametrize("name", TOPS)
def test_forest(name):
    bench.run("forest", "forest", TOPS[name])


def test_model_against_a_loop():
    """Every word, table and vote of the twin's own, by the loop over F.json; deep chains, single leaves."""
    draw, seen_ = random.Random(1), set()
    for features, classes, trees in ((1, 1, 1), (9, 2, 30), (13, 3, 21), (5, 100, 11), (256, 2, 7)):
        lists = [tree(draw, features, 9, 900, depth=draw.choice([0, 1, 5])) for _ in range(trees)]
        lists.append(tree(draw, features, 9, 900, depth=53, chain=True))
        given = forest(draw, features, classes, lists)
        for engines in (1, 3):
            model = twin.Forest(features, classes, 40, 2000, 9, engines=engines)
            for row in words.loads(given, engines):
                model.load(*row)
            model.swap()
            q = rows(draw, given, 60, 1000)
            found = model.next(q)
            expected = [decide(given, row) for row in q]
            assert found.votes.tolist() == [votes for votes, _, _ in expected]
            assert found.index.tolist() == [index for _, index, _ in expected]
            assert model.steps == sum(steps for _, _, steps in expected)
            assert not found.error.any()
            seen_ |= {*found.index.tolist()}
    assert len(seen_) > 3


test_refuses_illegal_parameters = refusals(
    "forest", twin.Forest, {"Engines": 65}, features=1, classes=2, trees=1, nodes=1, leaves=1
)
