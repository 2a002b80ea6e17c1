"""Scenes of an object held on the four-wire sensor: pulled until it slips, or gripped harder and softer."""

from dataclasses import dataclass, replace

import numpy as np

from meissner.builds import four_wires
from meissner.check import between, fields, numbers, one_of, positive, tables
from meissner.engines import COP_ONE
from meissner.physics import grip, mesh_loads, plate
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Solution
from meissner.scenes import base
from meissner.scenes.mesh.scene import electrodes
from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters

FEATURES = {
    "cop4": "slip is detected in the electrodes' position and load",
    "cop_slip": "its flag and direction are judged; [slip] configures it",
}
WHY = {
    "resistor mesh": "[mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "[converter]: voltages to codes, with its noise",
    "grip": "grip_n: force that holds the object",
    "pull": "[[world.pulls]]",
    "plate friction": "material of a pull: when the object moves",
    "rubber shear": "fall of the load output under a pull",
    "moment of the pull": "move of the position before the object moves",
}
COMPONENTS = tuple(WHY)
_BYTES = 32  # per taxel of a sample: loads applied and felt

_TOP = base.TOP | {"rate_hz": int, "seeds": int}
_TOP |= {**four_wires.TABLES, "slip": dict, "world": dict}
_SLIP = dict.fromkeys(("lag_s", "drop", "move", "min_load_n", "hold_s", "refractory_s"), float)
_TIMES = ("press_s", "rest_s", "after_s")
_WORLD = dict.fromkeys((*_TIMES, "wire_n_mm", "pitch_mm", "cover_pitches", "cover_mm"), float)
_WORLD |= {"pulls": list, "grips": list}
_PULL = {"name": str, "grip_n": float, "direction_deg": float, "speed_mm_s": float, "material": str}
_GRIP = {"name": str, "grip_n": float, "ramp_s": float, "to_n": list}


@dataclass(frozen=True)
class Pull:
    """A condition: held with ``grip_n`` and pulled; ``direction_deg``: counter-clockwise from +x."""

    name: str
    grip_n: float
    direction_deg: float
    speed_mm_s: float
    material: str


@dataclass(frozen=True)
class Grip:
    """A condition: held with ``grip_n``, then with each of ``to_n`` in turn, with ramps of ``ramp_s``."""

    name: str
    grip_n: float
    ramp_s: float
    to_n: tuple


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``lag``: of msn_cop_slip, in samples, with its ``registers``."""

    rate_hz: int
    seeds: int
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


def _registers(where, slip, rate_hz, load_lsb_n):
    """(lag, ``CopSlipRegisters``) of a checked [slip]."""

    def samples(seconds):
        return round(seconds * rate_hz)

    registers = CopSlipRegisters(
        drop=round(256 * slip["drop"]),
        move=round(slip["move"] * COP_ONE),
        min_load=round(slip["min_load_n"] / load_lsb_n),
        hold=samples(slip["hold_s"]),
        refractory=samples(slip["refractory_s"]),
    )
    lag = samples(slip["lag_s"])
    try:
        CopSlip(lag, registers)
    except ValueError as problem:
        raise ValueError(f"{where}: {problem}") from None
    return lag, registers


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    top, own = base.top(name, table, _TOP)
    mesh = four_wires.mesh_table(f"{where}, [mesh]", top["mesh"])
    config = four_wires.config(where, mesh, top["converter"], top["load"], noise=True)

    inside = f"{where}, [slip]"
    slip = fields(inside, top["slip"], _SLIP)
    between(inside, slip, {"lag_s": (0, 60), "drop": (0, 1), "move": (0, 2), "min_load_n": (0, 1e6)})
    between(inside, slip, {"hold_s": (0, 60), "refractory_s": (0, 60)})
    lag, registers = _registers(inside, slip, top["rate_hz"], config.load_lsb_n)

    inside = f"{where}, [world]"
    world = fields(inside, top["world"], _WORLD)
    positive(inside, world, [*_TIMES, "wire_n_mm", "pitch_mm", "cover_pitches"])
    between(inside, world, {"cover_mm": (0, 100)})
    conditions, at = [], f"{where}, [[world.pulls]]"
    for row in tables(inside, "world.pulls", world.pop("pulls")):
        row = fields(at, row, _PULL)
        positive(at, row, ["grip_n", "speed_mm_s"])
        between(at, row, {"direction_deg": (-360, 360)})
        one_of(at, "material", row["material"], tuple(plate.MATERIALS))
        conditions.append(Pull(**row))
    at = f"{where}, [[world.grips]]"
    for row in tables(inside, "world.grips", world.pop("grips")):
        row = fields(at, row, _GRIP)
        positive(at, row, ["grip_n", "ramp_s"])
        row["to_n"] = numbers(at, "to_n", row["to_n"], least=0, most=1e6)
        conditions.append(Grip(**row))
    return Scene(
        **own,
        config=config,
        lag=lag,
        registers=registers,
        world=world,
        conditions=tuple(conditions),
    )


def modelled(scene, conditions=None):
    """The parts of the physics that the scene has, or some of its conditions."""
    pulled = any(isinstance(condition, Pull) for condition in conditions or scene.conditions)
    return COMPONENTS if pulled else COMPONENTS[:4]


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
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
    solution = mesh.solve(felt)
    load, x, y = mesh_loads.true_centre(pressing)
    return Recording(
        scene=scene,
        condition=condition,
        seed=seed,
        time_s=time_s,
        codes=scene.config.convert(electrodes(solution), rng),
        solution=solution,
        held=held,
        load=load,
        x=x,
        y=y,
        modelled=modelled(scene, [condition]),
    )
