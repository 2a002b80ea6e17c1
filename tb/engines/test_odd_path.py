"""A checkout whose path has a space and a non-ASCII letter: make, which Verilator builds with, cannot read
such a path, so it gets links and folders elsewhere. A path that make can read stays unchanged."""

import os
import shutil
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cocotb_tools.config
import numpy as np
import platformdirs
import pytest

from meissner.builds import toolchain
from nightly import benches


@pytest.fixture
def cache(monkeypatch, tmp_path):
    """This test's own cache folder, in which the links are made."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    toolchain._elsewhere.cache_clear()
    yield tmp_path / "cache/meissner"
    toolchain._elsewhere.cache_clear()


def test_the_rtl_engine_runs_there(tmp_path, cache):
    checkout = tmp_path / "tac tile é"
    for name in ("model", "rtl", "host", "tools"):
        shutil.copytree(toolchain.ROOT / name, checkout / name, ignore=shutil.ignore_patterns("__pycache__"))
    # An environment inside the checkout, so that Python's package path has the space too.
    (checkout / ".venv").symlink_to(sys.prefix)
    # The runtime's objects by the path with the space, but compiled only once for all tests.
    (toolchain.BUILD / "objects").mkdir(parents=True, exist_ok=True)
    (checkout / "build").mkdir()
    (checkout / "build/objects").symlink_to(toolchain.BUILD / "objects")
    frame = np.zeros((1, 2, 3), np.uint16)
    frame[0, 1] = [7, 0, 21]  # x = 1/2, y at the lower edge
    np.save(checkout / "in.npy", frame)
    command = [checkout / ".venv/bin/python", "-m", "meissner.cli", "process", "cop", "in.npy"]
    command += ["--engine", "rtl", "--out", "out.npz"]
    environment = os.environ | {"PYTHONPATH": str(checkout / "model")}
    done = subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    found = np.load(checkout / "out.npz")
    assert {name: found[name].tolist() for name in ("sum", "x", "y")} == {
        "sum": [28],
        "x": [8192],
        "y": [-16384],
    }
    assert len(list((checkout / "build/rtl").glob("*/core.so"))) == 1
    assert os.readlink(next(path for path in cache.iterdir() if path.is_symlink())).startswith(str(checkout))


def test_the_tools_of_evidence_give_make_links_to_cocotb(tmp_path, cache, monkeypatch):
    """Otherwise a makefile depends on the first half of a path with a space, from its second run on."""
    for name in ("libs_dir", "share_dir"):
        folder = tmp_path / "tac tile" / name
        folder.mkdir(parents=True)
        monkeypatch.setattr(cocotb_tools.config, name, folder)
    benches.cocotb_for_make()
    for name in ("libs_dir", "share_dir"):
        given = getattr(cocotb_tools.config, name)
        assert given.is_relative_to(cache) and given.samefile(tmp_path / "tac tile" / name)


def test_a_path_that_make_can_read_stays(cache):
    path = Path("/srv/meissner-2.0/a_b/x+y,z@1/file.sv")
    assert toolchain.for_make(path) == path
    assert not cache.exists()


@pytest.mark.parametrize(
    "name", ["a b", "é", "a$b", "a:b", "a#b", "a%b", "a'b", 'a"b', "a;b", "a(b)", "~a", "a=b"]
)
def test_any_other_path_gets_a_link(tmp_path, cache, name):
    source = tmp_path / name / "top.sv"
    source.parent.mkdir()
    source.write_text("module top; endmodule\n")
    link = toolchain.for_make(source)
    assert toolchain._FOR_MAKE.fullmatch(str(link)) and link.samefile(source) and link.name == "top.sv"
    assert toolchain.for_make(source) == link  # the same link, so builds stay valid
    build = toolchain.folder_for_make(source.parent / "build")
    assert toolchain._FOR_MAKE.fullmatch(str(build.resolve())) and build.is_dir()
    assert toolchain.folder_for_make(source.parent / "build") == build
    assert toolchain.folder_for_make(source.parent / "build2") != build


def test_a_stale_link_is_replaced(tmp_path, cache):
    source = tmp_path / "a b/top.sv"
    source.parent.mkdir()
    source.touch()
    link = toolchain.for_make(source).parent
    link.unlink()
    link.symlink_to(tmp_path / "gone")
    assert toolchain.for_make(source).samefile(source)


def test_without_a_home_that_can_be_written_to(tmp_path, monkeypatch, cache):
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nowhere")
    (tmp_path / "a b").mkdir()
    (tmp_path / "a b/top.sv").touch()
    link = toolchain.for_make(tmp_path / "a b/top.sv")
    assert link.samefile(tmp_path / "a b/top.sv") and not link.is_relative_to("/proc")


def test_links_are_in_the_user_s_cache(tmp_path, monkeypatch, cache):
    """As platformdirs says, like the cores of an installed package."""
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda name: tmp_path / "own" / name)
    assert toolchain._elsewhere() == tmp_path / "own/meissner"


def test_two_threads_link_at_once(tmp_path, cache, monkeypatch):
    """As lint's threads do in a fresh clone: neither goes on before both have made their link."""
    folder, both = tmp_path / "a b", threading.Barrier(2)
    folder.mkdir()
    link_to = Path.symlink_to

    def together(path, target):
        both.wait()
        try:
            link_to(path, target)
        except OSError:
            both.abort()
            raise
        both.wait()

    monkeypatch.setattr(Path, "symlink_to", together)
    toolchain._elsewhere()
    with ThreadPoolExecutor(2) as pool:
        try:
            links = list(pool.map(toolchain.for_make, [folder / "x.sv"] * 2))
        finally:
            both.abort()  # if the test's time is over, nobody waits
    assert links[0] == links[1] and links[0].parent.samefile(folder)
    assert len(list(cache.iterdir())) == 1
