"""msn_width_converter against its model: full and partly filled last beats, gaps and stalls,
frames cut short, marks of rows in any place, reset."""

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.common.handshake import width_converter

FIELDS = ["data", "id", "last"]


def shape(dut):
    return tuple(getattr(dut, name).value.to_unsigned() for name in ("Rows", "Columns", "Lanes", "DataBits"))


def frame(rng, rows, columns, lanes, bits, beats=None):
    """The lane values, the row's last and last of each beat of one frame; cut after ``beats``."""
    row_beats = -(-columns // lanes)
    count = beats or rows * row_beats
    values = rng.integers(0, 1 << bits, (count, lanes))
    marks = [(index % row_beats == row_beats - 1, index == count - 1) for index in range(count)]
    return [(row.tolist(), *ends) for row, ends in zip(values, marks)]


async def check(dut, frames, gap=0.0, stall=0.0):
    _, columns, lanes, bits = shape(dut)
    beats = [
        {"data": bench.lane_word(values, bits), "row_last": int(row_last), "last": int(last)}
        for values, row_last, last in frames
    ]
    got = await bench.stream(dut, beats, FIELDS, *bench.gaps_and_stalls(gap, stall), hold=True)
    expected = [dict(zip(FIELDS, map(int, taxel))) for taxel in width_converter(frames, columns, lanes)]
    assert got == expected


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.4], stall=[0.0, 0.5])
async def matches_model(dut, gap, stall):
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut)
    frames = [beat for _ in range(4) for beat in frame(rng, *shape(dut))]
    await check(dut, frames, gap, stall)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def the_mark_tells_how_many_lanes_are_used(dut):
    """A frame whose rows have 1 2 0 0 3 0 beats without the mark before the one that has it."""
    _, columns, lanes, bits = shape(dut)
    used = columns % lanes or lanes
    await bench.start(dut)
    beats, expected = [], []
    for unmarked in (1, 2, 0, 0, 3, 0):
        for row_last in [0] * unmarked + [1]:
            values = [(37 * len(beats) + 5 * lane + 1) % (1 << bits) for lane in range(lanes)]
            beats.append({"data": bench.lane_word(values, bits), "row_last": row_last, "last": 0})
            expected += values[:used] if row_last else values
    beats[-1]["last"] = 1
    got = await bench.stream(dut, beats, FIELDS)
    last = len(expected) - 1
    ids = 1 << len(dut.out_id_o)
    assert [tuple(row[name] for name in FIELDS) for row in got] == [
        (value, place % ids, int(place == last)) for place, value in enumerate(expected)
    ]


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def starts_again_after_a_short_frame_and_a_reset(dut):
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut)
    await check(dut, frame(rng, *shape(dut), beats=1) + frame(rng, *shape(dut)))
    await bench.stream(
        dut, [{"data": 1, "row_last": 0, "last": 0}], FIELDS, stalls=bench.pauses(0.5, "stalls"), drain=0
    )
    await bench.reset(dut)
    await check(dut, frame(rng, *shape(dut)))


EVIDENCE = {"equivalence": {"size": {"Columns": 19}}}

SPACE = lambda draw: {
    "Rows": draw.randint(1, 6),
    "Columns": draw.randint(1, 24),
    "Lanes": draw.randint(1, 8),
}


@pytest.mark.parametrize(
    "rows, columns, lanes",
    [(3, 5, 1), (3, 5, 2), (2, 19, 4), (4, 10, 3), (2, 17, 5), (3, 14, 7), (4, 16, 8), (2, 3, 8), (1, 1, 1)],
)
def test_width_converter(rows, columns, lanes):
    bench.run("common", "width_converter", {"Rows": rows, "Columns": columns, "Lanes": lanes})


test_refuses_illegal_parameters = refusals(
    "width_converter",
    width_converter,
    *({"Lanes": 9}, {"Columns": 1025}),
    alone=[{"Rows": 0}],
    **{"beats": [], "columns": 4, "lanes": 2},
)
