"""Bit-exact twin of rtl/slip/msn_slip.sv: what the contact on each channel is doing."""

from bisect import bisect_left
from enum import IntEnum

import numpy as np

from meissner.twins.slip.config import check_channels


class State(IntEnum):
    """State of one channel; the numbers are those of msn_pkg::slip_state_e."""

    NONE = 0
    CONTACT = 1
    INCIPIENT = 2
    GROSS = 3
    RELEASE = 4


class Slip:
    """Slip state of each channel from the peak-to-peak and the level, one step per detail.

        pressed = level >= contact_level   lifted = level < release_level     (contact_rises)
        pressed = level <= contact_level   lifted = level > release_level     (otherwise)
        over = p2p > threshold             gross = p2p > gross_threshold
        kept = over or p2p > keep_threshold

    NONE, RELEASE -> CONTACT when pressed; the next ``blank`` details are blanked.
    CONTACT -> INCIPIENT (GROSS if gross) when over, unless blanked, refractory or moving.
    INCIPIENT -> GROSS when over and gross; both fall back to CONTACT when ``hold`` details passed that were
    not kept (or moving), and then ``refractory`` details are deaf.
    CONTACT, INCIPIENT, GROSS -> RELEASE when lifted; RELEASE -> NONE after ``hold`` details.
    A masked detail leads to NONE from anywhere and is never over.
    ``blanked`` counts, over all channels, the details that were over while blanked or moving.

    All times count details of the channel. ``config``: meissner.twins.slip.config.SlipConfig.
    """

    def __init__(self, channels, config):
        check_channels(channels)
        self.channels, self.config = channels, config
        self.reset()

    def reset(self):
        """Every channel to NONE, the count of blanked details to 0."""
        self.blanked = 0
        self.restart()

    def restart(self):
        """Every channel to NONE; the count stays."""
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

    def process(self, p2p, level, moving=None, mask=None):
        """``reset`` and then ``next``."""
        self.reset()
        return self.next(p2p, level, moving, mask)

    def _channel(self, channel, signals):
        """Step one channel through its details; keep its memory and return its states.

        Most details change nothing but a count: those are passed at once, up to the next that may, and that
        one is a step.
        """
        passing, count = _Passing(self.config, *signals), len(signals[0])
        states, at = np.empty(count, dtype=np.int8), 0
        while at < count:
            at, memory, blanked = passing.over(states, at, self._memory[channel])
            self.blanked += blanked
            if at < count:
                memory = self._step(memory, *(signal[at] for signal in signals))
                states[at] = memory[0]
                at += 1
            self._memory[channel] = memory
        return states

    def _step(self, memory, pressed, lifted, over, gross, kept, moving, masked):
        """One detail."""
        c = self.config
        # hold: details until a slip or a release is over; deaf: details until a slip may be raised;
        # blanking: deaf because of a contact onset, so what is over meanwhile is counted.
        state, hold, deaf, blanking = memory
        slipping = state in (State.INCIPIENT, State.GROSS)
        if masked:
            state = State.NONE
        elif state in (State.NONE, State.RELEASE):
            if pressed:
                state, hold, deaf, blanking = State.CONTACT, 0, c.blank, True
            elif state == State.RELEASE and hold:
                hold -= 1
            else:
                state = State.NONE
        elif lifted:
            state, hold, deaf = State.RELEASE, c.hold, 0
        elif slipping:
            self.blanked += int(over and moving)
            if kept and not moving:
                hold = c.hold
                state = State.GROSS if over and gross else state
            elif hold:
                hold -= 1
            else:
                state, deaf, blanking = State.CONTACT, c.refractory, False
        else:
            self.blanked += int(over and (moving or (deaf > 0 and blanking)))
            if over and not moving and not deaf:
                state, hold = State.GROSS if gross else State.INCIPIENT, c.hold
            elif deaf:
                deaf -= 1
        return state, hold, deaf, blanking


class _Passing:
    """Over the details of a channel that lead to no other state, or from INCIPIENT to GROSS."""

    def __init__(self, config, pressed, lifted, over, gross, kept, moving, masked):
        self.hold, self.count = config.hold, len(pressed)
        renewed, off = kept & ~moving, lifted | masked
        self.ends = {
            State.NONE: _where(pressed & ~masked),
            State.CONTACT: _where(off | over),
            State.RELEASE: _where(pressed | masked),
            State.INCIPIENT: _where(off),
        }
        self.ends[State.GROSS] = self.ends[State.INCIPIENT]
        self.gross = _where(renewed & over & gross)
        self.renewed = _where(renewed)
        # Those after which nothing renews the slip for as long as it holds.
        self.last = _where(np.diff(np.append(self.renewed, self.count + config.hold + 1)) > config.hold + 1)
        self.counted = over & moving

    def over(self, states, at, memory):
        """Fill ``states`` from ``at`` on; returns the next detail, the memory before it, what was blanked."""
        state, hold, deaf, blanking = memory
        until, blanked = _next(self.ends[state], at, self.count), 0
        if state == State.CONTACT:
            deaf = max(0, deaf - (until - at))
        elif state == State.RELEASE:
            until = min(until, at + hold)
            hold -= until - at
        elif state != State.NONE:
            until = min(until, self._lets_go(at, hold))
            renewed = bisect_left(self.renewed, until)
            latest = self.renewed[renewed - 1] if renewed else -1
            hold = self.hold - (until - 1 - latest) if latest >= at else hold - (until - at)
            turns = _next(self.gross, at, self.count)
            if turns < until:
                states[at:turns] = state
                state, blanked = State.GROSS, int(self.counted[at:turns].sum())
                at = turns
            blanked += int(self.counted[at:until].sum())
        states[at:until] = state
        return until, (state, hold, deaf, blanking), blanked

    def _lets_go(self, at, hold):
        """The detail at which a slip is over that holds for ``hold`` details from ``at`` on."""
        first = bisect_left(self.renewed, at)
        if first == len(self.renewed) or self.renewed[first] > at + hold:
            return at + hold
        return self.renewed[self.last[bisect_left(self.last, first)]] + self.hold + 1


def _where(signal):
    return np.flatnonzero(signal).tolist()


def _next(places, at, count):
    index = bisect_left(places, at)
    return places[index] if index < len(places) else count
