"""SDR SDRAM of 4 banks, 8192 rows, 512 columns and 16 bits (a part with more columns: with A9 low).

One set of limits that suits IS42S16160G, MT48LC16M16, AS4C16M16 and AS4C32M16; docs/sdram.md has the sources.
"""

from collections import deque
from dataclasses import dataclass

import cocotb
import numpy as np
from cocotb.triggers import Timer

from parts.timing import PartModel, TimingViolation, changed, level, now

BANKS, ROWS, COLUMNS, BURST, CAS, REFRESHES = 4, 8192, 512, 4, 3, 8
MODE = 0x032  # bursts of four in order, CAS latency 3
MRS, REF, PRE, ACT, WRITE, READ, STOP, NOP = range(8)  # RAS, CAS, WE
NAMES = "MRS", "REF", "PRE", "ACT", "WRITE", "READ", "STOP", "NOP"


@dataclass(frozen=True)
class Limits:
    """ns; docs/sdram.md has the sources."""

    t_ck: float = 7.5
    t_power: float = 200_000  # power to the first command
    t_mrd: float = 15  # mode register set to the next command, and two clocks
    t_rcd: float = 21  # row opened to READ or WRITE
    t_rp: float = 21  # row closed to ACT, REF or MRS
    t_ras: float = 44  # row opened to closed
    t_ras_max: float = 100_000
    t_rc: float = 67.5  # ACT to ACT of one bank
    t_rrd: float = 15  # ACT to ACT of two banks
    t_rfc: float = 70  # REF to the next command
    t_wr: float = 20  # last word taken to row closed
    t_ref_max: float = 64e6  # all rows
    t_ac: float = 6.5  # given by the part: clock to the next word
    t_oh: float = 2.5  # given by the part: clock to the old word gone


class Bank:
    row = opened = closed = last_word = None
    closes = None  # the clock in which its automatic precharge begins


