"""meissner.Forest against scikit-learn: decisions of forests of known and drawn data, and at each threshold
the values around it. Expected classes and probabilities are scikit-learn's own; a class may differ only where
its two best probabilities lie within twice the stated error.
"""

import json

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.calibration import CalibratedClassifierCV
from sklearn.datasets import load_iris, load_wine, make_classification
from sklearn.ensemble import ExtraTreesClassifier, RandomForestClassifier
from sklearn.frozen import FrozenEstimator
from sklearn.inspection import permutation_importance
from sklearn.metrics import ConfusionMatrixDisplay, get_scorer
from sklearn.model_selection import cross_val_score
from sklearn.tree import DecisionTreeClassifier, ExtraTreeClassifier

import meissner
from forest.compare import ERROR, agree, sides, walk
from meissner.forest import file, quantise

IRIS, WINE = load_iris(return_X_y=True), load_wine(return_X_y=True)
LABELS = {
    "integers": lambda y: 3 * y - 1,
    "names": lambda y: np.array(["öl", "b", "c"])[y],
    "floats": lambda y: (y * 2).astype(np.float32),
    "bytes": lambda y: (y * 100).astype(np.uint8),
    "objects": lambda y: np.array(["a", "bb", np.str_("c")], object)[y],
    "two": lambda y: y == 1,
    "one": lambda y: np.full(len(y), 7),
}


@pytest.mark.parametrize("data", ["iris", "wine"])
@pytest.mark.parametrize("labels", LABELS)
def test_every_row_of_known_data_gets_scikit_learns_class(data, labels):
    """Forests that are deep, shallow, best first and a single tree, of every kind of label."""
    x, y = IRIS if data == "iris" else WINE
    y = LABELS[labels](y)
    for model in (
        RandomForestClassifier(21, random_state=1),
        RandomForestClassifier(20, max_depth=3, random_state=2, criterion="entropy"),
        ExtraTreesClassifier(20, max_leaf_nodes=6, random_state=3),
        DecisionTreeClassifier(max_leaf_nodes=7, random_state=4),
        ExtraTreeClassifier(min_samples_leaf=5, random_state=5),
    ):
        forest = meissner.Forest(model.fit(x[::2], y[::2]))
        agree(forest, model, x, f"{data}, {labels}, {type(model).__name__}")
        assert forest.classes_.tolist() == model.classes_.tolist()
        assert json.dumps(forest.model.classes) == json.dumps(model.classes_.tolist())  # true is not 1
        assert forest.predict(x).dtype == forest.classes_.dtype == model.classes_.dtype
        assert forest.predict_proba(x).dtype == model.predict_proba(x).dtype
        file.check(file.document(forest.model))


@pytest.mark.long
def test_wine_with_a_hundred_deep_trees():
    x, y = WINE
    for kind in (RandomForestClassifier, ExtraTreesClassifier):
        model = kind(100, max_depth=100, random_state=0).fit(x[::2], y[::2])
        agree(meissner.Forest(model), model, x, f"wine, {kind.__name__}")


DRAWN = ExtraTreesClassifier(3, max_depth=6, min_samples_leaf=3, random_state=1)  # thresholds of 53 bits
HALVES = RandomForestClassifier(3, max_depth=4, random_state=1)  # means of two values


@pytest.mark.parametrize("model", [DRAWN, HALVES, ExtraTreeClassifier(random_state=2)], ids=repr)
def test_values_at_each_threshold_and_a_step_of_float32_beside_it(model):
    x, y = WINE
    model.fit(x, y)
    forest = meissner.Forest(model)
    trees = getattr(model, "estimators_", [model])
    rows, above, below = sides(trees, x)
    print(f"{len(rows)} rows; the float32 of {above} thresholds is above, of {below} below")
    assert below and (above or model is HALVES)
    assert np.array_equal(forest.process(rows).index, model.predict(rows))
    assert np.array_equal(forest.process(rows).index, walk(trees, rows))


