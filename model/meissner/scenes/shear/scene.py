"""Scenes of sheared rubber: the papers' own experiments on it, pressed, sheared by a stage and held.

``kind``: in amount, speed and recover both plates hold the rubber, which shears as far as the stage moves
and does not slip; in stick_slip a plate on the sensor is driven until it slips and beyond. A case is one
combination of the lists in [world] and its [[world.ways]].
"""

from dataclasses import dataclass
from itertools import product
from typing import Annotated

import numpy as np
from msgspec import Meta

from meissner.builds.slip_table import SlipOfScene
from meissner.builds.units import of_scene
from meissner.physics import plate, rubber
from meissner.scenes import base
from meissner.scenes.base import Event
from meissner.scenes.rubber.recording import partial_slip
from meissner.scenes.shear.published import SLOWEST_MM_S
from meissner.tables import Positive, Share, Table, naming, one_of, values

FEATURES = {
    "slip": "its false alarms are judged; in kind stick_slip also its flag",
    "shear_speed": "kind speed: its estimates are compared with the stage's speed",
}
WHY = {
    "rubber divider": "the sensor: force and shear to the voltage Vc",
    "normal force profile": "normal_n is pressed on before the shear",
    "shear step": "speed_mm_s and moved_mm: the dV that is measured",
    "deviation of repeated steps": "seeds: each repeats the shear",
    "recovery": "held_s: recovery of dV",
    "adc": "adc: Vc to codes, with its noise",
    "partial slip": "kind stick_slip: first_event",
    "plate friction": "kind stick_slip: material",
    "stick-slip": "kind stick_slip: the events to be detected",
}
COMPONENTS = tuple(WHY)
_BYTES = 400  # per sample, as in the scenes of the rubber
REST_S = 0.2  # least time between the end of pressing and the stage's start
_LISTS = ("normal_n", "speed_mm_s", "moved_mm")
_SLOPE = ("slope_s", "slope_v_s", "near_s")
_Speed = Annotated[float, Meta(ge=SLOWEST_MM_S / 10, le=100)]
_Moved = Annotated[float, Meta(ge=rubber.SHEAR_FULL_MM, le=10)]


class Sheared(Table, tag_field="kind", tag="amount"):
    """[world] of kind amount: times, and lists whose combinations are the cases."""

    press_start_s: Positive
    press_s: Positive
    shear_start_s: Positive
    held_s: Annotated[float, Meta(ge=0, le=600)]
    normal_n: Annotated[list[Annotated[float, Meta(ge=0.3, le=20)]], Meta(min_length=1)]
    speed_mm_s: Annotated[list[_Speed], Meta(min_length=1)]
    moved_mm: Annotated[list[_Moved], Meta(min_length=1)]

    def __post_init__(self):
        if self.shear_start_s < self.press_start_s + self.press_s + REST_S - 1e-9:
            raise ValueError(f"shear_start_s must come {REST_S:g} s or more after the end of pressing")


class AtSpeeds(Sheared, tag="speed"):
    """[world] of kind speed."""


class Way(Table):
    name: str
    recovers: Share
    lot: Annotated[float, Meta(ge=0.1, le=10)]
    published_v: Annotated[float, Meta(ge=0, le=5)]


class Recovering(Sheared, tag="recover"):
    ways: Annotated[list[Way], Meta(min_length=1)]


class PulledWay(Table):
    name: str
    material: str
    first_event: Event

    def __post_init__(self):
        one_of("material", self.material, plate.MATERIALS)


class Pulled(Sheared, tag="stick_slip"):
    """[world] of kind stick_slip, with the derivative of Vc as a detector."""

    ways: Annotated[list[PulledWay], Meta(min_length=1)]
    slope_s: Positive
    slope_v_s: Positive
    near_s: Positive


class Keys(base.SampledKeys):
    slip: SlipOfScene
    world: Sheared | AtSpeeds | Recovering | Pulled


@dataclass(frozen=True)
class Case:
    """One shear. ``recovers``, ``first_event``: physics.rubber; ``lot``: this rubber's k as a multiple of the
    published line's; ``published_v``: Vc some seconds after the shear; ``burst``: as in slip scenes."""

    name: str
    normal_n: float
    speed_mm_s: float
    moved_mm: float
    recovers: float = rubber.RESTORED
    lot: float = 1.0
    published_v: float | None = None
    material: str | None = None
    first_event: float = rubber.ONSET_RATIO
    burst: float = 1.0

    @property
    def rest_v(self):
        return float(rubber.rest_volts(self.normal_n))


