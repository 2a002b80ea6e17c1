"""The scenes: which sensor, converter, core settings and physics, each in one TOML file.

``load`` checks every key and refuses a mistyped one by name; ``simulate`` builds only the physics that
the scene names and reports what it left out. The sensor determines which module reads the rest: rubber is
slip, array is cop, grip is cop_slip, every other one has its own name. Each has ``build(name, table)`` and
``simulate(scene, ...)``.
"""

import tomllib
from importlib import resources

from meissner.scenes import capacitive, cop, cop_slip, fsr, mesh, slip
from meissner.scenes.check import one_of

SENSORS = {
    **{"rubber": slip, "array": cop, "mesh": mesh, "grip": cop_slip},
    **{"capacitive": capacitive, "fsr": fsr},
}


def names(sensor=None):
    """Every scene that comes with the package, or every one of a sensor, in alphabetical order."""
    files = resources.files(__name__).iterdir()
    every = sorted(file.name.removesuffix(".toml") for file in files if file.name.endswith(".toml"))
    return [name for name in every if sensor in (None, _table(name).get("sensor"))]


def describe(name):
    """One line for the list of scenes."""
    return load(name).title


def _table(name):
    return tomllib.loads((resources.files(__name__) / f"{name}.toml").read_text("utf-8"))


def load(name):
    """The scene of that name."""
    if name not in names():
        raise ValueError(f"unknown scene '{name}'; the scenes are: {', '.join(names())}")
    return build(name, _table(name))


def build(name, table):
    """Check a scene's table and return the scene; ValueError with one sentence if it cannot be."""
    where = f"scene {name}"
    if "sensor" not in table:
        raise ValueError(f"{where}: the key 'sensor' is missing")
    one_of(where, "sensor", table["sensor"], tuple(SENSORS))
    return SENSORS[table["sensor"]].build(name, table)


def simulate(scene, *arguments, **settings):
    """Run the scene's world: condition and seed of a slip scene, the seed of any other."""
    return SENSORS[scene.sensor].simulate(scene, *arguments, **settings)
