"""Where trees lie in four banks: a walk through the banks gives the forest's votes, each tree in one bank;
sums of walks by hand; every bank filled to the last word, and one word less."""

from types import SimpleNamespace

import numpy as np
import pytest
from sklearn.datasets import load_wine
from sklearn.ensemble import RandomForestClassifier

import meissner
from forest.test_words import ALONE, LISTS, OTHER, model, votes
from meissner.forest.place import lengths, place

BANK = 1 << 20
LEAVES = [[0, 65535], [21554, 43981], [65277, 258]]


def test_lengths_by_hand():
    """LISTS: the root, and both its children half of the time, and of one of these a child: 1 + 1/2 + 1/2 +
    1/4. OTHER: 1 + 1/2."""
    assert lengths(model(LEAVES, [0, 1])).tolist() == [2.25, 1.5, 1.0]


def test_banks_by_hand():
    """Walks of 9, 8, 7, 6 go to banks 0 to 3, then 5 to the bank of 6, 4 to that of 7, 1 to that of 8, at 8
    less than the others; each is walked when its bank is free."""
    found = place(
        model(LEAVES, [0, 1], [ALONE, OTHER, LISTS, OTHER, ALONE, OTHER, LISTS]), [5, 9, 8, 1, 7, 4, 6]
    )
    banks = dict(zip(found.order.tolist(), (found.roots // BANK).tolist()))
    assert banks == {1: 0, 2: 1, 4: 2, 6: 3, 0: 3, 5: 2, 3: 1}
    assert found.order.tolist() == [1, 2, 4, 6, 0, 5, 3]  # at 0, 0, 0, 0, 6, 7, 8
    assert found.roots.tolist() == [0, BANK, 2 * BANK, 3 * BANK, 3 * BANK + 4, 2 * BANK + 1, BANK + 4]
    assert [base for base, _ in found.blocks] == [0, BANK, 2 * BANK, 3 * BANK]
    assert hex(found.blocks[1][1][0]) == "0x3ffffd00100002"  # its right child is in the same bank


def test_full_banks():
    """Four words a bank: 4, 2 + 1 + 1, 2 + 2, 4 fit four banks of 4; of 3 they do not."""
    trees = [LISTS, OTHER, ALONE, ALONE, OTHER, OTHER, LISTS]
    found = place(model(LEAVES, [0, 1], trees), room=4)
    assert [len(words) for _, words in found.blocks] == [4, 4, 4, 4]
    with pytest.raises(ValueError, match="16 words do not fit 4 banks of 3: tree 0"):
        place(model(LEAVES, [0, 1], trees), room=3)


@pytest.mark.parametrize("classes, trees", [(2, 3), (3, 23)])
def test_a_walk_through_the_banks_gives_the_votes(classes, trees):
    x, y = load_wine(return_X_y=True)
    forest = meissner.Forest(
        RandomForestClassifier(trees, random_state=2).fit(x, np.minimum(y, classes - 1)), ()
    )
    walks = forest.steps(x).mean(0)
    found = place(forest.model, walks)
    nodes = {base + at: word for base, words in found.blocks for at, word in enumerate(words)}
    memory = SimpleNamespace(nodes=nodes, roots=found.roots, leaves=found.leaves)
    rows = forest.quantise(x)[0].tolist()
    assert [votes(memory, row, classes) for row in rows] == forest.process(x).votes.tolist()
    assert sorted(found.order) == list(range(trees))
    sums = [
        sum(walks[tree] for tree, root in zip(found.order, found.roots) if root // BANK == bank)
        for bank in range(4)
    ]
    assert trees < 4 or max(sums) - min(sums) <= walks.max()


def test_steps_are_those_of_a_plain_walk():
    x, y = load_wine(return_X_y=True)
    trained = RandomForestClassifier(7, random_state=3).fit(x, y)
    paths = [each.decision_path(x.astype(np.float32)).sum(1).A1 - 1 for each in trained.estimators_]
    assert np.array_equal(meissner.Forest(trained).steps(x), np.array(paths).T)
