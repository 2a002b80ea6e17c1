"""Forests in ONNX files: TreeEnsembleClassifier as skl2onnx writes it for scikit-learn's."""

import numpy as np

from meissner.forest.quantise import SUM_ERROR, Raw, check, quantise
from meissner.forest.sklearn import EXTRA

_BESIDE = ("Identity", "Cast", "ZipMap")  # pass the features, or the results
_DOMAINS = ("", "ai.onnx", "ai.onnx.ml")
_BOOSTED = "boosted trees add margins, which is another vote than a forest's"
_KNOWN = {
    *(
        "class_ids",
        "class_nodeids",
        "class_treeids",
        "class_weights",
        "nodes_falsenodeids",
        "nodes_featureids",
    ),
    *("classlabels_int64s", "classlabels_strings", "nodes_hitrates", "nodes_missing_value_tracks_true"),
    *("nodes_modes", "nodes_nodeids", "nodes_treeids", "nodes_truenodeids", "nodes_values", "post_transform"),
}


def read(path, trust=False):
    """The onnx.ModelProto in a file; ``trust`` changes nothing."""
    try:
        import onnx
    except ImportError:
        raise ValueError(f"it needs onnx: {EXTRA}") from None
    return onnx.load_model_from_string(path.read_bytes())


def own(given, model):
    """(name, function) of onnxruntime itself: rows to (index of the class, probabilities)."""
    try:
        import onnx
        import onnxruntime
    except ImportError:
        raise ValueError(f"the engine float of an ONNX model needs onnxruntime: {EXTRA}") from None
    for each in (*given.graph.input, *given.graph.output):
        for size in each.type.tensor_type.shape.dim[:1]:
            size.dim_param = "rows"  # whatever number of them the file is for
    place = {label: at for at, label in enumerate(model.classes)}
    kind = onnx.helper.tensor_dtype_to_np_dtype(given.graph.input[0].type.tensor_type.elem_type)

    def safe(function, *values, **more):
        try:
            return function(*values, **more)
        except Exception as problem:  # onnxruntime has kinds of its own
            raise ValueError(f"onnxruntime cannot decide: {str(problem).partition(chr(10))[0]}") from None

    session = safe(
        onnxruntime.InferenceSession, given.SerializeToString(), providers=["CPUExecutionProvider"]
    )
    if len(session.get_outputs()) < 2:
        raise ValueError("the engine float of an ONNX model needs its labels and its probabilities")

    def decide(x):
        rows = np.asarray(x).astype(kind)
        if kind.kind != "f" and (wrong := rows != x).any():
            row, feature = np.argwhere(wrong)[0]
            raise ValueError(
                f"row {row}: x{feature} = {x[row, feature]} is not of the kind {kind} of the model"
            )
        labels, share = safe(session.run, None, {session.get_inputs()[0].name: rows})[:2]
        if isinstance(share, list):  # ZipMap's: a dictionary for each row
            share = np.array([[row[label] for label in model.classes] for row in share])
        return np.array([place[label] for label in labels.tolist()]), share.astype(np.float64)

    return f"onnxruntime {onnxruntime.__version__}", decide


def _ensemble(graph):
    """(attributes, name of the input) of the graph's only ensemble."""
    import onnx

    kinds = [node.op_type for node in graph.node]
    more = [each.name for each in graph.output[2:]]
    if more and "TreeEnsembleClassifier" in kinds and "TreeEnsembleRegressor" in kinds:
        raise ValueError(f"it also gives {more[0]!r:.40}, which the core does not; export it without that")
    for node in graph.node:
        if node.op_type == "TreeEnsembleRegressor":
            raise ValueError(f"a {node.op_type} decides no class; {_BOOSTED}")
        if node.op_type not in (*_BESIDE, "TreeEnsembleClassifier") or node.domain not in _DOMAINS:
            raise ValueError(f"it computes {node.op_type}, which the core does not; export the forest alone")
    found = [node for node in graph.node if node.op_type == "TreeEnsembleClassifier"]
    if len(found) != 1:
        raise ValueError(f"it has {len(found)} TreeEnsembleClassifiers, not one")
    makers = {name: node for node in graph.node for name in node.output}
    name = found[0].input[0]
    while name in makers:
        node = makers.pop(name)  # a chain that comes back to itself ends too
        to = [each.i for each in node.attribute if each.name == "to"]
        if node.op_type == "ZipMap" or to not in ([], [onnx.TensorProto.FLOAT]):
            raise ValueError(f"it changes the features by {node.op_type} before the forest")
        name = node.input[0]
    value = onnx.helper.get_attribute_value
    return {each.name: value(each) for each in found[0].attribute}, name


