"""Integer twin of rtl/frontend/msn_acquire.sv: samples from a converter's codes or from a stream."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meissner.twins.frontend.adc_single import AdcSingle
from meissner.twins.frontend.adc_spi import MCP3208, AdcSpi, Part


@dataclass(frozen=True)
class Acquire:
    """The parameters of msn_acquire; illegal ones raise ValueError.

    ``part``: None if samples arrive on the stream; ``adc_period``: clocks of msn_adc_single, or 0.
    """

    part: Part | None = None
    channels: int = 1
    lanes: int = 1
    clk_khz: int = 25_000
    sclk_khz: int | None = None
    adc_period: int = 0
    sample_bits: int = 17
    period_bits: int = 24
    read_during: bool = False

    def __post_init__(self):
        if self.part is not None:
            _ = self.adc  # checks the rest

    @cached_property
    def adc(self):
        """Twin of the block that reads the converter: AdcSingle or AdcSpi, None for a stream."""
        if self.part is None:
            return None
        if not self.adc_period:
            sizes = (self.part, self.channels, self.lanes, self.clk_khz, self.sclk_khz)
            return AdcSpi(*sizes, self.sample_bits, self.period_bits, self.read_during)
        if self.part is not MCP3208 or self.channels != 1:
            raise ValueError(f"adc_period = {self.adc_period} must be 0 but for one channel of an MCP3208")
        sclk_khz = self.sclk_khz or self.part.sclk_default_khz
        return AdcSingle(0, self.clk_khz, sclk_khz, self.adc_period, self.sample_bits)

    def samples(self, codes):
        """Signed samples and over-range flags of a part's raw codes; a stream's samples pass unchanged."""
        if self.adc is None:
            return np.asarray(codes), np.zeros(np.shape(codes), dtype=bool)
        return self.adc.samples(codes)