class Sdram(PartModel):
    """``pins``: an object with clk, cke, cs_n, ras_n, cas_n, we_n, ba, a, dqm, dq_o and dq_oe (of the master)
    and dq_i (to it). The part's clock rises when clk becomes ``rises``.

    ``round_ns``: from the master's edge to the part's clock and from the part's DQ to the master's, together:
    its words arrive so much later. ``rows``: those that are refreshed in t_ref_max.
    """

    def __init__(self, pins, limits=None, report=None, rises=0, round_ns=0.0, rows=ROWS):
        super().__init__(limits or Limits(), report)
        self.pins, self.rises, self.round_ns = pins, rises, round_ns
        self.memory = np.zeros((BANKS, ROWS, COLUMNS), np.uint16)
        self.banks = [Bank() for _ in range(BANKS)]
        self.clock, self.edge_at, self.began, self.power = 0, None, now(), None
        self.refreshes, self.mode, self.mode_clock = 0, None, None
        self.refreshed = deque([now()] * rows, rows)  # the last times; all rows were as the part started
        self.opened = self.refresh_at = self.mode_at = None
        self.burst_end = 0  # clock after the last burst
        self.due, self.quiet = {}, 0  # words by clock; the master drives nothing before the clock ``quiet``
        self.writing = None  # bank, column, word
        self.counts = dict.fromkeys(NAMES, 0)
        pins.dq_i.value = 0
        cocotb.start_soon(self.watch())

    def load(self, words, base=0):
        """Put 64-bit ``words`` at word address ``base``, as the controller places them."""
        beats = np.asarray(words, "<u8").view("<u2")
        self.memory.reshape(-1)[4 * base : 4 * base + len(beats)] = beats

    async def watch(self):
        while True:
            await changed(self.pins.clk)
            if level(self.pins.clk) == self.rises:
                self.edge()

    def rule(self, says):
        self.report(TimingViolation(f"rule: {says}"))

    def edge(self):
        self.clock += 1
        if self.edge_at is not None:
            self.least("t_ck", now() - self.edge_at)
        self.edge_at = now()
        if self.clock <= self.quiet and self.clock > self.quiet - BURST - 2 and level(self.pins.dq_oe):
            self.rule("both drive DQ")
        for bank in self.banks:
            if bank.closes == self.clock:
                self.close(bank, now())
        if self.due:
            self.send()
        if self.writing:
            self.take_word()
        if not level(self.pins.cs_n):
            self.command()

    def send(self):
        """The word of the next clock's edge leaves after this one."""
        word = self.due.pop(self.clock + 1, None)

        async def later():
            await Timer(round((self.limits.t_oh + self.round_ns) * 1000), "ps")
            self.pins.dq_i.value = self.noise.getrandbits(16)
            if word is not None:
                await Timer(round((self.limits.t_ac - self.limits.t_oh) * 1000), "ps")
                self.pins.dq_i.value = word

        cocotb.start_soon(later())

    def take_word(self):
        bank, column, number = self.writing
        if level(self.pins.dqm) or not level(self.pins.dq_oe):
            self.rule(f"word {number} of a WRITE is masked or not driven")
        where = column & ~3 | (column + number) & 3
        own = self.banks[bank]
        self.memory[bank, own.row, where] = level(self.pins.dq_o)
        own.last_word = now()
        self.writing = (bank, column, number + 1) if number + 1 < BURST else None
        if not self.writing and own.closes == 0:
            self.close(own, now() + self.limits.t_wr)

    def close(self, bank, moment):
        self.least("t_ras", moment - bank.opened)
        self.most("t_ras_max", moment - bank.opened)
        bank.row = bank.closes = bank.last_word = None
        bank.closed = moment

    def command(self):
        pins = self.pins
        which = level(pins.ras_n) << 2 | level(pins.cas_n) << 1 | level(pins.we_n)
        if which == NOP:
            return
        name, bank, a = NAMES[which], level(pins.ba), level(pins.a)
        self.counts[name] += 1
        if not level(pins.cke):
            self.rule(f"{name} with CKE low")
        if self.power is None:
            self.power = now()
            self.least("t_power", self.power - self.began)
        self.least("t_rfc", self.since(self.refresh_at))
        self.least("t_mrd", self.since(self.mode_at))
        if self.mode_at is not None and self.clock < self.mode_clock + 2:
            self.rule(f"{name} a clock after MRS")
        if self.mode is None and which in (ACT, READ, WRITE):
            self.rule(f"{name} before the mode register is set")
        getattr(self, f"do_{name.lower()}")(bank, a)

    def all_closed(self, name):
        for bank in self.banks:
            if bank.row is not None:
                self.rule(f"{name} with an open row")
            self.least("t_rp", self.since(bank.closed))

    def do_stop(self, bank, a):
        self.rule("STOP is not used")

    def do_mrs(self, bank, a):
        self.all_closed("MRS")
        if self.refreshes < REFRESHES:
            self.rule(f"MRS after {self.refreshes} REF of {REFRESHES}")
        if a | bank << 13 != MODE:
            self.rule(f"mode {a | bank << 13:#06x} is not {MODE:#05x}")
        self.mode, self.mode_at, self.mode_clock = a, now(), self.clock

    def do_ref(self, bank, a):
        self.all_closed("REF")
        self.most("t_ref_max", self.since(self.refreshed[0]))
        self.refreshed.append(now())
        self.refresh_at = now()
        self.refreshes += 1

    def do_pre(self, bank, a):
        for own in self.banks if a >> 10 & 1 else [self.banks[bank]]:
            if own.row is None:
                own.closed = own.closed or now()
                continue
            if self.clock < self.burst_end:
                self.rule("PRE cuts a burst")
            self.least("t_wr", self.since(own.last_word))
            self.close(own, now())

    def do_act(self, bank, a):
        own = self.banks[bank]
        if own.row is not None:
            self.rule(f"ACT of bank {bank}, which has row {own.row} open")
        self.most("t_ref_max", self.since(self.refreshed[0]))
        self.least("t_rp", self.since(own.closed))
        self.least("t_rc", self.since(own.opened))
        self.least("t_rrd", self.since(self.opened))
        own.row, own.closes, own.opened, self.opened = a, None, now(), now()

    def begin(self, name, bank, a):
        """Whether a burst can begin; its columns."""
        own = self.banks[bank]
        if own.row is None or own.closes is not None:
            self.rule(f"{name} of bank {bank}, which has no row open")
            return False
        if self.clock < self.burst_end:
            self.rule(f"{name} cuts a burst")
        if a >> 11 or a >> 9 & 1:
            self.rule(f"{name} of column {a:#06x}")
        if level(self.pins.dqm):
            self.rule(f"{name} with DQM high")
        self.least("t_rcd", self.since(own.opened))
        self.burst_end = self.clock + BURST
        return True

    def do_read(self, bank, a):
        if not self.begin("READ", bank, a):
            return
        own, column = self.banks[bank], a & 511
        for number in range(BURST):
            where = column & ~3 | (column + number) & 3
            self.due[self.clock + CAS + number] = int(self.memory[bank, own.row, where])
        self.due.setdefault(self.clock + CAS + BURST, None)  # lets go of DQ
        self.quiet = self.clock + CAS + BURST
        if a >> 10 & 1:
            own.closes = self.clock + BURST

    def do_write(self, bank, a):
        if not self.begin("WRITE", bank, a):
            return
        self.banks[bank].closes = 0 if a >> 10 & 1 else None
        self.writing = bank, a & 511, 0
        self.take_word()
