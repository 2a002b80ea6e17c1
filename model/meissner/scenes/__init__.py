"""The scenes: each one TOML file with its sensor, converter, core settings and physics.

Each folder here is a sensor (meissner.scenes.sensor describes its content) with its scenes beside the code;
no list of them exists. ``load`` checks every key and refuses a mistyped one by name; ``simulate`` builds only
the physics that the scene names and lists what it left out.
"""

import tomllib
from functools import cache
from importlib import resources
from pathlib import Path

from meissner.scenes.features import check_line
from meissner.scenes.sensor import sensor, sensors
from meissner.tables import naming, one_of, parse


@cache
def _files():
    """{name: file} of every scene that comes with the package."""
    folders = (resources.files(__name__) / sensor for sensor in sensors())
    files = (file for folder in folders for file in folder.iterdir() if file.name.endswith(".toml"))
    return dict(sorted((file.name.removesuffix(".toml"), file) for file in files))


def names(of=None):
    """Every scene that comes with the package, or every one of a sensor, in alphabetical order."""
    return [name for name, file in _files().items() if of in (None, file.parent.name)]


def describe(name):
    """One line for the list of scenes."""
    return load(name).title


def source(name):
    """The TOML text of the scene of that name."""
    if name not in _files():
        raise ValueError(f"unknown scene '{name}'; name a .toml file, or one of: {', '.join(names())}")
    return _files()[name].read_text("utf-8")


def load(name):
    """The scene of that name, or of a TOML file's path."""
    path = Path(name)
    if name in _files() or path.suffix != ".toml":
        return build(name, tomllib.loads(source(name)))
    return build(path.stem, parse(path, "a scene"))


def build(name, table):
    """Check a scene's table and return the scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    if "sensor" not in table:
        raise ValueError(f"{where}: the key 'sensor' is missing")
    with naming(where):
        one_of("sensor", table["sensor"], sensors())
    own = {key: value for key, value in table.items() if key != "features"}
    scene = sensor(table["sensor"]).build(name, own)
    if "features" in table:
        check_line(scene, table["features"])
    return scene


def simulate(scene, *arguments, **settings):
    """Run the scene's world; arguments: condition and seed for a slip scene, only the seed for any other."""
    return sensor(scene.sensor).simulate(scene, *arguments, **settings)
