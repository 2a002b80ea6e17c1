"""AXI4-Lite: an independent master (cocotbext-axi) with stalls on every channel, simultaneous reads and
writes, word and byte writes, errors, reset in the middle. The bench serves the register bus from the
registers' twin.
"""

import itertools
import logging
import random

import cocotb
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer, gather
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiProt, AxiResp

import bench
from meissner.twins.link import axil
from meissner.twins.link.registers import Registers


async def serve(dut, twin, served):
    """The register bus: each access is answered once, two clocks later, as msn_registers does."""
    answers = [None, None]  # (data, error) of the accesses in the clock before and in this one
    while True:
        await ReadOnly()
        asked = dut.bus_valid_o.value == 1
        access = [bench.read(getattr(dut, f"bus_{name}_o")) for name in ("write", "address") if asked]
        for name in ("wdata", "strobe") if asked else ():  # valid for writes only
            access.append(bench.read(getattr(dut, f"bus_{name}_o")) if access[0] else 0)
        if asked:
            served.append(access)
        answers = [answers[1], twin.access(*access)[:2] if asked else None]
        await RisingEdge(dut.clk_i)
        data, error = answers[0] or (0xBAD0_BAD0, 1)
        dut.bus_done_i.value, dut.bus_rdata_i.value = int(answers[0] is not None), data
        dut.bus_error_i.value = int(error)


async def begin(dut):
    logging.getLogger("cocotb").setLevel(logging.WARNING)
    served = []
    await bench.start(dut, bus_done_i=0)
    master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk_i, dut.rst_i)
    cocotb.start_soon(serve(dut, Registers(), served))
    return master, served


def pause(master, rate):
    """Stall every channel with probability ``rate``."""
    write, read = master.write_if, master.read_if
    channels = {"aw": write.aw_channel, "w": write.w_channel, "b": write.b_channel}
    channels |= {"ar": read.ar_channel, "r": read.r_channel}
    for name, channel in channels.items():
        channel.set_pause_generator(iter(bench.pauses(rate, name), None))


