"""Logs of a core's packets: written as .mcap (ROS 2 messages) or .npz (arrays), and read back from either.

Arrays, one row per packet, ``_time`` in clocks and ``_ns`` in nanoseconds of UTC:

    change_time, _ns, _channel, _state, _before, _p2p, _late, _start         every change of a channel's state
    slip_time, _ns, _channel, _state, _p2p           of these, the starts of a slip
    state_time, _ns, _channel, _state                as asked for when the log began and after a gap
    cop_time, _ns, _x, _y, _load, _pressed
    image_time, _ns, _number                         image [images, rows, columns]
    health_time, _ns, _taxel, _faults                statistics_time, _ns, _index, _value
    gap_ns, _seconds, _reason                        reset_ns, _restarts, _min_load

``_ns`` of a packet from before a reset of the core lies before ``reset_ns``, that of one from after it does
not; ``boots`` counts the resets before each row. ``reset_min_load``: ``cop.min_load`` from there on, -1 if it
is not known.

The facts: clk_khz, start_ns and start_time (the same instant), newtons_per_code (nan: not known), min_load
(at the start, if the core or its configuration says it), and the counters of the line
(meissner.host.core.Counts); ``partial`` if the log was not finished.

While a log runs, its packets go to a spool beside the target every FLUSH_S seconds: as chunks of an MCAP
file, which is renamed to the target at the end; or as rows in blocks (meissner.host.table), removed when the
arrays are written. A log that ends before that leaves the spool, which ``read`` can read.
"""

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays
from meissner.builds.units import Units
from meissner.files import FULL, check_in, read_arrays
from meissner.files import check_out as check_name
from meissner.host import mcap_file, packets
from meissner.host.core import Core, Counts
from meissner.host.stamps import Stamps
from meissner.host.table import COLUMNS, Facts, NpzLog, Table, read_rows
from meissner.host.unfinished_log import UnfinishedLog, part_of

if TYPE_CHECKING:
    from meissner.host.sensors import Pins, Trace

FLUSH_S = 0.5  # a killed process loses at most this; shorter chunks compress less

_FACTS = {"clk_khz": int, "start_ns": int, "start_time": int, "newtons_per_code": float, "min_load": int}
_FACTS |= {counter.name: type(counter.default) for counter in fields(Counts)}

ADDED = ("reset_", "change_", "state_", "class_")  # arrays that earlier logs do not have

PARTIAL: Arrays = {"partial": np.asarray(True)}


class McapLog:
    """Writes a .mcap; its spool becomes the file."""

    KIND = ".mcap"

    def __init__(self, spool: UnfinishedLog, known: Units, core: Core | None = None) -> None:
        self._spool, self._writer = spool, mcap_file.Writer(spool, known, core)
        self.add, self.tell = self._writer.add, self._writer.tell

    def flush(self, facts: Facts) -> None:
        self._writer.flush()

    def finish(self, path: str | Path, facts: Facts) -> None:
        self._writer.finish(facts)
        self._spool.rename(path)


KINDS: dict[str, type[McapLog] | type[NpzLog]] = {".npz": NpzLog, ".mcap": McapLog}


class Writer(Protocol):
    """Takes packets with their time in ns of UTC, and facts."""

    def add(self, stamp_ns: int, item: Any, /) -> None: ...

    def tell(self, facts: Facts, /) -> None: ...

    def flush(self, facts: Facts, /) -> None: ...


class Log:
    """``add`` packets of ``core`` to a ``writer``, one of the above, with their time in UTC
    (meissner.host.stamps)."""

    def __init__(self, writer: Writer, core: Core) -> None:
        self._writer, self._core, self._stamps = writer, core, Stamps(core)
        self.packets, self.kept, self._flushed_at = 0, 0, time.monotonic()
        self._facts: dict[str, int] = {}
        if (least := self._stamps.min_load()) >= 0:
            self._facts["min_load"] = least
        self._tell()
        self.flush()

    def _tell(self) -> None:
        if self._stamps.moved:
            self._stamps.moved = False
            self._writer.tell(self.facts())

    def add(self, item: "packets.Item | Trace | Pins") -> None:
        for stamp, one in self._stamps.next(cast("packets.Item", item)):  # these have boot and time, too
            self._tell()
            self._writer.add(stamp, one)
        self.packets += 1
        if time.monotonic() - self._flushed_at > FLUSH_S:
            self.flush()

    def flush(self) -> None:
        """Keep what was received so far, however the log ends."""
        self._flushed_at = time.monotonic()
        self._writer.flush(self.facts())
        self.kept = self.packets

    def facts(self) -> Facts:
        known = self._core.units
        newtons = float("nan") if known.newtons_per_code is None else known.newtons_per_code
        facts = {
            "clk_khz": known.clk_khz,
            "start_ns": self._stamps.start_ns,
            "start_time": self._stamps.start,
            "newtons_per_code": newtons,
        }
        return facts | self._facts | asdict(self._core.counts)


