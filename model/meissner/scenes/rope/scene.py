"""Scenes of a rope that is pulled out of a fingertip's grip: forces, the sensors' matrix, the load cell's
labels.

Kinds: ``pull`` (a forest decides slip, frame by frame), ``cop`` (the centre of pressure over the pulls),
``hardness`` (differences of successive frames with grips of several hardnesses and shapes).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta

from meissner.builds.cop_tables import Cop
from meissner.physics import fsr, rope
from meissner.physics.adc import Adc
from meissner.rope import labels, train
from meissner.scenes import base, scanned
from meissner.scenes.fsr.scene import (
    CALIBRATION_FRAMES,
    CALIBRATION_STEPS,
    ArrayKeys,
    ConverterKeys,
    ReadoutKeys,
    Sheet,
)
from meissner.scenes.scanned import Scan, ScanKeys
from meissner.tables import Count, Positive, Table, one_of, values

FEATURES = {
    "forest_features": "kinds pull and hardness: differences of successive frames",
    "calibrate": "kind cop: cells are compared in newtons",
    "cop": "kind cop: position and load are compared with the forces",
}
_USED = {"pull": ("forest_features",), "hardness": ("forest_features",), "cop": ("calibrate", "cop")}
WHY = {
    "stick-slip": "[[conditions]]: tension of the rope, and when it slides",
    "rope": "rope: its stiffness, friction, surface and strands",
    "grip": "shape, shore: of the elastomer between rope and sensors",
    "arm": "mode: force control or speed control",
    "load cell": "the labels of slip",
    "cell resistance": "force to resistance",
    "spread of the cells": "one fingertip for all recordings of a seed",
    "drift under load": "of the sensors",
    "resistor network": "[readout]: the cells share their lines",
    "converter": "[converter]: volts to codes, with its noise",
    "converter front": "[scan]: what remains of the row before",
    "turning of the hand": "kinds cop and hardness, and of pull the real time: no post holds the rope",
}
COMPONENTS = tuple(WHY)
_BYTES = 2000  # per frame of a pull: the state of the pull, forces, conductances, volts, codes
CONDITION_SEED, TRAINING_SEED = 2, 1  # second number of a recording's seed

_Value = Annotated[float, Meta(gt=0, le=100)]


class Condition(Table):
    """[[conditions]]: as physics.rope.Pull; ``values``: newtons or mm/s of each pull."""

    name: str
    mode: Literal[rope.MODES]
    values: Annotated[list[_Value], Meta(min_length=1, max_length=100)]
    rope: str = "a"
    position: str = "middle"
    shape: str = "nine-sided"
    shore: Annotated[float, Meta(ge=10, le=98)] = 27.0
    post: bool = False

    def __post_init__(self):
        one_of("rope", self.rope, rope.ROPES)
        one_of("position", self.position, rope.POSITIONS)
        one_of("shape", self.shape, rope.SHAPES)


class World(Table):
    """[world]; ``trees``, ``pattern``: of kind pull; ``calibrate_n``: of kind cop."""

    kind: Literal[tuple(_USED)]
    pull_s: Annotated[float, Meta(ge=0.5, le=1000)]
    free_s: Annotated[float, Meta(ge=0.1, le=1000)]
    trees: Annotated[int, Meta(ge=1, le=1000)] = 400
    pattern: str = "E"
    calibrate_n: Positive = 5.0

    def __post_init__(self):
        one_of("pattern", self.pattern, labels.PATTERNS)


class Keys(base.Keys):
    rate_hz: Count
    seeds: Count
    array: ArrayKeys
    readout: ReadoutKeys
    converter: ConverterKeys
    scan: ScanKeys
    world: World
    conditions: Annotated[list[Condition], Meta(min_length=1)]
    cop: Cop = Cop(0.5)

    def __post_init__(self):
        if (self.array.rows, self.array.columns) != (3, 3):
            raise ValueError("[array]: rows and columns must be 3")
        if len({len(one.values) for one in self.conditions}) > 1:
            raise ValueError("[[conditions]]: values must be as many in each")
        for key, least in (("pull_s", labels.PATTERNS[self.world.pattern].w + 2), ("free_s", 1)):
            if (seconds := getattr(self.world, key)) * self.rate_hz < least:
                at = f"rate_hz = {self.rate_hz}"
                raise ValueError(f"[world]: {key} = {seconds:g} must last {least} frames or more at {at}")


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene; what its Sheet needs is named as in scenes.fsr. ``pulls``: of ``names``."""

    rate_hz: int
    seeds: int
    kind: str
    material: fsr.Material
    readout: fsr.Readout
    adc: Adc
    scan: Scan
    min_load_n: float
    world: dict
    names: tuple[str, ...]
    pulls: tuple[rope.Pull, ...]
    rows: int = 3
    columns: int = 3
    faults: tuple = ()

    @property
    def pattern(self) -> labels.Pattern:
        return labels.PATTERNS[self.world["pattern"]]


