"""Integer twin of rtl/frontend/msn_adc_single.sv: codes to samples, and the timing in clocks."""

from dataclasses import dataclass

from meissner.twins.frontend import adc_store
from meissner.twins.frontend.adc_spi import MCP3208, AdcSpi
from meissner.twins.shared import fits


@dataclass(frozen=True)
class AdcSingle:
    """The parameters of msn_adc_single, one channel of an MCP3208; illegal ones raise ValueError.

    ``period``: clocks from convert start to convert start. ``sclk_khz`` is an upper bound.
    """

    channel: int = 0
    clk_khz: int = 12_000
    sclk_khz: int = 2_000
    period: int = 1_200
    sample_bits: int = 13

    def __post_init__(self):
        fits(self, channel=(0, 7))
        AdcSpi(MCP3208, 1, 1, self.clk_khz, self.sclk_khz, self.sample_bits)  # checks these
        if self.clk_khz < self.bit_clocks * MCP3208.sclk_min_khz:
            raise ValueError(f"sclk_khz = {self.sclk_khz} is too slow: the sample droops before it is out")
        fits(self, period=(self.minimum_period, None))

    @property
    def bit_clocks(self):
        """Clocks per bit: the smallest power of two that is slow enough."""
        half = AdcSpi(MCP3208, 1, 1, self.clk_khz, self.sclk_khz).half
        return 1 << (2 * half - 1).bit_length()

    @property
    def minimum_period(self):
        """The shortest period: a word, plus CS high for one bit."""
        return (MCP3208.word_bits + 1) * self.bit_clocks + 1

    @property
    def latency(self):
        """Clocks from convert_o to out_valid_o."""
        return MCP3208.word_bits * self.bit_clocks + 1

    def samples(self, codes):
        """Signed samples and over-range flags of the part's codes."""
        return adc_store.samples(codes, MCP3208.data_bits, self.sample_bits, False)
