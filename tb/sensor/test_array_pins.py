"""msn_sensor_array at pin level: row lines, column multiplexer, converters that check their timing, then
health, tare, calibration and centre of pressure, all stages at once.

The cases: a capacitive array on its carrier behind a MAX11125, demodulated; 4×8 behind an MCP3208 and 16×16
behind an AD7606; 4×10 behind three MCP3208 and 5×17 behind five AD7606 of three inputs, whose second group
of columns has one beat; 3×16 behind eight MCP3208 or two AD7606C-16 on eight lines each; 2×14 behind two
MAX11131; 2×3 behind each MAX1112x; 64×64 behind eight AD7606; with the converters' front on, 4×16 behind an
AD7606, and 64×64 behind parts that settle in time; 16×16, 64×64 and 3×16 behind AD7606C-16 are also read
during the next conversion, so each part is read in each way that it has. Pins of several parts
move together (one model, so all give the same codes). Gains differ from taxel to taxel, a tare of the first
frames finds the zeros, then a press moves. Every result equals the twin's for the very codes at the pins, bit
for bit; every latency is the twin's, which is what `meissner budget` prints, and is below 1 ms where the
array's converters allow it. On the smallest array also the forces at the tap, faults and counters.
"""

from dataclasses import replace

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
import members
from meissner.budget.array import terms
from meissner.builds.settling import Settling
from meissner.twins.frontend.adc_spi import (
    AD7606,
    AD7606C,
    MAX11123,
    MAX11124,
    MAX11125,
    MAX11131,
    MCP3208,
    PARTS,
)
from meissner.twins.frontend.health import Limits
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.frontend.scan_demod import ScanDemod
from meissner.twins.sensor.sensors import Array
from parts import front
from parts.ad7606 import Ad7606
from parts.ad7606 import Limits as Timing
from parts.ad7606c import Ad7606c
from parts.carrier import CarrierMatrix
from parts.max1112x import FAST, Max1112x
from parts.mcp3208 import Mcp3208
from parts.timing import Line

CLK_KHZ = 100_000  # the bench's clock of 10 ns
CARRIER_HZ = 1e8 / 256
CONVERSION_NS = {AD7606: 3995, AD7606C: 615}  # so that BUSY falls between two clock edges
SETTLE = 7
TARE_LOG2 = 1
MICROSECONDS = {(16, 0): 331, (64, 0): 662}  # stated in the README for the two arrays behind AD7606
# Read during the next conversion, a slot is 5.97 us at 12.5 MHz of SCLK, and the part's 5 us at 16.7 MHz.
MICROSECONDS |= {(16, 1): 194, (64, 1): 323}
OFFSET = 777  # a calibration's offset, which must have no effect after a tare
FRAMES = 5  # two for the tare, one until the tare is in effect, then two pressed

