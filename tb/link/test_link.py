"""msn_link from events to the levels of the line, and from the line to the register bus, with the models of
both lines: at full load no slip event is lost and every image is complete, with register accesses in between;
the clocks from an event to the line's first edge. Without a line: packets byte by byte, and the host's bus
passed through."""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer

import bench
import members
from link import test_packet as packet
from link.test_bridge import Registers
from meissner.twins.link import packet as p
from meissner.twins.link.bridge import BUS_ERROR, DONE, NO_ANSWER, READ, WRITE, command
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.link import line_of, packets_of
from meissner.twins.link.uart import levels

ALL = {f"events_{state}": -1 for state in ("none", "contact", "incipient", "gross", "release")}
CLK, BAUD, TAXELS, CHUNK = 12_000_000, 3_000_000, 36, 16
TIME = 0xFEDC_BA98_7654
BUS = {"valid": 1, "write": 1, "address": 12, "wdata": 32, "strobe": 4}
# The counters in statistics, by docs/link.md: of a core with a converter, and of one with an array.
REST = ("slip_damaged", "slip_blanked", "cop_damaged", "link_image_dropped", "link_rejected")
REST += ("link_changes_lost",)
COUNTERS = (
    ("adc_dropped", "adc_overrun", "adc_timeout", *REST),
    ("scan_dropped", "scan_overrun", "scan_lost", *REST),
)


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def whole(dut):
    return not number(dut, "SlipOnly")


def has_line(dut):
    return whole(dut) and number(dut, "Uart")


def parameters(dut):
    return packet.parameters(dut) | {"Statistics": 9}


def told(dut):
    return members.of("link_status", bench.read(dut.status_o))


async def begin(dut, rates, ready=lambda: True):
    """The bench of msn_packet's test, without register accesses."""
    names = "status cfg convert decision_valid decision bus_done bus_error bus_rdata"
    rest = {f"{name}_i": 0 for name in (*names.split(), *(f"host_{name}" for name in BUS))}
    test, sources, _ = await packet.begin(
        dut, np.random.default_rng(bench.SEED), rates, ready, rx_i=1, time_i=TIME, **rest
    )
    names = COUNTERS[number(dut, "Array")]
    counters = {name: 0x0101_0101 * (3 + 7 * place) for place, name in enumerate(names)}
    others = dict.fromkeys(("adc_mistagged", "adc_over_range", "scan_held", "tare_swallowed"), 0x55)
    dut.status_i.value = members.word("status", counters | others)
    dut.cfg_i.value = members.word("link_cfg", ALL)
    return test, sources, list(counters.values())


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "out_valid_o", "now_o", "pressed_o")
    assert dut.tx_o.value == 1


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_clocks_over_the_whole_width(dut):
    """From the value at power-up, with registers at ones the greatest; from 0 after a reset."""
    for port in dut:
        if port._name.endswith("_i"):
            port.value = 0
    await Timer(1, "ns")
    count = bench.read(dut.now_o)
    assert bench.ONES.lstrip("+") not in cocotb.plusargs or count == 2**48 - 1
    Clock(dut.clk_i, 10, unit="ns").start()
    for clock in range(60):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        count = 0 if 30 <= clock < 33 else (count + 1) % 2**48
        assert bench.read(dut.now_o) == count, clock
        await FallingEdge(dut.clk_i)
        dut.rst_i.value = int(29 <= clock < 32)
    await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def keeps_whether_the_last_centre_was_pressed(dut):
    await begin(dut, {})
    for valid, pressed, kept in ((0, 1, 0), (1, 1, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0), (1, 1, 1), (1, 1, 1)):
        dut.cop_valid_i.value, dut.cop_i.value = valid, members.word("cop", {"pressed": pressed, "x": -1})
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        assert dut.pressed_o.value == kept, (valid, pressed)
        await FallingEdge(dut.clk_i)
    dut.rst_i.value = 1  # a pressed centre in its clock
    await RisingEdge(dut.clk_i)
    dut.rst_i.value = dut.cop_valid_i.value = 0
    await ReadOnly()
    assert dut.pressed_o.value == 0
    await RisingEdge(dut.clk_i)


