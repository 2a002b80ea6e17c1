"""Scenes of a hand with two slip sensors that holds a glass by the reflex: pouring, letting go, tugs."""

from dataclasses import dataclass

import numpy as np

from meissner.check import between, fields, numbers, one_of, positive, tables
from meissner.physics import plate
from meissner.physics.hand import COUNT_MM, GRIP_N_MM, MASS_S, Grasp
from meissner.physics.rubber import SUPPLY_V
from meissner.physics.slide import G_MM_S2
from meissner.physics.stepped import HEAL_S
from meissner.scenes import base
from meissner.scenes.rubber.settings import threshold_code
from meissner.twins.actuate.grip import BOOST_BITS, RULES, TOP, GripConfig
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
AT_ONCE = 50  # runs that advance together
_CYCLE_BYTES, _SAMPLE_BYTES = 1000, 64

_TOP = base.SAMPLED | {"slip": dict, "grip": dict, "world": dict}
_SLIP = dict.fromkeys(("window", "level"), int) | {"threshold_v": float, "threshold_share": float}
_GRIP = dict.fromkeys(("step_mm", "decay_mm_s", "rate_mm_s", "least_mm", "most_mm", "silent_s"), float)
_GRIP |= {"rule": str}
# Optional keys, (least, most): of the reflex, and of the host that sets step and decay.
_BOOST = {"boost": (0, 2**BOOST_BITS - 1)}
_STEPS = dict.fromkeys(("step_share", "calm_share"), (0.0, 0.1)) | {"guard_s": (0.0, 1e3)}
_STEPS |= {"calm_decay_share": (0.0, 1.0)}
_SPREADS = ("mass_spread", "friction_spread", "pour_spread")
_WORLD = dict.fromkeys((*_SPREADS, "duration_s", "hold_from_s", "mass_kg", "poured_kg"), float)
_WORLD |= dict.fromkeys(("pour_start_s", "pour_kg_s", "grain_kg"), float)
_WORLD |= {"material": str, "grip_ratio": list, "tugs": list, "conditions": list}
_CONDITION = {"name": str, "first_event": float, "cycle_ms": int}
# Optional keys of a condition, (least, most).
_OPTIONAL = {"heal_s": (0.001, 1e3), "step_mm": (0.0, 1.0), "threshold_v": (0.0, 5.0), "halves_s": (0.0, 1e4)}
_OPTIONAL |= {"dead_s": (0.0, 1e4), "decay_mm_s": (0.0, 1.0), "duration_s": (0.1, 1e4)}
_OPTIONAL |= {"count_mm": (1e-6, COUNT_MM), "down_mm": (0.0, 10.0)}
CYCLES_MS = (1, 2, 5, 10)


@dataclass(frozen=True)
class Condition:
    """``first_event``: q of the first event; ``cycle_ms``: control cycle; ``heal_s``: physics.stepped.

    ``step_mm``, ``decay_mm_s``, ``duration_s`` replace the scene's, the step without ``boost``;
    ``threshold_v``, too, and then stays constant. ``halves_s``: time at which friction halves; ``dead_s``:
    time after which both converters give their highest code. ``count_mm``: millimetres per count of the
    command. Finer counts span less: with ``down_mm`` the command's zero lies that far below the initial grip,
    and all 16 bits are its range.
    """

    name: str
    first_event: float
    cycle_ms: int
    heal_s: float = HEAL_S
    step_mm: float | None = None
    decay_mm_s: float | None = None
    threshold_v: float | None = None
    halves_s: float | None = None
    dead_s: float | None = None
    duration_s: float | None = None
    count_mm: float = COUNT_MM
    down_mm: float | None = None


@dataclass(frozen=True)
class Scene(base.Sampled):
    """A checked scene. ``grip``: [grip] in millimetres and seconds."""

    slip: dict
    grip: dict
    world: dict
    conditions: tuple

    def duration_s(self, condition):
        return self.world["duration_s"] if condition.duration_s is None else condition.duration_s

    def threshold_v(self, condition, vc_v=None):
        """The threshold on the Haar coefficient; that on peak to peak is twice as high.

        An event takes a share of the rubber's conductance, which in volts is that share of Vc (1 - Vc/5 V).
        With ``threshold_share`` above 0 the threshold follows ``vc_v`` in this way (None: threshold_v).
        """
        if condition.threshold_v is not None:
            return condition.threshold_v
        share = self.slip["threshold_share"]
        if vc_v is None or not share:
            return self.slip["threshold_v"]
        return share * vc_v * (1.0 - vc_v / SUPPLY_V)

    def threshold(self, condition, vc_v):
        """The threshold on peak to peak in codes, at least 1, that a host writes for each run's ``vc_v``."""
        level = self.slip["level"]
        return np.array(
            [max(1, threshold_code(self.threshold_v(condition, v), level, self.adc.lsb_v)) for v in vc_v]
        )

    def slip_config(self, condition) -> SlipConfig:
        """The slip detector's settings in codes and details."""
        level, window = self.slip["level"], self.slip["window"]
        codes = threshold_code(self.threshold_v(condition), level, self.adc.lsb_v)
        return SlipConfig(window=window, hop=window, level=level, threshold=codes, gross_threshold=codes)

    @property
    def steps(self):
        """The settings of scenes.hand.host; if all are 0, it writes the threshold only."""
        return {key: self.grip.get(key, 0.0) for key in _STEPS}

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
            boost=grip.get("boost", 0) if condition.step_mm is None else 0,
            decay=self.decay(condition),
            rate=round(grip["rate_mm_s"] * cycle_s / count_mm),
            minimum=round(grip["least_mm"] / count_mm) if condition.down_mm is None else 0,
            maximum=round(grip["most_mm"] / count_mm) if condition.down_mm is None else TOP,
            watchdog=max(1, round(grip["silent_s"] / cycle_s)),
            rule=grip["rule"],
        )

    def start(self, condition, closing_mm):
        """The command for the initial grip."""
        config = self.grip_config(condition)
        place_mm = closing_mm if condition.down_mm is None else condition.down_mm
        return min(max(round(place_mm / condition.count_mm), config.minimum), config.maximum)


