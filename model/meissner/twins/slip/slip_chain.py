"""Twin of rtl/slip/msn_slip_chain.sv: slip events of every channel or taxel."""

import numpy as np

from meissner.twins.slip.slip_path import decide


def slip_chain(samples, config, moving=None, mask=None, change=None):
    """(frame, channel, p2p, state) of each event of samples [frames, channels]; ``config``: SlipConfig.

    ``mask`` [frames, channels]: samples not to be trusted; ``change``: (frame, threshold), another threshold
    from that frame on. An event belongs to the last frame of its detail's group.
    """
    found = decide(np.asarray(samples).T, config, moving, None if mask is None else mask.T, change)
    group = 1 << config.level
    return [
        (
            int(detail + 1) * group - 1,
            int(channel),
            int(found.p2p[channel, detail]),
            int(found.state[channel, detail]),
        )
        for detail, channel in np.argwhere(found.raised.T)
    ]
