"""A trained model's file, by its suffix."""

from importlib import import_module
from pathlib import Path

from meissner import files

_KINDS = {".skops": "skops", ".onnx": "onnx", ".joblib": "sklearn", ".pkl": "sklearn", ".pickle": "sklearn"}


def load(path, integer=(), trust=False):
    """The Model of a file; ``trust``: also of one whose loading runs code."""
    path = Path(path)
    kind = _KINDS.get(path.suffix.lower())
    if kind is None:
        raise ValueError(f"{path} must be a .skops, .onnx or .joblib file")
    files.check_in(path)
    return import_module(f"meissner.forest.{kind}").of_file(path, integer, trust)