# {(rows, columns, part): ...} of cases whose converters have their front: its values, full scale, and the
# share of the old row that may remain (None: half a code). The others show the digital side, with SETTLE.
SETTLED = {
    (4, 16, AD7606): (front.AD7606_10V, 10.0, 0.005),
    (64, 64, AD7606C): (front.AD7606C, 5.0, 0.005),
    (64, 64, MAX11125): (front.MAX1112X, 5.0, None),
    (64, 64, MAX11131): (front.MAX1112X, 5.0, None),
}
# ln(sqrt(2)/0.005)/(sqrt(2) pi corner) = 55.240 and 5.7752 us; 5 ns · ln(8192) are less than the least, 1 us.
SETTLE_CLOCKS = {AD7606: 5525, AD7606C: 578, MAX11125: 100, MAX11131: 100}
CASES = {
    "demod": {
        **{"Rows": 2, "Columns": 3, "Demod": 1, "Adc": MAX11125.number, "SamplePeriod": 320},
        **{"Periods": 2, "Skip": 2, "Shift": 0},
    },
    "2x2": {"Rows": 2, "Columns": 2, "Adc": MCP3208.number, "AdcChannels": 2, "SclkKhz": 2000, "Tap": 1},
    "4x8": {"Rows": 4, "Columns": 8, "Adc": MCP3208.number, "AdcChannels": 8, "SclkKhz": 2000},
    "3x16": {
        **{"Rows": 3, "Columns": 16, "Adc": MCP3208.number, "AdcChannels": 2, "SclkKhz": 2000},
        "Converters": 8,
    },
    "4x10": {
        **{"Rows": 4, "Columns": 10, "Adc": MCP3208.number, "AdcChannels": 4, "SclkKhz": 2000},
        "Converters": 3,
    },
    "5x17": {"Rows": 5, "Columns": 17, "Adc": AD7606.number, "AdcChannels": 3, "Converters": 5},
    "3x16c": {
        **{"Rows": 3, "Columns": 16, "Adc": AD7606C.number, "Converters": 2, "AdcLanes": 8},
        "SclkKhz": 60_000,
    },
    "2x14": {"Rows": 2, "Columns": 14, "Adc": MAX11131.number, "Converters": 2, "AdcChannels": 7},
    "16x16": {"Rows": 16, "Columns": 16, "Adc": AD7606.number, "AdcLanes": 2},
    "64x64": {
        "Rows": 64,
        "Columns": 64,
        "Adc": AD7606.number,
        "Converters": 8,
        "AdcLanes": 2,
    },
    "4x16 settled": {"Rows": 4, "Columns": 16, "Adc": AD7606.number, "AdcChannels": 8, "AdcLanes": 2},
    "64x64 settled, eight MAX11125": {
        **{"Rows": 64, "Columns": 64, "Adc": MAX11125.number, "AdcChannels": 8, "SclkKhz": 16_000},
        "Converters": 8,
    },
    # The fewest converters that read 64×64 within a millisecond.
    "64x64 settled, four AD7606C-16": {
        **{"Rows": 64, "Columns": 64, "Adc": AD7606C.number, "Converters": 4, "AdcLanes": 2},
        "SclkKhz": 60_000,
    },
    "64x64 settled, four MAX11131": {
        **{"Rows": 64, "Columns": 64, "Adc": MAX11131.number, "Converters": 4, "SclkKhz": 48_000},
        "AdcChannels": 8,
    },
}
for part in (MAX11123, MAX11124, MAX11125):
    CASES[f"2x3 {part.name}"] = {"Rows": 2, "Columns": 3, "Adc": part.number, "AdcChannels": 3}
CASES["3x16c during"] = CASES["3x16c"] | {"ReadDuring": 1}
CASES["16x16 during"] = CASES["16x16"] | {"ReadDuring": 1}
CASES["64x64 during"] = CASES["64x64"] | {"ReadDuring": 1, "SclkKhz": 17_000}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def smallest(dut):
    """Whether this is the 2×2 array, whose frames take the fewest clocks."""
    return number(dut, "Rows") * number(dut, "Columns") == 4


def twin_of(dut, limits=None):
    rows, columns, clk_khz = number(dut, "Rows"), number(dut, "Columns"), number(dut, "ClkKhz")
    part = PARTS[number(dut, "Adc")]
    if number(dut, "Demod"):
        names = ("Form", "SamplesPerPeriod", "SamplePeriod", "Periods", "Skip", "Shift")
        form, *rest = (number(dut, name) for name in names)
        scan = ScanDemod(rows, columns, number(dut, "Converters"), part, clk_khz, None, 17, form, *rest)
    else:
        lanes, channels, adc_lanes = (number(dut, name) for name in ("Converters", "AdcChannels", "AdcLanes"))
        scan = ScanAdc(rows, columns, lanes, part, channels, adc_lanes, clk_khz, number(dut, "SclkKhz"))
        scan = replace(scan, read_during=bool(number(dut, "ReadDuring")))
    tare = {"tare_log2": TARE_LOG2, "contact": 200, "step": 1}
    kinds = {"bits_per_clock": number(dut, "BitsPerClock"), "gain_shift": number(dut, "GainShift")}
    return Array(scan, limits or Limits(), tare, **kinds)


def settled(dut):
    """The entry of SETTLED for this array, or None."""
    return SETTLED.get((number(dut, "Rows"), number(dut, "Columns"), PARTS[number(dut, "Adc")]))


def settle_of(dut, twin):
    """Clocks: as many as ``meissner budget`` takes for converters with their front."""
    return Settling(twin.scan, *settled(dut)[1:]).clocks(None) if settled(dut) else SETTLE


