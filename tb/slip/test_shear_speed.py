"""msn_shear_speed against its model; the model against cases worked out by hand, with each limit met exactly,
one below and one above; its registers from volts by hand; its formula against
float64 over the range of speeds and levels, at several precisions; and on the rubber of the physics model."""

from dataclasses import replace

import cocotb
import numpy as np
import pytest

import bench
from meissner.physics import rubber
from meissner.twins.slip import shear_speed as twin
from meissner.twins.slip.shear_speed import ShearSettings, ShearSize, ShearSpeed, speed

NAMES = {
    "SampleBits": "sample_bits",
    "WindowLog2": "window_log2",
    "SettleLog2": "settle_log2",
    "TableBits": "table_bits",
    "FractionBits": "fraction_bits",
    "SpeedBits": "speed_bits",
    "SpeedFraction": "speed_fraction",
}
LATENCY = 58
FIELDS = ["speed", "flags", "vi~", "rise~"]
OK, UNSETTLED, RANGE, SMALL, DENOMINATOR, CLIPPED, RISING, FAST, SATURATED = 0, 1, 2, 4, 8, 16, 32, 64, 128
ONE = 1 << 20  # 1 mm/s

# Windows of two samples, Vi of one window: a level is the sum of two codes. 1/n = 9.0908; k of Vi = 1000 is
# 1000 + floor(-270.004) = 729, so that a rise of 729 is 1 mm/s exactly.
SMALL_SIZE = ShearSize(sample_bits=13, window_log2=1, settle_log2=0)
HAND = ShearSettings(
    **{"k0": 1000, "k1": -17695, "exponent": 18618, "vi_min": 900, "vi_max": 1100, "noise": 50, "still": 10},
    **{"full": 4000, "limit": 3 * ONE, "travel": 0},
)

