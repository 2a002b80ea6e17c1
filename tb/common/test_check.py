"""msn_check stops a simulation where its rule is broken, after the first reset only; and the rule of
msn_frame_table: a word that was written while it was read may be discarded, not taken (broken_check)."""

import cocotb
import pytest
from cocotb.triggers import FallingEdge

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


async def spoil(dut, discard):
    """Read word 0 while it is written; then take it, or discard it by a restart and take it read again."""
    await begin(dut, "restart_i")
    dut.advance_i.value, dut.write_i.value = 1, 1  # word 0 is read in this clock
    await bench.clocks(dut, 1)
    dut.write_i.value = 0
    await bench.clocks(dut, 1)
    assert dut.out_valid_o.value == 0
    await bench.ReadOnly()
    assert dut.out_valid_o.value == 1
    await FallingEdge(dut.clk_i)
    dut.advance_i.value, dut.restart_i.value = 0, int(discard)
    await bench.clocks(dut, 1)
    dut.restart_i.value, dut.advance_i.value = 0, 1
    await bench.clocks(dut, 4)


@bench.applies(lambda dut: hasattr(dut, "restart_i"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_word_that_is_discarded_may_be_undefined(dut):
    await spoil(dut, discard=True)


EVIDENCE = {}


@pytest.mark.parametrize("block", ["check", "frame_table"])
def test_a_rule_that_is_broken_stops_the_simulation(block, capfd):
    bench.run("common", block, module="test_check")
    capfd.readouterr()
    with pytest.raises((SystemExit, RuntimeError, AssertionError)):
        bench.run("common", block, module="broken_check")
    told = "".join(capfd.readouterr())
    assert "a rule of the block is broken" in told and told.count("passed") == 0, told[-3000:]
