"""msn_round_sat against its model, and the model against exact fractions: the ends of the input range,
numbers around ties near zero and around both limits, powers of two, random numbers; with stalls; reset."""

from fractions import Fraction
from math import floor

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.arithmetic import round_sat

SIZES = [
    (24, 16, 8, 0),
    (35, 16, 12, 1),
    (9, 9, 1, 0),
    (9, 8, 1, 1),
    (20, 1, 3, 0),
    (20, 1, 3, 1),
    (51, 16, 24, 1),
]


def telling(in_width, out_width, drop_bits, unsigned):
    """Inputs around the points where rounding or clipping changes, then random ones of every magnitude."""
    rng = np.random.default_rng(bench.SEED)
    low, high = bench.width(in_width)
    half, bits = 1 << (drop_bits - 1), out_width - (not unsigned)
    centres = np.array([0, half, 1 << (drop_bits + bits), (1 << (drop_bits + bits)) - half, 2 * half])
    near = (np.r_[centres, -centres][:, None] + np.arange(-2, 3)).ravel()
    powers = 1 << np.arange(in_width - 1)
    wide = rng.integers(low, high + 1, 300) >> rng.integers(0, in_width, 300)
    x = np.r_[low, high, near, powers, -powers, wide]
    return x[(x >= low) & (x <= high)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    size = [
        getattr(dut, name).value.to_unsigned() for name in ("InWidth", "OutWidth", "DropBits", "Unsigned")
    ]
    await bench.start(dut)
    x = telling(*size)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, [{"data": v} for v in x], ["data" if size[3] else "data~"], *pauses)
    assert [beat["data"] for beat in got] == round_sat(x, *size).tolist()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await bench.start(dut)
    await bench.stream(dut, [{"data": 1}], ["data"], stalls=lambda: True, drain=0)
    await bench.reset(dut)
    assert await bench.stream(dut, [], ["data"]) == []


EVIDENCE = {
    "mutants": {"whole": True},
}


@pytest.mark.parametrize("in_width, out_width, drop_bits, unsigned", SIZES)
def test_round_sat(in_width, out_width, drop_bits, unsigned):
    size = {"InWidth": in_width, "OutWidth": out_width, "DropBits": drop_bits, "Unsigned": unsigned}
    bench.run("common", "round_sat", size)


@pytest.mark.parametrize("size", SIZES)
def test_model_against_fractions(size):
    _, out_width, drop_bits, unsigned = size
    low, high = (0, (1 << out_width) - 1) if unsigned else bench.width(out_width)
    x = telling(*size)
    exact = [floor(Fraction(int(v), 1 << drop_bits) + Fraction(1, 2)) for v in x]
    assert round_sat(x, *size).tolist() == [min(max(v, low), high) for v in exact]


test_refuses_illegal_parameters = refusals(
    "round_sat",
    round_sat,
    *({"DropBits": 0}, {"DropBits": 24}, {"OutWidth": 18}, {"OutWidth": 17, "Unsigned": 1}),
    **{"x": 0, "in_width": 24, "out_width": 16, "drop_bits": 8},
)


def test_refuses_numbers_beyond_the_width():
    for beyond in (1 << 23, -(1 << 23) - 1, 1 << 62, -(1 << 63)):
        with pytest.raises(ValueError):
            round_sat([0, beyond], 24, 16, 8)
    assert round_sat([(1 << 23) - 1, -(1 << 23)], 24, 16, 8).tolist() == [32767, -32768]
