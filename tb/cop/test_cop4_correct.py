"""msn_cop4_correct against its model, and the model against the polynomial in fractions: both ends of every
coordinate, register, N and D, every register alone, registers of fitted meshes, random ones at the limit of
their sum; sums that a unit more or less would round otherwise; gaps, stalls, a reset in mid-flight, exact
clocks. A mesh's load with it: test_cop4."""

from fractions import Fraction
from functools import cache
from math import floor

import cocotb
import numpy as np
import pytest

import bench
from meissner.physics.cop4_registers import correct_registers
from meissner.physics.mesh.correction import Correction
from meissner.twins.cop.cop4_correct import SUM_TOP, CorrectionRegisters, check_correction, cop4_correct

FIELDS = ["den~", "n~", "side"]


@cache
def register_sets():
    """Zero; each register alone at both ends; those of a published mesh (150 ohms, halved twice); random to
    the limit."""
    rng = np.random.default_rng(7)
    sets = [CorrectionRegisters((0,) * 6, 8)]
    sets += [
        CorrectionRegisters(tuple(s * (SUM_TOP - 1) * (i == j) for j in range(6)), 23)
        for i in range(6)
        for s in (1, -1)
    ]
    sets.append(CorrectionRegisters((24854, 16085, 20375, 4714, 13957, -4448), 21))
    for shift in (8, 15, 23):
        share = rng.dirichlet(np.ones(6)) * (SUM_TOP - 6) * rng.choice([-1, 1], 6)
        sets.append(CorrectionRegisters(tuple(int(v) for v in share), shift))
    return sets


def cases(rng, sum_bits, count):
    """x, y, N, D: every pair of corners, then random."""
    low, high = bench.width(sum_bits - 1)
    low_d, high_d = bench.width(sum_bits)
    rows = [
        (x, y, n, d)
        for x in (-16384, 0, 16384)
        for y in (-16384, 1, 16384)
        for n, d in ((low, high_d), (high, low_d), (low, low_d))
    ]
    rows += [(16383, -63, 1, 0), (64, -64, 0, 1), (0, 0, high, high), (0, 0, low, low), (1, 1, -1, -1)]
    for _ in range(count):
        x, y = rng.integers(-16384, 16385, 2)
        n = int(rng.integers(low, high + 1)) >> int(rng.integers(0, sum_bits - 2))
        d = int(rng.integers(low_d, high_d + 1)) >> int(rng.integers(0, sum_bits - 1))
        rows.append((int(x), int(y), n, d))
    return rows


def at_rounding(registers, count=6):
    """x, y, N, D where a sum of two products that is rounded down is whole or just above, and where it is
    just below; half of them with the first product odd, so that its lowest bit decides."""
    x, y = np.random.default_rng(11).integers(-16384, 16385, (2, 1 << 19))
    X, Y = x * x >> 12, y * y >> 12
    _, p1, p2, p3, p4, p5 = registers.p
    along, across = p1 + (p3 * X + p4 * Y >> 16), p2 + (p5 * Y >> 16)
    rows = []
    for first, second in ((p3 * X, p4 * Y), (p5 * Y, 0), (X * along, Y * across)):
        for odd in (0, 1):
            which = np.flatnonzero(first & 1 == odd)
            order = which[np.argsort((first + second)[which] & 0xFFFF, kind="stable")]
            rows += [(int(x[k]), int(y[k]), 1, 0) for k in (*order[:count], *order[-count:])]
    return rows


def beats_of(rows):
    return [dict(zip(("x", "y", "n", "d"), row)) | {"side": i % 2} for i, row in enumerate(rows)]


def expected_of(rows, registers):
    dens = cop4_correct(*np.array(rows).T, registers)
    return [{"den": int(den), "n": row[2], "side": i % 2} for i, (row, den) in enumerate(zip(rows, dens))]


