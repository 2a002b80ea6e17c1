"""Extremes of rtl/common: each width at its ends, against integers, fractions and 50 digits."""

from fractions import Fraction

import hypothesis.strategies as st
import mpmath

from extremes.rows import row
from meissner.twins.common import arithmetic, divide, exp2, hypot, log2, ratio
from reference import exact


@row("constant_multiplier", {"": "0"})
def constant_multiplier_(see):
    constants = [0, 1, 2, 3, 63, 64, 65, 0x5555, 0xAAAA, 32767, 32768, 32769, 65534, 65535]
    for one in see.covering(Constant=constants, InBits=[1, 2, 16, 28, 36, 46, 47]):
        numbers = exact.ends(0, 2 ** one["InBits"] - 1)
        got = arithmetic.constant_multiplier(numbers, one["Constant"])
        wanted = [sum(x << k for k in range(16) if one["Constant"] >> k & 1) for x in numbers]
        see.all_near(got.tolist(), wanted, [(one["Constant"], x) for x in numbers])
    see.elaborates("constant_multiplier", see.covering(Constant=constants, InBits=[1, 2, 16, 36, 47]))
    for constant in (-1, 65536):
        see.refused(arithmetic.constant_multiplier, 1, constant)


@row("multiply", {"": "0"})
def multiply_(see):
    for one in see.covering(AWidth=[2, 3, 17, 18], BWidth=[1, 2, 16, 17]):
        pairs = [
            (a, b)
            for a in exact.ends(*exact.signed(one["AWidth"]))
            for b in exact.ends(0, 2 ** one["BWidth"] - 1)
        ]
        got = arithmetic.multiply(*zip(*pairs), one["AWidth"], one["BWidth"])
        see.all_near(got.tolist(), [sum(a for _ in range(b)) if b < 9 else a * b for a, b in pairs], pairs)
    see.elaborates("multiply", see.covering(AWidth=[2, 18], BWidth=[1, 17]))
    for widths in ((1, 16), (19, 16), (18, 0), (18, 18)):
        see.refused(arithmetic.multiply, 1, 1, *widths)


@row("round_sat", {"": "1/2 LSB"})
def round_sat_(see):
    """The bound applies to values that fit; others saturate exactly."""

    def check(numbers, width, out, drop, unsigned):
        low, high = (0, 2**out - 1) if unsigned else exact.signed(out)
        got = arithmetic.round_sat(numbers, width, out, drop, unsigned).tolist()
        for x, y in zip(numbers, got):
            value = Fraction(x, 2**drop)
            place = f"{x} of {width} bits, {drop} dropped, to {out} {'unsigned' if unsigned else 'signed'}"
            see.near(y, exact.held(value, Fraction(low), Fraction(high)), place)
            see.near(y, exact.held(exact.half_up(value), low, high), place, limit=0)

    def fits(InWidth, OutWidth, DropBits, Unsigned):
        return DropBits < InWidth and OutWidth <= InWidth - DropBits + 1 - Unsigned

    widths = [2, 3, 9, 16, 24, 36, 52, 53, 62, 63]
    for one in see.covering(
        fits, InWidth=widths, OutWidth=[1, 2, 16, 17, 32, 62], DropBits=[1, 2, 8, 16, 31, 61], Unsigned=[0, 1]
    ):
        width, out, drop, unsigned = one.values()
        low, high = exact.signed(width)
        top = 2 ** (out + drop - (not unsigned))
        numbers = set(exact.ends(low, high))
        for edge in (0, 1 << drop, top, -top):  # exactly half, and one to either side
            numbers |= {
                edge + half + off for half in (0, 1 << drop - 1, -(1 << drop - 1)) for off in (-1, 0, 1)
            }
        check(sorted(x for x in numbers if low <= x <= high), width, out, drop, bool(unsigned))
        if width < 63:
            see.refused(arithmetic.round_sat, high + 1, width, out, drop, bool(unsigned))
            see.refused(arithmetic.round_sat, low - 1, width, out, drop, bool(unsigned))
    for width, out, drop in ((8, 4, 0), (8, 4, 8), (8, 0, 2), (8, 8, 2)):
        see.refused(arithmetic.round_sat, 0, width, out, drop)

    def drawn(width, share, cut, unsigned, number):
        drop = 1 + share % (width - 1)
        out = 1 + cut % (width - drop + 1 - unsigned)
        low, high = exact.signed(width)
        check([low + number % (high - low + 1)], width, out, drop, unsigned)

    integers = st.integers(0, 2**63)
    see.given(
        drawn, width=st.integers(2, 63), share=integers, cut=integers, unsigned=st.booleans(), number=integers
    )


