"""``meissner process forest``: classes and votes of rows of features, by any forest on any engine."""

import time
from typing import Any, NamedTuple

import numpy as np

from meissner import engines, files
from meissner.forest import models, rows
from meissner.forest.file import ONE
from meissner.forest.forest import Forest
from meissner.terminal import plain

SINGLES = 30  # rows for which the library's own time of one row is taken
MHZ = 100


class Decided(NamedTuple):
    """``index`` of each row's class; ``votes`` [rows, classes]: 65535 times the sum of the trees'
    probabilities. ``by``: what decided, if the engine is float; ``run``: of rtl and gate."""

    index: Any
    votes: Any
    seconds: float
    by: str = ""
    run: Any = None


def in_floats(model, x):
    """The votes [rows, classes] of features ``x``, which are compared in floating point."""
    votes, single = np.zeros((len(x), len(model.classes))), np.asarray(x).astype(np.float32)
    exact = [None if each.thresholds is None else [*each.thresholds, np.inf] for each in model.features]
    for tree in model.trees:
        pairs = zip(tree.feature.tolist(), tree.threshold.tolist())
        limit = np.array([k if exact[f] is None else exact[f][k] for f, k in pairs], np.float64)
        at = np.full(len(x), tree.root)
        while (going := np.flatnonzero(at >= 0)).size:
            node = at[going]
            value = single[going, tree.feature[node]]
            left = value <= limit[node]
            if tree.missing_left is not None:
                left = np.where(np.isnan(value), tree.missing_left[node], left)
            at[going] = np.where(left, tree.left[node], tree.right[node])
        votes += model.leaves[-1 - at]
    return votes


def decide(engine, model, x, count=1, own=None):
    """The Decided of features ``x`` [rows, features] by ``model``. ``count``: tree engines of rtl and gate;
    ``own``: meissner.forest.models.Opened's, which decides as engine float if it is there.

    ValueError: see Forest.quantise.
    """
    forest = Forest(model, engine="fixed" if engine == "float" else engine, engines=count)
    if engine != "float":
        began = time.perf_counter()
        found = forest.process(x)
        taken, run = time.perf_counter() - began, getattr(forest, "run", None)
        return Decided(*found, taken if run is None else run.seconds, run=run)
    forest.quantise(x)  # refuses what the other engines refuse
    name, function = own() if own else ("thresholds and leaves of F.json", None)
    began = time.perf_counter()
    if function is None:
        votes = in_floats(model, x)
        return Decided(votes.argmax(1), votes, time.perf_counter() - began, name)
    index, share = function(x)
    return Decided(index, share * (ONE * len(model.trees)), time.perf_counter() - began, name)


def forest(arguments):
    """``meissner process forest``."""
    engines.load(arguments.engine)
    single = arguments.single
    if single and arguments.engine not in engines.VERILATED:
        raise ValueError("--single counts clocks, which only the engines rtl and gate have")
    model, own = models.either(arguments.forest, trust=arguments.trust)
    x, _, taken = rows.read(arguments.input, [feature.name for feature in model.features])
    with files.results(arguments.out) as save:
        found = decide(arguments.engine, model, x, arguments.engines, own)
        classes = np.array(model.classes)[found.index]
        table = arguments.out.lower().endswith(".csv")
        result = {"class": classes, "votes": found.votes.T if table else found.votes}
        if single:
            result["clocks"] = Forest(model, engine=arguments.engine, engines=arguments.engines).clocks(x)
        save(result)
    counts = np.bincount(found.index, minlength=len(model.classes))
    label = plain(model.classes[int(counts.argmax())])
    print(
        f"{len(x)} row{'s' * (len(x) > 1)} of {len(model.features)} features ({plain(taken)}), "
        f"{len(model.classes)} classes, most often {label} ({counts.max()}); "
        f"{len(x) / found.seconds:.3g} rows/s on engine {arguments.engine}"
        f"{f' ({plain(found.by)})' if found.by else ''}; {plain(arguments.out)}"
    )
    if found.run is not None:
        print(found.run)
    if single:
        clocks = result["clocks"]
        text = ", ".join(
            f"{value:.0f} clocks {what} ({value / MHZ:.2f} us at {MHZ} MHz)"
            for value, what in ((clocks.mean(), "in the mean"), (clocks.max(), "at worst"))
        )
        print(f"one row at a time: {text}{beside(own, x)}")


def beside(own, x):
    """How long the model's own library takes for one row, as the end of a sentence."""
    if own is None:
        return ""
    name, function = own()
    taken = []
    for row in x[np.arange(SINGLES) % len(x)]:
        began = time.perf_counter()
        function(row[None])
        taken.append(time.perf_counter() - began)
    return f"; {plain(name)} on this machine: {1e6 * np.median(taken):.0f} us"
