"""Scenes of sheared rubber: the papers' own experiments on it, pressed, sheared by a stage and held.

``kind``: in amount, speed and recover both plates hold the rubber, which shears as far as the stage moves
and does not slip; in stick_slip a plate on the sensor is driven until it slips and beyond. A case is one
combination of the lists in [world] and its [[world.ways]].
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from meissner.check import between, fields, numbers, one_of, positive, tables
from meissner.physics import plate, rubber
from meissner.scenes import base
from meissner.scenes.rubber.recording import partial_slip
from meissner.scenes.rubber.settings import Slip, codes, settings
from meissner.scenes.shear.published import SLOWEST_MM_S

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
KINDS = ("amount", "speed", "recover", "stick_slip")
_TOP = base.SAMPLED | {"slip": dict, "world": dict}
_TIMES = ("press_start_s", "press_s", "shear_start_s", "held_s")
_LISTS = ("normal_n", "speed_mm_s", "moved_mm")
_WAY = {"name": str, "recovers": float, "lot": float, "published_v": float}
_PULLED_WAY = {"name": str, "material": str, "first_event": float}
_SLOPE = {"slope_s": float, "slope_v_s": float, "near_s": float}
REST_S = 0.2  # least time between the end of pressing and the stage's start


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

    slip: Slip
    kind: str
    world: dict
    cases: tuple
    slope: dict | None = None

    def slip_config(self):
        """The slip detector's settings in codes and details."""
        return codes(self.slip, self.adc, self.rate_hz)


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


def _ways(where, kind, world):
    """The checked rows of [[world.ways]]; a single nameless one for a kind that has none."""
    if kind not in ("recover", "stick_slip"):
        return ({"name": ""},)
    rows, at, keys = (
        tables(where, "world.ways", world.pop("ways", None)),
        f"{where}, [[world.ways]]",
        _PULLED_WAY if kind == "stick_slip" else _WAY,
    )
    ways = []
    for row in rows:
        row = fields(at, row, keys)
        if kind == "stick_slip":
            one_of(at, "material", row["material"], tuple(plate.MATERIALS))
            between(at, row, {"first_event": (0.0, 0.9)})
        else:
            between(at, row, {"recovers": (0.0, 1.0), "lot": (0.1, 10.0), "published_v": (0.0, 5.0)})
        ways.append(row)
    return tuple(ways)


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
    """The features that the scene uses, each with the reason."""
    return {name: why for name, why in FEATURES.items() if name == "slip" or scene.kind == "speed"}


def modelled(scene):
    """The parts of the physics that the scene has."""
    return COMPONENTS[: None if scene.kind == "stick_slip" else 6]


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
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
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    top, own = base.top(name, table, _TOP)
    slip = settings(f"{where}, [slip]", top["slip"])

    inside, world = f"{where}, [world]", dict(top["world"])
    kind = world.pop("kind", None)
    one_of(inside, "kind", kind, KINDS)
    ways = _ways(inside, kind, world)
    pulled = kind == "stick_slip"
    keys = dict.fromkeys(_TIMES, float) | dict.fromkeys(_LISTS, list) | (_SLOPE if pulled else {})
    world = fields(inside, world, keys)
    positive(inside, world, [key for key in world if key not in _LISTS and key != "held_s"])
    between(inside, world, {"held_s": (0.0, 600.0)})
    limits = {
        "normal_n": (0.3, 20.0),
        "speed_mm_s": (SLOWEST_MM_S / 10, 100.0),
        "moved_mm": (rubber.SHEAR_FULL_MM, 10.0),
    }
    for key, (least, most) in limits.items():
        world[key] = numbers(inside, key, world[key], least=least, most=most)
    if world["shear_start_s"] < world["press_start_s"] + world["press_s"] + REST_S - 1e-9:
        raise ValueError(f"{inside}: shear_start_s must come {REST_S:g} s or more after the end of pressing")
    scene = Scene(
        **own,
        slip=slip,
        kind=kind,
        world=world,
        cases=_cases(ways, world),
        slope={key: world.pop(key) for key in _SLOPE} if pulled else None,
    )
    for case in scene.cases:
        if _shear_samples(scene, case) < 10:
            raise ValueError(f"{inside}: the shear of {case.name} is shorter than 10 samples")
    try:
        scene.slip_config()
    except ValueError as problem:
        raise ValueError(f"{where}, [slip]: {problem}") from None
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
    converted, over_range = scene.adc.convert(volts, rng)
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
