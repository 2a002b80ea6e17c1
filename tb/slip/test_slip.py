"""msn_slip against its model: random walks through every state and transition under every register setting,
p2p at, one below and one above each threshold, timers of 0, 1 and more, moving actuators, restarts, gaps
and stalls. A run that leaves a state or transition unvisited fails."""

import itertools
import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles
from cocotb.utils import get_sim_time

import bench
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip import Slip, State

FIELDS = ["state", "raised", "over", "p2p", "id", "last", "end"]
THRESHOLD, GROSS, CONTACT, RELEASE = 40, 80, 1000, 900
KEEP = 25

# Every state transition that the rules allow.
ARCS = {
    (State.NONE, State.CONTACT),
    (State.CONTACT, State.INCIPIENT),
    (State.CONTACT, State.GROSS),
    (State.CONTACT, State.RELEASE),
    (State.INCIPIENT, State.GROSS),
    (State.INCIPIENT, State.CONTACT),
    (State.INCIPIENT, State.RELEASE),
    (State.GROSS, State.CONTACT),
    (State.GROSS, State.RELEASE),
    (State.RELEASE, State.NONE),
    (State.RELEASE, State.CONTACT),
}


def walk(channels, length, rises, draw):
    """p2p and level [channels, length] that stay for a while and then jump, at and around each threshold."""
    sign = 1 if rises else -1
    levels = [sign * v for v in (CONTACT, CONTACT - 1, CONTACT + 500, RELEASE, RELEASE - 1, 0)]
    sizes = [0, KEEP, KEEP + 1, THRESHOLD, THRESHOLD + 1, GROSS, GROSS + 1, (1 << 18) - 1]
    sizes += [draw.getrandbits(18) for _ in range(6)]

    def steps(choices, stay):
        value, out = draw.choice(choices), []
        for _ in range(length):
            value = value if draw.random() < stay else draw.choice(choices)
            out.append(value)
        return out

    p2p = [steps(sizes, 0.3) for _ in range(channels)]
    level = [steps(levels, 0.93) for _ in range(channels)]
    return np.array(p2p), np.array(level)


async def apply(dut, config):
    for name in (
        "threshold",
        "gross_threshold",
        "contact_level",
        "release_level",
        "hold",
        "refractory",
        "blank",
        "keep_threshold",
    ):
        port, value = getattr(dut, f"cfg_{name}_i"), getattr(config, name)
        port.value = (-1 if value is None else value) & ((1 << len(port)) - 1)
    dut.cfg_contact_rises_i.value = int(config.contact_rises)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "blanked_o", again=False)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """Every detail of a contact is over while the actuator moves."""
    names = ("threshold", "gross_threshold", "contact_level", "release_level", "hold", "refractory", "blank")
    idle = dict.fromkeys([f"cfg_{name}_i" for name in (*names, "keep_threshold")], 0)
    idle |= {f"in_{name}_i": 0 for name in ("total", "id", "last", "restart", "mask", "end")}
    await bench.start(dut, in_p2p_i=1, actuator_moving_i=1, cfg_contact_rises_i=1, **idle)
    await bench.counts_on(dut, "blanked_o", span=3000, in_valid_i=1, out_ready_i=1)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False], stall_rate=[0.0, 0.4])
