"""One reader in front of every command, for what scopes, loggers, boards and robots write.

    found = read("own.csv")                          a Recording: channels, unit, rate, what was taken
    codes, done = found.scaled(converter=adc)        whole numbers for the core

What a file does not say is given: ``column``, ``rate``, ``unit``, ``volts_per_code`` or a converter. A time
or an index is no channel. Every refusal is a ValueError with one sentence that names what was seen.
docs/own_recordings.md has the rules.
"""

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meissner.files import check_in
from meissner.physics.adc import Adc
from meissner.readers.table import TIMES, VOLTS, Column, Table, unit_of
from meissner.terminal import sides

_TEXT, _CHOOSING = "text:table", ("messages:mcap", "extras:bag", "arrays:npz")
KINDS = dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".log"), _TEXT) | {
    ".npy": "arrays:npy",
    ".npz": "arrays:npz",
    ".mat": "arrays:mat",
    ".wav": "arrays:wav",
    ".sr": "arrays:sigrok",
    ".mcap": "messages:mcap",
    ".h5": "extras:hdf5",
    ".hdf5": "extras:hdf5",
    ".tdms": "extras:tdms",
    ".bag": "extras:bag",
    ".db3": "extras:bag",
}
LEAST_RISING = 4  # rows without names, from which a column in equal steps is taken for a time or an index
UNEVEN = 0.5  # of the mean step: further off, a row is missing
ROUNDED = 10  # steps off by the clock's resolution, from which times are rounded and not lost
LONGEST = 40  # letters of a name in a sentence
NAMED = 4  # names of columns that a sentence has room for


def table(path: str | PathLike[str], column: Sequence[str] = ()) -> Table:
    """Every column of a file; ``column``: the topic or the arrays to read, where a file has several."""
    path = Path(path)
    if path.is_dir() and (path / "metadata.yaml").is_file():
        kind = "extras:bag"
    else:
        path = check_in(path)
        kind = KINDS.get(path.suffix.lower(), "")
    if kind == "arrays:mat" and _is_hdf5(path):
        kind = "extras:hdf5"
    if not kind:
        raise ValueError(f"{path} must be one of {' '.join(KINDS)}, or a rosbag2's folder")
    module, _, name = kind.partition(":")
    function = getattr(import_module(f"meissner.readers.{module}"), name)
    try:
        return function(path, tuple(column)) if kind in _CHOOSING else function(path)
    except (PermissionError, FileNotFoundError):
        raise
    except MemoryError:
        raise ValueError(f"{path} would take more memory than this machine has") from None
    except Exception as problem:  # of any kind: a damaged file breaks its parser anywhere
        what = (str(problem).splitlines() or [""])[0] or type(problem).__name__
        if isinstance(problem, ValueError) and what.startswith(str(path)):
            raise ValueError(what) from None
        broken = isinstance(problem, zipfile.BadZipFile | EOFError)
        what = "it is cut off or of another kind" if broken else what[:160]
        raise ValueError(
            f"{path} is not a complete {f'{path.suffix} file' if path.suffix else 'bag'}: {what}"
        ) from None


def _is_hdf5(path: Path) -> bool:
    """Whether a .mat file is of MATLAB 7.3."""
    with path.open("rb") as file:
        head = file.read(128)
    return head.startswith((b"\x89HDF\r\n", b"MATLAB 7.3"))