def _world(where, table):
    world = fields(where, table, _WORLD)
    positive(where, world, ["duration_s", "mass_kg", "grain_kg", "pour_kg_s"])
    between(where, world, dict.fromkeys(_SPREADS, (0.0, 0.2)))
    between(where, world, {"poured_kg": (0.0, 10.0), "pour_start_s": (0.0, 1e4)})
    between(where, world, {"hold_from_s": (0.0, 1e4)})
    one_of(where, "material", world["material"], tuple(plate.MATERIALS))
    world["grip_ratio"] = numbers(where, "grip_ratio", world["grip_ratio"], 2, 1.0, 100.0)
    world["tugs"] = [numbers(where, "tugs", tug, 3, 0.0, 1e4) for tug in world["tugs"]]
    return world


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    top, own = base.top(name, table, _TOP)
    if top["rate_hz"] % 1000:
        raise ValueError(f"{where}: rate_hz = {top['rate_hz']} must be a multiple of 1000")
    slip = fields(f"{where}, [slip]", top["slip"], _SLIP)
    more = {key: limits for key, limits in (_BOOST | _STEPS).items() if key in top["grip"]}
    kinds = {key: type(least) for key, (least, _) in more.items()}
    grip = fields(f"{where}, [grip]", top["grip"], _GRIP | kinds)
    between(f"{where}, [slip]", slip, {"threshold_share": (0.0, 1.0)})
    between(f"{where}, [grip]", grip, {key: (0.0, 1e3) for key in grip if key != "rule"} | more)
    one_of(f"{where}, [grip]", "rule", grip["rule"], RULES)
    world = _world(f"{where}, [world]", top["world"])
    conditions, inside = [], f"{where}, [[world.conditions]]"
    for row in tables(f"{where}, [world]", "world.conditions", world.pop("conditions")):
        row = fields(inside, row, _CONDITION | {key: float for key in _OPTIONAL if key in row})
        between(inside, row, {key: limits for key, limits in _OPTIONAL.items() if key in row})
        between(inside, row, {"first_event": (0.0, 0.9)})
        one_of(inside, "cycle_ms", row["cycle_ms"], CYCLES_MS)
        conditions.append(Condition(**row))
        lasts_s = row.get("duration_s", world["duration_s"])
        if world["hold_from_s"] >= lasts_s:
            raise ValueError(f"{inside}: hold_from_s = {world['hold_from_s']:g} must be below {lasts_s:g} s")
    scene = Scene(**own, slip=slip, grip=grip, world=world, conditions=tuple(conditions))
    for condition in conditions:
        try:
            scene.slip_config(condition), scene.grip_config(condition)
        except ValueError as problem:
            raise ValueError(f"{where}: {problem}") from None
    return scene


def modelled(scene):
    """The parts of the physics that the scene has."""
    off = {"changing mass": not scene.world["poured_kg"], "tug": not scene.world["tugs"]}
    return tuple(part for part in COMPONENTS if not off.get(part))


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
    cycles = sum(1000 * scene.duration_s(one) / one.cycle_ms for one in scene.conditions)
    runs = min(AT_ONCE, scene.seeds)
    return _CYCLE_BYTES * cycles + _SAMPLE_BYTES * runs * scene.rate_hz, f"{cycles:.3g} control cycles"


def grasp(scene, condition, seed):
    """The values drawn from one seed: mass, friction of both fingers, pour, initial grip."""
    world = scene.world
    rng = np.random.default_rng([seed, scene.conditions.index(condition)])
    kind = plate.MATERIALS[world["material"]]

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
        fluctuation=kind.fluctuation,
        tugs=tuple(world["tugs"]),
        halves_s=condition.halves_s,
        rng=rng,
    )


def simulate(scene, condition=None, seed=0):
    """The grasp of one seed; in closed loop there is no recording before the engine runs."""
    return grasp(scene, scene.conditions[0] if condition is None else condition, seed)
