"""msn_cop_accumulate against its model, and the model against exact sums of Python integers: every size
class from 1 x 1 to 1024 x 1024, all lane counts, row ends inside a beat; corners, single taxels, full scale,
checkerboards; gaps and stalls; frames back to back; a result not taken; last early, late, lost; resets."""

import random

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.cop.cop import CopAccumulate, moments, sum_bits

FIELDS = ["sum", "mx~", "my~"]


def parameters(dut):
    return [getattr(dut, name).value.to_unsigned() for name in ("Rows", "Columns", "Lanes")]


def small(dut):
    rows, columns, _ = parameters(dut)
    return rows * columns <= 10**5


def latency(lanes):
    return 2 + next(levels for levels in range(5) if 2**levels >= lanes)


def expected_of(forces):
    return [dict(zip(("sum", "mx", "my"), map(int, frame))) for frame in zip(*moments(forces))]


def damaged_frames(beats, length, draw):
    """The beats of complete frames with every other frame damaged, and the numbers of those left complete."""
    sent, whole = [], []
    for frame in range(len(beats) // length):
        part = [dict(beat) for beat in beats[frame * length : (frame + 1) * length]]
        kind = draw.choice(["missing", "doubled", "early", "lost", "late"]) if frame % 2 == 0 else "none"
        at = draw.randrange(length)
        if kind == "missing":
            del part[at]
            if not part or not part[-1]["last"]:  # the last beat is missing: two frames are lost
                kind = "lost"
        elif kind == "doubled":
            part.insert(at, dict(part[at]))
            if at == length - 1:
                part[at]["last"] = False
        elif kind == "early":
            part = part[: at + 1]
            part[-1]["last"] = True
            kind = "none" if at == length - 1 else kind
        elif kind == "late":
            part += [dict(part[-1])]
            part[-2]["last"] = False
        if kind == "lost":
            part = [beat | {"last": False} for beat in part]
        sent.append((part, kind))
    previous = "none"
    for frame, (_, kind) in enumerate(sent):
        if kind == "none" and previous != "lost":
            whole.append(frame)
        previous = kind
    return [beat for part, _ in sent for beat in part], whole


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", again=False)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """Frames of one beat that does not fit."""
    await bench.start(dut, in_data_i=0, in_row_last_i=0, in_fits_i=0, in_last_i=1)
    await bench.counts_on(dut, "damaged_o", in_valid_i=1, out_ready_i=1)


@bench.applies(small)  # the large array has its own test
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.6])
async def matches_model(dut, stall_rate):
    rows, columns, lanes = parameters(dut)
    assert len(dut.out_sum_o) == sum_bits(rows, columns)
    await bench.start(dut)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)
    gaps, stalls = bench.gaps_and_stalls(stall_rate / 3, stall_rate)
    beats = bench.force_beats(forces, lanes)
    assert await bench.stream(dut, beats, FIELDS, gaps, stalls) == expected_of(forces)
    assert bench.read(dut.damaged_o) == 0


@bench.applies(lambda dut: not small(dut), long=True)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def large_array_matches_model(dut):
    rows, columns, lanes = parameters(dut)
    await bench.start(dut)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)
    random_one = forces[-1]
    for frame in (np.full_like(random_one, 65535), random_one):
        result, waited = await bench.force_frame(dut, frame, lanes, FIELDS)
        assert result == expected_of(frame[None])[0]
        assert waited == latency(lanes)


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated_and_frames_never_wait(dut):
    """Frames back to back, a beat every clock: each result exactly its latency after its frame's last
    beat."""
    rows, columns, lanes = parameters(dut)
    await bench.start(dut, out_ready_i=1)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)[:12]
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // len(forces)
    seen = []
    for clock in range(len(beats) + latency(lanes) + 2):
        dut.in_valid_i.value = int(clock < len(beats))
        beat = beats[min(clock, len(beats) - 1)]
        bench.offer(dut, beat)
        await bench.ReadOnly()
        assert dut.in_ready_o.value == 1, f"stalled at clock {clock}"
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert seen == [length * (n + 1) - 1 + latency(lanes) for n in range(len(forces))]


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(every=[1, 4])
async def waits_only_when_two_results_are_not_taken(dut, every):
    """With results not taken, two frames and the beats in the pipeline go in, and none is lost."""
    rows, columns, lanes = parameters(dut)
    await bench.start(dut, out_ready_i=0)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)[-6:]
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // len(forces)
    room = 2 * length + latency(lanes) - 2  # beats of a third frame between lanes and sums
    sent = 0
    for clock in range(every * room + 40):
        dut.in_valid_i.value = int(clock % every == 0)
        bench.offer(dut, beats[sent])
        await bench.ReadOnly()
        sent += int(dut.in_ready_o.value) if clock % every == 0 else 0
        await bench.RisingEdge(dut.clk_i)
        if sent == len(beats):
            break
    assert sent == min(room, len(beats)) or (every > 1 and 2 * length <= sent <= room)  # gaps use room too
    assert await bench.stream(dut, beats[sent:], FIELDS) == expected_of(forces)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def counts_every_damaged_frame(dut):
    """A frame that ends with its first beat; a frame of one beat cannot be too short, so its last is
    removed."""
    rows, columns, lanes = parameters(dut)
    await bench.start(dut)
    lone = rows == 1 and columns <= lanes
    marks = {"data": 0, "fits": False, "row_last": lone}
    beats = [marks | {"last": last} for last in ((False, True) if lone else (True,))] * 1100
    assert await bench.stream(dut, beats, FIELDS) == []
    assert bench.read(dut.damaged_o) == 1100


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def drops_damaged_frames_whole(dut, stall_rate):
    rows, columns, lanes = parameters(dut)
    forces = np.random.default_rng(bench.SEED).integers(
        0, 65536, (40 if rows * columns < 99 else 8, rows, columns)
    )
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // len(forces)
    sent, whole = damaged_frames(beats, length, random.Random(bench.SEED))
    sent = bench.placed(sent, rows, length // rows)
    twin = CopAccumulate(rows, columns, lanes)
    data = [[beat["data"] >> 16 * k & 0xFFFF for k in range(lanes)] for beat in sent]
    ends = [[beat[name] for beat in sent] for name in ("last", "fits")]
    expected = [dict(zip(("sum", "mx", "my"), r)) for r in twin.process(data, *ends)]
    if length > 1:
        assert [frame for frame in expected_of(forces[whole]) if frame not in expected] == []
    await bench.start(dut)
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, sent, FIELDS, *pauses) == expected
    assert bench.read(dut.damaged_o) == twin.damaged > 0


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    rows, columns, lanes = parameters(dut)
    await bench.start(dut)
    forces = np.random.default_rng(bench.SEED).integers(0, 65536, (2, rows, columns))
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // 2
    for cut in {1, length // 2 + 1, length - 1, length, length + 1, 2 * length}:
        # Results are not taken, so that a finished frame waits when the reset comes.
        await bench.stream(dut, beats[:cut], FIELDS, stalls=lambda: True, drain=0)
        await bench.clocks(dut, lanes.bit_length())
        await bench.reset(dut)
        assert await bench.stream(dut, beats, FIELDS) == expected_of(forces)


EVIDENCE = {
    "equivalence": {"size": {"Rows": 5}, "reset_size": {"Rows": 3, "Lanes": 1}},
    "mutants": {"whole": True},
    "faults": {"size": {"Rows": 3}, "settle": 2},
    "icarus": {
        "refused": "a packed vector of vectors of which a process drives one element and an "
        "assignment another: refused",
        "runs": {"Lanes": 1},
    },
}

SPACE = lambda draw: {
    "Rows": draw.randint(1, 12),
    "Columns": draw.randint(1, 20),
    "Lanes": draw.choice([1, 2, 3, 4, 5, 6, 7, 8, 16]),
}


@pytest.mark.parametrize(
    "rows, columns, lanes",
    [
        (1, 1, 1),
        (1, 9, 4),
        (11, 1, 1),
        (2, 2, 2),
        (3, 3, 1),
        (5, 9, 8),
        (4, 10, 3),
        (3, 17, 5),
        (2, 15, 6),
        (2, 64, 7),
        (3, 100, 16),
        (64, 64, 1),
        (33, 63, 4),
        (1024, 1024, 8),
    ],
)
def test_cop_accumulate(rows, columns, lanes):
    bench.run("cop", "cop_accumulate", {"Rows": rows, "Columns": columns, "Lanes": lanes})


@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 9), (9, 1), (2, 2), (5, 7), (33, 63), (1024, 1024)])
def test_model_against_plain_sums(rows, columns):
    """The definition, term by term in Python's unbounded integers."""
    forces = bench.force_frames(np.random.default_rng(2), rows, columns)
    for frame in forces[:: 1 if rows * columns < 9999 else len(forces) - 1]:
        total = mx = my = 0
        for i, line in enumerate(frame.tolist()):
            total += sum(line)
            mx += sum((2 * j - (columns - 1)) * force for j, force in enumerate(line))
            my += (rows - 1 - 2 * i) * sum(line)
        assert moments(frame) == (total, mx, my)


def test_refuses_illegal_parameters():
    assert "Rows = 1025" in bench.refuses("cop_accumulate", {"Rows": 1025})
    assert "Columns = 0" in bench.refuses("cop_accumulate", {"Columns": 0})
    assert "Lanes = 9" in bench.refuses("cop_accumulate", {"Lanes": 9})
    for size, message in (((1025, 1), "rows = 1025"), ((1, 0), "columns = 0"), ((1, 1, 9), "lanes = 9")):
        with pytest.raises(ValueError, match=message):
            CopAccumulate(*size)
    with pytest.raises(ValueError, match="forces"):
        moments([[65536]])
