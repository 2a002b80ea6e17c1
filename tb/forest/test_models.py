"""Trained models' files to F.json: skops with malicious files, joblib, ONNX against onnxruntime, other kinds,
and the command."""

import io
import json
import zipfile
from itertools import pairwise

import joblib
import numpy as np
import onnx
import onnxruntime
import pytest
import skl2onnx
import sklearn
import skops.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sklearn.calibration import CalibratedClassifierCV
from sklearn.datasets import load_wine
from sklearn.ensemble import (
    AdaBoostClassifier,
    ExtraTreesClassifier,
    ExtraTreesRegressor,
    GradientBoostingClassifier,
    HistGradientBoostingClassifier,
    RandomForestClassifier,
    RandomForestRegressor,
    VotingClassifier,
)
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.tree import DecisionTreeClassifier

import meissner
from forest.compare import ERROR, agree, sides
from meissner import cli
from meissner.builds.toolchain import ROOT
from meissner.forest import models, process

X, Y = load_wine(return_X_y=True)
KINDS = [
    RandomForestClassifier(7, random_state=1),
    ExtraTreesClassifier(7, random_state=2),
    DecisionTreeClassifier(min_samples_leaf=9, random_state=3),
]
NAMES = [type(kind).__name__ for kind in KINDS]


@pytest.mark.parametrize("model", KINDS, ids=NAMES)
def test_files_of_scikit_learn_give_what_the_object_gives(model, tmp_path):
    model.fit(X, Y)
    skops.io.dump(model, tmp_path / "m.skops")
    joblib.dump(model, tmp_path / "m.joblib")
    for name, trust in (("m.skops", False), ("m.joblib", True)):
        forest = meissner.Forest.from_file(tmp_path / name, trust=trust)
        agree(forest, model, X, name)
        forest.to_file(tmp_path / f"{name}.json")
        agree(meissner.Forest.from_file(tmp_path / f"{name}.json"), model, X, "F.json")
    assert (tmp_path / "m.skops.json").read_bytes() == (tmp_path / "m.joblib.json").read_bytes()


class Bomb:
    """Leaves a mark if it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return open, (str(self.path), "w")


def test_joblib_needs_trust_and_nothing_runs_without(tmp_path):
    joblib.dump(Bomb(tmp_path / "mark"), tmp_path / "m.joblib")
    with pytest.raises(ValueError, match="runs code when it is loaded"):
        meissner.Forest.from_file(tmp_path / "m.joblib")
    assert not (tmp_path / "mark").exists()
    with pytest.raises(ValueError, match="a TextIOWrapper is no forest"):
        meissner.Forest.from_file(tmp_path / "m.joblib", trust=True)
    assert (tmp_path / "mark").exists()  # so the file was one that runs code


def changed(path, change):
    """The skops file with ``change(schema, arrays of the first tree's state, node of that tree)`` done."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    schema = json.loads(members["schema.json"])
    tree = schema["content"]["content"]["tree_"]
    state = tree["content"]["content"]
    arrays = {name: np.load(io.BytesIO(members[state[name]["file"]])) for name in ("nodes", "values")}
    change(schema, arrays, tree)
    for name, array in arrays.items():
        data = io.BytesIO()
        np.save(data, array)
        members[state[name]["file"]] = data.getvalue()
    members["schema.json"] = json.dumps(schema).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)


def node(field, index, value):
    def change(_, arrays, tree):
        arrays["nodes"][field][index] = value

    return change


def count(schema, arrays, tree):
    tree["content"]["content"]["node_count"]["content"] = "4000"


def fewer(schema, arrays, tree):
    arrays["values"] = arrays["values"][:-1]


def many_features(schema, arrays, tree):
    tree["__reduce__"]["args"]["content"][0] |= {"content": str(1 << 60), "__id__": 4}


def fewer_nodes(schema, arrays, tree):
    arrays["nodes"] = arrays["nodes"][:-1]


def wider(schema, arrays, tree):
    arrays["values"] = np.concatenate([arrays["values"]] * 2, 2)


def other_type(schema, arrays, tree):
    arrays["nodes"] = arrays["nodes"].view(np.uint8)


def outputs(schema, arrays, tree):
    tree["__reduce__"]["args"]["content"][2]["content"] = "1000000"


