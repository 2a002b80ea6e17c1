"""Slip of each channel at a pin of its own: a board's top with three channels, from the converter's pins. One
channel after the other is shaken; the pin of that channel alone is high then, and slip_o with it."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

from boards.test_two_converters import mcp3208, simulate

REST, SHAKEN = 2000, (2500, 2000, 2000, 2000)  # details of 0 and ±500, wherever a pair begins
ORDER = (1, 0, 2)  # not that of the channels
FRAMES = 24  # at rest, then shaken


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def each_channel_has_its_pin(dut):
    """A window has 4 samples, so a channel is over from the second window of the shaking on; each flag is
    looked at in the last frame of a phase."""
    dut.rx_i.value, dut.moving_i.value, dut.adc_miso_i.value = 1, 0, 0
    frame, shaken = 0, None

    def code(channel):
        return SHAKEN[frame % 4] if channel == shaken else REST

    cocotb.start_soon(Clock(dut.clk_25m_i, 40, "ns").start())
    cocotb.start_soon(mcp3208(dut, 0, [0], code))
    cs = RisingEdge(dut.adc_cs_n_o)
    for shaken in (None, *(one for channel in ORDER for one in (channel, None))):
        for _ in range(FRAMES):
            for _ in range(3):  # a transfer for each channel
                await cs
            frame += 1
        seen = int(dut.slip_each_o.value)
        assert seen == (0 if shaken is None else 1 << shaken), f"{seen:03b} while {shaken} is shaken"
        assert int(dut.slip_o.value) == (shaken is not None)


def test_slip_pins(tmp_path):
    assert simulate("each", "boards.test_slip_pins", tmp_path) == ["each_channel_has_its_pin"]
