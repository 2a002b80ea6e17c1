"""Forests in skops files. skops refuses scikit-learn's Tree, because it checks no indices when it is made or
asked; it is trusted here after the numbers of every tree in the file were checked.
"""

import io
import json
import zipfile

import numpy as np

from meissner.forest.quantise import Raw, check
from meissner.forest.sklearn import EXTRA, KINDS, OUTPUTS, no_forest, quietly
from meissner.forest.sklearn import of_model as of_model  # as of the other kinds of files
from meissner.forest.sklearn import own as own

TREE = "sklearn.tree._tree.Tree"
_STATE = {"max_depth", "node_count", "nodes", "values"}


def read(path, trust=False):
    """The object in a skops file; ``trust`` changes nothing."""
    try:
        import skops.io
        from skops.io.exceptions import UntrustedTypesFoundException
    except ImportError:
        raise ValueError(f"it needs skops: {EXTRA}") from None
    data = path.read_bytes()
    try:
        _check_trees(data)
        return quietly(skops.io.loads, data, trusted=[TREE])
    except UntrustedTypesFoundException:
        types = ", ".join(name for name in skops.io.get_untrusted_types(data=data) if name != TREE)
        raise ValueError(f"it holds {types}, and no forest needs that") from None
    except zipfile.BadZipFile:
        raise ValueError("it is no whole skops file") from None


def _nodes(schema):
    """Every object of the schema, at any depth."""
    waiting = [schema]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            yield value
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value


def _check_trees(data):
    """Raise ValueError unless each Tree that skops would make has fitting numbers."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        schema = json.loads(archive.read("schema.json"))
        whole, module = schema["__class__"], schema["__module__"]
        if whole not in KINDS and module.split(".")[0] == "sklearn":
            raise no_forest(whole)
        parts, number = {}, 0  # of trees, by the numbers of objects
        for node in _nodes(schema):
            named = node.get("__class__"), node.get("__module__")
            if node.get("__loader__") == "TreeNode" or named == ("Tree", "sklearn.tree._tree"):
                try:
                    tree = _tree(node, archive, number)
                except (KeyError, TypeError, AttributeError):
                    raise ValueError(f"tree {number} of the file is not as skops writes it") from None
                check(*tree, f"tree {number} of the file")
                parts |= {part["__id__"]: part for part in _nodes(node) if "__id__" in part}
                number += 1
        for node in _nodes(schema):
            # skops takes an object whose number it has seen for the earlier one, whatever this one says.
            if parts.get(node.get("__id__"), node) != node:
                raise ValueError(f"a part of a tree and another object have the number {node['__id__']}")


def _tree(node, archive, number):
    """(Raw, features, classes) of an object of the schema; its errors are those of another form."""
    from sklearn.tree._tree import NODE_DTYPE

    def whole(part):
        value = json.loads(part["content"])
        if part["__loader__"] != "JsonNode" or type(value) is not int:
            raise TypeError
        return value

    def array(part):
        if (part["__loader__"], part["type"]) != ("NdArrayNode", "numpy"):
            raise TypeError
        return np.load(io.BytesIO(archive.read(part["file"])), allow_pickle=False)

    args, state = node["__reduce__"]["args"], node["content"]
    loaders = node["__loader__"], args["__loader__"], state["__loader__"]
    if loaders != ("TreeNode", "TupleNode", "DictNode") or set(state["content"]) != _STATE:
        raise TypeError
    features, classes, outputs = args["content"]
    features, classes, outputs = whole(features), array(classes), whole(outputs)
    if outputs > 1:
        raise ValueError(f"tree {number} of the file has {outputs} {OUTPUTS}")
    count, nodes, values = (state["content"][name] for name in ("node_count", "nodes", "values"))
    count, nodes, values = whole(count), array(nodes), array(values)
    whole(state["content"]["max_depth"])
    fits = outputs == 1 and features >= 1 and classes.shape == (1,) and classes.dtype.kind in "iu"
    fits = fits and nodes.dtype == NODE_DTYPE and nodes.shape == (count,) and values.dtype == np.float64
    if not fits or values.shape != (count, 1, classes[0]):
        raise TypeError
    names = ("feature", "threshold", "left_child", "right_child")
    return Raw(*(nodes[name] for name in names), values[:, 0]), features, int(classes[0])
