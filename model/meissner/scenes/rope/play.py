"""The first condition of a scene of a rope, as a page plays it. Of kind pull with a small forest, trained
on some of the pulls that the scene's own is trained on."""

from functools import partial

import numpy as np

from meissner.forest import process, sklearn
from meissner.rope import train
from meissner.scenes.fsr.play import calibrated
from meissner.scenes.played import Classes, Frames
from meissner.scenes.rope.scene import TRAINING_SEED, pressed, record, simulate
from meissner.twins.forest.forest_features import ForestFeatures

TREES, EVERY = 40, 8  # of its trees; of its pulls


def _frames(scene, seed):
    codes = simulate(scene, 0, seed).codes
    if scene.kind == "cop":
        return calibrated(codes, pressed(scene, seed), scene.rate_hz, scene.min_load_n)
    return Frames(rate_hz=scene.rate_hz, span=len(codes), forces=codes)


def _classes(scene, seed):
    pulls, w = train.pulls(scene.pulls[0])[::EVERY], scene.pattern.w
    recordings = record(scene, pulls, [[seed, TRAINING_SEED, k] for k in range(len(pulls))], seed)
    (x, y), _ = train.Data(recordings, seed).split(scene.pattern)
    model = sklearn.of_model(train.fit(x, y, seed, min(TREES, scene.world["trees"])), True)
    rows = ForestFeatures(9, w).next(simulate(scene, 0, seed).channels)
    found = process.decide("fixed", model, rows)
    votes = found.votes[np.arange(len(rows)), found.index]
    before = np.full(w, -1)
    labels, votes = (np.concatenate([before, part]) for part in (found.index, votes))
    return Classes(rate_hz=scene.rate_hz, span=len(labels), labels=labels, votes=votes)


def played(scene):
    return [partial(part, scene) for part in ((_frames, _classes) if scene.kind == "pull" else (_frames,))]
