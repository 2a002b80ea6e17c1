"""msn_check stops a simulation where its rule is broken, after the first reset only (broken_check.py)."""

import cocotb
import pytest

import bench


async def begin(dut, reset):
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    for port in dut:
        if port._name.endswith("_i") and port._name != "clk_i":
            port.value = 0
    await bench.clocks(dut, 2)
    getattr(dut, reset).value = 1
    await bench.clocks(dut, 1)
    getattr(dut, reset).value = 0


@bench.applies(lambda dut: hasattr(dut, "wrong_i"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def is_quiet_before_the_first_reset_and_while_the_rule_holds(dut):
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    dut.rst_i.value, dut.wrong_i.value = 0, 1
    await bench.clocks(dut, 3)
    dut.wrong_i.value = 0
    await begin(dut, "rst_i")
    await bench.clocks(dut, 3)


EVIDENCE = {"faults": {"none": "it has no output and is no hardware"}}


@pytest.mark.parametrize("block", ["check"])
def test_a_rule_that_is_broken_stops_the_simulation(block, capfd):
    bench.run("common", block, module="test_check")
    capfd.readouterr()
    with pytest.raises((SystemExit, RuntimeError, AssertionError)):
        bench.run("common", block, module="broken_check")
    told = "".join(capfd.readouterr())
    assert "a rule of the block is broken" in told and told.count("passed") == 0, told[-3000:]
