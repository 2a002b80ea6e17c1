"""msn_scan_buffer against its twin: frames of both orders through a follower that stalls or sleeps.

An incomplete frame is replaced by the next. Frames are kept or dropped as a whole: a frame is dropped, and
counted, exactly if a beat of the previous one is left a clock before it begins. The clock in which each beat
leaves; a ring smaller than a frame never overflows if the sender obeys room_o; reset.
"""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refusals
from meissner.twins.frontend.scan_buffer import LATENCY, ScanBuffer

FIELDS = ("data", "id", "last")


def twin_of(dut):
    names = ("Rows", "Beats", "Burst", "Width", "Depth")
    return ScanBuffer(*(getattr(dut, name).value.to_unsigned() for name in names))


def random_frame(draw, twin):
    return [draw.getrandbits(twin.width) for _ in range(twin.rows * twin.beats)], draw.random() < 0.5


async def start(dut):
    await bench.start(dut, **{f"in_{name}_i": 0 for name in ("first", "interleave", "data")})


class Bench:
    """Drives and watches the block clock by clock."""

    def __init__(self, dut, stall):
        self.dut, self.stall = dut, stall
        self.beats = []  # (clock, data, id, last)
        self.clock = 0
        self.held = None
        self.room = 0

    async def tick(self, word=None, frame=None):
        """One clock; ``word`` comes in, with ``frame`` if it is its frame's first. Returns taken_o."""
        dut = self.dut
        dut.in_valid_i.value = int(word is not None)
        dut.in_first_i.value = int(frame is not None)
        noise = random.getrandbits
        dut.in_data_i.value = word if word is not None else noise(len(dut.in_data_i))
        dut.in_interleave_i.value = int(frame[1]) if frame else noise(1)
        ready = not self.stall()
        dut.out_ready_i.value = int(ready)
        await ReadOnly()
        valid = dut.out_valid_o.value == 1
        assert valid or self.held is None, "valid was withdrawn"
        if valid:
            beat = tuple(bench.read(getattr(dut, f"out_{name}_o")) for name in FIELDS)
            assert self.held in (None, beat), "payload changed while stalled"
            self.held = None if ready else beat
            if ready:
                self.beats.append((self.clock, *beat))
        taken = int(dut.taken_o.value)
        self.room = int(dut.room_o.value)
        await RisingEdge(dut.clk_i)
        self.clock += 1
        return taken


def stalls(kind, draw):
    state = {"left": 0, "asleep": True}

    def sleeps():
        if not state["left"]:
            state["asleep"] = not state["asleep"]
            state["left"] = draw.randint(1, 60)
        state["left"] -= 1
        return state["asleep"]

    return {"ready": lambda: False, "stalls": lambda: draw.random() < 0.5, "sleeps": sleeps}[kind]


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    inputs = {f"in_{name}_i": 0 for name in ("interleave", "data")}
    await bench.turn_over(dut, "dropped_o", wiggled=["in_valid_i", "in_first_i"], again=False, **inputs)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    await bench.start(dut, in_interleave_i=0, in_data_i=0, in_first_i=0)
    await bench.counts_on(dut, "dropped_o", strobe="turned_away")


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(consumer=["ready", "stalls", "sleeps"])
async def matches_model(dut, consumer):
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    await start(dut)
    run = Bench(dut, stalls(consumer, draw))
    expected, dropped = [], 0
    for number in range(bench.rounds(80)):
        frame = random_frame(draw, twin)
        data = frame[0]
        gaps = draw.choice([0.0, 0.3, 0.9])
        for index, word in enumerate(data):
            while draw.random() < gaps or not run.room:
                await run.tick()
            at = run.clock
            before = len(run.beats)
            taken = await run.tick(word, frame if index == 0 else None)
            if index == 0:
                assert taken == (before == len(expected)), f"frame {number}, {before}"
                dropped += not taken
                if taken:
                    expected += twin.frame(*frame)
                stored = taken
            if consumer == "ready" and stored and len(data) == 1:
                for _ in range(LATENCY):
                    await run.tick()
                assert run.beats[-1][0] == at + LATENCY
        for _ in range(draw.choice([0, 1, 2, 3, len(data) + 5, 2 * len(data) + 40])):
            await run.tick()
    run.stall = lambda: False
    for _ in range(len(expected) + 10):
        await run.tick()
    assert [beat[1:] for beat in run.beats] == expected
    assert bench.read(dut.dropped_o) == dropped
    assert dropped > 0 or (consumer == "ready" and twin.rows * twin.beats == 1)
    assert len(expected) > 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def latency_is_the_twins(dut):
    """In natural order each beat leaves LATENCY clocks after it came, in every row."""
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    await start(dut)
    run = Bench(dut, lambda: False)
    for _ in range(5):
        data, _ = random_frame(draw, twin)
        came = []
        run.beats = []
        for index, word in enumerate(data):
            for _ in range(draw.choice([0, 0, 1, 5])):
                await run.tick()
            came.append(run.clock)
            await run.tick(word, (data, False) if index == 0 else None)
        for _ in range(LATENCY + 1):
            await run.tick()
        assert [beat[0] for beat in run.beats] == [clock + LATENCY for clock in came]


