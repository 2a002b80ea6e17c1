"""Scenes of the pressure-conductive rubber: a plate pressed on it, and pulled until it slips.

``kind``: press: load and unload; pull: under a steady normal force; grip: a pull under a normal force that
follows it. Optional keys of a condition are off if they are not given.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from msgspec import Meta

from meissner.builds.slip_table import SlipOfScene
from meissner.builds.units import of_scene
from meissner.physics import plate, rubber
from meissner.scenes import base
from meissner.scenes.base import Event
from meissner.scenes.rubber import recording
from meissner.scenes.rubber.recording import COMPONENTS, WHY, Recording, simulate
from meissner.tables import Positive, Table, naming, one_of, values
from meissner.twins.slip.config import SlipConfig

__all__ = ["COMPONENTS", "WHY", "Recording", "Scene", "build", "simulate"]

FEATURES = {"slip": "its flag is judged against the truth"}
_BYTES = 400  # per sample: times, volts, forces, details, decisions, as int64 and double
Burst = Annotated[float, Meta(ge=1, le=50)]


class Press(Table):
    """[[world.conditions]] of kind press, with the disturbances of every kind (physics.disturbances).

    ``hum_v``: amplitude; ``flicker``: rms of G in a decade; ``hysteresis``: of force, loading to unloading.
    """

    burst: ClassVar[float] = 1.0
    name: str
    normal_n: Positive
    hum_v: Annotated[float, Meta(ge=0, le=5)] = 0.0
    flicker: Annotated[float, Meta(ge=0, le=0.1)] = 0.0
    hysteresis: Annotated[float, Meta(ge=0, le=0.5)] = 0.0


class Pull(Press, kw_only=True):
    """Of kind pull.

    ``first_event``: share of the friction limit from which Vc shows events; ``recovers``: share of the shear
    step that recovers (both physics.rubber); ``burst``: mean number of events in a burst.
    """

    follow: ClassVar[float] = 0.0
    speed_mm_s: Positive
    material: str
    first_event: Event = rubber.ONSET_RATIO
    recovers: Annotated[float, Meta(ge=0, le=1)] = rubber.RESTORED
    burst: Burst = 1.0

    def __post_init__(self):
        one_of("material", self.material, plate.MATERIALS)


class Grip(Pull, kw_only=True):
    """Of kind grip. ``follow``: newtons that the grip rises by for each newton pulled."""

    follow: float

    def __post_init__(self):
        super().__post_init__()
        # At 1/mu, with the spread of friction, the grip would outrun the pull and nothing would slip.
        most = round(0.8 / plate.MATERIALS[self.material].mu_s, 3)
        if not 0 <= self.follow <= most:
            raise ValueError(f"follow = {self.follow:g} must lie in 0 .. {most:g}")


class PressWorld(Table, tag_field="kind", tag="press"):
    """[world] of kind press: the times of loading and unloading."""

    press_start_s: Positive
    press_s: Positive
    rest_s: Positive
    unload_s: Positive
    after_s: Positive
    conditions: Annotated[list[Press], Meta(min_length=1)]


class _Pulled(Table):
    press_start_s: Positive
    press_s: Positive
    stage_start_s: Positive
    slide_s: Positive

    def __post_init__(self):
        if self.stage_start_s < self.press_start_s + self.press_s:
            raise ValueError("stage_start_s must not come before the end of pressing")


class PullWorld(_Pulled, tag_field="kind", tag="pull"):
    conditions: Annotated[list[Pull], Meta(min_length=1)]


class GripWorld(_Pulled, tag_field="kind", tag="grip"):
    conditions: Annotated[list[Grip], Meta(min_length=1)]


class Keys(base.SampledKeys):
    slip: SlipOfScene
    world: PressWorld | PullWorld | GripWorld


@dataclass(frozen=True)
class Scene(base.Sampled):
    """A checked scene. ``world``: the times of its kind."""

    slip: SlipOfScene
    kind: str
    world: dict
    conditions: tuple

    def condition(self, which=0):
        """The condition of that name or number."""
        for number, condition in enumerate(self.conditions):
            if which in (number, condition.name, condition):
                return condition
        names = ", ".join(condition.name for condition in self.conditions)
        raise ValueError(f"scene {self.name} has no condition '{which}'; it has: {names}")

    def duration_s(self, condition):
        """Duration of the condition; the slip comes later under more load or friction."""
        world = self.world
        if self.kind == "press":
            return sum(world.values())
        # Under a following grip, friction shifts the slip by more than its own spread: allow four deviations.
        spread = 1.0 + 4.0 * plate.FRICTION_SPREAD if self.kind == "grip" else 1.0
        rise_s = plate.rise_s(
            condition.normal_n, condition.speed_mm_s, condition.material, condition.follow, spread
        )
        return world["stage_start_s"] + rise_s + world["slide_s"]

    def slip_config(self) -> SlipConfig:
        """The slip detector's settings in codes and details."""
        return self.slip.codes(of_scene(self))


def modelled(scene):
    found = {part for one in scene.conditions for part in recording.modelled(scene.kind, one)}
    return [part for part in WHY if part in found]


def memory(scene):
    samples = sum(scene.duration_s(condition) for condition in scene.conditions) * scene.rate_hz
    return _BYTES * samples, f"{samples:.3g} samples of the shown runs"


def build(name, table):
    keys, own = base.read(name, table, Keys)
    world = values(keys.world)
    conditions = tuple(world.pop("conditions"))
    scene = Scene(**own, slip=keys.slip, world=world, conditions=conditions)
    with naming(f"scene {name}, [slip]"):
        scene.slip_config()
    return scene
