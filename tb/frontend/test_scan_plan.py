"""msn_scan_plan against its twin: every switch and trigger in its clock, with its place.

Random registers over every mix of frames (back to back, on a timer that suits and one that does not), orders,
regions (also past the array and upside down) and slip rounds (that fit, fill all the time, and do not fit);
settle 0 and the maximum; registers that change while a frame runs; waiting for room; enable; reset.
"""

import itertools
import random
from dataclasses import replace

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.scan_plan import START, Region, ScanPlan, Settings

NAMES = {
    "rows": "Rows",
    "columns": "Columns",
    "lanes": "Lanes",
    "channels": "Channels",
    "hold": "Hold",
    "cycle": "Cycle",
    "slip_slots": "SlipSlots",
    "settle_bits": "SettleBits",
    "period_bits": "PeriodBits",
    "group_bits": "GroupBits",
}


def twin_of(dut):
    return ScanPlan(**{name: getattr(dut, port).value.to_unsigned() for name, port in NAMES.items()})


def packed(values, bits):
    return sum(value << index * bits for index, value in enumerate(values))


def apply(dut, plan, settings):
    """Put ``settings`` on the registers; rows and columns that no port can hold wrap to its largest."""
    region = settings.region
    for name in ("first_row", "last_row", "first_column", "last_column"):
        port = getattr(dut, f"cfg_{name}_i")
        port.value = min(getattr(region, name), (1 << len(port)) - 1)
    dut.cfg_settle_i.value = settings.settle
    dut.cfg_period_i.value = settings.period
    dut.cfg_interleave_i.value = int(settings.interleave)
    dut.cfg_slip_period_i.value = settings.slip_period
    row_bits = len(dut.cfg_slip_row_i) // plan.slip_slots
    dut.cfg_slip_row_i.value = packed([row for row, _ in settings.slip_places], row_bits)
    dut.cfg_slip_group_i.value = packed([group for _, group in settings.slip_places], plan.group_bits)


