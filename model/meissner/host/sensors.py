"""What a simulated core sends for what its sensors give: sources of packets, made of the twins.

A source is a function that takes the core and yields (time in clocks, type, payload) in ascending time; the
type None only advances the time. It may read the core's registers, which change at ``core.boundary``.
``driven`` gives the source of each part of a scene (meissner.scenes.played).
"""

import heapq
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import singledispatch
from itertools import count, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner import engines
from meissner.arrays import Ints
from meissner.host import names, packets
from meissner.inputs import check_forces
from meissner.scenes import played
from meissner.twins.actuate.pin_display import increment_of
from meissner.twins.cop.cop4 import cop4
from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters
from meissner.twins.core import OF_LOAD
from meissner.twins.link import packet as p
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.shear_speeds import ShearSpeeds
from meissner.twins.slip.slip import Slip, State
from meissner.twins.slip.slip_changes import SlipChanges
from meissner.twins.slip.slip_path import details

if TYPE_CHECKING:
    from meissner.host.simulated import SimulatedCore

STATISTIC_CLOCKS = 1 << 20
TRACE_HZ, TRACED = 500, 16  # spans of a Trace in a second, its channels
BLOCK = 64  # details between two looks at the registers
IMAGE_HZ, TAXELS_S = 25, 400_000  # images in a second, and their taxels: at most
COP_HZ, LOOK_HZ = 500, 50  # of four electrodes: centres sent, looks at the registers in a second
FOLLOWED = ("step", "boost", "decay", "rate", "watchdog")  # of a hand that a viewer may set
SLIPS = (State.INCIPIENT, State.GROSS)

Sent = tuple[int, int | None, bytes]
Source = Callable[["SimulatedCore"], Iterator[Sent]]
Blocks = Iterable[Ints] | Callable[["SimulatedCore"], Iterable[Ints]]


@dataclass(frozen=True)
class Trace(packets.OfBoot):
    """Of a core in this process, whose samples no line carries: codes and peak-to-peak of some channels, each
    number of a span of ``step_s``, the first from ``time`` on.

    ``low``, ``high``: least and greatest sample; ``p2p``: greatest peak-to-peak; each [channels, spans],
    the first of ``first``.
    """

    time: int
    time_s: float | None
    step_s: float
    first: int
    low: NDArray[np.float32]
    high: NDArray[np.float32]
    p2p: NDArray[np.float32]


@dataclass(frozen=True)
class Pins(packets.OfBoot):
    """What a display shows from ``time`` on, in levels [rows, columns] up to ``most``: no line carries it."""

    time: int
    time_s: float | None
    levels: NDArray[np.uint8]
    most: int


def traced(
    clk_khz: int, rate_hz: float, start: int, codes: Ints, p2p: Ints, most_hz: float = TRACE_HZ
) -> Trace:
    """The Trace of codes and peak-to-peaks [channels, whole details] from sample ``start`` on, with at most
    ``most_hz`` spans in a second, if as many details make whole spans."""
    count, details = codes.shape[1], p2p.shape[1]
    spans = details
    while spans % 2 == 0 and rate_hz * spans / count > most_hz:
        spans //= 2
    parts = [array[:TRACED].reshape(min(TRACED, len(array)), spans, -1) for array in (codes, codes, p2p)]
    low, high, most = (pick(part, axis=2) for pick, part in zip((np.min, np.max, np.max), parts))
    seconds = start / rate_hz
    return Trace(
        round(1000 * clk_khz * seconds),
        seconds,
        count / spans / rate_hz,
        0,
        *(array.astype(np.float32) for array in (low, high, most)),
    )


def settings_of(config: SlipConfig) -> dict[str, int]:
    """{name: value} of the group slip's registers for a SlipConfig."""
    return {f"slip.{name}": value for name, value in config.settings.items()}


def blocks_of(codes: ArrayLike, level: int = 1, loop: bool = False) -> Iterator[Ints]:
    """Codes [channels, samples] as blocks of whole details, once or repeated endlessly."""
    codes, step = np.atleast_2d(codes), BLOCK << level
    usable = codes.shape[1] >> level << level
    for _ in count() if loop else (0,):
        for start in range(0, usable, step):
            yield codes[:, start : min(start + step, usable)]


