"""msn_am_demod against its model, and the model against NumPy's FFT and exact sums: each form; 4, 8 and 16
samples a period, 1 to 8 lanes; full scale at every phase, over-range, saturation, all shifts; settling and
extra samples, measurements cut short; offsets, phases; gaps and stalls, registers that change, reset in
mid-measurement, exact clocks, measurements back to back."""

import random
from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.frontend.am_demod import IQ, IQ_FAST, RECTIFIER, AmDemod, references

FIELDS = ["data~", "id", "last", "user"]
PORTS = ("Form", "SamplesPerPeriod", "Lanes", "Channels", "SampleBits", "PeriodBits", "SkipBits")


def demod_of(dut):
    return AmDemod(*(getattr(dut, name).value.to_unsigned() for name in PORTS))


def packed(beats, bits):
    """The beats with their lanes packed into words."""
    mask = (1 << bits) - 1
    for beat in beats:
        words = [(value & mask) << (lane * bits) for lane, value in enumerate(beat["data"])]
        flags = [bool(flag) << lane for lane, flag in enumerate(beat["user"])]
        yield beat | {"data": sum(words), "user": sum(flags)}


def taxel(demod, rng, kind, length, index):
    """Samples of one taxel of all lanes, as beats: ``length`` samples from the start on."""
    low, high = bench.width(demod.sample_bits)
    n, lanes = demod.samples_per_period, demod.lanes
    time = np.arange(length)
    phase = rng.uniform(0, 2 * np.pi, (lanes, 1))
    amplitude = rng.uniform(0, 1, (lanes, 1)) ** rng.choice([1, 3]) * high
    offset = rng.uniform(-1, 1, (lanes, 1)) * (high - amplitude)
    data = amplitude * np.cos(2 * np.pi * time / n + phase) + offset
    if kind == "square":  # gives the largest sums of I, of Q or of both, of either sign
        which = rng.integers(0, 3, lanes), rng.choice([-1, 1], lanes)
        i, q = references(n)
        reference = np.tile([i, q, i + q], length // n + 2)
        data = np.array([s * reference[w][1 : length + 1] for w, s in zip(*which)], dtype=float)
        data = np.roll(np.where(data > 0, high, low), rng.integers(0, n), axis=1)
    elif kind == "random":
        data = rng.integers(low, high + 1, (lanes, length)).astype(float)
    elif kind == "constant":
        data = np.full((lanes, length), rng.choice([low, high, 0, -1, 1])).astype(float)
    elif kind == "small":
        data = rng.integers(-2, 3, (lanes, length)).astype(float)
    codes = np.clip(np.rint(data), low, high).astype(int)
    user = rng.random((lanes, length)) < rng.choice([0, 0, 0.5 / length, 0.3])
    group = int(rng.integers(0, demod.channels // lanes)) * lanes
    last = bool(rng.integers(0, 2))
    return [
        {
            "data": codes[:, t].tolist(),
            "user": user[:, t].tolist(),
            "start": t == 0,
            "id": group if t == 0 else int(rng.integers(0, demod.channels)),
            "last": last if t == 0 else bool(rng.integers(0, 2)),
        }
        for t in time
    ]


KINDS = ["square", "constant", "sine", "random", "small", "sine", "square"]


def sequence(demod, rng, periods, skip, taxels):
    """Taxels, some with exactly enough samples, some with extra ones, some cut short; first some without a
    start."""
    whole = skip + (periods or 1 << demod.period_bits) * demod.samples_per_period
    beats = [beat | {"start": False} for beat in taxel(demod, rng, "random", 5, 0)]
    extra = [0, 0, 0, 1, demod.samples_per_period, -1, 1 - whole]
    for index in range(taxels):
        if index % len(extra) == 0:  # each of them equally often
            rng.shuffle(extra)
        beats += taxel(demod, rng, KINDS[index % len(KINDS)], whole + extra[index % len(extra)], index)
    return beats + taxel(demod, rng, "sine", whole, 0)


SETTINGS = [(1, 0, 0), (1, 3, 1), (3, 1, 4), (2, 0, 2), (2, 200, 31), (0, 2, 8)]  # periods, skip, shift


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "broken_o", wiggled=["in_valid_i", "in_start_i"], again=False)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """Every sample begins a measurement."""
    idle = dict.fromkeys(("in_data_i", "in_user_i", "in_id_i", "in_last_i", "cfg_shift_i"), 0)
    await bench.start(dut, cfg_periods_i=3, cfg_skip_i=1, in_start_i=1, **idle)
    await bench.counts_on(dut, "broken_o", in_valid_i=1, out_ready_i=1)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.6], setting=range(len(SETTINGS)))
