"""Builds of Verilated modules behind a batch C++ driver: made once for a source and a configuration."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, wraps
from pathlib import Path

from meissner.builds import boards, kept, netlist, toolchain

HERE = Path(__file__).parent
# The family whose cells library() builds from; None: the sources themselves.
CELLS = ContextVar("CELLS", default=None)


@contextmanager
def gates(cells):
    """Within it all builds are of netlists after synthesis for this family: ice40, ecp5 or gowin."""
    before = CELLS.set(cells)
    try:
        yield
    finally:
        CELLS.reset(before)


def of_gates(function):
    """``function`` of engine gate, for one of engine rtl: what it builds is a netlist in cells of an ECP5."""

    @wraps(function)
    def run(*arguments, **named):
        with gates("ecp5"):
            return function(*arguments, **named)

    return run


def cached(build):
    """functools.cache for what is built by library(): netlists are kept apart from sources."""
    known = cache(lambda cells, *arguments: build(*arguments))

    @wraps(build)
    def built(*arguments):
        return known(CELLS.get(), *arguments)

    built.cache_clear = known.cache_clear
    return built


def with_make(command, environment):
    """Run a command of Verilator's, and the makefile that it writes."""
    return subprocess.run(
        [*command, "--build", "-j", "2"],
        env=environment,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
    )


compiled = with_make  # tests put units.without_make in its place (tb/conftest.py)


def check_room(found):
    """ValueError where a driver says that a setting is wider than its port: kNoRoom of driver.hpp."""
    if found == -2:
        raise ValueError("a setting is wider than the core has bits for")


def library(top, driver, parameters, trace=False, include=None):
    """Path of ``top`` with these parameters behind ``driver``; built now if this source was not before.

    ``driver``: a .cpp file beside this one; its .vlt, if there is one, says which inner signals it reads.
    ``include``: folder of a board's msn_build.svh, from the repository's root, for rtl/boards.
    """
    environment = toolchain.environment()
    driver = HERE / driver
    told = driver.with_suffix(".vlt")
    if CELLS.get() is None:
        # A board's top is in no list: it takes all. Verilator reads those for a third of a second.
        sources = toolchain.sources() if include is not None else toolchain.sources_of(top)
        checks = [*toolchain.VERILATOR_FLAGS]
        if include is not None:
            sources += [toolchain.ROOT / source for source in boards.COMMON]
            sources.append(toolchain.ROOT / include / "msn_build.svh")
            checks += [f"-I{toolchain.for_make(toolchain.ROOT / include)}"]
            checks += [str(toolchain.for_make(toolchain.ROOT) / "rtl/verilator.vlt")]
        checks += [*(f"-G{name}={value}" for name, value in parameters.items())]
    else:  # a netlist is not written in the house style, and its parameters are no more
        text = told.read_text("utf-8") if told.exists() else ""
        read = re.findall(rf'public_flat_rd -module "{top}" -var "(\w+)"', text)
        sources = netlist.verilog(top, parameters, CELLS.get(), read, include)
        checks = [*toolchain.VERILATOR_FLAGS, "-Wno-lint", "-Wno-style"]
    flags = [
        *(["--trace-vcd"] if trace else []),
        *("--cc", "--quiet", "-O3", "--x-assign", "fast", "--x-initial", "fast", "--top-module", top),
        *checks,
        *(
            "-CFLAGS",
            f"-fPIC {toolchain.OPTIMISE} -I{toolchain.for_make(HERE)}",
            "-LDFLAGS",
            "-shared",
            "--exe",
            "-o",
            "core.so",
        ),
    ]
    inputs = [driver, *filter(Path.exists, [told]), *sources]
    digest = hashlib.sha256(repr(flags).encode())
    included = [*HERE.glob("*.hpp"), *toolchain.ROOT.glob("host/*.[ch]")]
    for file in [*inputs, *sorted(included)]:
        digest.update(file.read_bytes())
    folder = toolchain.BUILD / "rtl" / digest.hexdigest()[:16]
    built = folder / "core.so"
    if not kept.intact(built):
        toolchain.need_compiler()
        if sys.stderr.isatty():
            print("building the core for the rtl engine, once for this configuration ...", file=sys.stderr)
        place = toolchain.folder_for_make(folder.parent)
        with tempfile.TemporaryDirectory(dir=place) as scratch:
            command = ["verilator", *flags, "-Mdir", scratch]
            done = compiled([*command, *(str(toolchain.for_make(path)) for path in inputs)], environment)
            if done.returncode:
                raise RuntimeError(f"the core did not build:\n{done.stdout}{done.stderr}")
            folder.mkdir(parents=True, exist_ok=True)
            fresh = folder / f"core.{os.getpid()}"
            shutil.copy(Path(scratch) / "core.so", fresh)
            kept.keep(fresh, built)
    return built
