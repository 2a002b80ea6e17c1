"""msn_slip_serial against its model, which equals the chain of blocks it replaces: every state, both
directions of the level; samples, levels and thresholds at the ends of their ranges; timers of 0 and up to the
top bit; moving actuators, damage of every kind, resets in every step of a sample, gaps and stalls; its
time."""

import itertools
import random

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip import State
from meissner.twins.slip.slip_serial import SlipSerial
from slip import test_slip_path as slip_path

FIELDS = ["state", "raised", "over", "p2p", "end"]


def recording(rng, samples, rises=True):
    return (1 if rises else -1) * slip_path.recording(rng, 1, samples)[0]


def beats_of(x, ids=None, lasts=None):
    ids = np.zeros(len(x), int) if ids is None else ids
    lasts = np.ones(len(x), bool) if lasts is None else lasts
    return [{"data": d, "id": i, "last": e} for d, i, e in zip(x, ids, lasts)]


def build(dut, **settings):
    """The twin of this build with these settings."""
    value = lambda name: getattr(dut, name).value.to_unsigned()
    config = SlipConfig(level=value("Level"), window=value("Window"), hop=value("Window"), **settings)
    return SlipSerial(config, value("SampleBits"), value("TimerBits"), value("Digit"))


def usual(dut, rises=True, **settings):
    """Settings with which ``recording`` visits every state; times cut to what their registers hold."""
    sign = 1 if rises else -1
    half = 1 << (dut.Level.value.to_unsigned() - 1)
    given = {"contact_level": sign * 200 * half, "release_level": sign * 100 * half, "contact_rises": rises}
    given |= {"threshold": 60, "gross_threshold": 110, "hold": 3, "refractory": 4, "blank": 5}
    given |= {"keep_threshold": 35}
    given |= settings
    longest = (1 << dut.TimerBits.value.to_unsigned()) - 1
    times = {name: min(given[name], longest) for name in ("hold", "refractory", "blank")}
    return build(dut, **(given | times))


async def apply(dut, twin):
    names = "threshold gross_threshold contact_level release_level hold refractory blank contact_rises"
    names += " keep_threshold"
    for name in names.split():
        port, value = getattr(dut, f"cfg_{name}_i"), getattr(twin.config, name)
        port.value = int(-1 if value is None else value) & ((1 << len(port)) - 1)


def rows(decided):
    """The twin's decisions as output beats of the block."""
    return [{f: int(decided[f][n]) for f in FIELDS} for n in range(len(decided["state"]))]


