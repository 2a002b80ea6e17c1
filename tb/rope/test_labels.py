"""Labels of rope slip, worked out by hand: values at, below and above each limit of the rule, flat peaks,
windows at both ends of a section; the labels against a loop over all windows; what the printed counts say."""

import numpy as np
import pytest

from meissner.rope import labels
from meissner.rope.labels import PATTERNS, Pattern, Section


def test_the_mean_of_five_differences():
    """Differences 1, 2, 3, 4, 5, -20: their means of five are 3, then (2 + 3 + 4 + 5 - 20) / 5."""
    found = labels.smoothed([10, 11, 13, 16, 20, 25, 5])
    assert np.isnan(found[:5]).all() and found[5:].tolist() == pytest.approx([3.0, -1.2])
    assert np.isnan(labels.smoothed([1.0, 2.0, 3.0])).all()


# Means of a section, its first and last frame; t_s.
PEAKS = {
    "the last peak of two": ([0.5, 0.1, 0.3, 0.2, -0.021, -1], 0, 6, 2),
    "at the limit nothing falls": ([0.5, 0.1, 0.3, 0.2, -0.02], 0, 5, None),
    "just below it": ([0.5, 0.1, 0.3, 0.2, -0.0200001], 0, 5, 2),
    "above it": ([0.5, 0.1, 0.3, 0.2, -0.0199], 0, 5, None),
    "the first fall counts": ([0.1, 0.3, -0.03, 0.9, -0.03], 0, 5, 1),
    "no peak but the section's first frame": ([0.9, 0.5, 0.4, 0.1, -0.1], 1, 5, 1),
    "a flat peak: its last frame": ([0.1, 0.3, 0.3, 0.3, 0.2, -0.1], 0, 6, 3),
    "a shoulder is no peak": ([0.1, 0.4, 0.2, 0.2, -0.1], 0, 5, 1),
    "peak right before the fall": ([0.1, 0.2, 0.3, -0.1], 0, 4, 2),
    "the fall is in the next section": ([0.1, 0.3, 0.2, -0.1], 0, 3, None),
    "the fall was in the section before": ([0.4, -0.1, 0.1, 0.2], 2, 4, None),
    "below from the start": ([0.4, -0.1, -0.3, 0.2], 1, 4, 1),
    "means that are not there yet": ([np.nan, np.nan, 0.2, 0.3, -0.1], 0, 5, 3),
}


@pytest.mark.parametrize("case", PEAKS)
def test_the_time_of_slip(case):
    mean, start, stop, slip = PEAKS[case]
    assert labels.slip_of(np.array(mean), start, stop) == slip


def test_sections_of_a_load_cell():
    """It rises by 0.1 a frame to 1 N, falls by 0.5 at once, and rises again: t_s is the frame before the
    fall."""
    load = [*np.arange(11) / 10, 0.5, 0.6, 0.7, 0.8]
    assert labels.sections(load, [(1, 11), (5, 15)]) == [Section(1, 11, None), Section(5, 15, 10)]


# A section of frames 100 .. 299; pattern; t_s; the first and the last window; windows of label 1.
WINDOWS = {
    "A": (PATTERNS["A"], 150, (140, 154), (150, 154)),
    "B": (PATTERNS["B"], 150, (147, 154), (150, 154)),
    "C": (PATTERNS["C"], 150, (136, 150), (146, 150)),
    "D": (PATTERNS["D"], 150, (138, 152), (148, 152)),
    "E": (PATTERNS["E"], 150, (140, 154), (150, 154)),
    "all fit": (PATTERNS["E"], 116, (106, 120), (116, 120)),
    "one does not fit": (PATTERNS["E"], 115, (106, 119), (115, 119)),
    "w = 3 fits where 6 does not": (PATTERNS["A"], 113, (103, 117), (113, 117)),
    "fewer ones fit": (PATTERNS["E"], 104, (106, 108), (106, 108)),
    "the section ends": (PATTERNS["E"], 297, (287, 299), (297, 299)),
    "no slip, w = 6": (PATTERNS["E"], None, (106, 130), None),
    "no slip, w = 3": (PATTERNS["A"], None, (103, 127), None),
}


@pytest.mark.parametrize("case", WINDOWS)
def test_the_windows_of_a_section(case):
    pattern, slip, (first, last), ones = WINDOWS[case]
    section = Section(100, 300, slip)
    ends, label = labels.training(section, pattern)
    assert ends.tolist() == [*range(first, last + 1)]
    assert ends[label == 1].tolist() == ([*range(ones[0], ones[1] + 1)] if ones else [])
    every, of_every = labels.testing(section, pattern)
    assert every.tolist() == [*range(100 + pattern.w, (299 if slip is None else last) + 1)]
    assert of_every[np.isin(every, ends)].tolist() == label.tolist() and of_every.sum() == label.sum()


def test_a_section_too_short_for_a_window():
    for of in (labels.training, labels.testing):
        assert all(len(found) == 0 for found in of(Section(0, 6, None), PATTERNS["E"]))
        assert all(len(found) == 0 for found in of(Section(0, 6, 1), PATTERNS["E"]))
    assert labels.training(Section(0, 7, None), PATTERNS["E"])[0].tolist() == [6]


def test_table_2():
    """w, f and the ranges as printed; five ones and f - 5 zeros of a section, 25 of one without slip."""
    rows = [(3, 15, 0, 4), (6, 8, 0, 4), (6, 15, 4, 0), (6, 15, 2, 2), (6, 15, 0, 4)]
    assert dict(zip("ABCDE", rows)) == PATTERNS
    for pattern in PATTERNS.values():
        _, label = labels.training(Section(0, 200, 100), pattern)
        assert (sum(label), len(label)) == (5, pattern.f)
        assert len(labels.training(Section(0, 200, None), pattern)[0]) == 25
    assert labels.COUNTS["A"] == (6489 - 1773, 1773) and labels.COUNTS["B"] == (4014 - 1773, 1773)


def test_what_the_counts_say():
    """354 * 5 = 1770; 353 * 7 = 2471; 4716 - 3540 = 1176 = 47 * 25 + 1; 2241 - 1062 = 1179 = 47 * 25 + 4."""
    assert [*labels.remainders().values()] == [(354, 3), (353, 4), (47, 1), (47, 4)]


def test_the_label_is_of_the_last_frame():
    """A loop over every frame, for every pattern and a pattern of its own."""
    for pattern in (*PATTERNS.values(), Pattern(4, 9, 1, 3)):
        for slip in range(8, 40):
            ends, label = labels.training(Section(3, 42, slip), pattern)
            rows = []
            for end in range(60):
                whole = end - pattern.w >= 3 and end < 42
                if whole and 0 <= slip + pattern.after - end < pattern.f:
                    rows.append((end, int(-pattern.before <= end - slip <= pattern.after)))
            assert [*zip(ends.tolist(), label.tolist())] == rows
