"""Packets as columns of numbers, and a file of blocks of rows that stays readable wherever it is cut off."""

import io
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays
from meissner.builds.units import FRACTION_BITS, Units
from meissner.files import arrays_of, written
from meissner.host import packets
from meissner.host.core import Core
from meissner.host.unfinished_log import UnfinishedLog
from meissner.twins.link.packet import NO_CLASS
from meissner.twins.slip.slip import State

MAGIC = b"MSNROWS1"  # then blocks: 32-bit length, CRC-32, content (a .npz)

COLUMNS = {
    "slip": {"time": "u8", "ns": "i8", "channel": "u2", "state": "u1", "p2p": "u4"},
    "change": {
        **{"time": "u8", "ns": "i8", "channel": "u2", "state": "u1", "before": "u1", "p2p": "u4"},
        **{"late": "?", "start": "?"},
    },
    "state": {"time": "u8", "ns": "i8", "channel": "u2", "state": "u1"},
    "class": {"time": "u8", "ns": "i8", "label": "u2", "before": "u2", "votes": "u4"},
    "cop": {"time": "u8", "ns": "i8", "x": "i4", "y": "i4", "load": "u8", "pressed": "?"},
    "image": {"time": "u8", "ns": "i8", "number": "u1"},
    "health": {"time": "u8", "ns": "i8", "taxel": "u4", "faults": "u1"},
    "statistics": {"time": "u8", "ns": "i8", "index": "u1", "value": "u4"},
    "gap": {"ns": "i8", "seconds": "f8", "reason": "U"},
    "reset": {"ns": "i8", "restarts": "u4", "min_load": "i8"},
}
_KINDS = {
    packets.SlipEvent: "slip",
    packets.StateChange: "change",
    packets.States: "state",
    packets.ClassChange: "class",
    packets.CopFrame: "cop",
    packets.Image: "image",
    packets.Health: "health",
    packets.Statistics: "statistics",
    packets.Gap: "gap",
    packets.Reset: "reset",
}

# What a start of a slip leaves out as a change.
START = {"before": int(State.CONTACT), "late": False, "start": False}


Facts = Mapping[str, float | None]


class Table:
    """``add`` packets; ``new`` returns those added since its last call, ``arrays`` all."""

    def __init__(self) -> None:
        self._blocks: list[Arrays] = []
        self._shape: tuple[int, ...] | None = None
        self._clear()

    def _clear(self) -> None:
        self._columns: dict[str, dict[str, list[Any]]] = {
            kind: {name: [] for name in names} for kind, names in COLUMNS.items()
        }
        self._images: list[NDArray[np.uint16]] = []

    @staticmethod
    def takes(item: object) -> bool:
        """Whether a log has columns for such a packet."""
        return type(item) in _KINDS

    def add(self, stamp_ns: int, item: packets.Item | packets.Reset) -> None:
        kind = _KINDS[type(item)]
        if isinstance(item, packets.Image):
            self._shape = self._shape or item.taxels.shape
            if item.taxels.shape != self._shape:
                raise ValueError(
                    f"an image of {item.taxels.size} taxels came after one of {np.prod(self._shape)}: "
                    "a log holds images of one size"
                )
            self._images.append(item.taxels)
        if isinstance(item, packets.States):
            for place, state in enumerate(item.states):
                self._row("state", time=item.time, ns=stamp_ns, channel=item.first + place, state=state)
            return
        given = vars(item) | {"ns": stamp_ns}
        if isinstance(item, packets.ClassChange):
            given["before"] = NO_CLASS if item.before is None else item.before
        if isinstance(item, packets.CopFrame):
            given |= {name: round(given[name] * (1 << FRACTION_BITS)) for name in ("x", "y")}
        self._row(kind, **START | given if kind == "change" else given)
        if kind == "slip":  # all changes of the channels' states, in order
            self._row("change", **given | START | {"start": True})

    def _row(self, kind: str, **given: Any) -> None:
        for name, column in self._columns[kind].items():
            column.append(given[name])

    def new(self) -> Arrays:
        found = {
            f"{kind}_{name}": np.array(column, dtype=COLUMNS[kind][name])
            for kind, columns in self._columns.items()
            for name, column in columns.items()
        }
        size = (len(self._images), *(self._shape or (0, 0)))
        found["image"] = np.array(self._images, dtype=np.uint16).reshape(size)
        self._clear()
        self._blocks.append(found)
        return found

    def arrays(self) -> Arrays:
        self.new()
        return joined(self._blocks)


def joined(blocks: Sequence[Arrays]) -> Arrays:
    """The arrays of consecutive tables joined; ValueError if their images differ in size."""
    if not blocks:
        return Table().arrays()
    found = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0] if name != "image"}
    images = [block["image"] for block in blocks if len(block["image"])] or [blocks[0]["image"]]
    return found | {"image": np.concatenate(images)}


