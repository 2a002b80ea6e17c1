"""The tools that measure figures: what a figure says of a summary or a record; the area of a harness."""

import json
import sys

import pytest

import figures
import fmax
import synth
import version
from meissner.tradeoff import area


def test_figures_of_blocks_are_those_recorded(tmp_path, monkeypatch):
    """By hand: 1,048,576 taxels in 131,072 beats of 8, so 131.0721 MHz are 1,000 frames/s."""
    entry = {"mhz_worst": 131.0721, "clocks": 11, "ns": 80.6, "area": {"lut": 7, "ff": 5, "ram": 3}}
    path = tmp_path / "fmax.json"
    path.write_text(json.dumps({"version": "0.1.0", "figures": {"a ecp5": entry}}))
    monkeypatch.setattr(area, "BLOCKS", path)
    template = "{frames:,} frames/s at {mhz_worst:.1f} MHz, {clocks} clocks, {ns:.0f} ns, {lut} LUT, {ff} FF"
    assert figures.blocks(("a ecp5", template))() == (
        "1,000 frames/s at 131.1 MHz, 11 clocks, 81 ns, 7 LUT, 5 FF"
    )


def test_a_row_whose_test_fails_has_no_figure(tmp_path):
    (tmp_path / "test_it.py").write_text("def test_it():\n    assert 0\n")
    with pytest.raises(Exception, match="returned non-zero"):
        figures.tested("10 clocks", str(tmp_path / "test_it.py"))()


def test_a_record_of_another_version_is_dropped(tmp_path):
    path = tmp_path / "fmax.json"
    version.record(path, {"b": 1, "a": 2})
    version.record(path, {"c": 3})
    found = json.loads(path.read_text())
    assert found == {"version": version.VERSION, "figures": {"a": 2, "b": 1, "c": 3}}
    path.write_text(json.dumps(found | {"version": "0.0.1"}))
    assert version.record(path, {"d": 4}) == {"d": 4}


def test_recorded_blocks_and_boards_are_of_entries_that_are_there():
    kept = area.recorded(area.BLOCKS, "")
    for key, entry in kept.items():
        name, target = key.split()
        assert (entry["name"], entry["target"]) == (name, target) and target in fmax.TABLE[name][3].split()
        assert entry["seeds"] == [1, 2, 3] and entry["mhz_worst"] == min(entry["mhz"])
    assert synth.missing(area.recorded(area.BOARDS, "")) == []


def test_the_harness_is_taken_off_the_area_as_it_was_left():
    """Two registers on outputs and a fold with its table are removed; a cell that reads a block's register is
    not."""

    def cell(kind, source="", **connections):
        pins = {pin: [bit] for pin, bit in connections.items()}
        return {"type": kind, "attributes": {"src": source}, "connections": pins}

    table = dict(A="0", B="0")
    cells = [
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=3, Q=10),
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=4, Q=11),
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=12, Q=13),
        cell("TRELLIS_FF", "block.sv:6.3|cells.v", DI=14, Q=15),
        cell("LUT4", **table, C=10, D=11, Z=12),
        cell("LUT4", **table, C=10, D=15, Z=3),
        cell("LUT4", **table, C=10, D=13, Z=14),
    ]
    netlist = {"modules": {"harness": {"cells": dict(enumerate(cells))}}}
    assert fmax.own_area(netlist, "ecp5", "h.v") == {"lut": 1, "ff": 3}
    assert fmax.own_area(netlist, "up5k", "h.v") == {"lut": 3}


def test_a_module_of_ones_own_is_measured_in_the_same_harness(tmp_path, monkeypatch, capsys):
    """A port that is tied, one left open, a clock of another name; seeds and files as given. The median of
    three is in the middle, whatever the order."""
    monkeypatch.setattr(fmax, "ROOT", tmp_path)
    monkeypatch.setattr(fmax, "warm_up", lambda: None)
    found = [
        ("ck", "input", 1),
        ("on", "input", 2),
        ("a", "input", 2),
        ("no", "output", 3),
        ("y", "output", 4),
    ]
    asked = []

    def measure(name, block, target, seeds):
        asked.append((name, block.read(target), target, seeds, fmax.harness(block, found)))
        area = {"lut": 7, "ram": 0, "dsp": 1}
        return {
            "name": name,
            "target": target,
            "mhz": [90, 80, 120],
            "mhz_worst": 80,
            "clocks": None,
            "area": area,
        }

    monkeypatch.setattr(fmax, "measure", measure)
    (tmp_path / "src/deep").mkdir(parents=True)
    (tmp_path / "src/deep/a.v").write_text("// a")
    given = (
        f"--top mine --set P=3 W=2 --tie on=0x5 no= --clock ck --seeds 4 9 --sources {tmp_path}/src deep/a.v"
    )
    monkeypatch.setattr(sys, "argv", ["fmax.py", *given.split()])
    fmax.main()
    ((name, read, target, seeds, text),) = asked
    assert (name, target, seeds) == ("mine", "ecp5", [4, 9])
    assert read == "read_verilog -sv build/fmax/mine/a.v"
    assert (tmp_path / "build/fmax/mine/a.v").read_text() == "// a"
    assert "mine #(.P(3), .W(2)) u_block (" in text
    lines = [line.strip(" ,") for line in text.splitlines()]
    assert [line for line in lines if line.startswith(".")] == [
        ".ck(clk)", ".on(2'd1)", ".a(in_q[1:0])", ".y(out_d[3:0])"
    ]  # fmt: skip
    assert capsys.readouterr().out.splitlines()[1].split()[:4] == ["mine", "ecp5", "80.0", "90.0"]


@pytest.mark.parametrize(
    "given", ["--top x", "--sources .", "--record --seeds 4 5", "--record --sources . --top x"]
)
def test_what_does_not_go_together_is_refused(given, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["fmax.py", *given.split()])
    with pytest.raises(SystemExit, match="2"):
        fmax.main()
