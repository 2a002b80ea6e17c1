"""msn_packet against its model: every kind of packet, together and alone, on a fast line and a slow one; slip
events never lost, in order, with everything else at full load; other dropped packets are counted, and never
cut; images complete, in order, each with its own time, in chunks that divide them evenly or not; priorities;
an event's latency; a build of each kind alone; reset in mid-packet."""

import itertools
import random
import re

import cocotb
import numpy as np
import pytest

import bench
import members
from meissner.builds import toolchain
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder
from meissner.twins.slip.slip_changes import Change

INPUTS = (
    *("slip_valid", "slip", "slip_time", "cop_valid", "cop", "cop_time", "health_valid", "health"),
    *("answer_valid", "answer_data", "statistics", "now", "states", "states_state"),
    *("image_valid", "image_data", "image_last", "image_time", "class_valid", "class"),
)


CHECK = 3  # the sender's state that sends the checksum
FLIP = itertools.cycle([0, 0xFFFFFFFF])  # each counter is inverted from one test to the next


class Source:
    """The source of one kind of packet: drives its ports at its rate and records what was taken."""

    def __init__(self, dut, rng, name, rate):
        self.dut, self.rng, self.name, self.rate = dut, rng, name, rate
        self.sent, self.offer = [], None
        self.port = name if hasattr(dut, f"{name}_valid_i") else "decision"  # of msn_link

    def bits(self, *widths):
        return [int(self.rng.integers(0, 1 << width)) for width in widths]

    def set(self, **values):
        for name, value in values.items():
            getattr(self.dut, f"{self.port}_{name}_i").value = value

    def put(self, kind, **values):
        """The struct of ``kind``; its members are unsigned."""
        getattr(self.dut, f"{self.port}_i").value = members.word(kind, values)

    def time(self):
        """Draw and put the time of a result; msn_link has one for all."""
        if hasattr(self.dut, "time_i"):
            return bench.read(self.dut.time_i)
        (time,) = self.bits(48)
        self.set(time=time)
        return time

    def before(self, now):
        if self.offer is None and self.rng.random() < self.rate:
            self.offer = self.draw(now)
        self.set(valid=int(self.offer is not None))

    def after(self):
        if self.offer is not None and self.ready():
            self.sent.append(self.offer)
            self.offer = None

    def ready(self):
        return True


class Slip(Source):
    """Starts of a slip and, of msn_packet, other changes; of msn_link starts alone, so that none is late."""

    def draw(self, now):
        channel, p2p, last = self.bits(16, 24, 1)
        state = int(self.rng.integers(0, 5))
        if self.port == "decision":
            self.put("decision", raised=1, last=last, id=channel, p2p=p2p, state=state)
            return self.time(), p.SLIP, p.slip_event(channel, p2p, state)
        start, late = self.bits(1, 1)
        change = Change(bool(start), late, int(self.rng.integers(0, 5)), state)
        self.put("change", id=channel, p2p=p2p, **change._asdict())
        return self.time(), *p.change_of(channel, p2p, change)

    def ready(self):
        return getattr(self.dut, f"{self.port}_ready_o").value == 1


class Cop(Source):
    def draw(self, now):
        x, y, load, pressed = self.bits(24, 24, 40, 1)
        self.put("cop", x=x, y=y, load=load, pressed=pressed)
        x, y = (bench.as_signed(v, 24) for v in (x, y))
        return self.time(), p.cop_frame(x, y, load, pressed)


class Health(Source):
    def draw(self, now):
        taxel, faults = self.bits(24, 8)
        self.put("health", id=taxel, faults=faults)
        return [now, p.health(taxel, faults)]

    def ready(self):
        self.offer[0] = bench.read(
            getattr(self.dut, "now_i" if hasattr(self.dut, "now_i") else "now_o")
        )  # a report has the time at which it is taken
        return self.dut.health_ready_o.value == 1


class Classified(Source):
    def draw(self, now):
        label, told, votes, stamp = self.bits(16, 16, 32, 48)
        self.put("class", label=label, told=told, votes=votes, stamp=stamp)
        return stamp, p.class_change(label, told, votes)

    def ready(self):
        return self.dut.class_ready_o.value == 1


