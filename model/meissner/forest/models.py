"""A trained forest's file, by its suffix."""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from meissner import files
from meissner.forest import file
from meissner.forest.file import Model
from meissner.forest.sklearn import refusal

_KINDS = {".skops": "skops", ".onnx": "onnx", ".joblib": "sklearn", ".pkl": "sklearn", ".pickle": "sklearn"}


class Opened(NamedTuple):
    """``own()``: (name, function from rows to (index of the class, probabilities)) of the library that the
    file's model belongs to; None: an F.json."""

    model: Model
    own: Callable[[], Any] | None = None


def load(path, integer=(), trust=False, others=""):
    """What a trained model's file holds; ``trust``: also one whose loading runs code."""
    path = Path(path)
    kind = _KINDS.get(path.suffix.lower())
    if kind is None:
        raise ValueError(f"{path} must be a {others}.skops, .onnx or .joblib file")
    files.check_in(path)
    kind = import_module(f"meissner.forest.{kind}")
    try:
        given = kind.read(path, trust)
        model = kind.of_model(given, integer)
    except Exception as problem:
        raise refusal(path, problem) from None
    return Opened(model, partial(kind.own, given, model))


def either(path, integer=(), trust=False):
    """The same, or the forest in F.json."""
    if Path(path).suffix.lower() == ".json":
        return Opened(file.read(path))
    return load(path, integer, trust, ".json, ")