@bench.applies(has_line)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def full_load_and_registers(dut):
    rates = {"slip": 0.0006, "cop": 0.02, "health": 0.01, "image": 1.0}
    _, sources, counters = await begin(dut, rates)
    registers = Registers(dut)
    asked = [(WRITE, 1, 0x10, 0x1234), (READ, 2, 0x10, 0), (READ, 3, 0x804, 0), (READ, 4, 0, 0)]
    wait = [1] * 7000
    rx = [1] * 400 + [level for ask in asked for level in levels(command(*ask), CLK, BAUD) + wait]
    line = []
    for clock, level in enumerate(rx + [1] * 20_000):
        dut.rx_i.value = level
        registers.before()
        if clock == len(rx) // 2:
            sources["cop"].rate = 0  # now health gets its turn
        for source in sources.values():
            if clock == len(rx):
                source.rate = 0
            source.before(clock)
        await bench.ReadOnly()
        line.append(bench.read(dut.tx_o))
        registers.after()
        for source in sources.values():
            source.after()
        await bench.RisingEdge(dut.clk_i)
    got, decoder = packets_of(line, CLK, BAUD)
    assert decoder.damaged == 0 and bench.unbroken(got)
    assert told(dut)["packets"] == len(got)
    of_kind = packet.check(dut, got, sources, counters, parameters(dut))
    assert set(of_kind) == {p.SLIP, p.COP, p.IMAGE, p.HEALTH, p.STATISTIC, p.ANSWER}
    assert len(of_kind[p.SLIP]) > 5 and len(of_kind[p.HEALTH]) > 2
    assert told(dut)["image_dropped"] > 0
    answers = [tuple(q.fields.values()) for q in of_kind[p.ANSWER]]
    absent = [address ^ 0x5A5A0000 for address in (0x804, 0)]
    assert answers == [
        (1, DONE, 0x10, 0x1234),
        (2, DONE, 0x10, 0x1234),
        (3, BUS_ERROR, 0x804, absent[0]),
        (4, DONE, 0, absent[1]),
    ]
    assert told(dut)["rejected"] == 0


@bench.applies(has_line)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def commands_of_every_bit_on_a_quiet_line(dut):
    """Writes and reads, errors, a bus that does not answer, and a corrupted command."""
    await begin(dut, {})
    registers = Registers(dut)
    asked = [(WRITE, 0x55, 0x2AA, 0x5555_5555), (WRITE, 0xAA, 0x155, 0xAAAA_AAAA)]
    asked += [(READ, 0xFF, 0x2AA, 0), (READ, 0, 0x155, 0), (READ, 1, 0xBFC, 0), (READ, 2, 0x400, 0)]
    asked += [(READ, 3, 0, 0)]
    spoilt = bytearray(command(READ, 4, 0))
    spoilt[3] ^= 2
    frames = [*(command(*ask) for ask in asked), bytes(spoilt)]
    line = []
    for level in [level for frame in frames for level in [*levels(frame, CLK, BAUD), *[1] * 1600]]:
        dut.rx_i.value = level
        registers.before()
        await bench.ReadOnly()
        line.append(bench.read(dut.tx_o))
        registers.after()
        await bench.RisingEdge(dut.clk_i)
    got, decoder = packets_of(line, CLK, BAUD)
    assert decoder.damaged == 0 and bench.unbroken(got)
    answers = [tuple(q.fields.values()) for q in got if q.kind == p.ANSWER]
    assert answers.pop(5)[:3] == (2, NO_ANSWER, 0x400)
    assert answers == [
        (0x55, DONE, 0x2AA, 0x5555_5555),
        (0xAA, DONE, 0x155, 0xAAAA_AAAA),
        (0xFF, DONE, 0x2AA, 0x5555_5555),
        (0, DONE, 0x155, 0xAAAA_AAAA),
        (1, BUS_ERROR, 0xBFC, 0xBFC ^ 0x5A5A0000),
        (3, DONE, 0, 0x5A5A0000),
    ]
    assert told(dut)["rejected"] == 1


@bench.applies(lambda dut: number(dut, "BaudHz") == SLOW["BaudHz"])
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_command_that_pauses_is_given_up_after_ten_ms(dut):
    """docs/link.md; 1000 clocks at 100 kHz, in a link that is not told how many."""
    await begin(dut, {})
    for level in levels(command(READ, 1, 0x10)[:-3], 100_000, 25_000):
        dut.rx_i.value = level
        await RisingEdge(dut.clk_i)
    waited = 0
    while told(dut)["rejected"] == 0:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        waited += 1
        assert waited < 1100
    assert waited in range(990, 1011)
    await RisingEdge(dut.clk_i)


