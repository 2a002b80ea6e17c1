"""Print docs/published_cop.md's computed tables as Markdown: figures and tables of the papers beside ours.

    python tools/published_cop.py [mesh] [load] [rubber]

Without a name all of them, reproducible to the digit.
"""

import argparse

import numpy as np

from meissner.physics import mesh_loads, rubber
from meissner.physics.mesh import Mesh
from mesh_figures import errors, percent, show

DRAWS = 1000  # beside the papers' 100: the averages of our tables then move by less than their last digit
R_OVER_RP = {  # table I of the mesh paper
    5: (0.0115, 0.0544, 0.1157, 0.1736),
    10: (0.02315, 0.01088, 0.2315, 0.3472),
    15: (0.03472, 0.1632, 0.3472, 0.5208),
    20: (0.04630, 0.2178, 0.4629, 0.6944),
}
SHEAR_STEP = {0.05: 1.4, 0.1: 1.6, 1.0: 2.1}  # table I of the CoP slip paper: mm/s, volts, at 2 V
SHEAR_FIT = {2: (0.99, 0.12), 3: (0.75, 0.11), 4: (0.45, 0.11)}  # its table II: initial voltage: k, n
BELOW = "inside"


def signed(value):
    """Four digits; no sign on what rounds to nothing."""
    return f"{value:+.4f}" if abs(value) >= 5e-5 else "0"


def drops():
    """What the layers' own drop does to one and to three points."""
    found = []
    for r in mesh_loads.SIX_R:
        scene = mesh_loads.cop_one_point(r)
        solution = scene.mesh.solve(scene.load, "lu")
        found.append(solution.E1[0] - solution.Va.min())
    over = f"+{100 * (found[0] / 0.02 - 1):.0f} %"
    yield (
        "mesh, fig. 5",
        "drop in layer A, 5 N in the middle, r = 10",
        "below 0.02 V",
        f"{found[0]:.4f} V",
        over,
    )
    load = np.zeros((41, 41))
    at = (10, 10, 30), (10, 30, 20)
    load[at] = 5 / 3
    solution = Mesh(41, 41, 10.0).solve(load, "lu")
    lost = 1e3 * (solution.E1 - solution.E2 - (solution.Va - solution.Vb)[at])
    ours = f"{lost.min():.1f} to {lost.max():.1f} mV less than between the electrodes"
    yield (
        "mesh, fig. 6",
        "voltage at three loaded places, 5 N together, r = 10",
        "falls where pressed (surface)",
        ours,
        "none stated",
    )
    depth = ", ".join(f"{drop:.3f}" for drop in found)
    yield (
        "mesh, fig. 7",
        "fig. 5 for r = 10, 47, 100, 150",
        "grows with r (curve)",
        f"{depth} V",
        "none stated",
    )


def six_points():
    for split in ("equal", "random"):
        scenes = [mesh_loads.cop_six_random(10.0, t, DRAWS, split=split) for t in mesh_loads.SIX_TOTALS]
        position, load = zip(*(errors(scene) for scene in scenes))
        what = f"six random points, {split} shares, r = 10, 5-20 N"
        mean, worst = 100 * position[-1].mean(), 100 * np.max(position)
        inside = BELOW if worst <= 0.5 else f"mean {BELOW}, worst +{worst - 0.5:.2f} points"
        yield (
            "mesh, fig. 8",
            what + ": position",
            "within 0.5 %",
            f"mean {mean:.3f} %, worst {worst:.2f} %",
            inside,
        )
        mean = 100 * load[-1].mean()
        inside = BELOW if mean <= 2 else f"+{mean - 2:.2f} points"
        yield "mesh, fig. 9", what + ": load", "within 2 %", f"{percent(load[-1])} % at 20 N", inside


def two_points():
    scene = mesh_loads.cop_two_point()
    solution, (_, x, _) = scene.mesh.solve(scene.load), scene.truth()
    assert np.abs(solution.x - solution.y).max() < 1e-12
    ours = f"on it; along it at most {np.abs(solution.x - x).max():.3f} off"
    yield "mesh, fig. 10", "two points, 5×5, r = 47, 10 N", "on the straight line (curve)", ours, "none seen"
    scene = mesh_loads.cop_load()
    solution = scene.mesh.solve(scene.load)
    ours = f"{solution.load[10]:.2f} N of 10, {solution.load[20]:.2f} N of 20"
    yield (
        "mesh, fig. 11",
        "two equal loads, 5×5, r = 47",
        "falls behind as load grows (curve)",
        ours,
        "none stated",
    )
    scene = mesh_loads.cop_six_random(150.0, 20.0)
    reports = np.array([Mesh(41, 41, 150.0, R0).solve(scene.load).load for R0 in (1e3, 1e4, 1e5)])
    ours = f"load moves by {100 * np.abs(reports / reports[1] - 1).max():.1f} % from 1 to 100 kΩ"
    yield "mesh, IV-D", "R0 and the errors", "not affected", ours, "none of note"


