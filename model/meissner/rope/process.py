"""``meissner process rope``: slip of each frame of nine channels, or of any number, by a forest in F.json."""

import time

import numpy as np

from meissner import engines, files, readers
from meissner.engines.features import function
from meissner.forest import file
from meissner.forest.forest import Forest
from meissner.terminal import plain


def float_share(model, rows):
    """Share of the vote for the second class [rows]: thresholds and leaves in floats."""
    share = np.zeros(len(rows))
    exact = [feature.thresholds for feature in model.features]
    for tree in model.trees:
        pairs = zip(tree.feature, tree.threshold)
        limit = np.array([float(k) if exact[f] is None else [*exact[f], np.inf][k] for f, k in pairs])
        at = np.full(len(rows), tree.root)
        while (going := np.flatnonzero(at >= 0)).size:
            node = at[going]
            left = rows[going, tree.feature[node]] <= limit[node]
            at[going] = np.where(left, tree.left[node], tree.right[node])
        leaf = model.leaves[-1 - at].astype(float)
        share += leaf[:, 1] / leaf.sum(1)
    return share / len(model.trees)


def votes(engine, model, rows):
    """(share of the vote for slip, slip) of features [rows, n]."""
    if engine == "float":
        share = float_share(model, rows)
        return share, share > 0.5
    found = Forest(model, engine=engine).next(rows)
    return found.votes[:, 1] / found.votes.sum(1), found.index == 1


def decide(x, model, engine):
    """{"score", "slip"} [samples] of codes ``x`` [channels, samples]; 0 before the first whole window."""
    features, channels = len(model.features), len(x)
    if len(model.classes) != 2:
        raise ValueError(f"the forest decides {len(model.classes)} classes; slip needs two")
    if features % channels:
        raise ValueError(f"the forest has {features} features, no multiple of {channels} channels")
    window = features // channels
    if x.shape[1] <= window:
        raise ValueError(f"{x.shape[1]} samples do not fill a window of {window} differences")
    share, slip = votes(engine, model, function(engine, "forest_features")(x, window))
    return {
        "score": np.concatenate([np.zeros(window), share]),
        "slip": np.concatenate([np.zeros(window, bool), slip]),
    }


def rope(arguments):
    """``meissner process rope``."""
    engines.load(arguments.engine)
    model = file.read(arguments.forest)
    found = readers.read(arguments.input, arguments.column or (), unit=arguments.unit, samples_first=True)
    codes, done = found.flat().scaled(arguments.volts_per_code)
    x = engines.check_samples(codes)
    with files.results(arguments.out) as save:
        began = time.perf_counter()
        result = decide(x, model, arguments.engine)
        taken = time.perf_counter() - began
        save(result)
    rises = np.flatnonzero(np.diff(result["slip"].astype(int)) > 0) + 1
    first = f"first at sample {rises[0]}" if len(rises) else "none"
    print(plain(f"{found.said}; {done}"))
    print(
        f"{x.shape[1]} samples of {len(x)} channels, slip in {int(result['slip'].sum())} ({first}); "
        f"{x.size / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )
