"""Reading and writing of users' files: complete or not at all, with one sentence for any failure."""

import csv
import errno
import io
import math
import os
import tempfile
import warnings
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
from numpy.lib import format

HEADER_LIMIT = 1 << 16  # bytes; NumPy's own limit is 10,000
MEMORY_SHARE = 0.5
FULL = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk's quota is used up",
    errno.EFBIG: "the file may not grow any more",
}


class NoRoom(OSError):
    """No space left for a file that was being written."""

    def __str__(self):
        return self.strerror


def check_in(path):
    """``path`` if it is a regular file; ValueError in one sentence if not: reading a pipe would block."""
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file")
    if not path.exists():
        raise ValueError(f"there is no file {path}")
    if not path.is_file():
        raise ValueError(f"{path} is a pipe or a device; name a file")
    return path


def read_npy(path):
    """The array in a .npy file; None if it is not such a file, but an archive or damaged."""
    array = _load(check_in(path))
    return array if isinstance(array, np.ndarray) else None


def read_arrays(path, wanted=None):
    """The arrays of a .npz file by name; None if it is not such a file.

    ``wanted``: a function of (name, shape, dtype), called before an array is unpacked, that returns whether
    to read it, or raises ValueError. Together the arrays may take half of the machine's memory.
    """
    return arrays_of(path, wanted)


def arrays_of(file, wanted=None):
    """The same for a path or an open file."""
    with warnings.catch_warnings(action="ignore"):
        found = _load(file, whole=True, wanted=wanted)
    whole = isinstance(found, dict) and all(isinstance(array, np.ndarray) for array in found.values())
    return found if whole else None


class Unwanted(ValueError):
    """The contents that a file declares are refused: by ``wanted``, with its sentence, or as too large."""


def _header(file):
    """(shape, dtype) of a .npy from the beginning of ``file``; ValueError if it is not a .npy."""
    head = file.read(8)
    size = {1: 2, 2: 4}.get(head[6] if len(head) == 8 else 0, 0)
    length = int.from_bytes(file.read(size), "little")
    if not size or length > HEADER_LIMIT:  # the header is unpacked completely, and can declare 4 GB
        raise ValueError("no header of numbers")
    rest = io.BytesIO(length.to_bytes(size, "little") + file.read(length))
    shape, _, dtype = (format.read_array_header_1_0 if size == 2 else format.read_array_header_2_0)(rest)
    return shape, dtype


def _names(path, archive, wanted):
    """Names of the arrays to read from an open archive, chosen by their headers."""
    names, total = [], 0
    for member in archive.zip.namelist():
        name = member.removesuffix(".npy")
        with archive.zip.open(member) as file:
            shape, dtype = _header(file)
        if wanted is None or wanted(name, shape, dtype):
            names.append(name)
            total += math.prod(shape) * dtype.itemsize
    if total > MEMORY_SHARE * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"):
        raise Unwanted(f"{path} would take {total / 1e9:.1f} GB of memory, more than half of this machine's")
    return names


def _load(path, whole=False, wanted=None):
    """The contents of a file as numpy loads them, or None: a damaged file can fail anywhere in loading."""
    try:
        if isinstance(path, Path) and not whole:
            with path.open("rb") as file:
                shape, dtype = _header(file)
                if math.prod(shape) * dtype.itemsize > path.stat().st_size:
                    return None  # declares more than it has; numpy would allocate that first
        found = np.load(path, allow_pickle=False)
        if not whole or isinstance(found, np.ndarray):
            return found
        with found:
            return {name: found[name] for name in _names(path, found, wanted)}
    except (PermissionError, Unwanted):
        raise
    except Exception:
        return None


def check_out(path):
    """``path`` if a file can be written with this name; ValueError in one sentence if not."""
    path = Path(path)
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    if path.is_dir():
        raise ValueError(f"{path} is a folder; name a file")
    if path.exists() and not path.is_file():
        raise ValueError(f"{path} is not a regular file and cannot be replaced")  # a device, a pipe
    return path


def check_kept(out, overwrite, inputs, holds=""):
    """Raise ValueError if output to ``out`` would lose a file: one of ``inputs``, each perhaps a file or a
    prefix, a colon and a file; without ``overwrite`` any that exists. ``holds``: its name in a folder.
    """
    out = Path(out)
    target = out / holds if holds and out.is_dir() else out
    if not target.is_file() or (holds and target.suffix.lower() != Path(holds).suffix):
        return  # free, or no place for this output: its command says so
    for name in inputs:
        for path in (Path(name), Path(name.partition(":")[2])):
            with suppress(OSError):
                if path.is_file() and path.samefile(target):
                    raise ValueError(f"{out} is an input of this command: name another output")
    if not overwrite:
        raise ValueError(f"{target} exists: name another output, or replace it with --overwrite")


@contextmanager
def written(path):
    """A binary file that gets the name ``path`` only after it is completely written."""
    path = check_out(path)
    fresh = tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False)  # noqa: SIM115
    try:
        yield fresh
        fresh.close()
    except BaseException as problem:
        with suppress(OSError):  # closing flushes the buffer, which fails again without space
            fresh.close()
        os.unlink(fresh.name)
        if isinstance(problem, OSError) and problem.errno in FULL:
            sentence = f"{path} could not be written: {FULL[problem.errno]}"
            raise NoRoom(problem.errno, sentence) from None
        raise
    os.chmod(fresh.name, 0o644)
    os.replace(fresh.name, path)


@contextmanager
def results(path):
    """A function that writes named arrays to ``path``, as .npz or .csv according to its suffix."""
    path = check_out(path)
    kind = path.suffix.lower()
    if kind not in (".npz", ".csv"):
        raise ValueError(f"{path} must be a .npz or a .csv file")
    with written(path) as file:
        yield lambda arrays: np.savez(file, **arrays) if kind == ".npz" else _write_table(file, arrays)


def _write_table(file, arrays):
    """One column per array, or per channel of an array [channels, rows]: p2p_0, p2p_1, ...; flags as 0, 1."""
    columns = {}
    for name, array in arrays.items():
        several = {f"{name}_{channel}": row for channel, row in enumerate(array)} if array.ndim == 2 else {}
        columns |= several or {name: array}
    text = io.TextIOWrapper(file, "utf-8", newline="")
    table = csv.writer(text)
    table.writerow(columns)
    for row in zip(*(column.tolist() for column in columns.values()), strict=True):
        table.writerow(int(cell) if isinstance(cell, bool) else cell for cell in row)
    text.detach()
