"""A scanned array at pin level: row lines, column multiplexer, converters that check their timing, then
health, tare, calibration and centre of pressure, all stages at once.

The cases: a capacitive array on its carrier behind a MAX11125, demodulated; 4×8 behind an MCP3208 and 16×16
behind an AD7606; 3×16 behind eight MCP3208 and 64×64 behind eight AD7606, whose pins move together (one
model, so all eight give the same codes). Gains differ from taxel to taxel, a tare of the first frames finds
the zeros, then a press moves. Every result equals the twin's for the very codes at the pins, bit for bit;
every latency is the twin's, which is what `meissner budget` prints, and is below 1 ms where the array's
converters allow it. On the smallest array also the forces at the tap, faults and counters.
"""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge
from meissner.twins.cop.array import Array
from meissner.twins.cop.cop_array import CopArray

import bench
from cop import array_by_hand
from meissner.budget.array import terms
from meissner.twins.frontend.adc_spi import AD7606, MAX11125, MCP3208, PARTS
from meissner.twins.frontend.health import Limits
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.frontend.scan_demod import ScanDemod
from parts.ad7606 import Ad7606
from parts.carrier import CarrierMatrix
from parts.max1112x import Max1112x
from parts.mcp3208 import Mcp3208
from parts.timing import Line

CLK_KHZ = 100_000  # the bench's clock of 10 ns
CARRIER_HZ = 1e8 / 256
CONVERSION_NS = 3995  # of every AD7606 here, so that BUSY falls between two clock edges
SETTLE = 7
TARE_LOG2 = 1
MICROSECONDS = {16: 331, 64: 662}  # stated in the README for the two arrays behind AD7606
OFFSET = 777  # a calibration's offset, which must have no effect after a tare
FRAMES = 5  # two for the tare, one until the tare is in effect, then two pressed

CASES = {
    "demod": {
        **{"Rows": 2, "Columns": 3, "Demod": 1, "Part": MAX11125.number, "Channels": 1, "SamplePeriod": 320},
        **{"Periods": 2, "Skip": 2, "Shift": 0},
    },
    "2x2": {"Rows": 2, "Columns": 2, "Part": MCP3208.number, "Channels": 2, "SclkKhz": 2000, "Tap": 1},
    "4x8": {"Rows": 4, "Columns": 8, "Part": MCP3208.number, "Channels": 8, "SclkKhz": 2000},
    "3x16": {
        **{"Rows": 3, "Columns": 16, "Part": MCP3208.number, "Channels": 2, "SclkKhz": 2000},
        "Converters": 8,
    },
    "16x16": {"Rows": 16, "Columns": 16, "Part": AD7606.number, "Channels": 8, "AdcLanes": 2},
    "64x64": {
        "Rows": 64,
        "Columns": 64,
        "Part": AD7606.number,
        "Channels": 8,
        "Converters": 8,
        "AdcLanes": 2,
    },
}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def smallest(dut):
    """Whether this is the 2×2 array, whose frames take the fewest clocks."""
    return number(dut, "Rows") * number(dut, "Columns") == 4


def twin_of(dut, limits=None):
    rows, columns, clk_khz = number(dut, "Rows"), number(dut, "Columns"), number(dut, "ClkKhz")
    part = PARTS[number(dut, "Part")]
    if number(dut, "Demod"):
        names = ("Form", "SamplesPerPeriod", "SamplePeriod", "Periods", "Skip", "Shift")
        form, *rest = (number(dut, name) for name in names)
        scan = ScanDemod(rows, columns, number(dut, "Converters"), part, clk_khz, None, 17, form, *rest)
    else:
        lanes, channels, adc_lanes = (number(dut, name) for name in ("Converters", "Channels", "AdcLanes"))
        scan = ScanAdc(rows, columns, lanes, part, channels, adc_lanes, clk_khz, number(dut, "SclkKhz"))
    tare = {"tare_log2": TARE_LOG2, "contact": 200, "step": 1}
    return Array(
        scan, limits or Limits(), tare, number(dut, "BitsPerClock"), gain_shift=number(dut, "GainShift")
    )


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
    """Pins of several converters that the block must drive alike, seen as one."""

    def __init__(self, port):
        super().__init__(port, 0, {})

    @property
    def value(self):
        levels = bench.read(self.port)
        assert levels in (0, (1 << len(self.port)) - 1), f"{self.port._name} is {levels:b}"
        return levels & 1