# Per case: changes to HAND; levels of windows (h: held); for each window minus its flags, or its speed if it
# has no flags; None: any speed without flags, as it may round to 0.
CASES = {
    "rise below noise": ({}, [1000, 1049], [-UNSETTLED, -SMALL]),
    "rise at noise": ({}, [1000, 1050], [-UNSETTLED, None]),
    "rise above noise": ({}, [1000, 1051], [-UNSETTLED, None]),
    "rise of nothing": ({"noise": 0}, [1000, 1000, 1001], [-UNSETTLED, -SMALL, None]),
    "fall by one": ({"noise": 0}, [1000, 999], [-UNSETTLED, -SMALL]),
    "a small rise becomes the rest": ({}, [1000, 1049, 1098, 1148], [-UNSETTLED, -SMALL, -SMALL, None]),
    "Vi below": ({}, [899, 1500], [-UNSETTLED, -RANGE]),
    "Vi at the least": ({"limit": (1 << 24) - 1}, [900, 1500], [-UNSETTLED, None]),
    "Vi at the most": ({}, [1100, 1700], [-UNSETTLED, None]),
    "Vi above": ({}, [1101, 1700], [-UNSETTLED, -RANGE]),
    "Vi at 0": ({}, [0, 700], [-UNSETTLED, -RANGE]),
    "Vi and rise": ({}, [1101, 1150], [-UNSETTLED, -(RANGE | SMALL)]),
    "falls by still": ({}, [1000, 1729, 1719], [-UNSETTLED, ONE, None]),
    "falls by more": ({}, [1000, 1729, 1718, 1718], [-UNSETTLED, ONE, -UNSETTLED, -(SMALL | RANGE)]),
    "falls slowly": ({}, [1000, 1729, 1723, 1718], [-UNSETTLED, ONE, None, -UNSETTLED]),
    "rises by still": ({"travel": 1}, [1000, 1719, 1729, 1729], [-UNSETTLED, -RISING, ONE, ONE]),
    "rises by more": ({"travel": 1}, [1000, 1718, 1729, 1729], [-UNSETTLED, -RISING, -RISING, ONE]),
    "travel met": (
        {"travel": 3 * ONE},
        [1000, 1729, 1729, 1729, 1729],
        [-UNSETTLED, -RISING, -RISING, -RISING, ONE],
    ),
    "travel not met": (
        {"travel": 3 * ONE + 1},
        [1000, 1729, 1729, 1729, 1729, 1729],
        [-UNSETTLED, -RISING, -RISING, -RISING, -RISING, ONE],
    ),
    "travel passed": (
        {"travel": 3 * ONE - 1},
        [1000, 1729, 1729, 1729, 1729],
        [-UNSETTLED, -RISING, -RISING, -RISING, ONE],
    ),
    "travel and too fast": (
        {"travel": 2 * ONE, "limit": ONE - 1},
        [1000, 1729, 1729, 1729],
        [-UNSETTLED, -(RISING | FAST), -(RISING | FAST), -FAST],
    ),
    "travel ends at rest": (
        {"travel": 2 * ONE, "still": 1000},
        [1000, 1729, 1049, 1778, 1778],
        [-UNSETTLED, -RISING, -SMALL, -RISING, None],
    ),
    "speed at the limit": ({"limit": ONE}, [1000, 1729], [-UNSETTLED, ONE]),
    "speed below the limit": ({"limit": ONE + 1}, [1000, 1729], [-UNSETTLED, ONE]),
    "speed above the limit": ({"limit": ONE - 1}, [1000, 1729], [-UNSETTLED, -FAST]),
    "no denominator": ({"k0": 500, "k1": -32768}, [1000, 1200], [-UNSETTLED, -DENOMINATOR]),
    "denominator below 0": ({"k0": 499, "k1": -32768}, [1000, 1200], [-UNSETTLED, -DENOMINATOR]),
    "denominator of 1": ({"k0": 501, "k1": -32768}, [1000, 1200], [-UNSETTLED, -(FAST | SATURATED)]),
    # n = 1: the speed is the rise over k, and k = 1
    "speed of 8 at the limit": (
        {"k0": 501, "k1": -32768, "exponent": 2048, "limit": 8 * ONE, "noise": 8},
        [1000, 1008],
        [-UNSETTLED, 8 * ONE],
    ),
    "speed of 8 above the limit": (
        {"k0": 501, "k1": -32768, "exponent": 2048, "limit": 8 * ONE - 1, "noise": 8},
        [1000, 1008],
        [-UNSETTLED, -FAST],
    ),
    "speed of 15": (
        {"k0": 501, "k1": -32768, "exponent": 2048, "limit": (1 << 24) - 1, "noise": 15},
        [1000, 1015],
        [-UNSETTLED, None],
    ),
    "speed of 16": (
        {"k0": 501, "k1": -32768, "exponent": 2048, "limit": (1 << 24) - 1, "noise": 15},
        [1000, 1016],
        [-UNSETTLED, -SATURATED],
    ),
    "speed of 16, limited": (
        {"k0": 501, "k1": -32768, "exponent": 2048, "limit": (1 << 24) - 2, "noise": 15},
        [1000, 1016],
        [-UNSETTLED, -(FAST | SATURATED)],
    ),
    "1/n of 0": ({"exponent": 0}, [1000, 1900], [-UNSETTLED, ONE]),
    "the largest 1/n": ({"exponent": 65535}, [1000, 1729, 1300], [-UNSETTLED, ONE, -UNSETTLED]),
    "a hold": (
        {},
        [1000, 1729, "1729h", 1729, 2458],
        [-UNSETTLED, ONE, -UNSETTLED, -UNSETTLED, -RANGE],
    ),
    "a hold before all": ({}, ["1000h", "1000h", 1000, 1729], [-UNSETTLED, -UNSETTLED, -UNSETTLED, ONE]),
    "a code below full": ({"full": 866}, [1000, 1729], [-UNSETTLED, ONE]),  # the codes are 864 and 865
    "a code at full": (
        {"full": 865},
        [1000, 1729, 1727],
        [-UNSETTLED, -CLIPPED, None],
    ),
    "clipped and held": ({"full": 865}, [1000, "1729h"], [-UNSETTLED, -(UNSETTLED | CLIPPED)]),
    "clipped from the first": ({"full": 865}, [1729, 1729], [-(UNSETTLED | CLIPPED)] * 2),
    "clipped ends the travel": (
        {"full": 866, "travel": 1},
        [1000, 1729, 1731, 1729, 1729],
        [-UNSETTLED, -RISING, -CLIPPED, ONE, ONE],
    ),
    "Vi at the supply": ({"full": 4095}, [8190, 8190], [-(UNSETTLED | CLIPPED)] * 2),
    "the whole range": (
        {"vi_min": -8192, "k0": 8191, "full": 4095, "k1": 0},
        [-8192, 8187],
        [-UNSETTLED, -(FAST | SATURATED)],
    ),
    "the whole range of a straight line": (
        {"vi_min": -8192, "k0": 8191, "k1": 65536, "exponent": 2048, "full": 4095},
        [-8192, 8187],
        [-UNSETTLED, -DENOMINATOR],
    ),
    "the steepest line": (
        {"vi_min": -8192, "k0": 16382 - 8192 + 1, "k1": -131072, "exponent": 2048, "full": 4095},
        [-4096, 8191 - 8],
        [-UNSETTLED, None],
    ),
}