def ports(registers):
    packed = sum((p & 0x3FFFF) << 18 * i for i, p in enumerate(registers.p))
    return {"cfg_p_i": packed, "cfg_shift_i": registers.shift - 8}


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5], which=range(17))
async def matches_model(dut, stall_rate, which):
    registers = register_sets()[which]
    rows = cases(np.random.default_rng(bench.SEED), dut.SumBits.value.to_unsigned(), 30)
    await bench.start(dut, **ports(registers))
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, beats_of(rows), FIELDS, *pauses) == expected_of(rows, registers)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(which=range(13, 17))
async def rounds_sums_down(dut, which):
    registers = register_sets()[which]
    rows = at_rounding(registers)
    await bench.start(dut, **ports(registers))
    assert await bench.stream(dut, beats_of(rows), FIELDS) == expected_of(rows, registers)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    await bench.start(dut, **ports(register_sets()[0]), out_ready_i=1, in_x_i=0, in_y_i=0, in_n_i=0, in_d_i=0)
    for clock in range(14):
        dut.in_valid_i.value = int(clock < 5)
        await bench.ReadOnly()
        assert dut.in_ready_o.value == (clock not in (1, 3, 5)), f"clock {clock}"
        assert dut.out_valid_o.value == (clock in (8, 10, 12)), f"clock {clock}"
        await bench.RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    registers = register_sets()[-1]
    rows = cases(np.random.default_rng(bench.SEED), dut.SumBits.value.to_unsigned(), 2)[-4:]
    await bench.start(dut, **ports(registers), in_x_i=1, in_y_i=1, in_n_i=1, in_d_i=1, in_side_i=0)
    for delay in range(10):
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        assert await bench.stream(dut, beats_of(rows), FIELDS) == expected_of(rows, registers)


EVIDENCE = {
    "equivalence": {"yosys": "a product's operands have other widths as slang reads it"},
}


@pytest.mark.parametrize("sum_bits", [19, 6])
def test_cop4_correct(sum_bits):
    bench.run("cop", "cop4_correct", {"SumBits": sum_bits})


def test_model_against_fractions():
    """Each step of the polynomial rounded down, in exact rationals; and near the polynomial itself."""
    for registers in register_sets():
        p0, p1, p2, p3, p4, p5 = registers.p
        rows = cases(np.random.default_rng(3), 19, 100) + at_rounding(registers)
        for (x, y, n, d), got in zip(rows, expected_of(rows, registers)):
            X, Y = (floor(Fraction(v * v, 4096)) for v in (x, y))
            along = p1 + floor(Fraction(p3 * X + p4 * Y, 65536))
            across = p2 + floor(Fraction(p5 * Y, 65536))
            p = p0 + floor(Fraction(X * along + Y * across, 65536))
            assert got["den"] == (d << registers.shift) - n * p
            assert max(abs(v) for v in (along, across, p)) < 1 << 17
            u, v = Fraction(x, 16384) ** 2, Fraction(y, 16384) ** 2
            exact = p0 + p1 * u + p2 * v + p3 * u * u + p4 * u * v + p5 * v * v
            assert abs(p - exact) <= 11  # 3 steps round down; X, Y are low by up to 2^-16 of twice the sum


def test_registers_share_the_loads_shift():
    from meissner.twins.cop.cop4 import Cop4Registers

    cop4 = Cop4Registers(60000, 70000, 5, 70000, 5, 110000, 15, 32767, 30000, 20000, 9)
    found, p = correct_registers(Correction(np.full(6, 0.01), np.zeros(3), np.zeros(3), 0.864), cop4)
    assert p.shift == 8 + found.shift_load == 21 and found.kf == 27500 and p.p == (20972,) * 6
    found, p = correct_registers(Correction(np.full(6, 0.001), np.zeros(3), np.zeros(3), 0.864), cop4)
    assert found == cop4 and p.shift == 23
    for terms in (1.0, 100.0):  # either Kf loses all its bits, or the terms fit at no shift
        with pytest.raises(ValueError, match="larger load_lsb"):
            correct_registers(Correction(np.full(6, terms), np.zeros(3), np.zeros(3), 0.864), cop4)


def test_refuses_illegal_parameters():
    assert "SumBits = 5" in bench.refuses("cop4_correct", {"SumBits": 5})
    assert "SumBits = 27" in bench.refuses("cop4_correct", {"SumBits": 27})
    for p, shift, message in (
        ((SUM_TOP, 0, 0, 0, 0, 0), 20, "magnitudes"),
        ((1,) * 5, 20, "six"),
        ((1,) * 6, 24, "shift = 24"),
        ((1,) * 6, 7, "shift = 7"),
    ):
        with pytest.raises(ValueError, match=message):
            check_correction(CorrectionRegisters(p, shift))
    with pytest.raises(ValueError, match="16384"):
        cop4_correct([16385], [0], [1], [1], register_sets()[0])
