"""F.json: written and read again, every kind of damage refused with its place. The file under test is written
by hand; its checksums are zlib's of json.dumps."""

import json
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import meissner
from meissner.forest import file

# x0 <= 0.5: left, class b; else x1 <= 3: class a or 3 to 1 for b
WHOLE = {
    "format": "meissner-forest",
    "version": 1,
    "source": "by hand",
    "classes": ["a", "b"],
    "features": [
        {"name": "x0", "kind": "float", "thresholds": [-1.25, 0.5]},
        {"name": "x1", "kind": "integer"},
    ],
    "leaves": [[65535, 0], [0, 65535], [16384, 49151]],
    "trees": [
        {"feature": [0, 1], "threshold": [1, 3], "left": [-2, -1], "right": [1, -3], "missing_left": [1, 0]},
        {"feature": [], "threshold": [], "left": [], "right": [], "missing_left": [], "leaf": 2},
    ],
}


def crc(value):
    return f"{zlib.crc32(json.dumps(value, sort_keys=True, separators=(',', ':')).encode()):08x}"


def summed(whole):
    sums = {part: crc(value) for part, value in whole.items()}
    return whole | {"crc32": sums | {name: [*map(crc, whole[name])] for name in ("features", "trees")}}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "F.json"


def text_of(whole):
    return json.dumps(summed(whole), indent=1)


def test_a_file_written_by_hand_decides_as_its_numbers_say(path):
    path.write_text(text_of(WHOLE))
    forest = meissner.Forest.from_file(path)
    x = [[0.5, 9], [0.51, 3], [0.51, 4], [np.nan, 4], [7, np.nan]]
    result = forest.process(x)
    alone = np.array([16384, 49151])
    assert (result.votes - alone).tolist() == [
        [0, 65535],
        [65535, 0],
        [16384, 49151],
        [0, 65535],
        [16384, 49151],
    ]
    assert forest.predict(x).tolist() == ["b", "a", "b", "b", "b"]
    assert forest.predict_proba(x)[1].tolist() == [81919 / 131070, 49151 / 131070]
    forest.to_file(path)
    assert json.loads(path.read_text()) == summed(WHOLE)
    first = path.read_bytes()
    meissner.Forest.from_file(path).to_file(path)
    assert path.read_bytes() == first


def at(*keys, value):
    """WHOLE with one value replaced; None: removed."""

    def change(whole):
        inner = whole
        for key in keys[:-1]:
            inner = inner[key]
        if value is None:
            del inner[keys[-1]]
        else:
            inner[keys[-1]] = value

    return change


