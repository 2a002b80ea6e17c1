"""Bit-exact twin of rtl/frontend/msn_calibration_grid.sv: offset and gain of rows and of columns."""

import numpy as np

from meissner.twins.frontend.calibration_table import CalibrationTable


class CalibrationGrid(CalibrationTable):
    """CalibrationTable per row and column, for arrays too big for a word per taxel.

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
