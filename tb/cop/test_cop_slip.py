"""msn_cop_slip against its model; the model against fractions and counted times: drops just above and just
below the fraction and at it, moves at the limit in every direction, octants at their limits, full scale, the
gate, hold and refractory of 0, some and many samples, exact to the sample, lags of 1 to 40; it finds the
published slip and its direction, and no slip in a slow or plain release; gaps, stalls, reset in each state,
exact clocks."""

from dataclasses import asdict, replace
from fractions import Fraction
from itertools import product
from math import atan2, pi

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters, octants

FIELDS = ["slip", "raised", "over", "dx~", "dy~", "octant", "pressed"]
SETS = [
    CopSlipRegisters(),
    CopSlipRegisters(128, 205, 400, 3, 5),
    CopSlipRegisters(0, 1, 0, 0, 2),
    CopSlipRegisters(255, 0, 1, 40, 0),
    CopSlipRegisters(51, 65535, 65535, 65535, 65535),
    CopSlipRegisters(100, 32768, 2, 1, 1),
    CopSlipRegisters(90, 20, 0x5A33, 2, 3),
    CopSlipRegisters(30, 9, 0xA5CC, 0, 1),
]


def samples_of(rng, lag, registers, count):
    """x, y, load, pressed [4, n]: steps, about a lag apart, with critical ratios and moves, then random
    samples."""
    x, y, load = ([int(rng.integers(-200, 200))] * lag for _ in range(3))
    load = [max(v, 0) + 1000 for v in load]
    move = min(registers.move, 32767)
    corners = [(-16384, -16384), (16384, 16384), (-16384, 16384), (16384, -16384)]
    corners += [(s * (move + e), 0) for s in (-1, 1) for e in (-2, -1, 0, 1, 2)]
    corners += [(0, s * (move + e)) for s in (-1, 1) for e in (-2, -1, 0, 1, 2)]
    corners += [(128 * sx, 53 * sy + e) for sx in (1, -1) for sy in (1, -1) for e in (-1, 0, 1)]
    corners += [(53 * sx + e, 128 * sy) for sx in (1, -1) for sy in (1, -1) for e in (-1, 0, 1)]
    for index in range(count):
        gate = [registers.min_load + e for e in (-1, 0, 1)]
        high = int(rng.choice([256, 512, 2560, 65280, int(rng.integers(1, 65536)), *gate]))
        low = high - high * registers.drop // 256 + int(rng.integers(-1, 2))
        rest = (0, 0) if registers.move < 16384 else (-16384, 16384)
        corner = corners[index % len(corners)] if index % 3 else rest
        for level, place in ((high, rest), (low, corner)):
            spread = int(rng.integers(1, lag + 2))
            load += [min(max(level, 0), 65535)] * spread
            x += [place[0]] * spread
            y += [place[1]] * spread
    x, y, load = (np.clip(v, -16384 if i < 2 else 0, 65535) for i, v in enumerate((x, y, load)))
    x, y = np.minimum(x, 16384), np.minimum(y, 16384)
    pressed = rng.random(len(load)) < 0.9
    wild = np.stack(
        [*rng.integers(-16384, 16385, (2, 200)), rng.integers(0, 65536, 200), rng.random(200) < 0.8]
    )
    return np.concatenate([np.stack([x, y, load, pressed]), wild], axis=1).astype(np.int64)


def beats_of(samples):
    return [dict(zip(("x", "y", "load", "pressed"), column)) for column in samples.T.tolist()]


def expected_of(samples, lag, registers):
    columns = [values.astype(int).tolist() for values in CopSlip(lag, registers).process(*samples)]
    columns.append(samples[3].tolist())  # passes through
    return [dict(zip((f.rstrip("~") for f in FIELDS), row)) for row in zip(*columns)]


