"""The benches' own mechanism: a cocotb test that ran in no build of its file fails the session, none passes
by leaving early, and gaps and stalls are drawn from different sequences.

``Watch`` runs in separate sessions of pytest, on a file whose "builds" only record what ran.
"""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import bench

HERE = Path(__file__).parent

CONFTEST = """
from pathlib import Path
from harness import applicable
def pytest_configure(config):
    for mark in ("long", "big"):
        config.addinivalue_line("markers", mark)
    config.pluginmanager.register(applicable.Watch(config, Path(__file__).parent, True))
"""
FILE = """
import cocotb, pytest
from harness import applicable

@cocotb.test()
async def everywhere(dut): ...

@applicable.applies(lambda dut, size: size < dut)
@cocotb.test()
@cocotb.parametrize(size=[1, 2])
async def sized(dut, size): ...

@applicable.applies(lambda dut: dut > 9, long=lambda size: size > 1)
@cocotb.test()
@cocotb.parametrize(size=[1, 9])
async def huge(dut, size): ...

RUNS = {"a": ["everywhere", "huge/size=1", "sized/size=1"], "b": ["everywhere", "sized/size=2"]}

@pytest.mark.parametrize("build", RUNS)
def test_builds(build):
    applicable.RAN.update(f"stage.test_block.{name}" for name in RUNS[build])

@pytest.mark.long
def test_huge():
    applicable.RAN.add("stage.test_block.huge/size=9")
"""
USUAL = ["-m", "not long and not big"]


def session(folder, *options, text=FILE):
    """The exit status of a session of pytest, and the tests that it reports to have run in no build."""
    (folder / "stage").mkdir(exist_ok=True)
    (folder / "conftest.py").write_text(CONFTEST)
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --import-mode=importlib\n")
    (folder / "stage/test_block.py").write_text(text)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *options]
    given = {"PYTHONPATH": os.pathsep.join([str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])])}
    given["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # importing all plugins takes two thirds of a session
    done = subprocess.run(command, cwd=folder, env=os.environ | given, capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if ": it ran in no build" in line]
    return done.returncode, [line.split(": ")[0].removeprefix("FAILED stage.test_block.") for line in lines]


@pytest.mark.parametrize(
    "workers", [[], ["-p", "xdist", "-n", "2", "--dist", "worksteal"]], ids=["one", "two"]
)
def test_a_test_that_ran_in_no_build_fails_the_session(tmp_path, workers):
    assert session(tmp_path, *workers) == (0, [])
    less = FILE.replace(', "sized/size=2"]', "]")
    assert session(tmp_path, *workers, "stage", *USUAL, text=less) == (1, ["sized/size=2"])


def test_long_builds_are_missed_where_those_run_and_nothing_where_the_user_chose(tmp_path):
    less = FILE.replace("applicable.RAN.add(", "str(")
    assert session(tmp_path, *USUAL, text=less) == (0, [])
    assert session(tmp_path, "-m", "long or big", text=less) == (1, ["huge/size=9"])
    assert session(tmp_path, "-k", "a", text=less) == (0, [])


def leaves_early(function):
    """Lines of ``return`` in a test itself, not in its inner functions."""
    nodes, lines = list(function.body), []
    while nodes:
        node = nodes.pop()
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)):
            continue
        if isinstance(node, ast.Return) or "cocotb.pass_test" in ast.unparse(node).split("(")[0]:
            lines.append(node.lineno)
        nodes += ast.iter_child_nodes(node)
    return lines


def test_no_test_passes_by_leaving_early():
    """A cocotb test that does not apply must be declared so; a pytest test that cannot run, skipped."""
    for path in HERE.rglob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                cocotbs = any("cocotb.test" in ast.unparse(each) for each in node.decorator_list)
                if cocotbs or node.name.startswith("test_"):
                    assert leaves_early(node) == [], f"{path}: {node.name}"


@pytest.mark.parametrize("rate", [0.1, 0.5, 0.9])
def test_gaps_and_stalls_meet_in_every_way(rate):
    """Each of the four pairs occurs as often as for independent patterns, within five standard deviations,
    and a pattern repeats with the same seed and role."""
    count, pairs = 10_000, {}
    gaps, stalls = bench.gaps_and_stalls(rate)
    for _ in range(count):
        pair = gaps(), stalls()
        pairs[pair] = pairs.get(pair, 0) + 1
    for gap in (True, False):
        for stall in (True, False):
            share = (rate if gap else 1 - rate) * (rate if stall else 1 - rate)
            assert abs(pairs.get((gap, stall), 0) - count * share) < 5 * (count * share * (1 - share)) ** 0.5
    draws = [
        [pause() for _ in range(100)] for pause in (bench.pauses(rate, role) for role in ("b", "b", "r"))
    ]
    assert draws[0] == draws[1] != draws[2]
