"""msn_classify against its model, and the model against a plain loop over frames and nodes: rows from frames
and from registers, changes of class with their times while packets wait, decisions for the reflex, every
counter; loads that have no place, that come too early, that are swapped twice, in the middle of decisions; no
forest, nodes that cannot be, a memory that does not answer, rows without room, features beyond their bits,
damaged frames. Settings of classes that do not exist, or of the reflex that is off, change all the time."""

import random
from dataclasses import dataclass
from types import SimpleNamespace

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
import members
from forest import test_sdram
from forest.trees import decide, forest, leaf, rows
from harness.refusals import refused
from meissner.forest import place, words
from meissner.twins.forest import sdram
from meissner.twins.forest.classify import Classify

NONE = 65535
SLIP = 0b101  # classes 0 and 2, and of 35 classes not 32 and 34
NAMES = {"Frames": "frames", "Channels": "channels", "Features": "features", "FeatureBits": "bits"}
NAMES |= {name: name.lower() for name in ("Classes", "Trees", "Nodes", "Leaves", "Engines", "Banks")}
SIZE = {
    "Channels": 3,
    "SampleBits": 10,
    "Features": 6,
    "FeatureBits": 8,
    "Classes": 3,
    "Trees": 6,
    "Nodes": 64,
}
SIZE |= {"Leaves": 12, "Engines": 2}
BUILDS = {
    "frames": SIZE,
    "host": SIZE | {"Frames": 0, "Engines": 1, "Banks": 1, "FeatureBits": 22, "Classes": 35},
    "two": SIZE | {"Classes": 2, "Channels": 1, "Features": 1, "SampleBits": 17, "FeatureBits": 18},
    "none": {"Forest": 0},
    "sdram": SIZE | {"Frames": 0, "Engines": 1, "Features": 5, "FeatureBits": 22, "Sdram": 1, "PowerUpUs": 2},
}


def built(dut):
    return dut.Forest.value == 1 and dut.Sdram.value == 0


def from_frames(dut):
    return built(dut) and dut.Frames.value == 1


def from_host(dut):
    return built(dut) and dut.Frames.value == 0


@dataclass
class Sizes:
    """Of the build, by the model's names."""

    def __init__(self, dut):
        self.of = {own: getattr(dut, name).value.to_unsigned() for name, own in NAMES.items()}
        self.frames = self.of.pop("frames")

    def twin(self, **settings):
        channels = self.of["channels"] if self.frames else None
        return Classify(**self.of | {"channels": channels, "slip": SLIP, "grip": True} | settings)

    def drawn(self, draw):
        of, span = self.of, 1 << self.of["bits"] - 1
        count = of["trees"] * of["engines"] // 2
        shape = {"leaves": min(9, of["leaves"]), "span": min(span - 2, 200), "depth": 3}
        chosen = [0, 1, 28, 32, 33, 34] if of["classes"] > 3 else range(of["classes"])
        while True:  # until every class is found often
            given = forest(draw, of["features"], of["classes"], count, **shape)
            if of["classes"] > 3:
                given.leaves[:] = 0
                given.leaves[:, chosen] = [leaf(draw, len(chosen)) for _ in given.leaves]
            given_rows = [[draw.randint(-200, 200) for _ in range(of["features"])] for _ in range(40)]
            labels = [decide(given, row)[1] for row in given_rows]
            if min(map(labels.count, chosen)) > (4 if len(chosen) < 4 else 0):
                return given


