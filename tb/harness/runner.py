"""Build a block with Verilator and run its cocotb tests; set up the simulation before the first test."""

import hashlib
import os
import re
import subprocess
import zlib
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree

import cocotb
import pytest
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner

from harness import applicable, fast_cocotb, icarus, recorder, shared_builds
from harness.compile_models import Units
from harness.stimulus import SEED
from meissner.builds import toolchain

# Not --coverage: it adds state machine coverage, which has no points and stops Verilator 5.048 on some
# sources.
COVERAGE_FLAGS = ("--coverage-line", "--coverage-toggle", "--coverage-expr")
ONES = "+verilator+rand+reset+1"  # registers start as ones, as the tests of `starts_known` need them
SIM = os.environ.get("MEISSNER_SIM", "verilator")  # or icarus
# Files whose failed assertions show the compared values: rewriting every other module, NumPy too, takes a
# second.
os.environ.setdefault("COCOTB_REWRITE_ASSERTION_FILES", "test_*.py *_by_hand.py")
shared_builds.install()
if cocotb.is_simulation and os.environ.get("MEISSNER_COCOTB") != "plain":
    fast_cocotb.install()
if recorder.FILE:
    recorder.install()


def passed(results, name, *plusargs):
    """Names of the tests of a run, from the runner's results file; AssertionError if one failed."""
    tests, failures = get_results(results)
    assert tests > 0, f"{name}: no cocotb test ran"  # the runner itself accepts an empty run
    how = " ".join([f"MEISSNER_SEED={SEED}", *plusargs])
    assert failures == 0, f"{name}: {failures} of {tests} failed ({how})"
    cases = list(ElementTree.parse(results).iter("testcase"))
    applicable.RAN.update(f"{case.get('classname')}.{case.get('name')}" for case in cases)
    return [case.get("name") for case in cases]


