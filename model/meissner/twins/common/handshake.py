"""Bit-exact twins of the blocks of rtl/common that change the timing of words and not their values:

skid    msn_skid.sv      every word leaves unchanged, in order
fifo    msn_fifo.sv      every entry leaves unchanged, in order
fork    msn_fork.sv      every word goes once to each of two followers
"""

import numpy as np

from meissner.twins.shared import within


def skid(x, width=16):
    """The words ``x`` of ``width`` bits, unchanged: the block only changes the timing of `ready`."""
    within(width=(width, 1, None))
    return np.asarray(x, dtype=np.int64).copy()


def fifo(entries, depth=16, width=8):
    """The entries that leave the FIFO."""
    if depth < 2 or depth & (depth - 1):
        raise ValueError(f"depth = {depth} must be a power of two, 2 or more")
    within(width=(width, 1, None))
    return [entry & (1 << width) - 1 for entry in entries]


def fork(words):
    """The words that each of the two followers gets, in order."""
    return list(words), list(words)
