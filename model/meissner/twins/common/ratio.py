"""Bit-exact twin of rtl/common/msn_ratio.sv: a scaled quotient, saturated at +-1.0, rounded once."""

import numpy as np

from meissner.twins.common.divide import divide
from meissner.twins.shared import within

BITS = {"scale_bits": (1, 32), "num_bits": (2, 32), "den_bits": (2, 62)}


def check_bits(**bits):
    """Raise ValueError unless the RTL can be built with these widths."""
    within(**{name: (value, *BITS[name]) for name, value in bits.items()})


def ratio(scale, num, den, fraction_bits=14):
    """``scale num / den`` in Q2.fraction_bits, saturated at +-1.0, nearest, ties away from zero: int64.

    ``den`` <= 0 gives the sign of ``scale num``, as +-1.0 (0 if that is 0). ``scale`` >= 0.
    """
    if np.min(scale) < 0:
        raise ValueError("the scale must not be negative")
    num, den = np.broadcast_arrays(np.asarray(num, dtype=np.int64), np.asarray(den, dtype=np.int64))
    product = np.asarray(scale, dtype=np.int64) * num
    inside = (product < den) & (product >= -den)
    return divide(np.where(inside, product, np.sign(product)), np.where(inside, den, 1), fraction_bits)
