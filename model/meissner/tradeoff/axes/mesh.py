"""Solvers of the resistor mesh: time per scene against the certified error."""

import time

import numpy as np

from meissner.physics import mesh_loads
from meissner.physics.mesh import Mesh
from meissner.tradeoff.axis import Axis, Figure

TOTAL_N, CONTACTS = 5.0, 6


def _asked(point):
    totals = np.full(point["batch"], TOTAL_N)
    side = point["side"]
    return Mesh(side, side, 10.0), mesh_loads.random_points(side, side, CONTACTS, totals, 1)


def error(point):
    """Rigorous error bounds of position (of the range 2) and load, the largest of the batch."""
    mesh, load = _asked(point)
    answer = mesh.solve(load, point["solver"])
    if not answer.valid.all():
        raise ValueError(str(answer.why[~answer.valid][0]))
    bound = answer.bound
    away = np.abs(answer.load / TOTAL_N - 1).max()
    return {
        "position": 50 * float(max(np.max(bound.x), np.max(bound.y))),
        "load": 100 * float(np.max(bound.load / answer.load)),
        "formula": 100 * float(away),
    }


def cost(point):
    mesh, load = _asked(point)
    mesh.solve(load, point["solver"])  # computes what the solver caches of the mesh
    times = []
    for _ in range(point["repeats"]):
        began = time.process_time()
        mesh.solve(load, point["solver"])
        times.append(time.process_time() - began)
    return {"ms": 1e3 * min(times) / point["batch"]}


AXES = (
    Axis(
        name="mesh",
        title="Solvers of the resistor mesh",
        about="constant potential, the fast solver, sparse LU; six contacts of 5 N together, 10 Ω",
        values={"solver": ("constant", "fast", "lu"), "side": (5, 16, 41, 64), "batch": (1, 100)},
        quick={"side": (5, 41), "batch": (1, 10)},
        shipped={"solver": "fast", "side": 41, "batch": 100},
        runs={"repeats": (5, 2)},
        apart=("side", "batch"),
        legal=lambda point: 3 <= point["side"] <= 1024 and 1 <= point["batch"] <= 10_000,
        cost=cost,
        error=error,
        timed=("ms",),
        figures=(
            Figure("ms", "time of a scene", "ms", judged=True),
            Figure("position", "certified error of the position", "% of the range", judged=True),
            Figure("load", "certified error of the load", "%"),
            Figure("formula", "load that the electrodes' formula is off", "%"),
        ),
        panels=(("ms", "position"),),
    ),
)
