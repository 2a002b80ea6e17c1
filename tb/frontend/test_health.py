"""msn_health against its model: 1 x 1 to 64 x 64, all lane counts; samples that move, stay constant, jump,
stay at a rail, over-range on every sample; clears and reports at any beat; events not taken; damage, gaps,
stalls, resets, clocks. The model: no false alarm in 1e5 healthy frames, each fault found in N frames."""

import random
from itertools import pairwise

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, Timer

import bench
import members
from harness.refusals import refusals, refused
from meissner.twins.frontend.health import BLINKING, DEAD, RAILED, Health, Limits

FIELDS = ["data", "mask", "id", "fits", "row_last", "last"]
QUICK = {"band": 5, "jump": 30, "low": -900, "high": 900, "edges": True, "still": 12, "rail": 1, "blink": 30}


def twin_of(dut, limits):
    names = ("Rows", "Columns", "Lanes", "SampleBits")
    return Health(*(getattr(dut, name).value.to_unsigned() for name in names), limits)


def taxels(dut):
    return dut.Rows.value.to_unsigned() * dut.Columns.value.to_unsigned()


def settings_of(dut, limits):
    return members.Settings(dut, "health_cfg", **members.limits(limits))


def counts(dut):
    return members.of("health_status", bench.read(dut.status_o))


async def begin(dut, limits):
    """Reset with these limits; collect the events that are taken."""
    settings_of(dut, limits)
    await bench.start(dut, event_ready_i=1)
    twin = twin_of(dut, limits)
    events = []

    async def listen():
        edge, valid, ready = FallingEdge(dut.clk_i), dut.event_valid_o, dut.event_ready_i
        while True:
            await edge
            if bench.high(valid) and bench.high(ready):
                kinds = [getattr(dut, f"event_{name}_o") for name in ("id", "dead", "railed", "blinking")]
                events.append(tuple(bench.read(kind) for kind in kinds))

    return twin, events, cocotb.start_soon(listen())


async def begin_again(dut, limits, events):
    """Reset with other limits and discard earlier events; returns the twin."""
    settings_of(dut, limits)
    await bench.reset(dut)
    events.clear()
    return twin_of(dut, limits)


def expected_of(twin, beats):
    """The model's output beats and events for a stream of beats."""
    got, events = [], []
    for beat in beats:
        raw = bench.lane_values(beat["data"], twin.lanes, twin.sample_bits, signed=True)
        over = bench.lane_values(beat["user"], twin.lanes, 1)
        mask, news = twin.beat(raw, over, beat["id"], beat["last"], beat["fits"])
        events += news
        marks = {name: int(beat[name]) for name in ("id", "fits", "row_last", "last")}
        got.append({"data": beat["data"], "mask": bench.lane_word(mask, 1)} | marks)
    return got, events


def frames_of(rng, twin, count):
    """Beats of frames in which blocks of taxels move together, and some have faults that come and go."""
    shape = (count, twin.rows, twin.columns)
    steps = rng.choice([0, 0, 0, 9, -9, 60, -60], (count, 1, 1)) * (np.arange(count)[:, None, None] % 32 < 16)
    level = np.cumsum(steps, axis=0) * np.ones(shape)
    single = rng.random(shape[1:]) < 0.15  # these move independently
    level = np.where(single, np.cumsum(rng.choice([0, 0, 0, 8, -8, 31, -31], shape), axis=0), level)
    still = rng.random(shape[1:]) < 0.2
    level = np.where(still, 7, level)
    rails = rng.random(shape[1:]) < 0.1
    if min(shape[1:]) > 2:  # at least one of each fault, with neighbours that move around the dead one
        single[1, :3], still[1, :3], rails[1, :3] = False, (False, True, False), False
        single[0, 0], still[0, 0], rails[0, 0] = True, False, False
        rails[2, 2] = True
    railed = rails & (np.arange(count)[:, None, None] % 64 < 50)
    level = np.where(railed, rng.choice([-900, 900, -901, 65535, -65536, 899], shape[1:]), level)
    low, high = bench.width(twin.sample_bits)
    x = np.clip(level + rng.integers(-2, 3, shape), low, high).astype(np.int64)
    return bench.lane_beats(x, twin.lanes, twin.sample_bits, surplus=high, user=rng.random(shape) < 0.02)


