"""Extremes of rtl/cop: the longest sums, first moments that cancel, quotients at their ends."""

from fractions import Fraction

import hypothesis.strategies as st
import numpy as np

from extremes.rows import row
from meissner.twins.cop import cop, cop4, cop_slip
from meissner.twins.cop.cop4_correct import CorrectionRegisters, cop4_correct
from meissner.twins.sensor.array_forces import ArrayForces
from reference import exact

TOP = 65535
SIDES = [1, 2, 3, 63, 64, 65, 1023, 1024]


def closed_form(kind, m, n):
    """(forces, S, Mx, My) of frames whose sums are known in closed form."""
    i, j = np.indices((m, n))
    all_x = all_y = 0
    if kind == "full":
        return np.full((m, n), TOP), TOP * m * n, 0, 0
    if kind == "right half":  # the largest moment: sum of 2j - (n-1) over j > n/2
        half = n // 2
        return np.where(j >= n - half, TOP, 0), TOP * m * half, TOP * m * half * (n - half), 0
    if kind == "top half":
        half = m // 2
        return np.where(i < half, TOP, 0), TOP * n * half, 0, TOP * n * half * (m - half)
    if kind == "left half":
        half = n // 2
        return np.where(j < half, TOP, 0), TOP * m * half, -TOP * m * half * (n - half), 0
    if kind == "bottom half":
        half = m // 2
        return np.where(i >= m - half, TOP, 0), TOP * n * half, 0, -TOP * n * half * (m - half)
    if kind == "all but one LSB":  # moments cancel except for one LSB in the last corner
        forces = np.full((m, n), TOP)
        forces[-1, -1] -= 1
        return forces, TOP * m * n - 1, -(n - 1), (m - 1)
    if kind == "corner LSB":
        forces = np.zeros((m, n), int)
        forces[0, -1] = 1
        return forces, 1, n - 1, m - 1
    if kind == "corners":  # opposite corners at full scale cancel
        forces = np.zeros((m, n), int)
        forces[0, 0] += TOP
        forces[-1, -1] = TOP
        same = m == n == 1
        return forces, TOP * (1 if same else 2), 0, 0
    return np.zeros((m, n), int), 0, all_x, all_y


KINDS = (
    "zero",
    "full",
    "right half",
    "left half",
    "top half",
    "bottom half",
    "all but one LSB",
    "corner LSB",
    "corners",
)


