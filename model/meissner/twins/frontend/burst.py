"""Twin of rtl/frontend/msn_burst.sv: when the conversions of a burst start, and how many there are."""


def triggers(starts, count, period, end):
    """Clocks of trigger_o before ``end``; ``starts``: clocks of start_i. Each start restarts the burst.

    ``count`` and ``period``: the numbers themselves, 1 or more; the registers hold them without the top bit.
    """
    for name, value in (("count", count), ("period", period)):
        if value < 1:
            raise ValueError(f"{name} = {value} must be 1 or more")
    clocks = []
    for start, after in zip(starts, [*starts[1:], end]):
        burst = range(start + 1, start + 1 + count * period, period)
        clocks += [clock for clock in burst if clock <= after and clock < end]
    return clocks


def samples(skip, periods, samples_per_period):
    """Conversions of a burst that msn_am_demod needs."""
    return skip + periods * samples_per_period
