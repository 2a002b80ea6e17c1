"""msn_health_report against its model: every kind of fault on every lane, rows that do not fill their last
beat, gaps and stalls, reset."""

import random

import cocotb
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.frontend.health import reports


def shape(dut):
    return tuple(getattr(dut, name).value.to_unsigned() for name in ("Lanes", "Columns"))


def events(draw, count, lanes, id_bits):
    top = (1 << id_bits) - 1
    corners = [(top, (1 << lanes) - 1, 0, 0), (0, 0, 1, 0), (top, 0, 0, 1 << (lanes - 1))]
    bits = lambda: draw.getrandbits(lanes) & draw.getrandbits(lanes)
    return corners + [(draw.getrandbits(id_bits), bits(), bits(), bits()) for _ in range(count)]


async def check(dut, given, gap=0.0, stall=0.0):
    beats = [dict(zip(("id", "dead", "railed", "blinking"), event)) for event in given]
    got = await bench.stream(dut, beats, ["id", "faults"], *bench.gaps_and_stalls(gap, stall), hold=True)
    assert [tuple(row.values()) for row in got] == reports(given, *shape(dut))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.5], stall=[0.0, 0.6])
async def matches_model(dut, gap, stall):
    await bench.start(dut)
    draw = random.Random(bench.SEED)
    await check(dut, events(draw, 80, len(dut.in_dead_i), len(dut.in_id_i)), gap, stall)


# By hand from docs/link.md: taxels row-major; 1 dead, 2 railed, 4 blinking, or their sum.
LITERALS = {
    (1, 1): (
        [(5, 1, 0, 0), (6, 0, 1, 0), (7, 0, 0, 1), (9, 1, 0, 1), (10, 1, 1, 0), (12, 0, 1, 1), (13, 1, 1, 1)],
        [(5, 1), (6, 2), (7, 4), (9, 5), (10, 3), (12, 6), (13, 7)],
    ),
    (2, 6): ([(5, 0b01, 0b10, 0b00), (9, 0b10, 0b00, 0b11)], [(10, 1), (11, 2), (18, 4), (19, 5)]),
    # Beats 0 to 3 are taxels 0 to 9, beats 4 to 7 10 to 19; beat 47 is the last of row 11, with one taxel.
    (3, 10): (
        [(2, 0b101, 0b001, 0b000), (3, 0b001, 0b000, 0b001), (4, 0b001, 0b100, 0b000), (47, 0, 0b001, 0)],
        [(6, 3), (8, 1), (9, 5), (10, 1), (12, 2), (119, 2)],
    ),
    (8, 8): ([(3, 0b1000_0001, 0b0000_0001, 0b0100_0000)], [(24, 3), (30, 4), (31, 1)]),
}


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def bits_are_those_of_the_link(dut):
    await bench.start(dut)
    given, expected = LITERALS[shape(dut)]
    beats = [dict(zip(("id", "dead", "railed", "blinking"), event)) for event in given]
    got = await bench.stream(dut, beats, ["id", "faults"], hold=True)
    assert [(row["id"], row["faults"]) for row in got] == expected


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_reader_asleep_at_each_report(dut):
    """Every lane is faulty and the next event is always offered. The reader sleeps for 2 Lanes + 5 clocks
    before each report in turn: the offered report stays, the next event stalls, and each report comes once.
    """
    lanes = len(dut.in_dead_i)
    given = [(9 + 4 * number, (1 << lanes) - 1, 0, 0) for number in range(4)]
    row_beats = -(-shape(dut)[1] // lanes)
    first = [event[0] // row_beats * shape(dut)[1] + event[0] % row_beats * lanes for event in given]
    expected = [(taxel + lane, 1) for taxel in first for lane in range(lanes)]
    await bench.start(dut)
    for asleep in range(2 * lanes):
        sent, got, slept = 0, [], 0
        for _ in range(10 * lanes + 80):
            dut.in_valid_i.value = int(sent < len(given))
            bench.offer(dut, dict(zip(("id", "dead", "railed", "blinking"), given[min(sent, 3)])))
            ready = len(got) != asleep or slept == 2 * lanes + 5
            dut.out_ready_i.value = int(ready)
            await bench.ReadOnly()
            valid = dut.out_valid_o.value == 1
            report = (bench.read(dut.out_id_o), bench.read(dut.out_faults_o))
            assert not slept or (valid and report == expected[asleep]), asleep
            if not ready and valid:
                slept += 1
                assert dut.in_ready_o.value == 0
            if ready and valid:
                got.append(report)
                slept = 0
            sent += sent < len(given) and dut.in_ready_o.value == 1
            await bench.RisingEdge(dut.clk_i)
        assert got == expected, asleep
        assert dut.in_ready_o.value == 1 and dut.out_valid_o.value == 0


EVIDENCE = {
    "equivalence": {"size": {"Lanes": 2}},
}


@pytest.mark.parametrize("lanes, columns", LITERALS)
def test_model_s_bits_are_those_of_the_link(lanes, columns):
    given, expected = LITERALS[lanes, columns]
    assert reports(given, lanes, columns) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await bench.start(dut)
    draw = random.Random(bench.SEED)
    given = events(draw, 3, len(dut.in_dead_i), len(dut.in_id_i))
    beat = dict(zip(("id", "dead", "railed", "blinking"), given[0]))
    await bench.stream(dut, [beat], ["id", "faults"], stalls=lambda: True, drain=0)
    await bench.reset(dut)
    await check(dut, given)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(faulty=[True, False])
async def an_event_takes_a_clock_for_each_lane(dut, faulty):
    """And one to be taken, whether the lanes have a report or are skipped; one for each row above where
    the columns do not fill the lanes: beat 13 is then in row 3."""
    lanes, columns = shape(dut)
    each = lanes + 1 + (3 if columns == 10 else 0)
    await bench.start(dut, out_ready_i=1, in_valid_i=1, in_id_i=13, in_railed_i=0, in_blinking_i=0)
    dut.in_dead_i.value = (1 << lanes) - 1 if faulty else 0
    taken, reported = [], 0
    for clock in range(4 * each):
        await bench.ReadOnly()
        taken += [clock] if dut.in_ready_o.value == 1 else []
        reported += int(dut.out_valid_o.value)
        await bench.RisingEdge(dut.clk_i)
    assert taken == [0, each, 2 * each, 3 * each]
    assert reported == (4 * lanes if faulty else 0)


@pytest.mark.parametrize("lanes, columns, id_bits", [(1, 1, 6), (2, 6, 6), (3, 10, 6), (8, 8, 21)])
def test_health_report(lanes, columns, id_bits):
    bench.run("frontend", "health_report", {"Lanes": lanes, "Columns": columns, "IdBits": id_bits})


test_refuses_illegal_parameters = refusals(
    "health_report", reports, {"Lanes": 9}, {"Columns": 1025}, events=[], lanes=8
)
