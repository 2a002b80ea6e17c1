"""A scene of an array, as a page plays it."""

from functools import partial

from meissner.builds.units import Units
from meissner.scenes.array.scene import simulate
from meissner.scenes.played import Frames


def _frames(scene, seed):
    units = Units(newtons_per_code=scene.load_lsb if scene.unit == "N" else None)
    codes = simulate(scene, seed).codes
    given = {"rate_hz": scene.rate_hz, "span": len(codes), "units": units}
    return Frames(**given, forces=codes, min_load=scene.min_load)


def played(scene):
    return [partial(_frames, scene)]
