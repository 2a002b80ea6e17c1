"""Arrays by name: NumPy, MATLAB, WAV, sigrok, and what is like them."""

import configparser
import os
import pickle
import re
import subprocess
import sys
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meissner import files
from meissner.readers.table import Column, Table, check_memory, column

NAMED = 4  # arrays in a sentence
_RATE = re.compile(r"(sampl\w*_?)?(rate|freq\w*)(_?hz)?|fs", re.I)


def _fields(arrays: Mapping[str, tuple[Any, str]]) -> Iterator[tuple[str, NDArray[Any], str]]:
    """(name, array, unit), those of a structured array or a struct field by field."""
    for name, (array, unit) in arrays.items():
        array = np.asarray(array)
        if array.dtype.names is None:
            yield name, array, unit
        else:
            one = array.reshape(-1)[0] if array.size == 1 else array
            own = {f"{name}.{field}".lstrip("."): (one[field], unit) for field in array.dtype.names}
            yield from _fields(own)


def of_named(arrays: Mapping[str, tuple[Any, str]], how: str, longest: bool = True) -> Table:
    """A Table of {name: (array, unit)}; a single number named like a rate is the rate, if it is the only one.

    ``longest``: two dimensions are turned so that the longer one is time.
    """
    columns, rates, others = [], set(), []
    for name, array, unit in _fields(arrays):
        if array.dtype.kind not in "iufbc":
            others.append(f"{name} ({array.dtype})")
            continue
        if array.size == 1 and _RATE.fullmatch(re.split("[./]", name)[-1]):
            rates.add(float(array.reshape(-1)[0].real))
            continue
        if array.ndim == 0 or (longest and array.size == 1):
            continue
        if longest and array.ndim == 2:
            array = (
                array.ravel() if 1 in array.shape else array.T if array.shape[0] > array.shape[1] else array
            )
        columns.append(column(name, array, unit))
    if not columns and others:
        how = f"{how} with {', '.join(others[:NAMED])}"
    return Table(columns, how, rates.pop() if len(rates) == 1 else None)


def npy(path: Path) -> Table:
    array = files.read_npy(path)
    if array is None:
        raise ValueError(f"{path} is not a .npy file of numbers")
    if array.dtype.names:
        return of_named({"": (array, "")}, "a structured array")
    return Table([Column("samples", "", array, named=False)], f"an array of {array.dtype}")


def npz(path: Path, wanted: tuple[str, ...]) -> Table:
    """``wanted``: read only these, and a rate; numbers choose among all."""
    parts = [part.strip().lower() for name in wanted for part in (name, *name.split(","))]
    chosen = set() if any(part.isdecimal() for part in parts) else {*parts}
    names: list[str] = []

    def take(name: str, *_: object) -> bool:
        names.append(name)
        return not chosen or name.lower() in chosen or bool(_RATE.fullmatch(name))

    arrays = files.read_arrays(path, take)
    if arrays is None:
        raise ValueError(f"{path} is not a .npz file of arrays of numbers")
    how = "arrays by name" if arrays else f"the arrays {', '.join(names[:8])}"
    return of_named({name: (array, "") for name, array in arrays.items()}, how, False)


# In a process of its own: of a damaged file SciPy's compiled reader may end with a segmentation fault.
_MATLAB = """
import pickle, sys, warnings
from scipy.io import loadmat
warnings.simplefilter("ignore")
try:
    found = loadmat(sys.argv[1], chars_as_strings=False)
except Exception as problem:
    found = str(problem) or type(problem).__name__
pickle.dump(found, sys.stdout.buffer, 5)
"""


def mat(path: Path) -> Table:
    words = [sys.executable, "-c", _MATLAB, str(path.absolute())]
    safe = os.environ | {"PYTHONSAFEPATH": "1"}  # no module of the folder in which the command runs
    done = subprocess.run(words, capture_output=True, check=False, env=safe)
    arrays = "it is damaged" if done.returncode else pickle.loads(done.stdout)
    if isinstance(arrays, str):
        raise ValueError(arrays)
    named = {name: (array, "") for name, array in arrays.items() if not name.startswith("__")}
    return of_named(named, "MATLAB 5")


def wav(path: Path) -> Table:
    from scipy.io import wavfile

    with warnings.catch_warnings(action="ignore"):  # about chunks that hold no samples
        warnings.filterwarnings("error", "Reached EOF")
        rate, samples = wavfile.read(path)
    channels = samples.reshape(len(samples), 1 if samples.ndim == 1 else -1).T
    with path.open("rb") as file:
        head = file.read(1 << 16).partition(b"fmt ")[2]
    kind = str(samples.dtype)
    if kind == "int32" and int.from_bytes(head[16:18], "little") == 3 * len(channels):
        channels, kind = channels >> 8, "24 bits"  # SciPy puts the three bytes above an empty one
    columns = [Column(f"channel {k}", "", values) for k, values in enumerate(channels, 1)]
    how = f"audio, {len(channels)} channel{'s' * (len(channels) > 1)} of {kind} at {rate} Hz"
    return Table(columns, how, float(rate), audio=True)


def sigrok(path: Path) -> Table:
    """The analog channels of a session, which are floats; their numbers follow those of its logic probes."""
    with zipfile.ZipFile(path) as session:
        sizes = {info.filename: info.file_size for info in session.infolist()}
        check_memory(path, 3 * sum(sizes.values()))
        if "metadata" not in sizes:
            raise ValueError("it has no metadata")
        ini = configparser.RawConfigParser(strict=False, delimiters=("=",))
        ini.read_string(session.read("metadata").decode("utf-8"))
        device = dict(next((ini[name] for name in ini.sections() if name.startswith("device")), {}))
        named = {int(key[6:]): name for key, name in device.items() if re.fullmatch(r"analog\d+", key)}
        parts: dict[int, list[tuple[int, str]]] = {}
        for name in sizes:
            if found := re.fullmatch(r"analog-\d+-(\d+)-(\d+)", name):
                parts.setdefault(int(found[1]), []).append((int(found[2]), name))
        if not parts:
            probes = device.get("total probes", "no")
            raise ValueError(f"{path} is a logic capture of {probes} probes without an analog channel")
        columns = []
        for number, chunks in sorted(parts.items()):
            chunks.sort()
            if [at for at, _ in chunks] != [*range(1, len(chunks) + 1)]:
                raise ValueError(f"a part of channel {number} is missing")
            data = b"".join(session.read(name) for _, name in chunks)
            if len(data) % 4:
                raise ValueError(f"channel {number} ends within a number")
            values: NDArray[Any] = np.frombuffer(data, "<f4").astype(np.float64)
            columns.append(Column(named.get(number, f"analog {number}"), "V", values))
    rate = re.fullmatch(r"\s*([\d.]+)\s*([kMG]?)(Hz)?\s*", device.get("samplerate", ""))
    factor = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
    return Table(columns, "a sigrok session", float(rate[1]) * factor[rate[2]] if rate else None)
