"""F.json, a forest in the core's integers (docs/forest.md): read, written, checked.

A file that is not whole, or whose parts do not fit each other, is refused with its place. Each part has a
checksum, so that an edited number is refused too, and the sentence names the part that holds it.
"""

import json
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from meissner import files

FORMAT, VERSION = "meissner-forest", 1
ONE = 65535  # a probability of one
INTEGER_LIMIT = 1 << 24  # float32 holds the integers below it
MAX_TREES = 65535  # so that a sum of votes has 32 bits
MAX_CLASSES = 65536
MAX_LABEL = 1000  # characters
MAX_FEATURES = 1 << 20
_PARTS = ("format", "version", "source", "classes", "features", "leaves", "trees")
_LISTS = ("feature", "threshold", "left", "right")


@dataclass(frozen=True, eq=False)
class Feature:
    """``thresholds``: float64, ascending, if values become their ranks; None: integers that pass."""

    name: str
    thresholds: Any = None

    @property
    def bounds(self):
        """The least and the greatest threshold of a node; with the greatest rank every value goes left."""
        if self.thresholds is None:
            return -INTEGER_LIMIT, INTEGER_LIMIT - 1
        return 0, len(self.thresholds)


@dataclass(frozen=True, eq=False)
class Tree:
    """Inner nodes, int64 [nodes]; a child below 0 is the leaf -1 - child. A tree without nodes is ``leaf``.

    ``missing_left``: bool [nodes], where a value that is missing goes, or None.
    """

    feature: Any
    threshold: Any
    left: Any
    right: Any
    missing_left: Any = None
    leaf: int | None = None

    @property
    def root(self):
        """The first child to take: node 0, or the only leaf."""
        return 0 if self.leaf is None else -1 - self.leaf


@dataclass(frozen=True, eq=False)
class Model:
    """``leaves``: uint16 [distinct leaves, classes], the votes of each."""

    source: str
    classes: list
    features: list = field(repr=False)
    leaves: Any = field(repr=False)
    trees: list = field(repr=False)

    @property
    def nodes(self):
        """Inner nodes of all trees."""
        return sum(len(tree.feature) for tree in self.trees)


def unnamed(names):
    """Whether the names of features are those of a model that was trained without any."""
    return names == [f"x{index}" for index in range(len(names))]


def _dump(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)


def _sums(document):
    """The checksum of each part; of features and trees, one for each."""
    one = lambda value: f"{zlib.crc32(_dump(value).encode()):08x}"
    each = lambda part: [*map(one, document[part])] if part in ("features", "trees") else one(document[part])
    return {part: each(part) for part in _PARTS}


def document(model):
    """The contents of the file, without the checksums."""
    features = []
    for each in model.features:
        ranked = each.thresholds is not None
        kind = {"kind": "float", "thresholds": each.thresholds.tolist()} if ranked else {"kind": "integer"}
        features.append({"name": each.name} | kind)
    trees = []
    for tree in model.trees:
        lists = {name: getattr(tree, name).tolist() for name in _LISTS}
        if tree.missing_left is not None:
            lists["missing_left"] = tree.missing_left.astype(int).tolist()
        trees.append(lists | ({} if tree.leaf is None else {"leaf": tree.leaf}))
    values = (FORMAT, VERSION, model.source, model.classes, features, model.leaves.tolist(), trees)
    return dict(zip(_PARTS, values))


def check_out(path):
    """``path`` as a Path, if a forest may be written there and found again."""
    path = files.check_out(path)
    if path.suffix.lower() != ".json":
        raise ValueError(f"{path} must be a .json file: it gets a forest")
    return path


def write(path, model):
    """Write ``model``, a tree a line, if it can be read again."""
    path = check_out(path)
    whole = document(model)
    check(whole)
    lines = []
    for part, value in (whole | {"crc32": _sums(whole)}).items():
        text = "[" + ",\n".join(map(_dump, value)) + "]" if part == "trees" else _dump(value)
        lines.append(f'"{part}":{text}')
    with files.written(path) as file:
        file.write(("{" + ",\n".join(lines) + "}\n").encode())


def _pairs(pairs):
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"{next(name for name in names if names.count(name) > 1)!r:.40} stands there twice")
    return found


def _constant(name):
    raise ValueError(f"{name} is no number that a forest holds")


