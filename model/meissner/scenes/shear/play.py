"""A case of a scene of sheared rubber, as a page plays it: the one of middle length."""

from functools import partial

from meissner.builds.units import of_scene
from meissner.scenes.played import Slips
from meissner.scenes.shear.scene import simulate


def _slips(scene, seed):
    cases = sorted(scene.cases, key=lambda case: case.moved_mm / case.speed_mm_s)
    recording, shear = simulate(scene, cases[len(cases) // 2], seed), None
    if "shear_speed" in scene.features:
        from meissner.scenes.shear.estimate import Estimator  # here: other kinds need no estimator

        shear = Estimator(scene, None).config
    return Slips(
        rate_hz=scene.rate_hz,
        span=len(recording.codes),
        units=of_scene(scene),
        codes=recording.codes[:, None],
        config=scene.slip_config(),
        shear=shear,
        moving=recording.moving,
    )


def played(scene):
    return [partial(_slips, scene)]