async def counts_are(dut, twin):
    await bench.clocks(dut, 12)
    assert counts(dut) == {name: getattr(twin, name) for name in ("dead", "railed", "blinking")}


async def agrees(dut, twin, beats, events):
    """The output for ``beats``, the counters after them and the events so far must be the twin's."""
    expected, news = expected_of(twin, beats)
    assert await bench.stream(dut, beats, FIELDS) == expected
    await counts_are(dut, twin)
    assert events == news


async def clear(dut, twin):
    """Request for one clock that all faults be cleared."""
    await settings_of(dut, twin.limits).pulse(dut.clk_i, clear=1)


async def passed(dut, frames):
    """Wait for ``frames`` frames of one taxel, 10 clocks each, up to a clock edge, where inputs change."""
    await Timer(100 * frames - 5, "ns")
    await bench.RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4], damage=[False, True])
async def matches_model(dut, stall_rate, damage):
    """Pieces of a stream, cut at any beat, with a command after each."""
    rng, draw = np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    twin, events, listener = await begin(dut, Limits(**QUICK, over_range_enable=not damage))
    length = twin.rows * twin.row_beats
    pauses = bench.gaps_and_stalls(stall_rate)
    beats = frames_of(rng, twin, 300 if length < 50 else 40 if length < 100 else 8)
    if damage:
        beats = bench.placed(bench.damage(beats, length, draw), twin.rows, twin.row_beats)
    expected_events, most, at = [], np.zeros(3, dtype=int), 0
    while at < len(beats):
        piece = beats[at : at + draw.randint(1, 1 + 40 * length)]
        at += len(piece)
        expected, news = expected_of(twin, piece)
        got = await bench.stream(dut, piece, FIELDS, *pauses, drain=3)
        assert got == expected
        assert all(beat["mask"] == (1 << twin.lanes) - 1 for beat in got if not beat["fits"])
        expected_events += news
        if not twin._midway:  # the model updates at the end of a frame
            await counts_are(dut, twin)
            assert events == expected_events
        assert events[: len(expected_events)] == expected_events
        most = np.maximum(most, [twin.dead, twin.railed, twin.blinking])
        command = draw.choice(["none", "none", "report", "clear"])
        if command != "none":
            await settings_of(dut, twin.limits).pulse(dut.clk_i, **{command: 1})
            getattr(twin, command)()
    if min(twin.rows, twin.columns) > 2 and length < 100:  # where frames_of provides each fault
        assert most.all(), f"never found: {most}"
    listener.cancel()


@bench.applies(lambda dut: taxels(dut) <= 500)
@cocotb.test(timeout_time=40, timeout_unit="ms")
async def no_event_is_lost_that_nobody_takes(dut):
    """If events are taken only now and then, every fault is still reported, as often as without stalls."""
    rng, draw = np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    twin, events, listener = await begin(dut, Limits(**QUICK))

    async def reluctant():
        while True:
            await bench.RisingEdge(dut.clk_i)
            dut.event_ready_i.value = int(draw.random() < 0.03)

    slow = cocotb.start_soon(reluctant())
    beats = frames_of(rng, twin, 100)
    await bench.stream(dut, beats, FIELDS)
    expected_of(twin, beats)
    slow.cancel()
    dut.event_ready_i.value = 1
    still = beats[-twin.rows * twin.row_beats :] * 3
    await bench.stream(dut, still, FIELDS)
    expected_of(twin, still)
    padded = np.zeros((twin.rows, twin.row_beats * twin.lanes), dtype=int)
    padded[:, : twin.columns] = twin.faults
    told = np.zeros_like(padded).reshape(-1, twin.lanes)
    for beat, *kinds in events:
        words = [bench.lane_values(word, twin.lanes, 1) for word in kinds]
        told[beat] |= np.array(words).T @ [DEAD, RAILED, BLINKING]
    assert np.array_equal(told, padded.reshape(-1, twin.lanes))
    listener.cancel()


