"""msn_uart_rx against its model, clock by clock, and the model against an ideal sender: 2 % off, every
phase, no gap and long ones, glitches under half a bit, broken stop bits, a line held low, noise, reset."""

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.uart import UartRx, sixteenths
from reference.uart_cases import READS, cases, low_from_the_reset_on
from reference.uart_rx import receive

RATES = [(12_000_000, 3_000_000), (25_000_000, 3_000_000), (48_000_000, 921_600)]


def sampled(data, clocks_per_bit, phase, gap=0.0):
    """Levels of an ideal line, sampled once a clock."""
    edges, at = [], phase
    for byte in data:
        bits = [0, *(byte >> place & 1 for place in range(8)), 1]
        edges += [(at + place * clocks_per_bit, bit) for place, bit in enumerate(bits)]
        at += (10 + gap) * clocks_per_bit
    times = np.array([time for time, _ in edges])
    clocks = np.arange(int(at) + 20)
    index = np.searchsorted(times, clocks, side="right") - 1
    return [1 if k < 0 else edges[k][1] for k in index]


def hard_line(rng, clk, baud):
    """Bytes, glitches, breaks and noise."""
    bit = clk / baud
    line = [1] * 5
    for _ in range(8):
        line += sampled(
            rng.bytes(3), bit * rng.uniform(0.98, 1.02), rng.uniform(0, 1), rng.choice([0, 0.3, 5])
        )
        kind = rng.integers(0, 4)
        if kind == 0:
            line += [0] * int(rng.integers(1, max(2, bit))) + [1] * int(12 * bit)
        elif kind == 1:
            line += [0] * int(rng.integers(9 * bit, 30 * bit)) + [1] * int(rng.integers(1, 3 * bit))
        elif kind == 2:
            line += rng.integers(0, 2, int(30 * bit)).tolist()
    return line + [1] * int(12 * bit)


def rate_of(dut):
    return [getattr(dut, name).value.to_unsigned() for name in ("ClkHz", "BaudHz")]


async def listen(dut, line):
    found = []
    for clock, level in enumerate(line):
        dut.rx_i.value = level
        await bench.ReadOnly()
        valid, error = dut.out_valid_o.value == 1, dut.error_o.value == 1
        assert not (valid and error)
        if valid or error:
            found.append((clock, bench.read(dut.out_data_o) if valid else None))
        await bench.RisingEdge(dut.clk_i)
    return found


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_model(dut):
    rng = np.random.default_rng(bench.SEED)
    rate = rate_of(dut)
    await bench.start(dut, rx_i=1)
    await bench.clocks(dut, 4)
    await bench.reset(dut)
    line = hard_line(rng, *rate)
    expected = UartRx(*rate).process(line)
    assert await listen(dut, line) == expected
    assert sum(byte is None for _, byte in expected) > 2 and len(expected) > 20


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def recovers_after_reset(dut):
    rate = rate_of(dut)
    bit = rate[0] / rate[1]
    await bench.start(dut, rx_i=1)
    for cut in (2, 3.5 * bit, 9 * bit):
        await listen(dut, sampled(b"\0", bit, 0)[: int(cut)])
        dut.rx_i.value = 1
        await bench.clocks(dut, 3)
        await bench.reset(dut)
        found = await listen(dut, [1] * 3 + sampled(b"\x96", bit, 0) + [1] * 5)
        assert [byte for _, byte in found] == [0x96]


EVIDENCE = {
    "equivalence": {"reset": {"clocks": 3, "held": 3}},
    # The parameter sets with few clocks a bit.
    "mutants": {"sets": [1, 3]},
    "faults": {"settle": 2, "driver": {"strobe": "out_valid_o", "idle": "rx_i:38", "repeat": 6}},
}


@pytest.mark.parametrize("rate", RATES)
def test_uart_rx(rate):
    bench.run("link", "uart_rx", dict(zip(("ClkHz", "BaudHz"), rate)))


@pytest.mark.parametrize("rate", READS)
def test_uart_rx_by_hand(rate):
    """Against literals and exact rationals instead of the model: link/uart_rx_by_hand.py."""
    bench.run("link", "uart_rx", dict(zip(("ClkHz", "BaudHz"), rate)), module="uart_rx_by_hand")


@pytest.mark.parametrize("rate, name, line, found", [(rate, *case) for rate in READS for case in cases(rate)])
def test_the_loop_and_the_model_hear_what_the_hand_found(rate, name, line, found):
    assert receive(line, *rate) == found, name
    heard = UartRx(*rate).process([*line, 1, 1])
    assert [(clock - 2, byte) for clock, byte in heard] == found, name


@pytest.mark.parametrize("rate", READS)
def test_the_loop_waits_for_a_rest(rate):
    line, found = low_from_the_reset_on(rate)
    assert receive(line, *rate) == found


@pytest.mark.parametrize("rate", [*READS, (100_000_000, 3_000_000), (12_000_000, 115_200)])
def test_the_model_hears_what_the_loop_hears(rate):
    bit, rng = rate[0] / rate[1], np.random.default_rng(bench.SEED)
    for choice in (
        [1, 2, int(bit), int(1.5 * bit)],
        [int(bit), int(bit) + 1],
        [1, int(bit / 2), int(9 * bit)],
    ):
        levels = [1, *np.repeat(np.arange(3000) % 2, rng.choice(choice, 3000)).tolist()]
        heard = UartRx(*rate).process([*levels, 1, 1])
        assert [(clock - 2, byte) for clock, byte in heard] == receive(levels, *rate)
        assert len(heard) > 30


@pytest.mark.parametrize("rate", [*RATES, (12_000_000, 1_000_000), (100_000_000, 3_000_000)])
@pytest.mark.parametrize("error", [-0.02, 0.0, 0.02])
def test_model_reads_an_ideal_sender(rate, error):
    rng = np.random.default_rng(4)
    for phase in np.arange(0, 1, 0.125):
        for gap in (0, 0.37, 7):
            data = bytes([0, 255, 0x55]) + rng.bytes(5)
            line = [1] * 3 + sampled(data, rate[0] / rate[1] * (1 + error), phase, gap)
            found = UartRx(*rate).process(line + [1] * 40)
            assert bytes(byte for _, byte in found if byte is not None) == data
            assert len(found) == len(data)


def test_model_in_chunks():
    line = hard_line(np.random.default_rng(5), *RATES[1])
    twin = UartRx(*RATES[1])
    whole = twin.process(line)
    twin.reset()
    assert [f for part in np.split(line, [1, 50, 51, 400]) for f in twin.next(part.tolist())] == whole


def test_refuses_illegal_parameters():
    for clk, baud in ((12_000_000, 3_000_001), (12_000_000, 299)):
        assert f"BaudHz = {baud}" in bench.refuses("uart_rx", {"ClkHz": clk, "BaudHz": baud})
        with pytest.raises(ValueError, match=f"baud_hz = {baud}"):
            sixteenths(clk, baud)
