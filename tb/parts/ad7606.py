"""Analog Devices AD7606 in serial mode: 16 bits, 8 channels sampled together, no oversampling."""

import random
from dataclasses import dataclass

import cocotb
from cocotb.triggers import Timer

from parts.timing import PartModel, TimingViolation, changed, level, now


@dataclass(frozen=True)
class Limits:
    """ns, at VDRIVE above 2.7 V; docs/adc.md has the sources."""

    t_cycle: float = 5000  # from CONVST to CONVST
    t_conv_min: float = 3450  # given by the part: CONVST to BUSY falling
    t_conv_most: float = 4150
    t_busy: float = 45  # given by the part: CONVST to BUSY rising
    t_convst_low: float = 25
    t_convst_high: float = 25
    t_busy_cs: float = 0  # BUSY falling to CS falling
    t_cs_busy: float = 25  # last CS rising to BUSY falling
    t_sclk: float = 1e6 / 14_500
    t_sclk_low: float = 0.4  # of the period
    t_sclk_high: float = 0.4
    t_cs_dout: float = 30  # CS falling to the first bit
    t_sclk_dout: float = 27  # rising SCLK to the next bit
    t_hold: float = 7  # DOUT stays after rising SCLK
    t_dis: float = 22
    t_reset: float = 50  # RESET high
    t_reset_convst: float = 25  # RESET low to CONVST


class Ad7606(PartModel):
    """``code(channel, time_ns)`` gives the raw code (two's complement, 0 .. 65535).

    ``frames`` keeps the eight codes of every conversion. ``stuck`` None, 0 or 1 holds BUSY at that level.
    A conversion before the first RESET breaks a rule. A read may span CONVST, but not the fall of BUSY: it
    gives the last conversion that ended before.
    """

    def __init__(
        self, cs_n, sclk, miso, convst, busy, reset, code, limits=None, report=None, conversion_ns=None
    ):
        super().__init__(limits or Limits(), report)
        self.cs_n, self.sclk, self.miso, self.convst, self.busy = cs_n, sclk, miso, convst, busy
        self.reset = reset
        self.reset_rose = now() if level(reset) else None
        self.reset_fell = None
        self.code = code
        self.conversion_ns = conversion_ns
        self.lanes = len(miso)
        self.frames = []
        self.results = [0] * 8
        self.stuck = None
        self.draw = random.Random(11)
        self.levels = 0
        self.converting = None  # identifies the conversion in progress
        self.bit = 0
        self.convst_rose = self.convst_fell = self.cs_rose = self.busy_fell = self.rose = self.fell = None
        busy.value = 0
        for lane in range(self.lanes):
            self.release(lane, 1)
        for watch in (self.watch_convst, self.watch_cs, self.watch_sclk, self.watch_reset):
            cocotb.start_soon(watch())

    def hold_busy(self, level):
        """Hold BUSY at ``level`` whatever happens; None: back to normal, idle."""
        self.stuck = level
        self.busy.value = level or 0

    def set_busy(self, level):
        if self.stuck is None:
            self.busy.value = level

    async def watch_reset(self):
        while True:
            await changed(self.reset)
            if level(self.reset):
                self.reset_rose = now()
                self.reset_fell = None
                self.converting = None  # a conversion in progress is aborted
                self.results = [0] * 8
                self.set_busy(0)
            else:
                self.least("t_reset", self.since(self.reset_rose))
                self.reset_fell = now()
                self.convst_rose = None  # this ends its cycle too

    async def watch_convst(self):
        while True:
            await changed(self.convst)
            if level(self.convst):
                self.least("t_convst_low", self.since(self.convst_fell))
                self.least("t_cycle", self.since(self.convst_rose))
                if self.reset_fell is None:
                    self.report(TimingViolation("rule: CONVST rises before a RESET"))
                self.least("t_reset_convst", self.since(self.reset_fell))
                if self.converting:
                    self.report(TimingViolation("rule: CONVST rises during a conversion"))
                self.convst_rose = now()
                self.converting = token = object()
                cocotb.start_soon(self.convert(token))
            else:
                self.least("t_convst_high", self.since(self.convst_rose))
                self.convst_fell = now()

    async def convert(self, token):
        codes = [self.take(channel) for channel in range(8)]
        self.frames.append(codes)
        limits = self.limits
        duration = self.conversion_ns or self.draw.uniform(limits.t_conv_min, limits.t_conv_most)
        rise = self.draw.uniform(1, limits.t_busy)
        await Timer(round(rise * 1000), "ps")
        if self.converting is not token:
            return
        self.set_busy(1)
        await Timer(round((duration - rise) * 1000), "ps")
        if self.converting is not token:
            return
        if not level(self.cs_n):
            self.report(TimingViolation("rule: BUSY falls during a read"))
        self.least("t_cs_busy", self.since(self.cs_rose))
        self.results = codes
        self.converting = None
        self.busy_fell = now()
        self.set_busy(0)

    async def watch_cs(self):
        while True:
            await changed(self.cs_n)
            if level(self.cs_n) == 0:
                if not level(self.sclk):
                    self.report(TimingViolation("mode: SCLK is low as CS falls"))
                self.least("t_busy_cs", self.since(self.busy_fell))
                self.bit = 0
                self.rose = self.fell = None
                self.show(self.limits.t_cs_dout, 0)
            else:
                self.cs_rose = now()
                for lane in range(self.lanes):
                    self.release(lane, self.limits.t_dis)

    async def watch_sclk(self):
        while True:
            await changed(self.sclk)
            if level(self.sclk):
                self.rising()
            elif level(self.cs_n):
                self.report(TimingViolation("mode: SCLK runs while CS is high"))
            else:
                self.falling()

    def falling(self):
        if self.rose is not None and self.fell is not None:
            period = now() - self.fell
            self.least("t_sclk", period)
            self.least("t_sclk_low", (self.rose - self.fell) / period)
            self.least("t_sclk_high", (now() - self.rose) / period)
        self.fell = now()

    def rising(self):
        self.rose = now()
        self.bit += 1
        if not level(self.cs_n):
            self.show(self.limits.t_sclk_dout, self.limits.t_hold)

    def show(self, delay, hold):
        channel, bit = self.bit // 16, 15 - self.bit % 16
        for lane in range(self.lanes):
            value = self.results[(channel + 4 * lane) % 8] if channel < 8 else 0
            self.drive(lane, value >> bit & 1, delay, hold)
