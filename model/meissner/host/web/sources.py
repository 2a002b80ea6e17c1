"""Where the page's packets come from: a core, or a log. ``step`` takes what came in PERIOD_S and sends it."""

import time
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from meissner.arrays import Arrays
from meissner.builds.units import CODES, Units
from meissner.engines.rtl_core import CoreOnPins
from meissner.host import packets
from meissner.host.core import Core
from meissner.host.log import Log
from meissner.host.sensors import BLOCK, Pins, Trace, traced
from meissner.host.table import items
from meissner.host.view import pins_of
from meissner.host.web.hub import Hub
from meissner.twins.link.packet import COUNTERS
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.shear_speeds import MAX_CHANNELS
from meissner.twins.slip.slip import State
from meissner.twins.slip.slip_path import details

PERIOD_S = 0.02
POLL_S = 0.1  # between two reads of registers that no packet reports
TURN = 4  # settings read with them
STATUS_S = 0.5
GROUPS = ("slip", "cop", "cop4", "cop_slip", "grip", "shear_speed")  # whose settings the page shows
READ = (  # what no packet reports
    *("grip.enable", "grip.command", "grip.fault", "grip.faulty", "grip.tightenings"),
    *("forest.label", "forest.best", "shear_speed.enable"),
)


def about(title: str, known: Units, features: list[str], settings: list[dict[str, Any]]) -> dict[str, Any]:
    """What a viewer learns first."""
    names = ("clk_khz", "rows", "columns", "pitch_mm", "newtons_per_code")
    return {
        "title": title,
        "core": {name: getattr(known, name) for name in names},
        "features": features,
        "settings": settings,
        "counters": list(COUNTERS),
        "state_names": [state.name.lower() for state in State],
    }


def scale(known: Units, name: str) -> tuple[float, float, str] | None:
    """(value of a code, value of code 0, unit) of a register; None if it has no unit, or it is not known."""
    of = {(register, quantity): method for (register, quantity), method in CODES.items() if register == name}
    lsb_v, lsb_n, step = known.volts_per_code, known.newtons_per_code, 1 << known.level
    for (_, quantity), method in of.items():
        if method.startswith("detail_code"):
            one = known.detail_volts(1) if quantity == "volts" else known.detail_newtons(1)
            if one is not None:
                return one, 0.0, "V" if quantity == "volts" else "N"
        elif method == "level_code" and lsb_v is not None:
            return lsb_v / step, known.low_v - lsb_v * known.min_code, "V"
        elif method == "level_code_of_newtons" and known.of_forces and lsb_n is not None:
            return lsb_n / step, 0.0, "N"
        elif method == "load_code" and lsb_n is not None:
            return lsb_n, 0.0, "N"
        elif method == "details" and known.rate_hz:
            return step / known.rate_hz, 0.0, "s"
    return None


def reach(known: Units, name: str, least: int, most: int) -> tuple[int, int]:
    """The part of a register's range that samples of the build can reach, as far as that is known."""
    if known.codes and name.startswith("slip."):
        low, high = (code << known.level for code in known.codes)
        if name.endswith("threshold"):
            return 0, min(most, high - low)
        if name.endswith("level"):
            return max(least, low), min(most, high)
    if known.most_load and name.endswith(".min_load"):
        return least, min(most, known.most_load)
    return least, most


class OfPins:
    """Traces of the codes at the pins of a core of single channels, which repeat; the peak-to-peak is the
    twins'."""

    def __init__(self, pipe: CoreOnPins) -> None:
        assert pipe.config.slip is not None  # it has channels
        self._pipe, self._slip = pipe, pipe.config.slip
        span, hop = (each >> self._slip.level for each in (self._slip.window, self._slip.hop))
        self._spans, self._done = PeakToPeak(pipe.config.channels, span, hop), 0

    def take(self) -> Iterator[Trace]:
        pipe, config = self._pipe, self._pipe.config
        step = BLOCK << self._slip.level
        while self._done + step <= pipe.frames:
            codes = pipe.codes[np.arange(self._done, self._done + step) % len(pipe.codes)].T
            p2p, _ = self._spans.next(details(codes, self._slip)[0])
            yield traced(config.clk_khz, config.rate_hz, self._done, codes, p2p)
            self._done += step