def of_model(model, integer=()):
    """The Model of an onnx.ModelProto; ``integer``: names of features, or True for all."""
    found, name = _ensemble(model.graph)
    if found.get("base_values") or found.get("post_transform", b"NONE") != b"NONE":
        raise ValueError(f"it has base values or transforms its sums: {_BOOSTED}")
    if other := sorted(set(found) - _KNOWN - {"base_values"}):
        raise ValueError(f"it has {other[0]}, which skl2onnx writes for no forest of floats of 32 bits")
    modes = found.get("nodes_modes", [])
    if other := sorted({*modes} - {b"BRANCH_LEQ", b"LEAF"}):
        raise ValueError(f"its nodes compare by {other[0].decode(errors='replace')}, not <=: {_BOOSTED}")
    if found.get("classlabels_int64s") and found.get("classlabels_strings"):
        raise ValueError("it has labels of two kinds")
    labels = found.get("classlabels_int64s") or [
        each.decode() for each in found.get("classlabels_strings", [])
    ]
    labels = [*map(int, labels)] if "classlabels_int64s" in found else labels
    trees = _trees(found, modes, len(labels))
    given = next((each for each in model.graph.input if each.name == name), None)
    if given is None:
        raise ValueError(f"its forest gets {name!r:.40}, which is no input of the file")
    sizes = [each.dim_value for each in given.type.tensor_type.shape.dim]
    used = max(int(tree.feature.max(initial=0)) for tree in trees) + 1
    features = sizes[1] if len(sizes) == 2 and sizes[1] else used
    for index, tree in enumerate(trees):
        check(tree, features, len(labels), f"tree {index}")
    names = [f"x{index}" for index in range(features)]
    source = f"ONNX TreeEnsembleClassifier, {model.producer_name} {model.producer_version}"
    return quantise(trees, labels, names, names if integer is True else integer, source)


def _trees(found, modes, classes):
    def column(name, kind=np.int64, size=None):
        size = len(modes) if size is None else size
        values = np.array(found.get(name, []), kind)
        if values.shape != (size,):
            raise ValueError(f"{name} has {len(values)} entries for {size}")
        return values

    tree, node = column("nodes_treeids"), column("nodes_nodeids")
    starts = np.flatnonzero(node == 0)
    count = len(starts)
    if not count or classes < 2:  # onnxruntime gives the label 1 to a single class, whatever its label is
        raise ValueError(f"it has {count} trees and {classes} classes: at least one and two are needed")
    ends = np.append(starts[1:], len(modes))
    own = np.repeat(np.arange(count), np.diff(np.append(starts, len(modes)))) if starts[0] == 0 else tree[:0]
    if not np.array_equal(own, tree) or not np.array_equal(node, np.arange(len(modes)) - starts[tree]):
        raise ValueError("its nodes are not numbered from 0 in each tree, as skl2onnx writes them")
    leaf = np.array([mode == b"LEAF" for mode in modes])
    left, right = (np.where(leaf, -1, column(f"nodes_{side}nodeids")) for side in ("true", "false"))
    feature, threshold = column("nodes_featureids"), column("nodes_values", np.float32).astype(np.float64)
    missing = found.get("nodes_missing_value_tracks_true") or [0] * len(modes)
    found = found | {"nodes_missing_value_tracks_true": missing}
    missing = column("nodes_missing_value_tracks_true") == 1

    weights = np.array(found.get("class_weights", []), np.float32).astype(np.float64)
    of_tree, of_node, of_class = (
        column(f"class_{name}s", size=len(weights)) for name in ("treeid", "nodeid", "id")
    )
    outside = (of_tree < 0) | (of_tree >= count) | (of_class < 0) | (of_class >= classes) | (of_node < 0)
    outside |= of_node >= (ends - starts)[np.where(outside, 0, of_tree)]
    if (at := np.flatnonzero(outside)).size:
        raise ValueError(f"weight {at[0]} belongs to no leaf or no class")
    value = np.zeros((len(modes), classes))
    np.add.at(value, (starts[of_tree] + of_node, of_class), weights * count)
    if classes == 2 and len({*of_class.tolist()}) == 1:  # of the second class, whichever number they carry
        value[:, 1] = value[:, of_class[0]]
        value[:, 0] = 1 - value[:, 1]
    wrong = leaf & ((np.abs(value.sum(1) - 1) > SUM_ERROR) | (value < -SUM_ERROR).any(1))
    if (at := np.flatnonzero(wrong)).size:
        place = f"tree {tree[at[0]]}, node {node[at[0]]}"
        raise ValueError(f"{place}: the weights of its classes are no probabilities: {_BOOSTED}")
    value = value.clip(0, 1)
    parts = (feature, threshold, left, right, value, missing)
    return [Raw(*(part[one:end] for part in parts)) for one, end in zip(starts, ends)]
