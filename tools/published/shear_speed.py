"""The resolution of msn_shear_speed: error by table bits, effect of one converter LSB, latency on the rubber.

    python tools/published/shear_speed.py                    the three tables of docs/shear_speed.md
    python tools/published/shear_speed.py --plot FILE        also plot the effect of one LSB over Vi
    python tools/published/shear_speed.py --area [BITS ...]  only LUTs and Fmax by table bits, ECP5

All without noise. The rubber is that of meissner.physics.rubber; its Vc rises as 1 - exp(-3 x / 0.01 mm).
"""

import argparse

import numpy as np

from meissner.physics import rubber
from meissner.tradeoff.axes.shear import PER_V, PRECISIONS, RATE_HZ, size_of
from meissner.tradeoff.axes.shear import worst as error
from meissner.twins.slip.shear_speed import RISING, ShearSettings, ShearSize, ShearSpeed

MCP3208 = 4096 / 5
CLOCKS = 58  # latency of msn_shear_speed with any tables; tb/slip/test_shear_speed.py counts them


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


def plot(path):
    """Plot the effect of one code over Vi: 10 to 16 bits at 1 mm/s, and 12 bits at the ends of the range."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3.6), layout="constrained")
    axes = figure.subplots()
    vi = np.linspace(2, 4, 101)
    for bits, v, style in ((10, 1.0, "-"), (12, 0.01, ":"), (12, 1.0, "-"), (12, 3.0, "--"), (16, 1.0, "-")):
        share = [one_lsb(each, v, (1 << bits) / 5) for each in vi]
        axes.semilogy(vi, share, style, label=f"{bits} bits, {v:g} mm/s")
    axes.axhline(2, color="0.6", linewidth=0.8)
    axes.set(xlabel="Vi, V", ylabel="one code, % of v", title="What one LSB of the converter allows")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", ncols=2)
    figure.savefig(path, dpi=120)


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


def area(tables, widths):
    """Rows of LUTs, registers, multipliers and MHz on ECP5 with one seed; ``widths``: sample bits."""
    import fmax

    (fmax.ROOT / fmax.OUT).mkdir(parents=True, exist_ok=True)
    for table_bits in tables:
        for bits in widths:
            name = f"shear_speed-{bits}-{table_bits}"
            size = {"SampleBits": bits, "TableBits": table_bits, "FractionBits": PRECISIONS[table_bits]}
            fmax.TABLE[name] = ("msn_shear_speed", size, None, "ecp5")
            yield table_bits, bits, fmax.measure(name, "ecp5", (1,))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--area", type=int, nargs="*", choices=PRECISIONS, help="table bits; none: all")
    parser.add_argument("--sample-bits", type=int, nargs="+", default=[17], help="of --area")
    parser.add_argument("--plot", metavar="FILE", help="what one LSB allows, as a picture")
    options = parser.parse_args()
    if options.plot:
        plot(options.plot)
    if options.area is not None:
        print("| table bits | sample bits | LUTs | registers | multipliers | block RAM | MHz | clocks |")
        print("|---|---|---|---|---|---|---|---|")
        for table_bits, bits, found in area(options.area or PRECISIONS, options.sample_bits):
            used = found["area"]
            print(
                f"| {table_bits} | {bits} | {used['lut']} | {used['ff']} | {used['dsp']} | {used['ram']} ",
                f"| {found['mhz_worst']:.0f} | {CLOCKS} |",
                sep="",
                flush=True,
            )
        return
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
