"""Bit-exact twin of rtl/slip/msn_slip_serial.sv: the complete slip path of one channel."""

import numpy as np

from meissner.twins.common.frames import FrameFilter
from meissner.twins.shared import Stream, fits, one_of, within
from meissner.twins.slip.config import register_limits
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import Slip, State


class SlipSerial(Stream):
    """FrameFilter, Haar, PeakToPeak with tumbling windows and Slip of one channel, in this order.

        d = x[2k] - x[2k+1]   p2p = max d - min d of the window so far   the states as in Slip

    ``config``: meissner.twins.slip.config.SlipConfig, whose values must fit the block's registers of
    ``sample_bits`` + level and ``timer_bits`` bits. ``digit``: bits processed per clock, 1 or 2.
    """

    def __init__(self, config, sample_bits=17, timer_bits=14, digit=2):
        within(sample_bits=(sample_bits, 2, None), timer_bits=(timer_bits, 1, 31))
        one_of((1, 2), digit=digit)
        if config.hop != config.window:
            raise ValueError(
                f"hop = {config.hop} must equal the window, {config.window}: "
                "only tumbling windows are supported"
            )
        detail_bits = sample_bits + config.level
        fits(config, **register_limits(config, detail_bits, timer_bits))
        self.config = config
        digits = -(-max(detail_bits + digit, timer_bits + 1) // digit)
        self.steps = 1 << (digits - 1).bit_length()
        self._check, self._slip = FrameFilter(1), Slip(1, config)
        self._haar = Haar(1, config.level)
        span = config.window >> config.level
        self._extremes = PeakToPeak(1, span, span)
        self.reset()

    @property
    def clocks(self):
        """Clocks from the first clock in which a sample is offered to the clock in which it is taken."""
        return 2 * self.steps + 1

    @property
    def damaged(self):
        """Damaged frames since reset."""
        return self._check.damaged

    @property
    def blanked(self):
        """Details since reset that were over while blanked or moving."""
        return self._slip.blanked

    def reset(self):
        """Forget the past; the next sample is the first."""
        self._check.reset()
        self._slip.reset()
        self._restart()

    def next(self, x, ids=None, lasts=None, moving=None):
        """Feed samples ``x`` [n]; returns a dict of arrays, one value per detail that they complete.

        ``ids`` and ``lasts`` [n]: id and last of each sample (0 and true if undamaged); ``moving`` [n] bool.
        ``state``, ``raised``, ``over``, ``p2p``, ``end`` are the block's outputs.
        """
        x = np.asarray(x, dtype=np.int64)
        ids = np.zeros(len(x), int) if ids is None else ids
        lasts = np.ones(len(x), bool) if lasts is None else lasts
        moving = np.zeros(len(x), bool) if moving is None else moving
        rows = []
        for sample, channel, last, busy in zip(x, ids, lasts, moving):
            kept, restart = self._check.next(int(channel), bool(last))
            if not kept:
                continue
            if restart:
                self._slip.restart()
                self._restart()
            detail, total = self._haar.next([[sample]])
            if detail.size:
                p2p, end = self._extremes.next(detail)
                state = int(self._slip.next(p2p, total, [busy])[0, 0])
                rises = _slipping(state) and not _slipping(self._state)
                rows.append((state, rises, p2p[0, 0] > self.config.threshold, p2p[0, 0], end[0]))
                self._state = state
        columns = np.array(rows, dtype=np.int64).reshape(-1, 5).T
        return dict(zip(("state", "raised", "over", "p2p", "end"), columns))

    def _restart(self):
        self._haar.reset()
        self._extremes.reset()
        self._state = State.NONE


def _slipping(state):
    return state in (State.INCIPIENT, State.GROSS)
