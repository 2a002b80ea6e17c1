"""msn_exp2 against its model, and the model against NumPy's exp2 wherever it gives neither 0 nor full scale,
at the default precision and two others: whole numbers and their neighbours, entries of the table, the ends of
input and output; gaps and stalls, a reset in mid-flight, exact clocks."""

from functools import partial

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common import exp2 as twin
from meissner.twins.common.exp2 import exp2

NAMES = ("WholeBits", "TableBits", "FractionBits", "OutBits", "OutFraction")
LATENCY = 6


def parameters(dut):
    return [getattr(dut, name).value.to_unsigned() for name in NAMES]


def cases(rng, settings, count):
    """All numbers if they are few, else whole numbers from below 0 to beyond the output, table entries, the
    ends of the input, all with their neighbours, and random ones."""
    whole_bits, table_bits, fraction_bits, out_bits, out_fraction = settings
    low, high = bench.width(whole_bits + fraction_bits)
    if high < 1 << 11:
        return list(range(low, high + 1))
    first, beyond = -out_fraction - 3, out_bits - out_fraction + 2
    near = [low, low + 1, high - 1, high, -1, 1]
    near += [(k << fraction_bits) + e for k in range(first, beyond) for e in (-1, 0, 1)]
    step = 1 << fraction_bits - table_bits
    near += [j * step + e for j in range(1 << table_bits) for e in (-1, 0, 1)]
    near += [int(rng.integers(first << fraction_bits, beyond << fraction_bits)) for _ in range(count)]
    near += [int(rng.integers(low, high + 1)) for _ in range(count // 4)]
    return [y for y in near if low <= y <= high]


def beats_of(numbers):
    return [{"data": y} for y in numbers]


def expected_of(numbers, settings):
    return [{"data": int(out)} for out in exp2(numbers, *settings[1:])]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    settings = parameters(dut)
    numbers = cases(np.random.default_rng(bench.SEED), settings, 1000)
    await bench.start(dut)
    got = await bench.stream(dut, beats_of(numbers), ["data"], *bench.gaps_and_stalls(stall_rate))
    assert got == expected_of(numbers, settings)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """One number a clock; the first result at the sixth edge after its number was offered."""
    settings = parameters(dut)
    low, high = bench.width(settings[0] + settings[2])
    numbers = np.linspace(low, high, 300).astype(int).tolist()
    await bench.start(dut, out_ready_i=1)
    seen = []
    for clock in range(len(numbers) + 20):
        dut.in_valid_i.value = int(clock < len(numbers))
        dut.in_data_i.value = numbers[min(clock, len(numbers) - 1)]
        await bench.ReadOnly()
        assert bench.high(dut.in_ready_o)
        if bench.high(dut.out_valid_o):
            seen.append((clock, bench.read(dut.out_data_o)))
        await bench.RisingEdge(dut.clk_i)
    values = [beat["data"] for beat in expected_of(numbers, settings)]
    assert seen == [(clock + LATENCY, value) for clock, value in enumerate(values)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    settings = parameters(dut)
    await bench.start(dut, in_data_i=-77)
    numbers = [-5, 0, 121]
    for delay in range(LATENCY + 2):
        dut.in_data_i.value = 99
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        assert await bench.stream(dut, beats_of(numbers), ["data"]) == expected_of(numbers, settings)


EVIDENCE = {
    "equivalence": {
        "size": {"WholeBits": 4, "TableBits": 3, "FractionBits": 7, "OutBits": 9, "OutFraction": 5}
    },
}

SPACE = lambda draw: (
    lambda table: {
        "TableBits": table,
        "FractionBits": draw.randint(table + 1, table + 14),
        "WholeBits": draw.randint(6, 9),
        "OutBits": draw.randint(8, 32),
        "OutFraction": draw.randint(0, 32),
    }
)(draw.randint(3, 8))

# The default; a small size whose output has fewer bits than the mantissa; a fine one with the longest output.
SIZES = [(11, 6, 16, 24, 20), (4, 3, 7, 9, 5), (7, 8, 22, 32, 32)]


@pytest.mark.parametrize("sizes", SIZES)
def test_exp2(sizes):
    bench.run("common", "exp2", dict(zip(NAMES, sizes)))


# Relative errors below and above, by hand from the header's formula: the chord 0.0601/4^6, 4^4, 4^8.
BOUNDS = {
    (6, 16, 24, 20): (0.00000573, 0.0000166),
    (4, 12, 24, 20): (0.0000916, 0.000265),
    (8, 20, 30, 26): (0.000000361, 0.00000104),
}


@pytest.mark.parametrize("sizes, bounds", BOUNDS.items(), ids=str)
def test_every_number_within_the_bound(sizes, bounds):
    """From where the result is 0 to where it saturates; rounding of the output adds half an LSB."""
    table_bits, fraction_bits, out_bits, out_fraction = sizes
    assert twin.bound(table_bits, fraction_bits) == pytest.approx(bounds, rel=0.01)
    below, above = twin.bound(table_bits, fraction_bits)
    lowest, highest = 0.0, 0.0
    f = np.arange(1 << fraction_bits)
    for whole in range(-out_fraction - 3, out_bits - out_fraction):
        y = (whole << fraction_bits) + f
        exact = np.exp2(y / 2.0**fraction_bits) * 2.0**out_fraction
        got = exp2(y, *sizes)
        off = got - exact
        assert (off <= above * exact + 0.5 + 1e-6).all()
        assert (off >= -below * exact - 0.5 - 1e-6).all()  # saturated results too
        if whole == out_bits - out_fraction - 2:  # here half an LSB weighs least and nothing saturates
            lowest, highest = (off / exact).min(), (off / exact).max()
    half = 2.0 ** (1 - out_bits)
    assert -below - half <= lowest <= -0.7 * below
    assert 0.8 * above <= highest <= above + half


def test_ends_of_the_range():
    """0 below half an LSB, and exactly half rounds up; saturation just below the end, at it and beyond it."""
    one = 1 << 16
    assert exp2([-21 * one - 1, -21 * one, -21 * one + 1, -20 * one]).tolist() == [0, 1, 1, 1]
    assert exp2([-22 * one, -(1 << 26), -(1 << 31)]).tolist() == [0, 0, 0]
    top = (1 << 24) - 1
    assert exp2([4 * one - 1, 4 * one, 4 * one + 1, (1 << 26) - 1, (1 << 31) - 1]).tolist()[1:] == [top] * 4
    # 2^24 2^(-1/65536) = 16777038.5; the chord is too high by up to 1.7e-5, which is 280
    assert 16777038 - 97 <= exp2(4 * one - 1) <= 16777038 + 280
    assert exp2(0) == 1 << 20 and exp2(3 * one) == 1 << 23 and exp2(-one) == 1 << 19


test_refuses_illegal_parameters = refusals(
    "exp2",
    partial(exp2, 1),
    *({"TableBits": 2}, {"FractionBits": 21}, {"OutBits": 1}, {"OutBits": 33}, {"OutFraction": 33}),
    alone=[{"TableBits": 9}, {"FractionBits": 6}, {"WholeBits": 1}, {"WholeBits": 13}],
)
