"""msn_tare against its model: 1 x 1 to 64 x 64, all lane counts; zeros following up and down, with contact
and without; averaging requested at any beat, refused while pressed, forced, cut by damage; zeros loaded while
frames come; masks; samples at both ends of the range; gaps and stalls; resets; clocks. The model against
exact sums, and over an hour of drift: a held load is kept, a free taxel's zero follows."""

import random
from fractions import Fraction
from itertools import pairwise

import cocotb
import numpy as np
import pytest

import bench
import members
from harness.refusals import refusals, refused
from meissner.twins.cop.cop import cop
from meissner.twins.frontend.calibrate import forces
from meissner.twins.frontend.tare import Tare

FIELDS = ["data", "mask", "id", "fits", "row_last", "last"]


def twin_of(dut, **settings):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "FractionBits", "TareLog2")
    return Tare(*(getattr(dut, name).value.to_unsigned() for name in names), **settings)


def length_of(twin):
    return twin.rows * twin.row_beats


def expected_of(twin, beats):
    """The model's output for a stream of beats."""
    got = []
    for beat in beats:
        raw = bench.lane_values(beat["data"], twin.lanes, twin.sample_bits, signed=True)
        mask = bench.lane_values(beat["mask"], twin.lanes, 1)
        r = twin.beat(raw, beat["id"], beat["last"], mask, beat["fits"])
        if r is not None:
            marks = {name: int(beat[name]) for name in ("mask", "id", "fits", "row_last", "last")}
            got.append({"data": bench.lane_word(r, twin.sample_bits + 1)} | marks)
    return got


def frames_of(rng, twin, count, press=0.5):
    """Beats of frames whose taxels vary around a level, with a contact in a share ``press`` of the frames."""
    shape = (count, twin.rows, twin.columns)
    low, high = bench.width(twin.sample_bits)
    level = rng.choice([0, 300, low, high, -3], shape[1:]) * np.ones(shape, dtype=np.int64)
    x = level + rng.integers(-6, 7, shape)
    touched = (rng.random(shape) < 0.2) & (rng.random((count, 1, 1)) < press)
    x = np.where(touched, x + rng.choice([twin.contact, twin.contact + 1, 9 * twin.contact], shape), x)
    mask = rng.random(shape) < 0.1
    return bench.lane_beats(np.clip(x, low, high), twin.lanes, twin.sample_bits, high, mask=mask)


async def begin(dut, **inputs):
    """Reset with the settings given by ``contact`` and ``step``, others 0."""
    settings = members.Settings(dut, "tare_cfg", **inputs)
    await bench.start(dut, start_i=0)
    return settings


async def status_is(dut, twin):
    await bench.clocks(dut, 12)
    found = {
        name.removeprefix("state_"): n
        for name, n in members.of("tare_status", bench.read(dut.status_o)).items()
    }
    assert found == {name: int(getattr(twin, name)) for name in found}


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "swallowed_count", wraps=False)


