"""Builds of Verilated modules behind a batch C++ driver: made once for a source and a configuration."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from meissner import toolchain

HERE = Path(__file__).parent


def library(top, driver, parameters, trace=False):
    """Path of ``top`` with these parameters behind ``driver``; built now if this source was not before.

    ``driver``: a .cpp file beside this one; its .vlt, if there is one, says which inner signals it reads.
    """
    environment = toolchain.environment()
    flags = [
        *(["--trace-vcd"] if trace else []),
        *("--cc", "--quiet", "-O3", "--x-assign", "fast", "--x-initial", "fast", "--top-module", top),
        *toolchain.VERILATOR_FLAGS,
        *("-CFLAGS", f"-fPIC -O3 -I{HERE}", "-LDFLAGS", "-shared", "--exe", "-o", "core.so"),
        *(f"-G{name}={value}" for name, value in parameters.items()),
    ]
    driver = HERE / driver
    inputs = [driver, *filter(Path.exists, [driver.with_suffix(".vlt")]), *toolchain.sources()]
    digest = hashlib.sha256(repr(flags).encode())
    for file in [*inputs, *sorted(HERE.glob("*.hpp"))]:
        digest.update(file.read_bytes())
    folder = toolchain.BUILD / "rtl" / digest.hexdigest()[:16]
    built = folder / "core.so"
    if not built.exists():
        if sys.stderr.isatty():
            print("building the core for the rtl engine, once for this configuration ...", file=sys.stderr)
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
            command = ["verilator", *flags, "--build", "-j", "2", "-Mdir", scratch, *map(str, inputs)]
            done = subprocess.run(command, env=environment, capture_output=True, text=True)
            if done.returncode:
                raise RuntimeError(f"the core did not build:\n{done.stdout}{done.stderr}")
            folder.mkdir(exist_ok=True)
            shutil.copy(Path(scratch) / "core.so", folder / f"core.{os.getpid()}")
            (folder / f"core.{os.getpid()}").replace(built)  # atomic: several may build at once
    return built
