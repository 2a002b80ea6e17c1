"""Twin of rtl/frontend/msn_scan.sv: taxels to beats, and the latencies in clocks.

A frame is an array of samples [rows, columns]; a beat is Lanes adjacent samples. scan_plan.py gives the order
and the time of the conversions.
"""

from dataclasses import dataclass

import numpy as np

from meissner.twins.frontend import scan_buffer
from meissner.twins.frontend.scan_buffer import ScanBuffer
from meissner.twins.frontend.scan_plan import ScanPlan
from meissner.twins.shared import fits

PIN_CLOCKS = 1  # from trigger_o to the converter's pin
LATENCY = 2 + scan_buffer.LATENCY  # clocks from the last lane's sample to the beat at the output


@dataclass(frozen=True)
class Scan(ScanPlan):
    """The parameters of msn_scan; illegal ones raise ValueError."""

    sample_bits: int = 17
    depth: int | None = None
    overlap: int = 0  # clocks after a trigger in which the conversion before still sends

    def __post_init__(self):
        super().__post_init__()
        fits(self, sample_bits=(2, None))
        if self.overlap == 1 or not 0 <= self.overlap < self.cycle:
            raise ValueError(f"overlap = {self.overlap} must be 0 or lie in 2 .. {self.cycle - 1}")
        width = self.lanes * (self.sample_bits + 1)
        buffer = ScanBuffer(self.rows, self.beats, self.channels, width, self.depth)
        object.__setattr__(self, "buffer", buffer)

    def column(self, group, channel, lane):
        """The column at input ``channel`` of lane ``lane`` in ``group``; it may lie outside the array."""
        return (group * self.channels + channel) * self.lanes + lane

    def frame(self, samples, over):
        """The beats of a frame: (data, id, last, user), data and user packed as on the ports.

        ``samples`` int [rows, columns], ``over`` bool [rows, columns]. Lanes past the last column are 0 here;
        the block sends whatever their converters see, which has no meaning.
        """
        samples, over = np.asarray(samples, dtype=np.int64), np.asarray(over, dtype=bool)
        if samples.shape != (self.rows, self.columns) or over.shape != samples.shape:
            raise ValueError(f"a frame is [{self.rows}, {self.columns}], not {list(samples.shape)}")
        beats = []
        for row in range(self.rows):
            for beat in range(self.beats):
                columns = range(beat * self.lanes, min((beat + 1) * self.lanes, self.columns))
                mask = (1 << self.sample_bits) - 1
                data = sum(
                    (int(samples[row, c]) & mask) << lane * self.sample_bits for lane, c in enumerate(columns)
                )
                user = sum(int(over[row, c]) << lane for lane, c in enumerate(columns))
                beats.append(
                    (data, row * self.beats + beat, (row, beat) == (self.rows - 1, self.beats - 1), user)
                )
        return beats

    def coordinates(self, index):
        """(row, first column) of a beat's id."""
        return index // self.beats, index % self.beats * self.lanes