def quotients(top):
    """Numerators and denominators at the ends: 0, 1, halves, ties, one less than the denominator, equal to
    it."""
    dens = {1, 2, 3, 4, top // 3 or 1, top // 2 or 1, top // 2 + 1, top - 1 or 1, top}
    pairs = {(num, den) for den in dens for num in (0, 1, den // 3, den // 2, (den + 1) // 2, den - 1, den)}
    return sorted({(s * num, den) for num, den in pairs if 0 <= num <= den <= top for s in (-1, 1)})


@row("divide", {"": "1/2 LSB"})
def divide_(see):
    def check(pairs, fraction):
        got = divide.divide(*zip(*pairs), fraction).tolist()
        for (num, den), quotient in zip(pairs, got):
            value = Fraction(num * 2**fraction, den)
            see.near(quotient, value, lambda: f"{num} / {den}, {fraction} bits")
            see.near(quotient, exact.away(value), lambda: f"{num} / {den}, {fraction} bits", limit=0)

    for one in see.covering(DenBits=[1, 2, 16, 34, 46, 53, 61, 62], FractionBits=[1, 2, 14, 20, 29, 30]):
        check(quotients(2 ** one["DenBits"] - 1), one["FractionBits"])
    sizes = see.covering(DenBits=[1, 2, 46, 62], FractionBits=[1, 2, 30], BitsPerClock=[1, 2])
    see.elaborates("divide", sizes)
    for num, den in ((1, 0), (0, 0), (2, 1), (-2, 1), (1, -1), (2**62 - 1, 2**62 - 2)):
        see.refused(divide.divide, num, den)
    for fraction, rate in ((0, 2), (31, 2), (14, 0), (14, 3)):
        see.refused(divide.steps, fraction, rate)
    see.given(
        lambda den, num, fraction: check([(num % (2 * den + 1) - den, den)], fraction),
        den=st.integers(1, 2**62 - 1),
        num=st.integers(0, 2**64),
        fraction=st.integers(1, 30),
    )


@row("ratio", {"": "1/2 LSB"})
def ratio_(see):
    def check(scale, cases, fraction):
        got = ratio.ratio(scale, *zip(*cases), fraction).tolist()
        for (num, den), quotient in zip(cases, got):
            product = scale * num
            sign = Fraction((product > 0) - (product < 0))
            value = exact.held(Fraction(product, den), Fraction(-1), Fraction(1)) if den > 0 else sign
            place = f"{scale} * {num} / {den}, {fraction} bits"
            see.near(quotient, value * 2**fraction, place)
            see.near(quotient, exact.away(value * 2**fraction), place, limit=0)

    for one in see.covering(
        ScaleBits=[1, 2, 17, 31, 32],
        NumBits=[2, 3, 18, 31, 32],
        DenBits=[2, 3, 34, 61, 62],
        FractionBits=[1, 14, 16, 30],
    ):
        nums = exact.ends(*exact.signed(one["NumBits"]))
        dens = exact.ends(*exact.signed(one["DenBits"]))
        for scale in see.some(exact.ends(0, 2 ** one["ScaleBits"] - 1), 4):
            # The product equals the divisor, is one below it and one above it.
            products = {scale * num + off for num in nums for off in (-1, 0, 1)}
            fit = [p for p in products if abs(p) < 2 ** (one["DenBits"] - 1)]
            check(scale, [(num, den) for num in nums for den in {*dens, *fit[:6]}], one["FractionBits"])
    sizes = {"ScaleBits": [1, 32], "NumBits": [2, 32], "DenBits": [2, 62], "FractionBits": [1, 30]}
    see.elaborates("ratio", see.covering(**sizes, BitsPerClock=[1, 2]))
    see.refused(ratio.ratio, -1, 1, 1)
    for width in ({"scale_bits": 0}, {"scale_bits": 33}, {"num_bits": 1}, {"num_bits": 33}, {"den_bits": 63}):
        see.refused(ratio.check_bits, **width)
    see.given(
        lambda scale, num, den, fraction: check(scale, [(num, den)], fraction),
        scale=st.integers(0, 2**32 - 1),
        num=st.integers(*exact.signed(32)),
        den=st.integers(*exact.signed(62)),
        fraction=st.integers(1, 30),
    )


@row("hypot", {"the root": "1 LSB", "the estimate": "2.99 % and 1 LSB"})
def hypot_(see):
    """The root is the floor, so less than one LSB low; the estimate's error is that of docs/demod.md."""

    def check(pairs):
        got = zip(hypot.hypot(*zip(*pairs)).tolist(), hypot.hypot(*zip(*pairs), exact=False).tolist())
        for (a, b), (whole, rough) in zip(pairs, got):
            square = a * a + b * b
            see.near(whole, exact.root(square), (a, b), "the root", limit=0)
            size = mpmath.sqrt(square)
            see.near(whole, size, (a, b), "the root")
            share = [size * mpmath.mpf(end) for end in ("0.0299", "0.0078")]
            see.between(rough, size, share[0] + 1, share[1], (a, b), "the estimate")

    for bits in (1, 2, 13, 26, 27, 28, 29, 30):
        numbers = exact.ends(0, 2**bits - 1)
        check([(a, b) for a in numbers for b in numbers])
    # A square and one less, where a root in doubles is wrong.
    roots = [2**30 - 1 - k for k in range(40)] + [2**k + off for k in range(2, 30) for off in (-1, 0, 1)]
    check([(r, b) for r in roots for b in (0, 1, 2) if 0 <= r < 2**30])
    # (2 k^2 + 1)^2 - 1 = (2 k^2)^2 + (2 k)^2: one less than a square, which doubles round up to the square.
    check([(2 * k * k, 2 * k) for k in (1, 2, 100, 9742, 9743, *range(23_130, 23_171))])
    for a, b in ((-1, 0), (0, 2**30), (2**30, 0)):
        see.refused(hypot.hypot, a, b)
    for bits in (0, 31):
        see.refused(hypot.latency, bits)
    see.elaborates("hypot", see.covering(Bits=[1, 2, 29, 30], Exact=[0, 1]))
    see.given(lambda a, b: check([(a, b)]), a=st.integers(0, 2**30 - 1), b=st.integers(0, 2**30 - 1))


TABLES = [(3, 4), (3, 17), (4, 12), (6, 7), (6, 16), (6, 20), (8, 9), (8, 16), (8, 22)]


def log2_bound(in_bits, table, fraction):
    """The largest errors below and above that the header allows."""
    lsb = mpmath.mpf(2) ** -fraction
    above = lsb * 5 / 8 + mpmath.mpf(2) ** -29
    below = above + lsb / 4 + mpmath.mpf("0.1804") / 4**table
    if in_bits - 1 - table > 17:
        below += mpmath.mpf("1.4427") * mpmath.mpf(2) ** -(table + 17)
    return below, above


@row("log2", {"": "0.0000576 at the default size, exact at powers of two"})
def log2_(see):
    def check(numbers, in_bits, table, fraction):
        below, above = log2_bound(in_bits, table, fraction)
        got = log2.log2(numbers, in_bits, table, fraction).tolist()
        for x, y in zip(numbers, got):
            place = f"{x} of {in_bits} bits, table {table}, fraction {fraction}"
            see.between(Fraction(y, 2**fraction), exact.log2(x), below, above, place)
            if x & (x - 1) == 0:
                see.near(Fraction(y, 2**fraction), max(x.bit_length() - 1, 0), place, limit=0)

    sizes = [size for size in TABLES] if see.long else TABLES[::2]
    for table, fraction in sizes:
        for in_bits in sorted({table + 2, 27, 47, 48}):
            numbers = {0, 1, 2, 3, *exact.ends(0, 2**in_bits - 1)}
            for place in range(in_bits):  # each exponent: both ends, the middle of the first and last chord
                one = 1 << place
                step = max(1, one >> table)
                numbers |= {one, one + 1, 2 * one - 1, one + step // 2, one + step, one + step - 1}
                numbers |= {2 * one - step, 2 * one - step + step // 2}
            check(sorted(x for x in numbers if x < 2**in_bits), in_bits, table, fraction)
    see.near(log2_bound(27, 6, 16)[0], Fraction("0.0000576"), "the header's formula", limit=Fraction("5e-8"))
    tables = [{"TableBits": table, "FractionBits": fraction} for table, fraction in TABLES]
    see.elaborates("log2", [size | {"InBits": bits} for size in tables for bits in (10, 48)])
    for bad in ((27, 2, 16), (27, 9, 16), (27, 6, 6), (27, 6, 21), (7, 6, 16), (49, 6, 16)):
        see.refused(log2.log2, 1, *bad)
    see.given(
        lambda x, size: check([x], 48, *size), x=st.integers(0, 2**48 - 1), size=st.sampled_from(TABLES)
    )


@row("exp2", {"": "1/2 LSB and 0.0000166 of the result at the default size, exact at whole exponents"})
def exp2_(see):
    def check(numbers, table, fraction, out, point):
        lsb = mpmath.mpf(2) ** -fraction
        below = lsb * 3 / 8 + mpmath.mpf(2) ** -29
        above = lsb / 8 + mpmath.mpf(2) ** -29 + mpmath.mpf("0.0601") / 4**table
        top = 2**out - 1
        got = exp2.exp2(numbers, table, fraction, out, point).tolist()
        for y, number in zip(numbers, got):
            place = f"{y} / 2^{fraction}, table {table}, to {out} bits, {point} of fraction"
            power = Fraction(y, 2**fraction) + point
            if power > out + 1:
                see.near(number, top, place, limit=0)
                continue
            value = (
                exact.power(2, mpmath.mpf(power.numerator) / power.denominator)
                if power > -80
                else mpmath.mpf(0)
            )
            half = mpmath.mpf("0.5")
            see.between(
                number, min(value, mpmath.mpf(top)), value * below + half, value * above + half, place
            )
            see.same(number <= top, True, place)
            if y % 2**fraction == 0 and power > -80:
                see.near(
                    number, min(exact.half_up(Fraction(2) ** (y // 2**fraction + point)), top), place, limit=0
                )

    outs = [(24, 20), (32, 0), (32, 32), (2, 0), (2, 32), (8, 16)]
    for one in see.covering(table=TABLES if see.long else TABLES[::2], out=outs):
        (table, fraction), (out, point) = one["table"], one["out"]
        whole = 1 << fraction
        low, high = -(2**31), 2**31 - 1
        numbers = {low, low + 1, high, high - 1, 0, 1, -1, whole - 1, 1 - whole}
        for k in range(-34, 34) if see.long else (-33, -32, -21, -20, -1, 0, 1, 3, 4, 11, 12, 31, 32, 33):
            numbers |= {
                k * whole + off for off in (-1, 0, 1, whole >> 1, whole >> table, (whole >> table) // 2)
            }
        check(sorted(y for y in numbers if low <= y <= high), table, fraction, out, point)
    ends = see.covering(table=TABLES, WholeBits=[2, 12], OutBits=[2, 32], OutFraction=[0, 32])
    for size in ends:
        size["TableBits"], size["FractionBits"] = size.pop("table")
    see.elaborates("exp2", ends)
    for bad in ((6, 16, 1, 0), (6, 16, 33, 0), (6, 16, 24, 33), (6, 16, 24, -1), (2, 16), (6, 21)):
        see.refused(exp2.exp2, 0, *bad)
    see.given(
        lambda y, size, out: check([y], *size, *out),
        y=st.integers(-(2**31), 2**31 - 1),
        size=st.sampled_from(TABLES),
        out=st.sampled_from(outs),
    )
