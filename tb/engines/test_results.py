"""The folder of ``meissner run``: a second run's results replace those of the first, all or none of them, and
the user's own files stay. The runs that README and docs/commands.md name do not share a folder, and git
ignores their output."""

import json
import re
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import run
from meissner.builds.toolchain import ROOT
from meissner.scenes.results import finish

PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c489"
)  # enough of a PNG, since it is only copied


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Run "scenes" that draw pictures with these names into one folder; ``fails``: interrupted before the
    end."""

    def start(name, *pictures, fails=False):
        def module_run(scene, engine, out, seed, waves, progress):
            for picture in pictures:
                (out / picture).write_bytes(PIXEL)
            if fails:
                raise KeyboardInterrupt
            summary = {"scene": name, "seed": 1, "engine": engine, "runs": 1, "left_out": []}
            shown = [(out / picture, "any", "a picture") for picture in pictures]
            return finish(scene, summary, out, {"x": np.arange(3)}, shown, {}, 0.0)

        module = SimpleNamespace(check=lambda *_: None, run=module_run)
        monkeypatch.setattr(run, "runner", lambda _: module)
        monkeypatch.setattr(run, "check_memory", lambda _: None)
        monkeypatch.setattr("meissner.scenes.results.answer", lambda *_: "Nothing was judged.")
        monkeypatch.setattr(run, "check_memory", lambda _: None)
        monkeypatch.setattr("meissner.scenes.results.answer", lambda *_: "Nothing was judged.")
        return run.run(SimpleNamespace(name=name, title=name, sensor="any"), "fixed", tmp_path / "out")

    start.folder = tmp_path / "out"
    return start


def test_nothing_of_an_earlier_run_stays(results):
    results("first", "first_1.png", "first_2.png", "waves.vcd")
    (results.folder / "notes.png").write_text("the user's own")
    results("second", "second.png")
    names = ["notes.png", "report.html", "result.npz", "second.png", "summary.json"]
    assert sorted(path.name for path in results.folder.iterdir()) == names
    summary = json.loads((results.folder / "summary.json").read_text())
    assert summary["scene"] == "second" and summary["files"] == names[1:]


def test_a_run_that_is_interrupted_leaves_the_earlier_results(results):
    results("first", "first.png")
    before = {path.name: path.read_bytes() for path in results.folder.iterdir()}
    with pytest.raises(KeyboardInterrupt):
        results("second", "second.png", fails=True)
    assert {path.name: path.read_bytes() for path in results.folder.iterdir()} == before


@pytest.mark.parametrize(
    "summary", ["", "[]", "{}", '{"files": 3}', '{"files": [4, null]}', '{"files": ["../own"]}']
)
def test_a_summary_of_others_removes_nothing(results, summary):
    results.folder.mkdir()
    (results.folder / "summary.json").write_text(summary)
    (results.folder.parent / "own").touch()
    results("second", "second.png")
    assert (results.folder.parent / "own").exists()


def test_the_commands_of_the_pages_have_folders_of_their_own_which_git_ignores():
    pages = [(ROOT / name).read_text() for name in ("README.md", "docs/commands.md")]
    runs = {found for page in pages for found in re.findall(r"meissner (.*) --out (results\S*)", page)}
    folders = [folder for _, folder in runs]
    assert len(folders) >= 4 and len(set(folders)) == len(folders)
    for folder in folders:
        ignored = subprocess.run(["git", "check-ignore", "-q", f"{folder}/report.html"], cwd=ROOT)
        assert ignored.returncode in (0, 128), folder  # 128: sources without git
