"""Rules broken on purpose: the simulation must stop in each. Run by test_check.py."""

import cocotb

import bench
from common.test_check import begin


@bench.applies(lambda dut: hasattr(dut, "wrong_i"))
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=1)
async def stops_here_broken(dut):
    await begin(dut, "rst_i")
    dut.wrong_i.value = 1
    await bench.clocks(dut, 2)
