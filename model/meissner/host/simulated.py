"""A core without hardware: docs/link.md, built from the twins of registers, bridge, packets and slip.

A source is a function that takes the core and yields (time in clocks, type, payload) in ascending time; the
type None only advances the time. It may read the core's registers, which change at ``core.boundary``.
"""

import heapq
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner import engines, scenes
from meissner.arrays import Ints
from meissner.builds import units
from meissner.host import names, packets
from meissner.inputs import check_forces
from meissner.twins.link import bridge, cobs
from meissner.twins.link import packet as p
from meissner.twins.link.registers import Registers, reset_word
from meissner.twins.slip.config import SAMPLE_BITS, SWITCHES, TIMER_BITS, SlipConfig
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import Slip, State
from meissner.twins.slip.slip_changes import SlipChanges
from meissner.twins.slip.slip_path import details

CLK_KHZ = 25_000
STATISTIC_CLOCKS = 1 << 20
TRACE_HZ, TRACED = 500, 16  # spans of a Trace in a second, its channels
LATE_S = 0.1  # that a read may spend catching up before it slows the clock
BLOCK = 64  # details between two looks at the registers
SHOWN = "acrylic_slip+walk_25x5"
SLIPS = (State.INCIPIENT, State.GROSS)


Sent = tuple[int, int | None, bytes]
Source = Callable[["SimulatedCore"], Iterator[Sent]]


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


class SimulatedCore:
    """A pipe for meissner.host.pty or meissner.host.line.

    ``source``: a function as above, or a list of (time, type, payload). ``settings``: {name: value} that the
    build starts with. ``speed``: simulated seconds per second; 0: as fast as it is read. ``level``: of the
    slip path. ``status``: {(group, register, field): value} that the core reports.
    """

    def __init__(
        self,
        source: Source | Sequence[Sent] = (),
        features: Sequence[str] | None = None,
        settings: Mapping[str, int] | None = None,
        size: tuple[int, int] = (1, 1),
        clk_khz: int = CLK_KHZ,
        speed: float = 0.0,
        level: int = 1,
    ) -> None:
        taxels = size[0] * size[1]
        widths = {"detail": SAMPLE_BITS + level, "timer": TIMER_BITS, "offset": 17}
        widths["load"] = 16 + (taxels - 1).bit_length()
        self.level = level
        self.registers = Registers(features, reset_word(settings or {}, widths), widths)
        self.clk_khz, self.speed = clk_khz, speed
        self.status = {
            ("core", "size", "rows"): size[0],
            ("core", "size", "columns"): size[1],
            ("core", "clk_khz", "value"): clk_khz,
            ("core", "beats", "value"): taxels,
            ("core", "lanes", "value"): 1,
        }
        self.units = units.Units()  # what a host should know about this core
        self.traces: deque[Trace] = deque(maxlen=64)  # those not taken yet
        self._make = source if callable(source) else lambda core: iter(source)
        self.restart()

    def restart(self) -> None:
        """Reset the core: settings, packet numbers and time start over."""
        self.registers.reset()
        self._source = self._make(self)
        self._next: Sent | None = None
        self._out, self._in, self._number = bytearray(), bytearray(), 0
        self._began, self._now = time.monotonic(), 0
        self.rejected, self.states = 0, [0]

    @property
    def now(self) -> int:
        """Clocks since reset."""
        passed = (time.monotonic() - self._began) * self.speed * 1000 * self.clk_khz
        return max(self._now, int(passed))

    def boundary(self) -> None:
        """A frame begins: the settings that wait for it take effect."""
        if self.registers.pending:
            self.registers.commit()

    def read(self, n: int) -> bytes:
        """Up to ``n`` bytes that are due; slower than ``speed`` if the machine cannot keep up."""
        late = time.monotonic() + LATE_S
        while len(self._out) < n:
            self._next = self._next or next(self._source, None)
            if self._next is None or (self.speed and self._next[0] > self.now):
                break
            if self.speed and time.monotonic() > late:
                self._began = time.monotonic() - self._next[0] / (self.speed * 1000 * self.clk_khz)
                break
            (at, kind, payload), self._next = self._next, None
            self._now = max(self._now, at)
            if kind is not None:
                self.say(kind, self.now if kind == p.STATISTIC else at, payload)  # stamped when sent
        data = bytes(self._out[:n])
        del self._out[: len(data)]
        return data

    def say(self, kind: int, at: int, payload: bytes) -> None:
        """Send a packet."""
        self._now = max(self._now, at)
        self._out += cobs.encode(p.packet(kind, self._number, at, payload))
        self._number += 1
        self.status["link", "packets", "value"] = self._number

    def write(self, data: bytes) -> None:
        """Bytes for the register bridge."""
        self._in += data
        whole = self._in.rfind(b"\0") + 1
        found, rejected = bridge.accesses(bytes(self._in[:whole]))
        del self._in[:whole]
        self.rejected += rejected
        for operation, tag, address, value in found:
            word, error, pulses = self.registers.access(operation, address, value, status=self.status)
            status = bridge.BUS_ERROR if error else bridge.DONE
            self.say(p.ANSWER, self.now, bridge.answer(tag, status, address, word))
            if ("link", "states", "value") in pulses:
                for payload in p.states(self.states):
                    self.say(p.STATES, self.now, payload)

    @property
    def events(self) -> int:
        """The register link.events."""
        bits = (self.registers.setting("link", "events", state.name.lower()) << state for state in State)
        return sum(bits)

    def slip_config(self, window: int = SlipConfig.window, hop: int = SlipConfig.hop) -> SlipConfig:
        """The SlipConfig in the registers of the group slip, for a build with that window and hop."""
        values: dict[str, Any] = {}
        for name in names.PLACES:
            if name.startswith("slip.") and names.place(name).writable:
                key = name.removeprefix("slip.")
                values[key] = names.place(name).value(self.registers.setting("slip", key))
        for name in SWITCHES:
            values[name] = bool(values[name])
        return SlipConfig(level=self.level, window=window, hop=hop, **values)


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