async def check(dut, twin, x, stall_rate=0.0, **given):
    """Send ``x`` and compare every decision; return the twin's decisions.

    ``stall_rate``: for both ends, or (gaps, stalls).
    """
    decided = twin.next(x, **given)
    gaps, stalls = stall_rate if isinstance(stall_rate, tuple) else (stall_rate, stall_rate)
    pauses = bench.gaps_and_stalls(gaps, stalls)
    given.pop("moving", None)
    got = await bench.stream(dut, beats_of(x, **given), FIELDS, *pauses, drain=80, hold=True)
    for index, (is_, should) in enumerate(zip(got, rows(decided))):
        assert is_ == should, f"detail {index} with {twin.config}"
    assert len(got) == len(decided["state"])
    assert bench.read(dut.blanked_o) == twin.blanked
    assert bench.read(dut.damaged_o) == twin.damaged
    return decided


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", in_id_i=1)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False], stall_rate=[0.0, 0.4])
async def matches_model(dut, rises, stall_rate):
    await bench.start(dut, actuator_moving_i=0)
    rng = np.random.default_rng(bench.SEED)
    seen = set()
    for timers in ((3, 4, 5), (0, 0, 0), (1, 7, 1), (7, 0, 2)):
        twin = usual(dut, rises, **dict(zip(("hold", "refractory", "blank"), timers)))
        await bench.reset(dut)
        await apply(dut, twin)
        decided = await check(dut, twin, recording(rng, 250, rises), stall_rate)
        seen |= set(decided["state"])
    assert seen == set(State)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def samples_and_thresholds_use_every_bit(dut):
    """Full-scale steps of both signs; thresholds up to their top bit, levels at both ends."""
    await bench.start(dut, actuator_moving_i=0)
    bits = dut.SampleBits.value.to_unsigned()
    low, high = bench.width(bits + dut.Level.value.to_unsigned())
    rng = np.random.default_rng(bench.SEED + 1)
    x = bench.extremes_then_random(rng, 1, 80, bits)[0]
    x = np.concatenate([x, rng.choice([*bench.width(bits), -1, 0], 80)])
    for threshold, gross, contact, release, keep in (
        (high + 1, 2 * high, low, low, high),
        (high, high + 1, 0, 0, 1),
        (0, high, high, high, 2 * high),
        (2 * high + 1, 0, -1, low + 1, 0),
        (2 * high, 2 * high + 1, high, low, 2 * high - 1),
    ):
        levels = {"contact_level": contact, "release_level": release, "keep_threshold": keep}
        for rises in (True, False):
            twin = build(dut, threshold=threshold, gross_threshold=gross, contact_rises=rises, **levels)
            await bench.reset(dut)
            await apply(dut, twin)
            await check(dut, twin, x)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def compares_exactly_at_each_limit(dut):
    """p2p and level at, one below and one above each limit, also where the limit is a power of two."""
    level, window = (getattr(dut, n).value.to_unsigned() for n in ("Level", "Window"))
    longest = (1 << dut.TimerBits.value.to_unsigned()) - 1
    await bench.start(dut, actuator_moving_i=0)
    rules = [*itertools.product((True, False), repeat=2)]  # all with one limit, one with each of the others
    for limit, (rises, lower) in [*((64, rule) for rule in rules), *zip((1, 2, 63, 100), rules)]:
        levels = {"contact_level": limit, "release_level": limit, "contact_rises": rises}
        # The flag is raised by the least p2p above ``limit``, or by a greater one and then kept by it.
        keep = {"threshold": limit + 1, "keep_threshold": limit} if lower else {"threshold": limit}
        hold = min(window >> level, longest) if lower else 0
        twin = build(dut, gross_threshold=limit + 1, hold=hold, **keep, **levels)
        await bench.reset(dut)
        await apply(dut, twin)
        x = []
        for step in (limit - 1, limit, limit + 1, limit + 2, limit + 1, limit, limit, limit):
            # Level at ``step`` and details of 0, and in each window a few details that make p2p ``step`` too.
            for detail in range(window >> level):
                group = [0] * (1 << level)
                group[-1] = step
                if detail % 3:
                    group[-1 if detail % 2 else 0] = limit - step
                x += group
        await check(dut, twin, np.array(x))