FAULTS = {  # of converters: what they do otherwise
    "values stay float64": {"of_value": np.float64},
    "thresholds become float32": {"of_threshold": np.float32},
    "below, not up to the threshold": {"compare": np.less},
    "values become integers of 16 bits": {"of_value": lambda value: np.int16(np.clip(value, -32768, 32767))},
    "thresholds with six digits": {"of_threshold": lambda value: np.float64(f"{value:.6g}")},
    "each tree votes for one class": {"hard": True},
}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_rows_show_the_faults_of_other_converters(fault):
    """Each of these gives other classes for some of the rows, while the forest gives scikit-learn's."""
    wrong = 0
    for model, x in (
        (DRAWN, WINE[0]),
        (HALVES, np.rint(WINE[0])),
    ):  # no float32 equals a threshold that is drawn
        model.fit(x, WINE[1])
        rows = np.concatenate([sides(model.estimators_, x)[0], x])
        theirs = model.predict(rows)
        wrong += (walk(model.estimators_, rows, **FAULTS[fault]) != theirs).sum()
        assert np.array_equal(meissner.Forest(model).predict(rows), theirs)
    print(f"{fault}: {wrong} rows have another class")
    assert wrong


def test_the_rank_is_the_number_of_thresholds_below():
    """By hand. 0.1f is above 0.1, so it goes right of a threshold of 0.1 and left of one of 0.1f."""
    single = float(np.float32(0.1))
    assert single > 0.1
    feature = file.Feature("a", np.array([-np.inf, -1.5, 0.1, single, 7.0])[1:])
    model = file.Model("", [0, 1], [feature], None, [])
    after = np.nextafter(np.float32(0.1), np.float32(1))
    before = np.nextafter(np.float32(0.1), np.float32(0))
    x = np.array([[-2, -1.5, -1.4, before, 0.1, after, 7, 7.1, 1e30]], np.float64).T
    ranks, missing = quantise.to_ranks(model, x)
    assert ranks.ravel().tolist() == [0, 0, 1, 1, 2, 4 - 1, 3, 4, 4] and missing is None


def test_votes_are_the_nearest_integers_and_a_half_goes_to_the_first_class():
    """By hand; 65535 / 2 = 32767.5. A leaf of one half then decides for the first class, as argmax does."""
    step = 1 / 65535
    two, three = [[0.5, 0.5], [0.25, 0.75], [1, 0]], [[0.5, 0.5, 0], [1.5 * step, 2.5 * step, 1 - 4 * step]]
    assert quantise.votes(np.array(two)).tolist() == [[32768, 32767], [16384, 49151], [65535, 0]]
    assert quantise.votes(np.array(three)).tolist() == [[32768, 32768, 0], [2, 2, 65531]]
    x = np.arange(8.0)[:, None]
    for y in ([3, 5] * 4, [3, 3, 5, 5] * 2, [3, 5, 3, 5, 9, 9, 9, 9]):
        model = DecisionTreeClassifier(max_depth=1, min_samples_leaf=4).fit(x, y)
        assert model.predict_proba(x)[0, :2].tolist() == [0.5, 0.5]
        assert meissner.Forest(model).predict(x).tolist() == model.predict(x).tolist()


def test_numbers_of_samples_are_probabilities_too():
    """As versions of scikit-learn before 1.3 have them in place of probabilities, at whatever weight."""
    model = DecisionTreeClassifier(max_leaf_nodes=5, random_state=1).fit(*IRIS)
    share = model.predict_proba(IRIS[0])
    model.tree_.value[:] *= 1e-3 * np.arange(1, model.tree_.node_count + 1)[:, None, None]
    assert model.predict_proba(IRIS[0]).sum(1).max() < 0.1
    assert np.abs(meissner.Forest(model).predict_proba(IRIS[0]) - share).max() <= ERROR


