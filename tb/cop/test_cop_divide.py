"""msn_cop_divide against its model, and the model against Python's fractions: moments of real frames and at
their limits, the least and greatest loads, loads around the gate and zero; one row, one column; 4, 14 and 20
fraction bits; one and two bits a clock; gaps and stalls; exact clocks."""

from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.common.divide import steps
from meissner.twins.cop.cop import cop_divide, moments, sum_bits
from reference import exact

FIELDS = ["x~", "y~", "load", "pressed"]


def parameters(dut):
    names = ("Rows", "Columns", "FractionBits", "BitsPerClock")
    return [getattr(dut, name).value.to_unsigned() for name in names]


def cases(rng, rows, columns, count, fraction_bits=14):
    """S, Mx, My: of corner-case frames (small arrays), at the limits of the moments, exact halves, random.

    If the load is a power of two, some moment gives exactly half an LSB.
    """
    top = 65535 * rows * columns
    sums = [(0, 0, 0)]
    if rows * columns < 10**5:
        sums += [tuple(map(int, frame)) for frame in zip(*moments(bench.force_frames(rng, rows, columns)))]
    random_loads = (int(rng.integers(1, top + 1)) >> int(rng.integers(0, 30)) or 1 for _ in range(count))
    for load in (1, 2, 3, 99, 100, 101, top - 1, top, *random_loads):
        span_x, span_y = (columns - 1) * load, (rows - 1) * load
        sums += [(load, span_x, -span_y), (load, -span_x, span_y), (load, span_x // 2, -(span_y // 2))]
        sums.append((load, int(rng.integers(-span_x, span_x + 1)), int(rng.integers(-span_y, span_y + 1))))
    for power in range(fraction_bits + 1, top.bit_length()):
        odd = [2 * int(rng.integers(0, 1 << fraction_bits)) + 1 for _ in range(4)]
        halves = [value << power - fraction_bits - 1 for value in odd]
        sums.append((1 << power, (columns - 1) * halves[0], -(rows - 1) * halves[1]))
        sums.append((1 << power, -(columns - 1) * halves[2], (rows - 1) * halves[3]))
    # Only a light load can lie entirely in a corner; a heavy one must spread, and the moments' widths rely on
    # it.
    limit_x, limit_y = (
        1 << (sum_bits(rows, columns) - 1 + max((n - 1).bit_length(), 1)) for n in (columns, rows)
    )
    return [case for case in sums if abs(case[1]) < limit_x and abs(case[2]) < limit_y]


def expected_of(sums, rows, columns, fraction_bits, min_load):
    total, mx, my = zip(*sums)
    x, y, pressed = cop_divide(total, mx, my, rows, columns, fraction_bits, min_load)
    results = zip(x.tolist(), y.tolist(), total, map(int, pressed))
    return [dict(zip(("x", "y", "load", "pressed"), result)) for result in results]


def beats_of(sums):
    return [dict(zip(("sum", "mx", "my"), case)) for case in sums]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5], min_load=[0, 1, 100])
