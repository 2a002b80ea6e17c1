"""Cached builds of libraries: a complete one is not rebuilt, a damaged one is; without a compiler there is
one sentence."""

import shutil
import subprocess
from pathlib import Path

import pytest

from meissner import cli
from meissner.builds import cached_files, toolchain
from meissner.engines import rtl_core, verilated

WHOLE = bytes(range(256)) * 40


@pytest.fixture
def builds(monkeypatch, tmp_path):
    """verilated.library() with a compiler that writes WHOLE; returns the compiler's commands."""
    asked = []

    def run(command, **_):
        asked.append(command)
        (Path(command[command.index("-Mdir") + 1]) / "core.so").write_bytes(WHOLE)
        return subprocess.CompletedProcess(command, 0, "", "")

    toolchain.environment()
    monkeypatch.setattr(toolchain, "BUILD", tmp_path)
    monkeypatch.setattr(verilated.subprocess, "run", run)
    return asked


def library():
    return verilated.library("msn_core", "core_driver.cpp", {})


def test_what_is_whole_is_kept(builds):
    first = library()
    assert first.read_bytes() == WHOLE and len(builds) == 1
    assert library() == first and len(builds) == 1


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(WHOLE[:-1]),
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(WHOLE[:5000] + b"?" + WHOLE[5001:]),
        lambda path: path.unlink(),
        lambda path: path.with_name("core.so.sha256").unlink(),
        lambda path: path.with_name("core.so.sha256").write_bytes(b"\xff"),
    ],
    ids=["short", "empty", "changed", "gone", "no digest", "digest"],
)
def test_what_is_damaged_is_built_again(builds, damage):
    damage(library())
    assert library().read_bytes() == WHOLE and len(builds) == 2
    library()
    assert len(builds) == 2


@pytest.mark.parametrize(
    "name", ["core_driver.cpp", "core_driver.vlt", "driver.hpp", "serial.hpp", "adc_parts.hpp"]
)
def test_a_changed_driver_is_built_again(builds, monkeypatch, tmp_path, name):
    """Adding a line to any file in a copy of the drivers gives another library."""
    drivers = tmp_path / "drivers"
    drivers.mkdir()
    for file in verilated.HERE.glob("*.[ch]pp"):
        shutil.copy(file, drivers)
    shutil.copy(verilated.HERE / "core_driver.vlt", drivers)
    monkeypatch.setattr(verilated, "HERE", drivers)
    first = library()
    assert library() == first and len(builds) == 1
    with open(drivers / name, "a") as file:
        file.write("// more\n")
    assert library() != first and len(builds) == 2


def test_a_new_file_takes_the_place_of_an_old_one(tmp_path):
    for text in ("first", "second"):
        (tmp_path / "fresh").write_text(text)
        cached_files.keep(tmp_path / "fresh", tmp_path / "x")
        assert cached_files.intact(tmp_path / "x") and (tmp_path / "x").read_text() == text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x", "x.sha256"]


def test_without_a_compiler_there_is_one_sentence(builds, monkeypatch, capsys):
    monkeypatch.setattr(
        toolchain.shutil, "which", lambda name, path=None: None if name == "g++" else f"/{name}"
    )
    rtl_core._open.cache_clear()  # otherwise a core already opened by this process is used
    with pytest.raises(SystemExit) as end:
        cli.main(["live", "core:slip1", "--seconds", "1"])
    out, err = capsys.readouterr()
    assert end.value.code == 2 and not out and not builds
    assert err.startswith("meissner: g++ ") and err.count("\n") == 1
