"""Runs without pictures: a metric is judged by its number."""

import pytest

from harness import drawing


@pytest.fixture(scope="module", autouse=True)
def undrawn():
    """Takes effect before a module's own fixtures, which also run scenes."""
    with pytest.MonkeyPatch.context() as patch:
        drawing.off(patch)
        yield
