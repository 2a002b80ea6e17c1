"""UTC of a core's packets, from the core's clock."""

import time
from collections.abc import Iterator
from contextlib import suppress

from meissner.host import packets
from meissner.host.core import Core
from meissner.twins.link.packet import TIMES

DRIFT_PPM = 200  # of two crystals together, at most
LATE_NS = 10**9  # a packet that seems later than this means that the core's clock stood still


class Stamps:
    """``next(item)`` yields (ns, packet): ``item``, and before it a Reset where the core was reset.

    Time follows the core's clock from the moment at which this object is made, and is aligned again after a
    reset of the core, which lies behind everything before it. With ``follow`` it also follows this machine's
    clock, as a robot needs it: no packet is stamped later than it arrived, and the earliest of them are taken
    for those without delay, so the two clocks may drift by DRIFT_PPM.
    """

    def __init__(self, core: Core, follow: bool = False) -> None:
        if not core.units.clk_khz:
            raise ValueError(
                "the core's clock is unknown, so its times cannot become UTC: give it in kHz (--clk-khz)"
            )
        self._core, self._follow = core, follow
        self.start_ns, self.start, self._last = time.time_ns(), 0, 0
        self._boot: int | None = None  # of the last packet
        self._aligned = -1  # the boot of these times
        self.newest_ns, self._least_ns, self._checked_ns = self.start_ns, 0, self.start_ns
        self.moved = True  # ``start_ns`` and ``start`` have new values since somebody set this to False
        if core.now:
            self._set(core.now, core.counts.restarts)

    def min_load(self) -> int:
        """The core's ``cop.min_load``, which a replay needs; -1: not known."""
        core, known = self._core, self._core.units.min_load
        if core.registers and "cop" in core.features:
            return core["cop.min_load"]
        return -1 if known is None else known

    def _set(self, ticks: int, boot: int) -> None:
        """``ticks`` of that boot are now, but its time 0 does not lie before the reset."""
        self.start_ns = max(time.time_ns(), self._least_ns + self._ns(ticks))
        self.start, self._last, self._aligned, self.moved = ticks, ticks, boot, True

    def _ns(self, ticks: int) -> int:
        assert self._core.units.clk_khz
        return ticks * 10**6 // self._core.units.clk_khz

    def next(self, item: packets.Item) -> Iterator[tuple[int, packets.Item | packets.Reset]]:
        if isinstance(item, packets.Gap):
            stamp = time.time_ns()
        else:
            if self._boot not in (None, item.boot):
                self._least_ns, least = self.newest_ns + 1, -1
                with suppress(OSError), self._core.impatient():  # the line may be interrupted again
                    least = self.min_load()
                yield self._least_ns, packets.Reset(item.boot, least)
            self._boot = item.boot
            stamp = self._of(item)
        self.newest_ns = max(self.newest_ns, stamp)
        yield stamp, item

    def _of(self, item: packets.Stamped) -> int:
        if self._aligned != item.boot:
            self._set(item.time, item.boot)
        # Unwrap the 48-bit time: the value nearest to the last one, before or after it.
        self._last += (item.time - self._last + TIMES // 2) % TIMES - TIMES // 2
        stamp = self.start_ns + self._ns(self._last - self.start)
        if not self._follow:
            return stamp
        now = time.time_ns()
        delay, passed = now - stamp, max(0, now - self._checked_ns)
        self._checked_ns = now
        if 0 < delay <= LATE_NS:
            delay = min(delay, passed * DRIFT_PPM // 10**6)
        self.start_ns += delay
        return stamp + delay
