"""The first condition of a scene of an object held on the four-wire sensor, as a page plays it."""

from functools import partial

from meissner.builds.units import Units
from meissner.scenes.grip.scene import simulate
from meissner.scenes.played import Wires


def wires(scene, seed, cop=True):
    codes = simulate(scene, scene.conditions[0], seed).codes
    return Wires(
        rate_hz=scene.rate_hz,
        span=len(codes),
        units=Units(newtons_per_code=scene.config.load_lsb_n) if cop else Units(),
        codes=codes,
        config=scene.config,
        registers=scene.registers,
        lag=scene.lag,
        cop=cop,
    )


def played(scene):
    return [partial(wires, scene)]
