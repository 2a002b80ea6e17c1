"""The training set of rope slip: its patterns, pairs, recordings and sections; windows by hand; which
sections a test gets; measures counted by hand; and a forest that is trained on steps it can see."""

from types import SimpleNamespace

import numpy as np
import pytest

from meissner.physics.rope import Pull
from meissner.rope import labels, train
from meissner.rope.labels import PATTERNS, Section
from meissner.scenes.rope.run import answer


def test_the_published_set():
    """2 ropes, 5 positions, 2 modes, 4 pairs of 2: 160 values, 80 pairs, 240 recordings, 480 sections."""
    every = train.pulls(Pull(pull_s=5.0))
    assert len(every) == 240 and sum(len(one.values) for one in every) == 480
    kinds = {(one.rope, one.position, one.mode, one.values) for one in every}
    assert len(kinds) == 80 and len({(*kind[:3], value) for kind in kinds for value in kind[3]}) == 160
    assert {one.values for one in every if one.mode == "force"} == {(1, 3), (5, 7), (9, 11), (13, 15)}
    assert {one.values for one in every if one.mode == "speed"} == {(2, 4), (6, 8), (10, 15), (20, 30)}
    assert {one.rope for one in every} == {"a", "c"} and all(one.post for one in every)


def recording(codes, sections):
    return SimpleNamespace(channels=np.asarray(codes), sections=sections)


def test_windows_by_hand():
    """Two channels; the window of frame 3 has the steps to frames 2 and 3, both channels of each."""
    steps = train.steps(recording([[1, 4, 9, 16, 25], [0, 1, 0, 1, 0]], []))
    assert steps.tolist() == [[3, 1], [5, -1], [7, 1], [9, -1]]
    assert train.windows(steps, np.array([3, 4]), 2).tolist() == [[5, -1, 7, 1], [7, 1, 9, -1]]
    assert train.windows(steps, np.array([3]), 3).tolist() == [[3, 1, 5, -1, 7, 1]]


def recordings(count=60):
    """A section that slips at frame 60 by a step of 40 codes, and one that does not."""
    rng, found = np.random.default_rng(7), []
    for k in range(count):
        codes = rng.integers(-2, 3, (9, 240)) + 1000 * k
        codes[:, 61:100] -= 40
        found.append(recording(codes, [Section(20, 100, 60), Section(120, 200, None)]))
    return found


def test_the_test_sections_are_in_no_training_set():
    data = train.Data(recordings(), 3)
    slips = [section.slip is not None for _, section in data.test]
    assert (sum(slips), len(slips), len(data.rest), data.slipping) == (24, 32, 88, 36)
    key = lambda sections: {(id(steps), section.slip) for steps, section in sections}
    assert len(key(data.test) | key(data.rest)) == 120 and not key(data.test) & key(data.rest)
    drawn = lambda seed: [int(steps[0, 0]) for steps, _ in train.Data(recordings(), seed).test]
    assert drawn(3) == drawn(3) != drawn(4)
    with pytest.raises(ValueError, match="8 sections without slip"):
        slipping = [recording(np.zeros((9, 240)), [Section(20, 100, 60)]) for _ in range(20)]
        train.Data(recordings(8) + slipping, 1)


def test_the_rows_of_a_pattern():
    """36 slipping sections give 5 ones and 10 zeros each, 52 others 25 zeros; a tenth is held for
    validation."""
    data = train.Data(recordings(), 3)
    x, y = data.rows(PATTERNS["E"])
    assert x.shape == (36 * 15 + 52 * 25, 54) and y.sum() == 180
    # The step is in the first five windows from frame 61 on; windows of frames 60 .. 64 are ones.
    assert (x[y == 1] < -30).any(axis=1).sum() == 4 * 36 and not (x[y == 0] < -30).any()
    (train_x, train_y), (held_x, held_y) = data.split(PATTERNS["E"])
    assert len(held_y) == 184 and len(train_y) == 1656
    both = np.concatenate([np.column_stack(pair) for pair in ((train_x, train_y), (held_x, held_y))])
    assert sorted(map(tuple, both)) == sorted(map(tuple, np.column_stack([x, y])))
    _, of_test = data.rows(PATTERNS["E"], labels.testing)
    assert len(of_test) == 24 * (64 - 26 + 1) + 8 * (199 - 126 + 1) and of_test.sum() == 24 * 5


def test_a_forest_learns_the_step():
    data = train.Data(recordings(), 3)
    (x, y), (held_x, held_y) = data.split(PATTERNS["E"])
    model = train.fit(x, y, 3, 20)
    assert len(model.estimators_) == 20
    seen = (held_x < -30).any(axis=1)
    assert (model.predict(held_x)[seen] == 1).all() and held_y[seen].all()
    again = train.fit(x, y, 3, 20)
    assert np.array_equal(again.predict_proba(held_x), model.predict_proba(held_x))


def test_measures_by_hand():
    """4 of 6 right; 3 of 4 zeros and 1 of 2 ones found; 3 of 4 reports of 0 and 1 of 2 of 1 are right."""
    truth, found = np.array([0, 0, 0, 0, 1, 1]), np.array([0, 0, 0, 1, 1, 0])
    assert train.measures(truth, found) == (4 / 6, 3 / 4, 1 / 2, 3 / 4, 1 / 2)
    assert train.measures(np.zeros(2), np.zeros(2)) == (1.0, 1.0, None, 1.0, None)


def test_the_answer_counts_only_ropes_that_slip():
    rows = [
        {"condition": name, "slipping_sections": slips, "oscillation": rms}
        for name, slips, rms in (("a", 0, 11.5), ("b", 2, 9.25), ("c", 1, 4.5))
    ]
    assert answer({"conditions": rows[:1]}) == "The rope does not slip."
    assert "by 4.5 codes rms (c) to 9.2 (b)." in answer({"conditions": rows})