@dataclass(frozen=True)
class Recording(base.Recording):
    """One pull. ``codes`` and ``force_n`` [frames, rows, columns]; the rest [frames]; ``place``: where the
    rope crosses the sensors; ``sections``: rope.labels.Section by the load cell."""

    pull: rope.Pull
    time_s: np.ndarray
    codes: np.ndarray
    force_n: np.ndarray
    tension_n: np.ndarray
    load_n: np.ndarray
    slid_mm: np.ndarray
    place: np.ndarray
    sections: list[labels.Section]
    over_range: int

    @property
    def channels(self):
        """s_0 to s_8 [9, frames]."""
        return rope.as_published(self.codes).T


def build(name, table):
    keys, own = base.read(name, table, Keys)
    converter, world = keys.converter, values(keys.world)
    times = {key: world[key] for key in ("pull_s", "free_s")}
    own["kind"] = world.pop("kind")
    given = [values(one) for one in keys.conditions]
    names = tuple(one.pop("name") for one in given)
    return Scene(
        **own,
        material=fsr.MATERIALS[keys.array.material],
        readout=fsr.Readout(**values(keys.readout)),
        adc=Adc(converter.bits, 0.0, keys.readout.supply_v, converter.noise_v),
        scan=scanned.build(f"scene {name}", keys.scan, 3, 3, keys.rate_hz),
        min_load_n=keys.cop.min_load_n,
        world=world,
        names=names,
        pulls=tuple(rope.Pull(**one | {"values": tuple(one["values"])} | times) for one in given),
    )


def uses(scene):
    return {name: FEATURES[name] for name in _USED[scene.kind]}


def modelled(scene):
    return COMPONENTS if any(not one.post for one in scene.pulls) else COMPONENTS[:-1]


def memory(scene):
    frames = scene.seeds * sum(one.seconds for one in scene.pulls) * scene.rate_hz
    if scene.kind == "pull":
        frames += 240 * scene.pulls[0].seconds * scene.rate_hz
    return _BYTES * frames, f"{frames:.0f} frames of 9 cells"


def fingertip(scene, seed):
    """The Sheet of the fingertip with number ``seed``."""
    return Sheet(scene, seed)


def pressed(scene, seed):
    """Codes and forces of even presses on that fingertip, for its calibration."""
    return fingertip(scene, seed).even(
        np.linspace(0, scene.world["calibrate_n"], CALIBRATION_STEPS), CALIBRATION_FRAMES
    )


def record(scene, pulls: Sequence[rope.Pull], seeds: Sequence[Sequence[int]], fingertip_seed):
    """The Recording of each of ``pulls``, which last equally long, with its own seed."""
    rate_hz, sheet = scene.rate_hz, fingertip(scene, fingertip_seed)
    found = rope.pull(pulls, rate_hz, seeds)
    recordings = []
    for index, (one, seed) in enumerate(zip(pulls, seeds)):
        at = tension_n, load_n, slid_mm = found.tension_n[index], found.load_n[index], found.slid_mm[index]
        sheet.rng, sheet.over_range = np.random.default_rng([*seed, 1]), 0
        force_n = rope.forces(one, tension_n, slid_mm, rate_hz, sheet.rng)
        codes = sheet.codes(sheet.conductance(force_n) * fsr.drift(force_n, scene.material, rate_hz))
        recordings.append(
            Recording(
                scene=scene,
                seed=fingertip_seed,
                pull=one,
                time_s=np.arange(len(codes)) / rate_hz,
                codes=codes,
                force_n=force_n,
                tension_n=at[0],
                load_n=load_n,
                slid_mm=slid_mm,
                place=rope.places(one, tension_n, slid_mm),
                sections=labels.sections(load_n, one.spans(rate_hz)),
                over_range=sheet.over_range,
                modelled=modelled(scene),
            )
        )
    return recordings


def training(scene, seed):
    """The 240 recordings that a forest is trained on, with the fingertip of that number."""
    every = train.pulls(scene.pulls[0])
    return record(scene, every, [[seed, TRAINING_SEED, k] for k in range(len(every))], seed)


def simulate(scene, condition=0, seed=1, fingertip_seed=None):
    """The Recording of condition number ``condition``; ``seed`` draws the pull and the noise."""
    own = [[seed, CONDITION_SEED, condition]]
    return record(
        scene, scene.pulls[condition : condition + 1], own, seed if fingertip_seed is None else fingertip_seed
    )[0]


def simulate_all(scene, seeds, fingertip_seed):
    """[condition][seed]: what ``simulate`` gives for each, in one go."""
    tasks = [(k, seed) for k in range(len(scene.pulls)) for seed in seeds]
    found = record(
        scene,
        [scene.pulls[k] for k, _ in tasks],
        [[seed, CONDITION_SEED, k] for k, seed in tasks],
        fingertip_seed,
    )
    return [found[k * len(seeds) : (k + 1) * len(seeds)] for k in range(len(scene.pulls))]