class OfCore:
    """A connected Core; ``write`` may be called in any thread, the rest in one."""

    def __init__(self, core: Core, title: str) -> None:
        self.core, self.stopped = core, False
        known = core.names() if core.registers else []
        self._pipe = getattr(core.line, "pipe", None)
        obeys = getattr(self._pipe, "obeys", None)  # of a core that plays a scene
        shown = [name for name in known if name.split(".")[0] in GROUPS and (obeys is None or name in obeys)]
        self._settings = [name for name in shown if core.check(name).setting]
        speeds = [f"shear_speed.channel{k}" for k in range(min(core.units.columns or 1, MAX_CHANNELS))]
        self._read = [name for name in READ if name in known]
        if "shear_speed" in core.features:
            self._read += speeds
        self._display = pins_of(core)
        settings = []
        for name in self._settings:
            least, most = core.check(name).ends(core.build)
            ends = {"least": least, "most": most, "reach": reach(core.units, name, least, most)}
            settings.append({"name": name, **ends, "scale": scale(core.units, name)})
        self.hub = Hub(about(title, core.units, core.features, settings), core.units)
        self.log = Log(self.hub, core)
        for name in dict.fromkeys((*self._settings, *self._read)):
            self.hub.remember("register", name, core[name])
        self._polled, self._told = time.monotonic(), 0.0
        self._turn = deque(self._settings)
        self._pins = None
        if isinstance(self._pipe, CoreOnPins) and self._pipe.config.kind == "channels":
            self._pins = OfPins(self._pipe)
        core.ask_states()

    def stop(self) -> None:
        self.stopped = True
        self.core.stop()

    def say(self, sentence: str) -> None:
        self.hub.event("message", text=sentence)

    def write(self, name: str, value: int) -> int:
        """Set a register and read it back, in the core's thread."""

        def work() -> int:
            if name not in self._settings:
                raise ValueError(f"{name} is not one of the page's settings")
            self.core.check(name, value)
            if self.core.down:
                raise ValueError(f"{name} was not set: the line to the core is interrupted")
            with self.core.impatient():
                self.core[name] = value
                found = self.core[name]
            self.hub.remember("register", name, found)
            return found

        found: int = self.hub.ask(work)
        return found

    def step(self) -> None:
        core, hub = self.core, self.hub
        if core.ended:
            time.sleep(PERIOD_S)
        again = False
        for item in core.packets(PERIOD_S):
            self.log.add(item)
            again |= isinstance(item, packets.Gap)
            if self._display is not None and isinstance(item, packets.CopFrame | packets.Image):
                levels = self._display.take(item)
                if levels is not None:
                    shown = Pins(
                        item.time, item.time_s, levels.astype(np.uint8), (1 << self._display.bits) - 1
                    )
                    self.log.add(replace(shown, boot=item.boot))
        for one in self._beside():
            self.log.add(replace(one, boot=core.counts.restarts))
        hub.answer()
        if again:
            core.ask_states()
        now = time.monotonic()
        if now - self._polled >= POLL_S and not core.down and not core.ended:
            self._polled = now
            self._poll()
        if now - self._told >= STATUS_S:
            self._told = now
            hub.event(
                "status",
                counts=asdict(core.counts),
                down=core.down,
                ended=core.ended,
                viewers=len(hub.viewers),
            )
        hub.send()

    def _beside(self) -> Iterator[Trace | Pins]:
        """What no line carries, of a core in this process."""
        waiting = getattr(self._pipe, "beside", None)
        while waiting:
            yield waiting.popleft()
        if self._pins is not None:
            yield from self._pins.take()

    def _poll(self) -> None:
        """Read what changes by itself, and some settings in turn: another host may have written them."""
        self._turn.rotate(-TURN)
        with suppress(OSError, ValueError), self.core.impatient():
            for name in (*self._read, *list(self._turn)[:TURN]):
                self.hub.remember("register", name, self.core[name])
            if self._display is not None:
                self._display.read()
                self.hub.remember("display", "told", self._display.told)


class OfLog:
    """A log, played at the rate at which it was recorded."""

    def __init__(self, log: Arrays, title: str, known: Mapping[str, Any] | None = None) -> None:
        newtons = float(log.get("newtons_per_code", float("nan")))
        rows, columns = log["image"].shape[1:] if len(log["image"]) else (None, None)
        units = Units(
            clk_khz=int(log["clk_khz"]) if "clk_khz" in log else None,
            rows=rows,
            columns=columns,
            newtons_per_code=None if newtons != newtons else newtons,
        )
        self.hub, self.stopped = Hub(about(title, units, [], []), units), False
        self.hub.tell({name: value.item() for name, value in log.items() if value.ndim == 0})
        self._items = items(log, units)
        self._next = next(self._items, None)
        if self._next is None:
            raise ValueError("the log has no packet to play")
        self._zero = self._next[0] - time.monotonic_ns()
        self._told = 0.0

    def stop(self) -> None:
        self.stopped = True

    def say(self, sentence: str) -> None:
        self.hub.event("message", text=sentence)

    def write(self, name: str, value: int) -> int:
        raise ValueError(f"{name} cannot be set: a log is played, and no core is connected")

    def step(self) -> None:
        time.sleep(PERIOD_S)
        now = time.monotonic_ns() + self._zero
        while self._next is not None and self._next[0] <= now:
            self.hub.add(*self._next)
            self._next = next(self._items, None)
        self.hub.answer()
        if time.monotonic() - self._told >= STATUS_S:
            self._told = time.monotonic()
            self.hub.event(
                "status", counts={}, down=False, ended=self._next is None, viewers=len(self.hub.viewers)
            )
        self.hub.send()
