"""Extremes of rtl/slip: alternating full scale at every level, windows and timers at their ends, powers."""

import re

import hypothesis.strategies as st
import mpmath
import numpy as np

from extremes.rows import row
from meissner.builds import toolchain
from meissner.twins.slip import haar, peak_to_peak, shear_speed, slip, slip_path, slip_serial
from meissner.twins.slip.config import SlipConfig
from reference import exact
from reference.shear import FAST, RISING, SATURATED, ShearReference, within
from reference.slip import NUMBERS, SlipPathReference, SlipReference


def alternating(level, bits, count):
    """Full scale with the period that drives this level's detail to its end: 2^(level-1) samples up, as many
    down.
    """
    low, high = exact.signed(bits)
    half = 1 << level - 1
    return [high if k // half % 2 == 0 else low for k in range(count)]


@row("haar", {"": "0"})
def haar_(see):
    for bits in (2, 13, 17, 18, 24, 32):
        low, high = exact.signed(bits)
        for level in (1, 2, 3):
            for driven in (1, 2, 3):
                for x in (alternating(driven, bits, 64), alternating(driven, bits, 67)[3:]):
                    detail, total = haar.haar(x, level)
                    d, a = exact.details(x, level)
                    see.all_near(
                        detail.tolist(),
                        d,
                        [lambda: f"{bits} bits, level {level}, driven at {driven}"] * len(d),
                    )
                    see.all_near(total.tolist(), a, [(bits, level, driven)] * len(a))
                    room = exact.signed(bits + level)
                    see.same(all(room[0] <= v <= room[1] for v in d + a), True, (bits, level, driven))
            most = exact.details(alternating(level, bits, 8), level)[0][0]
            see.near(most, 2 ** (level - 1) * (high - low), f"the end itself, {bits} bits, level {level}")
            for flat in (low, high, 0, -1):
                see.all_near(
                    haar.haar([flat] * 16, level)[0].tolist(), [0] * (16 >> level), [flat] * (16 >> level)
                )
            masked = haar.haar([high, low] * 8, level, [False] * 15 + [True])
            see.same((int(masked[0][-1]), int(masked[1][-1])), (0, 0), (bits, level, "masked"))
    see.elaborates("haar", see.covering(Channels=[1, 2, 4096], Level=[1, 2, 3], SampleBits=[2, 17, 32]))
    for bad in ((1, 0), (1, 4), (0, 1), (4097, 1)):
        see.refused(haar.Haar, *bad)
    code = st.integers(*exact.signed(32))

    def drawn(x, level):
        for got, wanted in zip(haar.haar(x, level), exact.details(x, level)):
            see.same(got.tolist(), wanted, (x, level))

    see.given(drawn, x=st.lists(code, min_size=8, max_size=40), level=st.integers(1, 3))


@row("sliding_extremes", {"": "0"})
def sliding_extremes_(see):
    for bits in (2, 18, 20, 32):
        low, high = exact.signed(bits)
        x = ([low, high, 0, -1, high, low + 1, high - 1] * 12)[:70]
        y = x[::-1]
        for lag in (1, 2, 16, 69, 70, 1000):
            for taps in (2, 4):
                got = peak_to_peak.sliding_extremes(x, y, lag, taps)
                for t in range(len(x)):
                    seen = [t - k * lag for k in range(taps) if t >= k * lag]
                    see.near(got[0][t], max(x[k] for k in seen), (bits, lag, taps, t))
                    see.near(got[1][t], min(y[k] for k in seen), (bits, lag, taps, t))
    for lag, taps in ((1, 3), (1, 8), (0, 2)):
        see.refused(peak_to_peak.sliding_extremes, [0], [0], lag, taps)


@row("peak_to_peak", {"": "0"})
def peak_to_peak_(see):
    hops = ["span", "half", "one", "three quarters"]
    for one in see.covering(
        bits=[3, 18, 20, 32], span=[2, 4, 64, 2048], hop=hops, masks=["none", "some", "all"]
    ):
        span = one["span"]
        hop = {"span": span, "half": span // 2, "one": 1, "three quarters": max(1, 3 * span // 4)}[one["hop"]]
        low, high = exact.signed(one["bits"])
        count = 2 * span + 5 if span > 64 else 4 * span + 9
        x = [(low, high, 0, high, low, -1)[k * k % 6] for k in range(count)]
        off = [one["masks"] == "all" or (one["masks"] == "some" and k % 5 < 3) for k in range(count)]
        p2p, end = peak_to_peak.PeakToPeak(1, span, hop).process([x], [off])
        for k in range(count) if span <= 64 else range(span - 2, count, 17):
            if hop == span:
                begin = k // span * span
            elif hop == span // 2:
                begin = max(k // hop - 1, 0) * hop
            else:
                begin = max(k - span + 1, 0)
            window = [x[j] for j in range(begin, k + 1) if not off[j]]
            see.near(p2p[0, k], max(window) - min(window) if window else 0, lambda: f"{one}, detail {k}")
            see.same(bool(end[k]), k >= span - 1 and (k - span + 1) % hop == 0, (one, k))
        see.same(int(p2p.max()) < 2 ** one["bits"], True, one)
    for span, hop in ((1, 1), (3, 1), (0, 0), (4, 0), (4, 5)):
        see.refused(peak_to_peak.check_window, span, hop)


CODES = {
    "threshold": [0, 1, 2**18 - 1],
    "gross_threshold": [0, 40, 2**18 - 1],
    "contact_level": [-(2**17), 0, 2**17 - 1],
    "release_level": [-(2**17), -1, 2**17 - 1],
    "contact_rises": [True, False],
    "hold": [0, 1, 65535],
    "refractory": [0, 1, 65535],
    "blank": [0, 1, 65535],
    "keep_threshold": [None, 0, 2**18 - 1],
}


@row("slip", {"": "0"})
def slip_(see):
    draw, names = see.random, list(CODES)
    sizes = see.covering(**CODES)
    for k, one in enumerate(sizes if see.long else sizes[::2]):
        # One is long enough for the longest timers to end.
        count = 140_000 if k == 0 and see.long else 600
        config = SlipConfig(window=64, hop=64, level=1, **one)
        p2p = [draw.choice((0, 1, 2, 40, 41, 2**18 - 2, 2**18 - 1)) for _ in range(count)]
        level = [
            draw.choice((-(2**17), -1, 0, 1, 2**17 - 1)) if j % 50 < 8 else 2**17 - 1 for j in range(count)
        ]
        moving = [j % 7 == 3 for j in range(count)]
        masked = [j % 97 == 96 for j in range(count)]
        loop, twin = SlipReference(config), slip.Slip(1, config)
        states = twin.process([p2p], [level], moving, [masked])[0].tolist()
        for j in range(count):
            wanted = NUMBERS[loop.detail(p2p[j], level[j], moving[j], masked[j])]
            if states[j] != wanted or j % 50 == 0:
                see.same(states[j], wanted, lambda: f"{one}, detail {j}")
        see.near(twin.blanked, loop.blanked, lambda: f"{one}, blanked")
    timers(see)
    base = dict(window=64, hop=64, level=1)
    for name in names:
        for outside in (-(2**18) - 1, 2**18):
            if name not in ("contact_rises", "keep_threshold"):
                see.refused(SlipConfig, **base, **{name: outside})


def timers(see):
    """Each timer at its end, 65535 details, exactly."""
    top = 65535
    plain = {"threshold": 10, "gross_threshold": 1000, "contact_level": 0, "release_level": -5}
    config = SlipConfig(window=64, hop=64, level=1, **plain, hold=top)
    p2p = np.array([[0, 11] + [0] * (top + 3)])
    states = slip.Slip(1, config).process(p2p, np.zeros_like(p2p))[0]
    see.near(int((states == 2).sum()), 1 + top, "a slip outlasts hold details that are not over")
    config = SlipConfig(window=64, hop=64, level=1, **plain, blank=top)
    p2p = np.full((1, top + 4), 11)
    states = slip.Slip(1, config).process(p2p, np.zeros_like(p2p))[0]
    see.near(int(np.argmax(states == 2)), 1 + top, "blank details after the onset")
    config = SlipConfig(window=64, hop=64, level=1, **plain, refractory=top)
    p2p = np.array([[0, 11, 0] + [11] * (top + 4)])
    states = slip.Slip(1, config).process(p2p, np.zeros_like(p2p))[0]
    see.near(int(np.argmax(states[3:] == 2)), top, "refractory details are deaf")


def paths(see, axes, allowed):
    for one in see.covering(allowed, **axes):
        low, high = exact.signed(17)
        level = one["level"]
        window = one["window"]
        hop = {"window": window, "half": window // 2, "step": 1 << level}[one["hop"]]
        if hop % (1 << level):
            continue
        config = SlipConfig(
            window=window,
            hop=hop,
            level=level,
            threshold=one["threshold"],
            gross_threshold=one["gross"],
            contact_level=one["contact"],
            release_level=one["contact"],
            hold=one["timer"],
            refractory=one["timer"],
            blank=one["timer"],
        )
        x = (
            alternating(level, 17, 96)
            + [high] * 40
            + [low] * 24
            + alternating(1, 17, 64)
            + [0] * 24
            + [high, low, low] * 24
        )
        x = x * (1 if window < 128 else 8)
        yield one, config, x, low, high


AXES = {
    "level": [1, 2, 3],
    "window": [4, 16, 64, 1024],
    "hop": ["window", "half", "step"],
    "threshold": [0, 2**17, 2**18 - 1],
    "gross": [0, 2**18 - 1],
    "contact": [-(2**16), 0, 2**16],
    "timer": [0, 1, 65535],
}


@row("slip_path", {"": "0"})
def slip_path_(see):
    for one, config, x, *_ in paths(see, AXES, lambda level, window, **_: window >= 2 << level):
        mask = [k % 61 == 60 for k in range(len(x))]
        got = slip_path.decide(np.array([x]), config, None, np.array([mask]))
        loop, at = SlipPathReference(config), 0
        for sample, off in zip(x, mask):
            found = loop.sample(sample, False, off)
            if found:
                state, raised, _, p2p, end = found
                see.near(int(got.p2p[0, at]), p2p, lambda: f"{one}, detail {at}")
                see.same(
                    (int(got.state[0, at]), bool(got.raised[0, at]), bool(got.end[at])),
                    (NUMBERS[state], bool(raised), bool(end)),
                    lambda: f"{one}, detail {at}",
                )
                at += 1
        see.near(at, got.p2p.shape[1], one)


@row("slip_serial", {"": "0"})
def slip_serial_(see):
    axes = AXES | {"hop": ["window"], "timer": [0, 1, 16383], "digit": [1, 2]}
    for one, config, x, *_ in paths(see, axes, lambda level, window, **_: window >= 2 << level):
        twin = slip_serial.SlipSerial(config, 17, 14, one["digit"])
        got, loop = twin.process(x), SlipPathReference(config)
        wanted = [found for found in map(loop.sample, x) if found]
        for at, (state, raised, over, p2p, end) in enumerate(wanted):
            see.near(int(got["p2p"][at]), p2p, lambda: f"{one}, detail {at}")
            here = tuple(int(got[name][at]) for name in ("state", "raised", "over", "end"))
            see.same(here, (NUMBERS[state], int(raised), int(over), int(end)), lambda: f"{one}, detail {at}")
    config = SlipConfig(window=8, hop=8, threshold=2**13)
    for bad in (
        (config, 13),
        (config, 12, 14),
        (config, 1),
        (config, 17, 0),
        (config, 17, 32),
        (config, 17, 14, 3),
    ):
        if bad != (config, 13):
            see.refused(slip_serial.SlipSerial, *bad)
    see.refused(slip_serial.SlipSerial, SlipConfig(window=8, hop=8, hold=2**10), 17, 10)


def plain_settings(size, **given):
    """Registers that raise no flag, so that only the formula is tested."""
    top = 2**size.level_bits - 1
    settings = {
        "k0": top // 8,
        "k1": 0,
        "exponent": 18618,
        "vi_min": -(2 ** (size.level_bits - 1)),
        "vi_max": 2 ** (size.level_bits - 1) - 1,
        "noise": 0,
        "still": 0,
        "full": 2 ** (size.sample_bits - 1) - 1,
        "limit": 2**size.speed_bits - 1,
        "travel": 0,
    }
    return settings | given


@row("shear_speed", {"": "0.000023 + 0.000047 / n of v and 1/2 LSB at the default size"})
def shear_speed_(see):
    formula(see)
    rules(see)
    ends = {"SampleBits": [4, 24], "WindowLog2": [1, 12], "SettleLog2": [0, 8], "SpeedBits": [8, 32]}

    def fits(SampleBits, WindowLog2, SettleLog2, TableBits, **_):
        return SampleBits + WindowLog2 + SettleLog2 + 1 >= TableBits + 2

    see.elaborates("shear_speed", see.covering(fits, **ends, SpeedFraction=[0, 32], TableBits=[3, 6]))
    for bad in (
        {"sample_bits": 3},
        {"sample_bits": 25},
        {"window_log2": 0},
        {"window_log2": 13},
        {"settle_log2": 9},
        {"speed_bits": 7},
        {"speed_bits": 33},
        {"speed_fraction": 33},
        {"table_bits": 2},
    ):
        see.refused(shear_speed.ShearSize, **bad)
    size = shear_speed.ShearSize()
    for name, outside in (
        ("k0", 2**26),
        ("k0", -1),
        ("k1", 2**17),
        ("k1", -(2**17) - 1),
        ("exponent", 65536),
        ("vi_min", -(2**25) - 1),
        ("vi_max", 2**25),
        ("noise", -1),
        ("still", 2**26),
        ("full", 65536),
        ("limit", 2**24),
        ("travel", 2**32),
    ):
        see.refused(shear_speed.ShearSettings(**plain_settings(size, **{name: outside})).check, size)


def formula(see):
    """v for dV from 1 LSB to full scale, k from 1 to full scale, 1/n from 0 to its greatest value."""
    sizes = [
        {},
        {"table_bits": 3, "fraction_bits": 10, "speed_bits": 32, "speed_fraction": 16},
        {
            "table_bits": 8,
            "fraction_bits": 20,
            "sample_bits": 24,
            "window_log2": 12,
            "settle_log2": 8,
            "speed_bits": 32,
            "speed_fraction": 0,
        },
        {"sample_bits": 4, "window_log2": 1, "settle_log2": 2, "speed_fraction": 24},
        {"speed_bits": 8, "speed_fraction": 32},
    ]
    for given in sizes:
        size = shear_speed.ShearSize(**given)
        top = 2**size.level_bits
        ends = sorted({1, 2, 3, top // 8, top // 2 - 1, top // 2, top - 2, top - 1, top})
        exponents = [0, 1, 2047, 2048, 2049, 18618, 65534, 65535]
        for one in see.some(see.covering(rise=ends, k=ends[:-1], exponent=exponents), 4):
            settings = shear_speed.ShearSettings(**plain_settings(size, exponent=one["exponent"]))
            got = int(shear_speed.speed(one["rise"], one["k"], settings, size))
            power = mpmath.mpf(one["exponent"]) / 2**11
            value = (
                mpmath.power(mpmath.mpf(one["rise"]) / one["k"], power) * mpmath.mpf(2) ** size.speed_fraction
            )
            top_speed = 2**size.speed_bits - 1
            share = within(one["exponent"], size.level_bits, size.table_bits, size.fraction_bits)
            target = min(value, mpmath.mpf(top_speed))
            see.near(
                got,
                target,
                lambda: f"{given or 'default'}, {one}",
                limit=min(value, 2 * target) * share + mpmath.mpf("0.5"),
            )
            see.same(0 <= got <= top_speed, True, one)
    promised(see)
    size = shear_speed.ShearSize()
    half_lsb = mpmath.mpf(2) ** -21 / mpmath.mpf("0.01")  # part of the page's bound, at 0.01 mm/s
    see.near(
        within(18618, 26, 6, 16) + half_lsb,
        mpmath.mpf("0.000493"),
        "docs/shear_speed.md, bound of 6 bits",
        limit=mpmath.mpf("0.0000006"),
    )


def promised(see):
    """What the header promises for the default size, over 1/n from 0 to its greatest value; float64 is exact
    to 1e-13. At the least n more than 0.001 occurs: the promise may not be a constant of the published n."""
    text = (toolchain.ROOT / "rtl/slip/msn_shear_speed.sv").read_text("utf-8")
    promise = re.search(r"Error: at most (\S+) \+ (\S+) / n of v and 1/2 LSB at the default size", text)
    size, (fixed, slope) = shear_speed.ShearSize(), map(float, promise.groups())
    k = see.numpy.integers(1 << 20, 1 << 21, 3000)
    for exponent in sorted({*range(0, 65536, 2048 if not see.long else 61), 18618, 65535}):
        power = exponent / 2048
        rise = np.rint(k * 2 ** (see.numpy.uniform(-4, 3.9, k.size) / max(power, 4))).astype(int)
        exact = 2 ** (np.log2(rise / k) * power + 20)
        got = shear_speed.speed(rise, k, shear_speed.ShearSettings(**plain_settings(size, exponent=exponent)))
        worst = float(np.max((np.abs(got - exact) - 0.5)[exact < 2**24 - 1] / exact[exact < 2**24 - 1]))
        see.near(max(worst, 0), 0, f"1/n = {power}", limit=fixed + slope * power)
        see.near(within(exponent, 26, 6, 16), 0, f"1/n = {power}, bound", limit=fixed + slope * power)
    see.same(worst > 0.001, True, "the largest 1/n")


def rules(see):
    """Windows at 0, at the supply, one LSB apart; registers at both ends; compared with the page's rules."""
    size = shear_speed.ShearSize(sample_bits=6, window_log2=1, settle_log2=1, speed_bits=16, speed_fraction=8)
    levels, unit = 2**size.level_bits, 4
    low, high = exact.signed(6)
    axes = {
        "k0": [0, 1, levels // 4, levels - 1],
        "k1": [-(2**17), -17695, 0, 2**17 - 1],
        "exponent": [0, 2048, 18618, 65535],
        "vi_min": [-levels // 2, 0],
        "vi_max": [0, levels // 2 - 1],
        "noise": [0, 1, levels - 1],
        "still": [0, unit - 1, unit, levels - 1],
        "full": [low, 20, high],
        "limit": [0, 300, 65535],
        "travel": [0, 1, 2**32 - 1],
    }
    for number, one in enumerate(see.some(see.covering(**axes), 6)):
        draw = np.random.default_rng(number)
        steps = [
            low,
            low,
            low,
            low,
            low + 1,
            0,
            0,
            0,
            0,
            1,
            1,
            2,
            19,
            20,
            20,
            high,
            high,
            -1,
            -1,
            -1,
            -1,
            3,
            5,
            9,
            15,
            19,
        ]
        windows = [[v, v] for v in steps]
        windows += draw.choice([low, -1, 0, 1, 19, 20, high - 1, high], (120, 2)).tolist()
        windows += [[0, 0]] * 6 + [[10, 10]] * 8 + [[low, low]] * 5 + [[high - 1, high - 1]] * 3
        held = draw.random(len(windows)) < 0.03
        twin = shear_speed.ShearSpeed(shear_speed.ShearSettings(**one), size)
        speeds, flags = twin.process(np.ravel(windows), np.repeat(held, 2))
        loop, travel = ShearReference(one, 1, 1, size.speed_fraction), 0
        before = None
        for k, samples in enumerate(windows):
            before = loop.reference
            wanted, value = loop.window(samples, bool(held[k]))
            place = f"{one}, window {k}"
            if value is None:
                see.same((int(speeds[k]), int(flags[k])), (0, wanted), place)
                travel = 0
                continue
            top = 2**size.speed_bits - 1
            share = within(one["exponent"], size.level_bits, size.table_bits, size.fraction_bits)
            target = min(value, mpmath.mpf(top))
            room = min(value, 2 * target) * share + mpmath.mpf("0.5")
            least, most = max(0, target - room), min(mpmath.mpf(top), target + room)
            rises = before is not None and sum(samples) * 2 > before + one["still"]
            travel = (
                (0, 0)
                if rises
                else tuple(min(t + v, 2**32 - 1) for t, v in zip(travel or (0, 0), (least, most)))
            )
            sure, maybe = 0, 0
            for flag, never, always in (
                (RISING, travel[0] >= one["travel"], travel[1] < one["travel"]),
                (FAST, most <= one["limit"], least > one["limit"]),
                (SATURATED, most < top, least >= top),
            ):
                sure |= flag if always else 0
                maybe |= 0 if never else flag
            see.same((int(flags[k]) & sure, int(flags[k]) | maybe), (sure, maybe), place)
            if flags[k]:
                see.same(int(speeds[k]), 0, place)
            else:
                see.near(int(speeds[k]), target, place, limit=room)
    travel_holds(see)


def travel_holds(see):
    """The sum of speeds saturates at 2^32 - 1: windows at a speed of 2^31, and more of them after it."""
    size = shear_speed.ShearSize(
        sample_bits=6, window_log2=1, settle_log2=0, speed_bits=32, speed_fraction=31
    )
    settings = plain_settings(size, k0=20, exponent=2048, travel=2**32 - 1, full=31, still=2)
    twin = shear_speed.ShearSpeed(shear_speed.ShearSettings(**settings), size)
    samples = [0, 0] + [10, 10] * 12
    speeds, flags = twin.process(samples)
    # A rise of 20 over k of 20 is 1 mm/s, 2^31 units per window; the rise is in the first window.
    travels = [0 if k < 2 else min((k - 1) * 2**31, 2**32 - 1) for k in range(13)]
    wanted = [1] + [RISING * (travels[k] < 2**32 - 1) for k in range(1, 13)]
    see.same(flags.tolist(), wanted, "travel at 2^32 - 1")
    see.all_near(
        speeds.tolist()[4:],
        [2**31] * 9,
        ["1 mm/s"] * 9,
        limit=2**31 * within(2048, 7, 6, 16) + mpmath.mpf("0.5"),
    )