def check_out(path: str | Path) -> str:
    """The kind of log that ``path`` names; ValueError if it names none."""
    kind = Path(path).suffix.lower()
    if kind not in KINDS:
        raise ValueError(f"{path} must be a .mcap or a .npz file")
    return kind


@contextmanager
def recording(path: str | Path, core: Core) -> Iterator[Log]:
    """A Log that gets the name ``path`` when it is complete.

    Raises
    ------
    ValueError
        If no log can have that name.
    OSError
        If it could not be written: the packets received until then are in a file that it names.
    """
    make, out = KINDS[check_out(path)], check_name(path)
    spool, log = UnfinishedLog(out, make.KIND), None
    try:
        writer = make(spool, core.units, core)
        log = Log(writer, core)
        yield log
        log.flush()
        writer.finish(out, log.facts())
    except BaseException as problem:
        if log is None or not log.packets:
            spool.remove()
            raise
        raise _kept(problem, out, spool, log, core.say) from None


def _kept(
    problem: BaseException, path: Path, spool: UnfinishedLog, log: Log, say: Callable[[str], object]
) -> BaseException:
    """The exception to raise: what went wrong, and where the packets received until then are."""
    with suppress(OSError):
        if not isinstance(problem, OSError):  # keep the last half second too
            log.flush()
    with suppress(OSError):
        spool.give_up()
    kept = f"{log.kept} packets received are in {spool.path}, which `meissner replay` reads"
    if isinstance(problem, OSError):
        why = FULL.get(problem.errno or 0, problem.strerror or str(problem))
        return OSError(f"{path} could not be written, {why}: the {kept}")
    if isinstance(problem, ValueError):
        return ValueError(f"{problem}; the {kept}")
    say(f"{path} was not finished: the {kept}")
    return problem


def read(path: str | Path) -> Arrays:
    """The arrays and facts of a log, by the names above.

    Raises
    ------
    ValueError
        If the file is no log.
    """
    path = Path(path)
    if not path.exists():
        parts = [part_of(path, writer.KIND) for writer in KINDS.values()]
        left = [f"; the packets of an unfinished log are in {part}" for part in parts if part.is_file()]
        raise ValueError(f"there is no file {path}{''.join(left)}")
    check_in(path)
    if path.suffix.lower() == ".mcap":
        return _read_mcap(path)
    if path.suffix.lower() == NpzLog.KIND:
        arrays = read_rows(path) | PARTIAL
    elif path.suffix.lower() == ".npz":
        arrays = read_arrays(path)
        if arrays is None:
            raise ValueError(f"{path} is cut off or damaged: it is not a complete .npz file of arrays")
    else:
        raise ValueError(f"{path} must be a .mcap or a .npz file, or the spool of an unfinished log")
    arrays = {name: none for name, none in Table().arrays().items() if name.startswith(ADDED)} | arrays
    _check(path, arrays)
    return arrays


def boots(log: Arrays, kind: str) -> NDArray[np.int64]:
    """Of each row of ``kind``, how many of the log's resets it follows."""
    return np.searchsorted(log["reset_ns"], log[f"{kind}_ns"], side="right")


def _read_mcap(path: Path) -> Arrays:
    table = Table()
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # a message parser prints
            facts, items, whole = mcap_file.read(path)
            for stamp, item in items:
                table.add(stamp, item)
        found = {name: np.asarray(kind(facts[name])) for name, kind in _FACTS.items() if name in facts}
    except PermissionError:
        raise
    except Exception as problem:  # of any kind: a damaged file breaks its reader or decompressor
        what = str(problem).splitlines()[0] if str(problem) else type(problem).__name__
        raise ValueError(f"{path} is not a complete MCAP log of a core: {what}") from None
    return table.arrays() | found | ({} if whole else PARTIAL)


def _check(path: Path, arrays: Arrays) -> None:
    """ValueError unless these are the arrays of a log with matching lengths."""
    for kind, names in COLUMNS.items():
        columns = [f"{kind}_{name}" for name in names] + (["image"] if kind == "image" else [])
        missing = [name for name in columns if name not in arrays]
        if missing:
            raise ValueError(f"{path} is not a log of a core: the array {missing[0]!r} is missing")
        for name, dtype in names.items():
            array = arrays[f"{kind}_{name}"]
            if array.ndim != 1 or array.dtype.kind != np.dtype(dtype).kind:
                raise ValueError(
                    f"{path} is not a log of a core: {kind}_{name} must be a column of {np.dtype(dtype)}"
                )
        if len({arrays[name].shape[:1] for name in columns}) > 1:
            raise ValueError(f"{path}: the arrays of {kind} have different lengths")
    if arrays["image"].ndim != 3 or arrays["image"].dtype != np.uint16:
        raise ValueError(f"{path}: image must be of 16 bits, [images, rows, columns]")
