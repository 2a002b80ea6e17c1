"""Bit-exact twin of rtl/common/msn_frame_filter.sv: passes frames, resynchronises on ``last``."""

from meissner.twins.shared import within


class FrameFilter:
    """Channels must count 0 .. channels-1 with ``last`` on the final one.

    From the first sample that breaks this, the rest of the frame is dropped, up to and including its
    ``last``, where the frame is counted as damaged. The next frame is marked ``restart``; so is the first
    frame after reset.
    """

    def __init__(self, channels):
        within(channels=(channels, 1, None))
        self.channels = channels
        self.reset()

    def reset(self):
        """The next sample should be channel 0 of a first frame."""
        self.damaged = 0
        self._expected, self._dropping, self._restart = 0, False, True

    def next(self, channel, last):
        """One sample; returns (kept, restart)."""
        fits = channel == self._expected and last == (channel == self.channels - 1)
        kept, restart = fits and not self._dropping, self._restart
        bad = self._dropping or not fits
        self.damaged += last and bad
        if last:
            self._expected, self._dropping, self._restart = 0, False, bad
        else:
            self._expected, self._dropping = self._expected + 1, bad
        return kept, restart

    def process(self, channels, lasts):
        """``reset`` and then ``next`` for each pair; returns two lists."""
        self.reset()
        pairs = [self.next(int(c), bool(e)) for c, e in zip(channels, lasts)]
        return [kept for kept, _ in pairs], [restart for _, restart in pairs]
