"""Reading and writing of users' files: whole or not at all, and one sentence when it cannot be done."""

import os
import tempfile
import warnings
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from meissner.toolchain import ROOT


def recordings(name):
    """Path of recorded data, which the project does not contain: in $MEISSNER_DATA, or ../shared/data."""
    folder = os.environ.get("MEISSNER_DATA")
    path = (Path(folder) if folder else ROOT.parent / "shared/data") / name
    if not path.is_file():
        looked = "$MEISSNER_DATA" if folder else "../shared/data"
        raise ValueError(f"the recordings {name} are not in {looked}: nothing was measured on them")
    return path


def read_array(path):
    """The array in a .npy file or a .csv file (one column per channel, returned as [channels, samples])."""
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"there is no file {path}")
    if path.suffix.lower() == ".csv":
        try:
            with warnings.catch_warnings(action="ignore"):  # of an empty file: refused below
                # utf-8-sig: spreadsheets put a mark before the first number
                table = np.loadtxt(path, delimiter=",", ndmin=2, comments="#", encoding="utf-8-sig")
        except ValueError as problem:
            raise ValueError(f"{path} is not a table of numbers: {problem}") from None
        if not table.size:
            raise ValueError(f"{path} holds no numbers")
        return table.T
    if path.suffix.lower() == ".npy":
        array = _load(path)
        if not isinstance(array, np.ndarray):  # an archive of arrays is none either
            raise ValueError(f"{path} is not a .npy file of numbers")
        return array
    raise ValueError(f"{path} must be a .npy or a .csv file")


def read_arrays(path):
    """The arrays of a .npz file by name; {} if it is none."""
    return arrays_of(path)


def arrays_of(file):
    """The same of a path or a file that is open."""
    with warnings.catch_warnings(action="ignore"):
        found = _load(file, whole=True)
    whole = isinstance(found, dict) and all(isinstance(array, np.ndarray) for array in found.values())
    return found if whole else {}


def _load(path, whole=False):
    """What numpy finds in a file, None if nothing: a damaged one stops it, and what unpacks, anywhere."""
    try:
        found = np.load(path, allow_pickle=False)
        if not whole or isinstance(found, np.ndarray):
            return found
        with found:
            return {name: found[name] for name in found.files}
    except PermissionError:
        raise
    except Exception:
        return None


def check_out(path):
    """``path`` if a file can take this name; ValueError in one sentence if not."""
    path = Path(path)
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file")
    if path.exists() and not path.is_file():
        raise ValueError(f"{path} is not a file that could be replaced")  # a device, a pipe
    return path


@contextmanager
def written(path):
    """A binary file that takes the name ``path`` only when all of it was written."""
    path = check_out(path)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as fresh:
        try:
            yield fresh
        except BaseException:
            os.unlink(fresh.name)
            raise
    os.chmod(fresh.name, 0o644)
    os.replace(fresh.name, path)
