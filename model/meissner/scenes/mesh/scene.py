"""Scenes of the four-wire resistor mesh: loads in newtons, electrode voltages, codes, the ground truth."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta

from meissner.builds import four_wires
from meissner.physics import mesh_loads
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Mesh, Solution
from meissner.physics.mesh_loads import SETTLED
from meissner.scenes import base
from meissner.tables import Count, Positive, Table, naming, values

CONVERTER = "converter"  # modelled for every engine except float, which takes the voltages
FEATURES = {"cop4": "position and load of the electrodes are compared with the forces"}
WHY = {
    "resistor mesh": "[mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "[converter]: voltages to codes, with its noise",
    "random points": "kind random: count and draws",
    "rubber response": "kind pulse: response_s",
    "hemispherical cover": "kind stroke: cover_radius",
}
COMPONENTS = tuple(WHY)
_BYTES = 32  # per taxel of a sample: forces, felt loads, and the places above 0
_Newtons = Annotated[float, Meta(ge=0, le=1e6)]
_Steps = Annotated[int, Meta(ge=1, le=10**6)]
_Unit = Annotated[float, Meta(ge=-1, le=1)]


class MeshKeys(four_wires.Circuit):
    """[mesh]: each resistance is a condition."""

    r_ohm: Annotated[list[Annotated[float, Meta(ge=1e-6, le=1e9)]], Meta(min_length=1)]


class Moved(Table):
    """[[world.points]] of kind points: a place, and its force from the first step to the last."""

    at: tuple[_Unit, _Unit]
    force_n: tuple[_Newtons, _Newtons]


class Pressed(Table):
    at: tuple[_Unit, _Unit]
    force_n: tuple[_Newtons]


class Points(Table, tag_field="kind", tag="points"):
    steps: _Steps
    points: Annotated[list[Moved], Meta(min_length=1)]


class Random(Table, tag_field="kind", tag="random"):
    count: Count
    draws: _Steps
    totals_n: Annotated[tuple[Annotated[float, Meta(ge=1e-6, le=1e6)], ...], Meta(min_length=1)]
    split: Literal["equal", "random"]


class Pulse(Table, tag_field="kind", tag="pulse"):
    seconds: Positive
    start_s: Positive
    pulse_s: Positive
    response_s: Positive
    rest_n: _Newtons
    points: Annotated[list[Pressed], Meta(min_length=1)]

    def __post_init__(self):
        if self.start_s + self.pulse_s > self.seconds:
            raise ValueError(f"the pulse must end within seconds = {self.seconds:g}")


class Stroke(Table, tag_field="kind", tag="stroke"):
    """[world] of kind stroke; radii in half ranges."""

    steps: Annotated[int, Meta(ge=3, le=10**6)]
    force_n: Positive
    radius: Annotated[float, Meta(ge=1e-3, le=1)]
    cover_radius: Positive


class Keys(base.Keys):
    rate_hz: Count
    mesh: MeshKeys
    converter: four_wires.NoisyConverter
    load: four_wires.Load
    world: Points | Random | Pulse | Stroke


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. Its conditions are the values of ``r_ohm``, each with its entry of ``configs``."""

    rate_hz: int
    rows: int
    columns: int
    r_ohm: tuple
    configs: tuple
    kind: str
    world: dict

    def mesh(self, r_ohm) -> Mesh:
        return self.configs[self.r_ohm.index(r_ohm)].mesh


@dataclass(frozen=True)
class Recording(base.Recording):
    """One condition: ``solution``, the mesh under the load that the taxels feel, and the true forces.

    ``codes`` [samples, 4]: its electrodes converted with ``config``. ``load`` (N), ``x``, ``y`` [samples]:
    of the forces; ``felt_n``: the load that the taxels feel, which lags if the rubber's response is modelled.
    """

    r_ohm: float
    config: Cop4Config
    time_s: np.ndarray
    solution: Solution
    codes: np.ndarray
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray
    felt_n: np.ndarray


def _taxel(where, scene_rows, scene_columns, at):
    """Row and column of the taxel at the place (x, y); ValueError if none is there."""
    x, y = at
    column, row = (x + 1) * (scene_columns - 1) / 2, (1 - y) * (scene_rows - 1) / 2
    if abs(column - round(column)) > 1e-6 or abs(row - round(row)) > 1e-6:
        raise ValueError(f"{where}: at = [{x:g}, {y:g}] is between the taxels")
    return round(row), round(column)


