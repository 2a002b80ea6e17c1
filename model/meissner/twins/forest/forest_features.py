"""Bit-exact twin of rtl/forest/msn_forest_features.sv: differences of successive frames, in a window."""

import numpy as np

from meissner.twins.shared import Stream, within

MAX_CHANNELS, MAX_WINDOW = 4096, 256


class ForestFeatures(Stream):
    """d[n] = x[n] - x[n-1] of each channel; d[n-window+1] .. d[n], each of all channels, after frame n.

    ``next`` takes samples [channels, n] and returns features [m, window * channels]: a row for each frame
    that has ``window`` differences since ``reset``.
    """

    def __init__(self, channels=9, window=6, sample_bits=17):
        within(
            channels=(channels, 1, MAX_CHANNELS),
            window=(window, 1, MAX_WINDOW),
            sample_bits=(sample_bits, 2, None),
        )
        self.channels, self.window = channels, window
        self.reset()

    def reset(self):
        """Forget all frames."""
        self._kept = np.empty((self.channels, 0), np.int64)

    def next(self, x):
        """The features of the frames ``x`` [channels, n] that complete a window."""
        x = np.concatenate([self._kept, np.asarray(x, dtype=np.int64)], axis=1)
        self._kept = x[:, max(0, x.shape[1] - self.window) :]
        steps = np.diff(x).T
        count = max(0, len(steps) - self.window + 1)
        rows = np.arange(count)[:, None] + np.arange(self.window)
        return steps[rows].reshape(count, self.window * self.channels)
