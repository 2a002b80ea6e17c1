"""msn_constant_multiplier against its model: constants with runs of ones, single bits, none and all; extreme
and random factors. The block is combinational and each constant is a build, so only critical ones are
built."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import Timer

import bench
from harness.refusals import refusals
from meissner.twins.common.arithmetic import constant_multiplier


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def matches_model(dut):
    constant, bits = (getattr(dut, name).value.to_unsigned() for name in ("Constant", "InBits"))
    rng = np.random.default_rng(bench.SEED)
    values = [0, 1, 2, 3, (1 << bits) - 1, 1 << (bits - 1), *map(int, rng.integers(0, 1 << bits, 200))]
    for value, expected in zip(values, constant_multiplier(values, constant)):
        dut.in_data_i.value = value
        await Timer(1, "ns")
        assert bench.read(dut.out_data_o) == expected, f"{constant} * {value}"


EVIDENCE = {
    "equivalence": {"size": {"Constant": 1023}},
    "faults": {"none": "no state"},
}

SPACE = lambda draw: {"Constant": draw.randrange(65536), "InBits": draw.randint(2, 44)}


@pytest.mark.parametrize("constant", [0, 1, 1023, 43691])
def test_constant_multiplier(constant):
    bench.run("common", "constant_multiplier", {"Constant": constant, "InBits": 36})


test_refuses_illegal_parameters = refusals(
    "constant_multiplier", constant_multiplier, {"Constant": 65536}, alone=[{"InBits": 0}], x=1
)
