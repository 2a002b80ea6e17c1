"""Microchip MCP3208: 12 bits, 8 channels, single-ended reads only (data sheet DS21298)."""

from dataclasses import dataclass

import cocotb

from parts.timing import PartModel, TimingViolation, changed, level, now


@dataclass(frozen=True)
class Limits:
    """ns, at VDD = 5 V; docs/adc.md has the sources."""

    t_clk: float = 500  # 2.0 MHz
    t_hi: float = 250
    t_lo: float = 250
    t_sucs: float = 100  # CS falling to the first rising CLK
    t_csh: float = 500  # CS high between conversions
    t_su: float = 50  # DIN before rising CLK
    t_hd: float = 50  # DIN after rising CLK
    t_do: float = 200  # falling CLK to DOUT
    t_dis: float = 100  # CS rising to DOUT high impedance
    t_droop_max: float = 1.2e6  # from the end of sampling to the last bit


class Mcp3208(PartModel):
    """``code(channel, time_ns)`` gives the raw code; every conversion is kept in ``conversions``."""

    def __init__(self, cs_n, sclk, mosi, miso, code, limits=None, report=None):
        super().__init__(limits or Limits(), report)
        self.cs_n, self.sclk, self.mosi, self.miso = cs_n, sclk, mosi, miso
        self.code = code
        self.conversions = []  # (channel, code, time)
        self.levels = 0
        self.rose = self.fell = self.cs_fell = self.cs_rose = self.mosi_moved = self.sampled = None
        self.clear()
        self.release(0, 1)
        for watch in (self.watch_cs, self.watch_sclk, self.watch_mosi):
            cocotb.start_soon(watch())

    def clear(self):
        self.command = []  # bits from the start bit on
        self.falls = 0  # falling CLK edges since the start bit
        self.first = True

    async def watch_cs(self):
        while True:
            await changed(self.cs_n)
            if level(self.cs_n) == 0:
                self.least("t_csh", self.since(self.cs_rose))
                self.cs_fell = now()
                self.clear()
                if level(self.sclk):
                    self.report(TimingViolation("mode: CLK is high as CS falls"))
            else:
                self.cs_rose = now()
                self.release(0, self.limits.t_dis)

    async def watch_mosi(self):
        while True:
            await changed(self.mosi)
            self.mosi_moved = now()
            if level(self.cs_n) == 0 and not self.first and len(self.command) <= 5 and self.falls < 5:
                self.least("t_hd", self.since(self.rose))

    async def watch_sclk(self):
        while True:
            await changed(self.sclk)
            if level(self.sclk):
                self.rising()
            else:
                self.falling()

    def rising(self):
        if level(self.cs_n):
            self.report(TimingViolation("mode: CLK runs while CS is high"))
        if self.first:
            self.least("t_sucs", self.since(self.cs_fell))
        else:
            self.least("t_lo", self.since(self.fell))
            self.least("t_clk", self.since(self.rose))
        self.first = False
        self.rose = now()
        bit = level(self.mosi)
        if len(self.command) < 5 and (self.command or bit):
            self.least("t_su", self.since(self.mosi_moved))
            self.command.append(bit)
            self.opened = now()  # with the last bit of the command the capacitor is connected
            if len(self.command) == 2 and not bit:
                self.report(TimingViolation("command: differential"))

    def falling(self):
        self.fell = now()
        if level(self.cs_n):  # CLK falls at the end of the frame: no rule applies
            return
        self.least("t_hi", self.since(self.rose))
        if not self.command:
            return
        self.falls += 1
        if self.falls == 6:  # sampling ends, the null bit is sent
            channel = self.command[2] << 2 | self.command[3] << 1 | self.command[4]
            self.sampled = now()
            self.value = self.take(channel, self.since(self.opened))
            assert 0 <= self.value < 4096
            self.conversions.append((channel, self.value, self.sampled))
            self.drive(0, 0, self.limits.t_do)
        elif 7 <= self.falls <= 18:
            self.drive(0, self.value >> (18 - self.falls) & 1, self.limits.t_do)
            if self.falls == 18:
                self.most("t_droop_max", self.since(self.sampled))