@dataclass(frozen=True)
class Recording:
    """``values``: [channels, samples], or frames [frames, rows, columns]; ``unit``: "V", "codes", "N", any
    other, or "" if the file says none; ``rate_hz``: None if it is not known; ``audio``: its numbers are
    shares of full scale; ``frames``: three dimensions are frames, and no other array."""

    path: str
    values: NDArray[Any]
    names: tuple[str, ...]
    unit: str
    rate_hz: float | None
    said: str
    audio: bool = False
    frames: bool = False

    def _refuse(self, sentence: str) -> None:
        raise ValueError(f"{self.path}: {sentence}")

    def scaled(
        self, volts_per_code: float | None = None, converter: Adc | None = None
    ) -> tuple[NDArray[Any], str]:
        """(codes as the core takes them, what was done to get them); values without a unit that are whole
        stay as they are, and what is in volts needs one of the two."""
        known = volts_per_code is not None or converter is not None
        if volts_per_code is not None and not 0 < volts_per_code < np.inf:
            raise ValueError(f"volts-per-code = {volts_per_code:g} must be volts above 0")
        if self.values.dtype.kind not in "iufb":
            raise ValueError(f"{self.path}: the samples must be integers, not {self.values.dtype}")
        self._check_finite()
        whole = self.values.dtype.kind in "iub" or not np.modf(self.values)[0].any()
        if self.unit not in ("", "V", "codes"):
            self._refuse(
                f"{_listed(self.names)} {'is' if len(self.names) == 1 else 'are'} in {self.unit}; the core "
                "takes "
                "codes or volts: choose columns with --column, or say what they are with --unit"
            )
        if self.audio and not self.unit:
            raise ValueError(
                f"{self.said}; the numbers of a WAV file are shares of full scale, neither volts nor codes: "
                "--unit codes takes them as codes, --unit V as volts"
            )
        if self.unit == "codes" or (not self.unit and whole and volts_per_code is None):
            if self.unit and volts_per_code is not None:
                self._refuse("its numbers are codes already; omit --volts-per-code")
            ends = (converter.min_code, converter.max_code) if converter else (-np.inf, np.inf)
            if self.values.size and not ends[0] <= self.values.min() <= self.values.max() <= ends[1]:
                self._refuse(
                    f"its codes lie in {self.values.min():g} .. {self.values.max():g}, outside {ends[0]} .. "
                    f"{ends[1]} of the converter"
                )
            return self.values, "as codes" if self.unit else "whole numbers without a unit, taken as codes"
        if not known and self.unit == "V":
            self._refuse(
                f"{_listed(self.names)} in volts; give the converter with --config, or --volts-per-code"
            )
        if not known:
            worst = self.values[np.modf(self.values)[0] != 0].flat[0]
            self._refuse(
                f"its numbers have no unit and are not integers, such as {worst:g}; the core takes codes: "
                "give "
                "the converter with --config, or --volts-per-code, if these are volts"
            )
        why = "volts" if self.unit else "numbers without a unit, taken as volts,"
        if volts_per_code is not None:
            codes = np.floor(self.values / volts_per_code + 0.5)
            ends = f", {codes.min():.9g} .. {codes.max():.9g}" if codes.size else ""
            return codes, f"{why} to codes of {volts_per_code:g} V{ends}"
        assert converter is not None
        codes, over = converter.convert(self.values)
        clipped = f", {int(over.sum())} beyond its range cut to its ends" if over.any() else ""
        return codes, (
            f"{why} to the codes {converter.min_code} .. {converter.max_code} of a converter of "
            f"{converter.low_v:g} to {converter.high_v:g} V{clipped}"
        )

    def flat(self) -> "Recording":
        """This recording with the taxels of its frames as channels, row by row."""
        if self.values.ndim != 3 or not self.frames:
            return self
        return replace(self, values=self.values.reshape(len(self.values), -1).T)

    def _check_finite(self) -> None:
        if self.values.dtype.kind != "f" or np.isfinite(self.values).all():
            return
        bad = np.argwhere(~np.isfinite(self.values))
        first = bad[bad[:, -1 if self.values.ndim < 3 else 0].argmin()]
        row = first[-1] if self.values.ndim < 3 else first[0]
        name = self.names[first[0]] if len(self.names) > 1 and self.values.ndim == 2 else self.names[0]
        what = "NaN" if np.isnan(self.values[tuple(first)]) else "infinity"
        self._refuse(f"{name} is {what} in row {row + 1}; every row needs a value ({len(bad)} are missing)")


def read(
    path: str | PathLike[str],
    column: Sequence[str] | None = None,
    rate: float | None = None,
    unit: str | None = None,
    shape: tuple[int, int] | None = None,
    samples_first: bool = False,
) -> Recording:
    """The Recording in a file.

    Parameters
    ----------
    path : str or PathLike
        A file of one of KINDS, or the folder of a rosbag2.
    column : names, or numbers from 1
        Columns, arrays or a topic to take, in this order; all that are neither a time nor an index.
    rate : float
        Samples per second, in place of the file's.
    unit : str
        V, mV, uV, codes or N, in place of the file's.
    shape : (rows, columns)
        Of an array whose taxels are the file's columns, row by row: ``values`` are its frames.
    samples_first : bool
        Arrays of .npy and .npz are [samples, channels].

    Raises
    ------
    ValueError
        For a file that is none, has gaps, or does not say what it must.
    """
    if rate is not None and not 0 < rate < float("inf"):
        raise ValueError(f"rate = {rate:g} must be a number of samples per second above 0")
    column = column or ()
    found, name = table(path, column), str(path)
    wanted = [part for entry in column for part in _parts(entry, found)]
    if found.topic:
        topics = {name for one in found.columns for name in (one.name, one.name.split(".")[0])}
        if other := [part for part in wanted if part not in topics]:
            raise ValueError(f"{path} has no topic with numbers '{other[0]}'; without --column: {found.how}")
        wanted = []
    channels, aside = _channels(name, found, wanted, samples_first)
    rate_hz, how_rate = _rate(name, found, [one for one, _ in aside if one.is_time], rate)
    given = None if unit is None else unit_of(unit)
    units = [given or one.unit for one in channels]
    kinds = {"V" if one in VOLTS else one for one in units}
    if len(kinds) > 1:
        raise ValueError(
            f"{path}: its columns are in {', '.join(sorted(one or 'no unit' for one in kinds))}; choose "
            "those of "
            "one unit with --column, or name it with --unit"
        )
    values = (
        np.stack([one.values for one in channels]) if channels[0].values.ndim == 1 else channels[0].values
    )
    scale = np.array([VOLTS.get(one, 1.0) for one in units])
    if (scale != 1).any():
        values = values / (scale[:, None] if values.ndim == 2 else scale[0])
    names = tuple(one.name for one in channels)
    size = f"{values.shape[1]} rows" if values.ndim == 2 else sides(values.shape) or "one number"
    told = [f"{path}: {found.how}", f"{size} of {_listed(names)}"]
    if written := sorted({one for one in units if one}):
        told[1] += f" in {_listed(written)}{' as given' if given else ''}"
    told += [f"{one.name or 'a column without a name'} left out, {why}" for one, why in aside]
    told += [how_rate] if how_rate else []
    if shape is not None:
        values = _framed(name, values, shape)
    frames = shape is not None or found.frames
    return Recording(name, values, names, kinds.pop(), rate_hz, "; ".join(told), found.audio, frames)


