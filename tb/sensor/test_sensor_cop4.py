"""msn_sensor_cop4 with frames on the stream: centres of pressure and slip events are the twin's, each after
its own frame's beats, with the time of the frame's first beat; a damaged frame is counted and the next one
passes. At the pins: tb/core.
"""

import random
from dataclasses import asdict

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from core.test_axis import COP_SLIP, ELECTRODES, LAG, _electrodes
from meissner.twins.sensor.sensors import sensor_cop4

NEWTONS = [0.0, 2.0, 2.1, 2.0, 2.1, 2.0, 0.9, 0.8, 0.9, 0.8, 1.7, 1.8, 1.7, 1.8, 1.7, 0.7, 0.6, 0.0, 0.0]
SETTINGS = {f"cop4_{name}": value for name, value in asdict(ELECTRODES.registers).items()}
SETTINGS |= {f"cop_slip_{name}": value for name, value in asdict(COP_SLIP).items()}


class Bench:
    def __init__(self, dut, stall=0.0):
        self.dut, self.stall, self.clock, self.cops, self.decisions, self.commits = dut, stall, 0, [], [], []
        self.draw, self.firsts, self.frames = random.Random(f"{bench.SEED} sink"), [], 0

    async def begin(self):
        names = "now pending adc_miso adc_busy in_data in_id in_last decision_ready"
        idle = {f"{name}_i": 0 for name in names.split()}
        await bench.start(self.dut, cfg_i=members.word("cfg", SETTINGS), **idle)

    async def step(self, beat=None, pending=0):
        """One clock with a beat offered or none; returns whether it was taken."""
        dut = self.dut
        value, place, last = beat or (-5, 3, 1)
        dut.in_valid_i.value, dut.in_data_i.value = int(beat is not None), int(value) & 0x1FFFF
        dut.in_id_i.value, dut.in_last_i.value, dut.pending_i.value = place, last, pending
        ready, now = int(self.draw.random() >= self.stall), 11 + 5 * self.clock
        dut.decision_ready_i.value, dut.now_i.value = ready, now
        await ReadOnly()
        time = bench.read(dut.time_o)
        if dut.cop_valid_o.value == 1:
            cop = members.of("cop", bench.read(dut.cop_o))
            sides = [bench.as_signed(cop[side], 24) for side in "xy"]
            self.cops.append((*sides, cop["load"], cop["pressed"], time))
        decision = members.of("decision", bench.read(dut.decision_o))
        if dut.decision_valid_o.value == 1 and ready:
            assert (decision["last"], decision["id"]) == (1, 0xFFFF)
            self.decisions.append((decision["state"], decision["raised"], decision["p2p"], time))
        if dut.commit_o.value == 1:
            self.commits.append(self.frames)
        taken = beat is not None and dut.in_ready_o.value == 1
        if taken and place == 0:
            self.firsts.append(now)
        self.frames += bool(taken and last)
        await RisingEdge(dut.clk_i)
        self.clock += 1
        return taken


def beats_of(frame):
    return [(value, place, int(place == 3)) for place, value in enumerate(frame)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0), (0.5, 0.0), (0.2, 0.7)])
async def centres_and_events_are_the_models(dut, pace):
    gap, stall = pace
    line, draw, samples = Bench(dut, stall), random.Random(f"{bench.SEED} in"), _electrodes(NEWTONS)
    await line.begin()
    for frame in samples.tolist():
        for beat in beats_of(frame):
            while draw.random() < gap:
                await line.step()
            while not await line.step(beat):
                pass
    for _ in range(500):
        await line.step()
    slip = COP_SLIP if dut.CopSlip.value.to_unsigned() else None
    cops, decisions = sensor_cop4(samples, ELECTRODES.registers, None, LAG, slip)
    assert line.cops == [(*cop, time) for cop, time in zip(cops, line.firsts)]
    assert line.decisions == [(*one, time) for one, time in zip(decisions, line.firsts)]
    assert len(decisions) == (len(NEWTONS) if slip else 0) and len(set(line.firsts)) == len(NEWTONS)
    # 0: nothing presses; 1: pressed; 2: a slip, which is raised once for each of the two drops of the load.
    pressed = [int(newtons > 0) for newtons in NEWTONS]
    slips = [k for k, (_, raised, *_) in enumerate(line.decisions) if raised]
    for k, (state, *_) in enumerate(line.decisions):
        assert state == 2 or state == pressed[k], k
    assert not slip or (len(slips) == 2 and {state for state, *_ in line.decisions} == {0, 1, 2})
    assert bench.read(dut.status_o) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def settings_change_between_two_frames(dut):
    """Requested at every beat: committed when the frame's result has left, never inside a frame."""
    line, samples = Bench(dut), _electrodes(NEWTONS[:8])
    await line.begin()
    for n, frame in enumerate(samples.tolist()):
        for place, beat in enumerate(beats_of(frame)):
            while not await line.step(beat, pending=int(place >= n % 4)):
                pass
        before = len(line.commits)
        while len(line.commits) == before:
            await line.step(pending=1)
            assert line.clock < 20_000
        assert len(line.cops) == n + 1 and set(line.commits[before:]) == {n + 1}
        await bench.clocks(dut, 3)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_damaged_frame_is_counted_and_holds_nothing(dut):
    line, (first, second) = Bench(dut), _electrodes(NEWTONS[:2]).tolist()
    await line.begin()
    wrong = [(first[0], 0, 0), (first[1], 2, 0), (first[2], 2, 0), (first[3], 3, 1)]
    for beats in (wrong, beats_of(second)):
        for beat in beats:
            while not await line.step(beat):
                assert line.clock < 2000
    for _ in range(400):
        await line.step()
    assert len(line.cops) == 1 and line.cops[0][-1] == line.firsts[-1]
    status = members.of("status", bench.read(dut.status_o))
    assert {name: value for name, value in status.items() if value} == {"cop_damaged": 1}


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
}


@pytest.mark.parametrize("cop_slip", [1, 0])
def test_sensor_cop4(cop_slip):
    bench.run("sensor", "sensor_cop4", {"CopSlip": cop_slip, "Lag": LAG})
