"""Bit-exact twin of rtl/actuate/msn_finger_health.sv: which fingers have samples that can be trusted."""

import numpy as np

from meissner.twins.shared import within

MOST = 255  # the count of consecutive samples saturates here


class FingerHealth:
    """A finger with ``rail`` consecutive samples at a rail (<= ``low`` or >= ``high``) is not healthy.

    ``rail`` = 0 disables the check. ``next`` continues where the last call ended; ``fingers`` may count the
    fingers of several hands side by side.
    """

    def __init__(self, fingers, low=0, high=4095, rail=8):
        within(rail=(rail, 0, MOST))
        self.low, self.high, self.rail = low, high, rail
        self.run = np.zeros(fingers, dtype=np.int64)

    def next(self, samples, lost=False):
        """Whether each finger was healthy from before ``samples`` [fingers, n] to their end: bool [fingers].

        ``lost``: the converter missed a frame in that time.
        """
        samples = np.asarray(samples)
        at_rail = (samples <= self.low) | (samples >= self.high)
        steps = np.arange(1, samples.shape[1] + 1)
        good = np.maximum.accumulate(np.where(at_rail, 0, steps), axis=1)  # last good one's place, 0: none
        runs = steps - good + np.where(good == 0, self.run[:, None], 0)
        longest = np.maximum(self.run, runs.max(axis=1, initial=0))
        if samples.shape[1]:
            self.run = np.minimum(runs[:, -1], MOST)
        well = np.full(len(self.run), not lost)
        return well & (longest < self.rail) if self.rail else well