@bench.applies(lambda dut: twin_of(dut).rows % 2 == 0 and twin_of(dut).sorts)
@cocotb.test(timeout_time=50, timeout_unit="ms")
async def interleaved_rows_leave_as_soon_as_they_can(dut):
    """With an even number of rows both orders end with the last row: it leaves as it comes."""
    twin = twin_of(dut)
    beats = twin.beats
    await start(dut)
    run = Bench(dut, lambda: False)
    data = list(range(twin.rows * beats))
    data = [word & (1 << twin.width) - 1 for word in data]
    frame = (data, True)
    came = []
    for index, word in enumerate(data):
        for _ in range(beats):
            await run.tick()
        came.append(run.clock)
        await run.tick(word, frame if index == 0 else None)
    for _ in range(LATENCY + 1):
        await run.tick()
    assert [beat[1:] for beat in run.beats] == twin.frame(*frame)
    assert [beat[0] for beat in run.beats[-beats:]] == [clock + LATENCY for clock in came[-beats:]]
    assert [beat[0] for beat in run.beats[:beats]] == [clock + LATENCY for clock in came[:beats]]


@bench.applies(lambda dut: not twin_of(dut).sorts)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def room_ends_when_exactly_two_conversions_fit(dut):
    """Beats come slowly and the follower sleeps: one beat waits for it, outside the ring."""
    twin = twin_of(dut)
    await start(dut)
    run = Bench(dut, lambda: True)
    data, _ = random_frame(random.Random(bench.SEED), twin)
    last = dut.Depth.value.to_unsigned() - 2 * twin.burst + 1
    for count, word in enumerate(data[:last], 1):
        await run.tick(word, (data, False) if count == 1 else None)
        for _ in range(6):
            await run.tick()
        assert run.room == (count < last), count


