"""Bit-exact twin of rtl/common/msn_sync.sv."""

import numpy as np

LATENCY = 2


class Sync:
    """out[n] = in[n-2]; what comes out in the first two clocks is whatever the flops held: here 0."""

    def __init__(self, width=1):
        if width < 1:
            raise ValueError(f"width = {width} must be at least 1")
        self.reset()

    def reset(self):
        self.held = [0] * LATENCY

    def next(self, x):
        """Clock in one value and return the one that comes out in the same clock."""
        self.held.append(int(x))
        return self.held.pop(0)

    def process(self, x):
        return np.array([self.next(value) for value in np.asarray(x)], dtype=np.int64)