def features(schema, arrays, tree):
    tree["__reduce__"]["args"]["content"][0] |= {"content": "40", "__id__": 4}


def function(schema, arrays, tree):
    schema["content"]["content"]["criterion"] = {
        "__class__": "system",
        "__module__": "os",
        "__loader__": "FunctionNode",
        "content": {"module_path": "os", "function": "system"},
        "__id__": 5,
    }


def hidden(schema, arrays, tree):
    """An earlier object with the number of the tree's nodes, which skops would take in their place."""
    own = tree["content"]["content"]["nodes"]
    early = {**tree["content"]["content"]["values"], "__id__": own["__id__"]}
    schema["content"]["content"]["criterion"] = early  # stands before tree_


def another_maker(schema, arrays, tree):
    tree["__loader__"] = "ObjectNode"


def no_array(schema, arrays, tree):
    tree["content"]["content"]["nodes"]["type"] = "json"


@pytest.mark.parametrize(
    "change, says",
    [
        (node("left_child", 2, 1), "tree 0 of the file, node 2: its left child 1 is no later node of"),
        (node("left_child", 0, 0), "node 0: its left child 0 is no later"),
        (node("right_child", 0, 99999), "node 0: its right child 99999 is no later"),
        (node("right_child", 0, -7), "node 0: its right child -7"),
        (node("left_child", 0, -1), "node 0: its right child"),  # half a leaf
        (node("right_child", 0, 2), "it is a child of"),
        (node("feature", 0, 13), "node 0: its feature 13 is none of 13"),
        (node("feature", 0, -2), "node 0: its feature -2 is none of 13"),
        (node("threshold", 0, np.nan), "node 0: its threshold is nan"),
        (count, "is not as skops writes it"),
        (many_features, f"{1 << 60} features are not 1 to 1048576"),
        (fewer_nodes, "is not as skops writes it"),
        (fewer, "is not as skops writes it"),
        (wider, "is not as skops writes it"),
        (other_type, "is not as skops writes it"),
        (outputs, "tree 0 of the file has 1000000 outputs; the core decides one class"),
        (another_maker, "is not as skops writes it"),
        (no_array, "is not as skops writes it"),
        (features, "tree 0: it has 40 features, the model 13"),
        (function, "os.system"),
        (hidden, "have the number"),
    ],
    ids=lambda value: value.__name__ if callable(value) else "",
)
def test_malicious_skops_files_are_refused(tmp_path, change, says):
    path = tmp_path / "m.skops"
    skops.io.dump(DecisionTreeClassifier(random_state=1, min_samples_leaf=3).fit(X, Y), path)
    meissner.Forest.from_file(path)
    changed(path, change)
    with pytest.raises(ValueError, match=says) as refused:
        meissner.Forest.from_file(path)
    assert "\n" not in str(refused.value) and str(refused.value).startswith(str(path))


def onnx_of(path, model, **options):
    made = skl2onnx.to_onnx(model, X[:1].astype(np.float32), **options)
    path.write_bytes(made.SerializeToString())
    return made


