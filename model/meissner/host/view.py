"""The display of ``meissner live``: the newest values, as lines for a pipe, a picture for a terminal."""

import time
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meissner.host import packets
from meissner.host.core import Core, NoAnswer
from meissner.host.names import place
from meissner.twins.actuate.pin_display import PHASE_BITS
from meissner.twins.actuate.render import UNIT, Render, RenderSettings
from meissner.twins.core import OF_LOAD
from meissner.twins.slip.slip import State

if TYPE_CHECKING:
    from rich.console import Group

SHADES = " ░▒▓█"
SHORT_S = 0.2  # an interval too short for a rate of packets
WIDEST, HIGHEST = 32, 16  # cells of the picture; in a larger array each cell shows its largest taxel
SLIP_COLOURS: dict[int, str] = {State.INCIPIENT: "yellow", State.GROSS: "red"}


def state_name(state: int) -> str:
    return State(state).name.lower() if state in set(State) else f"state {state}"


def channel_name(channel: int) -> str:
    return "load" if channel == OF_LOAD else str(channel)


def coarse(taxels: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """The taxels as at most HIGHEST × WIDEST cells, each the maximum of its taxels."""
    for axis, most in ((0, HIGHEST), (1, WIDEST)):
        count = taxels.shape[axis]
        if count > most:
            starts = np.arange(most) * count // most
            taxels = np.maximum.reduceat(taxels, starts, axis=axis)
    return taxels


def heat_map(taxels: NDArray[np.uint16]) -> list[str]:
    """Lines of block characters, two per cell, shaded from 0 to the image's maximum."""
    cells = coarse(taxels).astype(np.int64)
    most = max(1, int(cells.max()))
    shade = (2 * cells * (len(SHADES) - 1) + most) // (2 * most)
    return ["".join(2 * SHADES[k] for k in row) for row in shade]


class Pins:
    """A core's tactile display, by its registers; ``told``: its state in words."""

    def __init__(self, core: Core) -> None:
        self.core, self.told = core, ""
        self.cop: packets.CopFrame | None = None  # the newest
        self.images = False  # four electrodes send none
        self.grid = core["display.size.rows"], core["display.size.columns"]
        self.bits = core["display.size.bits"]
        self.read()

    def read(self) -> None:
        """Ask for its state, and for what makes frames of images."""
        core = self.core
        state, names = core["display.state"], ("running", "fault", "limited", "pins")
        running, fault, limited, pins = (place(f"display.state.{name}").value(state) for name in names)
        self.host, self.running = bool(core["display.source"]), bool(running)
        self.top, self.most = core["display.top"], core["display.most"]
        settings = (core[f"display.{name}"] for name in ("floor", "step", "marker"))
        self.render = Render(None, self.grid, self.bits, RenderSettings(*settings))
        hertz = core["display.increment"] * 1000 * (core.units.clk_khz or 0) / (1 << PHASE_BITS)
        drive = f", {hertz:.3g} Hz" if hertz else ""
        self.told = f"{pins} pin{'s' * (pins != 1)} on{drive}" if running else "off"
        self.told += ", a fault of the sensor" * fault + ", limited" * limited

    def levels(self, image: packets.Image | None, cop: packets.CopFrame | None) -> NDArray[Any] | None:
        """The pins for an image of the core and the newest centre of pressure, as it makes them, while it
        drives pins, within ``top`` and ``most``; of a host's frames and slips it has none."""
        if self.host or (image is None and (cop is None or not self.render.settings.marker)):
            return None
        self.render.shape = None if image is None else image.taxels.shape
        at = (round(UNIT * cop.x), round(UNIT * cop.y)) if cop is not None and cop.pressed else None
        levels = self.render.next(None if image is None else image.taxels, cop=at)
        on = (levels > 0) & self.running
        on &= np.cumsum(on).reshape(on.shape) <= self.most
        return np.where(on, np.minimum(levels, self.top), 0)

    def take(self, item: packets.CopFrame | packets.Image) -> NDArray[Any] | None:
        """The pins of the frame that a packet begins: an image, or without any a centre of pressure."""
        if isinstance(item, packets.CopFrame):
            self.cop = item
            return None if self.images else self.levels(None, item)
        self.images = True
        return self.levels(item, self.cop)

    def picture(self, image: packets.Image | None, cop: packets.CopFrame | None) -> list[str]:
        levels = self.levels(image, cop)
        return [] if levels is None else heat_map(levels)


def pins_of(core: Core) -> Pins | None:
    """The display of a core that has one; the register map of a simulated core has every group."""
    if not core.registers or "display" not in core.features or not core["display.size.rows"]:
        return None
    return Pins(core)


class View:
    """``add`` takes packets; ``line`` and ``picture`` show the newest."""

    def __init__(self, core: Core) -> None:
        self.core = core
        self.slip_count = 0
        self._forget(core.counts.restarts)
        self.messages: deque[str] = deque(maxlen=4)
        self._from = (self._simulated_s or 0.0, time.monotonic())
        self._rate = (0.0, 0, 0.0)  # time of the last tick, packets then, packets per second
        self.pins = pins_of(core)

    def _forget(self, boot: int) -> None:
        """Nothing is known of this boot of the core yet."""
        self._boot = boot
        self.states: dict[int, tuple[int, str, str]] = {}  # of each channel: state, peak-to-peak, since when
        self.cop: packets.CopFrame | None = None
        self.image: packets.Image | None = None
        self.statistics: dict[str, int] = {}
        self.health: dict[int, int] = {}

    def add(self, item: packets.Item | None) -> str | None:
        """Take a packet; the lines to print immediately, or None."""
        if isinstance(item, packets.OfBoot) and item.boot != self._boot:
            self._forget(item.boot)
            return "\n".join(["the core was reset", self.add(item) or ""]).rstrip()
        if isinstance(item, packets.SlipEvent | packets.StateChange):
            since = self._at(item).removesuffix(": ")
            self.states[item.channel] = (item.state, self._p2p(item), since)
            self.slip_count += isinstance(item, packets.SlipEvent)
            return self._change(item)
        if isinstance(item, packets.States):
            for channel, state in enumerate(item.states, item.first):
                if self.states.get(channel, (None,))[0] != state:
                    self.states[channel] = (state, "", "")
        elif isinstance(item, packets.ClassChange):
            return f"{self._at(item)}class {item.label}"
        elif isinstance(item, packets.CopFrame):
            self.cop = item
        elif isinstance(item, packets.Image):
            self.image = item
        elif isinstance(item, packets.Statistics):
            self.statistics[item.name] = item.value
        elif isinstance(item, packets.Health):
            self.health[item.taxel] = item.faults
            return f"{self._at(item)}taxel {item.taxel} faults 0b{item.faults:b}"
        return None

    def tick(self, now_s: float) -> None:
        """Update the packet rate; call at intervals. One too short for a rate leaves the last rate."""
        when, before, rate = self._rate
        count = self.core.counts.packets
        if rate and now_s - when < SHORT_S:
            return
        self._rate = (now_s, count, (count - before) / (now_s - when) if now_s > when else 0.0)
        if self.pins and not self.core.ended:
            with suppress(NoAnswer):  # the line is interrupted: the last state stays
                self.pins.read()

    def _at(self, item: packets.Stamped) -> str:
        return f"{item.time} clocks: " if item.time_s is None else f"{item.time_s:.4f} s: "

    def _change(self, item: packets.SlipEvent | packets.StateChange) -> str | None:
        channel = f"channel {channel_name(item.channel)}, "
        if isinstance(item, packets.SlipEvent):
            what = f"slip, {channel}{state_name(item.state)}"
        elif (self.core.units.rows or 1) > 1:
            return None  # a press on an array changes too many
        else:
            late = ", late" if item.late else ""
            what = f"{channel}{state_name(item.before)} to {state_name(item.state)}{late}"
        how = f", peak-to-peak {self._p2p(item)}"
        if item.channel == OF_LOAD:  # it has the octant in its place
            how = f", towards {45 * item.p2p}°" if item.state in SLIP_COLOURS else ""
        return f"{self._at(item)}{what}{how}"

    def _p2p(self, item: packets.OfChannel) -> str:
        volts = "" if item.p2p_v is None else f", {1e3 * item.p2p_v:.1f} mV"
        return f"{item.p2p}{volts}" + ("" if item.p2p_n is None else f", {1e3 * item.p2p_n:.1f} mN")

    def _cop(self) -> str:
        cop = self.cop
        if cop is None:
            return "no centre of pressure yet"
        load = f"load {cop.load}" if cop.load_n is None else f"load {cop.load_n:.3f} N"
        if not cop.pressed:
            return f"not pressed, {load}"
        place = f"x {cop.x:+.3f} y {cop.y:+.3f}"
        return f"{place}{'' if cop.x_mm is None else f' ({cop.x_mm:+.2f}, {cop.y_mm:+.2f} mm)'}, {load}"

    def _simulated(self) -> str:
        """The progress of a core simulated in this process, and its speed as a share of real time."""
        seconds = self._simulated_s
        if seconds is None:
            return ""
        share = (seconds - self._from[0]) / max(time.monotonic() - self._from[1], 1e-9)
        return f"simulated {seconds:.3f} s, {share:.2g} of real time, "

    @property
    def _simulated_s(self) -> float | None:
        return getattr(getattr(self.core.line, "pipe", None), "simulated_s", None)

    def _line(self) -> str:
        counts = self.core.counts
        return (
            f"{self._simulated()}{self._rate[2]:.0f} packets/s, "
            f"{counts.lost} lost, {counts.damaged} damaged, "
            f"{counts.images_lost} images lost, {counts.gaps} gaps ({counts.gap_s:.1f} s)"
        )

    def line(self) -> str:
        """A summary in one line."""
        pins = f"{self.pins.told}; " if self.pins else ""
        return f"{self._cop()}; {self._slips()}; {pins}{self._line()}"

    def _slips(self) -> str:
        """How often it slipped, and how many channels are in contact and slip now."""
        events = f"{self.slip_count} slip event{'s' * (self.slip_count != 1)}"
        now = [state for state, *_ in self.states.values()]
        slipping = sum(state in SLIP_COLOURS for state in now)
        return f"{events}, {now.count(State.CONTACT) + slipping} in contact, {slipping} slipping"

    def picture(self) -> "Group":
        """The same as a renderable for rich."""
        from rich.console import Group
        from rich.panel import Panel
        from rich.table import Table
        from rich.text import Text

        slips = Table("channel", "state", "peak-to-peak", "at", box=None)
        # Those that slip first, then those in contact: of an array not all can be shown.
        order: dict[int, int] = {State.GROSS: 0, State.INCIPIENT: 1, State.CONTACT: 2}
        for channel in sorted(self.states, key=lambda c: (order.get(self.states[c][0], 3), c))[:HIGHEST]:
            state, p2p, since = self.states[channel]
            slips.add_row(
                channel_name(channel), Text(state_name(state), SLIP_COLOURS.get(state, "")), p2p, since
            )
        parts: list[Panel | Text] = [
            Panel(slips, title=f"slip, {self._slips()}"),
            Panel(self._cop(), title="centre of pressure"),
        ]
        if self.image is not None:
            rows, columns = self.image.taxels.shape
            shown = "\n".join(heat_map(self.image.taxels))
            title = f"image {self.image.number}, {rows}×{columns}, largest {self.image.taxels.max()}"
            parts.append(Panel(Text(shown), title=title))
        if self.pins:
            shown = "\n".join(self.pins.picture(self.image, self.cop))
            parts.append(Panel(Text(shown), title=f"display, {self.pins.told}"))
        faulty = {taxel: faults for taxel, faults in self.health.items() if faults}
        if faulty:
            parts.append(
                Panel(", ".join(f"{t}: 0b{f:b}" for t, f in sorted(faulty.items())), title="faulty taxels")
            )
        numbers = ", ".join(f"{value} {name}" for name, value in self.statistics.items())
        parts.append(Panel(f"{self._line()}\nin the core: {numbers or 'none yet'}", title="line"))
        parts += [Text(message) for message in self.messages]
        return Group(*parts)
