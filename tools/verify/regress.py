"""Blocks in random legal sizes, each against its own tests: many sizes in one build, each tested alone.

A block takes part if its test file has a function ``SPACE``, which returns parameters from a random.Random.
"""

import hashlib
import importlib
import os
import random
import subprocess
import sys
from pathlib import Path

from meissner.builds import toolchain
from nightly import benches

WORK = toolchain.BUILD / "regress"
TOP = "regress_top"
TOGETHER = 10  # sizes per build
STIMULI = 5  # stimulus seeds per size, since a build takes far longer than a run


def _tests(block):
    """The test file of a block as a module."""
    folder = str(toolchain.ROOT / "tb")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return importlib.import_module(f"{benches.stage_of(block)}.test_{block}")


def blocks():
    """The blocks whose tests have a SPACE."""
    folder = toolchain.ROOT / "tb"
    has = lambda name: "\nSPACE = " in (folder / benches.stage_of(name) / f"test_{name}.py").read_text()
    return [name for name in benches.blocks() if has(name)]


def sizes(block, count, seed):
    """``count`` random sizes, all different if the space has that many."""
    draw, space = random.Random(f"{block} {seed}"), _tests(block).SPACE
    found = []
    for _ in range(20 * count):
        size = space(draw)
        if size not in found:
            found.append(size)
        if len(found) == count:
            break
    return found


def build(block, given):
    """The folder of a build with the block in each of these sizes; the instances are u_0, u_1, ..."""
    from cocotb_tools.runner import get_runner

    text = benches.side_by_side(block, TOP, given)
    sources = toolchain.sources_of(f"msn_{block}")
    digest = hashlib.sha256(text.encode() + b"".join(path.read_bytes() for path in sources)).hexdigest()[:12]
    folder = toolchain.folder_for_make(WORK / f"{block}-{digest}")
    (folder / f"{TOP}.sv").write_text(text)
    os.environ.update(toolchain.environment())
    os.environ["MAKEFLAGS"] = "-- CFG_CXXFLAGS_PCH_I=-include OPT_FAST=-O1 OPT_SLOW=-O0"
    benches.cocotb_for_make()
    try:
        get_runner("verilator").build(
            sources=[*map(toolchain.for_make, sources), folder / f"{TOP}.sv"],
            hdl_toplevel=TOP,
            build_args=["-Wno-lint", "-Wno-style"],
            build_dir=folder,
            timescale=("1ns", "1ps"),
            log_file=folder / "build.log",
        )
    except SystemExit:
        raise RuntimeError((folder / "build.log").read_text()[-2000:]) from None
    return folder


def test(block, folder, number, seed, limit_s=600):
    """The failure of instance ``number``, or None."""
    import cocotb_tools.config
    import find_libpython
    from cocotb_tools.check_results import get_results

    results = folder / f"results-{number}-{seed}.xml"
    results.unlink(missing_ok=True)
    python = [str(toolchain.ROOT / "tb"), os.environ.get("PYTHONPATH", "")]
    environment = {
        **os.environ,
        "COCOTB_TOPLEVEL": TOP,
        "COCOTB_TEST_MODULES": f"{benches.stage_of(block)}.test_{block}",
        "COCOTB_RESULTS_FILE": str(results),
        "COCOTB_RANDOM_SEED": str(seed),
        "TOPLEVEL_LANG": "verilog",
        "GPI_USERS": f"{find_libpython.find_libpython()};{cocotb_tools.config.pygpi_entry_point()}",
        "PATH": os.pathsep.join([os.environ["PATH"], str(cocotb_tools.config.libs_dir)]),
        "PYTHONPATH": os.pathsep.join(filter(None, [*python, *sys.path])),
        "PYGPI_PYTHON_BIN": sys.executable,
        "MEISSNER_SEED": str(seed),
        "MEISSNER_INSTANCE": f"u_{number}",
    }
    command = [str(folder / TOP), "+verilator+rand+reset+1"]
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=limit_s
        )
    except subprocess.TimeoutExpired:
        return f"no end in {limit_s} s"
    if not results.exists():
        return f"no results:\n{done.stdout[-1500:]}{done.stderr[-500:]}"
    tests, failures = get_results(results)
    results.unlink()
    if not tests:
        return "no test ran"
    return None if not failures else f"{failures} of {tests} failed:\n{done.stdout[-3000:]}"


def some(block, given):
    """(size, seed, failure or None) of each run in ``given`` [(size, seeds)], all sizes in one build; a unit
    of work. A failed build counts as a failure of every size in it."""
    given = [(dict(size), seeds) for size, seeds in given]
    try:
        folder = build(block, [size for size, _ in given])
    except RuntimeError as error:
        return [(size, seed, str(error)) for size, seeds in given for seed in seeds]
    runs = [(n, size, seed) for n, (size, seeds) in enumerate(given) for seed in seeds]
    return [(size, seed, test(block, folder, n, seed)) for n, size, seed in runs]


def fails(block, size, seed):
    """Whether this size fails alone in its build; a refused size does not count."""
    try:
        return test(block, build(block, [size]), 0, seed) is not None
    except RuntimeError:
        return False


def smallest(block, size, seed, tries=30):
    """A failing size that passes as soon as any of its parameters is made smaller."""
    size = dict(size)
    again = True
    while again and tries > 0:
        again = False
        for name, value in size.items():
            for less in dict.fromkeys((0, 1, value // 2, value - 1)):
                if not isinstance(value, int) or less >= value or tries <= 0:
                    continue
                tries -= 1
                if fails(block, size | {name: less}, seed):
                    size[name], again = less, True
                    break
    return size


def command(block, size, seed):
    values = " ".join(f"{name}={value}" for name, value in size.items())
    where = Path("tools/regress.py")
    return f"python {where} --seed {seed} --only {block} {values}"


def summary(facts):
    return f"{facts['runs']} runs in {facts['sizes']} sizes"


def total(blocks):
    runs, sizes = (sum(facts[name] for facts in blocks) for name in ("runs", "sizes"))
    return f"{runs:,} random runs in {sizes:,} random sizes of {len(blocks)} blocks pass"
