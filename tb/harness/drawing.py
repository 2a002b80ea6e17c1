"""Scenes run without their pictures, for tests of numbers: drawing takes up to a third of a short run's time.
tb/physics/test_report.py draws every scene."""

import matplotlib.figure
import numpy as np


class Undrawn:
    """Stands for a plot: takes all that is asked of it, returns itself, and holds nothing."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *_, **__):
        return self

    def __getitem__(self, _):
        return self

    def __iter__(self):
        return iter(())


def subplots(_, nrows=1, ncols=1, *, squeeze=True, **__):
    """Figure.subplots: one plot, or an array of them, of the same shape."""
    plots = np.full((nrows, ncols), Undrawn(), dtype=object)
    if not squeeze:
        return plots
    return plots.item() if plots.size == 1 else plots.squeeze()


def empty(_, path, **__):
    """Figure.savefig: a file that is no picture, because the report embeds one."""
    path.write_bytes(b"\x89PNG not really")


def off(patch):
    """Draw nothing from now on, by ``patch``, a pytest.MonkeyPatch."""
    either = matplotlib.figure.FigureBase  # a figure or a part of one
    patch.setattr(either, "subplots", subplots)
    patch.setattr(either, "add_subplot", lambda *_, **__: Undrawn())
    patch.setattr(either, "colorbar", lambda *_, **__: Undrawn())
    patch.setattr(matplotlib.figure.Figure, "savefig", empty)
