"""Twin of rtl/frontend/msn_scan_demod.sv: a scan of carriers, and the time of each of its steps."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.frontend import scan, timing
from meissner.twins.frontend.adc_spi import MAX11123, AdcSpi, Part
from meissner.twins.frontend.am_demod import IQ, AmDemod
from meissner.twins.frontend.scan import Scan
from meissner.twins.shared import LANES, fits, one_of


@dataclass(frozen=True)
class ScanDemod:
    """The parameters of msn_scan_demod; illegal ones raise ValueError."""

    rows: int = 8
    columns: int = 8
    converters: int = 1
    part: Part = MAX11123
    clk_khz: int = 25_000
    sclk_khz: int | None = None
    sample_bits: int = 17
    form: int = IQ
    samples_per_period: int = 4
    sample_period: int = 160  # clocks
    periods: int = 4
    skip: int = 4  # samples ignored while the input settles
    shift: int = 3

    def __post_init__(self):
        if self.part.has_busy:
            raise ValueError(f"part = {self.part.name} must convert without BUSY")
        one_of(LANES, converters=self.converters)
        fits(self, periods=(1, None), skip=(0, None), sample_period=(self.adc.cycle_clocks(), None))
        assert self.demod and self.scan  # constructing them checks their parameters

    @property
    def adc(self):
        return AdcSpi(self.part, 1, 1, self.clk_khz, self.sclk_khz, self.sample_bits, 1)

    @property
    def count(self):
        """Samples of a burst."""
        return timing.samples(self.skip, self.periods, self.samples_per_period)

    @property
    def demod(self):
        return AmDemod(
            *(self.form, self.samples_per_period, self.converters, self.converters, self.sample_bits),
            *(self.periods.bit_length(), (self.skip + 1).bit_length()),
        )

    @property
    def span(self):
        """Clocks from a place's trigger to its last convert start."""
        return 2 + (self.count - 1) * self.sample_period

    @property
    def scan(self):
        bound = 3 * (self.sample_bits + 5 + self.periods.bit_length() + 1) + self.shift + 2
        demod = 5 + self.converters * bound
        hold = self.span + self.adc.hold_clocks()
        cycle = self.span + self.adc.cycle_clocks() + demod
        return Scan(*(self.rows, self.columns, 1, self.converters, hold, cycle), sample_bits=self.sample_bits)

    def levels(self, samples, user=None):
        """(amplitude, over-range) [...] of bursts of signed samples [..., count]."""
        samples = np.asarray(samples)[..., self.skip :]
        user = None if user is None else np.asarray(user)[..., self.skip :]
        return self.demod.amplitude(samples, self.shift, user)

    def latency(self, settle):
        """Clocks of each step, by name, with an always-ready consumer and back-to-back frames.

        As in ScanAdc.latency; ``burst``: from a place's first convert start to its last; ``demod_first``,
        ``demod_last``: from a burst's last sample to its first and last amplitude.
        """
        plan, demod = self.scan, self.demod
        lanes = (self.converters - 1) * demod.lane_clocks(self.shift)
        steps = {
            "settle": settle,
            "burst": (self.count - 1) * self.sample_period,
            "transfer": self.adc.latencies()[0],
            "demod_first": demod.latency(self.shift),
            "demod_last": demod.latency(self.shift) + lanes,
            "out": scan.LATENCY,
            "slot": plan.slot(settle),
            "frame": plan.frame_clocks(settle),
        }
        final = steps["frame"] - steps["slot"]
        to_level = steps["burst"] + steps["transfer"] + steps["out"]
        used = (self.columns - 1) % self.converters  # lanes before the last one in the last group
        steps |= {
            "last_convert": final,
            "first_beat": to_level + steps["demod_first"],
            "last_beat": final + to_level + steps["demod_first"] + used * demod.lane_clocks(self.shift),
        }
        return steps