class Answer(Source):
    def draw(self, now):
        low, high = self.bits(32, 32)
        data = high << 32 | low
        self.set(data=data)
        return None, data.to_bytes(8, "little")

    def ready(self):
        return self.dut.answer_ready_o.value == 1


class Image(Source):
    """``rate``: of taxels; complete images, starting at random."""

    def __init__(self, dut, rng, rate, taxels):
        super().__init__(dut, rng, "image", rate)
        self.taxels, self.images, self.left = taxels, [], []

    def draw(self, now):
        if not self.left:
            self.left = self.bits(*[16] * self.taxels)
            self.images.append((self.time(), list(self.left)))
        value = self.left.pop(0)
        self.set(data=value, last=int(not self.left))
        return value


class Bench:
    """All sources and the output bytes; also for msn_link, which has no out_begin_o."""

    def __init__(self, dut, ready, sources):
        self.dut, self.ready, self.sources = dut, ready, sources
        self.clock, self.bytes, self.packets, self.ends = 0, bytearray(), [], []
        self.epochs, self.epoch = random.Random(bench.SEED), 0  # the time jumps, so that all its bits change

    async def run(self, clocks, quiet=False):
        dut = self.dut
        for _ in range(clocks):
            if self.clock % 64 == 0:
                self.epoch = self.epochs.getrandbits(48)
            if hasattr(dut, "now_i"):  # msn_link counts itself
                dut.now_i.value = (self.clock + self.epoch) % (1 << 48)
            for source in self.sources:
                if quiet:
                    source.rate = 0
                source.before(self.clock)
            ready = int(self.ready())
            dut.out_ready_i.value = ready
            await bench.ReadOnly()
            if dut.out_valid_o.value == 1:
                if hasattr(dut, "out_begin_o"):
                    assert dut.out_begin_o.value == 1 or dut.out_last_o.value == 1
                if ready:
                    self.bytes.append(bench.read(dut.out_data_o))
                    if dut.out_last_o.value == 1:
                        self.packets.append(bytes(self.bytes))
                        self.ends.append(self.clock)
                        self.bytes.clear()
            for source in self.sources:
                source.after()
            await bench.RisingEdge(dut.clk_i)
            self.clock += 1

    def decoded(self):
        """The packets, through the host's decoder."""
        decoder = Decoder()
        got = decoder.next(b"".join(map(encode, self.packets)))
        assert decoder.damaged == 0
        assert self.packets == [p.packet(q.kind, k, q.time, q.payload) for k, q in enumerate(got)]
        return got


def parameters(dut):
    names = (
        "SlipDepth",
        "Cop",
        "Classes",
        "Health",
        "Answers",
        "Statistics",
        "StatisticBits",
        "Taxels",
        "Chunk",
    )
    return {name: getattr(dut, name).value.to_unsigned() if hasattr(dut, name) else 0 for name in names}


async def begin(dut, rng, rates, ready=lambda: True, **inputs):
    """A bench with those sources that this build has, at ``rates`` by name. ``inputs``: values of all other
    inputs."""
    build = parameters(dut)
    sources = {}
    if build["SlipDepth"]:
        sources["slip"] = Slip(dut, rng, "slip", rates.get("slip", 0))
    kinds = {"Cop": ("cop", Cop), "Classes": ("class", Classified), "Health": ("health", Health)}
    for name, (port, kind) in (kinds | {"Answers": ("answer", Answer)}).items():
        if build[name]:
            sources[port] = kind(dut, rng, port, rates.get(port, 0))
    if build["Taxels"]:
        sources["image"] = Image(dut, rng, rates.get("image", 0), build["Taxels"])
    await bench.start(dut, **{f"{name}_i": 0 for name in INPUTS if hasattr(dut, f"{name}_i")}, **inputs)
    if not hasattr(dut, "statistics_i"):  # of msn_link: its own test gives them
        return Bench(dut, ready, list(sources.values())), sources, None
    counters = [int(rng.integers(0, 1 << 32)) ^ next(FLIP) for _ in range(max(1, build["Statistics"]) | 1)]
    counters = counters[: max(1, build["Statistics"])]
    dut.statistics_i.value = sum(value << (32 * place) for place, value in enumerate(counters))
    return Bench(dut, ready, list(sources.values())), sources, counters


