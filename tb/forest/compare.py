"""Comparison with scikit-learn, for the tests of forests."""

import numpy as np

ERROR = 7.7e-6  # of a probability: half a step of 1/65535 is 7.63e-6


def agree(forest, model, x, what):
    """Classes and probabilities of ``forest`` are those of the scikit-learn ``model``; prints the ties."""
    theirs, ours = model.predict_proba(x), forest.predict_proba(x)
    assert np.abs(theirs - ours).max() <= ERROR, what
    best = np.sort(theirs, axis=1)[:, -2:]
    tie = best[:, -1] - best[:, 0] <= 2 * ERROR if theirs.shape[1] > 1 else np.zeros(len(x), bool)
    other = forest.predict(x) != model.predict(x)
    print(f"{what}: {len(x)} rows, {tie.sum()} at a tie, {other.sum()} of these with another class")
    assert not (other & ~tie).any(), what
    return int(tie.sum()), int(other.sum())


def sides(model):
    """Rows in which one feature lies at a threshold of a node, or a step of float32 beside it, and the other
    features as training left them; the numbers of thresholds whose float32 is above, and below."""
    rows, above, below = [], 0, 0
    middle = np.median([tree.tree_.threshold[tree.tree_.feature >= 0].mean() for tree in model.estimators_])
    for tree in model.estimators_:
        inner = tree.tree_.children_left >= 0
        for feature, threshold in zip(tree.tree_.feature[inner], tree.tree_.threshold[inner]):
            single = np.float32(threshold)
            above, below = above + (single > threshold), below + (single < threshold)
            ends = np.nextafter(single, np.float32([-np.inf, np.inf]), dtype=np.float32)
            for value in (threshold, single, *ends):
                row = np.full(model.n_features_in_, middle)
                row[feature] = value
                rows.append(row)
    return np.array(rows), above, below
