"""A capacitive array at the pins of a MAX11125 (12 bits): row lines, column multiplexer, carrier, SPI part.

The part's model checks its every limit; the matrix fails the test where not exactly one row is driven. What
leaves is, bit for bit, the twin's amplitude of the very codes that the part gave, and close to the true one;
latencies are the twin's to the clock; frames are whole under stalls; a lost conversion spoils its place only;
reset in the middle of a burst.
"""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.frontend.adc_spi import MAX11125, PARTS
from meissner.frontend.am_demod import references
from meissner.frontend.scan_demod import ScanDemod
from parts.carrier import CarrierMatrix
from parts.max1112x import Max1112x

NAMES = {
    "rows": "Rows",
    "columns": "Columns",
    "converters": "Converters",
    "clk_khz": "ClkKhz",
    "sample_bits": "SampleBits",
    "form": "Form",
    "samples_per_period": "SamplesPerPeriod",
    "sample_period": "SamplePeriod",
    "periods": "Periods",
    "skip": "Skip",
    "shift": "Shift",
    "settle_bits": "SettleBits",
}
CARRIER_HZ = 1e8 / 256  # of the bench's 10 ns clock: a sample every 5/4 periods is 320 clocks
BASE = {
    "Part": MAX11125.number,
    "ClkKhz": 100_000,
    "SamplePeriod": 320,
    "Periods": 2,
    "Skip": 2,
    "Shift": 0,
    "SettleBits": 8,
}


def twin_of(dut):
    values = {name: getattr(dut, port).value.to_unsigned() for name, port in NAMES.items()}
    return ScanDemod(part=PARTS[dut.Part.value.to_unsigned()], **values)


def amplitudes(twin):
    """Another one for every taxel, 0.1 to 0.9 of full scale."""
    count = twin.rows * twin.columns
    order = np.random.default_rng(bench.SEED).permutation(count)
    return (0.1 + 0.8 * order / max(1, count - 1)).reshape(twin.rows, twin.columns)


async def begin(dut, settle=3):
    twin = twin_of(dut)
    settings = {"settle": settle, "period": 0, "interleave": 0}
    settings |= {
        "first_row": 0,
        "last_row": twin.rows - 1,
        "first_column": 0,
        "last_column": twin.columns - 1,
    }
    inputs = {f"cfg_{name}_i": value for name, value in settings.items()}
    matrix = CarrierMatrix(dut, amplitudes(twin), CARRIER_HZ, twin.part.data_bits)
    await bench.start(dut, cfg_enable_i=0, now_i=0, adc_miso_i=0, **inputs)
    part = Max1112x(
        dut.adc_cs_n_o, dut.adc_sclk_o, dut.adc_mosi_o, dut.adc_miso_i, twin.part.data_bits, matrix.code
    )
    dut.cfg_enable_i.value = 1
    return twin, matrix, part


async def frames(dut, count, stalls=None):
    """Beats of ``count`` frames, [(clock, data, id, last, user)], and the clocks of the convert starts."""
    beats, converts, clock, ends = [], [], 0, 0
    while ends < count:
        ready = not (stalls and stalls())
        dut.out_ready_i.value = int(ready)
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(clock)
        if ready and dut.out_valid_o.value == 1:
            beat = [bench.read(getattr(dut, f"out_{name}_o")) for name in ("data", "id", "last", "user")]
            beats.append((clock, *beat))
            ends += beat[2]
        await RisingEdge(dut.clk_i)
        clock += 1
    return beats, converts


def bursts(twin, matrix, count):
    """Codes [frame, row, column, sample] that the part gave: of each pair of words the second is answered.

    The first word after a setup samples nothing.
    """
    taken = [(0, 0, 0, 0), *matrix.taken]
    codes = np.array([code for *_, code in taken])
    places = np.array([(row, group) for row, group, *_ in taken])
    size = twin.rows * twin.columns
    codes = codes[: 2 * count * size * twin.count].reshape(count, twin.rows, twin.columns, twin.count, 2)
    places = places[: codes.size].reshape(*codes.shape, 2)
    expected = np.indices((twin.rows, twin.columns)).transpose(1, 2, 0)
    assert (places == expected[None, :, :, None, None]).all(), "a place was left during its burst"
    return codes[..., 1]


