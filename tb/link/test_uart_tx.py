"""msn_uart_tx against its model, clock by clock, and the model against an independent receiver: integer and
fractional clocks per bit, 4 at the least, any byte, with and without gaps, reset in mid-byte, no delay before
the first bit."""

from fractions import Fraction
from math import floor

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.uart import levels, sixteenths

RATES = [(12_000_000, 3_000_000), (25_000_000, 3_000_000), (48_000_000, 921_600), (12_000_000, 1_000_000)]


async def watch(dut, data, gaps):
    """The levels of the line while ``data`` is sent and until it is idle."""
    line, at, quiet = [], 0, 0
    while quiet < 600:
        offer = at < len(data) and not gaps()
        dut.in_valid_i.value = int(offer)
        dut.in_data_i.value = data[at] if offer else 0xA5
        await bench.ReadOnly()
        line.append(bench.read(dut.tx_o))
        at += offer and dut.in_ready_o.value == 1
        quiet = quiet + 1 if at == len(data) and line[-1] else 0
        await bench.RisingEdge(dut.clk_i)
    return line


def edges_of(data, clk_hz, baud_hz):
    """By docs/link.md: after n bits in a row the line is n bit times on, rounded down to a clock; 1/16 clock
    units."""
    bit = Fraction(floor(Fraction(16 * clk_hz, baud_hz) + Fraction(1, 2)), 16)
    bits = [int(bit) for byte in data for bit in "0" + f"{byte:08b}"[::-1] + "1"]
    ends = [floor((n + 1) * bit) for n in range(len(bits))]
    return [level for level, begin, end in zip(bits, [0, *ends], ends) for _ in range(end - begin)]


EVIDENCE = {}


@pytest.mark.parametrize("rate", [*RATES, (11_000_000, 2_000_000), (100_000_000, 115_200)])
def test_model_against_fractions(rate):
    data = bytes([0, 255, 0x55, 0xAA, 1, 128, 0x96])
    assert levels(data, *rate) == edges_of(data, *rate)


def test_levels_by_hand():
    """0x96, lowest bit first, at 4 clocks a bit; then 5 1/2 clocks a bit: 5 and 6 alternate."""
    expected = [0, 0, 1, 1, 0, 1, 0, 0, 1, 1]
    assert levels(b"\x96", 12_000_000, 3_000_000) == [bit for bit in expected for _ in range(4)]
    lengths = [5, 6] * 5
    assert levels(b"\x96", 11_000_000, 2_000_000) == [b for b, n in zip(expected, lengths) for _ in range(n)]


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def matches_model(dut):
    rate = [getattr(dut, name).value.to_unsigned() for name in ("ClkHz", "BaudHz")]
    data = bytes([0, 255, 0x55, 0xAA, 1, 128]) + np.random.default_rng(bench.SEED).bytes(20)
    await bench.start(dut, in_data_i=0)
    expected = levels(data, *rate)
    line = await watch(dut, data, lambda: False)
    assert line[0] == 1
    assert line[1 : 1 + len(expected)] == expected  # the first bit begins one clock after the byte was taken
    assert set(line[1 + len(expected) :]) == {1}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def gaps_do_not_change_a_byte(dut):
    rate = [getattr(dut, name).value.to_unsigned() for name in ("ClkHz", "BaudHz")]
    data = bytes([0, 255]) + np.random.default_rng(bench.SEED).bytes(10)
    await bench.start(dut, in_data_i=0)
    pause = bench.pauses(0.98, "gaps")
    line, at, part = await watch(dut, data, pause), 0, 0
    for byte in data:
        at = line.index(0, at)
        expected = levels([byte], *rate, part=part)
        part = (part + 10 * sixteenths(*rate)) % 16
        assert line[at : at + len(expected)] == expected
        at += len(expected)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def rests_after_reset(dut):
    rate = [getattr(dut, name).value.to_unsigned() for name in ("ClkHz", "BaudHz")]
    await bench.start(dut, in_data_i=0)
    await bench.clocks(dut, 1)
    assert bench.read(dut.tx_o) == 1
    for cut in (1, 3, sixteenths(*rate) // 16, 5 * sixteenths(*rate) // 16, 10 * sixteenths(*rate) // 16):
        dut.in_valid_i.value, dut.in_data_i.value = 1, 0
        await bench.clocks(dut, cut)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        expected = levels(b"\x5a\0", *rate)
        line = await watch(dut, b"\x5a\0", lambda: False)
        assert line[: 1 + len(expected)] == [1, *expected]


@pytest.mark.parametrize("rate", RATES[:3])
def test_uart_tx(rate):
    bench.run("link", "uart_tx", dict(zip(("ClkHz", "BaudHz"), rate)))


@pytest.mark.parametrize("rate", [*RATES, (100_000_000, 115_200), (12_000_000, 300), (25_000_000, 6_250_000)])
def test_model_is_read_by_an_exact_receiver(rate):
    """Sampled at the nominal middle of each bit, as a receiver with a perfect clock would."""
    clk, baud = rate
    data = np.random.default_rng(3).bytes(50)
    line, bit = levels(data, *rate), clk / baud
    assert len(line) == pytest.approx(len(data) * 10 * bit, rel=0.5 / (16 * bit) + 1 / len(line))
    at = 0.0
    for byte in data:
        # Each byte is timed from its own start bit, as a receiver does.
        at = next(k for k in range(round(at - bit / 2), len(line)) if k >= 0 and line[k] == 0)
        seen = [line[int(at + (place + 0.5) * bit)] for place in range(10)]
        assert seen == [0, *(byte >> place & 1 for place in range(8)), 1]
        at += 10 * bit


def test_refuses_illegal_parameters():
    for clk, baud in ((12_000_000, 3_000_001), (12_000_000, 299)):
        assert f"BaudHz = {baud}" in bench.refuses("uart_tx", {"ClkHz": clk, "BaudHz": baud})
        with pytest.raises(ValueError, match=f"baud_hz = {baud}"):
            sixteenths(clk, baud)
