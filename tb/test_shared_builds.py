"""Parameter sets side by side in one build: each test sees its own instance as if it were alone. A session of
pytest on a file whose tests fail, crash and leave traces on purpose, on msn_delay in six sizes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from nightly import benches

HERE = Path(__file__).parent

CONFTEST = """
from harness import shared_builds
def pytest_collection_finish(session):
    shared_builds.of_session[:] = session.items
"""
FILE = """
import os
from pathlib import Path

import cocotb
import pytest
from cocotb.triggers import Timer
from cocotb.utils import get_sim_time

import bench

LEFT = []

@cocotb.test()
async def is_alone(dut):
    assert not LEFT and get_sim_time() == 0  # neither the process nor the clock of another run
    depth = dut.Depth.value.to_unsigned()
    LEFT.append(depth)
    await bench.start(dut)
    dut.in_data_i.value, dut.step_i.value = 100 + depth, 1
    passed = 0
    while dut.out_data_o.value.to_unsigned() != 100 + depth:
        await bench.clocks(dut, 1)
        await Timer(1, "ns")
        passed += 1
    with open(os.environ["TOLD"], "a") as file:
        print(depth, len(dut.in_data_i), passed, file=file)

@cocotb.test()
async def compares(dut):
    assert dut.Depth.value.to_unsigned() != 3

@bench.applies(lambda dut: hasattr(dut, "Depth") and dut.Depth.value.to_unsigned() == 4)
@cocotb.test()
async def crashes(dut):
    os._exit(7)

@bench.applies(lambda dut: hasattr(dut, "Depth") and dut.Depth.value.to_unsigned() == 6)
@cocotb.test()
async def never(dut):
    raise AssertionError("a test that the filter leaves out")

@bench.applies(lambda dut: not hasattr(dut, "Depth"))
@cocotb.test()
async def is_another_block(dut):
    with open(os.environ["TOLD"], "a") as file:
        print("sync", dut.Width.value.to_unsigned(), file=file)

@pytest.mark.parametrize("depth", [6, 4, 3, 2, 1, 4])
def test_sizes(depth):
    assert depth > 0
    size = {"Depth": depth, "Width": 7 + depth}
    bench.run("stage", "delay", size, "is_alone|compares|crashes", "test_sizes")

@pytest.mark.parametrize("width", [3, 2])
def test_other(width):
    bench.run("stage", "sync", {"Width": width}, "is_another_block", "test_sizes")

def test_with_a_fixture(tmp_path):
    bench.run("stage", "delay", {"Depth": 5, "Width": 20}, "is_alone", "test_sizes")

def test_that_fails_before_it_builds():
    raise ValueError("before")
    bench.run("stage", "delay", {"Depth": 9, "Width": 20}, "is_alone", "test_sizes")
"""


# The simulation says itself that the test's time is over, by the signal of pytest-timeout.
HANGS = """
import os
import signal
import threading

import cocotb
import pytest

import bench

os.environ.setdefault("SESSION", str(os.getpid()))

def waits_in_a_thread():
    threading.Event().wait()

@cocotb.test()
async def may_hang(dut):
    while dut.Depth.value.to_unsigned() == 2:
        os.kill(int(os.environ["SESSION"]), signal.SIGALRM)
        signal.pause()

@pytest.mark.parametrize("depth", [2, 3])
def test_sizes(depth):
    threading.Thread(target=waits_in_a_thread, daemon=True).start()
    bench.run("stage", "delay", {"Depth": depth, "Width": 9}, "may_hang", "test_sizes")
"""


def run(folder, text, *more):
    """What a session of pytest on such a file printed."""
    (folder / "stage").mkdir()
    (folder / "conftest.py").write_text(CONFTEST)
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --import-mode=importlib\n")
    (folder / "stage/test_sizes.py").write_text(text)
    # The simulator too imports the file, from the folder, and the benches' modules.
    paths = [folder, HERE, HERE.parent / "tools", *filter(None, [os.environ.get("PYTHONPATH")])]
    given = {
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        "TOLD": str(folder / "told"),
    }
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-rA", "--tb=short", *more, "stage"]
    return subprocess.run(command, cwd=folder, env=os.environ | given, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """What a session of pytest on FILE printed, and what its simulations wrote."""
    folder = tmp_path_factory.mktemp("together")
    return run(folder, FILE), (folder / "told").read_text().splitlines()


def test_a_simulation_that_hangs_ends_with_its_test(tmp_path):
    """Every thread's stack is printed, the next test has a simulator of its own, and the session ends."""
    said = run(tmp_path, HANGS, "-p", "pytest_timeout", "--timeout", "500")
    assert "FAILED stage/test_sizes.py::test_sizes[2] - Failed: Timeout" in said
    assert "PASSED stage/test_sizes.py::test_sizes[3]" in said
    assert "in waits_in_a_thread" in said and "in run\n" in said


def test_every_size_is_simulated_as_if_it_were_alone(session):
    """Depth, width and delay of each run, in the order of the tests; a test that failed runs again, to print
    what it compared."""
    sizes = {6: 13, 4: 11, 3: 10, 2: 9, 1: 8, 5: 20}
    expected = [f"{n} {sizes[n]} {n}" for n in (6, 4, 3, 3, 2, 1, 4, 5)]
    assert session[1] == [*expected[:-1], "sync 3", "sync 2", expected[-1]]


def test_a_failure_is_that_of_its_size_alone(session):
    said = session[0]
    lines = [line.split() for line in said.splitlines() if line.startswith(("PASSED ", "FAILED "))]
    outcome = {name.split("::")[1]: how for how, name, *_ in lines}
    assert outcome == {
        "test_sizes[6]": "PASSED",
        "test_sizes[4_0]": "FAILED",
        "test_sizes[3]": "FAILED",
        "test_sizes[2]": "PASSED",
        "test_sizes[1]": "PASSED",
        "test_sizes[4_1]": "FAILED",
        "test_other[3]": "PASSED",
        "test_other[2]": "PASSED",
        "test_with_a_fixture": "PASSED",
        "test_that_fails_before_it_builds": "FAILED",
    }
    assert "assert 3 != 3" in said  # the compared values
    assert "the simulation of u_1 ended with 7" in said and "ValueError: before" in said


def test_the_sizes_share_one_build(session):
    """The commands that cocotb's runner reports: Verilator, once a test, and the simulator."""
    tops = [line for line in session[0].splitlines() if "--top-module delay_side_by_side" in line]
    alone = [line for line in session[0].splitlines() if "--top-module msn_delay" in line]
    assert len(tops) == 6 and len(alone) == 1


def test_the_text_of_a_top():
    text = benches.side_by_side("fifo", "both", [{"Depth": 4, "Width": 9}, {"Width": 3}])
    assert text == (
        "// verilator lint_off PINMISSING\n"
        "module both;\n"
        "  msn_fifo #(.Depth(4), .Width(9)) u_0 ();\n"
        "  msn_fifo #(.Width(3)) u_1 ();\n"
        "endmodule\n"
    )
