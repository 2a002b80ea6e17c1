"""Tables of log2 and exp2 for the speed of shear: their bits against the speed's error."""

from dataclasses import replace

import numpy as np

from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.slip.shear_speed import ShearSettings, ShearSize, bound, denominator, speed

PER_V = 65535 / 5  # codes per volt: signed 17-bit codes over the supply
RATE_HZ = 10_000
PRECISIONS = {3: 10, 4: 12, 5: 14, 6: 16, 7: 18, 8: 20}  # {table bits: matching fraction bits}


def size_of(table_bits, fraction_bits):
    return replace(ShearSize(), table_bits=table_bits, fraction_bits=fraction_bits)


def worst(size):
    """(largest |v / true - 1| for v of the formula with the registers, and of the rubber; the bound)."""
    settings = ShearSettings.of(PER_V, RATE_HZ, size)
    v, vi = np.meshgrid(np.geomspace(0.01, 3.0, 600), np.linspace(2, 4, 201))
    code_vi = np.rint(vi * PER_V * size.unit).astype(np.int64)
    rise = np.rint((1.55 - 0.27 * vi) * v**0.11 * PER_V * size.unit).astype(np.int64)
    k = denominator(code_vi, settings)
    got = speed(rise, k, settings, size) / float(1 << size.speed_fraction)
    by_registers = (rise / k) ** (settings.exponent / 2048)
    return np.abs(got / by_registers - 1).max(), np.abs(got / v - 1).max(), bound(settings.exponent, size)


def error(point):
    by_registers, true, most = worst(size_of(point["table_bits"], point["fraction_bits"]))
    return {"speed": 100 * float(true), "arithmetic": 100 * float(by_registers), "bound": 100 * float(most)}


def cost(point):
    """Bits of the two tables: 2^table_bits words, each with an entry and a step."""
    table, fraction = point["table_bits"], point["fraction_bits"]
    return {"rom_bits": 2 * ((2 * fraction - table + 5) << table)}


AXES = (
    Axis(
        name="shear",
        title="Tables of the speed of shear",
        about="a table has 2^3 to 2^8 entries; the fraction has 1 to 14 bits more than the table's address",
        values={"table_bits": tuple(PRECISIONS), "fraction_bits": (10, 12, 14, 16, 18, 20)},
        shipped={"table_bits": 6, "fraction_bits": 16},
        legal=lambda point: (
            3 <= point["table_bits"] <= 8 and 1 <= point["fraction_bits"] - point["table_bits"] <= 14
        ),
        cost=cost,
        error=error,
        figures=(
            Figure("rom_bits", "both tables", "bits", judged=True),
            Figure("speed", "speed's error, 0.01 to 3 mm/s, largest", "% of v", judged=True),
            Figure("arithmetic", "of this the arithmetic's", "% of v"),
            Figure("bound", "its bound, half an LSB of the speed aside", "% of v"),
        ),
        panels=(("rom_bits", "speed"),),
    ),
)