@bench.applies(has_line)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def first_edge_of_an_event(dut):
    """The idle line falls 4 clocks after the event was taken, and the packet follows without a gap."""
    slip = (await begin(dut, {}))[1]["slip"]
    await bench.clocks(dut, 2)
    for _ in range(3):
        slip.sent.clear()
        slip.rate, line = 1, []
        count = told(dut)["packets"]
        for clock in range(1400):
            slip.before(0)
            await bench.ReadOnly()
            line.append(bench.read(dut.tx_o))
            slip.after()
            slip.rate = 0
            await bench.RisingEdge(dut.clk_i)
            if clock == 0:
                dut.decision_valid_i.value = 0
        assert line.index(0) == 4
        ((time, kind, payload),) = slip.sent
        expected = line_of([p.packet(kind, count, time, payload)], CLK, BAUD)
        assert line[4 : 4 + len(expected)] == expected


@bench.applies(lambda dut: not number(dut, "Uart") and number(dut, "SlipChannels") == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.7])
async def without_a_line_packets_are_bytes(dut, rate):
    rates = {"slip": 0.02, "cop": 0.02, "health": 0.01, "image": 1.0}  # more events than a line could carry
    stall = bench.pauses(rate, "stalls")
    test, sources, counters = await begin(dut, rates, lambda: not stall())

    async def line():
        """The line must be ignored as an input and stay high as an output."""
        while True:
            dut.rx_i.value = not dut.rx_i.value
            await bench.RisingEdge(dut.clk_i)
            assert dut.tx_o.value == 1

    watching = cocotb.start_soon(line())
    await test.run(9_000)
    await test.run(12_000, quiet=True)  # 9 statistics come in 2^10 clocks each
    while test.bytes:  # a statistic is still being sent
        await test.run(1, quiet=True)
    watching.cancel()
    of_kind = packet.check(dut, test.decoded(), sources, counters, parameters(dut))
    assert set(of_kind) == {p.SLIP, p.COP, p.IMAGE, p.HEALTH, p.STATISTIC} and len(of_kind[p.STATISTIC]) > 9
    assert told(dut)["packets"] == len(test.packets) > 20 and told(dut)["rejected"] == 0


