"""Extremes of the physics of arrays and pads: registers of four wires, FSR, capacitances, dielectrics."""

from fractions import Fraction

import mpmath
import numpy as np

from extremes.rows import row
from meissner.physics import capacitive, dielectric, fsr
from meissner.physics.adc import Adc
from meissner.physics.cop4_registers import cop4_registers
from meissner.physics.mesh import Mesh
from meissner.twins.cop.cop4 import cop4
from reference import exact, network

DOUBLE = np.finfo(float).eps


@row("cop4 registers", {"x, y": "1/2 LSB and |x| (1/8 + 8192/N)", "load": "1/2 LSB and load (1/2kf + 1/2N)"})
def cop4_registers_(see):
    """docs/cop4.md: the core's numbers against the formula on the same codes, r/R0 from 1e-12 to 1e12."""
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


@row("fsr", {"": "2^-49 of the supply times the largest cell over the weakest line's end"})
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
        # The elimination of rows subtracts: digits are lost by the ratio of the cells' conductance to the
        # lines' ends'.
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


@row("capacitive", {"a tab's height": "1e-12", "the voltage": "1e-12"})
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


@row("dielectric", {"": "1e-9"})
def dielectric_(see):
    """Forces converted there and back: the inverse of the tab's law, and the published cases of a flat
    sheet."""
    for tab in (0.25, 0.75):
        for grams in (1e-3, 0.1, 1.0, 100.0, 150.0, 1e4, 1e6):
            share = float(dielectric.rise(grams, tab))
            # The inverse magnifies the error: digits of u are lost as 1 - u.
            see.near(
                float(dielectric.force_for(share, tab)) / grams,
                1,
                (tab, grams),
                limit=Fraction(1, 10**9) if grams > 0.5 else Fraction(1, 10**6),
            )
        see.same(np.isinf(dielectric.force_for(1 + tab / 0.25, tab)).item(), True, (tab, "beyond any force"))
    for stress in (0.0, 1e-6, 1.0, 1e6):
        see.near(dielectric.strain_confined(stress, 0.5, 1.0), 0, (stress, "keeps its volume"))
    for ohm in (1e-3, 1.0, 1e5, 1e12, np.inf):
        leak = mpmath.mpf(0) if np.isinf(ohm) else 1 / (2 * mpmath.pi * 200_000 * mpmath.mpf(ohm))
        wanted = 10 * mpmath.sqrt(mpmath.mpf(capacitive.CELL_F) ** 2 + leak**2) / mpmath.mpf(capacitive.REF_F)
        see.near(float(dielectric.leaking_v(10.0, 2e5, ohm)) / wanted, 1, ohm)
