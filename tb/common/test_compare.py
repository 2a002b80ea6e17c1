"""msn_compare against its model: every pair of corners and neighbours, then random pairs."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import Timer

import bench
from harness.refusals import refusals
from meissner.twins.common.arithmetic import compare


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def matches_model(dut):
    bits = dut.Width.value.to_unsigned()
    low, high = bench.width(bits)
    corners = sorted({max(low, min(high, v)) for v in (low, low + 1, -1, 0, 1, high - 1, high)})
    rng = np.random.default_rng(bench.SEED)
    random = rng.integers(low, high + 1, (500, 2))
    pairs = [(a, b) for a in corners for b in corners] + random.tolist() + [(a, a) for a, _ in random]
    mask = (1 << bits) - 1
    for a, b in pairs:
        dut.a_i.value, dut.b_i.value = int(a) & mask, int(b) & mask
        await Timer(1, "ns")
        assert bool(dut.greater_o.value) == compare(a, b, bits), (a, b)


EVIDENCE = {
    "equivalence": {"size": {"Width": 18}},
    "faults": {"none": "no state"},
}

SPACE = lambda draw: {"Width": draw.randint(1, 60)}


@pytest.mark.parametrize("width", [1, 18])
def test_compare(width):
    bench.run("common", "compare", {"Width": width})


test_refuses_illegal_parameters = refusals("compare", compare, {"Width": 0}, a=0, b=0)


def test_refuses_numbers_beyond_the_width():
    with pytest.raises(ValueError):
        compare(2, 0, 2)
