"""Bit-exact twin of rtl/frontend/msn_calibration_preset.sv: the writes to the tables after reset."""

from meissner.twins.shared import LANES, one_of

ROW_GAIN = 4096


def preset(rows, columns, lanes, gain, row_column=False):
    """(row, word, offset, gain) of every write, each to all lanes of its word; then the banks are swapped."""
    one_of(LANES, lanes=lanes)
    row_beats = -(-columns // lanes)
    if not row_column:
        return [(False, word, 0, gain) for word in range(rows * row_beats)]
    return [(False, word, 0, gain) for word in range(row_beats)] + [
        (True, row, 0, ROW_GAIN) for row in range(rows)
    ]
