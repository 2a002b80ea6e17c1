"""A core at the other end of a line: identify, check, set up, receive, reconnect."""

import logging
import random
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from meissner.builds.units import Units
from meissner.host import names
from meissner.host.boots import Boots
from meissner.host.line import Ended, Gone, Line
from meissner.host.names import Place
from meissner.host.packets import Assembler, Gap, Item
from meissner.twins.actuate import display
from meissner.twins.link import bridge
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Decoder, Packet
from meissner.twins.link.register import Group

NOISE = 4096  # bytes without a packet before it is reported: sixteen of the longest packets
UNREAD = 1 << 16  # packets that wait for the program; beyond it, the oldest are dropped
FIRST_WAIT_S, LONGEST_WAIT_S = 0.05, 5.0  # between two attempts to open an interrupted line


class Refused(ValueError):
    """The device that answers is not a core that this host supports."""


class NoAnswer(OSError):
    """The core did not answer; the message gives the likely reason."""


@dataclass
class Counts:
    """Counters of the line. ``lost``: packets missing by their numbers, mod 256 in each gap; ``damaged``:
    frames that are no packet; ``images_lost``: images of which a part was lost; ``images_unfit``: images
    dropped because their size differs from the units; ``unknown``: packets of types that this host does not
    know; ``gaps``, ``gap_s``: number and total length of interruptions of the line; ``restarts``: of the
    core; ``retries``: commands sent again; ``unread``: packets dropped because the program did not take them.
    """

    bytes: int = 0
    packets: int = 0
    lost: int = 0
    damaged: int = 0
    images_lost: int = 0
    images_unfit: int = 0
    unknown: int = 0
    gaps: int = 0
    gap_s: float = 0.0
    restarts: int = 0
    retries: int = 0
    unread: int = 0


