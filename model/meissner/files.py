"""Reading and writing of users' files: whole or not at all, and one sentence when it cannot be done."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np


def read_array(path):
    """The array in a .npy file or a .csv file (one column per channel, returned as [channels, samples])."""
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"there is no file {path}")
    if path.suffix == ".csv":
        try:
            return np.loadtxt(path, delimiter=",", ndmin=2, comments="#").T
        except ValueError as problem:
            raise ValueError(f"{path} is not a table of numbers: {problem}") from None
    if path.suffix == ".npy":
        try:
            return np.load(path, allow_pickle=False)
        except (ValueError, EOFError, OSError):
            raise ValueError(f"{path} is not a .npy file of numbers") from None
    raise ValueError(f"{path} must be a .npy or a .csv file")


@contextmanager
def written(path):
    """A binary file that takes the name ``path`` only when all of it was written."""
    path = Path(path)
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file")
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as fresh:
        try:
            yield fresh
        except BaseException:
            os.unlink(fresh.name)
            raise
    os.chmod(fresh.name, 0o644)
    os.replace(fresh.name, path)
