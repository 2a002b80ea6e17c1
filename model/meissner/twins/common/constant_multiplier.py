"""Bit-exact twin of rtl/common/msn_constant_multiplier.sv: product with a constant."""

import numpy as np


def constant_multiplier(x, constant):
    """``constant * x``, exact; ``constant``: 0 .. 65535."""
    if not 0 <= constant < 65536:
        raise ValueError(f"constant = {constant} must be below 65536")
    return np.asarray(x, dtype=np.int64) * constant
