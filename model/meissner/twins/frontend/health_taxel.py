"""Bit-exact twin of rtl/frontend/msn_health_taxel.sv: judges each taxel by one frame."""

from typing import NamedTuple

import numpy as np

DEAD, RAILED, BLINKING = 1, 2, 4  # as in docs/link.md


class State(NamedTuple):
    """The state of taxels, in arrays of one shape."""

    held: np.ndarray
    rail: np.ndarray
    blink: np.ndarray
    still: np.ndarray
    since: np.ndarray
    rising: np.ndarray
    jumped: np.ndarray
    faults: np.ndarray
    reported: np.ndarray

    @classmethod
    def none(cls, shape):
        """No history, no faults."""
        numbers = np.zeros((5, *shape), dtype=np.int64)
        flags = np.zeros((3, *shape), dtype=bool)
        return cls(*numbers, *flags[:2], np.zeros(shape, dtype=np.int64), flags[2])


class Judged(NamedTuple):
    """``state``: the next one; ``news``: new faults; ``event``: a fault is not reported yet;
    ``moved``: recently; ``rose``: the last move was upwards."""

    state: State
    news: np.ndarray
    event: np.ndarray
    moved: np.ndarray
    rose: np.ndarray


def judge(state, raw, over, around, limits, tick, fresh=False, again=False, send=True):
    """One frame of taxels.

    ``around``: bool arrays pair, border, alone: how the neighbours moved recently; ``limits``: Limits of
    meissner.twins.frontend.health; ``tick``: this frame counts rails; ``fresh``: it is the first, of which
    only the samples are kept; ``again``: no fault counts as reported; ``send``: events are reported now.
    """
    pair, border, alone = around
    delta = raw - state.held
    moved, jumped = np.abs(delta) > limits.band, np.abs(delta) > limits.jump
    railed = (raw <= limits.low) | (raw >= limits.high) | (over & limits.over_range_enable)
    rail = np.where(railed, np.minimum(state.rail + tick, 255), 0)
    more, less = np.minimum(state.blink + 16, 255), np.maximum(state.blink - 1, 0)
    blink = np.where(state.jumped & alone, more, less)
    proof = np.where(pair, 4, border)
    still = np.where(moved | (state.since > 0), 0, np.minimum(state.still + proof, 255))
    since = np.where(moved, 3, np.maximum(state.since - 1, 0))
    rising = np.where(moved, delta >= 0, state.rising)
    held = np.where(moved, raw, state.held)
    faults = state.faults.copy()
    for kind, value, limit in (
        (DEAD, still, limits.still),
        (RAILED, rail, limits.rail),
        (BLINKING, blink, limits.blink),
    ):
        faults |= kind * ((value >= limit) & (limit > 0))
    news = faults & ~state.faults
    reported = state.reported & (not again) & (news == 0)
    event = (faults != 0) & ~reported
    after = State(held, rail, blink, still, since, rising, jumped, faults, (faults != 0) & (reported | send))
    if fresh:
        after = State.none(raw.shape)._replace(held=raw.copy())
        news, event = np.zeros_like(news), np.zeros_like(event)
    return Judged(after, news, event, after.since > 0, rising)
