"""docs/adding.md, followed word for word in a copy of the tree: its files and patches apply, its commands
pass, and as many existing files are changed by hand as it states; at most 8, the project's goal."""

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
    """The fenced blocks of the page, in order."""
    found = []
    for part in re.split(r"^(?=## Part )", page, flags=re.M)[1:]:
        letter = re.match(r"## Part (\w)", part)[1]
        found += [Step(letter, *block.groups()) for block in BLOCK.finditer(part)]
    return found


STEPS = steps(PAGE.read_text("utf-8"))


def said(which):
    """The number of existing files changed by hand that the page states for "part A", "both parts"."""
    return int(re.search(rf"Existing files changed by hand in {which}: (\d+)", PAGE.read_text("utf-8"))[1])


class Tree:
    """A copy of the files that git tracks, with this environment."""

    def __init__(self, top):
        self.top = top
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=toolchain.ROOT, capture_output=True, check=True
        )
        self.names = [name for name in listed.stdout.decode().split("\0") if name]
        for name in self.names:
            (top / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(toolchain.ROOT / name, top / name)
        self.before = {name: (top / name).read_bytes() for name in self.names}
        (top / ".venv").symlink_to(sys.prefix)
        (toolchain.BUILD / "objects").mkdir(parents=True, exist_ok=True)
        (top / "build").mkdir()
        (top / "build/objects").symlink_to(toolchain.BUILD / "objects")  # Verilator's runtime, compiled once

    def changed(self):
        """Existing files that the steps have changed so far."""
        return [name for name in self.names if (self.top / name).read_bytes() != self.before[name]]


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


def run(tree, command, environment, given=None):
    told = {"cwd": tree.top, "env": environment, "input": given}
    done = subprocess.run(command, **told, capture_output=True, text=True)
    assert done.returncode == 0, f"{done.stdout[-8000:]}{done.stderr[-8000:]}{given or ''}"


def do(step, tree):
    """Follow one step. An unknown kind is refused, as otherwise it would be skipped undetected."""
    if step.what.startswith("file="):
        path = tree.top / step.what.removeprefix("file=")
        assert not path.exists(), f"{path} is there already"
        path.write_text(step.text, "utf-8")
    elif (step.language, step.what) == ("diff", "patch"):
        apart = {"GIT_CEILING_DIRECTORIES": str(tree.top.parent)}
        run(tree, ["git", "apply", "--whitespace=error", "-"], os.environ | apart, step.text)
    elif step.language == "console" and step.what in ("", "long"):
        # A pytest in the step is separate, and its meissner is the copy's.
        known = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST_", "COV_", "MEISSNER_"))}
        known |= {"PYTHONPATH": str(tree.top / "model")}
        run(tree, ["bash", "-euxo", "pipefail", "-c", step.text], known)
    else:
        assert (step.language, step.what) == ("console", "by-hand"), f"{step.language} {step.what}"


def test_a_leaf_is_four_files_and_a_line(tree):
    """Part A, with its commands, which include tb/test_twins.py."""
    part = [step for step in STEPS if step.part == "A"]
    by_hand = [step for step in part if step.language != "console"]
    for step in by_hand:
        do(step, tree)
    made = [step.what for step in by_hand if step.what.startswith("file=")]
    assert [Path(name).suffix for name in made] == [".sv", ".py", ".py", ".py"]
    assert tree.changed() == ["rtl/rtl.f"] and said("part A") == 1
    assert "+rtl/" in by_hand[1].text and by_hand[1].text.count("\n+") == 2  # "+++" and the added line
    commands = [step for step in part if (step.language, step.what) == ("console", "")]
    assert any("tb/test_twins.py" in step.text for step in commands)
    for step in commands:
        do(step, tree)


def test_a_feature_changes_few_files_by_hand(tree):
    for step in STEPS:
        if step.language != "console":
            do(step, tree)
    files = tree.changed()
    patched = {name for step in STEPS for name in re.findall(r"^\+\+\+ b/(.+)$", step.text, re.M)}
    assert sorted(files) == sorted(patched)
    assert len(files) == said("both parts") <= GOAL


@pytest.mark.long
def test_the_feature_works(tree):
    """All commands, including those that take minutes; they write as many other files as the page states."""
    for step in STEPS:
        if step.language != "console":
            do(step, tree)
    by_hand = tree.changed()
    for step in STEPS:
        if step.language == "console":
            do(step, tree)
    made = [name for name in tree.changed() if name not in by_hand]
    assert len(made) == 7 and "Commands wrote seven more" in PAGE.read_text("utf-8"), made


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
    assert tree.changed() == []
