"""Bit-exact twin of rtl/slip/msn_slip_chain.sv: from samples to the changes of each channel's state."""

import numpy as np

from meissner.twins.slip.slip_changes import ALL, SlipChanges
from meissner.twins.slip.slip_path import decide


def slip_chain(samples, config, moving=None, mask=None, change=None, events=ALL):
    """(frame, channel, p2p, Change) of each change in samples [frames, channels]; ``config``: SlipConfig.

    ``mask`` [frames, channels]: samples not to be trusted; ``change``: (frame, threshold), another threshold
    from that frame on; ``events``: as in SlipChanges. A change belongs to its detail's last frame.
    """
    found = decide(np.asarray(samples).T, config, moving, None if mask is None else mask.T, change)
    return changes_of(found.state, found.raised, found.p2p, 1 << config.level, events)


def changes_of(state, raised, p2p, group=1, events=ALL):
    """(frame, channel, p2p, Change) of decisions [channels, details]; a detail is of ``group`` frames."""
    twin, found = SlipChanges(len(state), events), []
    new = np.diff(state, axis=1, prepend=0) != 0
    for detail, channel in np.argwhere((new | raised).T).tolist():
        change = twin.next(channel, state[channel, detail], raised[channel, detail])
        if change:
            found.append(((detail + 1) * group - 1, channel, int(p2p[channel, detail]), change))
    return found
