"""msn_ratio against its model, and the model against Python's fractions: products equal to the denominator
and just below and above it, of both signs; denominators zero, negative and extreme; exact halves; random of
any size; narrow and wide; 14 and 16 bits; gaps, stalls, a reset in mid-flight, exact clocks."""

from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals, refused
from meissner.twins.common.divide import steps
from meissner.twins.common.ratio import check_bits, ratio

FIELDS = ["quotient~", "side"]


def parameters(dut):
    names = ("ScaleBits", "NumBits", "DenBits", "FractionBits", "BitsPerClock")
    return [getattr(dut, name).value.to_unsigned() for name in names]


def scales(scale_bits):
    return (0, 1, 3 << scale_bits - 2, (1 << scale_bits) - 1)


def cases(rng, scale, num_bits, den_bits, count, fraction_bits=14):
    """Pairs a, d around |k a| = d, at halves and at the ends of every width, then random of any size."""
    low, high = bench.width(num_bits)
    den_low, den_high = bench.width(den_bits)
    nums = [0, 1, -1, 2, low, high, low + 1]
    nums += [int(rng.integers(low, high + 1)) >> int(rng.integers(0, num_bits - 1)) for _ in range(count)]
    nums += [num for num in (3, 4, 5, 6, 7, 15, 63, 105) if num <= high]
    pairs = []
    for num in nums:
        size = abs(scale * num)
        dens = {0, 1, -1, 2, den_low, den_high, size - 1, size, size + 1, -size - 1, -size, 1 - size}
        dens |= {2 * size, (2 * size << 14) // 3, int(rng.integers(den_low, den_high + 1))}
        dens.add(int(rng.integers(1, den_high + 1)) >> int(rng.integers(0, den_bits)))
        if size and 2 < num < 128:  # quotients of half an LSB and odd multiples of it, and their neighbours
            halves = {size // odd << fraction_bits + 1 for odd in (1, 3, 5, 7, 9, 15) if size % odd == 0}
            dens |= {half + e for half in halves for e in (-1, 0, 1)}
        pairs += [(num, den) for den in sorted(dens) if den_low <= den <= den_high]
    return pairs


def beats_of(pairs):
    return [{"num": num, "den": den, "side": index % 2} for index, (num, den) in enumerate(pairs)]


def expected_of(scale, pairs, fraction_bits):
    quotients = ratio(scale, *zip(*pairs), fraction_bits)
    return [{"quotient": int(q), "side": index % 2} for index, q in enumerate(quotients)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5], which=[0, 1, 2, 3])
async def matches_model(dut, stall_rate, which):
    scale_bits, num_bits, den_bits, fraction_bits, _ = parameters(dut)
    scale = scales(scale_bits)[which]
    pairs = cases(np.random.default_rng(bench.SEED), scale, num_bits, den_bits, 20, fraction_bits)
    await bench.start(dut, cfg_scale_i=scale)
    pauses = bench.gaps_and_stalls(stall_rate)
    expected = expected_of(scale, pairs, fraction_bits)
    assert await bench.stream(dut, beats_of(pairs), FIELDS, *pauses) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated_whatever_the_numbers(dut):
    _, num_bits, den_bits, fraction_bits, per_clock = parameters(dut)
    pairs = cases(np.random.default_rng(bench.SEED), 1, num_bits, den_bits, 0)[:40]
    await bench.start(dut, cfg_scale_i=1, out_ready_i=1)
    accepted, seen = [], []
    for clock in range(45 * (steps(fraction_bits, per_clock) + 1)):
        dut.in_valid_i.value = int(len(accepted) < len(pairs))
        dut.in_num_i.value, dut.in_den_i.value = pairs[min(len(accepted), len(pairs) - 1)]
        await bench.ReadOnly()
        if dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1:
            accepted.append(clock)
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    latency, period = steps(fraction_bits, per_clock) + 4, steps(fraction_bits, per_clock) + 1
    assert seen[0] - accepted[0] == latency
    assert set(np.diff(seen)) == {period} and len(seen) == len(pairs)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    _, _, _, fraction_bits, per_clock = parameters(dut)
    await bench.start(dut, cfg_scale_i=1, in_num_i=1, in_den_i=2, in_side_i=1)
    pairs = [(1, 3), (-1, 2)]
    for delay in range(steps(fraction_bits, per_clock) + 6):
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        assert await bench.stream(dut, beats_of(pairs), FIELDS) == expected_of(1, pairs, fraction_bits)


EVIDENCE = {}

SPACE = lambda draw: {
    "ScaleBits": draw.randint(2, 17),
    "NumBits": draw.randint(3, 20),
    "DenBits": draw.randint(4, 44),
    "FractionBits": draw.randint(2, 18),
    "BitsPerClock": draw.randint(1, 2),
}


@pytest.mark.parametrize(
    "scale_bits, num_bits, den_bits, fraction_bits, per_clock",
    [(17, 18, 34, 14, 2), (17, 19, 43, 16, 1), (5, 4, 4, 4, 2)],
)
def test_ratio(scale_bits, num_bits, den_bits, fraction_bits, per_clock):
    sizes = {"ScaleBits": scale_bits, "NumBits": num_bits, "DenBits": den_bits}
    bench.run("common", "ratio", sizes | {"FractionBits": fraction_bits, "BitsPerClock": per_clock})


@pytest.mark.parametrize("scale_bits, num_bits, den_bits, fraction_bits", [(17, 18, 34, 14), (5, 4, 4, 4)])
def test_model_against_fractions(scale_bits, num_bits, den_bits, fraction_bits):
    one = 1 << fraction_bits
    for scale in scales(scale_bits):
        pairs = cases(np.random.default_rng(3), scale, num_bits, den_bits, 100, fraction_bits)
        for (num, den), got in zip(pairs, ratio(scale, *zip(*pairs), fraction_bits).tolist()):
            product = scale * num
            exact = Fraction(product, den) if den > 0 else Fraction(int(np.sign(product)))
            size = int(min(abs(exact), 1) * one + Fraction(1, 2))
            assert got == (size if exact >= 0 else -size), (scale, num, den)


test_refuses_illegal_parameters = refusals(
    "ratio", check_bits, {"ScaleBits": 0}, {"NumBits": 33}, {"DenBits": 63}
)


def test_the_least_and_the_most_bits():
    check_bits(scale_bits=1, num_bits=32, den_bits=62)
    refused(ratio, {"scale": -1}, num=1, den=1)
