"""What every sensor's scenes and recordings share: keys, their check, and what a recording models."""

from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from msgspec import Meta

from meissner import tables
from meissner.physics.adc import PARTS, Adc
from meissner.physics.front import Stream
from meissner.scenes.sensor import sensor, used
from meissner.tables import Count, Table, one_of

Event = Annotated[float, Meta(ge=0, le=0.9)]  # above 0.9, a slip of the rubber may have no event


class Keys(Table):
    """The keys of every scene's file."""

    title: str
    sensor: str


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

    def front(self) -> Stream:
        """What stands in front of the converter, for the voltages of a recording from its first sample on."""
        return Stream(self.adc_part, self.adc.high_v, self.rate_hz)


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


def read(name: str, table: dict[str, Any], kind: type[K]) -> tuple[K, dict[str, Any]]:
    """(the file of scene ``name`` as a ``kind``, the fields of Scene in it); ValueError with one sentence."""
    keys = tables.read(kind, table, f"scene {name}")
    own = {key: getattr(keys, key) for key in ("title", "sensor", "rate_hz", "seeds") if hasattr(keys, key)}
    kind = keys.world.__struct_config__.tag
    own |= {"kind": kind} if kind else {}
    return keys, {"name": name, **own} | ({"adc_part": keys.adc} if isinstance(keys, SampledKeys) else {})
