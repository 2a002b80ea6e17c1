"""msn_bridge against its model: reads and writes with every byte value and zeros anywhere, answers in order
and late, bus errors, a bus that does not answer; every mutated frame, noise, broken bytes, half frames and a
pause, a command before the last one is answered, unknown operations and addresses out of range; resets."""

import random
import struct
import zlib

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.bridge import BUS_ERROR, DONE, NO_ANSWER, READ, WRITE, accesses, answer, command
from meissner.twins.link.cobs import stuff

TIMEOUT = 300


class Registers:
    """The other end of the bus: a memory; addresses with 0x800 give an error, with 0x400 no answer."""

    def __init__(self, dut):
        self.dut, self.memory, self.seen = dut, {}, []
        self.pending = None

    def before(self):
        """Drive the answer of this clock."""
        done = self.pending is not None
        self.dut.bus_done_i.value = int(done)
        self.dut.bus_error_i.value = int(done and self.pending[1])
        self.dut.bus_rdata_i.value = self.pending[0] if done else 0xDEADBEEF

    def after(self):
        """Take the access of this clock."""
        dut, self.pending = self.dut, None
        if dut.bus_valid_o.value == 1:
            write, address = int(dut.bus_write_o.value), bench.read(dut.bus_address_o)
            assert dut.bus_strobe_o.value == 15
            data = bench.read(dut.bus_wdata_o)
            self.seen.append((write, address, data if write else 0))
            if address & 0x400:
                return
            error = bool(address & 0x800)
            if write and not error:
                self.memory[address] = data
            self.pending = (self.memory.get(address, address ^ 0x5A5A0000), error)


async def send(dut, registers, line, gap=lambda: 0, stall=lambda: False, errors=(), drain=60):
    """Send bytes with gaps of clocks; return the answers. ``errors``: bytes after which the receiver reports
    an error."""
    answers = []

    async def clock(valid, byte, error=0):
        dut.in_valid_i.value, dut.in_data_i.value, dut.in_error_i.value = valid, byte, error
        dut.answer_ready_i.value = int(not stall())
        registers.before()
        await bench.ReadOnly()
        if dut.answer_valid_o.value == 1 and dut.answer_ready_i.value == 1:
            answers.append(bench.read(dut.answer_data_o).to_bytes(8, "little"))
        registers.after()
        await bench.RisingEdge(dut.clk_i)

    for place, byte in enumerate(line):
        await clock(1, byte)
        if place in errors:
            await clock(0, 0x33, 1)
        for _ in range(gap()):
            await clock(0, random.randrange(256))
    for _ in range(drain):
        await clock(0, 0)
    return answers


def expected_of(found, memory):
    """The answers and the bus accesses that commands ``found`` must give."""
    answers, seen = [], []
    for operation, tag, address, data in found:
        seen.append((operation, address, data if operation else 0))
        if address & 0x400:
            status, value = NO_ANSWER, None
        elif address & 0x800:
            status, value = BUS_ERROR, memory.get(address, address ^ 0x5A5A0000)
        else:
            if operation == WRITE:
                memory[address] = data
            status, value = DONE, memory.get(address, address ^ 0x5A5A0000)
        answers.append((tag, status, address, value))
    return answers, seen


def same(got, expected):
    assert len(got) == len(expected)
    for payload, (tag, status, address, value) in zip(got, expected):
        if status == NO_ANSWER:
            assert payload[:4] == answer(tag, status, address, 0)[:4]
        else:
            assert payload == answer(tag, status, address, value)


async def begin(dut):
    registers = Registers(dut)
    await bench.start(dut, in_data_i=0, in_error_i=0, bus_done_i=0, bus_error_i=0, answer_ready_i=0)
    return registers


def commands_of(rng, count):
    lines = []
    for index in range(count):
        data = int(rng.choice([0, 0xFFFFFFFF, 0x00FF0000, rng.integers(0, 1 << 32)]))
        address = int(rng.choice([0, 4, 0x3FC, 0x800, rng.integers(0, 0x400)]))
        lines.append(command(int(rng.integers(0, 2)), index * 37, address, data))
    return lines


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    inputs = {"in_data_i": 0, "in_error_i": 0, "bus_done_i": 0}
    await bench.turn_over(dut, "rejected_o", wiggled=["in_valid_i"], again=False, **inputs)


