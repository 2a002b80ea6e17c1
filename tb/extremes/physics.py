"""Extremes of the solvers: ratios from 1e-12 to 1e12, loads of one part in 65535, numbers at the ends
of doubles.
"""

from fractions import Fraction

import mpmath
import numpy as np

from meissner import calibration, fit_rubber, interval, second_order
from meissner.physics import capacitive, dielectric, fsr, rubber
from meissner.physics.adc import Adc
from meissner.physics.cop4_registers import cop4_registers
from meissner.physics.mesh import Mesh, correction
from meissner.physics.mesh.cut import CutMesh
from meissner.twins.cop.cop4 import cop4
from reference import exact, network
from verify.extremes import row

MESH = [
    f"model/meissner/physics/mesh/{name}.py"
    for name in ("mesh", "solution", "green", "groups", "circuit", "contacts", "spread_out", "constants")
]
DOUBLE = np.finfo(float).eps


def ratio_of(power):
    """The power of two that is nearest to a power of ten: no rounding in what is stored."""
    return 2.0 ** round(power * np.log2(10))


def loads(m, n):
    """Newtons: one taxel, all, one at 1 beside all at 65536, one LSB in one corner, opposite corners."""
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
    """Every value beside exact fractions, and within the bound that the solution itself states.

    ``must``: each scene has to be valid, and to be good to 1e-13; else it may say that it is not.
    """
    sizes = [(1, 1), (1, 4), (4, 1), (2, 2), (2, 3)] + ([(3, 3), (4, 3)] if see.long else [])
    for one in see.covering(
        size=sizes, rp=powers, r0=[-9, 0, 9], load=["one", "all", "1 beside 65536", "corner", "corners"]
    ):
        (m, n), load = one["size"], loads(*one["size"])[one["load"]]
        R0, k = 1024.0, 4096.0
        # r over the rubber's resistance, that of the most loaded taxel.
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


@row(
    "mesh, fast",
    {"x, y": "1e-13", "load": "1e-13", "its own bound": "what bound says and 2^-52"},
    ends="r/rp 1e-12 to 1e12: every one valid",
    files=MESH,
)
def mesh_fast(see):
    solved(see, "fast", list(range(-12, 13, 1 if see.long else 4)))


