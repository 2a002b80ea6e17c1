"""The first condition of a scene of the rubber, as a page plays it."""

from functools import partial

from meissner.builds.units import of_scene
from meissner.scenes.played import Slips
from meissner.scenes.rubber.recording import simulate


def _slips(scene, seed):
    codes = simulate(scene, 0, seed).codes[:, None]
    return Slips(
        rate_hz=scene.rate_hz,
        span=len(codes),
        units=of_scene(scene),
        codes=codes,
        config=scene.slip_config(),
    )


def played(scene):
    return [partial(_slips, scene)]
