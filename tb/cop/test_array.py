"""A scanned array at pin level: row lines, column multiplexer, converters that check their timing, then
health, tare, calibration and centre of pressure, all stages at once.

Four cases: a capacitive array on its carrier behind a MAX11125, demodulated; 4×8 behind an MCP3208 and 16×16
behind an AD7606; 64×64 behind eight AD7606, whose pins move together (one model, so all eight give the same
codes). Gains differ from taxel to taxel, zeros are found by a tare of the first frames, then something
presses and moves. Every result is, bit for bit, the twin's of the very codes at the pins; every latency is
the twin's, which is what `meissner budget` prints; each stands below 1 ms where the array's converters allow
it.
"""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
from meissner.budget.array import terms
from meissner.cop.array import Array
from meissner.frontend.adc_spi import AD7606, MAX11125, MCP3208, PARTS
from meissner.frontend.health import Limits
from meissner.frontend.scan_adc import ScanAdc
from meissner.frontend.scan_demod import ScanDemod
from parts.ad7606 import Ad7606
from parts.carrier import CarrierMatrix
from parts.max1112x import Max1112x
from parts.mcp3208 import Mcp3208

CLK_KHZ = 100_000  # the bench's 10 ns
CARRIER_HZ = 1e8 / 256
CONVERSION_NS = 3995  # of every AD7606 here: BUSY falls between two clock edges
SETTLE = 7
TARE_LOG2 = 1
OFFSET = 777  # of the calibration, which has none behind a tare
FRAMES = 5  # two for the tare and one in which it is taken up, then two pressed