def ports(registers):
    return {f"cfg_{name}_i": value for name, value in asdict(registers).items()}


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5], which=range(len(SETS)))
async def matches_model(dut, stall_rate, which):
    lag, registers = dut.Lag.value.to_unsigned(), SETS[which]
    samples = samples_of(np.random.default_rng(bench.SEED + which), lag, registers, bench.rounds(60))
    await bench.start(dut, **ports(registers))
    pauses = bench.gaps_and_stalls(stall_rate)
    expected = expected_of(samples, lag, registers)
    assert await bench.stream(dut, beats_of(samples), FIELDS, *pauses) == expected


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_bit_of_a_time_counts(dut):
    """Slips in a row, with one of the two times a power of two and the other 0."""
    lag, rng = dut.Lag.value.to_unsigned(), np.random.default_rng(bench.SEED)
    await bench.start(dut)
    for bit, held in product(range(16), (False, True)):
        times = (1 << bit, 0) if held else (0, 1 << bit)
        registers = CopSlipRegisters(26, 0, 1, *times)
        for name, value in ports(registers).items():
            getattr(dut, name).value = value
        await bench.reset(dut)
        samples = samples_of(rng, lag, registers, 1)[:, -150:]
        expected = expected_of(samples, lag, registers)
        assert sum(beat["raised"] for beat in expected) > 0
        assert await bench.stream(dut, beats_of(samples), FIELDS) == expected


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_time_ends_to_the_sample(dut):
    """One drop: slip is set for it and `hold` more samples; then drops are ignored for `refractory`
    samples."""
    lag = dut.Lag.value.to_unsigned()
    await bench.start(dut)
    for hold, refractory in ((0, 0xAAA), (0, 0x1555), (0xAAA, 0), (0x1555, 0), (5, 3)):
        for name, value in ports(CopSlipRegisters(26, 0, 1, hold, refractory)).items():
            getattr(dut, name).value = value
        await bench.reset(dut)
        first = lag + 3
        after = first + hold + 1
        again = after + refractory + 1
        loads = [1000] * again + [10]
        loads[first] = 100
        if refractory:
            loads[again - 1] = 100  # the last drop that is ignored
        beats = [{"x": 7, "y": -9, "load": load, "pressed": 1} for load in loads]
        got = await bench.stream(dut, beats, ["slip", "raised"], drain=9)
        assert [k for k, beat in enumerate(got) if beat["raised"]] == [first, again]
        assert [k for k, beat in enumerate(got) if beat["slip"]] == [*range(first, after), again]
        assert len(got) == again + 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def octants_end_where_the_header_says(dut):
    """The smaller side times 128 is at most 53 times the larger, or just more: many lengths, all eight
    octants."""
    lag = dut.Lag.value.to_unsigned()
    await bench.start(dut, **ports(CopSlipRegisters(26, 0, 1, 2, 3)))
    long = [1 << k for k in range(7, 15)] + [127, 255, 1023, 4095, 16383, 0x2A55, 0x155A, 0x3C3C, 11111]
    moves = []
    for larger in long:
        for smaller in (53 * larger // 128, 53 * larger // 128 + 1):
            near = smaller * 128 <= 53 * larger  # then the move lies along an axis, not a diagonal
            moves += [(larger, smaller, 0 if near else 1), (smaller, larger, 2 if near else 1)]
            moves += [(-smaller, larger, 2 if near else 3), (-larger, smaller, 4 if near else 3)]
    moves += [(0, 0, 0)] * (-len(moves) % lag)
    beats, expected = [], []
    for place in range(0, len(moves), lag):  # moves go out and back, `lag` of them interleaved
        some = moves[place : place + lag]
        beats += [
            {"x": x, "y": y, "load": 9, "pressed": 1} for x, y in [(0, 0)] * lag + [m[:2] for m in some]
        ]
        back = [(4 + octant) % 8 if x or y else 0 for x, y, octant in moves[max(0, place - lag) : place]]
        expected += (back or [0] * lag) + [octant for _, _, octant in some]
    got = await bench.stream(dut, beats, ["octant"], drain=9)
    assert [beat["octant"] for beat in got] == expected
    assert set(expected) == set(range(8))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def takes_five_samples_while_none_is_taken(dut):
    """One for each stage, back to back; the sixth stalls."""
    await bench.start(dut, **ports(SETS[0]), out_ready_i=0, in_x_i=1, in_y_i=2, in_load_i=9, in_pressed_i=1)
    dut.in_valid_i.value = 1
    for clock in range(9):
        await bench.ReadOnly()
        assert dut.in_ready_o.value == (clock < 5), f"clock {clock}"
        await bench.RisingEdge(dut.clk_i)
    dut.out_ready_i.value = 1
    await bench.ReadOnly()
    assert dut.in_ready_o.value == 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset(dut):
    """During a slip, its hold and its refractory time; a reset must leave no trace of it."""
    lag, registers = dut.Lag.value.to_unsigned(), CopSlipRegisters(10, 0, 1, 3, 4)
    samples = np.tile(np.array([[0], [0], [1000], [1]]), 2 * lag + 3)
    samples[2, lag + 1 :] = 100
    await bench.start(dut, **ports(registers))
    for cut in range(lag, 2 * lag + 3):
        await bench.stream(dut, beats_of(samples[:, :cut]), FIELDS, drain=1)
        await bench.reset(dut)
        assert await bench.stream(dut, beats_of(samples), FIELDS) == expected_of(samples, lag, registers)
        await bench.reset(dut)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    await bench.start(dut, **ports(SETS[0]), out_ready_i=1, in_x_i=0, in_y_i=0, in_load_i=9, in_pressed_i=1)
    dut.in_valid_i.value = 1
    await bench.clocks(dut, 3)
    dut.in_valid_i.value = 0
    for clock in range(3, 10):
        await bench.ReadOnly()
        assert dut.out_valid_o.value == (5 <= clock < 8), f"clock {clock}"
        await bench.RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {
        "size": {"Lag": 4},
        "reset": {"joined": (("seen_pair", "seen_valid"), ("size_pair", "size_valid"))},
    },
    "faults": {"short": {"TimerBits": 6}, "settle": 90},
}


