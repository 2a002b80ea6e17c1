"""Tables of text: CSV and TSV of scopes, loggers and serial monitors."""

import csv
import re
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from meissner.inputs import MAX_CHANNELS
from meissner.readers.table import TIMES, VOLTS, Column, Table, check_memory, column, numbered, unit_of

COMMENTS = ("#", "%", "//")
MOST = MAX_CHANNELS + 16  # columns: a time, an index and what a logger adds
NAMES = {"\t": "tab", ";": "semicolon", ",": "comma", " ": "space", "": "one column"}
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_LOOSE = re.compile(  # with separators that have to be refused; a date is text
    r"(?!\d{1,2}\.\d{1,2}\.(\d\d){1,2}$|\d{4}\.\d\d?\.\d\d?$)[+-]?[.,]?\d[\d.,]*([eE][+-]?\d+)?"
)
# A number with a unit or a remark, with spaces between its thousands, or in hexadecimal.
_NEARLY = re.compile(
    r"[+-]?\d[\d.,]*(\s*[A-Za-zµμΩ%°]{1,3}|\s*(#|//).*|(['’\s]\d{3})+([.,]\d*)?)|[+-]?0x[\da-f]+", re.I
)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_COMMAS = re.compile(r"([+-]?(\d+(,\d+)?|,\d+)([eE][+-]?\d+)?( +|$)){2,}")  # between spaces
_MARKUP = re.compile(r"[][{}<>]")  # of JSON and pages
_MISSING = re.compile(r"|[+-]?nan|n/?a|null|none|x|-+|[+-]?inf(inity)?|[+-]?∞", re.I)
_STAMP = re.compile(r"(\d\d):(\d\d):(\d\d\.\d{3}) -> ?(.*)")  # of the Arduino IDE's monitor
_LABEL = re.compile(r"(?<![^\s,;])([^\s:,;\d+-][^:,;\t]{0,60}):[ \t]*(?=[+-]?[.\d])")
_RATE = re.compile(r"sampl\w{0,9} ?rate\W+([\d.eE+-]+) ?([kMG]?)(hz|s/s|sps)?", re.I)


def table(path: Path) -> Table:
    """The Table of a text file; ValueError with one sentence that names the line."""
    return _Text(path).table()


