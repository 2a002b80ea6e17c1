"""A capacitive array at the pins of a MAX11125 (12 bits): row lines, column multiplexer, carrier, SPI part.

The part's model checks all its limits; the matrix fails the test unless exactly one row is driven. The output
is, bit for bit, the twin's amplitude of the codes that the part gave, and close to the true one; latencies
are the twin's to the clock; frames are complete under stalls; a lost conversion affects only its place; reset
in the middle of a burst.
"""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from frontend.test_scan import counts
from harness.refusals import refused
from meissner.twins.frontend.adc_spi import AD7606, MAX11125, PARTS
from meissner.twins.frontend.am_demod import references
from meissner.twins.frontend.scan_demod import ScanDemod
from parts.carrier import CarrierMatrix
from parts.max1112x import Max1112x
from parts.timing import Line

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
}
CARRIER_HZ = 1e8 / 256  # with the bench's 10 ns clock: a sample every 5/4 periods is 320 clocks
BASE = {
    "Part": MAX11125.number,
    "ClkKhz": 100_000,
    "SamplePeriod": 320,
    "Periods": 2,
    "Skip": 2,
    "Shift": 0,
}


def twin_of(dut):
    values = {name: getattr(dut, port).value.to_unsigned() for name, port in NAMES.items()}
    return ScanDemod(part=PARTS[dut.Part.value.to_unsigned()], **values)


def amplitudes(twin):
    """A different one for every taxel: nearly full scale, half of it, a quarter of it .."""
    order = np.random.default_rng(bench.SEED).permutation(twin.rows * twin.columns)
    return (0.95 * 0.5**order).reshape(twin.rows, twin.columns)


async def begin(dut, settle=3, **others):
    twin = twin_of(dut)
    settings = members.Settings(dut, "scan_cfg", settle=settle, **others)
    matrices = [
        CarrierMatrix(dut, amplitudes(twin), CARRIER_HZ, twin.part.data_bits, 0.3, lane, twin.converters)
        for lane in range(twin.converters)
    ]
    await bench.start(dut, now_i=0, adc_miso_i=0)
    parts, driven = [], {}
    for lane, matrix in enumerate(matrices):
        pins = [
            Line(getattr(dut, f"adc_{name}"), lane, driven)
            for name in ("cs_n_o", "sclk_o", "mosi_o", "miso_i")
        ]
        parts.append(Max1112x(*pins, twin.part.data_bits, matrix.code))
    settings.put(enable=1)
    return twin, matrices, parts


async def frames(dut, count, stalls=None):
    """Beats of ``count`` frames, [(clock, data, id, last, user, frame, time)], the clocks of the convert
    starts and those in which the lines changed."""
    beats, converts, clock, ends = [], [], 0, 0
    changes, lines = [], None
    while ends < count:
        ready = not (stalls and stalls())
        dut.out_ready_i.value, dut.now_i.value = int(ready), bench.time(clock)
        await ReadOnly()
        if dut.convert_o.value == 1:
            converts.append(clock)
        if (now := (bench.read(dut.row_o), bench.read(dut.group_o))) != lines:
            changes.append(clock)
            lines = now
        if ready and dut.out_valid_o.value == 1:
            fields = ("data", "id", "last", "user", "frame", "time")
            beat = [bench.read(getattr(dut, f"out_{name}_o")) for name in fields]
            beats.append((clock, *beat))
            ends += beat[2]
        await RisingEdge(dut.clk_i)
        clock += 1
    return beats, converts, changes


