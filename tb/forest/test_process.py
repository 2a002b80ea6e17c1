"""``meissner process forest``: scikit-learn's classes from every kind of table on every engine, a forest by
hand, the clocks of a row, and what is refused, with nothing written."""

import csv
import re

import numpy as np
import pytest
import skl2onnx
import skops.io
from sklearn.datasets import load_iris, load_wine
from sklearn.ensemble import RandomForestClassifier
from sklearn.tree import DecisionTreeClassifier

import meissner
from forest.compare import ERROR
from meissner import cli
from meissner.forest import file, process, rows
from meissner.forest.file import Feature, Model, Tree

X, Y = load_wine(return_X_y=True)
NAMES = [name.replace("/", " of ") for name in load_wine().feature_names]
LABELS = np.array(["öl", "b", 'c, "d"'])[Y]


def run(capsys, *given):
    cli.main(["process", "forest", *map(str, given)])
    return capsys.readouterr().out


@pytest.fixture(scope="module")
def wine(tmp_path_factory):
    """A tree of seven leaves over columns with names, as F.json and skops; tables of every kind."""
    folder = tmp_path_factory.mktemp("wine")
    model = DecisionTreeClassifier(max_leaf_nodes=7, random_state=4).fit(X[::2], LABELS[::2])
    given = model.predict(X), model.predict_proba(X)
    model.feature_names_in_ = np.array(NAMES, object)
    skops.io.dump(model, folder / "m.skops")
    meissner.Forest(model).to_file(folder / "F.json")
    order = [*range(7, 13), *range(7)]
    with (folder / "turned.csv").open("w", newline="") as text:
        table = csv.writer(text)
        table.writerow(["sort", *(NAMES[at] for at in order)])
        table.writerows([label, *map(repr, row[order].tolist())] for label, row in zip(LABELS, X))
    np.savetxt(folder / "plain.csv", X, delimiter=",", fmt="%.17g")
    np.savetxt(folder / "marked.csv", X, delimiter=",", fmt="%.17g", header=",".join(NAMES))
    np.save(folder / "x.npy", X)
    np.savez(folder / "rows.npz", x=X)
    records = np.rec.fromarrays([*X.T[order], LABELS], names=[*(NAMES[at] for at in order), "sort"])
    np.save(folder / "records.npy", records)
    return folder, *given


TABLES = {
    "turned.csv": "by name, not used: sort",
    "plain.csv": "by position",
    "marked.csv": "by name",
    "x.npy": "by position",
    "rows.npz": "by position",
    "records.npy": "by name, not used: sort",
}


@pytest.mark.parametrize("table", TABLES)
def test_every_table_gives_scikit_learns_classes(wine, table, tmp_path, capsys):
    folder, labels, share = wine
    text = run(capsys, folder / table, "--forest", folder / "F.json", "--out", tmp_path / "o.npz")
    found = np.load(tmp_path / "o.npz")
    assert found["class"].tolist() == labels.tolist()
    assert np.abs(found["votes"] / 65535 - share).max() <= ERROR
    assert f"178 rows of 13 features ({TABLES[table]})" in text


def test_every_engine_gives_the_same(wine, tmp_path, capsys):
    folder, labels, share = wine
    found = {}
    for engine, forest, says in (
        ("float", "m.skops", f"engine float (scikit-learn {__import__('sklearn').__version__} DecisionTree"),
        ("float", "F.json", "engine float (thresholds and leaves of F.json)"),
        ("fixed", "m.skops", "engine fixed;"),
        ("rtl", "F.json", "of 3 engines compares a node"),
    ):
        given = (folder / "x.npy", "--forest", folder / forest, "--engine", engine, "--engines", 3)
        assert says in run(capsys, *given, "--out", tmp_path / "o.npz", "--overwrite")
        found[engine, forest] = dict(np.load(tmp_path / "o.npz"))
    own, floats, fixed, core = found.values()
    assert np.array_equal(own["votes"], 65535 * share)
    for one in (own, floats, fixed, core):
        assert one["class"].tolist() == labels.tolist() and one["votes"].shape == (178, 3)
    assert all(np.array_equal(fixed[name], core[name]) for name in fixed) and set(fixed) == {"class", "votes"}
    assert np.array_equal(floats["votes"], fixed["votes"])


def test_onnxruntime_itself_decides(tmp_path, capsys):
    """Two classes and three, with and without ZipMap, rows of iris between the thresholds."""
    x, y = load_iris(return_X_y=True)
    for classes, zipmap in ((2, True), (3, True), (3, False)):
        model = RandomForestClassifier(11, random_state=1).fit(
            x[::2], np.minimum(y, classes - 1)[::2] * 3 + 1
        )
        options = {id(model): {"zipmap": zipmap}}
        made = skl2onnx.to_onnx(model, x[:1].astype(np.float32), options=options)
        (tmp_path / "m.onnx").write_bytes(made.SerializeToString())
        np.save(tmp_path / "x.npy", x)
        found = []
        for engine in ("float", "fixed"):
            given = (tmp_path / "x.npy", "--forest", tmp_path / "m.onnx", "--engine", engine, "--overwrite")
            text = run(capsys, *given, "--out", tmp_path / "o.npz")
            assert ("onnxruntime 1" in text) == (engine == "float")
            found.append(dict(np.load(tmp_path / "o.npz")))
        own, fixed = found
        assert own["class"].tolist() == fixed["class"].tolist() == model.predict(x).tolist()
        assert np.abs(own["votes"] - fixed["votes"]).max() <= 11 * 65535 * (ERROR + 6e-8 * 11)


