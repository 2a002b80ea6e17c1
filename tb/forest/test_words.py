"""The word of a node, against literals put together by hand from docs/forest.md."""

import numpy as np
import pytest
from sklearn.datasets import load_wine
from sklearn.ensemble import RandomForestClassifier

import meissner
from meissner.forest import file, words

# x0 <= -3 ? (x1 <= 5 ? leaf 0 : leaf 1) : (x0 <= 2^21 - 2 ? (x1 <= 0 ? leaf 1 : leaf 2) : leaf 2)
LISTS = dict(feature=[0, 1, 0, 1], threshold=[-3, 5, 2097150, 0], left=[1, -1, 3, -2], right=[2, -2, -3, -3])
# leaf 0 <- x1 <= -2^21 -> (x0 <= 1 ? leaf 2 : leaf 0)
OTHER = dict(feature=[1, 0], threshold=[-2097152, 1], left=[-1, -3], right=[1, -1])
ALONE = dict(feature=[], threshold=[], left=[], right=[], leaf=1)


def model(leaves, classes, trees=(LISTS, OTHER, ALONE)):
    features = [{"name": name, "kind": "integer"} for name in ("a", "b")]
    return file.check(
        {"format": "meissner-forest", "version": 1, "source": "by hand", "classes": classes}
        | {"features": features, "leaves": leaves, "trees": list(trees)}
    )


def test_two_classes_have_their_votes_in_the_word():
    """Leaves 0, 1, 2 vote 65535, 0xABCD = 43981 and 0x0102 = 258 for class 1."""
    found = words.pack(model([[0, 65535], [21554, 43981], [65277, 258]], ["no", "yes"]))
    assert [hex(word) for word in found.nodes] == [
        "0x3ffffd00000002",  # kind 0, feature 0, -3 in 22 bits; its right child is at 2
        "0xc0400005ffffabcd",  # kind 3, feature 1, 5
        "0x801ffffe00000102",  # kind 2, feature 0, 2097150; right leaf 258
        "0xc0400000abcd0102",  # kind 3, feature 1, 0
        "0x40600000ffff0000",  # kind 1, feature 1, -2097152; left leaf 65535
        "0xc00000010102ffff",  # kind 3, feature 0, 1
        "0xc0000000abcdabcd",  # one leaf
    ]
    assert found.roots.tolist() == [0, 4, 6] and found.leaves.size == 0
    assert words.beats(found.nodes[:1]).tolist() == [0x0002, 0x0000, 0xFFFD, 0x003F]


def test_more_classes_have_rows_of_the_table_and_trees_any_order():
    leaves = [[1, 2, 65532], [7, 65500, 28], [65535, 0, 0]]
    found = words.pack(model(leaves, [4, 5, 6]), trees=[1, 0])
    assert [hex(word) for word in found.nodes[:3]] == [
        "0x4060000000000000",  # kind 1: left leaf 0
        "0xc000000100020000",  # kind 3: leaves 2 and 0
        "0x3ffffd00000004",  # the root of the other tree, at 2: its right child is at 4
    ]
    assert found.roots.tolist() == [0, 2] and found.leaves.tolist() == leaves


@pytest.mark.parametrize("threshold", [-2097153, 2097151])
def test_a_threshold_that_saturation_would_change_is_refused(threshold):
    lists = OTHER | {"threshold": [threshold, 1]}
    with pytest.raises(ValueError, match="tree 0: a threshold"):
        words.pack(model([[0, 65535]] * 3, [0, 1], [lists]))


def test_what_the_word_cannot_number_is_refused():
    with pytest.raises(ValueError, match="65537 distinct leaves"):
        words.pack(model([[1, 2, 65532]] * 65537, [0, 1, 2]))
    words.pack(model([[1, 2, 65532]] * 65536, [0, 1, 2]))
    whole = file.document(model([[0, 65535]] * 3, [0, 1]))
    for count in (256, 257):
        whole["features"] = [{"name": "a", "kind": "integer"}] * count
        lists = OTHER | {"threshold": [0, 1], "feature": [count - 1, 0]}
        given = file.check(whole | {"trees": [lists]})
        if count == 256:
            assert words.pack(given).nodes[0] >> np.uint64(54) & np.uint64(255) == 255
        else:
            with pytest.raises(ValueError, match="257 features"):
                words.pack(given)


