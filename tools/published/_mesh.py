"""A High-Speed Mesh of Tactile Sensors Fitting Arbitrary Surfaces: its part of page ``shear_and_mesh``."""

import dataclasses

import numpy as np

from meissner import scenes
from meissner.budget import cop4
from meissner.physics import mesh_loads
from meissner.physics.mesh import Mesh
from meissner.scenes.mesh import run as mesh_run
from meissner.scenes.mesh.run import circle
from published import section
from published._parts import NONE, figure, label, percent, save, signed
from published.mesh_figures import errors

HEAD = """The mesh's equations are solved exactly, so these are the circuit's own errors; `meissner budget
--cop4` shows the errors that a converter adds ([cop4.md](../cop4.md)). Position errors are distances as a
fraction of the range from -1 to 1; the paper does not state how it normalises its own. Figures 1 to 4 and 12
are drawings and photographs and have no row."""

DRAWS = 1000  # the paper has 100; with 1000 the averages of our tables vary by less than their last digit
R_OVER_RP = {  # table I
    5: (0.0115, 0.0544, 0.1157, 0.1736),
    10: (0.02315, 0.01088, 0.2315, 0.3472),
    15: (0.03472, 0.1632, 0.3472, 0.5208),
    20: (0.04630, 0.2178, 0.4629, 0.6944),
}
PUBLISHED_S = 0.6e-3  # figure 13
REST_N = (0.0, 0.05, 0.5, 5.0)  # nine taxels together, in addition to 5 N
RATE_HZ = 500_000  # for the table and picture of figure 13
RADII = (0.6, 0.8, 1.0, 1.2, 1.4, 1.5, 1.6, 2.0, 3.0)  # of the hemisphere
R0_OHM = (1e3, 3e3, 10e3, 30e3, 100e3)
INSIDE = "inside"


def drops():
    """The effect of the layers' own voltage drop with one and with three points."""
    found = []
    for r in mesh_loads.SIX_R:
        scene = mesh_loads.cop_one_point(r)
        solution = scene.mesh.solve(scene.load, "lu")
        found.append(solution.E1[0] - solution.Va.min())
    over = f"{100 * (found[0] / 0.02 - 1):+.0f} %, unexplained"
    what = "drop in layer A, 5 N in the middle of 41×41, r = 10"
    yield ("fig. 5", what, "below 0.02 V", f"{found[0]:.4f} V", over)
    load = np.zeros((41, 41))
    at = (10, 10, 30), (10, 30, 20)
    load[at] = 5 / 3
    solution = Mesh(41, 41, 10.0).solve(load, "lu")
    lost = 1e3 * (solution.E1 - solution.E2 - (solution.Va - solution.Vb)[at])
    ours = f"{lost.min():.1f} to {lost.max():.1f} mV less than between the electrodes"
    what = "voltage at three loaded places, 5 N together, r = 10"
    yield ("fig. 6", what, "falls where loaded (surface)", ours, NONE)
    depth = ", ".join(f"{drop:.3f}" for drop in found)
    yield ("fig. 7", "fig. 5 for r = 10, 47, 100, 150", "grows with r (curve)", f"{depth} V", NONE)


def six_points():
    for split in ("equal", "random"):
        found = [
            errors(mesh_loads.cop_six_random(10.0, t, DRAWS, split=split)) for t in mesh_loads.SIX_TOTALS
        ]
        position, load = zip(*found)
        what = f"six random points, {split} shares, r = 10, 5 to 20 N"
        mean, worst = 100 * position[-1].mean(), 100 * np.max(position)
        inside = INSIDE if worst <= 0.5 else f"mean {INSIDE}, worst +{worst - 0.5:.2f} points"
        ours = f"mean {mean:.3f} %, worst {worst:.2f} %"
        yield ("fig. 8", f"{what}: position", "within 0.5 %", ours, inside)
        mean = 100 * load[-1].mean()
        inside = INSIDE if mean <= 2 else f"+{mean - 2:.2f} points"
        yield ("fig. 9", f"{what}: load", "within 2 %", f"{percent(load[-1])} % at 20 N", inside)
    r = 0.05 * mesh_loads.K_PAPER / 5
    place, load = errors(mesh_loads.cop_six_random(r, 5.0, DRAWS))
    ours = f"at 0.05 (5 N, r = {r:.1f}): position {percent(place, 3)} %, load {percent(load)} %"
    what = "errors with r/rp below 0.05, six points"
    yield ("IV-C", what, "sufficient accuracy", ours, "none: no number is given")


