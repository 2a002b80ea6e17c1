"""Logs of what a core said: written to .mcap (ROS 2 messages) or .npz (arrays), read back from either.

Arrays, one row a packet, times in clocks and ``_ns`` in nanoseconds of UTC:

    slip_time, _ns, _channel, _state, _p2p           cop_time, _ns, _x, _y, _load, _pressed
    image_time, _ns, _number                         image [images, rows, columns]
    health_time, _ns, _taxel, _faults                statistics_time, _ns, _index, _value
    gap_ns, _seconds, _reason

and the facts: clk_khz, start_ns and start_time (the same instant), newtons_per_code (nan: not known),
min_load where the core told it, and the counters of the line (meissner.host.core.Counts).
"""

import io
import time
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import asdict
from pathlib import Path

import numpy as np

from meissner.files import read_arrays, written
from meissner.host import packets, ros
from meissner.host.units import FRACTION_BITS

_COLUMNS = {
    "slip": {"time": "u8", "ns": "i8", "channel": "u2", "state": "u1", "p2p": "u4"},
    "cop": {"time": "u8", "ns": "i8", "x": "i4", "y": "i4", "load": "u8", "pressed": "?"},
    "image": {"time": "u8", "ns": "i8", "number": "u1"},
    "health": {"time": "u8", "ns": "i8", "taxel": "u4", "faults": "u1"},
    "statistics": {"time": "u8", "ns": "i8", "index": "u1", "value": "u4"},
    "gap": {"ns": "i8", "seconds": "f8", "reason": "U"},
}
_KINDS = {
    packets.SlipEvent: "slip",
    packets.CopFrame: "cop",
    packets.Image: "image",
    packets.Health: "health",
    packets.Statistics: "statistics",
    packets.Gap: "gap",
}
_FACTS = {"clk_khz": int, "start_ns": int, "start_time": int, "newtons_per_code": float, "min_load": int}


class Table:
    """Packets as columns of numbers."""

    def __init__(self):
        self._columns = {kind: {name: [] for name in names} for kind, names in _COLUMNS.items()}
        self._images = []

    def add(self, stamp_ns, item):
        kind = _KINDS[type(item)]
        for name, column in self._columns[kind].items():
            value = stamp_ns if name == "ns" else getattr(item, name)
            column.append(round(value * (1 << FRACTION_BITS)) if name in ("x", "y") else value)
        if kind == "image":
            if self._images and item.taxels.shape != self._images[0].shape:
                raise ValueError(
                    f"an image of {item.taxels.size} taxels came after one of {self._images[0].size}: "
                    "a log holds images of one size"
                )
            self._images.append(item.taxels)

    def arrays(self):
        found = {
            f"{kind}_{name}": np.array(column, dtype=_COLUMNS[kind][name])
            for kind, columns in self._columns.items()
            for name, column in columns.items()
        }
        found["image"] = np.array(self._images, dtype=np.uint16).reshape(
            len(self._images), *(self._images[0].shape if self._images else (0, 0))
        )
        return found


class NpzWriter(Table):
    def __init__(self, file, known):
        super().__init__()
        self._file = file

    def finish(self, facts):
        np.savez_compressed(self._file, **self.arrays(), **{k: np.asarray(v) for k, v in facts.items()})


WRITERS = {".npz": NpzWriter, ".mcap": ros.McapWriter}


class Log:
    """``add`` packets of ``core``; clocks become time with the core's clock, and anew after its reset."""

    def __init__(self, writer, core):
        if not core.units.clk_khz:
            raise ValueError(
                "the core's clock is not known, so its clocks cannot become time: name it in kHz"
            )
        self._writer, self._core, self._anchor, self._restarts = writer, core, None, 0
        self.packets, self._facts = 0, {}
        if core.registers and "cop" in core.features:
            self._facts["min_load"] = core["cop.min_load"]
        if core.now:
            self._set(core.now)

    def _set(self, ticks):
        self._anchor, self._restarts = (time.time_ns(), ticks), self._core.counts.restarts

    def _stamp(self, ticks):
        if self._anchor is None or self._restarts != self._core.counts.restarts:
            self._set(ticks)
        start_ns, start = self._anchor
        return start_ns + (ticks - start) * 10**6 // self._core.units.clk_khz

    def add(self, item):
        stamp = time.time_ns() if isinstance(item, packets.Gap) else self._stamp(item.time)
        self._writer.add(stamp, item)
        self.packets += 1

    def finish(self):
        start_ns, start = self._anchor or (time.time_ns(), 0)
        known = self._core.units
        newtons = float("nan") if known.newtons_per_code is None else known.newtons_per_code
        facts = {
            "clk_khz": known.clk_khz,
            "start_ns": start_ns,
            "start_time": start,
            "newtons_per_code": newtons,
        }
        self._writer.finish(facts | self._facts | asdict(self._core.counts))


def check_out(path):
    """The kind of log that ``path`` names, ValueError if none."""
    kind = Path(path).suffix.lower()
    if kind not in WRITERS:
        raise ValueError(f"{path} must be a .mcap or a .npz file")
    return kind


@contextmanager
def recording(path, core):
    """A Log that takes the name ``path`` when it is whole; ValueError if there can be none."""
    kind = check_out(path)
    with written(path) as file:
        log = Log(WRITERS[kind](file, core.units), core)
        yield log
        log.finish()


def read(path):
    """The arrays and facts of a log; ValueError in one sentence if it is none."""
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"there is no file {path}")
    if path.suffix.lower() == ".mcap":
        return _read_mcap(path)
    if path.suffix.lower() != ".npz":
        raise ValueError(f"{path} must be a .mcap or a .npz file")
    arrays = read_arrays(path)
    _check(path, arrays)
    return arrays


def _read_mcap(path):
    table = Table()
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # a parser of messages prints
            facts, items = ros.read(path)
            for stamp, item in items:
                table.add(stamp, item)
        found = {name: np.asarray(kind(facts[name])) for name, kind in _FACTS.items() if name in facts}
    except PermissionError:
        raise
    except Exception as problem:  # a damaged file stops its reader, and what unpacks for it, anywhere
        what = str(problem).splitlines()[0] if str(problem) else type(problem).__name__
        raise ValueError(f"{path} is not a whole MCAP log of a core: {what}") from None
    return table.arrays() | found


def _check(path, arrays):
    """ValueError unless these are the arrays of a log, each with its length."""
    for kind, names in _COLUMNS.items():
        columns = [f"{kind}_{name}" for name in names] + (["image"] if kind == "image" else [])
        missing = [name for name in columns if name not in arrays]
        if missing:
            raise ValueError(f"{path} is no log of a core: it has no array {missing[0]!r}")
        for name, dtype in names.items():
            array = arrays[f"{kind}_{name}"]
            if array.ndim != 1 or array.dtype.kind != np.dtype(dtype).kind:
                raise ValueError(
                    f"{path} is no log of a core: {kind}_{name} must be a column of {np.dtype(dtype)}"
                )
        if len({arrays[name].shape[:1] for name in columns}) > 1:
            raise ValueError(f"{path}: the arrays of {kind} have different lengths")
    if arrays["image"].ndim != 3 or arrays["image"].dtype != np.uint16:
        raise ValueError(f"{path}: image must be of 16 bits, [images, rows, columns]")