NODE = "trees", 0
WRONG = [
    (at("format", value="other"), "this is no forest"),
    (at("version", value=2), "version 2 is not known"),
    (at("version", value=True), "version True"),
    (at("source", value=3), "source must be"),
    (at("classes", value=None), "has no classes"),
    (at("more", value=1), "has a key 'more'"),
    (at("classes", value=[]), "classes must be a list of 1"),
    (at("classes", value=["a", 1]), "labels of one kind"),
    (at("classes", value=[None, None]), "labels of one kind"),
    (at("classes", value=["a", "a"]), "classes: 'a' stands there twice"),
    (at("classes", value=["a", "b", "c"]), "leaf 0 has 2 votes for 3 classes"),
    (at("classes", value=["a", "a\0"]), "classes: 'a\\x00' has more than 1000 characters or ends in"),
    (at("classes", value=["a", "b" * 1001]), "classes: 'bbb"),
    (at("classes", value=[1 << 63, -1]), "classes: -1 to 9223372036854775808 must be integers of 64 bits"),
    (at("classes", value=[1, 1 << 64]), "classes: 1 to 18446744073709551616 must be"),
    (at("classes", value=[-(1 << 63) - 1, 0]), "classes: -9223372036854775809 to 0 must be"),
    (at("features", value=[]), "features must be a list of 1"),
    (at("features", 1, value=7), "feature 1 must be an object"),
    (at("features", 1, "kind", value="int"), "feature 1: its kind"),
    (at("features", 1, "kind", value="float"), "feature 1: its kind"),
    (at("features", 0, "kind", value="integer"), "feature 0: its kind"),
    (at("features", 0, "name", value=0), "feature 0: its name"),
    (at("features", 0, "thresholds", 0, value=0.5), "feature 0, threshold 1 must be above"),
    (at("features", 0, "thresholds", 1, value=1), "feature 0, threshold 1: 1 must be a finite float"),
    (at("features", 0, "thresholds", 1, value="x"), "feature 0, threshold 1: 'x'"),
    (at("leaves", 2, value=[16383, 49151]), "leaf 2: its votes"),
    (at("leaves", 2, value=[-1, 65536]), "leaf 2: its votes"),
    (at("leaves", 2, 0, value=1.0), "leaf 2, class 0: 1.0 must be an integer"),
    (at("leaves", value={}), "leaves must be a list"),
    (at("trees", value=[]), "trees must be a list of 1 to 65535, not 0"),
    (at(*NODE, "left", value=None), "tree 0 has no left"),
    (at(*NODE, "left", value=[1]), "tree 0 has 2 nodes, but 1 in left"),
    (at(*NODE, "left", value="11"), "tree 0, left must be a list"),
    (at(*NODE, "feature", 1, value=True), "tree 0, feature, node 1: True must be an integer"),
    (at(*NODE, "feature", 1, value=1 << 80), "tree 0, feature, node 1: 12089"),
    (at(*NODE, "feature", 1, value=2), "tree 0, node 1: feature = 2 must lie in 0 .. 1"),
    (at(*NODE, "feature", 0, value=-1), "tree 0, node 0: feature = -1"),
    (at(*NODE, "threshold", 0, value=3), "tree 0, node 0: threshold = 3 must lie in 0 .. 2"),
    (at(*NODE, "threshold", 0, value=-1), "tree 0, node 0: threshold = -1"),
    (at(*NODE, "threshold", 1, value=1 << 24), "tree 0, node 1: threshold = 16777216 must lie in"),
    (at(*NODE, "threshold", 1, value=-(1 << 24) - 1), "tree 0, node 1: threshold = -16777217"),
    (
        at(*NODE, "right", 0, value=0),
        "tree 0, node 0: right = 0 must be a later node below 2, or a leaf, -3 .. -1",
    ),
    (at(*NODE, "right", 0, value=2), "tree 0, node 0: right = 2"),
    (at(*NODE, "left", 1, value=-4), "tree 0, node 1: left = -4"),
    (at(*NODE, "left", 0, value=1), "tree 0, node 1: it is a child of 2 nodes"),
    (at(*NODE, "right", 0, value=-1), "tree 0, node 1: it is a child of 0 nodes"),
    (at(*NODE, "missing_left", 1, value=2), "tree 0, node 1: missing_left = 2"),
    (at(*NODE, "missing_left", value=None), "tree 0 has no missing_left, but others have"),
    (at(*NODE, "leaf", value=0), "tree 0 must have nodes or be one leaf"),
    (at("trees", 1, "leaf", value=None), "tree 1 must have nodes or be one leaf"),
    (at("trees", 1, "leaf", value=3), "tree 1: leaf = 3 must lie in 0 .. 2"),
    (at("trees", 1, "leaf", value=0.0), "tree 1: leaf = 0.0"),
]


@pytest.mark.parametrize("change, says", WRONG, ids=[says for _, says in WRONG])
def test_what_does_not_fit_is_refused_with_its_place(path, change, says):
    """With checksums that match, so that the parts' own check is what refuses."""
    whole = json.loads(json.dumps(WHOLE))
    change(whole)
    missing = [name for name in WHOLE if name not in whole]
    lists = {name: [] for name in missing}
    with_sums = (
        summed(whole | lists)
        if all(isinstance(whole.get(n, []), list) for n in ("features", "trees"))
        else whole
    )
    path.write_text(json.dumps({key: value for key, value in with_sums.items() if key not in missing}))
    with pytest.raises(ValueError) as refused:
        file.read(path)
    assert str(refused.value).startswith(f"{path}: ") and says in str(refused.value), refused.value


