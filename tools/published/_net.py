"""A Net-Structure Tactile Sensor Covering Freeform Surface: its part of the page ``cop_slip_and_net``."""

import numpy as np

from meissner.physics import disturbances, mesh_loads
from meissner.physics.mesh import Mesh
from meissner.physics.mesh.cut import CutMesh
from published import section
from published._mesh import blow
from published._parts import NONE, figure, label, save

HEAD = """The circuit is that of the mesh, so [shear_and_mesh](shear_and_mesh.md) has its errors. Figures
1 to 4, 6 and 12 are drawings and photographs and have no row."""
R_OHM = 150.0  # VI
VOLTS = 3.0  # figure 8: one step of one element
HYSTERESIS = 0.1  # of the force, unloading above loading; chosen: figure 7's loop has no readable numbers
CYCLE_HZ, CYCLE_N = 0.2, 3.0  # figure 7; the force is chosen equal to that of figure 9
LEFT_N = np.arange(7) / 2  # figure 9
HELD_N = 3.0  # figure 9, on the right
# Sheets with elements cut out, and which elements are missing.
CUTS = {
    "3×3, none": ((3, 3), []),
    "3×3, a corner": ((3, 3), [(0, 0)]),
    "3×3, an edge": ((3, 3), [(0, 1)]),
    "3×3, the middle": ((3, 3), [(1, 1)]),
    "3×3, all four corners": ((3, 3), [(0, 0), (0, 2), (2, 0), (2, 2)]),
    "25×5, a sole: corners and waist": (
        (25, 5),
        [*((i, j) for i in (0, 24) for j in (0, 4)), *((i, 0) for i in range(10, 15))],
    ),
}


def one_at_a_time():
    loads = np.eye(9).reshape(9, 3, 3) * HELD_N
    solution = Mesh(3, 3, R_OHM).solve(loads)
    worst = max(
        np.abs(np.diff(solution.x.reshape(3, 3))[0] - 1).max(), np.abs(solution.y[::3] - [1, 0, -1]).max()
    )
    ours = f"steps of {VOLTS:g} V, equal to {max(VOLTS * worst, 1e-14):.0e} V"
    yield ("fig. 8", "one element at a time, 3×3, r = 150", "steps of 3 V", ours, "none")


def two_points(r=R_OHM):
    """(reported x, x of an ideal centre, x on a straight line) for each load on the left."""
    loads = np.zeros((len(LEFT_N), 3, 3))
    loads[:, 1, 2], loads[:, 1, 0] = HELD_N, LEFT_N
    return Mesh(3, 3, r).solve(loads).x, (HELD_N - LEFT_N) / (HELD_N + LEFT_N), 1 - LEFT_N / HELD_N


def shares():
    x, centre, straight = two_points()
    half = list(LEFT_N).index(1.5)
    ours = f"{x[half]:.3f} of the half range at 1.5 N ({VOLTS * x[half]:.2f} V), {x[-1]:.3f} at 3 N"
    why = (
        f"a line gives {straight[half]:g} at 1.5 N; eq. 24 gives (3-F)/(3+F) = {centre[half]:.3f}, since "
        f"the total also grows, and the layers' drop reduces it by {centre[half] - x[half]:.3f}"
    )
    what = "3 N on the right, 0 to 3 N on the left, r = 150"
    published = "proportional to the left load; 0 V when equal"
    yield ("fig. 9", what, published, ours, why)


def cycle(count=1000, turns=2):
    """(time_s, force, reported load) of the middle element over cycles of load, with the rubber's
    hysteresis."""
    time_s = np.arange(count * turns) / count / CYCLE_HZ
    force_n = CYCLE_N * (0.5 - 0.5 * np.cos(2 * np.pi * CYCLE_HZ * time_s))
    loads = np.zeros((len(time_s), 3, 3))
    loads[:, 1, 1] = disturbances.hysteresis(force_n, HYSTERESIS)
    return time_s, force_n, Mesh(3, 3, R_OHM).solve(loads).load


def loop():
    time_s, force_n, load = cycle()
    half = len(time_s) // 4
    up, down = load[2 * half : 3 * half], load[3 * half :][::-1]
    at = np.argmin(np.abs(force_n[2 * half : 3 * half] - CYCLE_N / 2))
    ours = f"0 to {CYCLE_N:g} N, chosen: at {CYCLE_N / 2:g} N {up[at]:.2f} N rising, {down[at]:.2f} N falling"
    what = "load output over a cycle of 0.2 Hz on the middle, amplitude not printed"
    yield (
        "fig. 7",
        what,
        "rising and falling differ (loop)",
        ours,
        f"{NONE}, since the curve has no readable scale",
    )


def pressed(shape, gone):
    """(elements present, solution, gains of x and y, position errors, position errors with the gains) for
    presses on one element at a time while the elements ``gone`` are missing. Errors are shares of the range:
    with the complete mesh's constants, and with a gain for each axis fitted to the same presses."""
    m, n = shape
    there = np.ones(shape, bool)
    for at in gone:
        there[at] = False
    places = np.argwhere(there)
    load = np.zeros((len(places), m, n))
    load[np.arange(len(places)), *places.T] = HELD_N
    found, (_, x, y) = CutMesh(Mesh(m, n, R_OHM), there).solve(load), mesh_loads.true_centre(load)
    gains = [(seen @ true) / (seen @ seen) for seen, true in ((found.x, x), (found.y, y))]
    plain = np.hypot(found.x - x, found.y - y) / 2
    fitted = np.hypot(gains[0] * found.x - x, gains[1] * found.y - y) / 2
    return there, found, gains, plain, fitted


