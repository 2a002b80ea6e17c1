"""msn_link_slip from changes to the levels of the line, as its twin computes them; there is room between
packets; a change carries the clock of its convert start."""

import cocotb
import numpy as np
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.link.link import link_slip
from meissner.twins.link.uart import UartRx
from meissner.twins.slip.slip_changes import Change

CLK, BAUD, BITS = 4_000_000, 500_000, 14


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def changes_are_the_models_levels(dut):
    await bench.start(dut, convert_i=0, in_i=0)
    rng, line, events, clock = np.random.default_rng(bench.SEED), [], [], 0

    async def step(convert=0, change=None):
        """One clock; returns whether the change was taken."""
        nonlocal clock
        dut.convert_i.value, dut.in_valid_i.value = convert, int(change is not None)
        dut.in_i.value = members.word("change", change or {"start": 1, "state": 7, "id": 0xFFFF})
        await ReadOnly()
        busy = bool(events) and clock < events[-1][0] + 21 * 10 * CLK // BAUD
        assert busy or dut.room_o.value == 1
        line.append(bench.read(dut.tx_o))
        taken = change is not None and dut.in_ready_o.value == 1
        await RisingEdge(dut.clk_i)
        clock += 1
        return taken

    for turn in range(6):
        start = clock
        await step(convert=1)
        for _ in range(int(rng.integers(3, 150))):
            await step()
        state, p2p = 1 + turn % 4, int(rng.choice([0, (1 << BITS) - 1, rng.integers(1 << BITS)]))
        change = Change(turn % 2 == 1, turn > 3, 4 - turn % 5, state)
        while not await step(0, {"p2p": p2p, "id": 5} | change._asdict()):
            pass
        events.append((start, p2p, change))
        for place in range(21 * 10 * CLK // BAUD + 300):
            await step()
            assert place != 1000 or dut.room_o.value == 0
    byte = lambda levels: [value for _, value in UartRx(CLK, BAUD).process(levels)]
    assert byte(line) == byte([1] * 9 + list(link_slip(events, BITS, CLK, BAUD)) + [1] * 99)
    assert len(byte(line)) == 6 * 21


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut)
    assert dut.tx_o.value == 1


EVIDENCE = {"faults": {"none": "msn_packet_slip, msn_cobs and msn_uart_tx in a row, each done alone"}}


def test_link_slip():
    bench.run("link", "link_slip", {"ClkHz": CLK, "BaudHz": BAUD, "P2pBits": BITS})