class Matrix:
    """Codes of the taxels; ``taken`` [(time in ns, row, group, channel, code)]; ``press``: added to the
    codes; ``plan``: instead of ``press``, a list with one value per frame."""

    def __init__(self, dut, twin, bits):
        self.dut, self.twin = dut, twin
        rng = np.random.default_rng(bench.SEED)
        shape = twin.scan.rows, twin.scan.columns
        self.zero = rng.integers(1 << bits - 6, 1 << bits - 5, shape)
        self.press = np.zeros(shape, dtype=np.int64)
        self.taken, self.times, self.plan = [], [], []

    def code(self, channel, time_ns):
        rows = bench.read(self.dut.row_o)
        assert rows and rows & rows - 1 == 0, f"rows {rows:b} while converting"
        row, group = rows.bit_length() - 1, bench.read(self.dut.group_o)
        column = self.twin.scan.scan.column(group, channel, 0)
        if self.plan:
            self.press = self.plan[min(self.frames, len(self.plan) - 1)]
        part = self.twin.scan.part
        most = (1 << part.data_bits - part.signed) - 1
        code = min(int(self.zero[row, column] + self.press[row, column]), most) & (1 << part.data_bits) - 1
        self.taken.append((time_ns, row, group, channel, code))
        return code

    @property
    def per_frame(self):
        scan = self.twin.scan
        return scan.rows * scan.scan.groups * scan.channels

    @property
    def frames(self):
        """Number of frames of which all codes were taken."""
        return len(self.taken) // self.per_frame

    def samples(self, count):
        """Signed samples [count, rows, columns] and over-range flags of the codes taken."""
        scan = self.twin.scan
        rows, columns, lanes, channels = scan.rows, scan.columns, scan.lanes, scan.channels
        codes = np.array([code for *_, code in self.taken])[: count * self.per_frame]
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


