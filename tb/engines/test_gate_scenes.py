"""Scenes on twins, RTL and netlist together (tools/make/gate_scenes.py): the complete published crosstalk in
`make test`, every scene in `make test-long`. A value, shape or result that differs is counted by engine and
name, and a deliberately broken cell of a netlist is detected.
"""

import re
from typing import NamedTuple

import numpy as np
import pytest

import gate_scenes
from meissner import scenes
from meissner.engines import Watched, rtl_frontend, verilated
from meissner.engines.features import FEATURE_OF, FEATURES
from meissner.engines.protocol import Engine

QUICK = "capacitive_crosstalk"
SAMPLES = 76  # carrier samples per amplitude: 12 to settle, 16 periods of 4


class Found(NamedTuple):
    x: np.ndarray
    y: np.ndarray


def watched(**changes):
    ends = np.array([False, True])
    given = {"p2p": np.array([[3, 7]]), "over": np.array([[False, True]]), "state": np.array([[1, 2]])}
    return Watched(**(given | {"end": ends, "blanked": 5} | changes))


def noted(netlist, **others):
    compared = gate_scenes.Compared()
    compared.note("stage", 9, netlist, others)
    return compared


@pytest.mark.parametrize(
    "netlist, other, different",
    [
        (watched(), watched(state=np.array([[1, 3]])), {"state": 1}),
        (watched(), watched(p2p=np.array([[4, 8]]), blanked=6), {"p2p": 2, "blanked": 1}),
        (watched(), watched(end=np.array([False, True, False])), {"end": 3}),
        ({"sum": np.array([1, 2]), "x": np.array([3])}, {"sum": np.array([1, 2])}, {"x": 1}),
        ({"sum": np.array([1])}, {"sum": np.array([1]), "x": np.array([3, 4])}, {"x": 2}),
        (Found(np.array([1]), np.array([2])), Found(np.array([1]), np.array([3])), {"y": 1}),
        (
            (watched(), Found(np.array([1]), np.array([2]))),
            (watched(), Found(np.array([0]), np.array([2]))),
            {"1.x": 1},
        ),
        (np.array([-1]), np.array([1]), {"result": 1}),
    ],
)
def test_what_differs_is_named(netlist, other, different):
    compared = noted(netlist, rtl=netlist, fixed=other)
    assert compared.different == {("stage", "fixed", name): count for name, count in different.items()}
    assert noted(netlist, rtl=other, fixed=netlist).different.keys() == {
        ("stage", "rtl", name) for name in different
    }


def test_every_stage_of_an_engine_is_compared():
    """The functions that the engine protocol lists, those of the features, and watch_pins, which only
    Verilated engines have."""
    listed = {name for name in vars(Engine) if not name.startswith("_")}
    assert set(FEATURE_OF) == listed | set(FEATURES) | {"watch_pins"}
    before = {name: gate_scenes.function("gate", name) for name in FEATURE_OF}
    with gate_scenes.Compared().watching():
        assert all(gate_scenes.function("gate", name) is not before[name] for name in FEATURE_OF)
    assert all(gate_scenes.function("gate", name) is before[name] for name in FEATURE_OF)


def same(name):
    compared, summary = gate_scenes.compare(gate_scenes.stretch(scenes.load(name)))
    assert compared.different == {} and summary["twin_mismatches"] == 0
    assert compared.inputs > 0 and compared.results > 0
    return compared, summary


def test_a_scene_as_a_whole_is_the_same_on_all_three():
    compared, _ = same(QUICK)
    assert compared.inputs == SAMPLES * compared.results


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in scenes.names() if name != QUICK])
def test_every_scene_is_the_same_on_all_three(name):
    """A hand's reflex must act in each of its conditions."""
    _, summary = same(name)
    if scenes.load(name).sensor == "hand":
        assert all(row["tightenings"] > 0 for row in summary["conditions"])


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
    for engine in ("rtl", "fixed"):
        assert re.search(rf"demodulate: [1-9]\d* values of result are not those of {engine}\b", said)
