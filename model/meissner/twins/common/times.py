"""Bit-exact twin of rtl/common/msn_times.sv: product with a constant."""

import numpy as np


def times(x, constant):
    """``constant * x``, exact; ``constant``: 0 .. 65535."""
    if not 0 <= constant < 65536:
        raise ValueError(f"constant = {constant} must be below 65536")
    return np.asarray(x, dtype=np.int64) * constant
