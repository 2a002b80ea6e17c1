"""Bit-exact twin of rtl/slip/msn_slip_flags.sv: whether any channel slips, slips grossly, is touched."""

from meissner.twins.slip.slip import State


def slip_flags(decisions):
    """(slip, gross, touched) after each of ``decisions``: (state, last of its frame)."""
    flags, any_of, found = (False,) * 3, (False,) * 3, []
    for state, last in decisions:
        slips = state in (State.INCIPIENT, State.GROSS)
        now = (slips, state == State.GROSS, slips or state == State.CONTACT)
        any_of = tuple(a or b for a, b in zip(any_of, now))
        flags = any_of if last else tuple(a or b for a, b in zip(flags, now))
        any_of = (False,) * 3 if last else any_of
        found.append(flags)
    return found
