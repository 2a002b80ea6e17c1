"""Bit-exact twin of rtl/common/msn_compare.sv: signed comparison."""

import numpy as np


def compare(a, b, width):
    """True where a > b; ``a`` and ``b`` are integers of ``width`` signed bits."""
    if width < 1:
        raise ValueError(f"width = {width} must be at least 1")
    a, b = np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64)
    limit = 1 << (width - 1)
    for x in (a, b):
        if x.size and (x.min() < -limit or x.max() >= limit):
            raise ValueError(f"numbers must lie in {-limit} .. {limit - 1}")
    return a > b
