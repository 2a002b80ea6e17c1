"""Extremes of the physics of arrays and pads: registers of four wires, FSR, capacitances, dielectrics."""

from fractions import Fraction

import numpy as np

from extremes.rows import row
from meissner.physics import fsr
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
