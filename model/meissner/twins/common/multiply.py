"""Bit-exact twin of rtl/common/msn_multiply.sv: a product."""

import numpy as np


def multiply(a, b, a_width=18, b_width=16):
    """Exact product of ``a``, signed integers of ``a_width`` bits, and ``b``, unsigned, ``b_width`` bits."""
    if not 2 <= a_width <= 18:
        raise ValueError(f"a_width = {a_width} must lie in 2 .. 18")
    if not 1 <= b_width <= 17:
        raise ValueError(f"b_width = {b_width} must lie in 1 .. 17")
    return np.asarray(a, dtype=np.int64) * np.asarray(b, dtype=np.int64)
