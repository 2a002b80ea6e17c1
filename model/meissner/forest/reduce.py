"""Smaller forests out of one: fewer trees, less depth, nodes cut where the votes change least, fewer bits of
a leaf (docs/forest.md, "Budget").

A node that is cut becomes a leaf with the mean votes of the rows that reach it. Its loss is the sum of
squares about that mean, of all rows and classes. For a price a node, the trees with the least loss + price *
nodes follow from the leaves up; the price is the lowest that leaves no more nodes than there is room for."""

from dataclasses import replace
from functools import cache

import numpy as np

from meissner.forest.file import ONE, Tree
from meissner.forest.forest import PAIRS, Forest


class Reducer:
    """``x``: rows whose walks say how often each node is reached; none of the labels is needed.

    Arrays over the nodes of all trees, one after another: ``children`` [nodes, 2] (right, left), ``depth``,
    ``tree``, ``mean`` votes [nodes, classes] and ``loss``.
    """

    def __init__(self, forest: Forest, x):
        self.forest, self.model = forest, forest.model
        self.children = forest.joined.children
        sizes = np.array([len(tree.feature) for tree in self.model.trees])
        self.base = np.cumsum([0, *sizes])
        self.tree = np.repeat(np.arange(len(sizes)), sizes)
        self.levels, at = [], forest.joined.roots[forest.joined.roots >= 0]
        while at.size:
            self.levels.append(at)
            at = self.children[at].ravel()
            at = at[at >= 0]
        self.depth = np.zeros(len(self.tree), np.int64)
        for depth, level in enumerate(self.levels):
            self.depth[level] = depth
        self._count(x)
        self._rows = cache(self._rows)

    def _count(self, x):
        nodes, votes = len(self.tree), self.model.leaves.astype(np.float64)
        hits, squares, sums = np.zeros(nodes), np.zeros(nodes), np.zeros((nodes, votes.shape[1]))
        trees = len(self.model.trees)
        q, missing = self.forest.quantise(x)
        step = max(PAIRS // trees, 1)
        for start in range(0, len(q), step):
            rows = slice(start, start + step)
            paths = []
            lost = None if missing is None else missing[rows]
            leaf, _ = self.forest.walk(q[rows], lost, paths)
            got = votes[leaf.ravel()]
            square = (got**2).sum(1)
            for going, node in paths:
                hits += np.bincount(node, minlength=nodes)
                squares += np.bincount(node, square[going], nodes)
                for label in range(votes.shape[1]):
                    sums[:, label] += np.bincount(node, got[going, label], nodes)
        self.loss = squares - (sums**2).sum(1) / np.maximum(hits, 1)
        # A node that no row reaches: the mean of its children.
        self.mean = sums / np.maximum(hits, 1)[:, None]
        for level in reversed(self.levels):
            none = level[hits[level] == 0]
            below = self.children[none]
            self.mean[none] = np.where(
                (below < 0)[..., None],
                votes[-1 - np.minimum(below, -1)],
                self.mean[below.clip(0)],
            ).mean(1)

    def within(self, depth, trees=None):
        """The nodes of the first ``trees`` whose distance from the root is below ``depth``."""
        return (self.depth < depth) & (self.tree < (len(self.model.trees) if trees is None else trees))

    def priced(self, price, trees):
        """The nodes of the first ``trees`` that are worth ``price``."""
        cost, kept = np.zeros(len(self.tree)), np.zeros(len(self.tree), bool)
        for level in reversed(self.levels):
            below = self.children[level]
            split = price + np.where(below < 0, 0.0, cost[below.clip(0)]).sum(1)
            kept[level] = split < self.loss[level]
            cost[level] = np.minimum(split, self.loss[level])
        kept &= self.tree < trees
        for above, level in zip(self.levels, self.levels[1:]):
            alive = np.zeros(len(self.tree), bool)
            below = self.children[above[kept[above]]].ravel()
            alive[below[below >= 0]] = True
            kept[level] &= alive[level]
        return kept

    def cheapest(self, room, trees):
        """As many of the nodes of the first ``trees`` as ``room`` allows, those that matter most."""
        low, high = 0.0, float(self.loss.max(initial=0.0)) + 1.0
        if (kept := self.priced(low, trees)).sum() <= room:
            return kept
        for _ in range(40):
            middle = (low + high) / 2 if low else high / 64
            if self.priced(middle, trees).sum() <= room:
                high = middle
            else:
                low = middle
            if low and high < low * 1.001:
                break
        return self.priced(high, trees)

    def _rows(self, bits):
        """(table of distinct votes in ``bits``, the row of each leaf, that of each node if it is cut)."""
        whole = np.concatenate([self.model.leaves.astype(np.float64), self.mean])
        table, row = np.unique(_coarse(whole, bits), axis=0, return_inverse=True)
        return table, *np.split(row.ravel(), [len(self.model.leaves)])

    def build(self, kept, trees=None, bits=16):
        """The Model of the first ``trees`` with the nodes ``kept``, its leaves in ``bits``; a node whose two
        leaves are then the same becomes this leaf."""
        trees = len(self.model.trees) if trees is None else trees
        table, leaf_row, cut_row = self._rows(bits)
        below = self.children
        value = np.where(below < 0, leaf_row[-1 - np.minimum(below, -1)], cut_row[below.clip(0)])
        kept, cut_row = kept.copy(), cut_row.copy()
        for level in reversed(self.levels):
            inner = (below[level] >= 0) & kept[below[level].clip(0)]
            value[level] = np.where(below[level] < 0, value[level], cut_row[below[level].clip(0)])
            same = ~inner.any(1) & (value[level, 0] == value[level, 1]) & kept[level]
            kept[level[same]] = False
            cut_row[level[same]] = value[level[same], 0]
        number = np.cumsum(kept) - 1
        inner = (below >= 0) & kept[below.clip(0)]
        used = np.zeros(len(table), bool)
        roots = self.forest.joined.roots[:trees]
        at_root = lambda array, none: np.append(array, none)[roots.clip(0)]  # there may be no node at all
        alone = np.where(roots < 0, leaf_row[-1 - np.minimum(roots, -1)], at_root(cut_row, 0))
        single = (roots < 0) | ~at_root(kept, False)
        used[alone[single]] = True
        used[value[kept][~inner[kept]]] = True
        place = np.cumsum(used) - 1
        found = []
        for index in range(trees):
            if single[index]:
                none = np.zeros(0, np.int64)
                lost = None if self.model.trees[index].missing_left is None else none.astype(bool)
                found.append(Tree(none, none, none, none, lost, int(place[alone[index]])))
                continue
            own = np.flatnonzero(kept[self.base[index] : self.base[index + 1]])
            at, tree = own + self.base[index], self.model.trees[index]
            child = np.where(inner[at], number[below[at].clip(0)] - number[at[0]], -1 - place[value[at]])
            lost = None if tree.missing_left is None else tree.missing_left[own]
            found.append(Tree(tree.feature[own], tree.threshold[own], child[:, 1], child[:, 0], lost))
        return replace(self.model, leaves=table[used], trees=found)

    def distinct(self):
        """How many of the subtrees are different from each other, by what they decide."""
        seen, number = {}, np.zeros(len(self.tree), np.int64)
        nodes = self.forest.joined
        for level in reversed(self.levels):
            below = self.children[level]
            key = np.where(below < 0, below, number[below.clip(0)] + 1)
            parts = [nodes.feature[level], nodes.threshold[level], key[:, 0], key[:, 1]]
            parts += [] if nodes.missing_left is None else [nodes.missing_left[level]]
            for node, each in zip(level.tolist(), np.stack(parts, 1).tolist()):
                number[node] = seen.setdefault(tuple(each), len(seen))
        return len(seen)


def _coarse(votes, bits):
    """Votes [rows, classes] in steps of 1/(2^bits - 1), which add up to 65535: the first class that has most
    gets the rest."""
    votes = votes * (ONE / votes.sum(1, keepdims=True))
    top = (1 << bits) - 1
    if votes.shape[1] == 2:  # a half to the first class
        second = np.ceil(np.ceil(votes[:, 1] * top / ONE - 0.5) * ONE / top - 0.5)
        return np.stack([ONE - second, second], 1).astype(np.uint16)
    found = np.rint(np.rint(votes * top / ONE) * ONE / top).astype(np.int64)
    found[np.arange(len(found)), found.argmax(1)] += ONE - found.sum(1)
    return found.clip(0, ONE).astype(np.uint16)