def net():
    loads = np.eye(9).reshape(9, 3, 3) * 3
    solution = Mesh(3, 3, 150.0).solve(loads)
    worst = max(
        np.abs(np.diff(solution.x.reshape(3, 3))[0] - 1).max(), np.abs(solution.y[::3] - [1, 0, -1]).max()
    )
    assert worst < 1e-12
    yield "net, fig. 8", "one element at a time, 3×3, r = 150", "equal 3 V steps", "equal steps", "none"
    loads = np.zeros((7, 3, 3))
    loads[:, 1, 2], loads[:, 1, 0] = 3, np.arange(7) / 2
    solution = Mesh(3, 3, 150.0).solve(loads)
    assert abs(solution.x[-1]) < 1e-12
    straight = (3 - np.arange(7) / 2) / (3 + np.arange(7) / 2)
    ours = f"0 when equal; from the ideal at most {np.abs(solution.x - straight).max():.3f}"
    yield "net, fig. 9", "3 N right, 0-3 N left", "0 V when equal", ours, "none"


def mesh():
    rows = [*drops(), *six_points(), *two_points(), *net()]
    show("Figures", ("paper", "what", "published", "ours", "difference"), rows)
    rows = []
    for force, printed in R_OVER_RP.items():
        ours = [r * force / mesh_loads.K_PAPER for r in mesh_loads.SIX_R]
        rows.append((f"{force} N", *(f"{p:g} / {o:.4f} ({signed(p - o)})" for p, o in zip(printed, ours))))
    show("Table I of mesh, r/rp: printed / ours", ("load", *(f"{r:.0f} Ω" for r in mesh_loads.SIX_R)), rows)


def load():
    titles = "Position error, % of the range (mesh, fig. 8)", "Load error, % (mesh, fig. 9)"
    for index, name in enumerate(titles):
        rows = []
        for r in mesh_loads.SIX_R:
            cells = [errors(mesh_loads.cop_six_random(r, t, DRAWS))[index] for t in mesh_loads.SIX_TOTALS]
            rows.append((f"{r:.0f} Ω", *(percent(cell, 3 - index) for cell in cells)))
        show(name, ("r", *(f"{t:.0f} N" for t in mesh_loads.SIX_TOTALS)), rows)


def rubber_tables():
    n = rubber.SHEAR_EXPONENT
    k = {volts: float(rubber.shear_gain(volts)) for volts in SHEAR_FIT}  # eq. 2 in this range
    rows = []
    for speed, step in SHEAR_STEP.items():
        own, ours = SHEAR_FIT[2][0] * speed ** SHEAR_FIT[2][1], k[2] * speed**n
        rows.append(
            (
                f"{speed:g} mm/s",
                f"{step} V",
                f"{own:.2f} V",
                f"{ours:.2f} V",
                f"{100 * (ours / step - 1):+.0f} %",
            )
        )
    header = "shear speed", "table I", "by its own table II", "ours", "ours beside table I"
    show("Voltage step of sheared rubber at 2 V (CoP slip, tables I, II, figs. 6-8, 10)", header, rows)
    rows = [
        (
            f"{volts} V",
            f"{k_found:g}",
            f"{k[volts]:.2f}",
            f"{k[volts] - k_found:+.2f}",
            f"{n_found:g}",
            f"{n:g}",
        )
        for volts, (k_found, n_found) in SHEAR_FIT.items()
    ]
    header = "initial voltage", "k, table II", "k, eq. 2, ours", "difference", "n, table II", "n, eq. 1, ours"
    show("Constants of the step (CoP slip, table II, fig. 11)", header, rows)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tables", nargs="*", metavar="table", help="mesh, load or rubber")
    calls = {"mesh": mesh, "load": load, "rubber": rubber_tables}
    for table in parser.parse_args().tables or calls:
        if table not in calls:
            parser.error(f"{table} is none of {', '.join(calls)}")
        calls[table]()


if __name__ == "__main__":
    main()
