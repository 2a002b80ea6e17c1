"""The modules of a sensor's folder, and the list of sensors: every package here is one."""

import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol


class Sensor(Protocol):
    """The module ``scene``: its scenes, what they need and why, and their physics."""

    FEATURES: dict[str, str]  # {feature of the core: why a scene uses it}
    WHY: dict[str, str]  # {part of the physics: why a scene needs it}
    COMPONENTS: tuple[str, ...]  # those of WHY that a scene models or leaves out

    def build(self, name: str, table: dict) -> Any:
        """The scene in a TOML file's table; it has ``name``, ``title``, ``sensor``."""

    def uses(self, scene) -> dict[str, str]:
        """Those of FEATURES that the scene uses; without this function it uses all."""

    def modelled(self, scene) -> tuple[str, ...]:
        """Those of WHY that any of its conditions has."""

    def memory(self, scene) -> tuple[float, str]:
        """(bytes of its largest arrays, what they contain)."""

    def simulate(self, scene, *arguments, **settings) -> Any:
        """A recording; it has ``modelled`` and ``left_out``."""


class Runner(Protocol):
    """The module ``run``: runs a scene on an engine."""

    TABLES: dict[str, str]  # {heading of a table of the report: key of its rows in the summary}
    WAVES: bool  # engine rtl can record waves

    def run(self, scene, engine: str, seed: int, waves: Path | None, spread) -> Any:
        """The Result (meissner.scenes.results); ``waves``: the file to record; ``spread``:
        pool.Spread, over which it spreads its conditions and seeds."""

    def tell(self, summary: dict) -> list[str]:
        """The lines that the command prints for a summary."""

    def answer(self, summary: dict) -> str:
        """The sentence that a report begins with."""


@cache
def sensors():
    """The sensors' names, in alphabetical order."""
    here = [str(Path(__file__).parent)]
    return tuple(sorted(found.name for found in pkgutil.iter_modules(here) if found.ispkg))


def sensor(name) -> Sensor:
    """The module of a sensor's scenes."""
    return import_module(f"meissner.scenes.{name}.scene")


def used(scene):
    """{feature of the core that the scene uses: why}."""
    own = sensor(scene.sensor)
    return own.uses(scene) if hasattr(own, "uses") else own.FEATURES


def runner(name) -> Runner:
    """The module that runs a sensor's scenes."""
    return import_module(f"meissner.scenes.{name}.run")
