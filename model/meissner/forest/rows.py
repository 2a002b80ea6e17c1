"""Tables of features: columns by the features' names where the table has names, else by position."""

import csv
from typing import Any, NamedTuple

import numpy as np

from meissner import files
from meissner.forest.file import unnamed


class Rows(NamedTuple):
    """``x`` [rows, features]; ``y`` [rows], labels, or None; ``taken``: what was taken for the features."""

    x: Any
    y: Any
    taken: str


def read(path, names, labelled=False):
    """The Rows of a table for a forest whose features have ``names``.

    .csv: with a header, or numbers alone; an empty cell is a missing value. .npy: [rows, features], or
    records with names. .npz: ``x``. ``labelled``: also ``y`` of a .npz, or the last column of a .csv.
    """
    path = files.check_in(path)
    kind, y = path.suffix.lower(), None
    if kind == ".npz":
        given = files.read_arrays(path)
        if given is None:
            raise ValueError(
                f"{path} is no .npz of numbers and texts; of objects, save x.astype(float), y.astype(str)"
            )
        for name in ("x", "y")[: 1 + labelled]:
            if name not in given:
                raise ValueError(f"{path} has no array {name}; it must have x [rows, features] and y [rows]")
        head, x, y = None, given["x"], given["y"] if labelled else None
    elif kind == ".npy" and not labelled:
        x = files.read_npy(path)
        if x is None:
            raise ValueError(f"{path} is not a .npy file of numbers")
        head = x.dtype.names
        if head and x.ndim == 1:
            x = np.stack([x[name].astype(object) for name in head], 1)
    elif kind == ".csv":
        head, x = _table(path, labelled, names)
        if labelled:
            x, y, head = x[:, :-1], x[:, -1], head and head[:-1]
    else:
        raise ValueError(f"{path} must be {'' if labelled else 'a .npy, '}a .npz or a .csv file")
    if x.ndim != 2 or not len(x):
        raise ValueError(f"{path}: the rows must have the shape [rows, {len(names)}], not {x.shape}")
    if y is not None and y.shape != x.shape[:1]:
        raise ValueError(f"{path}: {x.shape} features do not fit {y.shape} labels")
    at, taken = _chosen(path, names, head, x.shape[1])
    return Rows(_numbers(path, names, x[:, at]), y, taken)


def _table(path, labelled, names):
    """(header or None, cells) of a .csv file, whose last column may be texts if it is ``labelled``.

    A header is a first line without numbers, or with a feature's name that is none; of numbers, if it has
    all ``names``, or counts three columns or more from 0."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as text:  # a spreadsheet's byte order mark
            lines = [(number, line) for number, line in enumerate(csv.reader(text), 1) if line]
    except (ValueError, csv.Error) as problem:
        raise ValueError(f"{path} is not a table of numbers: {problem}") from None
    if not lines:
        raise ValueError(f"{path} has no rows")
    head = [*map(_plain, lines[0][1])]
    for number, line in lines:
        if len(line) != len(head):
            raise ValueError(f"{path}, line {number}: {len(line)} values are not {len(head)}")
    columns, plain = head[: len(head) - labelled], {*map(_plain, names)}
    counted = len(columns) > 2 and columns == [*map(str, range(len(columns)))]
    texts = [cell for cell in columns if not _is_number(cell)]
    numbers = len(columns) - len(texts) - columns.count("")
    named = counted or plain <= {*columns} or bool(plain & {*texts}) or (texts and not numbers)
    body = [line for _, line in lines[bool(named) :]]
    return head if named else None, np.array(body, object).reshape(-1, len(head))


def _plain(name):
    """A name as a header shows it."""
    return name.strip().removeprefix("#").strip()


def _grouped(cell):
    """1_000, which is a number for Python alone."""
    return isinstance(cell, str) and "_" in cell


def _is_number(cell):
    if _grouped(cell):
        return False
    try:
        float(cell or "nan")
    except (ValueError, TypeError):
        return False
    return True


def _chosen(path, names, head, count):
    """(indices of the columns that are the features, how they were found)."""
    plain, head = [*map(_plain, names)], [*map(_plain, head or ())]
    if set(plain) & set(head):
        for name in plain:
            if head.count(name) != 1:
                how = "missing" if name not in head else "there twice"
                raise ValueError(f"{path}: the feature {name} is {how}")
            if plain.count(name) > 1:
                raise ValueError(f"{path}: two features have the name {name}: give columns without names")
        others = [name for name in head if name not in plain]
        unused = f", not used: {', '.join(others)}" if others else ""
        return [head.index(name) for name in plain], f"by name{unused}"
    if head and not unnamed(names):
        raise ValueError(f"{path}: the feature {names[0]} is missing")
    if count != len(names):
        raise ValueError(
            f"{path}: the features {names[0]} to {names[-1]} need {len(names)} columns, not {count}"
        )
    return slice(None), "by position" + ", since the forest has no names" * bool(head)


def _numbers(path, names, cells):
    if cells.dtype != object:
        return cells
    try:
        if any(map(_grouped, cells.flat)):
            raise ValueError
        return np.where(cells == "", "nan", cells).astype(np.float64)
    except (ValueError, TypeError):
        row, column = next(at for at, cell in np.ndenumerate(cells) if not _is_number(cell))
        raise ValueError(
            f"{path}, row {row}: {names[column]} = {cells[row, column]!r} is not a number"
        ) from None