async def matches_model(dut, stall_rate, min_load):
    rows, columns, fraction_bits, _ = parameters(dut)
    sums = cases(np.random.default_rng(bench.SEED), rows, columns, 40, fraction_bits)
    await bench.start(dut, cfg_min_load_i=min_load)
    pauses = bench.gaps_and_stalls(stall_rate)
    expected = expected_of(sums, rows, columns, fraction_bits, min_load)
    assert await bench.stream(dut, beats_of(sums), FIELDS, *pauses) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def gate_is_judged_when_the_sums_are_taken(dut):
    rows, columns, fraction_bits, bits_per_clock = parameters(dut)
    await bench.start(dut, cfg_min_load_i=100, in_sum_i=100, in_mx_i=0, in_my_i=0, out_ready_i=1)
    dut.in_valid_i.value = 1
    await bench.clocks(dut, 1)
    dut.in_valid_i.value = 0
    dut.cfg_min_load_i.value = 101
    await bench.clocks(dut, steps(fraction_bits, bits_per_clock))
    await bench.ReadOnly()
    assert dut.out_valid_o.value == 1
    assert dut.out_pressed_o.value == 1
    await bench.RisingEdge(dut.clk_i)
    sums = [(100, 0, 0), (101, 0, 0)]
    expected = expected_of(sums, rows, columns, fraction_bits, 101)
    assert [frame["pressed"] for frame in expected] == [0, 1]
    assert await bench.stream(dut, beats_of(sums), FIELDS) == expected


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def every_bit_of_the_gate_counts(dut):
    """A gate of 2^k differs from the load one below it in every bit that either has set."""
    rows, columns, fraction_bits, _ = parameters(dut)
    await bench.start(dut, cfg_min_load_i=0)
    for k in range(1, len(dut.cfg_min_load_i)):
        dut.cfg_min_load_i.value = 1 << k
        sums = [((1 << k) - 1, 0, 0), (1 << k, 0, 0)]
        expected = expected_of(sums, rows, columns, fraction_bits, 1 << k)
        assert [frame["pressed"] for frame in expected] == [0, 1]
        assert await bench.stream(dut, beats_of(sums), FIELDS, count=2) == expected


@bench.applies(lambda dut: not hasattr(dut, "mutsel"))  # netlists of mutants hide inner signals
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def no_divider_sees_a_zero_denominator(dut):
    """For any load and any gate: checked at the dividers' inputs, not only by the results that pass the
    gate."""
    rows, columns, *_ = parameters(dut)
    await bench.start(dut, in_mx_i=0, in_my_i=0)
    for load in (0, 1, 2, 99):
        for min_load in (0, 1, 99, 100):
            dut.in_sum_i.value, dut.cfg_min_load_i.value = load, min_load
            await bench.ReadOnly()
            assert bench.read(dut.den_x) == (load * max(columns - 1, 1) or 1)
            assert bench.read(dut.den_y) == (load * max(rows - 1, 1) or 1)
            await bench.RisingEdge(dut.clk_i)


EVIDENCE = {}


@pytest.mark.parametrize(
    "rows, columns, fraction_bits, bits_per_clock", [(63, 64, 20, 2), (1, 9, 4, 2), (1024, 1, 14, 1)]
)
def test_cop_divide(rows, columns, fraction_bits, bits_per_clock):
    parameters = {"Rows": rows, "Columns": columns, "FractionBits": fraction_bits}
    bench.run("cop", "cop_divide", parameters | {"BitsPerClock": bits_per_clock})


@pytest.mark.parametrize("fraction_bits", [4, 14, 20])
@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 9), (9, 1), (2, 2), (33, 63), (64, 64), (1024, 1024)])
def test_model_against_fractions(rows, columns, fraction_bits):
    one = 1 << fraction_bits
    sums = cases(np.random.default_rng(3), rows, columns, 300, fraction_bits)
    for (total, mx, my), got in zip(sums, expected_of(sums, rows, columns, fraction_bits, 100)):
        pressed = total >= 100
        x = exact.away(Fraction(mx, (columns - 1) * total) * one) if pressed and columns > 1 else 0
        y = exact.away(Fraction(my, (rows - 1) * total) * one) if pressed and rows > 1 else 0
        assert got == {"x": x, "y": y, "load": total, "pressed": int(pressed)}, (total, mx, my)


def test_refuses_illegal_parameters():
    assert "Rows = 0" in bench.refuses("cop_divide", {"Rows": 0})
    assert "Columns = 1025" in bench.refuses("cop_divide", {"Columns": 1025})
    assert "FractionBits = 3" in bench.refuses("cop_divide", {"FractionBits": 3})
    for args, message in (
        ((0, 1), "rows = 0"),
        ((1, 1025), "columns = 1025"),
        ((2, 2, 3), "fraction_bits = 3"),
    ):
        with pytest.raises(ValueError, match=message):
            cop_divide(1, 0, 0, *args)