@bench.applies(lambda dut: taxels(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def over_range_on_every_sample(dut):
    """All railed after exactly the stated number of frames; an event for each; a clear resets all of them."""
    limits = Limits(**QUICK | {"low": -65536, "high": 65535}, over_range_enable=True)
    twin, events, listener = await begin(dut, limits)
    x = np.full((36, twin.rows, twin.columns), 40)
    beats = bench.lane_beats(x, twin.lanes, twin.sample_bits, user=np.ones(x.shape))
    length = twin.rows * twin.row_beats
    got = await bench.stream(dut, beats, FIELDS)
    assert got == expected_of(twin, beats)[0]
    first = next(n for n, beat in enumerate(got) if beat["mask"])
    assert first == 17 * length
    assert counts(dut)["railed"] == twin.rows * twin.columns
    assert len(events) == length
    await clear(dut, twin)
    got = await bench.stream(dut, beats[:length], FIELDS)
    assert not any(beat["mask"] for beat in got)
    assert counts(dut)["railed"] == 0
    listener.cancel()


@bench.applies(lambda dut: taxels(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def limits_of_every_size(dut):
    """Each bit of each limit, all and none, with samples over the full range."""
    rng = np.random.default_rng(bench.SEED)
    twin, events, listener = await begin(dut, Limits(**QUICK))
    low, high = bench.width(twin.sample_bits)
    shape = (80, twin.rows, twin.columns)
    for ones in (0x55555, 0xAAAAA, 0xFFFFF, 0):
        bits = min(17, twin.sample_bits)  # of a register
        code = ones & (1 << bits) - 1
        ends = {"low": bench.as_signed(code ^ (1 << bits) - 1, bits), "high": bench.as_signed(code, bits)}
        counts = dict.fromkeys(("still", "rail", "blink"), ones & 255)
        limits = Limits(code, code, **ends, over_range_enable=bool(ones & 1), edges=bool(ones & 2), **counts)
        twin = await begin_again(dut, limits, events)
        x = np.where(rng.random(shape) < 0.05, rng.integers(low, high + 1, shape), 0)
        x += rng.choice([low, 0, high], (80, 1, 1)) * (rng.random(shape[1:]) < 0.6)
        beats = bench.lane_beats(
            np.clip(x, low, high), twin.lanes, twin.sample_bits, user=rng.random(shape) < 0.9
        )
        await agrees(dut, twin, beats, events)
    listener.cancel()


@bench.applies(lambda dut: 4 < taxels(dut) < 50)
@cocotb.test(timeout_time=40, timeout_unit="ms")
async def limits_that_counters_come_by(dut):
    """Small counts, some with single bits, and jumps from the first frame on: each count is met step by
    step."""
    rng = np.random.default_rng(bench.SEED)
    twin, events, listener = await begin(dut, Limits(**QUICK))
    for rail, blink, still in ((2, 17, 8), (1, 2, 16), (3, 33, 3), (6, 16, 11), (4, 48, 2)):
        limits = Limits(**QUICK | {"rail": rail, "blink": blink, "still": still}, over_range_enable=True)
        twin = await begin_again(dut, limits, events)
        frames = 120
        # Some taxels blink alone; those around them move up and down together.
        x = np.cumsum(rng.choice([0, 0, 9, -9], (frames, 1, twin.columns)), axis=0)
        x = x + rng.integers(-2, 3, (frames, twin.rows, twin.columns))
        x[:, rng.random((twin.rows, twin.columns)) < 0.3] //= 8
        jumps = rng.random((twin.rows, twin.columns)) < 0.3
        x = np.where(jumps, rng.choice([0, 31, 60], x.shape) * (rng.random(x.shape) < 0.7), x)
        over = rng.random((twin.rows, twin.columns)) < 0.3
        beats = bench.lane_beats(x, twin.lanes, twin.sample_bits, user=np.broadcast_to(over, x.shape))
        await agrees(dut, twin, beats, events)
        assert twin.railed and (twin.blinking or twin.dead)
    listener.cancel()


@bench.applies(lambda dut: taxels(dut) == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_rail_counts_to_its_end_and_stays(dut):
    """Over-range for longer than the greatest limit, up to where the counter saturates; then again from 0."""
    twin, _, listener = await begin(dut, Limits(**QUICK | {"rail": 0}, over_range_enable=True))
    listener.cancel()
    frames = 16 * 260
    over = np.ones((frames, 1, 1), dtype=bool)
    twin.next(over * 40, over)
    bench.offer(dut, {"data": 40, "user": 1, "id": 0, **bench.marks(0, 1, 1)})
    dut.in_valid_i.value = dut.out_ready_i.value = 1
    await passed(dut, frames)
    assert counts(dut)["railed"] == twin.railed == 0
    twin.limits.rail = 255
    settings_of(dut, twin.limits)
    twin.next(over[:1] * 40, over[:1])
    await passed(dut, 2)
    assert counts(dut)["railed"] == twin.railed == 1
    await clear(dut, twin)
    twin.clear()
    twin.next(over[:40] * 40, over[:40])
    await passed(dut, 40)
    assert counts(dut)["railed"] == twin.railed == 0


@bench.applies(lambda dut: min(dut.Rows.value.to_unsigned(), dut.Columns.value.to_unsigned()) >= 4)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def every_taxel_has_every_fault(dut):
    """The fields of a chessboard jump in turn, columns move in turn, then all are at a rail; a clear resets
    all."""
    limits = Limits(**QUICK | {"still": 1, "blink": 1})
    twin, _, listener = await begin(dut, limits)
    listener.cancel()
    i, j = np.indices((twin.rows, twin.columns))
    x = np.zeros((17, twin.rows, twin.columns), dtype=int)
    for frame, who, step in ((1, i + j, 60), (5, i + j + 1, 60), (8, j, 9), (12, j + 1, 9), (16, 0 * i, 900)):
        x[frame:] += np.where(who % 2 == 0, step, 0)
    beats = bench.lane_beats(x, twin.lanes, twin.sample_bits, user=0 * x)
    assert await bench.stream(dut, beats, FIELDS) == expected_of(twin, beats)[0]
    await counts_are(dut, twin)
    assert twin.dead == twin.railed == twin.blinking == i.size
    await clear(dut, twin)
    twin.clear()
    await counts_are(dut, twin)
    assert twin.dead == twin.railed == twin.blinking == 0


@bench.applies(lambda dut: taxels(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    rng = np.random.default_rng(bench.SEED)
    twin, events, listener = await begin(dut, Limits(**QUICK))
    length = twin.rows * twin.row_beats
    beats = frames_of(rng, twin, 40)
    for cut in (1, 30 * length + length // 2, 39 * length):
        settings = settings_of(dut, twin.limits)
        settings.put(clear=cut % 2, report=cut % 2)
        await bench.stream(dut, beats[:cut], FIELDS, drain=0)
        settings.put(clear=0, report=0)
        await bench.reset(dut)
        events.clear()
        twin.reset()
        twin._beats = []
        await agrees(dut, twin, beats, events)
    listener.cancel()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """A beat a clock inside a frame, each out a clock later; 9 clocks between frames."""
    rng = np.random.default_rng(bench.SEED)
    twin, _, listener = await begin(dut, Limits(**QUICK))
    length = twin.rows * twin.row_beats
    dut.out_ready_i.value = 1
    await bench.clocks(dut, 12)
    beats = frames_of(rng, twin, 3)
    taken, left, clock = [], [], 0
    while len(left) < len(beats):
        for name, value in beats[min(len(taken), len(beats) - 1)].items():
            getattr(dut, f"in_{name}_i").value = int(value)
        dut.in_valid_i.value = int(len(taken) < len(beats))
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1:
            left.append(clock)
        if len(taken) < len(beats) and dut.in_ready_o.value == 1:
            taken.append(clock)
        clock += 1
        await bench.RisingEdge(dut.clk_i)
    assert left == [clock + 1 for clock in taken]
    gaps = [after - before for before, after in pairwise(taken)]
    assert gaps == [10 if (n + 1) % length == 0 else 1 for n in range(len(gaps))]
    listener.cancel()


EVIDENCE = {
    "equivalence": {"size": {"Columns": 3}, "defined": True, "boxes": True},
    "faults": {
        "size": {"Rows": 3, "Columns": 3},
        "settle": 40,
        "driver": {
            # It counts frames; an entirely missing frame cannot be noticed here.
            "skip": "gone",
            # An event that is not taken immediately comes with the next frame.
            "ready": "event_",
            # The state of a taxel.
            "kept": "state u_row. u_up. u_down. gen_lane out_data_o head ahead behind here "
            "write learn place row_first top bottom u_taxel. tick asked bank fresh again drain "
            "was_whole",
        },
    },
}


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits",
    [
        (1, 1, 1, 17),
        (2, 1, 2, 17),
        (3, 3, 1, 17),
        (4, 5, 2, 17),
        (3, 19, 8, 18),
        (7, 6, 4, 12),
        (4, 10, 3, 17),
        (64, 64, 8, 17),
    ],
)
def test_health(rows, columns, lanes, sample_bits):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": sample_bits}
    bench.run("frontend", "health", size)


@pytest.mark.parametrize("rows, columns, lanes", [(3, 5, 2), (1, 3, 1), (3, 5, 3)])
def test_health_by_hand(rows, columns, lanes):
    """Against literals and a plain loop instead of the model: frontend/health_by_hand.py."""
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": 17}
    bench.run("frontend", "health", size, module="health_by_hand")


def contacts(rng, size, frames, noise):
    """Chunks of frames of a healthy array pressed at random places: bumps that rise, stay, may slide, and
    fall.

    ``noise``: codes rms, before rounding. Every taxel has its own zero and gain.
    """
    i, j = np.indices((size, size))
    zero, gain = rng.integers(300, 900, (size, size)), rng.uniform(0.7, 1.3, (size, size))
    while frames > 0:
        ramp, hold, gap = rng.integers(3, 30), rng.integers(5, 80), rng.integers(3, 30)
        count = min(frames, 2 * ramp + hold + gap)
        t = np.arange(count)
        force = np.interp(t, [0, ramp, ramp + hold, 2 * ramp + hold], [0, 1, 1, 0]) * rng.uniform(800, 8000)
        (row, column), radius = rng.uniform(-0.5, size - 0.5, 2), rng.uniform(1.2, 4)
        slide = rng.uniform(-0.02, 0.02, (2, 1, 1, 1)) * t[:, None, None] * (rng.random() < 0.5)
        squares = (i - row - slide[0]) ** 2 + (j - column - slide[1]) ** 2
        press = gain * force[:, None, None] * np.exp(-squares / (2 * radius**2))
        yield np.rint(zero + press + noise * rng.standard_normal(press.shape)).astype(np.int64)
        frames -= count


@pytest.mark.parametrize("noise, frames", [(2.0, 50_000), (0.0, 20_000)])
def test_no_false_report_in_healthy_frames(noise, frames):
    """With noise of 2 codes rms; and with a noise-free converter, whose unpressed taxels never move."""
    twin = Health(12, 12)
    seen = 0
    for chunk in contacts(np.random.default_rng(bench.SEED), 12, frames, noise):
        masks, events = twin.next(chunk)
        assert not masks.any() and not any(events), f"frame {seen}"
        seen += len(chunk)
    assert seen == frames
    assert (twin.dead, twin.railed, twin.blinking) == (0, 0, 0)


def test_an_idle_array_without_noise_is_healthy():
    twin = Health(4, 4)
    masks, _ = twin.next(np.broadcast_to(np.arange(16).reshape(4, 4), (3000, 4, 4)))
    assert not masks.any()


# Place, fault type that must be reported, and the number N of frames within which it must be.
FAULTS = {
    "dead": ((6, 5), DEAD, 1000),
    "dead, at a corner": ((0, 0), DEAD, 5000),
    "stuck high": ((3, 8), DEAD, 1000),
    "dead row": ((7, slice(None)), DEAD, 2000),
    "open column": ((slice(None), 4), DEAD, 2000),
    "saturated": ((2, 2), RAILED, 144),
    "grounded row": ((9, slice(None)), RAILED, 144),
    "blinking": ((8, 3), BLINKING, 500),
}


def inject(kind, frames, where, rng):
    """The frames with this fault added."""
    frames = frames.copy()
    at = (slice(None), *where)
    noise = np.rint(rng.normal(0, 2, frames[at].shape)).astype(np.int64)
    if kind.startswith(("dead", "open")):
        frames[at] = 500 + noise
    elif kind == "stuck high":
        frames[at] = 7777
    elif kind == "saturated":
        frames[at] = 65535
    elif kind == "grounded row":
        frames[at] = 0
    else:
        frames[at] = np.where(rng.random(frames[at].shape) < 0.2, 0, frames[at])
    return frames


def frames_until_found(kind, seed, healthy=200):
    """Frames from the begin of the fault until all its taxels are found; no other taxel may ever be."""
    where, fault, limit = FAULTS[kind]
    rng = np.random.default_rng(seed)
    twin = Health(12, 12, limits=Limits(low=0))
    wanted = np.zeros((12, 12), dtype=bool)
    wanted[where] = True
    begun = -healthy
    for chunk in contacts(rng, 12, healthy + limit, 2.0):
        before = max(0, min(len(chunk), -begun))
        twin.next(chunk[:before])
        for frame, picture in enumerate(inject(kind, chunk[before:], where, rng)):
            twin.next(picture[None])
            assert not twin.faults[~wanted].any()
            if (twin.faults[wanted] & fault).all():
                return begun + before + frame + 1
        begun += len(chunk)
    raise AssertionError(
        f"{(twin.faults[wanted] & fault == 0).sum()} not found in {limit} frames, seed {seed}"
    )


@pytest.mark.parametrize("kind", FAULTS)
def test_every_fault_is_found(kind):
    """Within N frames of its begin, all of its taxels and no other, on an array pressed all over."""
    print(f"{kind}: found after {[frames_until_found(kind, seed) for seed in range(1, 9)]} frames")


def test_model_in_frames_and_beats():
    rng = np.random.default_rng(5)
    one, other = Health(4, 5, 2, limits=Limits(**QUICK)), Health(4, 5, 2, limits=Limits(**QUICK))
    beats = frames_of(rng, one, 80)
    got, events = expected_of(one, beats)
    raw = np.array([bench.lane_values(beat["data"], 2, 17, signed=True) for beat in beats])
    over = np.array([bench.lane_values(beat["user"], 2, 1) for beat in beats])
    raw, over = (a.reshape(80, 4, 6)[:, :, :5] for a in (raw, over))
    masks, whole_events = other.process(raw, over)
    lanes = np.array([bench.lane_values(beat["mask"], 2, 1) for beat in got])
    assert np.array_equal(lanes.reshape(80, 4, 6)[:, :, :5], masks)
    assert events == [event for frame in whole_events for event in frame] != []


test_refuses_illegal_parameters = refusals(
    "health", Health, *({"Rows": 0}, {"Columns": 1025}, {"Lanes": 9}, {"SampleBits": 19}), rows=2, columns=2
)


def test_refuses_limits_beyond_a_register():
    refused(Limits, {"still": 256})