def by_hand(**missing):
    """Class b for certain where u <= 0.5, else 0.4 of it; and 0.8 of it where v <= -3, else none."""
    tree = lambda feature, threshold, left, right, **more: Tree(
        *(np.array([part], np.int64) for part in (feature, threshold, left, right)), **more
    )
    features = [Feature("u", np.array([0.5])), Feature("v")]
    leaves = np.array([[0, 65535], [39321, 26214], [13107, 52428], [65535, 0]], np.uint16)
    trees = [tree(0, 0, -1, -2, **missing), tree(1, -3, -3, -4, **missing)]
    return Model("by hand", ["a", "b"], features, leaves, trees)


# u, v, votes for b: a value just above one half, whose float32 is one half, goes left
ROWS = [(0.5, -3, 117963), (np.nextafter(0.5, 1), -2, 65535), (0.50001, -3, 78642), (9e9, 0, 26214)]


@pytest.mark.parametrize("engine", ["float", "fixed"])
def test_votes_by_hand(engine, tmp_path, capsys):
    file.write(tmp_path / "F.json", by_hand())
    (tmp_path / "x.csv").write_text("v,u\r\n" + "".join(f"{v},{float(u)!r}\r\n" for u, v, _ in ROWS))
    given = (tmp_path / "x.csv", "--forest", tmp_path / "F.json", "--engine", engine)
    text = run(capsys, *given, "--out", tmp_path / "o.csv")
    with (tmp_path / "o.csv").open(newline="", encoding="utf-8") as table:
        head, *body = csv.reader(table)
    assert head == ["class", "votes_0", "votes_1"]
    assert [float(row[2]) for row in body] == [votes for *_, votes in ROWS]
    assert [float(row[1]) + float(row[2]) for row in body] == [131070] * 4
    assert [row[0] for row in body] == ["b", "a", "b", "a"] and "most often a (2)" in text


def test_a_value_that_is_missing_goes_where_the_model_says():
    for left, expected in ((True, 65535), (False, 26214)):
        model = by_hand(missing_left=np.array([left]))
        x = np.array([[np.nan, 0.0]])
        for engine in ("float", "fixed"):
            assert process.decide(engine, model, x).votes[:, 1].tolist() == [expected]


def test_an_empty_cell_is_missing(tmp_path):
    (tmp_path / "x.csv").write_text("u,v\n,3\n1,nan\n\n")
    found = rows.read(tmp_path / "x.csv", ["v", "u"])
    assert np.array_equal(found.x, [[3, np.nan], [np.nan, 1]], equal_nan=True)


def test_clocks_of_a_row_alone(wine, tmp_path, capsys):
    """One tree: 11 clocks a node (docs/forest.md), and the same time for all rows besides."""
    folder, *_ = wine
    given = (folder / "x.npy", "--forest", folder / "m.skops", "--engine", "rtl", "--engines", 3, "--single")
    text = run(capsys, *given, "--out", tmp_path / "o.npz")
    clocks = np.load(tmp_path / "o.npz")["clocks"]
    steps = meissner.Forest.from_file(folder / "F.json").steps(X)[:, 0]
    assert len({*steps}) > 2 and len({*(clocks - 11 * steps).tolist()}) == 1
    assert clocks.min() > 13
    found = re.search(
        r"one row at a time: (\d+) clocks in the mean \((\S+) us.*, (\d+) clocks at worst", text
    )
    mean, us, worst = map(float, found.groups())
    assert (mean, us, worst) == (round(clocks.mean()), round(clocks.mean() / 100, 2), clocks.max())
    assert re.search(r"scikit-learn \S+ DecisionTreeClassifier on this machine: \d+ us", text)


@pytest.mark.long
def test_the_netlist_decides_the_same(tmp_path, capsys):
    file.write(tmp_path / "F.json", by_hand())
    np.save(tmp_path / "x.npy", np.array([row[:2] for row in ROWS]))
    given = (tmp_path / "x.npy", "--forest", tmp_path / "F.json", "--engine", "gate")
    run(capsys, *given, "--out", tmp_path / "o.npz")
    assert np.load(tmp_path / "o.npz")["votes"][:, 1].tolist() == [votes for *_, votes in ROWS]


