"""Bit-exact twins of rtl/slip/msn_slip_path.sv: samples to decisions about every channel; msn_slip_flags.sv:
whether any channel slips, slips grossly, is touched."""

from dataclasses import dataclass, replace

import numpy as np

from meissner.twins.slip.haar import haar, masked_groups
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import Slip, State


@dataclass(frozen=True)
class Decisions:
    """Per detail: ``p2p``, ``state``, ``raised`` [channels, details]; ``end`` as in msn_peak_to_peak.

    ``raised``: the first detail of a slip; ``blanked``: the number over while blanked or moving.
    """

    p2p: np.ndarray
    state: np.ndarray
    raised: np.ndarray
    end: np.ndarray
    blanked: int


def check_serial(channels, config):
    """Raise ValueError for settings that the path with two bits per clock does not support."""
    if channels != 1 or config.hop != config.window:
        raise ValueError("serial must go with one channel and hop = window")


def details(x, config, mask=None, start=0, stop=None):
    """(detail, total) of the samples start .. stop of ``x`` [channels, samples], as the windows get them.

    A detail may depend on samples before its own: these are to be in ``x``.
    """
    mask = None if mask is None else mask[:, start:stop]
    return haar(x[:, start:stop], config.level, mask)


def decide(x, config, moving=None, mask=None, change=None, serial=False):
    """Decisions about complete frames of samples ``x`` [channels, samples]; ``moving``: [details] or None.

    ``mask`` [channels, samples]: samples not to be trusted; their details count in no window, raise no slip.
    ``change``: (frame, threshold), another threshold from that frame on. ``serial``: the same decisions at
    two bits per clock; ValueError for settings that this path does not support.
    """
    if serial:
        check_serial(len(x), config)
        if mask is not None:
            raise ValueError("serial must go without a mask")
    detail, total = details(x, config, mask)
    off = None if mask is None else masked_groups(mask, config.level)
    group = 1 << config.level
    p2p, end = PeakToPeak(len(x), config.window // group, config.hop // group).process(detail, off)
    twin = Slip(len(x), config)
    if change is None:
        state = twin.process(p2p, total, moving, off)
    else:
        first = -(-(change[0] + 1) // group) - 1  # the detail that the frame completes, else the next
        moving = np.zeros(p2p.shape[1], bool) if moving is None else moving
        off = np.zeros(p2p.shape, bool) if off is None else off
        before = twin.process(p2p[:, :first], total[:, :first], moving[:first], off[:, :first])
        twin.config = replace(config, threshold=change[1])
        after = twin.next(p2p[:, first:], total[:, first:], moving[first:], off[:, first:])
        state = np.concatenate([before, after], axis=1)
    slipping = (state == State.INCIPIENT) | (state == State.GROSS)
    was = np.concatenate([np.zeros((len(x), 1), dtype=bool), slipping[:, :-1]], axis=1)
    return Decisions(p2p, state, slipping & ~was, end, twin.blanked)


def slip_flags(decisions):
    """(slip, gross, touched) after each of ``decisions``: (channel, state, last of its frame)."""
    flags, any_of, found = (False,) * 3, (False,) * 3, []
    for channel, state, last in decisions:
        slips = state in (State.INCIPIENT, State.GROSS)
        now = (slips, state == State.GROSS, slips or state == State.CONTACT)
        any_of = tuple(a or b for a, b in zip(any_of, now)) if channel else now
        flags = any_of if last else tuple(a or b for a, b in zip(flags, now))
        any_of = (False,) * 3 if last else any_of
        found.append(flags)
    return found
