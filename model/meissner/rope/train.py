"""``meissner train-rope``: a forest trained on simulated ropes as published, and its tables beside the
published.

data      ropes a and c, five positions, force and speed control, four pairs of values each, three times:
          2 * 5 * 2 * 4 pairs of 2 values are 160 patterns, 80 pairs, 240 recordings, 480 sections
test      32 sections, 24 of them slipping, drawn from the 480; the others give the training set
validation  a tenth of the training set's windows, drawn; the forest is trained on the rest
"""

from dataclasses import replace
from itertools import product

import numpy as np

from meissner.forest.sklearn import EXTRA
from meissner.physics import rope
from meissner.rope import labels
from meissner.rope.labels import FORCES_N, HELD_OUT, SPEEDS_MM_S, TIMES, TRAINED

TREES, VALIDATED = 400, 0.1
MEASURES = ("accuracy", "recall 0", "recall 1", "precision 0", "precision 1")


def pulls(like):
    """The 240 pulls; times and grip as of ``like``. A post holds the rope's end."""
    modes = (("force", FORCES_N), ("speed", SPEEDS_MM_S))
    return [
        replace(like, rope=name, position=position, mode=mode, values=values, post=True)
        for name, position, (mode, pairs) in product(TRAINED, rope.POSITIONS, modes)
        for values in pairs
        for _ in range(TIMES)
    ]


def steps(recording):
    """Differences of successive frames [frames - 1, 9]: row n - 1 is that of frame n."""
    return np.diff(recording.channels.T, axis=0)


def windows(differences, ends, w):
    """Features [ends, 9 w]: the differences of the frames end - w + 1 .. end, the oldest first."""
    rows = ends[:, None] - w + np.arange(w)
    return differences[rows].reshape(len(ends), w * differences.shape[1])


class Data:
    """Sections of recordings, and which of them are for the test; ``seed`` draws."""

    def __init__(self, recordings, seed):
        each = [(steps(one), one.sections) for one in recordings]
        every = [(differences, section) for differences, own in each for section in own]
        rng, test = np.random.default_rng([seed, 3]), []
        for slips, count in HELD_OUT.items():
            own = [k for k, (_, section) in enumerate(every) if (section.slip is not None) == slips]
            if len(own) <= count:
                raise ValueError(f"{len(own)} sections {'with' if slips else 'without'} slip are too few")
            test += rng.choice(own, count, replace=False).tolist()
        self.test = [every[k] for k in sorted(test)]
        self.rest = [one for k, one in enumerate(every) if k not in set(test)]
        self.slipping = sum(section.slip is not None for _, section in self.rest)
        self.seed = seed

    def rows(self, pattern, of=labels.training):
        """(features, labels) of all sections for the test or for the training set."""
        found = []
        for differences, section in self.test if of is labels.testing else self.rest:
            ends, label = of(section, pattern)
            found.append((windows(differences, ends, pattern.w), label))
        return tuple(np.concatenate(part) for part in zip(*found))

    def split(self, pattern):
        """((features, labels) to train on, those to validate)."""
        x, y = self.rows(pattern)
        order = np.random.default_rng([self.seed, 4]).permutation(len(y))
        held = round(VALIDATED * len(y))
        return (x[order[held:]], y[order[held:]]), (x[order[:held]], y[order[:held]])


def fit(x, y, seed, trees=TREES):
    """scikit-learn's RandomForestClassifier with its defaults."""
    try:
        from sklearn.ensemble import RandomForestClassifier
    except ImportError:
        raise ValueError(f"to train a forest needs scikit-learn: {EXTRA}") from None
    return RandomForestClassifier(trees, random_state=seed).fit(x, y)


def measures(truth, found):
    """MEASURES as shares; None where nothing is counted."""
    share = lambda of, among: float(np.mean(of[among])) if among.any() else None
    right = found == truth
    return (
        share(right, truth >= 0),
        *(share(right, truth == label) for label in (0, 1)),
        *(share(right, found == label) for label in (0, 1)),
    )
