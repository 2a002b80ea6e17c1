"""Bit-exact twin of rtl/actuate/msn_finger_health.sv: which fingers can be believed, from their samples."""

import numpy as np

MOST = 255  # samples in a row that are counted


class FingerHealth:
    """``low``, ``high``: codes from which on a sample is at the rail; ``rail``: samples in a row, 0: never.

    ``next`` goes on from where it was; ``fingers`` may be those of several hands side by side.
    """

    def __init__(self, fingers, low=0, high=4095, rail=8):
        if not 0 <= rail <= MOST:
            raise ValueError(f"rail = {rail} must lie in 0 .. {MOST}")
        self.low, self.high, self.rail = low, high, rail
        self.run = np.zeros(fingers, dtype=np.int64)

    def next(self, samples, lost=False):
        """Whether each finger was healthy all the time, from before ``samples`` [fingers, n] to their end.

        ``lost``: the converter did not give a frame in that time.
        """
        samples = np.asarray(samples)
        at_rail = (samples <= self.low) | (samples >= self.high)
        steps = np.arange(1, samples.shape[1] + 1)
        good = np.maximum.accumulate(np.where(at_rail, 0, steps), axis=1)  # the last good one, 0: none
        runs = steps - good + np.where(good == 0, self.run[:, None], 0)
        longest = np.maximum(self.run, runs.max(axis=1, initial=0))
        if samples.shape[1]:
            self.run = np.minimum(runs[:, -1], MOST)
        well = np.full(len(self.run), not lost)
        return well & (longest < self.rail) if self.rail else well