@bench.applies(lambda dut: bench.whole(dut) and dut.TimeoutClocks.value == TIMEOUT and not bench.is_top(dut))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    registers = await begin(dut)
    for start in bench.carries(dut.rejected_o):
        dut.rejected_o.value = start
        assert await send(dut, registers, b"\x03\x01\x02\0", drain=4) == []
        assert bench.read(dut.rejected_o) == (start + 1) % 2**32


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(slow=[False, True])
async def matches_model(dut, slow):
    rng = np.random.default_rng(bench.SEED)
    registers = await begin(dut)
    line = b"".join(commands_of(rng, 60))
    found, rejected = accesses(line)
    expected, seen = expected_of(found, {})
    # Without a gap the next command ends 14 bytes later; by then the answer has left.
    gap = (lambda: int(rng.integers(0, 12))) if slow else (lambda: 0)
    stall = bench.pauses(0.5, "stalls") if slow else (lambda: False)
    same(await send(dut, registers, line, gap, stall), expected)
    assert registers.seen == seen
    assert bench.read(dut.rejected_o) == rejected == 0
    assert len(found) == 60


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def damaged_frames_change_nothing(dut):
    rng = np.random.default_rng(bench.SEED)
    registers = await begin(dut)
    total = 0
    memory = {}
    for _ in range(300):
        frame = bytearray(commands_of(rng, 1)[0])
        at = int(rng.integers(0, len(frame)))
        kind = rng.integers(0, 5)
        if kind == 0:
            frame[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            frame.insert(at, int(rng.integers(0, 256)))
        elif kind == 2:
            del frame[at]
        elif kind == 3:
            frame[at:] = rng.bytes(int(rng.integers(0, 40)))
        line = bytes(frame) + b"\0" + commands_of(rng, 1)[0]
        found, rejected = accesses(line)
        total += rejected
        expected, seen = expected_of(found, memory)
        registers.seen.clear()
        same(await send(dut, registers, line, lambda: 3, drain=20), expected)
        assert registers.seen == seen
        assert len(found) >= 1
    assert bench.read(dut.rejected_o) == total
    assert total > 100


@bench.applies(lambda dut: dut.TimeoutClocks.value != TIMEOUT)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_frame_may_pause_for_the_default_time(dut):
    """120,000 clocks: a pause one clock shorter has no effect, one of all of them ends the frame."""
    registers, good = await begin(dut), command(WRITE, 1, 8, 99)
    for pause, answers in ((119_999, 1), (120_000, 0)):
        assert await send(dut, registers, good[:6], drain=1) == []
        await bench.clocks(dut, pause - 1)
        assert len(await send(dut, registers, good[6:])) == answers


@bench.applies(lambda dut: dut.TimeoutClocks.value == TIMEOUT)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def what_is_no_command_is_rejected(dut):
    registers = await begin(dut)
    good = command(WRITE, 1, 8, 99)
    rejected = 0
    for operation, address in ((2, 8), (255, 8), (0, 0x1008), (1, 0xF008)):
        body = struct.pack("<BBHI", operation, 0, address, 1)
        line = stuff(body + struct.pack("<I", zlib.crc32(body)))
        assert accesses(line) == ([], 1)
        assert await send(dut, registers, line) == []
        rejected += 1
    # The CRC is right, but the command is shorter or longer than one, by up to two wraps of its count.
    for length in (6, 7, 9, 10, 11, 12, 24, 40):
        body = struct.pack("<BBHI", WRITE, 0, 8, 1)[:length].ljust(length, b"\0")
        line = stuff(body + struct.pack("<I", zlib.crc32(body)))
        assert accesses(line) == ([], 1)
        assert await send(dut, registers, line) == []
        rejected += 1
    # Its last code announces one byte more than there is.
    longer, last = bytearray(good), int(good[0] == 0)
    while last + longer[last] < len(longer) - 1:
        last += longer[last]
    longer[last] += 1
    assert accesses(bytes(longer)) == ([], 1)
    assert await send(dut, registers, bytes(longer)) == []
    rejected += 1
    # A line error inside it; a pause inside it, then the rest; noise; then a good command.
    for place in range(1, len(good) - 1):
        assert await send(dut, registers, good, errors=(place,)) == []
        rejected += 1
    assert await send(dut, registers, good[:6], drain=TIMEOUT) == []
    assert await send(dut, registers, good[6:]) == []
    rejected += 2
    assert bench.read(dut.rejected_o) == rejected
    assert registers.seen == []
    # A frame that has paused is over: it is counted once, however long the pause, and a zero begins the next.
    assert await send(dut, registers, good[:6], drain=8 * TIMEOUT) == []
    assert bench.read(dut.rejected_o) == rejected + 1
    same(await send(dut, registers, command(WRITE, 4, 12, 7)), [(4, DONE, 12, 7)])
    assert bench.read(dut.rejected_o) == rejected + 1
    registers.seen.clear()
    # A pause one clock shorter than the time-out has no effect.
    first = await send(dut, registers, good[:6], drain=TIMEOUT - 1)
    assert first == [] and len(await send(dut, registers, good[6:])) == 1
    assert registers.seen == [(1, 8, 99)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_bus_that_does_not_answer(dut):
    registers = await begin(dut)
    for tag, address in enumerate((0x404, 0x7F8, 0xCAC), start=5):
        line = command(READ, tag, address)
        # Its time-out is 255 clocks, from 2 clocks on.
        assert await send(dut, registers, line, drain=257) == []
        got = await send(dut, registers, b"", drain=1)
        assert [g[:4] for g in got] == [answer(tag, NO_ANSWER, address, 0)[:4]]
    same(await send(dut, registers, command(READ, 9, 0x10)), [(9, DONE, 0x10, 0x10 ^ 0x5A5A0000)])
    assert registers.seen == [(0, 0x404, 0), (0, 0x7F8, 0), (0, 0xCAC, 0), (0, 0x10, 0)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def one_command_at_a_time(dut):
    """A command that arrives before the last one is answered is rejected and disturbs nothing."""
    registers = await begin(dut)
    held = await send(dut, registers, command(READ, 1, 4) + command(WRITE, 2, 4, 7), stall=lambda: True)
    assert held == [] and registers.seen == [(0, 4, 0)]
    assert bench.read(dut.rejected_o) == 1
    same(await send(dut, registers, b""), [(1, DONE, 4, 4 ^ 0x5A5A0000)])


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_command_that_ends_as_the_last_is_answered(dut):
    """If its closing zero comes in the clock in which the first answer is taken, or later, its access begins;
    a clock earlier it is rejected."""
    registers = await begin(dut)
    first, second = command(WRITE, 1, 8, 99), command(READ, 2, 8)
    refused = 0
    for late in (1, 0, -1, -2):
        taken = iter([False] * (len(second) - 1 - late))
        registers.seen.clear()
        assert await send(dut, registers, first, stall=lambda: True) == []
        got = await send(dut, registers, second, stall=lambda taken=taken: next(taken, True) is False)
        refused += late < 0
        same(got, [(1, DONE, 8, 99)] + [(2, DONE, 8, 99)] * (late >= 0))
        assert registers.seen == [(1, 8, 99)] + [(0, 8, 0)] * (late >= 0)
        assert bench.read(dut.rejected_o) == refused


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset(dut):
    registers = await begin(dut)
    line = command(WRITE, 9, 0x20, 0x00010203)
    for cut in range(1, len(line) + 1):
        await send(dut, registers, line[:cut], stall=lambda: True, drain=cut % 4)
        # A byte and an error in the clock of the reset are lost with it.
        dut.in_valid_i.value, dut.in_data_i.value, dut.in_error_i.value = 1, 1, 1
        await bench.reset(dut)
        dut.in_valid_i.value = dut.in_error_i.value = 0
        registers.pending = None
        registers.seen.clear()
        # With the zero before it and without: after a reset a frame begins with the first byte.
        same(await send(dut, registers, line[cut % 2 :]), [(9, DONE, 0x20, 0x00010203)])
        assert len(registers.seen) == 1
        assert bench.read(dut.rejected_o) == 0


# A zero before and after each command.
EVIDENCE = {
    "faults": {"settle": 4, "driver": {"frame": "in_data_i:0", "when": "in_valid_i", "bus": 1}},
}


@pytest.mark.parametrize("parameters", [{"TimeoutClocks": TIMEOUT}, {}], ids=str)
def test_bridge(parameters):
    bench.run("link", "bridge", parameters)


def test_refuses_illegal_parameters():
    assert "TimeoutClocks = 15" in bench.refuses("bridge", {"TimeoutClocks": 15})
    with pytest.raises(ValueError, match="operation = 2"):
        command(2, 0, 0)
    with pytest.raises(ValueError, match="address = 4096"):
        command(READ, 0, 4096)
