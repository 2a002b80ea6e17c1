"""From a trained forest's floats to the core's integers (docs/forest.md, "Arithmetic"): ranks of thresholds
for floats and floors of thresholds for integers, which change no decision; probabilities in 1/65535.
"""

from typing import Any, NamedTuple

import numpy as np

from meissner.forest.file import MAX_FEATURES, ONE, Feature, Model, Tree, check_classes
from meissner.forest.words import fits

# Of what a leaf's probabilities add up to, by which it may miss one: float32 weights of an ONNX model.
SUM_ERROR = 1e-4


class Raw(NamedTuple):
    """A tree as scikit-learn has it, arrays [nodes]; a node whose ``left`` is -1 is a leaf.

    ``value``: probabilities [nodes, classes], used at leaves. ``missing_left``: bool [nodes], or None.
    """

    feature: Any
    threshold: Any
    left: Any
    right: Any
    value: Any
    missing_left: Any = None


def check(tree, features, classes, place):
    """Raise ValueError unless ``tree`` is a tree over ``features``: before anything follows its indices."""
    if not 1 <= features <= MAX_FEATURES:
        raise ValueError(f"{place}: {features} features are not 1 to {MAX_FEATURES}")
    count = len(tree.left)
    shapes = {np.shape(part) for part in tree[:4]} | {np.shape(tree.value)[:1]}
    if not count or shapes != {(count,)} or np.shape(tree.value) != (count, classes):
        sizes = ", ".join(f"{name} {np.shape(part)}" for name, part in zip(Raw._fields, tree[:5]))
        raise ValueError(f"{place}: its arrays do not fit {classes} classes: {sizes}")

    def refuse(wrong, says):
        if (at := np.flatnonzero(wrong)).size:
            raise ValueError(f"{place}, node {at[0]}: {says(at[0])}")

    own, leaf = np.arange(count), tree.left == -1
    for name, child in (("left", tree.left), ("right", tree.right)):
        inside = (child > own) & (child < count)
        says = lambda i, n=name, c=child: f"its {n} child {c[i]} is no later node of {count}"
        refuse(~np.where(leaf, child == -1, inside), says)
    inner = ~leaf
    reached = np.bincount(np.concatenate([tree.left[inner], tree.right[inner]]), minlength=count)
    refuse((own > 0) & (reached != 1), lambda i: f"it is a child of {reached[i]} nodes, not of one")
    wrong = inner & ((tree.feature < 0) | (tree.feature >= features))
    refuse(wrong, lambda i: f"its feature {tree.feature[i]} is none of {features}")
    refuse(inner & ~(tree.threshold > -np.inf), lambda i: f"its threshold is {tree.threshold[i]}")
    wrong = ~(tree.value >= 0).all(1) | ~(tree.value.sum(1) > 0) | ~np.isfinite(tree.value).all(1)
    refuse(leaf & wrong, lambda i: f"its probabilities are {', '.join(map(str, tree.value[i][:9].tolist()))}")


def votes(probability):
    """65535 times the probabilities [leaves, classes] to the nearest integer, a half to even. Of two
    classes, the first is the rest of 65535 and gets the half: a leaf of one half decides as before."""
    if probability.shape[1] == 2:
        second = np.ceil(ONE * probability[:, 1] - 0.5).astype(np.uint16)
        return np.stack([ONE - second, second], 1)
    return np.rint(ONE * probability).astype(np.uint16)


def _in_order(left, right):
    """The number of each inner node when a node is followed by its left part, then its right part."""
    count = len(left)
    levels, inner = [], np.zeros(min(count, 1), np.int64)
    while inner.size:
        levels.append(inner)
        inner = np.concatenate([left[inner], right[inner]])
        inner = inner[inner >= 0]
    size = np.ones(count + 1, np.int64)
    size[-1] = 0  # a leaf's: index -1
    for level in reversed(levels):
        size[level] += size[left[level]] + size[right[level]]
    order = np.zeros(count + 1, np.int64)
    for level in levels:
        order[left[level]] = order[level] + 1
        order[right[level]] = order[level] + 1 + size[left[level]]
    return order[:-1]


def _ranked(threshold, integer):
    """(Feature.thresholds, node thresholds) of one feature's nodes."""
    if integer:
        floor = np.floor(threshold)
        if fits(floor):
            return None, floor.astype(np.int64)
    thresholds = np.unique(threshold[threshold < np.inf])
    return thresholds, np.searchsorted(thresholds, threshold)  # infinity: the rank that no value exceeds


def quantise(trees, classes, names, integer, source):
    """The Model of checked Raw ``trees``; ``integer``: names of features whose values pass as they are."""
    integer = (integer,) if isinstance(integer, str) else [*(integer or ())]
    check_classes(classes)
    unknown = [name for name in integer if name not in names]
    if unknown:
        raise ValueError(f"the forest has no feature {unknown[0]!r}; it has {', '.join(names[:20])}")
    inner = [tree.left != -1 for tree in trees]
    feature = np.concatenate([tree.feature[keep] for tree, keep in zip(trees, inner)]).astype(np.int64)
    given = np.concatenate([tree.threshold[keep] for tree, keep in zip(trees, inner)]).astype(np.float64)
    threshold, features = np.zeros(len(given), np.int64), []
    groups = np.split(
        np.argsort(feature, kind="stable"), np.cumsum(np.bincount(feature, minlength=len(names)))
    )
    for name, nodes in zip(names, groups):
        thresholds, threshold[nodes] = _ranked(given[nodes], name in integer)
        features.append(Feature(name, thresholds))

    leaf_votes = votes(np.concatenate([tree.value[~keep] for tree, keep in zip(trees, inner)]))
    leaves, which = np.unique(leaf_votes, axis=0, return_inverse=True)
    found, node, leaf = [], 0, 0
    for tree, keep in zip(trees, inner):
        count = int(keep.sum())
        child = np.empty(len(keep), np.int64)
        child[keep] = np.arange(count)
        child[~keep] = -1 - which.ravel()[leaf : leaf + len(keep) - count]
        left, right = child[tree.left[keep]], child[tree.right[keep]]
        order = _in_order(np.maximum(left, -1), np.maximum(right, -1))
        back = np.argsort(order)
        left, right = (
            (np.where(side < 0, side, order[side.clip(0)])[back] for side in (left, right))
            if count
            else (left, right)
        )
        lists = feature[node : node + count][back], threshold[node : node + count][back], left, right
        missing = None if tree.missing_left is None else tree.missing_left[keep][back].astype(bool)
        found.append(Tree(*lists, missing, None if count else int(-1 - child[0])))
        node, leaf = node + count, leaf + len(keep) - count
    return Model(source, classes, features, leaves, found)


def to_ranks(model, x):
    """What the nodes compare, int64 [rows, features], and what of it is missing, bool or None."""
    with np.errstate(over="ignore"):
        single = x.astype(np.float32)
    missing = np.isnan(single)
    codes = np.empty(x.shape, np.int64)
    for index, feature in enumerate(model.features):
        if feature.thresholds is not None:
            # The first threshold that is not below the value: as many are below it.
            codes[:, index] = np.searchsorted(feature.thresholds, single[:, index].astype(np.float64))
        else:
            codes[:, index] = np.where(missing[:, index], 0, single[:, index])
    return codes, missing if missing.any() else None
