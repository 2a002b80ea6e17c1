"""msn_divide against its model, and the model against Python's fractions: every pair of small numbers, exact
ties of both signs, quotients of 0 and of exactly one, extreme and random widths; even and odd fraction bits,
one and two bits a clock; gaps and stalls, reset in mid-division, exact clocks."""

from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.divide import divide, steps


def parameters(dut):
    names = ("DenBits", "FractionBits", "BitsPerClock")
    return [getattr(dut, name).value.to_unsigned() for name in names]


def nearest(value):
    """Integer nearest to a fraction, ties away from zero: the definition, in exact rationals."""
    whole = int(abs(value) + Fraction(1, 2))
    return whole if value >= 0 else -whole


def cases(rng, den_bits, fraction_bits, count):
    """Pairs num, den: corners, exact ties and their neighbours of both signs, then random of any size.

    A tie depends on every bit of every remainder; in other quotients a remainder bit that is rarely wrong
    would go unnoticed.
    """
    top = (1 << den_bits) - 1
    pairs = [(n, d) for d in (1, 2, 3, top - 1, top) for n in {0, 1, d // 2, d // 2 + 1, d - 1, d} if n <= d]
    unit = 1 << (fraction_bits + 1)  # in half LSBs
    for scale in (1, 2, 3, top // unit):
        for half in (1, 3, unit // 2 - 1, unit - 3, unit - 1):
            if 1 <= scale <= top // unit:
                pairs += [(half * scale + off, unit * scale) for off in (-1, 0, 1)]
    for _ in range(count // 4 if top >= unit else 0):
        scale, half = int(rng.integers(1, top // unit + 1)), 2 * int(rng.integers(0, unit // 2)) + 1
        pairs.append((half * scale + int(rng.integers(-1, 2)), unit * scale))
    for _ in range(count):
        den = int(rng.integers(1, top + 1)) >> int(rng.integers(0, den_bits)) or 1
        pairs.append((int(rng.integers(0, den + 1)), den))
    return pairs + [(-num, den) for num, den in pairs]


def beats_of(pairs):
    return [{"num": num, "den": den, "side": index % 2} for index, (num, den) in enumerate(pairs)]


def expected_of(pairs, fraction_bits):
    quotients = divide(*zip(*pairs), fraction_bits)
    return [{"quotient": int(q), "side": index % 2} for index, q in enumerate(quotients)]


FIELDS = ["quotient~", "side"]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    den_bits, fraction_bits, _ = parameters(dut)
    pairs = cases(np.random.default_rng(bench.SEED), den_bits, fraction_bits, bench.rounds(400))
    await bench.start(dut)
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, beats_of(pairs), FIELDS, *pauses) == expected_of(pairs, fraction_bits)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated_whatever_the_numbers(dut):
    """With a number always offered: a quotient every latency clocks from the first on, without jitter."""
    den_bits, fraction_bits, bits_per_clock = parameters(dut)
    latency = steps(fraction_bits, bits_per_clock) + 1
    pairs = cases(np.random.default_rng(bench.SEED), den_bits, fraction_bits, 0)[:50]
    await bench.start(dut, in_valid_i=1, out_ready_i=1)
    accepted, seen = [], []
    for clock in range(51 * latency):
        dut.in_valid_i.value = int(len(accepted) < len(pairs))
        dut.in_num_i.value, dut.in_den_i.value = pairs[min(len(accepted), len(pairs) - 1)]
        await bench.ReadOnly()
        if dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1:
            accepted.append(clock)
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert accepted == [latency * i for i in range(len(pairs))]
    assert seen == [clock + latency for clock in accepted]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    _, fraction_bits, bits_per_clock = parameters(dut)
    await bench.start(dut, in_num_i=1, in_den_i=2, in_side_i=1)
    pairs = [(1, 3), (-3, 7)]
    for delay in range(steps(fraction_bits, bits_per_clock) + 3):
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        await bench.reset(dut, clocks=1)
        assert await bench.stream(dut, beats_of(pairs), FIELDS) == expected_of(pairs, fraction_bits)


EVIDENCE = {
    "mutants": {"whole": True},
}

SPACE = lambda draw: {
    "DenBits": draw.randint(4, 46),
    "FractionBits": draw.randint(1, 24),
    "BitsPerClock": draw.randint(1, 2),
}


@pytest.mark.parametrize(
    "den_bits, fraction_bits, bits_per_clock",
    [
        *((34, 14, 2), (46, 20, 1), (12, 5, 2), (12, 3, 1), (12, 5, 1), (34, 7, 2), (46, 20, 2)),
        (6, 1, 1),  # the fewest bits that a quotient may have
        (12, 9, 2),
    ],
)
def test_divide(den_bits, fraction_bits, bits_per_clock):
    parameters = {"DenBits": den_bits, "FractionBits": fraction_bits, "BitsPerClock": bits_per_clock}
    bench.run("common", "divide", parameters)


@pytest.mark.parametrize("fraction_bits", [1, 4, 5, 14, 20, 30])
def test_model_against_fractions(fraction_bits):
    pairs = [(num, den) for den in range(1, 65) for num in range(-den, den + 1)]
    for den_bits in (8, 20, 34, 46, 62):
        pairs += cases(np.random.default_rng(fraction_bits), den_bits, fraction_bits, 1000)
    expected = [nearest(Fraction(num, den) * (1 << fraction_bits)) for num, den in pairs]
    assert divide(*zip(*pairs), fraction_bits).tolist() == expected


test_refuses_illegal_parameters = refusals(
    "divide", steps, {"FractionBits": 31}, {"BitsPerClock": 3, "FractionBits": 14}, alone=[{"DenBits": 0}]
)


@pytest.mark.parametrize("num, den", [(1, 0), (3, 2), (-3, 2)])
def test_refuses_quotients_beyond_one(num, den):
    with pytest.raises(ValueError, match="denominator"):
        divide(num, den)