# Vi from two windows: the settled level is their sum.
PAIR_SIZE = replace(SMALL_SIZE, settle_log2=1)
PAIR = replace(HAND, k0=2000, vi_min=1800, vi_max=2200, noise=100, still=20)  # as HAND, in half the unit
PAIR_CASES = {
    "Vi at the least": ({}, [900, 900, 1500], [-UNSETTLED, -UNSETTLED, None]),
    "Vi below": ({}, [899, 900, 1500], [-UNSETTLED, -UNSETTLED, -RANGE]),
    "Vi at the most": ({}, [1100, 1100, 1700], [-UNSETTLED, -UNSETTLED, None]),
    "Vi above": ({}, [1100, 1101, 1700], [-UNSETTLED, -UNSETTLED, -RANGE]),
    "two windows": ({}, [1000, 1000, 1729], [-UNSETTLED, -UNSETTLED, None]),
    "second within still": ({}, [1000, 1010, 1734], [-UNSETTLED, -UNSETTLED, None]),
    "second off by more": ({}, [1000, 1011, 1011, 1740], [-UNSETTLED] * 3 + [None]),
    "second below by more": ({}, [1011, 1000, 1000, 1729], [-UNSETTLED] * 3 + [None]),
    "a hold between": ({}, [1000, "1000h", 1000, 1000, 1729], [-UNSETTLED] * 4 + [None]),
    "a clip between": (
        {"full": 501, "vi_max": 8000},
        [1000, 1002, 1000, 1000, 1000],
        [-UNSETTLED, -(UNSETTLED | CLIPPED), -UNSETTLED, -UNSETTLED, -SMALL],
    ),
    "a drift at rest is followed": (
        {"still": 60},
        [1000, 1000, 1020, 1020, 1040, 1040, 1085],
        [-UNSETTLED, -UNSETTLED, *[-SMALL] * 5],
    ),
    "a drift down is no fall": (
        {"still": 60},
        [1000, 1000, 980, 980, 960, 960, 1010],
        [-UNSETTLED, -UNSETTLED, *[-SMALL] * 4, None],
    ),
    "one window at rest is not enough": (
        {"still": 60},
        [1000, 1000, 1020, 1070],
        [-UNSETTLED, -UNSETTLED, -SMALL, None],
    ),
    "a shear between ends the rest": (
        {"still": 120},
        [1000, 1000, 1040, 1050, 1040, 1050, 1040, 1040, 1089, 1090],
        [-UNSETTLED, -UNSETTLED, -SMALL, None, -SMALL, None, -SMALL, -SMALL, -SMALL, None],
    ),
}


# (Vi, rise) of each window: both 0 while Vi is unknown; with a speed, a fall to below Vi, a clip, a hold.
LEVELS = [1000, 1729, 990, 990, 996, "990h", 1010, 1001]
LEVELS_TOLD = [(0, 0), (1000, 729), (0, 0), (990, 0), (990, 6), (0, 0), (0, 0), (1010, -9)]


