"""`make setup` in a copy where Python and pip are shell scripts, interrupted after each step as Ctrl-C does.
The next run starts again and completes; a complete environment is kept and receives what is new."""

import os
import shutil
import subprocess

import pytest

from meissner.builds.toolchain import ROOT

# One script acts as both: `python -m venv` makes an environment whose python is a copy of it. BREAK names the
# step after which it dies; each step first leaves half of its work.
PYTHON = """#!/bin/sh
echo "$*" >> log
here=$(dirname "$0")
case "$*" in
  *check_machine*) ;;
  "-m venv .venv")
    test "$BREAK" != nothing || exit 130
    mkdir -p .venv/bin && touch .venv/half && cp "$0" .venv/bin/python
    test "$BREAK" != venv || exit 130
    touch .venv/pip && rm .venv/half ;;
  "-m pip --version") test -e "$here/../pip" ;;
  "-m pip install"*requirements*)  # half a package that pip takes for whole, and so never mends
    test "$BREAK" != packages || { touch .venv/half; exit 130; }
    touch .venv/packages ;;
  "-m pip install"*) test "$BREAK" != own || exit 130 ; touch .venv/own ;;
  *) exit 99 ;;
esac
"""


@pytest.fixture
def setup(tmp_path):
    for name in ("requirements", "tools", "rtl"):
        (tmp_path / name).mkdir()
    for name in ("Makefile", "pyproject.toml", "rtl/rtl.f", "requirements/sim.txt"):
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "python").write_text(PYTHON)
    (tmp_path / "python").chmod(0o755)

    def run(stop=""):
        environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
        command = ["make", "setup", "PYTHON=./python"]
        done = subprocess.run(command, cwd=tmp_path, env=environment | {"BREAK": stop}, capture_output=True)
        return done.returncode

    return run


def whole(folder):
    """Files of the environment, without bin."""
    return sorted(path.name for path in (folder / ".venv").iterdir() if path.name != "bin")


@pytest.mark.parametrize("stop", ["nothing", "venv", "packages", "own"])
def test_an_interrupted_setup_begins_again(tmp_path, setup, stop):
    assert setup(stop) != 0
    assert not (tmp_path / ".venv/.sim").exists()
    assert setup() == 0
    assert whole(tmp_path) == [".sim", "own", "packages", "pip"]


def test_an_environment_without_pip_is_made_again(tmp_path, setup):
    """The state that an interrupted set-up of an earlier version left, which kept no note that it had
    begun."""
    (tmp_path / ".venv/bin").mkdir(parents=True)
    shutil.copy(tmp_path / "python", tmp_path / ".venv/bin/python")
    (tmp_path / ".venv/half").touch()
    assert setup() == 0
    assert whole(tmp_path) == [".sim", "own", "packages", "pip"]


def test_a_whole_environment_stays(tmp_path, setup):
    assert setup() == 0
    (tmp_path / ".venv/of_the_user").touch()
    os.utime(tmp_path / ".venv/.sim", (1, 1))  # older than the requirements
    assert setup() == 0
    assert whole(tmp_path) == [".sim", "of_the_user", "own", "packages", "pip"]
    assert (tmp_path / "log").read_text().count("-m venv .venv") == 1