def status(dut):
    return members.of("status", bench.read(dut.status_o))


class Together:
    """Pins of several converters, all driven by one model: ``lanes`` levels for each converter."""

    def __init__(self, handle, lanes=1):
        self.handle, self.lanes = handle, lanes

    def __len__(self):
        return self.lanes

    @property
    def value(self):
        return self.handle.value

    @value.setter
    def value(self, level):
        copies = len(self.handle) // self.lanes
        self.handle.value = sum(int(level) << copy * self.lanes for copy in range(copies))


class Alike(Line):
    """Pins of several converters that the block must drive alike, seen as one; with ``cs_n`` only while that
    is low: before its first word a data line may have any level."""

    def __init__(self, port, cs_n=None):
        super().__init__(port, 0, {})
        self.cs_n = cs_n

    @property
    def value(self):
        levels = bench.read(self.port)
        rests = self.cs_n is not None and bench.read(self.cs_n)
        assert rests or levels in (0, (1 << len(self.port)) - 1), f"{self.port._name} is {levels:b}"
        return levels & 1


class Matrix:
    """Codes of the taxels; ``taken`` [(time in ns, row, group, channel, code)]; ``press``: added to the
    codes; ``plan``: instead of ``press``, a list with one value per frame; ``front``: what the levels pass,
    ``errors`` then [largest difference that it makes to a code of each conversion]."""

    def __init__(self, dut, twin, bits):
        self.dut, self.twin = dut, twin
        rng = np.random.default_rng(bench.SEED)
        shape = twin.scan.rows, twin.scan.columns
        self.zero = rng.integers(1 << bits - 6, 1 << bits - 5, shape)
        self.press = np.zeros(shape, dtype=np.int64)
        # A part that tags its words samples once more at each place; after its setup that sample has no code.
        self.lead = twin.scan.part.lead
        self.taken, self.times, self.plan, self.errors = [(0, 0, 0, 0, 0)] * self.lead, [], [], []
        part = twin.scan.part
        self.most, self.mask = (1 << part.data_bits - part.signed) - 1, (1 << part.data_bits) - 1
        self.front = None
        if settled(dut):
            self.front = front.Front(settled(dut)[0], self.levels, (dut.row_o, dut.group_o))

    def level(self, row, group, channel):
        column = self.twin.scan.scan.column(group, channel, 0)
        if column >= self.twin.scan.columns:
            return self.most  # of an input without a column
        return min(int(self.zero[row, column] + self.press[row, column]), self.most)

    def levels(self):
        """At the pins of one converter; 0 without a row."""
        row, group = bench.read(self.dut.row_o).bit_length() - 1, bench.read(self.dut.group_o)
        return [self.level(row, group, channel) if row >= 0 else 0 for channel in range(8)]

    def code(self, channel, time_ns):
        rows = bench.read(self.dut.row_o)
        if self.lead and not rows:
            return 0  # of a setup word after a reset
        assert rows and rows & rows - 1 == 0, f"rows {rows:b} while converting"
        row, group = rows.bit_length() - 1, bench.read(self.dut.group_o)
        if channel >= self.twin.scan.channels and not self.lead:
            return 0  # the part converts an input whose word is not read
        if self.plan:
            self.press = self.plan[min(self.frames, len(self.plan) - 1)]
        level = self.level(row, group, channel)
        if self.front:
            level = min(round(self.front.sample(channel)), self.most)
            self.errors.append(abs(level - self.front.to[channel]))
        code = level & self.mask
        self.taken.append((time_ns, row, group, channel, code))
        return code

    @property
    def per_frame(self):
        scan = self.twin.scan
        return scan.rows * scan.scan.groups * (scan.channels + self.lead)

    @property
    def frames(self):
        """Number of frames of which all codes were taken."""
        return len(self.taken) // self.per_frame

    def samples(self, count):
        """Signed samples [count, rows, columns] and over-range flags of the codes taken."""
        scan = self.twin.scan
        rows, columns, lanes, channels = scan.rows, scan.columns, scan.lanes, scan.channels
        codes = np.array([code for *_, code in self.taken])[: count * self.per_frame]
        codes = codes.reshape(count, rows, scan.scan.groups, -1)[..., self.lead :]
        codes = codes.reshape(count, rows, scan.scan.groups * channels)
        codes = np.repeat(codes, lanes, axis=2)[:, :, :columns]  # column = place * lanes + lane
        return scan.adc.samples(codes)