def run(stage, block, parameters=None, test_filter=None, module=None, sources=None, include=None, inside=()):
    """Build ``msn_<block>`` with Verilator and run the cocotb tests of tb/<stage>/test_<block>.py.

    ``module``: another test file of that stage, in place of test_<block>; ``sources``: files to use in place
    of those of rtl/rtl.f; ``include``: a folder with a header that they include; ``inside``: what the tests
    see below the top (compile_models.py).
    """
    from nightly.benches import cocotb_for_make  # in tools/, which is not on a simulation's path

    parameters = parameters or {}
    if shared_builds.collecting(block, parameters, sources or include or inside):
        return
    module = module or f"test_{block}"
    evidence = os.environ.get("MEISSNER_COVERAGE")  # a folder for the counts; see docs/verification.md
    where = "coverage/builds" if evidence else "tb" if SIM == "verilator" else SIM
    alone = sources or include or inside or evidence or SIM != "verilator"
    sizes = [] if alone else shared_builds.group(block, parameters)
    top = f"{block}_side_by_side" if sizes else f"msn_{block}"
    of = f"-{(include or sources[-1].parent).name}" if sources else ""
    asks = os.environ.get("PYTEST_CURRENT_TEST", "none").rsplit(" ", 1)[0]
    # Tests of several modules share a build of several sizes if one file runs them.
    name = name_of(Path(asks.split("::")[0]).stem if sizes else module, block, sizes or [parameters]) + of
    build_dir = toolchain.folder_for_make(toolchain.BUILD / where / name)
    sources = sources or toolchain.sources_of(f"msn_{block}")
    # `make lint` checks for unused signals and parameters, in the sizes that are built.
    flags = [*toolchain.VERILATOR_FLAGS, "-Wno-UNUSEDSIGNAL", "-Wno-UNUSEDPARAM"]
    if SIM == "icarus":
        if reason := icarus.refused(block, parameters):
            pytest.skip(f"Icarus: {reason}")
        sources, flags = icarus.adapted(sources, build_dir / "adapted"), ["-g2012"]
    elif evidence:
        sources, flags = [*sources, *covers(sources)], [*flags, *COVERAGE_FLAGS]
    sources = [toolchain.for_make(source) for source in sources]
    os.environ.update(toolchain.environment())
    cocotb_for_make()
    if sizes:
        runner = shared_builds.Side(block, sizes, parameters)
    else:
        runner = Units(inside) if SIM == "verilator" else get_runner(SIM)
    runner.build(
        sources=sources,
        hdl_toplevel=top,
        includes=[include] if include else [],
        parameters={} if sizes else parameters,
        build_args=flags,
        build_dir=build_dir,
        timescale=("1ns", "1ps"),
    )

    # Workers may run tests of one build at the same time. cocotb's own name is that of a worker's first test.
    results = hashlib.sha256(asks.encode()).hexdigest()[:12] + ".result.xml"

    def simulate(select, *plusargs):
        """Run the tests that ``select`` names; return the names of those that ran."""
        given = {
            "hdl_toplevel": top,
            "test_module": f"{stage}.{module}",
            "build_dir": build_dir,
            "test_dir": build_dir,
            "test_filter": select,
            "results_xml": build_dir / results,
            "plusargs": [*plusargs],
            "seed": SEED,
        }
        try:
            found = plainly(runner.test, **given)
        except SystemExit:
            runner.test(**given)  # again, to print the values that a failed assertion compared
            raise
        return passed(found, name, *plusargs)

    # Registers start with random values: one that needs a reset and has none fails a test.
    seed = zlib.crc32(f"{SEED} {block} {module}".encode()) >> 1 | 1
    random_start = ["+verilator+rand+reset+2", f"+verilator+seed+{seed}"]
    known = "starts_known" in Path(find_spec(f"{stage}.{module}").origin).read_text("utf-8")
    start = [ONES] if known else random_start
    if evidence:
        file = Path(asks.split("::")[0])  # the test file pytest runs
        folder = Path(evidence) / file.stem.removeprefix("test_")
        folder.mkdir(parents=True, exist_ok=True)
        which = hashlib.sha256(f"{name} {test_filter}".encode()).hexdigest()[:12]
        # Start from zeros: a change from ones to the reset value would count as a toggle.
        start = [f"+verilator+coverage+file+{folder / which}.dat"]
    tests = simulate(test_filter, *start)
    # Where the first test needs ones, a quarter of the builds start once more: only a run's first test sees
    # how its registers start.
    turn = zlib.crc32(f"{block} {parameters}".encode())
    if known and not evidence and turn % 4 == 0:
        again = tests[1:] or tests
        simulate(rf"\b{re.escape(again[turn // 4 % len(again)])}$", *random_start)


def name_of(module, block, sizes):
    """A build's folder: the test file's name, the block's if the file's does not have it, all parameters."""
    file = module.removeprefix("test_")
    values = [f"{k}{v}" for size in sizes for k, v in size.items()]
    name = "-".join([file, *([] if block in file else [block]), *values])
    name = name.replace("'", "")  # from sized numbers
    # A file name may have 255 characters.
    return name if len(name) <= 150 else f"{name[:100]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"


def plainly(test, **given):
    """Run ``test`` without assertion values: rewriting the assertions is a quarter of a simulation's start
    time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COCOTB_REWRITE_ASSERTION_FILES", "")
        return test(**given)


def covers(sources):
    """The functional cover points of ``sources``' modules; each binds itself to its module."""
    folder = toolchain.ROOT / "tb/coverage"
    files = [folder / f"cover_{path.stem.removeprefix('msn_')}.sv" for path in sources]
    return [folder / "bin.svh", *(path for path in files if path.exists())]


def refuses(block, parameters, of=None, sources=None):
    """Elaborate ``msn_<block>`` with illegal parameters; the error message of ``msn_<of>``.

    ``sources``: as for ``run``.
    """
    command = ["verilator", "--lint-only", "-Wall", "--top-module", f"msn_{block}"]
    command += [f"-G{k}={v}" for k, v in parameters.items()]
    done = subprocess.run(
        command + [str(path) for path in sources or toolchain.sources_of(f"msn_{block}")],
        env=toolchain.environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0, f"msn_{block} accepted {parameters}"
    fatal = [line for line in done.stderr.splitlines() if f"msn_{of or block}: " in line]
    assert fatal, f"msn_{block} stopped without its own message:\n{done.stderr}"
    return fatal[0]
