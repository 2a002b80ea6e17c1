"""Bit-exact twin of rtl/frontend/msn_calibration_table.sv: offset and gain of every taxel, in two banks."""

import numpy as np


def check_array(rows, columns, lanes, sample_bits):
    """Raise ValueError for a size at which no stage of an array elaborates."""
    if not 1 <= rows <= 1024:
        raise ValueError(f"rows = {rows} must lie in 1 .. 1024")
    if not 1 <= columns <= 1024:
        raise ValueError(f"columns = {columns} must lie in 1 .. 1024")
    if lanes not in (1, 2, 4, 8):
        raise ValueError(f"lanes = {lanes} must be 1, 2, 4 or 8")
    if not 2 <= sample_bits <= 18:
        raise ValueError(f"sample_bits = {sample_bits} must lie in 2 .. 18")


class CalibrationTable:
    """Offset and gain of each taxel.

    A write goes to the bank that is not in use; ``swap`` exchanges the two. A word is a beat of ``lanes``
    columns. Offsets have ``offset_bits`` signed bits, gains 16 unsigned. ``offset`` False: all offsets are 0.
    """

    row_column = False

    def __init__(self, rows, columns, lanes=1, sample_bits=17, offset=True):
        check_array(rows, columns, lanes, sample_bits)
        self.rows, self.columns, self.lanes = rows, columns, lanes
        self.row_beats = -(-columns // lanes)
        self.offset, self.offset_bits = offset, sample_bits - self.row_column
        words = self.row_beats if self.row_column else rows * self.row_beats
        self._beats = np.zeros((2, 2, words, lanes), dtype=np.int64)  # bank; offset, gain; word; lane
        self.reset()

    def reset(self):
        """Back to the first bank, which counts as empty; written words stay in memory."""
        self.loaded, self._bank, self._words = False, 0, None

    def write(self, word, offset, gain, lanes=slice(None)):
        """Write ``lanes`` of one word."""
        for part, value in enumerate(self._entry(offset, gain)):
            self._beats[1 - self._bank, part, word, lanes] = value

    def swap(self):
        """Put the written bank in use. The RTL does this before the first beat of the next frame."""
        self.loaded, self._bank, self._words = True, 1 - self._bank, None

    def words(self):
        """Offsets and gains in use, each [rows, row_beats * lanes]."""
        if self._words is None:  # cached: writes go to the other bank
            self._words = self._in_use()
        return self._words

    def _in_use(self):
        return tuple(self._beats[self._bank].reshape(2, self.rows, -1).copy())

    def _entry(self, offset, gain):
        limit = 1 << (self.offset_bits - 1)
        if not -limit <= offset < limit:
            raise ValueError(f"offset = {offset} must fit {self.offset_bits} signed bits")
        if not 0 <= gain < 1 << 16:
            raise ValueError(f"gain = {gain} must lie in 0 .. 65535")
        return (int(offset) if self.offset else 0), int(gain)
