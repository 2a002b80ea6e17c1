"""msn_packet_slip against its model: convert start and change at every phase of the sweep; changes of every
kind, changes that wait for the previous one while converts go on, a slow line, long times, packet numbers
past 255, resets in each state; the frame opens with the change itself; bounds on its wait and on the gaps of
its bytes; there is room while no packet is under way."""

import cocotb
import numpy as np
import pytest

import bench
import members
from meissner.twins.link import packet
from meissner.twins.slip.slip_changes import Change


def packets(events, **named):
    """Of (time, p2p, state): starts of a slip, but for states 0, 1 and 4, which have their own past."""
    return packet.packets([(time, p2p, change_of(p2p, state)) for time, p2p, state in events], **named)


def change_of(p2p, state):
    return Change(state in (2, 3), bool(p2p & 1), (p2p + state) % 5, state)


class Line:
    """Drives converts and decisions and takes bytes; counts clocks since the release of reset."""

    def __init__(self, dut, ready):
        self.dut, self.ready = dut, ready
        ports = ("convert_i", "in_valid_i", "in_i", "out_ready_i")
        self.put = [bench.putter(getattr(dut, name)) for name in ports]
        self.valid, self.last, self.data = dut.out_valid_o, dut.out_last_o, dut.out_data_o
        self.edge = bench.RisingEdge(dut.clk_i)
        self.clock, self.bytes, self.packets = 0, bytearray(), []
        self.waits, self.opened = [], True

    async def step(self, convert=0, change=None):
        """One clock; returns whether the change (p2p, state) was taken."""
        word = 0x5A5A_5A5A_5A5A
        if change:
            word = members.word("change", {"id": 9, "p2p": change[0]} | change_of(*change)._asdict())
        ready = int(self.ready())
        for put, value in zip(self.put, (convert, change is not None, word, ready)):
            put(value)
        await bench.ReadOnly()
        if change:
            assert self.dut.out_begin_o.value == 1
        else:  # free when no packet is under way
            assert self.dut.room_o.value == (self.dut.out_begin_o.value == 0)
        if bench.high(self.valid) and ready:
            self.bytes.append(bench.read(self.data))
            if bench.high(self.last):
                self.packets.append(bytes(self.bytes))
                self.bytes.clear()
        taken = change is not None and bench.high(self.dut.in_ready_o)
        await self.edge
        self.clock += 1
        return taken

    async def offer(self, change, convert=lambda: 0):
        waited = 0
        while not await self.step(convert(), change):
            waited += 1
        return waited

    async def drain(self, count):
        for _ in range(20_000):
            if len(self.packets) == count:
                return
            await self.step()
        raise AssertionError("a packet did not come")


async def begin(dut, ready=lambda: True):
    line = Line(dut, ready)
    await bench.start(dut, convert_i=0, in_i=0)
    return line


def drawn(rng, bits):
    return int(rng.choice([0, (1 << bits) - 1, rng.integers(0, 1 << bits)])), int(rng.integers(0, 5))


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def matches_model_at_every_phase(dut):
    """Convert start and change at every clock of the sweep; the wait has a bound."""
    rng = np.random.default_rng(bench.SEED)
    bits = dut.P2pBits.value.to_unsigned()
    line, events = await begin(dut), []
    for phase in range(64):
        for delay in (1, 30, 64, 130):
            while line.clock % 64 != phase:
                await line.step()
            time = line.clock
            await line.step(convert=1)
            for _ in range(delay - 1):
                await line.step()
            event = drawn(rng, bits)
            assert 63 <= await line.offer(event) <= 191
            events.append((time, *event))
            await line.drain(len(events))
            if phase % 16:
                break
    assert line.packets == packets(events)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(rate=[1.0, 0.02])