@pytest.mark.parametrize("rule", [False, True])
def test_of_more_than_256_features_those_asked_for_have_columns(rule):
    """Of 300 features the nodes ask for 299 and 2. With a rule, one column each also holds their missing
    values; where a core has a column for each of 256 features, these are used as they are."""
    whole = file.document(model([[0, 65535]] * 3, [0, 1]))
    features = [{"name": "a", "kind": "integer"}] * 300
    lists = OTHER | {"threshold": [0, 1], "feature": [299, 2]} | ({"missing_left": [1, 0]} if rule else {})
    given = file.check(whole | {"features": features, "trees": [lists]})
    inside, inputs = words.without_missing(given)
    assert inputs.source.tolist() == [2, 299] and inside.trees[0].feature.tolist() == [1, 0]
    q, lost = np.arange(300)[None], np.zeros((1, 300), bool)
    assert inputs.of(q, None).tolist() == [[2, 299]]
    lost[0, 7] = True  # no node asks for it
    assert inputs.of(q, lost).tolist() == [[2, 299]]
    lost[0, 2] = True
    if rule:
        assert inputs.of(q, lost).tolist() == [[words.THRESHOLD_LIMIT - 1, 299]]
    else:
        with pytest.raises(ValueError, match="row 0: feature 2 is NaN"):
            inputs.of(q, lost)
    for room, source in ((2, [2, 299]), (300, [*range(300)]), (3, [*range(300)])):
        assert words.without_missing(given, room)[1].source.tolist() == source
    few = file.check(whole | {"features": features[:256], "trees": [lists | {"feature": [255, 2]}]})
    assert len(words.without_missing(few)[1].source) == (2 if rule else 256)


def votes(found, q, classes):
    """Votes for one row of columns: a walk through the memory as the table of docs/forest.md says."""
    total = np.zeros(classes, np.int64)
    for at in found.roots.tolist():
        leaf = None
        while leaf is None:
            word = int(found.nodes[at])
            kind, low = word >> 62, word & 0xFFFFFFFF
            threshold = (word >> 32 & 0x3FFFFF ^ 0x200000) - 0x200000
            left = q[word >> 54 & 255] <= threshold
            if (kind in (1, 3)) if left else (kind in (2, 3)):
                leaf = low >> 16 if left else low & 0xFFFF
            else:
                at = low if kind == 0 and not left else at + 1
        total += [65535 - leaf, leaf] if classes == 2 else found.leaves[leaf]
    return total.tolist()


@pytest.mark.parametrize("classes", [2, 3])
@pytest.mark.parametrize("integer", [(), True], ids=["ranks", "integers"])
def test_a_walk_through_the_memory_gives_scikit_learns_votes(classes, integer):
    """Also where values are missing, which go to both sides in the nodes of one feature."""
    x, y = load_wine(return_X_y=True)
    x, y = np.rint(x - x.mean(0)) if integer else x, np.minimum(y, classes - 1)  # thresholds of both signs
    holes = np.where(np.random.default_rng(1).random(x.shape) < 0.2, np.nan, x)
    model = RandomForestClassifier(5, random_state=1, max_leaf_nodes=12).fit(holes, y)
    forest = meissner.Forest(model, integer=integer)
    inside, inputs = words.without_missing(forest.model)
    assert len(set(inputs.source.tolist())) < len(inputs.source)
    found, columns = words.pack(inside), inputs.of(*forest.quantise(holes))
    walked = [votes(found, row, classes) for row in columns.tolist()]
    assert np.abs(np.array(walked) / (5 * 65535) - model.predict_proba(holes)).max() < 7.7e-6
    assert walked == forest.process(holes).votes.tolist()
    whole = [votes(words.pack(forest.model), row, classes) for row in forest.quantise(x)[0].tolist()]
    assert whole == forest.process(x).votes.tolist()


def test_trees_are_spread_by_size_there_and_back():
    """Trees of 4, 2 and no nodes, twice and once: the largest first, each turn in the other direction."""
    given = model([[0, 65535]] * 3, [0, 1], [ALONE, LISTS, OTHER, LISTS, ALONE])
    assert words.spread(given, 1) == [[0, 1, 2, 3, 4]]
    assert words.spread(given, 2) == [[0, 1, 4], [2, 3]]  # order 1, 3 | 2, 0 | 4: engines 0, 1 | 1, 0 | 0
    assert words.spread(given, 7) == [[1], [3], [2], [0], [4], [], []]


def test_the_writes_that_load_a_forest():
    """OTHER and ALONE by two engines: kind, engine, address, data; then votes by class and row."""
    leaves = [[1, 2, 65532], [7, 65500, 28], [65535, 0, 0]]
    node = lambda word: int(word, 16)
    assert words.loads(model(leaves, [4, 5, 6], [ALONE, OTHER]), 2) == [
        *((0, 0, 0, node("0x4060000000000000")), (0, 0, 1, node("0xc000000100020000"))),
        *((1, 0, 0, 0), (3, 0, 0, 1)),
        *((0, 1, 0, node("0xc000000000010001")), (1, 1, 0, 0), (3, 1, 0, 1)),
        *((2, 0, 0, 1), (2, 0, 65536, 2), (2, 0, 131072, 65532)),
        *((2, 0, 1, 7), (2, 0, 65537, 65500), (2, 0, 131073, 28)),
        *((2, 0, 2, 65535), (2, 0, 65538, 0), (2, 0, 131074, 0)),
    ]
    two = words.loads(model([[0, 65535]] * 3, [0, 1], [ALONE, OTHER]), 3)
    assert [row for row in two if row[0] == 2] == [] and two[-1] == (3, 2, 0, 0)
