"""The keys that every scene has, and their check: names, features; in sampled scenes converter and rate."""

from dataclasses import dataclass
from typing import Any, TypeVar

from meissner import tables
from meissner.physics.adc import PARTS, Adc
from meissner.tables import Count, Table, one_of


class Keys(Table):
    """The keys of every scene's file."""

    title: str
    sensor: str
    features: list[str]


class SampledKeys(Keys):
    """Those of a scene with a converter."""

    adc: str
    rate_hz: Count
    seeds: Count

    def __post_init__(self) -> None:
        one_of("adc", self.adc, PARTS)


K = TypeVar("K", bound=Keys)


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


def read(
    name: str, table: dict[str, Any], kind: type[K], features: dict[str, str]
) -> tuple[K, dict[str, Any]]:
    """(the file of scene ``name`` as a ``kind``, the fields of Scene in it); ValueError with one sentence.

    ``features``: those that its sensor can use.
    """
    where = f"scene {name}"
    keys = tables.read(kind, table, where)
    with tables.naming(where):
        for feature in keys.features:
            one_of("features", feature, features)
    own = {"name": name, "title": keys.title, "sensor": keys.sensor, "features": tuple(keys.features)}
    own |= {key: getattr(keys, key) for key in ("rate_hz", "seeds") if hasattr(keys, key)}
    return keys, own | ({"adc_part": keys.adc} if isinstance(keys, SampledKeys) else {})
