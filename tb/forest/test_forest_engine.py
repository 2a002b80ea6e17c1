"""msn_forest_engine by itself, with the memory played by the test: each request and each answer clock by
clock. What a forest decides is tested with the whole (test_forest.py); here are the clocks of a node, of a
tree and of an answer that is late, flushes in every clock of a walk, answers after a flush, nodes that cannot
be, and what is left of an upset. What goes with a valid, a write or a read is wrong while that is low."""

import random

import cocotb
import numpy as np
import pytest

import bench
from forest.trees import decide, forest, moved, rows, tree
from harness.refusals import refusals
from meissner.forest import words
from meissner.twins.forest.forest import Forest, walk

IDLE = (
    "go_i oldest_i free_i flush_i row_write_i bank_i load_root_i load_leaf_i load_count_i read_context_i "
    "req_ready_i rsp_valid_i"
)


def parameter(dut, name):
    return getattr(dut, name).value.to_unsigned()


class Played:
    """The engine with a memory: ``answers(number)`` clocks after its request, the request of this number is
    answered; 0 or less: never."""

    IDLE = {  # noqa: RUF012
        "row": ("row_context_i", "row_index_i", "row_data_i"),
        "load": ("load_address_i", "load_data_i"),
        "read": ("read_context_i", "read_class_i", "read_sum_i"),
    }

    def __init__(self, dut, memory, answers):
        self.dut, self.memory, self.answers = dut, memory, answers
        self.pending, self.asked, self.clock = [], [], 0
        self.late, self.busy, self.draw = [], None, random.Random(bench.SEED)
        self.idle = {
            key: [(getattr(dut, name), len(getattr(dut, name))) for name in names]
            for key, names in self.IDLE.items()
        }

    async def step(self):
        dut, bits = self.dut, self.draw.getrandbits
        due = [entry for entry in self.pending if entry[0] == self.clock][:1]
        if not due:  # what could not be answered in its clock, as another one was
            due = [entry for entry in self.pending if entry[0] < self.clock][:1]
        dut.rsp_valid_i.value = len(due)
        dut.rsp_tag_i.value = due[0][1] if due else bits(len(dut.rsp_tag_i))
        dut.rsp_data_i.value = int(self.memory[due[0][2]]) if due else bits(64)
        for key, ports in self.idle.items():
            for port, width in ports if key != self.busy else ():
                port.value = bits(width)
        self.pending = [entry for entry in self.pending if entry not in due]
        await bench.ReadOnly()
        if bench.high(dut.req_valid_o) and bench.high(dut.req_ready_i):
            wait = self.answers(len(self.asked))
            address, tag = bench.read(dut.req_address_o), bench.read(dut.req_tag_o)
            self.asked.append((self.clock, address))
            if wait > 0:
                self.pending.append((self.clock + wait, tag, address))
        if bench.high(dut.late_o):
            self.late.append(self.clock)
        await bench.RisingEdge(dut.clk_i)
        self.clock += 1

    async def steps(self, count):
        for _ in range(count):
            await self.step()

    async def row(self, context, values):
        for index, value in enumerate(values):
            self.dut.row_write_i.value, self.dut.row_context_i.value = 1, context
            self.dut.row_index_i.value, self.dut.row_data_i.value = index, value & (1 << 22) - 1
            self.busy = "row"
            await self.step()
        self.dut.row_write_i.value, self.busy = 0, None

    async def votes(self, context):
        found = []
        for label in range(parameter(self.dut, "Classes")):
            before, self.busy = self.draw.getrandbits(32), "read"
            self.dut.read_context_i.value, self.dut.read_class_i.value = context, label
            self.dut.read_sum_i.value, self.dut.read_i.value = before, 1
            await self.step()
            self.dut.read_i.value, self.busy = 0, None
            await self.step()
            found.append((bench.read(self.dut.read_votes_o) - before) % (1 << 32))
        return found

    async def free(self, *contexts):
        self.dut.go_i.value = 0
        self.dut.free_i.value = sum(1 << context for context in contexts)
        await self.step()
        self.dut.free_i.value = 0
        await self.step()


async def begin(dut, given, answers, base=0):
    """The engine with the forest ``given`` in use, in bank 1, its nodes from address ``base`` on."""
    await bench.start(dut, **dict.fromkeys(IDLE.split(), 0))
    table = moved(words.loads(given, 1), base)
    memory = {address: data for kind, _, address, data in table if kind == words.NODE}
    await load(dut, table)
    dut.bank_i.value = dut.req_ready_i.value = 1
    dut.read_i.value = 0
    played = Played(dut, memory, answers)
    await played.steps(parameter(dut, "Walkers") + 4)
    return played


