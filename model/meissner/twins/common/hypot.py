"""Bit-exact twin of rtl/common/msn_hypot.sv: magnitude of two unsigned integers."""

import numpy as np

from meissner.twins.shared import within


def latency(bits=24, exact=True):
    """Clocks from the numbers to their magnitude; also the shortest period between two."""
    within(bits=(bits, 1, 30))
    return 3 * bits + 1 if exact else 3


def hypot(a, b, exact=True):
    """floor(sqrt(a**2 + b**2)), or the estimate floor(max(8 M, 7 M + 4 m) / 8) of larger M and smaller m.

    ``a``, ``b``: integers 0 .. 2**30 - 1 of any shape. The estimate's error lies in -2.99 .. +0.78 %, minus
    the fraction that floor drops.
    """
    a, b = np.broadcast_arrays(np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64))
    if min(a.min(initial=0), b.min(initial=0)) < 0 or max(a.max(initial=0), b.max(initial=0)) >= 1 << 30:
        raise ValueError("the numbers must lie in 0 .. 2**30 - 1")
    if not exact:
        large, small = np.maximum(a, b), np.minimum(a, b)
        return np.maximum(8 * large, 7 * large + 4 * small) >> 3
    square = a * a + b * b
    root = np.sqrt(square.astype(float)).astype(np.int64)  # above 2**52 off by at most one
    root -= root * root > square
    return root + ((root + 1) ** 2 <= square)
