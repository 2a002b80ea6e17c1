"""Bit-exact twin of rtl/slip/msn_slip_changes.sv: the changes of each channel's state that the host gets."""

from typing import NamedTuple

from meissner.twins.slip.config import check_channels
from meissner.twins.slip.slip import State

ALL = (1 << len(State)) - 1  # of ``events``


class Change(NamedTuple):
    """``start``: of a slip; ``late``: the channel had this state in an earlier detail already; ``told``: the
    state that the host has of this channel."""

    start: bool
    late: bool
    told: int
    state: int


class SlipChanges:
    """``next`` takes a decision about a channel and returns its Change, or None.

        wanted = (state != told or raised) and events[state]
        a start (raised) waits for its place; any other goes with the first detail at which there is room
        late = state != told and it is not new in this detail

    ``lost``: changes that followed an unsent one before there was room; ``now``: the state of each channel.
    """

    def __init__(self, channels=8, events=ALL):
        check_channels(channels)
        self.channels, self.events = channels, events
        self.reset()

    def reset(self):
        self.now, self.told = [0] * self.channels, [0] * self.channels
        self.lost = 0

    def next(self, channel, state, raised=False, room=True):
        told, now = self.told[channel], self.now[channel]
        state, waiting, changed = int(state), told != now, state != now
        differs, listed = bool(state != told or raised), bool(self.events >> state & 1)
        sends = differs and listed and bool(raised or room)
        self.lost += (waiting and changed) * (1 + (listed and not differs))
        self.now[channel] = state
        if sends or not (differs and listed):
            self.told[channel] = state
        return Change(bool(raised), waiting and not changed, told, state) if sends else None
