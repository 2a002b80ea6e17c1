"""Bit-exact twins of rtl/common/msn_delay.sv, msn_ram.sv and msn_sync.sv: values some steps later."""

import numpy as np

from meissner.twins.shared import Stream, within


class Delay(Stream):
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


LATENCY = 2


class Ram:
    """A word leaves with the second read after the one that asks for it; a word never written is 0."""

    def __init__(self, words, width=1):
        within(words=(words, 1, None), width=(width, 1, None))
        self.memory, self._held = [0] * words, [0] * LATENCY

    def clock(self, read=None, write=None):
        """A clock: ``read`` an address, ``write`` (address, value); the output after it."""
        if read is not None:
            self._held = [self._held[1], self.memory[read]]
        if write is not None:
            self.memory[write[0]] = write[1]
        return self._held[0]


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