def build(name, table):
    where = f"scene {name}"
    keys, own = base.read(name, table, Keys)
    mesh, world = keys.mesh, values(keys.world)
    configs = (four_wires.config(where, mesh.mesh(r), keys.converter, keys.load) for r in mesh.r_ohm)
    if "points" in world:
        at = f"{where}, [[world.points]]"
        rows = world["points"]
        world["points"] = tuple((*_taxel(at, mesh.rows, mesh.columns, row.at), row.force_n) for row in rows)
    with naming(f"{where}, [world]"):
        if world.get("count", 1) > mesh.rows * mesh.columns:
            raise ValueError(f"count = {world['count']} must lie in 1 .. {mesh.rows * mesh.columns}")
    return Scene(
        **own,
        rows=mesh.rows,
        columns=mesh.columns,
        r_ohm=tuple(mesh.r_ohm),
        configs=tuple(configs),
        world=world,
    )


def loads(scene, seed=0):
    """Newtons [samples, rows, columns]: (the forces on the taxels, the loads that the taxels feel)."""
    world, shape = scene.world, (scene.rows, scene.columns)
    if scene.kind == "random":
        parts = [
            mesh_loads.random_points(
                *shape, world["count"], np.full(world["draws"], total), seed, world["split"]
            )
            for total in world["totals_n"]
        ]
        return (np.concatenate(parts),) * 2
    if scene.kind == "points":
        load = np.zeros((world["steps"], *shape))
        for row, column, (first, last) in world["points"]:
            load[:, row, column] += np.linspace(first, last, world["steps"])
        return load, load
    if scene.kind == "stroke":
        keys = ("force_n", "radius", "steps", "cover_radius")
        load = mesh_loads.stroke(*shape, *(world[key] for key in keys))
        return load, load
    time_s = np.arange(round(world["seconds"] * scene.rate_hz)) / scene.rate_hz
    start, stop = world["start_s"], world["start_s"] + world["pulse_s"]
    tau = world["response_s"] / SETTLED
    # The taxel's conductance follows its load with one time constant.
    rise = np.where(time_s >= start, -np.expm1(-np.maximum(time_s - start, 0) / tau), 0.0)
    fall = np.where(time_s >= stop, -np.expm1(-np.maximum(time_s - stop, 0) / tau), 0.0)
    true, felt = np.zeros((2, len(time_s), *shape))
    for row, column, (force_n,) in world["points"]:
        true[:, row, column] += force_n * ((time_s >= start) & (time_s < stop))
        felt[:, row, column] += force_n * np.maximum(rise - fall, 0.0)
    # rest_n: the conductance of an unloaded taxel, as the load that would give it.
    return true, felt + world["rest_n"]


def electrodes(solution):
    """Volts [scenes, 4] of E1 to E4 of a batch."""
    return np.stack([solution.E1, solution.E2, solution.E3, solution.E4], axis=1)


def modelled(scene):
    added = {"random": (COMPONENTS[3],), "pulse": (COMPONENTS[4],), "stroke": (COMPONENTS[5],)}
    return COMPONENTS[:3] + added.get(scene.kind, ())


def memory(scene):
    world, taxels = scene.world, scene.rows * scene.columns
    if scene.kind == "random":
        samples = world["draws"] * len(world["totals_n"])
    else:
        samples = world["seconds"] * scene.rate_hz if scene.kind == "pulse" else world["steps"]
    return _BYTES * samples * taxels, f"{samples:.0f} loads of {taxels} taxels"


def simulate(scene, seed=0):
    """A list with a Recording for each r; the seed draws random points and the converter's noise."""
    true, felt = loads(scene, seed)
    load, x, y = mesh_loads.true_centre(true)
    recordings = []
    for number, (r_ohm, config) in enumerate(zip(scene.r_ohm, scene.configs)):
        solution = config.mesh.solve(felt)
        recordings.append(
            Recording(
                scene=scene,
                r_ohm=r_ohm,
                config=config,
                seed=seed,
                time_s=np.arange(len(true)) / scene.rate_hz,
                solution=solution,
                codes=config.convert(electrodes(solution), np.random.default_rng([seed, number])),
                load=load,
                x=x,
                y=y,
                felt_n=felt.sum((1, 2)),
                modelled=modelled(scene),
            )
        )
    return recordings
