"""Builds of Verilated modules behind a batch C++ driver, made once per source and configuration."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, wraps
from pathlib import Path
from typing import Generic, ParamSpec, TypeVar

from meissner.builds import boards, cached_files, netlist, toolchain

HERE = Path(__file__).parent
# The family whose netlists library() builds; None: it builds the sources themselves.
CELLS: ContextVar[str | None] = ContextVar("CELLS", default=None)

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def gates(cells: str | None) -> Iterator[None]:
    """A context in which all builds use netlists after synthesis for this family: ice40, ecp5 or gowin."""
    before = CELLS.set(cells)
    try:
        yield
    finally:
        CELLS.reset(before)


def of_gates(function: Callable[P, R]) -> Callable[P, R]:
    """``function`` of engine rtl as one of engine gate: it builds a netlist in ECP5 cells."""

    @wraps(function)
    def run(*arguments: P.args, **named: P.kwargs) -> R:
        with gates("ecp5"):
            return function(*arguments, **named)

    return run


class cached(Generic[R]):
    """functools.cache for builds by library(): netlists and sources have separate entries."""

    def __init__(self, build: Callable[..., R]) -> None:
        self._known = cache(lambda cells, *arguments: build(*arguments))
        self.cache_clear = self._known.cache_clear

    def __call__(self, *arguments: Hashable) -> R:
        return self._known(CELLS.get(), *arguments)


def with_make(command: Sequence[str], environment: Mapping[str, str]) -> "subprocess.CompletedProcess[str]":
    """Run a command of Verilator and the makefile that it writes."""
    return subprocess.run(
        [*command, "--build", "-j", "2"],
        env=environment,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
    )


def check_room(found: int) -> None:
    """Raise ValueError if a driver returns kNoRoom of driver.hpp: a setting is wider than its port."""
    if found == -2:
        raise ValueError("a setting is wider than the core has bits for")


def library(
    top: str, driver: str, parameters: Mapping[str, object], trace: bool = False, include: str | None = None
) -> Path:
    """Path of the library of ``top`` with these parameters and ``driver``, built now unless it exists.

    ``driver``: a .cpp file, by its name if it is in this folder; its .vlt, if it exists, names the internal
    signals that it reads.
    ``include``: folder of a board's msn_build.svh, from the repository's root, for rtl/boards.
    """
    environment = toolchain.environment()
    source, cells = HERE / driver, CELLS.get()
    told = source.with_suffix(".vlt")
    if cells is None:
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
        sources = netlist.verilog(top, parameters, cells, read, include)
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
    inputs = [source, *filter(Path.exists, [told]), *sources]
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