def samples(levels, size):
    """(codes, held) of windows: a window's samples share its level; with h its last sample is held."""
    length = 1 << size.window_log2
    codes, held = [], []
    for level in levels:
        total = int(str(level).rstrip("h"))
        codes += [(total + place) // length for place in range(length)]
        held += [False] * (length - 1) + [str(level).endswith("h")]
    return codes, held


def check(case, found):
    """Check ``found``, (speed, flags) of each window, against the case."""
    assert len(found) == len(case)
    for expected, (v, flags) in zip(case, found):
        if expected is None:
            assert flags == OK
        elif expected > 0:
            assert (v, flags) == (expected, OK)
        else:
            assert (v, flags) == (0, -expected)


def beats_of(codes, held):
    """``restart`` on the first beat, as after lost samples."""
    return [
        {"data": code, "hold": hold, "restart": n == 0} for n, (code, hold) in enumerate(zip(codes, held))
    ]


def put(dut, settings):
    for name, value in vars(settings).items():
        port = getattr(dut, f"cfg_{name}_i")
        port.value = value & ((1 << len(port)) - 1)


def size_of(dut):
    return ShearSize(**{name: getattr(dut, port).value.to_unsigned() for port, name in NAMES.items()})


async def begin(dut, settings):
    put(dut, settings)
    await bench.start(dut, in_hold_i=0, in_restart_i=0, in_data_i=0)


def all_of(got):
    return [tuple(beat.values()) for beat in got]


def of_model(settings, size, codes, held):
    return list(zip(*map(np.ndarray.tolist, ShearSpeed(settings, size).windows(codes, held))))


def pairs(got):
    return [(beat["speed"], beat["flags"]) for beat in got]


def settings_of(size, **given):
    """Registers for 5 V over the positive codes at 10 kHz; a travel of three windows at 0.5 mm/s."""
    full = (1 << size.sample_bits - 1) - 1
    given = {"noise": 0.2, "still": 0.01, "travel": 1.5e-4 * (1 << size.window_log2)} | given
    return ShearSettings.of(full / 5, 10_000, size, **given)


def story(rng, size, windows):
    """Codes and holds of a level that rests, is sheared at one speed and at a higher one, drifts and falls;
    with noise, some windows held and some at the end of the range."""
    full, length = (1 << size.sample_bits - 1) - 1, 1 << size.window_log2
    levels, rest = [], (1 << size.settle_log2) + 2
    while len(levels) < windows:
        vi, v = rng.uniform(1.9, 4.1), rng.uniform(0.15, 2.8)
        k = 1.55 - 0.27 * vi
        levels += [vi] * int(rng.integers(rest - 2, rest + 3))
        levels += [vi + rng.choice([-0.011, 0.005, 0.15])] * int(rng.integers(0, 3))
        for faster in (v, v * rng.choice([1.0, 1.1, 1.3])):
            levels += [vi + k * faster**0.11] * int(rng.integers(1, 12))
            levels += [levels[-1] + rng.choice([-0.011, -0.004, 0.005])] * int(rng.integers(0, 2))
        levels += [5.0] * (rng.random() < 0.3)
    volts = np.repeat(levels[:windows], length)
    codes = np.clip(np.rint(volts * full / 5 + rng.normal(0, 0.7, volts.shape)), -full - 1, full).astype(int)
    held = np.repeat(rng.random(windows) < 0.03, length) & (rng.random(len(codes)) < 0.5)
    return codes, held


@bench.applies(lambda dut: size_of(dut).sample_bits > 12)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.3])
async def matches_model(dut, stall_rate):
    size = size_of(dut)
    rng = np.random.default_rng(bench.SEED)
    long_rest = size.window_log2 >= 4 and size.settle_log2 <= 3  # it takes many clocks
    windows = 130 if long_rest else bench.rounds(400)
    seen = 0
    for given in ({}, {"n": 0.5, "k1": 0.11, "limit": 0.2, "travel": 0.6e-5 * (1 << size.window_log2)}):
        settings = settings_of(size, **given)
        await begin(dut, settings)
        codes, held = story(rng, size, windows)
        stalls = bench.gaps_and_stalls(stall_rate / 8, stall_rate)
        got = await bench.stream(dut, beats_of(codes, held), FIELDS, *stalls, drain=80)
        assert all_of(got) == of_model(settings, size, codes, held)
        seen |= int(np.bitwise_or.reduce([beat["flags"] for beat in got]))
        assert any(beat["flags"] == OK for beat in got)
    assert seen & (UNSETTLED | SMALL | CLIPPED | RISING) == UNSETTLED | SMALL | CLIPPED | RISING


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_model_whatever_is_set(dut):
    """Random registers and levels, which need not make sense."""
    size = size_of(dut)
    rng, length = np.random.default_rng(bench.SEED), 1 << size.window_log2
    low, high = bench.width(size.sample_bits)
    await begin(dut, HAND)
    for _ in range(bench.rounds(12) if length < 16 else 3):
        settings = any_settings(rng, size)
        put(dut, settings)
        places = rng.choice(
            [low, -1, 0, 1, settings.full - 1, settings.full, high, *rng.integers(low, high, 3)], 9
        )
        codes = np.repeat(rng.choice(places, 40 * length // 8), 8)[: 40 * length]
        codes = np.clip(codes + rng.integers(-1, 2, codes.shape), low, high)
        held = np.repeat(rng.random(40) < 0.05, length)[: len(codes)]
        stalls = bench.gaps_and_stalls(0.05, 0.3)
        got = await bench.stream(dut, beats_of(codes, held), FIELDS, *stalls, drain=80)
        assert all_of(got) == of_model(settings, size, codes, held)


@bench.applies(lambda dut: size_of(dut).sample_bits > 12 and size_of(dut).window_log2 < 4)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_model_where_comparisons_are_met(dut):
    """A register equal to the value in a window of the story, one below and one above; speeds of any size."""
    size = size_of(dut)
    rng = np.random.default_rng(bench.SEED)
    await begin(dut, HAND)
    met = dict.fromkeys(("limit", "vi_min", "vi_max", "noise"), 0)
    while min(met.values()) < bench.rounds(4):
        share, n = ((1, 0.5), (4, 1.0), (8, 1.0), (12, 1.0))[int(rng.integers(4))]
        open_ = settings_of(size, k0=1.55 / share, k1=-0.27 / share, n=n, travel=0.0)
        open_ = replace(open_, limit=(1 << size.speed_bits) - 1)
        codes, held = story(rng, size, 60)
        found = ShearSpeed(open_, size).windows(codes, held)
        good = np.flatnonzero(found.flags == OK)
        if not len(good):
            continue
        at, name = rng.choice(good), min(met, key=met.get)
        made = {"limit": found.speed, "vi_min": found.vi, "vi_max": found.vi, "noise": found.rise}
        met[name], value = met[name] + 1, made[name][at]
        results = []
        for off in (-1, 0, 1):
            settings = replace(open_, **{name: int(value) + off})
            put(dut, settings)
            got = await bench.stream(dut, beats_of(codes, held), FIELDS, drain=80)
            assert all_of(got) == of_model(settings, size, codes, held)
            results.append(got[at]["flags"])
        by_hand = {"limit": [FAST, OK, OK], "vi_min": [OK, OK, RANGE], "vi_max": [RANGE, OK, OK]}
        assert results == by_hand.get(name, results)  # noise also changes what was rest earlier


def any_settings(rng, size):
    """Random registers over their full range, small values among them."""
    widths = {"k0": size.level_bits, "noise": size.level_bits, "still": size.level_bits}
    widths |= {"exponent": 16, "limit": size.speed_bits, "travel": 32}
    drawn = {
        name: int(rng.integers(0, 1 << bits)) >> int(rng.integers(0, bits)) for name, bits in widths.items()
    }
    k1, full = int(rng.integers(-(1 << 17), 1 << 17)), int(rng.integers(*bench.width(size.sample_bits)))
    low, high = bench.width(size.level_bits)
    ends = sorted(int(rng.integers(low, high + 1)) for _ in range(2))
    return ShearSettings(**drawn, k1=k1, full=full, vi_min=ends[0], vi_max=ends[1])


@bench.applies(lambda dut: size_of(dut) == SMALL_SIZE)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def says_vi_and_the_rise(dut):
    await begin(dut, HAND)
    codes, held = samples(LEVELS, SMALL_SIZE)
    got = await bench.stream(dut, beats_of(codes, held), FIELDS, drain=70)
    assert [(beat["vi"], beat["rise"]) for beat in got] == LEVELS_TOLD


def test_the_model_says_vi_and_the_rise():
    found = ShearSpeed(HAND, SMALL_SIZE).windows(*samples(LEVELS, SMALL_SIZE))
    assert list(zip(found.vi.tolist(), found.rise.tolist())) == LEVELS_TOLD


# 1 mm/s = 2^27: the 32nd window after the rise brings the travel to 2^32, where it saturates at 2^32 - 1.
LONG_SIZE = ShearSize(20, 3, 2, 8, 22, 32, 27)
LONG = replace(HAND, k0=32000, k1=-17694, vi_min=32000 - 1, vi_max=32000, limit=1 << 28, travel=(1 << 32) - 1)
LONG_LEVELS = [8000] * 4 + [8000 + 5840] * 41  # k = 32000 - floor(..) = 32000 - 8640 = 23360 = 4 x 5840
LONG_CASE = [-UNSETTLED] * 4 + [-RISING] * 32 + [1 << 27] * 9

# Rises of 4, 8 and 16 k with n = 1: speeds of 2^29, 2^30 and 2^31, some equal to the limit; windows of 8
# samples, Vi of 4 windows.
FAST_LEVELS, FAST_REST = [8000] * 4 + [8100, 8200, 8400], [-UNSETTLED] * 4
FAST_CASES = {
    name: ({"k0": 100, "k1": 0, "exponent": 2048, "travel": 0, "limit": limit}, FAST_LEVELS, FAST_REST + case)
    for name, limit, case in (
        ("no limit", (1 << 32) - 1, [1 << 29, 1 << 30, 1 << 31]),
        ("a limit of 16", 1 << 31, [1 << 29, 1 << 30, 1 << 31]),
        ("a limit below 16", (1 << 31) - 1, [1 << 29, 1 << 30, -FAST]),
        ("a limit of 4", 1 << 29, [1 << 29, -FAST, -FAST]),
    )
}
SLOW = {"k0": 100, "k1": 0, "exponent": 2048, "travel": 1, "noise": 8, "limit": 1 << 31}
LONG_CASES = {"the travel's end": ({}, LONG_LEVELS, LONG_CASE)} | FAST_CASES
LONG_CASES |= {  # a level is four times the sum: 8003 lies 12 above
    "rises by 12, still 11": (SLOW | {"still": 11}, [8000] * 4 + [8003], [*FAST_REST, -RISING]),
    "rises by 12, still 12": (SLOW | {"still": 12}, [8000] * 4 + [8003], [*FAST_REST, None]),
    "no noise and no rise": (SLOW | {"noise": 0}, [8000] * 5, [*FAST_REST, -SMALL]),
}

# From the lowest code to the highest below full, a rise of 131070: each register as wide as this needs.
WIDE_SIZE, WIDE_RISE = ShearSize(), 512 * (65534 + 65536)
WIDE = ShearSettings(
    **{"k0": WIDE_RISE, "k1": 0, "exponent": 65535, "vi_min": -(1 << 25), "vi_max": (1 << 25) - 1},
    **{"noise": WIDE_RISE, "still": WIDE_RISE, "full": 65535, "limit": ONE, "travel": ONE},
)
WIDE_LEVELS, WIDE_REST = [-64 * 65536] * 8 + [64 * 65534], [-UNSETTLED] * 8
HIGH_LEVELS = [64 * 65534] * 9
WIDE_CASES = {
    "all registers wide": ({}, WIDE_LEVELS, [*WIDE_REST, ONE]),
    "noise above it": ({"noise": WIDE_RISE + 1}, WIDE_LEVELS, [*WIDE_REST, -SMALL]),
    "still below it": ({"still": WIDE_RISE - 1}, WIDE_LEVELS, [*WIDE_REST, -RISING]),
    "travel above it": ({"travel": (1 << 32) - 1}, WIDE_LEVELS, [*WIDE_REST, -RISING]),
    "no travel": ({"travel": 0}, WIDE_LEVELS, [*WIDE_REST, ONE]),
    "all registers least": (  # a rise of 131070 k to the power of 0
        {"k0": 1, "exponent": 0, "noise": 0, "still": 0, "travel": 0},
        WIDE_LEVELS,
        [*WIDE_REST, ONE],
    ),
    "back at the rest": ({}, [*WIDE_LEVELS, -64 * 65536], [*WIDE_REST, ONE, -SMALL]),
    "falls by more at the ends": (
        {"still": WIDE_RISE - 1, "travel": 0},
        [*WIDE_LEVELS, -64 * 65536],
        [*WIDE_REST, ONE, -UNSETTLED],
    ),
    "Vi at the highest level": ({"vi_max": 512 * 65534}, HIGH_LEVELS, [*WIDE_REST, -SMALL]),
    "Vi above it": ({"vi_max": 512 * 65534 - 1}, HIGH_LEVELS, [*WIDE_REST, -(RANGE | SMALL)]),
}
BY_SIZE = {  # registers, cases
    SMALL_SIZE: (HAND, CASES),
    PAIR_SIZE: (PAIR, PAIR_CASES),
    LONG_SIZE: (LONG, LONG_CASES),
    WIDE_SIZE: (WIDE, WIDE_CASES),
}


@bench.applies(lambda dut: size_of(dut) in BY_SIZE)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def decides_by_hand(dut):
    size = size_of(dut)
    standard, cases = BY_SIZE[size]
    await begin(dut, standard)
    for name, (given, levels, case) in cases.items():
        settings = replace(standard, **given)
        put(dut, settings)
        codes, held = samples(levels, size)
        got = pairs(await bench.stream(dut, beats_of(codes, held), ["speed", "flags"], drain=70))
        check(case, got)
        by_twin = ShearSpeed(settings, size).process(codes, held)
        assert got == list(zip(*map(np.ndarray.tolist, by_twin))), name


@bench.applies(lambda dut: size_of(dut) == SMALL_SIZE)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """From a window's last sample to its result, with a flag or without; no sample is taken until the result
    left."""
    await begin(dut, HAND)
    codes, _ = samples([1000, 1729, 1040, 1729], SMALL_SIZE)
    dut.out_ready_i.value = 1
    accepted, seen = [], []
    for clock in range(8 + 4 * (LATENCY + 1)):
        dut.in_valid_i.value = int(len(accepted) < len(codes))
        dut.in_data_i.value = codes[min(len(accepted), len(codes) - 1)]
        await bench.ReadOnly()
        if bench.high(dut.in_valid_i) and bench.high(dut.in_ready_o):
            accepted.append(clock)
        if bench.high(dut.out_valid_o):
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert seen == [clock + LATENCY for clock in accepted[1::2]]
    assert accepted[2::2] == [clock + 1 for clock in seen[:-1]]
    assert accepted[1::2] == [clock + 1 for clock in accepted[::2]]


@bench.applies(lambda dut: size_of(dut) == SMALL_SIZE)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def forgets_what_a_reset_or_a_restart_interrupts(dut):
    """At any clock of a window's computation, at any sample of a window; the known level is discarded too."""
    await begin(dut, HAND)
    codes, held = samples([1000, 1729, 1729], SMALL_SIZE)
    for delay in range(0, LATENCY + 4, 3):
        await bench.stream(dut, beats_of(codes, held)[: 4 + delay % 3], [], drain=80)
        dut.in_valid_i.value = 1
        bench.offer(dut, {"data": 1729, "hold": delay % 2, "restart": 0})
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        beats = [beat | {"restart": 0} for beat in beats_of(codes, held)]
        got = pairs(await bench.stream(dut, beats, ["speed", "flags"], drain=80))
        assert got == [(0, UNSETTLED), (ONE, OK), (ONE, OK)]
    # A restart in the middle of a window: its sample begins a window.
    part = beats_of([500, 500, 864], [False, False, True])
    again = beats_of(codes[:4], held[:4])
    got = pairs(await bench.stream(dut, part + again, ["speed", "flags"], drain=80))
    assert got == [(0, UNSETTLED), (0, UNSETTLED), (ONE, OK)]


EVIDENCE = {
    "equivalence": {
        "boxes": True,
        "size": {
            "SampleBits": 5,
            "WindowLog2": 1,
            "SettleLog2": 1,
            "TableBits": 3,
            "FractionBits": 6,
            "SpeedBits": 8,
            "SpeedFraction": 6,
        },
    },
    "faults": {
        "size": {"SampleBits": 13, "WindowLog2": 1, "SettleLog2": 1},
        "settle": 100,  # 50 windows: within them a fall or a hold discards the level that a fault changed
        "driver": {"phases": 2},
    },
}

SPACE = lambda draw: {
    "SampleBits": draw.randint(13, 20),
    "WindowLog2": draw.randint(1, 5),
    "SettleLog2": draw.randint(0, 4),
    "FractionBits": draw.randint(12, 20),
}

SIZES = [
    {},
    {"SampleBits": 13, "WindowLog2": 1, "SettleLog2": 0},
    {"SampleBits": 13, "WindowLog2": 1, "SettleLog2": 1},
    {"SampleBits": 20, "WindowLog2": 3, "SettleLog2": 2, "TableBits": 8, "FractionBits": 22, "SpeedBits": 32}
    | {"SpeedFraction": 27},
    EVIDENCE["equivalence"]["size"],
]


@pytest.mark.parametrize("parameters", SIZES, ids=lambda p: "-".join(map(str, p.values())) or "default")
def test_shear_speed(parameters):
    bench.run("slip", "shear_speed", parameters)


@pytest.mark.parametrize(
    "size, standard, given, levels, case",
    [(size, standard, *case) for size, (standard, cases) in BY_SIZE.items() for case in cases.values()],
    ids=[name for _, cases in BY_SIZE.values() for name in cases],
)
def test_decisions_by_hand(size, standard, given, levels, case):
    block = ShearSpeed(replace(standard, **given), size)
    codes, held = samples(levels, size)
    check(case, list(zip(*block.process(codes, held))))
    pieces = [block.next(codes[at : at + 3], held[at : at + 3]) for at in range(0, len(codes), 3)]
    block.reset()
    pieces = [block.next(codes[at : at + 3], held[at : at + 3]) for at in range(0, len(codes), 3)]
    check(case, list(zip(*np.concatenate(pieces, axis=1))))


def test_registers_from_volts_by_hand():
    """13107 codes a volt, levels of 512 samples, windows of 64 at 10 kHz: 6710784 a volt, 6.4 ms."""
    found = ShearSettings.of(13_107, 10_000, noise=0.2, still=0.01003, travel=0.0096)
    assert found == ShearSettings(
        **{"k0": 10_401_715, "k1": -17_695, "exponent": 18_618, "vi_min": 13_421_568, "vi_max": 26_843_136},
        **{"noise": 1_342_157, "still": 67_309, "full": 65_404, "limit": 3 << 20, "travel": 3 << 19},
    )


@pytest.mark.parametrize("table_bits, fraction_bits, percent", [(6, 16, 0.05), (4, 12, 0.75), (8, 20, 0.05)])
def test_formula_against_float64(table_bits, fraction_bits, percent):
    """0.01 to 3 mm/s, Vi of 2 to 4 V, a converter of 17 bits: within the bound plus half an LSB of the
    registers' own formula; within ``percent`` of the true speed, at most 2 % at the default."""
    size = ShearSize(table_bits=table_bits, fraction_bits=fraction_bits)
    per_v = 65535 / 5
    settings = ShearSettings.of(per_v, 10_000, size)
    v, vi = np.meshgrid(np.geomspace(0.01, 3.0, 400), np.linspace(2, 4, 101))
    code_vi = np.rint(vi * per_v * size.unit).astype(np.int64)
    code_rise = np.rint((1.55 - 0.27 * vi) * v**0.11 * per_v * size.unit).astype(np.int64)
    k = twin.denominator(code_vi, settings)
    got = speed(code_rise, k, settings, size) / float(1 << size.speed_fraction)
    registers = (code_rise / k) ** (settings.exponent / 2048)
    assert (
        np.abs(got - registers) <= twin.bound(settings.exponent, size) * registers + 0.5 / (1 << 20)
    ).all()
    assert 100 * np.abs(got / v - 1).max() < percent + 0.01
    assert percent < 2


@pytest.mark.parametrize("exponent", [1, 2047, 2048, 65535])
def test_n_at_its_limits(exponent):
    """From n = 2048 to 1/32; ratios at which the speed neither rounds to 0 nor saturates."""
    settings = replace(HAND, exponent=exponent)
    rise = np.array([1, 2, 700, 728, 729, 730, 800, 5000])
    exact = (rise / 729) ** (exponent / 2048)
    got = speed(rise, 729, settings) / ONE
    bound = twin.bound(exponent)
    shown = exact < 15.9
    assert (np.abs(got - exact) <= bound * exact + 0.5 / ONE)[shown].all() and shown.sum() >= 6
    assert (got[~shown] >= 15.9 * (1 - bound)).all()


def test_the_product_with_1_over_n_is_rounded_half_up():
    """log2(3) = 103872/65536, so y = ±38336; times 16/2048 it is ±299.5. In the table 2^(1/64) - 1 is
    2855/2^18; 2855 · 300 >> 10 = 836 and 4 (2^18 + 836) = 1051920. -299: entry 63 one octave down, r 725."""
    settings = replace(HAND, exponent=16)
    assert speed(3, 2, settings) == 1051920
    t63, t64 = round(2**18 * (2 ** (63 / 64) - 1)), 1 << 18
    mantissa = (1 << 18) + t63 + ((t64 - t63) * 725 >> 10)
    assert speed(2, 3, settings) == 2 * mantissa  # 2^-1, and 20 fraction bits in place of 18


@pytest.mark.parametrize("rest_v, v", [(2.0, 0.05), (3.0, 0.4), (4.0, 2.7)])
def test_on_the_rubber_of_the_physics(rest_v, v):
    """A shear after a rest: every reported speed is within 2 %, from the travel that the page states on.
    After the shear stops, the level may fall by ``still`` before the stop is detected."""
    size, rate = ShearSize(), 10_000
    settings = ShearSettings.of(13107, rate, size)
    travelled = 0.06  # mm
    edges = np.arange(0, 0.5 + travelled / v + 0.5, 1 / rate)
    speeds = np.where((edges > 0.5) & (edges < 0.5 + travelled / v), v, 0.0)
    level = rest_v + rubber.shear_gain(rest_v) * rubber.shear_level(edges, speeds)
    found, flags = ShearSpeed(settings, size).process(np.rint(level * 13107).astype(int))
    good = np.flatnonzero(flags == OK)
    at = (good + 1) * (1 << size.window_log2) / rate - 0.5  # the window's end, from the begin of the shear
    off = np.abs(found[good] / ONE / v - 1)
    sheared = at <= travelled / v
    assert sheared.any() and off[sheared].max() < 0.005
    assert off.max() < 9.2 * 0.0025 / rubber.shear_step(rest_v, v)
    assert (~sheared).sum() <= 2
    assert 0.02 / v < at.min() < 0.04 / v + 3 * 0.0064


def test_refuses_illegal_parameters():
    wrong = {"SampleBits": (3, 25), "WindowLog2": (0, 13), "SettleLog2": (9,), "SpeedBits": (7, 33)}
    for port, values in wrong.items():
        for value in values:
            assert f"{port} = {value}" in bench.refuses("shear_speed", {port: value})
            with pytest.raises(ValueError, match=f"{NAMES[port]} = {value} must lie"):
                ShearSize(**{NAMES[port]: value})
    for name, values in {
        **{"k0": (-1, 1 << 26), "k1": (-(1 << 17) - 1, 1 << 17), "exponent": (-1, 1 << 16)},
        **{"vi_min": (-(1 << 25) - 1, 1 << 25), "limit": (-1, 1 << 24), "travel": (-1, 1 << 32)},
        **{"full": (-(1 << 16) - 1, 1 << 16), "noise": (1 << 26,), "still": (-1,)},
    }.items():
        for value in values:
            with pytest.raises(ValueError, match=f"{name} = {value} must lie"):
                replace(HAND, **{name: value}).check(ShearSize())
            inside = value - 1 if value > 0 else value + 1
            replace(HAND, **{name: inside}).check(ShearSize())
    with pytest.raises(ValueError, match="no such setting: Travel, speed"):
        ShearSettings.of(819.2, 10_000, speed=1, Travel=2)
