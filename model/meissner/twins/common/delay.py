"""Bit-exact twin of rtl/common/msn_delay.sv: a delay of a fixed number of steps."""

import numpy as np

from meissner.twins.shared import within


class Delay:
    """out = in, ``depth`` steps ago. The outputs of the first ``depth`` steps are undefined."""

    def __init__(self, depth):
        within(depth=(depth, 1, None))
        self.depth = depth
        self.reset()

    def reset(self):
        """Forget the past; here the undefined first outputs are 0."""
        self._past = np.zeros(self.depth, dtype=np.int64)

    def next(self, x):
        """For each of ``x`` [n], the value ``depth`` steps before it."""
        line = np.concatenate([self._past, np.asarray(x, dtype=np.int64)])
        self._past = line[len(line) - self.depth :]
        return line[: len(line) - self.depth]

    def process(self, x):
        """``reset`` and then ``next``."""
        self.reset()
        return self.next(x)
