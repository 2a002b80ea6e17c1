"""Bit-exact twin of rtl/slip/msn_slip.sv: the contact state of each channel."""

from enum import IntEnum

import numpy as np

from meissner.twins.shared import Stream
from meissner.twins.slip.config import check_channels


class State(IntEnum):
    """State of one channel; the numbers are those of msn_pkg::slip_state_e."""

    NONE = 0
    CONTACT = 1
    INCIPIENT = 2
    GROSS = 3
    RELEASE = 4


# Signals of a detail, as bits of a byte; and the states as plain numbers, because members take twice as long.
PRESSED, LIFTED, OVER, GROSSLY, KEPT, MOVING, MASKED = (1 << place for place in range(7))
NONE, CONTACT, INCIPIENT, GROSS, RELEASE = map(int, State)


class Slip(Stream):
    """Slip state of each channel from the peak-to-peak and the level, one step per detail.

        pressed = level >= contact_level   lifted = level < release_level     (contact_rises)
        pressed = level <= contact_level   lifted = level > release_level     (otherwise)
        over = p2p > threshold             gross = p2p > gross_threshold
        kept = over or p2p > keep_threshold

    NONE, RELEASE -> CONTACT when pressed; the next ``blank`` details are blanked.
    CONTACT -> INCIPIENT (GROSS if gross) when over, unless blanked, refractory or moving.
    INCIPIENT -> GROSS when over and gross; both last through ``hold`` details in a row that are not kept (or
    moving), then return to CONTACT; the next ``refractory`` details raise no slip.
    CONTACT, INCIPIENT, GROSS -> RELEASE when lifted; RELEASE -> NONE after ``hold`` details.
    A masked detail leads to NONE from every state and is never over.
    ``blanked`` counts, over all channels, the details that were over while blanked or moving.

    All times count details of the channel. ``config``: meissner.twins.slip.config.SlipConfig.
    """

    def __init__(self, channels, config):
        check_channels(channels)
        self.channels, self.config = channels, config
        self.reset()

    def reset(self):
        """Set every channel to NONE and the count of blanked details to 0."""
        self.blanked = 0
        self.restart()

    def restart(self):
        """Set every channel to NONE; keep the count."""
        self._memory = [(State.NONE, 0, 0, False)] * self.channels

    def next(self, p2p, level, moving=None, mask=None):
        """States [channels, n] of ``p2p``, ``level`` and bool ``mask`` [channels, n], bool ``moving`` [n]."""
        c = self.config
        p2p, level = np.asarray(p2p), np.asarray(level)
        moving = np.zeros(p2p.shape[1], bool) if moving is None else np.asarray(moving, bool)
        pressed = level >= c.contact_level if c.contact_rises else level <= c.contact_level
        lifted = level < c.release_level if c.contact_rises else level > c.release_level
        over, gross, kept = p2p > c.threshold, p2p > c.gross_threshold, p2p > c.keeps_above
        mask = np.zeros(p2p.shape, bool) if mask is None else np.asarray(mask, bool)
        states = np.empty(p2p.shape, dtype=np.int8)
        for channel in range(self.channels):
            signals = [b[channel] for b in (pressed, lifted, over, gross, kept)]
            states[channel] = self._channel(channel, [*signals, moving, mask[channel]])
        return states

    def _channel(self, channel, signals):
        """Step one channel through its details; keep its memory and return its states.

        Without contact nothing changes until the next press; in contact only the refractory time runs until
        the next detail that is lifted, over or masked. These stretches are skipped in one step.
        """
        pressed, lifted, over, _, _, _, masked = signals
        count = len(pressed)
        ends = {
            State.NONE: np.append(np.flatnonzero(pressed & ~masked), count),
            State.CONTACT: np.append(np.flatnonzero(lifted | over | masked), count),
        }
        # A byte per detail, a bit per signal: most details are skipped, and lists of them would be slower.
        inputs = np.packbits(np.stack(signals), axis=0, bitorder="little")[0].tobytes()
        states, at = np.empty(count, dtype=np.int8), 0
        while at < count:
            state, hold, deaf, blanking = self._memory[channel]
            if state in ends:
                until = int(ends[state][np.searchsorted(ends[state], at)])
                states[at:until] = state
                deaf = max(0, deaf - (until - at)) if state == State.CONTACT else deaf
                self._memory[channel] = (state, hold, deaf, blanking)
                at = until
            at = self._steps(channel, inputs, at, states)
        return states

    def _steps(self, channel, inputs, first, states):
        """Step the details from ``first`` on, one by one, up to NONE or CONTACT; returns the next detail."""
        c = self.config
        # hold: details until a slip or a release ends; deaf: details until a slip may be raised;
        # blanking: deaf because of a contact onset, so details over meanwhile are counted.
        state, hold, deaf, blanking = self._memory[channel]
        found, blanked = bytearray(), 0
        for now in memoryview(inputs)[first:]:
            if now & MASKED:
                state = NONE
            elif state in (NONE, RELEASE):
                if now & PRESSED:
                    state, hold, deaf, blanking = CONTACT, 0, c.blank, True
                elif state == RELEASE and hold:
                    hold -= 1
                else:
                    state = NONE
            elif now & LIFTED:
                state, hold, deaf = RELEASE, c.hold, 0
            elif state != CONTACT:  # slipping
                blanked += bool(now & OVER and now & MOVING)
                if now & KEPT and not now & MOVING:
                    hold = c.hold
                    state = GROSS if now & OVER and now & GROSSLY else state
                elif hold:
                    hold -= 1
                else:
                    state, deaf, blanking = CONTACT, c.refractory, False
            else:
                blanked += bool(now & OVER and (now & MOVING or (deaf and blanking)))
                if now & OVER and not now & MOVING and not deaf:
                    state, hold = GROSS if now & GROSSLY else INCIPIENT, c.hold
                elif deaf:
                    deaf -= 1
            found.append(state)
            if state in (NONE, CONTACT):
                break
        self.blanked += blanked
        states[first : first + len(found)] = found
        self._memory[channel] = (State(state), hold, deaf, blanking)
        return first + len(found)
