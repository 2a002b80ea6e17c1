"""Twins of rtl/frontend/msn_burst.sv: when the conversions of a burst start, and how many there are; and
msn_time_stamp.sv: the convert start of each frame that is taken."""

from meissner.twins.shared import within


def triggers(starts, count, period, end):
    """Clocks of trigger_o before ``end``; ``starts``: clocks of start_i. Each start restarts the burst.

    ``count`` and ``period``: the numbers themselves, 1 or more; the registers hold them without the top bit.
    """
    within(count=(count, 1, None), period=(period, 1, None))
    clocks = []
    for start, after in zip(starts, [*starts[1:], end]):
        burst = range(start + 1, start + 1 + count * period, period)
        clocks += [clock for clock in burst if clock <= after and clock < end]
    return clocks


def samples(skip, periods, samples_per_period):
    """Conversions of a burst that msn_am_demod needs."""
    return skip + periods * samples_per_period


def time_stamps(clocks, read_during=False):
    """The clock of each frame's convert start.

    ``clocks``: (convert, valid, ready, last, read) of every clock. A frame's convert start is the last one
    before its first sample is offered; ``read_during``: before the last read that began before that.
    """
    started, converted, frame, found = None, None, None, []
    for now, (convert, valid, ready, last, read) in enumerate(clocks):
        if valid:
            if frame is None:
                frame = converted
                found.append(frame)
            if ready and last:
                frame = None
        if read and read_during:
            converted = started
        if convert:
            started = now
        if not read_during:
            converted = started
    return found