def read(path):
    """The forest in ``path``; ValueError names the place that is wrong."""
    path = files.check_in(path)
    try:
        text = path.read_bytes().decode()
    except UnicodeDecodeError as problem:
        raise ValueError(f"{path} is no text: byte {problem.start} is not UTF-8") from None
    try:
        whole = json.loads(text, object_pairs_hook=_pairs, parse_constant=_constant)
    except json.JSONDecodeError as at:
        place = f"line {at.lineno}, column {at.colno}"
        raise ValueError(f"{path} is no whole JSON: {at.msg} at {place}") from None
    except (ValueError, RecursionError) as problem:
        raise ValueError(f"{path} cannot be read: {problem}") from None
    try:
        model = check(whole, sums=True)
    except ValueError as problem:
        raise ValueError(f"{path}: {problem}") from None
    return model


def _check_keys(value, place, needed, optional=()):
    if type(value) is not dict:
        raise ValueError(f"{place} must be an object, not {type(value).__name__}")
    for name in needed:
        if name not in value:
            raise ValueError(f"{place} has no {name}")
    for name in value:
        if name not in (*needed, *optional):
            raise ValueError(f"{place} has a key {name!r:.40}, which version {VERSION} does not know")


def _check_list(value, place, most=None):
    if type(value) is not list or (most is not None and not 1 <= len(value) <= most):
        number = "" if most is None else f" of 1 to {most}"
        found = f"{len(value)}" if type(value) is list else type(value).__name__
        raise ValueError(f"{place} must be a list{number}, not {found}")
    return value


def _integers(values, place, unit):
    """``values`` as int64 [...] if they are integers of 32 bits."""
    for index, value in enumerate(_check_list(values, place)):
        if type(value) is not int or not -(1 << 31) <= value < 1 << 31:
            raise ValueError(f"{place}, {unit} {index}: {value!r:.40} must be an integer of 32 bits")
    return np.array(values, np.int64)


def check_classes(classes):
    """``classes``, if they are labels that a file holds."""
    kinds = {type(label) for label in _check_list(classes, "classes", MAX_CLASSES)}
    if len(kinds) > 1 or not kinds <= {bool, int, float, str}:
        raise ValueError("classes must be labels of one kind: integers, floats, strings or true and false")
    low, high = min(classes), max(classes)
    if kinds == {int} and not (low >= -(1 << 63) and high < 1 << (63 if low < 0 else 64)):
        raise ValueError(f"classes: {low!r:.40} to {high!r:.40} must be integers of 64 bits")
    if kinds == {float} and not -np.inf < low <= high < np.inf:
        raise ValueError("classes must be finite")
    if kinds == {str}:
        for label in classes:
            if len(label) > MAX_LABEL or label.endswith("\0"):
                raise ValueError(
                    f"classes: {label!r:.40} has more than {MAX_LABEL} characters or ends in \\0"
                )
    if len(set(classes)) < len(classes):
        again = next(label for index, label in enumerate(classes) if label in classes[:index])
        raise ValueError(f"classes: {again!r:.40} stands there twice")
    return classes


def _feature(value, place):
    _check_keys(value, place, ("name", "kind"), ("thresholds",))
    kind, ranked = value["kind"], "thresholds" in value
    if type(value["name"]) is not str:
        raise ValueError(f"{place}: its name must be a string")
    if kind not in ("integer", "float") or ranked != (kind == "float"):
        raise ValueError(f"{place}: its kind must be integer, or float with thresholds")
    if not ranked:
        return Feature(value["name"])
    for index, threshold in enumerate(_check_list(value["thresholds"], f"{place}, thresholds")):
        if type(threshold) is not float or not abs(threshold) < float("inf"):
            raise ValueError(f"{place}, threshold {index}: {threshold!r:.40} must be a finite float")
    thresholds = np.array(value["thresholds"], np.float64)
    if (fall := np.flatnonzero(np.diff(thresholds) <= 0)).size:
        raise ValueError(f"{place}, threshold {fall[0] + 1} must be above the one before it")
    return Feature(value["name"], thresholds)


def _leaves(rows, classes):
    votes = []
    for index, row in enumerate(_check_list(rows, "leaves", 1 << 31)):
        place = f"leaf {index}"
        found = _integers(row, place, "class")
        if len(found) != classes:
            raise ValueError(f"{place} has {len(found)} votes for {classes} classes")
        if (
            found.min() < 0
            or found.max() > ONE
            or 2 * abs(found.sum() - ONE) > (classes if classes > 2 else 0)
        ):
            raise ValueError(f"{place}: its votes must lie in 0 .. {ONE} and add up to {ONE}")
        votes.append(found.astype(np.uint16))
    return np.stack(votes)


