"""Extremes of the blocks whose own tests do not reach both ends of the range against exact numbers."""

from fractions import Fraction

import mpmath

from extremes.rows import row
from meissner.twins.common import exp2
from meissner.twins.frontend import tare
from meissner.twins.slip import shear_speed
from reference import exact
from reference.shear import within
from reference.tare import TareReference

HALF = mpmath.mpf("0.5")


@row("exp2", {"": "1/2 LSB and 0.0000166 of the result at the default size, exact at whole exponents"})
def exp2_(see):
    tables = [(3, 4), (3, 17), (4, 12), (6, 7), (6, 16), (6, 20), (8, 9), (8, 16), (8, 22)]
    outs = [(24, 20), (32, 0), (32, 32), (2, 0), (2, 32), (8, 16)]
    for one in see.covering(table=see.some(tables, 2), out=outs):
        (table, fraction), (out, point) = one["table"], one["out"]
        whole, top, (low, high) = 1 << fraction, 2**out - 1, exact.signed(32)
        numbers = {low, low + 1, high, high - 1, *(see.random.randint(low, high) for _ in range(40))}
        for k in range(-34, 34) if see.long else (-33, -32, -21, -20, -1, 0, 1, 3, 4, 11, 12, 31, 32, 33):
            near = (-1, 0, 1, whole >> 1, whole >> table, (whole >> table) // 2)
            numbers |= {k * whole + off for off in near}
        numbers = sorted(y for y in numbers if low <= y <= high)
        below = mpmath.mpf(2) ** -fraction * 3 / 8 + mpmath.mpf(2) ** -29
        above = mpmath.mpf(2) ** -fraction / 8 + mpmath.mpf(2) ** -29 + mpmath.mpf("0.0601") / 4**table
        for y, number in zip(numbers, exp2.exp2(numbers, table, fraction, out, point).tolist()):
            place = f"{y} / 2^{fraction}, table {table}, to {out} bits, {point} of fraction"
            power = Fraction(y, whole) + point
            if power > out + 1:
                see.near(number, top, place, limit=0)
                continue
            exponent = mpmath.mpf(power.numerator) / power.denominator
            value = mpmath.power(2, exponent) if power > -80 else mpmath.mpf(0)
            limits = value * below + HALF, value * above + HALF
            see.between(number, min(value, mpmath.mpf(top)), *limits, place)
            see.same(number <= top, True, place)
            if y % whole == 0 and power > -80:
                see.near(number, min(exact.half_up(Fraction(2) ** int(power)), top), place, limit=0)


@row("tare", {"": "0"})
def tare_(see):
    """Zeros one step before either end, with steps of 127.5 codes: beyond a sample's bits, and back."""
    for bits, fraction in ((2, 7), (8, 1), (9, 1), (13, 4), (17, 1), (18, 1)):
        low, high = exact.signed(bits)
        for start in (low, low + 1, 0, high - 1, high):
            for raws in ([high] * 4, [low] * 4, [high, low] * 2, [low, high, high, high]):
                twin = tare.Tare(1, 1, 1, bits, fraction, 0, contact=2**18, step=255)
                loop = TareReference(1, fraction, 0, 2**18, 255, bits)
                twin.next([[[0]]])
                loop.frame([0], [False])
                twin._zero[:] = (start << fraction) + 1
                loop.zeros = [start + Fraction(1, 2**fraction)]
                for frame in range(24):
                    if frame in (9, 14):
                        twin.tare(force=True)
                        loop.tare(force=True)
                    raw = raws[frame % 4]
                    place = f"{bits} bits, fraction {fraction}, from {start}, {raws}, frame {frame}"
                    see.near(twin.next([[[raw]]])[0, 0, 0], loop.frame([raw], [False])[0], place)
                    if frame == 8:
                        see.near(int(twin._zero[0, 0]), loop.zeros[0] * 2**fraction, place)


def settings(size, **given):
    """Registers that raise no flag, so that only the formula is tested."""
    half = 2 ** (size.level_bits - 1)
    widest = {"vi_min": -half, "vi_max": half - 1, "full": 2 ** (size.sample_bits - 1) - 1}
    quiet = {"noise": 0, "still": 0, "limit": 2**size.speed_bits - 1, "travel": 0}
    return shear_speed.ShearSettings(**{"k0": half // 4, "k1": 0} | widest | quiet | given)


@row("shear_speed", {"": "0.0005 of v and 1/2 LSB at the default size"})
def shear_speed_(see):
    """v for dV from 1 LSB to full scale, k from 1 to full scale, 1/n from 0 to its greatest value."""
    wide = {"sample_bits": 24, "window_log2": 12, "settle_log2": 8, "speed_bits": 32, "speed_fraction": 0}
    for given in (
        {},
        {"table_bits": 3, "fraction_bits": 10, "speed_bits": 32, "speed_fraction": 16},
        {"table_bits": 8, "fraction_bits": 20} | wide,
        {"sample_bits": 4, "window_log2": 1, "settle_log2": 2, "speed_fraction": 24},
        {"speed_bits": 8, "speed_fraction": 32},
    ):
        size = shear_speed.ShearSize(**given)
        top, fastest = 2**size.level_bits, 2**size.speed_bits - 1
        ends = sorted({1, 2, 3, top // 8, top // 2 - 1, top // 2, top - 2, top - 1, top})
        exponents = [0, 1, 2047, 2048, 2049, 18618, 65534, 65535]
        for one in see.some(see.covering(rise=ends, k=ends[:-1], exponent=exponents), 4):
            got = shear_speed.speed(one["rise"], one["k"], settings(size, exponent=one["exponent"]), size)
            value = mpmath.power(mpmath.mpf(one["rise"]) / one["k"], mpmath.mpf(one["exponent"]) / 2**11)
            value *= mpmath.mpf(2) ** size.speed_fraction
            share = within(one["exponent"], size.level_bits, size.table_bits, size.fraction_bits)
            target = min(value, mpmath.mpf(fastest))
            limit = min(value, 2 * target) * share + HALF
            see.near(int(got), target, lambda: f"{given or 'default'}, {one}", limit=limit)
            see.same(0 <= got <= fastest, True, one)
