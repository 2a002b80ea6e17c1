"""A forest's decisions in the core's own integers: the twin of what the RTL decides, for many rows at once.

    node: q[feature] <= threshold: left, else right
    V_c = sum over trees of the votes of the leaf that a row reaches
    class = the first c with the largest V_c            probability = V_c / (65535 trees)

meissner.forest.quantise makes q of the features.
"""

from contextlib import suppress
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.forest import file, words
from meissner.forest.file import INTEGER_LIMIT, ONE, Model
from meissner.forest.quantise import to_ranks
from meissner.twins.shared import one_of, within

PAIRS = 1 << 19  # of a row and a tree, followed at the same time


class Joined(NamedTuple):
    """The nodes of all trees, one after another; the arrays cannot be written.

    ``children`` [nodes, 2]: right, left; below 0 the leaf -1 - child. ``missing_left``: None if the model has
    no rule for missing values. ``roots`` [trees]: node or leaf.
    """

    feature: NDArray[np.int64]
    threshold: NDArray[np.int64]
    children: NDArray[np.int64]
    missing_left: NDArray[np.bool_] | None
    roots: NDArray[np.int64]


class ForestResult(NamedTuple):
    """The decision about every row, named as in OUT.npz.

    Attributes
    ----------
    index : int64 [rows]
        Of the class in ``classes_``.
    votes : int64 [rows, classes]
        65535 for each tree that is certain of the class.
    """

    index: NDArray[np.int64]
    votes: NDArray[np.int64]


