"""Bit-exact twin of rtl/cop/msn_cop_divide.sv: centre of pressure from load and first moments."""

import numpy as np

from meissner.twins.common.divide import divide
from meissner.twins.cop.cop_accumulate import check_size
from meissner.twins.shared import within


def cop_divide(total, mx, my, rows, columns, fraction_bits=14, min_load=1):
    """x, y and whether they are valid, from each frame's S, Mx, My.

    x = Mx / ((n-1) S)     y = My / ((m-1) S)

    in Q2.fraction_bits, rounded to nearest, ties away from zero. Not valid, with x = y = 0, if S is 0 or
    below ``min_load``; a single column gives x = 0, a single row y = 0. Returns int32 x, int32 y, bool.
    """
    check_size(rows, columns)
    within(fraction_bits=(fraction_bits, 4, 20))
    total, mx, my = (np.asarray(value, dtype=np.int64) for value in (total, mx, my))
    pressed = (total > 0) & (total >= min_load)
    safe = np.where(total > 0, total, 1)
    x = divide(mx, (columns - 1) * safe, fraction_bits) if columns > 1 else np.zeros_like(mx)
    y = divide(my, (rows - 1) * safe, fraction_bits) if rows > 1 else np.zeros_like(my)
    return np.where(pressed, x, 0).astype(np.int32), np.where(pressed, y, 0).astype(np.int32), pressed
