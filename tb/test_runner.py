"""The benches' own code: what it compiles again, how it compiles engines, how it reads levels and writes
ports."""

from types import SimpleNamespace

import pytest

import bench
from harness import compile_models
from meissner.builds import toolchain

ONE = "module one (\n  input  logic a_i,\n  output logic b_o\n);\n  assign b_o = {} a_i;\nendmodule\n"


def test_compiles_again_only_what_changed(tmp_path, monkeypatch):
    """The commands run: one unit and its link; none if all is up to date; two units for a larger model."""
    asked, do = [], compile_models._do

    def noted(command, folder):
        asked.append(command)
        do(command, folder)

    monkeypatch.setattr(compile_models, "_do", noted)

    def build(text):
        asked.clear()
        source = tmp_path / "one.sv"
        source.write_text(text)
        compile_models.Units().build(sources=[source], hdl_toplevel="one", build_dir=tmp_path / "built")
        assert (tmp_path / "built/one").exists()
        return [command[-1].split("/")[-1] for command in asked]

    for name, value in toolchain.environment().items():
        monkeypatch.setenv(name, value)
    assert build(ONE.format("~")) == ["fast.cpp", "one"]
    assert build(ONE.format("~")) == []
    assert build(ONE.format("")) == ["fast.cpp", "one"]
    (tmp_path / "built/one").unlink()
    assert build(ONE.format("")) == ["fast.cpp", "one"]
    monkeypatch.setattr(compile_models, "SMALL", 0)
    assert build(ONE.format("")) == ["fast.cpp", "slow.cpp", "one"]


def test_what_does_not_compile_is_reported(tmp_path):
    with pytest.raises(RuntimeError, match=r"none\.cpp"):
        compile_models._do(["c++", "-c", "none.cpp"], tmp_path)


@pytest.mark.parametrize("bits", ["X", "0Z", "1x0", "", "U", "-"])
def test_a_level_that_is_none_is_no_number(bits):
    port = SimpleNamespace(_name="out_o", _handle=SimpleNamespace(get_signal_val_binstr=lambda: bits))
    with pytest.raises(AssertionError, match=f"out_o is {bits}$"):
        bench.read(port)
    assert not bench.high(port)


@pytest.mark.parametrize("bits, number", [("0", 0), ("1", 1), ("0110", 6), ("1" + 90 * "0", 1 << 90)])
def test_levels_are_a_number(bits, number):
    port = SimpleNamespace(_name="out_o", _handle=SimpleNamespace(get_signal_val_binstr=lambda: bits))
    assert bench.read(port) == number
    assert bench.high(port) is (bits == "1")


def test_a_putter_writes_what_changes():
    class Port:
        written = []  # noqa: RUF012
        value = property(None, lambda self, value: self.written.append(value))
        __len__ = lambda self: 4

    put = bench.putter(Port())
    for value in (0, 0, 5, 5, ~5, 21, True, 1, -16):
        put(value)
    assert Port.written == [0, 5, 10, 5, 1, 0]