class Carrier(CarrierMatrix):
    """The same for the amplitudes of a carrier."""

    def __init__(self, dut, twin, bits):
        rng = np.random.default_rng(bench.SEED)
        self.twin = twin
        self.zero = rng.uniform(0.1, 0.2, (twin.scan.rows, twin.scan.columns))
        super().__init__(dut, self.zero, CARRIER_HZ, bits)
        self.taken = [(0, 0, 0, 0)]  # the first word after the setup is no sample
        self.times = []

    @property
    def press(self):
        return self.amplitude - self.zero

    @press.setter
    def press(self, codes):
        self.amplitude = self.zero + codes / (1 << self.bits)

    def samples(self, count):
        scan = self.twin.scan
        codes = np.array([code for *_, code in self.taken])
        shape = count, scan.rows, scan.columns, scan.count, 2
        samples, over = scan.adc.samples(codes[: np.prod(shape)].reshape(shape)[..., 1])
        return scan.levels(samples, over)


async def begin(dut, limits=None, load=True, settle=None):
    """``load``: whether to load a calibration and start a tare of the first frames."""
    twin = twin_of(dut, limits)
    given = {f"health_{name}": value for name, value in members.limits(twin.health.limits).items()}
    given |= {
        "scan_settle": settle_of(dut, twin) if settle is None else settle,
        "tare_contact": twin.tare.contact,
        "tare_step": twin.tare.step,
    }
    settings = members.Settings(dut, "cfg", **given, cop_min_load=1)
    inputs = {"pending_i": 0, "busy_i": 0, "sample_ready_i": 1, "in_valid_i": 0, "health_ready_i": 1}
    await bench.start(dut, now_i=0, adc_miso_i=0, adc_busy_i=0, **inputs)

    scan = twin.scan
    bits = scan.part.data_bits
    matrix = (Carrier if number(dut, "Demod") else Matrix)(dut, twin, bits)
    adc_lanes = getattr(scan, "adc_lanes", 1)
    cs_n, sclk, mosi, miso = (
        dut.adc_cs_n_o,
        dut.adc_sclk_o,
        dut.adc_mosi_o,
        Together(dut.adc_miso_i, adc_lanes),
    )
    if scan.part.has_busy:
        convst, busy, reset = dut.adc_convst_o, Together(dut.adc_busy_i), dut.adc_reset_o
        pins = [cs_n, sclk, *[Alike(mosi, cs_n)] * bool(scan.part.setup), miso, convst, busy, reset]
        model = Ad7606c if scan.part.setup else Ad7606
        part = model(*pins, matrix.code, conversion_ns=CONVERSION_NS[scan.part])
        if scan.part is AD7606 and scan.adc.sclk_khz > 14_500:
            part.limits = Timing(t_sclk=1e6 / 17_000)  # VDRIVE of 3.3 V or more
    elif scan.part is MCP3208:
        part = Mcp3208(Alike(cs_n), Alike(sclk), Alike(mosi, cs_n), miso, matrix.code)
    else:
        limits = FAST if scan.part is MAX11131 else None
        part = Max1112x(Alike(cs_n), Alike(sclk), Alike(mosi, cs_n), miso, bits, matrix.code, limits)
    part.front = getattr(matrix, "front", None)

    if not load:
        return twin, matrix, part, settings
    # Gains of the taxels, when the preset ones are in use; then start the tare of the first frames.
    rng = np.random.default_rng(bench.SEED + 1)
    table = twin.calibrate.table
    await bench.clocks(dut, max(table.beats + 4, scan.adc.start_clocks()))
    for word in range(table.beats):
        for lane in range(table.lanes):
            gain = int(rng.integers(1 << 10, 1 << 13))
            table.write(word, OFFSET, gain, slice(lane, lane + 1))
            entry = {
                "word": word,
                "gain": gain,
                "offset": OFFSET,
                "write_lanes": 1 << lane,
                "write_written": 1,
            }
            settings.put(**{f"calibrate_{name}": value for name, value in entry.items()})
            await RisingEdge(dut.clk_i)
    settings.put(calibrate_write_written=0)
    await settings.pulse(dut.clk_i, calibrate_swap=1, tare_average=1, tare_force=1)
    twin.calibrate.swap()
    twin.tare.tare(force=True)
    settings.put(scan_enable=1)
    return twin, matrix, part, settings


