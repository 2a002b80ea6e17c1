"""Bit-exact twin of rtl/common/msn_delay.sv: a delay of a fixed number of steps."""

import numpy as np


class Delay:
    """out = in, ``depth`` steps ago. What comes out in the first ``depth`` steps is not defined."""

    def __init__(self, depth):
        if depth < 1:
            raise ValueError(f"depth = {depth} must be at least 1")
        self.depth = depth
        self.reset()

    def reset(self):
        """Forget the past; the undefined first outputs are 0 here."""
        self._past = np.zeros(self.depth, dtype=np.int64)

    def next(self, x):
        """The values of ``depth`` steps before each of ``x`` [n]."""
        line = np.concatenate([self._past, np.asarray(x, dtype=np.int64)])
        self._past = line[len(line) - self.depth :]
        return line[: len(line) - self.depth]

    def process(self, x):
        """``reset`` and then ``next``."""
        self.reset()
        return self.next(x)
