"""Bit-exact twin of rtl/common/msn_sync.sv."""

import numpy as np

from meissner.twins.shared import within

LATENCY = 2


class Sync:
    """out[n] = in[n-2]; in the first two clocks the output is what the flip-flops held: here 0."""

    def __init__(self, width=1):
        within(width=(width, 1, None))
        self.reset()

    def reset(self):
        self.held = [0] * LATENCY

    def next(self, x):
        """Clock in one value and return the output of the same clock."""
        self.held.append(int(x))
        return self.held.pop(0)

    def process(self, x):
        return np.array([self.next(value) for value in np.asarray(x)], dtype=np.int64)
