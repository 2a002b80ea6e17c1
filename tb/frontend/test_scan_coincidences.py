"""Events that meet in one clock in msn_scan, worked out by hand from its header: a frame's last beat and the
next one's trigger, first beat and time stamp; a lost strobe around samples; enable falling around triggers; a
reset in every clock of a frame.

Settle 2 and a cycle of 20: a conversion every 20 clocks, trigger_o in clocks 7, 27, 47 .. after enable, at
the pins a clock later. A frame has two conversions of 3 beats of 2 columns; the last beat has one column
outside the array.
"""

import itertools
from functools import partial

import cocotb
import pytest

import bench
import members
from frontend.test_scan import counts

SIZE = {"Rows": 2, "Columns": 5, "Lanes": 2, "Channels": 3, "Hold": 4, "Cycle": 20, "SampleBits": 13}
SIZE |= {"SettleBits": 6, "PeriodBits": 16}
TRIGGER, SLOT, LATENCY, BEATS, ROWS = 7, 20, 5, 3, 2
FIELDS = ("id", "last", "user", "frame", "time")


SETTINGS = partial(members.Settings, kind="scan_cfg", settle=2)


def code(conversion, channel, lane):
    return 100 * conversion + 10 * channel + lane + 1


def now(clock):
    return (0xABCD_0000_0000 + 7 * clock) & ((1 << 48) - 1)


def wide(dut):
    return dut.Lanes.value.to_unsigned() == 2


class Scene:
    """Samples follow each trigger from ``delay`` clocks after trigger_o on; ``lost``: {(conversion, lane):
    clocks after trigger_o}; ``ready``: a function of the clock; enable is high for ``enabled`` clocks."""

    def __init__(self, dut, delay=2, lost=None, ready=lambda clock: 1, enabled=None):
        self.dut, self.delay, self.lost, self.ready, self.enabled = dut, delay, lost or {}, ready, enabled
        self.clock, self.triggers, self.out = 0, [], []

    async def tick(self):
        dut, waiting = self.dut, []
        SETTINGS(dut, enable=self.enabled is None or self.clock < self.enabled)
        dut.now_i.value, dut.out_ready_i.value = now(self.clock), self.ready(self.clock)
        valid, data, lost = 0, [0, 0], 0
        for number, at in enumerate(self.triggers):
            channel = self.clock - at - self.delay
            for lane in range(2):
                waiting = self.lost.get((number, lane))
                if waiting is None and 0 <= channel < BEATS:
                    valid |= 1 << lane
                    data[lane] = code(number, channel, lane)
                if waiting == self.clock - at:
                    lost |= 1 << lane
        dut.in_valid_i.value, dut.in_data_i.value = valid, bench.lane_word(data, 13)
        dut.in_lost_i.value = lost
        await bench.ReadOnly()
        assert bench.read(dut.in_ready_o) & valid == valid  # here both lanes' samples come together
        if dut.out_valid_o.value == 1 and self.ready(self.clock):
            beat = [bench.read(getattr(dut, f"out_{name}_o")) for name in FIELDS]
            values = bench.lane_values(bench.read(dut.out_data_o), 2, 13)
            self.out.append((self.clock, *beat, values))
        if dut.trigger_o.value == 1:
            self.triggers.append(self.clock)
        await bench.RisingEdge(dut.clk_i)
        self.clock += 1

    async def run(self, clocks):
        for _ in range(clocks):
            await self.tick()
        return [beat[1:] for beat in self.out]


def frame(number, first, lost=()):
    """The beats of frame ``number``, which begins with trigger ``first``; ``lost``: {conversion: lanes}."""
    found, time = [], now(TRIGGER + SLOT * first + 1)
    for place in range(ROWS * BEATS):
        conversion, channel = first + place // BEATS, place % BEATS
        gone = dict(lost).get(conversion, ())
        values = [0 if lane in gone else code(conversion, channel, lane) for lane in range(2)]
        user = sum(1 << lane for lane in gone)
        found.append((place, int(place == ROWS * BEATS - 1), user, number, time, values))
    return found


def frames(*dropped):
    """The beats of frames back to back, without the ``dropped`` ones."""
    return [beat for number in range(7) if number not in dropped for beat in frame(number, 2 * number)]


