"""A forest in the words that the engines' memories hold (docs/forest.md, "Node word").

    [63:62] kind      0: both children are nodes   1: the left one is a leaf   2: the right one   3: both
    [61:54] feature   [53:32] threshold, 22 bits, signed
    [31:0]  kind 0: address of the right child, whose sibling follows the node
    [31:16] left leaf, [15:0] right leaf   else; the child that is a node follows

A leaf is the votes for class 1 if there are two classes, else a row of the table of leaves.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meissner.forest.file import Model

NODE, ROOT, VOTE, COUNT = range(4)  # kinds of a load
FEATURES, LEAVES = 1 << 8, 1 << 16
THRESHOLD_BITS = 22
THRESHOLD_LIMIT = 1 << THRESHOLD_BITS - 1


class Words(NamedTuple):
    """``nodes``: uint64; ``roots``: word address of each tree; ``leaves``: uint16 [leaves, classes]."""

    nodes: NDArray[np.uint64]
    roots: NDArray[np.int64]
    leaves: NDArray[np.uint16]


class Inputs(NamedTuple):
    """What the engines get in each column: feature ``source``, or ``missing`` if its value is missing; None:
    no value may be."""

    source: NDArray[np.int64]
    missing: NDArray[np.int64] | None = None

    def of(self, q, missing):
        """The columns [rows, columns] of what Forest.quantise returns; ValueError for a missing value that
        they do not show."""
        columns = q[:, self.source]
        if missing is None:
            return columns
        if self.missing is None and (lost := missing[:, self.source]).any():
            row, column = np.argwhere(lost)[0]
            feature = self.source[column]
            raise ValueError(f"row {row}: feature {feature} is NaN, and the core has no column for that")
        return columns if self.missing is None else np.where(missing[:, self.source], self.missing, columns)


def fits(thresholds) -> bool:
    """Whether the thresholds, and values that saturate, keep their order in the word's bits."""
    return bool(((thresholds >= -THRESHOLD_LIMIT) & (thresholds <= THRESHOLD_LIMIT - 2)).all())


def check(model: Model) -> None:
    """Raise ValueError if the word has no room for ``model``."""
    if len(model.features) > FEATURES:
        raise ValueError(f"{len(model.features)} features are more than the {FEATURES} of a node's word")
    if len(model.classes) != 2 and len(model.leaves) > LEAVES:
        raise ValueError(f"{len(model.leaves)} distinct leaves are more than the {LEAVES} of a node's word")
    for index, tree in enumerate(model.trees):
        if not fits(tree.threshold):
            bits = f"{THRESHOLD_BITS} bits"
            raise ValueError(f"tree {index}: a threshold does not fit {bits}; export that feature as a float")


def without_missing(model: Model, room: int | None = None) -> tuple[Model, Inputs]:
    """The same decisions without missing_left, which a word has no bit for. A column per feature and side on
    which its missing values go: in one they are below every threshold, in the other above.

    ``room``: the number of columns that there are. If it is another one, or if those needed are more than a
    word can number, a column per feature, without missing values; if these are too many or not ``room``
    either, and the features that a node asks for are not, a column for each of those."""
    fitting = lambda found: len(found) <= FEATURES if room is None else len(found) == room
    distinct = lambda keys: np.unique(np.concatenate(keys)) if model.nodes else np.zeros(1, np.int64)
    columns, keys = None, []
    if model.trees[0].missing_left is not None:
        keys = [2 * tree.feature + tree.missing_left for tree in model.trees]
        columns = distinct(keys)
    if columns is None or not fitting(columns):
        sources = np.arange(len(model.features))
        if not fitting(sources) and fitting(asked := distinct([tree.feature for tree in model.trees])):
            sources = asked
        trees = [
            replace(tree, feature=np.searchsorted(sources, tree.feature), missing_left=None)
            for tree in model.trees
        ]
        return replace(model, features=[model.features[at] for at in sources], trees=trees), Inputs(sources)
    ranked = [model.features[key // 2].thresholds for key in columns]
    low = np.array([-THRESHOLD_LIMIT if each is None else 0 for each in ranked], np.int64)
    high = np.array([THRESHOLD_LIMIT - 1 if each is None else len(each) + 1 for each in ranked], np.int64)
    trees = [
        replace(tree, feature=np.searchsorted(columns, key), missing_left=None)
        for tree, key in zip(model.trees, keys)
    ]
    features = [model.features[key // 2] for key in columns]
    missing = np.where(columns % 2 == 1, low, high)
    return replace(model, features=features, trees=trees), Inputs(columns // 2, missing)


def pack(model: Model, trees=None) -> Words:
    """The memory of an engine that holds ``trees`` (indices; all by default) one after another."""
    check(model)
    two = len(model.classes) == 2
    value = model.leaves[:, 1].astype(np.int64) if two else np.arange(len(model.leaves))
    memory, roots, base = [], [], 0
    for index in range(len(model.trees)) if trees is None else trees:
        tree = model.trees[index]
        roots.append(base)
        if tree.leaf is not None:
            low = np.array([value[tree.leaf] << 16 | value[tree.leaf]])
            kind, feature, threshold = np.array([3]), np.array([0]), np.array([0])
        else:
            left, right = (
                np.where(child < 0, value[-1 - child.clip(max=-1)], 0) for child in (tree.left, tree.right)
            )
            kind = (tree.left < 0) + 2 * (tree.right < 0)
            low = np.where(kind == 0, base + tree.right, left << 16 | right)
            feature, threshold = tree.feature, tree.threshold
        high = kind << 30 | feature << THRESHOLD_BITS | threshold & (1 << THRESHOLD_BITS) - 1
        memory.append(high.astype(np.uint64) << np.uint64(32) | low.astype(np.uint64))
        base += len(low)
    leaves = model.leaves[:0] if two else model.leaves
    return Words(np.concatenate([*memory, np.zeros(0, np.uint64)]), np.array(roots, np.int64), leaves)


def spread(model: Model, engines: int) -> list[list[int]]:
    """The trees of each engine: nodes and number of trees nearly alike, the largest trees first."""
    order = sorted(range(len(model.trees)), key=lambda index: -len(model.trees[index].feature))
    turn = 2 * engines
    return [sorted(order[one::turn] + order[turn - 1 - one :: turn]) for one in range(engines)]


def loads(model: Model, engines: int) -> list[tuple[int, int, int, int]]:
    """(kind, engine, address, data) of every write that loads ``model`` (rtl/forest/msn_forest.sv)."""
    rows = []
    for engine, trees in enumerate(spread(model, engines)):
        memory = pack(model, trees)
        rows += [(NODE, engine, address, int(word)) for address, word in enumerate(memory.nodes)]
        rows += [(ROOT, engine, index, int(root)) for index, root in enumerate(memory.roots)]
        rows.append((COUNT, engine, 0, len(trees)))
    if len(model.classes) != 2:
        rows += [
            (VOTE, 0, label << 16 | row, int(value))
            for row, leaf in enumerate(model.leaves)
            for label, value in enumerate(leaf)
        ]
    return rows


def beats(words: NDArray[np.uint64]) -> NDArray[np.uint16]:
    """The four beats of 16 bits of each word, the low one first."""
    return words.astype("<u8").view("<u2")