def items(log: Arrays, known: Units) -> Iterator[tuple[int, packets.Item | packets.Reset]]:
    """(ns, packet) of every row of a log's arrays in order of time, with the units of ``known``."""
    resets = log["reset_ns"]
    changes = "change" if len(log["change_ns"]) else "slip"  # earlier logs have the starts of a slip alone
    kinds = [kind for kind in COLUMNS if kind not in ("slip", "change", "state")] + [changes]
    rows = [(int(ns), kind, row) for kind in kinds for row, ns in enumerate(log[f"{kind}_ns"])]
    apart = [np.diff(log[f"state_{name}"].astype(np.int64)) for name in ("time", "channel")]
    breaks = np.flatnonzero((apart[0] != 0) | (apart[1] != 1)) + 1  # between two packets of states
    starts = [0, *breaks.tolist()] if len(log["state_time"]) else []
    ends = dict(zip(starts, [*starts[1:], len(log["state_time"])]))
    rows += [(int(log["state_ns"][row]), "state", row) for row in starts]
    # Of one instant, a reset comes before what follows it.
    for ns, kind, row in sorted(rows, key=lambda row: (row[0], row[1] != "reset")):
        found = {name: log[f"{kind}_{name}"][row].item() for name in COLUMNS[kind] if name != "ns"}
        if kind in ("gap", "reset"):
            yield ns, (packets.Gap if kind == "gap" else packets.Reset)(**found)
            continue
        boot = int(np.searchsorted(resets, ns, side="right"))
        at: dict[str, Any] = {"time": found.pop("time"), "boot": boot}
        at["time_s"] = known.seconds(at["time"])
        if kind == "state":
            states = tuple(log["state_state"][row : ends[row]].tolist())
            yield ns, packets.States(**at, first=found["channel"], states=states)
        elif kind == "cop":
            x, y, x_mm, y_mm = known.place(found["x"], found["y"])
            more = {"x": x, "y": y, "x_mm": x_mm, "y_mm": y_mm, "load_n": known.load_newtons(found["load"])}
            yield ns, packets.CopFrame(**at, **found | more)
        elif kind == "image":
            found |= {"taxels": log["image"][row], "newtons_per_code": known.newtons_per_code}
            yield ns, packets.Image(**at, **found)
        elif kind == "class":
            before = None if found["before"] == NO_CLASS else found["before"]
            yield ns, packets.ClassChange(**at, **found | {"before": before})
        elif kind in ("change", "slip"):
            code, start = found["p2p"], found.pop("start", True)
            found |= {"p2p_v": known.detail_volts(code), "p2p_n": known.detail_newtons(code)}
            if start:
                for name in ("before", "late"):
                    found.pop(name, None)
            yield ns, (packets.SlipEvent if start else packets.StateChange)(**at, **found)
        else:
            yield ns, (packets.Health if kind == "health" else packets.Statistics)(**at, **found)


class NpzLog:
    """Writes rows to a spool while it runs, and a .npz at the end."""

    KIND = ".rows"

    def __init__(self, spool: UnfinishedLog, known: Units, core: Core | None = None) -> None:
        self.spool, self._table, self._told = spool, Table(), False
        self.add = self._table.add
        spool.write(MAGIC)

    def tell(self, facts: Facts) -> None:
        self._told = False

    def flush(self, facts: Facts) -> None:
        found = {name: array for name, array in self._table.new().items() if len(array)}
        if found or not self._told:
            block = io.BytesIO()
            _save(block, found, facts)
            data = block.getvalue()
            head = [len(data).to_bytes(4, "little"), zlib.crc32(data).to_bytes(4, "little")]
            self.spool.write(b"".join([*head, data]))
            self._told = True
        self.spool.flush()

    def finish(self, path: str | Path, facts: Facts) -> None:
        with written(path) as file:
            _save(file, self._table.arrays(), facts)
        self.spool.remove()


def _save(file: IO[bytes], arrays: Arrays, facts: Facts) -> None:
    found = arrays | {name: np.asarray(value) for name, value in facts.items()}
    np.savez_compressed(file, **found)  # type: ignore[arg-type]  # of allow_pickle, which is no name here


def read_rows(path: str | Path) -> Arrays:
    """Arrays and facts of an NpzLog's spool up to its last complete block; ValueError if it is not one."""
    data = Path(path).read_bytes()
    if not data.startswith(MAGIC):
        raise ValueError(f"{path} does not contain the rows of a log")
    blocks: list[Arrays] = []
    at, facts = len(MAGIC), Arrays()
    empty = Table().arrays()
    while at + 8 <= len(data):
        length, crc = (int.from_bytes(data[at + k : at + k + 4], "little") for k in (0, 4))
        block = data[at + 8 : at + 8 + length]
        if len(block) < length:
            break
        if zlib.crc32(block) != crc:
            raise ValueError(f"{path} is damaged at byte {at}")
        found = arrays_of(io.BytesIO(block)) or {}
        blocks.append({name: found.pop(name, none) for name, none in empty.items()})
        facts, at = found, at + 8 + length
    if not facts:
        raise ValueError(f"{path} ends before a log began")
    return joined(blocks) | facts
