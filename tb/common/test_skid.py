"""msn_skid against its model: words in order, none lost or doubled, with gaps and stalls; no latency;
room for exactly one word while the follower stalls; in_ready_o is a register; reset."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb.utils import get_sim_time

import bench
from harness.refusals import refusals
from meissner.twins.common.handshake import skid


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.4], stall_rate=[0.0, 0.4, 0.8])
async def matches_model(dut, gap_rate, stall_rate):
    await bench.start(dut)
    x = np.random.default_rng(bench.SEED).integers(0, 1 << len(dut.in_data_i), 300)
    beats = [{"data": value} for value in x]
    got = await bench.stream(dut, beats, ["data"], *bench.gaps_and_stalls(gap_rate, stall_rate))
    assert [beat["data"] for beat in got] == skid(x).tolist()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def holds_one_word_and_ready_is_a_register(dut):
    await bench.start(dut)
    await FallingEdge(dut.clk_i)
    dut.in_valid_i.value, dut.in_data_i.value = 1, 5
    await bench.ReadOnly()
    assert (dut.out_valid_o.value, bench.read(dut.out_data_o), dut.in_ready_o.value) == (1, 5, 1)
    await FallingEdge(dut.clk_i)
    dut.in_data_i.value = 9
    dut.out_ready_i.value = 1  # too late for the kept word to make room in this clock
    await bench.ReadOnly()
    assert (dut.out_valid_o.value, bench.read(dut.out_data_o), dut.in_ready_o.value) == (1, 5, 0)
    await FallingEdge(dut.clk_i)
    await bench.ReadOnly()
    assert (dut.out_valid_o.value, bench.read(dut.out_data_o), dut.in_ready_o.value) == (1, 9, 1)
    await FallingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await bench.ReadOnly()
    assert dut.out_valid_o.value == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await bench.start(dut)
    await bench.stream(dut, [{"data": 3}], ["data"], stalls=lambda: True, drain=0)
    await bench.reset(dut)
    assert await bench.stream(dut, [], ["data"]) == []


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def readers_and_clocks_of_the_bench_are_the_simulators(dut):
    """tb/harness/streams.py: it reads the same levels as the handle's own value; ``clocks`` ends at the right
    edge."""
    await bench.start(dut)
    for value in (0, 1, 5, (1 << len(dut.in_data_i)) - 1):
        dut.in_data_i.value = value
        dut.in_valid_i.value = value & 1
        await bench.ReadOnly()
        assert (bench.read(dut.in_data_i), bench.high(dut.in_valid_i)) == (value, value & 1 == 1)
        assert bench.read(dut.in_data_i) == dut.in_data_i.value.to_unsigned()
        await bench.RisingEdge(dut.clk_i)
    for count in (0, 1, 2, 3, 4, 5, 17, 2):
        before = get_sim_time("ns")
        await bench.clocks(dut, count)
        assert get_sim_time("ns") == before + 10 * count
        assert dut.clk_i.value == 1


EVIDENCE = {}

SPACE = lambda draw: {"Width": draw.randint(4, 62)}


def test_skid():
    bench.run("common", "skid")


test_refuses_illegal_parameters = refusals("skid", skid, {"Width": 0}, x=[1])
