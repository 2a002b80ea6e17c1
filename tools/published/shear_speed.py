"""The resolution of msn_shear_speed: error by table bits, effect of one converter LSB, latency on the rubber.

    python tools/published/shear_speed.py       the three tables of docs/shear_speed.md

All without noise. The rubber is that of meissner.physics.rubber; its Vc rises as 1 - exp(-3 x / 0.01 mm).
"""

import numpy as np

from meissner.physics import rubber
from meissner.tradeoff.axes.shear import PER_V, PRECISIONS, RATE_HZ, size_of
from meissner.tradeoff.axes.shear import worst as error
from meissner.twins.slip.shear_speed import RISING, ShearSettings, ShearSize, ShearSpeed

MCP3208 = 4096 / 5


def precision():
    """Rows of the precision table: table bits, ROM bits, errors in per cent, bound."""
    for table_bits, fraction_bits in PRECISIONS.items():
        size = size_of(table_bits, fraction_bits)
        word = 2 * fraction_bits - table_bits + 5
        by_registers, true, most = error(size)
        half = 0.5 / (1 << size.speed_fraction) / 0.01  # output LSB at the lowest speed
        yield (
            table_bits,
            fraction_bits,
            word << table_bits,
            100 * by_registers,
            100 * true,
            100 * (most + half),
        )


def one_lsb(vi, v=1.0, per_v=MCP3208):
    """Change of v in per cent for one more code in the rise: 1 / (n dV), dV in codes."""
    rise = rubber.shear_gain(vi) * v**0.11 * per_v
    return 100 * ((1 + 1 / rise) ** (1 / 0.11) - 1)


def latency(vi, v, travel=0.01, size=None):
    """(seconds to the first speed, worst error in per cent during the shear), after 0.5 s of rest."""
    size = size or ShearSize()
    settings = ShearSettings.of(PER_V, RATE_HZ, size, travel=travel)
    length = max(0.06 / v, 0.06)
    time = np.arange(0, 0.5 + length, 1 / RATE_HZ)
    level = vi + rubber.shear_gain(vi) * rubber.shear_level(time, np.where(time > 0.5, v, 0.0))
    found, flags = ShearSpeed(settings, size).process(np.rint(level * PER_V).astype(int))
    good = np.flatnonzero(flags == 0)
    assert not len(good) or not (flags[good[0] :] & ~RISING).any()
    off = np.abs(found[good] / (1 << size.speed_fraction) / v - 1).max()
    return (good[0] + 1) * (1 << size.window_log2) / RATE_HZ - 0.5, 100 * off


def main():
    print("| table bits | fraction bits | bits of a ROM | arithmetic, % of v | with the registers' | bound |")
    print("|---|---|---|---|---|---|")
    for row in precision():
        print("| {} | {} | {} | {:.4f} | {:.4f} | {:.4f} |".format(*row))
    print("\n| Vi | dV at 1 mm/s | one code of an MCP3208 | at 0.01 mm/s | one code of 16 bits |")
    print("|---|---|---|---|---|")
    for vi in (2.0, 2.5, 3.0, 3.5, 4.0):
        coarse, slow, fine = one_lsb(vi), one_lsb(vi, 0.01), one_lsb(vi, per_v=PER_V)
        step = float(rubber.shear_gain(vi))
        print(f"| {vi} V | {step:.3f} V | {coarse:.2f} % of v | {slow:.2f} % | {fine:.3f} % |")
    print("\n| speed | Vi | travel register | first speed after | of travel | worst error |")
    print("|---|---|---|---|---|---|")
    for travel, v, vi in [(0.01, v, vi) for v in (0.01, 0.05, 0.1, 1.0, 2.9) for vi in (2.0, 4.0)] + [
        (travel, 0.05, 2.0) for travel in (0.0, 0.0025, 0.005)
    ]:
        after, off = latency(vi, v, travel)
        print(f"| {v} mm/s | {vi} V | {travel} mm | {after:.3f} s | {after * v:.4f} mm | {off:.2f} % |")


if __name__ == "__main__":
    main()
