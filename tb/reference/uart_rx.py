"""A receiver of a serial line by docs/link.md, in exact rationals: 8N1, lowest bit first.

A bit lasts clk / baud clocks, rounded to a sixteenth. The k-th bit after the start bit is read, counted from
the clock that first saw the line low, after half a bit rounded down to clocks plus k bits rounded to the
nearest clock.
"""

from fractions import Fraction
from math import floor


def bit_clocks(clk_hz, baud_hz):
    """Length of a bit in clocks."""
    return Fraction(floor(Fraction(16 * clk_hz, baud_hz) + Fraction(1, 2)), 16)


def receive(levels, clk_hz, baud_hz):
    """The bytes on a line with these levels, one per clock from reset on: a list of (clock, byte).

    ``clock`` is that in which the stop bit is read; byte None: the stop bit was missing. A start bit that has
    ended by its middle is ignored; after a missing stop bit and after reset, nothing is read until the line
    is high.
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
