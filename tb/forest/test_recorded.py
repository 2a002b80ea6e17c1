"""Forests trained on labelled recordings of slip (recorded.py): every row of the test set gets scikit-learn's
class except at a tie, which is counted and printed, as is the accuracy. Skipped, with a message, without the
data."""

import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesClassifier, RandomForestClassifier

import meissner
from forest import recorded
from forest.compare import agree


def compare(model, source, label, tmp_path, **engine):
    """Ties, and other classes among them, of a model trained, written, read and tested."""
    (x, y), (test_x, test_y) = recorded.read(source, label)
    model.set_params(random_state=0).fit(x, y)
    meissner.Forest(model, integer=source == "biotacsp" or ()).to_file(tmp_path / "F.json")
    forest = meissner.Forest.from_file(tmp_path / "F.json", **engine)
    found = agree(forest, model, test_x, f"{source}, {len(model.estimators_)} {type(model).__name__}")
    own, theirs = (np.mean(each.predict(test_x) == test_y) for each in (forest, model))
    print(f"accuracy {own:.4f}, scikit-learn's {theirs:.4f}, {forest.model.nodes} nodes, label {label}")
    return found


@pytest.mark.parametrize("kind", [RandomForestClassifier, ExtraTreesClassifier])
@pytest.mark.parametrize("source", recorded.SOURCES)
def test_small_forests(source, kind, tmp_path):
    compare(kind(16, max_depth=8), source, 0, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("source, label", [("biotacsp", 0), *(("osu_slip", label) for label in range(4))])
def test_published_forests(source, label, tmp_path):
    """400 trees of unlimited depth."""
    ties, others = compare(RandomForestClassifier(400, n_jobs=2), source, label, tmp_path)
    if source == "biotacsp":  # pure leaves: a row at one half is an exact tie in both
        assert (ties, others) == (2, 0)


@pytest.mark.long
@pytest.mark.parametrize("source, label", [("biotacsp", 0), ("osu_slip", 3)])
def test_published_forests_on_rtl(source, label, tmp_path):
    """The same on the blocks, with all nodes in block RAM that no board has."""
    compare(RandomForestClassifier(400, n_jobs=2), source, label, tmp_path, engine="rtl", engines=8)
