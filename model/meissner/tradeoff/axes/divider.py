"""Division of the centre of pressure: fraction bits and bits per clock, against the error."""

import numpy as np

from meissner.physics import mesh_loads
from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.common.divide import steps
from meissner.twins.cop.cop import cop_divide, moments

SIDE, CONTACTS, SEED = 64, 6, 1


def error(point):
    """Reported position less the exact quotient, of the range 2, in frames with six pressed taxels."""
    totals = np.geomspace(1, 300_000, point["frames"])  # sum of all six, each up to 65535
    forces = np.rint(mesh_loads.random_points(SIDE, SIDE, CONTACTS, totals, SEED)).astype(np.int64)
    s, mx, my = (np.asarray(each) for each in moments(forces))
    bits = point["fraction_bits"]
    x, y, valid = cop_divide(s, mx, my, SIDE, SIDE, bits)
    away = [
        np.abs(got[valid] / 2.0**bits - moment[valid] / ((SIDE - 1) * s[valid]))
        for got, moment in ((x, mx), (y, my))
    ]
    return {"position": 50 * float(np.max(away)), "position_mean": 50 * float(np.mean(away))}


def cost(point):
    bits, per_clock = point["fraction_bits"], point["bits_per_clock"]
    return {"clocks": 3 + steps(bits, per_clock), "out_bits": bits + 2}


def placed(point):
    bits = point["fraction_bits"]  # the tools' table places some of these
    return (f"cop-64x64-q{bits}-turn{point['bits_per_clock']}", "ecp5") if bits in (4, 14, 20) else None


AXES = (
    Axis(
        name="divider",
        title="Division of the centre of pressure",
        about="the fraction has 4 to 20 bits, one or two computed per clock",
        values={"fraction_bits": (4, 6, 8, 10, 12, 14, 16, 18, 20), "bits_per_clock": (1, 2)},
        shipped={"fraction_bits": 14, "bits_per_clock": 2},
        runs={"frames": (2000, 500)},
        legal=lambda point: 4 <= point["fraction_bits"] <= 20 and point["bits_per_clock"] in (1, 2),
        cost=cost,
        error=error,
        placed=placed,
        figures=(
            Figure("clocks", "last taxel to position, 64×64", "clocks", judged=True),
            Figure("position", "position's error, largest", "% of the range", judged=True),
            Figure("position_mean", "the same, mean", "% of the range"),
            Figure("out_bits", "bits of a coordinate"),
        ),
        panels=(("clocks", "position"),),
    ),
)