class Forest:
    """A forest as the core decides (rtl/forest/msn_forest.sv); it takes the place of a scikit-learn object.

    Parameters
    ----------
    model : a fitted scikit-learn forest or tree, or meissner.forest.file.Model
    integer : sequence of str, or True
        Names of features whose values are integers below 2**24 and pass as they are; True: all.
    engine : "fixed", "rtl" or "gate"
        What decides: this twin, the Verilated msn_forest, or its netlist.
    engines : int
        Tree engines of the latter two.

    Attributes
    ----------
    classes_ : [classes]
        The labels, as in scikit-learn; also of its type, if ``model`` is its object.
    n_features_in_, n_classes_ : int
    feature_names_in_ : [features]
        If the model was trained with names.
    joined : Joined
        The nodes of all trees, for those that follow them.
    run : meissner.engines.rtl_forest.Run
        The last run of the latter two engines; printed, it says how fast it was.

    Raises
    ------
    ValueError
        For a model of another kind, one that is damaged, and another engine.
    """

    _estimator_type = "classifier"  # for scikit-learn before 1.6

    def __init__(self, model: Any, integer: Any = (), engine: str = "fixed", engines: int = 1) -> None:
        one_of(("fixed", "rtl", "gate"), engine=engine)
        within(engines=(engines, 1, 64))
        self.engine, self.engines = engine, engines
        kind = getattr(getattr(model, "classes_", None), "dtype", None)
        if not isinstance(model, Model):
            from meissner.forest.sklearn import of_model

            model = of_model(model, integer)
        self.model = model
        self.classes_ = np.array(model.classes, kind)
        self.n_features_in_, self.n_classes_ = len(model.features), len(model.classes)
        names = [feature.name for feature in model.features]
        if not file.unnamed(names):
            self.feature_names_in_ = np.array(names, object)
        sizes = [len(tree.feature) for tree in model.trees]
        base = np.cumsum([0, *sizes[:-1]])
        joined = lambda name: np.concatenate([getattr(tree, name) for tree in model.trees])
        at = np.repeat(base, sizes)
        children = np.stack([joined("right"), joined("left")], 1)
        missing = model.trees[0].missing_left is not None
        self.joined = Joined(
            joined("feature"),
            joined("threshold"),
            np.where(children < 0, children, children + at[:, None]),
            joined("missing_left") if missing else None,
            np.array([tree.root + start * (tree.root == 0) for tree, start in zip(model.trees, base)]),
        )
        for array in filter(lambda part: part is not None, self.joined):
            array.setflags(write=False)

    @classmethod
    def from_file(
        cls, path: str | PathLike[str], integer: Any = (), trust: bool = False, **engine: Any
    ) -> "Forest":
        """The forest in F.json, a .skops or .onnx file, or with ``trust`` a joblib file, which runs code.

        ``engine``, ``engines``: as above.
        """
        from meissner.forest.models import either

        return cls(either(path, integer, trust).model, **engine)

    def to_file(self, path: str | PathLike[str]) -> None:
        """Write F.json."""
        file.write(path, self.model)

    def quantise(self, x: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.bool_] | None]:
        """What the nodes compare [rows, features], and which of it is missing (or None: nothing is).

        Raises
        ------
        ValueError
            For another number of features, infinity, NaN if the model has no rule for it, and numbers with a
            fraction or beyond 2**24 in a feature of integers.
        """
        names = [feature.name for feature in self.model.features]
        columns = [*getattr(x, "columns", ())]
        columns = [*map(str, columns)] if any(isinstance(each, str) for each in columns) else []
        if columns and (not file.unnamed(names) or set(names) & set(columns)):
            for name in names:
                if name not in columns:
                    raise ValueError(f"the feature {name} is missing")
            if columns != names:
                raise ValueError(f"the features must be {', '.join(names)} in this order")
        known = x.notna() if hasattr(x, "notna") else True
        x = np.asarray(x.toarray() if hasattr(x, "toarray") else x)
        if x.dtype == object:  # columns of several kinds, of pandas' own perhaps
            x = np.where(known, x, np.nan)
            with suppress(TypeError, ValueError, OverflowError):
                x = x.astype(np.float64)
        if x.dtype.kind not in "iufb":
            raise ValueError(f"the features must be numbers, not {x.dtype}")
        x = x[None] if x.ndim == 1 else x
        if x.ndim != 2 or x.shape[1] != len(names):
            lacks = f": {names[x.shape[1]]} is missing" if x.ndim == 2 and x.shape[1] < len(names) else ""
            raise ValueError(f"the rows must have the shape [rows, {len(names)}], not {x.shape}{lacks}")
        with np.errstate(over="ignore"):
            single = x.astype(np.float32)
        self._refuse(np.isinf(single), names, "is infinite or too large for a float of 32 bits")
        if self.joined.missing_left is None:
            self._refuse(np.isnan(single), names, "is NaN, and this model has no rule for missing values")
        for index, feature in enumerate(self.model.features):
            if feature.thresholds is None:
                own = x[:, index : index + 1]
                good = np.isnan(single[:, index : index + 1]) | (
                    np.abs(own.astype(np.float64)) < INTEGER_LIMIT
                )
                good &= ~(own != np.rint(own)) | (own != own)
                self._refuse(
                    ~good, names[index:], f"must be an integer below {INTEGER_LIMIT} and above its negative"
                )
        return to_ranks(self.model, x)

    @staticmethod
    def _refuse(wrong, names, says):
        if wrong.any():
            row, column = np.argwhere(wrong)[0]
            raise ValueError(f"row {row}: {names[column]} {says}")

    def next(self, x: ArrayLike) -> ForestResult:
        """Decisions about rows of features [rows, features], or [features] for one row, with the errors of
        ``quantise``; no state between rows."""
        if self.engine != "fixed":
            self.run = self._simulated(x)
            return ForestResult(self.run.index, self.run.votes)
        q, missing = self.quantise(x)
        count, trees = max(PAIRS // len(self.joined.roots), 1), self.model.leaves
        votes = np.empty((len(q), trees.shape[1]), np.int64)
        for start in range(0, len(q), count):
            rows = slice(start, start + count)
            leaf = self.walk(q[rows], None if missing is None else missing[rows])[0]
            for index in range(trees.shape[1]):
                votes[rows, index] = trees[:, index].astype(np.int64)[leaf].sum(1)
        return ForestResult(votes.argmax(1), votes)

    def process(self, x: ArrayLike) -> ForestResult:
        """The same as ``next``."""
        return self.next(x)

    def clocks(self, x: ArrayLike) -> NDArray[np.int64]:
        """Clocks of each row if it is decided alone, from its first feature to its last vote: of the engines
        rtl and gate, with the errors of ``quantise``."""
        return self._simulated(x, alone=True).alone

    def _simulated(self, x, alone=False):
        q, missing = self.quantise(x)
        from meissner.engines.rtl_forest import forest
        from meissner.engines.verilated import of_gates

        whole, inputs = words.without_missing(self.model)
        decide = of_gates(forest) if self.engine == "gate" else forest
        return decide(inputs.of(q, missing), whole, self.engines, alone=alone)

    def steps(self, x: ArrayLike) -> NDArray[np.int64]:
        """Nodes that are compared for each row in each tree [rows, trees], with the errors of
        ``quantise``."""
        q, missing = self.quantise(x)
        return self.walk(q, missing)[1]

    def walk(self, q, missing, paths=None):
        """Of what ``quantise`` returns, the leaf of each row in each tree [rows, trees], and the nodes
        compared; ``paths`` gets (row and tree, node) of each step."""
        nodes, trees = self.joined, len(self.joined.roots)
        at = np.tile(nodes.roots, len(q))
        steps = np.zeros(len(at), np.int64)
        going = np.flatnonzero(at >= 0)
        while going.size:
            node, row = at[going], going // trees
            steps[going] += 1
            if paths is not None:
                paths.append((going, node))
            feature = nodes.feature[node]
            left = q[row, feature] <= nodes.threshold[node]
            if missing is not None:
                left = np.where(missing[row, feature], nodes.missing_left[node], left)
            at[going] = after = nodes.children[node, left.astype(np.int64)]
            going = going[after >= 0]
        return (-1 - at).reshape(len(q), trees), steps.reshape(len(q), trees)

    def predict_proba(self, x: ArrayLike) -> NDArray[np.float64]:
        """Probabilities [rows, classes], within 7.7e-6 of scikit-learn's."""
        return self.next(x).votes / (ONE * len(self.model.trees))

    def predict(self, x: ArrayLike) -> NDArray[Any]:
        """The label of each row, as in scikit-learn."""
        return self.classes_[self.next(x).index]

    def score(self, x: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> float:
        """The share of the rows whose label is ``y``."""
        return float(np.average(self.predict(x) == np.asarray(y).ravel(), weights=sample_weight))

    def fit(self, x: Any = None, y: Any = None, **_: Any) -> "Forest":
        """Changes nothing: the forest is trained. What scikit-learn evaluates has to have it."""
        return self

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """What it was made of, for scikit-learn."""
        return {"model": self.model, "engine": self.engine, "engines": self.engines}

    def __sklearn_clone__(self) -> "Forest":
        return self

    def __sklearn_is_fitted__(self) -> bool:
        return True

    def __sklearn_tags__(self) -> Any:
        from sklearn.utils import ClassifierTags, InputTags, Tags, TargetTags

        nan = InputTags(sparse=True, allow_nan=self.joined.missing_left is not None)
        return Tags("classifier", TargetTags(required=False), None, ClassifierTags(), input_tags=nan)