def subsequence(part, whole):
    rest = iter(whole)
    return all(any(item == other for other in rest) for item in part)


def dropped(dut, kind):
    """How many packets of this kind were replaced before they were sent."""
    if hasattr(dut, "status_o"):  # msn_link
        return members.of("link_status", bench.read(dut.status_o))[f"{kind}_dropped"]
    return bench.read(getattr(dut, f"{kind}_dropped_o"))


def check(dut, got, sources, counters, build):
    """Check all output packets ``got`` against everything that went in."""
    by_kind = {}
    for q in got:
        by_kind.setdefault(q.kind, []).append(q)
    assert set(by_kind) <= set(p.KNOWN) - {p.STATES}
    pairs = {kind: [(q.time, q.payload) for q in packets] for kind, packets in by_kind.items()}
    if "slip" in sources:
        mine = [(q.time, q.kind, q.payload) for q in got if q.kind in (p.SLIP, p.CHANGE)]
        assert mine == sources["slip"].sent
    if "answer" in sources:
        assert [payload for _, payload in pairs.get(p.ANSWER, [])] == [d for _, d in sources["answer"].sent]
    if "health" in sources:
        assert pairs.get(p.HEALTH, []) == [tuple(report) for report in sources["health"].sent]
    if "class" in sources:
        assert pairs.get(p.CLASS, []) == sources["class"].sent
    if "cop" in sources:
        mine, sent = pairs.get(p.COP, []), sources["cop"].sent
        assert subsequence(mine, sent)
        assert len(mine) + dropped(dut, "cop") == len(sent)
        assert mine[-1:] == sent[-1:]  # the newest is always sent
    for place, q in enumerate(by_kind.get(p.STATISTIC, [])):
        index = place % build["Statistics"]
        assert q.payload == p.statistic(index, counters[index])
    if "image" in sources:
        check_images(dut, sources["image"], by_kind.get(p.IMAGE, []), build)
    return by_kind


def check_images(dut, source, chunks, build):
    sent = [image for image in source.images if not (source.left and image is source.images[-1])]
    starts = [place for place, q in enumerate(chunks) if q.fields["first"] == 0]
    images = []
    for number, (start, end) in enumerate(zip(starts, [*starts[1:], len(chunks)])):
        taxels = [taxel for q in chunks[start:end] for taxel in q.fields["taxels"]]
        assert len(taxels) == build["Taxels"]
        assert [q.payload for q in chunks[start:end]] == p.image_chunks(number, taxels, build["Chunk"])
        assert len({q.time for q in chunks[start:end]}) == 1
        images.append((chunks[start].time, taxels))
    assert starts[:1] == [0][: len(chunks)]  # no chunk precedes the first image's start
    assert subsequence(images, sent)
    assert len(images) + dropped(dut, "image") == len(sent)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "packets_o", "cop_dropped_o", "image_dropped_o", most=3, wraps=False)


