"""Bit-exact twin of rtl/frontend/msn_calibrate_taxels.sv: forces from an array's samples, a word a taxel."""

import numpy as np

from meissner.twins.common.round_sat import round_sat
from meissner.twins.frontend.calibration_table import CalibrationTable

LATENCY = 3  # clocks of the RTL from a beat in to its forces out


def forces(raw, offset, gain, gain_shift=12, mask=None, sample_bits=17, gain_bits=16):
    """Forces 0 .. 65535 of samples [..., rows, columns]; ``offset`` and ``gain``: of each taxel.

        F = clip(floor((raw - offset) gain / 2^gain_shift + 1/2), 0, 65535)

    ``mask``: taxels that give 0. ``gain_bits``: 16, or 32 for a row's gain times a column's.
    """
    if not 1 <= gain_shift <= gain_bits:
        raise ValueError(f"gain_shift = {gain_shift} must lie in 1 .. {gain_bits}")
    difference = np.asarray(raw, dtype=np.int64) - offset
    if mask is not None:
        difference = np.where(mask, 0, difference)
    product_bits = sample_bits + 1 + gain_bits + 1
    return round_sat(difference * gain, product_bits, 16, gain_shift, unsigned=True)


class CalibrateTaxels:
    """``forces`` with the tables: write and swap ``table``; ``next`` calibrates with the bank in use.

    All forces are 0 until the first swap.
    """

    table_of, gain_bits = CalibrationTable, 16

    def __init__(self, rows, columns, lanes=1, sample_bits=17, gain_shift=12, offset=True):
        if sample_bits + bool(offset) > 18:  # sample - offset must fit a multiplier's 18 bits
            raise ValueError(f"sample_bits = {sample_bits} must be at most {18 - bool(offset)}")
        self.table = self.table_of(rows, columns, lanes, sample_bits, offset)
        self.sample_bits, self.gain_shift = sample_bits, gain_shift
        forces(0, 0, 0, gain_shift, gain_bits=self.gain_bits)  # the same check of the shift
        self.reset()

    def reset(self):
        """The next beat should be the first of a frame; no table is in use."""
        self.table.reset()
        self._swapping = self._midway = False

    def swap(self):
        """Exchange the banks before the next frame's first beat."""
        self._swapping = True

    def next(self, raw, mask=None):
        """Forces of complete frames [..., rows, columns]."""
        self._take_up()
        offset, gain = (words[:, : self.table.columns] for words in self.table.words())
        if not self.table.loaded:
            gain = np.zeros_like(gain)
        return forces(raw, offset, gain, self.gain_shift, mask, self.sample_bits, self.gain_bits)

    def beat(self, raw, id_, last, mask=None):
        """Forces of one beat of ``lanes`` samples as FrameMarker passes it."""
        self._take_up()
        self._midway = not last
        offset, gain = (words.reshape(-1, self.table.lanes)[id_] for words in self.table.words())
        if not self.table.loaded:
            gain = np.zeros_like(gain)
        return forces(raw, offset, gain, self.gain_shift, mask, self.sample_bits, self.gain_bits)

    def process(self, raw, mask=None):
        """``reset``, put the written tables in use, then ``next``."""
        self.reset()
        self.swap()
        return self.next(raw, mask)

    def _take_up(self):
        if self._swapping and not self._midway:
            self.table.swap()
            self._swapping = False
