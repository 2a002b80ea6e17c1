"""Forests of scikit-learn: an object in memory, or a joblib file, whose loading runs code."""

import warnings
from contextlib import suppress

import numpy as np

from meissner.forest.quantise import Raw, check, quantise

KINDS = ("RandomForestClassifier", "ExtraTreesClassifier", "DecisionTreeClassifier", "ExtraTreeClassifier")
TAKEN = "RandomForestClassifier, ExtraTreesClassifier or DecisionTreeClassifier"
OUTPUTS = "outputs; the core decides one class"
EXTRA = "pip install 'meissner-touch[forest]'"
RUNS_CODE = "a joblib or pickle file runs code when it is loaded: give --trust if you know who made it"


def read(path, trust=False):
    """The object in a joblib or pickle file."""
    if not trust:
        raise ValueError(f"it was not loaded: {RUNS_CODE}")
    try:
        import joblib
        import sklearn  # noqa: F401
    except ImportError:
        raise ValueError(f"it needs scikit-learn: {EXTRA}") from None
    return quietly(joblib.load, path)


def quietly(load, *given, **more):
    """What ``load`` returns, without scikit-learn's warnings of another version, which `of_model` notes."""
    with warnings.catch_warnings(record=True, action="always") as said:
        found = load(*given, **more)
    for each in said:
        with suppress(AttributeError):
            found._trained_by = each.message.original_sklearn_version
    return found


def no_forest(kind):
    """The sentence for a model of another ``kind``."""
    inside = {"Boost": "boosted trees add margins, which is another vote"}
    inside |= dict.fromkeys(("SearchCV", "Pipeline", "Frozen"), "export the forest inside it alone")
    other = "".join(f"; {says}" for part, says in inside.items() if part in kind)
    article = "an" if kind[0] in "AEIU" else "a"
    return ValueError(f"{article} {kind} is no forest that votes with probabilities: {TAKEN}{other}")


def own(given, model):
    """(name, function) of scikit-learn itself: rows to (index of the class, probabilities)."""

    def decide(x):
        with warnings.catch_warnings(action="ignore"):  # the rows have no names of features
            share = given.predict_proba(x)
        return share.argmax(1), share

    import sklearn

    return f"scikit-learn {sklearn.__version__} {type(given).__name__}", decide


def refusal(path, problem):
    """The sentence for whatever loading a damaged file raises: it can fail anywhere."""
    if isinstance(problem, OSError) and problem.filename:
        return problem
    line = str(problem).partition("\n")[0]
    ours = isinstance(problem, ValueError) and line
    return ValueError(f"{path}: {line if ours else f'it is damaged ({type(problem).__name__}: {line})'}")


def of_model(model, integer=()):
    """The Model of a fitted forest or tree; ``integer``: names of features, or True for all."""
    kind = type(model)
    if kind.__module__.split(".")[0] != "sklearn" or kind.__name__ not in KINDS:
        raise no_forest(kind.__name__)
    forest = kind.__name__ in KINDS[:2]
    if not hasattr(model, "estimators_" if forest else "tree_"):
        raise ValueError(f"the {kind.__name__} is not fitted")
    import sklearn

    if model.n_outputs_ != 1:
        raise ValueError(f"the {kind.__name__} has {model.n_outputs_} {OUTPUTS}")
    labels = np.asarray(model.classes_)
    if labels.dtype.kind in "mM":
        raise ValueError(f"its classes are times ({labels.dtype}): train it with their texts")
    classes = [each.item() if isinstance(each, np.generic) else each for each in labels.tolist()]
    features = model.n_features_in_
    trees = []
    for index, each in enumerate(model.estimators_ if forest else [model]):
        if type(each).__name__ not in KINDS[2:] or not hasattr(each, "tree_"):
            raise ValueError(f"tree {index} is a {type(each).__name__}, not a fitted tree")
        trees.append(_raw(each, features, len(classes), f"tree {index}"))
    if not trees:
        raise ValueError(f"the {kind.__name__} has no trees")
    names = [*map(str, getattr(model, "feature_names_in_", [f"x{index}" for index in range(features)]))]
    integer = names if integer is True else integer
    now = sklearn.__version__
    trained = getattr(model, "_trained_by", now)
    source = f"scikit-learn {trained} {kind.__name__}" + f", read by {now}" * (trained != now)
    return quantise(trees, classes, names, integer, source)


def _raw(each, features, classes, place):
    tree = each.tree_
    if tree.node_count > tree.capacity:  # its arrays would end behind its memory
        raise ValueError(f"{place}: it has {tree.node_count} nodes and memory for {tree.capacity}")
    if tree.n_features != features:
        raise ValueError(f"{place}: it has {tree.n_features} features, the model {features}")
    if tree.n_outputs != 1 or tree.value.shape[1:] != (1, classes):
        raise ValueError(f"{place}: its values {tree.value.shape} do not fit {classes} classes")
    names = ("feature", "threshold", "children_left", "children_right")
    takes_missing = getattr(each, "_support_missing_values", None)
    takes_missing = takes_missing is not None and takes_missing(np.zeros((1, 1)))
    value = tree.value[:, 0]
    raw = Raw(
        *(getattr(tree, name) for name in names),
        value,
        tree.missing_go_to_left == 1 if takes_missing else None,
    )
    check(raw, features, classes, place)
    total = value.sum(1, keepdims=True)  # numbers of samples before scikit-learn 1.3
    return raw._replace(
        value=np.where(np.abs(total - 1) < 1e-9, value, value / np.where(total > 0, total, 1))
    )
