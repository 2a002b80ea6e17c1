"""A receiver of a serial line as in docs/link.md, in exact rationals: 8N1, lowest bit first.

A bit lasts clk / baud clocks, to a sixteenth. The k-th bit after the start bit is read half a bit's whole
clocks and k bits, to the nearest clock, after the clock that first saw the line low.
"""

from fractions import Fraction
from math import floor


def bit_clocks(clk_hz, baud_hz):
    """Clocks that a bit lasts."""
    return Fraction(floor(Fraction(16 * clk_hz, baud_hz) + Fraction(1, 2)), 16)


def receive(levels, clk_hz, baud_hz):
    """What a line with these levels, one a clock from the reset on, says: a list of (clock, byte).

    The clock in which the stop bit is read; byte None: it was not there. A start bit that is gone by
    its middle is none; after a missing stop bit, and after the reset, nothing is read until the line rests.
    """
    bit, found = bit_clocks(clk_hz, baud_hz), []
    half = floor(bit) // 2
    clock, rested = 0, False
    while clock < len(levels):
        if levels[clock]:
            rested = True
        elif rested:
            reads = [clock + half + floor(k * bit + Fraction(1, 2)) for k in range(10)]
            if reads[0] < len(levels) and levels[reads[0]]:
                clock = reads[0] + 1
                continue
            if reads[9] >= len(levels):
                break
            byte = sum(levels[read] << place for place, read in enumerate(reads[1:9]))
            rested = bool(levels[reads[9]])
            found.append((reads[9], byte if rested else None))
            clock = reads[9]
        clock += 1
    return found
