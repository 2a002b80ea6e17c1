"""Slip states of engine ``float``: an independent loop on the times of past events and unrounded numbers."""

import numpy as np

NONE, CONTACT, INCIPIENT, GROSS, RELEASE = range(5)


def states(p2p, level, config, moving):
    """States [channels, details] of p2p and level, and the number of details over while blanked or moving."""
    found, blanked = np.empty(p2p.shape, dtype=np.int8), 0
    for channel, (sizes, levels) in enumerate(zip(p2p.tolist(), level.tolist())):
        found[channel], count = _channel(sizes, levels, moving.tolist(), config)
        blanked += count
    return found, blanked


def _channel(sizes, levels, moving, config):
    sign = 1 if config.contact_rises else -1
    press, let_go = sign * config.contact_level, sign * config.release_level
    state, blanked, states = NONE, 0, []
    touched = slipped = calmed = left = -1  # the detail at which each last happened
    for now, (size, level, moves) in enumerate(zip(sizes, levels, moving)):
        pressed, lifted = sign * level >= press, sign * level < let_go
        over = size > config.threshold
        if state in (NONE, RELEASE):
            if pressed:
                state, touched, calmed = CONTACT, now, -1
            elif state == RELEASE and now - left > config.hold:
                state = NONE
        elif lifted:
            state, left = RELEASE, now
        elif state == CONTACT:
            fresh = calmed < 0 and now - touched <= config.blank
            deaf = calmed >= 0 and now - calmed <= config.refractory
            blanked += over and (moves or fresh)
            if over and not (moves or fresh or deaf):
                state, slipped = GROSS if size > config.gross_threshold else INCIPIENT, now
        else:
            blanked += over and moves
            kept = over or (config.keep_threshold is not None and size > config.keep_threshold)
            if kept and not moves:
                slipped = now
                state = GROSS if over and size > config.gross_threshold else state
            elif now - slipped > config.hold:
                state, calmed = CONTACT, now
        states.append(state)
    return states, blanked
