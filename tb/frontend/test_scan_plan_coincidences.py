"""Events that meet in one clock in msn_scan_plan, with switches and counts worked out by hand from its
header: a frame's tick around its end, enable and room falling in the clock of a switch.

Settle 2: gap = max(7, 20 - 1 - 2) = 17; a slot has 2 + 1 + 17 = 20 clocks, a frame of 3 rows and 3 groups
180. The first switch is 4 clocks after enable.
"""

import itertools

import cocotb

import bench
from frontend.test_scan_plan import apply
from meissner.twins.frontend.scan_plan import Settings

SIZE = {"Rows": 3, "Columns": 5, "Channels": 2, "Hold": 7, "Cycle": 20}
SIZE |= {"SettleBits": 6, "PeriodBits": 16}
PLACES = [(row, group) for row in range(3) for group in range(3)]
FIRST, SLOT, FRAME = 4, 20, 180


async def scene(dut, clocks, room=(), enabled=None, changes=None, **settings):
    """(clock, row, group) of every switch, and the counts. ``room``: clocks without room; ``enabled``: number
    of clocks with enable; ``changes``: {clock: Settings}."""
    apply(dut, Settings(settle=2, **settings))
    dut.cfg_enable_i.value, dut.room_i.value = 0, 1
    await bench.reset(dut)
    await bench.clocks(dut, 6)
    switches, triggers = [], []
    for clock in range(clocks):
        dut.cfg_enable_i.value = int(enabled is None or clock < enabled)
        dut.room_i.value = int(clock not in room)
        if clock in (changes or {}):
            apply(dut, changes[clock])
        await bench.ReadOnly()
        if dut.switch_o.value == 1:
            switches.append((clock, bench.read(dut.switch_row_o), bench.read(dut.switch_group_o)))
        if dut.trigger_o.value == 1:
            triggers.append(clock)
        await bench.RisingEdge(dut.clk_i)
    await bench.ReadOnly()
    counts = tuple(bench.read(getattr(dut, f"{name}_o")) for name in ("overrun", "held"))
    idle = bench.read(dut.idle_o)
    await bench.RisingEdge(dut.clk_i)
    if changes:
        assert min(later - one for one, later in itertools.pairwise(triggers)) >= SIZE["Cycle"]
    else:
        assert triggers == [clock + 3 for clock, *_ in switches if clock + 3 < clocks]
    return switches, counts, idle


def frames(*starts, until=10_000):
    found = [(start + SLOT * n, *place) for start in starts for n, place in enumerate(PLACES)]
    return [switch for switch in found if switch[0] < until]