class Stage:
    """``told``: (time, class, class before, votes) of every change that was taken, ``decided``: slips of
    every decision for the reflex; packets are taken in a share ``rate`` of the clocks."""

    def __init__(self, dut, rate=1.0):
        self.dut, self.size, self.rate = dut, Sizes(dut), rate
        self.told, self.decided, self.draw = [], [], random.Random(bench.SEED)

    async def begin(self, **settings):
        dut = self.dut
        idle = dict.fromkeys(("now_i", "time_i", "in_data_i", "in_id_i", "in_last_i", "sdram_dq_i"), 0)
        await bench.start(dut, **idle, change_ready_i=0, cfg_i=0)
        self.registers = members.Settings(dut, "forest_cfg", **{"slip": SLIP, "grip": 1} | settings)
        dut.out_ready_i.value = 1
        cocotb.start_soon(self._watch())
        return self

    async def _watch(self):
        while True:
            self.dut.change_ready_i.value = int(self.draw.random() < self.rate)
            if self.dut.Sdram.value == 0:
                self.dut.sdram_dq_i.value = self.draw.getrandbits(16)
            await ReadOnly()
            if bench.high(self.dut.change_valid_o) and bench.high(self.dut.change_ready_i):
                found = members.of("class", bench.read(self.dut.change_o))
                self.told.append(tuple(found[name] for name in ("stamp", "label", "told", "votes")))
            if bench.high(self.dut.decided_o):
                self.decided.append(bench.read(self.dut.slips_o))
            await RisingEdge(self.dut.clk_i)

    def noise(self):
        """Slips of classes that do not exist, and of all with the reflex off; the class that is not read."""
        values, bits = self.registers.values, self.draw.getrandbits
        known = min(self.size.of["classes"], 32) if values["grip"] else 0
        slip = SLIP & (1 << known) - 1 | bits(32) >> known << known
        self.registers.put(slip=slip, select=bits(16))

    def status(self):
        return members.of("forest_status", bench.read(self.dut.status_o))

    async def pulse(self, **values):
        await self.registers.pulse(self.dut.clk_i, **values)

    async def write(self, kind, engine, address, data, clocks=3):
        """One load, with its place."""
        label = address >> 16 if kind == words.VOTE else 0
        self.registers.put(target_kind=kind, target_engine=engine, target_label=label)
        self.registers.put(address=address & 0xFFFF if kind == words.VOTE else address)
        await self.pulse(address_written=1)
        self.registers.put(high=bench.as_signed(data >> 32, 32), data=bench.as_signed(data & 0xFFFF_FFFF, 32))
        await self.pulse(data_written=1)
        await bench.clocks(self.dut, clocks)

    async def load(self, given, table=None, swap=True):
        await self.pulse(clear=1)
        table = table or words.loads(given, self.size.of["engines"])
        for row in table:
            await self.write(*row)
            while self.status()["state_waits"]:
                await RisingEdge(self.dut.clk_i)
        assert self.status()["written"] == len(table) and not self.status()["state_refused"]
        if swap:
            await self.swap()

    async def swap(self):
        await self.pulse(swap=1)
        await bench.clocks(self.dut, 2)
        while self.status()["state_swapping"]:
            await RisingEdge(self.dut.clk_i)

    async def frame(self, values, time, gaps=None, spoil=None, waits=True):
        """One frame, when the one before has been taken or, without ``waits``, as soon as it is let in;
        ``spoil``: place of a wrong id."""
        dut = self.dut
        await ReadOnly()
        while waits and bench.high(dut.busy_o):
            await RisingEdge(dut.clk_i)
            await ReadOnly()
        await RisingEdge(dut.clk_i)
        self.noise()
        dut.time_i.value = time
        for at, value in enumerate(values):
            while gaps and gaps():
                await RisingEdge(dut.clk_i)
            wrong = at == spoil
            beat = {"data": value, "id": at ^ wrong, "last": (at == len(values) - 1) != wrong}
            dut.in_valid_i.value = 1
            bench.offer(dut, beat)
            await ReadOnly()
            while not (bench.high(dut.in_ready_o)):
                assert dut.out_valid_o.value == 0
                await RisingEdge(dut.clk_i)
                await ReadOnly()
            assert dut.out_valid_o.value == 1
            await RisingEdge(dut.clk_i)
            dut.in_valid_i.value = 0

    async def row(self, values, time, start=True):
        """The features of a host's row, last one first."""
        for index, value in reversed(list(enumerate(values))):
            self.registers.put(feature=value, feature_index=bench.as_signed(index, 8))
            await self.pulse(feature_written=1)
        self.noise()
        self.dut.now_i.value = time
        if start:
            await self.pulse(start=1)

    async def decisions(self, count):
        """Until so many were made."""
        for _ in range(20_000):
            if self.status()["decisions"] == count:
                return
            await RisingEdge(self.dut.clk_i)
        raise AssertionError(f"{self.status()['decisions']} decisions, not {count}")

    def agrees(self, twin):
        """The registers with the model's."""
        status = self.status()
        names = ("label", "best", "decisions", "changes", "absent", "late", "broken")
        assert {name: status[name] for name in names} == {name: getattr(twin, name) for name in names}