def group_of(detail, level):
    """Samples whose Haar detail is ``detail``, as small as they can be."""
    each, more = divmod(detail, 1 << level)
    half = 1 << (level - 1)
    return [(1 if n < half else -1) * (each + (n < more)) for n in range(2 * half)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def every_bit_of_a_threshold_counts(dut):
    """p2p one above, at and one below the thresholds, whose bits are patterns and their inverses. States by
    hand: a slip lasts while p2p is above the threshold for keeping it, and for ``hold`` details more."""
    level, window = (getattr(dut, name).value.to_unsigned() for name in ("Level", "Window"))
    bits = dut.SampleBits.value.to_unsigned() + level
    details, hold = window >> level, min(2, (1 << dut.TimerBits.value.to_unsigned()) - 1)
    await bench.start(dut, actuator_moving_i=0)
    for pattern in (0x55555, 0xAAAAA, 0x33333, 0xCCCCC):
        keep = pattern % (1 << bits)
        settings = {"threshold": keep + 1, "gross_threshold": keep + 2, "keep_threshold": keep, "hold": hold}
        twin = build(dut, contact_level=bench.width(bits)[0], release_level=bench.width(bits)[0], **settings)
        await bench.reset(dut)
        await apply(dut, twin)
        x = []
        for p2p in (keep + 2, keep + 1, keep, keep + 3):
            lowest = -(p2p // 2)
            for place in range(details):
                x += group_of(lowest + p2p if place == 1 else lowest, level)
        states = [State.INCIPIENT] * (4 * details)
        states[0] = states[3 * details] = State.CONTACT
        states[2 * details + hold : 3 * details] = [State.CONTACT] * (details - hold)
        states[3 * details + 1 :] = [State.GROSS] * (details - 1)
        decided = await check(dut, twin, np.array(x))
        assert decided["state"].tolist() == states, hex(keep)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def keeps_its_decision_for_a_consumer_that_sleeps(dut):
    """The follower stalls, mostly for longer than the next sample would take."""
    twin = usual(dut)
    await bench.start(dut, actuator_moving_i=0)
    await apply(dut, twin)
    await check(dut, twin, recording(np.random.default_rng(bench.SEED), 120), (0.0, 0.99))


@bench.applies(lambda dut: dut.TimerBits.value.to_unsigned() <= 8)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def timers_reach_their_top_bit(dut):
    """The longest time that the register holds, or if that takes too long, times with every other bit set."""
    bits = dut.TimerBits.value.to_unsigned()
    longest = (1 << bits) - 1
    even, odd = longest // 3, longest - longest // 3
    settings = [(longest, 0, 0), (0, longest, 0), (1, 1, longest), (longest >> 1, longest, 1)]
    if bits > 6:
        settings = [(even, odd, even), (odd, even, odd)]
    await bench.start(dut, actuator_moving_i=0)
    for times in settings:
        twin = usual(dut, **dict(zip(("hold", "refractory", "blank"), times)))
        await bench.reset(dut)
        await apply(dut, twin)
        await check(dut, twin, recording(np.random.default_rng(bench.SEED), 800))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def moving_is_that_of_the_clock_that_takes_a_sample(dut):
    """The actuator may start or stop at every clock; mostly it differs in clocks that take no sample."""
    twin = usual(dut, hold=1, refractory=0, blank=0)
    await bench.start(dut, out_ready_i=1, actuator_moving_i=0)
    await apply(dut, twin)
    draw = random.Random(bench.SEED)
    x = recording(np.random.default_rng(bench.SEED), 600)
    moving, got = [], []
    for beat in beats_of(x):
        bench.offer(dut, beat)
        dut.in_valid_i.value = 1
        taken = False
        while not taken:
            now = draw.random() < 0.5
            dut.actuator_moving_i.value = int(now)
            await bench.ReadOnly()
            if dut.out_valid_o.value == 1:
                got.append(bench.read(dut.out_state_o))
            taken = dut.in_ready_o.value == 1
            await bench.RisingEdge(dut.clk_i)
        moving.append(now)
    await bench.ReadOnly()
    if dut.out_valid_o.value == 1:
        got.append(bench.read(dut.out_state_o))
    assert got == twin.process(x, moving=moving)["state"].tolist()
    assert bench.read(dut.blanked_o) == twin.blanked > 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def starts_again_after_damage(dut, stall_rate):
    """Samples with another id and lost or late `last`, singly and in runs."""
    twin = usual(dut)
    await bench.start(dut, actuator_moving_i=0)
    await apply(dut, twin)
    rng = np.random.default_rng(bench.SEED + 2)
    x = recording(rng, 900)
    wrong = np.repeat(rng.random(len(x) // 3) < 0.03, 3)
    decided = await check(
        dut,
        twin,
        x,
        stall_rate,
        ids=(wrong & (rng.random(len(x)) < 0.5)).astype(int),
        lasts=~(wrong & (rng.random(len(x)) < 0.5)),
    )
    assert twin.damaged > 5
    assert len(set(decided["state"])) == 5


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset_at_every_clock_of_a_sample(dut):
    twin = usual(dut)
    await bench.start(dut, actuator_moving_i=0)
    await apply(dut, twin)
    rng = np.random.default_rng(bench.SEED + 3)
    first, second = recording(rng, 7), recording(rng, 30)
    for late in range(twin.clocks + 2):
        await bench.stream(dut, beats_of(first), FIELDS, drain=1, hold=True)
        beat = beats_of([-77])[0]
        bench.offer(dut, beat)
        dut.in_valid_i.value = 1
        await bench.clocks(dut, late)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        twin.reset()
        await check(dut, twin, second)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def takes_as_long_as_the_twin_says(dut):
    """Clocks until a sample offered to an idle block is taken; its decision follows one clock later."""
    twin = usual(dut)
    await bench.start(dut, out_ready_i=1, actuator_moving_i=0, in_data_i=0, in_id_i=0, in_last_i=1)
    await apply(dut, twin)
    for sample in range(4 << twin.config.level):
        await bench.clocks(dut, 5)
        dut.in_valid_i.value = 1
        clock = 0
        await bench.ReadOnly()
        while dut.in_ready_o.value != 1:
            await bench.RisingEdge(dut.clk_i)
            await bench.ReadOnly()
            clock += 1
        assert clock == twin.clocks
        await bench.RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0
        await bench.ReadOnly()
        assert dut.out_valid_o.value == (sample % (1 << twin.config.level) == (1 << twin.config.level) - 1)
        await bench.RisingEdge(dut.clk_i)
    dut._log.info(f"a sample takes {twin.clocks} clocks, its decision stands one clock later")


EVIDENCE = {
    # Its memory asks for block RAM.
    "equivalence": {"defined": True},
    "faults": {"size": {"Window": 8, "TimerBits": 3}, "settle": 60, "driver": {"phases": 8}},
}


@pytest.mark.parametrize(
    "parameters",
    [
        pytest.param({"SampleBits": 13, "TimerBits": 1, "Window": 16, "Digit": 1}, marks=pytest.mark.long),
        {"SampleBits": 15, "TimerBits": 8, "Digit": 2},
        {"SampleBits": 15, "TimerBits": 8, "Digit": 1},
        pytest.param({"SampleBits": 17, "TimerBits": 14, "Level": 2, "Window": 16}, marks=pytest.mark.long),
        pytest.param({"SampleBits": 13, "TimerBits": 5, "Level": 3, "Window": 32}, marks=pytest.mark.long),
        {"SampleBits": 10, "TimerBits": 3, "Level": 2, "Window": 8},
        {"SampleBits": 13, "TimerBits": 2, "Level": 1, "Window": 16},  # timer's sign early in a pass
    ],
)
def test_slip_serial(parameters):
    bench.run("slip", "slip_serial", {"Level": 1, "Window": 64} | parameters)


@pytest.mark.parametrize(
    "sample_bits, level, timer_bits, digit, clocks",
    [
        (13, 1, 14, 2, 17),  # p2p has 7 digits, 8 with the spare one: two passes, and the clock that takes it
        (15, 1, 14, 2, 33),  # 8 digits, 9 with the spare one: 16
        (15, 1, 8, 1, 65),  # 16 and 17: 32
        (13, 3, 5, 2, 33),
        (10, 1, 15, 2, 17),  # the timer and its sign: 16 bits
        (10, 1, 16, 2, 33),
    ],
)
def test_clocks_by_hand(sample_bits, level, timer_bits, digit, clocks):
    assert SlipSerial(SlipConfig(level=level), sample_bits, timer_bits, digit).clocks == clocks


def test_slip_serial_by_hand():
    """Against a plain loop instead of the models: slip/slip_path_by_hand.py."""
    parameters = {"SampleBits": 13, "Level": 2, "Window": 16, "TimerBits": 3}
    bench.run("slip", "slip_serial", parameters, module="slip_path_by_hand")


@pytest.mark.parametrize(
    "parameters, message",
    [
        ({"SampleBits": 1}, "SampleBits = 1"),
        ({"Level": 4}, "Level = 4"),
        ({"Window": 48}, "Window = 48"),
        ({"Window": 2}, "Window = 2"),
        ({"TimerBits": 32}, "TimerBits = 32"),
        ({"Digit": 3}, "Digit = 3"),
    ],
)
def test_refuses_illegal_parameters(parameters, message):
    assert message in bench.refuses("slip_serial", parameters)


@pytest.mark.parametrize(
    "arguments, settings, message",
    [
        ({"sample_bits": 1}, {}, "sample_bits = 1"),
        ({"timer_bits": 32}, {}, "timer_bits = 32"),
        ({"digit": 3}, {}, "digit = 3"),
        ({}, {"hop": 32}, "hop = 32 must equal the window, 64"),
        ({"sample_bits": 13}, {"threshold": 1 << 14}, "threshold = 16384 must lie in 0 .. 16383"),
        ({"sample_bits": 13}, {"contact_level": -8193}, "contact_level = -8193 must lie in -8192 .. 8191"),
        ({"timer_bits": 10}, {"blank": 1024}, "blank = 1024 must lie in 0 .. 1023"),
        ({"sample_bits": 13}, {"keep_threshold": 1 << 14}, "keep_threshold = 16384 must lie in 0 .. 16383"),
    ],
)
def test_model_refuses(arguments, settings, message):
    with pytest.raises(ValueError, match=message):
        SlipSerial(SlipConfig(**settings), **arguments)