def pressing(twin, step):
    """What a round contact adds to the code of each taxel; it moves with ``step``.

    Without a carrier, one earlier frame has the highest codes everywhere and, if the converter is signed, the
    one before it the lowest codes at some taxels.
    """
    i, j = np.indices((twin.scan.rows, twin.scan.columns))
    rows, columns = i.max() + 1, j.max() + 1
    at = (0.3 + 0.1 * step) * (rows - 1), (0.8 - 0.15 * step) * (columns - 1)
    part, plain = twin.scan.part, isinstance(twin.scan, ScanAdc)
    top = 1 << part.data_bits - part.signed

    def contact(height, width):
        return np.rint(height * top * np.exp(-((i - at[0]) ** 2 + (j - at[1]) ** 2) / width**2)).astype(int)

    if step == FRAMES - 3 and plain and part.signed:
        # The largest array is pressed as well, which sets load bits that the other frames leave at 0.
        return np.where((columns * i + j) % 37 == 0, -top, contact(1.06, rows) * (rows > 16))
    if step == FRAMES - 2 and plain:
        return 0 * i + top
    return contact(0.5 if part.signed else 0.25, max(1.0, rows / 6)) * (step >= FRAMES - 2)


async def results(dut, matrix, twin, count, stalls=None, press=None):
    """Results [(clock, x, y, load, pressed)] of ``count`` frames and the clocks of all convert starts.

    ``matrix``: the times of the results are added to it.
    ``press``: added to all codes; None: the last two frames are pressed.
    """
    out, converts, clock, pressed = [], [], 0, None
    conversions = len(twin.scan.scan.places()) * getattr(twin.scan, "count", 1)
    put_ready, put_now = bench.putter(dut.sample_ready_i), bench.putter(dut.now_i)
    settled, edge, convert, valid = ReadOnly(), RisingEdge(dut.clk_i), dut.convert_o, dut.cop_valid_o
    while len(out) < count:
        put_ready(not (stalls and stalls()))
        put_now(bench.time(clock))
        frame, place = divmod(len(converts), conversions)
        if place == 0 and frame != pressed:
            matrix.press = pressing(twin, frame) if press is None else 0 * matrix.press + press
            pressed = frame
        await settled
        if bench.high(convert):
            converts.append(clock)
        if bench.high(valid):
            out.append((clock, *result(dut)))
            matrix.times.append(bench.read(dut.time_o))
        await edge
        clock += 1
    return out, converts


def result(dut):
    """(x, y, load, pressed)"""
    cop = members.of("cop", bench.read(dut.cop_o))
    return *(bench.as_signed(cop[side], 24) for side in "xy"), cop["load"], cop["pressed"]