def changes(given):
    """(time, class, before, votes) of [(time, Decision)]."""
    return [(time, *of.change) for time, of in given if of.change]


def frames_of(draw, channels, count, span):
    return [[draw.randint(-span, span - 1) for _ in range(channels)] for _ in range(count)]


def rows_of(size, frames):
    """The rows of ``frames``: differences in windows, held at the ends of their bits."""
    differences, window = np.diff(np.array(frames), axis=0), size.of["features"] // size.of["channels"]
    end = 1 << size.of["bits"] - 1
    count = len(differences) - window + 1
    return [np.clip(differences[n : n + window].ravel(), -end, end - 1).tolist() for n in range(count)]


@bench.applies(from_frames)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.5])
async def frames_match_the_model(dut, rate):
    """Every class, its time and votes; what the reflex gets, if it is asked for; a damaged frame begins the
    window anew; votes of each class."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED)
    twin, given = size.twin(), size.drawn(draw)
    await stage.load(given)
    for row in words.loads(given, size.of["engines"]):
        twin.load(*row)
    twin.swap()
    gaps = bench.gaps_and_stalls(rate)[0]
    x = frames_of(draw, size.of["channels"], 60, 120)
    expected, decided, made = [], [], 0
    for number, values in enumerate(x):
        if number == 40 and size.of["channels"] > 1:  # its first beat is right, so the frame is dropped
            await stage.frame(values, 1, gaps, spoil=1)
            twin.source.reset()
        time, grip = draw.getrandbits(48), int(number % 20 < 16)
        stage.registers.put(grip=grip)
        await stage.frame(values, time, gaps)
        for _, of in twin.next(np.array([values]).T):
            expected.append((time, of))
            decided += [int(of.slips)] * grip
            made += 1
            await stage.decisions(made)
            await bench.clocks(dut, 2)
    assert (
        stage.told == changes(expected) and len({label for _, label, *_ in stage.told}) == size.of["classes"]
    )
    assert stage.decided == decided and {*decided} == {0, 1}
    stage.agrees(twin)
    for label, votes in enumerate(expected[-1][1].votes.tolist()):
        stage.registers.put(select=label)
        await bench.clocks(dut, 4)
        assert stage.status()["votes"] == votes
    assert stage.status()["state_error"] == stage.status()["missed"] == 0


@bench.applies(from_host)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def rows_of_a_host_match_the_model(dut):
    """Rows one after another; a feature that is not written keeps its value, one beyond the last is ignored;
    a start while a row is sent is missed."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED)
    twin, given = size.twin(), size.drawn(draw)
    await stage.load(given)
    for row in words.loads(given, size.of["engines"]):
        twin.load(*row)
    twin.swap()
    expected, row = [], [0] * size.of["features"]
    for number in range(40):
        row = [draw.choice([value, draw.randint(-200, 200)]) for value in row]
        time = draw.getrandbits(48)
        await stage.row(row, time)
        expected += [(time, of) for of in twin.rows([row])]
        await stage.decisions(number + 1)
    await bench.clocks(dut, 5)
    assert stage.told == changes(expected) and stage.decided == [int(of.slips) for _, of in expected]
    stage.agrees(twin)
    for index in (size.of["features"], 255, *(draw.randrange(size.of["features"], 256) for _ in range(9))):
        stage.registers.put(feature=(1 << 21) - 1, feature_index=bench.as_signed(index, 8))
        await stage.pulse(feature_written=1)
    busy, decisions = size.of["features"] + 2, 40  # clocks in which a row is read and sent
    for later in range(1, busy + 3):
        missed = stage.status()["missed"]
        await stage.pulse(start=1)
        await bench.clocks(dut, later - 1)
        await stage.pulse(start=1)
        decisions += 1 + (later > busy)
        await stage.decisions(decisions)
        await bench.clocks(dut, 200)
        assert stage.status()["decisions"] == decisions
        assert stage.status()["missed"] - missed == (later <= busy), later
    assert [one.error for one in twin.rows([row] * (decisions - 40))] == [0] * (decisions - 40)
    stage.agrees(twin)


