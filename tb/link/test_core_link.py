"""msn_core_link: each member of the core's decisions, results and reports, and each counter of its status, at
its place in its packet, by hand from docs/link.md; the host's bus passed through; with SlipOnly the small
link's line; the clock count and whether the last centre of pressure was pressed."""

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer

import bench
import members

TAXELS, TIME = 6, 0xFEDC_BA98_7654
# The order of docs/link.md: the counters of a core with a converter, and of one with an array.
REST = ("slip_damaged", "slip_blanked", "cop_damaged", "link_image_dropped", "link_rejected")
COUNTERS = {
    0: ("adc_dropped", "adc_overrun", "adc_timeout", *REST),
    1: ("scan_dropped", "scan_overrun", "scan_lost", *REST),
}
BUS = ("valid", "write", "address", "wdata", "strobe")


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


async def begin(dut):
    names = "status convert decision_valid decision cop_valid cop health_valid health image_valid image_data"
    names += " image_last bus_done bus_error bus_rdata " + " ".join(f"host_{name}" for name in BUS)
    await bench.start(dut, **{f"{name}_i": 0 for name in names.split()}, rx_i=1, time_i=TIME)


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
    await begin(dut)
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


async def packets(dut, clocks):
    """(kind, time, payload) of the packets that leave within ``clocks`` clocks."""
    found, data = [], bytearray()
    dut.out_ready_i.value = 1
    for _ in range(clocks):
        await ReadOnly()
        if dut.out_valid_o.value == 1:
            data.append(bench.read(dut.out_data_o))
            if dut.out_last_o.value == 1:
                found.append((data[0], int.from_bytes(data[2:8], "little"), bytes(data[8:-4])))
                data.clear()
        await RisingEdge(dut.clk_i)
    return found


async def pulse(dut, **inputs):
    for name, value in inputs.items():
        getattr(dut, f"{name}_i").value = value
    await RisingEdge(dut.clk_i)
    for name in inputs:
        if name.endswith("valid"):
            getattr(dut, f"{name}_i").value = 0


