"""Scenes of the four-wire resistor mesh: loads in newtons, electrode voltages, codes, the ground truth."""

from dataclasses import dataclass

import numpy as np

from meissner.builds import four_wires
from meissner.check import between, fields, numbers, one_of, positive, tables
from meissner.physics import mesh_loads
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Mesh, Solution
from meissner.physics.mesh_loads import SETTLED
from meissner.scenes import base

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
_TOP = base.TOP | {"rate_hz": int, **four_wires.TABLES, "world": dict}
_WORLD = {
    "points": {"steps": int, "points": list},
    "random": {"count": int, "draws": int, "totals_n": list, "split": str},
    "pulse": {
        "seconds": float,
        "start_s": float,
        "pulse_s": float,
        "response_s": float,
        "rest_n": float,
        "points": list,
    },
    "stroke": {"steps": int, "force_n": float, "radius": float, "cover_radius": float},
}


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
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    top, own = base.top(name, table, _TOP)
    inside = f"{where}, [mesh]"
    mesh = four_wires.mesh_table(inside, top["mesh"], r_ohm=list)
    mesh["r_ohm"] = numbers(inside, "r_ohm", mesh["r_ohm"], least=1e-6, most=1e9)
    configs = tuple(
        four_wires.config(where, mesh | {"r_ohm": r}, top["converter"], top["load"], noise=True)
        for r in mesh["r_ohm"]
    )

    inside = f"{where}, [world]"
    world = dict(top["world"])
    kind = world.pop("kind", None)
    one_of(inside, "kind", kind, tuple(_WORLD))
    world = fields(inside, world, _WORLD[kind])
    if kind == "random":
        between(inside, world, {"count": (1, mesh["rows"] * mesh["columns"]), "draws": (1, 10**6)})
        one_of(inside, "split", world["split"], ("equal", "random"))
        world["totals_n"] = numbers(inside, "totals_n", world["totals_n"], least=1e-6, most=1e6)
    elif kind == "stroke":
        between(inside, world, {"steps": (3, 10**6), "radius": (1e-3, 1)})
        positive(inside, world, ["force_n", "cover_radius"])
    else:
        points, at = [], f"{where}, [[world.points]]"
        for row in tables(inside, "world.points", world["points"]):
            row = fields(at, row, {"at": list, "force_n": list})
            force_n = numbers(at, "force_n", row["force_n"], 2 if kind == "points" else 1, 0, 1e6)
            place = numbers(at, "at", row["at"], 2, -1, 1)
            points.append((*_taxel(at, mesh["rows"], mesh["columns"], place), force_n))
        world["points"] = tuple(points)
    if kind == "points":
        between(inside, world, {"steps": (1, 10**6)})
    if kind == "pulse":
        positive(inside, world, ["seconds", "start_s", "pulse_s", "response_s"])
        between(inside, world, {"rest_n": (0, 1e6)})
        if world["start_s"] + world["pulse_s"] > world["seconds"]:
            raise ValueError(f"{inside}: the pulse must end within seconds = {world['seconds']:g}")
    return Scene(
        **own,
        rows=mesh["rows"],
        columns=mesh["columns"],
        r_ohm=mesh["r_ohm"],
        configs=configs,
        kind=kind,
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
    """The parts of the physics that the scene has."""
    added = {"random": (COMPONENTS[3],), "pulse": (COMPONENTS[4],), "stroke": (COMPONENTS[5],)}
    return COMPONENTS[:3] + added.get(scene.kind, ())


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
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
