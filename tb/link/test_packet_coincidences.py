"""Events that meet in one clock in msn_packet, with packets decoded here by docs/link.md: any two sources
that request in the same clock and in the clocks around it; all sources while a packet leaves; a CoP and a
report in the clock in which the previous one is taken; an event at every clock around a packet's end; the
queue exactly full and exactly empty while the line stalls for longer than the queue is deep."""

import itertools
import zlib

import cocotb

import bench
import members

DEPTH, COUNTERS, TAXELS, CHUNK, PERIOD = 4, 3, 6, 4, 1 << 10
TYPES = {
    "slip": 1,
    "answer": 16,
    "states": 7,
    "cop": 2,
    "health": 4,
    "statistic": 5,
    "image": 3,
}  # in the order of priority
LENGTH = {"slip": 6, "answer": 8, "states": 8, "cop": 12, "health": 4, "statistic": 5}
# Clocks from a request until it takes part in the choice; the chosen packet's first byte follows 5 clocks
# later.
WAITS = {"slip": 3, "answer": 0, "states": 2, "cop": 1, "health": 1, "statistic": 1, "image": 2}
STATISTICS = [0x01020304, 0x11223344, 0xCAFEBABE]
NAMES = ("slip", "answer", "cop", "health", "image")
STATES = [4, 3, 2, 1, 0, 4]  # of the channels, and the packet that says so
STATES_SENT = bytes.fromhex("0000 0600 34 12 40 00")


class Talk:
    def __init__(self, dut):
        self.dut, self.clock, self.bytes, self.packets, self.starts = dut, 0, bytearray(), [], []
        self.left = {}  # clock: the requests in it
        self.answering = self.reporting = None

    def now(self, clock):
        return (0xFEDC_0000_0000 + 5 * clock + 3) & ((1 << 48) - 1)

    def ask(self, kind, at, number=0):
        """Request at clock ``at``; of an image, its last taxel comes in that clock."""
        if kind == "image":
            for taxel in range(TAXELS):
                self.left.setdefault(at - TAXELS + 1 + taxel, []).append(("image", (number, taxel)))
        else:
            self.left.setdefault(at, []).append((kind, number))

    async def tick(self, ready=1):
        """One clock; returns the byte that left in it, or None."""
        dut = self.dut
        dut.now_i.value, dut.out_ready_i.value = self.now(self.clock), ready
        for name in NAMES:
            getattr(dut, f"{name}_valid_i").value = 0
        dut.states_i.value = 0
        for kind, number in self.left.pop(self.clock, []):
            if kind == "answer":
                self.answering = number
            elif kind == "health":
                self.reporting = number
            else:
                self.drive(kind, number)
        if self.answering is not None:
            self.drive("answer", self.answering)
        if self.reporting is not None:
            self.drive("health", self.reporting)
        await bench.ReadOnly()
        took, place = dut.slip_ready_o.value == 1, bench.read(dut.states_id_o)
        if self.answering is not None and dut.answer_ready_o.value == 1:
            self.answering = None
        if self.reporting is not None and dut.health_ready_o.value == 1:
            self.reporting = None
        if ready and dut.out_valid_o.value == 1:
            if not self.bytes:
                self.starts.append(self.clock)
            self.bytes.append(bench.read(dut.out_data_o))
            if dut.out_last_o.value == 1:
                self.packets.append(bytes(self.bytes))
                self.bytes.clear()
        await bench.RisingEdge(dut.clk_i)
        dut.states_state_i.value = STATES[place] if place < len(STATES) else 7
        self.clock += 1
        return took

    def drive(self, kind, number):
        dut = self.dut
        if kind == "change":
            dut.slip_valid_i.value, dut.slip_time_i.value = 1, number
            change = {"id": 7, "p2p": number, "state": 4, "told": 1, "late": number % 2}
            dut.slip_i.value = members.word("change", change)
            return
        getattr(dut, "states_i" if kind == "states" else f"{kind}_valid_i").value = 1
        if kind == "slip":
            event = {"id": 0x0102 + number, "p2p": 0x030405 + number, "state": 2 + number % 2, "start": 1}
            dut.slip_i.value = members.word("change", event)
            dut.slip_time_i.value = 0x060708090A0B + number
        elif kind == "answer":
            dut.answer_data_i.value = 0x0102_0304_0506_0708 + number
        elif kind == "cop":
            cop = {"x": 0x0A0B0C + number, "y": 0xF0E0D0, "load": 0x1122334455, "pressed": 1}
            dut.cop_i.value = members.word("cop", cop)
            dut.cop_time_i.value = 0x0C0D0E0F1011 + number
        elif kind == "states":
            pass
        elif kind == "health":
            dut.health_i.value = members.word("health", {"id": 0x161718 + number, "faults": 5})
        else:
            image, taxel = number
            dut.image_data_i.value, dut.image_last_i.value = (
                0x2000 + 256 * image + taxel,
                int(taxel == TAXELS - 1),
            )
            dut.image_time_i.value = 0x1A1B1C1D1E1F + image

    async def run(self, clocks, ready=1):
        for _ in range(clocks):
            await self.tick(ready)

    async def until_still(self):
        quiet = 0
        while quiet < 12 or self.left:
            await self.tick()
            quiet = 0 if self.dut.out_begin_o.value == 1 else quiet + 1
            assert self.clock < 5000, "it goes on for ever"

    def kinds(self):
        """(kind, number) of each packet, after checking its checksum, count, time and payload."""
        found, counters = [], 0
        for count, (packet, start) in enumerate(zip(self.packets, self.starts)):
            head, checksum = packet[:-4], int.from_bytes(packet[-4:], "little")
            assert checksum == zlib.crc32(head)
            assert head[1] == count
            time, payload = int.from_bytes(head[2:8], "little"), head[8:]
            if head[0] == 6:
                assert payload == bytes([7, 0, time, 0, 0, 0x94 if time % 2 else 0x14])
                found.append(("change", time))
                continue
            kind = next(name for name, number in TYPES.items() if number == head[0])
            assert kind == "image" or len(payload) == LENGTH[kind]
            if kind == "slip":
                number = time - 0x060708090A0B
                due = (0x0102 + number).to_bytes(2, "little") + (0x030405 + number).to_bytes(3, "little")
                assert payload == due + bytes([2 + number % 2])
            elif kind == "answer":
                number = int.from_bytes(payload, "little") - 0x0102_0304_0506_0708
                assert time == self.now(start - 4)  # the time of the choice
            elif kind == "cop":
                number = time - 0x0C0D0E0F1011
                due = (0x0A0B0C + number).to_bytes(3, "little") + bytes([0xD0, 0xE0, 0xF0])
                assert payload == due + bytes([0x55, 0x44, 0x33, 0x22, 0x11, 1])
            elif kind == "states":
                number = 0
                assert payload == STATES_SENT and time == self.now(start - 4)
            elif kind == "health":
                number = int.from_bytes(payload[:3], "little") - 0x161718
                assert payload[3] == 5
            elif kind == "statistic":
                number, counters = payload[0], counters + 1
                assert number == (counters - 1) % COUNTERS
                assert int.from_bytes(payload[1:], "little") == STATISTICS[number]
                assert time == self.now(start - 4)
            else:
                number = (time - 0x1A1B1C1D1E1F, payload[2])
                assert payload[0] == number[0] and payload[1] == int(number[1] == CHUNK)
                taxels = range(CHUNK) if number[1] == 0 else range(CHUNK, TAXELS)
                values = [0x2000 + 256 * number[0] + taxel for taxel in taxels]
                assert payload[5:] == b"".join(value.to_bytes(2, "little") for value in values)
            found.append((kind, number))
        return found


