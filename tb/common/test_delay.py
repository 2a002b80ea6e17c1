"""msn_delay against its model: every small depth, with and without gaps in the steps, and a block RAM."""

import random

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.delay import Delay


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.5])
async def matches_model(dut, gap_rate):
    depth = dut.Depth.value.to_unsigned()
    x = np.random.default_rng(bench.SEED).integers(0, 1 << len(dut.in_data_i), 5 * depth + 20)
    expected = Delay(depth).process(x)
    await bench.start(dut, step_i=0)
    draw = random.Random(bench.SEED)
    for index, value in enumerate(x):
        dut.step_i.value = 0
        while draw.random() < gap_rate:
            dut.in_data_i.value = ~int(value) & ((1 << len(dut.in_data_i)) - 1)
            await bench.clocks(dut, 1)
        dut.step_i.value = 1
        dut.in_data_i.value = int(value)
        await bench.ReadOnly()
        if index >= depth:
            assert bench.read(dut.out_data_o) == expected[index], f"step {index}"
        await bench.RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {"size": {"Depth": 7}, "reset": {"ties": {"step_i": 1}, "clocks": 9}},
    "faults": {"settle": 12, "driver": {"frame": "step_i"}},
}

SPACE = lambda draw: {"Depth": draw.randint(1, 90), "Width": 9}


@pytest.mark.parametrize("depth", [1, 2, 3, 4, 7, 1000])
def test_delay(depth):
    bench.run("common", "delay", {"Depth": depth, "Width": 9})


def test_model_in_chunks():
    x = np.arange(50)
    line = Delay(7)
    chunks = np.concatenate([line.next(part) for part in np.split(x, [3, 4, 20])])
    assert np.array_equal(chunks, Delay(7).process(x))


test_refuses_illegal_parameters = refusals("delay", Delay, {"Depth": 0}, alone=[{"Width": 0}])