async def matches_model(dut, stall_rate, setting):
    demod = demod_of(dut)
    periods, skip, shift = SETTINGS[setting]
    skip %= 1 << demod.skip_bits
    rng = np.random.default_rng([bench.SEED, setting, bool(stall_rate)])
    taxels = 21 if periods else 7
    beats = sequence(demod, rng, periods, skip, taxels)
    expected, broken = demod.process(beats, periods, skip, shift)
    await bench.start(dut, cfg_periods_i=periods, cfg_skip_i=skip, cfg_shift_i=shift)
    gaps, stalls = bench.gaps_and_stalls(stall_rate / 3, stall_rate)
    sent = list(packed(beats, demod.sample_bits))
    drain = demod.latency(shift) + 9
    assert await bench.stream(dut, sent, FIELDS, gaps, stalls, drain) == expected
    assert bench.read(dut.broken_o) == broken
    assert len(expected) > demod.lanes * taxels // 2


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def registers_count_at_the_start_of_a_taxel(dut):
    """Registers that change with every sample except the first of each taxel: only the first must count."""
    demod = demod_of(dut)
    rng = np.random.default_rng(bench.SEED)
    beats = sequence(demod, rng, 2, 1, 6)
    expected, _ = demod.process(beats, 2, 1, 3)
    await bench.start(dut)
    draw = random.Random(bench.SEED)

    class Wandering(list):
        """Beats that set the registers when they are fetched."""

        def __getitem__(self, index):
            beat = super().__getitem__(index)
            right = beat["start"]
            dut.cfg_periods_i.value = 2 if right else draw.randrange(1 << demod.period_bits)
            dut.cfg_skip_i.value = 1 if right else draw.randrange(1 << demod.skip_bits)
            dut.cfg_shift_i.value = 3 if right else draw.randrange(32)
            return beat

    sent = Wandering(packed(beats, demod.sample_bits))
    assert await bench.stream(dut, sent, FIELDS, drain=demod.latency(3) + 9) == expected


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """A sample every clock: each lane's amplitude comes in its clock; samples stall only for the lanes
    before."""
    demod = demod_of(dut)
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut, cfg_skip_i=0, out_ready_i=1, in_valid_i=0)
    for periods, shift in ((1, 0), (2, 5), (2, 30)):
        length = periods * demod.samples_per_period
        beats = [b for index in range(3) for b in taxel(demod, rng, "sine", length, index)]
        sent = list(packed(beats, demod.sample_bits))
        dut.cfg_periods_i.value, dut.cfg_shift_i.value = periods, shift
        await bench.reset(dut)
        ends, seen, at = [], [], 0
        for clock in range(4 * length + 4 * demod.lanes * demod.lane_clocks(shift) + demod.latency(shift)):
            dut.in_valid_i.value = int(at < len(sent))
            for name, value in sent[min(at, len(sent) - 1)].items():
                getattr(dut, f"in_{name}_i").value = int(value)
            await bench.ReadOnly()
            if dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1:
                at += 1
                if at % length == 0:
                    ends.append(clock)
            if dut.out_valid_o.value == 1:
                seen.append(clock)
            await bench.RisingEdge(dut.clk_i)
        lanes = range(demod.lanes)
        first = [ends[0] + demod.latency(shift) + demod.lane_clocks(shift) * lane for lane in lanes]
        assert seen[: demod.lanes] == first
        assert len(seen) == 3 * demod.lanes
        gap = max(length, demod.lanes * demod.lane_clocks(shift))
        if demod.lane_clocks(shift) > shift + 1:  # if the magnitude, not the shift after it, sets the pace
            assert seen[-1] - seen[-1 - demod.lanes] == gap
        assert ends[1] == ends[0] + length  # results are held while those of the lanes before leave


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def recovers_after_reset(dut):
    """Reset after any number of samples: no earlier result leaves, and later ones are complete."""
    demod = demod_of(dut)
    rng = np.random.default_rng(bench.SEED)
    beats = sequence(demod, rng, 1, 2, 3)
    expected, _ = demod.process(beats, 1, 2, 1)
    sent = list(packed(beats, demod.sample_bits))
    await bench.start(dut, cfg_periods_i=1, cfg_skip_i=2, cfg_shift_i=1)
    drain = demod.latency(1) + 9
    for cut in (6, 8, 9, 7 + demod.samples_per_period, 8 + demod.samples_per_period):
        for wait in (0, 1, 2, 3, 4, 5, drain // 2):
            await bench.stream(dut, sent[5 : 5 + cut], FIELDS, drain=1, count=0)
            for beat in sent[5 : 5 + cut]:
                dut.in_valid_i.value = 1
                bench.offer(dut, beat)
                await bench.clocks(dut, 1)
            dut.in_valid_i.value = 0
            await bench.clocks(dut, wait)
            await bench.reset(dut)
            assert await bench.stream(dut, sent, FIELDS, drain=drain) == expected


EVIDENCE = {
    "faults": {"settle": 3, "driver": {"frame": "in_start_i"}},
}


@pytest.mark.parametrize(
    "form, samples, lanes, sample_bits, period_bits",
    [
        (RECTIFIER, 4, 1, 17, 6),
        (IQ, 4, 1, 17, 6),
        (IQ_FAST, 8, 8, 13, 3),
        (RECTIFIER, 16, 3, 12, 2),
        (IQ, 8, 2, 17, 4),
        (IQ, 16, 1, 18, 5),
        (IQ_FAST, 16, 1, 4, 2),
    ],
)
def test_am_demod(form, samples, lanes, sample_bits, period_bits):
    parameters = {"Form": form, "SamplesPerPeriod": samples, "Lanes": lanes, "SampleBits": sample_bits}
    bench.run("frontend", "am_demod", parameters | {"PeriodBits": period_bits})


def carrier(samples, periods, amplitude, phase, offset=0.0):
    """A carrier as real numbers [..., periods * samples]; the arguments broadcast."""
    time = 2 * np.pi * np.arange(samples * periods) / samples
    phase, amplitude, offset = (np.asarray(v, dtype=float)[..., None] for v in (phase, amplitude, offset))
    return amplitude * np.cos(time + phase) + offset


@pytest.mark.parametrize("samples", [4, 8, 16])
def test_iq_against_a_lock_in(samples):
    """With 4 samples a period the FFT's bin, for any samples; otherwise a noise-free carrier's bin."""
    demod = AmDemod(IQ, samples, sample_bits=18, period_bits=5)
    rng = np.random.default_rng(samples)
    periods = 7
    x = rng.integers(-(2**17), 2**17, (2000, samples * periods))
    if samples > 4:
        x = np.rint(
            carrier(samples, periods, rng.uniform(0, 1.2e5, 2000), rng.uniform(0, 7, 2000), 3000.0)
        ).astype(np.int64)
    bin_amplitude = 2 * np.abs(np.fft.fft(x, axis=-1)[:, periods]) / (samples * periods)
    got, _ = demod.amplitude(x, 0)
    expected = np.minimum(demod.gain(periods) * bin_amplitude, 2**17 - 1)
    # 4: the same except for rounding; otherwise the rounding of the samples adds to other harmonics.
    bound = 0.5001 if samples == 4 else demod.gain(periods) * 0.05
    assert np.abs(got - expected).max() <= bound


@pytest.mark.parametrize("samples", [4, 8, 16])
@pytest.mark.parametrize("form", [RECTIFIER, IQ, IQ_FAST])
def test_sums_are_exact_and_rounded_once(form, samples):
    """Against exact integers and rationals, sample by sample."""
    demod = AmDemod(form, samples, sample_bits=14, period_bits=4)
    rng = np.random.default_rng(form * 100 + samples)
    period = references(samples)
    for shift in (0, 1, 2, 5, 13):
        x = rng.integers(-(2**13), 2**13, (100, 3 * samples))
        got, over = demod.amplitude(x, shift)
        for row, data, flag in zip(x.tolist(), got.tolist(), over.tolist()):
            i, q = (sum(v * int(period[part][k % samples]) for k, v in enumerate(row)) for part in (0, 1))
            if form == RECTIFIER:
                starts = [3 * samples // 3 * p + k for p in range(3) for k in range(samples // 2)]
                square = sum(abs(row[s + samples // 2] - row[s]) for s in starts) ** 2
            elif form == IQ:
                square = i * i + q * q
            else:
                big, little = max(abs(i), abs(q)), min(abs(i), abs(q))
                square = Fraction(max(8 * big, 7 * big + 4 * little), 8) ** 2
            # data - 1/2 <= M / 2**shift < data + 1/2, squared to avoid the root
            if flag:
                assert data == 2**13 - 1 and square >= (Fraction(2**14 - 1, 2) * 2**shift) ** 2
            else:
                assert max(Fraction(2 * data - 1, 2), 0) ** 2 * 4**shift <= square
                assert square < Fraction(2 * data + 1, 2) ** 2 * 4**shift


@pytest.mark.parametrize("form", [RECTIFIER, IQ, IQ_FAST])
def test_ends_of_the_range_by_hand(form):
    """12 bits end at 2047. Two samples half a period apart: M is their difference in every form."""
    demod = AmDemod(form, 4, sample_bits=12, period_bits=2)
    for first, other, shift, data, over in (
        (2045, -1, 0, 2046, False),
        (2047, 0, 0, 2047, False),  # the greatest value itself is not over-range
        (2047, -1, 0, 2047, True),
        (2047, -2046, 1, 2047, False),  # 2046.5 rounds up
        (2047, -2047, 1, 2047, False),  # 2047
        (2047, -2048, 1, 2047, True),  # 2047.5 rounds up
        (2, -1, 1, 2, False),
    ):
        got = demod.amplitude([first, 0, other, 0], shift)
        assert (int(got[0]), bool(got[1])) == (data, over), (first, other, shift)


def samples(values, over=()):
    """Beats of one lane, the first of which starts a measurement; ``over``: places of over-range samples."""
    return [
        {"data": [value], "user": [place in over], "start": place == 0, "id": 3, "last": True}
        for place, value in enumerate(values)
    ]


def test_over_range_samples_by_hand():
    """An over-range sample marks its measurement; one while settling or after it does not."""
    demod = AmDemod(IQ, 4, sample_bits=12, period_bits=2, skip_bits=3)
    values = [7, 7, 7, 40, 0, 30, 0, 40, 0, 30, 0, 9]  # three settle, two periods, one extra
    for place in range(12):
        results, _ = demod.process(samples(values, {place}), 2, 3, 0)
        # I = 2 (40 - 30), Q = 0
        assert results == [{"data": 20, "id": 3, "last": 1, "user": int(3 <= place < 11)}], place


@pytest.mark.parametrize("last", [0, 1])
def test_lanes_by_hand(last):
    """Lane k has the id of lane 0 plus k; only the last lane ends the frame, if the start carries
    ``last``."""
    demod = AmDemod(IQ, 4, lanes=3, sample_bits=12, period_bits=2)
    sizes = (40, 7, 300)
    beats = [
        {"data": [turn * size for size in sizes], "user": [0, place == 2, 0], "start": place == 0}
        | ({"id": 6, "last": last} if place == 0 else {"id": 9, "last": 1 - last})
        for place, turn in enumerate((1, 0, -1, 0))
    ]
    assert demod.process(beats, 1, 0, 1)[0] == [
        {"data": 40, "id": 6, "last": 0, "user": 0},
        {"data": 7, "id": 7, "last": 0, "user": 1},
        {"data": 300, "id": 8, "last": last, "user": 0},
    ]


def test_measurements_cut_off_by_hand():
    """A measurement is counted if the next start finds it incomplete, also while it settles."""
    demod = AmDemod(IQ, 4, sample_bits=12, period_bits=2, skip_bits=3)
    whole = samples([7, 7, 7, 40, 0, 30, 0])
    for cut in range(1, 7):
        results, broken = demod.process(whole[:cut] + whole, 1, 3, 0)
        assert (len(results), broken) == (1, 1), cut
    assert demod.process(whole + whole, 1, 3, 0)[1] == 0
    assert demod.process(whole[1:] + whole, 1, 3, 0)[1] == 0  # nothing had started


@pytest.mark.parametrize("samples", [4, 8, 16])
@pytest.mark.parametrize("form", [RECTIFIER, IQ, IQ_FAST])
def test_any_constant_offset_changes_nothing(form, samples):
    demod = AmDemod(form, samples)
    rng = np.random.default_rng(1)
    x = rng.integers(-1000, 1001, (50, 3 * samples))
    without, _ = demod.amplitude(x, 2)
    for offset in (-64000, -1, 1, 2048, 64000):
        assert np.array_equal(demod.amplitude(x + offset, 2)[0], without)


@pytest.mark.parametrize(
    "form, samples, spread",
    [
        (IQ, 4, 2e-4),
        (IQ, 8, 2e-4),
        (IQ, 16, 2e-4),
        (IQ_FAST, 4, 0.0388),
        (IQ_FAST, 16, 0.0388),
        (RECTIFIER, 4, 0.4143),
        (RECTIFIER, 8, 0.0825),
        (RECTIFIER, 16, 0.0197),
    ],
)
def test_phase(form, samples, spread):
    """Largest to smallest amplitude over all phases, minus one: 0 with I and Q, 1/cos(pi/N) - 1 rectified."""
    demod = AmDemod(form, samples, sample_bits=17)
    phases = np.linspace(0, 2 * np.pi, 4001)
    x = np.rint(carrier(samples, 8, 30_000, phases)).astype(np.int64)
    got, over = demod.amplitude(x, int(np.ceil(np.log2(demod.gain(8) / 1.5))))
    assert not over.any()
    assert got.max() / got.min() - 1 <= spread
    if form != IQ:
        assert got.max() / got.min() - 1 >= 0.95 * spread
    assert got.mean() == pytest.approx(
        30_000 * demod.gain(8) / 2 ** int(np.ceil(np.log2(demod.gain(8) / 1.5))), rel=1e-3
    )


def test_model_refuses_what_it_cannot_measure():
    demod = AmDemod(sample_bits=12, period_bits=2)
    for x, message in (
        (np.zeros(3), "not 1 .. "),
        (np.zeros(6), "not 1 .. "),
        (np.zeros(20), "not 1 .. "),
        (np.full(4, 2048), "does not fit 12 bits"),
    ):
        with pytest.raises(ValueError, match=message):
            demod.amplitude(x, 0)
    with pytest.raises(ValueError, match="shift = 32"):
        demod.amplitude(np.zeros(4), 32)


test_refuses_illegal_parameters = refusals(
    "am_demod",
    AmDemod,
    *({"Form": 3}, {"SamplesPerPeriod": 6}, {"Lanes": 9}, {"Channels": 0}, {"SampleBits": 19}),
    *({"PeriodBits": 13}, {"SkipBits": 0}),
)
