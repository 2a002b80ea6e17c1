"""Twin of rtl/frontend/msn_scan_plan.sv: which place is converted in which clock.

Clocks count from the first clock in which the block is enabled.
"""

from dataclasses import dataclass

from meissner.twins.shared import LANES, fits, one_of

START = 4  # the first clock in which a line may be switched


@dataclass(frozen=True)
class Settings:
    """The registers of the block."""

    settle: int = 0  # clocks from switching the lines to convert start
    period: int = 0  # clocks from frame to frame; 0: back-to-back
    interleave: bool = False  # rows 0, 2, 4 .., then 1, 3, 5 ..


@dataclass(frozen=True)
class Conversion:
    switch: int  # clock of switch_o
    trigger: int  # clock of trigger_o
    first: bool  # the first of its frame
    row: int
    group: int


@dataclass(frozen=True)
class ScanPlan:
    """The parameters of msn_scan_plan; illegal ones raise ValueError."""

    rows: int = 16
    columns: int = 16
    lanes: int = 1
    channels: int = 8
    hold: int = 2
    cycle: int = 268
    settle_bits: int = 16
    period_bits: int = 32

    def __post_init__(self):
        fits(self, rows=(1, 1024), columns=(1, 1024), channels=(1, 8), hold=(2, None))
        fits(self, settle_bits=(1, 24), period_bits=(1, 32))
        one_of(LANES, lanes=self.lanes)
        fits(self, cycle=(self.channels + 8, None))

    @property
    def beats(self):
        """Beats of a row."""
        return -(-self.columns // self.lanes)

    @property
    def groups(self):
        """Conversions of a row."""
        return -(-self.beats // self.channels)

    def gap(self, settle):
        """Clocks from trigger_o to the next switch_o."""
        return max(self.hold, self.cycle - 1 - settle)

    def slot(self, settle):
        """Clocks from switch to switch, and from convert start to convert start."""
        return settle + 1 + self.gap(settle)

    def places(self, interleave=False):
        """(row, group) of a frame's conversions, in their order."""
        rows = range(self.rows)
        rows = [*rows[::2], *rows[1::2]] if interleave else rows
        return [(row, group) for row in rows for group in range(self.groups)]

    def frame_clocks(self, settle):
        """Clocks from a frame's first convert start to that of the next."""
        return self.rows * self.groups * self.slot(settle)

    def schedule(self, settings, clocks):
        """(conversions, overrun) up to clock ``clocks``, always enabled and with room for the samples."""
        slot, frame = self.slot(settings.settle), self.places(settings.interleave)
        conversions = []
        begin = START
        served = {START}  # ticks that begin a frame
        while begin < clocks:
            for at, (row, group) in enumerate(frame):
                switch = begin + at * slot
                conversions.append(Conversion(switch, switch + 1 + settings.settle, at == 0, row, group))
            begin = switch + slot
            if settings.period:
                # A tick up to two clocks after the last switch begins no frame: this one is not over yet.
                tick = START + ((switch + 2 - START) // settings.period + 1) * settings.period
                served.add(tick)
                begin = max(begin, tick)
        ticks = range(START, clocks, settings.period) if settings.period else ()
        overrun = sum(tick not in served for tick in ticks)
        return [c for c in conversions if c.switch < clocks], overrun
