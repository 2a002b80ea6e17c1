"""Labelled recordings of slip, for the tests of forests: features and labels to train on and to test.

The project holds none of them: tools/published/recordings.py finds them, or says where it looked.
"""

import csv

import numpy as np
import pytest

from published.recordings import find

SOURCES = ("biotacsp", "osu_slip")


def _biotacsp():
    """72 codes of three fingertips; the files named test hold ten objects that training has not seen."""
    parts = [[], []]
    for palm in ("45", "down", "side"):
        for part, end in zip(parts, ("", "_test")):
            with find(f"biotacsp/bts3v2_palm_{palm}{end}.csv").open() as file:
                part += [row[1:] for row in list(csv.reader(file))[1:]]
    return [(rows[:, 1:], rows[:, 0]) for rows in (np.array(part, dtype=np.int64) for part in parts)]


def _osu_slip(label):
    """60 float features, one of four labels; of every four trials the last is for the test."""
    with np.load(find("osu_slip/osu_slip.npz"), allow_pickle=False) as found:
        x, y, trial = found["X"], found["Y"][:, label], found["trial"]
    test = trial % 4 == 3
    return [(x[~test], y[~test]), (x[test], y[test])]


def read(source, label=0):
    """(x, y) to train on, (x, y) to test; the test is skipped if the recordings are absent."""
    try:
        return _biotacsp() if source == "biotacsp" else _osu_slip(label)
    except ValueError as absent:
        pytest.skip(str(absent))