def _tree(value, place, bounds, leaves):
    _check_keys(value, place, _LISTS, ("missing_left", "leaf"))
    lists = {name: _integers(value[name], f"{place}, {name}", "node") for name in value if name != "leaf"}
    count = len(lists["feature"])
    for name, found in lists.items():
        if len(found) != count:
            raise ValueError(f"{place} has {count} nodes, but {len(found)} in {name}")
    missing = lists.pop("missing_left", None)
    own = np.arange(count)
    feature = lists["feature"]

    def check(wrong, what):
        if (at := np.flatnonzero(wrong)).size:
            raise ValueError(f"{place}, node {at[0]}: {what(at[0])}")

    def outside(found, low, high, name):
        bad = (found < low) | (found > high)
        check(bad, lambda i: f"{name} = {found[i]} must lie in {[*low][i]} .. {[*high][i]}")

    outside(feature, own * 0, own * 0 + len(bounds) - 1, "feature")
    outside(lists["threshold"], *bounds[feature].T.reshape(2, count), "threshold")
    if missing is not None:
        outside(missing, own * 0, own * 0 + 1, "missing_left")
    for name in ("left", "right"):
        child = lists[name]
        says = f"must be a later node below {count}, or a leaf, {-leaves} .. -1"
        wrong = (child < -leaves) | (child >= count) | ((child >= 0) & (child <= own))
        check(wrong, lambda i, c=child, start=f"{name} =", end=says: f"{start} {c[i]} {end}")
    first = np.where(lists["left"] >= 0, lists["left"], lists["right"])
    check((first >= 0) & (first != own + 1), lambda i: f"its first inner child must be node {i + 1}")
    children = np.concatenate([lists["left"], lists["right"]])
    reached = np.bincount(children[children >= 0], minlength=count)
    check((own > 0) & (reached != 1), lambda i: f"it is a child of {reached[i]} nodes, not of one")
    leaf = value.get("leaf")
    if (leaf is None) == (count == 0):
        raise ValueError(f"{place} must have nodes or be one leaf")
    if leaf is not None and (type(leaf) is not int or not 0 <= leaf < leaves):
        raise ValueError(f"{place}: leaf = {leaf!r:.40} must lie in 0 .. {leaves - 1}")
    return Tree(**lists, missing_left=None if missing is None else missing == 1, leaf=leaf)


def check(whole, sums=False):
    """The Model of a file's contents; ValueError names the place that is wrong. ``sums``: with checksums."""
    if type(whole) is not dict or whole.get("format") != FORMAT:
        raise ValueError(f'this is no forest: "format" must be "{FORMAT}"')
    if type(whole.get("version")) is not int or whole["version"] != VERSION:
        raise ValueError(f"version {whole.get('version')!r:.40} is not known, only {VERSION}")
    _check_keys(whole, "the file", (*_PARTS, "crc32") if sums else _PARTS)
    if type(whole["source"]) is not str:
        raise ValueError("source must be a string")
    classes = check_classes(whole["classes"])
    listed = enumerate(_check_list(whole["features"], "features", MAX_FEATURES))
    features = [_feature(value, f"feature {index}") for index, value in listed]
    leaves = _leaves(whole["leaves"], len(classes))
    bounds = np.array([each.bounds for each in features], np.int64)
    listed = enumerate(_check_list(whole["trees"], "trees", MAX_TREES))
    trees = [_tree(value, f"tree {index}", bounds, len(leaves)) for index, value in listed]
    with_missing = [tree.missing_left is not None for tree in trees]
    if len(set(with_missing)) > 1:
        raise ValueError(f"tree {with_missing.index(False)} has no missing_left, but others have")
    if sums:
        _check_sums(whole)
    return Model(whole["source"], classes, features, leaves, trees)


def _check_sums(whole):
    said = "its crc32 does not match: it was edited or damaged"
    _check_keys(whole["crc32"], "crc32", _PARTS)
    for part, found in _sums(whole).items():
        given = whole["crc32"][part]
        if type(found) is list and type(given) is list and len(found) == len(given):
            for index, (one, other) in enumerate(zip(found, given)):
                if one != other:
                    raise ValueError(f"{part.removesuffix('s')} {index}: {said}")
        elif found != given:
            raise ValueError(f"{part}: {said}")