async def begin(dut):
    inputs = {f"{name}_valid_i": 0 for name in NAMES}
    inputs |= {"states_i": 0, "states_state_i": 0}
    await bench.start(dut, statistics_i=bench.lane_word(STATISTICS, 32), **inputs)


async def again(dut):
    await bench.reset(dut)
    return Talk(dut)


PARTS = {"image": [("image", (0, 0)), ("image", (0, CHUNK))]}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def two_sources_ask_in_one_clock(dut):
    """Each pair, one request up to 3 clocks (statistics: one) before or after the other. The first one
    waiting is sent first; if both begin to wait in one clock, docs/link.md's order decides. The other
    follows, and both are complete."""
    await begin(dut)
    for one, other in itertools.combinations(TYPES, 2):
        for shift in range(-1, 2) if "statistic" in (one, other) else range(-3, 4):
            talk = await again(dut)
            # Statistics request once in PERIOD clocks; the other source requests around that clock.
            still, moved = (one, other) if one == "statistic" else (other, one)
            base = PERIOD if still == "statistic" else 20
            waits = {still: base, moved: base + shift}
            for kind, clock in waits.items():
                if kind != "statistic":
                    talk.ask(kind, clock - WAITS[kind])
            await talk.run(base + 5)
            await talk.until_still()
            order = sorted(TYPES, key=lambda kind: (waits.get(kind, 9999), list(TYPES).index(kind)))[:2]
            first, second = order
            parts = [PARTS.get(kind, [(kind, 0)]) for kind in (first, second)]
            # An image is sent in packets, so no other source waits for more than one of them.
            due = [parts[0][0], *parts[1], *parts[0][1:]]
            assert talk.kinds() == due, (one, other, shift)
            assert talk.starts[0] == waits[first] + 5, (one, other, shift)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def all_of_them_wait_while_a_packet_leaves(dut):
    """In the order of the docs, whichever requested first."""
    await begin(dut)
    for order in (list(TYPES), list(TYPES)[::-1], ["image", "cop", "slip", "states", "health", "answer"]):
        talk = await again(dut)
        talk.ask("cop", PERIOD - 40, number=7)
        for place, kind in enumerate(order):
            if kind != "statistic":
                talk.ask(kind, PERIOD - 32 + 3 * place)
        await talk.run(PERIOD + 10)
        await talk.until_still()
        due = [("cop", 7)] + [(kind, 0) for kind in TYPES if kind != "image"] + PARTS["image"]
        assert talk.kinds() == due, order


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_cop_and_a_report_as_the_one_before_is_taken(dut):
    """The CoP of clock n waits in n + 1 and is taken in n + 2. A CoP in n + 1 replaces it, and it is dropped;
    one from n + 2 on follows it, complete. A report stalls until the previous one is taken, and then follows
    it."""
    await begin(dut)
    for later in range(1, 6):
        talk = await again(dut)
        talk.ask("cop", 10, number=1)
        talk.ask("cop", 10 + later, number=2)
        await talk.run(20)
        await talk.until_still()
        assert talk.kinds() == ([("cop", 1), ("cop", 2)] if later > 1 else [("cop", 2)])
        assert bench.read(dut.cop_dropped_o) == int(later == 1)
        talk = await again(dut)
        talk.ask("health", 10, number=1)
        talk.ask("health", 10 + later, number=2)
        await talk.run(20)
        await talk.until_still()
        assert talk.kinds() == [("health", 1), ("health", 2)]
        times = [int.from_bytes(packet[2:8], "little") for packet in talk.packets]
        # Accepted in its own clock, but not in clocks 11 and 12, while the previous one waits.
        assert times == [talk.now(10), talk.now(max(10 + later, 13))]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_event_at_every_clock_around_a_packets_end(dut):
    """Both it and the packet that is leaving are complete: neither is lost, doubled or changed."""
    await begin(dut)
    talk = await again(dut)
    talk.ask("slip", 5, number=1)
    await talk.run(6)
    await talk.until_still()
    end = talk.starts[0] + 4 * (len(talk.packets[0]) - 1)  # clock of the last byte, if the line is free
    for kind in ("slip", "cop", "answer", "health"):
        for shift in range(-9, 8):
            talk = await again(dut)
            talk.ask("slip", 5, number=1)
            talk.ask(kind, end + shift, number=2)
            await talk.run(end + shift + 1)
            await talk.until_still()
            assert talk.kinds() == [("slip", 1), (kind, 2)], (kind, shift)
            free = end + 1  # from here on the next packet can be chosen
            assert talk.starts[1] == max(end + shift + WAITS[kind], free) + 5, (kind, shift)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_queue_exactly_full_and_empty(dut):
    """The line stalls for 60 clocks: the event being sent and DEPTH + 2 more are taken, no other. Each packet
    that leaves makes room for one. Then all leave, in order and once; the same again after 60 clocks without
    events."""
    await begin(dut)
    talk = await again(dut)
    number = 0

    async def offer(ready):
        """Offer an event for one clock; the next event once it was taken."""
        nonlocal number
        talk.left.setdefault(talk.clock, []).append(("slip", number))
        number += await talk.tick(ready)

    for rounds in range(2):
        before = number
        for _ in range(60):
            await offer(0)
        assert number - before == DEPTH + 3
        for one in range(1, 2 * DEPTH + 3):
            count = len(talk.packets)
            while len(talk.packets) == count:
                await offer(1)
            for _ in range(30):
                await offer(0)
            assert number - before == DEPTH + 3 + one
        await talk.until_still()
        await talk.run(60)
        sent = [number for kind, number in talk.kinds() if kind == "slip"]
        assert sent == list(range(number)), rounds


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def changes_that_never_end_let_the_others_pass(dut):
    """The queue is never empty: after a change the others go first once, and after seven a part of an image;
    starts of a slip, which are never kept back, then follow one another."""
    await begin(dut)
    talk = await again(dut)
    for kind in ("image", "cop", "health", "answer", "states"):
        talk.ask(kind, 45, (0 if kind == "image" else 3) if kind != "states" else 0)
    number = 0
    while len(talk.packets) < 28:
        talk.left.setdefault(talk.clock, []).append(("change", number))
        number += await talk.tick()
    others = [("answer", 3), ("states", 0), ("cop", 3), ("health", 3), *PARTS["image"]]
    before = [1, 1, 1, 1, 3, 7, 5]  # changes before each of these, and at the end
    wanted, count = [], 0
    for changes, other in zip(before, [*others, None]):
        wanted += [("change", count + k) for k in range(changes)] + [other] * (other is not None)
        count += changes
    got = [one for one in talk.kinds() if one[0] != "statistic"]
    assert got[: len(wanted)] == wanted, got
    # A start behind the changes goes before a centre of pressure once it is first.
    talk = await again(dut)
    for place, kind in enumerate(("change", "slip", "slip", "cop")):
        talk.ask(kind, 10 + place, 1)
    await talk.run(15)
    await talk.until_still()
    assert talk.kinds() == [("change", 1), ("slip", 1), ("slip", 1), ("cop", 1)]


def test_packet_coincidences():
    build = {
        "SlipDepth": DEPTH,
        "States": len(STATES),
        "Statistics": COUNTERS,
        "StatisticBits": 10,
        "Taxels": TAXELS,
        "Chunk": CHUNK,
    }
    bench.run("link", "packet", build, module="test_packet_coincidences")