def two_points():
    scene = mesh_loads.cop_two_point()
    solution, (_, x, _) = scene.mesh.solve(scene.load), scene.truth()
    off = np.abs(solution.x - solution.y).max()
    along = np.abs(solution.x - x).max()  # of the half range, on each axis
    ours = f"on it to {max(off, 1e-15):.0e}; along it at most {100 * along / np.sqrt(2):.2f} % off "
    ours += f"({along:.3f} of the half range on each axis)"
    what = "two points, 5×5, r = 47, 10 N"
    yield ("fig. 10", what, "on the straight line (curve)", ours, "none seen")
    scene = mesh_loads.cop_load()
    solution = scene.mesh.solve(scene.load)
    ours = f"{solution.load[10]:.2f} N of 10, {solution.load[20]:.2f} N of 20"
    what = "two equal loads, 5×5, r = 47"
    yield ("fig. 11", what, "lags as load grows (curve)", ours, NONE)


def resolved(r0_ohm, bits=16, load_n=5.0):
    """(one code of E1-E3 as a share of the range, I R0 in volts) for one point on 41×41, r = 10."""
    found = cop4.budget(Mesh(41, 41, 10.0, r0_ohm), bits, 1.0, load_n)["loads"]
    row = next(row for row in found if row["load_n"] == load_n)
    return row["x"]["step"], row["n_v"]


def series_resistor():
    scene = mesh_loads.cop_six_random(150.0, 20.0)
    reports = np.array([Mesh(41, 41, 150.0, R0).solve(scene.load).load for R0 in (1e3, 1e4, 1e5)])
    moved = f"load moves by {100 * np.abs(reports / reports[1] - 1).max():.1f} % from 1 to 100 kΩ"
    yield ("IV-D", "R0 and the errors of position and load", "not affected", moved, "none of note")
    steps = {r0: resolved(r0)[0] for r0 in (1e3, 10e3)}
    ours = (
        f"one code of 16 bits is {100 * steps[10e3]:.2f} % of the range at 10 kΩ, "
        f"{100 * steps[1e3]:.3f} % at 1 kΩ"
    )
    what = "R0 and signal to noise: position, 5 N on one of 41×41, r = 10"
    yield ("IV-D", what, "falls as R0 grows", ours, "agrees; no number is given")


def blow(rest_n, response_s=PUBLISHED_S):
    """(time_s, x, Recording) of 5 N at the right edge of 3×3; ``rest_n``: the taxels' conductance at rest."""
    scene = scenes.load("cop_impulse_place")
    scene = dataclasses.replace(
        scene, rate_hz=RATE_HZ, world=scene.world | {"rest_n": rest_n / 9, "response_s": response_s}
    )
    (recording,) = scenes.simulate(scene)
    solution = recording.solution
    return recording, solution.x, mesh_run._position_response_s(recording, solution.x, solution.y)


def rubber_for(rest_n):
    """The rubber's response time (95 %) with which the position settles in the published time; None if none.

    The settling time is a share of the rubber's that depends only on ``rest_n``, so one division gives it.
    """
    settled_s = blow(rest_n)[2]
    return PUBLISHED_S**2 / settled_s if settled_s > 2 / RATE_HZ else None


def impulse():
    load_s = mesh_run._response_s(blow(0.0)[0], blow(0.0)[0].solution.load)
    at_rest = {rest_n: blow(rest_n)[2] for rest_n in REST_N}
    ours = f"load {1e3 * load_s:.2f} ms; position from the first sample of {1e6 / RATE_HZ:.0f} µs"
    why = (
        "nothing conducts before the blow, and the common time constant of all taxels cancels in the "
        "quotient of eq. 27: the position itself has no transient"
    )
    what = "position output after a blow, 3×3, r = 47"
    yield ("fig. 13", what, "settles in about 0.6 ms", ours, why)
    some = "; ".join(f"{rest_n:g} N: {1e3 * at_rest[rest_n]:.2f} ms" for rest_n in REST_N[1:])
    what = "the same with taxels that conduct at rest; their total is given as a load"
    why = "a position that settles in 0.6 ms then needs a rubber slower than 0.6 ms: the table below"
    yield ("fig. 13", what, "settles in about 0.6 ms", some, why)


