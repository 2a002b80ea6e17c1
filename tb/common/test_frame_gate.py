"""msn_frame_gate: in the bench a chain of one to forty stages follows it, each busy while it holds a beat.
Settings are written at every beat of a frame and between frames. The chain's first and last stages must see
the same settings for all beats of a frame, those of the twin, with gaps and stalls; nothing is lost, repeated
or reordered; without a write every clock carries a beat; the mark of a frame's first beat is checked at every
beat; a gate that an upset closes inside a frame opens again.
"""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.common.frames import first_frame

FRAME = 5
STAGES = (1, 8, 40)


async def run_chain(dut, stages, frames, write_at, gap=0.0, stall=0.0):
    """(results, clocks, when): results [(beat, setting at the first stage, setting at the last stage)].

    ``write_at``: the numbers of beats taken at which a setting is written (its value counts the writes);
    ``when``: the beats offered up to the clock in which each write first was pending.
    """
    gaps, stalls = random.Random(f"{bench.SEED} gaps"), random.Random(f"{bench.SEED} stalls")
    await bench.start(dut, pending_i=0, busy_i=0, in_last_i=0)
    chain, results = [None] * stages, []
    taken = written = active = clock = 0
    pending = held = False
    writes, when = sorted(write_at), []
    while len(results) < frames * FRAME:
        if writes and taken >= writes[0]:
            writes.pop(0)
            when.append(None)
            written, pending = written + 1, True
        offer = taken < frames * FRAME and (held or gaps.random() >= gap)
        ready = stalls.random() >= stall
        stalled = chain[-1] is not None and not ready
        dut.pending_i.value, dut.busy_i.value = int(pending), int(any(chain))
        dut.in_valid_i.value, dut.out_ready_i.value = int(offer), int(not stalled)
        dut.in_last_i.value = int(offer and taken % FRAME == FRAME - 1)
        await ReadOnly()
        out, accepted = bench.read(dut.out_valid_o), bench.read(dut.in_ready_o)
        commit = bench.read(dut.commit_o)
        assert not (commit and any(chain)), "settings change under a frame"
        assert not (out and commit)
        assert not (held and not out), "valid was withdrawn while stalled"
        if out:
            assert bench.read(dut.out_first_o) == (taken % FRAME == 0), taken
        held = out and stalled
        await RisingEdge(dut.clk_i)
        clock += 1
        assert clock < 100_000, "the chain stands still"
        if not stalled:
            if chain[-1] is not None:
                results.append((*chain[-1], active))
            moved = (taken, active) if out else None
            chain = [moved, *chain[:-1]]
            assert bool(out) == bool(offer and accepted)
            taken += bool(out)
        when = [taken + bool(held) if at is None else at for at in when]
        if commit:
            active, pending = written, False
    dut.in_valid_i.value = 0
    return results, clock, when


def check(results, frames, when):
    assert [beat for beat, _, _ in results] == list(range(frames * FRAME))
    for beat, first, last in results:
        expected = sum(first_frame(at, FRAME) <= beat // FRAME for at in when)
        assert first == last == expected, (beat, first, last, expected)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(stages=STAGES, stalls=((0.0, 0.0), (0.4, 0.0), (0.0, 0.4), (0.5, 0.5)))
async def settings_change_between_frames_only(dut, stages, stalls):
    frames = 40
    write_at = [beat * (FRAME * 3 + 1) for beat in range(frames * FRAME // (FRAME * 3 + 1))]
    results, _, when = await run_chain(dut, stages, frames, write_at, *stalls)
    assert len(when) == len(write_at)
    check(results, frames, when)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stages=STAGES)
async def costs_nothing_without_a_change(dut, stages):
    _, plain, _ = await run_chain(dut, stages, 20, [])
    assert plain == 20 * FRAME + stages


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stages=STAGES)
async def a_change_costs_the_chain_and_two_clocks(dut, stages):
    _, changed, _ = await run_chain(dut, stages, 20, [7])
    assert changed == 20 * FRAME + stages + stages + 2


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def opens_after_a_reset_in_the_middle_of_a_frame(dut):
    await bench.start(dut, pending_i=0, busy_i=0, in_last_i=0)
    dut.in_valid_i.value = dut.out_ready_i.value = 1
    await bench.clocks(dut, 2)
    dut.in_valid_i.value = 0
    await bench.reset(dut)
    dut.pending_i.value = 1
    await bench.clocks(dut, 2)  # no frame is in flight: it closes, then has drained
    await ReadOnly()
    assert dut.commit_o.value == 1


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_reset_while_closed_commits_nothing(dut):
    await bench.start(dut, pending_i=1, busy_i=0, in_last_i=1)
    for wait in range(1, 6):
        dut.in_valid_i.value = dut.out_ready_i.value = dut.pending_i.value = 1
        await bench.clocks(dut, wait)
        dut.in_valid_i.value = dut.pending_i.value = 0
        await bench.reset(dut)
        await ReadOnly()
        assert dut.commit_o.value == 0 and dut.in_ready_o.value == 1
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def waits_as_long_as_the_chain_is_busy(dut):
    await bench.start(dut, pending_i=1, busy_i=1, in_last_i=0)
    for _ in range(1000):
        await ReadOnly()
        assert dut.commit_o.value == 0
        await RisingEdge(dut.clk_i)
    dut.busy_i.value, dut.out_ready_i.value = 0, 1
    seen = []
    for _ in range(4):
        await ReadOnly()
        seen.append((bench.read(dut.commit_o), bench.read(dut.in_ready_o)))
        await RisingEdge(dut.clk_i)
        dut.pending_i.value = 0
    assert seen == [(0, 0), (1, 0), (0, 1), (0, 1)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def opens_again_when_an_upset_closes_it_inside_a_frame(dut):
    await bench.start(dut, pending_i=0, busy_i=1, in_last_i=0)
    dut.in_valid_i.value = dut.out_ready_i.value = 1
    await bench.clocks(dut, 2)
    dut.closed.value = 1
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    commits, ready = [], []
    for _ in range(3):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        commits.append(bench.read(dut.commit_o))
        ready.append(bench.read(dut.in_ready_o))
    assert commits == [0, 0, 0] and ready[-1] == 1


EVIDENCE = {"faults": {"inside": ["sensor_array", "u_gate."]}}


def test_frame_gate():
    bench.run("common", "frame_gate")


def test_refuses_illegal_frames():
    with pytest.raises(ValueError, match="frame_beats"):
        first_frame(1, 0)
