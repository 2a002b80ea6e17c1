"""Bit-exact twin of rtl/forest/msn_classify.sv: the forest of a core.

    q = a feature, held at the ends of ``bits``      from frames: twins.forest.forest_features
    class, votes = the forest's                      a decision with an error changes no class
    change = the class is not the one that the host has

Every row is decided before the next one comes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.twins.forest.forest import ABSENT, BROKEN, COUNT, LATE, NODE, ROOT, VOTE, Forest
from meissner.twins.forest.forest_features import ForestFeatures
from meissner.twins.link.packet import NO_CLASS
from meissner.twins.shared import within

SLIPS = 32  # classes that the setting ``slip`` has a bit for


class Change(NamedTuple):
    """``told``: the class that the host has; NO_CLASS: none."""

    label: int
    told: int
    votes: int


class Decision(NamedTuple):
    """``change``: what a packet says, or None. ``slips``: for the reflex; None: not decided for it."""

    label: int
    votes: NDArray[np.int64]
    error: int
    change: Change | None
    slips: bool | None


class Classify:
    """``channels``: of a frame, or None for rows of a host; the other sizes and ``outside``: of Forest.

    ``next`` takes frames [channels, n], ``rows`` rows of features; ``load`` and ``swap`` as the registers.
    """

    def __init__(
        self,
        channels: int | None = 9,
        features: int = 54,
        bits: int = 18,
        slip: int = 0,
        grip: bool = False,
        outside: bool = False,
        **size: int,
    ) -> None:
        within(features=(features, 1, 256), classes=(size["classes"], 1, NO_CLASS))
        if channels is not None and features % channels:
            raise ValueError(f"features = {features} must be a multiple of channels = {channels}")
        self.forest = Forest(features, feature_bits=bits, outside=outside, **size)
        self.source = None if channels is None else ForestFeatures(channels, features // channels)
        self.bits, self.slip, self.grip = bits, slip, grip
        self.reset()

    def reset(self) -> None:
        """No forest, no class, no frames."""
        self.forest.reset()
        if self.source is not None:
            self.source.reset()
        self.refused, self.written, self.loaded = False, 0, False
        self.label = self.told = NO_CLASS
        self.best = self.decisions = self.changes = self.absent = self.late = self.broken = 0

    def clear(self) -> None:
        self.refused, self.written = False, 0

    def load(self, kind: int, engine: int, address: int, data: int) -> None:
        """One write; what has no place makes the load refused until ``clear``."""
        forest = self.forest
        _, engines, nodes = forest.nodes.shape
        leaves = 0 if forest.table is None else forest.table.shape[1]
        row, label = address & 0xFFFF, address >> 16
        there = {
            NODE: engine < engines and address < nodes,
            ROOT: engine < engines and address < forest.roots.shape[2],
            VOTE: row < leaves and label < forest.classes,
            COUNT: engine < engines and data <= forest.roots.shape[2],
        }[kind]
        if there:
            forest.load(kind, engine, address, data)
            self.written += 1
        else:
            self.refused = True

    def swap(self) -> None:
        """Use what was written, unless that is nothing or was refused."""
        if self.written and not self.refused:
            self.forest.swap()
            self.written, self.loaded = 0, True

    def next(self, x: ArrayLike) -> list[tuple[int, Decision]]:
        """(frame of ``x``, its decision) of each that completes a window."""
        assert self.source is not None
        x = np.asarray(x)
        rows = self.source.next(x)
        return list(enumerate(self.rows(rows), x.shape[1] - len(rows)))

    def rows(self, q):
        """The decisions about rows of features."""
        top = 1 << self.bits - 1
        for row in np.clip(np.asarray(q), -top, top - 1).reshape(-1, self.forest.features):
            found = self.forest.next(row)
            yield self._decided(int(found.index[0]), found.votes[0], int(found.error[0]))

    def _decided(self, label: int, votes: NDArray[np.int64], error: int) -> Decision:
        self.decisions += 1
        self.absent += bool(error & ABSENT)
        self.late += bool(error & LATE)
        self.broken += bool(error & BROKEN)
        change = slips = None
        if not error:
            self.changes += label != self.label
            self.label, self.best = label, int(votes[label])
            if label != self.told:
                change = Change(label, self.told, self.best)
                self.told = label
            if self.grip:
                slips = label < SLIPS and bool(self.slip >> label & 1)
        return Decision(self.label, votes, error, change, slips)
