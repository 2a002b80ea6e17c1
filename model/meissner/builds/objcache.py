"""Compiles Verilator's runtime, which all simulations share, only once: three quarters of a build's time.

Called as ``objcache.py COMPILER ARGUMENTS...`` by Verilator's makefiles (their OBJCACHE). The objects of the
runtime's own sources, verilated*.cpp of the pinned package, are cached under the hash of the command. These
sources include nothing of the model, so the command identifies them completely. Sources compiled at -O0 or
-O1, for tests, begin with the runtime's headers, precompiled once: reading these takes two thirds of the
remaining time. The folder is $MEISSNER_OBJECTS, which toolchain.environment sets.
"""

import fcntl
import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

# Loaded without its package, which takes a second to import.
SPEC = importlib.util.spec_from_file_location("cached_files", Path(__file__).with_name("cached_files.py"))
assert SPEC and SPEC.loader
cached_files = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(cached_files)

OWN = ("verilated.h", "svdpi.h")  # in the runtime's own include folders


def folder() -> Path:
    """The folder of the cached objects and headers."""
    return Path(os.environ["MEISSNER_OBJECTS"])


def _key(compiler: str, words: list[str]) -> str:
    """The hash of a compiler's version and arguments. Makefiles and the builds of tests give the same ones in
    another order; of those used here only folders and levels of optimisation (see _level) depend on it. Paths
    are resolved, and include folders of models are left out, from which the runtime includes nothing, so that
    trees which link to one environment share its runtime."""

    def of_a_model(folder: str) -> bool:
        return not any(os.path.exists(os.path.join(folder, name)) for name in OWN)

    def meant(word: str) -> str:
        option = "-I" if word.startswith("-I") else ""
        path = word[len(option) :]
        return option + os.path.realpath(path) if option or os.path.isabs(path) else word

    folders = [meant(word) for word in words if word.startswith("-I") and not of_a_model(word[2:])]
    others = sorted(meant(word) for word in words if not word.startswith("-I"))
    return hashlib.sha256("\0".join([version(compiler), *folders, *others]).encode()).hexdigest()


def _level(words: list[str], instead: dict[str, str] | None = None) -> list[str]:
    """``words`` with one level of optimisation, at first: the last, as for the compiler, or what is given
    ``instead`` of it."""
    levels = [word for word in words if word.startswith("-O")]
    last = [(instead or {}).get(level, level) for level in levels[-1:]]
    return [*last, *(word for word in words if word not in levels)]


def _precompile(compiler: str, flags: list[str], header: Path, found: Path) -> bool:
    """Precompile the runtime's headers; returns whether the compiler succeeded."""
    header.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=header.parent, suffix=".h", delete=False) as fresh:
        fresh.write('#include "verilated.h"\n#include "verilated_vpi.h"\n')
    compiled = Path(f"{fresh.name}.gch")
    command = [compiler, *flags, "-x", "c++-header", "-o", str(compiled), fresh.name]
    if subprocess.run(command, capture_output=True).returncode:
        Path(fresh.name).unlink()
        return False
    Path(fresh.name).replace(header)  # atomic: another build may use it immediately
    compiled.replace(found)
    return True


def precompiled(command: list[str]) -> Path | None:
    """The precompiled header that ``command`` can begin with; None if precompiling fails."""
    source = next(word for word in command if word.endswith(".cpp"))
    output = command.index("-o")
    words = [word for word in command[1:output] + command[output + 2 :] if word not in ("-c", "-MMD", source)]
    flags = _level(words)
    key = _key(command[0], flags)
    header = folder() / key / "runtime.h"
    found = header.with_name("runtime.h.gch")
    if not found.exists():
        with alone(key):
            return header if found.exists() or _precompile(command[0], flags, header, found) else None
    return header


@contextmanager
def alone(key: str) -> Iterator[None]:
    """A lock for one process at a time: processes that start together would all compile the same."""
    folder().mkdir(parents=True, exist_ok=True)
    with open(folder() / f"{key}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@cache
def version(compiler: str) -> str:
    return subprocess.run([compiler, "-dumpfullversion"], capture_output=True, text=True).stdout


def _compile(command: list[str], found: Path) -> None:
    with tempfile.NamedTemporaryFile(dir=folder(), suffix=".o", delete=False) as fresh:
        status = subprocess.run([*command, "-o", fresh.name]).returncode
    if status:
        Path(fresh.name).unlink()
        sys.exit(status)
    cached_files.keep(Path(fresh.name), found)


def runtime(command: list[str]) -> Path:
    """The object of a compiler's ``command`` (without its output) for a source of the runtime. All models of
    tests, compiled at -O0 or -O1, get the runtime of benches."""
    command = [command[0], *_level(command[1:], {"-O0": "-Os", "-O1": "-Os"})]
    key = _key(command[0], command[1:])
    found = folder() / f"{key}.o"
    if not cached_files.intact(found):
        with alone(key):
            if not cached_files.intact(found):
                _compile(command, found)
    return found


def main() -> None:
    command = sys.argv[1:]
    sources = [Path(word) for word in command if word.endswith(".cpp") and Path(word).is_absolute()]
    own = [source for source in sources if source.parent.name == "include"]
    shared = len(sources) == 1 and len(own) == 1 and own[0].stem.startswith("verilated")
    if not shared or "-o" not in command:
        source = [word for word in command if word.endswith(".cpp")]
        quick = {"-c", "-o"} <= {*command} and {"-O0", "-O1"} & {*command} and len(source) == 1
        header = precompiled(command) if quick else None
        os.execvp(command[0], [command[0], *(["-include", str(header)] if header else []), *command[1:]])
    output = Path(command[command.index("-o") + 1])
    shutil.copyfile(runtime([word for word in command if word not in ("-o", "-MMD", str(output))]), output)


if __name__ == "__main__":
    main()
