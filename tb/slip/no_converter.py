"""The converter pins of msn_channels when samples come from a stream. Run by test_channels.py."""

import cocotb

import bench


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_converter_that_is_not_there_rests(dut):
    """CS is high, the other pins are low, and any clock may be a convert start."""
    pins = ("cs_n", "sclk", "mosi", "convst", "reset")
    await bench.start(dut, cfg_adc_enable_i=1, cfg_adc_period_i=5, adc_miso_i=1, adc_busy_i=1)
    for _ in range(20):
        await bench.ReadOnly()
        assert [bench.read(getattr(dut, f"adc_{pin}_o")) for pin in pins] == [1, 0, 0, 0, 0]
        assert bench.read(dut.convert_o) == 1
        await bench.RisingEdge(dut.clk_i)
