"""Bit-exact twin of rtl/link/msn_state_report.sv: the states of all channels as packets of words."""

from meissner.twins.shared import within

CHUNK = 128  # channels of a packet


def report(states, first=0):
    """(first channel, channels left, words) of each packet of ``states``; ``first``: number of channel 0.

    state of channel first + 4 n + k in bits 4 k .. 4 k + 2 of word n, 0 beyond the last channel
    first = 0, 128, ..    left = channels - first
    """
    within(channels=(len(states), 1, 4096), first=(first, 0, 65535 if len(states) == 1 else 0))
    found = []
    for at in range(0, len(states), CHUNK):
        part = [int(state) for state in states[at : at + CHUNK]]
        words = [
            sum(state << 4 * k for k, state in enumerate(part[n : n + 4])) for n in range(0, len(part), 4)
        ]
        found.append((first + at, len(states) - at, words))
    return found
