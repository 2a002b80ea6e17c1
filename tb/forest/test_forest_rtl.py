"""meissner.Forest on the Verilated msn_forest, against scikit-learn's own classes and the leaves of its
trees: iris and wine with a hundred deep trees, every row; missing values; features of integers beyond the 22
bits of a node's threshold; several engines; the share of clocks that compare a node."""

import numpy as np
import pytest
from sklearn.datasets import load_iris, load_wine, make_classification
from sklearn.ensemble import ExtraTreesClassifier, RandomForestClassifier
from sklearn.tree import DecisionTreeClassifier

import meissner
from forest.compare import agree
from forest.trees import decide
from meissner.forest import cost

NEAR = 0.06  # of the clocks of a row alone: what a budget of them may miss


def near(forest, x):
    """The clocks of rows alone are those of a budget (docs/forest.md), for each row."""
    said = cost.of_rows(forest.model, np.maximum(forest.steps(x), 1), forest.engines)["block RAM"]
    alone = forest.clocks(x)
    print(f"clocks of a row alone: {alone.mean():.1f}, by the budget {said.mean():.1f}")
    assert (abs(said / alone - 1) < 3 * NEAR).all() and abs(said.mean() / alone.mean() - 1) < NEAR


IRIS, WINE = load_iris(return_X_y=True), load_wine(return_X_y=True)


def votes_of_leaves(model, x):
    """65535 times the probabilities of the leaf that scikit-learn names, rounded (docs/forest.md), summed by
    hand."""
    total = 0
    for each in getattr(model, "estimators_", [model]):
        found = each.tree_.value[each.apply(x), 0]
        total = total + np.rint(65535 * (found / found.sum(1, keepdims=True))).astype(int)
    return total


@pytest.mark.parametrize(
    "data, model, engines",
    [
        (IRIS, RandomForestClassifier(10, random_state=1), 1),
        (WINE, RandomForestClassifier(100, max_depth=100, random_state=0), 1),
        (WINE, ExtraTreesClassifier(100, max_depth=100, random_state=0), 8),
        (WINE, DecisionTreeClassifier(max_leaf_nodes=7, random_state=4), 3),
    ],
    ids=["iris", "wine, one engine", "wine, eight engines", "wine, one tree"],
)
def test_every_row_of_known_data(data, model, engines):
    x, y = data
    model.fit(x[::2], y[::2])
    forest = meissner.Forest(model, engine="rtl", engines=engines)
    agree(forest, model, x, f"{type(model).__name__}, {engines} engines")
    assert np.array_equal(forest.predict(x), model.predict(x))
    found = forest.process(x)
    assert np.array_equal(found.votes, votes_of_leaves(model, x))
    assert found.votes.tolist() == [decide(forest.model, q)[0] for q in forest.quantise(x)[0]]
    print(forest.run)
    near(forest, x[::5])


@pytest.mark.long
@pytest.mark.parametrize("engines", [1, 3])
def test_a_hundred_classes(engines):
    """The votes of a leaf take longer than its walk."""
    x = np.random.default_rng(1).normal(size=(900, 5))
    model = RandomForestClassifier(20, min_samples_leaf=3, random_state=1).fit(x, np.arange(900) % 100)
    forest = meissner.Forest(model, engine="rtl", engines=engines)
    agree(forest, model, x, "100 classes")
    near(forest, x[::20])


@pytest.mark.parametrize("engines", [1, 8])
def test_nine_of_ten_clocks_compare_a_node(engines):
    """400 default trees of a set of the size of a rope's."""
    x, y = make_classification(400, 9, n_informative=6, random_state=1)
    model = RandomForestClassifier(400, random_state=1).fit(x, y)
    forest = meissner.Forest(model, engine="rtl", engines=engines)
    assert np.array_equal(forest.predict(x[:60]), model.predict(x[:60]))
    print(forest.run)
    expected = sum(int(tree.decision_path(x[:60]).sum()) - 60 for tree in model.estimators_)
    assert forest.run.steps == expected
    assert forest.run.share >= 0.9
    near(forest, x[:60:4])


def test_missing_values_and_large_integers():
    x, y = make_classification(300, 5, n_informative=4, n_redundant=0, random_state=2)
    holes = np.where(np.random.default_rng(1).random(x.shape) < 0.2, np.nan, x)
    model = DecisionTreeClassifier(random_state=1).fit(holes, y)
    forest = meissner.Forest(model, engine="rtl")
    assert np.array_equal(forest.predict(holes), model.predict(holes))
    codes = np.rint(x * (1 << 21)).clip(1 - (1 << 24), (1 << 24) - 1)  # saturate to 22 bits in a node
    small = np.rint(x * 100)
    small[:7, 0] = [-(1 << 21), (1 << 21) - 1, 1 << 21, -(1 << 21) - 1, (1 << 24) - 1, 1 - (1 << 24), 0]
    for values in (codes, small):
        model = RandomForestClassifier(9, random_state=1).fit(values[20:], y[20:])
        forest = meissner.Forest(model, integer=True, engine="rtl", engines=2)
        agree(forest, model, values, "integers")


def test_another_engine_is_refused():
    model = DecisionTreeClassifier().fit(*IRIS)
    with pytest.raises(ValueError, match="engine = 'float'"):
        meissner.Forest(model, engine="float")
    with pytest.raises(ValueError, match="engines = 65"):
        meissner.Forest(model, engine="rtl", engines=65)


def test_no_rows_are_no_decisions():
    forest = meissner.Forest(DecisionTreeClassifier(max_depth=1).fit([[1], [2]], [3, 4]), engine="rtl")
    assert forest.predict(np.zeros((0, 1))).shape == (0,) and str(forest.run).startswith("0 decisions/s")
