"""What every sensor's scenes and recordings share: keys, their check, and what a recording models."""

from dataclasses import dataclass
from typing import Any

from meissner.check import fields, one_of, positive
from meissner.physics.adc import PARTS, Adc
from meissner.scenes.sensor import sensor, used

TOP = {"title": str, "sensor": str}
SAMPLED = TOP | {"adc": str, "rate_hz": int, "seeds": int}


@dataclass(frozen=True)
class Scene:
    """What every scene has."""

    name: str
    title: str
    sensor: str

    @property
    def features(self) -> tuple[str, ...]:
        """The features of the core that the scene uses: only these are built and loaded."""
        return tuple(used(self))


@dataclass(frozen=True)
class Sampled(Scene):
    """A scene with a converter of meissner.physics.adc, its rate, and the number of seeds per condition."""

    adc_part: str
    rate_hz: int
    seeds: int

    @property
    def adc(self) -> Adc:
        return PARTS[self.adc_part]


@dataclass(frozen=True, kw_only=True)
class Recording:
    """What every recording has; ``modelled``: the parts of the physics in it."""

    scene: Any
    seed: int
    modelled: tuple[str, ...]

    @property
    def left_out(self) -> tuple[str, ...]:
        """The sensor's other COMPONENTS."""
        return left_out(self.scene, self.modelled)


def left_out(scene, modelled):
    """The COMPONENTS of the scene's sensor that are not among ``modelled``."""
    return tuple(part for part in sensor(scene.sensor).COMPONENTS if part not in modelled)


def top(name, table, expected):
    """(the checked table of scene ``name``, the fields of Scene in it); ValueError with one sentence.

    ``expected``: {key: kind}, including TOP or SAMPLED.
    """
    where = f"scene {name}"
    given = fields(where, table, expected)
    positive(where, given, [key for key in ("rate_hz", "seeds") if key in expected])
    own = {
        "name": name,
        **{key: given[key] for key in ("title", "sensor", "rate_hz", "seeds") if key in given},
    }
    if "adc" in expected:
        one_of(where, "adc", given["adc"], tuple(PARTS))
        own["adc_part"] = given["adc"]
    return given, own