def bursts(twin, matrices, count):
    """Codes [frame, row, column, sample] that the parts gave: of each pair of words only the second counts.

    The first word after a setup is no sample.
    """
    lanes = []
    for matrix in matrices:
        taken = [(0, 0, 0, 0), *matrix.taken]
        codes = np.array([code for *_, code in taken])
        places = np.array([(row, group) for row, group, *_ in taken])
        shape = count, twin.rows, twin.scan.groups, twin.count, 2
        codes, places = codes[: np.prod(shape)].reshape(shape), places[: np.prod(shape)].reshape(*shape, 2)
        expected = np.indices((twin.rows, twin.scan.groups)).transpose(1, 2, 0)
        assert (places == expected[None, :, :, None, None]).all(), "a place was left during its burst"
        lanes.append(codes[..., 1])
    codes = np.stack(lanes, axis=3)  # column = group * converters + converter
    return codes.reshape(count, twin.rows, -1, twin.count)[:, :, : twin.columns]


def rounding(twin):
    """The most by which half a code in each sample can change an amplitude, including its own rounding."""
    weights = np.abs(references(twin.samples_per_period)[0]).sum()
    return 0.5 * np.sqrt(2) * weights * twin.periods / 2**twin.shift + 1.5


def check(twin, matrices, beats, count):
    size = twin.rows * twin.columns
    assert [beat[2] for beat in beats] == [*range(size)] * count
    assert [beat[3] for beat in beats] == [i == size - 1 for i in range(size)] * count
    samples, over = twin.adc.samples(bursts(twin, matrices, count))
    levels, _ = twin.levels(samples, over)
    assert [beat[1] for beat in beats] == levels.ravel().tolist()
    # Against the true value: each summed sample is at most half a code off.
    if twin.form == 1:
        gain = twin.demod.gain(twin.periods) / 2**twin.shift
        true = matrices[0].amplitude * ((1 << twin.part.data_bits) - 1) / 2 * gain
        bound = rounding(twin)
        assert np.abs(levels - true).max() <= bound, np.abs(levels - true).max()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "row_o", "convert_o", "out_valid_o", "status_o")


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def gives_the_amplitudes_of_the_codes_at_the_pins(dut):
    twin, matrices, _ = await begin(dut)
    beats, *_ = await frames(dut, 2)
    check(twin, matrices, beats, 2)
    assert not any(beat[4] for beat in beats)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(settle=(0, 255))