async def load(dut, table):
    """Write what of ``table`` [(kind, engine, address, data)] does not lie in the memory outside."""
    ports = {1: dut.load_root_i, 2: dut.load_leaf_i, 3: dut.load_count_i}
    for kind, _, address, data in table:
        if kind in ports:
            ports[kind].value, dut.load_address_i.value, dut.load_data_i.value = 1, address, data
            await bench.RisingEdge(dut.clk_i)
            ports[kind].value = 0


async def again(played, given, row):
    """Give up what is under way, as msn_forest does, then decide on ``row`` with all walkers; how many nodes
    were read."""
    dut = played.dut
    dut.flush_i.value = 1
    await played.step()
    dut.flush_i.value = 0
    await played.free(0, 1)
    count = len(played.asked)
    dut.go_i.value = 0b10
    await played.row(1, row)
    for _ in range(400):
        await played.step()
        if bench.read(dut.done_o) == 0b10:
            break
    assert bench.read(dut.done_o) == 0b10 and bench.read(dut.stuck_o) == 0
    assert await played.votes(1) == decide(given, row)[0]
    await played.free(1)
    return len(played.asked) - count


def small(draw, dut, trees, **shape):
    return forest(draw, 3, parameter(dut, "Classes"), trees, leaves=4, **shape)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def decides_on_contexts_in_their_order(dut):
    """All contexts at once, the oldest being each of them: trees begin in its order, and the sums are the
    loop's."""
    draw, contexts = random.Random(bench.SEED), parameter(dut, "Contexts")
    given = small(draw, dut, 5, depth=3, stop=0)
    played = await begin(dut, given, lambda number: 2)
    for oldest in range(contexts):
        q = rows(draw, given, contexts, 1000)
        for context in range(contexts):
            await played.row(context, q[context])
        dut.oldest_i.value, dut.go_i.value = oldest, (1 << contexts) - 1
        first = len(played.asked)
        await played.steps(5 * 3 * contexts + 60)
        assert bench.read(dut.done_o) == (1 << contexts) - 1
        roots = [a for _, a in played.asked[first:] if a in words.pack(given).roots]
        assert roots == words.pack(given).roots.tolist() * contexts
        for context in range(contexts):
            assert await played.votes(context) == decide(given, q[context])[0]
        dut.go_i.value, dut.free_i.value = 0, (1 << contexts) - 1
        await played.step()
        dut.free_i.value = 0
        await played.steps(2)
        assert bench.read(dut.done_o) == 0
    assert played.late == []


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(end=[0, 1])
async def decides_with_every_tree_and_node(dut, end):
    """As many trees as there is room for, at either end of the memory, all contexts at once; answers in any
    order."""
    draw, contexts, count = (
        random.Random(bench.SEED + end),
        parameter(dut, "Contexts"),
        parameter(dut, "Trees"),
    )
    given = small(draw, dut, count, depth=4, stop=0.1)
    nodes = len(words.pack(given).nodes)
    base = (parameter(dut, "Nodes") - nodes) * end
    assert base >= 0
    played = await begin(dut, given, lambda number: draw.randint(1, 20), base)
    for oldest in range(3):
        q = rows(draw, given, contexts, 1000)
        for context in range(contexts):
            await played.row(context, q[context])
        dut.oldest_i.value, dut.go_i.value = oldest % contexts, (1 << contexts) - 1
        for _ in range(4000):
            await played.step()
            if bench.read(dut.done_o) == (1 << contexts) - 1:
                break
        for context in range(contexts):
            assert await played.votes(context) == decide(given, q[context])[0]
        await played.free(*range(contexts))
    assert {address for _, address in played.asked} >= {base + root for root in words.pack(given).roots}
    assert played.late == []


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def walks_a_tree_in_eleven_clocks_a_node(dut):
    """One tree in block RAM's two clocks: requests 11 clocks apart."""
    draw = random.Random(bench.SEED)
    chain = tree(draw, 3, 4, 900, depth=12, chain=True)
    given = small(draw, dut, [chain])
    played = await begin(dut, given, lambda number: 2)
    for q in rows(draw, given, 6, 1000):
        await played.row(0, q)
        first = len(played.asked)
        dut.go_i.value = 1
        await played.steps(11 * 12 + 30)
        clocks = [clock for clock, _ in played.asked[first:]]
        assert len(clocks) == decide(given, q)[2] and set(np.diff(clocks)) <= {11}
        assert bench.read(dut.done_o) == 1
        await played.free(0)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(which=[0, 1, 2])