def slip_source(blocks: Blocks, rate_hz: float, window: int = 64, hop: int = 64) -> Source:
    """Blocks of codes [channels, whole details] through the slip path's twins: a packet for each change.

    The settings come from the core's registers, read before each block; ``blocks`` may be a generator, or a
    function of the core that returns one.
    """

    def source(core: "SimulatedCore") -> Iterator[Sent]:
        level = core.level
        clocks, group = 1000 * core.clk_khz / rate_hz, 1 << level
        spans: PeakToPeak | None = None
        done = 0
        for codes in blocks(core) if callable(blocks) else blocks:
            core.boundary()
            config = core.slip_config(window, hop)
            if spans is None:
                spans = PeakToPeak(len(codes), window // group, hop // group)
                twin, last = Slip(len(codes), config), np.zeros((len(codes), 1), dtype=int)
                changes, before = SlipChanges(len(codes)), codes[:, :0]
                core.states = changes.now
            twin.config, changes.events = config, core.events
            detail, total = details(np.concatenate([before, codes], axis=1), config, start=before.shape[1])
            before = codes
            p2p, _ = spans.next(detail)
            state = twin.next(p2p, total)
            earlier, last = np.concatenate([last, state[:, :-1]], axis=1), state[:, -1:]
            starts = np.isin(state, SLIPS) & ~np.isin(earlier, SLIPS)
            for k, channel in np.argwhere((state != earlier).T).tolist():
                change = changes.next(channel, state[channel, k], starts[channel, k])
                if change:
                    at = int((done + group * (k + 1) - 1) * clocks)  # time of the sample that decided
                    yield at, *p.change_of(channel, int(p2p[channel, k]), change)
            core.beside.append(traced(core.clk_khz, rate_hz, done, codes, p2p))
            done += codes.shape[1]
            yield int(done * clocks), None, b""

    return source


def array_source(
    forces: ArrayLike, rate_hz: float, min_load: int | None = 1, image_every: int = 1, loop: bool = False
) -> Source:
    """Frames of forces [frames, rows, columns] through the CoP twin: their CoP and images. ``min_load`` None:
    that of the register."""
    forces = check_forces(forces)
    found = engines.process_cop(forces, "fixed", 1 if min_load is None else min_load)

    def source(core: "SimulatedCore") -> Iterator[Sent]:
        clocks = 1000 * core.clk_khz / rate_hz
        for turn in count() if loop else (0,):
            for k, frame in enumerate(forces):
                place = turn * len(forces) + k
                at = int(place * clocks)
                core.boundary()
                x, y, load, pressed = (int(found[name][k]) for name in ("x", "y", "sum", "valid"))
                if min_load is None and load < core.registers.setting("cop", "min_load"):
                    x = y = pressed = 0
                yield at, p.COP, p.cop_frame(x, y, load, pressed)
                if place % image_every == 0:
                    for part in p.image_chunks(place // image_every, frame.ravel().tolist()):
                        yield at, p.IMAGE, part

    return source


def statistics_source(core: "SimulatedCore") -> Iterator[Sent]:
    """The core's counters in turn, endlessly; here all but the rejected commands stay 0."""
    for turn in count():
        name = p.COUNTERS[turn % len(p.COUNTERS)]
        value = core.rejected if name == "commands rejected" else 0
        yield (turn + 1) * STATISTIC_CLOCKS, p.STATISTIC, p.statistic(turn % len(p.COUNTERS), value)


def together(*sources: Source) -> Source:
    """The packets of all sources in order of time, until the last source ends."""
    return lambda core: heapq.merge(*(source(core) for source in sources), key=lambda item: item[0])


# The parts of a scene


@dataclass(frozen=True)
class Driven:
    """A source, and what its core has: ``settings`` {name: value}, as after reset; ``obeys``: those that the
    source follows while it runs; ``status`` {name: value}; ``size``: of the array, or (1, channels)."""

    source: Source
    settings: dict[str, int] = field(default_factory=dict)
    obeys: frozenset[str] = frozenset()
    status: dict[str, int] = field(default_factory=dict)
    size: tuple[int, int] = (1, 1)
    level: int | None = None


def _settings(group: str) -> frozenset[str]:
    """The names of all settings in a group of registers."""
    return frozenset(
        name for name, place in names.PLACES.items() if name.startswith(f"{group}.") and place.setting
    )


@singledispatch
def driven(part: Any) -> Driven:
    """The Driven of a part of a scene."""
    raise TypeError(f"no core is driven by {type(part).__name__}")


@driven.register
def _slips(part: played.Slips) -> Driven:
    config, settings = part.config, settings_of(part.config)

    def sheared(core: "SimulatedCore") -> Iterator[Ints]:
        """The codes, with the registers of the shear speed kept up."""
        twin, place = ShearSpeeds(part.shear, part.codes.shape[1]), 0
        usable = len(part.codes) >> config.level << config.level
        moving = np.zeros(usable, bool) if part.moving is None else part.moving[:usable]
        for codes in blocks_of(part.codes.T, config.level, loop=True):
            yield codes
            twin.next(codes, moving[place : place + codes.shape[1]])
            place = (place + codes.shape[1]) % usable
            for channel, (speed, flags) in enumerate(twin.last):
                core.report(f"shear_speed.channel{channel}", speed | flags << 24)

    blocks: Blocks = blocks_of(part.codes.T, config.level, loop=True)
    if part.shear is not None:
        blocks = sheared
        settings |= {f"shear_speed.{name}": value for name, value in part.shear.settings.items()}
    source = slip_source(blocks, part.rate_hz, config.window, config.hop)
    return Driven(source, settings, _settings("slip"), size=(1, part.codes.shape[1]), level=config.level)


@driven.register
def _frames(part: played.Frames) -> Driven:
    _, rows, columns = part.forces.shape
    every = max(1, round(part.rate_hz / min(IMAGE_HZ, TAXELS_S / (rows * columns))))
    source = array_source(part.forces, part.rate_hz, None, every, loop=True)
    min_load = "cop.min_load"
    return Driven(source, {min_load: part.min_load}, frozenset([min_load]), size=(rows, columns))


@driven.register
def _wires(part: played.Wires) -> Driven:
    registers, given = part.config.registers, part.registers
    settings = {"cop4.min_load": registers.min_load}
    if given is not None:
        settings |= {f"cop_slip.{name}": value for name, value in vars(given).items()}

    def source(core: "SimulatedCore") -> Iterator[Sent]:
        clocks, step = 1000 * core.clk_khz / part.rate_hz, max(1, round(part.rate_hz / LOOK_HZ))
        every = max(1, round(part.rate_hz / COP_HZ))
        twin = CopSlip(part.lag, given) if given is not None else None
        changes, state, done = SlipChanges(1), 0, 0
        if twin is not None:
            core.states, core.first = changes.now, OF_LOAD
        for _ in count():
            if twin is not None:  # that the last turn ended in a touch is no slip of this one
                twin.reset()
            for start in range(0, len(part.codes), step):
                core.boundary()
                codes = part.codes[start : start + step]
                own = replace(registers, min_load=core.registers.setting("cop4", "min_load"))
                found = cop4(codes, own, part.config.sample_bits, part.config.terms)
                rows: list[tuple[int, int, bytes]] = []
                if twin is not None:
                    values = {name: core.registers.setting("cop_slip", name) for name in vars(given)}
                    twin.registers, changes.events = CopSlipRegisters(**values), core.events
                    slips = twin.next(found.x, found.y, found.load, found.pressed)
                    touched = np.where(found.pressed, State.CONTACT, State.NONE)
                    states = np.where(slips.slip, State.INCIPIENT, touched).tolist()
                    for k, (before, now) in enumerate(pairwise([state, *states])):
                        if before != now or slips.raised[k]:
                            change = changes.next(0, now, slips.raised[k])
                            if change:
                                rows.append((k, *p.change_of(OF_LOAD, int(slips.octant[k]), change)))
                    state = states[-1]
                for k in range(-done % every, len(codes), every) if part.cop else ():
                    x, y, load, pressed = (int(found[name][k]) for name in range(4))
                    rows.append((k, p.COP, p.cop_frame(x, y, load, bool(pressed))))
                for k, kind, payload in sorted(rows, key=lambda row: row[0]):
                    yield int((done + k) * clocks), kind, payload
                done += len(codes)
                yield int(done * clocks), None, b""

    obeys = frozenset(["cop4.min_load"]) | (frozenset() if given is None else _settings("cop_slip"))
    return Driven(source, settings, obeys)


@driven.register
def _classes(part: played.Classes) -> Driven:
    def source(core: "SimulatedCore") -> Iterator[Sent]:
        clocks, told = 1000 * core.clk_khz / part.rate_hz, p.NO_CLASS
        for turn in count():
            for frame, (label, votes) in enumerate(zip(part.labels.tolist(), part.votes.tolist())):
                at = int((turn * len(part.labels) + frame) * clocks)
                if label in (-1, told):
                    yield at, None, b""
                else:
                    yield at, p.CLASS, p.class_change(label, told, votes)
                    told = label
                if label >= 0:
                    core.report("forest.label", label)
                    core.report("forest.best", votes)

    return Driven(source)


@driven.register
def _pins(part: played.Pins) -> Driven:
    largest = max((levels.shape for _, _, levels in part.frames), key=lambda shape: shape[0] * shape[1])
    most = (1 << part.bits) - 1

    def source(core: "SimulatedCore") -> Iterator[Sent]:
        for turn in count():
            for at, hz, levels in part.frames:
                seconds = (turn * part.span + at) / part.rate_hz
                clocks = int(1000 * core.clk_khz * seconds)
                yield clocks, None, b""
                core.put("display.increment", increment_of(hz, core.clk_khz))
                core.report("display.state", 1 | int((levels > 0).sum()) << 8)
                core.beside.append(Pins(clocks, seconds, levels.astype(np.uint8), most))

    size = {"rows": largest[0], "columns": largest[1], "bits": part.bits}
    status = {f"display.size.{name}": value for name, value in size.items()}
    return Driven(source, {"display.source": 1, "display.enable": 1}, status=status)


@driven.register
def _loop(part: played.Loop) -> Driven:
    config, whole = part.config, BLOCK << part.config.level
    names_of = {"slip.threshold": "threshold"} | {f"grip.{name}": name for name in FOLLOWED}
    written: dict[str, int] = {}  # what the scene's host wrote last

    def cycles(core: "SimulatedCore") -> Iterator[Ints]:
        """The codes of both fingers in whole blocks; a viewer writes the registers, and so does the scene's
        own host."""
        left, tightenings, last = np.zeros((2, 0), np.int64), 0, 0
        for turn in count():
            for codes, command, fault, faulty, reflexes in part.begin(turn):
                tightenings += int((np.diff(command, prepend=last) > 0).sum()) if last else 0
                last = int(command[-1])
                told = {"command": last, "fault": int(fault[-1]), "faulty": int(faulty[-1])}
                for name, value in (told | {"tightenings": tightenings}).items():
                    core.report(f"grip.{name}", value)
                shared(core, reflexes)
                left = np.concatenate([left, codes], axis=1)
                while left.shape[1] >= whole:
                    yield left[:, :whole]
                    left = left[:, whole:]

    def shared(core: "SimulatedCore", reflexes: Any) -> None:
        [reflex] = reflexes.reflexes
        core.put("grip.minimum", reflex.config.minimum)
        own = vars(reflex.config) | {"threshold": int(np.max(reflexes.slip.threshold))}
        for register, name in names_of.items():
            if written.get(register) != own[name]:
                core.put(register, own[name])
        core.boundary()
        seen = {name: core.registers.setting(*register.split(".")) for register, name in names_of.items()}
        written.update({register: seen[name] for register, name in names_of.items()})
        reflexes.compare_with(np.array([seen.pop("threshold")]))
        reflex.config = replace(reflex.config, **seen | {"watchdog": max(1, seen["watchdog"])})

    given = {f"grip.{name}": value for name, value in part.grip.settings.items()} | {"grip.enable": 1}
    settings = settings_of(config) | given
    source = slip_source(cycles, part.rate_hz, config.window, config.hop)
    return Driven(source, settings, frozenset(names_of), size=(1, 2), level=config.level)
