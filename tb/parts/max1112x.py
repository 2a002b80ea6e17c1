"""Maxim MAX11123, MAX11124, MAX11125: 8 channels of 8, 10, 12 bits; MAX11131: 16 of 12 bits. Manual scan on
the external clock only.

What was taken from the data sheet and what only from memory: docs/adc.md.
"""

from dataclasses import dataclass

import cocotb

from parts.timing import PartModel, TimingViolation, changed, level, now

# Registers that must be written after power-up: the reset in mode control, configuration, unipolar, bipolar,
# range; each with the value that single-ended inputs against ground need.
SETUP = {0x0040, 0x8000, 0x8800, 0x9000, 0x9800}


@dataclass(frozen=True)
class Limits:
    """ns; docs/adc.md has the sources."""

    t_cp: float = 62.5  # SCLK period: 16 MHz
    t_cp_max: float = 6250  # 0.16 MHz: the sample droops below
    t_ch: float = 25  # SCLK high
    t_cl: float = 25
    t_css: float = 4  # CS falling to the first falling SCLK
    t_csw: float = 5  # CS high
    t_acq: float = 52  # from the end of a conversion, the last rising SCLK, to CS falling, which samples
    t_ds: float = 4  # DIN before rising SCLK
    t_dh: float = 1  # DIN after rising SCLK
    t_dot: float = 16.5  # falling SCLK to the next bit
    t_hold: float = 4  # DOUT stays after falling SCLK
    t_dod: float = 15  # CS rising to DOUT high impedance


# The MAX11131: 48 MHz.
FAST = Limits(t_cp=1e6 / 48_000, t_cp_max=1e6 / 480, t_ch=8.3, t_cl=8.3)


class Max1112x(PartModel):
    """``code(channel, time_ns)`` gives the raw code of ``bits`` bits.

    ``conversions`` keeps every sample taken: (channel or None before the first command, code, time). The
    first one of a frame answers the last command of the previous frame: a frame of n channels holds n + 1 of
    them.
    """

    def __init__(self, cs_n, sclk, mosi, miso, bits, code, limits=None, report=None, channels=8):
        super().__init__(limits or Limits(), report)
        self.cs_n, self.sclk, self.mosi, self.miso = cs_n, sclk, mosi, miso
        self.bits, self.channels = bits, channels
        self.code = code
        self.conversions = []
        self.words = []  # commands since power-up
        self.spoil = None  # if set, called with the answer; returns what is sent instead
        self.levels = 0
        self.rose = self.fell = self.cs_fell = self.cs_rose = self.mosi_moved = None
        self.received = []
        self.falls = 0
        self.answer = 0
        self.power_up()
        self.release(0, 1)
        for watch in (self.watch_cs, self.watch_sclk, self.watch_mosi):
            cocotb.start_soon(watch())

    def power_up(self):
        """Registers are undefined: no manual scan, no channel numbers."""
        self.words = []
        self.channel = None

    async def watch_cs(self):
        while True:
            await changed(self.cs_n)
            if level(self.cs_n) == 0:
                self.select()
            else:
                self.cs_rose = now()
                self.release(0, self.limits.t_dod)
                if len(self.received) == 16:
                    self.execute(int("".join(map(str, self.received)), 2))

    def select(self):
        if not level(self.sclk):
            self.report(TimingViolation("mode: SCLK is low as CS falls"))
        self.least("t_csw", self.since(self.cs_rose))
        self.least("t_acq", self.since(self.rose))
        self.cs_fell = now()
        self.received = []
        self.falls = 0
        self.rose = self.fell = None
        code = 0
        if self.channel is not None:
            code = self.take(self.channel, self.since(self.rose))
            assert 0 <= code < 1 << self.bits
        self.conversions.append((self.channel, code, now()))
        self.answer = (15 if self.channel is None else self.channel) << 12 | code << 12 - self.bits
        if self.spoil:
            self.answer = self.spoil(self.answer)

    def execute(self, word):
        self.words.append(word)
        if word >> 11 == 1:  # mode control, manual scan
            missing = SETUP - set(self.words)
            if missing:
                names = ", ".join(f"0x{each:04x}" for each in sorted(missing))
                self.report(TimingViolation(f"setup: a conversion was asked for before {names}"))
                return
            if word & 0x7B != 0:
                self.report(TimingViolation(f"setup: 0x{word:04x} resets, powers down or sets a spare bit"))
            self.channel = word >> 7 & 15 if word & 4 else None
            if (word >> 7 & 15) >= self.channels:
                self.report(TimingViolation("setup: a channel that the part does not have"))
        elif word not in SETUP:
            self.report(TimingViolation(f"setup: 0x{word:04x} is no setting that is known to be right"))
        else:
            self.channel = None

    async def watch_mosi(self):
        while True:
            await changed(self.mosi)
            self.mosi_moved = now()
            if level(self.cs_n) == 0 and self.received and len(self.received) < 16:
                self.least("t_dh", self.since(self.rose))

    async def watch_sclk(self):
        while True:
            await changed(self.sclk)
            if level(self.cs_n):
                if not level(self.sclk):  # an aborted word may end both at the same time
                    self.report(TimingViolation("mode: SCLK runs while CS is high"))
            elif level(self.sclk):
                self.rising()
            else:
                self.falling()

    def falling(self):
        if self.fell is None:
            self.least("t_css", self.since(self.cs_fell))
        else:
            self.least("t_ch", self.since(self.rose))
            self.least("t_cp", self.since(self.fell))
            self.most("t_cp_max", self.since(self.fell))
        self.fell = now()
        self.falls += 1
        level = self.answer >> (16 - self.falls) & 1 if self.falls <= 16 else 0
        self.drive(0, level, self.limits.t_dot, self.limits.t_hold)

    def rising(self):
        self.least("t_cl", self.since(self.fell))
        self.least("t_ds", self.since(self.mosi_moved))
        self.rose = now()
        if len(self.received) < 16:
            self.received.append(level(self.mosi))
        else:
            self.report(TimingViolation("mode: more than 16 SCLK periods"))