@dataclass(frozen=True)
class Scene(base.Sampled):
    """A checked scene. ``slope``: settings of the derivative of Vc as a detector, of kind stick_slip."""

    slip: SlipOfScene
    kind: str
    world: dict
    cases: tuple
    slope: dict | None = None

    def slip_config(self):
        """The slip detector's settings in codes and details."""
        return self.slip.codes(of_scene(self))


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run of one case: the converter's codes, the stage's motion, and the ground truth.

    ``speed_mm_s``: of the stage; ``moving``: the loading stage moves. ``onset_s``: the first event of partial
    slip, ``gross_s``: the whole contact slips, both None if nothing slips; ``slips_s``: the stick-slips.
    """

    condition: Case
    time_s: np.ndarray
    volts: np.ndarray  # before the converter
    codes: np.ndarray
    over_range: np.ndarray
    normal_n: np.ndarray
    tension_n: np.ndarray
    slip_mm: np.ndarray
    speed_mm_s: np.ndarray
    moving: np.ndarray
    start_s: float
    stop_s: float
    onset_s: float | None
    gross_s: float | None
    slips_s: np.ndarray


def _cases(ways, world):
    """Every combination of ways and lists as a Case."""
    cases = []
    for way, normal_n, speed, moved in product(ways, *(world[key] for key in _LISTS)):
        prefix = f"{way['name']}, " if way["name"] else ""
        name = f"{prefix}{normal_n:g} N, {speed:g} mm/s, {moved:g} mm"
        case = Case(**{**way, "name": name}, normal_n=normal_n, speed_mm_s=speed, moved_mm=moved)
        cases.append(case)
    return tuple(cases)


def uses(scene):
    return {name: why for name, why in FEATURES.items() if name == "slip" or scene.kind == "speed"}


def modelled(scene):
    return COMPONENTS[: None if scene.kind == "stick_slip" else 6]


def memory(scene):
    world = scene.world
    shears_s = sum(case.moved_mm / case.speed_mm_s for case in scene.cases)
    samples = scene.rate_hz * (shears_s + len(scene.cases) * (world["shear_start_s"] + world["held_s"]))
    return _BYTES * samples, f"{samples:.3g} samples of the shown runs"


def check_supply(scene):
    """ValueError if a lot lifts Vc to the supply. ``build`` omits it: the rubber's curve needs SciPy."""
    for case in scene.cases:
        full_v = case.rest_v + case.lot * float(rubber.shear_step(case.rest_v, case.speed_mm_s))
        if full_v >= rubber.SUPPLY_V:
            raise ValueError(
                f"scene {scene.name}: lot = {case.lot:g} raises Vc of {case.name} to {full_v:.2f} V, "
                "the supply or more"
            )


def build(name, table):
    keys, own = base.read(name, table, Keys)
    world = values(keys.world)
    ways = [values(way) for way in world.pop("ways", [])] or [{"name": ""}]
    slope = {key: world.pop(key) for key in _SLOPE} if isinstance(keys.world, Pulled) else None
    cases = _cases(ways, world)
    scene = Scene(**own, slip=keys.slip, world=world, cases=cases, slope=slope)
    for case in scene.cases:
        if _shear_samples(scene, case) < 10:
            raise ValueError(f"scene {name}, [world]: the shear of {case.name} is shorter than 10 samples")
    with naming(f"scene {name}, [slip]"):
        scene.slip_config()
    return scene


def _shear_samples(scene, case):
    return round(case.moved_mm / case.speed_mm_s * scene.rate_hz)


def pulled(time_s, case, start_s, rate_hz, rng):
    """(Pull, PartialSlip) of the plate on the sensor, whose drive is as stiff as the rubber."""
    pull = plate.pull(
        time_s, case.normal_n, case.speed_mm_s, case.material, start_s, rng, rubber.STIFFNESS_N_MM
    )
    return pull, partial_slip(pull, case, time_s, rate_hz, rng)


def simulate(scene, case=0, seed=0):
    """Run one case (a Case or its number) with one seed: ripple, deviation of the step, slip, noise."""
    if not isinstance(case, Case):
        case = scene.cases[case]
    rng = np.random.default_rng([seed, scene.cases.index(case)])
    world, rate_hz = scene.world, scene.rate_hz
    first = round(world["shear_start_s"] * rate_hz)
    last = first + _shear_samples(scene, case)
    time_s = np.arange(last + round(world["held_s"] * rate_hz)) / rate_hz
    normal_n, moving = plate.press(time_s, case.normal_n, [(world["press_start_s"], world["press_s"])], rng)
    speed = np.zeros(len(time_s))
    speed[first:last] = case.speed_mm_s

    tension_n, slip_mm, slips_s = *np.zeros((2, len(time_s))), np.zeros(0)
    onset_s = gross_s = share = None
    if scene.kind == "stick_slip":
        pull, slip = pulled(time_s, case, first / rate_hz, rate_hz, rng)
        level, share = slip.level, slip.share
        tension_n, slip_mm, slips_s = pull.tension_n, pull.slip_mm, pull.slips_s
        onset_s, gross_s = float(slip.events_s[0]), float(pull.gross_s)
    else:
        spread = 1.0 + rubber.SHEAR_SPREAD * rng.standard_normal()
        level = case.lot * spread * rubber.shear_level(time_s, speed, case.recovers)
    volts = rubber.volts(normal_n, level, share)
    converted, over_range = scene.adc.convert(scene.front().next(volts), rng)
    return Recording(
        scene=scene,
        condition=case,
        seed=seed,
        time_s=time_s,
        volts=volts,
        codes=converted,
        over_range=over_range,
        normal_n=normal_n,
        tension_n=tension_n,
        slip_mm=slip_mm,
        speed_mm_s=speed,
        moving=moving,
        start_s=first / rate_hz,
        stop_s=last / rate_hz,
        onset_s=onset_s,
        gross_s=gross_s,
        slips_s=slips_s,
        modelled=modelled(scene),
    )
