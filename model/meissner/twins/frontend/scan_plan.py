"""Twin of rtl/frontend/msn_scan_plan.sv: which place is converted in which clock.

Clocks count from the first one in which the block is enabled (and was off before).
"""

from dataclasses import dataclass
from itertools import count

from meissner.twins.frontend.scan_walk import WHOLE, Region, places

START = 4  # the first clock in which a line may be switched


@dataclass(frozen=True)
class Settings:
    """The registers of the block."""

    settle: int = 0  # clocks from the lines to convert start
    period: int = 0  # clocks from frame to frame; 0: one after the other
    interleave: bool = False  # rows 0, 2, 4 .., then 1, 3, 5 ..
    region: Region = WHOLE
    slip_period: int = 0  # clocks from round to round; 0: none
    slip_places: tuple = ((0, 0),)  # (row, group) of each slot; a row past the array: none is driven


@dataclass(frozen=True)
class Conversion:
    switch: int  # clock of switch_o
    trigger: int  # clock of trigger_o
    slip: bool
    first: bool  # of its frame or round
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
    slip_slots: int = 1
    settle_bits: int = 16
    period_bits: int = 32
    group_bits: int | None = None  # None: as many as the array needs

    def __post_init__(self):
        for name, low, high in (
            ("rows", 1, 1024),
            ("columns", 1, 1024),
            ("channels", 1, 8),
            ("hold", 2, None),
            ("slip_slots", 1, 16),
            ("settle_bits", 1, 24),
            ("period_bits", 1, 32),
        ):
            value = getattr(self, name)
            if value < low or (high is not None and value > high):
                raise ValueError(f"{name} = {value} must lie in {low} .. {high}")
        if self.lanes not in (1, 2, 4, 8):
            raise ValueError(f"lanes = {self.lanes} must be 1, 2, 4 or 8")
        if self.groups > 1 and self.channels not in (1, 2, 4, 8):
            raise ValueError(f"channels = {self.channels} must be 1, 2, 4 or 8 with {self.groups} groups")
        if self.cycle < self.channels + 8:
            raise ValueError(f"cycle = {self.cycle} must be at least channels + 8")
        needed = max(1, (self.groups - 1).bit_length())
        if self.group_bits is None:
            object.__setattr__(self, "group_bits", needed)
        if self.group_bits < needed:
            raise ValueError(f"group_bits = {self.group_bits} must number {self.groups} groups")

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

    def beat_range(self, region):
        """First and last beat of each row of the region."""
        return region.beats(self.rows, self.columns, self.lanes)

    def places(self, region=WHOLE, interleave=False):
        """(row, group) of a frame's conversions, in their order."""
        return places(self.rows, self.columns, self.lanes, self.channels, region, interleave)

    def frame_clocks(self, settle, region=WHOLE):
        """Clocks from a frame's first convert start to that of the next, without slip rounds."""
        return len(self.places(region)) * self.slot(settle)

    def schedule(self, settings, clocks):
        """(conversions, overrun, slip_overrun) up to clock ``clocks``, enabled throughout, room always."""
        slot = self.slot(settings.settle)
        frame = self.places(settings.region, settings.interleave)
        conversions = []

        def convert(clock, slip, first, row, group):
            conversions.append(Conversion(clock, clock + 1 + settings.settle, slip, first, row, group))
            return clock + slot

        slip_overrun = 0
        dues = count(START, settings.slip_period) if settings.slip_period else iter([float("inf")])
        due = next(dues)
        free = START
        left = []  # places of the frame under way
        tick, served = START, 1  # the tick that begins the next frame, and how many have or will
        while free < clocks:
            while due < free:  # not on its grid: left out
                slip_overrun += 1
                due = next(dues)
            start = free if left else max(free, tick)
            if start < due and start + slot <= due:
                first = not left
                left = left or list(frame)
                free = convert(start, False, first, *left.pop(0))
                if not left and settings.period:
                    # Ticks up to two clocks after the last switch found the frame under way or still wanted.
                    tick = START + ((start + 2 - START) // settings.period + 1) * settings.period
                    served += 1
            else:
                free = due
                for index, place in enumerate(settings.slip_places):
                    free = convert(free, True, index == 0, *place)
                due = next(dues)
        while due < min(free, clocks):
            slip_overrun += 1
            due = next(dues)
        ticks = -(-(clocks - START) // settings.period) if settings.period else 0
        overrun = max(0, ticks - (served - (tick >= clocks))) if settings.period else 0
        return [c for c in conversions if c.switch < clocks], overrun, slip_overrun
