"""Bit-exact twins of the blocks of rtl/common that change the timing of words and not their values:

skid               msn_skid.sv               every word leaves unchanged, in order
fifo               msn_fifo.sv               every entry leaves unchanged, in order
fork               msn_fork.sv               every word goes once to each of two followers
width_converter    msn_width_converter.sv    beats of parallel lanes to a sequence of taxels
"""

import numpy as np

from meissner.twins.shared import LANES, one_of, within


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


def width_converter(beats, columns, lanes):
    """(data, id, last) of every taxel; ``beats``: (lane values, last of the row, last of the frame) each."""
    one_of(LANES, lanes=lanes)
    within(columns=(columns, 1, 1024))
    found, channel = [], 0
    for values, row_last, last in beats:
        kept = list(values)[: (columns - 1) % lanes + 1 if row_last else lanes]
        for place, value in enumerate(kept):
            final = bool(last) and place == len(kept) - 1
            found.append((value, channel, final))
            channel = 0 if final else channel + 1
    return found
