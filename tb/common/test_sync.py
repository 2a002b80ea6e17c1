"""msn_sync: any level comes out two clocks later, bit for bit; a narrow and a wide build, random levels."""

import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refusals
from meissner.twins.common.delay import LATENCY, Sync


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def comes_out_two_clocks_later(dut):
    width = len(dut.in_data_i)
    draw = random.Random(bench.SEED)
    sent = [draw.getrandbits(width) for _ in range(500)]
    Clock(dut.clk_i, 10, unit="ns").start()
    received = []
    for value in sent:
        dut.in_data_i.value = value
        await ReadOnly()
        received.append(dut.out_data_o.value)  # unknown at first, if the simulator has X
        await RisingEdge(dut.clk_i)
    assert [int(value) for value in received[LATENCY:]] == list(Sync(width).process(sent))[LATENCY:]


def test_twin_is_the_same_in_pieces():
    x = [random.Random(1).getrandbits(4) for _ in range(100)]
    twin = Sync(4)
    assert [*twin.process(x[:37]), *twin.process(x[37:])] == list(Sync(4).process(x))


EVIDENCE = {
    "equivalence": {"size": {"Width": 5}, "reset": {"clocks": 2}},
}

SPACE = lambda draw: {"Width": draw.randint(1, 40)}


@pytest.mark.parametrize("width", [1, 5])
def test_sync(width):
    bench.run("common", "sync", {"Width": width})


test_refuses_illegal_parameters = refusals("sync", Sync, {"Width": 0})