def check(twin, matrix, out):
    x, y, load, pressed = twin.next(*matrix.samples(len(out)))
    expected = [tuple(map(int, values)) for values in zip(x, y, load, pressed)]
    assert [values[1:] for values in out] == expected
    assert expected[-1][2] > 0 and expected[-1][3] == 1, "nothing pressed"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "row_o", "convert_o", "health_valid_o", "cop_valid_o")


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def codes_at_the_pins_become_the_models_centre_of_pressure_in_its_time(dut):
    twin, matrix, *_ = await begin(dut)
    out, converts = await results(dut, matrix, twin, FRAMES)
    check(twin, matrix, out)
    given = {"conversion_ns": CONVERSION_NS[twin.scan.part]} if twin.scan.part.has_busy else {}
    settle = settle_of(dut, twin)
    steps = twin.latency(settle, **given)
    conversions = len(twin.scan.scan.places()) * getattr(twin.scan, "count", 1)
    starts = converts[::conversions]
    totals = [values[0] - start for values, start in zip(out, starts)]
    us = 1000 / CLK_KHZ
    dut._log.info(
        f"{twin.scan.rows}x{twin.scan.columns}: scan {steps['last_convert'] * us:.2f} us, "
        f"convert and transfer {(steps['last_beat'] - steps['last_convert'] - steps['out']) * us:.2f} us, "
        f"compute {steps['compute'] * us:.2f} us, first convert to result {totals[0] * us:.2f} us"
    )
    assert set(totals) == {steps["total"]}, (set(totals), steps)
    if twin.scan.rows in (16, 64) and not settled(dut):
        assert round(totals[0] * us) == MICROSECONDS[twin.scan.rows, number(dut, "ReadDuring")]
    if settled(dut):
        assert settle == SETTLE_CLOCKS[twin.scan.part]
        # A step is at most the range. Rounding adds half a code on each side.
        share = settled(dut)[2] or 0.5 ** (twin.scan.part.data_bits + 1)
        assert max(matrix.errors) <= share * matrix.mask + 1
    assert sum(terms(twin, settle, **given)[0].values()) == steps["total"]
    assert set(np.diff(starts)) == {steps["frame"]}
    # With a carrier, the time is that of the clock before the burst's first convert start.
    assert matrix.times == [bench.time(start - number(dut, "Demod")) for start in starts[:FRAMES]]
    if twin.scan.columns > 8 and twin.scan.part is not MCP3208:
        assert steps["total"] * us < 1000, "the millisecond is spent"
    others = ("scan_held", "tare_state_pressed")
    assert {name: n for name, n in status(dut).items() if n and name not in others} == {"tare_tared": 1}


@bench.applies(lambda dut: settled(dut) and number(dut, "Rows") <= 4)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_settle_time_that_is_too_short_reads_the_old_row(dut):
    """A place takes 10.36 us, of which 70 ns settle: most of a taxel is its predecessors."""
    twin, matrix, *_ = await begin(dut, settle=SETTLE)
    await results(dut, matrix, twin, FRAMES)
    assert max(matrix.errors) > 0.5 * matrix.mask


