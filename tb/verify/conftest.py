"""A copy of the files that digests cover, which a test can change."""

import shutil

import pytest

from meissner.builds import toolchain
from verify import revision

FOLDERS = ("rtl", "tb", "model", "tools", "requirements", "constraints", "host")


@pytest.fixture
def change(tmp_path, monkeypatch):
    """A function that replaces ``text`` by ``other`` in a file of a copy of the sources; digests are those of
    the copy."""
    for folder in FOLDERS:
        without = shutil.ignore_patterns("__pycache__")
        shutil.copytree(toolchain.ROOT / folder, tmp_path / folder, ignore=without)
    monkeypatch.setattr(toolchain, "ROOT", tmp_path)
    revision.forget()

    def changed(file, text, other):
        path = tmp_path / file
        before = path.read_text("utf-8")
        assert text in before
        path.write_text(before.replace(text, other), "utf-8")
        revision.forget()

    yield changed
    revision.forget()
