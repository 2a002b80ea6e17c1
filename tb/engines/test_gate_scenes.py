"""Scenes on twins, RTL and netlist together (tools/make/gate_scenes.py): the complete published crosstalk in
`make test`, every scene in `make test-long`. A deliberately broken cell of a netlist is detected.
"""

import re

import pytest

import gate_scenes
from meissner import scenes
from meissner.engines import rtl_frontend, verilated

QUICK = "capacitive_crosstalk"


def same(name):
    said, summary = gate_scenes.compare(gate_scenes.stretch(scenes.load(name)))
    assert said == []
    return summary


def test_a_scene_as_a_whole_is_the_same_on_all_three():
    same(QUICK)


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in scenes.names() if name != QUICK])
def test_every_scene_is_the_same_on_all_three(name):
    """A hand's reflex must act in each of its conditions."""
    summary = same(name)
    if scenes.load(name).sensor == "hand":
        assert all(row["tightenings"] > 0 for row in summary["conditions"])


@pytest.mark.parametrize(
    "netlist, count",
    [({"twin_mismatches": 3}, 1), ({"twin_mismatches": None}, 1), ({"pins": {"clocks": 801}}, 1), ({}, 0)],
)
def test_what_differs_is_said(netlist, count, monkeypatch):
    right = {"twin_mismatches": 0, "pins": {"clocks": 800}}
    found = {"rtl": right, "gate": right | netlist}
    monkeypatch.setattr(gate_scenes.runs, "run", lambda scene, engine, out: found[engine])
    assert len(gate_scenes.compare(None)[0]) == count


@pytest.fixture
def broken(monkeypatch):
    """One LUT that feeds the demodulator's amplitude, with half of its table inverted after synthesis."""
    right = verilated.netlist.verilog

    def verilog(*arguments):
        path, *models = right(*arguments)
        table = re.compile(r"(assign \\out_data_o_\S*LUT4_\S*\.s3 .* : 8'h)(\w\w);")
        invert = lambda found: f"{found[1]}{255 - int(found[2], 16):02x};"
        text, count = table.subn(invert, path.read_text("utf-8"), 1)
        assert count == 1
        changed = path.with_name("broken.v")
        changed.write_text(text, "utf-8")
        return [changed, *models]

    monkeypatch.setattr(verilated.netlist, "verilog", verilog)
    rtl_frontend._open_demod.cache_clear()
    yield
    rtl_frontend._open_demod.cache_clear()


@pytest.mark.long
def test_a_broken_cell_is_seen(broken, capsys):
    assert gate_scenes.table([QUICK])
    said = capsys.readouterr().out
    assert "DIFFERENT" in said
    assert re.search(r"[1-9]\d* results on gate are not the twins'", said) and " on rtl " not in said
