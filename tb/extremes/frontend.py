"""Extremes of rtl/frontend: codes and gains at their ends, unlimited drift, clocks."""

from fractions import Fraction
from functools import partial
from math import ceil

import hypothesis.strategies as st
import numpy as np

from extremes.rows import row
from meissner.twins.frontend import (
    adc_single,
    adc_spi,
    am_demod,
    calibrate,
    health,
    health_taxel,
    scan_plan,
    tare,
)
from reference import exact
from reference.health import HealthReference
from reference.tare import TareReference

TOP = 65535


def parts(see):
    """Every part at the ends of clock and SCLK, by "One bit" in docs/adc.md."""
    for part in adc_spi.PARTS.values():
        rates = [1, 2, part.sclk_min_khz, 1000, part.sclk_max_khz - 1, part.sclk_max_khz]
        for one in see.covering(
            clk=[1, 476, 477, 2_857, 2_858, 12_000, 25_000, 133_333, 399_999, 400_000],
            sclk=sorted(set(rates)),
            channels=[1, 2, 7, 8],
        ):
            yield part, one


def fits(part, half, clk, sclk):
    """SCLK does not exceed its bound, and 2 half - 1 clocks last at least the access time plus 7 ns."""
    return Fraction(clk, 2 * half) <= sclk and (2 * half - 1) * 10**6 >= (part.access_ns + 7) * clk


@row("adc_spi", {"": "0 clocks"})
def adc_spi_(see):
    for part, one in parts(see):
        rough = ceil(Fraction(one["clk"], 2 * one["sclk"]))
        least = next(half for half in range(rough, 10**6) if fits(part, half, one["clk"], one["sclk"]))
        given = part, one["channels"], 1, one["clk"], one["sclk"]
        unseen = one["clk"] <= {"ad7606": 476, "ad7606c-16": 2857}.get(part.name, 0)  # two clocks of BUSY
        if unseen or one["clk"] < 2 * least * part.sclk_min_khz:
            see.refused(adc_spi.AdcSpi, *given)
            continue
        see.near(adc_spi.AdcSpi(*given).half, least, (part.name, one))
    for bad in (
        {"clk_khz": 0},
        {"clk_khz": 400_001},
        {"channels": 0},
        {"channels": 9},
        {"sclk_khz": 2_001},
        {"sclk_khz": 0},
        {"sample_bits": 12},
        {"period_bits": 0},
        {"period_bits": 33},
        {"lanes": 2},
    ):
        see.refused(adc_spi.AdcSpi, **bad)


@row("adc_single", {"": "0 clocks"})
def adc_single_(see):
    part = adc_spi.MCP3208
    for clk in (100, 1_000, 12_000, 100_000, 400_000):
        for sclk in (50, 1_000, 2_000):
            half = next(half for half in range(1, 10**6) if fits(part, half, clk, sclk))
            bit = next(1 << k for k in range(20) if 1 << k >= 2 * half)
            least = (part.word_bits + 1) * bit + 1  # a word, and CS high for a bit
            if clk < bit * part.sclk_min_khz:
                see.refused(adc_single.AdcSingle, 0, clk, sclk, least)
                continue
            twin = adc_single.AdcSingle(7, clk, sclk, least)
            see.near(twin.bit_clocks, bit, (clk, sclk))
            see.near(twin.latency, part.word_bits * bit + 1, (clk, sclk))
            see.refused(adc_single.AdcSingle, 0, clk, sclk, least - 1)
            values, over = twin.samples([0, 1, 4094, 4095])
            see.same(
                (values.tolist(), over.tolist()),
                ([0, 1, 4094, 4095], [True, False, False, True]),
                (clk, sclk),
            )
    for channel in (-1, 8):
        see.refused(adc_single.AdcSingle, channel)