FOURS = [[5.5, 1, 2, 3], [0.5, 1, 2, 3]]
HEADERS = {  # names of the features, the table: its rows
    "abcd | 5.5,1,2,3;0.5,1,2,3": FOURS,
    "abcd | d,c,b,a;3,2,1,5.5;3,2,1,.5": FOURS,
    " a,#b,c,d | # a ,b, c,d;5.5,1,2,3;0.5,1,2,3": FOURS,  # spaces are no part of a name
    "x0,x1,x2,x3 | 0,1,2,3;5.5,1,2,3;0.5,1,2,3": FOURS,  # as pandas counts columns without names
    "x0,x1,x2,x3 | 0,1,2,4;5.5,1,2,3": [[0, 1, 2, 4], FOURS[0]],
    "x0,x1 | 0,1;1,2": [[0, 1], [1, 2]],  # two columns: rows
    "x0,x1 | ,;1,2": [[np.nan, np.nan], [1, 2]],
    "3,1,2,0 | 3,1,2,0;5.5,1,2,3;0.5,1,2,3": FOURS,
    "3,1 | 1,3;7,8": [[8, 7]],
    "abcd | 0,1,2,3;5.5,1,2,3": "the feature a is missing",
    "x0,x1 | NA,1;1,2": "row 0: x0 = 'NA' is not a number",
    "x0,x1 | 1,2;NA,1": "row 1: x0 = 'NA' is not a number",
    "a,b,a | a,b,c;1,2,3": "two features have the name a",
}


@pytest.mark.parametrize("case", HEADERS)
def test_what_is_a_header_and_what_a_row(case, tmp_path):
    names, _, table = case.partition(" | ")
    names = [*names] if names == "abcd" else names.split(",")
    (tmp_path / "x.csv").write_text(table.replace(";", "\n"))
    if isinstance(HEADERS[case], str):
        with pytest.raises(ValueError, match=HEADERS[case]):
            rows.read(tmp_path / "x.csv", names)
    else:
        assert np.array_equal(rows.read(tmp_path / "x.csv", names).x, HEADERS[case], equal_nan=True)


def test_records_that_are_no_numbers_are_refused(tmp_path):
    np.save(tmp_path / "x.npy", np.array([(1.0, 5)], [("u", "f8"), ("v", "M8[s]")]))
    with pytest.raises(ValueError, match=r"row 0: v = .* is not a number"):
        rows.read(tmp_path / "x.npy", ["u", "v"])


REFUSED = {
    "u,w\n1,2\n": "the feature v is missing",
    "v,w\n1,2\n": "the feature u is missing",
    "u,v,u\n1,2,3\n": "the feature u is there twice",
    "a,b\n1,2\n": "the feature u is missing",
    "1,2,3\n": "need 2 columns, not 3",
    "u,v\n1,2\n1\n": "line 3: 1 values are not 2",
    "u,v\n1,2\n1,x\n": "row 1: v = 'x' is not a number",
    "u,v\n1,2\n1,1_0\n": "row 1: v = '1_0' is not a number",
    "u,v\n": "must have the shape [rows, 2]",
    "": "has no rows",
    "u,v\n1,2.5\n": "v must be an integer",
    "u,v\n1,16777216\n": "v must be an integer below 16777216",
    "u,v\n,2\n": "u is NaN, and this model has no rule",
    "u,v\ninf,2\n": "u is infinite",
    "u,v\n1e39,2\n": "u is infinite or too large",
    "u,v\n1,2\n--engine warp": "unknown engine 'warp'",
    "u,v\n1,2\n--single": "--single counts clocks",
    "u,v\n1,2\n--engines 65": "engines = 65",
    "u,v\n1,2\n--forest x.csv": "must be a .json, .skops, .onnx or .joblib file",
}


@pytest.mark.parametrize("given", REFUSED)
@pytest.mark.parametrize("engine", ["float", "fixed"])
def test_bad_input_is_refused_with_a_sentence(given, engine, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file.write(tmp_path / "F.json", by_hand())
    text, _, more = given.partition("--")
    (tmp_path / "x.csv").write_text(text)
    more = f"--{more}".split() if more else []
    with pytest.raises(SystemExit) as end:
        run(capsys, "x.csv", "--forest", "F.json", "--engine", engine, "--out", "o.npz", *more)
    error = capsys.readouterr().err
    assert end.value.code == 2 and error.count("\n") == 1 and REFUSED[given] in error, error
    assert {path.name for path in tmp_path.iterdir()} == {"F.json", "x.csv"}


def test_a_forest_without_names_takes_a_table_with_others_by_position(tmp_path):
    (tmp_path / "x.csv").write_text("a,b\n1,2\n")
    found = rows.read(tmp_path / "x.csv", ["x0", "x1"])
    assert found.x.tolist() == [[1, 2]] and found.taken == "by position, since the forest has no names"
    (tmp_path / "x.csv").write_text("x0,x2\n1,2\n")
    with pytest.raises(ValueError, match="the feature x1 is missing"):
        rows.read(tmp_path / "x.csv", ["x0", "x1"])
