"""Bit-exact twin of rtl/cop/msn_cop.sv: centre of pressure and load of frames of forces."""

import numpy as np

from meissner.twins.common.divide import steps
from meissner.twins.cop.cop_accumulate import moments
from meissner.twins.cop.cop_divide import cop_divide


def cop(forces, fraction_bits=14, min_load=1):
    """x, y, load and whether x and y are valid, per frame; ``forces``: 0 .. 65535 [..., rows, columns]."""
    total, mx, my = moments(forces)
    rows, columns = np.shape(forces)[-2:]
    x, y, pressed = cop_divide(total, mx, my, rows, columns, fraction_bits, min_load)
    return x, y, total, pressed


def latency(lanes=1, fraction_bits=14, bits_per_clock=2):
    """Clocks of the RTL from a frame's last beat to its centre of pressure, the same for every frame."""
    return 3 + (lanes.bit_length() - 1) + steps(fraction_bits, bits_per_clock)