def random_settings(draw, plan):
    settle = draw.choice([0, 1, 2, min(draw.randint(0, 3 * plan.cycle), (1 << plan.settle_bits) - 1)])
    slot = plan.slot(settle)
    top_row = 2 ** max(1, (plan.rows - 1).bit_length()) - 1
    top_column = 2 ** max(1, (plan.columns - 1).bit_length()) - 1
    region = Region()
    if draw.random() < 0.7:
        region = Region(
            *(draw.randint(0, top_row) for _ in range(2)), *(draw.randint(0, top_column) for _ in range(2))
        )
    frame = plan.frame_clocks(settle, region)
    rounds = plan.slip_slots * slot
    slip = draw.choice(
        [0, rounds + slot, rounds + 2 * slot, rounds + 3 * slot + draw.randint(-1, 1), 7 * rounds]
    )
    return Settings(
        settle=settle,
        period=draw.choice([0, frame, frame + 1, frame - 1, 3 * frame, max(1, frame // 3)]),
        interleave=draw.random() < 0.5,
        region=region,
        slip_period=slip,
        slip_places=tuple(
            (draw.randint(0, 2 * top_row + 1), draw.randint(0, 2**plan.group_bits - 1))
            for _ in range(plan.slip_slots)
        ),
    )


async def begin(dut, plan, settings):
    apply(dut, plan, settings)
    dut.room_i.value = 1
    await bench.start(dut, cfg_enable_i=0)
    await bench.clocks(dut, 2)


FRAME = ("first_row", "last_row", "first_beat", "last_beat", "interleave")


def frame_of(plan, settings):
    """What the block tells of a frame, as FRAME names it."""
    region = settings.region.cut(plan.rows, plan.columns)
    beats = plan.beat_range(settings.region)
    return region.first_row, region.last_row, *beats, int(settings.interleave)


async def watch(dut, clocks, at=None, action=None):
    """Switches and triggers of the next ``clocks`` clocks.

    As [(clock, row, group)] and [(clock, slip, first, group, what FRAME names)].

    ``action`` is called at the beginning of clock ``at``. Ends in the clock after, to read it.
    """
    switches, triggers = [], []
    told = None
    for clock in range(clocks):
        if clock == at:
            action()
        await ReadOnly()
        if told is not None:
            names = ("done_slip", "done_first", "done_group")
            frame = tuple(bench.read(getattr(dut, f"frame_{name}_o")) for name in FRAME)
            triggers.append((told, *(bench.read(getattr(dut, f"{name}_o")) for name in names), frame))
            told = None
        if dut.switch_o.value == 1:
            switches.append((clock, bench.read(dut.switch_row_o), bench.read(dut.switch_group_o)))
        if dut.trigger_o.value == 1:
            told = clock
        await RisingEdge(dut.clk_i)
    await ReadOnly()
    return switches, triggers


def agree(plan, settings, clocks, switches, triggers):
    conversions, overrun, slip_overrun = plan.schedule(settings, clocks)
    row_mask = (2 << max(1, (plan.rows - 1).bit_length())) - 1
    assert switches == [(c.switch, c.row & row_mask, c.group) for c in conversions], settings
    expected = [(c.trigger, c.slip, c.first, c.group) for c in conversions if c.trigger < clocks - 1]
    assert [trigger[:4] for trigger in triggers[: len(expected)]] == expected
    assert {frame for _, slip, *_, frame in triggers if not slip} <= {frame_of(plan, settings)}
    return conversions, overrun, slip_overrun


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "overrun_o", "slip_overrun_o", wiggled=["room_i"], cfg_enable_i=1)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def matches_model(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for number in range(60):
        settings = random_settings(draw, plan)
        if number % 3 == 2:  # rounds that fill all the time or do not fit, and times of any number of clocks
            rounds = plan.slip_slots * plan.slot(settings.settle)
            slip, period = (draw.getrandbits(plan.period_bits) for _ in range(2))
            slip = draw.choice([1, draw.randint(1, rounds), rounds, slip, slip])
            settings = replace(settings, slip_period=slip, period=draw.choice([period, settings.period]))
        await begin(dut, plan, settings)
        clocks = min(4000, 3 * plan.frame_clocks(settings.settle, settings.region) + 200)
        dut.cfg_enable_i.value = 1
        switches, triggers = await watch(dut, clocks)
        _, overrun, slip_overrun = agree(plan, settings, clocks, switches, triggers)
        assert bench.read(dut.overrun_o) == overrun, settings
        assert bench.read(dut.slip_overrun_o) == slip_overrun, settings
        assert bench.read(dut.held_o) == 0
        await RisingEdge(dut.clk_i)


@bench.applies(lambda dut: (twin_of(dut).rows, twin_of(dut).columns) == (5, 24))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_period_of_many_clocks_is_exact(dut):
    """With a bit set that the other tests' periods have not, in one of the builds, as it takes its time."""
    plan = twin_of(dut)
    settings = Settings(settle=0, period=(1 << 19) + 5, region=Region(0, 0, 0, 0))
    await begin(dut, plan, settings)
    dut.cfg_enable_i.value = 1
    [first], _ = await watch(dut, 100)
    await bench.clocks(dut, settings.period - 100)
    [second], _ = await watch(dut, 100)
    assert first == second
    assert bench.read(dut.overrun_o) == 0


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def every_bit_of_a_period_is_counted(dut):
    """What is left of both periods, looked at inside: one of 32 bits takes too long to wait for."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    bits = plan.period_bits
    lone = [(1 << bit) + 1 for bit in range(6, bits)]  # a clock later this bit alone is left of it
    some = [draw.getrandbits(bits) | 1 << bits - 1 for _ in range(3 * bits)]
    for period, slip_period in zip([*lone, *some], [*some[: len(lone)], *some[::-1]]):
        await begin(dut, plan, replace(Settings(), settle=0, period=period, slip_period=slip_period))
        dut.cfg_enable_i.value = 1
        left = []
        for _ in range(START + 12):
            await ReadOnly()
            left.append((bench.read(dut.left_q), bench.read(dut.slip_left_q)))
            await RisingEdge(dut.clk_i)
        for counts, whole in zip(zip(*left), (period, slip_period)):
            begun = next(n for n, count in enumerate(counts) if count == whole - 1)
            assert begun <= START + 2
            assert list(counts[begun:]) == list(range(whole - 1, whole - 1 - len(counts) + begun, -1))


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def slip_rounds_have_no_jitter(dut):
    """Rounds that fit start exactly a period apart, and the frame gets all other slots."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for settle in (0, 3, plan.cycle):
        slot = plan.slot(settle)
        for spare in (slot, 2 * slot - 1, 5 * slot):
            period = plan.slip_slots * slot + spare
            places = tuple((draw.randrange(plan.rows), 0) for _ in range(plan.slip_slots))
            settings = Settings(settle=settle, slip_period=period, slip_places=places)
            await begin(dut, plan, settings)
            dut.cfg_enable_i.value = 1
            _, triggers = await watch(dut, START + 8 * period)
            rounds = [clock for clock, slip, first, *_ in triggers if slip and first]
            assert len(rounds) >= 7
            assert {b - a for a, b in itertools.pairwise(rounds)} == {period}
            between = [clock for clock, slip, *_ in triggers if not slip and clock < rounds[6]]
            assert len(between) == 6 * (spare // slot)
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def largest_settle_and_no_settle(dut):
    plan = twin_of(dut)
    largest = (1 << plan.settle_bits) - 1
    for settle in (0, largest):
        settings = Settings(settle=settle)
        await begin(dut, plan, settings)
        dut.cfg_enable_i.value = 1
        clocks = START + 3 * plan.slot(settle) + 5
        switches, triggers = await watch(dut, clocks)
        agree(plan, settings, clocks, switches, triggers)
        assert {t[0] - s[0] for s, t in zip(switches, triggers)} == {settle + 1}
        assert len(triggers) >= 2
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def registers_change_between_frames_only(dut):
    """A region that changes inside a frame is the next frame's; settle and periods wait until off."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for _ in range(20):
        old, new = (random_settings(draw, plan) for _ in range(2))
        old = Settings(settle=old.settle, interleave=old.interleave, region=old.region)
        await begin(dut, plan, old)
        dut.cfg_enable_i.value = 1
        slot = plan.slot(old.settle)
        frames = [plan.places(each.region, each.interleave) for each in (old, new)]
        if len(frames[0]) * slot > 20_000 or len(frames[1]) * slot > 20_000:
            continue
        # The last clock that is in time is the second before the next frame's first switch.
        moment = START + draw.randrange(len(frames[0]) * slot - 1)
        clocks = START + (len(frames[0]) + len(frames[1])) * slot
        switches, _ = await watch(dut, clocks, moment, lambda new=new: apply(dut, plan, new))
        places = [(row, group) for _, row, group in switches]
        assert places == frames[0] + frames[1], (old, new, moment)
        assert [clock for clock, *_ in switches] == list(range(START, clocks, slot))
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_region_is_taken_whole(dut):
    """What changes in the very clocks in which a frame begins is all of this frame, or all of the next."""
    plan = twin_of(dut)
    top = Region(last_row=0, last_column=0)
    low = Region(first_row=plan.rows - 1, first_column=plan.columns - 1)
    for old, new in ((top, low), (low, top), (Region(), low), (top, Region())):
        frames = [plan.places(region) for region in (old, new)]
        second = START + len(frames[0]) * plan.slot(0)  # clock of its first switch
        for moment in range(second - 3, second + 4):
            await begin(dut, plan, Settings(region=old))
            dut.cfg_enable_i.value = 1
            frame = frames[moment <= second - 2]
            clocks = second + len(frame) * plan.slot(0)
            switches, triggers = await watch(
                dut, clocks, moment, lambda new=new: apply(dut, plan, Settings(region=new))
            )
            places = [(row, group) for _, row, group in switches]
            assert places == frames[0] + frame, (old, new, moment - second)
            told = [frame_of(plan, Settings(region=old))] * len(frames[0])
            told += [frame_of(plan, Settings(region=new if frame is frames[1] else old))] * len(frame)
            assert [trigger[4] for trigger in triggers] == told[: len(triggers)]
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def waits_for_room_and_counts_it(dut):
    plan = twin_of(dut)
    settings = Settings(
        settle=2, slip_period=(plan.slip_slots + 3) * plan.slot(2), slip_places=((0, 0),) * plan.slip_slots
    )
    await begin(dut, plan, settings)
    dut.room_i.value = 0
    dut.cfg_enable_i.value = 1
    clocks = 5 * settings.slip_period
    _, triggers = await watch(dut, START + clocks)
    assert triggers and all(slip for _, slip, *_ in triggers)  # slip goes on
    assert bench.read(dut.held_o) > 0
    await RisingEdge(dut.clk_i)
    dut.room_i.value = 1
    _, triggers = await watch(dut, settings.slip_period)
    assert any(not slip for _, slip, *_ in triggers)
    await RisingEdge(dut.clk_i)
    dut.room_i.value = 0  # in mid-frame, if it has more than three conversions
    held = bench.read(dut.held_o)
    _, triggers = await watch(dut, clocks)
    assert all(slip for clock, slip, *_ in triggers if clock >= plan.slot(2))
    assert bench.read(dut.held_o) > held


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def enable_ends_after_a_whole_frame(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for period in (0, 1, 50):
        for slip in (0, (plan.slip_slots + 2) * plan.slot(1)):
            settings = Settings(
                settle=1, period=period, slip_period=slip, slip_places=((plan.rows - 1, 0),) * plan.slip_slots
            )
            await begin(dut, plan, settings)
            size = len(plan.places())
            dut.cfg_enable_i.value = 1
            on = START + draw.randrange(min(3000, 2 * plan.frame_clocks(1)))
            clocks = on + 3 * plan.frame_clocks(1) + 4 * (slip + plan.slot(1))
            _, triggers = await watch(dut, clocks, on, lambda: setattr(dut.cfg_enable_i, "value", 0))
            frame = [trigger for trigger in triggers if not trigger[1]]
            rounds = [trigger for trigger in triggers if trigger[1]]
            assert len(frame) % size == 0
            assert len(rounds) % plan.slip_slots == 0
            assert dut.idle_o.value == 1
            assert max(clock for clock, *_ in triggers) < on + 3 * plan.frame_clocks(1) + slip
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def recovers_after_reset(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    settings = random_settings(draw, plan)
    await begin(dut, plan, settings)
    dut.cfg_enable_i.value = 1
    for _ in range(6):
        await bench.clocks(dut, draw.randint(1, 4 * plan.slot(settings.settle)))
        await bench.reset(dut)
        clocks = 6 * plan.slot(settings.settle)
        switches, triggers = await watch(dut, clocks)
        agree(plan, settings, clocks, switches, triggers)
        await RisingEdge(dut.clk_i)


BUILDS = [
    {"Rows": 1, "Columns": 1, "Channels": 1, "Cycle": 140, "SettleBits": 8},
    {"Rows": 3, "Columns": 3, "Channels": 3, "Cycle": 40, "Hold": 30, "SlipSlots": 2, "SettleBits": 6},
    {"Rows": 5, "Columns": 24, "Lanes": 2, "Channels": 4, "Cycle": 12, "SlipSlots": 3, "SettleBits": 8},
    {
        "Rows": 16,
        "Columns": 16,
        "Channels": 8,
        "Cycle": 16,
        "GroupBits": 2,
        "SettleBits": 6,
        "PeriodBits": 16,
    },
    {"Rows": 6, "Columns": 17, "Lanes": 8, "Channels": 1, "Cycle": 9, "Hold": 9, "SettleBits": 8},
]


EVIDENCE = {
    "reference": {
        "against": "columns of a region; clocks `by_hand`",
        "test": "tb/frontend/test_front_references.py::test_a_scan_by_hand",
    },
    "equivalence": {
        "size": {"Rows": 5},
        "defined": True,
        "open": ["reset"],
        "reset": {
            "qualifiers": {
                "switch_row_o": "switch_o",
                "switch_group_o": "switch_o",
                "frame_first_row_o": "!done_slip_o",
                "frame_last_row_o": "!done_slip_o",
                "frame_first_beat_o": "!done_slip_o",
                "frame_last_beat_o": "!done_slip_o",
                "frame_interleave_o": "!done_slip_o",
            },
            "since": {"done_*": "trigger_o", "frame_*": "trigger_o"},
        },
    },
    "faults": {"inside": ["scan_adc", "u_plan."]},
}


@pytest.mark.parametrize("parameters", BUILDS, ids=lambda p: "-".join(map(str, p.values())))
def test_scan_plan(parameters):
    bench.run("frontend", "scan_plan", parameters)


ILLEGAL = [
    {"Rows": 0},
    {"Rows": 1025},
    {"Columns": 0},
    {"Columns": 1025},
    {"Lanes": 3},
    {"Channels": 0},
    {"Channels": 9},
    {"Channels": 3},
    {"Hold": 1},
    {"Cycle": 15},
    {"SlipSlots": 0},
    {"SlipSlots": 17},
    {"GroupBits": 0},
    {"SettleBits": 25},
    {"PeriodBits": 33},
]


@pytest.mark.parametrize("parameters", ILLEGAL, ids=str)
def test_refuses_what_cannot_work(parameters):
    (name,) = parameters
    assert f"{name} = " in bench.refuses("scan_plan", parameters)
    twin = next(key for key, port in NAMES.items() if port == name)
    with pytest.raises(ValueError, match=twin):
        ScanPlan(**{twin: parameters[name]})


@pytest.mark.parametrize("interleave", [False, True])
def test_twin_visits_every_place_once(interleave):
    plan = ScanPlan(rows=7, columns=25, lanes=2, channels=4)
    places = plan.places(Region(), interleave)
    assert sorted(places) == [(row, group) for row in range(7) for group in range(4)]
    rows = [row for row, _ in places[::4]]
    assert rows == ([0, 2, 4, 6, 1, 3, 5] if interleave else list(range(7)))
