"""Smaller forests: losses and means by hand, the best subtrees against all there are, decisions of what is
built against a plain walk that stops where nodes were cut, leaves of fewer bits by hand."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from sklearn.datasets import load_wine
from sklearn.ensemble import RandomForestClassifier
from sklearn.tree import DecisionTreeClassifier

import meissner
from forest.test_words import ALONE, LISTS, OTHER, model
from meissner.forest import file
from meissner.forest.reduce import Reducer, _coarse

LEAVES = [[0, 65535], [21554, 43981], [65277, 258]]


def reducer(rows, trees=(LISTS, OTHER, ALONE), leaves=LEAVES):
    forest = meissner.Forest(model(leaves, [0, 1], trees))
    return Reducer(forest, np.array(rows, np.float64))


def test_means_and_losses_by_hand():
    """LISTS: node 1 gets (-4, 0) and (-5, 9), which end in leaves 0 and 1, node 2 gets (0, -1) in leaf 1
    through node 3. OTHER: all rows reach leaf 0 by none of its nodes but the first and the second: x0 <= 1 is
    leaf 2."""
    found = reducer([(-4, 0), (-5, 9), (0, -1)])
    half = lambda *votes: [sum(65535 - v for v in votes) / len(votes), sum(votes) / len(votes)]
    assert found.mean[1].tolist() == half(65535, 43981) and found.mean[3].tolist() == half(43981)
    assert found.mean[0].tolist() == pytest.approx(half(65535, 43981, 43981))
    a, b = Fraction(65535), Fraction(43981)
    spread = lambda *votes: 2 * sum((v - sum(votes) / len(votes)) ** 2 for v in votes)
    assert found.loss[:4].tolist() == pytest.approx([spread(a, b, b), spread(a, b), 0, 0], abs=1)
    assert found.loss[4:].tolist() == pytest.approx([0, 0], abs=1)
    assert found.depth.tolist() == [0, 1, 1, 2, 0, 1]
    assert found.within(2).tolist() == [1, 1, 1, 0, 1, 1] and not found.within(0).any()
    assert found.within(1, 1).tolist() == [1, 0, 0, 0, 0, 0]


def test_a_node_that_no_row_reaches_has_the_mean_of_its_children():
    """LISTS, node 3: leaves 1 and 2; node 2: half of node 3 and half of leaf 2."""
    found = reducer([(-4, 0)])
    assert found.mean[3].tolist() == [(21554 + 65277) / 2, (43981 + 258) / 2]
    assert found.mean[2].tolist() == [((21554 + 65277) / 2 + 65277) / 2, ((43981 + 258) / 2 + 258) / 2]


def subtrees(children, node):
    """Every set of nodes that may remain of a subtree: none, or its root with some of either side."""
    if node < 0:
        return [frozenset()]
    sides = [subtrees(children, child) for child in children[node]]
    return [frozenset(), *(frozenset({node}) | a | b for a, b in itertools.product(*sides))]


def test_the_nodes_kept_are_the_best_of_that_number():
    x, y = load_wine(return_X_y=True)
    x = x[:, :3]
    trained = DecisionTreeClassifier(max_leaf_nodes=10, random_state=1).fit(x, y)
    forest = meissner.Forest(trained)
    found = Reducer(forest, x)
    leaves = forest.process(x).votes.astype(float)

    def loss(kept):
        """Sum of squares about the means of the groups that the kept nodes make."""
        q = forest.quantise(x)[0]
        groups = {}
        for row, votes in zip(q, leaves):
            node = 0
            while node >= 0 and node in kept:
                left = row[forest.joined.feature[node]] <= forest.joined.threshold[node]
                node = forest.joined.children[node, int(left)]
            groups.setdefault(node if node >= 0 else (node, *votes), []).append(votes)
        return sum(((np.array(group) - np.mean(group, 0)) ** 2).sum() for group in groups.values())

    every = {}
    for kept in subtrees(found.children.tolist(), 0):
        every[len(kept)] = min(every.get(len(kept), np.inf), loss(kept))
    seen = set()
    for room in range(10):
        kept = frozenset(np.flatnonzero(found.cheapest(room, 1)).tolist())
        assert len(kept) <= room and loss(kept) == pytest.approx(every[len(kept)], rel=1e-9, abs=1e-3)
        seen.add(len(kept))
    assert {0, 9} <= seen and len(seen) > 4


@pytest.mark.parametrize("classes, holes", [(2, False), (3, False), (3, True)])
def test_what_is_built_decides_as_a_walk_that_stops(classes, holes):
    x, y = load_wine(return_X_y=True)
    if holes:
        x = np.where(np.random.default_rng(1).random(x.shape) < 0.2, np.nan, x)
    trained = RandomForestClassifier(7, random_state=2).fit(x, np.minimum(y, classes - 1))
    forest = meissner.Forest(trained)
    found = Reducer(forest, x)
    for kept, trees in (
        (found.within(3), 7),
        (found.within(2, 4), 4),
        (found.cheapest(30, 7), 7),
        (found.within(0), 7),
        (found.within(99), 7),
    ):
        small = found.build(kept, trees)
        file.check(file.document(small))
        q, missing = forest.quantise(x)
        votes = np.zeros((len(x), classes))
        for index, row in enumerate(q):
            for root in forest.joined.roots[:trees]:
                node = root
                while node >= 0 and kept[node]:
                    feature = forest.joined.feature[node]
                    left = row[feature] <= forest.joined.threshold[node]
                    if missing is not None and missing[index, feature]:
                        left = forest.joined.missing_left[node]
                    node = forest.joined.children[node, int(left)]
                votes[index] += forest.model.leaves[-1 - node] if node < 0 else found.mean[node]
        got = meissner.Forest(small).process(x).votes
        assert np.abs(got - votes).max() <= trees * (1.0 if classes > 2 else 0.5) + 1e-6
        assert small.nodes <= kept.sum() and len(small.trees) == trees
    assert small.nodes == forest.model.nodes and (got == forest.process(x).votes).all()


def test_leaves_of_fewer_bits_by_hand():
    """Two classes: a half goes to the first; 32767.5 is the middle of 16 bits. Three: the largest gets the
    rest."""
    two = lambda *second: np.array([[65535 - value, value] for value in second])
    assert _coarse(two(32767, 32767.5, 32768, 65535), 16)[:, 1].tolist() == [32767, 32767, 32768, 65535]
    assert _coarse(two(32767, 32767.5, 32768, 65535), 1)[:, 1].tolist() == [0, 0, 65535, 65535]
    assert _coarse(two(2184, 2185, 30583), 4)[:, 1].tolist() == [0, 4369, 30583]  # steps of 4369
    assert _coarse(np.array([[21845, 21845, 21845]]), 2).tolist() == [[21845] * 3]
    assert _coarse(np.array([[40000, 20000, 5535]]), 1).tolist() == [[65535, 0, 0]]
    assert _coarse(np.array([[22000, 21768, 21767]]), 1).tolist() == [[65535, 0, 0]]


def test_a_node_whose_leaves_become_the_same_goes():
    """At one bit, leaves 0 and 1 are both class 1: LISTS loses node 1; node 3 asks between 1 and 2, and
    stays."""
    found = reducer([(-4, 0), (-5, 9), (0, -1)])
    small = found.build(np.ones(6, bool), bits=1)
    assert [tree.feature.tolist() for tree in small.trees] == [[0, 0, 1], [1, 0], []]
    assert small.leaves.tolist() == [[0, 65535], [65535, 0]]
    assert small.trees[0].left.tolist() == [-1, 2, -1] and small.trees[0].right.tolist() == [1, -2, -2]


def test_equal_subtrees_are_counted_once():
    """OTHER twice, and LISTS with OTHER's nodes in another place of the tree."""
    assert reducer([(0, 0)], (OTHER, LISTS, OTHER, ALONE)).distinct() == 6
    chain = dict(feature=[0, 1, 0], threshold=[7, *OTHER["threshold"]], left=[1, -1, -3], right=[-1, 2, -1])
    assert reducer([(0, 0)], (OTHER, chain)).distinct() == 3
    assert reducer([(0, 0)], (ALONE,)).distinct() == 0
