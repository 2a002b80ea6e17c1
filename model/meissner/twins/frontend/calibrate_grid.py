"""Bit-exact twin of rtl/frontend/msn_calibrate_grid.sv: forces from an array's samples, by row and column."""

from meissner.twins.frontend.calibrate_taxels import CalibrateTaxels
from meissner.twins.frontend.calibration_grid import CalibrationGrid

LATENCY = 15  # clocks of the RTL from a beat in to its forces out


class CalibrateGrid(CalibrateTaxels):
    """CalibrateTaxels with offset and gain of rows and columns.

    F = clip(floor((raw - offset) gain / 2^gain_shift + 1/2), 0, 65535)
    offset = row's + column's    gain = row's * column's
    """

    table_of, gain_bits = CalibrationGrid, 32

    def __init__(self, rows, columns, lanes=1, sample_bits=17, gain_shift=24, offset=True):
        super().__init__(rows, columns, lanes, sample_bits, gain_shift, offset)
