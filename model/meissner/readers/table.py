"""What the readers of this package return: columns by name with their units, before any is chosen."""

import os
import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

MEMORY_SHARE = 0.5
TIMES = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}  # of each in a second: to be divided by, which is exact
VOLTS = {"V": 1.0, "mV": 1e3, "uV": 1e6, "kV": 1e-3}  # likewise
_SAME = {"sec": "s", "second": "s", "seconds": "s", "millis": "ms", "micros": "us", "volt": "V", "volts": "V"}
_SAME |= dict.fromkeys(("code", "codes", "count", "counts", "lsb", "raw", "adc", "digits"), "codes")
_BRACKETS = re.compile(r"(.*?)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]\s*")
_SUFFIX = re.compile(r"(.+?) ?[ _/] ?(V|mV|uV)")
_UNITS = ("ms", "us", "µs", "millis", "micros", "seconds", "volts", "counts", "adc", "raw")  # as names
LONGEST = 200  # letters of a name in which a unit is looked for
_TIME = re.compile(
    r"(time|zeit|temps|tiempo|tempo|t|time[ _]?stamp|elapsed|millis|micros|trigger|date)", re.I
)
_TIME_SUFFIX = re.compile(rf"{_TIME.pattern} ?[ _/] ?(s|ms|us|ns)", re.I)
_INDEX = re.compile(
    r"(index|idx|sample|sample ?(#|no\.?|number)|n|no\.?|nr\.?|#|row|seq|sequence|counter|unnamed.*)?", re.I
)


@dataclass(frozen=True)
class Column:
    """``values``: [samples]; of arrays also [channels, samples] or [frames, rows, columns]; ``unit``: ""
    where the file says none; ``named``: the name is the file's."""

    name: str
    unit: str
    values: NDArray[Any]
    named: bool = True

    @property
    def _rows(self) -> bool:
        return self.values.ndim == 1 and self.values.dtype.kind in "iuf"

    @property
    def _last(self) -> str:
        """The name, without the group of a file or the struct that it is in; a topic's begins with "/"."""
        return self.name if self.name.startswith("/") else re.split(r"[./](?=.)", self.name)[-1]

    @property
    def is_time(self) -> bool:
        return self._rows and bool(self.unit in TIMES or (self.named and _TIME.fullmatch(self._last)))

    @property
    def is_index(self) -> bool:
        """A counter by its name, whose values rise by whole numbers."""
        if not (self._rows and self.named and _INDEX.fullmatch(self._last)) or len(self.values) < 2:
            return False
        steps = np.diff(self.values.astype(np.float64))
        return bool((steps > 0).all() and (steps == np.rint(steps)).all())


@dataclass(frozen=True)
class Table:
    """``how``: the form of the file in words; ``rate_hz``: if it is not in a column; ``audio``: its numbers
    are shares of full scale; ``frames``: three dimensions are frames; ``topic``: one was chosen already."""

    columns: list[Column]
    how: str
    rate_hz: float | None = None
    audio: bool = False
    frames: bool = False
    topic: bool = False


def unit_of(text: str) -> str:
    """A unit in one spelling: ``µs`` is ``us``, ``volts`` is ``V``."""
    text = text.strip().strip("()[]").strip().replace("µ", "u").replace("μ", "u")
    return _SAME.get(text.lower(), text)


def column(name: str, values: NDArray[Any], unit: str = "", named: bool = True) -> Column:
    """A column whose unit may be part of its name: ``Time (ms)``, ``Channel A [V]``, ``t_us``."""
    name = name.strip()
    plain = name.replace("µ", "u").replace("μ", "u")
    found = len(name) < LONGEST and (
        _BRACKETS.fullmatch(name) or _SUFFIX.fullmatch(plain) or _TIME_SUFFIX.fullmatch(plain)
    )
    if found and not unit:
        name, unit = found[1], found[2]
    if not unit and name.lower() in _UNITS:
        unit = name
    return Column(name, unit_of(unit), values, named)


def numbered(columns: list[Column]) -> list[Column]:
    """The columns with a number behind each name that another has, too."""
    seen: dict[str, int] = {}
    for at, one in enumerate(columns):
        seen[one.name] = seen.get(one.name, 0) + 1
        if seen[one.name] > 1:
            columns[at] = replace(one, name=f"{one.name} {seen[one.name]}")
    return columns


def check_memory(path: object, size: float) -> None:
    """ValueError if ``size`` bytes are more than this machine should hold."""
    if size > MEMORY_SHARE * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"):
        raise ValueError(f"{path} would take {size / 1e9:.1f} GB of memory, more than half of this machine's")