def test_nodes_out_of_order_are_refused(path):
    """Each node once, children later than parents, but the left part is not the next one."""
    tree = {"feature": [0] * 3, "threshold": [0] * 3, "left": [2, -1, -1], "right": [1, -2, -3]}
    path.write_text(text_of(WHOLE | {"trees": [tree]}))
    with pytest.raises(ValueError, match="tree 0, node 0: its first inner child must be node 1"):
        file.read(path)


EDITS = [
    ('"by hand"', '"by hands"', "source: its crc32"),
    ('"a"', '"c"', "classes: its crc32"),
    ("-1.25", "-1.26", "feature 0: its crc32"),
    ('"x1"', '"x2"', "feature 1: its crc32"),
    ("16384", "16385", "leaf 2"),
    ('"missing_left": [\n    1,', '"missing_left": [\n    0,', "tree 0: its crc32"),
    ('"leaf": 2', '"leaf": 1', "tree 1: its crc32"),
]


@pytest.mark.parametrize("old, new, says", EDITS, ids=[says for *_, says in EDITS])
def test_an_edited_number_is_refused_with_the_part_that_holds_it(path, old, new, says):
    text = text_of(WHOLE)
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    with pytest.raises(ValueError, match=says):
        file.read(path)


def test_every_truncation_and_every_changed_digit_is_refused(path):
    text = text_of(WHOLE)
    for size in range(0, len(text) - 1, 7):
        path.write_text(text[:size])
        with pytest.raises(ValueError, match=r"no whole JSON: .* at line \d+, column \d+"):
            file.read(path)
    for place in [index for index, letter in enumerate(text) if letter.isdigit()][::3]:
        path.write_text(text[:place] + str((int(text[place]) + 1) % 10) + text[place + 1 :])
        with pytest.raises(ValueError):
            file.read(path)


def test_other_texts_are_refused(path):
    text = text_of(WHOLE)
    for data, says in (
        (b"\xff", "byte 0 is not UTF-8"),
        (b"[]", "this is no forest"),
        (b"null", "this is no forest"),
        (b"[" * 100000, "cannot be read|no whole JSON"),
        (text.replace('"version": 1', '"version": 1, "version": 1').encode(), "'version' stands there twice"),
        (text.replace("-1.25", "NaN").encode(), "NaN is no number"),
        (text.replace("-1.25", "-1e999").encode(), "feature 0, threshold 0"),
        (text.replace('"a"', "1e400").replace('"b"', "1.5").encode(), "classes must be finite"),
        (text.replace("16384", "9" * 5000).encode(), "cannot be read"),
        (json.dumps(WHOLE).encode(), "has no crc32"),
        (json.dumps(summed(WHOLE) | {"crc32": "00"}).encode(), "crc32 must be an object"),
        (
            json.dumps(summed(WHOLE) | {"crc32": {**summed(WHOLE)["crc32"], "trees": []}}).encode(),
            "trees: its crc32",
        ),
    ):
        path.write_bytes(data)
        with pytest.raises(ValueError, match=says):
            file.read(path)
    for name, says in ((path.parent, "is a folder"), (path.parent / "no.json", "there is no file")):
        with pytest.raises(ValueError, match=says):
            meissner.Forest.from_file(name) if name.suffix else file.read(name)


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_any_value_anywhere_is_read_or_refused(data):
    """Values of any kind in any place, with checksums that match: a Model or a sentence."""
    whole = json.loads(json.dumps(WHOLE))
    inner = whole
    keys = []
    while isinstance(inner, dict | list) and inner and (not keys or data.draw(st.booleans())):
        keys.append(
            data.draw(st.sampled_from(sorted(inner) if isinstance(inner, dict) else range(len(inner))))
        )
        inner = inner[keys[-1]]
    leaf = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=3))
    value = data.draw(
        st.recursive(
            leaf,
            lambda more: st.lists(more, max_size=3) | st.dictionaries(st.text(max_size=4), more, max_size=2),
            max_leaves=4,
        )
    )
    at(*keys, value=value)(whole)
    try:
        model = file.check(whole)
    except ValueError as problem:
        assert "\n" not in str(problem)
    else:
        meissner.Forest(model).process([[0.0, 1]]) if len(model.features) == 2 else None
