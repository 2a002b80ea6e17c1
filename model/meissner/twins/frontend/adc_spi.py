"""Integer twin of rtl/frontend/msn_adc_spi.sv and its package: codes to samples, and the timing in clocks."""

from dataclasses import dataclass

from meissner.twins.frontend import adc_store, spi_shift
from meissner.twins.shared import fits

ROUND_TRIP_NS = 7
HOLD_NS = 25


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
    reset_ns: int = 0  # RESET is high, then low, before the first word or conversion
    start_ns: int = 0
    conversion_min_ns: int = 0
    read_end_ns: int = 0  # from the end of a read to the next fall of BUSY, at least
    tagged: bool = False  # four bits of channel number before the code; a frame's first word carries no code
    setup: tuple = ()  # words sent before the first conversion

    def setup_words(self, lanes):
        """``setup`` with the number of lanes in it."""
        if self.has_busy and self.setup:
            return (self.setup[0], self.setup[1] | lanes.bit_length() - 1 << 3, *self.setup[2:])
        return self.setup

    @property
    def lead(self):
        return self.tagged

    def cs_clocks(self, half, words=1):
        """Clocks from one CS frame of ``words`` words to the next."""
        return spi_shift.done_clock(self.word_bits, half, words, self.lead)

    def command(self, index):
        """The 16 bits sent, top bit first, with word ``index`` of a frame."""
        if self.tagged:
            return 0x0804 | index % 8 << 7  # mode control: manual scan, channel, its number in the answer
        return 0 if self.has_busy else 0xC000 | index % 8 << 11