async def begin(dut):
    SETTINGS(dut)
    await bench.start(dut, now_i=0, in_data_i=0, in_lost_i=0, in_user_i=0)


async def again(dut, **given):
    SETTINGS(dut)
    dut.in_valid_i.value = dut.in_lost_i.value = 0
    await bench.reset(dut)
    await bench.clocks(dut, 5)
    return Scene(dut, **given)


@bench.applies(wide)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_frames_end_around_the_next_trigger(dut):
    """The last sample comes as late as the clock before the next trigger_o: the frame's last beat leaves
    around that clock, with the number and the time of its own frame."""
    await begin(dut)
    for delay in range(1, SLOT - BEATS + 1):
        scene = await again(dut, delay=delay)
        got = await scene.run(150)
        assert got == frames()[: len(got)], delay
        came = [at + delay + channel for at in scene.triggers for channel in range(BEATS)]
        due = [clock + LATENCY for clock in came if clock + LATENCY < 150]
        assert [beat[0] for beat in scene.out] == due and len(due) >= 14, delay
        assert scene.triggers == [TRIGGER + SLOT * n for n in range(8)]


@bench.applies(wide)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_consumer_wakes_around_the_next_frames_first_beat(dut):
    """A frame's first beat is in the buffer 2 clocks after its sample. If the previous frame's last beat
    leaves in an earlier clock, the frame is kept; otherwise it is dropped and counted, and the next one
    follows with its own number and time."""
    await begin(dut)
    delay = 2
    first = TRIGGER + 2 * SLOT + delay + 2  # of frame 1
    met = set()
    for last, one in itertools.product(range(first - 4, first + 5), (False, True)):
        # Awake from 6 clocks before on, where the last of these clocks takes the frame's last beat; or asleep
        # only for that beat, which is offered in clock 36.
        asleep = range(36, last) if one else range(last - 5)
        scene = await again(dut, delay=delay, ready=lambda clock, asleep=asleep: int(clock not in asleep))
        got = await scene.run(220)
        kept = last < first
        due = frames(*([] if kept else [1]))
        assert scene.out[5][0] == last and got == due[: len(got)] and len(got) >= 18, (last - first, one)
        assert counts(dut)["dropped"] == int(not kept), (last - first, one)
        met.add(kept)
    assert met == {True, False}


@bench.applies(wide)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_lost_strobe_around_the_other_samples(dut):
    """Of one converter and of both, at every clock from the one after the trigger to the latest: its samples
    are 0 and marked, the other's are right, the conversions around it are complete, and it is counted
    once."""
    await begin(dut)
    latest = SLOT - BEATS - 3
    for lanes in ((0,), (1,), (0, 1)):
        for at in range(1, latest + 1):
            lost = {(3, lane): at for lane in lanes}
            scene = await again(dut, delay=latest + 1 if len(lanes) == 1 else 2, lost=lost)
            got = await scene.run(170)
            due = [*frame(0, 0), *frame(1, 2, {3: lanes}), *frame(2, 4)]
            assert got[: len(due)] == due, (lanes, at)
            assert counts(dut)["lost"] == 1 and counts(dut)["dropped"] == 0
    for one, other in ((3, 9), (9, 3), (8, 9)):  # both lanes of one conversion, one after the other
        scene = await again(dut, lost={(3, 0): one, (3, 1): other})
        got = await scene.run(170)
        due = [*frame(0, 0), *frame(1, 2, {3: (0, 1)}), *frame(2, 4)]
        assert got[: len(due)] == due and counts(dut)["lost"] == 1
    for one, other in ((1, 2), (2, 1), (4, 9)):  # one lane each, in two consecutive conversions
        scene = await again(dut, delay=latest + 1, lost={(1, 0): one, (2, 1): other})
        got = await scene.run(170)
        due = [*frame(0, 0, {1: (0,)}), *frame(1, 2, {2: (1,)}), *frame(2, 4)]
        assert got[: len(due)] == due and counts(dut)["lost"] == 2


