"""Integer twin of rtl/frontend/msn_adc_spi.sv and its package: codes to samples, and the timing in clocks."""

from dataclasses import dataclass

from meissner.frontend import adc_store, spi_shift

ROUND_TRIP_NS = 7


@dataclass(frozen=True)
class Part:
    """One converter; the same facts as rtl/frontend/msn_adc_pkg.sv, sources in docs/adc.md."""

    name: str
    number: int  # msn_pkg::adc_part_e
    data_bits: int
    word_bits: int
    signed: bool
    cs_per_channel: bool
    has_busy: bool
    max_lanes: int
    sclk_max_khz: int
    sclk_min_khz: int
    sclk_default_khz: int
    access_ns: int
    conversion_max_ns: int = 0
    cycle_min_ns: int = 0

    @property
    def lane_channels(self):
        return 8 // self.max_lanes


MCP3208 = Part("mcp3208", 1, 12, 19, False, True, False, 1, 2_000, 10, 1_000, 200)
AD7606 = Part("ad7606", 2, 16, 16, True, False, True, 2, 14_500, 1, 14_500, 30, 4_200, 5_000)
PARTS = {part.number: part for part in (MCP3208, AD7606)}


def clocks_of_ns(ns, clk_khz):
    """Clocks that last at least ``ns``, at least one."""
    return max(1, -(-ns * clk_khz // 1_000_000))


@dataclass(frozen=True)
class AdcSpi:
    """The parameters of msn_adc_spi; illegal ones raise ValueError."""

    part: Part = MCP3208
    channels: int = 8
    lanes: int = 1
    clk_khz: int = 25_000
    sclk_khz: int | None = None  # upper bound; None: the part's default
    sample_bits: int = 17
    period_bits: int = 24

    def __post_init__(self):
        part = self.part
        if part not in PARTS.values():
            raise ValueError(f"part = {part} must be one of msn_pkg::adc_part_e")
        if self.sclk_khz is None:
            object.__setattr__(self, "sclk_khz", part.sclk_default_khz)
        if not 1 <= self.channels <= 8:
            raise ValueError(f"channels = {self.channels} must lie in 1 .. 8")
        if not 1 <= self.lanes <= part.max_lanes:
            raise ValueError(f"lanes = {self.lanes} must lie in 1 .. {part.max_lanes}")
        if self.lanes > 1 and self.channels <= part.lane_channels:
            raise ValueError(f"lanes = {self.lanes} must be 1: one lane has all {self.channels} channels")
        if not 1 <= self.clk_khz <= 400_000:
            raise ValueError(f"clk_khz = {self.clk_khz} must lie in 1 .. 400000")
        if not 1 <= self.sclk_khz <= part.sclk_max_khz:
            raise ValueError(f"sclk_khz = {self.sclk_khz} must lie in 1 .. {part.sclk_max_khz}")
        if self.clk_khz < 2 * self.half * part.sclk_min_khz:
            raise ValueError(f"sclk_khz = {self.sclk_khz} is too slow: the sample droops before it is out")
        if not 1 <= self.period_bits <= 32:
            raise ValueError(f"period_bits = {self.period_bits} must lie in 1 .. 32")
        self.samples([])  # checks sample_bits

    @property
    def half(self):
        """Clocks in half an SCLK period."""
        by_rate = -(-self.clk_khz // (2 * self.sclk_khz))
        by_access = (clocks_of_ns(self.part.access_ns + ROUND_TRIP_NS, self.clk_khz) + 2) // 2
        return max(by_rate, by_access)

    @property
    def words(self):
        """Codes per lane in a frame."""
        return self.part.lane_channels if self.lanes > 1 else self.channels

    @property
    def watch_clocks(self):
        """Clocks after convert start at which a frame without BUSY's answer is given up."""
        wait = clocks_of_ns(2 * self.part.conversion_max_ns, self.clk_khz)
        return 1 << max(1, (wait - 1).bit_length())

    def samples(self, codes):
        """Signed samples and over-range flags of the part's raw codes."""
        return adc_store.samples(codes, self.part.data_bits, self.sample_bits, self.part.signed)

    def read_clocks(self):
        """Clocks from the start of the transfer to its end."""
        if self.part.cs_per_channel:
            return self.channels * spi_shift.done_clock(self.part.word_bits, self.half)
        return spi_shift.done_clock(self.part.word_bits, self.half, self.words)

    def latencies(self):
        """Per channel, clocks until its sample is offered, to a consumer that is always ready.

        They count from the clock of convert_o; with BUSY, from the first clock at whose end BUSY is low.
        """
        start = 2 if self.part.has_busy else -1  # the clock in which the transfer starts
        clocks = []
        for channel in range(self.channels):
            word = channel % self.part.lane_channels if self.lanes > 1 else channel
            if self.part.cs_per_channel:
                before = word * spi_shift.done_clock(self.part.word_bits, self.half)
                arrival = before + spi_shift.word_clock(self.part.word_bits, self.half)
            else:
                arrival = spi_shift.word_clock(self.part.word_bits, self.half, word + 1)
            earliest = clocks[-1] + 1 if clocks else 0
            clocks.append(max(start + arrival + 1, earliest))
        return clocks

    def minimum_period(self, conversion_ns=None):
        """The least cfg_period at which a consumer that is always ready loses nothing, for a part that
        converts in ``conversion_ns``.

        The transfer must be over, and the samples of two lanes, which arrive together, must have left one by
        one. The part's own shortest cycle may be longer: see ``safe_period``.
        """
        if not self.part.has_busy:
            return self.read_clocks() + 1
        if conversion_ns is None:
            conversion_ns = self.part.conversion_max_ns
        busy = int(conversion_ns * self.clk_khz // 1_000_000) + 1  # from the tick until BUSY is seen low
        return busy + max(2 + self.read_clocks() + 1, self.latencies()[-1])

    def safe_period(self):
        """The least cfg_period that suits every sample of the part."""
        return max(self.minimum_period(), clocks_of_ns(self.part.cycle_min_ns, self.clk_khz))
