"""msn_hypot against its model, and the model against Python's exact integer root: all small pairs, squares
and their neighbours, full scale, every width from 1 to 30; the bound of the estimate; gaps and stalls, a
reset in mid-flight, exact clocks."""

from math import hypot as float_hypot
from math import isqrt

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.hypot import hypot, latency


def parameters(dut):
    return dut.Bits.value.to_unsigned(), bool(dut.Exact.value.to_unsigned())


def last_rest(pair):
    """The remainder of a^2 + b^2 before the root's last digit."""
    a, b = pair
    return a * a + b * b - 4 * isqrt((a // 2) ** 2 + (b // 2) ** 2) ** 2


def cases(rng, bits, count):
    """Pairs: corners, Pythagorean triples (root exact) and one less, powers of two, then any size."""
    top = (1 << bits) - 1
    values = sorted({min(v, top) for v in (0, 1, 2, 3, top // 2, top - 1, top)})
    pairs = [(a, b) for a in values for b in values]
    for scale in (1, 2, top // 21, top // 4):
        for a, b in ((3, 4), (20, 21), (5, 12), (8, 15)):
            pairs += [(a * scale, b * scale), (a * scale - 1, b * scale), (b * scale, a * scale - 1)]
    pairs += [(2 * k * k, 2 * k) for k in (1, 2, 100, *range(23_130, 23_171))]  # a square less one
    pairs += [(1 << k, 1 << j) for k in range(bits) for j in (0, k // 2, k)]
    near = range(max(top - 15, 0), top + 1)  # to find the greatest remainder before the last digit
    pairs.append(max(((a, b) for a in near for b in near), key=last_rest))
    for _ in range(count):
        a, b = (int(rng.integers(0, top + 1)) >> int(rng.integers(0, bits)) for _ in range(2))
        pairs.append((a, b))
    return [(a, b) for a, b in pairs if 0 <= a <= top and 0 <= b <= top]


def beats_of(pairs):
    return [{"a": a, "b": b} for a, b in pairs]


def expected_of(pairs, exact):
    return [{"root": int(root)} for root in hypot(*zip(*pairs), exact)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    bits, exact = parameters(dut)
    pairs = cases(np.random.default_rng(bench.SEED), bits, bench.rounds(300))
    await bench.start(dut)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, beats_of(pairs), ["root"], *pauses, drain=3 * bits + 9)
    assert got == expected_of(pairs, exact)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated_whatever_the_numbers(dut):
    bits, exact = parameters(dut)
    period = latency(bits, exact)
    pairs = cases(np.random.default_rng(bench.SEED), bits, 0)[:40]
    await bench.start(dut, in_valid_i=1, out_ready_i=1)
    accepted, seen = [], []
    for clock in range((len(pairs) + 1) * period):
        dut.in_valid_i.value = int(len(accepted) < len(pairs))
        dut.in_a_i.value, dut.in_b_i.value = pairs[min(len(accepted), len(pairs) - 1)]
        await bench.ReadOnly()
        if dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1:
            accepted.append(clock)
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert accepted == [period * i for i in range(len(pairs))]
    assert seen == [clock + period for clock in accepted]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    bits, exact = parameters(dut)
    top = (1 << bits) - 1
    await bench.start(dut, in_a_i=top, in_b_i=top)
    pairs = [(top, 0), (top // 3, top // 2)]
    for delay in range(latency(bits, exact) + 2):
        dut.in_a_i.value = dut.in_b_i.value = top
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        got = await bench.stream(dut, beats_of(pairs), ["root"], drain=3 * bits + 9)
        assert got == expected_of(pairs, exact)


EVIDENCE = {}

SPACE = lambda draw: {"Bits": draw.randint(1, 18), "Exact": draw.randint(0, 1)}


@pytest.mark.parametrize(
    "bits, exact", [pytest.param(24, 1, marks=pytest.mark.long), (1, 1), (5, 1), (30, 1), (24, 0), (2, 0)]
)
def test_hypot(bits, exact):
    bench.run("common", "hypot", {"Bits": bits, "Exact": exact})


@pytest.mark.parametrize("bits", [1, 2, 6, 17, 26, 27, 30])
def test_model_against_integer_root(bits):
    pairs = cases(np.random.default_rng(bits), bits, 3000)
    if bits <= 6:
        pairs = [(a, b) for a in range(1 << bits) for b in range(1 << bits)]
    assert hypot(*zip(*pairs)).tolist() == [isqrt(a * a + b * b) for a, b in pairs]


def test_estimate_stays_within_its_bound():
    angles = np.linspace(0, np.pi / 2, 100_001)
    a, b = (np.rint(2**29 * part(angles)).astype(np.int64) for part in (np.cos, np.sin))
    errors = hypot(a, b, exact=False) / np.array([float_hypot(*pair) for pair in zip(a, b)]) - 1
    assert -0.02990 < errors.min() < -0.02980
    assert 0.00777 < errors.max() < 0.00780


test_refuses_illegal_parameters = refusals("hypot", latency, {"Bits": 0}, {"Bits": 31})


@pytest.mark.parametrize("pair", [(-1, 0), (0, 1 << 30)])
def test_refuses_numbers_beyond_30_bits(pair):
    with pytest.raises(ValueError):
        hypot(*pair)