def of_command(arguments: Any, path: str | PathLike[str] | None = None, **given: Any) -> Recording:
    """The Recording that the arguments of a command describe; ``given``: others of ``read``."""
    options = {name: getattr(arguments, name, None) for name in ("rate", "unit", "shape")}
    column = getattr(arguments, "column", None) or ()
    return read(path or arguments.input, column, **options | given)


def chosen(path: str | PathLike[str], found: Table, column: Sequence[str]) -> list[Column]:
    """Columns by names or numbers, times among them."""
    names = [part for entry in column for part in _parts(entry, found)]
    return [_find(str(path), name, found.columns, found.how) for name in names]


def taken(x: Any, samples_first: bool = False) -> Any:
    """``x`` of a public class: a Recording or a path becomes its codes, anything else stays as it is."""
    if isinstance(x, str | PathLike):
        x = read(x, samples_first=samples_first)
    if not isinstance(x, Recording):
        return x
    codes = np.asarray(x.scaled()[0])
    if codes.dtype.kind == "f":
        codes = codes.astype(np.int64)
    return codes.T if samples_first and codes.ndim == 2 else codes


def _listed(names: Sequence[str]) -> str:
    rest = len(names) - NAMED
    first = ", ".join(name[:LONGEST] or "no name" for name in names[:NAMED])
    return first + (f" and {rest} more" if rest > 0 else "")


def _parts(entry: str, found: Table) -> list[str]:
    """A name may have commas in it."""
    known = {one.name.lower() for one in found.columns}
    return [entry] if entry.lower() in known else [part.strip() for part in entry.split(",")]


def _find(path: str, name: str, columns: list[Column], how: str) -> Column:
    for one in columns:
        if one.named and one.name.lower() == name.lower():
            return one
    if name.isdecimal() and 1 <= int(name) <= len(columns):
        return columns[int(name) - 1]
    raise ValueError(f"{path} has no column '{name}'; it has {_listed([one.name for one in columns]) or how}")


def _channels(
    path: str, found: Table, wanted: list[str], samples_first: bool
) -> tuple[list[Column], list[tuple[Column, str]]]:
    """(channels, columns that are none with the reason)."""
    columns = found.columns
    if len(columns) == 1 and not found.frames:
        columns = _split(columns[0], samples_first)
    aside = [(one, why) for one in columns if (why := _why(one))]
    aside += _rising([one for one in columns if not _why(one)]) if not wanted else []
    channels = [one for one in columns if not any(one is other for other, _ in aside)]
    if wanted:
        channels = [_find(path, name, columns, found.how) for name in wanted]
        for one in channels:
            if why := _why(one):
                raise ValueError(f"{path}: {one.name} is no channel: {why}")
    for one, _ in aside:
        _check_index(path, one)
    if not channels:
        raise ValueError(f"{path} has no channel, only {_listed([one.name for one in columns]) or found.how}")
    if len({one.values.shape for one in channels}) > 1 or (len(channels) > 1 and channels[0].values.ndim > 1):
        kinds = _listed([f"{one.name} [{'×'.join(map(str, one.values.shape))}]" for one in channels])
        raise ValueError(f"{path} has arrays that are not one recording, {kinds}: choose with --column")
    return (_split(channels[0], samples_first) if len(channels) == 1 else channels), aside


