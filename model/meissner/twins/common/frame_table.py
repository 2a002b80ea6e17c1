"""Bit-exact twin of rtl/common/msn_frame_table.sv: one word per beat of a frame, in one or two banks."""

import numpy as np

from meissner.twins.shared import one_of, within


class FrameTable:
    """``words`` words of ``parts`` parts per bank; read in order from ``start``, written at any place.

    Words that were never written are undefined in the RTL and 0 here.
    """

    def __init__(self, words, parts=1, banks=2, start=0):
        within(words=(words, 1, None), parts=(parts, 1, None))
        one_of((1, 2), banks=banks)
        if not 0 <= start < words:
            raise ValueError(f"start = {start} must be below words = {words}")
        self.start = start
        self._memory = np.zeros((banks, words, parts), dtype=np.int64)
        self.restart()

    def restart(self, bank=0):
        """Read from word ``start`` of ``bank`` next."""
        self._bank, self._at = bank, self.start

    def next(self, count):
        """The next ``count`` words [count, parts], wrapping around at the end of the bank."""
        words = self._memory.shape[1]
        at = (self._at + np.arange(count)) % words
        self._at = (self._at + count) % words
        return self._memory[self._bank, at]

    def write(self, bank, word, data, parts=slice(None)):
        """Write the ``parts`` of one word."""
        self._memory[bank, word, parts] = data