async def begin(dut, limits=None, load=True):
    """``load``: whether to load a calibration and start a tare of the first frames."""
    twin = twin_of(dut, limits)
    limits = twin.health.limits
    settings = {name: int(getattr(limits, name)) for name in limits.__dataclass_fields__}
    settings |= {name: settings[name] & (1 << number(dut, "SampleBits")) - 1 for name in ("low", "high")}
    settings |= {
        "settle": SETTLE,
        "period": 0,
        "interleave": 0,
    }
    settings |= {"enable": 0, "clear": 0, "report": 0, "contact": twin.tare.contact, "step": twin.tare.step}
    settings |= {"tare": 0, "force": 0, "load": 0, "zero_write": 0, "zero_word": 0, "zero": 0}
    settings |= {"write": 0, "write_row": 0, "word": 0, "offset": OFFSET, "gain": 0, "swap": 0, "min_load": 1}
    inputs = {f"cfg_{name}_i": value for name, value in settings.items()}
    inputs |= {"cfg_pending_i": 0, "busy_i": 0, "tap_ready_i": 1, "in_valid_i": 0}
    await bench.start(dut, now_i=0, event_ready_i=1, adc_miso_i=0, adc_busy_i=0, **inputs)

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
    if scan.part is AD7606:
        convst, busy, reset = dut.adc_convst_o, Together(dut.adc_busy_i), dut.adc_reset_o
        part = Ad7606(cs_n, sclk, miso, convst, busy, reset, matrix.code, conversion_ns=CONVERSION_NS)
    elif scan.part is MCP3208:
        part = Mcp3208(Alike(cs_n), Alike(sclk), Alike(mosi), miso, matrix.code)
    else:
        part = Max1112x(cs_n, sclk, mosi, miso, bits, matrix.code)

    if not load:
        return twin, matrix, part
    # Gains of the taxels, then start the tare of the first frames.
    rng = np.random.default_rng(bench.SEED + 1)
    lanes = twin.cop.calibrate.table.lanes
    for word in range(scan.rows * -(-scan.columns // lanes)):
        for lane in range(lanes):
            gain = int(rng.integers(1 << 10, 1 << 13))
            twin.cop.calibrate.table.write(word, OFFSET, gain, slice(lane, lane + 1))
            dut.cfg_write_i.value, dut.cfg_word_i.value, dut.cfg_gain_i.value = 1 << lane, word, gain
            await RisingEdge(dut.clk_i)
    dut.cfg_write_i.value = 0
    for name in ("swap", "tare", "force"):
        getattr(dut, f"cfg_{name}_i").value = 1
    await RisingEdge(dut.clk_i)
    for name in ("swap", "tare", "force"):
        getattr(dut, f"cfg_{name}_i").value = 0
    twin.cop.calibrate.swap()
    twin.tare.tare(force=True)
    dut.cfg_enable_i.value = 1
    return twin, matrix, part


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
    put_ready, put_now = bench.putter(dut.out_ready_i), bench.putter(dut.now_i)
    settled, edge, convert, valid = ReadOnly(), RisingEdge(dut.clk_i), dut.convert_o, dut.out_valid_o
    while len(out) < count:
        ready = not (stalls and stalls())
        put_ready(ready)
        put_now(bench.time(clock))
        frame, place = divmod(len(converts), conversions)
        if place == 0 and frame != pressed:
            matrix.press = pressing(twin, frame) if press is None else 0 * matrix.press + press
            pressed = frame
        await settled
        if bench.high(convert):
            converts.append(clock)
        if ready and bench.high(valid):
            x, y = (bench.as_signed(bench.read(port), len(port)) for port in (dut.out_x_o, dut.out_y_o))
            out.append((clock, x, y, bench.read(dut.out_load_o), bench.read(dut.out_pressed_o)))
            matrix.times.append(bench.read(dut.time_o))
        await edge
        clock += 1
    return out, converts


def check(twin, matrix, out):
    x, y, load, pressed = twin.next(*matrix.samples(len(out)))
    expected = [tuple(map(int, values)) for values in zip(x, y, load, pressed)]
    assert [values[1:] for values in out] == expected
    assert expected[-1][2] > 0 and expected[-1][3] == 1, "nothing pressed"


@bench.applies(bench.whole)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def every_bit_of_the_counts_of_faults(dut):
    """The outputs are the counts of msn_health, up to a count of all taxels."""
    await begin(dut, load=False)
    health = dut.u_condition.gen_health.u_health
    taxels = number(dut, "Rows") * number(dut, "Columns")
    for values in (
        (taxels, 0, 1),
        (0, 2 * taxels - 1, taxels),
        (taxels - 1, taxels, 0),
        (0, 0, 2 * taxels - 1),
    ):
        for kind, value in zip(("dead", "railed", "blinking"), values):
            port = getattr(dut, f"{kind}_o")
            assert len(port) == taxels.bit_length()
            getattr(health, f"{kind}_o").value = value & (1 << len(port)) - 1
        await FallingEdge(dut.clk_i)
        for kind, value in zip(("dead", "railed", "blinking"), values):
            port = getattr(dut, f"{kind}_o")
            assert bench.read(port) == value & (1 << len(port)) - 1
        await RisingEdge(dut.clk_i)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    counters = [
        "dropped_o",
        "overrun_o",
        "held_o",
        "lost_o",
        "swallowed_o",
        "damaged_o",
    ]
    await bench.turn_over(dut, *counters, wraps=False)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "row_o", "convert_o", "event_valid_o", "out_valid_o")


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def codes_at_the_pins_become_the_models_centre_of_pressure_in_its_time(dut):
    twin, matrix, _ = await begin(dut)
    out, converts = await results(dut, matrix, twin, FRAMES)
    check(twin, matrix, out)
    assert (bench.read(dut.tared_o), bench.read(dut.refused_o)) == (1, 0)
    given = {"conversion_ns": CONVERSION_NS} if twin.scan.part is AD7606 else {}
    steps = twin.latency(SETTLE, **given)
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
    if twin.scan.part is AD7606:
        assert round(totals[0] * us) == MICROSECONDS[twin.scan.rows]
    assert sum(terms(twin, SETTLE, **given)[0].values()) == steps["total"]
    assert set(np.diff(starts)) == {steps["frame"]}
    # With a carrier, the time is that of the clock before the burst's first convert start.
    assert matrix.times == [bench.time(start - number(dut, "Demod")) for start in starts[:FRAMES]]
    if twin.scan.part is AD7606:
        assert steps["total"] * us < 1000, "the millisecond is spent"
    for name in ("dropped", "overrun", "lost", "damaged", "dead", "railed", "blinking"):
        assert bench.read(getattr(dut, f"{name}_o")) == 0, name


@bench.applies(lambda dut: number(dut, "Rows") <= 4)  # larger arrays: the same logic in many more clocks
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def gives_the_same_to_a_consumer_that_stalls_and_starts_over_after_a_reset(dut):
    twin, matrix, part = await begin(dut)
    out, _ = await results(dut, matrix, twin, FRAMES, bench.pauses(0.8, "stalls"))
    check(twin, matrix, out)
    # In the middle of a frame. After the reset the calibration is empty, so nothing presses any more.
    await bench.clocks(dut, twin.latency(SETTLE)["frame"] // 3)
    part.report = lambda violation: None  # the reset breaks off a transfer
    await bench.reset(dut)
    out, _ = await results(dut, matrix, twin, 2)
    assert [values[1:] for values in out] == [(0, 0, 0, 0)] * 2
    assert bench.read(dut.damaged_o) == 0


@bench.applies(smallest)  # sixteen frames of the other arrays take long
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def a_taxel_over_range_is_told_and_counts_in_nothing(dut):
    """Over-range for sixteen frames, it is reported and masked: no share in the load, and a tare is not
    refused."""
    limits = Limits(low=-65536, high=65535, over_range_enable=True, rail=1, edges=False)
    twin, matrix, _ = await begin(dut, limits)
    events = []

    async def listen():
        edge, valid = FallingEdge(dut.clk_i), dut.event_valid_o
        while True:
            await edge
            if bench.high(valid):
                kinds = (dut.event_id_o, dut.event_dead_o, dut.event_railed_o, dut.event_blinking_o)
                events.append(tuple(bench.read(kind) for kind in kinds))

    listener = cocotb.start_soon(listen())
    out, _ = await results(dut, matrix, twin, FRAMES - 2, press=0)
    for bad, press in (((0, 1), 0), ((1, 0), 900)):
        matrix.zero[bad] = (1 << twin.scan.part.data_bits) - 1
        found, _ = await results(dut, matrix, twin, 20, press=press)
        out += found
    assert events == [(1, 0, 1, 0), (2, 0, 1, 0)]
    before = len(out)
    for name in ("cfg_force_i", "cfg_tare_i"):
        getattr(dut, name).value = int(name == "cfg_tare_i")
    await RisingEdge(dut.clk_i)
    dut.cfg_tare_i.value = 0
    found, _ = await results(dut, matrix, twin, FRAMES, press=0)
    out += found
    listener.cancel()
    x, y, load, pressed = (
        np.concatenate(parts) for parts in zip(*tare_after(twin, matrix.samples(len(out)), before))
    )
    expected = [tuple(map(int, values)) for values in zip(x, y, load, pressed)]
    assert [values[1:] for values in out] == expected
    assert twin.health.railed == bench.read(dut.railed_o) == 2
    assert (
        (bench.read(dut.tared_o), bench.read(dut.refused_o)) == (twin.tare.tared, twin.tare.refused) == (2, 0)
    )


@bench.applies(smallest)  # as above
@cocotb.test(timeout_time=200, timeout_unit="ms")
@cocotb.parametrize(low=[0x2AA, 0x555])
async def a_taxel_at_a_limit_is_told(dut, low):
    """Low and high limit, with every bit both 0 and 1: codes at a limit and next to it."""
    high = low ^ 0xFFF
    limits = Limits(low=low, high=high, over_range_enable=False, rail=1, edges=False)
    twin, matrix, _ = await begin(dut, limits)
    matrix.zero = np.array([[high - 1, high], [low, low + 1]])
    out, _ = await results(dut, matrix, twin, 20, press=0)
    expected = [tuple(map(int, values)) for values in zip(*twin.next(*matrix.samples(len(out))))]
    assert [values[1:] for values in out] == expected
    assert twin.health.railed == bench.read(dut.railed_o) == 2


@bench.applies(smallest)  # as above
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(settle=[0x5555, 0xAAAA])
async def the_lines_settle_as_long_as_asked(dut, settle):
    await begin(dut, load=False)
    dut.cfg_settle_i.value, dut.cfg_enable_i.value = settle, 1
    await bench.clocks(dut, 2)
    while not bench.read(dut.row_o):
        await FallingEdge(dut.clk_i)
    clocks = 0
    while not dut.convert_o.value:
        await FallingEdge(dut.clk_i)
        clocks += 1
    assert clocks == settle
    await bench.clocks(dut, 4000)  # until the converter is idle


@bench.applies(lambda dut: PARTS[number(dut, "Part")] is AD7606, long=True)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def conversions_without_an_answer_are_counted(dut):
    """BUSY stays low at all converters: one lost conversion is counted each time, and frames stay
    complete."""
    twin, _, part = await begin(dut, load=False)
    part.hold_busy(0)
    dut.cfg_enable_i.value = 1
    slot, converts = twin.scan.scan.slot(SETTLE), 0
    for _ in range(twin.scan.adc.start_clocks() + 4 * slot):
        await ReadOnly()
        converts += dut.convert_o.value == 1
        await RisingEdge(dut.clk_i)
    part.hold_busy(None)
    lost = bench.read(dut.lost_o)
    assert converts - 1 <= lost <= converts and lost > 1


@bench.applies(smallest)
@cocotb.test(timeout_time=200, timeout_unit="ms")
async def the_smallest_arrays_faults_and_counters(dut):
    """In stages; the scan is off between them, so that the number of converted frames is known."""
    twin, matrix, _ = await begin(dut)
    dut.cfg_enable_i.value = 0
    out, tapped, expected, images = [], [], [], []
    even = np.array([[1, 0], [0, 1]])
    counter = lambda name: bench.read(getattr(dut, f"{name}_o"))
    quiet = 4 * twin.scan.scan.slot(SETTLE)

    async def pulse(*names):
        for level in (1, 0):
            for name in names:
                getattr(dut, f"cfg_{name}_i").value = level
            await RisingEdge(dut.clk_i)

    async def run(ready=True, tap_ready=True, timeout=100):
        """Collect results and tap beats until no conversion started for ``timeout`` clocks."""
        dut.out_ready_i.value, dut.tap_ready_i.value, still = int(ready), int(tap_ready), 0
        put_enable = bench.putter(dut.cfg_enable_i)
        while still < timeout:
            put_enable(len(matrix.taken) <= (len(matrix.plan) - 1) * matrix.per_frame)
            await ReadOnly()
            still = 0 if bench.high(dut.convert_o) else still + 1
            if bench.high(dut.out_valid_o) and ready:
                x, y = (bench.as_signed(bench.read(port), len(port)) for port in (dut.out_x_o, dut.out_y_o))
                out.append((x, y, counter("out_load"), counter("out_pressed")))
            if bench.high(dut.tap_valid_o) and tap_ready:
                marks = (counter("tap_row_last"), counter("tap_last"))
                tapped.append((counter("tap_data"), counter("tap_mask"), *marks))
            await RisingEdge(dut.clk_i)

    async def stage(*presses, swallowed=False, **ready):
        """Scan one frame per press."""
        before = matrix.frames
        matrix.plan = [0] * before + [0 * even + press for press in presses]
        await run(timeout=quiet, **ready)
        assert matrix.frames == len(matrix.plan)
        samples = [part[before:] for part in matrix.samples(matrix.frames)]
        if not swallowed:
            forces, mask = twin.forces(*samples)
            expected.extend(tuple(map(int, found)) for found in zip(*twin.cop.of_forces(forces)))
            ends = [np.resize(marks, mask.size) for marks in ([0, 1], [0, 0, 0, 1])]
            beats = zip(forces.ravel(), mask.ravel(), *ends)
            images.extend(tuple(map(int, beat)) for beat in beats)

    def follow(**limits):
        for name, value in limits.items():
            getattr(dut, f"cfg_{name}_i").value = value
            setattr(twin.health.limits, name, value)

    await stage(0, 0, 0, 0, 0)
    follow(jump=20, blink=16, still=1)
    await stage(0, 50 * even, 50 * even, 50 * even, 50 * even, 50, 50, 50)
    assert (out, tapped) == (expected, images)
    assert counter("dead") == twin.health.dead == 4
    assert counter("blinking") == twin.health.blinking == 4
    follow(jump=200, blink=0, still=0)
    twin.health.clear()
    dut.cfg_force_i.value = 0
    await pulse("clear", "tare")
    await bench.clocks(dut, 2)
    assert counter("taring") == 1
    twin.tare.tare()
    await stage(900, 900, 700)
    assert counter("taring") == 0
    assert (out, tapped) == (expected, images)
    assert (counter("dead"), counter("blinking")) == (0, 0)
    assert (counter("tared"), counter("refused")) == (1, 1) == (twin.tare.tared, twin.tare.refused)

    dut.cfg_load_i.value = 1
    twin.tare.load(True)
    await bench.clocks(dut, 4)
    assert counter("cfg_loading") == 1
    await stage(0, 0, 0, swallowed=True)
    assert counter("swallowed") == 3
    for word in range(4):
        dut.cfg_zero_word_i.value, dut.cfg_zero_i.value = word, 5 * word
        await pulse("zero_write")
        twin.tare.write(word, 5 * word)
    dut.cfg_load_i.value = 0
    twin.tare.load(False)
    await bench.clocks(dut, 4)
    await stage(100, 0, tap_ready=False)  # two frames wait for a stalled tap
    assert len(out) < len(expected) and len(tapped) == len(images) - 8
    await run()
    assert (out, tapped) == (expected, images)

    # Results are not taken: two results and a frame wait, later frames are dropped.
    dut.cfg_period_i.value = 1
    given = len(out)
    await stage(*[0] * 8, ready=False)
    dut.cfg_pending_i.value = 1  # new settings wait for the results as well
    await bench.clocks(dut, quiet)
    assert counter("commit") == 0
    await run()
    commits = 0
    for _ in range(6):  # closed, commit, open: a commit every third clock as long as settings are pending
        await ReadOnly()
        commits += counter("commit")
        await RisingEdge(dut.clk_i)
    assert commits == 2
    dut.cfg_pending_i.value = 0
    await stage(0)
    assert counter("dropped") > 2 and counter("overrun") > 100
    assert len(out) - given + counter("dropped") == 9
    assert [counter(name) for name in ("held", "lost", "damaged")] == [0] * 3
    await bench.reset(dut)
    await bench.clocks(dut, 1)
    for name in ("dropped", "overrun", "swallowed", "tared", "refused"):
        assert counter(name) == 0


def tare_after(twin, samples, count):
    """The model's results if a tare is requested while frame ``count`` is scanned."""
    yield twin.next(*(a[:count] for a in samples))
    twin.tare.tare()
    yield twin.next(*(a[count:] for a in samples))


EVIDENCE = {
    "equivalence": {"size": {"Columns": 2}, "defined": True, "boxes": True, "open": ["reset"]},
    "mutants": {"sets": [1], "limit": 60, "unsolved": True},
    "faults": {
        "size": {"Rows": 2, "Part": 1},
        "program": {"Tap": 1, "ClkKhz": 16000},
        "settle": 4,
        # The recording's gains; no tare, so that the converter's codes are the press; no failing taxel.
        "driver": {
            "free": 40000,
            # Counters up to a scan's next row and frame.
            "late": "left_q count_q",
            "part": 1,
            "lead": 16,
            "set": "cfg_tare_i:0",
            "quiet": "event_",
            # What a scan copied when it was enabled, until it is disabled.
            "kept": "settle_q period_q",
        },
        "kept_inside": {"u_calibrate": "calibrate_taxels", "u_tare": "tare", "u_health": "health"},
    },
}


def test_model_without_health_and_tare_is_the_calibration_alone():
    rng = np.random.default_rng(bench.SEED)
    scan = ScanAdc(3, 5, 2, MCP3208, 3, 1, CLK_KHZ, 2000)
    bare, alone = Array(scan), CopArray(3, 5, 2)
    for word in range(9):
        offset, gain = rng.integers(-99, 99), rng.integers(1, 9999)
        for table in (bare.cop.calibrate.table, alone.calibrate.table):
            table.write(word, offset, gain)
    samples = rng.integers(0, 4096, (4, 3, 5))
    found, expected = bare.next(samples), alone.of_forces(alone.calibrate.next(samples))
    assert [np.asarray(a).tolist() for a in found] == [np.asarray(a).tolist() for a in expected]
    assert not bare.forces(samples)[1].any()


LONG = {"4x8": pytest.mark.long}


@pytest.mark.parametrize("case", [pytest.param(name, marks=LONG.get(name, ())) for name in CASES])
def test_array(case):
    bench.run("cop", "array", {"ClkKhz": CLK_KHZ, "TareLog2": TARE_LOG2} | CASES[case], inside=["msn_health"])


def test_array_of_a_stream():
    bench.run("cop", "array", array_by_hand.BUILD, module="array_by_hand")
