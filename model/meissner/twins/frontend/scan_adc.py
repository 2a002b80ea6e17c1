"""Twin of rtl/frontend/msn_scan_adc.sv: a scan with its converters, and the time of each of its steps."""

from dataclasses import dataclass, field

from meissner.twins.frontend import scan
from meissner.twins.frontend.adc_spi import AD7606, AdcSpi, Part
from meissner.twins.frontend.scan import Scan


@dataclass(frozen=True)
class ScanAdc:
    """The parameters of msn_scan_adc; illegal ones raise ValueError."""

    rows: int = 16
    columns: int = 16
    lanes: int = 1  # converters
    part: Part = AD7606
    channels: int = 8  # inputs used per converter
    adc_lanes: int = 1
    clk_khz: int = 25_000
    sclk_khz: int | None = None
    sample_bits: int = 17
    depth: int | None = None
    read_during: bool = False  # a conversion is read while the next one runs
    adc: AdcSpi = field(init=False, repr=False, compare=False)
    scan: Scan = field(init=False, repr=False, compare=False)

    def __post_init__(self):
        adc = AdcSpi(
            *(self.part, self.channels, self.adc_lanes, self.clk_khz, self.sclk_khz, self.sample_bits, 1),
            read_during=self.read_during,
        )
        plan = Scan(
            *(self.rows, self.columns, self.lanes, self.channels, adc.hold_clocks(), adc.cycle_clocks()),
            sample_bits=self.sample_bits,
            depth=self.depth,
            overlap=adc.overlap_clocks(),
        )
        object.__setattr__(self, "adc", adc)
        object.__setattr__(self, "scan", plan)

    def latency(self, settle, conversion_ns=None):
        """Clocks of each step, by name, with an always-ready consumer and back-to-back frames.

        ``conversion_ns``: conversion time of a part with BUSY, at the converter's pins; None: the longest.

        - ``settle``: from switching the lines of a place to its convert start
        - ``convert``: from convert start until BUSY is sampled low (0 without BUSY)
        - ``transfer_first``, ``transfer_last``: from there to the conversion's first and last sample
        - ``out``: from a sample to its beat at the output
        - ``slot``: from convert start to convert start
        - ``frame``: from a frame's first convert start to the next one's
        - ``last_convert``: from a frame's first convert start to its last
        - ``first_beat``, ``last_beat``: from a frame's first convert start to its first and last beat
        """
        plan, adc = self.scan, self.adc
        convert = 0
        if self.part.has_busy:
            if conversion_ns is None:
                conversion_ns = self.part.conversion_max_ns
            convert = int(conversion_ns * self.clk_khz // 1_000_000)
        offered = adc.latencies()
        slot = plan.slot(settle)
        frame = plan.frame_clocks(settle)
        final = frame - slot
        return {
            "settle": settle,
            "convert": convert,
            "transfer_first": offered[0],
            "transfer_last": offered[-1],
            "out": scan.LATENCY,
            "slot": slot,
            "frame": frame,
            "last_convert": final,
            "first_beat": convert + offered[0] + scan.LATENCY,
            "last_beat": final + convert + offered[(plan.beats - 1) % self.channels] + scan.LATENCY,
        }
