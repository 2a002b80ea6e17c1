"""Scenes of a hand with two slip sensors that holds a glass by the reflex: pouring, letting go, tugs."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from msgspec import Meta

from meissner.builds.units import Units
from meissner.physics import plate
from meissner.physics.hand import COUNT_MM, GRIP_N_MM, MASS_S, Grasp
from meissner.physics.rubber import SUPPLY_V
from meissner.physics.slide import G_MM_S2
from meissner.physics.stepped import HEAL_S
from meissner.scenes import base
from meissner.scenes.base import Event
from meissner.tables import Positive, Share, Table, naming, one_of, values
from meissner.twins.actuate.grip import BOOST_BITS, TOP, GripConfig
from meissner.twins.slip.config import SlipConfig

FEATURES = {
    "slip": "the reflex reads its windows; [slip] configures it",
    "grip": "it closes the loop; [grip] configures it",
}
WHY = {
    "rubber divider": "the sensor of each finger",
    "shear step": "the object's weight shears the rubber",
    "partial slip that begins again": "first_event and heal_s: events that the reflex answers",
    "friction of two contacts": "material and friction_spread",
    "slide with inertia": "whether and how far the object falls",
    "position servo with ripple": "the hand that carries out the command",
    "grip's compliance": "closing to force",
    "changing mass": "poured_kg",
    "tug": "tugs",
    "adc": "adc: Vc to codes, with its noise",
}
COMPONENTS = tuple(WHY)
AT_ONCE = 50  # runs that advance together, cycle by cycle
ALONE_MS = 2  # up to this control cycle a run advances alone: many cycles then pass between two slips
_CYCLE_BYTES, _SAMPLE_BYTES = 1000, 64

_STEPS = ("step_share", "calm_share", "guard_s", "calm_decay_share", "gross_share", "floor_decay_share")
CYCLES_MS = (1, 2, 5, 10)
_Spread = Annotated[float, Meta(ge=0, le=0.2)]
_Seconds = Annotated[float, Meta(ge=0, le=1e4)]
_Range = Annotated[float, Meta(ge=0, le=1e3)]
_Step = Annotated[float, Meta(ge=0, le=0.1)]
_Volts = Annotated[float, Meta(ge=0, le=5)]
_Millimetre = Annotated[float, Meta(ge=0, le=1)]


class SlipKeys(Table):
    """[slip]: of the slip path, what the reflex and its host need (scenes.hand.host).

    The threshold is ``threshold_quiet`` times what the quiet sensor shows, or with ``threshold_p2p_share``
    that share of Vc (1 - Vc/5 V), or without either ``threshold_p2p_v``; all peak to peak.
    """

    RENAMED: ClassVar = {"threshold_v": ("threshold_p2p_v", 2), "threshold_share": ("threshold_p2p_share", 2)}
    window: int
    level: Literal[1, 2, 3]
    threshold_p2p_v: _Volts
    gross_threshold_p2p_v: _Volts
    threshold_quiet: Annotated[float, Meta(ge=0, le=100)] = 0.0
    threshold_p2p_share: Share = 0.0


class GripKeys(Table):
    """[grip]: of the reflex, and of the host that sets step and decay, each off where it is left out."""

    RENAMED: ClassVar = {"silent_s": ("silent_ms", 1000)}
    step_mm: _Range
    decay_mm_s: _Range
    rate_mm_s: _Range
    least_mm: _Range
    most_mm: _Range
    silent_ms: Annotated[float, Meta(ge=0, le=1e6)]
    rule: Literal["any", "weakest"]
    boost: Annotated[int, Meta(ge=0, le=2**BOOST_BITS - 1)] = 0
    step_share: _Step = 0.0
    calm_share: _Step = 0.0
    guard_s: _Range = 0.0
    calm_decay_share: Share = 0.0
    gross_share: Share = 0.0
    floor_decay_share: Share = 0.0


class Condition(Table):
    """[[world.conditions]].

    ``first_event``: q of the first event; ``cycle_ms``: control cycle; ``heal_s``: physics.stepped.
    ``material`` replaces the scene's, ``events`` multiplies the size of its events.
    ``step_mm``, ``decay_mm_s``, ``duration_s`` replace the scene's, the step without ``boost``;
    ``threshold_p2p_v``, too, and then stays constant. ``halves_s``: time at which friction halves;
    ``dead_s``: time after which both converters give code 0. ``count_mm``: millimetres per count
    of the command. Finer counts span less: with ``down_mm`` the command's zero lies that far below the grip,
    and all 16 bits are its range.
    """

    RENAMED: ClassVar = {"threshold_v": ("threshold_p2p_v", 2)}
    name: str
    first_event: Event
    cycle_ms: Literal[CYCLES_MS]
    heal_s: Annotated[float, Meta(ge=0.001, le=1e3)] = HEAL_S
    step_mm: _Millimetre | None = None
    threshold_p2p_v: _Volts | None = None
    halves_s: _Seconds | None = None
    dead_s: _Seconds | None = None
    decay_mm_s: _Millimetre | None = None
    duration_s: Annotated[float, Meta(ge=0.1, le=1e4)] | None = None
    count_mm: Annotated[float, Meta(ge=1e-6, le=COUNT_MM)] = COUNT_MM
    down_mm: Annotated[float, Meta(ge=0, le=10)] | None = None
    material: str | None = None
    events: Annotated[float, Meta(gt=0, le=10)] = 1.0

    def __post_init__(self):
        one_of("material", self.material or next(iter(plate.MATERIALS)), plate.MATERIALS)


class World(Table):
    mass_spread: _Spread
    friction_spread: _Spread
    pour_spread: _Spread
    duration_s: Positive
    hold_from_s: _Seconds
    mass_kg: Positive
    poured_kg: Annotated[float, Meta(ge=0, le=10)]
    pour_start_s: _Seconds
    pour_kg_s: Positive
    grain_kg: Positive
    material: str
    grip_ratio: tuple[Annotated[float, Meta(ge=1, le=100)], Annotated[float, Meta(ge=1, le=100)]]
    tugs: list[tuple[_Seconds, _Seconds, _Seconds]]
    conditions: Annotated[list[Condition], Meta(min_length=1)]

    def __post_init__(self):
        one_of("material", self.material, plate.MATERIALS)
        for row in self.conditions:
            lasts_s = row.duration_s or self.duration_s
            if self.hold_from_s >= lasts_s:
                raise ValueError(f"hold_from_s = {self.hold_from_s:g} must be below {lasts_s:g} s")


class Keys(base.SampledKeys):
    slip: SlipKeys
    grip: GripKeys
    world: World

    def __post_init__(self):
        super().__post_init__()
        if self.rate_hz % 1000:
            raise ValueError(f"rate_hz = {self.rate_hz} must be a multiple of 1000")


@dataclass(frozen=True)
class Scene(base.Sampled):
    """A checked scene. ``grip``: [grip] in millimetres and seconds."""

    slip: dict
    grip: dict
    world: dict
    conditions: tuple

    def duration_s(self, condition):
        return self.world["duration_s"] if condition.duration_s is None else condition.duration_s

    def threshold_p2p_v(self, condition, vc_v=None, quiet_v=None):
        """The threshold on the Haar coefficient's peak to peak; without ``vc_v`` that before the host's.

        An event takes a share of the rubber's conductance, which in volts is that share of Vc (1 - Vc/5 V).
        With ``threshold_p2p_share`` above 0 the threshold follows ``vc_v`` in this way.
        """
        if condition.threshold_p2p_v is not None:
            return condition.threshold_p2p_v
        share, quiet = self.slip["threshold_p2p_share"], self.slip["threshold_quiet"]
        if share and vc_v is not None:
            return share * vc_v * (1.0 - vc_v / SUPPLY_V)
        if quiet and quiet_v is not None:
            return quiet * quiet_v
        return self.slip["threshold_p2p_v"]

    def _code(self, volts):
        codes = self.adc.min_code, self.adc.max_code
        return Units(volts_per_code=self.adc.lsb_v, level=self.slip["level"], codes=codes).detail_code(volts)

    def threshold(self, condition, vc_v, quiet_v):
        """The threshold on peak to peak in codes, at least 1, that a host writes; both [runs]."""
        both = zip(vc_v, quiet_v)
        return np.array([max(1, self._code(self.threshold_p2p_v(condition, *one))) for one in both])

    def slip_config(self, condition) -> SlipConfig:
        """The slip detector's settings in codes and details."""
        level, window = self.slip["level"], self.slip["window"]
        code = self._code(self.threshold_p2p_v(condition))
        gross = max(code, self._code(self.slip["gross_threshold_p2p_v"]))
        return SlipConfig(window=window, hop=window, level=level, threshold=code, gross_threshold=gross)

    @property
    def steps(self):
        """The settings of scenes.hand.host; if all are 0, it writes the threshold only."""
        return {key: self.grip[key] for key in _STEPS}

    def decay(self, condition):
        """The decay of the condition, or else of the scene, in counts per cycle."""
        mm_s = self.grip["decay_mm_s"] if condition.decay_mm_s is None else condition.decay_mm_s
        least = condition.count_mm / (condition.cycle_ms / 1e3)
        if mm_s > 0 and not round(mm_s / least):
            raise ValueError(f"decay_mm_s = {mm_s:g} rounds to 0 counts per cycle; one is {least:g} mm/s")
        return round(mm_s / least)

    def grip_config(self, condition) -> GripConfig:
        """[grip] in counts and cycles."""
        cycle_s, grip, count_mm = condition.cycle_ms / 1e3, self.grip, condition.count_mm
        step_mm = grip["step_mm"] if condition.step_mm is None else condition.step_mm
        return GripConfig(
            step=round(step_mm / count_mm),
            boost=grip["boost"] if condition.step_mm is None else 0,
            decay=self.decay(condition),
            rate=round(grip["rate_mm_s"] * cycle_s / count_mm),
            minimum=round(grip["least_mm"] / count_mm) if condition.down_mm is None else 0,
            maximum=round(grip["most_mm"] / count_mm) if condition.down_mm is None else TOP,
            watchdog=max(1, round(grip["silent_ms"] / condition.cycle_ms)),
            rule=grip["rule"],
        )

    def start(self, condition, closing_mm):
        """The command for the initial grip."""
        config = self.grip_config(condition)
        place_mm = closing_mm if condition.down_mm is None else condition.down_mm
        return min(max(round(place_mm / condition.count_mm), config.minimum), config.maximum)


