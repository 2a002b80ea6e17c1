"""A core's packets as values in physical units; images are assembled from their parts.

``time``: clocks since the core's reset, as in docs/link.md; ``time_s``: the same in seconds. A value whose
unit is unknown is None.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from meissner.builds.units import Units
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Packet
from meissner.twins.slip.slip import State


@dataclass(frozen=True)
class OfBoot:
    """``boot``: how many resets of the core the host has seen before this packet, in the stream."""

    boot: int = field(default=0, kw_only=True, repr=False)


@dataclass(frozen=True)
class OfChannel(OfBoot):
    """A channel has another state.

    Attributes
    ----------
    channel : int
        twins.core.OF_LOAD: the load of four electrodes.
    state : int
        twins.slip.slip.State.
    p2p : int
        In codes of the detail.
    p2p_v, p2p_n : float or None
        Of the Haar coefficient in volts or newtons: the samples are a sensor's volts or a taxel's forces.
    """

    time: int
    time_s: float | None
    channel: int
    state: int
    p2p: int
    p2p_v: float | None
    p2p_n: float | None = None


@dataclass(frozen=True)
class SlipEvent(OfChannel):
    """A slip begins: the channel was in contact, and is incipient or gross."""


@dataclass(frozen=True)
class StateChange(OfChannel):
    """Any other change of a channel's state.

    Attributes
    ----------
    before : int
        The state before, as the core last sent it.
    late : bool
        The channel has had this state for some details: the line was too slow.
    """

    before: int = State.NONE
    late: bool = False


@dataclass(frozen=True)
class States(OfBoot):
    """The states of the channels from ``first`` on, which ``Core.ask_states`` asked for."""

    time: int
    time_s: float | None
    first: int
    states: tuple[int, ...]


@dataclass(frozen=True)
class ClassChange(OfBoot):
    """The forest decides for another class.

    Attributes
    ----------
    label, before : int
        Index of the class; the one before, as the core last sent it, None for the first.
    votes : int
        For ``label``: 65535 for each tree that is certain of it.
    """

    time: int
    time_s: float | None
    label: int
    before: int | None
    votes: int


@dataclass(frozen=True)
class CopFrame(OfBoot):
    """The centre of pressure of a frame.

    Attributes
    ----------
    x, y : float
        -1 .. 1, exact; 0 where not ``pressed``.
    load : int
        Sum of the forces.
    """

    time: int
    time_s: float | None
    x: float
    y: float
    load: int
    pressed: bool
    x_mm: float | None
    y_mm: float | None
    load_n: float | None


@dataclass(frozen=True)
class Image(OfBoot):
    """``taxels``: uint16 [rows, columns]; [1, taxels] if the core did not report its size."""

    time: int
    time_s: float | None
    number: int
    taxels: NDArray[np.uint16]
    newtons_per_code: float | None


@dataclass(frozen=True)
class Health(OfBoot):
    time: int
    time_s: float | None
    taxel: int
    faults: int


@dataclass(frozen=True)
class Statistics(OfBoot):
    """One counter of the core, named by ``index`` and ``name``."""

    time: int
    time_s: float | None
    index: int
    value: int

    @property
    def name(self) -> str:
        return p.COUNTERS[self.index] if self.index < len(p.COUNTERS) else f"counter {self.index}"


@dataclass(frozen=True)
class Gap:
    """The line was interrupted for ``seconds``; the packets that the core sent meanwhile are lost."""

    reason: str
    seconds: float


@dataclass(frozen=True)
class Reset:
    """In a log, between two boots of the core. ``restarts``: ``boot`` of what follows; ``min_load``:
    ``cop.min_load`` from here on, -1 if it is not known."""

    restarts: int
    min_load: int = -1


# By the core.
Stamped = SlipEvent | StateChange | States | ClassChange | CopFrame | Image | Health | Statistics
Item = Stamped | Gap


def _state(number: int) -> int:
    """A State, or the number if this host does not know it."""
    return State(number) if number in set(State) else number


class Assembler:
    """``next`` takes a link.decoder.Packet and returns one of the above, or None (part of an image, unknown).

    ``images_lost``: images that did not arrive completely, counted from the first received part on; the first
    image counts only if its first part arrived. ``images_unfit``: complete images, dropped because their size
    differs from ``units``.
    """

    def __init__(self, units: Units | None = None) -> None:
        self.units, self.images_lost, self.images_unfit = units or Units(), 0, 0
        self.unfit = 0  # taxels of the newest image, if its size differs from ``units``
        self._image: tuple[int, int] | None = None  # number and time
        self._parts: list[int] | None = []
        self._owed = False  # a part of that image

    def restart(self) -> None:
        """The core was reset: the rest of an image does not come, and images are numbered from 0 again."""
        self.images_lost += self._owed
        self._image = (-1, -1)
        self._parts, self._owed = None, False

    def next(self, packet: Packet) -> Stamped | None:
        fields, units = packet.fields, self.units
        at = (packet.time, units.seconds(packet.time))
        if packet.kind in (p.SLIP, p.CHANGE):
            code = fields["p2p"]
            amounts = (units.detail_volts(code), units.detail_newtons(code))
            shared = (*at, fields["channel"], _state(fields["state"]), code, *amounts)
            if packet.kind == p.SLIP:
                return SlipEvent(*shared)
            return StateChange(*shared, _state(fields["told"]), fields["late"])
        if packet.kind == p.STATES:
            return States(*at, fields["first"], tuple(map(_state, fields["states"])))
        if packet.kind == p.CLASS:
            told = fields["told"]
            return ClassChange(*at, fields["label"], None if told == p.NO_CLASS else told, fields["votes"])
        if packet.kind == p.COP:
            x, y, x_mm, y_mm = units.place(fields["x"], fields["y"])
            load = fields["load"]
            return CopFrame(*at, x, y, load, fields["pressed"], x_mm, y_mm, units.load_newtons(load))
        if packet.kind == p.HEALTH:
            return Health(*at, fields["taxel"], fields["faults"])
        if packet.kind == p.STATISTIC:
            return Statistics(*at, fields["index"], fields["counter"])
        if packet.kind == p.IMAGE:
            return self._image_part(packet, at)
        return None

    def _image_part(self, packet: Packet, at: tuple[int, float | None]) -> Image | None:
        fields, which = packet.fields, (packet.fields["image"], packet.time)
        if which != self._image or fields["first"] == 0:
            if self._image is not None:
                between = (which[0] - self._image[0] - 1) % 256 if which != self._image else 0
                self.images_lost += between + self._owed
            # The host may have begun to listen in the middle of the very first image.
            self._owed = fields["first"] == 0 or self._image is not None
            self._image, self._parts = which, []
        if self._parts is None or fields["first"] != len(self._parts):
            self._parts = None  # a part is missing, so the image is lost
            return None
        self._parts.extend(fields["taxels"])
        if not fields["last"]:
            return None
        taxels, self._parts, self._owed = np.array(self._parts, dtype=np.uint16), None, False
        rows, columns = self.units.rows or 1, self.units.columns
        self.unfit = len(taxels) if len(taxels) != rows * (columns or len(taxels)) else 0
        if self.unfit:
            self.images_unfit += 1
            return None
        shape = (rows, len(taxels) // rows)
        return Image(*at, which[0], taxels.reshape(shape), self.units.newtons_per_code)