@row(
    "mesh, auto",
    {"x, y": "1e-13", "load": "1e-13", "its own bound": "what bound says and 2^-52"},
    ends="r/rp 1e-12 to 1e12: every one valid; no load, bad load: a sentence",
    files=MESH,
)
def mesh_auto(see):
    solved(see, "auto", list(range(-12, 13, 1 if see.long else 6)))
    mesh = Mesh(3, 2, 10.0)
    for name, load in (
        ("none", np.zeros((3, 2))),
        ("below doubles", np.full((3, 2), 5e-324)),
        ("all shorts", np.full((3, 2), np.inf)),
        ("greatest", np.full((3, 2), 1.7e308)),
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
    for bad in (np.full((3, 2), -1.0), np.full((3, 2), np.nan), np.zeros((2, 3)), -np.full((3, 2), np.inf)):
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
    """1024 x 1024: a point at each place that symmetry gives, and its mirror: positions that are known
    exactly.
    """
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


@row(
    "mesh, lu",
    {"its own bound": "what bound says and 2^-52"},
    ends="fewer than three certain digits: not valid, with a sentence",
    files=MESH,
)
def mesh_lu(see):
    solved(see, "lu", list(range(-12, 13, 1 if see.long else 4)), must=False)


@row(
    "mesh, constant",
    {"x, y": "1e-15", "load": "1e-15"},
    ends="a short is refused with a sentence",
    files=MESH,
)
def mesh_constant(see):
    """Eq. 25 has no drop: the centre and the sum of the forces themselves."""
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
    got = Mesh(2, 2, 1.0).solve([[np.inf, 1.0], [0, 0]], "constant")
    see.same((bool(got.valid), got.x, got.load), (False, 0.0, 0.0), "a short", "load")


@row("mesh, iterated", {"x, y": "1e-12", "load": "1e-12"}, ends="2,000 contacts and more", files=MESH)
def mesh_iterated(see):
    """Against the fast solver's own dense system where both may run, and where symmetry gives the
    position.
    """
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


@row(
    "mesh, cut",
    {"x, y": "2^-46 (Cx + r/rp + (r + rp)/R0)", "load": "2^-46 (Cx + r/rp + (r + rp)/R0)"},
    ends="no current: not valid, 0",
    files=["model/meissner/physics/mesh/cut.py", *MESH],
)
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


@row(
    "mesh, correction",
    {"": "1e-12 of the load"},
    ends="the factor is held at 16",
    files=["model/meissner/physics/mesh/correction.py"],
)
def mesh_correction(see):
    """F = Kf N / (D - N p): what apply gives of it, beside rationals, up to where it holds the factor."""
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
        # 1 - load p/Kf cancels: by as much as its terms are larger than it.
        grown = (1 + load / kf * sum(abs(Fraction(c)) for c in p)) / max(left, Fraction(1, 16))
        see.near(
            Fraction(float(got)),
            wanted,
            one,
            limit=wanted * min(grown, 10**3) * Fraction(16 * DOUBLE) if wanted else 0,
        )


@row(
    "cop4 registers",
    {"x, y": "1/2 LSB and |x| (1/8 + 8192/N)", "load": "1/2 LSB and load (1/2kf + 1/2N)"},
    ends="a constant without room in its register: a sentence",
    files=[
        "model/meissner/physics/cop4_registers.py",
        "model/meissner/twins/cop/cop4.py",
        "model/meissner/physics/mesh/constants.py",
    ],
)
def cop4_registers_(see):
    """docs/cop4.md: the core's numbers beside the formula on the same codes, r/R0 from 1e-12 to 1e12."""
    built = 0
    for one in see.covering(
        size=[(2, 2), (5, 5), (41, 41), (3, 7), (1024, 1024)],
        power=list(range(-12, 13, 2)),
        bits=[12, 17, 23],
        k=[1e-3, 4320.0, 1e9],
    ):
        (m, n), bits = one["size"], one["bits"]
        mesh, converter = Mesh(m, n, 10.0 ** one["power"] * 1e4, 1e4, 15.0, one["k"]), Adc(bits, -16.0, 16.0)
        kf = 2 * Fraction(mesh.k) / 10**4
        lsb = float(kf) / 65536 * 4
        try:
            found = cop4_registers(mesh, converter, load_lsb=lsb, min_load=lsb, sample_bits=bits)
        except ValueError as problem:
            see.same(
                any(word in str(problem) for word in ("register", "room", "must lie")),
                True,
                (one, str(problem)),
                "x, y",
            )
            continue
        built += 1
        r, v = Fraction(mesh.r), Fraction(15) * 2**bits / 32
        cx = (2 * m * 10**4 / r + n + 1) / (n - 1)
        rail, half = 2 * v, 1 << bits - 1
        for n_codes in (8, 9, 100, half // 8, half // 2):
            for d in (0, 1, n_codes // 3):
                e = round(v) - n_codes // 2
                codes = [e + d, -(e - 1), e - d, -e]
                if max(map(abs, codes)) >= converter.max_code:
                    continue
                got = cop4([codes], found, bits)
                current = rail - codes[0] - codes[2]
                if not got.pressed[0] or current < 1:
                    continue
                x = exact.held(cx * (codes[0] - codes[2]) / current, Fraction(-1), Fraction(1)) * 16384
                shown = Fraction(1, 2) + abs(x) * (Fraction(1, 8) + 8192 / current) / 1
                see.near(int(got.x[0]), x, f"{one}, N {n_codes}, E1 - E3 {2 * d}", "x, y", limit=shown)
                below = codes[0] + codes[2] - codes[1] - codes[3]
                load = kf * current / below / Fraction(lsb)
                room = Fraction(1, 2) + load * (Fraction(1, 2 * found.kf) + 1 / (2 * current))
                if load < 65535:
                    see.near(int(got.load[0]), load, f"{one}, N {n_codes}", "load", limit=room)
    see.same(built > 3, True, f"{built} sensors have registers", "x, y")


@row(
    "fsr",
    {"": "2^-49 of the supply times the largest cell over the weakest line's end"},
    ends="a line cut off at its end reads 0",
    files=["model/meissner/physics/fsr.py"],
)
def fsr_(see):
    shapes = {
        "even": lambda i, j: 1.0,
        "one": lambda i, j: float((i, j) == (0, 0)),
        "checked": lambda i, j: float((i + j) % 2),
        "far apart": lambda i, j: 2.0 ** (-30 * ((i + j) % 2)),
        "corner": lambda i, j: float((i, j) != (1, 1)),
    }
    for one in see.covering(
        size=[(1, 1), (1, 3), (3, 1), (3, 4)],
        shape=[*shapes],
        siemens=[0.0, 2.0**-40, 2.0**-20, 2.0**-7, 2.0**10],
        driver=[2.0**-10, 4.0, 2.0**20],
        load=[2.0**-1, 2.0**13, 2.0**30],
        circuit=fsr.CIRCUITS,
        unselected=fsr.UNSELECTED,
    ):
        (m, n), shape = one["size"], shapes[one["shape"]]
        siemens = [[one["siemens"] * shape(i, j) for j in range(n)] for i in range(m)]
        readout = fsr.Readout(one["circuit"], one["unselected"], 4.0, one["driver"], one["load"], 0.5)
        got = fsr.column_volts(np.array(siemens), readout)
        column = 1 / Fraction(0.5 if one["circuit"] == "zero potential" else one["load"])
        # The rows' elimination subtracts: what cells have more than the lines' ends is lost in digits.
        room = (
            8
            * Fraction(DOUBLE)
            * (1 + m * n * Fraction(one["siemens"]) / min(column, 1 / Fraction(one["driver"])))
        )
        for driven in range(m):
            wanted = network.matrix_volts(
                siemens, 4, 1 / Fraction(one["driver"]), column, one["unselected"] == "floating", driven
            )
            for j in range(n):
                see.near(
                    got[driven, j] / 4, wanted[j] / 4, lambda: f"{one}, row {driven}, column {j}", limit=room
                )


@row(
    "capacitive",
    {"a tab's height": "1e-12", "the voltage": "1e-12"},
    ends="forces from 0 to 1e6 N; less than 0 is no force",
    files=["model/meissner/physics/capacitive.py"],
)
def capacitive_(see):
    for force in (0.0, 5e-324, 1e-300, 1e-12, 1e-3, 1.0, 1.4709975, 10.0, 1e3, 1e6):
        for tab in see.some((0.25, 0.75, 1e-3), 2):
            for stiffness in see.some((0.1, 1.0, 10.0), 2):
                shape = mpmath.mpf(capacitive.TAB_DIAMETER_MM) / (4 * mpmath.mpf(tab))
                modulus = mpmath.mpf(capacitive.MODULUS_MPA) * (1 + 2 * shape**2)
                area = mpmath.pi / 4 * mpmath.mpf(capacitive.TAB_DIAMETER_MM) ** 2
                q = 3 * mpmath.mpf(force) / (area * modulus * mpmath.mpf(stiffness))
                u = mpmath.mpf(1)
                for _ in range(60):
                    u -= (u**3 + q * u**2 - 1) / (3 * u**2 + 2 * q * u)
                got = capacitive.tab_height(force, stiffness, tab)
                see.near(float(got) / u, 1, (force, tab, stiffness), "a tab's height")
                b = mpmath.mpf(capacitive.BACKING_MM)
                rise = (b + mpmath.mpf(tab)) / (b + mpmath.mpf(tab) * u)
                see.near(
                    float(capacitive.capacitance_ratio(force, stiffness, tab)) / rise,
                    1,
                    (force, tab, "C"),
                    "a tab's height",
                )
    for one in see.covering(
        cell=[1e-18, 1e-12, 1e-6],
        others=[0.0, 1e-12, 1e-6],
        gain=[1e-6, 1.0, 200.0, 1e9, 200j, -1e6j],
        cell_ohm=[1.0, 1e7, np.inf],
        input_ohm=[1.0, 1e12, np.inf],
        hertz=[1e-3, 2e5, 1e9],
    ):
        w, ref = 2j * mpmath.pi * one["hertz"], mpmath.mpf(capacitive.REF_F)
        leak = [
            mpmath.mpf(0) if np.isinf(one[name]) else 1 / mpmath.mpf(one[name])
            for name in ("cell_ohm", "input_ohm")
        ]
        cell = w * mpmath.mpf(one["cell"]) + leak[0]
        rest = w * (mpmath.mpf(one["others"]) + ref) + leak[1]
        gain = mpmath.mpc(one["gain"])
        wanted = abs(10 * gain * cell / (gain * w * ref + cell + rest))
        got = capacitive.output_v(
            one["cell"],
            one["others"],
            one["gain"],
            hertz=one["hertz"],
            cell_ohm=one["cell_ohm"],
            input_ohm=one["input_ohm"],
        )
        see.near(float(got) / wanted, 1, one, "the voltage")


@row(
    "dielectric",
    {"": "1e-9"},
    ends="a rise that no force reaches takes an infinite one, by contract",
    files=["model/meissner/physics/dielectric.py"],
)
def dielectric_(see):
    """Forces there and back: the tab's law turned round, and the published cases of a flat sheet."""
    for tab in (0.25, 0.75):
        for grams in (1e-3, 0.1, 1.0, 100.0, 150.0, 1e4, 1e6):
            share = float(dielectric.rise(grams, tab))
            # What turning back must magnify: u loses its digits as 1 - u.
            see.near(
                float(dielectric.force_for(share, tab)) / grams,
                1,
                (tab, grams),
                limit=Fraction(1, 10**9) if grams > 0.5 else Fraction(1, 10**6),
            )
        see.same(np.isinf(dielectric.force_for(1 + tab / 0.25, tab)).item(), True, (tab, "beyond any force"))
    for stress in (0.0, 1e-6, 1.0, 1e6):
        see.near(dielectric.strain_confined(stress, 0.5, 1.0), 0, (stress, "keeps its volume"))
        see.near(dielectric.strain_free(stress, 2.0), Fraction(stress) / 2, stress)
        see.near(dielectric.lateral_stress(stress, 0.5), Fraction(stress), stress)
    for ohm in (1e-3, 1.0, 1e5, 1e12, np.inf):
        leak = mpmath.mpf(0) if np.isinf(ohm) else 1 / (2 * mpmath.pi * 200_000 * mpmath.mpf(ohm))
        wanted = 10 * mpmath.sqrt(mpmath.mpf(capacitive.CELL_F) ** 2 + leak**2) / mpmath.mpf(capacitive.REF_F)
        see.near(float(dielectric.leaking_v(10.0, 2e5, ohm)) / wanted, 1, ohm)


@row(
    "rubber",
    {"": "2e-14", "the distance slipped": "1e-15"},
    ends="0 N conducts nothing; up to 1e30 N Vc stays within 0 .. 5 V",
    files=["model/meissner/physics/rubber.py"],
)
def rubber_(see):
    for force, volts in rubber.POINTS:
        see.near(float(rubber.rest_volts(force)) / 5, Fraction(volts) / 5, f"published, {force} N")
    forces = np.array([0.0, 5e-324, 1e-300, 1e-12, 0.1, 0.5, 1.0, 1.7, 10.0, 1e6, 1e30])
    volts = rubber.rest_volts(forces)
    see.same(
        bool(np.isfinite(volts).all() and (volts >= 0).all() and (volts <= 5).all()), True, "0 to 1e30 N"
    )
    see.same(bool((np.diff(volts) <= 0).all()), True, "more force, never more volts")
    for vi in (0.0, 2.0, 3.0, 4.0, 4.999, 5.0):
        k = min(
            mpmath.mpf("1.55") - mpmath.mpf("0.27") * mpmath.mpf(vi),
            mpmath.mpf("0.47") * (5 - mpmath.mpf(vi)),
        )
        for speed in (0.0, 5e-324, 1e-12, 0.01, 3.0, 1e6, 1e300):
            wanted = k * mpmath.power(mpmath.mpf(speed), mpmath.mpf("0.11"))
            got = float(rubber.shear_step(vi, speed))
            see.near(
                (got - wanted) / max(abs(wanted), mpmath.mpf("0.1")),
                0,
                (vi, speed),
                limit=Fraction(2, 10**14),
            )
    for q in (0.0, 5e-324, 1e-16, 1e-9, 1e-3, 0.12, 0.5, 0.875, 1 - 2.0**-53, 1.0):
        value = mpmath.mpf("1.5") * (1 - mpmath.power(1 - mpmath.mpf(q), mpmath.mpf(2) / 3)) - mpmath.mpf(q)
        see.near(float(rubber.slipped(q)), value, q, "the distance slipped")
    for q in (-1.0, 2.0, 1e300):
        see.near(float(rubber.slipped(q)), 0 if q < 0 else Fraction(1, 2), q, "the distance slipped")
    for rate in (1e-3, 1e4, 1e9):
        level = rubber.shear_level(np.arange(50) / rate, np.repeat([0.0, 1e-9, 3.0, 1e6, 0.0], 10))
        see.same(bool(np.isfinite(level).all() and (level >= 0).all()), True, f"{rate} Hz")


@row(
    "rubber fit",
    {"": "1e-9"},
    ends="a sentence for steps that do not determine the constants, or whose scatter of 0 leaves no interval",
    files=["model/meissner/fit_rubber.py"],
)
def rubber_fit(see):
    """Steps without noise give their constants back, at the ends of what the check lets through."""
    fits = 0
    for one in see.covering(
        k0=[0.5, 1.55, 100.0],
        k1=[-0.1, 0.0, 0.27],
        n=[0.01, 0.11, 1.0, 4.0],
        slow=[1e-6, 0.01, 1.0],
        ratio=[10.0, 1e3],
    ):
        rest = np.array([2.0, 2.5, 3.0, 3.5, 4.0, 2.2, 3.3, 3.9])
        speed = one["slow"] * np.geomspace(1, one["ratio"], 8)[[0, 7, 3, 5, 1, 6, 2, 4]]
        step = (one["k0"] + one["k1"] * rest) * speed ** one["n"]
        try:
            found = fit_rubber.fit((rest, step, speed))
        except ValueError:  # a sentence; the published constants must not be refused
            see.same((one["k0"], one["k1"], one["n"]) == (1.55, -0.1, 0.11), False, one)
            continue
        fits += 1
        for name, value in zip(("k0", "k1", "n"), found.value):
            see.near(
                float(value),
                Fraction(one[name]),
                lambda: f"{name}, {one}",
                limit=Fraction(1, 10**9) * max(Fraction(one["k0"]), 1),
            )
    see.same(fits >= 8, True, f"{fits} fits")
    good = np.array([2.0, 3.0, 4.0, 2.0, 3.0])
    for bad in (
        (good, good * 0, good),
        (good, good, -good),
        (good, good, good * 0 + 1),
        (good * 0 + 2, good, good),
        (good[:2],) * 3,
    ):
        see.refused(fit_rubber.fit, bad)


@row(
    "second order",
    {"": "1e-9 of the largest"},
    ends="fewer than three forces: 0, never below 0",
    files=["model/meissner/second_order.py"],
)
def second_order_(see):
    for one in see.covering(
        top=[3, 100, 65535], a=[0.0, 1e-6, 5.0], b=[1e-6, 1.0, 1e3], c=[-1e-9, 0.0, 1e-6]
    ):
        forces = np.unique(np.linspace(1, one["top"], 7).astype(int))
        newtons = one["a"] + one["b"] * forces + one["c"] * forces**2.0
        terms = second_order.fit(forces[:, None, None], newtons[:, None, None])
        got = second_order.newtons(forces[:, None, None], terms)[:, 0, 0]
        largest = np.abs(newtons).max()
        for force, value in zip(forces.tolist(), got.tolist()):
            wanted = Fraction(one["a"]) + Fraction(one["b"]) * force + Fraction(one["c"]) * force**2
            see.near(value / largest, max(wanted, 0) / Fraction(largest), lambda: f"{one}, F {force}")
    see.same(
        second_order.fit(np.array([[[1.0]], [[2.0]]]), np.array([[[1.0]], [[2.0]]])).tolist(),
        [[[0.0] * 3]],
        "two forces",
    )
    see.same(
        second_order.newtons(
            np.array([[0, 65535]]), np.array([[[5.0, 1.0, 0.0], [0.0, -1.0, 0.0]]])
        ).tolist(),
        [[0.0, 0.0]],
        "F = 0, below 0",
    )


@row(
    "calibration",
    {"": "1/2 LSB"},
    ends="a gain or offset without room, too few presses: a sentence",
    files=["model/meissner/calibration.py"],
)
def calibration_(see):
    """Lines at the ends of the codes: offset and gain are the nearest integers of the exact line."""
    for one in see.covering(slope=[1, 10, 1000, 20000], rest=[-65536, -1, 0, 1, 32768], shift=[8, 12, 16]):
        slope, rest, shift = one.values()
        newtons = [k / 4 for k in range(5)]  # up to 1 N, in fractions that doubles hold
        if any((slope * k) % 4 for k in range(5)) and slope != 1:
            continue
        scale = 4 if slope == 1 else 1
        codes = np.array([rest + slope * scale * k // 4 for k in range(5)])[:, None, None]
        if codes.max() > 65535:
            see.refused(calibration.check_codes, codes)
            continue
        known = np.array(newtons)[:, None, None]
        try:
            lines, _ = calibration.fit(codes, known, gain_shift=shift)
        except ValueError as problem:
            see.same("gain" in str(problem) or "range" in str(problem), True, (one, str(problem)))
            continue
        see.near(int(lines.offset[0, 0]), rest, one)
        gain = Fraction(2**shift) / (slope * scale * Fraction(lines.force_lsb_n))
        see.near(int(lines.gain[0, 0]), gain, one)
        see.same(0 < int(lines.gain[0, 0]) < 65536, True, one)
    for bad in (
        np.full((5, 1, 1), 65536),
        np.full((5, 1, 1), -65537),
        np.full((5, 1, 1), np.nan),
        np.full((5, 1, 1), 0.5),
    ):
        see.refused(calibration.check_codes, bad)
    for force in (np.nan, np.inf, -1.0):
        see.refused(calibration.cell_forces, np.array([0.0, force]), (2, 1, 1))
    flat = np.zeros((5, 1, 1))
    see.refused(calibration.fit, flat.astype(int), flat)


@row(
    "interval",
    {"": "1e-9 of the tail"},
    ends="0 of any and all of any count end at 0 and at 1",
    files=["model/meissner/interval.py"],
)
def interval_(see):
    """Clopper and Pearson's own condition, with 50 digits: as many or more at the low end are 2.5 %
    likely.
    """
    tail = (1 - mpmath.mpf(interval.CONFIDENCE)) / 2

    def at_least(count, runs, share):
        share = mpmath.mpf(share)
        few = range(count) if count <= runs // 2 else range(count, runs + 1)
        parts = [mpmath.binomial(runs, k) * share**k * (1 - share) ** (runs - k) for k in few]
        return 1 - mpmath.fsum(parts) if count <= runs // 2 else mpmath.fsum(parts)

    for runs in (1, 2, 40, 700 if see.long else 100):
        for count in sorted({0, 1, runs // 3, runs - 1, runs}):
            low, high = interval.exact(count, runs)
            if count:
                see.near(at_least(count, runs, low) / tail, 1, (count, runs, "low"))
            else:
                see.near(low, 0, (count, runs))
            if count < runs:
                see.near((1 - at_least(count + 1, runs, high)) / tail, 1, (count, runs, "high"))
            else:
                see.near(high, 1, (count, runs))
    low, high = interval.exact(10**9, 2 * 10**9)
    see.near(low + high, 1, "half of 2e9")
    for bad in ((1, 0), (-1, 5), (6, 5)):
        see.refused(interval.exact, *bad)


@row(
    "converter",
    {"": "1/2 LSB"},
    ends="held at both ends, with the over-range flag",
    files=["model/meissner/physics/adc.py"],
)
def converter_(see):
    for bits in (1, 8, 12, 16, 24):
        for low, high in ((0.0, 5.0), (-5.0, 5.0), (-10.0, 10.0), (0.0, 1e-6), (-1e6, 1e6)):
            part = Adc(bits, low, high)
            lsb = (Fraction(high) - Fraction(low)) / 2**bits
            volts = [
                low,
                high,
                0.0,
                -1e200,
                1e200,
                -np.inf,
                np.inf,
                5e-324,
                np.nextafter(high, 2 * high),
                np.nextafter(low, low - 1),
            ]
            volts += [
                float(Fraction(low) + lsb * (2 * k + 1) / 2 + off * lsb / 1000)
                for k in (0, 1, 2**bits // 2, 2**bits - 2)
                for off in (-1, 1)
            ]
            codes, over = part.convert(volts)
            for v, code, out in zip(volts, codes.tolist(), over.tolist()):
                value = (
                    Fraction(part.max_code if v > 0 else part.min_code)
                    if np.isinf(v)
                    else (Fraction(v) - Fraction(low)) / lsb + part.min_code
                )
                wanted = exact.held(value, Fraction(part.min_code), Fraction(part.max_code))
                see.near(code, wanted, (bits, low, high, v))
                see.same(out, not low <= v <= high, (bits, low, high, v))
    for bad in (
        (0, 0.0, 1.0),
        (25, 0.0, 1.0),
        (8, 1.0, 2.0),
        (8, 0.0, 0.0),
        (8, -1.0, 2.0),
        (8, 0.0, 1.0, -1.0),
    ):
        see.refused(Adc, *bad)