async def takes_the_clocks_of_the_model(dut, settle):
    twin, matrices, _ = await begin(dut, settle)
    beats, converts, changes = await frames(dut, 2)
    check(twin, matrices, beats, 2)
    steps = twin.latency(settle)
    size, places = twin.rows * twin.columns, twin.rows * twin.scan.groups
    starts = converts[:: twin.count]
    # The lines have been constant for the settle time.
    rests = [start - max(change for change in changes if change <= start) for start in starts]
    assert rests == [settle + 1] * len(starts)
    for start in range(0, places * twin.count, twin.count):
        assert set(np.diff(converts[start : start + twin.count])) <= {twin.sample_period}
    assert np.diff(starts[:places]).tolist() == [steps["slot"]] * (places - 1)
    assert starts[places] - starts[0] == steps["frame"]
    assert beats[0][0] - starts[0] == steps["first_beat"]
    assert beats[size - 1][0] - starts[0] == steps["last_beat"]
    assert starts[places - 1] - starts[0] == steps["last_convert"]
    # The time is that of the burst's start, a clock before its first convert_o.
    whole = [beat[5:] for beat in beats]
    assert whole == [(n, bench.time(starts[n * places] - 1)) for n in range(2) for _ in range(size)]


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def frames_are_whole_under_stalls(dut):
    twin, matrices, _ = await begin(dut)
    beats, *_ = await frames(dut, 3, bench.pauses(0.7, "stalls"))
    check(twin, matrices, beats, 3)


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def what_nobody_takes_and_what_comes_too_early_is_counted(dut):
    """A tick each clock and a stalled output: the first frame waits, the others are dropped."""
    twin, *_ = await begin(dut, period=1)
    steps = twin.latency(3)
    await bench.clocks(dut, 3 * steps["frame"] + steps["first_beat"] + steps["slot"])
    await ReadOnly()
    assert (dut.out_valid_o.value, bench.read(dut.out_id_o), bench.read(dut.out_frame_o)) == (1, 0, 0)
    told = counts(dut)
    assert (told["dropped"], told["held"], told["lost"]) == (3, 0, 0)
    assert told["overrun"] > 3 * steps["frame"] - 9


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def marks_over_range(dut):
    _, matrices, _ = await begin(dut)
    for matrix in matrices:
        matrix.over = True
    beats, *_ = await frames(dut, 1)
    assert all(beat[4] for beat in beats) and not any(beat[1] for beat in beats)


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def a_lost_conversion_spoils_its_place_alone(dut):
    """The part answers once with another channel's number, in the middle of the second place's burst."""
    twin, matrices, parts = await begin(dut)
    matrix = matrices[-1]
    at = 2 * (twin.count + twin.count // 2) + 1  # the word with the wrong answer
    parts[-1].spoil = lambda answer: answer ^ 0x5000 if len(matrix.taken) == at else answer
    beats, *_ = await frames(dut, 3)
    size = twin.rows * twin.columns
    assert [beat[2] for beat in beats] == [*range(size)] * 3
    # The second place of the scan: as many taxels as there are converters, or the rest of the row.
    places = [
        range(at, min(at + twin.converters, twin.columns)) for at in range(0, twin.columns, twin.converters)
    ]
    spoiled = places[1] if len(places) > 1 else [column + twin.columns for column in places[0]]
    assert [i for i, beat in enumerate(beats) if beat[4]] == list(spoiled)
    assert not any(beats[i][1] for i in spoiled)
    # Values before and after are right (the rectifier's amplitude changes with the phase).
    level = np.array([beat[1] for beat in beats]).reshape(3, size)
    if twin.form == 1:
        assert np.abs(np.delete(level - level[2], spoiled)).max() <= 2 * rounding(twin)
    assert counts(dut)["lost"] == 1


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def a_reset_in_a_burst_leaves_nothing_behind(dut):
    twin, matrices, parts = await begin(dut)
    await frames(dut, 1)
    await bench.clocks(dut, twin.span // 2)
    for part in parts:
        part.report = lambda violation: None  # the reset breaks off a word
    await bench.reset(dut)
    await bench.clocks(dut, 20)
    for part, matrix in zip(parts, matrices):
        matrix.taken.clear()
        part.report = part.fail
    beats, *_ = await frames(dut, 1)
    check(twin, matrices, beats, 1)


CASES = [
    {"Rows": 2, "Columns": 3},
    {"Rows": 2, "Columns": 3, "Converters": 2, "Skip": 0},  # an extra sample would begin the next burst
    {"Rows": 2, "Columns": 7, "Converters": 3},  # three groups of three, the last of one
    {"Rows": 1, "Columns": 2, "SamplesPerPeriod": 8, "SamplePeriod": 288, "Periods": 1, "Skip": 0},
    {"Rows": 2, "Columns": 2, "Form": 0, "Shift": 1},
]


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
    "faults": {
        "program": {"ClkKhz": 32000, "SamplePeriod": 100},
        "settle": 2,
        "driver": {
            "free": 60000,
            # Counters up to a scan's next row and frame, and the settle time in force until it.
            "late": "since_q count_q rest_q settle_q",
            "part": 5,
            "carrier": 2,
        },
    },
}


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(f"{k}{v}" for k, v in case.items()))
def test_scan_demod(case):
    bench.run("frontend", "scan_demod", BASE | case)


def test_refuses_illegal_parameters():
    wrong = {"Converters": 9, "SamplePeriod": 100, "Periods": 0, "Part": 2}
    for name, value in wrong.items():
        assert name in bench.refuses("scan_demod", BASE | {name: value})
    cases = ({"converters": 9}, {"sample_period": 100}, {"periods": 0}, {"skip": -1})
    refused(ScanDemod, *cases, clk_khz=100_000, part=MAX11125, **{"sample_period": 320})
    with pytest.raises(ValueError, match="BUSY"):
        ScanDemod(part=AD7606)