async def changes_in_a_row(dut, rate):
    """A convert every 300 clocks, some with a change; changes closer together than packets; a slow line."""
    rng = np.random.default_rng(bench.SEED)
    bits = dut.P2pBits.value.to_unsigned()
    draw = np.random.default_rng(2)
    line, events = await begin(dut, lambda: draw.random() < rate), []
    stamp = None
    for _ in range(60 if rate == 1 else 25):
        start = line.clock
        if rng.random() < 0.1:
            await line.step(convert=0)
        stamp = line.clock
        await line.step(convert=1)
        for _ in range(int(rng.integers(0, 200))):
            await line.step()
        event = drawn(rng, bits)
        if rng.random() < 0.3:
            # Converts during its wait must not change its time.
            await line.offer(event, lambda start=start: int((line.clock - start) % 300 == 299))
            events.append((stamp, *event))
        while line.clock - start < 300:
            await line.step()
    await line.drain(len(events))
    assert line.packets == packets(events)
    assert len(events) > 5


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def events_after_one_convert(dut):
    """Events offered back to back have the time of the one convert before them, and a number each: 1 to 4."""
    line, events = await begin(dut), []
    for count in (1, 4):
        for _ in range(237):
            await line.step()
        time = line.clock
        await line.step(convert=1)
        events += [(time, p2p, p2p % 5) for p2p in (9, 4, 7, 3)[:count]]
        for event in events[-count:]:
            await line.offer(event[1:], lambda: int(line.clock % 50 == 0))
        await line.drain(len(events))
    assert line.packets == packets(events)


@bench.applies(lambda dut: dut.P2pBits.value.to_unsigned() == 24)  # one build is enough
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def counts_on(dut):
    """Packet numbers wrap around after 255; the time goes on, with carries through many bits."""
    line, events = await begin(dut), []
    for number in range(260):
        time = line.clock
        await line.step(convert=1)
        await line.offer((number % 2, 2))
        events.append((time, number % 2, 2))
        await line.drain(len(events))
    assert line.packets == packets(events)
    assert events[-1][0] > 1 << 18


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def bytes_come_in_time(dut):
    """At least one byte in 72 clocks, so a line of 72 clocks a byte or more never has to wait."""
    line = await begin(dut)
    await line.step(convert=1)
    await line.offer((3, 2))
    seen = []
    while not line.packets:
        before = len(line.bytes)
        await line.step()
        if len(line.bytes) != before:
            seen.append(line.clock)
    assert len(seen) == 18
    assert np.diff(seen).max() <= 72


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def recovers_after_reset(dut):
    line = await begin(dut)
    for wait in (0, 1, 64, 100, 200, 500):
        for _ in range(wait % 64):
            await line.step()
        await line.step(convert=1)
        for _ in range(wait):
            if await line.step(0, (1, 3)):
                break
        for _ in range(wait):
            await line.step()
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        line = Line(dut, lambda: True)
        for _ in range(wait % 100 + 1):
            await line.step()
        time = line.clock
        await line.step(convert=1)
        await line.offer((2, 4))
        await line.drain(1)
        assert line.packets == packets([(time, 2, 4)])


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_convert_around_an_event(dut):
    """At every clock of the sweep: an event's time is that of a convert in the clock before it, not of one in
    its own clock or the one after. If the last byte of its packet is taken more than a sweep late, this
    packet and the next event, offered meanwhile, are complete."""
    asleep, slept = 17, 0

    def ready():
        nonlocal slept
        slept += len(line.bytes) == asleep
        return len(line.bytes) != asleep or slept > 150

    line, events = await begin(dut, ready), []
    for phase in range(64):
        while line.clock % 64 != phase:
            await line.step()
        events.append((line.clock, 3 + phase, 2))
        await line.step(convert=1)
        at = line.clock + phase % 2
        slept = 0
        await line.offer((3 + phase, 2), lambda at=at: int(line.clock == at))
        if phase % 8 == 0:
            while len(line.bytes) < 10:
                await line.step()
            events.append((line.clock, 70 + phase, 3))
            await line.step(convert=1)
            await line.offer((70 + phase, 3))
            assert len(line.packets) == len(events) - 1 and slept == 151
            slept = 0
        await line.drain(len(events))
        assert slept == 151
    assert line.packets == packets(events)


EVIDENCE = {
    "faults": {"driver": {"packets": 1, "join": 1, "rows": 20000}},
}


@pytest.mark.parametrize(
    "bits", [24, pytest.param(14, marks=pytest.mark.long), pytest.param(18, marks=pytest.mark.long)]
)
def test_packet_slip(bits):
    bench.run("link", "packet_slip", {"P2pBits": bits})


def test_refuses_illegal_parameters():
    assert "P2pBits = 25" in bench.refuses("packet_slip", {"P2pBits": 25})
    assert "P2pBits = 0" in bench.refuses("packet_slip", {"P2pBits": 0})
    for bits in (0, 25):
        with pytest.raises(ValueError, match=f"p2p_bits = {bits}"):
            packets([], p2p_bits=bits)
    for p2p in (-1, 1 << 14):
        with pytest.raises(ValueError, match="does not fit 14 bits"):
            packets([(0, p2p, 0)], p2p_bits=14)
