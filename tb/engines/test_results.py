"""The folder of ``meissner run``: a second run's results replace those of the first, all or none of them, and
the user's own files stay."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import run
from meissner.scenes import results as writing
from meissner.scenes.results import Picture, Result, table

PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c489"
)  # enough of a PNG, since it is only copied


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Run "scenes" that draw pictures with these ends of names into one folder; ``fails``: interrupted before
    the end."""

    def start(name, ends=("",), files=(), fails=False):
        def draw(path):
            path.write_bytes(PIXEL)
            if fails:
                raise KeyboardInterrupt

        def module_run(scene, engine, seed, waves, spread):
            summary = {"scene": name, "seed": 1, "engine": engine, "runs": 1, "left_out": []}
            shown = [Picture(end, draw, "any", "a picture") for end in ends]
            return Result(summary, {"x": np.arange(3)}, shown, {name: b"" for name in files})

        module = SimpleNamespace(run=module_run, TABLES={}, answer=lambda _: "Nothing was judged.")
        for place in (run, writing):
            monkeypatch.setattr(place, "runner", lambda _: module)
        monkeypatch.setattr(run, "check", lambda *_: 1)
        return run.run(SimpleNamespace(name=name, title=name, sensor="any"), "fixed", tmp_path / "out")

    start.folder = tmp_path / "out"
    return start


def test_nothing_of_an_earlier_run_stays(results):
    results("first", ("_1", "_2"), ("waves.vcd",))
    (results.folder / "notes.png").write_text("the user's own")
    results("second")
    names = ["notes.png", "report.html", "result.npz", "second.png", "summary.json"]
    assert sorted(path.name for path in results.folder.iterdir()) == names
    summary = json.loads((results.folder / "summary.json").read_text())
    assert summary["scene"] == "second" and summary["files"] == names[1:]


def test_a_run_that_is_interrupted_leaves_the_earlier_results(results):
    results("first")
    before = {path.name: path.read_bytes() for path in results.folder.iterdir()}
    with pytest.raises(KeyboardInterrupt):
        results("second", fails=True)
    assert {path.name: path.read_bytes() for path in results.folder.iterdir()} == before


@pytest.mark.parametrize(
    "summary", ["", "[]", "{}", '{"files": 3}', '{"files": [4, null]}', '{"files": ["../own"]}']
)
def test_a_summary_of_others_removes_nothing(results, summary):
    results.folder.mkdir()
    (results.folder / "summary.json").write_text(summary)
    (results.folder.parent / "own").touch()
    results("second")
    assert (results.folder.parent / "own").exists()


def test_nothing_to_count_is_a_dash_in_a_table():
    rows = [{"a": None, "longer": 1.5}, {"a": "some", "longer": None}]
    assert table(rows) == ["a     longer", "–     1.5", "some  –"]
