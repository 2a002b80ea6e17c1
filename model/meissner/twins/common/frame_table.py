"""Bit-exact twin of rtl/common/msn_frame_table.sv: one word per beat of a frame, in one or two banks."""

import numpy as np


class FrameTable:
    """``words`` words of ``parts`` parts per bank; read in order from ``start``, written at any place.

    Words that were never written are undefined in the RTL and 0 here.
    """

    def __init__(self, words, parts=1, banks=2, start=0):
        if words < 1:
            raise ValueError(f"words = {words} must be at least 1")
        if parts < 1:
            raise ValueError(f"parts = {parts} must be at least 1")
        if banks not in (1, 2):
            raise ValueError(f"banks = {banks} must be 1 or 2")
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