@bench.applies(lambda dut: bench.whole(dut) and not twin_of(dut).sorts)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_upset_of_the_room_never_stops_the_scan(dut):
    """Each bit of the count of used places, between frames and inside one: a sender that obeys room_o ends
    the frame, and the next one is whole."""
    twin, draw = twin_of(dut), random.Random(bench.SEED)
    await start(dut)
    run = Bench(dut, lambda: False)
    used = dut.gen_part.used_q
    length = twin.rows * twin.beats
    for at in (None, 0, length // 2, length - 1):
        for bit in range(len(used)):
            for upset in (True, False):
                frame, run.beats = random_frame(draw, twin), []
                for _ in range(20):
                    await run.tick()
                for index, word in enumerate(frame[0]):
                    if upset and index == (at or 0):
                        used.value = bench.read(used) ^ 1 << bit
                        for _ in range(20 if at is None else 0):
                            await run.tick()
                    waited = 0
                    while not run.room:
                        await run.tick()
                        waited += 1
                        assert waited < 4 * twin.depth, (at, bit)
                    await run.tick(word, frame if index == 0 else None)
                for _ in range(length + 20):
                    await run.tick()
                assert [beat[1:] for beat in run.beats] == twin.frame(*frame), (at, bit, upset)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def two_conversions_fit_while_there_is_room(dut):
    """The sender checks room_o once, then sends two conversions; the follower takes a few beats now and
    then."""
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    burst = dut.Burst.value.to_unsigned()
    await start(dut)
    run = Bench(dut, lambda: run.clock % 50 < 44)
    for _ in range(12):
        frame = random_frame(draw, twin)
        run.beats = []
        for index, word in enumerate(frame[0]):
            if index % (2 * burst) == 0:
                for _ in range(3):
                    await run.tick()
                while not run.room:
                    await run.tick()
            await run.tick(word, frame if index == 0 else None)
        for _ in range(20 * len(frame[0]) + 100):
            await run.tick()
        assert [beat[1:] for beat in run.beats] == twin.frame(*frame)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def recovers_after_reset(dut):
    """Reset with half a frame inside: the rest of it must not count as a frame; the next frame is
    complete."""
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    await start(dut)
    run = Bench(dut, lambda: draw.random() < 0.3)
    for _ in range(12):
        frame = random_frame(draw, twin)
        cut = draw.randrange(len(frame[0]))
        for index, word in enumerate(frame[0]):
            if index == cut:
                await bench.reset(dut)
                run.held, run.beats = None, []
            while not run.room:
                await run.tick()
            await run.tick(word, frame if index == 0 and cut else None)
        for _ in range(2 * len(frame[0]) + 10):
            await run.tick()
        assert not run.beats
        for index, word in enumerate(frame[0]):
            while not run.room:
                await run.tick()
            await run.tick(word, frame if index == 0 else None)
        for _ in range(4 * len(frame[0]) + 30):
            await run.tick()
        assert [beat[1:] for beat in run.beats] == twin.frame(*frame)
        run.beats = []


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_frame_that_misses_a_beat_gives_way_to_the_next(dut):
    """Its beats leave, or are lost if the output stalls; an extra beat changes nothing."""
    twin = twin_of(dut)
    draw = random.Random(bench.SEED)
    await start(dut)
    asleep = False
    run = Bench(dut, lambda: asleep)

    async def send(frame, count, first=True):
        for index, word in enumerate(frame[0][:count]):
            while not run.room:
                await run.tick()
            taken = await run.tick(word, frame if first and index == 0 else None)
            assert taken == (first and index == 0)

    async def drain():
        for _ in range(twin.rows * twin.beats + 10):
            await run.tick()

    cuts = 0
    for number in range(40):
        cut, frame = random_frame(draw, twin), random_frame(draw, twin)
        count = draw.randrange(len(cut[0]))
        count = min(count, twin.burst) if not twin.sorts else count  # a ring needs free room while it sleeps
        if count:
            cuts += 1
            asleep = number % 3 == 2
            await send(cut, count)
            await (run.tick() if asleep else drain())
            asleep = False
            if number % 3 != 2:
                assert [beat[1:] for beat in run.beats] == twin.begun(cut[0][:count], cut[1])
            run.beats = []
        await send(frame, len(frame[0]))
        await drain()
        expected = twin.frame(*frame)
        if number % 3 == 2:
            run.beats = run.beats[-len(expected) :]
        assert [beat[1:] for beat in run.beats] == expected
        run.beats = []
        await send(cut, min(3, len(cut[0])), first=False)
        await drain()
        assert not run.beats
    assert bench.read(dut.dropped_o) == 0
    assert cuts or twin.rows * twin.beats == 1


EVIDENCE = {
    "equivalence": {"size": {"Rows": 5}},
    "faults": {"inside": ["scan_adc", "u_buffer."]},
}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Rows": 1, "Beats": 1, "Burst": 1, "Width": 5},
        {"Rows": 5, "Beats": 3, "Burst": 3, "Width": 18},
        {"Rows": 8, "Beats": 2, "Burst": 2, "Width": 9},
        {"Rows": 7, "Beats": 20, "Burst": 4, "Width": 9, "Depth": 16},
        {"Rows": 2, "Beats": 32, "Burst": 4, "Width": 12},
    ],
    ids=lambda p: "-".join(map(str, p.values())),
)
def test_scan_buffer(parameters):
    bench.run("frontend", "scan_buffer", parameters)


test_refuses_illegal_parameters = refusals(
    "scan_buffer", ScanBuffer, {"Rows": 0}, {"Width": 0}, *({"Depth": depth} for depth in (31, 16, 96))
)


def test_twin_of_a_whole_frame():
    twin = ScanBuffer(3, 2)
    assert twin.depth == 6 and twin.sorts
    came = [10, 11, 14, 15, 12, 13]  # rows 0, 2, 1
    beats = [(10 + index, index, index == 5) for index in range(6)]
    assert twin.frame(came, True) == beats and twin.frame([*range(10, 16)]) == beats
    assert twin.begun(came[:3], True) == beats[:2]
    assert twin.begun(came[:5], True) == beats[:3]
    assert twin.begun(came, True) == beats
    assert ScanBuffer(7, 5, 1, 18, 8).frame([*range(35)], True)[7] == (7, 7, False)  # a ring does not sort
    with pytest.raises(ValueError, match="3 rows of 2 beats has 6 words, not 5"):
        twin.frame([0] * 5)
