"""Runs without their pictures: a metric is judged by its number, and drawing takes as long as the run."""

import matplotlib.figure
import pytest


def empty(_, path, **__):
    """In place of a figure's ``savefig``: the file, which the report embeds, without the picture."""
    path.write_bytes(b"")


@pytest.fixture(scope="module", autouse=True)
def undrawn():
    """Before a module's own fixtures, which run scenes too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(matplotlib.figure.Figure, "savefig", empty)
        yield