@pytest.mark.parametrize("case", range(6))
def test_drawn_forests(case):
    classes = (2, 3, 5, 2, 12, 4)[case]
    x, y = make_classification(
        400, 11, n_informative=8, n_redundant=0, n_classes=classes, flip_y=0.2, random_state=case
    )
    kind = (RandomForestClassifier, ExtraTreesClassifier)[case % 2]
    model = kind(15, max_depth=(None, 4)[case // 3], random_state=case).fit(x[:200], y[:200])
    agree(meissner.Forest(model), model, x, f"drawn {case}")


def test_one_node_one_leaf_depth_of_60_and_a_hundred_classes():
    x = np.arange(200.0)[:, None]
    for y, depth in ((x[:, 0] > 50, 1), (x[:, 0] % 2, 60), (x[:, 0] // 2, None), (x[:, 0] * 0, None)):
        model = DecisionTreeClassifier(max_depth=depth, random_state=0)
        if depth == 60:  # a chain: each node cuts off the least value
            model.set_params(splitter="best", criterion="gini")
            y = np.arange(200) % 2
            weight = 1.2 ** -np.arange(200.0)
            model.fit(x, y, sample_weight=weight)
            assert model.get_depth() >= 53
        else:
            model.fit(x, y)
        agree(meissner.Forest(model), model, np.concatenate([x, x - 0.5, x + 0.5]), f"depth {depth}")
    assert len(meissner.Forest(DecisionTreeClassifier().fit(x, x[:, 0] // 2)).classes_) == 100


def test_integers_pass_as_they_are():
    """Codes to both ends of 2^24 and thresholds that are halves or not: the floor decides alike."""
    rng = np.random.default_rng(7)
    print("seed 7")
    ends = (1 << 24) - 1
    x = np.stack(
        [rng.integers(-9, 9, 300), rng.integers(-(1 << 20), 1 << 20, 300), rng.integers(-ends, ends, 300)], 1
    )
    y = (x.sum(1) + 3 * x[:, 0] * (1 << 18) > 0).astype(int)
    model = ExtraTreesClassifier(9, random_state=1).fit(x, y)
    forest = meissner.Forest(model, integer=True)
    kinds = [feature.thresholds is None for feature in forest.model.features]
    assert kinds == [True, True, False]  # the last one's thresholds need more than 22 bits
    near = np.concatenate([x + step for step in (-1, 0, 1)]).clip(-ends, ends)
    for rows in (near, near.astype(np.float64), near.astype(np.float32)):
        agree(forest, model, rows, "integers")
    for bad, says in (
        (0.5, "row 1: x0 must be an integer"),
        (1 << 24, "row 1: x0"),
        (-(1 << 24), "row 1: x0"),
    ):
        rows = np.zeros((2, 3), type(bad))
        rows[1, 0] = bad
        with pytest.raises(ValueError, match=says):
            forest.predict(rows)
    rows = np.full((1, 3), ends)
    agree(forest, model, np.concatenate([rows, -rows]), "the ends of integers")


def test_missing_values_go_where_scikit_learn_sends_them():
    x, y = IRIS
    holes = x.copy()
    holes[np.random.default_rng(3).random(x.shape) < 0.3] = np.nan
    for model in (RandomForestClassifier(9, random_state=1), ExtraTreesClassifier(9, random_state=1)):
        for trained in (holes, x):  # without holes in training, to the child of more samples
            agree(meissner.Forest(model.fit(trained, y)), model, holes, "missing values")
    model = ExtraTreeClassifier(splitter="best").fit(x, y == 1)  # without a rule
    with pytest.raises(ValueError):
        model.predict(holes)
    with pytest.raises(ValueError, match="x1 is NaN"):
        meissner.Forest(model).predict([[1, np.nan, 2, 3]])


SCORES = ("accuracy", "f1_macro", "neg_log_loss", "roc_auc_ovr", "roc_auc", "neg_brier_score")


def test_it_stands_where_the_object_of_scikit_learn_stood():
    for classes in (3, 2):
        x, y = WINE[0], np.minimum(WINE[1], classes - 1)
        model = RandomForestClassifier(5, random_state=1).fit(x[::2], y[::2])
        forest = meissner.Forest(model)
        for name in SCORES[: 4 if classes == 3 else None]:
            score = get_scorer(name)
            assert score(forest, x, y) == pytest.approx(score(model, x, y), abs=1e-4), name
        weight = np.arange(len(y))
        assert forest.score(x, y[:, None], weight) == model.score(x, y, weight) < 1
        drawn = [permutation_importance(each, x, y, n_repeats=1, random_state=0) for each in (forest, model)]
        assert np.array_equal(*(each.importances for each in drawn))
        assert clone(forest) is forest and forest.n_classes_ == classes
        assert not hasattr(forest, "feature_names_in_")
        shown = [ConfusionMatrixDisplay.from_estimator(each, x, y) for each in (forest, model)]
        assert np.array_equal(*(each.confusion_matrix for each in shown))
        frozen = [FrozenEstimator(each) for each in (forest, model)]
        made = [CalibratedClassifierCV(each).fit(x, y).predict(x) for each in frozen]
        assert np.array_equal(*made)
        assert np.array_equal(*(cross_val_score(each, x, y) for each in (forest, frozen[1])))


class Columns(np.ndarray):
    """An array with names, as a table of pandas has them."""

    def notna(self):
        return np.array([[cell is not NA for cell in row] for row in self])


class NA:
    """What pandas has for a missing value of a column of integers; no float."""


def table(x, names):
    found = np.asarray(x, object).view(Columns)
    found.columns = names
    return found


def test_what_no_forest_takes_is_refused():
    x, y = IRIS
    forest = meissner.Forest(DecisionTreeClassifier().fit(x, y))
    for rows, says in (
        (x[:, :3], "x3 is missing"),
        (np.c_[x, x], r"shape \[rows, 4\], not \(150, 8\)"),
        ([[1, 2, np.inf, 4]], "row 0: x2 is infinite"),
        ([[1, 2, 3, 4], [1, -1e39, 3, 4]], "row 1: x1 is infinite or too large"),
        ([["1", "2", "3", "4"]], "must be numbers"),
        (np.zeros((1, 1, 4)), "shape"),
    ):
        with pytest.raises(ValueError, match=says):
            forest.process(rows)
    named = DecisionTreeClassifier().fit(x, y)
    theirs = named.predict(x)
    named.feature_names_in_ = np.array(["a", "b", "c", "d"], object)
    forest = meissner.Forest(named)
    assert forest.feature_names_in_.tolist() == ["a", "b", "c", "d"]
    with pytest.raises(ValueError, match="the feature c is missing"):
        forest.predict(table(x, ["a", "b", "x", "d"]))
    with pytest.raises(ValueError, match="in this order"):
        forest.predict(table(x, ["b", "a", "c", "d"]))
    assert np.array_equal(forest.predict(table(x, ["a", "b", "c", "d"])), theirs)
    holes, lost = x.astype(object), x.copy()
    holes[::3, 2], lost[::3, 2] = NA, np.nan
    for names in (["a", "b", "c", "d"], [0, 1, 2, 3]):  # numbers are no names, as for scikit-learn
        assert np.array_equal(forest.predict(table(holes, names)), meissner.Forest(named).predict(lost))
    named.feature_names_in_ = np.array(["x0", "y", "x2", "x3"], object)  # names as of none, but one
    with pytest.raises(ValueError, match="in this order"):
        meissner.Forest(named).predict(table(x, ["x0", "x2", "y", "x3"]))


class Sparse:
    """A matrix with few entries, as scipy's."""

    def __init__(self, x):
        self.x = x

    def toarray(self):
        return self.x


@pytest.mark.parametrize(
    "kind", [list, np.asfortranarray, Sparse, lambda x: x.astype(object), lambda x: x.astype(">f8")]
)
def test_rows_of_every_kind_are_the_same_rows(kind):
    """Objects: a table of pandas whose columns have several kinds."""
    x, y = IRIS
    model = DecisionTreeClassifier(random_state=1).fit(x, y)
    assert np.array_equal(meissner.Forest(model).predict(kind(x)), model.predict(x))
    for bad in ("x", {}, 2**2000, "2"):
        with pytest.raises(ValueError, match="must be numbers"):
            meissner.Forest(model).predict([[1, 2, bad, 4]])


def test_pieces_give_what_the_whole_gives(monkeypatch):
    x, y = WINE
    forest = meissner.Forest(RandomForestClassifier(7, random_state=1).fit(x, y))
    whole = forest.process(x)
    monkeypatch.setattr("meissner.forest.forest.PAIRS", 20)  # two rows at a time
    pieces = [forest.next(x[:5]), forest.next(x[5]), forest.next(x[6:6]), forest.next(x[6:])]
    for one, several in zip(whole, zip(*pieces)):
        assert np.array_equal(one, np.concatenate(several))