@pytest.mark.parametrize("lag", [1, 4, 5, 40])
def test_cop_slip(lag):
    bench.run("cop", "cop_slip", {"Lag": lag})


@pytest.mark.parametrize("lag", [1, 7])
@pytest.mark.parametrize("registers", SETS, ids=str)
def test_model_against_fractions(lag, registers):
    """Sample by sample in exact rationals; times counted directly."""
    samples = samples_of(np.random.default_rng(2), lag, registers, 200)
    columns = samples.T.tolist()
    ended, last_over = -(10**9), 0  # samples: first after the last slip, last over in it
    slipping, seen = False, set()
    for k, got in enumerate(expected_of(samples, lag, registers)):
        x, y, load, pressed = columns[k]
        old = columns[k - lag] if k >= lag else (0, 0, 0, 0)
        dx = dy = over = 0
        if pressed and old[3] and old[2] >= registers.min_load:
            dx, dy = x - old[0], y - old[1]
            drops = old[2] > load and Fraction(old[2] - load, old[2]) > Fraction(registers.drop, 256)
            over = int(drops and max(abs(dx), abs(dy)) >= registers.move)
        was = slipping
        if was:
            last_over = k if over else last_over
            slipping = k - last_over <= registers.hold
            ended = ended if slipping else k
        elif over and k - ended > registers.refractory:
            slipping, last_over = True, k
        seen.add((over, int(slipping)))
        wanted = {
            "slip": int(slipping),
            "raised": int(slipping and not was),
            "over": over,
            "dx": dx,
            "dy": dy,
        }
        assert got == wanted | {"octant": int(octants(dx, dy)), "pressed": pressed}, k
    if registers.min_load < 65535:
        assert {(0, 0), (1, 1)} <= seen


