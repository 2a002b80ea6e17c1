"""tb/harness/fast_cocotb.py against cocotb's own functions that it replaces: what a port accepts, returns
and refuses. On msn_delay, whose ports have one bit and more than a word."""

import hashlib
import inspect
import os

import cocotb
import numpy as np
import pytest
from cocotb import handle
from cocotb.handle import Immediate
from cocotb.triggers import ReadOnly, Timer
from cocotb.types import Logic, LogicArray

import bench
from harness import fast_cocotb

WIDTH = 40
# Digests of the sources that fast_cocotb.py was written for: another version of cocotb may do more.
REPLACED = {
    handle.HierarchyObject.__getattr__: "211af289c27f",
    Logic.__eq__: "d826e0c7aa2f",
    LogicArray._from_handle: "9f4e231161fa",
    handle.ValueObjectBase.value.fset: "275afe9dce86",
    handle.LogicObject._set_value: "fce4ac42df11",
    handle.LogicObject.get: "b15202ce73ba",
    handle._LogicArrayObjectBase._set_value: "b1199858cca1",
}
VALUES = [0, 1, 2, -1, True, False, "1", "z", "02", 1.0, None, np.int64(1), Logic("X"), LogicArray("1")]
VALUES += [5, (1 << WIDTH) - 1, 1 << WIDTH, 1 << WIDTH - 1, -(1 << WIDTH - 1), -(1 << WIDTH - 1) - 1]
VALUES += [0x5A_1234_5678, "0" * WIDTH, "10" * (WIDTH // 2), LogicArray(7, WIDTH)]


def outcome(function, *given):
    try:
        return function(*given)
    except Exception as error:
        return type(error), str(error)


# On Icarus each write waits for its phase, so cocotb's own setters stay.
@cocotb.test(timeout_time=1, timeout_unit="ms", skip=not handle._trust_inertial)
@cocotb.parametrize(port=["step_i", "in_data_i"])
async def a_port_takes_what_it_took(dut, port):
    port = getattr(dut, port)
    own, quicker = fast_cocotb._set, type(port).value.fset
    assert own is not quicker
    for value in VALUES:
        found = []
        for put, before in ((own, 0), (quicker, 1)):
            port.value = before
            await Timer(1, "ns")
            said = outcome(put, port, value)
            await Timer(1, "ns")
            got = port.value
            assert type(got) is type(port.get())
            found.append((said, str(got) if said is None else None, said is None or int(got) == before))
        assert found[0] == found[1], value
    port.value = Immediate(0)
    assert port.value == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def levels_are_given_as_they_were(dut):
    for level in (0, 1):
        dut.step_i.value = level
        dut.in_data_i.value = 3 * level
        await Timer(1, "ns")
        assert dut.step_i.value is dut.step_i.get() is Logic(level)
        word = dut.in_data_i.value
        assert (word, len(word), word[0], word[WIDTH - 1]) == (3 * level, WIDTH, level, 0)
    for level in "UX01ZWLH-":
        for value in (0, 1, 2, -1, True, "1", "h", "q", Logic("1"), Logic("L"), LogicArray("1"), 1.0, None):
            found = Logic(level) == value
            assert found is (fast_cocotb._equal(Logic(level), value) is True), (level, value)
    with pytest.raises(AttributeError, match="no child object named no_such_i"):
        dut.no_such_i  # noqa: B018
    assert not hasattr(dut, "no_such_i") and dut.step_i is dut["step_i"]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def nothing_is_written_once_all_has_settled(dut):
    await ReadOnly()
    for port in (dut.step_i, dut.in_data_i):
        with pytest.raises(RuntimeError, match="during the ReadOnly phase"):
            port.value = 1
    await Timer(1, "ns")
    with pytest.raises(TypeError, match="immutable"):
        dut.Depth.value = 1


@pytest.mark.skipif(os.environ.get("MEISSNER_COCOTB") == "plain", reason="cocotb's own functions are wanted")
def test_fast_cocotb():
    bench.run("common", "delay", {"Depth": 3, "Width": WIDTH}, module="test_fast_cocotb")


def test_knows_what_it_replaces():
    for function, known in REPLACED.items():
        digest = hashlib.sha256(inspect.getsource(function).encode()).hexdigest()
        assert digest.startswith(known), (function.__qualname__, digest[:12])