async def is_late_one_clock_after_the_timeout(dut, which):
    """A chain of three nodes: the answer to request ``which`` Timeout clocks after the one before is in time,
    in the next clock it is late, once. For the first one the decision's beginning counts."""
    draw, limit = random.Random(bench.SEED), parameter(dut, "Timeout")
    nodes = dict(feature=[0, 1, 2], threshold=[0, 0, 0], left=[1, 2, -1], right=[-2, -3, -4])
    given = small(draw, dut, [nodes])
    walked = 11 - 2  # from an answer to the next request
    for more in (0, 1):
        held = {which: (limit - walked if which else limit - 1 - 5) + more}
        played = await begin(dut, given, lambda number, held=held: held.get(number, 2))
        await played.row(0, [-1, -1, -1])
        begun, dut.go_i.value = played.clock, 1
        await played.steps(2 * limit + 60)
        if which == 0 and more == 0:
            assert played.asked[0][0] - begun == 5
        assert bool(played.late) == bool(more), (which, more, played.late)
        if not more:
            assert bench.read(dut.done_o) == 1 and await played.votes(0) == decide(given, [-1, -1, -1])[0]
        dut.go_i.value = 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def begins_again_after_a_flush(dut):
    """A flush in every clock of a decision: the answers on their way are awaited and not used, then the same
    row gives the same votes with all walkers."""
    draw = random.Random(bench.SEED)
    given = small(draw, dut, 6, depth=3, stop=0.1)
    played = await begin(dut, given, lambda number: 3 + number % 4)
    q = rows(draw, given, 50, 1000)
    for at, row in enumerate(q):
        await played.row(0, row)
        dut.go_i.value = 1
        await played.steps(at)
        assert await again(played, given, row) - decide(given, row)[2] in (0, 1), at
    assert played.late == []


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def is_stuck_until_the_last_answer(dut):
    """Two requests whose answers come late and one that is not taken, before a flush; a new decision waits
    for all."""
    draw = random.Random(bench.SEED)
    given = small(draw, dut, 3, depth=2, stop=0)
    played = await begin(dut, given, lambda number: 60 if number < 2 else 20 if number == 2 else 2)
    row = [5, -5, 7]
    await played.row(0, row)
    dut.go_i.value = 1
    await played.steps(7)
    dut.req_ready_i.value = 0
    await played.steps(3)
    dut.flush_i.value = 1
    await played.step()
    dut.flush_i.value = 0
    await played.free(0)
    await played.row(1, row)
    dut.go_i.value = 2
    await played.steps(70)
    assert (len(played.asked), played.pending, bench.read(dut.stuck_o)) == (2, [], 1)
    dut.req_ready_i.value = 1
    await played.steps(15)
    assert (len(played.asked), bench.read(dut.stuck_o)) == (3, 1)
    await played.steps(140)
    assert (bench.read(dut.stuck_o), bench.read(dut.done_o)) == (0, 2)
    assert await played.votes(1) == decide(given, row)[0]


@bench.applies(lambda dut: parameter(dut, "Walkers") >= 3)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(later=[0, 100])
async def forgets_an_answer_that_never_comes(dut, later):
    """Of three requests one is answered before a flush, one never, and one never or later: stuck for Patience
    clocks from the flush, or from that answer, exactly; then it decides with all walkers."""
    draw, patience = random.Random(bench.SEED), parameter(dut, "Patience")
    given, row = small(draw, dut, 3, depth=2, stop=0), [5, -5, 7]
    played = await begin(dut, given, lambda number: [2, 0, later, 2][min(number, 3)])
    await played.row(0, row)
    dut.go_i.value = 1
    await played.steps(9)
    flushed, dut.flush_i.value = played.clock, 1
    await played.step()
    dut.flush_i.value = 0
    await played.free(0)
    since = played.asked[2][0] + later if later else flushed
    while played.clock <= since + patience:
        assert bench.high(dut.stuck_o), played.clock
        await played.step()
    await played.step()
    assert len(played.asked) == 3 and not bench.high(dut.stuck_o)
    await again(played, given, row)


