"""Microchip HV507: 64 push-pull outputs of high voltage behind a shift register and latches
(docs/pin_display.md)."""

from dataclasses import dataclass

import cocotb

from parts.timing import PartModel, TimingViolation, changed, level, now

OUTPUTS = 64


@dataclass(frozen=True)
class Limits:
    """ns. The data sheet could not be read: each is unverified, and none is below that of a part of the
    family."""

    t_clk: float = 125  # 8 MHz
    t_hi: float = 62
    t_lo: float = 62
    t_su: float = 20  # data before rising CLK
    t_hd: float = 20  # data after rising CLK
    t_dle: float = 80  # rising CLK to LE rising
    t_wle: float = 80  # LE high
    t_sle: float = 40  # LE falling to rising CLK


class Hv507(PartModel):
    """``drivers`` parts in a chain; ``lane``: of the data line. ``outputs``: their levels, from the bit
    shifted in last on, and ``changes``: [(ns, levels)] as often as they change."""

    def __init__(self, data, clk, le, bl, pol, drivers=2, lane=0, limits=None, report=None):
        super().__init__(limits or Limits(), report)
        self.data, self.clk, self.le, self.bl, self.pol, self.lane = data, clk, le, bl, pol, lane
        self.shift = [self.noise.getrandbits(1) for _ in range(OUTPUTS * drivers)]
        self.latches = [self.noise.getrandbits(1) for _ in self.shift]
        self.rose = self.fell = self.moved = self.opened = self.closed = None
        self.changes, self.latched = [], []  # latched: [ns] of LE rising
        self.outputs = None
        self.show()
        for watch in (
            self.watch_data,
            self.watch_clk,
            self.watch_le,
            self.watch_levels(bl),
            self.watch_levels(pol),
        ):
            cocotb.start_soon(watch() if callable(watch) else watch)

    def show(self):
        blanked, inverted = not level(self.bl), not level(self.pol)
        if blanked and inverted:
            self.report(TimingViolation("all on: BL is low while POL is low"))
        if level(self.le):
            self.latches = list(self.shift)
        levels = [0] * len(self.shift) if blanked else self.latches
        levels = tuple(bit ^ inverted for bit in levels)
        if levels != self.outputs:
            self.outputs = levels
            self.changes.append((now(), levels))

    async def watch_levels(self, pin):
        while True:
            await changed(pin)
            self.show()

    async def watch_data(self):
        before = self.bit()
        while True:
            await changed(self.data)
            if self.bit() != before:  # of several chains' lines another may have moved
                before = self.bit()
                self.least("t_hd", self.since(self.rose))
                self.moved = now()

    def bit(self):
        return level(self.data) >> self.lane & 1

    async def watch_clk(self):
        while True:
            await changed(self.clk)
            if level(self.clk):
                self.least("t_clk", self.since(self.rose))
                self.least("t_lo", self.since(self.fell))
                self.least("t_su", self.since(self.moved))
                self.least("t_sle", self.since(self.closed))
                if level(self.le):
                    self.report(TimingViolation("mode: CLK rises while LE is high"))
                self.rose = now()
                self.shift = [self.bit(), *self.shift[:-1]]
                self.show()
            else:
                self.least("t_hi", self.since(self.rose))
                self.fell = now()

    async def watch_le(self):
        while True:
            await changed(self.le)
            if level(self.le):
                self.least("t_dle", self.since(self.rose))
                self.opened = now()
                self.latched.append(self.opened)
            else:
                self.least("t_wle", self.since(self.opened))
                self.closed = now()
            self.show()
