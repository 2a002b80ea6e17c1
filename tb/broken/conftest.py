"""Runs without pictures: a metric is judged by its number, and drawing takes a third of a run's time.
tb/physics/test_report.py draws every scene."""

import matplotlib.figure
import pytest

from meissner.scenes.array import pictures as of_array
from meissner.scenes.grip import pictures as of_grip
from meissner.scenes.hand import pictures as of_hand
from meissner.scenes.rubber import pictures as of_rubber

DRAWN = [
    *((of_array, "draw_array"), (of_array, "draw_mesh"), (of_grip, "draw"), (of_grip, "draw_ways")),
    *((of_hand, "draw"), (of_rubber, "draw_slip")),
]


def empty(path, *_, **__):
    """Writes an empty file in place of a picture, because the report embeds the file."""
    path.write_bytes(b"")
    return path


@pytest.fixture(scope="module", autouse=True)
def undrawn():
    """Takes effect before a module's own fixtures, which also run scenes."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name in DRAWN:
            patch.setattr(module, name, empty)
        # Other modules draw several pictures in one call.
        patch.setattr(matplotlib.figure.Figure, "savefig", lambda _, path, **__: empty(path))
        yield
