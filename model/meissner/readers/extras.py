"""Formats whose libraries the extra ``formats`` installs: HDF5, TDMS, bags of ROS 1 and 2."""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from meissner.readers.arrays import of_named
from meissner.readers.messages import Collected
from meissner.readers.table import Column, Table, check_memory, unit_of

_MATLAB = ("double", "single", "logical", *(f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)))


def _library(path: Path, name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise ValueError(
            f"{path} needs {name.split('.')[0]}: pip install 'meissner-touch[formats]'"
        ) from None


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def hdf5(path: Path) -> Table:
    h5py, sets, rates = _library(path, "h5py"), {}, {}

    def visit(name: str, item: Any) -> None:
        text = _text(item.attrs.get("MATLAB_class", ""))  # whose letters are numbers, too
        if isinstance(item, h5py.Dataset) and not name.startswith("#") and text in ("", *_MATLAB):
            sets[name] = item
        for key, value in item.attrs.items():
            if not isinstance(value, h5py.Empty) and np.size(value) == 1:
                rates[f"{name}/{key}"] = (value, "")

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
        check_memory(path, sum(one.nbytes for one in sets.values()))
        unit = lambda one: next((_text(one.attrs[key]) for key in ("unit", "units") if key in one.attrs), "")
        arrays = {name: (one[()], unit(one)) for name, one in sets.items() if one.shape is not None}
    return of_named(rates | arrays, "HDF5")


def tdms(path: Path) -> Table:
    library, columns, steps = _library(path, "nptdms"), [], set()
    for group in library.TdmsFile.read(path).groups():
        for one in group.channels():
            values = one[:]
            if len(values) and values.dtype.kind in "iufb":
                columns.append(Column(one.name, unit_of(str(one.properties.get("unit_string", ""))), values))
                steps.add(float(one.properties.get("wf_increment", 0.0)))
    if not columns:
        raise ValueError(f"{path} holds no channel of numbers")
    step = steps.pop() if len(steps) == 1 else 0.0
    return Table(columns, "TDMS", 1 / step if step > 0 else None)


def bag(path: Path, wanted: tuple[str, ...]) -> Table:
    """A .bag, a .db3, or the folder of a rosbag2."""
    reader = _library(path, "rosbags.highlevel")
    stores = _library(path, "rosbags.typesys")
    where = path.parent if path.suffix == ".db3" and (path.parent / "metadata.yaml").is_file() else path
    found = Collected(path, "a bag")
    store = stores.get_typestore(stores.Stores.LATEST)
    with reader.AnyReader([where], default_typestore=store) as opened:
        for connection, stamp, raw in opened.messages():
            message = opened.deserialize(raw, connection.msgtype)
            found.add(connection.topic, connection.msgtype, stamp, message)
    return found.table(wanted)