@row("cop_accumulate", {"": "0"})
def cop_accumulate_(see):
    def few(m, n):
        return see.long or m * n < 70_000 or (m, n) == (1024, 1024)

    for one in see.covering(m=SIDES, n=SIDES):
        m, n = one["m"], one["n"]
        if not few(m, n):
            continue
        for kind in KINDS if m * n < 10**6 or see.long else ("full", "right half", "all but one LSB"):
            forces, *wanted = closed_form(kind, m, n)
            got = cop.moments(forces)
            for part, value, exactly in zip(("S", "Mx", "My"), got, wanted):
                see.near(int(value), exactly, f"{part} of {m} x {n}, {kind}")
            # docs/cop.md, Widths: the room in the RTL.
            bits = 16 + (m * n - 1).bit_length()
            room = [bits, bits + (n - 1).bit_length(), bits + (m - 1).bit_length()]
            see.same(
                all(abs(v) < 2 ** (b - (k > 0)) or v == 0 for k, (v, b) in enumerate(zip(wanted, room))),
                True,
                f"room for {m} x {n}, {kind}",
            )
    for lanes in (*range(1, 9), 16):
        for m, n in ((1, 1), (3, 5), (2, 9), (16, 15)):
            twin, forces = cop.CopAccumulate(m, n, lanes), closed_form("all but one LSB", m, n)[0]
            padded = np.full((m, -(-n // lanes) * lanes), TOP)  # values in the extra lanes must not count
            padded[:, :n] = forces
            beats = padded.reshape(-1, lanes).tolist()
            [got] = twin.process(beats, [False] * (len(beats) - 1) + [True])
            see.all_near(got, exact.moments(forces.tolist()), [f"{m} x {n}, {lanes} lanes"] * 3)
    see.elaborates(
        "cop_accumulate", see.covering(Rows=[1, 2, 1024], Columns=[1, 2, 1024], Lanes=[1, 2, 7, 16])
    )
    see.refused(cop.moments, [[TOP + 1]])
    see.refused(cop.moments, [[-1]])
    for m, n in ((0, 1), (1, 0), (1025, 1), (1, 1025)):
        see.refused(cop.check_size, m, n)
    see.given(
        lambda frame: see.all_near(map(int, cop.moments(frame)), exact.moments(frame), [frame] * 3),
        frame=st.tuples(st.integers(1, 6), st.integers(1, 6)).flatmap(
            lambda size: st.lists(
                st.lists(st.integers(0, TOP), min_size=size[1], max_size=size[1]),
                min_size=size[0],
                max_size=size[0],
            )
        ),
    )


def centre(see, got, sums, m, n, fraction, least, where):
    """x, y and pressed, against the quotients of docs/cop.md."""
    total, mx, my = sums
    x, y, pressed = (int(value) for value in got)
    holds = total > 0 and total >= least
    see.near(pressed, holds, where, "x, y")
    for value, moment, side in ((x, mx, n), (y, my, m)):
        wanted = Fraction(moment * 2**fraction, (side - 1) * total) if holds and side > 1 else Fraction(0)
        see.near(value, wanted, where, "x, y")
        see.near(value, exact.away(wanted), where, "x, y", limit=0)


@row("cop_divide", {"x, y": "1/2 LSB"})
def cop_divide_(see):
    for one in see.some(see.covering(m=SIDES, n=SIDES, fraction=[4, 5, 14, 19, 20]), 4):
        m, n, fraction = one.values()
        most = TOP * m * n
        cases = [(0, 0, 0)]
        for total in (1, 2, 3, TOP, most - 1, most):
            for share in (-1, 1):
                edge_x, edge_y = share * (n - 1) * total, share * (m - 1) * total
                cases += [
                    (total, edge_x, edge_y),
                    (total, edge_x - share * (n > 1), -edge_y),
                    (total, share * (n > 1), 0),
                ]
                half = (n - 1) * total  # of an LSB: exactly between two codes, if divisible
                cases += [(total, share * (half >> fraction + 1), share * (m > 1))]
        for least in (0, 1, 2, most):
            got = zip(*cop.cop_divide(*zip(*cases), m, n, fraction, least))
            for each, sums in zip(got, cases):
                centre(see, each, sums, m, n, fraction, least, lambda: f"{m} x {n}, {fraction} bits, {sums}")
    sides = {"Rows": [1, 2, 1024], "Columns": [1, 2, 1024]}
    see.elaborates("cop_divide", see.covering(**sides, FractionBits=[4, 20], BitsPerClock=[1, 2]))
    for fraction in (3, 21):
        see.refused(cop.cop_divide, 1, 0, 0, 2, 2, fraction)


@row("cop", {"x, y": "1/2 LSB"})
def cop_(see):
    sizes = [(1, 1), (1, 7), (7, 1), (2, 2), (3, 3), (16, 15)] + (
        [(64, 64), (1024, 1), (1, 1024)] if see.long else []
    )
    for m, n in [*sizes, (1024, 1024)]:
        for kind in KINDS if m * n < 10**5 or see.long else KINDS[1:3]:
            forces, *sums = closed_form(kind, m, n)
            for fraction in (4, 20):
                x, y, load, pressed = cop.cop(forces, fraction)
                centre(see, (x, y, pressed), sums, m, n, fraction, 1, f"{m} x {n}, {kind}")
                see.near(int(load), sums[0], (m, n, kind), "x, y", limit=0)


def registers(gain, shift_gain, offsets, raws):
    return gain, shift_gain, offsets, raws


@row("array_forces", {"x, y": "1/2 LSB"})
def array_forces_(see):
    """A pad with gains and samples at their ends, taxel by taxel, then its centre."""
    low, high = exact.signed(17)
    for one in see.covering(
        size=[(1, 1), (2, 2), (3, 5)],
        gain=[0, 1, 4096, 65535],
        offset=[low, 0, high],
        shift=[1, 12, 16],
        raw=["low", "high", "checked", "LSB"],
    ):
        (m, n), gain, offset, shift, raw = one.values()
        twin = ArrayForces(m, n, gain_shift=shift)
        for word in range(m * n):
            twin.calibrate.table.write(word, offset, gain)
        codes = [
            [
                {"low": low, "high": high, "checked": (low, high)[(i + j) % 2], "LSB": min(offset + 1, high)}[
                    raw
                ]
                for j in range(n)
            ]
            for i in range(m)
        ]
        x, y, load, pressed = twin.cops(twin.calibrate.process(np.array(codes)))
        forces = [
            [exact.held(exact.half_up(Fraction((code - offset) * gain, 2**shift)), 0, TOP) for code in line]
            for line in codes
        ]
        sums = exact.moments(forces)
        centre(see, (x, y, pressed), sums, m, n, 14, 1, one)
        see.near(int(load), sums[0], one, "x, y", limit=0)


NAMES = ("rail", "kx", "shift_x", "ky", "shift_y", "kf", "shift_load", "top", "idle", "busy", "imbalance")


def cop4_ends(bits, kind):
    """Registers of a converter of that many bits: least, greatest, or those of a sensor."""
    half = 1 << bits - 1
    plain = {
        "rail": half,
        "kx": 131071,
        "shift_x": 8,
        "ky": 65536,
        "shift_y": 5,
        "kf": 70000,
        "shift_load": 2,
    }
    plain |= {"top": half - 1, "idle": half - 1, "busy": half - 1, "imbalance": 4 * half - 1, "min_load": 0}
    if kind == "least":
        plain |= dict.fromkeys(("rail", "kx", "ky", "kf", "shift_x", "shift_y", "shift_load"), 0)
    if kind == "greatest":
        plain |= {"rail": 2 * half - 1} | dict.fromkeys(("kx", "ky", "kf"), 131071)
        plain |= dict.fromkeys(("shift_x", "shift_y", "shift_load"), 15)
    if kind == "large C":  # Cx = 131071: R0 far above r
        plain |= dict.fromkeys(("shift_x", "shift_y", "shift_load"), 0) | {"rail": 2 * half - 1}
    return plain


def cop4_case(see, got, codes, r, where, correction=None):
    x, y, load = exact.cop4(codes, r, correction)
    load_lsb = load * 65536
    shown = min(exact.away(load_lsb), TOP)
    see.near(int(got.load), min(load_lsb, Fraction(TOP)), where, "load")
    see.near(int(got.load), shown, where, "load", limit=0)
    see.same(bool(got.over), exact.away(load_lsb) > TOP, where, "load")
    half = r["top"]
    saturated = any(code >= half or code <= -half - 1 for code in codes)
    e1, e2, e3, e4 = codes
    unbalanced = abs((r["rail"] - e1 - e3) - (r["rail"] + e2 + e4)) > r["imbalance"]
    upper = [e1, -1 - e2, e3, -1 - e4]
    opened = sum(1 << k for k in range(4) if upper[k] >= r["idle"] and upper[(k + 2) % 4] <= r["busy"])
    see.same(
        (bool(got.saturated), bool(got.imbalance), int(got.open)),
        (saturated, unbalanced, opened),
        where,
        "x, y",
    )
    pressed = shown > 0 and shown >= r["min_load"] and not (saturated or unbalanced or opened)
    see.same(bool(got.pressed), pressed, where, "x, y")
    for value, quotient in ((int(got.x), x), (int(got.y), y)):
        wanted = quotient * 16384 if pressed else Fraction(0)
        see.near(value, wanted, where, "x, y")
        see.near(value, exact.away(wanted), where, "x, y", limit=0)


@row("cop4", {"x, y": "1/2 LSB", "load": "1/2 LSB"})
def cop4_(see):
    """Exact for the given registers; the error from rounding a sensor's constants to registers is in
    docs/cop4.md.
    """

    def check(bits, r, rows, correction=None):
        terms = None if correction is None else CorrectionRegisters(tuple(correction), 8 + r["shift_load"])
        got = cop4.cop4(rows, cop4.Cop4Registers(**r), bits, terms)
        for k, codes in enumerate(rows):
            one = cop4.Cop4(*(value[k] for value in got))
            cop4_case(see, one, codes, r, lambda: f"{bits} bits, {codes}, {r}", correction)

    corrections = [
        None,
        (0,) * 6,
        (131069, 0, 0, 0, 0, 0),
        (-131069, 0, 0, 0, 0, 0),
        (21844,) * 6,
        (-21844,) * 6,
        (0, 0, 0, 43689, -43689, 43689),
    ]
    for one in see.covering(
        bits=[4, 12, 13, 17, 23, 24], kind=["sensor", "least", "greatest", "large C"], terms=corrections
    ):
        bits, kind, terms = one.values()
        r, half = cop4_ends(bits, kind), 1 << bits - 1
        few = [-half, -half + 1, -1, 0, 1, half // 2, half - 2, half - 1]
        rows = [
            [a, b, c, d]
            for a in few
            for c in (few if see.long else few[::3])
            for b in see.some(few[::2], 3)
            for d in few[1::3]
        ]
        # Currents of one LSB, differences of one LSB of full scale, N of 0 and of 1.
        v = r["rail"] // 2
        near = [[v, -v, v, -v], [v - 1, -v, v, -v + 1], [v, -v, v - 1, -v], [v + 1, -v, v, -v]]
        rows += [codes for codes in near if all(-half <= code < half for code in codes)]
        check(bits, r, rows, terms)
    # Loads of 65534, 65535 and 65536 LSBs, and halfway between them: N = 100 and D = 256 N.
    for kf in (65533, 65534, 65535, 65536, 65537):
        for more in (-1, 0, 1):
            r = cop4_ends(24, "sensor") | {"kf": kf, "shift_load": 0, "rail": 2**20}
            upper = 2**20 - 100 * 256
            codes = [upper // 2, 0, upper // 2, upper - 256 * 100 * 256 + more]
            check(24, r, [codes])
    see.elaborates("cop4", see.covering(SampleBits=[4, 17, 24], BitsPerClock=[1, 2], Correct=[0, 1]))
    for bits in (3, 25):
        see.refused(cop4.check_sample_bits, bits)
    base = cop4_ends(17, "sensor")
    for name, limit in (
        ("rail", 131071),
        ("kx", 131071),
        ("ky", 131071),
        ("kf", 131071),
        ("shift_x", 15),
        ("shift_load", 15),
        ("top", 65535),
        ("idle", 65535),
        ("imbalance", 262143),
        ("min_load", TOP),
    ):
        for outside in (limit + 1, -1 if name != "idle" else -65537):
            see.refused(cop4.Cop4Registers(**base | {name: outside}).check, 17)
    see.refused(cop4.cop4, [[1 << 16, 0, 0, 0]], cop4.Cop4Registers(**base), 17)
    code = st.integers(-(2**23), 2**23 - 1)
    see.given(
        lambda codes, kind: check(24, cop4_ends(24, kind), [list(codes)]),
        codes=st.tuples(code, code, code, code),
        kind=st.sampled_from(["sensor", "least", "greatest", "large C"]),
    )
    ratios(see, check)


def ratios(see, check):
    """Codes of sensors with r/rp from 1e-12 to 1e12, with registers as close as their range allows."""
    bits, half = 17, 1 << 16
    for power in range(-12, 13, 1 if see.long else 3):
        # Cx = (2m R0/r + n+1)/(n-1) of 41 x 41; kx keeps it while Cx < 2^17.
        cx = min(
            Fraction(82 * 10**12, 10 ** (12 + power)) / 40 if power < 12 else Fraction(42, 40),
            Fraction(131071),
        )
        shift = next((s for s in range(15, -1, -1) if cx * 2**s < 131072), 0)
        r = cop4_ends(bits, "sensor") | {"kx": int(cx * 2**shift), "shift_x": shift, "rail": 2 * half - 1}
        rows = [
            [half - 2 - d, -half + 2, half - 2 - e, -half + 2 + d]
            for d in (0, 1, 2, 100, half)
            for e in (0, 1, half)
        ]
        check(bits, r, rows)


@row("cop4_correct", {"": "0", "the polynomial": "5 N"})
def cop4_correct_(see):
    """Equal to the exact value with the block's own floors; p differs from the polynomial without floors by
    at most 5 of its LSBs.

    The floors of X and Y lose less than 1 of 2^16 each, which the sums of |p| < 2^17 turn into less than 2,
    and again in the inner brackets; the three other floors lose less than 1 each: 0.0 .. 5 in all.
    """
    terms = [
        (0,) * 6,
        (131069, 0, 0, 0, 0, 0),
        (0, 131069, 0, 0, 0, 0),
        (0, 0, 131069, 0, 0, 0),
        (0, 0, 0, 131069, 0, 0),
        (0, 0, 0, 0, 131069, 0),
        (0, 0, 0, 0, 0, 131069),
        (21844,) * 6,
    ]
    terms += [tuple(-p for p in each) for each in terms[1:]] + [(21844, -21844, 21844, -21844, 21844, -21844)]
    places = [
        (x, y) for x in (0, 1, -1, 127, 128, 16383, 16384, -16384) for y in (0, 1, -64, 11585, 16384, -16384)
    ]
    for one in see.covering(
        p=terms,
        shift=[8, 9, 16, 23],
        n=[0, 1, -1, 131071, 2**25 - 1, -(2**25)],
        d=[0, 1, -1, 2**25 - 1, -(2**25)],
    ):
        p, shift, n, d = one.values()
        got = cop4_correct(
            *zip(*places), [n] * len(places), [d] * len(places), CorrectionRegisters(p, shift)
        ).tolist()
        for (x, y), value in zip(places, got):
            see.near(value, exact.cop4_divisor(x, y, n, d, p, shift), (x, y, one))
            true = exact.true_divisor(x, y, n, d, p, shift)
            see.near(value, true, lambda: f"{x}, {y}, {one}", "the polynomial", limit=5 * max(abs(n), 1))
    for bad in ((131070, 0, 0, 0, 0, 0), (21845,) * 6, (0,) * 5):
        see.refused(cop4_correct, 0, 0, 1, 1, CorrectionRegisters(bad, 8))
    for shift in (7, 24):
        see.refused(cop4_correct, 0, 0, 1, 1, CorrectionRegisters((0,) * 6, shift))
    see.refused(cop4_correct, 16385, 0, 1, 1, CorrectionRegisters((0,) * 6, 8))


@row("cop_slip", {"": "0"})
def cop_slip_(see):
    """The header's rule, applied sample by sample to the list of all samples."""
    ends_of = {
        "drop": [0, 1, 77, 255],
        "move": [0, 1, 32767, 65535],
        "min_load": [0, 1, TOP],
        "hold": [0, 1, TOP],
        "refractory": [0, 1, TOP],
    }
    for one in see.covering(lag=[1, 2, 16, *([4096] if see.long else [])], **ends_of):
        lag = one["lag"]
        given = {name: one[name] for name in ends_of}
        loads = [0, 1, TOP, TOP, 1, 0, TOP, TOP - 1, 256, 255, 179, 178]
        x = [-32768, 32767, 0, 1, -1, 32767, -32768]
        count = 3 * lag + 60
        samples = [(x[k % 7], x[k // 2 % 7], loads[k // lag % 12], k % 11 != 5) for k in range(count)]
        twin = cop_slip.CopSlip(lag, cop_slip.CopSlipRegisters(**given))
        got = twin.process(*zip(*samples))
        wanted = slip_by_rule(samples, lag, **given)
        for k, each in enumerate(wanted):
            here = tuple(int(value[k]) for value in got)
            see.same(here, each, lambda: f"{one}, sample {k}")
    see.elaborates("cop_slip", see.covering(Lag=[1, 2, 4096], TimerBits=[1, 31]))
    for d in exact.ends(-65535, 65535):
        for e in (0, 1, 53, 128, d * 53 // 128, -d, d):
            see.same(int(cop_slip.octants(d, e)), octant(d, e), (d, e))
    for bad in ({"lag": 0}, {"lag": 4097}, {"timer_bits": 0}, {"timer_bits": 32}):
        see.refused(cop_slip.CopSlip, **bad)
    for name, top in (("drop", 255), ("move", TOP), ("min_load", TOP), ("hold", TOP), ("refractory", TOP)):
        for outside in (-1, top + 1):
            see.refused(cop_slip.CopSlip, 16, cop_slip.CopSlipRegisters(**{name: outside}))


def octant(dx, dy):
    """Octants about the axes and diagonals with limits at 53/128, counter-clockwise from +x; 0 for no
    move."""
    if 128 * abs(dy) <= 53 * abs(dx):
        return 4 if dx < 0 else 0
    if 128 * abs(dx) <= 53 * abs(dy):
        return 6 if dy < 0 else 2
    return {(0, 0): 1, (1, 0): 3, (1, 1): 5, (0, 1): 7}[dx < 0, dy < 0]


def slip_by_rule(samples, lag, drop, move, min_load, hold, refractory):
    """(slip, raised, over, dx, dy, octant) of each sample."""
    slipping, since_over, deaf, found = False, 0, 0, []
    for k, (x, y, load, pressed) in enumerate(samples):
        old = samples[k - lag] if k >= lag else (0, 0, 0, False)
        pair = pressed and old[3] and old[2] >= min_load
        dx, dy = (x - old[0], y - old[1]) if pair else (0, 0)
        over = pair and (old[2] - load) * 256 > drop * old[2] and max(abs(dx), abs(dy)) >= move
        raised = False
        if slipping:
            since_over = 0 if over else since_over + 1
            slipping = since_over <= hold
            deaf = refractory
        elif over and deaf == 0:
            slipping = raised = True
            since_over = 0
        else:
            deaf = max(0, deaf - 1)
        found.append((int(slipping), int(raised), int(over), dx, dy, octant(dx, dy)))
    return found
