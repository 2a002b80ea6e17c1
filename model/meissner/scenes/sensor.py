"""The modules of a sensor's folder, and the list of sensors: every package here is one."""

import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol


class Sensor(Protocol):
    """The module ``scene``: its scenes and their physics."""

    COMPONENTS: tuple | dict  # parts of the physics; a scene models each or leaves it out

    def build(self, name: str, table: dict) -> Any:
        """The scene in a TOML file's table; it has ``name``, ``title``, ``sensor``."""

    def simulate(self, scene, *arguments, **settings) -> Any:
        """A recording; it has ``modelled`` and ``left_out``."""


class Parts(Protocol):
    """The module ``parts``: what a scene needs and why; it imports no module that computes."""

    FEATURES: dict  # {feature of the core: why a scene needs it}
    WHY: dict  # {part of the physics: why}

    def uses(self, scene) -> dict:
        """Those of FEATURES that the scene uses."""

    def modelled(self, scene) -> list[str]:
        """Those of WHY that any of its conditions has."""

    def memory(self, scene) -> tuple[float, str]:
        """(bytes of its largest arrays, what they contain)."""


class Runner(Protocol):
    """The module ``run``: runs a scene on an engine and writes a folder of results."""

    def check(self, scene, engine: str, waves: bool) -> None:
        """ValueError with one sentence if this engine cannot run the scene."""

    def run(self, scene, engine: str, out: Path, seed: int, waves: bool, progress) -> dict:
        """Write the results (meissner.scenes.results.finish) and return the summary."""

    def tell(self, summary: dict) -> list[str]:
        """The lines that the command prints for a summary."""


@cache
def sensors():
    """The sensors' names, in alphabetical order."""
    here = [str(Path(__file__).parent)]
    return tuple(sorted(found.name for found in pkgutil.iter_modules(here) if found.ispkg))


def sensor(name) -> Sensor:
    """The module of a sensor's scenes."""
    return import_module(f"meissner.scenes.{name}.scene")


def answer(name, summary):
    """The sentence of the sensor's module ``verdict`` about a summary."""
    return import_module(f"meissner.scenes.{name}.verdict").answer(summary)


def runner(name) -> Runner:
    """The module that runs a sensor's scenes."""
    return import_module(f"meissner.scenes.{name}.run")
