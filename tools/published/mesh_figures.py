"""Print docs/mesh.md's tables as Markdown: the correction and its limits.

python tools/published/mesh_figures.py [correction] [cross] [limits]
"""

import argparse
import time

import numpy as np
from scipy.spatial import cKDTree

from meissner.physics import mesh_loads
from meissner.physics.mesh import Mesh, contacts, correction
from meissner.physics.mesh.circuit import Circuit


def show(title, header, rows):
    print(f"### {title}\n\n| {' | '.join(header)} |\n|{'---|' * len(header)}")
    for row in rows:
        print(f"| {' | '.join(str(cell) for cell in row)} |")
    print()


def errors(scene, fix=None):
    """Position error (fraction of the range 2) and load error (fraction), one per scene."""
    solution, (total, x, y) = scene.mesh.solve(scene.load), scene.truth()
    got = solution.x, solution.y, solution.load
    got = fix.apply(*got) if fix else got
    return np.hypot(got[0] - x, got[1] - y) / 2, 1 - got[2] / total


def percent(values, digits=2):
    return f"{100 * values.mean():.{digits}f} ± {100 * values.std():.{digits}f}"


KINDS = {
    "point": "one point",
    "cover": "one press through a cover, 2 pitches",
    "two covers": "two presses through it",
    "equal points": "six points, equal shares",
    "uneven points": "six points, random shares",
}


def correct():
    rows = []
    for r in (10.0, 47.0, 150.0):
        mesh = Mesh(41, 41, r)
        for kind, name in KINDS.items():
            fix = correction.fit(mesh, mesh_loads.touches(41, 41, kind, 1))
            check = mesh_loads.MeshScene(mesh, mesh_loads.touches(41, 41, kind, 2, 20.0))
            (place, load), (new_place, new_load) = errors(check), errors(check, fix)
            cells = [
                load.mean(),
                np.abs(new_load).mean(),
                np.median(np.abs(new_load)),
                np.abs(new_load).max(),
            ]
            cells = [f"{100 * cell:.2f}" for cell in cells]
            cells += [f"{100 * cell:.3f}" for cell in (place.mean(), new_place.mean(), new_place.max())]
            rows.append((f"{r:.0f} Ω", name, *cells))
            if r == 150 and kind == "equal points":
                stage = correction.registers(fix)
    header = ("r", "touch", "load error before", "after: mean", "median", "worst")
    show(
        "Correction: 41×41, 20 N, held-out scenes, fitted over 1-25 N (%)",
        (*header, "position before: mean", "after: mean", "worst"),
        rows,
    )
    print(f"Registers for six equal points at 150 Ω: {stage.p} / 2^{stage.shift}\n")


def cross():
    """Mean load error for kinds of touch that the correction was not fitted for."""
    mesh, rows = Mesh(41, 41, 150.0), []
    checks = [mesh_loads.MeshScene(mesh, mesh_loads.touches(41, 41, kind, 2, 20.0)) for kind in KINDS]
    rows.append(("none", *(f"{100 * errors(check)[1].mean():.0f}" for check in checks)))
    for kind, name in KINDS.items():
        fix = correction.fit(mesh, mesh_loads.touches(41, 41, kind, 1))
        rows.append((name, *(f"{100 * np.abs(errors(check, fix)[1]).mean():.1f}" for check in checks)))
    show("Load error with another touch than fitted, 150 Ω, 20 N (%)", ("fitted for", *KINDS.values()), rows)


def moments(mesh, load):
    """The six conductances between the four wires: s' M^-1 s with s = 1, x, y; [scenes, 6], siemens."""
    row, column = (np.nonzero(load)[axis].reshape(len(load), -1) for axis in (1, 2))
    resistance = mesh.k / load[load > 0].reshape(row.shape)
    x = column * 2 / (mesh.n - 1) - 1
    y = 1 - row * 2 / (mesh.m - 1)
    drive = np.stack([np.ones_like(x), x, y], -1)
    got = np.swapaxes(drive, 1, 2) @ np.linalg.solve(contacts.matrix(mesh, row, column, resistance), drive)
    return got[:, *np.triu_indices(3)]


