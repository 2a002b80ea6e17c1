"""Runs without pictures: a metric is judged by its number. Every metric has a fault that turns it."""

import ast
from pathlib import Path

import pytest

from harness import drawing

# Of a run, and no metrics.
FACTS = "scene engine seed seeds runs conditions constants rows columns modelled left_out built not_built"
FACTS += " files pins seconds_taken seconds_simulated samples_per_second twin_mismatches"


@pytest.fixture(scope="module", autouse=True)
def undrawn():
    """Takes effect before a module's own fixtures, which also run scenes."""
    with pytest.MonkeyPatch.context() as patch:
        drawing.off(patch)
        yield


@pytest.fixture(scope="module")
def sound(request):
    """A module's unbroken summaries, from its ``unbroken``. One of its tests names each of their metrics,
    or a set that holds it; METRICS, which lists them all, does not count."""
    found = request.getfixturevalue("unbroken")
    module = request.module
    tree = ast.parse(Path(module.__file__).read_text("utf-8"))
    tests = [node for node in tree.body if getattr(node, "name", "").startswith("test_")]
    parts = [part for test in tests for part in ast.walk(test)]
    named = {part.value for part in parts if isinstance(part, ast.Constant)}
    for name in {part.id for part in parts if isinstance(part, ast.Name)} - {"METRICS"}:
        value = getattr(module, name, None)
        named |= value if isinstance(value, set) else set()
    summaries = [found] if "over_range" in found or "scene" in found else found.values()
    lacking = {key for one in summaries for key in one} - named - set(FACTS.split())
    assert not lacking, f"no test plants a fault for {', '.join(sorted(lacking))}"
    return found