@bench.applies(lambda dut: parameter(dut, "Walkers") >= 5)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def gives_up_for_a_leaf_of_no_decision(dut):
    """Only an upset brings a leaf too many; here it is made by inputs that msn_forest never gives: the result
    leaves before its trees have ended, or there are fewer trees while they are walked. The leaf comes in the
    clock after the last one that counts, or long after: then it is late as it comes and as it is counted."""
    draw = random.Random(bench.SEED)
    lists = [tree(draw, 3, 4, 900, depth=depth, stop=0) for depth in (1, 1, 1, 1, 4)]
    given, row = small(draw, dut, lists), [5, -5, 7]
    played = await begin(dut, given, lambda number: 2)
    for kept, late in ((0, 5), (4, 2), (3, 1 + 2)):
        await played.row(0, row)
        dut.go_i.value = 1
        await played.steps(12)
        assert len(played.asked) == 5  # all roots, and no leaf is there yet
        if kept:  # into the bank that is not in use, then that is in use
            await load(dut, [(3, 0, 0, kept)])
            dut.bank_i.value = 0
        else:
            await played.free(0)
        await played.steps(80)
        assert len(played.late) == late and bench.read(dut.done_o) == bool(kept)
        played.late.clear()
        dut.bank_i.value = 0
        await load(dut, [(3, 0, 0, 5)])
        dut.bank_i.value = 1
        await again(played, given, row)
        played.asked.clear()
        assert played.late == []


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def gives_up_for_a_tag_that_waits_already(dut):
    """Two walkers with one tag would get each other's nodes. An upset says that a free tag waits for an
    answer: late when it is given to the second tree; or that one does whose answer came: late with the next
    node."""
    draw = random.Random(bench.SEED)
    given, row = small(draw, dut, 3, depth=2, stop=0), [5, -5, 7]
    for walked in (0, 1):
        played = await begin(dut, given, lambda number, walked=walked: 2 if walked else 40)
        await played.row(0, row)
        dut.go_i.value = 1
        await played.steps(walked * 12)
        dut.waiting.value = 0b10
        await played.steps(12)
        assert [clock - played.asked[1 + 3 * walked][0] for clock in played.late] == [0]
        await again(played, given, row)
        assert len(played.late) == 1


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_no_vote_of_what_cannot_be(dut):
    """Beside a whole tree one whose way goes right at one node, with each limit exactly and one beyond: a
    feature, a child, a root, a leaf. damaged_o says so for its decision until that is freed."""
    nodes, leaves, features = (parameter(dut, name) for name in ("Nodes", "Leaves", "Features"))
    whole = lambda feature, leaf: 3 << 62 | feature << 54 | leaf  # both children are leaves
    right = lambda low, feature=0: feature << 54 | low
    left = lambda feature=0: 2 << 62 | feature << 54 | (1 << 21) - 1 << 32  # goes left, to the next node
    ends = whole(0, 3)
    cases = [
        (20, {20: whole(features - 1, 3)}, True), (20, {20: whole(features, 3)}, False),
        (20, {20: whole(255, 3)}, False), (20, {20: right(21), 21: ends}, True), (20, {20: right(20)}, False),
        (20, {20: right(19), 19: ends}, False), (20, {20: right(nodes - 1), nodes - 1: ends}, True),
        (20, {20: right(nodes), nodes: ends}, False),
        (nodes - 1, {nodes - 1: ends}, True),
        (nodes, {nodes: ends}, False), (nodes - 2, {nodes - 2: left(), nodes - 1: ends}, True),
        (nodes - 1, {nodes - 1: left(), nodes: ends}, False), (20, {20: left(features), 21: ends}, False),
        (20, {20: whole(0, leaves - 1)}, True),
    ]  # fmt: skip
    classes, beyond = parameter(dut, "Classes"), [leaves, *(1 << bit | 3 for bit in range(5, 16))]
    cases += [(20, {20: whole(0, leaf)}, classes == 2) for leaf in beyond]
    cases += [
        (20, {20: right(1 << bit | 21), 21: ends}, False) for bit in range((nodes - 1).bit_length(), 32)
    ]
    draw = random.Random(bench.SEED)
    given = small(draw, dut, 2)
    played = await begin(dut, given, lambda number: 2)
    table = {}
    for leaf in (0, 3, leaves - 1):
        table[leaf] = [65535 - leaf, leaf] if classes == 2 else [7 + leaf, 100 * leaf, 9]
    votes = [(2, 0, label << 16 | leaf, value) for leaf in table for label, value in enumerate(table[leaf])]
    table |= {leaf: [65535 - leaf, leaf] for leaf in beyond}
    for number, (root, memory, good) in enumerate(cases):
        context, dut.bank_i.value = number % 2, 0
        assert await nothing_else(played, votes if number == 0 else [], root)
        dut.bank_i.value = 1
        played.memory = memory | {10: whole(0, 0)}
        await played.row(context, [1, 2, 3])
        dut.go_i.value = 1 << context
        await played.steps(70)
        assert bench.read(dut.done_o) == 1 << context
        assert bench.read(dut.damaged_o) == (0 if good else 1 << context), (root, memory)
        leaf = memory[max(memory)] & 0xFFFF
        both = [table[0], table[leaf]] if good else [table[0]]
        assert await played.votes(context) == [sum(of) for of in zip(*both)], (root, memory)
        await played.free(context)
        assert bench.read(dut.damaged_o) == 0
    count, dut.bank_i.value = len(played.asked), 0
    await load(dut, [(3, 0, 0, 0)])
    dut.bank_i.value, dut.go_i.value = 1, 1
    await played.steps(9)
    assert (bench.read(dut.done_o), len(played.asked)) == (1, count)  # no trees
    assert await played.votes(0) == [0] * classes and played.late == []


