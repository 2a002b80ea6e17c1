"""msn_scan_plan against its twin: every switch and trigger in its clock, with its place.

Random registers over frames (back to back, on a timer with a long enough period and with one that is too
short) in both orders; settle 0 and the maximum; registers that change during a frame; waiting for room;
enable; reset.
"""

import itertools
import random
from dataclasses import replace

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from harness.refusals import refusals
from meissner.twins.frontend.scan_plan import START, ScanPlan, Settings

NAMES = {
    "rows": "Rows",
    "columns": "Columns",
    "lanes": "Lanes",
    "channels": "Channels",
    "hold": "Hold",
    "cycle": "Cycle",
    "settle_bits": "SettleBits",
    "period_bits": "PeriodBits",
}


def twin_of(dut):
    return ScanPlan(**{name: getattr(dut, port).value.to_unsigned() for name, port in NAMES.items()})


def apply(dut, settings):
    """Write ``settings`` to the registers."""
    dut.cfg_settle_i.value = settings.settle
    dut.cfg_period_i.value = settings.period
    dut.cfg_interleave_i.value = int(settings.interleave)


def random_settings(draw, plan):
    settle = draw.choice([0, 1, 2, min(draw.randint(0, 3 * plan.cycle), (1 << plan.settle_bits) - 1)])
    frame = plan.frame_clocks(settle)
    period = draw.choice([0, frame, frame + 1, frame - 1, 3 * frame, max(1, frame // 3)])
    return Settings(settle, period, draw.random() < 0.5)


async def begin(dut, settings):
    apply(dut, settings)
    dut.room_i.value = 1
    await bench.start(dut, cfg_enable_i=0)
    await bench.clocks(dut, 2)


async def watch(dut, clocks, at=None, action=None):
    """Switches and triggers of the next ``clocks`` clocks.

    As [(clock, row, group)] and [(clock, first, group, interleave)].

    ``action`` is called at the beginning of clock ``at``. Ends in the read-only phase of the clock after.
    """
    switches, triggers = [], []
    told = None
    for clock in range(clocks):
        if clock == at:
            action()
        await ReadOnly()
        if told is not None:
            names = ("first", "group", "interleave")
            triggers.append((told, *(bench.read(getattr(dut, f"done_{name}_o")) for name in names)))
            told = None
        if dut.switch_o.value == 1:
            switches.append((clock, bench.read(dut.switch_row_o), bench.read(dut.switch_group_o)))
        if dut.trigger_o.value == 1:
            told = clock
        await RisingEdge(dut.clk_i)
    await ReadOnly()
    return switches, triggers


def agree(plan, settings, clocks, switches, triggers):
    conversions, overrun = plan.schedule(settings, clocks)
    assert switches == [(c.switch, c.row, c.group) for c in conversions], settings
    order = int(settings.interleave)
    expected = [(c.trigger, c.first, c.group, order) for c in conversions if c.trigger < clocks - 1]
    assert triggers[: len(expected)] == expected
    return overrun


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "overrun_o", "held_o", wiggled=["room_i"], again=False, cfg_enable_i=1)


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def counts_on_from_any_value(dut):
    """A tick in each clock, and a buffer that has no room."""
    await bench.start(dut, cfg_enable_i=1, cfg_settle_i=1, cfg_period_i=1, cfg_interleave_i=0, room_i=1)
    await bench.counts_on(dut, "overrun_o")
    await bench.counts_on(dut, "held_o", room_i=0)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def matches_model(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for number in range(bench.rounds(60)):
        settings = random_settings(draw, plan)
        if number % 3 == 2:  # periods of any length
            settings = replace(settings, period=draw.getrandbits(plan.period_bits))
        await begin(dut, settings)
        clocks = min(4000, 3 * plan.frame_clocks(settings.settle) + 200)
        dut.cfg_enable_i.value = 1
        switches, triggers = await watch(dut, clocks)
        overrun = agree(plan, settings, clocks, switches, triggers)
        assert bench.read(dut.overrun_o) == overrun, settings
        assert bench.read(dut.held_o) == 0
        await RisingEdge(dut.clk_i)


@bench.applies(lambda dut: (twin_of(dut).rows, twin_of(dut).columns) == (5, 24))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_period_of_many_clocks_is_exact(dut):
    """With a period bit that the other tests do not set; in one build only, as it takes long."""
    plan = twin_of(dut)
    settings = Settings(settle=0, period=(1 << 19) + 5)
    await begin(dut, settings)
    dut.cfg_enable_i.value = 1
    first, _ = await watch(dut, 200)
    await bench.clocks(dut, settings.period - 200)
    second, _ = await watch(dut, 200)
    assert first == second == [(START + 12 * n, *place) for n, place in enumerate(plan.places())]
    assert bench.read(dut.overrun_o) == 0


@bench.applies(bench.whole)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def every_bit_of_a_period_is_counted(dut):
    """The clocks since a tick are put close to the period, where they pass every bit: 32 bits would take too
    long to wait for. An upset of them costs one tick at most."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    bits = plan.period_bits
    lone = [(1 << bit) + 1 for bit in range(6, bits)]
    some = [draw.getrandbits(bits) | 1 << bits - 1 for _ in range(3 * bits)]
    for period in [*lone, *some]:
        await begin(dut, Settings(period=period))
        dut.cfg_enable_i.value = 1
        await bench.clocks(dut, START + 12)
        dut.since_q.value = period - 3
        seen = []
        for _ in range(7):
            await ReadOnly()
            seen.append((bench.read(dut.since_q), bench.read(dut.zero_q)))
            await RisingEdge(dut.clk_i)
        first = [since for since, _ in seen].index(period - 2)
        assert seen[first:][:4] == [(period - 2, 0), (period - 1, 0), (period, 1), (1, 0)], period


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def largest_settle_and_no_settle(dut):
    plan = twin_of(dut)
    largest = (1 << plan.settle_bits) - 1
    for settle in (0, largest):
        settings = Settings(settle=settle)
        await begin(dut, settings)
        dut.cfg_enable_i.value = 1
        clocks = START + 3 * plan.slot(settle) + 5
        switches, triggers = await watch(dut, clocks)
        agree(plan, settings, clocks, switches, triggers)
        assert {t[0] - s[0] for s, t in zip(switches, triggers)} == {settle + 1}
        assert len(triggers) >= 2
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def registers_change_between_frames_only(dut):
    """Order, settle and period changed inside a frame apply to the next one, also if its first conversion
    needs more or less time before it; its period counts from the frame before."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    for interleave in (False, True):
        for _ in range(10):
            old, new = (random_settings(draw, plan).settle for _ in range(2))
            slot, size, after = plan.slot(old), len(plan.places()), draw.choice((0, 7, 300))
            if size * max(slot, plan.slot(new)) > 20_000:
                continue
            second = START + (size - 1) * slot + max(old + 1 + plan.gap(new), 4)  # 4: to the frame's end
            period = (second - START + after) % (1 << plan.period_bits) if after else 0
            second += after
            await begin(dut, Settings(old, 0, interleave))
            dut.cfg_enable_i.value = 1
            change = Settings(new, period, not interleave)
            moment = draw.randrange(START + 1, START + (size - 1) * slot + 2)
            clocks = second + (size - 1) * plan.slot(new) + 1
            switches, triggers = await watch(dut, clocks, moment, lambda new=change: apply(dut, new))
            due = [START + n * slot for n in range(size)] + [second + n * plan.slot(new) for n in range(size)]
            places = plan.places(interleave) + plan.places(not interleave)
            assert switches == [(clock, *place) for clock, place in zip(due, places)], (old, new, moment)
            settles = [old] * size + [new] * size
            told = [clock + 1 + settle for clock, settle in zip(due, settles)]
            assert [clock for clock, *_ in triggers] == [clock for clock in told if clock < clocks - 1]
            if plan.rows > 1:
                orders = [int(interleave)] * size + [int(not interleave)] * size
                assert [order for *_, order in triggers] == orders[: len(triggers)]
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def triggers_keep_their_distance_whatever_changes(dut):
    """Settle, period, order, room and enable change at random clocks: triggers are never less than Cycle
    clocks apart, every conversion settles for a time that was set, and the scan is alive afterwards."""
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    await begin(dut, Settings(3))
    seen, settles, switch, put = [], set(), None, set()
    for clock in range(12_000):
        if draw.random() < 0.05:
            settings = Settings(draw.choice([0, 1, 2, 5, draw.randrange(40)]), draw.choice([0, 0, 9, 300]))
            put.add(settings.settle)
            apply(dut, replace(settings, interleave=draw.random() < 0.5))
        if draw.random() < 0.01:
            dut.cfg_enable_i.value = draw.randrange(2)
        dut.room_i.value = int(draw.random() < 0.9)
        await ReadOnly()
        if dut.trigger_o.value == 1:
            seen.append(clock)
            settles.add(clock - switch - 1)
        if dut.switch_o.value == 1:
            switch = clock
        await RisingEdge(dut.clk_i)
    apart = [later - one for one, later in itertools.pairwise(seen)]
    assert min(apart) >= plan.cycle and len(seen) > 50
    assert settles <= put | {3} and len(settles) > 3
    apply(dut, Settings(2))
    dut.cfg_enable_i.value = dut.room_i.value = 1
    await bench.clocks(dut, 2 * plan.slot(40) * len(plan.places()) + 600)
    switches, _ = await watch(dut, 3 * plan.slot(2))
    assert [later - one for (one, *_), (later, *_) in itertools.pairwise(switches)] == [plan.slot(2)] * 2


@bench.applies(lambda dut: twin_of(dut).rows > 2)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def the_order_is_that_of_the_first_switch(dut):
    """A change up to the clock of a frame's first switch applies to this frame, a later one to the next."""
    plan = twin_of(dut)
    size, slot = len(plan.places()), plan.slot(0)
    second = START + size * slot
    for old in (False, True):
        for moment in range(second - 3, second + 4):
            await begin(dut, Settings(interleave=old))
            dut.cfg_enable_i.value = 1
            switches, triggers = await watch(
                dut, second + size * slot, moment, lambda old=old: apply(dut, Settings(interleave=not old))
            )
            order = not old if moment <= second else old
            places = [(row, group) for _, row, group in switches]
            assert places == plan.places(old) + plan.places(order), (old, moment - second)
            told = [int(old)] * size + [int(order)] * size
            assert [trigger[3] for trigger in triggers] == told[: len(triggers)]
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def ticks_without_room_are_overruns(dut):
    """The first tick waits; of the others, one every 1, 2, 3 or 7 clocks, each is counted."""
    for period in (1, 2, 3, 7):
        await begin(dut, Settings(settle=1, period=period))
        dut.room_i.value = 0
        dut.cfg_enable_i.value = 1
        switches, _ = await watch(dut, START + 50)
        counted = {1: 48, 2: 24, 3: 16, 7: 6}[period]  # of clock 49, a tick of 1 and 7, a clock later
        assert not switches and bench.read(dut.overrun_o) == counted, period
        await RisingEdge(dut.clk_i)
        dut.rst_i.value = 1  # a tick and a wait in the clock of the reset are not counted after it
        await RisingEdge(dut.clk_i)
        dut.rst_i.value = 0
        await bench.clocks(dut, 3)
        await ReadOnly()
        assert (bench.read(dut.overrun_o), bench.read(dut.held_o)) == (0, 0)
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def waits_for_room_and_counts_it(dut):
    plan = twin_of(dut)
    slot, size = plan.slot(2), len(plan.places())
    await begin(dut, Settings(settle=2))
    dut.room_i.value = 0
    dut.cfg_enable_i.value = 1
    switches, _ = await watch(dut, START + 5 * slot)
    assert not switches and bench.read(dut.held_o) == 5 * slot - 1  # the last clock is counted a clock later
    await RisingEdge(dut.clk_i)
    dut.room_i.value = 1
    switches, _ = await watch(dut, 4)
    assert [switch[0] for switch in switches] == [0] and bench.read(dut.held_o) == 5 * slot + 1
    await RisingEdge(dut.clk_i)
    dut.room_i.value = 0  # in mid-frame, if a frame has more than one conversion
    switches, _ = await watch(dut, 3 * slot)
    assert not switches and bench.read(dut.held_o) == 5 * slot + 1 + 3 * slot - (slot - 5) - 1
    await RisingEdge(dut.clk_i)
    dut.room_i.value = 1
    switches, _ = await watch(dut, 1)
    assert switches == [(0, *plan.places()[1 % size])]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def enable_ends_after_a_whole_frame(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    size, frame = len(plan.places()), plan.frame_clocks(1)
    for period in (0, 1, 50):
        await begin(dut, Settings(settle=1, period=period))
        dut.cfg_enable_i.value = 1
        on = START + draw.randrange(min(3000, 2 * frame))
        clocks = on + 3 * frame + 4 * plan.slot(1)
        _, triggers = await watch(dut, clocks, on, lambda: setattr(dut.cfg_enable_i, "value", 0))
        assert len(triggers) % size == 0
        assert dut.idle_o.value == 1
        assert all(clock < on + 2 + frame for clock, *_ in triggers)
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def goes_on_after_an_upset_of_its_state(dut):
    """In any clock of a conversion, also to the code that no state has: whole frames follow, in order."""
    plan = twin_of(dut)
    slot, size = plan.slot(2), len(plan.places())
    await begin(dut, Settings(settle=2))
    dut.cfg_enable_i.value = 1
    for clock, code in itertools.product((*range(8), slot - 1), range(4)):
        await bench.clocks(dut, slot + clock)
        dut.state_q.value = code
        await bench.clocks(dut, 4 * slot)
        switches, _ = await watch(dut, (size + 2) * slot)
        places = [(row, group) for _, row, group in switches]
        start = plan.places().index(places[0])
        expected = (plan.places() * 3)[start:][: len(places)]
        assert places == expected and len(places) >= size + 1, (clock, code)
        await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def recovers_after_reset(dut):
    plan = twin_of(dut)
    draw = random.Random(bench.SEED)
    settings = random_settings(draw, plan)
    await begin(dut, settings)
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
    {"Rows": 3, "Columns": 3, "Channels": 3, "Cycle": 40, "Hold": 30, "SettleBits": 6},
    {"Rows": 5, "Columns": 24, "Lanes": 2, "Channels": 4, "Cycle": 12, "SettleBits": 8},
    {"Rows": 16, "Columns": 16, "Channels": 8, "Cycle": 16, "SettleBits": 6, "PeriodBits": 16},
    {"Rows": 3, "Columns": 64, "Lanes": 7, "Channels": 3, "Cycle": 11, "SettleBits": 6},
    {"Rows": 6, "Columns": 17, "Lanes": 8, "Channels": 1, "Cycle": 9, "Hold": 9, "SettleBits": 8},
]


EVIDENCE = {
    "equivalence": {"size": {"Rows": 5}, "defined": True},
    "faults": {"inside": ["scan_adc", "u_plan."]},
}


@pytest.mark.parametrize("parameters", BUILDS, ids=lambda p: "-".join(map(str, p.values())))
def test_scan_plan(parameters):
    bench.run("frontend", "scan_plan", parameters)


test_refuses_illegal_parameters = refusals(
    "scan_plan",
    ScanPlan,
    *({"Rows": 0}, {"Rows": 1025}, {"Columns": 0}, {"Columns": 1025}, {"Lanes": 9}, {"Channels": 0}),
    *({"Channels": 9}, {"Hold": 1}, {"Cycle": 15}, {"SettleBits": 25}, {"PeriodBits": 33}),
)


@pytest.mark.parametrize("interleave", [False, True])
def test_twin_visits_every_place_once(interleave):
    plan = ScanPlan(rows=7, columns=25, lanes=2, channels=4)
    places = plan.places(interleave)
    assert sorted(places) == [(row, group) for row in range(7) for group in range(4)]
    rows = [row for row, _ in places[::4]]
    assert rows == ([0, 2, 4, 6, 1, 3, 5] if interleave else list(range(7)))