def check(twin, matrix, beats, count):
    size = twin.rows * twin.columns
    assert [beat[2] for beat in beats] == [*range(size)] * count
    assert [beat[3] for beat in beats] == [i == size - 1 for i in range(size)] * count
    samples, over = twin.adc.samples(bursts(twin, matrix, count))
    levels, _ = twin.levels(samples, over)
    assert [beat[1] for beat in beats] == levels.ravel().tolist()
    # Against the truth: each of the samples that are summed is half a code off at most.
    if twin.form == 1:
        gain = twin.demod.gain(twin.periods) / 2**twin.shift
        true = matrix.amplitude * ((1 << twin.part.data_bits) - 1) / 2 * gain
        weights = np.abs(references(twin.samples_per_period)[0]).sum()
        bound = 0.5 * np.sqrt(2) * weights * twin.periods / 2**twin.shift + 1.5
        assert np.abs(levels - true).max() <= bound, np.abs(levels - true).max()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def gives_the_amplitudes_of_the_codes_at_the_pins(dut):
    twin, matrix, _ = await begin(dut)
    beats, _ = await frames(dut, 2)
    check(twin, matrix, beats, 2)
    assert not any(beat[4] for beat in beats)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(settle=(0, 255))
async def takes_the_clocks_of_the_model(dut, settle):
    twin, matrix, _ = await begin(dut, settle)
    beats, converts = await frames(dut, 2)
    check(twin, matrix, beats, 2)
    steps = twin.latency(settle)
    size = twin.rows * twin.columns
    starts = converts[:: twin.count]
    for start in range(0, size * twin.count, twin.count):
        assert set(np.diff(converts[start : start + twin.count])) <= {twin.sample_period}
    assert np.diff(starts[:size]).tolist() == [steps["slot"]] * (size - 1)
    assert starts[size] - starts[0] == steps["frame"]
    assert beats[0][0] - starts[0] == steps["first_beat"]
    assert beats[size - 1][0] - starts[0] == steps["last_beat"]
    assert starts[size - 1] - starts[0] == steps["last_convert"]


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def frames_are_whole_under_stalls(dut):
    twin, matrix, _ = await begin(dut)
    beats, _ = await frames(dut, 3, bench.pauses(0.7))
    check(twin, matrix, beats, 3)


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def marks_over_range(dut):
    _, matrix, _ = await begin(dut)
    matrix.over = True
    beats, _ = await frames(dut, 1)
    assert all(beat[4] for beat in beats) and not any(beat[1] for beat in beats)


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def a_lost_conversion_spoils_its_place_alone(dut):
    """The part answers with another channel's number once, in the middle of the second place's burst."""
    twin, matrix, part = await begin(dut)
    at = 2 * (twin.count + twin.count // 2) + 1  # the word that answers
    part.spoil = lambda answer: answer ^ 0x5000 if len(matrix.taken) == at else answer
    beats, _ = await frames(dut, 3)
    size = twin.rows * twin.columns
    assert [beat[2] for beat in beats] == [*range(size)] * 3
    marked = [i for i, beat in enumerate(beats) if beat[4]]
    assert marked == [1] and beats[1][1] == 0
    # What comes before and after is right (the rectifier's amplitude changes with the phase).
    level = np.array([beat[1] for beat in beats]).reshape(3, size)
    if twin.form == 1:
        assert np.abs(np.delete(level - level[2], 1)).max() <= 8
    assert bench.read(dut.lost_o) == 1


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def a_reset_in_a_burst_leaves_nothing_behind(dut):
    twin, matrix, part = await begin(dut)
    await frames(dut, 1)
    await bench.clocks(dut, twin.span // 2)
    part.report = lambda violation: None  # a word is broken off
    await bench.reset(dut)
    await bench.clocks(dut, 20)
    matrix.taken.clear()
    part.report = part.fail
    beats, _ = await frames(dut, 1)
    check(twin, matrix, beats, 1)


CASES = [
    {"Rows": 2, "Columns": 3},
    {"Rows": 1, "Columns": 1, "SamplesPerPeriod": 8, "SamplePeriod": 288, "Periods": 1, "Skip": 0},
    {"Rows": 2, "Columns": 2, "Form": 0, "Shift": 1},
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(f"{k}{v}" for k, v in case.items()))
def test_scan_demod(case):
    bench.run("frontend", "scan_demod", BASE | case)


def test_refuses_illegal_parameters():
    for name, value, field in (
        ("Converters", 3, "converters"),
        ("SamplePeriod", 100, "sample_period"),
        ("Periods", 0, "periods"),
    ):
        assert f"{name} = {value}" in bench.refuses("scan_demod", BASE | {name: value})
        with pytest.raises(ValueError, match=field):
            ScanDemod(**{"clk_khz": 100_000, "sample_period": 320, "part": MAX11125, field: value})
