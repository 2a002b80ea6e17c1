"""A scene of the four-wire mesh, as a page plays it: with its first r."""

from functools import partial

from meissner.builds.units import Units
from meissner.scenes.mesh.scene import simulate
from meissner.scenes.played import Wires


def _wires(scene, seed):
    first = simulate(scene, seed)[0]
    units = Units(newtons_per_code=first.config.load_lsb_n)
    given = {"rate_hz": scene.rate_hz, "span": len(first.codes), "units": units}
    return Wires(**given, codes=first.codes, config=first.config)


def played(scene):
    return [partial(_wires, scene)]
