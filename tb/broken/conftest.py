"""Runs without pictures: a metric is judged by its number."""

import pytest

import undrawn as nothing


@pytest.fixture(scope="module", autouse=True)
def undrawn():
    """Takes effect before a module's own fixtures, which also run scenes."""
    with pytest.MonkeyPatch.context() as patch:
        nothing.use(patch)
        yield