def _max(name, number, data_bits, sclk_khz=16_000):
    setup = (0x0040, 0x8000, 0x8800, 0x9000, 0x9800)
    return Part(
        *(name, number, data_bits, 16, False, True, False, 1, sclk_khz, sclk_khz // 100, sclk_khz, 17),
        reset_ns=100,
        start_ns=100,
        tagged=True,
        setup=setup,
    )


MCP3208 = Part("mcp3208", 1, 12, 19, False, True, False, 1, 2_000, 10, 1_000, 200)
AD7606 = Part(
    *("ad7606", 2, 16, 16, True, False, True, 2, 17_000, 1, 14_500, 30, 4_200, 5_000, 100, 100, 3_450, 25)
)
MAX11123 = _max("max11123", 3, 8)
MAX11124 = _max("max11124", 4, 10)
MAX11125 = _max("max11125", 5, 12)
# Read register 2, then write: lanes, ranges of +-5 V, wide bandwidth; 0: back to conversions.
AD7606C = Part(
    *("ad7606c-16", 6, 16, 16, True, True, True, 8, 60_000, 1, 60_000, 20, 700, 1_000, 3_300, 275_000),
    conversion_min_ns=500,
    read_end_ns=25,
    setup=(0x4200, 0x0200, 0x0311, 0x0411, 0x0511, 0x0611, 0x07FF, 0x0000),
)
MAX11131 = _max("max11131", 7, 12, 48_000)
_ALL = (MCP3208, AD7606, MAX11123, MAX11124, MAX11125, AD7606C, MAX11131)
PARTS = {part.number: part for part in _ALL}
BY_NAME = {part.name.upper(): part for part in _ALL}


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
    read_during: bool = False  # a frame is read while the next one is converted

    def __post_init__(self):
        part = self.part
        if part not in PARTS.values():
            raise ValueError(f"part = {part} must be one of msn_pkg::adc_part_e")
        if self.sclk_khz is None:
            object.__setattr__(self, "sclk_khz", part.sclk_default_khz)
        fits(self, channels=(1, 8), lanes=(1, part.max_lanes))
        if self.lanes & self.lanes - 1:
            raise ValueError(f"lanes = {self.lanes} must be a power of two up to {part.max_lanes}")
        if self.lanes > 1 and self.channels <= self.lane_channels:
            raise ValueError(f"lanes = {self.lanes} must be 1: one lane has all {self.channels} channels")
        if self.read_during and not part.has_busy:
            raise ValueError(f"read_during = True must be False for a part without BUSY, as the {part.name}")
        fits(self, clk_khz=(1, 400_000), sclk_khz=(1, part.sclk_max_khz))
        if part.has_busy and self.clk_khz * part.conversion_max_ns <= 2_000_000:
            least = 2_000_000 // part.conversion_max_ns + 1
            raise ValueError(f"clk_khz = {self.clk_khz} must be at least {least} to see the part's BUSY")
        if self.clk_khz < 2 * self.half * part.sclk_min_khz:
            raise ValueError(f"sclk_khz = {self.sclk_khz} is too slow: the sample droops before it is out")
        fits(self, period_bits=(1, 32))
        self.samples([])  # checks sample_bits

    @property
    def half(self):
        """Clocks in half an SCLK period."""
        by_rate = -(-self.clk_khz // (2 * self.sclk_khz))
        by_access = (clocks_of_ns(self.part.access_ns + ROUND_TRIP_NS, self.clk_khz) + 2) // 2
        return max(by_rate, by_access)

    @property
    def lane_channels(self):
        return 8 // self.lanes

    @property
    def words(self):
        """Words per lane in a frame; the first word of a tagged part carries no code."""
        return (self.lane_channels if self.lanes > 1 else self.channels) + self.part.tagged

    @property
    def watch_clocks(self):
        """Clocks after convert start at which a frame is given up if BUSY has not answered."""
        if self.read_during:
            return self.busy_clocks + 4
        wait = clocks_of_ns(2 * self.part.conversion_max_ns, self.clk_khz)
        return 1 << max(1, (wait - 1).bit_length())

    @property
    def busy_clocks(self):
        """The last clock after convert start in which BUSY may fall."""
        return self.part.conversion_max_ns * self.clk_khz // 1_000_000

    @property
    def busy_least(self):
        """The first clock after convert start at whose end BUSY may have fallen."""
        return clocks_of_ns(self.part.conversion_min_ns, self.clk_khz) - 1

    def samples(self, codes):
        """Signed samples and over-range flags of the part's raw codes."""
        return adc_store.samples(codes, self.part.data_bits, self.sample_bits, self.part.signed)

    def read_clocks(self):
        """Clocks from the start of the transfer to its end."""
        if self.part.cs_per_channel:
            return self.words * self.part.cs_clocks(self.half)
        return self.part.cs_clocks(self.half, self.words)

    def start_clocks(self):
        """Clocks from the end of reset until a tick can start a conversion."""
        if not self.part.start_ns:
            return 0
        rest = sum(clocks_of_ns(ns, self.clk_khz) for ns in (self.part.reset_ns, self.part.start_ns))
        return rest + len(self.part.setup) * self.part.cs_clocks(self.half) + 1

    def hold_clocks(self):
        """Clocks from convert_o until every channel has sampled its input, which may then change."""
        if self.part.has_busy:
            return clocks_of_ns(HOLD_NS, self.clk_khz) + 1
        if self.part.tagged:
            return self.channels * self.part.cs_clocks(self.half) + 1
        return (self.channels - 1) * self.part.cs_clocks(self.half) + 12 * self.half + 1

    def cycle_clocks(self):
        """Clocks between triggers in which every frame ends and its samples (or, for a lost frame, as many
        substitutes, 4 clocks later) leave to an always-ready consumer."""
        if self.read_during:
            lost = self.busy_clocks + self.read_clocks() + self.channels + 7 - self.overlap_clocks()
            return max(self.safe_period(), self.watch_clocks + 1, lost)
        if self.part.has_busy:
            return max(self.safe_period(), self.watch_clocks + self.channels + 4)
        return self.read_clocks() + (self.channels + 4 if self.part.tagged else 1)

    def guard_clocks(self):
        """Clocks from the start of a transfer in which no tick starts a conversion: its BUSY could fall less
        than ``read_end_ns`` after the transfer, or before the shifter rests."""
        ends = self.read_clocks() - 2 * self.half  # CS rises a clock later
        least = (self.part.conversion_min_ns - self.part.read_end_ns) * self.clk_khz // 1_000_000
        return max(ends - least, self.read_clocks() - 2 - self.busy_least, 1)

    def overlap_clocks(self):
        """Clocks after a trigger from which on samples and losses are of its conversion; 0: from the trigger
        on. A loss is known after the watchdog, a sample after the first word of the shortest conversion."""
        first = self.busy_least + 3 + spi_shift.word_clock(self.part.word_bits, self.half)
        return min(self.busy_clocks + 4, first) if self.read_during else 0

    def latencies(self):
        """Per channel, clocks until its sample is offered to an always-ready consumer.

        They count from the clock of convert_o; with BUSY, from the first clock at whose end BUSY is low.
        """
        start = 2 if self.part.has_busy else -1  # the clock in which the transfer starts
        clocks = []
        for channel in range(self.channels):
            word = channel % self.lane_channels if self.lanes > 1 else channel
            if self.part.tagged:
                word = self.channels  # all samples wait for the last word, because its tag could be wrong
            if self.part.cs_per_channel:
                before = word * self.part.cs_clocks(self.half)
                arrival = before + spi_shift.word_clock(self.part.word_bits, self.half, lead=self.part.lead)
            else:
                arrival = spi_shift.word_clock(self.part.word_bits, self.half, word + 1)
            earliest = clocks[-1] + 1 if clocks else 0
            clocks.append(max(start + arrival + 1, earliest))
        return clocks

    def minimum_period(self, conversion_ns=None):
        """The smallest cfg_period at which an always-ready consumer loses nothing, for a part that
        converts in ``conversion_ns``.

        The transfer must be over, and the samples of two lanes, which arrive together, must have left one by
        one. The part's own shortest cycle may be longer: see ``safe_period``.
        """
        if not self.part.has_busy:
            return max(self.read_clocks(), self.latencies()[-1]) + 1
        spread = self.busy_clocks - self.busy_least if conversion_ns is None else 0
        if conversion_ns is None:
            conversion_ns = self.part.conversion_max_ns
        busy = int(conversion_ns * self.clk_khz // 1_000_000) + 1  # from the tick until BUSY is sampled low
        if self.read_during:
            return max(busy + 2 + self.guard_clocks(), spread + self.latencies()[-1] - 2)
        return busy + max(2 + self.read_clocks() + 1, self.latencies()[-1])

    def safe_period(self):
        """The smallest cfg_period that suits every specimen of the part."""
        return max(self.minimum_period(), clocks_of_ns(self.part.cycle_min_ns, self.clk_khz))
