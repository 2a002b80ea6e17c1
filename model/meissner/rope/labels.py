"""Labels of rope slip from a load cell, as published, and the windows that a forest is trained on.

    d[n] = L[n] - L[n-1]            m[n] = (d[n-4] + ... + d[n]) / 5
    fall = the first n of a section with m[n] < -0.02        none: nothing slips in it
    t_s  = the last peak of m before the fall; of a flat peak, its last sample

A window is named by its last frame e and has the differences e-w+1 .. e, all within its section. It is
labelled 1 if t_s - before <= e <= t_s + after: so there are five ones in a section for every w, as the
published equal counts for w = 3 and 6 require. A slipping section gives the f windows up to t_s + after, any
other its first 25.
"""

from typing import NamedTuple

import numpy as np

MEAN = 5
FALL = -0.02
QUIET = 25  # windows of a section without slip


class Pattern(NamedTuple):
    """Table II: ``w`` differences in a window, ``f`` windows of a slipping section, ones from ``before``
    frames before t_s to ``after`` after it."""

    w: int
    f: int
    before: int
    after: int


PATTERNS = {
    "A": Pattern(3, 15, 0, 4),
    "B": Pattern(6, 8, 0, 4),
    "C": Pattern(6, 15, 4, 0),
    "D": Pattern(6, 15, 2, 2),
    "E": Pattern(6, 15, 0, 4),
}
COUNTS = {name: (2241 if name == "B" else 4716, 1773) for name in PATTERNS}  # labels 0 and 1, as printed
FORCES_N = ((1, 3), (5, 7), (9, 11), (13, 15))
SPEEDS_MM_S = ((2, 4), (6, 8), (10, 15), (20, 30))  # printed without a unit
TRAINED, TIMES = ("a", "c"), 3  # ropes; measurements of each pair
HELD_OUT = {True: 24, False: 8}  # sections for the test, slipping and not: 32 (docs/papers/rope_slip.md)


class Section(NamedTuple):
    """A pull of frames ``start`` .. ``stop`` - 1; ``slip``: t_s, or None."""

    start: int
    stop: int
    slip: int | None


def smoothed(load):
    """m of the load cell's values [n]; NaN where it has not five differences yet."""
    load = np.asarray(load, float)
    mean = np.full(len(load), np.nan)
    mean[MEAN:] = (load[MEAN:] - load[:-MEAN]) / MEAN  # the sum of successive differences
    return mean


def slip_of(mean, start, stop):
    """t_s of the section ``start`` .. ``stop`` - 1 by the smoothed differences, or None."""
    below = np.flatnonzero(mean[start:stop] < FALL)
    if not len(below):
        return None
    at = start + int(below[0])
    while at > start and mean[at - 1] >= mean[at]:
        at -= 1
    while mean[at + 1 if at + 1 < stop else at] == mean[at] and at + 1 < stop:
        at += 1
    return at


def sections(load, spans):
    """The Section of each of ``spans``, (start, stop) in frames, of a recording."""
    mean = smoothed(load)
    return [Section(*span, slip_of(mean, *span)) for span in spans]


def _ends(section, pattern, first, last):
    """Windows that end at first .. last, as far as they fit into the section."""
    return np.arange(max(first, section.start + pattern.w), min(last, section.stop - 1) + 1)


def training(section, pattern):
    """(last frames, labels) of the windows of a section that a forest is trained on."""
    if section.slip is None:
        first = section.start + pattern.w
        return _labelled(section, pattern, first, first + QUIET - 1)
    last = section.slip + pattern.after
    return _labelled(section, pattern, last - pattern.f + 1, last)


def testing(section, pattern):
    """(last frames, labels) of all windows up to t_s + after, or of the whole section without slip."""
    last = section.stop if section.slip is None else section.slip + pattern.after
    return _labelled(section, pattern, 0, last)


def _labelled(section, pattern, first, last):
    ends = _ends(section, pattern, first, last)
    if section.slip is None:
        return ends, np.zeros(len(ends), np.int64)
    from_slip = ends - section.slip
    return ends, ((from_slip >= -pattern.before) & (from_slip <= pattern.after)).astype(np.int64)


def remainders():
    """What the printed counts say of the sections: {sum: (quotient, remainder)}."""
    (zeros, ones), (fewer, _) = COUNTS["E"], COUNTS["B"]
    slipping = ones // 5
    return {
        "1773 ones, five a section": divmod(ones, 5),
        "4716 - 2241 zeros, f of 15 and of 8": divmod(zeros - fewer, 15 - 8),
        f"4716 - 10*{slipping} zeros, {QUIET} a section without slip": divmod(zeros - 10 * slipping, QUIET),
        f"2241 - 3*{slipping} zeros, {QUIET} a section without slip": divmod(fewer - 3 * slipping, QUIET),
    }
