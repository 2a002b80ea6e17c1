"""msn_log2 against its model, and the model against NumPy's log2 at every mantissa, at the default precision
and two others: powers of two and table entries, with their neighbours, zero, full scale, every size; tables
against mpmath; gaps and stalls, a reset in mid-flight, exact clocks."""

from functools import partial

import cocotb
import mpmath
import numpy as np
import pytest

import bench
import tables
from harness.refusals import refusals
from meissner.builds import toolchain
from meissner.twins.common import log2 as twin
from meissner.twins.common.exp2 import finest as finest_exp2
from meissner.twins.common.log2 import log2

NAMES = ("InBits", "TableBits", "FractionBits")
LATENCY = 7


def parameters(dut):
    return [getattr(dut, name).value.to_unsigned() for name in NAMES]


def cases(rng, in_bits, table_bits, count):
    """All numbers if they are few, else powers of two and table entries with their neighbours, and random
    ones."""
    top = (1 << in_bits) - 1
    if in_bits <= 10:
        return list(range(top + 1))
    near = [(1 << k) + e for k in range(in_bits + 1) for e in (-1, 0, 1)]
    step = 1 << in_bits - 1 - table_bits
    near += [(1 << in_bits - 1) + i * step + e for i in range(1 << table_bits) for e in (-1, 0, step // 2)]
    near += [int(rng.integers(0, top + 1)) >> int(rng.integers(0, in_bits)) for _ in range(count)]
    return [x for x in near if 0 <= x <= top]


def beats_of(numbers):
    return [{"data": x} for x in numbers]


def expected_of(numbers, settings):
    return [{"data": int(y)} for y in log2(numbers, *settings)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    in_bits, table_bits, _ = settings = parameters(dut)
    numbers = cases(np.random.default_rng(bench.SEED), in_bits, table_bits, 1000)
    await bench.start(dut)
    got = await bench.stream(dut, beats_of(numbers), ["data"], *bench.gaps_and_stalls(stall_rate))
    assert got == expected_of(numbers, settings)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """One number a clock; the first result at the seventh edge after its number was offered."""
    settings = parameters(dut)
    numbers = cases(np.random.default_rng(bench.SEED), 9, settings[1], 0)[:300]
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
    await bench.start(dut, in_data_i=77)
    numbers = [5, 1, 300]
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
    "equivalence": {"size": {"InBits": 10, "TableBits": 3, "FractionBits": 8}},
}

SPACE = lambda draw: (
    lambda table: {
        "TableBits": table,
        "FractionBits": draw.randint(table + 1, table + 14),
        "InBits": draw.randint(table + 4, 40),
    }
)(draw.randint(3, 8))

# The default, coarse, fine; the last two with the smallest and largest table.
SIZES = [(27, 6, 16), (10, 3, 8), (20, 8, 22)]


@pytest.mark.parametrize("sizes", SIZES)
def test_log2(sizes):
    bench.run("common", "log2", dict(zip(NAMES, sizes)))


# Errors below and above, by hand from the header's formula: LSB 2^-16, 2^-12, 2^-20; chord 0.1804/4^6, 4^4,
# 4^8.
BOUNDS = {
    (27, 6, 16): (0.0000576, 0.00000954),
    (20, 4, 12): (0.000919, 0.0001527),
    (24, 8, 20): (0.00000360, 0.000000599),
}


@pytest.mark.parametrize("sizes, bounds", BOUNDS.items(), ids=str)
def test_every_mantissa_within_the_bound(sizes, bounds):
    """Numbers that agree in the bits that the table and the chord use give the same result; of each such run
    the first and the last are checked, as the logarithm rises. The float's own error is below 1e-14."""
    in_bits, table_bits, fraction_bits = sizes
    assert twin.bound(*sizes) == pytest.approx(bounds, rel=0.01)
    below, above = twin.bound(*sizes)
    cut = max(0, in_bits - 1 - table_bits - 17)
    lowest, highest = 0.0, 0.0
    octave = 1 << in_bits - 1
    for start in range(octave, 2 * octave, 1 << 22):
        first = np.arange(start, min(start + (1 << 22), 2 * octave), 1 << cut)
        got = log2(first, *sizes) / 2.0**fraction_bits
        highest = max(highest, (got - np.log2(first)).max())
        last = first + (1 << cut) - 1
        assert np.array_equal(log2(last[::97], *sizes) / 2.0**fraction_bits, got[::97])
        lowest = min(lowest, (got - np.log2(last)).min())
    assert -below - 1e-14 <= lowest <= -0.8 * below
    assert 0.8 * above <= highest <= above + 1e-14


@pytest.mark.parametrize("sizes", [(27, 6, 16), (12, 4, 12), (40, 8, 20)])
def test_an_octave_is_one_more(sizes):
    """log2(2^s x) = s + log2(x), for all x that fit; powers of two are exact, and 0 gives the same as 1."""
    in_bits, _, fraction_bits = sizes
    x = np.arange(1, 1 << 11)
    for s in range(1, in_bits - 11):
        assert np.array_equal(log2(x << s, *sizes), log2(x, *sizes) + (s << fraction_bits))
    powers = [1 << k for k in range(in_bits)]
    assert log2(powers, *sizes).tolist() == [k << fraction_bits for k in range(in_bits)]
    assert log2(0, *sizes) == 0


def test_the_result_never_falls():
    for sizes in ((18, 6, 16), (18, 4, 12), (18, 8, 20)):
        assert (np.diff(log2(np.arange(1 << 18), *sizes)) >= 0).all()


def test_tables_against_mpmath():
    with mpmath.workdps(60):
        places = [mpmath.mpf(i) / 256 for i in range(257)]
        by_mpmath = [int(mpmath.nint(2**28 * mpmath.log(1 + place, 2))) for place in places]
        powers = [int(mpmath.nint(2**28 * (mpmath.mpf(2) ** place - 1))) for place in places]
    assert list(twin.finest()) == by_mpmath
    assert list(finest_exp2()) == powers


def test_the_packages_are_what_the_tool_writes():
    for path, text in tables.packages().items():
        assert path.read_text("utf-8") == text, "`python tools/make/tables.py`"
    assert {path.parent for path in tables.packages()} == {toolchain.ROOT / "rtl/common"}


test_refuses_illegal_parameters = refusals(
    "log2",
    partial(log2, 1),
    *({"TableBits": 2}, {"TableBits": 9}, {"FractionBits": 6}, {"FractionBits": 21}),
    *({"InBits": 7}, {"InBits": 49}),
)


def test_the_least_and_the_most_bits():
    assert log2(255, 8, 6, 7) == log2(255, 48, 6, 7) and log2(3, 48, 6, 20) > 0