@bench.applies(built)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def without_a_forest_there_is_no_class(dut):
    stage = await Stage(dut).begin()
    size = stage.size
    for number in range(8):
        if size.frames:
            await stage.frame([number] * size.of["channels"], number)
        else:
            await stage.row([number] * size.of["features"], number)
        await bench.clocks(dut, 60)
    made = 8 - size.of["features"] // size.of["channels"] if size.frames else 8
    status = stage.status()
    assert (status["decisions"], status["absent"], status["label"], status["state_error"]) == (
        made,
        made,
        NONE,
        1,
    )
    assert not stage.told and not stage.decided and not status["state_loaded"]
    assert (status["late"], status["broken"], status["changes"], status["missed"]) == (0, 0, 0, 0)


@bench.applies(built)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_load_without_a_place_is_refused(dut):
    """Each limit exactly and one beyond; then nothing is swapped until `clear`; a swap that comes twice, or
    without a write, swaps nothing."""
    stage = await Stage(dut).begin()
    of, ends = stage.size.of, []
    table = 0 if of["classes"] == 2 else of["leaves"]
    ends += [
        ((0, 0, of["nodes"] - 1, 5), (0, 0, of["nodes"], 5)),
        ((0, of["engines"] - 1, 0, 5), (0, of["engines"], 0, 5)),
    ]
    ends += [
        ((1, 0, of["trees"] - 1, 5), (1, 0, of["trees"], 5)),
        ((1, of["engines"] - 1, 0, 5), (1, of["engines"], 0, 5)),
    ]
    ends += [((3, 0, 0, of["trees"]), (3, 0, 0, of["trees"] + 1)), ((3, 0, 9, 1), (3, of["engines"], 0, 1))]
    if table:
        ends += [
            ((2, 63, table - 1, 1), (2, 63, table, 1)),
            ((2, 0, of["classes"] - 1 << 16, 1), (2, 0, of["classes"] << 16, 1)),
        ]
    else:
        ends += [((3, 0, 0, 1), (2, 0, 0, 1))]
    for inside, outside in ends:
        await stage.pulse(clear=1)
        await stage.write(*inside)
        await bench.clocks(dut, 4)
        status = stage.status()
        assert (status["written"], status["state_refused"], status["state_waits"]) == (1, 0, 0), inside
        await stage.write(*outside)
        status = stage.status()
        assert (status["written"], status["state_refused"]) == (1, 1), outside
        await stage.swap()
        assert stage.status()["state_loaded"] == 0
    draw = random.Random(2)
    for number in range(40):  # far beyond
        await stage.pulse(clear=1)
        put = {"target_kind": number % 3, "target_label": draw.getrandbits(16)}
        put |= {"target_engine": draw.getrandbits(6), "address": draw.randrange(of["nodes"], 1 << 22)}
        stage.registers.put(**put)
        await stage.pulse(address_written=1)
        stage.registers.put(data=draw.getrandbits(32), high=draw.getrandbits(32))
        await stage.pulse(data_written=1)
        await bench.clocks(dut, 4)
        assert (stage.status()["written"], stage.status()["state_refused"]) == (0, 1), put
    await stage.pulse(clear=1)
    await stage.swap()
    assert stage.status()["state_loaded"] == 0
    given = stage.size.drawn(draw)
    await stage.load(given)
    assert stage.status()["state_loaded"] == 1 and stage.status()["written"] == 0
    bank = bench.read(dut.gen_forest.gen_block_ram.u_forest.bank)
    await stage.swap()
    assert bench.read(dut.gen_forest.gen_block_ram.u_forest.bank) == bank
    # In the clock after a write the next one comes too early.
    await stage.pulse(clear=1)
    stage.registers.put(target_kind=3, target_engine=0, data=1)
    await stage.pulse(data_written=1)
    await stage.pulse(data_written=1)
    await bench.clocks(dut, 6)
    assert stage.status()["state_refused"] == 1 and stage.status()["written"] == 1
    await stage.pulse(clear=1)  # and so does an address
    await stage.pulse(data_written=1)
    await stage.pulse(address_written=1)
    await bench.clocks(dut, 6)
    assert stage.status()["state_refused"] == 1 and stage.status()["written"] == 1