def _split(one: Column, samples_first: bool = False) -> list[Column]:
    """A column for each channel of a two-dimensional array; others stay."""
    if one.values.ndim != 2 or 0 in one.values.shape:
        return [one]
    values = one.values.T if samples_first else one.values
    return [replace(one, name=f"{one.name} {k}", values=row, named=False) for k, row in enumerate(values, 1)]


def _why(one: Column) -> str:
    """Why a column is no channel; "" if it is one by its name and unit."""
    if one.is_time:
        return f"times in {one.unit}" if one.unit in TIMES else "times without a unit"
    return "which counts the rows" if one.is_index else ""


def _rising(columns: list[Column]) -> list[tuple[Column, str]]:
    """Leading columns without names that rise in equal steps: a count of the rows, a time, or both."""
    found = []
    for one in columns[: min(2, len(columns) - 1)]:
        values = one.values
        if one.named or values.ndim != 1 or len(values) < LEAST_RISING or values.dtype.kind not in "iuf":
            break
        steps = np.diff(values.astype(np.float64))
        if not (steps > 0).all() or np.ptp(steps) > 1e-3 * steps.mean():
            break
        found.append((one, f"as it rises in equal steps of {steps[0]:.6g} (--column takes it)"))
    return found


def _check_index(path: str, one: Column) -> None:
    """ValueError if a count of the rows leaves some out."""
    if one.is_time or not one.is_index:
        return
    steps = np.diff(one.values)
    usual = np.median(steps)
    if (steps != usual).any():
        row = int(np.argmax(steps != usual)) + 1
        raise ValueError(
            f"{path}: {one.name} goes from {one.values[row - 1]:g} to {one.values[row]:g} in row {row + 1}: "
            "rows "
            "are missing"
        )


def _rate(path: str, found: Table, times: list[Column], given: float | None) -> tuple[float | None, str]:
    """(samples per second, how that is known)."""
    if given is not None:
        return given, f"{given:g} Hz as given"
    if len(times) > 1:
        raise ValueError(
            f"{path} has {len(times)} columns of times, {_listed([one.name for one in times])}: give the "
            "rate "
            "with --rate"
        )
    if not times or len(times[0].values) < 2:
        return found.rate_hz, "" if found.rate_hz is None else f"{found.rate_hz:g} Hz"
    (one,) = times
    values = np.asarray(one.values, dtype=np.float64)
    if one.unit not in TIMES and (one.unit or not np.modf(values)[0].any()):
        return found.rate_hz, f"the unit of {one.name} is not known"
    hz, note = _even(path, one.name, values / TIMES.get(one.unit, 1.0))
    return hz, f"{hz:.6g} Hz from {one.name}{note}{'' if one.unit else ', read as seconds'}"


def _even(path: str, name: str, time_s: NDArray[np.float64]) -> tuple[float, str]:
    """(rows per second, a remark) of times in equal steps; ValueError for others."""
    steps, count = np.diff(time_s), len(time_s) - 1
    if not np.isfinite(time_s).all():
        raise ValueError(f"{path}: {name} is no number in row {int(np.argmin(np.isfinite(time_s))) + 1}")
    if (steps < 0).any() or time_s[-1] == time_s[0]:
        row = int(np.argmin(steps)) + 2
        raise ValueError(f"{path}: {name} does not rise: row {row} has {time_s[row - 1]:g} s")
    step = (time_s[-1] - time_s[0]) / count
    if np.abs(steps - step).max() < UNEVEN * step:
        return float(1 / step), ""
    least = steps[steps > 0].min()
    off = np.abs(time_s - time_s[0] - step * np.arange(count + 1)).max()
    whole = np.abs(steps / least - np.rint(steps / least)).max() < 0.01
    several = (np.abs(steps - np.median(steps)) > least / 2).sum() >= ROUNDED
    if whole and several and off <= 1.01 * least:
        step = np.polyfit(np.arange(count + 1), time_s, 1)[0]
        return float(1 / step), f", whose times are rounded to {least:g} s"
    row = int(np.argmax(np.abs(steps - step))) + 1
    raise ValueError(
        f"{path}: {name} is uneven: from {steps.min():.4g} to {steps.max():.4g} s from row to row, such as "
        "after "
        f"row {row}; --rate takes the rows as evenly spaced"
    )


def _framed(path: str, values: NDArray[Any], shape: tuple[int, int]) -> NDArray[Any]:
    rows, columns = shape
    if values.ndim == 3 and values.shape[1:] == shape:
        return values
    if values.ndim != 2 or len(values) != rows * columns:
        have = len(values) if values.ndim == 2 else sides(values.shape[1:])
        raise ValueError(f"{path} has {have} channels, not the {rows * columns} of {rows}×{columns} taxels")
    return np.ascontiguousarray(values.T).reshape(-1, rows, columns)
