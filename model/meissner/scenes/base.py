"""The keys that every scene has, and their check: names, features; in sampled scenes converter and rate."""

from dataclasses import dataclass

from meissner.check import fields, one_of, positive
from meissner.physics.adc import PARTS, Adc

TOP = {"title": str, "sensor": str, "features": list}
SAMPLED = TOP | {"adc": str, "rate_hz": int, "seeds": int}


@dataclass(frozen=True)
class Scene:
    """``features``: features of the core, which decide what is built and loaded (meissner.scenes.parts)."""

    name: str
    title: str
    sensor: str
    features: tuple


@dataclass(frozen=True)
class Sampled(Scene):
    """A scene with a converter of meissner.physics.adc, its rate, and the number of seeds per condition."""

    adc_part: str
    rate_hz: int
    seeds: int

    @property
    def adc(self) -> Adc:
        return PARTS[self.adc_part]


def top(name, table, expected, features):
    """(the checked table of scene ``name``, the fields of Scene in it); ValueError with one sentence.

    ``expected``: {key: kind}, including TOP or SAMPLED; ``features``: those that its sensor can use.
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