def covers():
    """{radius of the hemisphere: locus of a circle of radius 0.5} (figures 14, 15)."""
    found = {}
    for radius in RADII:
        scene = mesh_loads.cop_stroke(steps=720, cover=radius)
        solution = scene.mesh.solve(scene.load)
        found[radius] = circle(solution.x, solution.y), solution
    return found


def stroke():
    locus = covers()[mesh_loads.COVER_RADIUS][0]
    ours = f"for a radius of 0.5, chosen: a circle of {locus['radius']:.4f}, "
    ours += f"out of round by {100 * locus['roundness']:.3f} %"
    what = "a finger draws a circle, of no stated radius, on a hemisphere over 3×3, r = 47"
    apart = f"{NONE}; depends on the cover, below"
    yield ("figs. 14, 15", what, "a neat locus (curve)", ours, apart)


def tables():
    rows = []
    for force, printed in R_OVER_RP.items():
        ours = [r * force / mesh_loads.K_PAPER for r in mesh_loads.SIX_R]
        cells = (f"{p:g} / {o:.4f} ({signed(p - o)})" for p, o in zip(printed, ours))
        rows.append((f"{force} N", *cells))
    text = "It prints 0.01088 for 47 Ω and 10 N, a factor of ten too small, and 0.2178 for 0.2176: misprints."
    header = ("load", *(f"{r:.0f} Ω" for r in mesh_loads.SIX_R))
    yield section("Table I of the mesh, r/rp: printed / ours", text, header, rows)

    titles = "Position error, % of the range (mesh, fig. 8)", "Load error, % (mesh, fig. 9)"
    header = ("r", *(f"{t:.0f} N" for t in mesh_loads.SIX_TOTALS))
    found = six_errors()
    for index, name in enumerate(titles):
        rows = [
            (f"{r:.0f} Ω", *(percent(found[r, t][index], 3 - index) for t in mesh_loads.SIX_TOTALS))
            for r in mesh_loads.SIX_R
        ]
        uneven = errors(mesh_loads.cop_six_random(10.0, 20.0, DRAWS, split="random"))
        place, load = (100 * (u.mean() / e.mean() - 1) for u, e in zip(uneven, found[10.0, 20.0]))
        text = (
            f"Equal shares. With random shares the position errors are {place:.0f} % larger, the load errors "
            f"{load:.0f} %."
        )
        yield section(name, text if not index else "", header, rows)

    rows = []
    for r0 in R0_OHM:
        step, volts = resolved(r0)
        rows.append((f"{r0 / 1e3:g} kΩ", f"{volts:.1f} V", f"{100 * step:.3f} %"))
    text = (
        "One point of 5 N, 41×41, r = 10: one code of 16 bits over ±15.75 V in the difference of two "
        "electrodes."
    )
    header = "R0", "I R0", "one code, of the range"
    yield section("R0 and what a converter resolves (mesh, IV-D)", text, header, rows)

    rows = []
    for rest_n in REST_N:
        took_s, rubber_s = blow(rest_n)[2], rubber_for(rest_n)
        slower = "none" if rubber_s is None else f"{1e3 * rubber_s:.2f} ms"
        rows.append((f"{rest_n:g} N", f"{1e3 * took_s:.2f} ms", slower))
    text = (
        "A blow of 5 N at the right edge. The centre moves from the middle, where the taxels' conductance "
        "at rest holds it, to the blow: x = f/(f + rest/5 N) with f = 1 - exp(-t/τ) of the force there; τ "
        "is a third of the rubber's time to 95 %. With a high conductance at rest the position settles as "
        "slowly as the load; without any, only a threshold or the divider's own settling can cause a delay."
    )
    header = (
        "conductance at rest, as load",
        "position settles, rubber of 0.6 ms",
        "rubber for 0.6 ms of the position",
    )
    yield section("How the position settles (mesh, fig. 13)", text, header, rows)

    rows = [
        (f"{radius:g}", f"{locus['radius']:.4f}", f"{100 * locus['roundness']:.3g} %")
        for radius, (locus, _) in covers().items()
    ]
    text = (
        "A circle of radius 0.5 on hemispheres of other radii, in units of the half range (a pitch is 1). A "
        "low cover passes the force to the nearest of nine taxels, so the locus is a square turned by 45°; "
        "it is round only near 1.5, the chosen radius, which just covers taxels as wide as their pitch."
    )
    header = "radius of the cover", "radius of the locus", "out of round"
    yield section("The cover and the circle (mesh, figs. 14, 15)", text, header, rows)


