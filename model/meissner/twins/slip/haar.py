"""Bit-exact twin of rtl/slip/msn_haar.sv: Haar wavelet detail and sum, unnormalised integers."""

import numpy as np

from meissner.twins.shared import Stream, one_of
from meissner.twins.slip.config import check_channels


def haar(x, level=1, mask=None):
    """Level-``level`` Haar detail and sum of each channel, exact.

        a0 = x;   d_l[k] = a_(l-1)[2k] - a_(l-1)[2k+1];   a_l[k] = a_(l-1)[2k] + a_(l-1)[2k+1]

    ``x``: integers [..., samples]. Returns (detail, total), int64 [..., samples // 2**level]; samples at
    the end that fill no group are not used. d_l is sqrt(2)**l times PyWavelets' cD of the same level
    with the same sign, a_l is sqrt(2)**l times cA; neither is ever rounded. ``level``: 1, 2 or 3.
    ``mask``: samples not to be trusted; their groups (``masked_groups``) give 0 and 0.
    """
    one_of((1, 2, 3), level=level)
    total = np.asarray(x, dtype=np.int64)
    for _ in range(level):
        pairs = total.shape[-1] // 2
        even, odd = total[..., 0 : 2 * pairs : 2], total[..., 1 : 2 * pairs : 2]
        detail, total = even - odd, even + odd
    if mask is not None:
        off = masked_groups(mask, level)
        detail, total = np.where(off, 0, detail), np.where(off, 0, total)
    return detail, total


def masked_groups(mask, level=1):
    """Whether any of a group's samples is masked: bool [..., samples // 2**level]."""
    mask = np.asarray(mask, dtype=bool)
    groups = mask.shape[-1] >> level
    return mask[..., : groups << level].reshape(*mask.shape[:-1], groups, 1 << level).any(axis=-1)


class Haar(Stream):
    """``haar`` in chunks: ``next`` takes [channels, n] samples and keeps those of an unfinished group."""

    def __init__(self, channels=1, level=1):
        haar(np.zeros(1), level)  # the same check of the level
        check_channels(channels)
        self.channels = channels
        self.level = level
        self.reset()

    def reset(self):
        """Forget the samples of an unfinished group."""
        self._rest = np.zeros((self.channels, 0), dtype=np.int64)

    def next(self, x):
        """Details and sums that the samples ``x`` [channels, n] complete."""
        x = np.concatenate([self._rest, np.asarray(x, dtype=np.int64)], axis=1)
        whole = x.shape[1] >> self.level << self.level
        self._rest = x[:, whole:]
        return haar(x[:, :whole], self.level)
