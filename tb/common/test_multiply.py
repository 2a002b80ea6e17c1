"""msn_multiply against its model: every pair of corners, then random factors, a product a clock, and with
clocks without enable; the ECP5 version gets the same, with a model of its multiplier cell."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge

import bench
from meissner.builds import toolchain
from meissner.twins.common.arithmetic import multiply

LATENCY = 2
ECP5 = [
    toolchain.ROOT / name
    for name in ("model/meissner/engines/cells/MULT18X18D.v", "rtl/ecp5/msn_multiply.sv")
]


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(rest_rate=[0.0, 0.5])
async def matches_model(dut, rest_rate):
    a_width, b_width = (getattr(dut, name).value.to_unsigned() for name in ("AWidth", "BWidth"))
    rng = np.random.default_rng(bench.SEED)
    low, high = bench.width(a_width)
    top = (1 << b_width) - 1
    pairs = [(a, b) for a in (low, low + 1, -1, 0, 1, high) for b in (0, 1, top >> 1, top)]
    pairs += zip(rng.integers(low, high + 1, 500).tolist(), rng.integers(0, top + 1, 500).tolist())
    expected = multiply(*np.array(pairs).T, a_width, b_width).tolist()
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    rest = bench.pauses(rest_rate, "rests")
    for clock in range(len(pairs) + LATENCY):
        await FallingEdge(dut.clk_i)
        while clock and rest():
            dut.enable_i.value, dut.a_i.value, dut.b_i.value = 0, 1, 1
            await FallingEdge(dut.clk_i)
        dut.enable_i.value = 1
        if clock >= LATENCY:
            got = bench.as_signed(bench.read(dut.y_o), len(dut.y_o))
            assert got == expected[clock - LATENCY], pairs[clock - LATENCY]
        a, b = pairs[min(clock, len(pairs) - 1)]
        dut.a_i.value, dut.b_i.value = a & ((1 << a_width) - 1), b


EVIDENCE = {
    "equivalence": {"reset": {"ties": {"enable_i": 1}, "clocks": 2}},
    # Two registers in a row: the effect of a fault must pass through both.
    "faults": {"settle": 4, "driver": {"frame": "enable_i"}},
}

SPACE = lambda draw: {"AWidth": draw.randint(2, 18), "BWidth": draw.randint(1, 17)}


@pytest.mark.parametrize("sources", [None, ECP5], ids=["common", "ecp5"])
@pytest.mark.parametrize("a_width, b_width", [(2, 1), (17, 16), (18, 17)])
def test_multiply(a_width, b_width, sources):
    bench.run("common", "multiply", {"AWidth": a_width, "BWidth": b_width}, sources=sources)


@pytest.mark.parametrize("sources", [None, ECP5], ids=["common", "ecp5"])
def test_refuses_illegal_parameters(sources):
    assert "AWidth = 19" in bench.refuses("multiply", {"AWidth": 19}, sources=sources)
    assert "AWidth = 1 " in bench.refuses("multiply", {"AWidth": 1}, sources=sources)
    assert "BWidth = 18" in bench.refuses("multiply", {"BWidth": 18}, sources=sources)
    assert "BWidth = 0 " in bench.refuses("multiply", {"BWidth": 0}, sources=sources)


def test_the_model_refuses_illegal_parameters():
    with pytest.raises(ValueError, match="a_width = 19"):
        multiply(0, 0, 19, 16)
    with pytest.raises(ValueError, match="b_width = 0"):
        multiply(0, 0, 18, 0)
