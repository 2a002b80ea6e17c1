"""``meissner process rope``: slip of each frame of nine channels, or of any number, by a forest."""

import numpy as np

from meissner import engines, files
from meissner.engines.features import function
from meissner.forest import models
from meissner.forest.process import decide as decide_rows
from meissner.process import take
from meissner.terminal import plain


def votes(found):
    """(share of the vote for slip, slip) of what meissner.forest.process.decide found."""
    return found.votes[:, 1] / found.votes.sum(1), found.index == 1


def decide(x, model, engine, count=1, own=None):
    """({"score", "slip"} [samples] of codes ``x`` [channels, samples], 0 before the first whole window; the
    Decided of the windows)."""
    features, channels = len(model.features), len(x)
    if len(model.classes) != 2:
        raise ValueError(f"the forest decides {len(model.classes)} classes; slip needs two")
    if features % channels:
        raise ValueError(f"the forest has {features} features, no multiple of {channels} channels")
    window = features // channels
    if x.shape[1] <= window:
        raise ValueError(f"{x.shape[1]} samples do not fill a window of {window} differences")
    found = decide_rows(engine, model, function(engine, "forest_features")(x, window), count, own)
    share, slip = votes(found)
    before = lambda array: np.concatenate([np.zeros(window, array.dtype), array])
    return {"score": before(share), "slip": before(slip)}, found


def rope(arguments):
    """``meissner process rope``."""
    engines.load(arguments.engine)
    model, own = models.either(arguments.forest, trust=arguments.trust)
    read = take(arguments, samples_first=True)
    codes, done = read.flat().scaled(arguments.volts_per_code)
    x = engines.check_samples(codes)
    with files.results(arguments.out) as save:
        result, found = decide(x, model, arguments.engine, arguments.engines, own)
        save(result)
    rises = np.flatnonzero(np.diff(result["slip"].astype(int)) > 0) + 1
    first = f"first at sample {rises[0]}" if len(rises) else "none"
    print(plain(f"{read.said}; {done}"))
    print(
        f"{x.shape[1]} samples of {len(x)} channels, slip in {int(result['slip'].sum())} ({first}); "
        f"{x.size / found.seconds:.3g} samples/s on engine {arguments.engine}"
        f"{f' ({plain(found.by)})' if found.by else ''}; {plain(arguments.out)}"
    )
    if found.run is not None:
        print(found.run)