async def matches_model(dut, rises, stall_rate):
    channels = dut.Channels.value.to_unsigned()
    draw = random.Random(bench.SEED)
    sign = 1 if rises else -1
    await bench.start(dut, actuator_moving_i=0)
    arcs, blanked = set(), 0
    length = (1000 if channels == 1 else 400) if channels < 100 else 3
    timers = [(0, 0, 0), (1, 1, 1), (3, 9, 5), (10, 0, 9), (2, 6, 14)] if channels < 100 else [(1, 1, 1)]
    keeps = itertools.cycle([KEEP, None, GROSS - 1, 0])  # lower, equal, higher, any p2p keeps
    for (hold, refractory, blank), keep in zip(timers, keeps):
        config = SlipConfig(
            threshold=THRESHOLD,
            gross_threshold=GROSS,
            contact_level=sign * CONTACT,
            release_level=sign * RELEASE,
            contact_rises=rises,
            hold=hold,
            refractory=refractory,
            blank=blank,
            keep_threshold=keep,
        )
        await bench.reset(dut)
        await apply(dut, config)
        twin = Slip(channels, config)
        for moving in (False, True, False):
            dut.actuator_moving_i.value = int(moving)
            p2p, level = walk(channels, length // (4 if moving else 1), rises, draw)
            ends = np.broadcast_to(np.arange(p2p.shape[1]) % 32 == 31, p2p.shape)
            mask = np.array([[draw.random() < 0.02 for _ in row] for row in p2p], bool).reshape(p2p.shape)
            beats = bench.frames(p2p=p2p, total=level, end=ends, mask=mask)
            mask &= bool(dut.Mask.value.to_unsigned())
            twin.restart()
            states = twin.next(p2p, level, np.full(p2p.shape[1], moving), mask)
            before = np.concatenate([np.zeros((channels, 1), np.int8), states[:, :-1]], axis=1)
            slipping = (states == State.INCIPIENT) | (states == State.GROSS)
            was = (before == State.INCIPIENT) | (before == State.GROSS)
            arcs |= {(State(a), State(b)) for a, b in zip(before.flat, states.flat) if a != b}
            expected = [
                {field: beat[field] for field in FIELDS}
                for beat in bench.frames(
                    state=states, raised=slipping & ~was, over=(p2p > THRESHOLD) & ~mask, p2p=p2p, end=ends
                )
            ]
            pauses = bench.gaps_and_stalls(stall_rate)
            got = await bench.stream(dut, beats, FIELDS, *pauses)
            for index, (is_, should) in enumerate(zip(got, expected)):
                assert is_ == should, f"detail {index // channels} with {config}"
            assert len(got) == len(expected)
        assert bench.read(dut.blanked_o) == twin.blanked, config
        blanked += twin.blanked
    masked = {(state, State.NONE) for state in State if state != State.NONE}
    allowed = ARCS | masked if dut.Mask.value.to_unsigned() else ARCS
    if channels < 100:
        assert arcs == allowed, f"not visited: {allowed - arcs}; not allowed: {arcs - allowed}"
        assert blanked > 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def moving_changes_while_the_stage_waits(dut):
    """Decisions are taken in one of four clocks. In each clock that takes no detail, the actuator does the
    opposite of what it did for the last detail. Every third detail of a contact is over: a slip if the
    actuator was at rest in the clock that took it."""
    channels = dut.Channels.value.to_unsigned()
    config = SlipConfig(
        threshold=THRESHOLD, gross_threshold=GROSS, contact_level=CONTACT, hold=1, refractory=0, blank=0
    )
    await bench.start(dut, actuator_moving_i=0, in_mask_i=0)
    await apply(dut, config)
    steps = ((0, 0), (CONTACT, 0), (CONTACT, THRESHOLD + 1))
    beats, expected = [], []
    for trial in range(12 if channels < 100 else 1):
        for step, (level, p2p) in enumerate(steps):
            for channel in range(channels):
                moving = (5 * trial + 3 * channel + step // 2) % 7 < 3
                beats.append((p2p, level, int(step == 0), int(moving)))
                expected.append((0, 1, 1 if moving else 2)[step])  # NONE, CONTACT, CONTACT or INCIPIENT
    got, before, clock = [], 0, 0
    while len(got) < len(expected):
        offer = beats[0] if beats else None
        p2p, level, restart, moving = offer or (0, 0, 0, 1 - before)
        dut.in_valid_i.value, dut.in_p2p_i.value, dut.in_total_i.value = int(offer is not None), p2p, level
        dut.in_restart_i.value, dut.out_ready_i.value = restart, int(clock % 4 == 3)
        await bench.Timer(1, "ns")
        takes = offer is not None and dut.in_ready_o.value == 1
        dut.actuator_moving_i.value = moving if takes else 1 - before
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1 and clock % 4 == 3:
            got.append(bench.read(dut.out_state_o))
        if takes:
            beats.pop(0)
            before = moving
        await bench.RisingEdge(dut.clk_i)
        clock += 1
    assert got == expected


@bench.applies(lambda dut: dut.Channels.value.to_unsigned() <= 100)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    """In every state, with a detail in flight."""
    channels = dut.Channels.value.to_unsigned()
    config = SlipConfig(
        threshold=THRESHOLD, gross_threshold=GROSS, contact_level=CONTACT, release_level=RELEASE, hold=2
    )
    await bench.start(dut, actuator_moving_i=0, in_mask_i=0, out_ready_i=1)
    await apply(dut, config)
    level = np.tile([0, *[CONTACT] * 4, 0, 0], (channels, 1))
    p2p = np.tile([0, 0, 0, THRESHOLD + 1, GROSS + 1, 0, 0], (channels, 1))
    states = Slip(channels, config).process(p2p, level)
    assert set(states[0]) == set(State)
    beats = bench.frames(p2p=p2p, total=level, end=np.zeros_like(p2p))
    expected = [{"state": row["state"]} for row in bench.frames(state=states)]
    for cut in range(1, len(beats) + 1):
        dut.in_valid_i.value = 1
        for beat in beats[:cut]:
            bench.offer(dut, beat)
            await bench.clocks(dut, 1)
        await bench.reset(dut)
        dut.in_valid_i.value = 0
        await bench.ReadOnly()
        assert dut.out_valid_o.value == 0
        await bench.clocks(dut, 1)
        assert await bench.stream(dut, beats, ["state"]) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def thresholds_and_levels_use_every_bit(dut):
    """Thresholds are unsigned and reach the top bit; levels are signed and reach both ends."""
    channels, bits = dut.Channels.value.to_unsigned(), len(dut.in_p2p_i)
    low, high = bench.width(bits)
    ends_of = (
        [0, 1, high, high + 1, high + 2, 2 * high, 2 * high + 1],
        [low, low + 1, -1, 0, 1, high - 1, high],
    )
    settings = [(high + 1, 2 * high, low, low, high), (high, high + 1, 0, low, 1), (0, high, high, low, 0)]
    draw = random.Random(bench.SEED)
    sign = 1 << bits
    numbers = [draw.randrange(1, sign - 1) for _ in range(5)]
    for _ in range(3):  # every bit of every register at 0 and at 1
        levels = [bench.as_signed(number, bits) for number in numbers[2:4]]
        settings.append((*numbers[:2], *levels, numbers[4]))
        numbers = [sign - 1 - number for number in numbers]
    await bench.start(dut, actuator_moving_i=0, in_mask_i=0)
    for number, (threshold, gross, contact, release, keep) in enumerate(settings):
        config = SlipConfig(
            threshold=threshold,
            gross_threshold=gross,
            contact_level=contact,
            release_level=release,
            contact_rises=number != 4,
            keep_threshold=keep,
        )
        await apply(dut, config)
        sizes, levels = ends_of
        if number > 2:
            limits = (threshold, gross, keep)
            sizes = [t + off for t in limits for off in (-1, 0, 1) if 0 <= t + off < sign]
            levels = [t + off for t in (contact, release) for off in (-1, 0, 1) if low <= t + off <= high]
        p2p, total = (np.tile(a.ravel(), (channels, 1)) for a in np.meshgrid(sizes, levels))
        if channels > 100:
            p2p, total = p2p[:, ::7], total[:, ::7]
        states = Slip(channels, config).process(p2p, total)
        ends = np.zeros_like(p2p)
        got = await bench.stream(dut, bench.frames(p2p=p2p, total=total, end=ends), ["state", "over"])
        rows = bench.frames(state=states, over=p2p > threshold)
        assert got == [{"state": row["state"], "over": row["over"]} for row in rows], config


# By hand: p2p, level, moving, state. A p2p of 7 keeps a flag, 6 does not; 11 raises one, 10 does not.
KEPT_CONFIG = SlipConfig(
    threshold=10,
    gross_threshold=20,
    keep_threshold=6,
    contact_level=5,
    release_level=3,
    hold=2,
    refractory=3,
    blank=1,
)
_N, _C, _I, _G, _R = State
KEPT = [
    *[
        (0, 0, 0, _N),
        (0, 5, 0, _C),
        (11, 5, 0, _C),
        (7, 5, 0, _C),
        (10, 5, 0, _C),
    ],  # the 11 is blanked; a p2p that would keep a flag raises none
    *[(11, 5, 0, _I), (6, 5, 0, _I), (7, 5, 0, _I), (10, 5, 0, _I)],
    *[(6, 5, 0, _I), (6, 5, 0, _I), (7, 5, 0, _I)],  # kept in the last detail of the hold
    *[(5, 5, 0, _I), (6, 5, 0, _I), (0, 5, 0, _C)],
    *[(11, 5, 0, _C), (11, 5, 0, _C), (11, 5, 0, _C), (7, 5, 0, _C)],  # refractory time
    *[
        (21, 5, 0, _G),
        (7, 5, 0, _G),
        (6, 5, 0, _G),
        (20, 5, 0, _G),
        (6, 5, 0, _G),
        (6, 5, 0, _G),
        (6, 5, 0, _C),
    ],
    *[(0, 5, 0, _C), (0, 5, 0, _C), (0, 5, 0, _C), (11, 5, 0, _I)],
    *[(7, 5, 1, _I), (11, 5, 1, _I), (7, 5, 0, _I)],  # a moving actuator keeps no flag
    *[(7, 5, 1, _I), (10, 5, 1, _I), (7, 5, 1, _C)],
    *[
        (0, 5, 0, _C),
        (0, 5, 0, _C),
        (0, 5, 0, _C),
        (11, 5, 0, _I),
        (7, 2, 0, _R),
        (7, 2, 0, _R),
        (7, 2, 0, _R),
    ],
    (7, 2, 0, _N),
]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def keeps_a_flag_as_told(dut):
    """Every channel runs the same sequence, with states worked out by hand."""
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut, actuator_moving_i=0, in_mask_i=0)
    await apply(dut, KEPT_CONFIG)
    dut.out_ready_i.value = dut.in_valid_i.value = 1
    p2p, level, moving, states = (np.tile(column, (channels, 1)) for column in zip(*KEPT))
    seen = []
    beats = bench.frames(p2p=p2p, total=level, moving=moving)
    for beat in (*beats, beats[-1], beats[-1]):
        dut.actuator_moving_i.value = beat.pop("moving", 0)
        bench.offer(dut, beat)
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1:
            seen.append(bench.read(dut.out_state_o))
        await bench.RisingEdge(dut.clk_i)
    assert seen == [int(state) for state in states.T.ravel()]


async def note_changes(port, seen):
    """Append the time, in ns, and the value of every change of ``port`` to ``seen``."""
    while True:
        await port.value_change
        seen.append((int(get_sim_time("ns")), bench.read(port)))


@bench.applies(lambda dut: dut.Channels.value.to_unsigned() == 1)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def timers_end_on_time_with_every_bit(dut):
    """For each of the three times: every other bit set, the bits between, and 0; one detail a clock."""
    bits = len(dut.cfg_hold_i)
    times = [sum(1 << k for k in range(first, bits, 2)) for first in (0, 1)] + [0]
    await bench.start(dut, actuator_moving_i=0, in_mask_i=0, out_ready_i=1)
    for name, time in itertools.product(("blank", "hold", "refractory"), times):
        config = SlipConfig(**{"contact_level": 1, "release_level": 1, "hold": 3} | {name: time})
        await apply(dut, config)
        # Over from the onset on, below, over in the refractory time, then lifted.
        parts = [(99, 1, config.blank + 3), (0, 1, config.hold + 2), (99, 1, config.refractory + 2)]
        parts += [(0, 0, config.hold + 3 if name != "hold" else 1)]
        p2p, level, _ = np.repeat(parts, [part[2] for part in parts], axis=0).T
        states = Slip(1, config).process([p2p], [level])[0]
        before, seen = int(get_sim_time("ns")), []
        watch = cocotb.start_soon(note_changes(dut.out_state_o, seen))
        dut.in_valid_i.value = dut.in_restart_i.value = 1
        for p2p, level, count in parts:
            dut.in_p2p_i.value, dut.in_total_i.value = p2p, level
            await bench.clocks(dut, 1)
            dut.in_restart_i.value = 0
            await ClockCycles(dut.clk_i, count - 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, 2)
        watch.cancel()
        # A detail is taken in the clock after it is offered and gives its state two clocks later.
        expected = [(before + 10 * (at + 2), states[at]) for at in np.flatnonzero(np.diff(states)) + 1]
        assert [change for change in seen if change[0] > before + 20] == expected, config


EVIDENCE = {
    "equivalence": {
        "size": {"Channels": 6},
        "reset_size": {"Channels": 1},
        "reset": {
            "framed": True,
            "joined": (
                ("block.seen_valid", "!moved"),
                ("block.restart", "begun"),
                ("block.kept_state", "moved"),
            ),
        },
    },
    "faults": {"size": {"TimerBits": 4}, "settle": 40},
}


# With timers of 4 bits the times of matches_model reach the top bit.
@pytest.mark.parametrize(
    "channels, timer_bits, mask",
    [
        (1, 16, 0),
        (1, 4, 1),
        (2, 4, 0),
        pytest.param(6, 16, 0, marks=pytest.mark.long),
        (1024, 16, 0),
        (6, 16, 1),
    ],
)
def test_slip(channels, timer_bits, mask):
    bench.run("slip", "slip", {"Channels": channels, "TimerBits": timer_bits, "Mask": mask})


@pytest.mark.parametrize("channels, mask", [(1, 1), (3, 0)])
def test_slip_by_hand(channels, mask):
    """Against literals and a plain loop instead of the model: slip/slip_by_hand.py."""
    size = {"Channels": channels, "TimerBits": 4, "Mask": mask}
    bench.run("slip", "slip", size, module="slip_by_hand")


def test_model_keeps_a_flag_above_the_keep_threshold():
    p2p, level, moving, states = zip(*KEPT)
    assert Slip(1, KEPT_CONFIG).process([p2p], [level], moving)[0].tolist() == [*states]


def test_model_in_chunks():
    draw = random.Random(2)
    config = SlipConfig(
        threshold=40, gross_threshold=80, contact_level=1000, release_level=900, hold=3, refractory=4, blank=5
    )
    p2p, level = walk(2, 300, True, draw)
    moving = np.array([draw.random() < 0.1 for _ in range(300)])
    twin = Slip(2, config)
    cuts = [0, 1, 2, 50, 51, 300]
    parts = [twin.next(p2p[:, a:b], level[:, a:b], moving[a:b]) for a, b in itertools.pairwise(cuts)]
    blanked = twin.blanked
    assert np.array_equal(np.concatenate(parts, axis=1), twin.process(p2p, level, moving))
    assert blanked == twin.blanked


def test_refuses_illegal_parameters():
    assert "Channels = 0" in bench.refuses("slip", {"Channels": 0})
    assert "TimerBits = 32" in bench.refuses("slip", {"TimerBits": 32})
    for channels in (0, 4097):
        with pytest.raises(ValueError, match=f"channels = {channels} must lie in 1 .. 4096"):
            Slip(channels, SlipConfig())


@pytest.mark.parametrize(
    "settings",
    [
        *[{"window": 48}, {"window": 2}, {"window": 64.0}, {"window": 4, "hop": 4, "level": 2}],
        *[{"hop": 3}, {"hop": 66}, {"level": 4}, {"blank": 1 << 16}],
        *[{"threshold": value} for value in (-1, 1 << 18, 4.5)],
        *[{"keep_threshold": value} for value in (-1, 1 << 18, 2.5)],
        {"gross_threshold": 1 << 32, "level": 2},
        *[{"contact_level": 1 << 17}, {"release_level": -(1 << 17) - 1}],
    ],
    ids=str,
)
def test_config_refuses(settings):
    name, value = next(iter(settings.items()))
    with pytest.raises(ValueError, match=f"^{name} = {value} must"):
        SlipConfig(**settings)
