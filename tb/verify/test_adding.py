"""docs/adding.md, followed word by word in a copy of the tree: its files and patches fit, its commands pass,
and it changes as many existing files by hand as it says; at most 8, the project's goal."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from meissner.builds import toolchain

PAGE = toolchain.ROOT / "docs/adding.md"
BLOCK = re.compile(r"^```(\w+) ?(.*)\n((?:.*\n)*?)```$", re.M)
GOAL = 8


@dataclass(frozen=True)
class Step:
    part: str  # A or B
    language: str
    what: str
    text: str


def steps(page):
    """The fenced blocks of the page, in their order."""
    found = []
    for part in re.split(r"^(?=## Part )", page, flags=re.M)[1:]:
        letter = re.match(r"## Part (\w)", part)[1]
        found += [Step(letter, *block.groups()) for block in BLOCK.finditer(part)]
    return found


STEPS = steps(PAGE.read_text("utf-8"))


def said(which):
    """How many existing files the page says are changed by hand in "part A", "both parts"."""
    return int(re.search(rf"Existing files changed by hand in {which}: (\d+)", PAGE.read_text("utf-8"))[1])


@pytest.fixture
def tree(tmp_path):
    """A copy of what git tracks, with this environment."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=toolchain.ROOT, capture_output=True, check=True)
    for name in filter(None, listed.stdout.decode().split("\0")):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(toolchain.ROOT / name, tmp_path / name)
    (tmp_path / ".venv").symlink_to(sys.prefix)
    return tmp_path


def do(step, tree):
    """Follow one step. Every kind that is not known here would be left out undetected: it is refused."""
    if step.what.startswith("file="):
        path = tree / step.what.removeprefix("file=")
        assert not path.exists(), f"{path} is there already"
        path.write_text(step.text, "utf-8")
    elif (step.language, step.what) == ("diff", "patch"):
        apart = {"GIT_CEILING_DIRECTORIES": str(tree.parent)}
        done = subprocess.run(
            ["git", "apply", "--whitespace=error", "-"],
            **{
                "cwd": tree,
                "input": step.text,
                "env": os.environ | apart,
                "capture_output": True,
                "text": True,
            },
        )
        assert done.returncode == 0, f"{done.stderr}{step.text}"
    elif step.language == "console" and step.what in ("", "long"):
        # A run of pytest of its own, whose meissner is the copy's.
        known = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST_", "COV_", "MEISSNER_"))}
        known |= {"PYTHONPATH": str(tree / "model"), "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run(
            ["bash", "-euxo", "pipefail", "-c", step.text],
            **{"cwd": tree, "env": known, "capture_output": True, "text": True},
        )
        assert done.returncode == 0, f"{done.stdout[-8000:]}{done.stderr[-8000:]}"
    else:
        assert (step.language, step.what) == ("console", "by-hand"), f"{step.language} {step.what}"


def changed(tree):
    """Existing files that the steps so far have changed."""
    paths = [path for path in tree.rglob("*") if path.is_file() and ".venv" not in path.parts]
    old = [(path, toolchain.ROOT / path.relative_to(tree)) for path in paths]
    return sorted(
        str(path.relative_to(tree))
        for path, before in old
        if before.exists() and before.read_bytes() != path.read_bytes()
    )


def test_a_leaf_is_three_files_and_a_line(tree):
    """Part A, with its commands; tb/test_twins.py and tb/test_references.py are among them."""
    part = [step for step in STEPS if step.part == "A"]
    by_hand = [step for step in part if step.language != "console"]
    for step in by_hand:
        do(step, tree)
    made = [step.what for step in by_hand if step.what.startswith("file=")]
    assert [Path(name).suffix for name in made] == [".sv", ".py", ".py"]
    assert changed(tree) == ["rtl/rtl.f"] and said("part A") == 1
    assert "+rtl/" in by_hand[1].text and by_hand[1].text.count("\n+") == 2  # "+++" and the line
    commands = [step for step in part if step not in by_hand]
    assert any("tb/test_twins.py tb/test_references.py" in step.text for step in commands)
    for step in commands:
        do(step, tree)


def test_a_feature_changes_few_files_by_hand(tree):
    for step in STEPS:
        if step.language != "console":
            do(step, tree)
    files = changed(tree)
    patched = {name for step in STEPS for name in re.findall(r"^\+\+\+ b/(.+)$", step.text, re.M)}
    assert files == sorted(patched)
    assert len(files) == said("both parts") <= GOAL


@pytest.mark.long
def test_the_feature_works(tree):
    """All commands, those of some minutes too; what they wrote beside is what the page says."""
    for step in STEPS:
        if step.language != "console":
            do(step, tree)
    by_hand = changed(tree)
    for step in STEPS:
        if step.language == "console":
            do(step, tree)
    made = [name for name in changed(tree) if name not in by_hand]
    assert len(made) == 9, made


def test_an_unknown_kind_of_step_is_refused(tree):
    for step in (Step("A", "console", "later", "true\n"), Step("A", "bash", "", "true\n")):
        with pytest.raises(AssertionError):
            do(step, tree)
    with pytest.raises(AssertionError, match="is there already"):
        do(Step("A", "sv", "file=rtl/rtl.f", ""), tree)
    with pytest.raises(AssertionError):
        do(Step("A", "diff", "patch", "--- a/rtl/rtl.f\n+++ b/rtl/rtl.f\n@@ -1 +1 @@\n-no\n+yes\n"), tree)
    with pytest.raises(AssertionError):
        do(Step("A", "console", "", "false\ntrue\n"), tree)
    assert changed(tree) == []
