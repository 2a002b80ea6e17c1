"""Builds of Verilated modules behind a batch C++ driver, made once per source and configuration."""

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

from meissner.builds import boards, cached_files, netlist, toolchain

HERE = Path(__file__).parent
# The family whose netlists library() builds; None: it builds the sources themselves.
CELLS = ContextVar("CELLS", default=None)


@contextmanager
def gates(cells):
    """A context in which all builds use netlists after synthesis for this family: ice40, ecp5 or gowin."""
    before = CELLS.set(cells)
    try:
        yield
    finally:
        CELLS.reset(before)


def of_gates(function):
    """``function`` of engine rtl as one of engine gate: it builds a netlist in ECP5 cells."""

    @wraps(function)
    def run(*arguments, **named):
        with gates("ecp5"):
            return function(*arguments, **named)

    return run


def cached(build):
    """functools.cache for builds by library(): netlists and sources have separate entries."""
    known = cache(lambda cells, *arguments: build(*arguments))

    @wraps(build)
    def built(*arguments):
        return known(CELLS.get(), *arguments)

    built.cache_clear = known.cache_clear
    return built


def with_make(command, environment):
    """Run a command of Verilator and the makefile that it writes."""
    return subprocess.run(
        [*command, "--build", "-j", "2"],
        env=environment,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
    )


def check_room(found):
    """Raise ValueError if a driver returns kNoRoom of driver.hpp: a setting is wider than its port."""
    if found == -2:
        raise ValueError("a setting is wider than the core has bits for")


def library(top, driver, parameters, trace=False, include=None):
    """Path of the library of ``top`` with these parameters and ``driver``, built now unless it exists.

    ``driver``: a .cpp file, by its name if it is in this folder; its .vlt, if it exists, names the internal
    signals that it reads.
    ``include``: folder of a board's msn_build.svh, from the repository's root, for rtl/boards.
    """
    environment = toolchain.environment()
    driver = HERE / driver
    told = driver.with_suffix(".vlt")
    if CELLS.get() is None:
        # A board's top is in no list, so it takes all sources, which Verilator reads in a third of a second.
        sources = toolchain.sources() if include is not None else toolchain.sources_of(top)
        checks = [*toolchain.VERILATOR_FLAGS]
        if include is not None:
            sources += [toolchain.ROOT / source for source in boards.COMMON]
            sources.append(toolchain.ROOT / include / "msn_build.svh")
            checks += [f"-I{toolchain.for_make(toolchain.ROOT / include)}"]
            checks += [str(toolchain.for_make(toolchain.ROOT) / "rtl/verilator.vlt")]
        checks += [*(f"-G{name}={value}" for name, value in parameters.items())]
    else:  # a netlist is not in the house style and has no parameters left
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
    if not cached_files.intact(built):
        toolchain.need_compiler()
        if sys.stderr.isatty():
            print("building the core for the rtl engine, once for this configuration ...", file=sys.stderr)
        place = toolchain.folder_for_make(folder.parent)
        with tempfile.TemporaryDirectory(dir=place) as scratch:
            command = ["verilator", *flags, "-Mdir", scratch]
            done = with_make([*command, *(str(toolchain.for_make(path)) for path in inputs)], environment)
            if done.returncode:
                raise RuntimeError(f"the core did not build:\n{done.stdout}{done.stderr}")
            folder.mkdir(parents=True, exist_ok=True)
            fresh = folder / f"core.{os.getpid()}"
            shutil.copy(Path(scratch) / "core.so", fresh)
            cached_files.keep(fresh, built)
    return built