@bench.applies(
    lambda dut: number(dut, "Rows") <= 4 and not settled(dut)
)  # larger arrays: the same logic in many more clocks
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def gives_the_same_to_a_consumer_that_stalls_and_starts_over_after_a_reset(dut):
    twin, matrix, part, _ = await begin(dut)
    out, _ = await results(dut, matrix, twin, FRAMES, bench.pauses(0.8, "stalls"))
    check(twin, matrix, out)
    # In the middle of a frame. After the reset the gains are the preset ones, 0, so nothing presses any more.
    await bench.clocks(dut, twin.latency(settle_of(dut, twin))["frame"] // 3)
    part.report = lambda violation: None  # the reset breaks off a transfer
    await bench.reset(dut)
    out, _ = await results(dut, matrix, twin, 2)
    assert [values[1:] for values in out] == [(0, 0, 0, 0)] * 2
    assert status(dut)["cop_damaged"] == 0


@bench.applies(smallest)  # sixteen frames of the other arrays take long
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def a_taxel_over_range_is_told_and_counts_in_nothing(dut):
    """Over-range for sixteen frames, it is reported and masked: no share in the load, and a tare is not
    refused."""
    limits = Limits(low=-65536, high=65535, over_range_enable=True, rail=1, edges=False)
    twin, matrix, _, settings = await begin(dut, limits)
    events = []

    async def listen():
        edge, valid = FallingEdge(dut.clk_i), dut.health_valid_o
        while True:
            await edge
            if bench.high(valid):
                events.append(members.of("health", bench.read(dut.health_o)))

    listener = cocotb.start_soon(listen())
    out, _ = await results(dut, matrix, twin, FRAMES - 2, press=0)
    for bad, press in (((0, 1), 0), ((1, 0), 900)):
        matrix.zero[bad] = (1 << twin.scan.part.data_bits) - 1
        found, _ = await results(dut, matrix, twin, 20, press=press)
        out += found
    assert events == [{"id": 1, "faults": 2}, {"id": 2, "faults": 2}]
    before = len(out)
    await settings.pulse(dut.clk_i, tare_average=1)
    found, _ = await results(dut, matrix, twin, FRAMES, press=0)
    out += found
    listener.cancel()
    x, y, load, pressed = (
        np.concatenate(parts) for parts in zip(*tare_after(twin, matrix.samples(len(out)), before))
    )
    expected = [tuple(map(int, values)) for values in zip(x, y, load, pressed)]
    assert [values[1:] for values in out] == expected
    found = status(dut)
    assert twin.health.railed == found["health_railed"] == 2
    assert (found["tare_tared"], found["tare_refused"]) == (twin.tare.tared, twin.tare.refused) == (2, 0)


@bench.applies(smallest)  # as above
@cocotb.test(timeout_time=200, timeout_unit="ms")
@cocotb.parametrize(low=[0x2AA, 0x555])
async def a_taxel_at_a_limit_is_told(dut, low):
    """Low and high limit, with every bit both 0 and 1: codes at a limit and next to it."""
    high = low ^ 0xFFF
    limits = Limits(low=low, high=high, over_range_enable=False, rail=1, edges=False)
    twin, matrix, *_ = await begin(dut, limits)
    matrix.zero = np.array([[high - 1, high], [low, low + 1]])
    out, _ = await results(dut, matrix, twin, 20, press=0)
    expected = [tuple(map(int, values)) for values in zip(*twin.next(*matrix.samples(len(out))))]
    assert [values[1:] for values in out] == expected
    assert twin.health.railed == status(dut)["health_railed"] == 2


@bench.applies(smallest)  # as above
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(settle=[0x5555, 0xAAAA])
async def the_lines_settle_as_long_as_asked(dut, settle):
    *_, settings = await begin(dut, load=False)
    settings.put(scan_settle=settle, scan_enable=1)
    await bench.clocks(dut, 2)
    while not bench.read(dut.row_o):
        await FallingEdge(dut.clk_i)
    clocks = 0
    while not dut.convert_o.value:
        await FallingEdge(dut.clk_i)
        clocks += 1
    assert clocks == settle
    await bench.clocks(dut, 4000)  # until the converter is idle


@bench.applies(lambda dut: PARTS[number(dut, "Adc")] is AD7606 and not settled(dut), long=True)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def conversions_without_an_answer_are_counted(dut):
    """BUSY stays low at all converters: one lost conversion is counted each time, and frames stay
    complete."""
    twin, _, part, settings = await begin(dut, load=False)
    part.hold_busy(0)
    settings.put(scan_enable=1)
    slot, converts = twin.scan.scan.slot(SETTLE), 0
    for _ in range(twin.scan.adc.start_clocks() + 4 * slot):
        await ReadOnly()
        converts += dut.convert_o.value == 1
        await RisingEdge(dut.clk_i)
    part.hold_busy(None)
    lost = status(dut)["scan_lost"]
    assert converts - 1 <= lost <= converts and lost > 1


@bench.applies(smallest)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def the_smallest_arrays_faults_and_counters(dut):
    """In stages; the scan is off between them, so that the number of converted frames is known."""
    twin, matrix, _, settings = await begin(dut)
    settings.put(scan_enable=0)
    out, tapped, expected, images = [], [], [], []
    even = np.array([[1, 0], [0, 1]])
    counter = lambda name: status(dut)[name]
    quiet = 4 * twin.scan.scan.slot(SETTLE)

    async def run(ready=True, timeout=100):
        """Collect results and forces until no conversion started for ``timeout`` clocks."""
        dut.sample_ready_i.value, still, enabled = int(ready), 0, None
        while still < timeout:
            enable = len(matrix.taken) <= (len(matrix.plan) - 1) * matrix.per_frame
            if enable != enabled:
                settings.put(scan_enable=enable)
                enabled = enable
            await ReadOnly()
            still = 0 if bench.high(dut.convert_o) else still + 1
            if bench.high(dut.cop_valid_o):
                out.append(result(dut))
            if bench.high(dut.sample_valid_o) and ready:
                names = ("data", "mask", "id", "last")
                tapped.append(tuple(bench.read(getattr(dut, f"sample_{name}_o")) for name in names))
            await RisingEdge(dut.clk_i)

    async def stage(*presses, swallowed=False, ready=True):
        """Scan one frame per press."""
        before = matrix.frames
        matrix.plan = [0] * before + [0 * even + press for press in presses]
        await run(ready, quiet)
        assert matrix.frames == len(matrix.plan)
        samples = [part[before:] for part in matrix.samples(matrix.frames)]
        if not swallowed:
            forces, mask = twin.forces(*samples)
            expected.extend(tuple(map(int, found)) for found in zip(*twin.cops(forces)))
            places = [np.resize(marks, mask.size) for marks in ([0, 1, 2, 3], [0, 0, 0, 1])]
            taxels = zip(forces.ravel(), mask.ravel(), *places)
            images.extend(tuple(map(int, taxel)) for taxel in taxels)

    def follow(**limits):
        settings.put(**{f"health_{name}": value for name, value in limits.items()})
        for name, value in limits.items():
            setattr(twin.health.limits, name, value)

    await stage(0, 0, 0, 0, 0)
    follow(jump=20, blink=16, still=1)
    await stage(0, 50 * even, 50 * even, 50 * even, 50 * even, 50, 50, 50)
    assert (out, tapped) == (expected, images)
    assert counter("health_dead") == twin.health.dead == 4
    assert counter("health_blinking") == twin.health.blinking == 4
    follow(jump=200, blink=0, still=0)
    twin.health.clear()
    await settings.pulse(dut.clk_i, health_clear=1, tare_average=1)
    await bench.clocks(dut, 2)
    assert counter("tare_state_taring") == 1
    twin.tare.tare()
    await stage(900, 900, 700)
    assert counter("tare_state_taring") == 0
    assert (out, tapped) == (expected, images)
    assert (counter("health_dead"), counter("health_blinking")) == (0, 0)
    assert (counter("tare_tared"), counter("tare_refused")) == (1, 1) == (twin.tare.tared, twin.tare.refused)

    settings.put(tare_load=1)
    twin.tare.load(True)
    await bench.clocks(dut, 4)
    assert counter("tare_state_loading") == 1
    await stage(0, 0, 0, swallowed=True)
    assert counter("tare_swallowed") == 3
    for word in range(4):
        zero = {"tare_word": word, "tare_zero": 5 * word, "tare_write": 1}
        await settings.pulse(dut.clk_i, tare_write_written=1, **zero)
        twin.tare.write(word, 5 * word)
    settings.put(tare_load=0)
    twin.tare.load(False)
    await bench.clocks(dut, 4)
    await stage(100, 0, ready=False)  # two frames wait for a stalled consumer
    assert len(out) < len(expected) and len(tapped) == len(images) - 8
    await run()
    assert (out, tapped) == (expected, images)

    # Forces are not taken: a frame waits in the stages and one at the gate, later frames are dropped.
    settings.put(scan_period=1)
    given = len(out)
    await stage(*[0] * 8, ready=False)
    dut.pending_i.value = 1  # new settings wait as well
    await bench.clocks(dut, quiet)
    assert bench.read(dut.commit_o) == 0
    await run()
    commits = 0
    for _ in range(6):  # closed, commit, open: a commit every third clock as long as settings are pending
        await ReadOnly()
        commits += bench.read(dut.commit_o)
        await RisingEdge(dut.clk_i)
    assert commits == 2
    dut.pending_i.value = 0
    await stage(0)
    assert counter("scan_dropped") > 2 and counter("scan_overrun") > 100
    assert len(out) - given + counter("scan_dropped") == 9
    assert [counter(name) for name in ("scan_held", "scan_lost", "cop_damaged")] == [0] * 3
    await bench.reset(dut)
    await bench.clocks(dut, 1)
    assert not any(status(dut).values())


def tare_after(twin, samples, count):
    """The model's results if a tare is requested while frame ``count`` is scanned."""
    yield twin.next(*(a[:count] for a in samples))
    twin.tare.tare()
    yield twin.next(*(a[count:] for a in samples))


LONG = dict.fromkeys(("4x8", "64x64 settled, eight MAX11125"), pytest.mark.long)


@pytest.mark.parametrize("case", [pytest.param(name, marks=LONG.get(name, ())) for name in CASES])
def test_array_pins(case):
    size = {"ClkKhz": CLK_KHZ, "TareLog2": TARE_LOG2, "Health": 1, "Tare": 1, "Tap": 0} | CASES[case]
    bench.run("sensor", "sensor_array", size, module="test_array_pins")