def limits():
    """The best that any function of the four wires can achieve for six equal points at 150 Ω and 20 N."""
    mesh, count = Mesh(41, 41, 150.0), 200_000
    rng = np.random.default_rng(11)
    totals = rng.uniform(14, 28, count)
    totals[: count // 20] = 20
    rows = []
    parts = [slice(at, at + 4000) for at in range(0, count, 4000)]
    numbers, truth = [], []
    for at, part in enumerate(parts):
        load = mesh_loads.random_points(41, 41, 6, totals[part], 100 + at)
        numbers.append(moments(mesh, load))
        truth.append(np.stack(mesh_loads.true_centre(load), 1))
    c, cx, cy, cxx, cxy, cyy = np.concatenate(numbers).T
    total, x_true, y_true = np.concatenate(truth).T
    x, y = cx / c, cy / c
    check = np.arange(count) < count // 20
    three = np.stack([10 * np.log(c), 3 * np.abs(x), 3 * np.abs(y)], 1)
    shape = 3 * np.stack([cxx / c - x * x, cyy / c - y * y, (cxy / c - x * y) * np.sign(x * y)], 1)
    for name, seen in (
        ("I_all, x, y (one drive)", three),
        ("all six (three drives)", np.concatenate([three, shape], 1)),
    ):
        near = cKDTree(seen[~check]).query(seen[check], 200)[1]
        step = seen[~check][near] - seen[check][:, None]
        solver = np.linalg.pinv(np.concatenate([np.ones((*near.shape, 1)), step], -1))[:, :1]
        local = lambda value, solver=solver, near=near: (solver @ value[~check][near][..., None])[:, 0, 0]
        load = np.abs(local(total / c) * c[check] / total[check] - 1)
        off_x, off_y = ((true - at) * np.sign(at) for true, at in ((x_true, x), (y_true, y)))
        away = np.hypot(off_x[check] - local(off_x), off_y[check] - local(off_y)) / 2
        rows.append((name, *(f"{100 * cell:.2f}" for cell in (load.mean(), np.median(load), away.mean()))))
    show(
        "Limit: local regression over 200,000 scenes, six equal points, 150 Ω, 20 N (%)",
        ("known", "load error: mean", "median", "position: mean"),
        rows,
    )


def best(call, repeats=7):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)


def figures():
    """The two solvers on 1,000 scenes of six contacts: largest relative difference, ratios of time.

    The difference covers the four voltages, the position (relative to its range, 2) and the load. The times
    are the best CPU times of several: a sparse LU solve against a fast solve, alone and in a batch.
    """
    mesh = Mesh(41, 41, 10.0)
    load = mesh_loads.cop_six_random(10.0, 5.0, 1000).load
    names, ranges = ("E1", "E2", "E3", "E4", "x", "y", "load"), (None, None, None, None, 2, 2, None)
    fast, plain = mesh.solve(load, "fast"), mesh.solve(load, "lu")
    away = 0.0
    for name, span in zip(names, ranges):
        got, expected = getattr(fast, name), getattr(plain, name)
        away = max(away, float(np.max(np.abs(got - expected) / (span or np.abs(expected)))))
    lu = best(lambda: Circuit(mesh, load[0]).plain())
    one = best(lambda: mesh.solve(load[0], "fast"), 50)
    batch = best(lambda: mesh.solve(load, "fast")) / len(load)
    return {"difference": away, "one": lu / one, "batch": lu / batch}


def main():
    calls = {"correction": correct, "cross": cross, "limits": limits}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", metavar="table", help="correction, cross or limits")
    wanted = parser.parse_args()
    for table in wanted.tables or calls:
        if table not in calls:
            parser.error(f"{table} is none of {', '.join(calls)}")
        calls[table]()


if __name__ == "__main__":
    main()
