"""What every scene has, and the check of it: names, features, and of sampled ones converter and rate."""

from dataclasses import dataclass

from meissner.check import fields, one_of, positive
from meissner.physics.adc import PARTS, Adc

TOP = {"title": str, "sensor": str, "features": list}
SAMPLED = TOP | {"adc": str, "rate_hz": int, "seeds": int}


@dataclass(frozen=True)
class Scene:
    """``features``: of the core, which decide what is built and loaded (meissner.scenes.parts)."""

    name: str
    title: str
    sensor: str
    features: tuple


@dataclass(frozen=True)
class Sampled(Scene):
    """With a converter of meissner.physics.adc, its rate, and how many seeds a condition has."""

    adc_part: str
    rate_hz: int
    seeds: int

    @property
    def adc(self) -> Adc:
        return PARTS[self.adc_part]


def top(name, table, expected, features):
    """The table of scene ``name`` by its keys, and what Scene has of it; ValueError with one sentence.

    ``expected``: {key: kind}, TOP or SAMPLED among them; ``features``: what its sensor has.
    """
    where = f"scene {name}"
    given = fields(where, table, expected)
    if "adc" in expected:
        one_of(where, "adc", given["adc"], tuple(PARTS))
    positive(where, given, [key for key in ("rate_hz", "seeds") if key in expected])
    for feature in given["features"]:
        one_of(where, "features", feature, tuple(features))
    own = {"name": name, "title": given["title"], "sensor": given["sensor"]}
    own["features"] = tuple(given["features"])
    own |= {key: given[key] for key in ("rate_hz", "seeds") if key in expected}
    if "adc" in expected:
        own["adc_part"] = given["adc"]
    return given, own