class Core:
    """``line``: of meissner.host.line; see ``meissner.host.connect`` for the rest.

    ``core["slip.threshold"]`` reads or writes a register by its name in docs/registers.md; ``packets()``
    yields the core's packets. Both open the line again after an interruption.
    """

    def __init__(
        self,
        line: Line,
        known: Units | None = None,
        registers: bool = True,
        timeout_s: float = 0.25,
        retries: int = 3,
        give_up_s: float = 30.0,
        say: Callable[[str], object] | None = None,
    ) -> None:
        self.line, self.registers = line, registers
        self.timeout_s, self.retries, self.give_up_s = timeout_s, retries, give_up_s
        self.say = say or logging.getLogger("meissner.host").warning
        self.counts = Counts()
        self.features: list[str] = []
        self.build: dict[str, int] = {}
        self._assembler = Assembler(known)
        self._decoder = Decoder()
        self._waiting: deque[Item] = deque()
        self._boots, self._joining = Boots(), True
        self._held: list[Packet] | None = None  # received while it is not known whether the core was reset
        self._since_packet, self._told_noise, self._told_unfit = 0, False, set[int]()
        self._tag = 0
        self._asked: tuple[int, int] | None = None  # tag and address
        self._answer: dict[str, int] | None = None
        self._newest, self._resets = 0, 0  # those after which no setting was written again
        self._written: dict[int, tuple[Place, int]] = {}
        self._down: float | None = None  # since when
        self._reason, self._try_at, self._wait_s = "", 0.0, FIRST_WAIT_S
        self._ended = False
        self._loaded: dict[str, Callable[[], object]] = {}  # tables, and what loads each again
        self._frame_ended = False  # of a display: a host before may have stopped in the middle of one
        if registers:
            try:
                self.identify()
                self._waiting.clear()  # packets from before the units were known
                self._resets = self.counts.restarts = 0
                self["core.scratch"] = random.randrange(1, 1 << 32)  # a reset clears it: see _greet
            except Gone as gone:
                raise NoAnswer(str(gone)) from None

    # Facts about the core

    @property
    def units(self) -> Units:
        return self._assembler.units

    @units.setter
    def units(self, known: Units) -> None:
        """Clock and size, which the core reported itself, are kept."""
        own = {name: getattr(self.units, name) for name in ("clk_khz", "rows", "columns")}
        self._assembler.units = replace(known, **{k: v for k, v in own.items() if v is not None})

    @property
    def now(self) -> int:
        """Clocks since the core's reset, as it last reported them; 0 before the first report."""
        return self._newest

    def identify(self) -> None:
        """Read ID, VERSION, FEATURES, SIZE, clock, widths; Refused in one sentence if the core is another."""
        name = self.line.name
        found = self._ask(bridge.READ, names.place("core.id"))
        if found != names.CONSTANTS["core.id.value"]:
            raise Refused(f"the device on {name} is not a Meissner core: its ID is 0x{found:08x}")
        word = self._ask(bridge.READ, names.place("core.version"))
        major, minor = (names.place(f"core.version.{part}").value(word) for part in ("major", "minor"))
        own = [names.CONSTANTS[f"core.version.{part}"] for part in ("major", "minor")]
        if major != own[0] or (major == 0 and minor != own[1]):
            raise Refused(
                f"the core on {name} has version {major}.{minor} of the register map and this host knows "
                f"{own[0]}.{own[1]}: use the meissner that the core was built with"
            )
        bits = self._ask(bridge.READ, names.place("core.features"))
        size = self._ask(bridge.READ, names.place("core.size"))
        widths = self._ask(bridge.READ, names.place("core.widths"))
        self.build = {name: names.place(f"core.widths.{name}").value(widths) for name in names.WIDTHS}
        self.build |= {
            name: self._ask(bridge.READ, names.place(f"core.{name}")) for name in ("beats", "lanes")
        }
        self.features = [group for bit, group in enumerate(names.FEATURES) if bits >> bit & 1]
        self._assembler.units = replace(
            self.units,
            clk_khz=self._ask(bridge.READ, names.place("core.clk_khz")),
            rows=names.place("core.size.rows").value(size),
            columns=names.place("core.size.columns").value(size),
        )

    # Registers

    def _place(self, name: str) -> Place:
        place = names.place(name)
        if not self.registers:
            raise ValueError(f"{name}: the registers of this core are not read, since it is only listened to")
        if not self._has(place.group):
            raise ValueError(f"{name}: this core is built without {place.group.name}")
        return place

    @property
    def interrupted(self) -> str:
        """Why the line is interrupted now; "" if it is not."""
        return self._reason if self._down is not None else ""

    @property
    def ended(self) -> bool:
        """No more packets will come: the file has ended, or ``stop`` was called."""
        return self._ended and not self._waiting

    @property
    def down(self) -> bool:
        """The line is interrupted, and will be opened again."""
        return self._down is not None

    def names(self) -> list[str]:
        """Names of the registers that this core has; for a register with several fields, of each field."""
        return [
            name for name, place in names.PLACES.items() if place.field is not None and self._has(place.group)
        ]

    def check(self, name: str, value: int | None = None) -> Place:
        """The Place of that name.

        Raises
        ------
        ValueError
            If the core has no such register, or it cannot take the value.
        """
        place = self._place(name)
        if value is not None:
            if not place.writable:
                raise ValueError(f"{name} can only be read")
            place.into(0, value, self.build)
        return place

    def show(self, levels: ArrayLike) -> None:
        """A frame of pin levels [rows, columns], 0 .. 255, on a core's display with ``display.source`` = 1.

        Raises
        ------
        ValueError
            If the display has another size or shows the sensor's frames, or a level is out of range or no
            whole number.
        """
        found, whole = np.asarray(levels), self["display.size"]
        size = tuple(names.place(f"display.size.{side}").value(whole) for side in ("rows", "columns"))
        if found.shape != size:
            raise ValueError(
                f"a frame of {found.shape} does not fit the display: it has {size[0]} x {size[1]} pins"
            )
        words = display.words(found)
        if not self["display.source"]:
            raise ValueError("display.source = 0: the pins show the sensor's frames, and a host's with 1")
        # What was sent of another frame, or a word sent twice, makes this one too long: it is dropped.
        for _ in range(2 + self.retries):
            sent, ended, self._frame_ended = self.counts.retries, self._frame_ended, False
            for word in words:
                self["display.levels"] = word
            self._frame_ended = True
            if ended and self.counts.retries == sent:
                break

    def __getitem__(self, name: str) -> int:
        place = self._place(name)
        word = self._ask(bridge.READ, place)
        if self._resets and self._restore():
            word = self._ask(bridge.READ, place)
        return place.value(word)

    def __setitem__(self, name: str, value: int) -> None:
        place = self.check(name, value)
        word = 0
        if place.field is not None and len(place.register.fields) > 1:  # the other fields keep their values
            word = self._ask(bridge.READ, place)
            if self._resets and self._restore():
                word = self._ask(bridge.READ, place)
        word = place.into(word, value, self.build)
        self._ask(bridge.WRITE, place, word)
        if place.setting:
            self._written[place.address] = (place, word)
        if self._resets:
            self._restore()

    def ask_states(self) -> bool:
        """Ask for the state of every channel, which ``packets`` then yields as States; False if this core has
        none, is only listened to, or does not answer now."""
        if not self.registers or not {"slip", "cop_slip"} & {*self.features}:
            return False
        try:
            with self.impatient():
                self["link.states"] = 1
        except OSError:
            return False
        return True

    def set(self, name: str, **amount: float) -> int:
        """Write one register in volts, newtons or seconds: ``core.set("slip.threshold", volts=0.02)``.

        Returns
        -------
        int
            The code written.

        Raises
        ------
        ValueError
            If the register does not take this quantity (builds.units.CODES) or its code.
        """
        ((quantity, value),) = amount.items()
        code = self.units.code(name, quantity, value)
        self[name] = code
        return code

    @contextmanager
    def together(self) -> Iterator[None]:
        """``with core.together():`` the settings written in this block take effect with the same frame.

        It concerns those that apply at a frame's start (docs/registers.md); the core takes none of them
        before the block ends, also by an error.
        """
        self["core.hold"] = 1
        try:
            yield
        finally:
            self["core.hold"] = 0

    def _ask(self, operation: int, place: Place, data: int = 0) -> int:
        """The word in the core's answer; NoAnswer, or ValueError if it refuses the access."""
        self._tag = self._tag + 1 & 255
        tag, address = self._tag, place.address
        attempts, heard, packets = 0, self.counts.bytes, self.counts.packets
        deadline = time.monotonic() + self.give_up_s
        while attempts <= self.retries:
            if self._down is not None:
                if time.monotonic() > deadline:
                    raise NoAnswer(f"{self._reason}, and did not come back within {self.give_up_s:g} s")
                self._reopen(self._down, 0.1)
                continue
            if attempts:
                self.counts.retries += 1
            attempts += 1
            self._asked, self._answer = (tag, address), None
            try:
                self.line.write(bridge.command(operation, tag, address, data))
            except Gone as gone:
                self._lost(gone)
                continue
            end = time.monotonic() + self.timeout_s
            while self._answer is None and self._down is None and (left := end - time.monotonic()) > 0:
                self._hear(left)
            if self._answer is not None:
                break
        else:
            raise NoAnswer(self._silence(self.counts.bytes - heard, self.counts.packets - packets))
        answer, self._asked = self._answer, None
        if answer["status"] == bridge.DONE:
            return answer["data"]
        what = "write" if operation == bridge.WRITE else "read"
        why = (
            "the core refused the access"
            if answer["status"] == bridge.BUS_ERROR
            else "its bus did not answer"
        )
        raise ValueError(f"{place.name} could not be {what}: {why}".replace("be write", "be written"))

    def _silence(self, heard: int, packets: int) -> str:
        """The likely reason why no answer came."""
        name = self.line.name
        if packets:
            return (
                f"{name} sends packets but does not answer a register access: a core that was built "
                "without registers can only be listened to (--listen)"
            )
        if heard:
            return f"no valid packet in {heard} bytes from {name}: {self._baud_question()}"
        return (
            f"nothing received from {name}: is the core powered, its line connected, its bitstream loaded? "
            "A build without registers (slip1, and every build for the iCEBreaker) never answers: "
            "it can only be listened to (--listen)"
        )

    def _baud_question(self) -> str:
        rate = f" ({self.line.baud})" if self.line.baud else ""
        return f"is the baud rate right{rate}?"

    # Packets

    def packets(self, seconds: float | None = None) -> Iterator[Item]:
        """Packets and gaps as they come.

        Parameters
        ----------
        seconds : float, optional
            0: those already received; None: until the line ends.

        Yields
        ------
        SlipEvent, StateChange, States, ClassChange, CopFrame, Image, Health, Statistics or Gap
        """
        end = None if seconds is None else time.monotonic() + seconds
        while True:
            left = 0.1 if end is None else end - time.monotonic()
            wait = 0.0 if self._waiting else max(0.0, min(left, 0.1))
            if self._down is not None:
                self._reopen(self._down, wait)
            elif not self._ended:
                self._hear(wait)
            if self._resets and self._down is None:
                self._restore()
            while self._waiting:
                yield self._waiting.popleft()
            if self._ended or left <= 0:
                return

    def _hear(self, timeout_s: float) -> None:
        """Wait up to ``timeout_s`` for bytes and take the first that come."""
        try:
            data = self.line.read(timeout_s)
        except Ended:
            self._ended = True
            return
        except Gone as gone:
            self._lost(gone)
            return
        self.counts.bytes += len(data)
        self._since_packet += len(data)
        if self._joining:  # possibly in mid-packet: its remainder is not damage
            data = data[data.find(0) :] if 0 in data else b""
            self._joining = not data
        for packet in self._decoder.next(data):
            self._answered(packet)
            if self._held is None:
                self._take(packet)
            else:
                self._held.append(packet)
        self.counts.damaged = self._decoder.damaged
        greeting = self.registers and not self.build  # a failed greeting reports it
        if self._since_packet >= NOISE and not self._told_noise and not greeting:
            self._told_noise = True
            name = self.line.name
            self.say(f"no valid packet in {self._since_packet} bytes from {name}: {self._baud_question()}")

    def _answered(self, packet: Packet) -> None:
        self.counts.packets += 1
        self._since_packet, self._told_noise = 0, False
        fields = packet.fields
        if packet.kind == p.ANSWER and self._asked == (fields["tag"], fields["address"]):
            self._answer = fields

    def _take(self, packet: Packet) -> None:
        counts = self.counts
        reset, lost = self._boots.next(packet)
        if reset:
            self._started_over()
        counts.lost += lost
        if packet.kind in (p.STATISTIC, p.ANSWER):  # stamped when sent; others may have waited
            self._newest = packet.time
        if packet.kind == p.ANSWER:
            return
        if packet.kind not in p.KNOWN:
            counts.unknown += 1
            return
        item = self._assembler.next(packet)
        counts.images_lost = self._assembler.images_lost
        if self._assembler.images_unfit > counts.images_unfit:
            counts.images_unfit = self._assembler.images_unfit
            self._say_unfit(self._assembler.unfit)
        if item is not None:
            self._put(replace(item, boot=counts.restarts))

    def _say_unfit(self, taxels: int) -> None:
        """Report images of an unexpected size, once for each size."""
        if taxels not in self._told_unfit:
            self._told_unfit.add(taxels)
            rows, columns = self.units.rows or 1, self.units.columns
            self.say(
                f"images of {taxels} taxels from {self.line.name} are dropped, {rows}×{columns} are "
                "expected: is this the core's configuration?"
            )

    def _put(self, item: Item) -> None:
        if len(self._waiting) == UNREAD:
            self._waiting.popleft()
            self.counts.unread += 1
        self._waiting.append(item)

    def _started_over(self) -> None:
        """The core was reset, and with it packet numbers, time and settings."""
        self.counts.restarts += 1
        self._resets += 1
        self._newest = 0
        self._assembler.restart()
        self.counts.images_lost = self._assembler.images_lost

    def keep(self, what: str, load: Callable[[], object]) -> None:
        """Call ``load`` after each reset, which writes ``what`` into the core again, until ``forget``."""
        self._loaded[what] = load

    def forget(self, what: str) -> None:
        self._loaded.pop(what, None)

    def _restore(self) -> bool:
        """Write the settings again that this host had written; returns whether that succeeded."""
        known = [item for item in self._written.values() if self._has(item[0].group)]
        try:
            with self.impatient():
                for place, word in known:
                    self._ask(bridge.WRITE, place, word)
        except (NoAnswer, ValueError):
            return False
        times = "" if self._resets == 1 else f" {self._resets} times"
        again = f": {len(known)} settings were written again" if self.registers else ""
        self._resets = 0
        self.say(f"the core on {self.line.name} was reset{times}{again}")
        for what, load in [*self._loaded.items()]:
            try:
                load()
            except (ValueError, OSError) as problem:
                self.say(f"{what} is not in the core on {self.line.name} any more: {problem}")
            else:
                self.say(f"{what} was written into the core on {self.line.name} again")
        return True

    def _has(self, group: Group) -> bool:
        return not group.feature or group.name in self.features

    @contextmanager
    def impatient(self) -> Iterator[None]:
        """Give up immediately if the line is interrupted meanwhile."""
        kept, self.give_up_s = self.give_up_s, -1.0
        try:
            yield
        finally:
            self.give_up_s = kept

    # The line

    def _lost(self, gone: Gone) -> None:
        self._down, self._reason, self._wait_s = time.monotonic(), str(gone), FIRST_WAIT_S
        self._try_at = self._down + self._wait_s
        self.line.close()
        self.say(f"{gone}; trying to open it again")

    def _reopen(self, since: float, timeout_s: float) -> None:
        """Try once to open the line, if an attempt is due; waits at most about ``timeout_s``."""
        wait = self._try_at - time.monotonic()
        if wait > timeout_s:
            time.sleep(timeout_s)
            return
        time.sleep(max(0.0, wait))
        self._held, reset = [], False
        try:
            self.line.reopen()
            self._down, self._joining = None, True
            reset = self.registers and self._greet()
        except (Gone, NoAnswer, OSError):
            if self._down is None:
                self.line.close()
            self._down = since
            self._wait_s = min(2 * self._wait_s, LONGEST_WAIT_S)
            self._try_at = time.monotonic() + self._wait_s
        else:
            seconds = time.monotonic() - since
            self.counts.gaps += 1
            self.counts.gap_s += seconds
            self.say(f"{self.line.name} is back after {seconds:.1f} s")
            self._put(Gap(self._reason, seconds))
        finally:
            held, self._held = self._held, None
            if reset:
                self._boots.restart()
                self._started_over()
            for packet in held:
                self._take(packet)

    def _greet(self) -> bool:
        """``identify`` on a line just opened again; returns whether the core was reset meanwhile."""
        with self.impatient():
            self.identify()
            scratch = names.place("core.scratch")
            return scratch.address in self._written and (
                self._ask(bridge.READ, scratch) != self._written[scratch.address][1]
            )

    def stop(self) -> None:
        """Make ``packets`` end after the packets already received."""
        self._ended = True

    def close(self) -> None:
        self.line.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
