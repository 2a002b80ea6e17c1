"""``meissner process rope``: a forest written by hand decides as worked out by hand, on float, fixed and rtl
and from both kinds of files; what does not fit is refused, and nothing is written."""

import re

import numpy as np
import pytest

from meissner import cli
from meissner.forest import file
from meissner.forest.file import Feature, Model, Tree

ENGINES = ("float", "fixed", "rtl")


def tree(feature, threshold, left, right):
    return Tree(*(np.array(part, np.int64) for part in (feature, threshold, left, right)))


@pytest.fixture
def forest(tmp_path):
    """Two channels, windows of two. Slip for certain if channel 0's last step is -3 or less; the second tree
    says 0.4 if channel 1's first step is 5 or less, else 1; the third says 0."""
    leaves = np.array([[65535, 0], [0, 65535], [39321, 26214]], np.uint16)
    trees = [
        tree([2], [-3], [-2], [-1]),
        tree([1], [5], [-3], [-2]),
        Tree(*(np.zeros(0, np.int64),) * 4, leaf=0),
    ]
    path = tmp_path / "F.json"
    file.write(path, Model("by hand", [0, 1], [Feature(f"x{k}") for k in range(4)], leaves, trees))
    return path


# Frames of two channels; steps 0 / -3, +1 / 0, -4 / +6, -2 / 0.
CODES = [[10, 10, 7, 7, 3, 1], [5, 5, 5, 11, 12, 12]]
# Of frame n >= 2: steps of channel 0 at n, of channel 1 at n - 1; three trees' shares of 65535.
SCORES = [0, 0, (1 + 0.4 + 0) / 3, (0 + 0.4) / 3, (1 + 1) / 3, 0.4 / 3]
SLIP = [False, False, False, False, True, False]


def run(*given):
    cli.main([*map(str, given)])


@pytest.mark.parametrize("engine", ENGINES)
def test_it_decides_as_worked_out_by_hand(engine, forest, tmp_path, capsys):
    np.save(tmp_path / "in.npy", np.array(CODES).T)
    run(
        "process",
        "rope",
        tmp_path / "in.npy",
        "--forest",
        forest,
        "--engine",
        engine,
        "--out",
        tmp_path / "o.npz",
    )
    found = np.load(tmp_path / "o.npz")
    assert found["score"] == pytest.approx(SCORES, abs=1e-12) and found["slip"].tolist() == SLIP
    assert "slip in 1 (first at sample 4)" in capsys.readouterr().out


def test_a_table_gives_the_same(forest, tmp_path):
    (tmp_path / "in.csv").write_text("\n".join(f"{a},{b}" for a, b in zip(*CODES)))
    run("process", "rope", tmp_path / "in.csv", "--forest", forest, "--out", tmp_path / "o.csv")
    rows = [line.split(",") for line in (tmp_path / "o.csv").read_text().splitlines()]
    assert rows[0] == ["score", "slip"] and [row[1] for row in rows[1:]] == ["0", "0", "0", "0", "1", "0"]


def test_all_engines_agree_on_a_trained_forest(tmp_path):
    from meissner.forest.sklearn import of_model
    from meissner.rope import process, train

    rng = np.random.default_rng(2)
    x = rng.integers(-9, 10, (300, 12))
    model = of_model(train.fit(x, x[:, 3] + x[:, 7] > 4, 1, 15), True)
    codes = np.cumsum(rng.integers(-9, 10, (3, 90)), axis=1)
    one, other, core = (process.decide(codes, model, engine)[0] for engine in ENGINES)
    assert one["score"] == pytest.approx(other["score"], abs=7.7e-6)
    assert np.array_equal(one["slip"], other["slip"]) and 0 < other["slip"].sum() < 90
    assert all(np.array_equal(core[name], other[name]) for name in other)


@pytest.mark.parametrize(
    "codes, engine, says",
    [
        (np.zeros((6, 3), int), "fixed", "4 features, no multiple of 3 channels"),
        (np.zeros((2, 2), int), "fixed", "2 samples do not fill a window of 2 differences"),
        (np.full((6, 2), 0.5), "fixed", "integer"),
        (np.full((6, 2), np.nan), "float", "NaN"),
        (np.full((6, 2), 70000), "fixed", "70000"),
        (np.zeros((6, 2), int), "quick", "unknown engine 'quick'"),
    ],
)
def test_bad_input_is_refused_with_a_sentence(codes, engine, says, forest, tmp_path, capsys):
    np.save(tmp_path / "in.npy", codes)
    with pytest.raises(SystemExit) as end:
        given = ["process", "rope", tmp_path / "in.npy", "--forest", forest, "--engine", engine]
        run(*given, "--out", tmp_path / "o.npz")
    err = capsys.readouterr().err
    assert end.value.code == 2 and err.count("\n") == 1 and not (tmp_path / "o.npz").exists()
    assert re.search(says, err), err


def test_a_forest_of_three_classes_is_refused(tmp_path, forest):
    from meissner.rope import process

    model = file.read(forest)
    wide = Model("x", [0, 1, 2], model.features, np.zeros((3, 3), np.uint16), model.trees)
    with pytest.raises(ValueError, match="3 classes"):
        process.decide(np.array(CODES), wide, "fixed")
