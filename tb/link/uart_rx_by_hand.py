"""msn_uart_rx on the lines of tb/reference/uart_cases.py, and against the loop of tb/reference/uart_rx.py.

Run by test_uart_rx.py.
"""

import cocotb
import numpy as np

import bench
from reference.uart_cases import cases, low_from_the_reset_on
from reference.uart_rx import receive


async def listen(dut, line):
    """(clock of the line, byte) of each output; a level is seen two clocks later (the synchroniser)."""
    found = []
    await bench.reset(dut)
    for clock, level in enumerate([*line, 1, 1]):
        dut.rx_i.value = level
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1 or dut.error_o.value == 1:
            found.append((clock - 2, bench.read(dut.out_data_o) if dut.out_valid_o.value == 1 else None))
        await bench.RisingEdge(dut.clk_i)
    return found


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def hears_what_the_hand_found(dut):
    rate = dut.ClkHz.value.to_unsigned(), dut.BaudHz.value.to_unsigned()
    await bench.start(dut, rx_i=1)
    for name, line, found in [*cases(rate), ("low", *low_from_the_reset_on(rate))]:
        dut.rx_i.value = line[0]  # a reset does not clear the synchroniser
        await bench.clocks(dut, 3)
        assert await listen(dut, line) == found, name


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def hears_what_the_loop_hears(dut):
    """Noise of short and long levels."""
    rate = dut.ClkHz.value.to_unsigned(), dut.BaudHz.value.to_unsigned()
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut, rx_i=1)
    await bench.clocks(dut, 3)
    lengths = rng.choice([1, 2, int(rate[0] / rate[1]), int(1.5 * rate[0] / rate[1])], 700)
    line = [1, *(int(level) for level in np.repeat(np.arange(700) % 2, lengths))]
    expected = receive(line, *rate)
    assert await listen(dut, line) == expected
    assert len(expected) > 10 and any(byte is None for _, byte in expected)
