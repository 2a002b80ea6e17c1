"""Analog Devices AD7606C-16 in serial software mode: an AD7606 with registers and 1, 2, 4 or 8 DOUT lanes.

Each word has a CS frame of its own. What was taken from which source: docs/adc.md.
"""

from dataclasses import dataclass

import cocotb

from parts import ad7606
from parts.timing import TimingViolation, changed, level, now

RESET_VALUES = {2: 0x08, 3: 0x33, 4: 0x33, 5: 0x33, 6: 0x33, 7: 0x00}  # two lanes, +-10 V, 25 kHz
NEEDED = {3: 0x11, 4: 0x11, 5: 0x11, 6: 0x11, 7: 0xFF}  # +-5 V on every channel, 220 kHz


@dataclass(frozen=True)
class Limits(ad7606.Limits):
    """ns, at VDRIVE above 2.7 V; docs/adc.md has the sources."""

    t_cycle: float = 1000
    t_conv_min: float = 500
    t_conv_most: float = 650
    t_busy: float = 25
    t_convst_low: float = 10
    t_convst_high: float = 10
    t_sclk: float = 1e6 / 60_000
    t_cs_dout: float = 20
    t_sclk_dout: float = 20
    t_hold: float = 5
    t_reset: float = 3200
    t_reset_convst: float = 274_000  # RESET low to CONVST or to the first word
    t_csh: float = 22  # CS high between words
    t_css: float = 2  # CS falling to the first falling SCLK
    t_ds: float = 8  # SDI before falling SCLK
    t_dh: float = 3  # SDI after falling SCLK


class Ad7606c(ad7606.Ad7606):
    """``lanes``: DOUT lanes that the registers must ask for before a conversion; None: those of ``miso``."""

    def __init__(
        self,
        cs_n,
        sclk,
        mosi,
        miso,
        convst,
        busy,
        reset,
        code,
        limits=None,
        report=None,
        conversion_ns=None,
        lanes=None,
    ):
        self.mosi = mosi
        self.needed = NEEDED | {2: ((lanes or len(miso)).bit_length() - 1) << 3}
        self.mosi_moved = None
        self.received = []
        self.power_up()
        super().__init__(
            cs_n, sclk, miso, convst, busy, reset, code, limits or Limits(), report, conversion_ns
        )
        for watch in (self.watch_words, self.watch_mosi, self.watch_power):
            cocotb.start_soon(watch())

    def power_up(self):
        self.registers, self.writes = dict(RESET_VALUES), False  # writes: words are for registers
        self.word = 0  # of the conversion that is read
        self.words = []  # taken since the reset

    async def watch_power(self):
        while True:
            await changed(self.reset)
            if level(self.reset):
                self.power_up()

    def set_busy(self, level):
        self.word = self.word if level else 0
        super().set_busy(level)

    async def convert(self, token):
        wrong = {place: value for place, value in self.registers.items() if value != self.needed[place]}
        if wrong or self.writes:
            self.report(TimingViolation(f"setup: CONVST rises with {wrong}, registers {self.writes}"))
        await super().convert(token)

    async def watch_words(self):
        while True:
            await changed(self.cs_n)
            if level(self.cs_n) == 0:
                self.least("t_csh", self.since(self.cs_rose))
                self.least("t_reset_convst", self.since(self.reset_fell))
                self.cs_fell = now()
                self.received = []
                continue
            if len(self.received) == 16:
                self.execute(int("".join(map(str, self.received)), 2))
            elif not level(self.reset):
                self.report(TimingViolation(f"mode: a word of {len(self.received)} SCLK periods"))

    def execute(self, word):
        self.words.append(word)
        place, value = word >> 8 & 63, word & 255
        if not self.writes:
            self.word += 1
            self.writes = word >> 14 == 1
            if word and not self.writes:
                self.report(TimingViolation(f"setup: 0x{word:04x} is no read of a register"))
        elif word == 0:
            self.writes = False
        elif word >> 14 == 0 and self.needed.get(place) == value:
            self.registers[place] = value
        else:
            self.report(TimingViolation(f"setup: 0x{word:04x} is no setting that is known to be right"))

    async def watch_mosi(self):
        while True:
            await changed(self.mosi)
            self.mosi_moved = now()
            if level(self.cs_n) == 0 and self.received:
                self.least("t_dh", self.since(self.fell))

    def falling(self):
        if self.fell is None:
            self.least("t_css", self.since(self.cs_fell))
        super().falling()
        self.least("t_ds", self.since(self.mosi_moved))
        self.received.append(level(self.mosi))

    def show(self, delay, hold):
        wide = 1 << (self.registers[2] >> 3 & 3)
        each = 8 // wide
        for lane in range(self.lanes):
            sends = lane < wide and self.word < each and not self.writes and self.bit < 16
            value = self.results[self.word + each * lane] if sends else 0
            self.drive(lane, value << self.bit >> 15 & 1, delay, hold)
