"""Bit-exact twin of rtl/common/msn_skid.sv: what goes in comes out, in order."""

import numpy as np


def skid(x, width=16):
    """The words ``x`` of ``width`` bits, unchanged: only `ready` is different behind it."""
    if width < 1:
        raise ValueError(f"width = {width} must be at least 1")
    return np.asarray(x, dtype=np.int64).copy()
