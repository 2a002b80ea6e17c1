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


def sides(trees, x):
    """For each node of ``trees`` a row of ``x`` that comes to it, with its feature at the threshold, at the
    float32 of that, and a step of float32 below and above; how many float32 are above, below theirs."""
    rows, above, below = [], 0, 0
    for each in trees:
        tree = each.tree_
        paths = each.decision_path(x.astype(np.float32)).tocsc()
        for node in np.flatnonzero((tree.children_left >= 0) & (np.diff(paths.indptr) > 0)):
            threshold = tree.threshold[node]
            single = np.float32(threshold)
            above, below = above + (single > threshold), below + (single < threshold)
            for value in (threshold, single, *np.nextafter(single, np.float32([-np.inf, np.inf]))):
                row = x[paths.indices[paths.indptr[node]]].copy()
                row[tree.feature[node]] = value
                rows.append(row)
    return np.array(rows), above, below


def walk(trees, rows, of_value=np.float32, of_threshold=np.float64, compare=np.less_equal, hard=False):
    """Index of the class by a plain walk through scikit-learn's arrays, by its rules or the given ones."""
    found = []
    for row in rows:
        votes = 0
        for each in trees:
            tree, node = each.tree_, 0
            while (left := tree.children_left[node]) >= 0:
                value, threshold = of_value(row[tree.feature[node]]), of_threshold(tree.threshold[node])
                node = left if compare(value, threshold) else tree.children_right[node]
            leaf = tree.value[node, 0]
            votes = votes + (np.eye(len(leaf))[leaf.argmax()] if hard else leaf)
        found.append(np.argmax(votes))
    return np.array(found)
