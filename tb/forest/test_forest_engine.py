"""msn_forest_engine by itself, with the memory played by the test: each request and each answer clock by
clock. What a forest decides is tested with the whole (test_forest.py); here are the clocks of a node, of a
tree and of an answer that is late, flushes in every clock of a walk, and answers after a flush."""

import random

import cocotb
import numpy as np
import pytest

import bench
from forest.trees import decide, forest, rows, tree
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

    def __init__(self, dut, memory, answers):
        self.dut, self.memory, self.answers = dut, memory, answers
        self.pending, self.asked, self.clock = [], [], 0
        self.late = []

    async def step(self):
        dut = self.dut
        due = [entry for entry in self.pending if entry[0] == self.clock][:1]
        if not due:  # what could not be answered in its clock, as another one was
            due = [entry for entry in self.pending if entry[0] < self.clock][:1]
        dut.rsp_valid_i.value = len(due)
        dut.rsp_tag_i.value = due[0][1] if due else 0
        dut.rsp_data_i.value = int(self.memory[due[0][2]]) if due else 0
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
            await self.step()
        self.dut.row_write_i.value = 0

    async def votes(self, context):
        found = []
        for label in range(parameter(self.dut, "Classes")):
            self.dut.read_context_i.value, self.dut.read_class_i.value = context, label
            await self.steps(2)
            found.append(bench.read(self.dut.read_votes_o))
        return found

    async def free(self, context):
        self.dut.go_i.value = 0
        self.dut.free_i.value = 1 << context
        await self.step()
        self.dut.free_i.value = 0
        await self.step()


async def begin(dut, given, answers):
    """The engine with the forest ``given`` in use, in bank 1."""
    await bench.start(dut, **dict.fromkeys(IDLE.split(), 0))
    memory = words.pack(given)
    for kind, port in ((1, dut.load_root_i), (3, dut.load_count_i), (2, dut.load_leaf_i)):
        port.value = 1
        for kind_, _, address, data in words.loads(given, 1):
            if kind_ == kind:
                dut.load_address_i.value, dut.load_data_i.value = address, data
                await bench.RisingEdge(dut.clk_i)
        port.value = 0
    dut.bank_i.value = dut.req_ready_i.value = dut.read_i.value = 1
    dut.read_sum_i.value = 0
    played = Played(dut, memory.nodes, answers)
    await played.steps(parameter(dut, "Walkers") + 4)
    return played


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
        done = bench.read(dut.done_o)
        dut.flush_i.value = 1
        await played.step()
        dut.flush_i.value = 0
        await played.free(0)
        count = len(played.asked)
        dut.go_i.value = 0b10
        await played.row(1, row)
        for _ in range(400):
            await played.step()
            if bench.read(dut.done_o) == 0b10:
                break
        assert bench.read(dut.done_o) == 0b10 and bench.read(dut.stuck_o) == 0, (at, done)
        assert await played.votes(1) == decide(given, row)[0]
        assert len(played.asked) - count in (decide(given, row)[2], decide(given, row)[2] + 1)
        await played.free(1)


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


EVIDENCE = {}

SPACE = lambda draw: {"Walkers": draw.randint(2, 64), "Contexts": 1 << draw.randint(1, 3), "Timeout": 200}


@pytest.mark.parametrize("classes, walkers, contexts", [(2, 16, 4), (3, 5, 2)])
def test_forest_engine(classes, walkers, contexts):
    size = {"Features": 3, "Classes": classes, "Trees": 20, "Nodes": 400, "Leaves": 20}
    size |= {"Walkers": walkers, "Contexts": contexts, "Timeout": 150}
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
    alone=({"Walkers": 0}, {"Walkers": 65}, {"Timeout": 67}),
    **dict.fromkeys(("features", "classes", "trees", "nodes", "leaves"), 1),
)