def test_octants_against_angles():
    """All directions; within a tenth of a degree of a limit either octant is accepted."""
    a = np.linspace(0, 2 * pi, 3600, endpoint=False) + 1e-4
    dx, dy = np.round(30000 * np.cos(a)).astype(int), np.round(30000 * np.sin(a)).astype(int)
    turns = np.array([atan2(v, u) for u, v in zip(dx, dy)]) / (pi / 4)
    sure = abs(abs(turns % 1) - 0.5) > 0.1 / 45
    assert sure.mean() > 0.9
    assert np.array_equal(octants(dx, dy)[sure], np.round(turns[sure]).astype(int) % 8)
    assert octants(0, 0) == 0


def scene(kind, direction, rng):
    """At 1 kHz: 2 N held (1 mN an LSB), then at 500 ms a slip or a slow or fast release; noise of 1 %."""
    n = np.arange(1000)
    fall = {"slip": (10, 0.5), "slow release": (400, 1.0), "release": (10, 1.0)}[kind]
    ramp = np.clip((n - 500) / fall[0], 0, 1)
    load = 2000 * (1 - fall[1] * ramp) * (1 + 0.003 * rng.standard_normal(1000))
    step = 205 * ramp * (kind == "slip")  # 0.05 V of +-4 V
    x = 1000 + step * np.cos(direction) + 4 * rng.standard_normal(1000)
    y = -500 + step * np.sin(direction) + 4 * rng.standard_normal(1000)
    pressed = load >= 50
    rows = [np.where(pressed, x, 0), np.where(pressed, y, 0), np.maximum(load, 0), pressed]
    return np.round(np.stack(rows)).astype(np.int64)


@pytest.mark.parametrize("octant", range(8))
def test_finds_the_published_slip_and_its_direction(octant):
    """The load halves within 10 ms, the centre moves by 1.25 %: raised during the fall, with the right
    direction."""
    got = CopSlip(16, CopSlipRegisters(77, 80, 200, 20, 50)).process(
        *scene("slip", octant * pi / 4, np.random.default_rng(octant))
    )
    (at,) = np.flatnonzero(got.raised)
    assert 500 < at <= 510 and got.octant[at] == octant


@pytest.mark.parametrize("kind", ["slow release", "release"])
def test_a_release_is_no_slip(kind):
    got = CopSlip(16, CopSlipRegisters(77, 80, 200, 20, 50)).process(
        *scene(kind, 0, np.random.default_rng(1))
    )
    assert not got.slip.any()
    if kind == "release":  # only the missing move distinguishes it from a slip
        assert (
            CopSlip(16, CopSlipRegisters(77, 0, 200))
            .process(*scene(kind, 0, np.random.default_rng(1)))
            .slip.any()
        )


def test_model_in_chunks():
    samples = samples_of(np.random.default_rng(4), 5, SETS[1], 80)
    twin = CopSlip(5, SETS[1])
    whole = twin.process(*samples)
    twin.reset()
    parts = [twin.next(*part) for part in np.split(samples, [1, 2, 5, 6, 13, 50, 99], axis=1)]
    for index, values in enumerate(whole):
        assert np.array_equal(np.concatenate([part[index] for part in parts]), values)


def test_refuses_illegal_parameters():
    for name, value in (("Lag", 0), ("Lag", 4097), ("TimerBits", 0), ("TimerBits", 32)):
        assert f"{name} = {value}" in bench.refuses("cop_slip", {name: value})
    for lag, bits, message in (
        (0, 16, "lag = 0"),
        (4097, 16, "lag = 4097"),
        (1, 0, "timer_bits = 0"),
        (1, 32, "32"),
    ):
        with pytest.raises(ValueError, match=message):
            CopSlip(lag, timer_bits=bits)
    for sample, message in (
        ((32768, 0, 1, 1), "x must lie in"),
        ((0, -32769, 1, 1), "y must lie in"),
        ((0, 0, 65536, 1), "load must lie in 0 .. 65535"),
        ((0, 0, -1, 1), "load must"),
    ):
        with pytest.raises(ValueError, match=message):
            CopSlip(1).next(*np.array(sample)[:, None])
    for name, value in (("drop", 256), ("move", -1), ("hold", 65536)):
        with pytest.raises(ValueError, match=f"{name} = {value}"):
            CopSlip(1, replace(SETS[0], **{name: value}))