@bench.applies(lambda dut: parameters(dut)["Cop"] and bench.whole(dut) and not bench.is_top(dut))
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def counters_count_from_any_value(dut):
    """A packet that is begun, and a centre of pressure that replaces another."""
    test, sources, _ = await begin(dut, np.random.default_rng(bench.SEED), {})
    for start in bench.carries(dut.packets_o):
        dut.packets_o.value = dut.cop_dropped_o.value = start
        sent, packets = len(sources["cop"].sent), len(test.packets)
        sources["cop"].rate = 1
        await test.run(6)
        await test.run(500, quiet=True)
        while dut.out_begin_o.value == 1:
            await test.run(1)
        told = [packet[0] for packet in test.packets[packets:]]
        left = len(sources["cop"].sent) - sent - told.count(p.COP)
        assert left > 0 and p.COP in told
        assert bench.read(dut.packets_o) == (start + len(told)) % 2**32
        assert bench.read(dut.cop_dropped_o) == (start + left) % 2**32


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(load=["light", "full", "slow line"])
async def everything_at_once(dut, load):
    rng = np.random.default_rng(bench.SEED)
    rates = {
        "light": {"slip": 0.001, "cop": 0.001, "health": 0.0005, "answer": 0.0005, "image": 0.05},
        "full": {"slip": 0.004, "cop": 0.05, "health": 0.01, "answer": 0.002, "image": 1.0},
        "slow line": {"slip": 0.002, "cop": 0.01, "health": 0.01, "answer": 0.01, "image": 0.9},
    }[load]
    rates["class"] = rates["health"]
    draw = np.random.default_rng(7)
    rate = 0.05 if load == "slow line" else 1.0
    test, sources, counters = await begin(dut, rng, rates, lambda: draw.random() < rate)
    await test.run(5_000)
    for source in sources.values():
        source.rate = 0
    test.ready = lambda: True
    await test.run(4_000, quiet=True)
    while test.bytes or dut.out_begin_o.value == 1:  # a statistic is still being sent
        await test.run(1, quiet=True)
    build = parameters(dut)
    check(dut, test.decoded(), sources, counters, build)
    assert bench.read(dut.packets_o) == len(test.packets)
    if load != "light" and build["Taxels"] and build["SlipDepth"]:
        assert bench.read(dut.image_dropped_o) > 0
        assert len(sources["slip"].sent) > 3


@bench.applies(lambda dut: parameters(dut)["SlipDepth"])
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def events_go_first_and_soon(dut):
    """If nothing is being sent, the frame opens after 3 clocks and the first byte is valid after 8."""
    rng = np.random.default_rng(bench.SEED)
    test, sources, _ = await begin(dut, rng, {})
    await test.run(5)
    sources["slip"].rate = 1
    await test.run(1)
    sources["slip"].rate = 0
    opened = first = None
    for clock in range(1, 20):
        await bench.ReadOnly()
        opened = clock if opened is None and dut.out_begin_o.value == 1 else opened
        first = clock if first is None and dut.out_valid_o.value == 1 else first
        await bench.RisingEdge(dut.clk_i)
        dut.slip_valid_i.value = 0
        test.clock += 1
        if first:
            break
    assert (opened, first) == (3, 8)


@bench.applies(lambda dut: parameters(dut)["SlipDepth"] and parameters(dut)["Taxels"])
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def an_event_waits_for_one_packet_at_most(dut):
    build = parameters(dut)
    rng = np.random.default_rng(bench.SEED)
    test, sources, _ = await begin(dut, rng, {"image": 1.0, "cop": 0.02, "health": 0.01})
    longest = 4 * (17 + 2 * min(build["Chunk"], build["Taxels"])) + 4 * 24 + 12
    for _ in range(6):
        await test.run(int(rng.integers(200, 500)))
        count = len(sources["slip"].sent)
        sources["slip"].rate = 1
        await test.run(1)
        sources["slip"].rate = 0
        begin_clock = test.clock
        while sum(q[0] in (p.SLIP, p.CHANGE) for q in test.packets) <= count:
            await test.run(1)
        assert test.clock - begin_clock <= longest


@bench.applies(lambda dut: parameters(dut)["SlipDepth"])
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_full_queue_holds_the_slip_path(dut):
    """Events in every clock, first during an image, and a slow line: all arrive, in order."""
    build = parameters(dut)
    draw = np.random.default_rng(7)
    test, sources, counters = await begin(
        dut, np.random.default_rng(bench.SEED), {"image": 1.0}, lambda: draw.random() < 0.3
    )
    await test.run(400)
    sources["slip"].rate = 1
    await test.run(100 * build["SlipDepth"])
    assert dut.slip_ready_o.value == 0
    test.ready = lambda: True
    await test.run(150 * build["SlipDepth"] + 1500, quiet=True)
    while test.bytes or dut.out_begin_o.value == 1:
        await test.run(1, quiet=True)
    check(dut, test.decoded(), sources, counters, build)
    assert len(sources["slip"].sent) > build["SlipDepth"]