CASES = {
    "demod": {
        **{"Rows": 2, "Columns": 3, "Demod": 1, "Part": MAX11125.number, "Channels": 1, "SamplePeriod": 320},
        **{"Periods": 2, "Skip": 2, "Shift": 0},
    },
    "2x2": {"Rows": 2, "Columns": 2, "Part": MCP3208.number, "Channels": 2, "SclkKhz": 2000},
    "4x8": {"Rows": 4, "Columns": 8, "Part": MCP3208.number, "Channels": 8, "SclkKhz": 2000},
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
    """Pins of several converters that are driven alike by one model: ``lanes`` levels for each of them."""

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


class Matrix:
    """Codes of the taxels; ``taken`` [(time in ns, row, group, channel, code)]; ``press``: what is added."""

    def __init__(self, dut, twin, bits):
        self.dut, self.twin = dut, twin
        rng = np.random.default_rng(bench.SEED)
        shape = twin.scan.rows, twin.scan.columns
        self.zero = rng.integers(1 << bits - 6, 1 << bits - 5, shape)
        self.press = np.zeros(shape, dtype=np.int64)
        self.taken, self.times = [], []

    def code(self, channel, time_ns):
        rows = bench.read(self.dut.row_o)
        assert rows and rows & rows - 1 == 0, f"rows {rows:b} while converting"
        row, group = rows.bit_length() - 1, bench.read(self.dut.group_o)
        column = self.twin.scan.scan.column(group, channel, 0)
        top = (1 << self.twin.scan.part.data_bits) - 1
        code = min(int(self.zero[row, column] + self.press[row, column]), top)
        self.taken.append((time_ns, row, group, channel, code))
        return code

    def samples(self, count):
        """Signed samples [count, rows, columns] and over-range of what was taken."""
        scan = self.twin.scan
        rows, columns, lanes, channels = scan.rows, scan.columns, scan.lanes, scan.channels
        codes = np.array([code for *_, code in self.taken])
        frame = rows * scan.scan.groups * channels
        codes = codes[: count * frame].reshape(count, rows, scan.scan.groups * channels)
        codes = np.repeat(codes, lanes, axis=2)[:, :, :columns]  # column = place * lanes + lane
        return scan.adc.samples(codes)


class Carrier(CarrierMatrix):
    """The same of a carrier's amplitudes."""

    def __init__(self, dut, twin, bits):
        rng = np.random.default_rng(bench.SEED)
        self.twin = twin
        self.zero = rng.uniform(0.1, 0.2, (twin.scan.rows, twin.scan.columns))
        super().__init__(dut, self.zero, CARRIER_HZ, bits)
        self.taken = [(0, 0, 0, 0)]  # the first word after the setup samples nothing
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


async def begin(dut, limits=None):
    twin = twin_of(dut, limits)
    limits = twin.health.limits
    settings = {name: int(getattr(limits, name)) for name in limits.__dataclass_fields__}
    settings |= {name: settings[name] & (1 << number(dut, "SampleBits")) - 1 for name in ("low", "high")}
    settings |= {
        "settle": SETTLE,
        "period": 0,
        "interleave": 0,
        "slip_period": 0,
        "slip_row": 0,
        "slip_group": 0,
    }
    settings |= {"enable": 0, "clear": 0, "report": 0, "contact": twin.tare.contact, "step": twin.tare.step}
    settings |= {"tare": 0, "force": 0, "load": 0, "zero_write": 0, "zero_word": 0, "zero": 0}
    settings |= {"write": 0, "write_row": 0, "word": 0, "offset": OFFSET, "gain": 0, "swap": 0, "min_load": 1}
    inputs = {f"cfg_{name}_i": value for name, value in settings.items()}
    inputs |= {"cfg_pending_i": 0, "stalled_i": 0, "tap_ready_i": 1, "in_valid_i": 0}
    await bench.start(dut, now_i=0, slip_ready_i=1, event_ready_i=1, adc_miso_i=0, adc_busy_i=0, **inputs)

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
        part = Mcp3208(cs_n, sclk, mosi, miso, matrix.code)
    else:
        part = Max1112x(cs_n, sclk, mosi, miso, bits, matrix.code)

    # Gains of the taxels, then the tare of the first frames.
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
    """What a round contact adds to the codes of each taxel; it moves with ``step``."""
    i, j = np.indices((twin.scan.rows, twin.scan.columns))
    rows, columns = i.max() + 1, j.max() + 1
    at = (0.3 + 0.1 * step) * (rows - 1), (0.8 - 0.15 * step) * (columns - 1)
    width = max(1.0, rows / 6)
    bits = twin.scan.part.data_bits
    return np.rint(2 ** (bits - 2) * np.exp(-((i - at[0]) ** 2 + (j - at[1]) ** 2) / width**2)).astype(
        np.int64
    )


async def results(dut, matrix, twin, count, stalls=None, press=None):
    """Results [(clock, x, y, load, pressed)] of ``count`` frames and the clocks of all convert starts.

    ``matrix``: gets the results' times.
    ``press``: added to all codes; None: the last two frames are pressed.
    """
    out, converts, clock = [], [], 0
    conversions = len(twin.scan.scan.places()) * getattr(twin.scan, "count", 1)
    while len(out) < count:
        ready = not (stalls and stalls())
        dut.out_ready_i.value, dut.now_i.value = int(ready), bench.time(clock)
        if len(converts) % conversions == 0:
            frame = len(converts) // conversions
            matrix.press = (
                pressing(twin, frame) * (frame >= FRAMES - 2) if press is None else 0 * matrix.press + press
            )
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(clock)
        if ready and dut.out_valid_o.value == 1:
            x, y = (bench.as_signed(bench.read(port), len(port)) for port in (dut.out_x_o, dut.out_y_o))
            out.append((clock, x, y, bench.read(dut.out_load_o), bench.read(dut.out_pressed_o)))
            matrix.times.append(bench.read(dut.time_o))
        await RisingEdge(dut.clk_i)
        clock += 1
    return out, converts


def check(twin, matrix, out):
    x, y, load, pressed = twin.next(*matrix.samples(len(out)))
    expected = [tuple(map(int, values)) for values in zip(x, y, load, pressed)]
    assert [values[1:] for values in out] == expected
    assert expected[-1][2] > 0 and expected[-1][3] == 1, "nothing pressed"


@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    counters = [
        "dropped_o",
        "overrun_o",
        "held_o",
        "lost_o",
        "slip_dropped_o",
        "slip_overrun_o",
        "swallowed_o",
        "damaged_o",
    ]
    await bench.turn_over(dut, *counters, wraps=False)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "row_o", "convert_o", "slip_valid_o", "event_valid_o", "out_valid_o")


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
    assert sum(terms(twin, SETTLE, **given)[0].values()) == steps["total"]
    assert set(np.diff(starts)) == {steps["frame"]}
    # Of a burst it is the clock before its first convert start.
    assert matrix.times == [bench.time(start - number(dut, "Demod")) for start in starts[:FRAMES]]
    if twin.scan.part is AD7606:
        assert steps["total"] * us < 1000, "the millisecond is spent"
    for name in ("dropped", "overrun", "lost", "damaged", "dead", "railed", "blinking"):
        assert bench.read(getattr(dut, f"{name}_o")) == 0, name


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def gives_the_same_to_a_consumer_that_stalls_and_starts_over_after_a_reset(dut):
    twin, matrix, part = await begin(dut)
    if twin.scan.rows > 4:
        return  # the same logic in many more clocks
    out, _ = await results(dut, matrix, twin, FRAMES, bench.pauses(0.8))
    check(twin, matrix, out)
    # In the middle of a frame: calibration counts as empty, so nothing presses any more.
    await bench.clocks(dut, twin.latency(SETTLE)["frame"] // 3)
    part.report = lambda violation: None  # a transfer is broken off
    await bench.reset(dut)
    out, _ = await results(dut, matrix, twin, 2)
    assert [values[1:] for values in out] == [(0, 0, 0, 0)] * 2
    assert bench.read(dut.damaged_o) == 0


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def a_taxel_over_range_is_told_and_counts_in_nothing(dut):
    """Over-range for sixteen frames, it is masked: out of the load, and it does not refuse a tare."""
    if number(dut, "Rows") * number(dut, "Columns") != 4:
        return  # sixteen frames of the others take long
    limits = Limits(low=-65536, high=65535, user=True, rail=1, edges=False)
    twin, matrix, _ = await begin(dut, limits)
    events = []

    async def listen():
        while True:
            await FallingEdge(dut.clk_i)
            if dut.event_valid_o.value == 1:
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


def tare_after(twin, samples, count):
    """The model's results with a tare asked for while frame ``count`` is scanned."""
    yield twin.next(*(a[:count] for a in samples))
    twin.tare.tare()
    yield twin.next(*(a[count:] for a in samples))


LONG = {"4x8": pytest.mark.long}


@pytest.mark.parametrize("case", [pytest.param(name, marks=LONG.get(name, ())) for name in CASES])
def test_array(case):
    bench.run("cop", "array", {"ClkKhz": CLK_KHZ, "TareLog2": TARE_LOG2} | CASES[case])