@bench.applies(lambda dut: length_of(twin_of(dut)) < 100 and bench.whole(dut))
@cocotb.test(timeout_time=40, timeout_unit="ms")
async def each_counter_counts_from_any_value(dut):
    """An averaging that is done, one that is refused because something presses, a frame that is swallowed."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    settings = await begin(dut, contact=20, step=0)
    quiet = [beat | {"data": 0} for beat in frames_of(rng, twin, 1, press=0)]
    pressed = [
        beat | {"data": bench.lane_word([99] * twin.lanes, twin.sample_bits), "mask": 0} for beat in quiet
    ]
    length = quiet * (2 << twin.tare_log2)
    for name, beats, change in (
        ("tared", length, {"average": 1}),
        ("refused", pressed * 2, {"average": 1}),
        ("swallowed", quiet, {"load": 1}),
    ):
        port = getattr(dut, f"{name}_count")
        for start in bench.carries(port):
            await bench.stream(dut, quiet if name == "tared" else pressed, FIELDS, drain=12)
            port.value = start
            if name == "swallowed":
                settings.put(**change)
                await bench.clocks(dut, 2)
            else:
                await settings.pulse(dut.clk_i, **change)
            await bench.stream(dut, beats, FIELDS, drain=12)
            found = members.of("tare_status", bench.read(dut.status_o))
            assert found[name] == (start + 1) % (1 << len(port)), (name, start, found)
            settings.put(load=0)


@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4], damage=[False, True])
async def matches_model(dut, stall_rate, damage):
    """Pieces of a stream, cut at any beat, with a command after each."""
    rng, draw = np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    twin = twin_of(dut, contact=20, step=37)
    length = length_of(twin)
    settings = await begin(dut, contact=20, step=37)
    pauses = bench.gaps_and_stalls(stall_rate)
    count = 160 if length < 100 else 12
    if twin.tare_log2 > 4:
        count *= 4
    beats = frames_of(rng, twin, count // 2, press=0.05) + frames_of(rng, twin, count // 4)
    beats += frames_of(rng, twin, count // 4, press=0)
    if damage:
        beats = bench.placed(bench.damage(beats, length, draw), twin.rows, twin.row_beats)
    at = 0
    while at < len(beats):
        piece = beats[at : at + draw.randint(1, 1 + 4 * length)]
        at += len(piece)
        got = await bench.stream(dut, piece, FIELDS, *pauses, drain=3)
        assert got == expected_of(twin, piece)
        assert not any(beat["data"] for beat in got if not beat["fits"])
        await status_is(dut, twin)
        what = draw.choice(["none", "tare", "tare", "force", "load"])
        if what in ("tare", "force"):
            await settings.pulse(dut.clk_i, average=1, force=what == "force")
            twin.tare(what == "force")
        elif what == "load":
            every = twin._fresh  # the memory is still empty, so all of it must be written
            settings.put(load=1)
            twin.load(True)
            await bench.clocks(dut, 1)  # a beat may still be taken in this clock
            piece = beats[at : at + draw.randint(0, 2 * length)]
            at += len(piece)
            got = await bench.stream(dut, piece, FIELDS, *pauses, drain=3)
            assert got == expected_of(twin, piece)
            await status_is(dut, twin)
            for word in range(length) if every or length < 99 else draw.sample(range(length), 4):
                lanes = draw.randrange(1, 1 << twin.lanes) if not every else (1 << twin.lanes) - 1
                offset = draw.choice([*bench.width(twin.sample_bits), draw.randint(-99, 999)])
                bits = [lane for lane in range(twin.lanes) if lanes >> lane & 1]
                for write, which in ((1, [0]), (lanes, bits)):
                    await settings.pulse(dut.clk_i, word=word, zero=offset, write=write, write_written=1)
                    twin.write(word, offset, which)
                beyond = 1 << twin.rows * twin.row_beats.bit_length()  # no such word, but word 0's low bits
                for word_ in (length, min(beyond, (1 << 20) - 1)):
                    await settings.pulse(dut.clk_i, word=word_, zero=-5, write=255, write_written=1)
            settings.put(load=0)
            twin.load(False)
            await bench.clocks(dut, 2)
    if not damage and 1 < length < 100:
        assert twin.tared > 0 and twin.refused > 0 and twin.swallowed > 0


@bench.applies(lambda dut: length_of(twin_of(dut)) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def settings_of_every_size(dut):
    """Each bit of both settings, and none; a load request of a single clock does not start loading."""
    rng = np.random.default_rng(bench.SEED)
    settings = await begin(dut)
    for ones in (0x55555, 0xAAAAA, 0):
        twin = twin_of(
            dut,
            contact=ones & (1 << min(17, len(dut.in_data_i) // dut.Lanes.value.to_unsigned())) - 1,
            step=ones & 255,
        )
        settings.put(contact=twin.contact, step=twin.step)
        await bench.reset(dut)
        await settings.pulse(dut.clk_i, load=1)
        low, high = bench.width(twin.sample_bits)
        x = rng.choice([low, -1, 0, 40, twin.contact - 3, high], (12, twin.rows, twin.columns))
        beats = bench.lane_beats(np.minimum(x, high), twin.lanes, twin.sample_bits, mask=0 * x)
        assert await bench.stream(dut, beats, FIELDS) == expected_of(twin, beats)
        await status_is(dut, twin)


@bench.applies(lambda dut: length_of(twin_of(dut)) <= 500)
@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(up=[True, False])
async def every_bit_of_a_zero_counts(dut, up):
    """Zeros that follow in steps of any size to exactly half a code, or to one LSB short of it or beyond.

    Between two steps come frames that must move none: taxels at their zero, just pressed, averaged. The
    unused lanes beside the array are always pressed.
    """
    rng, draw = np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    twin = twin_of(dut)
    settings = await begin(dut)
    sign, frames = 1 if up else -1, 1 << twin.tare_log2
    part = frames // 2 - sign if frames > 1 else 0
    high = bench.width(twin.sample_bits)[1]

    async def frame(x, step, beside=high):
        twin.step = step
        settings.put(step=step)
        beats = bench.lane_beats(x[None], twin.lanes, twin.sample_bits, beside, mask=0 * x[None])
        assert await bench.stream(dut, beats, FIELDS, drain=12) == expected_of(twin, beats)

    for turn in range(6 if frames <= 16 else 2):
        twin.contact = contact = draw.getrandbits(13) | 2
        settings.put(contact=contact)
        level = rng.integers(-300, 300, (twin.rows, twin.columns))
        rest = level + (not up and frames > 1)
        moves = [1, contact] if up else [-1, -5000]
        await bench.reset(dut)
        twin.reset()
        await settings.pulse(dut.clk_i, average=1, force=1)
        twin.tare(True)
        for place in range(frames + 1):
            await frame(level + (place < part), draw.randrange(256), beside=0)
        assert twin.tared == 1 and not twin.pressed
        way = (1 << twin.fraction_bits - max(twin.tare_log2, 1)) - sign * (turn % 2)
        while way:
            step = min(way, draw.randint(1, 255))
            await frame(rest + rng.choice(moves, level.shape), step)
            assert not twin.pressed
            way -= step
            still = rng.choice([0, 0, 0, contact + 1], level.shape)
            await frame(rest + still, draw.randrange(256))
        await frame(level, 0)
        await status_is(dut, twin)


@bench.applies(lambda dut: length_of(twin_of(dut)) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    rng = np.random.default_rng(bench.SEED)
    twin = twin_of(dut, contact=20, step=255)
    length = length_of(twin)
    settings = await begin(dut, contact=20, step=255)
    beats = frames_of(rng, twin, 2 + (1 << twin.tare_log2), press=0)
    for cut in (1, length, length * (2 + (1 << twin.tare_log2) // 2) - length // 2):
        await settings.pulse(dut.clk_i, average=1, force=1)
        await bench.stream(dut, beats[:cut], FIELDS, drain=0)
        await bench.reset(dut)
        twin.reset()
        assert await bench.stream(dut, beats, FIELDS) == expected_of(twin, beats)
        await status_is(dut, twin)
        assert twin.tared == twin.refused == 0


@bench.applies(lambda dut: length_of(twin_of(dut)) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_start_asks_for_the_first_tare(dut):
    """With at_start it averages in spite of a contact, without it the start has no effect."""
    settings = await begin(dut, contact=20, step=1)
    for at_start in (1, 0):
        await bench.reset(dut)
        twin = twin_of(dut, contact=20, step=1)
        settings.put(at_start=at_start)
        dut.start_i.value = 1
        await bench.RisingEdge(dut.clk_i)
        dut.start_i.value = 0
        if at_start:
            twin.tare(True)
        x = np.full(((1 << twin.tare_log2) + 2, twin.rows, twin.columns), 400)
        beats = bench.lane_beats(x, twin.lanes, twin.sample_bits, mask=0 * x)
        assert await bench.stream(dut, beats, FIELDS) == expected_of(twin, beats)
        await status_is(dut, twin)
        assert twin.tared == at_start


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """A beat a clock inside a frame, each out a clock later; 8 clocks between frames."""
    rng = np.random.default_rng(bench.SEED)
    twin = twin_of(dut)
    length = length_of(twin)
    await begin(dut, contact=64, step=1)
    dut.out_ready_i.value = 1
    await bench.clocks(dut, 10)
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
    assert gaps == [9 if (n + 1) % length == 0 else 1 for n in range(len(gaps))]


@bench.applies(lambda dut: 1 < length_of(twin_of(dut)) < 10)
@cocotb.test(timeout_time=40, timeout_unit="ms")
async def a_contact_inside_a_damaged_frame_is_forgotten(dut):
    """Wherever the frame breaks off: the averaging starts again and is not refused."""
    twin, settings = twin_of(dut, contact=20), await begin(dut, contact=20)
    length = length_of(twin)
    x = np.full((1, twin.rows, twin.columns), 9)
    still = bench.lane_beats(x, twin.lanes, twin.sample_bits, mask=0 * x)
    pressed = bench.lane_beats(x + 500, twin.lanes, twin.sample_bits, mask=0 * x)
    for cut in range(1, length):
        await bench.reset(dut)
        twin.reset()
        await settings.pulse(dut.clk_i, average=1)
        twin.tare()
        broken = [beat | {"last": place == cut - 1} for place, beat in enumerate(pressed[:cut])]
        beats = bench.placed(still + broken + still * (2 + (1 << twin.tare_log2)), twin.rows, twin.row_beats)
        assert await bench.stream(dut, beats, FIELDS) == expected_of(twin, beats)
        await status_is(dut, twin)
        assert (twin.tared, twin.refused) == (1, 0), cut


EVIDENCE = {
    "equivalence": {"size": {"Columns": 5}, "defined": True, "boxes": True},
    "faults": {
        "size": {"Rows": 3, "Columns": 3},
        "settle": 6,
        "driver": {
            # The stored words and everything on the way to them, including a frame of an averaging.
            "kept": "fresh u_state. u_round. zero_ sum_ write learn place_q loading "
            "drain frames averaging commit forced asked dropping contact nonzero "
            "over_q negative mask_q seen",
            # A frame that is missing in the words.
            "skip": "gone",
        },
    },
}


@pytest.mark.parametrize(
    "rows, columns, lanes, fraction_bits, tare_log2",
    [
        (1, 1, 1, 4, 0),
        (2, 8, 8, 12, 2),
        (3, 3, 1, 1, 1),
        (3, 5, 2, 16, 4),
        (2, 8, 3, 9, 3),
        (2, 18, 8, 8, 8),
        pytest.param(64, 64, 1, 12, 2, marks=pytest.mark.long),
    ],
)
def test_tare(rows, columns, lanes, fraction_bits, tare_log2):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes}
    bench.run("frontend", "tare", size | {"FractionBits": fraction_bits, "TareLog2": tare_log2})


def test_averaging_is_exact():
    """The new zero is the exact average, also at the ends of the range; r is raw minus it, rounded."""
    rng = np.random.default_rng(3)
    for log2 in (0, 3, 8):
        twin = Tare(2, 3, fraction_bits=12, tare_log2=log2)
        raw = rng.integers(-65536, 65536, (1 << log2, 2, 3))
        raw[:, 0, 0], raw[:, 0, 1] = -65536, 65535
        twin.tare(force=True)
        assert np.array_equal(twin.next(raw), raw)  # nothing changes while it averages
        found = [Fraction(int(total), 1 << log2) for total in raw.sum(axis=0).ravel()]
        assert [Fraction(value) for value in twin.zeros().ravel().tolist()] == found
        assert twin.tared == 0 and twin.taring
        again = twin.next(raw[:1])
        assert again.ravel().tolist() == [
            int(sample) - (2 * value + 1).__floor__() // 2 for sample, value in zip(raw[0].ravel(), found)
        ]
        assert twin.tared == 1 and not twin.taring


def test_refuses_while_pressed_and_says_so():
    twin = Tare(3, 3, tare_log2=2, contact=50, step=0)
    quiet, pressed = np.full((1, 3, 3), 20), np.full((1, 3, 3), 20)
    pressed[0, 1, 1] += 51
    twin.next(quiet)
    twin.tare()
    twin.next(np.concatenate([quiet, pressed]))
    assert (twin.refused, twin.tared, twin.taring, twin.pressed) == (1, 0, False, True)
    assert not twin.zeros().any()
    mask = np.zeros((3, 3), bool)
    mask[1, 1] = True  # a masked taxel is no contact
    twin.tare()
    twin.next(np.repeat(pressed, 5, axis=0), mask)
    assert (twin.refused, twin.tared) == (1, 1)
    assert twin.zeros()[0, 0] == 20


RATE_HZ, MINUTES = 20, 68
STEP, FRACTION = 8, 10  # 8 / 1024 codes a frame: 0.16 codes a second


def hour_of_drift(rng, step=STEP, size=(9, 13)):
    """Frames of ``size``: every taxel drifts in its own way by up to 60 codes in an hour, with noise.

    Held from minute 2 to 62: a disc of 2,000 codes. Returns the twin, the last true zeros, and per minute the
    true load and centre and those from the forces of the tared samples, gain 1.
    """
    twin = Tare(*size, fraction_bits=FRACTION, tare_log2=6, contact=100, step=step)
    i, j = np.indices(size)
    base = rng.integers(200, 900, size)
    slope = rng.uniform(-40, 40, size)
    phase = rng.uniform(0, 2 * np.pi, size)
    # slope t + 20 (sin(turn + phase) - sin(phase)), as a matrix product, since sines take most of the time
    amounts = np.stack([slope, 20 * np.cos(phase), 20 * np.sin(phase)]).reshape(3, -1)
    load = np.where((i - 5) ** 2 + (j - 9) ** 2 <= 8, 2000, 0)
    twin.tare(force=True)
    truth, measured = [], []
    chunk = RATE_HZ * 60
    for minute in range(MINUTES):
        t = (minute * chunk + np.arange(chunk)) / (3600 * RATE_HZ)
        turn = 2 * np.pi * t
        drift = (np.stack([t, np.sin(turn), np.cos(turn) - 1], axis=1) @ amounts).reshape(chunk, *size)
        held = load * (2 <= minute < 62)
        noise = rng.standard_normal(drift.shape, dtype=np.float32) * 1.5
        raw = np.rint(drift + noise).astype(np.int64) + (base + held)
        r = twin.next(raw)
        truth.append(cop(held))
        measured.append(cop(forces(r[-1], 0, 4096)))
    return twin, base + drift[-1], truth, measured


@pytest.mark.parametrize("seed", [1, 2])
def test_an_hour_of_drift(seed):
    """A load held for an hour and its centre stay within 1 %; minutes later every zero is within 1 code."""
    twin, zero, truth, measured = hour_of_drift(np.random.default_rng(seed))
    held = [minute for minute in range(MINUTES) if truth[minute][3]]
    assert len(held) == 60
    for minute in held:
        x, y, load, _ = truth[minute]
        got_x, got_y, got_load, _ = measured[minute]
        assert abs(got_load - load) <= 0.01 * load, f"minute {minute}: load {got_load} of {load}"
        assert max(abs(got_x - x), abs(got_y - y)) <= 164, f"minute {minute}: {got_x}, {got_y} of {x}, {y}"
    assert np.abs(twin.zeros() - zero).max() <= 1


def test_without_following_an_hour_of_drift_shows():
    """The same hour with the zeros averaged only once: it misses these goals."""
    twin, zero, truth, measured = hour_of_drift(np.random.default_rng(1), step=0)
    worst = max(abs(m[2] - t[2]) / t[2] for m, t in zip(measured, truth) if t[3])
    assert worst > 0.01
    assert np.abs(twin.zeros() - zero).max() > 10


def test_model_in_frames_and_beats():
    rng = np.random.default_rng(4)
    one, other = Tare(3, 5, 2, step=9), Tare(3, 5, 2, step=9)
    raw = rng.integers(-200, 200, (40, 3, 5))
    one.tare(True)
    other.tare(True)
    whole = np.concatenate([one.next(part) for part in np.split(raw, [1, 7, 20])])
    beats = bench.lane_beats(raw, 2, 17, mask=np.zeros_like(raw))
    lanes = [bench.lane_values(beat["data"], 2, 18, signed=True) for beat in expected_of(other, beats)]
    assert np.array_equal(np.array(lanes).reshape(40, 3, 6)[:, :, :5], whole)
    assert np.array_equal(one.zeros(), other.zeros())
    assert np.array_equal(one.process(raw), Tare(3, 5, 2, step=9).next(raw))  # nothing is kept


test_refuses_illegal_parameters = refusals(
    "tare",
    Tare,
    *({"Rows": 0}, {"Columns": 1025}, {"Lanes": 9}, {"FractionBits": 17}, {"TareLog2": 9}),
    *({"TareLog2": 4, "FractionBits": 3}, {"SampleBits": 5, "FractionBits": 3, "TareLog2": 0}),
    rows=2,
    columns=2,
)


def test_refuses_a_step_beyond_its_register():
    refused(Tare, {"step": 256}, rows=2, columns=2)
