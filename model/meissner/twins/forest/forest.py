"""Bit-exact twins of rtl/forest: msn_forest.sv, and of its parts msn_forest_engine.sv, msn_forest_votes.sv
and msn_forest_memory.sv.

    node: q[feature] <= threshold: left, else right
    V_c = sum over trees of the votes of the leaf that the row reaches
    class = the first c with the largest V_c

Without timing: a memory that answers late is not modelled.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meissner.twins.shared import index_width, one_of, within

NODE, ROOT, VOTE, COUNT = range(4)  # kinds of a load
ABSENT, LATE, BROKEN = 1, 2, 4  # errors of a decision
ONE = 65535
WORD_BITS = 22  # of a threshold in a word


def of_word(words):
    """(kind, feature, threshold, low half) of words (docs/forest.md), each int64."""
    words = np.asarray(words, np.uint64)
    take = lambda low, bits: (words >> np.uint64(low) & np.uint64((1 << bits) - 1)).astype(np.int64)
    threshold = take(32, WORD_BITS)
    return take(62, 2), take(54, 8), threshold - (threshold >> WORD_BITS - 1 << WORD_BITS), take(0, 32)


def stored(word, features, feature_bits):
    """``word`` after block RAM, which keeps only the bits of a feature's index and of ``feature_bits``."""
    kind, feature, threshold, low = (int(part) for part in of_word(word))
    threshold &= (1 << feature_bits) - 1
    threshold -= threshold >> feature_bits - 1 << feature_bits
    threshold &= (1 << WORD_BITS) - 1
    return kind << 62 | (feature & (1 << index_width(features)) - 1) << 54 | threshold << 32 | low


def walk(words, root, q, features, leaves):
    """Of rows ``q`` [rows, features]: (leaf that each reaches, whether its way there was broken, nodes read).

    ``leaves``: rows of the table of leaves, or None if a leaf is the votes themselves."""
    nodes, rows = len(words), len(q)
    at, leaf = np.full(rows, root), np.zeros(rows, np.int64)
    broken, steps, going = np.zeros(rows, bool), 0, np.arange(rows)
    while going.size:
        steps += going.size
        here = at[going]
        there = here < nodes
        kind, feature, threshold, low = of_word(words[np.minimum(here, nodes - 1)])
        there &= feature < features
        right = q[going, np.minimum(feature, features - 1)] > threshold
        ends = np.where(right, kind >> 1, kind & 1) == 1
        value = np.where(right, low & 0xFFFF, low >> 16)
        after = np.where(right & (kind == 0), low, here + 1)
        good = there & np.where(ends, leaves is None or value < leaves, (after > here) & (after < nodes))
        leaf[going], broken[going], at[going] = value, ~good, after
        going = going[good & ~ends]
    return leaf, broken, steps


def votes_of(leaf, table):
    """The votes [rows, classes] of leaves: two classes without a ``table``."""
    return np.stack([ONE - leaf, leaf], -1) if table is None else table[leaf].astype(np.int64)


class Decisions(NamedTuple):
    """``index`` of the class, ``votes`` of all classes [rows, classes], ``error`` bits."""

    index: NDArray[np.int64]
    votes: NDArray[np.int64]
    error: NDArray[np.int64]


class Forest:
    """``load`` and ``swap`` as at the block's port; ``next`` decides on rows with what is in use then."""

    def __init__(
        self, features, classes, trees, nodes, leaves, engines=1, banks=2, feature_bits=22, outside=False
    ):
        within(features=(features, 1, 256), classes=(classes, 1, 65536), trees=(trees, 1, 65535))
        within(nodes=(nodes, 1, 1 << 30), leaves=(leaves, 1, 65536), engines=(engines, 1, 64))
        within(feature_bits=(feature_bits, 2, WORD_BITS))
        one_of((1, 2), banks=banks)
        self.features, self.feature_bits, self.classes, self.outside = (
            features,
            feature_bits,
            classes,
            outside,
        )
        self.nodes = np.zeros((banks, engines, nodes), np.uint64)
        self.roots = np.zeros((banks, engines, trees), np.int64)
        self.table = None if classes == 2 else np.zeros((banks, leaves, classes), np.uint16)
        self.counts = np.zeros((banks, engines), np.int64)
        self.reset()

    def reset(self):
        """No forest; words stay, and their bank is not known before a swap."""
        self.counts[:] = 0
        self.bank, self.loading, self.damaged = 0, False, 0
        self._row, self._dropping = [], False
        self.steps = 0

    def load(self, kind, engine, address, data):
        """One write to the bank that is not in use; what does not exist is not written."""
        bank = 1 - self.bank if len(self.nodes) == 2 else 0
        self.loading |= len(self.nodes) == 1
        if engine >= self.nodes.shape[1] and kind != VOTE:
            return
        if kind == NODE and address < self.nodes.shape[2]:
            features = 256 if self.outside else self.features
            self.nodes[bank, engine, address] = stored(data, features, self.feature_bits)
        elif kind == ROOT and address < self.roots.shape[2]:
            self.roots[bank, engine, address] = data % (1 << index_width(self.nodes.shape[2]))
        elif kind == VOTE and self.table is not None:
            row, label = address & 0xFFFF, address >> 16
            if row < self.table.shape[1] and label < self.classes:
                self.table[bank, row, label] = data & 0xFFFF
        elif kind == COUNT and data <= self.roots.shape[2]:
            self.counts[bank, engine] = data

    def swap(self):
        """What was loaded is in use from the next decision on."""
        self.bank = (self.bank + 1) % len(self.nodes)
        self.loading = False

    def next(self, q):
        """Decisions about rows ``q`` [rows, features]."""
        q = np.asarray(q, np.int64).reshape(-1, self.features)
        votes, error = np.zeros((len(q), self.classes), np.int64), np.zeros(len(q), np.int64)
        if self.loading or not self.counts[self.bank].any():
            return Decisions(error, votes, error + ABSENT)
        table = None if self.table is None else self.table[self.bank]
        for words, roots, count in zip(self.nodes[self.bank], self.roots[self.bank], self.counts[self.bank]):
            for root in roots[:count]:
                leaf, broken, steps = walk(
                    words, root, q, self.features, None if table is None else len(table)
                )
                votes += np.where(broken[:, None], 0, votes_of(np.where(broken, 0, leaf), table))
                error |= BROKEN * broken
                self.steps += steps
        return Decisions(votes.argmax(1), votes, error)

    def beat(self, data, last):
        """One beat of a frame; the row that it completes, or None. Other frames count as ``damaged``."""
        self._row.append(data)
        fits = not self._dropping and last == (len(self._row) == self.features)
        self.damaged += not fits and not self._dropping
        row, self._dropping = self._row, not last and not fits
        if last:
            self._row = []
        return row if last and fits else None