@pytest.mark.parametrize("two", [True, False], ids=["two", "three"])
@pytest.mark.parametrize("model", KINDS, ids=NAMES)
def test_onnx_files_give_what_onnxruntime_gives(tmp_path, model, two):
    """Also at the thresholds, which the file holds as float32. onnxruntime adds a float32 a tree, which
    gives its probabilities an error of their own: half a unit in the last place of one, a tree."""
    names = np.array(["a", "b", "c"])[Y]
    model.fit(X, Y > 0 if two else names)
    onnx_of(tmp_path / "m.onnx", model, options={"zipmap": False})
    forest = meissner.Forest.from_file(tmp_path / "m.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "m.onnx")
    trees = getattr(model, "estimators_", [model])
    rows = sides(trees, X)[0]
    for x in (X, rows):
        label, theirs = session.run(None, {"X": x.astype(np.float32)})
        ours = forest.predict_proba(x)
        assert np.abs(ours - theirs).max() <= ERROR + len(trees) * 2.0**-24
        best = np.sort(theirs, axis=1)[:, -2:]
        tie = best[:, 1] - best[:, 0] <= 2 * (ERROR + len(trees) * 2.0**-24)
        other = forest.predict(x) != label
        print(f"{len(x)} rows, {tie.sum()} at a tie, {other.sum()} of these with another class")
        assert not (other & ~tie).any()


def test_onnx_files_with_labels_in_a_map_or_from_integers(tmp_path):
    model = KINDS[0].fit(X, Y)
    for options in ({}, {"initial_types": [("X", skl2onnx.common.data_types.Int64TensorType([None, 13]))]}):
        given = options or {"X": X[:1].astype(np.float32)}
        made = skl2onnx.to_onnx(model, **given)
        (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
        x = X if not options else np.rint(X)
        assert np.array_equal(meissner.Forest.from_file(tmp_path / "m.onnx").predict(x), model.predict(x))


TYPES = skl2onnx.common.data_types


@pytest.mark.parametrize(
    "kind, given, options",
    [
        (np.float64, (TYPES.DoubleTensorType([None, 13]), False), {}),
        (np.int64, (TYPES.Int64TensorType([None, 13]), False), {}),
        (np.float32, (TYPES.FloatTensorType([1, 13]), True), {}),  # a row at a time
        (np.float32, (TYPES.FloatTensorType([None, 13]), False), {"output_class_labels": True}),
    ],
    ids=["double", "integers", "one row", "three outputs"],
)
def test_onnx_files_of_every_input_decide_on_the_engine_float(tmp_path, kind, given, options):
    x = np.rint(X)
    model = RandomForestClassifier(7, random_state=1).fit(x, Y)
    made = skl2onnx.to_onnx(
        model, initial_types=[("X", given[0])], options={id(model): {"zipmap": given[1]} | options}
    )
    (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
    opened = models.load(tmp_path / "m.onnx")
    found = process.decide("float", opened.model, x, own=opened.own)
    session = onnxruntime.InferenceSession(tmp_path / "m.onnx")
    rows = x[:, None] if given[1] else [x]
    labels = np.concatenate([session.run(None, {"X": row.astype(kind)})[0] for row in rows])
    assert found.index.tolist() == labels.tolist() == model.predict(x).tolist()
    if kind is np.int64:
        x[3, 2] += 0.5
        with pytest.raises(ValueError, match=r"row 3: x2 = .*5 is not of the kind int64"):
            process.decide("float", opened.model, x, own=opened.own)


def test_what_onnxruntime_cannot_run_is_refused_with_a_sentence(tmp_path):
    made = onnx_of(tmp_path / "m.onnx", KINDS[2].fit(X, Y))
    opset, known = made.opset_import[0], made.opset_import[0].version
    opset.version = 9999
    for change, says in (
        (lambda: None, "onnxruntime cannot decide"),
        (lambda: made.graph.output.pop(), "needs its labels"),
    ):
        change()
        (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
        opened = models.load(tmp_path / "m.onnx")
        with pytest.raises(ValueError, match=says) as refused:
            process.decide("float", opened.model, X, own=opened.own)
        assert "\n" not in str(refused.value)
        opset.version = known


def test_nan_in_an_onnx_file_goes_where_onnxruntime_sends_it(tmp_path):
    holes = X.copy()
    holes[::2, ::3] = np.nan
    model = KINDS[0].fit(holes, Y)
    onnx_of(tmp_path / "m.onnx", model, options={"zipmap": False})
    label, _ = onnxruntime.InferenceSession(tmp_path / "m.onnx").run(None, {"X": holes.astype(np.float32)})
    assert np.array_equal(meissner.Forest.from_file(tmp_path / "m.onnx").predict(holes), label)


def attribute(made, name):
    [node] = [node for node in made.graph.node if node.op_type == "TreeEnsembleClassifier"]
    return next(each for each in node.attribute if each.name == name)


@pytest.mark.parametrize(
    "name, field, index, value, says",
    [
        ("nodes_modes", "strings", 0, b"BRANCH_LT", "compare by BRANCH_LT, not <=: boosted"),
        ("post_transform", "s", None, b"LOGISTIC", "boosted trees add margins"),
        ("nodes_truenodeids", "ints", 0, 0, "tree 0, node 0: its left child 0 is no later node"),
        ("nodes_falsenodeids", "ints", 0, 900, "tree 0, node 0: its right child 900"),
        ("nodes_featureids", "ints", 0, 13, "its feature 13 is none of 13"),
        ("nodes_nodeids", "ints", 1, 5, "not numbered from 0"),
        ("nodes_treeids", "ints", 0, 5, "not numbered from 0"),
        ("class_treeids", "ints", 2, 7, "weight 2 belongs to no leaf"),
        ("class_nodeids", "ints", 1, -1, "weight 1 belongs to no leaf"),
        ("class_ids", "ints", 1, 3, "weight 1 belongs to no leaf or no class"),
        ("class_weights", "floats", 0, 0.5, "are no probabilities: boosted"),
        ("nodes_values", "floats", 0, float("nan"), "its threshold is nan"),
    ],
)
def test_onnx_files_that_are_no_forest_are_refused(tmp_path, name, field, index, value, says):
    made = onnx_of(tmp_path / "m.onnx", KINDS[0].fit(X, Y))
    if index is None:
        setattr(attribute(made, name), field, value)
    else:
        getattr(attribute(made, name), field)[index] = value
    (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
    with pytest.raises(ValueError, match=says):
        meissner.Forest.from_file(tmp_path / "m.onnx")


def test_an_onnx_file_whose_features_come_from_nowhere_is_refused(tmp_path):
    """From no input of the file, and from a node that gets its own output."""
    for names in (["none"], ["here", "here"], ["one", "two", "one"]):
        made = onnx_of(tmp_path / "m.onnx", KINDS[2].fit(X, Y))
        next(node for node in made.graph.node if node.op_type == "TreeEnsembleClassifier").input[0] = names[0]
        for output, source in pairwise(names):
            made.graph.node.append(onnx.helper.make_node("Identity", [source], [output]))
        (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
        with pytest.raises(ValueError, match=f"its forest gets '{names[-1]}', which is no input"):
            meissner.Forest.from_file(tmp_path / "m.onnx")


def test_an_onnx_file_may_leave_its_number_of_features_open_but_not_state_any(tmp_path):
    model = KINDS[2].fit(X, Y)
    made = onnx_of(tmp_path / "m.onnx", model)
    size = made.graph.input[0].type.tensor_type.shape.dim[1]
    size.dim_value = 1 << 60
    (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
    with pytest.raises(ValueError, match=f"{1 << 60} features"):
        meissner.Forest.from_file(tmp_path / "m.onnx")
    size.dim_param = "many"  # then as many as the nodes ask for
    (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
    assert meissner.Forest.from_file(tmp_path / "m.onnx").n_features_in_ == model.tree_.feature.max() + 1


def test_onnx_labels_that_are_none_are_refused(tmp_path):
    for strings, ints, says in (
        ([], [1, 5, 1], "1 stands there twice"),
        ([b"a", b"b", b"c"], [1, 5, 7], "two kinds"),
    ):
        made = onnx_of(tmp_path / "m.onnx", KINDS[2].fit(X, Y))
        attribute(made, "classlabels_int64s").ints[:] = ints
        node = next(node for node in made.graph.node if node.op_type == "TreeEnsembleClassifier")
        node.attribute.append(onnx.helper.make_attribute("classlabels_strings", strings, attr_type=8))
        (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
        with pytest.raises(ValueError, match=says):
            meissner.Forest.from_file(tmp_path / "m.onnx")


def test_other_models_are_refused(tmp_path):
    two = Y > 0
    for model, says in (
        (
            GradientBoostingClassifier(n_estimators=2),
            "a GradientBoosting.* boosted trees add margins",
        ),
        (HistGradientBoostingClassifier(max_iter=2), "boosted trees add margins"),
        (AdaBoostClassifier(n_estimators=2), "boosted"),
        (RandomForestRegressor(2), "a RandomForestRegressor is no forest that votes"),
        (LogisticRegression(), "a LogisticRegression is no forest"),
        (VotingClassifier([("a", RandomForestClassifier(2))]), "a VotingClassifier is no forest"),
        (CalibratedClassifierCV(RandomForestClassifier(2)), "a CalibratedClassifierCV is no forest"),
        (ExtraTreesRegressor(2), "an ExtraTreesRegressor is no forest"),
        (make_pipeline(StandardScaler(), DecisionTreeClassifier()), "a Pipeline is no.* forest inside it"),
        (GridSearchCV(DecisionTreeClassifier(), {"max_depth": [1]}), "a GridSearchCV is no.* forest inside"),
    ):
        joblib.dump(model.fit(X[:, :2], two), tmp_path / "m.joblib")
        for make in (meissner.Forest, lambda _: meissner.Forest.from_file(tmp_path / "m.joblib", trust=True)):
            with pytest.raises(ValueError, match=says):
                make(model)
        skops.io.dump(model, tmp_path / "m.skops")  # says what it is before its trees are looked at
        with pytest.raises(ValueError, match=says):
            meissner.Forest.from_file(tmp_path / "m.skops")
    skops.io.dump(DecisionTreeClassifier().fit(X, np.c_[Y, two]), tmp_path / "m.skops")
    with pytest.raises(ValueError, match="2 outputs; the core decides one class"):
        meissner.Forest.from_file(tmp_path / "m.skops")
    for model, says in (
        (RandomForestRegressor(2), "TreeEnsembleRegressor decides no class; boosted"),
        (GradientBoostingClassifier(n_estimators=2), "boosted"),
        (make_pipeline(StandardScaler(), DecisionTreeClassifier()), "it computes Scaler"),
        (DecisionTreeClassifier(max_depth=1), None),
    ):
        onnx_of(tmp_path / "m.onnx", model.fit(X, two))
        if says:
            with pytest.raises(ValueError, match=says):
                meissner.Forest.from_file(tmp_path / "m.onnx")
        else:
            assert len(meissner.Forest.from_file(tmp_path / "m.onnx").model.trees) == 1
    model = RandomForestClassifier(2).fit(X, two)
    for more in ("decision_path", "decision_leaf"):
        onnx_of(tmp_path / "m.onnx", model, options={id(model): {more: True, "zipmap": False}})
        with pytest.raises(ValueError, match=f"also gives '{more}', which the core does not"):
            meissner.Forest.from_file(tmp_path / "m.onnx")
    for model, says in (
        (RandomForestClassifier(), "the RandomForestClassifier is not fitted"),
        (DecisionTreeClassifier().fit(X, np.c_[Y, Y]), "has 2 outputs"),
        ([1, 2], "a list is no forest"),
        (DecisionTreeClassifier().fit(X, np.array(Y, "M8[ns]")), "classes are times .datetime64"),
        (DecisionTreeClassifier().fit(X, np.array([b"a", b"b", b"c"])[Y]), "labels of one kind"),
    ):
        with pytest.raises(ValueError, match=says):
            meissner.Forest(model)


def read_or_refused(path):
    try:
        forest = meissner.Forest.from_file(path)
    except ValueError as problem:
        assert str(problem).startswith(str(path)) and "\n" not in str(problem)
    else:
        forest.process(np.zeros((1, forest.n_features_in_)))


ANY = st.none() | st.booleans() | st.integers() | st.text(max_size=4) | st.lists(st.integers(), max_size=2)
FUZZ = settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@FUZZ
@given(st.data())
def test_any_byte_of_an_onnx_file_may_change(tmp_path, data):
    onnx_of(tmp_path / "m.onnx", DecisionTreeClassifier(max_depth=2, random_state=0).fit(X, Y))
    whole = bytearray((tmp_path / "m.onnx").read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    (tmp_path / "m.onnx").write_bytes(whole)
    read_or_refused(tmp_path / "m.onnx")


@FUZZ
@given(st.data())
def test_any_value_of_a_skops_file_may_change(tmp_path, data):
    def change(schema, arrays, tree):
        inner = data.draw(st.sampled_from([schema, tree]))
        while True:
            keys = sorted(inner) if isinstance(inner, dict) else range(len(inner))
            key = data.draw(st.sampled_from(keys))
            if not isinstance(inner[key], dict | list) or not inner[key] or data.draw(st.integers(0, 5)) == 0:
                break
            inner = inner[key]
        inner[key] = data.draw(ANY)

    path = tmp_path / "m.skops"
    skops.io.dump(DecisionTreeClassifier(max_depth=2, random_state=0).fit(X, Y), path)
    changed(path, change)
    read_or_refused(path)


@pytest.mark.parametrize("suffix", ["skops", "onnx", "joblib"])
def test_files_that_are_not_whole_are_refused(tmp_path, suffix):
    model = DecisionTreeClassifier().fit(X, Y)
    path = tmp_path / f"m.{suffix}"
    {"skops": skops.io.dump, "onnx": lambda m, p: onnx_of(p, m), "joblib": joblib.dump}[suffix](model, path)
    whole = path.read_bytes()
    for size in (0, 1, len(whole) // 3, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        with pytest.raises(ValueError) as refused:
            meissner.Forest.from_file(path, trust=True)
        assert str(refused.value).startswith(str(path)) and "\n" not in str(refused.value), size


def test_the_ten_lines_of_the_page_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs/forest.md").read_text("utf-8").partition("```python\n")[2].partition("```")[0]
    exec(compile(text, "forest.md", "exec"), {})
    assert capsys.readouterr().out == "True\n" and meissner.Forest.from_file("wine.json")


def run(capsys, *arguments):
    try:
        code = cli.main([*map(str, arguments)]) or 0
    except SystemExit as end:
        code = end.code
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_command_writes_a_forest_and_keeps_files(tmp_path, capsys):
    x = np.rint(X).astype(int)
    model = RandomForestClassifier(3, random_state=1).fit(x, Y)
    skops.io.dump(model, tmp_path / "m.skops")
    given = ("export-forest", tmp_path / "m.skops", "--out", tmp_path / "F.json")
    code, out, _ = run(capsys, *given, "--integer", "x0,x12")
    nodes = sum((tree.tree_.children_left >= 0).sum() for tree in model.estimators_)
    assert code == 0 and f"RandomForestClassifier: 3 trees, {nodes} nodes, 3 classes, 13 features" in out
    forest = meissner.Forest.from_file(tmp_path / "F.json")
    integers = [each.name for each in forest.model.features if each.thresholds is None]
    assert integers == ["x0", "x12"] and np.array_equal(forest.predict(x), model.predict(x))
    before = (tmp_path / "F.json").read_bytes()
    code, _, err = run(capsys, *given)
    assert code == 2 and "F.json exists" in err and (tmp_path / "F.json").read_bytes() == before
    assert run(capsys, *given, "--overwrite", "--integer", "all")[0] == 0
    assert (tmp_path / "F.json").read_bytes() != before
    for more, says in (
        (("--overwrite", "--integer", "x13"), "no feature 'x13'"),
        (("--out", tmp_path / "m.skops", "--overwrite"), "is an input of this command"),
        (("--out", tmp_path / "no" / "F.json"), "there is no folder"),
        (("--out", tmp_path / "F.txt"), "F.txt must be a .json file"),
    ):
        code, _, err = run(capsys, *given, *more)
        assert code == 2 and says in err and err.count("\n") == 1
    joblib.dump(model, tmp_path / "m.pkl")
    (tmp_path / "m.txt").touch()
    for name, says in (
        ("m.pkl", "--trust"),
        ("m.txt", "must be a .skops, .onnx or .joblib"),
        ("no.onnx", "no file"),
    ):
        code, _, err = run(capsys, "export-forest", tmp_path / name, "--out", tmp_path / "G.json")
        assert code == 2 and says in err and not (tmp_path / "G.json").exists()
    assert run(capsys, "export-forest", tmp_path / "m.pkl", "--trust", "--out", tmp_path / "G.json")[0] == 0
    assert run(capsys, "forest-budget", tmp_path / "m.pkl", "--trust")[0] == 0


@pytest.mark.filterwarnings("error")
def test_a_model_of_another_version_says_so_in_one_line(tmp_path, capsys):
    """The versions' own warnings, two of three lines for each kind of estimator, are not printed."""
    now = sklearn.__version__
    other = f"0{now[1:]}"
    joblib.dump(KINDS[0].fit(X, Y), tmp_path / "m.joblib")
    whole = (tmp_path / "m.joblib").read_bytes()
    (tmp_path / "m.joblib").write_bytes(whole.replace(now.encode(), other.encode()))
    given = ("export-forest", tmp_path / "m.joblib", "--trust", "--out", tmp_path / "F.json")
    code, out, err = run(capsys, *given)
    assert (code, err) == (0, "") and f"scikit-learn {other} RandomForestClassifier, read by {now}: 7" in out
