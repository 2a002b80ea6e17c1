"""Scenes of the pressure-conductive rubber: a plate pressed on it, and pulled until it slips.

``kind``: press: load and unload; pull: under a steady normal force; grip: a pull under a normal force that
follows it. Optional keys of a condition (Condition) are off if they are not given.
"""

from dataclasses import dataclass

from meissner.check import between, fields, one_of, positive
from meissner.physics import plate, rubber
from meissner.scenes import base
from meissner.scenes.rubber import recording
from meissner.scenes.rubber.recording import COMPONENTS, WHY, Recording, simulate
from meissner.scenes.rubber.settings import Slip, codes, settings
from meissner.twins.slip.config import SlipConfig

__all__ = ["COMPONENTS", "WHY", "Condition", "Recording", "Scene", "Slip", "build", "simulate"]

FEATURES = {"slip": "its flag is judged against the truth"}
_BYTES = 400  # per sample: times, volts, forces, details, decisions, as int64 and double
_TOP = base.SAMPLED | {"slip": dict, "world": dict}
_WORLD = {
    "press": ("press_start_s", "press_s", "rest_s", "unload_s", "after_s"),
    "pull": ("press_start_s", "press_s", "stage_start_s", "slide_s"),
    "grip": ("press_start_s", "press_s", "stage_start_s", "slide_s"),
}
_PRESS = {"name": str, "normal_n": float}
_PULL = _PRESS | {"speed_mm_s": float, "material": str}
_CONDITION = {"press": _PRESS, "pull": _PULL, "grip": _PULL | {"follow": float}}
# Optional keys, (least, most). first_event is at most 0.9: above it, a slip may have no event.
_DISTURBED = {"hum_v": (0.0, 5.0), "flicker": (0.0, 0.1), "hysteresis": (0.0, 0.5)}
_SLIPPING = {"first_event": (0.0, 0.9), "recovers": (0.0, 1.0), "burst": (1.0, 50.0)}
_OPTIONAL = {"press": _DISTURBED, "pull": _DISTURBED | _SLIPPING, "grip": _DISTURBED | _SLIPPING}


@dataclass(frozen=True)
class Condition:
    """One row of a sweep. ``speed_mm_s`` and ``material`` only where a plate is pulled.

    ``follow``: newtons that the grip rises by for each newton pulled. ``first_event``: share of the friction
    limit from which Vc shows events; ``recovers``: share of the shear step that recovers (both
    physics.rubber); ``burst``: mean number of events in a burst; ``hum_v``: amplitude; ``flicker``: rms of G
    in a decade; ``hysteresis``: of the force, loading to unloading (all physics.disturbances).
    """

    name: str
    normal_n: float
    speed_mm_s: float = 0.0
    material: str | None = None
    follow: float = 0.0
    first_event: float = rubber.ONSET_RATIO
    recovers: float = rubber.RESTORED
    burst: float = 1.0
    hum_v: float = 0.0
    flicker: float = 0.0
    hysteresis: float = 0.0


@dataclass(frozen=True)
class Scene(base.Sampled):
    """A checked scene. ``world``: the times of its kind."""

    slip: Slip
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

    def peak_to_peak_v(self):
        """The threshold on max cD - min cD."""
        return 2.0 * self.slip.threshold_v

    def slip_config(self) -> SlipConfig:
        """The slip detector's settings in codes and details."""
        return codes(self.slip, self.adc, self.rate_hz)


def modelled(scene):
    """The parts of the physics that the scene has."""
    found = {part for one in scene.conditions for part in recording.modelled(scene.kind, one)}
    return [part for part in WHY if part in found]


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
    samples = sum(scene.duration_s(condition) for condition in scene.conditions) * scene.rate_hz
    return _BYTES * samples, f"{samples:.3g} samples of the shown runs"


def _condition(where, kind, row):
    needed, optional = _CONDITION[kind], _OPTIONAL[kind]
    row = fields(where, row, needed | {key: float for key in optional if key in row})
    positive(where, row, [key for key in needed if key.endswith(("_n", "_s"))])
    between(where, row, {key: limits for key, limits in optional.items() if key in row})
    if kind != "press":
        one_of(where, "material", row["material"], tuple(plate.MATERIALS))
    if kind == "grip":
        # At 1/mu, with the spread of friction, the grip would outrun the pull and nothing would slip.
        most = 0.8 / plate.MATERIALS[row["material"]].mu_s
        between(where, row, {"follow": (0.0, round(most, 3))})
    return Condition(**row)


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    top, own = base.top(name, table, _TOP)

    slip = settings(f"{where}, [slip]", top["slip"])
    world = dict(top["world"])
    kind, rows = world.pop("kind", None), world.pop("conditions", None)
    inside = f"{where}, [world]"
    one_of(inside, "kind", kind, tuple(_WORLD))
    world = fields(inside, world, dict.fromkeys(_WORLD[kind], float))
    positive(inside, world, world)
    if kind != "press" and world["stage_start_s"] < world["press_start_s"] + world["press_s"]:
        raise ValueError(f"{inside}: stage_start_s must not come before the end of pressing")
    if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
        raise ValueError(f"{inside}: there must be at least one [[world.conditions]]")
    conditions = []
    for row in rows:
        conditions.append(_condition(f"{where}, [[world.conditions]]", kind, row))

    scene = Scene(
        **own,
        slip=slip,
        kind=kind,
        world=world,
        conditions=tuple(conditions),
    )
    try:
        scene.slip_config()
    except ValueError as problem:
        raise ValueError(f"{where}, [slip]: {problem}") from None
    return scene
