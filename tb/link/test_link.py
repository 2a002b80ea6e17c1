"""msn_link from events to the levels of the line, and from the line to the register bus, with the models of
both lines: at full load no slip event is lost and every image is complete, with register accesses in between;
the clocks from an event to the line's first edge. Without a line: packets byte by byte, and the host's bus
passed through."""

import cocotb
import numpy as np
import pytest

import bench
from link import test_packet as packet
from link.test_bridge import Registers
from meissner.twins.link import packet as p
from meissner.twins.link.bridge import BUS_ERROR, DONE, NO_ANSWER, READ, WRITE, command
from meissner.twins.link.link import line_of, packets_of
from meissner.twins.link.uart_tx import levels

CLK, BAUD, TAXELS, CHUNK = 12_000_000, 3_000_000, 36, 16
HOST = ("host_valid", "host_write", "host_address", "host_wdata", "host_strobe")


async def begin(dut, rates, ready=lambda: True):
    """The bench of msn_packet's test, without register accesses."""
    rest = {f"{name}_i": 0 for name in ("bus_done", "bus_error", "bus_rdata", *HOST)}
    return await packet.begin(dut, np.random.default_rng(bench.SEED), rates, ready, rx_i=1, **rest)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    counters = ["packets_o", "cop_dropped_o", "image_dropped_o", "rejected_o"]
    await bench.turn_over(dut, *counters, most=3, wraps=False)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    counters = ["packets_o", "cop_dropped_o", "image_dropped_o", "rejected_o"]
    await bench.inputs_in_reset(dut, "out_valid_o", *counters)
    assert dut.tx_o.value == 1


@bench.applies(lambda dut: dut.Uart.value.to_unsigned())
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
        dut.rx_i.value, dut.now_i.value = level, bench.time(clock)
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
    assert (decoder.damaged, decoder.missed) == (0, 0)
    assert bench.read(dut.packets_o) == len(got)
    of_kind = packet.check(dut, got, sources, counters, packet.parameters(dut))
    assert set(of_kind) == {p.SLIP, p.COP, p.IMAGE, p.HEALTH, p.STATISTIC, p.ANSWER}
    assert len(of_kind[p.SLIP]) > 5 and len(of_kind[p.HEALTH]) > 2
    assert bench.read(dut.image_dropped_o) > 0
    answers = [tuple(q.fields.values()) for q in of_kind[p.ANSWER]]
    absent = [address ^ 0x5A5A0000 for address in (0x804, 0)]
    assert answers == [
        (1, DONE, 0x10, 0x1234),
        (2, DONE, 0x10, 0x1234),
        (3, BUS_ERROR, 0x804, absent[0]),
        (4, DONE, 0, absent[1]),
    ]
    assert bench.read(dut.rejected_o) == 0


@bench.applies(lambda dut: dut.Uart.value.to_unsigned())
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
    assert (decoder.damaged, decoder.missed) == (0, 0)
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
    assert bench.read(dut.rejected_o) == 1


@bench.applies(lambda dut: dut.Uart.value.to_unsigned())
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def first_edge_of_an_event(dut):
    """The idle line falls 4 clocks after the event was taken, and the packet follows without a gap."""
    slip = (await begin(dut, {}))[1]["slip"]
    await bench.clocks(dut, 2)
    for _ in range(3):
        slip.sent.clear()
        slip.rate, line = 1, []
        number = bench.read(dut.packets_o)
        for clock in range(1400):
            slip.before(0)
            await bench.ReadOnly()
            line.append(bench.read(dut.tx_o))
            slip.after()
            slip.rate = 0
            await bench.RisingEdge(dut.clk_i)
            if clock == 0:
                dut.slip_valid_i.value = 0
        assert line.index(0) == 4
        expected = line_of([p.packet(p.SLIP, number, *slip.sent[0])], CLK, BAUD)
        assert line[4 : 4 + len(expected)] == expected


@bench.applies(lambda dut: not dut.Uart.value.to_unsigned())
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
    await test.run(3_000, quiet=True)
    while test.bytes:  # a statistic is still being sent
        await test.run(1, quiet=True)
    watching.cancel()
    of_kind = packet.check(dut, test.decoded(), sources, counters, packet.parameters(dut))
    assert set(of_kind) == {p.SLIP, p.COP, p.IMAGE, p.HEALTH, p.STATISTIC}
    assert bench.read(dut.packets_o) == len(test.packets) > 20
    assert bench.read(dut.rejected_o) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def without_a_line_the_bus_is_the_hosts(dut):
    """Both directions pass in the same clock; in a build with a line the host's side does nothing."""
    rng = np.random.default_rng(bench.SEED)
    await begin(dut, {})
    uart = dut.Uart.value.to_unsigned()
    widths = {"valid": 1, "write": 1, "address": 12, "wdata": 32, "strobe": 4}
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
        told = {name: bench.read(getattr(dut, f"host_{name}_o")) for name in answer}
        assert told == (dict.fromkeys(answer, 0) if uart else answer)
        assert got["valid"] == 0 if uart else got == asked
        await bench.RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {"boxes": True, "yosys": "slang joins a port of msn_bridge otherwise", "open": ["reset"]},
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


@pytest.mark.parametrize("uart", [1, 0])
def test_link(uart):
    build = {
        "ClkHz": CLK,
        "BaudHz": BAUD,
        "TimeoutClocks": 500,
        "SlipDepth": 4,
        "Statistics": 3,
        "StatisticBits": 12 if uart else 10,
        "Taxels": TAXELS,
        "Chunk": CHUNK,
    }
    bench.run("link", "link", build | {"Uart": uart})


@pytest.mark.parametrize("count", [1, 5])
def test_model_there_and_back(count):
    packets = [p.packet(p.HEALTH, number, 5, p.health(number, 3)) for number in range(count)]
    got, decoder = packets_of([1] * 50 + line_of(packets) + [1] * 50)
    assert [p.packet(q.kind, q.number, q.time, q.payload) for q in got] == packets
    assert (decoder.damaged, decoder.missed) == (0, 0)