@bench.applies(built)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_forest_is_loaded_while_another_decides(dut):
    """Rows all the time while three forests are loaded in turn: every decision is by the one before the swap
    or the one after it; with one bank there is none in between."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED + 3)
    forests = [size.drawn(draw) for _ in range(3)]
    rows, got, ending = [], [], False
    value = [0] * (size.of["channels"] if size.frames else size.of["features"])
    await stage.load(forests[0])

    async def feed():
        number = 0
        while not ending:
            fresh = [draw.randint(-120, 119) for _ in value]
            if size.frames:
                await stage.frame(fresh, number)
            else:
                await stage.row(fresh, number)
            rows.append(fresh)
            number += 1
            for _ in range(200):
                await RisingEdge(dut.clk_i)
                now = stage.status()
                if now["decisions"] > len(got):
                    got.append((now["label"], now["best"]) if not now["state_error"] else None)
                    break

    cocotb.start_soon(feed())
    await bench.clocks(dut, 600)
    for given in forests[1:]:
        await stage.load(given)
        await bench.clocks(dut, 500)
    ending = True
    await bench.clocks(dut, 400)
    q = rows_of(size, rows) if size.frames else rows
    answers = [answers_of(given, q) for given in forests]
    stage_of, switched = 0, set()
    for at, found in enumerate(got):
        if found is None:
            assert size.of["banks"] == 1
            continue
        while found != answers[stage_of][at]:
            stage_of += 1
            switched.add(at)
            assert stage_of < 3, (at, found, [every[at] for every in answers])
    assert stage_of == 2 and len(got) > 20 and (None in got) == (size.of["banks"] == 1)


@bench.applies(lambda dut: from_frames(dut) and dut.Banks.value.to_unsigned() == 2)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_write_waits_for_a_swap(dut):
    """A swap waits for the decision under way, and the write after it for the swap: it goes to the bank that
    is left. Here it says that this has no trees, as the next swap shows."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED + 9)
    for swap in (True, False):
        await stage.load(size.drawn(draw), swap=swap)
    for number in range(size.of["features"] // size.of["channels"] + 1):
        await stage.frame([number] * size.of["channels"], number)
    await bench.clocks(dut, 14)
    stage.registers.put(target_kind=3, target_engine=0, data=0, high=0)
    await stage.pulse(swap=1)
    await stage.pulse(data_written=1)
    clocks = 0
    while (status := stage.status())["state_swapping"]:
        assert status["written"] == 0
        await RisingEdge(dut.clk_i)
        clocks += 1
    assert clocks > 5
    await bench.clocks(dut, 3)
    assert (stage.status()["written"], stage.status()["state_waits"]) == (1, 0)
    for engine in range(1, size.of["engines"]):
        await stage.write(3, engine, 0, 0)
    await stage.swap()
    await stage.frame([9] * size.of["channels"], 9)
    await stage.decisions(2)
    assert (stage.status()["absent"], stage.status()["state_error"]) == (1, 1)


def answers_of(given, q):
    """(class, its votes) of rows."""
    return [(label, votes[label]) for votes, label, _ in (decide(given, row) for row in q)]


@bench.applies(from_frames)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_row_without_room_is_dropped_whole(dut):
    """Frames as fast as they are let in: what was decided are some of the rows in their order, each with its
    own time, and `missed` counts the others; then a row alone is decided again."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED + 7)
    given, got = size.drawn(draw), []
    await stage.load(given)

    async def watch():
        while True:
            await RisingEdge(dut.clk_i)
            if stage.status()["decisions"] > len(got):
                got.append((stage.status()["label"], stage.status()["best"]))

    watching = cocotb.start_soon(watch())
    x = frames_of(draw, size.of["channels"], 40, 120)
    for number, values in enumerate(x):
        if number == 39:
            await bench.clocks(dut, 400)
        await stage.frame(values, number)
    await bench.clocks(dut, 400)
    watching.cancel()
    answers, at = answers_of(given, rows_of(size, x)), 0
    for found in got:
        at = answers.index(found, at) + 1
    assert stage.status()["missed"] == len(answers) - len(got) > 5 and got[-1] == answers[-1]
    window = size.of["features"] // size.of["channels"]
    assert [(label, votes) for _, label, _, votes in stage.told] == [
        answers[time - window] for time, *_ in stage.told
    ]
    assert len(stage.told) == stage.status()["changes"] > 1


@bench.applies(from_frames)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def beats_wait_while_a_row_is_taken(dut):
    """Frames of one time, offered without a look at busy_o."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED + 8)
    given, x = size.drawn(draw), frames_of(draw, size.of["channels"], 30, 120)
    await stage.load(given)
    for values in x:
        await stage.frame(values, 7, waits=False)
    await bench.clocks(dut, 400)
    answers, status = answers_of(given, rows_of(size, x)), stage.status()
    assert status["decisions"] + status["missed"] == len(answers) and status["decisions"] > 1
    assert stage.told and all(time == 7 and (label, votes) in answers for time, label, _, votes in stage.told)


@bench.applies(built)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_node_that_cannot_be_is_reported(dut):
    """One tree of one node, whose feature does not exist."""
    stage = await Stage(dut).begin()
    of = stage.size.of
    table = [(0, 0, 0, 3 << 62 | of["features"] << 54), (1, 0, 0, 0), (3, 0, 0, 1)]
    for row in [*table, *((3, engine, 0, 0) for engine in range(1, of["engines"]))]:
        await stage.write(*row)
    await stage.swap()
    if stage.size.frames:
        for number in range(of["features"] // of["channels"] + 1):
            await stage.frame([number] * of["channels"], number)
    else:
        await stage.row([1] * of["features"], 1)
    await stage.decisions(1)
    status = stage.status()
    assert (status["broken"], status["state_error"], status["label"]) == (1, 4, NONE)
    assert (status["absent"], status["late"], status["changes"]) == (0, 0, 0)
    assert not stage.told and not stage.decided


@bench.applies(from_frames)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def changes_that_wait_are_merged(dut):
    """Nothing takes a packet while the class changes; then one packet tells the class now, from the one that
    the host has, or none if it is that again."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED)
    twin, given = size.twin(), size.drawn(draw)
    await stage.load(given)
    for row in words.loads(given, size.of["engines"]):
        twin.load(*row)
    twin.swap()
    host, now, since, made, expected = NONE, NONE, 0, 0, []
    stage.rate = 0.0
    for number, values in enumerate(frames_of(draw, size.of["channels"], 90, 120)):
        await stage.frame(values, number)
        for _, of in twin.next(np.array([values]).T):
            made += 1
            await stage.decisions(made)
            since = number if of.label != now else since
            now = of.label
        if number % 4 == 3:
            stage.rate = 1.0
            await bench.clocks(dut, 4)
            stage.rate = 0.0
            if now != host:
                expected.append((since, now, host))
                host = now
        await bench.clocks(dut, 4)
    assert [one[:3] for one in stage.told] == expected and len(expected) > 2
    assert stage.status()["changes"] == twin.changes > len(expected)


@bench.applies(lambda dut: built(dut) and dut.Features.value.to_unsigned() > 1 and bench.whole(dut))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_memory_that_does_not_answer_is_reported(dut):
    """The engines' memories are silent from a node on: the decision is late, the class stays; they answer
    again, and so does the forest after a reset."""
    stage = await Stage(dut).begin()
    size, draw = stage.size, random.Random(bench.SEED + 5)
    given = size.drawn(draw)
    await stage.load(given)
    engines = dut.gen_forest.gen_block_ram.u_forest.gen_engine
    silent = True

    async def hush():
        while silent:
            await FallingEdge(dut.clk_i)
            for engine in range(size.of["engines"]):
                engines[engine].gen_memory.u_memory.rsp_valid_o.value = 0

    cocotb.start_soon(hush())
    count = size.of["features"] // size.of["channels"] + 1
    for number in range(count if size.frames else 1):
        if size.frames:
            await stage.frame([number] * size.of["channels"], number)
        else:
            await stage.row([1] * size.of["features"], number)
    await stage.decisions(1)
    status = stage.status()
    assert (status["late"], status["state_error"], status["label"]) == (1, 2, NONE)
    assert not stage.told and not stage.decided
    silent = False
    await bench.clocks(dut, 2)
    await bench.reset(dut)
    await bench.clocks(dut, 2)
    assert stage.status()["late"] == 0


@bench.applies(from_frames)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_feature_is_held_at_the_ends_of_its_bits(dut):
    """One node at the greatest threshold: the greatest feature goes right, one below left; and the least."""
    stage = await Stage(dut).begin()
    of = stage.size.of
    top = (1 << of["bits"] - 1) - 1
    most = (1 << dut.SampleBits.value.to_unsigned()) - 1  # the largest step of a sample
    cases = [(top - 1, top - 1, 0), (top - 1, top, 1), (-top - 1, -top, 1)]
    if most > top:
        cases += [(-top - 1, -top - 1, 0), (top - 1, most, 1), (-top - 1, -most, 0)]
    for threshold, step, right in cases:
        tree = {"feature": [of["features"] - 1], "threshold": [threshold], "left": [-1], "right": [-2]}
        given = forest(random.Random(1), of["features"], of["classes"], [tree], leaves=2)
        given.leaves[:] = np.eye(of["classes"], dtype=int)[:2] * 65535
        await stage.load(given)
        window, low = of["features"] // of["channels"], -(abs(step) + 1 >> 1)
        for number in range(window + 1):  # the last frame has the step in its last channel
            high = (number == window) == (step > 0)
            await stage.frame([0] * (of["channels"] - 1) + [low + abs(step) if high else low], number)
            await bench.clocks(dut, 100)
        assert stage.status()["label"] == right, (threshold, step, stage.status())


class Member:
    """Bits of a packed struct at a port, for the part's model."""

    def __init__(self, port, low, bits):
        self.port, self.low, self.bits = port, low, bits

    @property
    def value(self):
        return bench.read(self.port) >> self.low & (1 << self.bits) - 1


@bench.applies(lambda dut: dut.Sdram.value == 1, long=True)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def nodes_lie_in_an_sdram(dut):
    """Two forests at the pins of the part's model, one after the other, each loaded by its writes."""
    stage, draw = await Stage(dut).begin(), random.Random(bench.SEED)
    names = {name: getattr(dut, name) for name in ("sdram_dq_i", "clk_i", "PowerUpUs", "ClkKhz")}
    lines = {f"sdram_{name}_o": Member(dut.sdram_o, *at) for name, at in members.PLACES["sdram"].items()}
    part = test_sdram.part(SimpleNamespace(**names, **lines))
    made = writes = 0
    for _ in range(2):
        given = stage.size.drawn(draw)
        await stage.load(given, place.loads(place.place(given, room=sdram.BANK_WORDS // 2)))
        writes += sum(len(tree.feature) or 1 for tree in given.trees)
        assert part.counts["WRITE"] == writes
        for row in rows(draw, given, 12, 1 << 21):
            await stage.row(row, made)
            made += 1
            await stage.decisions(made)
            votes, label, _ = decide(given, row)
            assert (stage.status()["label"], stage.status()["best"]) == (label, votes[label])
    assert stage.status()["state_error"] == stage.status()["missed"] == 0


@bench.applies(lambda dut: dut.Forest.value == 0)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def without_the_feature_samples_pass(dut):
    await bench.start(
        dut, cfg_i=0, now_i=0, time_i=0, in_data_i=5, in_id_i=0, in_last_i=0, change_ready_i=1, sdram_dq_i=0
    )
    for valid, ready in ((0, 0), (0, 1), (1, 0), (1, 1)):
        dut.in_valid_i.value, dut.out_ready_i.value, dut.in_id_i.value = valid, ready, 15 * ready
        await ReadOnly()
        assert (dut.out_valid_o.value, dut.in_ready_o.value, dut.busy_o.value) == (valid, ready, 0)
        assert (bench.read(dut.status_o), dut.change_valid_o.value, dut.decided_o.value) == (0, 0, 0)
        await RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {"boxes": True},
    "mutants": {"sets": [0, 2], "unsolved": True},
    "faults": {
        "settle": 9,  # a window, and the rows of msn_forest
        # Changes that wait are merged. The bank in use and the forest in it are kept.
        "driver": {"ready": "change_", "quiet": "change_", "kept": "bank swap"},
        "kept_inside": {"gen_forest.gen_block_ram.u_forest": "forest"},
    },
}


@pytest.mark.parametrize(
    "name", [name if name != "sdram" else pytest.param(name, marks=pytest.mark.long) for name in BUILDS]
)
def test_classify(name):
    inside = ("msn_forest.bank", "msn_forest_memory.rsp_valid_o")
    bench.run("forest", "classify", BUILDS[name], inside=inside)


def test_the_model_decides_as_a_loop_over_frames():
    """Differences, a window, the votes of every tree; before the first window nothing; a class of slip."""
    draw = random.Random(3)
    size = {"features": 6, "classes": 3, "trees": 5, "nodes": 64, "leaves": 9}
    twin = Classify(3, bits=8, slip=0b110, grip=True, **size)
    given = forest(draw, 6, 3, 5, leaves=9, span=60, depth=3)
    x = np.array([[draw.randint(-120, 119) for _ in range(3)] for _ in range(40)])
    assert all(of.error == 1 and of.slips is None for _, of in twin.next(x[:4].T)) and twin.absent == 2
    twin.reset()
    for row in words.loads(given, 1):
        twin.load(*row)
    twin.swap()
    found = twin.next(x[:7].T) + [(7 + at, of) for at, of in twin.next(x[7:].T)]
    told, expected = NONE, []
    for n in range(2, 40):
        row = [int(min(max(x[k, c] - x[k - 1, c], -128), 127)) for k in (n - 1, n) for c in range(3)]
        votes, label, _ = decide(given, row)
        expected.append(
            (n, label, votes, (label, told, votes[label]) if label != told else None, label in (1, 2))
        )
        told = label
    assert [
        (n, of.label, of.votes.tolist(), of.change and tuple(of.change), of.slips) for n, of in found
    ] == expected
    assert (twin.decisions, twin.changes) == (38, sum(one[3] is not None for one in expected))


def test_the_model_holds_features_at_their_ends():
    """Of 4 bits: 7 and all above go right of a threshold of 6, -8 and all below left of one of -8."""
    for threshold, steps in ((6, {6: 0, 7: 1, 8: 1, 99: 1}), (-8, {-7: 1, -8: 0, -9: 0, -99: 0})):
        twin = Classify(1, features=1, bits=4, classes=2, trees=1, nodes=1, leaves=1)
        tree = {"feature": [0], "threshold": [threshold], "left": [-1], "right": [-2]}
        given = forest(random.Random(1), 1, 2, [tree], leaves=2)
        given.leaves[:] = [[65535, 0], [0, 65535]]
        for row in words.loads(given, 1):
            twin.load(*row)
        twin.swap()
        for step, label in steps.items():
            twin.source.reset()
            [(_, of)] = twin.next([[0, step]])
            assert (of.label, of.error) == (label, 0), (threshold, step)


def test_the_model_swaps_whole_loads_only():
    twin = Classify(1, features=1, bits=4, classes=2, trees=1, nodes=2, leaves=1)
    for loads, loaded in (([(0, 0, 2, 5)], False), ([(0, 0, 1, 5), (1, 0, 1, 0)], False), ([], False)):
        twin.clear()
        for row in loads:
            twin.load(*row)
        twin.swap()
        assert twin.loaded == loaded
    twin.clear()
    twin.load(3, 0, 0, 1)
    twin.swap()
    assert twin.loaded and twin.written == 0 and twin.forest.bank == 1
    twin.swap()  # nothing was written since
    assert twin.forest.bank == 1


def test_the_model_refuses_what_cannot_be():
    refused(
        Classify,
        *({"features": 0}, {"features": 257}, {"features": 7}, {"classes": 0}, {"classes": 65536}),
        **{"channels": 3, "features": 6, "classes": 2, "trees": 1, "nodes": 1, "leaves": 1},
    )
    for wrong in (
        {"Features": 257},
        {"Features": 10},
        {"Classes": 65536},
        {"Suits": 0},
        {"Sdram": 1, "Engines": 2},
    ):
        said = bench.refuses("classify", wrong)
        assert next(iter(wrong)) in said or "Registers" in said