@bench.applies(lambda dut: not number(dut, "SlipOnly"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def each_member_is_at_its_place(dut):
    await begin(dut)
    event = {"raised": 1, "last": 0, "state": 3, "p2p": 0xA1B2C3, "id": 0x4D5E}
    await pulse(dut, decision_valid=1, decision=members.word("decision", event))
    assert (1, TIME, bytes.fromhex("5e4d c3b2a1 03")) in await packets(dut, 300)
    cop = {"x": -2, "y": 0x123456, "load": 0x9A_8765_4321, "pressed": 1}
    await pulse(dut, cop_valid=1, cop=members.word("cop", cop))
    assert (2, TIME, bytes.fromhex("feffff 563412 214365879a 01")) in await packets(dut, 300)
    health = members.word("health", {"id": 0x0F1E2D, "faults": 5})
    dut.health_i.value, dut.health_valid_i.value = health, 1
    await ReadOnly()
    while dut.health_ready_o.value != 1:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
    await RisingEdge(dut.clk_i)
    dut.health_valid_i.value = 0
    assert bytes.fromhex("2d1e0f 05") in [
        payload for kind, _, payload in await packets(dut, 300) if kind == 4
    ]
    for taxel in range(TAXELS):
        last = int(taxel == TAXELS - 1)
        await pulse(dut, image_valid=1, image_data=0x1100 + taxel, image_last=last)
    images = [payload for kind, _, payload in await packets(dut, 400) if kind == 3]
    assert [payload[-2 * n :] for payload, n in zip(images, (4, 2))] == [
        bytes.fromhex("0011 0111 0211 0311"),
        bytes.fromhex("0411 0511"),
    ]


@bench.applies(lambda dut: not number(dut, "SlipOnly"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_event_is_raised_and_takes_its_turn(dut):
    """A decision without a raised event is taken immediately and not sent; an event waits while the queue is
    full."""
    await begin(dut)
    dut.decision_valid_i.value, dut.decision_i.value = 1, members.word("decision", {"state": 1, "p2p": 7})
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
    dut.decision_i.value = members.word("decision", {"state": 1, "p2p": 7})
    await ReadOnly()
    assert dut.decision_ready_o.value == 1
    await RisingEdge(dut.clk_i)
    dut.decision_valid_i.value = 0
    assert number(dut, "SlipDepth") <= taken < 60
    slips = [payload for kind, _, payload in await packets(dut, 80 * taken) if kind == 1]
    assert slips == [bytes.fromhex("0900 070000 02")] * taken
    status = members.of("link_status", bench.read(dut.status_o))
    assert status["packets"] >= taken and status["rejected"] == 0


@bench.applies(lambda dut: not number(dut, "SlipOnly"))
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def each_counter_has_its_number(dut):
    await begin(dut)
    names = COUNTERS[number(dut, "Array")]
    values = {name: 0x0101_0101 * (3 + 7 * place) for place, name in enumerate(names)}
    others = {name: 0 for name in members.PLACES["status"] if name not in values}
    others |= {name: 0x55 for name in ("adc_mistagged", "adc_over_range", "scan_held", "tare_swallowed")}
    dut.status_i.value = members.word("status", values | others)
    got = [payload for kind, _, payload in await packets(dut, 9 << number(dut, "StatisticBits")) if kind == 5]
    expected = {bytes([place]) + value.to_bytes(4, "little") for place, value in enumerate(values.values())}
    assert set(got) == expected


@bench.applies(lambda dut: not number(dut, "SlipOnly"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_hosts_bus_goes_straight_through(dut):
    await begin(dut)
    for turn in range(1, 40):
        asked = {name: turn * 0x9E3779B1 >> 3 & (1 << len(getattr(dut, f"bus_{name}_o"))) - 1 for name in BUS}
        answer = {
            name: turn * 0x85EBCA6B >> 5 & (1 << n) - 1
            for name, n in (("done", 1), ("error", 1), ("rdata", 32))
        }
        for name, value in asked.items():
            getattr(dut, f"host_{name}_i").value = value
        for name, value in answer.items():
            getattr(dut, f"bus_{name}_i").value = value
        await ReadOnly()
        assert {name: bench.read(getattr(dut, f"bus_{name}_o")) for name in BUS} == asked
        assert {name: bench.read(getattr(dut, f"host_{name}_o")) for name in answer} == answer
        await RisingEdge(dut.clk_i)


@bench.applies(lambda dut: number(dut, "SlipOnly"))
@cocotb.test(timeout_time=2, timeout_unit="ms")
async def the_small_link_sends_an_event_alone(dut):
    await begin(dut)
    await pulse(dut, cop_valid=1, health_valid=1, image_valid=1, image_last=1)
    dut.convert_i.value = 1
    await RisingEdge(dut.clk_i)
    dut.convert_i.value, dut.decision_valid_i.value = 0, 1
    dut.decision_i.value = members.word("decision", {"raised": 1, "last": 1, "state": 2, "p2p": 300})
    levels = []
    for _ in range(3000):
        await ReadOnly()
        levels.append(bench.read(dut.tx_o))
        taken = dut.decision_ready_o.value == 1
        await RisingEdge(dut.clk_i)
        if taken:
            dut.decision_valid_i.value = 0
    # 8 clocks a bit, 10 bits a byte; 18 bytes, the first COBS code, and a zero before and after.
    starts, clock = [], 0
    while clock < len(levels):
        if levels[clock] == 0:
            starts.append(clock)
            clock += 8 * 10 - 4
        clock += 1
    data = bytes(sum(levels[at + 4 + 8 * (bit + 1)] << bit for bit in range(8)) for at in starts)
    assert len(data) == 21 and (data[0], data[-1]) == (0, 0)
    assert (bench.read(dut.status_o), bench.read(dut.health_ready_o), bench.read(dut.bus_valid_o)) == (
        0,
        0,
        0,
    )


WHOLE = {"ClkKhz": 4000, "Uart": 0, "SlipDepth": 4, "StatisticBits": 10, "Taxels": TAXELS, "Chunk": 4}
SMALL = {"ClkKhz": 4000, "BaudHz": 500_000, "SlipOnly": 1, "Registers": 0, "DetailBits": 14}


EVIDENCE = {
    "reference": {"joins": "link or link_slip; members checked at the packets' bytes, by hand"},
    "equivalence": {"boxes": True, "open": ["reset"]},
}


@pytest.mark.parametrize(
    "parameters",
    [WHOLE | {"Health": 1}, WHOLE | {"Health": 1, "Array": 1}, SMALL],
    ids=["adc", "array", "slip"],
)
def test_core_link(parameters):
    bench.run("link", "core_link", parameters)