def bare_rows():
    """5×5 with every second row and column without rubber: the others report as on a complete mesh."""
    rubber = np.ones((5, 5), bool)
    rubber[1::2] = rubber[:, 1::2] = False
    mesh = Mesh(5, 5, R_OHM)
    load = np.zeros((2, 5, 5))
    load[:, 2, 4], load[:, 0, 0], load[0, 1, 1] = 3.0, 2.0, 4.0
    found, whole = CutMesh(mesh, rubber=rubber).solve(load), mesh.solve(load[1])
    off = max(abs(found.x[0] - whole.x), abs(found.y[0] - whole.y))
    ours = f"loads on rubber as on the complete mesh, to {max(off, 1e-12):.0e}; 4 N on a bare one: no effect"
    what = "elements without rubber: every second row and column of 5×5 bare"
    yield ("fig. 5 (b), before V", what, "possible: r_p is infinite there", ours, "none")


def cut_rows():
    *_, plain, fitted = pressed(*CUTS["3×3, a corner"])
    ours = (
        f"one corner missing: errors up to {100 * plain.max():.0f} % of the range with the complete mesh's "
        f"constants, {100 * fitted.max():.1f} % with a gain fitted for each axis"
    )
    published = "can be cut from the sheet; no error is given"
    yield ("VIII, figs. 13, 14", "elements cut out, 3×3, r = 150", published, ours, "the table below")


def others():
    _, _, settled_s = blow(0.5)
    what, published = "position output after a blow", "settles in about 0.6 ms, mostly due to the rubber"
    ours = f"at once; {1e3 * settled_s:.2f} ms with a conductance at rest of 0.5 N in addition to 5 N"
    yield ("fig. 10", what, published, ours, "see [shear_and_mesh](shear_and_mesh.md)")
    what, ours = "a finger draws a circle on a covered sensor", "the mesh paper's figure 15"
    yield ("fig. 11", what, "a locus (curve)", ours, "see [shear_and_mesh](shear_and_mesh.md)")
    what, ours = "25×5 elements for walking", "a walk over 25×5 taxels, scanned: `meissner run walk_25x5`"
    yield ("fig. 14", what, "works", ours, "not four wires")


def table():
    rows = []
    for name, (shape, gone) in CUTS.items():
        _, found, gains, plain, fitted = pressed(shape, gone)
        rows.append(
            (
                name,
                f"{100 * plain.mean():.1f} / {100 * plain.max():.1f} %",
                f"{gains[0]:.3f}, {gains[1]:.3f}",
                f"{100 * fitted.mean():.2f} / {100 * fitted.max():.2f} %",
                f"{found.load.min():.2f} to {found.load.max():.2f} N",
            )
        )
    text = (
        "Each element in turn under 3 N, r = 150. Where nodes are missing, a coordinate is no longer "
        "harmonic (eq. 6), and a layer conducts less between its electrodes, so eq. 16 and 17 with the "
        "complete mesh's constants report positions too far out. A gain for each axis, found by pressing "
        "each element once, corrects this. It does not correct that an element whose path to one electrode "
        "is cut is reported near the other: such a sheet must be cut evenly, its edges rewired, or its "
        "positions looked up in a table. Loads are those of eq. 26. `meissner.physics.mesh.cut` solves the "
        "remaining mesh."
    )
    header = "cut out", "position error, mean / worst", "gain for x, y", "with it", "load of 3 N"
    yield section("Elements cut from the sheet (net, VIII)", text, header, rows)


def compute():
    rows = [*loop(), *one_at_a_time(), *shares(), *others(), *bare_rows(), *cut_rows()]
    return [section("A Net-Structure Tactile Sensor", HEAD), *rows, *table()]


def draw(folder):
    drawn, axes = figure(2)
    _, force_n, load = cycle()
    half = len(load) // 2
    axes[0].plot(force_n[half:], load[half:], lw=2)
    label(axes[0], "force (N)", "load output (N)", "fig. 7: 0.2 Hz", legend=False)
    x, centre, straight = two_points()
    axes[1].plot(LEFT_N, VOLTS * straight, "k:", lw=1.5, label="proportional")
    axes[1].plot(LEFT_N, VOLTS * centre, lw=2, label="(3-F)/(3+F)")
    axes[1].plot(LEFT_N, VOLTS * x, "o", ms=7, label="reported")
    label(axes[1], "load on the left (N)", "position output (V)", "fig. 9: 3 N on the right")
    caption = "Load output over a cycle with the rubber's hysteresis (figure 7); two points (figure 9)"
    pictures = [(save(drawn, folder, "net_loads.png"), caption)]

    drawn, axes = figure(3, height=3.9)
    for axis, name in zip(axes, ("3×3, a corner", "3×3, the middle", "3×3, all four corners")):
        there, found, gains, _, _ = pressed(*CUTS[name])
        rows, columns = np.nonzero(there)
        axis.plot(columns - 1, 1 - rows, "s", ms=16, mfc="none", mec="#999999", label="elements")
        axis.plot(found.x, found.y, "x", ms=9, mew=2, label="reported")
        axis.plot(gains[0] * found.x, gains[1] * found.y, "o", ms=7, label="with a gain")
        axis.set_aspect("equal")
        label(axis, "x", "y", name.removeprefix("3×3, ") + " gone", legend=False)
    axes[0].legend(frameon=False, fontsize=11, loc="upper center", bbox_to_anchor=(0.5, -0.25))
    caption = "Each element in turn under 3 N, on sheets with elements cut out (figure 13)"
    pictures.append((save(drawn, folder, "net_cut.png"), caption))
    return pictures