def slip_source(blocks: Iterable[Ints], rate_hz: float, window: int = 64, hop: int = 64) -> Source:
    """Blocks of codes [channels, whole details] through the slip path's twins: a packet for each change.

    The settings come from the core's registers, read before each block; ``blocks`` may be a generator.
    """

    def source(core: SimulatedCore) -> Iterator[Sent]:
        level = core.level
        clocks, group = 1000 * core.clk_khz / rate_hz, 1 << level
        spans: PeakToPeak | None = None
        done = 0
        for codes in blocks:
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
            core.traces.append(traced(core.clk_khz, rate_hz, done, codes, p2p))
            done += codes.shape[1]
            yield int(done * clocks), None, b""

    return source


def array_source(
    forces: ArrayLike, rate_hz: float, min_load: int = 1, image_every: int = 1, loop: bool = False
) -> Source:
    """Frames of forces [frames, rows, columns] through the CoP twin: their CoP and images."""
    forces = check_forces(forces)
    found = engines.process_cop(forces, "fixed", min_load)

    def source(core: SimulatedCore) -> Iterator[Sent]:
        clocks = 1000 * core.clk_khz / rate_hz
        for turn in count() if loop else (0,):
            for k, frame in enumerate(forces):
                place = turn * len(forces) + k
                at = int(place * clocks)
                x, y, load, pressed = (int(found[name][k]) for name in ("x", "y", "sum", "valid"))
                yield at, p.COP, p.cop_frame(x, y, load, pressed)
                if place % image_every == 0:
                    for part in p.image_chunks(place // image_every, frame.ravel().tolist()):
                        yield at, p.IMAGE, part

    return source


def statistics_source(core: SimulatedCore) -> Iterator[Sent]:
    """The core's counters in turn, endlessly; here all but the rejected commands stay 0."""
    for turn in count():
        name = p.COUNTERS[turn % len(p.COUNTERS)]
        value = core.rejected if name == "commands rejected" else 0
        yield (turn + 1) * STATISTIC_CLOCKS, p.STATISTIC, p.statistic(turn % len(p.COUNTERS), value)


def together(*sources: Source) -> Source:
    """The packets of all sources in order of time, until the last source ends."""
    return lambda core: heapq.merge(*(source(core) for source in sources), key=lambda item: item[0])


def of_scenes(which: str | Sequence[Any] = SHOWN, speed: str = "1", seed: int = 1) -> SimulatedCore:
    """A core whose sensors play slip and array scenes in a loop; ``which``: names joined by +, or scenes."""
    try:
        rate = float(speed)
        if not 0 < rate < float("inf"):
            raise ValueError
    except ValueError:
        raise ValueError(f"speed = {speed} must be a number above 0") from None
    sources: list[Source] = [statistics_source]
    settings: dict[str, int] = {}
    size, known, level = (1, 1), units.Units(), 1
    found: Sequence[Any] = which or SHOWN
    for scene in map(scenes.load, found.split("+")) if isinstance(found, str) else found:
        if scene.sensor == "rubber":
            config = scene.slip_config()
            recording = scenes.simulate(scene, 0, seed)
            blocks = blocks_of(recording.codes, config.level, loop=True)
            sources.append(slip_source(blocks, scene.rate_hz, config.window, config.hop))
            level = config.level
            settings |= settings_of(config)
            known = replace(units.of_scene(scene), newtons_per_code=known.newtons_per_code)
        elif scene.sensor == "array":
            recording = scenes.simulate(scene)
            every = max(1, round(scene.rate_hz / 25))
            sources.append(array_source(recording.codes, scene.rate_hz, scene.min_load, every, loop=True))
            size = (scene.rows, scene.columns)
            settings["cop.min_load"] = scene.min_load
            known = replace(known, newtons_per_code=scene.load_lsb)
        else:
            raise ValueError(
                f"scene {scene.name} has neither a rubber sensor nor an array, so it gives no packets"
            )
    core = SimulatedCore(together(*sources), settings=settings, size=size, speed=rate, level=level)
    core.units = known
    return core