def addresses(draw):
    return draw.choice((0x014, 0x104, 0x200, 0x000, *(draw.randrange(0, 0x1000, 4) for _ in range(4))))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def answers_as_the_model(dut):
    """One access after another: each answer is the twin's, and each access reaches it once."""
    master, served = await begin(dut)
    mirror, draw = Registers(), random.Random(bench.SEED)
    for sent in range(800):
        if sent == 400:
            pause(master, 0.5)
        address, size = addresses(draw), draw.choice((4, 4, 2, 1))
        data, protection = draw.randbytes(size), AxiProt(draw.randrange(8))  # protection must not matter
        lane = draw.randrange(0, 4, size)
        writes = draw.random() < 0.5
        if writes:
            answer = await master.write(address + lane, data, protection)
            strobe = ((1 << size) - 1) << lane
            expected = axil.write(mirror, address, int.from_bytes(data, "little") << 8 * lane, strobe)
            assert answer.resp == AxiResp(expected), hex(address)
        else:
            answer = await master.read(address + lane, size, protection)
            value, response = axil.read(mirror, address)
            assert answer.data == value.to_bytes(4, "little")[lane : lane + size]
            assert answer.resp == AxiResp(response)
        assert served[sent][:2] == [writes, address]
    assert len(served) == 800


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(rate=(0.0, 0.3))
async def reads_and_writes_at_once_lose_and_repeat_nothing(dut, rate):
    master, served = await begin(dut)
    if rate:
        pause(master, rate)
    values = []

    async def write():
        for value in range(300):
            await master.write_dword(0x014, value)

    async def read():
        for _ in range(300):
            values.append(await master.read_dword(0x014))

    await gather(write(), read())
    assert values == sorted(values) and len(served) == 600
    assert [access[2] for access in served if access[0]] == list(range(300))
    if not rate:  # they alternate: while both wait, neither is served twice in a row
        kinds = [access[0] for access in served]
        assert not any(kinds[i] == kinds[i + 1] == kinds[i + 2] for i in range(len(kinds) - 2))


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def what_always_waits_takes_turns(dut):
    """A write and a read wait in every clock: they are served alternately, the write first after reset, one
    access at a time."""
    kinds = ("awvalid", "wvalid", "arvalid", "bready", "rready")
    inputs = {f"s_axil_{name}": 1 for name in kinds} | {f"s_axil_{name}": 0 for name in ("awprot", "arprot")}
    inputs |= {"s_axil_awaddr": 0x014, "s_axil_araddr": 0x014, "s_axil_wstrb": 15, "s_axil_wdata": 1}
    served = []
    await bench.start(dut, bus_done_i=0, **inputs)
    cocotb.start_soon(serve(dut, Registers(), served))
    accesses = []
    for clock in range(100):
        await bench.ReadOnly()
        accesses += [clock] if dut.bus_valid_o.value == 1 else []
        await bench.RisingEdge(dut.clk_i)
    # The answer is taken three clocks after the access, and the next is accepted one clock later.
    assert {later - earlier for earlier, later in itertools.pairwise(accesses)} == {4}
    assert len(served) > 20
    assert [access[0] for access in served] == [1, 0] * (len(served) // 2) + [1] * (len(served) % 2)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_reset_in_the_middle_leaves_no_answer_behind(dut):
    """Reset at every clock of an access: no unrequested answer appears, and the next access is right."""
    idle = {
        f"s_axil_{name}": 0
        for name in ("awvalid", "wvalid", "arvalid", "bready", "rready", "awprot", "arprot")
    }
    twin, served = Registers(), []
    await bench.start(dut, bus_done_i=0, **idle)
    cocotb.start_soon(serve(dut, twin, served))
    for wait in range(6):
        dut.s_axil_araddr.value = 0x000
        dut.s_axil_arvalid.value = 1
        for clock in range(wait):
            await RisingEdge(dut.clk_i)
            dut.s_axil_arvalid.value = int(clock == 0)  # it is taken in the clock after
        dut.s_axil_arvalid.value = 0
        await bench.reset(dut, 2)  # the register block is reset too
        await bench.clocks(dut, 3)
        await ReadOnly()
        assert dut.s_axil_rvalid.value == 0 and dut.s_axil_bvalid.value == 0
        await RisingEdge(dut.clk_i)
    dut.s_axil_arvalid.value = 1
    await bench.clocks(dut, 2)
    dut.s_axil_arvalid.value = 0
    await bench.clocks(dut, 2)
    await ReadOnly()
    assert dut.s_axil_rvalid.value == 1 and bench.read(dut.s_axil_rdata) == 0x4D534E52


INPUTS = [f"s_axil_{name}" for name in ("awvalid", "wvalid", "arvalid", "bready", "rready")]
READIES = [f"s_axil_{name}ready" for name in ("aw", "w", "ar")]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def ready_waits_for_no_valid_of_its_clock(dut):
    """In every clock of random accesses and resets, each READY stays as it is whatever the inputs become; in
    reset all are low, and what was offered there has no answer. AXI: an input may not decide a READY of its
    clock."""
    served, draw, seen, answers = [], random.Random(bench.SEED), set(), 0
    await bench.start(dut, bus_done_i=0, **dict.fromkeys([*INPUTS, "s_axil_awprot", "s_axil_arprot"], 0))
    dut.s_axil_awaddr.value = dut.s_axil_araddr.value = 0x014
    dut.s_axil_wstrb.value, dut.s_axil_wdata.value = 15, 1
    cocotb.start_soon(serve(dut, Registers(), served))
    held = dict.fromkeys(INPUTS, 0)
    for _ in range(2000):
        reset = int(draw.random() < 0.02)
        for name in INPUTS:  # a request stays until it is taken
            held[name] = (
                int(held[name] or draw.random() < 0.4) if name.endswith("valid") else draw.randrange(2)
            )
        dut.rst_i.value = reset
        for name, value in held.items():
            getattr(dut, name).value = value
        await FallingEdge(dut.clk_i)
        readies = set()
        for values in itertools.product((0, 1), repeat=len(INPUTS)):
            for name, value in zip(INPUTS, values):
                getattr(dut, name).value = value
            await Timer(1, "ps")
            readies.add(tuple(bench.read(getattr(dut, name)) for name in READIES))
        for name, value in held.items():
            getattr(dut, name).value = value
        await Timer(1, "ps")
        assert len(readies) == 1
        aw, w, ar = readies.pop()
        assert aw == w and not (aw and ar) and not (reset and (aw or ar))
        seen.add((reset, aw, ar))
        answers += 0 if reset else bench.read(dut.s_axil_bvalid) & held["s_axil_bready"]
        answers += 0 if reset else bench.read(dut.s_axil_rvalid) & held["s_axil_rready"]
        await RisingEdge(dut.clk_i)
        if reset:
            held = dict.fromkeys(INPUTS, 0)
        for name, taken in (("aw", aw), ("w", w), ("ar", ar)):
            held[f"s_axil_{name}valid"] &= not taken
    assert seen == {(0, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)} and answers > 200


EVIDENCE = {
    "equivalence": {
        "reset": {
            "qualifiers": {
                "s_axil_bresp": "s_axil_bvalid",
                "s_axil_rdata": "s_axil_rvalid",
                "s_axil_rresp": "s_axil_rvalid",
            }
        },
    },
    "faults": {
        "settle": 3,
        "driver": {
            "bus": 1,
            "inputs": "s_axil_awvalid s_axil_awaddr s_axil_awprot s_axil_wvalid s_axil_wdata "
            "s_axil_wstrb s_axil_bready s_axil_arvalid s_axil_araddr s_axil_arprot "
            "s_axil_rready",
        },
    },
}


def test_axil():
    bench.run("link", "axil")