class _Text:
    def __init__(self, path: Path) -> None:
        check_memory(path, 10 * path.stat().st_size)
        self.path, text = path, _decoded(path)
        lines = [(at, line.strip(" \r")) for at, line in enumerate(text.split("\n"), 1)]
        self.comments = [(at, line) for at, line in lines if line.startswith(COMMENTS)]
        self.lines = [(at, line) for at, line in lines if line.strip() and not line.startswith(COMMENTS)]
        if self.lines and re.fullmatch(r'"?sep=.?"?', self.lines[0][1], re.I):  # of a spreadsheet
            del self.lines[0]
        while self.lines and not self.lines[-1][1].strip("\t,; "):
            del self.lines[-1]  # empty cells below the table
        self.labels: list[str] = []
        self.stamps: NDArray[Any] | None = None
        if self.lines:
            self._unstamped()
            self._unlabelled()

    def refuse(self, sentence: str) -> NoReturn:
        raise ValueError(f"{self.path}{sentence}")

    def _unstamped(self) -> None:
        """Take the times before "->" off; a monitor's clock starts again at midnight."""
        found = [_STAMP.match(line) for _, line in self.lines]
        if not all(found):
            return
        clock = np.array([3600 * int(f[1]) + 60 * int(f[2]) + float(f[3]) for f in found if f])
        self.stamps = clock + 86400 * np.concatenate([[0], np.cumsum(np.diff(clock) < -43200)])
        self.lines = [(at, f[4]) for (at, _), f in zip(self.lines, found) if f]

    def _unlabelled(self) -> None:
        """Take the labels of a serial plotter off: ``Light:512,Heat:23``."""
        some = [self.lines[at][1] for at in (0, len(self.lines) // 2, -1)]
        found = [[name.strip() for name in _LABEL.findall(line)] for line in some]
        labels = max(found, key=found.count)  # a capture may begin and end within a line
        rest = _LABEL.sub("", some[found.index(labels)])
        if not labels or not all(_LOOSE.fullmatch(field) for field in _fields(rest, _mark(rest))):
            return
        self.labels = labels
        for at, line in self.lines:
            if [name.strip() for name in _LABEL.findall(line)] != self.labels:
                self.refuse(f", line {at}: '{line[:40]}' has other labels than {', '.join(self.labels)}")
        self.lines = [(at, _LABEL.sub("", line)) for at, line in self.lines]

    def table(self) -> Table:
        first = self._first()
        head, data = self.lines[:first], self.lines[first:]
        mark = _mark(data[0][1])
        self.mark = mark
        if mark not in ("", " ") and all(line.endswith(mark) for _, line in data):
            data = [(at, line[:-1]) for at, line in data]  # a separator behind the last value
            head = [(at, line.removesuffix(mark)) for at, line in head]
        self.data, self.count = data, len(_fields(data[0][1], mark))
        if self.count > MOST:
            self.refuse(f" has {self.count} columns, more than the core's {MAX_CHANNELS} channels")
        if self.labels and len(self.labels) != self.count:
            self.refuse(f", line {data[0][0]}: {self.count} values but the labels {', '.join(self.labels)}")
        self._check_rows()
        names, units = self._header(head)
        named = bool(names or self.labels)
        names = names or self.labels or [f"column {k}" for k in range(1, self.count + 1)]
        units = units or [""] * self.count
        words = self._words(names)
        rest = [k for k in range(self.count) if k not in words]
        if words or any('"' in line for _, line in self.data):  # what is left has neither text nor quotes
            rows = [(at, _fields(line, mark)) for at, line in self.data]
            self.data = [(at, "\t".join(fields[k] for k in rest)) for at, fields in rows]
            self.mark = "\t" if len(rest) > 1 else ""
            words, names, units = (
                [names[k] for k in words],
                [names[k] for k in rest],
                [units[k] for k in rest],
            )
        self.names = names
        decimal = self._decimal(mark)
        values = self._values(decimal)
        columns = [column(name, each, unit, named) for name, unit, each in zip(names, units, values)]
        if self.stamps is not None:
            columns.insert(0, Column("time of the monitor", "s", self.stamps))
        how = f"{NAMES[mark]}{', decimal comma' if decimal == ',' else ''}"
        return Table(
            numbered(columns),
            f"{how}{''.join(f', without the text of {word}' for word in words)}",
            self._rate(),
        )

    def _first(self) -> int:
        """Index of the first row of numbers; if all have text in them, of the first with any number."""
        mixed = None
        for at, (_, line) in enumerate(self.lines[:1000]):
            fields = _fields(line, _mark(line))
            if len(fields) > MOST:
                self.refuse(f" has {len(fields)} columns, more than the core's {MAX_CHANNELS} channels")
            known = [bool(_LOOSE.fullmatch(field)) for field in fields]
            if fields[1:] and fields == ["", *map(str, range(len(fields) - 1))]:
                continue  # a header of pandas
            if any(known) and all(k or _MISSING.fullmatch(field) for k, field in zip(known, fields)):
                return at
            if mixed is None and any(known) and not _MARKUP.search(line):
                mixed = at
        if mixed is not None:
            return mixed
        if not self.lines:
            self.refuse(" holds no numbers: it is empty")
        shown = " and ".join(f"line {at} is '{line[:40]}'" for at, line in self.lines[:2])
        self.refuse(f" holds no rows of numbers: {shown}")

    def _words(self, names: list[str]) -> list[int]:
        """Places of columns of text, by the first row; ValueError if one may be meant as numbers."""
        at, line = self.data[0]
        fields = _fields(line, self.mark)
        found = [k for k, f in enumerate(fields) if not (_LOOSE.fullmatch(f) or _MISSING.fullmatch(f))]
        for k in found:
            if _NEARLY.fullmatch(fields[k]):
                self.refuse(f", line {at}: {names[k]} is '{fields[k][:20]}', no number")
        return found

    def _check_rows(self) -> None:
        """ValueError unless every row has as many values as the first."""
        wide = self.count
        for at, line in self.data:
            if (
                len(line.split()) if self.mark == " " else line.count(self.mark) + 1 if self.mark else 1
            ) == wide:
                continue
            fields = _fields(line, self.mark)
            if len(fields) == wide:  # a quoted separator
                continue
            other = _mark(line)
            if other not in ("", " ", self.mark):
                self.refuse(
                    f", line {at}: a {NAMES[other]} separates its values, a {NAMES[self.mark]} those before"
                )
            if not all(_LOOSE.fullmatch(field) or _MISSING.fullmatch(field) for field in fields):
                self.refuse(f", line {at}: '{line[:40]}' is text among the numbers")
            self.refuse(f", line {at}: {len(fields)} values where the rows before have {wide}")

    def _header(self, head: list[tuple[int, str]]) -> tuple[list[str], list[str]]:
        """(names, units) above the numbers; each may be missing."""
        units: list[str] = []
        for at, line in reversed(head):
            fields = _fields(line, self.mark if self.mark in line or self.mark == " " else _mark(line))
            if len(fields) == self.count + 1 and not fields[-1]:
                fields.pop()
            if len(fields) != self.count:
                if len(fields) > 1 and self.mark != " ":
                    below = self.data[0][0]
                    self.refuse(
                        f", line {below}: {self.count} values under the {len(fields)} names of line {at}"
                    )
                if self.mark == "," and self.count == 2:
                    self.refuse(
                        f", line {at}: one name above values such as '{self.data[0][1][:20]}'; if the comma "
                        "is "
                        "their decimal sign, separate columns by a semicolon"
                    )
                break
            if not units and all(_is_unit(field) for field in fields):
                units = [unit_of(field) for field in fields]
                continue
            timed = any(column(field, np.zeros(1)).is_time for field in fields) or {*units} & {*TIMES}
            if any(_LOOSE.fullmatch(field) for field in fields) and fields[0] and not timed:
                self.refuse(f", line {at}: '{line[:40]}' has text among numbers")
            return fields, units
        before = self.data[0][0]
        near = [line.lstrip("#%/ ") for at, line in self.comments if at < before][-1:]
        if near and not units and len(fields := _fields(near[0], self.mark or ",")) == self.count > 1:
            return fields, units  # as NumPy writes a header
        return [], units

    def _decimal(self, mark: str) -> str:
        """The decimal sign of the numbers; ``mark``: between the columns of the file."""
        if self.mark == ",":
            return "."
        with_comma = next(((at, line) for at, line in self.data if "," in line), None)
        if with_comma is None:
            return "."
        with_point = next(((at, line) for at, line in self.data if "." in line), None)
        if with_point is not None:
            self.refuse(
                f": line {with_comma[0]}, '{with_comma[1][:30]}', has a comma and line {with_point[0]}, "
                f"'{with_point[1][:30]}', a point; which of them is the decimal sign is not clear"
            )
        fields = [field for field in with_comma[1].split("\t") if "," in field]
        every = (field for _, line in self.data for field in line.split("\t") if "," in field)
        if mark == "," and all(map(_THOUSANDS.fullmatch, every)):
            self.refuse(
                f", line {with_comma[0]}: the comma of '{fields[0][:20]}' may be a decimal sign or stand "
                "between thousands; write the numbers without it"
            )
        return ","

    def _values(self, decimal: str) -> NDArray[np.float64]:
        """[columns, rows]."""
        rows = [line for _, line in self.data]
        if decimal == ",":
            rows = [line.replace(",", ".") for line in rows]
        try:
            mark = None if self.mark in ("", " ") else self.mark
            return np.loadtxt(rows, delimiter=mark, ndmin=2, comments=None).T
        except ValueError:
            pass
        for row, (at, line) in enumerate(self.data, 1):
            fields = _fields(line, self.mark)
            if not any(_LOOSE.fullmatch(field) or _MISSING.fullmatch(field) for field in fields):
                self.refuse(f", line {at}: '{line[:40]}' is text among the numbers")
            for name, field in zip(self.names, fields):
                if not _NUMBER.fullmatch(field):
                    what = "has no value" if not field else f"is '{field[:20]}', no number"
                    self.refuse(f", line {at}: {name} {what} (row {row})")
        self.refuse(" is not a table of numbers")

    def _rate(self) -> float | None:
        """Samples per second, if a comment says so."""
        found = next((f for _, line in self.comments if (f := _RATE.search(line))), None)
        try:
            factor = {"k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9, "": 1.0}
            return float(found[1]) * factor[found[2]] if found else None
        except (ValueError, KeyError):
            return None


def _decoded(path: Path) -> str:
    data = path.read_bytes()
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        kinds = ("utf-16",)
    elif b"\0" in data:
        raise ValueError(f"{path} is not text: it begins with {data[:8]!r}")
    else:
        kinds = (
            "utf-8-sig",
            "cp1252",
            "latin-1",
        )  # spreadsheets put a byte order mark before the first number
    for kind in kinds:
        try:
            text = data.decode(kind)
            if "\0" in text:
                break
            return text.replace("\r\n", "\n").replace("\r", "\n")
        except UnicodeDecodeError:
            continue
    raise ValueError(f"{path} is not text: it begins with {data[:8]!r}")


def _mark(line: str) -> str:
    """What separates the values of a line; "" if there is one."""
    found = next((mark for mark in "\t;, " if mark in line.strip()), "")
    return " " if found == "," and _COMMAS.fullmatch(line.strip()) else found


def _fields(line: str, mark: str) -> list[str]:
    if mark in ("", " "):
        return [field.strip('"') for field in line.split()] if mark else [line.strip().strip('"')]
    if '"' in line:
        line_fields = next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])
        return [field.strip() for field in line_fields]
    return [field.strip() for field in line.split(mark)]


def _is_unit(field: str) -> bool:
    return not field or (field[0] in "([" and field[-1] in ")]") or unit_of(field) in TIMES | VOLTS
