"""Extremes of the mesh solvers: ratios from 1e-12 to 1e12, loads of one part in 65535."""

from fractions import Fraction

import numpy as np

from extremes.rows import row
from meissner.physics.mesh import Mesh, correction
from meissner.physics.mesh.cut import CutMesh
from reference import network

MESH = [
    f"model/meissner/physics/mesh/{name}.py"
    for name in ("mesh", "solution", "green", "groups", "circuit", "contacts", "spread_out", "constants")
]
DOUBLE = np.finfo(float).eps


def ratio_of(power):
    """The power of two nearest to a power of ten, so that stored values are not rounded."""
    return 2.0 ** round(power * np.log2(10))


def loads(m, n):
    """Newtons: one taxel, all, one at 1 and all others at 65536, one LSB in one corner, opposite corners."""
    one, corner = np.zeros((m, n)), np.zeros((m, n))
    one[m // 2, n // 2] = 4.0
    uneven = np.full((m, n), 65536.0)
    uneven[0, 0] = 1.0
    corner[0, -1] = 2.0**-20
    both = corner.copy()
    both[-1, 0] = 1024.0
    return {
        "one": one,
        "all": np.full((m, n), 4.0),
        "1 beside 65536": uneven,
        "corner": corner,
        "corners": both,
    }


def solved(see, solver, powers, must=True):
    """Every value compared with exact fractions, and within the bound that the solution itself states.

    ``must``: each scene must be valid and accurate to 1e-13; otherwise it may report that it is not valid.
    """
    sizes = [(1, 1), (1, 4), (4, 1), (2, 2), (2, 3)] + ([(3, 3), (4, 3)] if see.long else [])
    for one in see.covering(
        size=sizes, rp=powers, r0=[-9, 0, 9], load=["one", "all", "1 beside 65536", "corner", "corners"]
    ):
        (m, n), load = one["size"], loads(*one["size"])[one["load"]]
        R0, k = 1024.0, 4096.0
        # r over the rubber's resistance at the most loaded taxel.
        r = ratio_of(one["rp"]) * k / load.max()
        R0 = R0 * ratio_of(one["r0"]) if one["rp"] == 0 else R0
        mesh = Mesh(m, n, r, R0, 16.0, k)
        got = mesh.solve(load, solver)
        for name, value, (across, along) in (("Cx", mesh.Cx, (m, n)), ("Cy", mesh.Cy, (n, m))):
            c = (
                (2 * across * Fraction(R0) / Fraction(r) + along + 1) / (along - 1)
                if along > 1
                else Fraction(0)
            )
            see.near(
                value / max(mesh.Cx, mesh.Cy, 1),
                c / Fraction(max(mesh.Cx, mesh.Cy, 1)),
                name,
                "its own bound",
                limit=4 * Fraction(DOUBLE),
            )
        place = f"{m} x {n}, r/rp 1e{one['rp']}, R0/r {R0 / r:.0e}, {one['load']}"
        if not got.valid:
            see.same((bool(got.why), bool(must)), (True, False), place, "its own bound")
            continue
        e1, e2, e3, e4, x, y, force = network.mesh(m, n, r, R0, 16.0, k, load.tolist())
        if must:
            see.near(got.x, x, place, "x, y")
            see.near(got.y, y, place, "x, y")
            see.near(Fraction(got.load) / force, 1, place, "load")
        bound = got.bound
        for name, value in (
            ("x", x),
            ("y", y),
            ("load", force),
            ("E1", e1),
            ("E2", e2),
            ("E3", e3),
            ("E4", e4),
        ):
            stated = Fraction(float(getattr(bound, name)))
            see.near(
                getattr(got, name),
                value,
                f"{name}, {place}",
                "its own bound",
                limit=stated + abs(value) * Fraction(DOUBLE),
            )


@row("mesh, fast", {"x, y": "1e-13", "load": "1e-13", "its own bound": "what bound says and 2^-52"})
def mesh_fast(see):
    solved(see, "fast", list(range(-12, 13, 1 if see.long else 4)))


@row("mesh, auto", {"x, y": "1e-13", "load": "1e-13", "its own bound": "what bound says and 2^-52"})
def mesh_auto(see):
    solved(see, "auto", list(range(-12, 13, 1 if see.long else 6)))
    mesh = Mesh(3, 2, 10.0)
    for name, load in (
        ("none", np.zeros((3, 2))),
        ("below doubles", np.full((3, 2), 5e-324)),
        ("all shorts", np.full((3, 2), 1e12)),
        ("least", np.full((3, 2), 1e-300)),
    ):
        got = mesh.solve(load)
        values = [
            got.E1,
            got.E2,
            got.E3,
            got.E4,
            got.x,
            got.y,
            got.load,
            got.current,
            *got.bound,
            got.condition,
        ]
        see.same(
            bool(np.isfinite(values).all() and np.isfinite(got.Va).all() and np.isfinite(got.Vb).all()),
            True,
            name,
            "x, y",
        )
        see.same(bool(got.valid) is not bool(got.why), True, name, "x, y")
    for bad in (*(np.full((3, 2), bad) for bad in (-1.0, np.nan, -np.inf, np.inf, 1.1e12)), np.zeros((2, 3))):
        see.refused(mesh.solve, bad)
    for given in (
        (0, 2, 10.0),
        (3, 2, 0.0),
        (3, 2, np.inf),
        (3, 2, np.nan),
        (3, 2, -1.0),
        (3, 2, 10.0, 0.0),
        (3, 2, 10.0, 1e4, 0.0),
    ):
        see.refused(Mesh, *given)
    if see.long:
        largest(see)


def largest(see):
    """1024 x 1024: single points and a pair of mirrored ones, whose positions are known exactly by
    symmetry."""
    mesh = Mesh(1024, 1024, 10.0)
    for i, j in ((0, 0), (511, 512), (1023, 0), (100, 900)):
        load = np.zeros((1024, 1024))
        load[i, j] = 5.0
        got = mesh.solve(load)
        see.near(got.x, Fraction(2 * j - 1023, 1023), (i, j), "x, y", limit=Fraction("1e-11"))
        see.near(got.y, Fraction(1023 - 2 * i, 1023), (i, j), "x, y", limit=Fraction("1e-11"))
    load = np.zeros((1024, 1024))
    load[[0, 1023], [0, 1023]] = 3.0
    got = mesh.solve(load)
    see.near(got.x, 0, "opposite corners", "x, y", limit=Fraction("1e-11"))


@row("mesh, lu", {"its own bound": "what bound says and 2^-52"})
def mesh_lu(see):
    solved(see, "lu", list(range(-12, 13, 1 if see.long else 4)), must=False)


@row("mesh, constant", {"x, y": "1e-15", "load": "1e-15"})
def mesh_constant(see):
    """Eq. 25 has no voltage drop: the centre and the sum of the forces themselves."""
    for m, n in ((1, 1), (1, 5), (4, 3), *([(41, 41)] if see.long else [])):
        for power in range(-12, 13, 4):
            for name, load in loads(m, n).items():
                got = Mesh(m, n, ratio_of(power), 1024.0, 16.0, 4096.0).solve(load, "constant")
                total, along, across = (Fraction(0),) * 3
                for (i, j), force in np.ndenumerate(load):
                    total += Fraction(force)
                    along += (2 * j - (n - 1)) * Fraction(force)
                    across += ((m - 1) - 2 * i) * Fraction(force)
                place = f"{m} x {n}, r 1e{power}, {name}"
                see.near(got.x, along / ((n - 1) * total) if n > 1 else 0, place, "x, y")
                see.near(got.y, across / ((m - 1) * total) if m > 1 else 0, place, "x, y")
                see.near(Fraction(got.load) / total, 1, place, "load")
    got = Mesh(2, 2, 1.0, k=5e-324).solve([[1e12, 1.0], [0, 0]], "constant")
    see.same((bool(got.valid), got.x, got.load), (False, 0.0, 0.0), "a short", "load")


@row("mesh, iterated", {"x, y": "1e-12", "load": "1e-12"})
def mesh_iterated(see):
    """Against the fast solver's own dense system where both can run, and where symmetry gives the
    position."""
    from meissner.physics.mesh import mesh as engine

    for power in (-12, -6, 0, 3) if see.long else (-6, 0):
        m, n = 12, 9
        mesh, load = Mesh(m, n, 4096.0 / 4 * ratio_of(power), 1024.0, 16.0, 4096.0), loads(m, n)
        for name in ("all", "1 beside 65536"):
            dense = mesh.solve(load[name], "fast")
            kept, engine.DENSE = engine.DENSE, 10
            try:
                got = mesh.solve(load[name], "fast")
            finally:
                engine.DENSE = kept
            place = f"r/rp 1e{power}, {name}"
            see.same(bool(got.valid), True, place, "x, y")
            see.near(got.x, Fraction(dense.x), place, "x, y")
            see.near(got.y, Fraction(dense.y), place, "x, y")
            see.near(got.load / dense.load, 1, place, "load")
            if name == "all":
                see.near(got.x, 0, place, "x, y")


@row("mesh, cut", {"x, y": "2^-46 (Cx + r/rp + (r + rp)/R0)", "load": "2^-46 (Cx + r/rp + (r + rp)/R0)"})
def mesh_cut(see):
    there = np.ones((3, 3), bool)
    there[0, 0] = False
    for power in range(-6, 7, 2 if see.long else 3):
        for name, load in loads(3, 3).items():
            mesh = Mesh(3, 3, 4096.0 / load.max() * ratio_of(power), 1024.0, 16.0, 4096.0)
            felt = np.where(there, load, 0.0)
            got = CutMesh(mesh, elements=there).solve(load[None])
            place = f"r/rp 1e{power}, {name}, a corner cut"
            wanted = network.mesh(3, 3, mesh.r, 1024.0, 16.0, 4096.0, felt.tolist(), {(0, 0)})
            if wanted[4] is None:
                see.same((bool(got.valid[0]), float(got.load[0])), (False, 0.0), place, "load")
                continue
            rubber_ohm = 4096.0 / load.max()
            lost = mesh.Cx + mesh.r / rubber_ohm + (mesh.r + rubber_ohm) / mesh.R0
            room = 64 * Fraction(DOUBLE) * Fraction(lost)
            if not got.valid[0]:
                see.same(
                    (float(got.x[0]), float(got.load[0]), room > Fraction(1, 1000)),
                    (0.0, 0.0, True),
                    place,
                    "load",
                )
                continue
            see.near(got.x[0], wanted[4], place, "x, y", limit=room)
            see.near(got.y[0], wanted[5], place, "x, y", limit=room)
            see.near(Fraction(float(got.load[0])) / wanted[6], 1, place, "load", limit=room)


@row("mesh, correction", {"": "1e-12 of the load"})
def mesh_correction(see):
    """F = Kf N / (D - N p): the result of apply against rationals, up to where the factor saturates."""
    p = [0.5, -0.25, 0.125, 0.0625, -0.5, 0.25]
    for one in see.covering(
        x=[-1.0, 0.0, 2.0**-30, 1.0],
        y=[-1.0, 0.0, 1.0],
        load=[0.0, 2.0**-30, 1.0, 1e6, 1e300],
        kf=[2.0**-20, 1.0, 2.0**30],
    ):
        x, y, load, kf = (Fraction(value) for value in one.values())
        X, Y = x * x, y * y
        terms = [1, X, Y, X * X, X * Y, Y * Y]
        left = 1 - load / kf * sum(Fraction(c) * term for c, term in zip(p, terms))
        wanted = load / max(left, Fraction(1, 16))
        got = correction.Correction(np.array(p), np.zeros(3), np.zeros(3), one["kf"]).apply(
            one["x"], one["y"], one["load"]
        )[2]
        # 1 - load p/Kf cancels; the error grows by the ratio of its terms to the result.
        grown = (1 + load / kf * sum(abs(Fraction(c)) for c in p)) / max(left, Fraction(1, 16))
        see.near(
            Fraction(float(got)),
            wanted,
            one,
            limit=wanted * min(grown, 10**3) * Fraction(16 * DOUBLE) if wanted else 0,
        )