@bench.applies(whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def without_a_line_the_bus_is_the_hosts(dut):
    """Both directions pass in the same clock; in a build with a line the host's side does nothing."""
    rng = np.random.default_rng(bench.SEED)
    await begin(dut, {})
    uart = dut.Uart.value.to_unsigned()
    widths = BUS
    for _ in range(50):
        asked = {name: int(rng.integers(1 << width)) for name, width in widths.items()}
        answer = {
            "done": int(rng.integers(2)),
            "error": int(rng.integers(2)),
            "rdata": int(rng.integers(1 << 32)),
        }
        for name, value in asked.items():
            getattr(dut, f"host_{name}_i").value = value
        for name, value in answer.items():
            getattr(dut, f"bus_{name}_i").value = value
        await bench.ReadOnly()
        got = {name: bench.read(getattr(dut, f"bus_{name}_o")) for name in widths}
        host = {name: bench.read(getattr(dut, f"host_{name}_o")) for name in answer}
        assert host == (dict.fromkeys(answer, 0) if uart else answer)
        assert got["valid"] == 0 if uart else got == asked
        await bench.RisingEdge(dut.clk_i)


async def pulse(dut, **inputs):
    for name, value in inputs.items():
        getattr(dut, f"{name}_i").value = value
    await RisingEdge(dut.clk_i)
    for name in inputs:
        if name.endswith("valid"):
            getattr(dut, f"{name}_i").value = 0


@bench.applies(lambda dut: not number(dut, "Uart") and number(dut, "SlipChannels") == 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_event_is_raised_and_takes_its_turn(dut):
    """A decision without a change is taken at once and not sent; a start waits while the queue is full."""
    stalled = False
    test, *_ = await begin(dut, {}, lambda: not stalled)
    dut.decision_valid_i.value, dut.decision_i.value = 1, members.word("decision", {"state": 0, "p2p": 7})
    for _ in range(20):
        await ReadOnly()
        assert dut.decision_ready_o.value == 1
        await RisingEdge(dut.clk_i)
    dut.out_ready_i.value = 0
    dut.decision_i.value = members.word("decision", {"raised": 1, "state": 2, "p2p": 7, "id": 9})
    taken = 0
    for _ in range(60):
        await ReadOnly()
        taken += dut.decision_ready_o.value == 1
        await RisingEdge(dut.clk_i)
    dut.decision_i.value = members.word("decision", {"state": 2, "p2p": 7})
    await ReadOnly()
    assert dut.decision_ready_o.value == 1
    await RisingEdge(dut.clk_i)
    dut.decision_valid_i.value = 0
    assert number(dut, "SlipDepth") <= taken < 60
    await test.run(80 * taken)
    slips = [q.payload for q in test.decoded() if q.kind == p.SLIP]
    assert slips == [bytes.fromhex("0900 070000 02")] * taken


async def decide(dut, **word):
    """Offer a decision for at most 4 clocks; whether it was taken."""
    dut.decision_valid_i.value, dut.decision_i.value = 1, members.word("decision", word)
    for _ in range(4):
        await ReadOnly()
        taken = dut.decision_ready_o.value == 1
        await RisingEdge(dut.clk_i)
        if taken:
            break
    dut.decision_valid_i.value = 0
    return taken


@bench.applies(lambda dut: number(dut, "SlipChannels") > 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def every_channel_changes_in_one_detail(dut):
    """On a line that stands still: the queue takes as many changes as half its depth and two, and then none;
    each of the others comes late with the next detail after there is room, or is counted lost if its channel
    changes before. Starts of a slip fill the queue to its end, and then hold the decisions up. Then the
    states of all channels on request."""
    stalled = True
    test, *_ = await begin(dut, {}, lambda: not stalled)
    channels, depth = number(dut, "SlipChannels"), number(dut, "SlipDepth")
    await bench.clocks(dut, channels + 3)

    async def detail(*states, raised=0, p2p=0x10203, gap=9):
        for channel, state in enumerate(states):
            last = channel == len(states) - 1
            word = {"raised": raised, "last": last, "state": state, "p2p": p2p + channel, "id": channel}
            if not await decide(dut, **word):
                return channel
            await test.run(gap)  # 9: the queue's first entries move on
        return len(states)

    lost = lambda: told(dut)["changes_lost"]
    sent = 1 + 2 + depth // 2  # one is being sent, two are in the queue's registers
    assert channels > sent + 3
    assert await detail(*[1] * channels) == channels and lost() == 0
    assert await detail(*[1] * channels) == channels and lost() == 0
    # Two that had no room change again; one of them back to what the host has.
    assert await detail(*[1] * (channels - 2), 4, 0) == channels
    assert lost() == 1 + 2
    # Starts: the first waits in no case for the line, up to the queue's end.
    room = depth - depth // 2
    assert await detail(*[2] * channels, raised=1) == room
    stalled = False
    await test.run(2_000)
    assert await detail(*[2] * room, *[1] * (channels - room - 2), 4, 0, gap=120) == channels
    got = [q for q in test.decoded() if q.kind in (p.SLIP, p.CHANGE)]
    change = lambda channel, last: (6, bytes([channel, 0, 3 + channel, 2, 1, last]))
    start = lambda channel: (1, bytes([channel, 0, 3 + channel, 2, 1, 2]))
    wanted = [change(channel, 0x01) for channel in range(sent)]
    wanted += [start(channel) for channel in range(room)]
    late = [channel for channel in range(channels - 2) if channel >= sent]
    wanted += [change(channel, 0x81) for channel in late] + [change(channels - 2, 0x84)]
    assert [(q.kind, q.payload) for q in got] == wanted and {q.time for q in got} == {TIME}
    assert lost() == 3
    states = [2] * room + [1] * (channels - room - 2) + [4, 0]
    dut.cfg_i.value = members.word("link_cfg", ALL | {"states": -1})
    await RisingEdge(dut.clk_i)
    dut.cfg_i.value = members.word("link_cfg", ALL)
    await test.run(2_000)
    (q,) = [q for q in test.decoded() if q.kind == p.STATES]
    assert q.payload[:4] == bytes([0, 0, channels, 0])
    assert [byte >> shift & 15 for byte in q.payload[4:] for shift in (0, 4)][:channels] == states
    assert len(q.payload) == 4 + 2 * -(-channels // 4)


@bench.applies(lambda dut: number(dut, "SlipChannels") > 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_bit_of_events_is_its_own_states(dut):
    test, *_ = await begin(dut, {})
    channels = number(dut, "SlipChannels")
    names = ("none", "contact", "incipient", "gross", "release")
    way = [(1, 0), (2, 1), (3, 0), (1, 0), (4, 0), (0, 0)]
    for alone in range(5):
        dut.cfg_i.value = members.word("link_cfg", {f"events_{names[alone]}": -1})
        await bench.reset(dut)
        await bench.clocks(dut, channels + 3)
        test.packets.clear()
        for state, raised in way:
            assert await decide(dut, raised=raised, last=0, state=state, id=0)
            await test.run(120)
        got = [q.payload[5] & 7 for q in test.decoded() if q.kind in (p.SLIP, p.CHANGE)]
        assert got == [state for state, _ in way if state == alone]


@bench.applies(lambda dut: number(dut, "SlipOnly"))
@cocotb.test(timeout_time=2, timeout_unit="ms")
async def the_small_link_sends_an_event_alone(dut):
    await begin(dut, {})
    await pulse(dut, cop_valid=1, health_valid=1, image_valid=1, image_last=1)
    dut.convert_i.value = 1
    await RisingEdge(dut.clk_i)
    dut.convert_i.value, dut.decision_valid_i.value = 0, 1
    dut.decision_i.value = members.word("decision", {"raised": 1, "last": 1, "state": 2, "p2p": 300})

    async def sent():
        """The bytes of the next 3000 clocks: 8 clocks a bit, 10 bits a byte."""
        levels = []
        for _ in range(3000):
            await ReadOnly()
            levels.append(bench.read(dut.tx_o))
            taken = dut.decision_ready_o.value == 1
            await RisingEdge(dut.clk_i)
            if taken and dut.decision_valid_i.value == 1:
                if len(levels) < 300:  # the slip ends while its packet leaves: no room, and nothing waits
                    dut.decision_i.value = members.word("decision", {"last": 1, "state": 1, "p2p": 5})
                else:
                    dut.decision_valid_i.value = 0
        starts, clock = [], 0
        while clock < len(levels):
            if levels[clock] == 0:
                starts.append(clock)
                clock += 8 * 10 - 4
            clock += 1
        return bytes(sum(levels[at + 4 + 8 * (bit + 1)] << bit for bit in range(8)) for at in starts)

    # 18 bytes, the first COBS code, and a zero before and after.
    data = await sent()
    assert len(data) == 21 and (data[0], data[-1]) == (0, 0)
    dut.decision_valid_i.value = 1  # the slip has ended, in a later detail
    (late,) = Decoder().next(await sent())
    assert (late.kind, late.payload.hex()) == (p.CHANGE, "0000050000a1")
    assert (bench.read(dut.status_o), bench.read(dut.health_ready_o), bench.read(dut.bus_valid_o)) == (
        0,
        0,
        0,
    )


EVIDENCE = {
    "equivalence": {"boxes": True, "yosys": "slang joins a port of msn_bridge otherwise"},
    "faults": {
        "size": {"Uart": 0},
        "settle": 8,
        "driver": {
            "packets": 1,
            "frame": "cop_valid_i",
            "when": "cop_valid_i",
            # A waiting image, and its time.
            "kept": "memory read_time_o written_time",
            "slow": 24,
            "rows": 1000,
        },
    },
}


WHOLE = {"ClkKhz": CLK // 1000, "BaudHz": BAUD, "TimeoutClocks": 500, "SlipDepth": 4, "Taxels": TAXELS}
WHOLE |= {"Chunk": CHUNK}
LINE = WHOLE | {"Uart": 1, "StatisticBits": 12, "Array": 1}
BYTES = WHOLE | {"Uart": 0, "StatisticBits": 10}
CHANGES = BYTES | {"SlipChannels": 13, "Statistics": 0, "Taxels": 0, "Health": 0, "Cop": 0}
SLOW = {"ClkKhz": 100, "BaudHz": 25_000}
SMALL = {"ClkKhz": 4000, "BaudHz": 500_000, "SlipOnly": 1, "Registers": 0, "DetailBits": 14}


@pytest.mark.parametrize("build", [LINE, BYTES, CHANGES, SMALL], ids=["line", "bytes", "changes", "small"])
def test_link(build):
    bench.run("link", "link", build)


def test_link_with_the_time_out_of_a_core():
    bench.run("link", "link", SLOW, "a_command_that_pauses_is_given_up_after_ten_ms")


@pytest.mark.parametrize("count", [1, 5])
def test_model_there_and_back(count):
    packets = [p.packet(p.HEALTH, number, 5, p.health(number, 3)) for number in range(count)]
    got, decoder = packets_of([1] * 50 + line_of(packets) + [1] * 50)
    assert [p.packet(q.kind, q.number, q.time, q.payload) for q in got] == packets
    assert decoder.damaged == 0
