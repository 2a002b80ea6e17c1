"""A core without hardware: docs/link.md, built from the twins of registers, bridge, packets and slip."""

import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from meissner import scenes
from meissner.builds import units
from meissner.host import names
from meissner.host.sensors import Pins, Sent, Source, Trace, driven, statistics_source, together
from meissner.scenes import played
from meissner.twins.link import bridge, cobs
from meissner.twins.link import packet as p
from meissner.twins.link.registers import Registers, reset_word
from meissner.twins.slip.config import SAMPLE_BITS, SWITCHES, TIMER_BITS, SlipConfig
from meissner.twins.slip.slip import State

CLK_KHZ = 25_000
LATE_S = 0.1  # that a read may spend catching up before it slows the clock
SHOWN = "acrylic_slip+walk_25x5"


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
        widths["load"] = min(32, 16 + (taxels - 1).bit_length())  # of the map
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
        self.beside: deque[Trace | Pins] = deque(maxlen=64)  # what no line carries, until it is taken
        self.obeys: set[str] | None = None  # settings that the source follows; None: any
        self.title = "a simulated core"
        self.channels = 1  # with a state, before a source says how many
        self._make = source if callable(source) else lambda core: iter(source)
        self.restart()

    def restart(self) -> None:
        """Reset the core: settings, packet numbers and time start over."""
        self.registers.reset()
        self._source = self._make(self)
        self._next: Sent | None = None
        self._out, self._in, self._number = bytearray(), bytearray(), 0
        self._began, self._now = time.monotonic(), 0
        self.rejected, self.states, self.first = 0, [0] * self.channels, 0

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
                for payload in p.states(self.states, self.first) if self.states else ():
                    self.say(p.STATES, self.now, payload)

    def put(self, name: str, value: int) -> None:
        """Write a register of one field, as a host does."""
        place = names.place(name)
        self.registers.access(True, place.address, place.into(0, value))

    def report(self, name: str, value: int) -> None:
        """What a status register or one of its fields reads from now on."""
        place = names.place(name)
        for each in [place.field] if place.field else place.register.fields:
            bits = value if place.field else value >> each.low & each.most
            self.status[place.group.name, place.register.name, each.name] = bits

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


def of_scenes(which: str | Sequence[Any] = SHOWN, speed: str = "1", seed: int = 1) -> SimulatedCore:
    """A core whose sensors play scenes in a loop; ``which``: names joined by +, or scenes. ``title`` says how
    much more slowly than in truth a short one is played."""
    try:
        rate = float(speed)
        if not 0 < rate < float("inf"):
            raise ValueError
    except ValueError:
        raise ValueError(f"speed = {speed} must be a number above 0") from None
    sources: list[Source] = [statistics_source]
    settings: dict[str, int] = {}
    status: dict[str, int] = {}
    obeys: set[str] = set()
    titles = []
    size, known, level, unknown = (1, 1), units.Units(), 1, vars(units.Units())
    found: Sequence[Any] = which or SHOWN
    for scene in map(scenes.load, found.split("+")) if isinstance(found, str) else found:
        parts, slow = played.parts(scene, seed)
        titles.append(scene.name + (f", {slow:.3g} times more slowly" if slow > 1 else ""))
        for part in parts:
            one = driven(part)
            sources.append(one.source)
            settings |= one.settings
            status |= one.status
            obeys |= one.obeys
            size, level = max(size, one.size, key=lambda each: each[0] * each[1]), one.level or level
            own = {name: value for name, value in vars(part.units).items() if value != unknown[name]}
            known = replace(known, **own)
    core = SimulatedCore(together(*sources), settings=settings, size=size, speed=rate, level=level)
    core.units, core.obeys, core.title = known, obeys, " + ".join(titles)
    core.channels = any(name.startswith(("slip.", "cop_slip.")) for name in obeys)
    core.restart()
    for name, value in status.items():
        core.report(name, value)
    return core