@row("am_demod", {"": "1/2 LSB"})
def am_demod_(see):
    """Form 2 is the estimate, rounded once; the estimate's error from the root is covered by hypot."""

    def check(twin, rows, shift, place):
        got, over = twin.amplitude(rows, shift)
        top = 2 ** (twin.sample_bits - 1) - 1
        for samples, value, out in zip(rows, got.tolist(), over.tolist()):
            m = exact.demodulated(samples, twin.samples_per_period, twin.form)
            scaled = m / 2**shift
            see.near(value, min(scaled, Fraction(top)), place)
            # The root is known to half an LSB of M, so the rounding uses floor(2 M) / 2, as in the header.
            see.near(value, min(exact.half_up(scaled), top), place, limit=0)
            see.same(out, exact.half_up(scaled) > top, place)

    def fits(form, n, bits, periods):
        weights = n // 2 if form == 0 else 2 * sum(map(sum, exact.WEIGHTS[n])) // 2
        return bits + (max(weights, 1) - 1).bit_length() + periods <= 29

    for one in see.covering(
        fits, form=[0, 1, 2], n=[4, 8, 16], bits=[4, 13, 17, 18], periods=[1, 2, 6, 7, 8]
    ):
        form, n, bits, period_bits = one.values()
        try:
            twin = am_demod.AmDemod(form, n, sample_bits=bits, period_bits=period_bits)
        except ValueError:
            continue
        low, high = exact.signed(bits)
        periods = 2**period_bits if see.long else min(2**period_bits, 8)
        square = [high] * (n // 2) + [low] * (n // 2)
        shapes = [[0] * n, [high] * n, [low] * n, square, square[::-1], square[n // 4 :] + square[: n // 4]]
        shapes += [[low, high] * (n // 2), [1] + [0] * (n - 1), [high] + [0] * (n - 1), [0] * (n - 1) + [low]]
        shapes += [[high if (k * 4 // n) % 2 else low for k in range(n)]]
        rows = [shape * periods for shape in shapes]
        rows += [[*(square * periods)[:-1], square[-1] + 1]]
        for shift in sorted({0, 1, twin.sum_bits - bits + 1, twin.sum_bits, 31}):
            check(twin, rows, max(shift, 0), lambda: f"{one}, shift {shift}")
    base = am_demod.AmDemod(sample_bits=13)
    for bad in ([[0] * 5], [[0] * 0], [[0] * (4 * 65)], [[4096] * 4], [[-4097] * 4]):
        see.refused(base.amplitude, bad, 0)
    for shift in (-1, 32):
        see.refused(base.amplitude, [[0] * 4], shift)
    for bad in (
        {"form": 3},
        {"samples_per_period": 2},
        {"lanes": 0},
        {"lanes": 9},
        {"channels": 65537},
        {"sample_bits": 3},
        {"sample_bits": 19},
        {"period_bits": 0},
        {"period_bits": 28},
        {"skip_bits": 33},
    ):
        see.refused(am_demod.AmDemod, **bad)
    code = st.integers(*exact.signed(18))
    see.given(
        lambda form, samples, shift: check(
            am_demod.AmDemod(form, 8, sample_bits=18), [samples], shift, samples
        ),
        form=st.integers(0, 2),
        samples=st.lists(code, min_size=16, max_size=16),
        shift=st.integers(0, 31),
    )


@row("scan_plan", {"": "0 clocks"})
def scan_plan_(see):
    for one in see.covering(
        rows=[1, 2, 1023, 1024],
        columns=[1, 3, 1024],
        lanes=[1, 2, 7, 8],
        channels=[1, 7, 8],
        settle=[0, 1, 2**24 - 1],
    ):
        rows, columns, lanes, channels, settle = one.values()
        cycle = channels + 8
        twin = scan_plan.ScanPlan(rows, columns, lanes, channels, cycle=cycle, settle_bits=24)
        groups = ceil(Fraction(ceil(Fraction(columns, lanes)), channels))
        see.near(twin.groups, groups, one)
        # Triggers come Settle + 1 clocks after their switch and at least Cycle clocks apart; the next switch
        # is at least Hold clocks later.
        slot = max(settle + 3, cycle)
        see.near(twin.frame_clocks(settle), rows * groups * slot, one)
        places = twin.places(interleave=True)
        see.same(sorted(places), [(r, g) for r in range(rows) for g in range(groups)], one)
        if rows * groups < 5000:
            found, _ = twin.schedule(scan_plan.Settings(settle), twin.frame_clocks(settle) + scan_plan.START)
            see.near(found[-1].switch - found[0].switch, (rows * groups - 1) * slot, one)
            see.near(found[-1].trigger - found[-1].switch, settle + 1, one)
    for bad in (
        {"rows": 0},
        {"rows": 1025},
        {"columns": 1025},
        {"channels": 0},
        {"channels": 9},
        {"hold": 1},
        {"cycle": 15},
        {"settle_bits": 25},
        {"period_bits": 33},
        {"lanes": 9},
    ):
        see.refused(scan_plan.ScanPlan, **bad)


@row("health_taxel", {"": "0"})
def health_taxel_(see):
    """Each counter one below, at and beyond its ends, after 1e9 frames as after 255: it never wraps
    around."""
    for one in see.covering(
        count=[0, 1, 14, 15, 239, 240, 251, 252, 254, 255],
        limit=[0, 1, 239, 240, 255],
        pair=[0, 1],
        border=[0, 1],
        alone=[0, 1],
        tick=[0, 1],
    ):
        count, limit = one["count"], one["limit"]
        shape = (1,)
        ones = [np.array([value]) for value in (0, count, count, count, 0)]
        state = health_taxel.State(
            *ones, np.array([False]), np.array([True]), np.array([0]), np.array([False])
        )
        limits = health.Limits(band=24, jump=200, low=-5, high=TOP, still=limit, rail=limit, blink=limit)
        around = tuple(np.array([bool(one[name])]) for name in ("pair", "border", "alone"))
        judged = health_taxel.judge(
            state, np.full(shape, -5), np.zeros(shape, bool), around, limits, one["tick"]
        )
        proof = 4 if one["pair"] else one["border"]
        still, rail = min(count + proof, 255), min(count + one["tick"], 255)
        blink = min(count + 16, 255) if one["alone"] else max(count - 1, 0)
        after = judged.state
        see.all_near((after.still[0], after.rail[0], after.blink[0]), (still, rail, blink), [one] * 3)
        faults = sum(kind for kind, value in ((1, still), (2, rail), (4, blink)) if limit and value >= limit)
        see.near(after.faults[0], faults, one)
    for name in ("still", "rail", "blink"):
        for bad in (-1, 256):
            see.refused(health.Limits, **{name: bad})


@row("health", {"": "0"})
def health_(see):
    """Codes at both ends of 18 bits beside still, ramping and blinking taxels, for more frames than 255 x
    16."""
    low, high = exact.signed(18)
    sizes = see.covering(
        size=[(1, 1), (1, 4), (3, 1), (3, 4)],
        band=[0, 1, 2**18 - 1],
        jump=[0, 200, 2**18 - 1],
        still=[0, 1, 255],
        rail=[0, 1, 255],
        blink=[0, 17, 255],
        edges=[False, True],
        rails=[(low, high), (high, low), (-1, 1)],
    )
    for k, one in enumerate(sizes if see.long else sizes[::4]):
        (m, n), (least, most) = one["size"], one["rails"]
        given = {name: one[name] for name in ("band", "jump", "still", "rail", "blink", "edges")}
        given |= {"low": least, "high": most, "over_range_enable": True}
        twin, loop = health.Health(m, n, 1, 18, health.Limits(**given)), HealthReference(m, n, **given)
        draw, count = np.random.default_rng(see.seed + k), 600 if see.long else 120
        frames = draw.choice([low, low + 1, -1, 0, 1, high - 1, high], (count, m, n))
        frames[:, 0, 0] = 0  # one never changes
        frames[count // 2 :, -1, -1] = high  # one stays railed from here
        masks, _ = twin.next(frames, np.zeros(frames.shape, bool))
        for frame, codes in enumerate(frames.tolist()):
            see.same(
                masks[frame].tolist(),
                [[loop.faults(i, j) != 0 for j in range(n)] for i in range(m)],
                lambda: f"{one}, frame {frame}",
            )
            loop.frame(codes)
        see.same(twin.faults.tolist(), [[loop.faults(i, j) for j in range(n)] for i in range(m)], one)
    long_rail(see)


def long_rail(see):
    """1e9 frames of one code: the rail's count is 255 from frame 4080 on and stays there; checked by the
    state, which no longer changes.
    """
    twin = health.Health(1, 1, 1, 17, health.Limits(rail=0))
    twin.next(np.full((4200, 1, 1), TOP))
    held = int(twin._state.rail[0, 0])
    see.near(held, 255, "a rail of 4200 frames")
    before = [np.array(value) for value in twin._state]
    twin.next(np.full((64, 1, 1), TOP))
    for name, value, again in zip(twin._state._fields, before, twin._state):
        see.same(again.tolist(), value.tolist(), f"a state of 1e9 frames: {name}")


@row("tare", {"": "0"})
def tare_(see):
    """Compared with exact rationals: steps from the least to the greatest, samples at both ends, tared while
    pressed."""

    def fits(bits, fraction, tare_log2, **_):
        return tare_log2 <= min(fraction, 8) and bits + fraction >= 9

    for one in see.covering(
        fits,
        bits=[2, 8, 13, 17, 18],
        fraction=[1, 2, 7, 12, 16],
        tare_log2=[0, 1, 4, 8],
        contact=[0, 64, 2**18],
        step=[0, 1, 255],
    ):
        bits, fraction, tare_log2, contact, step = one.values()
        low, high = exact.signed(bits)
        twin = tare.Tare(1, 4, 1, bits, fraction, tare_log2, contact, step)
        loop = TareReference(4, fraction, tare_log2, contact, step, bits)
        pattern = [[high, low, 0, high], [high, low, 1, low], [high, low, -1, high], [high, low, 0, low]]
        count = 3 * 2**tare_log2 + 40
        for frame in range(count):
            if frame == 20:
                twin.tare(force=True)
                loop.tare(force=True)
            codes = [low] * 4 if frame > count - 8 else pattern[frame % 4]
            got = twin.next([[codes]])[0, 0].tolist()
            see.all_near(got, loop.frame(codes, [False] * 4), [lambda: f"{one}, frame {frame}"] * 4)
        zeros = [int(value) for value in twin._zero[:, 0]]
        room = exact.signed(bits + 1 + fraction)
        see.same(all(room[0] <= zero <= room[1] for zero in zeros), True, one)
    see.elaborates(
        "tare", see.covering(fits_rtl, SampleBits=[2, 8, 18], FractionBits=[1, 7, 16], TareLog2=[0, 8])
    )
    overshoot(see)
    drift(see)
    for bad in (
        {"fraction_bits": 0},
        {"fraction_bits": 17},
        {"tare_log2": 9},
        {"step": -1},
        {"step": 256},
        {"lanes": 9},
        {"sample_bits": 19},
        {"sample_bits": 2, "fraction_bits": 6, "tare_log2": 2},
    ):
        see.refused(tare.Tare, 1, 1, **{"lanes": 1} | bad)


def fits_rtl(SampleBits, FractionBits, TareLog2):
    return SampleBits + FractionBits >= 9 and TareLog2 <= FractionBits


def overshoot(see):
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


def drift(see):
    """1e9 samples that drift: the state is set to where that many steps of one LSB lead, then runs frame by
    frame.
    """
    for raw in (TOP, -TOP - 1):
        fraction, sign = 16, 1 if raw > 0 else -1
        for frames in (10**9, 2**32 - 1, (abs(raw) << 16) - 1):
            twin = tare.Tare(1, 1, 1, 17, fraction, 4, contact=2**17 - 1, step=1)
            loop = TareReference(1, fraction, 4, 2**17 - 1, 1)
            # The zero moves by one LSB per frame, down or up, until the remainder rounds to 0.
            moved = min(frames, (abs(raw) << 16) - (1 << 15) + (sign < 0))
            twin.next([[[0]]])  # the first frame sets the zeros
            twin._zero[:] = sign * moved
            loop.zeros = [Fraction(sign * moved, 1 << fraction)]
            for frame in range(40):
                see.near(twin.next([[[raw]]])[0, 0, 0], loop.frame([raw], [False])[0], (raw, frames, frame))
            see.near(int(twin._zero[0, 0]), loop.zeros[0] * 2**fraction, (raw, frames))


@row("grid_table", {"": "0"})
def grid_table_(see):
    for bits in (2, 13, 17, 18):
        low, high = exact.signed(bits - 1)
        for one in see.covering(
            row=[low, 0, high], column=[low, -1, high], gain=[0, 1, 65535], by=[0, 4096, 65535]
        ):
            twin = calibrate.GridTable(2, 3, 1, bits)
            twin.write_row(1, one["row"], one["gain"])
            twin.write(2, one["column"], one["by"])
            twin.swap()
            offset, gain = (int(words[1, 2]) for words in twin.words())
            see.near(offset, one["row"] + one["column"], (bits, one))
            see.near(gain, one["gain"] * one["by"], (bits, one))
        for outside in (low - 1, high + 1):
            see.refused(twin.write_row, 0, outside, 0)
            see.refused(twin.write, 0, outside, 0)
        for gain in (-1, 65536):
            see.refused(twin.write, 0, 0, gain)


def forces_(see, row_column):
    """The ends of either calibration."""
    gain_bits, kind = 32 if row_column else 16, partial(calibrate.Calibrate, row_column=row_column)
    top = 2**16 - 1 if gain_bits == 16 else (2**16 - 1) ** 2

    def check(raws, offset, gain, shift, bits):
        got = calibrate.forces(raws, offset, gain, shift, sample_bits=bits, gain_bits=gain_bits).tolist()
        for raw, force in zip(raws, got):
            value = Fraction((raw - offset) * gain, 2**shift)
            place = f"({raw} - {offset}) {gain} / 2^{shift}, {bits} bits"
            see.near(force, exact.held(value, Fraction(0), Fraction(TOP)), place)
            see.near(force, exact.held(exact.half_up(value), 0, TOP), place, limit=0)

    def fits(bits, gain, shift, offset):
        return bits + gain_bits + 2 - shift >= 16  # otherwise the product has fewer than 16 bits

    for one in see.covering(
        fits,
        bits=[2, 13, 17, 18],
        gain=[0, 1, 4096, top - 1, top],
        shift=[1, 2, 12, gain_bits - 1, gain_bits],
        offset=["low", "zero", "high"],
    ):
        low, high = exact.signed(one["bits"])
        offset = {"low": low, "zero": 0, "high": high}[one["offset"]]
        raws = set(exact.ends(low, high)) | {offset, offset + 1, offset - 1}
        if one["gain"]:  # where the force saturates
            edge = offset + (TOP << one["shift"]) // one["gain"]
            raws |= {edge - 1, edge, edge + 1}
        check(sorted(r for r in raws if low <= r <= high), offset, one["gain"], one["shift"], one["bits"])
    see.refused(kind, 1, 1, sample_bits=18)
    for shift in (0, gain_bits + 1):
        see.refused(kind, 1, 1, gain_shift=shift)
    see.same(kind(1, 1).next([[[TOP]]]).tolist(), [[[0]]], "before the first swap")
    code = st.integers(*exact.signed(18))
    see.given(
        lambda raw, offset, gain, shift: check([raw], offset, gain, shift, 18),
        raw=code,
        offset=code,
        gain=st.integers(0, top),
        shift=st.integers(1, gain_bits),
    )


@row("calibrate", {"": "1/2 LSB"})
def calibrate_(see):
    for row_column, gain_bits in ((0, 16), (1, 32)):
        forces_(see, bool(row_column))

        def room(SampleBits, GainShift, Offset, **_):
            return SampleBits + Offset <= 18 and SampleBits + Offset + gain_bits + 1 - GainShift >= 16

        sizes = {"SampleBits": [13, 17, 18], "GainShift": [1, gain_bits], "Lanes": [1, 8], "Offset": [0, 1]}
        see.elaborates("calibrate", see.covering(room, RowColumn=[row_column], **sizes))
