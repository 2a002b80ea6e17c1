"""Lines for a serial receiver and the bytes they carry, worked out by hand from docs/link.md.

READS: clocks from the first in which the line is seen low to the ten in which start, data and stop bits are
read.
"""

READS = {
    # 4 clocks a bit: 2 and 4k
    (12_000_000, 3_000_000): [2, 6, 10, 14, 18, 22, 26, 30, 34, 38],
    # 25/3 = 8.33, 8 5/16: 4 and 8.3125, 16.625, 24.9375, 33.25, 41.5625, 49.875, 58.1875, 66.5, 74.8125
    (25_000_000, 3_000_000): [4, 12, 21, 29, 37, 46, 54, 62, 71, 79],
    # 52.083, 52 1/16: 26 and 52.0625, 104.125, 156.1875, 208.25, 260.3125, 312.375, 364.4375, 416.5, 468.5625
    (48_000_000, 921_600): [26, 78, 130, 182, 234, 286, 338, 390, 443, 495],
    # 11/2 = 5.5, 5 8/16: 2 and 5.5, 11, 16.5, 22, 27.5, 33, 38.5, 44, 49.5
    (11_000_000, 2_000_000): [2, 8, 13, 19, 24, 30, 35, 41, 46, 52],
}


def line_of(*ones, length):
    """Low except in the clocks ``ones``."""
    return [int(clock in ones) for clock in range(length)]


def cases(rate):
    """(name, levels, [(clock of the stop bit, byte or None)]); each line begins with two idle clocks."""
    reads = READS[rate]
    start, data, stop = reads[0], reads[1:9], reads[9]
    rest = [1] * (stop + 12)
    at = lambda clock: 2 + clock
    low = lambda *ones: [1, 1, *line_of(*ones, length=stop + 1)]

    # High only in the clocks that read it; high levels one clock off must have no effect.
    yield "high where it is read", low(*data, stop) + rest, [(at(stop), 0xFF)]
    for off in (-1, 1):
        ones = {clock + off for clock in data} - set(reads)
        yield f"high {off} beside", low(*ones, stop) + rest, [(at(stop), 0)]
    for number, clock in enumerate(data):
        yield f"bit {number} alone", low(clock, stop) + rest, [(at(stop), 1 << number)]
        ones = set(range(1, stop + 1)) - {start, clock}
        yield f"bit {number} missing", low(*ones) + rest, [(at(stop), 255 - (1 << number))]
    yield "0x96", low(data[1], data[2], data[4], data[7], stop) + rest, [(at(stop), 0x96)]

    # A start bit that has ended by its middle.
    yield "no start", [1, 1] + [0] * start + rest, []
    yield "a start of just its middle", [1, 1] + [0] * (start + 1) + rest, [(at(stop), 0xFF)]
    yield "a start of two clocks", [1, 1, 0] + [1] * (start - 1) + [0] + rest, [(at(stop), 0xFF)]
    again = [1, 1] + [0] * start + [1] + low(stop)[2:] + rest
    yield "a start in the clock after one that was none", again, [(at(start + 1 + stop), 0)]

    # Stop bits: one clock long with the next start in the clock after; missing; missing for long.
    two = low(data[0], stop) + low(data[7], stop)[2:] + rest
    yield "a stop bit of one clock", two, [(at(stop), 1), (at(2 * stop + 1), 128)]
    yield (
        "a long stop bit",
        low(data[0], stop) + [1] * 3 * stop + low(data[7], stop)[2:] + rest,
        [
            (at(stop), 1),
            (at(5 * stop + 1), 128),
        ],
    )
    yield "no stop bit", low(data[0]) + rest, [(at(stop), None)]
    yield (
        "a stop bit a clock late",
        [*low(data[0]), 1, *low(data[7], stop)[2:], *rest],
        [
            (at(stop), None),
            (at(2 * stop + 2), 128),
        ],
    )
    held = low() + [0] * 3 * stop + [1] + low(data[3], stop)[2:] + rest
    yield "held low", held, [(at(stop), None), (at(5 * stop + 2), 8)]


def low_from_the_reset_on(rate):
    """A line already low before the reset: nothing is read until it is high. Returns the levels and their
    bytes."""
    reads = READS[rate]
    stop = reads[9]
    line = [0] * 2 * stop + [1] + line_of(reads[4], stop, length=stop + 1) + [1] * 12
    return line, [(3 * stop + 1, 8)]