@bench.applies(wide)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def enable_falls_around_triggers(dut):
    """At every clock of a frame: that frame is complete, and no other follows, also if enable falls in the
    clock of the next frame's first switch."""
    await begin(dut)
    for enabled in range(45, 95):  # frame 1's first switch is in clock 44, frame 2's in 84
        scene = await again(dut, enabled=enabled)
        got = await scene.run(180)
        due = [*frame(0, 0), *frame(1, 2), *(frame(2, 4) if enabled > 84 else [])]
        assert got == due and len(scene.triggers) == len(due) // BEATS, enabled
        assert bench.read(dut.row_o) == 0


@bench.applies(wide)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_reset_in_every_clock_of_a_frame(dut):
    """Nothing of it leaves afterwards; the frames after it are complete, from number 0 on."""
    await begin(dut)
    for cut in range(TRIGGER + SLOT, TRIGGER + 3 * SLOT + 4):
        scene = await again(dut, ready=lambda clock: clock % 5 != 0)
        await scene.run(cut)
        scene = await again(dut)
        got = await scene.run(100)
        assert got == frames()[: len(got)] and len(got) >= 11, cut
        assert counts(dut)["lost"] == counts(dut)["dropped"] == 0


RING = {"Rows": 3, "Columns": 8, "Lanes": 1, "Channels": 2, "Cycle": 20, "SampleBits": 13, "Depth": 8}
RING |= {"SettleBits": 6, "PeriodBits": 16}


async def ring(dut, ready, clocks):
    """Clocks of trigger_o, the number of beats that left, the count held; ``ready``(clock, beats so far)."""
    SETTINGS(dut)
    dut.in_valid_i.value = 0
    await bench.reset(dut)
    await bench.clocks(dut, 5)
    triggers, out = [], []
    for clock in range(clocks):
        awake = ready(clock, len(out))
        SETTINGS(dut, enable=1)
        dut.out_ready_i.value = awake
        channel = clock - triggers[-1] - 2 if triggers else -1
        dut.in_valid_i.value = int(0 <= channel < 2)
        dut.in_data_i.value = 10 * len(triggers) + max(channel, 0)
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1 and awake:
            out.append((bench.read(dut.out_id_o), bench.read(dut.out_data_o)))
        if dut.trigger_o.value == 1:
            triggers.append(clock)
        await bench.RisingEdge(dut.clk_i)
    await bench.ReadOnly()
    held, dropped = counts(dut)["held"], counts(dut)["dropped"]
    await bench.RisingEdge(dut.clk_i)
    assert dropped == 0 and out == [(n % 24, 10 * (n // 2 + 1) + n % 2) for n in range(len(out))]
    return triggers, len(out), held


@bench.applies(lambda dut: not wide(dut))
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_consumer_wakes_around_a_switch_that_waits_for_room(dut):
    """A buffer of 8 beats for frames of 24, with conversions of two beats. Two beats wait downstream of it:
    after three conversions 4 beats are in it, only two more fit, and the scan waits. A beat that leaves makes
    room two clocks later: the fourth switch, due in clock 64, comes then. Each clock of waiting is
    counted."""
    await begin(dut)
    for awake in range(56, 76):
        triggers, left, held = await ring(dut, lambda clock, _, awake=awake: int(clock >= awake), 120)
        late = max(0, awake + 2 - 64)
        assert triggers[:5] == [7, 27, 47, 67 + late, 87 + late] and held == late, awake
        assert left >= 8
    # Once per frame, asleep for much longer than the buffer is deep, each time at another place of the ring.
    until = {}

    def ready(clock, left):
        if left % 24 == 9 + left // 24:
            until.setdefault(left, clock + 150)
        return int(clock >= max(until.values(), default=0))

    triggers, left, held = await ring(dut, ready, 2450)
    waits = [after - before - SLOT for before, after in itertools.pairwise(triggers)]
    assert len(until) == 7 and held == sum(waits) and left > 6 * 24
    assert sum(wait > 0 for wait in waits) == 7 and min(filter(None, waits)) > 80


@pytest.mark.parametrize("size", [SIZE, RING], ids=["whole", "ring"])
def test_scan_coincidences(size):
    bench.run("frontend", "scan", size, module="test_scan_coincidences")
