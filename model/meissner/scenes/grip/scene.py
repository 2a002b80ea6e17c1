"""Scenes of an object held on the four-wire sensor: pulled until it slips, or gripped harder and softer."""

import dataclasses
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from msgspec import Meta
from msgspec.structs import replace

from meissner.builds import config as builds
from meissner.physics import grip, mesh_loads, plate
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.front import Stream
from meissner.physics.mesh import Solution
from meissner.scenes import base
from meissner.scenes.mesh.scene import electrodes
from meissner.tables import Count, Positive, Table, naming, one_of, values
from meissner.twins.cop.cop_slip import CopSlipRegisters

FEATURES = {
    "cop4": "slip is detected in the electrodes' position and load",
    "cop_slip": "its flag and direction are judged; the build's [cop_slip] configures it",
}
WHY = {
    "resistor mesh": "the build's [mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "the build's [adc] and amplifiers: voltages to codes, with the part's noise",
    "grip": "grip_n: force that holds the object",
    "pull": "[[world.pulls]]",
    "plate friction": "material of a pull: when the object moves",
    "rubber shear": "fall of the load output under a pull",
    "moment of the pull": "move of the position before the object moves",
}
COMPONENTS = tuple(WHY)
_BYTES = 32  # per taxel of a sample: loads applied and felt


class Pull(Table):
    """[[world.pulls]]: held with ``grip_n`` and pulled; ``direction_deg``: counter-clockwise from +x."""

    name: str
    grip_n: Positive
    direction_deg: Annotated[float, Meta(ge=-360, le=360)]
    speed_mm_s: Positive
    material: str

    def __post_init__(self):
        one_of("material", self.material, plate.MATERIALS)


class Grip(Table):
    """[[world.grips]]: held with ``grip_n``, then with each of ``to_n`` in turn, with ramps of ``ramp_s``."""

    name: str
    grip_n: Positive
    ramp_s: Positive
    to_n: Annotated[tuple[Annotated[float, Meta(ge=0, le=1e6)], ...], Meta(min_length=1)]


class World(Table):
    press_s: Positive
    rest_s: Positive
    after_s: Positive
    wire_n_mm: Positive
    pitch_mm: Positive
    cover_pitches: Positive
    cover_mm: Annotated[float, Meta(ge=0, le=100)]
    pulls: Annotated[list[Pull], Meta(min_length=1)]
    grips: Annotated[list[Grip], Meta(min_length=1)]


class Keys(base.Keys):
    """``build``: a configuration of four electrodes (docs/config.md), its name or file, with all that is not
    the world: mesh, converter, amplifiers, rate, load and detector.
    """

    seeds: Count
    build: str
    world: World

    @classmethod
    def unknown(cls, key, value):
        if key in ("mesh", "converter", "load", "cop_slip", "slip", "rate_hz"):
            return f"'{key}' belongs in the configuration that 'build' names (docs/config.md)"
        return None


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``lag``: of msn_cop_slip, in samples, with its ``registers``."""

    rate_hz: float
    seeds: int
    adc_part: str
    config: Cop4Config
    lag: int
    registers: CopSlipRegisters
    world: dict
    conditions: tuple

    def duration_s(self, condition):
        world = self.world
        rest_s = world["press_s"] + world["rest_s"]
        if isinstance(condition, Grip):
            return rest_s + len(condition.to_n) * (condition.ramp_s + world["after_s"])
        rise_n = plate.MATERIALS[condition.material].mu_s * condition.grip_n
        spread = 1 + 4 * plate.FRICTION_SPREAD
        return rest_s + spread * rise_n / (world["wire_n_mm"] * condition.speed_mm_s) + world["after_s"]


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run: ``codes`` [samples, 4]; ground truth: ``load`` (N), ``x``, ``y`` [samples] of the forces."""

    condition: Pull | Grip
    time_s: np.ndarray
    codes: np.ndarray
    solution: Solution
    held: grip.Held
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray


def build(name, table):
    keys, own = base.read(name, table, Keys)
    with naming(f"scene {name}: build"):
        found = builds.load(keys.build)
        if found.cop_slip is None:
            raise ValueError(f"'{keys.build}' must have kind = 'electrodes' and the table [cop_slip]")
    lag, registers = found.cop_slip
    noisy = dataclasses.replace(found.cop4.adc, noise_v=found.input.noise_v)
    config = dataclasses.replace(found.cop4, adc=noisy)
    world = values(keys.world)
    conditions = (*world.pop("pulls"), *world.pop("grips"))
    settings = {"config": config, "lag": lag, "registers": registers, "rate_hz": found.rate_hz}
    settings["adc_part"] = found.adc.part
    return Scene(**own, **settings, world=world, conditions=conditions)


def modelled(scene, conditions=None):
    """The parts of the physics that the scene has, or some of its conditions."""
    pulled = any(isinstance(condition, Pull) for condition in conditions or scene.conditions)
    return COMPONENTS if pulled else COMPONENTS[:4]


def memory(scene):
    mesh = scene.config.mesh
    longest_s = max(scene.duration_s(condition) for condition in scene.conditions)
    samples, taxels = longest_s * scene.rate_hz, mesh.m * mesh.n
    return _BYTES * samples * taxels, f"{samples:.0f} samples of {taxels} taxels"


def simulate(scene, condition, seed=0, side=0):
    """Run one of the scene's conditions with one seed: friction, place, tilt and the converter's noise.

    ``side``: 1 for the gripper's second sensor, with the same grip, pull and friction, and the rest its own.
    Its recording's condition has the direction as that sensor sees it.
    """
    world, mesh = scene.world, scene.config.mesh
    number = scene.conditions.index(condition)
    rng = np.random.default_rng([seed, number])
    time_s = np.arange(round(scene.duration_s(condition) * scene.rate_hz)) / scene.rate_hz
    levels = [(0.0, world["press_s"], condition.grip_n)]
    start_s = world["press_s"] + world["rest_s"]
    pulled = isinstance(condition, Pull)
    if pulled:
        rest_n = grip.ramps(time_s, levels)
        held = grip.pulled(
            *(time_s, rest_n, start_s, condition.speed_mm_s, condition.material, world["wire_n_mm"], rng),
            cover_mm=world["cover_mm"],
        )
    else:
        for number, to_n in enumerate(condition.to_n):
            each_s = condition.ramp_s + world["after_s"]
            levels.append((start_s + number * each_s, condition.ramp_s, to_n))
        held = grip.gripped(grip.ramps(time_s, levels))
    direction_deg = condition.direction_deg if pulled else 0.0
    if side:
        rng, direction_deg = np.random.default_rng([seed, number, side]), grip.mirrored(direction_deg)
        condition = replace(condition, direction_deg=direction_deg) if pulled else condition
    depth = world["cover_pitches"] + world["cover_mm"] / world["pitch_mm"]
    pressing, felt = grip.loads(held, mesh.m, mesh.n, world["pitch_mm"], depth, direction_deg, rng)
    solution, adc = mesh.solve(felt), scene.config.adc
    volts = Stream(scene.adc_part, adc.high_v, scene.rate_hz).next(electrodes(solution).T).T
    load, x, y = mesh_loads.true_centre(pressing)
    return Recording(
        scene=scene,
        condition=condition,
        seed=seed,
        time_s=time_s,
        codes=scene.config.convert(volts, rng),
        solution=solution,
        held=held,
        load=load,
        x=x,
        y=y,
        modelled=modelled(scene, [condition]),
    )