async def begin(dut):
    await bench.start(dut, cfg_enable_i=0, room_i=1)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_tick_around_a_frames_end(dut):
    """The place after a switch is found in two clocks: up to the second clock after its last switch a frame
    is in progress, and a tick is counted as an overrun and ignored. From the third clock on a tick waits
    until the slot is over."""
    await begin(dut)
    late = 3 * FRAME
    for period, starts, overrun in (
        (FRAME + 1, [4, 185, 366], 0),
        (FRAME, [4, 184, 364], 0),
        (FRAME - 1, [4, 184, 364], 0),  # ticks at 183 and 362 wait
        (FRAME - 17, [4, 184, 493], 1),  # 167, with the last trigger, waits; 330 is counted; next 493
        (FRAME - 18, [4, 328], 1),  # one at 166 is counted; 490 too, but that is later
        (FRAME - 20, [4, 324], 1),  # one at 164, with the last switch, is counted
    ):
        until = {1: 484}.get(overrun, late)
        switches, counts, _ = await scene(dut, until, period=period)
        assert switches == frames(*starts, until=until), period
        assert counts == (overrun, 0), period


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def enable_falls_around_a_frames_first_switch(dut):
    """In the clock of the switch, no frame begins; a clock later the frame is complete. Back to back and by
    ticks."""
    await begin(dut)
    for period, second in ((0, 184), (200, 204)):
        for enabled, starts in ((second - 1, [4]), (second, [4]), (second + 1, [4, second])):
            switches, counts, idle = await scene(dut, 600, period=period, enabled=enabled)
            assert switches == frames(*starts) and counts == (0, 0) and idle == 1, (period, enabled)
    for enabled in (3, 4, 5):  # the very first frame
        switches, _, idle = await scene(dut, 400, enabled=enabled)
        assert switches == (frames(4) if enabled == 5 else []) and idle == 1, enabled


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def room_falls_around_a_switch(dut):
    """The switch comes in the first clock with room; exactly the clocks that it waits are counted."""
    await begin(dut)
    for room, at, held in (
        ([43], 0, 0),
        ([44], 1, 1),
        ([45], 0, 0),
        ([43, 44], 1, 1),
        ([44, 45, 46], 3, 3),
        (range(30, 57), 13, 13),
    ):
        switches, counts, _ = await scene(dut, 140, room=room)
        due = [(4, 0, 0), (24, 0, 1), *((clock + at, *place) for clock, *place in frames(4)[2:])]
        assert switches == [switch for switch in due if switch[0] < 140], room
        assert counts == (0, held), room
    for room, at in (([203], 204), ([204], 205), ([204, 205, 206], 207), ([205], 204)):  # by ticks
        switches, counts, _ = await scene(dut, 380, room=room, period=200)
        assert switches == frames(4, at, until=380) and counts == (0, at - 204), room
    # The next tick, at 404, is counted: the frame of the tick before has just begun, begins, or still waits.
    for start in (403, 404, 405, 430):
        switches, counts, _ = await scene(dut, 480, room=range(203, start), period=200)
        assert switches == frames(4, start, until=480) and counts == (1, start - 204), start


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_setting_is_in_force_from_the_clock_after_on(dut):
    """Settle, period or both changed in a clock around the start of the second frame: a change up to the
    clock before it counts, a later one for the third. Triggers of settle 5 and 0 after the last one at 167
    are 20 clocks apart: switches at 167 + 14 and 167 + 19."""
    await begin(dut)

    async def starts(before, *changes, clocks=700):
        switches, counts, _ = await scene(dut, clocks, changes=dict(changes), period=before)
        assert counts[1] == 0
        return [clock for clock, row, group in switches if (row, group) == (0, 0)]

    for at, second in ((10, 181), (167, 181), (180, 181), (181, 182), (182, 183), (183, 184), (184, 184)):
        assert (await starts(0, (at, Settings(settle=5))))[1] == second, at
    for at, second in ((10, 186), (183, 186), (184, 184), (185, 184)):
        assert (await starts(0, (at, Settings(settle=0))))[1] == second, at
    # By ticks: settle changes nothing but the trigger.
    for at in (190, 203, 204):
        assert await starts(200, (at, Settings(settle=5, period=200))) == [4, 204, 404, 604], at
    # A period from back to back: of the frame before, or at once if that is over; then every 230 clocks.
    for at in (10, 100, 166):
        assert await starts(0, (at, Settings(settle=2, period=230))) == [4, 234, 464, 694], at
    assert await starts(0, (184, Settings(settle=2, period=230))) == [4, 184, 414, 644]
    # A long wait ends: to back to back two clocks later, to a period that is over, and to one that is not.
    assert (await starts(9000, (300, Settings(settle=2)), clocks=400)) == [4, 301]
    assert (await starts(9000, (300, Settings(settle=2, period=250)), clocks=600)) == [4, 302, 552]
    assert (await starts(9000, (210, Settings(settle=2, period=250)), clocks=600)) == [4, 254, 504]
    assert (await starts(9000, (251, Settings(settle=2, period=250)), clocks=600)) == [4, 254, 504]
    # A wait becomes longer, up to the clock before the one in which the tick is decided.
    assert (await starts(200, (201, Settings(settle=2, period=300)), clocks=700)) == [4, 304, 604]


def test_scan_plan_coincidences():
    bench.run("frontend", "scan_plan", SIZE, module="test_scan_plan_coincidences")
