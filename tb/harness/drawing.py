"""Scenes run without rendering their pictures, most of a short run's time, for tests of numbers.
tb/physics/test_report.py and the runs on engine fixed draw them."""

from matplotlib.figure import Figure


def off(patch):
    """From now on a picture becomes a file that is none, by ``patch``, a pytest.MonkeyPatch."""
    patch.setattr(Figure, "savefig", lambda _, path, **__: path.write_bytes(b"\x89PNG not really"))