def build(name, table):
    keys, own = base.read(name, table, Keys)
    world = values(keys.world)
    conditions = tuple(world.pop("conditions"))
    scene = Scene(**own, slip=values(keys.slip), grip=values(keys.grip), world=world, conditions=conditions)
    for condition in conditions:
        with naming(f"scene {name}, [slip] or [[world.conditions]]: threshold_p2p_v"):
            scene.slip_config(condition)
        with naming(f"scene {name}"):
            scene.grip_config(condition)
    return scene


def batches(condition, seeds):
    """The ranges of ``seeds`` that a process advances together."""
    count = 1 if condition.cycle_ms <= ALONE_MS else AT_ONCE
    return [seeds[at : at + count] for at in range(0, len(seeds), count)]


def modelled(scene):
    off = {"changing mass": not scene.world["poured_kg"], "tug": not scene.world["tugs"]}
    return tuple(part for part in COMPONENTS if not off.get(part))


def memory(scene):
    cycles = sum(1000 * scene.duration_s(one) / one.cycle_ms for one in scene.conditions)
    runs = min(AT_ONCE, scene.seeds)
    return _CYCLE_BYTES * cycles + _SAMPLE_BYTES * runs * scene.rate_hz, f"{cycles:.3g} control cycles"


def grasp(scene, condition, seed):
    """The values drawn from one seed: mass, friction of both fingers, pour, initial grip."""
    world = scene.world
    rng = np.random.default_rng([seed, scene.conditions.index(condition)])
    kind = plate.MATERIALS[condition.material or world["material"]]

    def spread(key, count=None):
        return np.maximum(1.0 + world[key] * rng.standard_normal(count), 0.1)

    mass_kg = world["mass_kg"] * spread("mass_spread")
    friction = spread("friction_spread") * (1.0 + plate.FRICTION_SPREAD * rng.standard_normal(2))
    pour_kg_s = world["pour_kg_s"] * spread("pour_spread")
    pieces = round(scene.duration_s(condition) / MASS_S)
    pours = np.arange(pieces) * MASS_S >= world["pour_start_s"]
    grains = rng.poisson(pour_kg_s * MASS_S / world["grain_kg"], pieces) * pours * world["grain_kg"]
    poured = np.minimum(np.concatenate([[0.0], np.cumsum(grains)]), world["poured_kg"])
    ratio = rng.uniform(*world["grip_ratio"])
    mu_s = kind.mu_s * friction
    closing_mm = ratio * mass_kg * G_MM_S2 / 1e3 / mu_s.sum() / GRIP_N_MM
    return Grasp(
        mass_kg=mass_kg + poured,
        mu_s=tuple(mu_s),
        mu_k=tuple(kind.mu_k * friction),
        closing_mm=round(closing_mm / COUNT_MM) * COUNT_MM,
        first_event=condition.first_event,
        heal_s=condition.heal_s,
        fluctuation=condition.events * kind.fluctuation,
        tugs=tuple(world["tugs"]),
        halves_s=condition.halves_s,
        rng=rng,
    )


def simulate(scene, condition=None, seed=0):
    """The grasp of one seed; in closed loop there is no recording before the engine runs."""
    return grasp(scene, scene.conditions[0] if condition is None else condition, seed)