async def nothing_else(played, votes, root):
    """Load two trees, at 10 and at ``root``, then what does not exist; whether empty_o follows the number."""
    dut, trees = played.dut, parameter(played.dut, "Trees")
    told, beyond, dut.bank_i.value = [], [1 << bit for bit in range(trees.bit_length(), 32)], 1
    await load(dut, [(3, 0, 0, 11), (3, 0, 0, 0)])  # of the other bank
    dut.bank_i.value = 0
    for count in (0, 11, 2, trees + 1, *beyond):
        await load(dut, [(3, 0, 0, count)])
        dut.bank_i.value = 1
        await played.step()
        told.append(bench.read(dut.empty_o))
        dut.bank_i.value = 0
    roots = [(1, 0, 0, 10), (1, 0, 1, root)]
    await load(dut, [*votes, *roots, (1, 0, trees, 5), *((1, 0, one | 1, 7) for one in beyond)])
    return told == [1, *[0] * (3 + len(beyond))]


EVIDENCE = {
    "equivalence": {"boxes": True},
    "faults": {"inside": ["forest", "gen_engine[0].u_engine."]},
}

SPACE = lambda draw: {"Walkers": draw.randint(2, 64), "Contexts": 1 << draw.randint(1, 3), "Timeout": 200}


@pytest.mark.parametrize("classes, walkers, contexts", [(2, 16, 4), (3, 5, 2)])
def test_forest_engine(classes, walkers, contexts):
    """The smaller build has one bank, and takes two clocks for a leaf."""
    size = {"Features": 3, "Classes": classes, "Trees": 20, "Nodes": 400, "Leaves": 20}
    size |= {"Walkers": walkers, "Contexts": contexts, "Timeout": 150, "Patience": 150 + 100 * (classes - 2)}
    size |= {"Banks": 1, "Lanes": 2} if classes == 3 else {}
    bench.run("forest", "forest_engine", size)


def test_walk_by_hand():
    """Two nodes: x0 <= -3: leaf 10, else x1 <= 4: leaf 20, else 30; and one that goes back to itself."""
    lists = dict(feature=[0, 1], threshold=[-3, 4], left=[-1, -2], right=[1, -3])
    given = forest(random.Random(1), 2, 3, [lists], leaves=3)
    memory = words.pack(given).nodes
    q = np.array([[-3, 9], [-2, 4], [-2, 5], [-4, 4]])
    leaf, broken, steps = walk(memory, 0, q, 2, 3)
    assert (leaf.tolist(), broken.tolist(), steps) == ([0, 1, 2, 0], [False] * 4, 6)
    for words_, root, features, leaves in (
        (memory, 2, 2, 3),  # beyond the memory
        (memory[:1], 0, 2, 3),
        (memory, 0, 1, 3),  # a feature that does not exist
        (memory, 0, 2, 2),
        (np.array([1 << 32], np.uint64), 0, 2, 3),
    ):
        assert walk(words_, root, np.array([[2, 9]]), features, leaves)[1].tolist() == [True]


test_refuses_illegal_parameters = refusals(
    "forest_engine",
    Forest,
    {"Features": 257},
    {"FeatureBits": 23},
    {"Trees": 0},
    {"Trees": 65536},
    {"Nodes": 0},
    alone=({"Walkers": 0}, {"Walkers": 65}, {"Timeout": 67}, {"Patience": 4095}),
    **dict.fromkeys(("features", "classes", "trees", "nodes", "leaves"), 1),
)