def six_errors():
    """{(r, total): (position errors, load errors)} of six equal points."""
    return {
        (r, t): errors(mesh_loads.cop_six_random(r, t, DRAWS))
        for r in mesh_loads.SIX_R
        for t in mesh_loads.SIX_TOTALS
    }


def response():
    what = "response of the circuit, and the number of elements"
    ours = "clock counts at any m, n: docs/results.md"
    yield ("VI-A, VII", what, "below 1 ms, independent of it", ours, "none")


def compute():
    rows = [*drops(), *six_points(), *series_resistor(), *two_points(), *impulse(), *stroke(), *response()]
    return [section("A High-Speed Mesh of Tactile Sensors", HEAD), *rows, *tables()]


def draw(folder):
    found, pictures = six_errors(), []
    drawn, axes = figure(2)
    for axis, index, top in zip(axes, (0, 1), (0.5, 2.0)):
        for r in mesh_loads.SIX_R:
            values = [100 * found[r, t][index] for t in mesh_loads.SIX_TOTALS]
            mean, spread = [v.mean() for v in values], [v.std() for v in values]
            axis.errorbar(mesh_loads.SIX_TOTALS, mean, spread, marker="o", capsize=4, label=f"r = {r:.0f} Ω")
        axis.axhline(top, color="black", lw=1, ls=":", label=f"stated for 10 Ω: {top:g} %")
        title = ("position, fig. 8", "load, fig. 9")[index]
        axis.set_xticks(mesh_loads.SIX_TOTALS)
        label(axis, "total load (N)", "error (%)", title, legend=not index)
    caption = "Errors of six random points (figures 8, 9); dotted: what the paper states for 10 Ω"
    pictures.append((save(drawn, folder, "mesh_errors.png"), caption))

    drawn, axis = figure()
    for rest_n in REST_N:
        recording, x, _ = blow(rest_n)
        end = x[recording.time_s < 0.0035 - 1e-9][-1]
        axis.plot(1e3 * (recording.time_s - 0.0005), 3 * x / end, lw=2, label=f"{rest_n:g} N at rest")
    axis.axvline(0.6, color="black", lw=1, ls=":", label="published: about 0.6 ms")
    axis.set_xlim(-0.2, 1.6)
    label(axis, "time after the blow (ms)", "position output (V)")
    caption = "Position output after a blow, as a share of its end, drawn as 3 V (figure 13)"
    pictures.append((save(drawn, folder, "mesh_impulse.png"), caption))

    drawn, axes = figure(2)
    for radius in (0.8, 1.0, 1.5, 2.0):
        _, solution = covers()[radius]
        ring = np.append(np.arange(720), 0)
        axes[0].plot(solution.x[ring], solution.y[ring], lw=2, label=f"{radius:g}")
    axes[0].set_aspect("equal")
    label(axes[0], "x", "y", "locus, by the cover's radius")
    fine = np.linspace(0.7, 3, 60)
    rounds = []
    for radius in fine:
        scene = mesh_loads.cop_stroke(steps=72, cover=radius)
        solution = scene.mesh.solve(scene.load)
        rounds.append(100 * circle(solution.x, solution.y)["roundness"])
    axes[1].semilogy(fine, rounds, lw=2)
    label(axes[1], "radius of the cover", "out of round (%)", legend=False)
    caption = "A circle drawn on hemispheres (figure 15), and its roundness"
    pictures.append((save(drawn, folder, "mesh_covers.png"), caption))

    drawn, axis = figure(height=3.8)
    many = np.geomspace(300, 1e5, 25)
    axis.loglog(many / 1e3, [100 * resolved(r0)[0] for r0 in many], lw=2)
    for r0 in (1e3, 10e3):
        axis.plot(
            r0 / 1e3,
            100 * resolved(r0)[0],
            "o",
            ms=9,
            label=f"{r0 / 1e3:g} kΩ: {100 * resolved(r0)[0]:.3g} %",
        )
    label(axis, "R0 (kΩ)", "one code (% of range)")
    pictures.append(
        (save(drawn, folder, "mesh_r0.png"), "R0 and what a converter of 16 bits resolves (IV-D)")
    )
    return pictures
