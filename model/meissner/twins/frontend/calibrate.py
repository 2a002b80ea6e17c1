"""Bit-exact twins of rtl/frontend/msn_calibrate.sv, msn_taxel_table.sv and msn_grid_table.sv: forces from an
array's samples, by taxel or by row and column."""

import numpy as np

from meissner.twins.common.arithmetic import round_sat
from meissner.twins.shared import LANES, one_of, within

ROW_GAIN = 4096  # of every row before the first swap


def check_array(rows, columns, lanes, sample_bits):
    """Raise ValueError for a size at which no stage of an array elaborates."""
    within(rows=(rows, 1, 1024), columns=(columns, 1, 1024))
    one_of(LANES, lanes=lanes)
    within(sample_bits=(sample_bits, 2, 18))


class TaxelTable:
    """Offset and gain of each taxel.

    A write goes to the bank that is not in use; ``swap`` exchanges the two. Before the first one every offset
    is 0 and every gain ``preset``. A word is a beat of ``lanes`` columns. Offsets have ``offset_bits``
    signed bits, gains 16 unsigned. ``offset`` False: all offsets are 0.
    """

    row_column = False

    def __init__(self, rows, columns, lanes=1, sample_bits=17, offset=True):
        check_array(rows, columns, lanes, sample_bits)
        self.rows, self.columns, self.lanes, self.preset = rows, columns, lanes, 0
        self.row_beats = -(-columns // lanes)
        self.offset, self.offset_bits = offset, sample_bits - self.row_column
        self.beats = self.row_beats if self.row_column else rows * self.row_beats  # words for ``write``
        self._beats = np.zeros((2, 2, self.beats, lanes), dtype=np.int64)  # bank; offset, gain; word; lane
        self.reset()

    def reset(self):
        """Back to the first bank, which counts as empty; written words stay in memory."""
        self.loaded, self._bank, self._words = False, 0, None

    def write(self, word, offset, gain, lanes=slice(None)):
        """Write ``lanes`` of one word."""
        for part, value in enumerate(self._entry(offset, gain)):
            self._beats[1 - self._bank, part, word, lanes] = value

    def put(self, of_row, word, lanes, offset, gain):
        """Write a row's entry or ``lanes`` of a word; nothing if there is no such row or word."""
        if word >= (self.rows if of_row else self.beats):
            return
        if of_row:
            self.write_row(word, offset, gain)
        else:
            self.write(word, offset, gain, lanes)

    def swap(self):
        """Put the written bank in use. The RTL does this before the first beat of the next frame."""
        self.loaded, self._bank, self._words = True, 1 - self._bank, None

    def words(self):
        """Offsets and gains in use, each [rows, row_beats * lanes]."""
        if not self.loaded:
            offsets = np.zeros((self.rows, self.row_beats * self.lanes), dtype=np.int64)
            return offsets, offsets + self.preset * (ROW_GAIN if self.row_column else 1)
        if self._words is None:  # cached: writes go to the other bank
            self._words = self._in_use()
        return self._words

    def _in_use(self):
        return tuple(self._beats[self._bank].reshape(2, self.rows, -1).copy())

    def _entry(self, offset, gain):
        limit = 1 << (self.offset_bits - 1)
        if not -limit <= offset < limit:
            raise ValueError(f"offset = {offset} must fit {self.offset_bits} signed bits")
        within(gain=(gain, 0, (1 << 16) - 1))
        return (int(offset) if self.offset else 0), int(gain)


class GridTable(TaxelTable):
    """TaxelTable per row and column, for arrays too big for a word per taxel.

        offset = row's + column's    gain = row's * column's, exact

    ``write`` addresses the beats of a row, ``write_row`` the rows. Offsets have one bit less than samples, so
    that the sum of two fits a sample's bits.
    """

    row_column = True

    def __init__(self, rows, columns, lanes=1, sample_bits=17, offset=True):
        self._rows = np.zeros((2, 2, max(rows, 1), 1), dtype=np.int64)  # bank; offset, gain; row
        super().__init__(rows, columns, lanes, sample_bits, offset)

    def write_row(self, row, offset, gain):
        """Write one row's offset and gain."""
        self._rows[1 - self._bank, :, row, 0] = self._entry(offset, gain)

    def _in_use(self):
        of_row, of_column = self._rows[self._bank], self._beats[self._bank].reshape(2, 1, -1)
        return of_row[0] + of_column[0], of_row[1] * of_column[1]


def latency(row_column=False):
    """Clocks of the RTL from a beat in to its forces out."""
    return 15 if row_column else 3


def forces(raw, offset, gain, gain_shift=12, mask=None, sample_bits=17, gain_bits=16):
    """Forces 0 .. 65535 of samples [..., rows, columns]; ``offset`` and ``gain``: of each taxel.

        F = clip(floor((raw - offset) gain / 2^gain_shift + 1/2), 0, 65535)

    ``mask``: taxels that give 0. ``gain_bits``: 16, or 32 for a row's gain times a column's.
    """
    within(gain_shift=(gain_shift, 1, gain_bits))
    difference = np.asarray(raw, dtype=np.int64) - offset
    if mask is not None:
        difference = np.where(mask, 0, difference)
    product_bits = sample_bits + 1 + gain_bits + 1
    return round_sat(difference * gain, product_bits, 16, gain_shift, unsigned=True)


class Calibrate:
    """``forces`` with the tables: write and swap ``table``; ``next`` calibrates with the bank in use.

    ``row_column``: offset and gain of rows and columns.
    """

    def __init__(
        self, rows, columns, lanes=1, sample_bits=17, row_column=False, offset=True, gain_shift=None
    ):
        if sample_bits + bool(offset) > 18:  # sample - offset must fit a multiplier's 18 bits
            raise ValueError(f"sample_bits = {sample_bits} must be at most {18 - bool(offset)}")
        self.table = (GridTable if row_column else TaxelTable)(rows, columns, lanes, sample_bits, offset)
        self.gain_bits, gain_one = (32, 24) if row_column else (16, 12)
        self.sample_bits, self.gain_shift = sample_bits, gain_one if gain_shift is None else gain_shift
        forces(0, 0, 0, self.gain_shift, gain_bits=self.gain_bits)  # the same check of the shift
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
        return self._forces(raw, mask, lambda words: words[:, : self.table.columns])

    def beat(self, raw, id_, last, mask=None):
        """Forces of one beat of ``lanes`` samples as FrameMarker passes it."""
        found = self._forces(raw, mask, lambda words: words.reshape(-1, self.table.lanes)[id_])
        self._midway = not last
        return found

    def process(self, raw, mask=None):
        """``reset``, put the written tables in use, then ``next``."""
        self.reset()
        self.swap()
        return self.next(raw, mask)

    def _forces(self, raw, mask, part):
        if self._swapping and not self._midway:
            self.table.swap()
            self._swapping = False
        offset, gain = map(part, self.table.words())
        return forces(raw, offset, gain, self.gain_shift, mask, self.sample_bits, self.gain_bits)