async def offer(dut, starts, clocks=0):
    """A change for each of ``starts``, so many clocks after it was taken."""
    for start in starts:
        dut.slip_i.value, dut.slip_valid_i.value = members.word("change", {"start": start}), 1
        await bench.ReadOnly()
        while not bench.high(dut.slip_ready_o):
            await bench.RisingEdge(dut.clk_i)
            await bench.ReadOnly()
        await bench.RisingEdge(dut.clk_i)
        if clocks:
            dut.slip_valid_i.value = 0
            await bench.clocks(dut, clocks)
    dut.slip_valid_i.value = 0


@bench.applies(lambda dut: parameters(dut)["SlipDepth"])
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def tells_when_half_of_the_queue_is_left(dut):
    """One change is on its way and two in registers, so memory has three less than were taken."""
    depth = parameters(dut)["SlipDepth"]
    test, *_ = await begin(dut, np.random.default_rng(bench.SEED), {})
    test.sources = []
    dut.out_ready_i.value = 0
    for taken in range(1, depth + 4):
        await offer(dut, [0], 12)
        assert bench.high(dut.slip_room_o) == (taken - 3 < depth // 2), taken
        assert bench.high(dut.slip_ready_o) == (taken - 3 < depth), taken
    await kinds(test, depth + 3)
    assert bench.high(dut.slip_room_o)


@bench.applies(lambda dut: parameters(dut)["SlipDepth"] and not parameters(dut)["Statistics"])
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def others_go_between_changes(dut):
    """One after each change that starts no slip, the lowest kind's first; after seven of these a part of an
    image. A start waits for the changes before it only; nor does it end the turn that another has."""
    build = parameters(dut)
    test, *_ = await begin(dut, np.random.default_rng(bench.SEED), {})
    test.sources = []
    ports = {p.COP: dut.cop_valid_i}
    if build["Health"]:
        ports = {p.ANSWER: dut.answer_valid_i} | ports | {p.HEALTH: dut.health_valid_i}
    dut.out_ready_i.value = 0
    await offer(dut, [1], 12)
    for port in ports.values():
        port.value = 1
    feed = cocotb.start_soon(offer(dut, [0] * 20))
    await bench.clocks(dut, 1)
    dut.cop_valid_i.value = dut.health_valid_i.value = 0
    for taxel in range(build["Taxels"]):
        dut.image_valid_i.value, dut.image_last_i.value = 1, taxel == build["Taxels"] - 1
        await bench.clocks(dut, 1)
    dut.image_valid_i.value = 0
    answered = cocotb.start_soon(until_answered(dut))
    wanted, left, parts = [p.SLIP], [*ports], -(-build["Taxels"] // build["Chunk"])
    for number in range(1, 21):
        wanted += [p.CHANGE, *left[:1]]
        left = left[1:]
        if number % 7 == 0 and number // 7 <= parts:
            wanted.append(p.IMAGE)
    assert await kinds(test, len(wanted)) == wanted
    await feed
    answered.cancel()
    dut.out_ready_i.value = 0
    await offer(dut, [1], 12)
    dut.cop_valid_i.value = dut.health_valid_i.value = 1
    await bench.clocks(dut, 1)
    dut.cop_valid_i.value = dut.health_valid_i.value = 0
    await offer(dut, [0, 1], 4)
    wanted = [p.SLIP, p.COP, p.CHANGE, p.SLIP, p.HEALTH][: 4 + build["Health"]]
    assert await kinds(test, len(wanted)) == wanted


async def kinds(test, count):
    """Of so many packets."""
    test.packets.clear()
    while len(test.packets) < count:
        await test.run(1)
    return [packet[0] for packet in test.packets]


async def until_answered(dut):
    while not bench.high(dut.answer_ready_o):
        await bench.RisingEdge(dut.clk_i)
        await bench.ReadOnly()
    await bench.RisingEdge(dut.clk_i)
    dut.answer_valid_i.value = 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def recovers_after_reset(dut):
    rng = np.random.default_rng(bench.SEED)
    rates = {"slip": 0.01, "cop": 0.01, "health": 0.01, "answer": 0.01, "image": 0.9, "class": 0.01}
    test, _, _ = await begin(dut, rng, rates)
    for cut in (30, 61, 333, None):
        await test.run(cut or 1)
        inside = getattr(dut, "state", None)  # a netlist may lack it
        while cut is None and inside is not None and inside.value.to_unsigned() != CHECK:
            await test.run(1)
        for name in ("slip", "cop", "health", "answer", "image", "class"):
            getattr(dut, f"{name}_valid_i").value = 0
        await bench.reset(dut)
        build = parameters(dut)
        sources = {}
        for source in test.sources:
            name = source.name
            if name == "image":
                sources[name] = Image(dut, rng, rates[name], build["Taxels"])
            else:
                sources[name] = type(source)(dut, rng, name, rates[name])
        test = Bench(dut, lambda: True, list(sources.values()))
        value = dut.statistics_i.value.to_unsigned()
        counters = [value >> 32 * k & 0xFFFFFFFF for k in range(max(1, build["Statistics"]))]
        await test.run(700)
        await test.run(3500, quiet=True)
        check(dut, test.decoded(), sources, counters, build)
        test.packets.clear()
        for name, source in sources.items():
            source.rate = rates[name]


async def collect(dut, count):
    """Packets as (type, payload) in docs/link.md's layout, with a host that is always ready."""
    packets, data = [], bytearray()
    dut.out_ready_i.value = 1
    while len(packets) < count:
        await bench.RisingEdge(dut.out_valid_o)
        await bench.ReadOnly()
        data.append(bench.read(dut.out_data_o))
        if dut.out_last_o.value == 1:
            packets.append((data[0], bytes(data[8:-4])))
            data.clear()
    await bench.RisingEdge(dut.clk_i)
    return packets


@bench.applies(lambda dut: parameters(dut)["Statistics"])
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def statistics_come_in_equal_times(dut):
    """After a reset the first one is due in 2^StatisticBits clocks, the next as long after it; each opens its
    frame a clock later."""
    await begin(dut, np.random.default_rng(bench.SEED), {})
    dut.out_ready_i.value = 1
    period, opened, before = 1 << parameters(dut)["StatisticBits"], [], False
    for clock in range(3 * period + 9):
        await bench.ReadOnly()
        now = bench.high(dut.out_begin_o)
        if now and not before:
            opened.append(clock)
        before = now
        await bench.RisingEdge(dut.clk_i)
    assert opened == [period + 1, 2 * period + 1, 3 * period + 1]


@bench.applies(lambda dut: parameters(dut)["Statistics"] == 256)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def each_of_the_most_statistics_has_its_turn(dut):
    """Index in a byte, counter in four: from 0 to 255, then 0 again."""
    _, _, counters = await begin(dut, np.random.default_rng(bench.SEED), {})
    assert len(set(counters)) == 256
    got = await collect(dut, 258)
    wanted = [bytes([index]) + counters[index].to_bytes(4, "little") for index in (*range(256), 0, 1)]
    assert got == [(5, payload) for payload in wanted]


@bench.applies(lambda dut: parameters(dut)["Taxels"] and not parameters(dut)["SlipDepth"])
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def images_are_numbered_modulo_256(dut):
    """One packet per taxel: image number, whether the image ends, place in three bytes, taxel in two."""
    build = parameters(dut)
    await begin(dut, np.random.default_rng(bench.SEED), {})
    for number in range(258):
        taxels = [(number * 251 + 9973 * place) % 65536 for place in range(build["Taxels"])]
        for place, taxel in enumerate(taxels):
            dut.image_valid_i.value, dut.image_data_i.value = 1, taxel
            dut.image_last_i.value, dut.image_time_i.value = int(place == len(taxels) - 1), number
            await bench.RisingEdge(dut.clk_i)
        dut.image_valid_i.value = 0
        assert await collect(dut, len(taxels)) == [
            (3, bytes([number % 256, place == len(taxels) - 1, place, 0, 0]) + taxel.to_bytes(2, "little"))
            for place, taxel in enumerate(taxels)
        ]
    assert bench.read(dut.image_dropped_o) == 0


@bench.applies(lambda dut: parameters(dut)["Taxels"] == LARGEST["Taxels"])
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def each_part_of_the_largest_image_says_where_it_begins(dut):
    """65536 = 564 x 116 + 112 taxels."""
    await begin(dut, np.random.default_rng(bench.SEED), {})
    dut.image_valid_i.value, dut.image_data_i.value, dut.image_last_i.value = 1, 0xA5C3, 0
    await bench.clocks(dut, 65535)
    dut.image_last_i.value = 1
    await bench.clocks(dut, 1)
    dut.image_valid_i.value = 0
    got = [payload for _, payload in await collect(dut, 565)]
    assert [int.from_bytes(payload[2:5], "little") for payload in got] == [116 * part for part in range(565)]
    assert [(payload[:2], len(payload)) for payload in got] == [(b"\0\0", 237)] * 564 + [(b"\0\1", 229)]


ALONE = {"SlipDepth": 0, "Cop": 0, "Health": 0, "Answers": 0, "Statistics": 0, "Taxels": 0}
BUILDS = [
    {"SlipDepth": 4, "Statistics": 3, "StatisticBits": 10, "Taxels": 36, "Chunk": 16, "Classes": 1},
    {"SlipDepth": 16, "Statistics": 1, "StatisticBits": 8, "Taxels": 9, "Chunk": 64},
    {"SlipDepth": 2, "Statistics": 0, "Taxels": 128, "Chunk": 116},
    ALONE | {"SlipDepth": 2, "Cop": 1},
    ALONE | {"Statistics": 256, "StatisticBits": 8, "Answers": 1},  # the largest number
    ALONE | {"Taxels": 4, "Chunk": 1},
]
LARGEST = ALONE | {"Taxels": 65536, "Chunk": 116}


EVIDENCE = {
    "equivalence": {"size": {"Taxels": 9}, "boxes": True},
    "mutants": {"sets": [0, 2], "unsolved": True},  # the last three have few kinds
    "faults": {
        # Events and images are queued.
        "settle": 8,
        "driver": {
            "packets": 1,
            "frame": "cop_valid_i",
            "when": "cop_valid_i",
            # A waiting image, and its time.
            "kept": "memory read_time_o written_time",
            "slow": 40,
            "rows": 700,
        },
    },
}


@pytest.mark.parametrize("build", BUILDS, ids=lambda b: "-".join(f"{v}" for v in b.values()))
def test_packet(build):
    bench.run("link", "packet", build)


def test_packet_of_the_largest_image():
    bench.run("link", "packet", LARGEST, "each_part_of_the_largest_image_says_where_it_begins")


def test_refuses_illegal_parameters():
    for name, value in (
        ("SlipDepth", 1),
        ("SlipDepth", 6),
        ("Statistics", 257),
        ("StatisticBits", 7),
        ("Taxels", 1),
        ("Chunk", 117),
        ("Chunk", 0),
    ):
        assert f"{name} = {value}" in bench.refuses("packet", {name: value})
    for chunk in (0, 117):
        with pytest.raises(ValueError, match=f"chunk = {chunk}"):
            p.image_chunks(0, [1, 2], chunk)


def test_the_page_names_the_counters_of_a_core():
    page = (toolchain.ROOT / "docs/link.md").read_text()
    row = next(line for line in page.splitlines() if line.startswith(f"| {p.STATISTIC} | statistics"))
    said = re.findall(r"(\d+) ([^,(|:]+?) *(?:\([^)]*\))? *[,|]", row.partition("Of the core:")[2])
    assert [(int(index), name) for index, name in said] == list(enumerate(p.COUNTERS))
