"""msn_grip against the loop of tb/reference/grip.py, written from docs/grip.md, clock by clock: both rules
and modes, with and without `immediate`, slip that starts, lasts and ends, fingers that become silent or
unhealthy, changes of settings, overrides, resets during a grip; against its model; by hand: clocks, limits,
watchdog, the effect of a reset. The model against the same loop, and the limits of its settings."""

import random
from dataclasses import replace
from itertools import permutations

import cocotb
import pytest

import bench
from meissner.twins.actuate.grip import Command, Grip, GripConfig
from reference.grip import LATENCY, GripLoop

NAMES = ("period", "step", "speed_gain", "decay", "minimum", "maximum", "rate", "watchdog", "rule", "mode")
NAMES += ("immediate", "override", "override_value", "boost")
QUIET = {"over_valid_i": 0, "over_id_i": 0, "over_i": 0, "over_end_i": 1, "speed_valid_i": 0, "speed_id_i": 0}
QUIET |= {"speed_ok_i": 1, "speed_i": 0}
PUTS = []  # functions that write the inputs of QUIET, in its order, and healthy_i
HAND = {"period": 20, "step": 7, "speed_gain": 0, "decay": 3, "minimum": 30, "maximum": 100, "rate": 11}
HAND |= {"watchdog": 4, "rule": 0, "mode": 0, "immediate": 0, "override": 0, "override_value": 0, "boost": 0}
RESET = {"word": 0, "increment": 0, "command": 0, "fault": 16, "faulty": 0}


def sizes(dut):
    """Fingers, bits of the command, shift of the speed's product."""
    return [getattr(dut, name).value.to_unsigned() for name in ("Fingers", "CommandBits", "SpeedShift")]


def drive(dut, **settings):
    for name, value in settings.items():
        getattr(dut, f"cfg_{name}_i").value = int(value)


async def begin(dut, **settings):
    """Reset with these settings; returns in the first clock after the reset."""
    everyone = (1 << sizes(dut)[0]) - 1
    inputs = {f"cfg_{name}_i": int(value) for name, value in settings.items()}
    await bench.start(dut, healthy_i=everyone, **QUIET, **inputs)
    PUTS[:] = [bench.putter(getattr(dut, name)) for name in (*QUIET, "healthy_i")]


async def clock(dut, decision=None, speed=None, healthy=None):
    """Run one clock with these inputs; return the outputs in it."""
    slip = decision or (0, 1, 1)  # must not be read without valid
    values = [decision is not None, *slip, speed is not None, *(speed or (0, 1, 1))]
    if healthy is not None:
        values.append(sum(well << finger for finger, well in enumerate(healthy)))
    for put, value in zip(PUTS, values):
        put(int(value))
    await bench.ReadOnly()
    got = outputs(dut)
    await bench.RisingEdge(dut.clk_i)
    return got


def outputs(dut):
    signed = lambda port: bench.as_signed(bench.read(port), len(port))
    return {
        "valid": bench.read(dut.out_valid_o),
        "command": bench.read(dut.out_command_o),
        "word": signed(dut.out_word_o),
        "increment": signed(dut.out_increment_o),
        "fault": bench.read(dut.fault_o),
        "faulty": bench.read(dut.faulty_o),
    }


def settings_at_random(draw, dut, **fixed):
    """Settings of every size, with the limits mostly in order; periods short enough for many cycles."""
    _, bits, _ = sizes(dut)
    top, gain = 2**bits - 1, 2 ** len(dut.cfg_speed_gain_i) - 1
    small = lambda most: draw.choice([0, 1, draw.randint(0, most // 50), draw.randint(0, most), most])
    low, high = sorted((small(top), draw.choice([top, top - 1, draw.randint(0, top)])))
    if draw.random() < 0.1:
        low, high = high, low
    found = {name: small(top) for name in ("step", "decay", "rate", "override_value")}
    found |= {
        "minimum": low,
        "maximum": high,
        "speed_gain": small(gain),
        "watchdog": draw.choice([0, 1, 2, 5]),
    }
    found |= {"period": draw.choice([0, 15, 16, 17, 23, 31]), "override": draw.random() < 0.2}
    found["boost"] = draw.choice([0, 0, 1, 2, 6, 7])
    if draw.random() < 0.3:  # wide limits, so that all sums of windows show
        step = draw.randint(0, top // 4 >> draw.choice([0, found["boost"]]))
        found |= {"step": step, "minimum": 0, "maximum": top, "rate": top}
    return found | fixed


def stimulus(draw, fingers, ids, top_speed):
    """(decision, speed, healthy) of each clock: times in which fingers slip, hold, are silent or
    unhealthy."""
    while True:
        slipping = [draw.choice([0, 0, 0.3, 1]) for _ in range(fingers)]
        silent = [draw.random() < 0.15 for _ in range(fingers)]
        ill = [draw.choice([0, 0, 0, 0, 0.1, 1]) for _ in range(fingers)]
        often, ends, speedy = draw.choice([0.02, 0.2, 0.7]), draw.choice([0.1, 0.5, 1]), draw.choice([0, 0.2])
        for _ in range(draw.choice([30, 150, 400])):
            decision = speed = None
            finger = draw.randrange(ids)
            if draw.random() < often and not (finger < fingers and silent[finger]):
                over = finger >= fingers or draw.random() < slipping[finger]
                decision = finger, over, draw.random() < ends
            if draw.random() < speedy:
                value = draw.choice([0, 1, draw.randint(0, top_speed), top_speed])
                speed = draw.randrange(ids), draw.random() < 0.8, value
            yield decision, speed, [draw.random() >= share for share in ill]


@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(rule=[0, 1], mode=[0, 1], immediate=[0, 1])
async def matches_the_loop(dut, rule, mode, immediate):
    """Repeated resets with other settings; some settings also change in between, where no cycle is near."""
    fingers, bits, shift = sizes(dut)
    draw = random.Random(bench.SEED * 8 + 4 * rule + 2 * mode + immediate)
    ids, top_speed = 1 << len(dut.over_id_i), 2 ** len(dut.speed_i) - 1
    kinds = {"rule": rule, "mode": mode, "immediate": immediate}
    feed, seen, started, turns = stimulus(draw, fingers, ids, top_speed), set(), False, 0
    for _ in range(30):
        settings = settings_at_random(draw, dut, **kinds, override=draw.random() < (0.8 if mode else 0.2))
        if started:
            drive(dut, **settings)
            await bench.reset(dut)
        else:
            await begin(dut, **settings)
            started = True
        loop = GripLoop(fingers, bits, shift, **settings)
        calm, due, shown = 0, {}, RESET
        for now in range(draw.choice([5, 250, 700])):
            decision, speed, healthy = next(feed)
            if loop.last_cycle < now - 5 and loop.in_period == 9 and draw.random() < 0.3:
                calm = now + 6
                changed = settings_at_random(draw, dut, **kinds, period=loop.period) | {"mode": loop.mode}
                keep = draw.sample(sorted(changed), 8)
                loop.settings |= {name: changed[name] for name in keep}
                drive(dut, **loop.settings)
            decision = None if now < calm else decision
            if turn := draw.random() < 0.008:  # in any clock; often there and back before a command
                loop.settings["mode"] ^= 1
                drive(dut, mode=loop.mode)
            ended = loop.clock(decision, speed, healthy)
            if ended:
                due[now + LATENCY] = ended
            valid = 0
            if now in due:
                shown = due.pop(now)
                valid = shown["valid"]
                seen.add((shown["fault"], (shown["increment"] > 0) - (shown["increment"] < 0)))
            got = await clock(dut, decision, speed, healthy)
            assert got == shown | {"valid": valid}, f"clock {now} with {loop.settings}"
            if turn:
                turns, due, shown = turns + 1, {}, RESET
    assert turns > 20
    assert {fault & 1 for fault, _ in seen} == {fault >> 1 & 1 for fault, _ in seen} == {0, 1}
    assert {fault >> 2 & 1 for fault, _ in seen} == {fault >> 3 & 1 for fault, _ in seen} == {0, 1}
    assert {sign for _, sign in seen} == {-1, 0, 1}


@bench.applies(lambda dut: sizes(dut) == [2, 16, 8])
@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(rule=["any", "weakest"], mode=["position", "force"])
async def matches_model(dut, rule, mode):
    """Period by period, with decisions and speeds in its middle."""
    draw = random.Random(bench.SEED)
    config = GripConfig(40, 900, 3000, 170, 2000, 41000, 3333, 3, rule, mode, boost=1)
    await begin(dut, **config.settings, override=mode == "force", override_value=7777)
    twin, expected, got = Grip(config), [], []
    for period in range(400):
        rates = [(0, 0), (0.4, 0.2), (1, 1), (0, 0.5), (0.1, 0)][period // 20 % 5]
        silent = period // 20 % 7 == 6
        events = {n: (draw.randrange(2), draw.random(), draw.random() < 0.7) for n in range(4, 30, 3)}
        events = {
            n: (f, share < rates[f], end) for n, (f, share, end) in events.items() if not (f and silent)
        }
        speeds = {1: (0, draw.random() < 0.8, draw.randrange(1 << 16)), 33: (1, True, draw.randrange(900))}
        ill = draw.randrange(2) if draw.random() < 0.1 else None
        for n in range(40):
            found = await clock(dut, events.get(n), speeds.get(n), [f != ill or n != 20 for f in range(2)])
            if n == 3 and period:  # of the previous period
                got.append(
                    Command(*(found[name] for name in ("increment", "command", "fault", "valid", "word")))
                )
            if n == 3:
                dut.cfg_override_i.value = 0 if period else int(mode == "force")
            if n - 3 in speeds:
                finger, ok, value = speeds[n - 3]
                twin.report(finger, value if ok else None)
            if n in events:
                twin.decision(*events[n])
        command = twin.cycle([f != ill for f in range(2)], 7777 if mode == "force" and not period else None)
        expected.append(replace(command, faulty=()))
    assert got == expected[:-1]
    assert {command.increment for command in got} >= {-170, 0, 3333}


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def four_clocks_from_a_decision_to_its_command(dut):
    """In the last clock of a period; immediately with `immediate`; 5 if the period's end has just given a
    command."""
    await begin(dut, **HAND)
    last = sizes(dut)[0] - 1
    for now in range(20 + 20 + 4):
        got = await clock(dut, (last, 1, 1) if now == 39 else None)
        assert got["valid"] == (now in (23, 43))
    assert (got["increment"], got["command"], got["word"]) == (7, 37, 7)
    drive(dut, immediate=1)
    await bench.reset(dut)
    # Period 20 .. 39 has its cycle at 27, 40 .. 59 at its end; a decision a clock later waits one clock.
    decisions, commands = (27, 60, 65), {}
    for now in range(90):
        got = await clock(dut, (last, 1, 1) if now in decisions else None)
        if got["valid"]:
            commands[now] = got["increment"]
    assert commands == {19 + 4: 0, 27 + 4: 7, 59 + 4: 0, 60 + 5: 7, 80 + 4: 7}


async def at(dut, clock):
    """The outputs before ``clock`` and in it, counted from the reset that has just ended."""
    await bench.clocks(dut, clock - 1)
    found = []
    for _ in range(2):
        await bench.ReadOnly()
        found.append(outputs(dut))
        await bench.RisingEdge(dut.clk_i)
    return found


@bench.applies(bench.whole)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_period_has_all_its_clocks(dut):
    """The first command comes three clocks after the first period's last clock. A long period is waited for
    from 40 clocks before its end on."""
    await begin(dut, **HAND)
    bits = len(dut.cfg_period_i)
    top = (1 << bits) - 1
    for period in [1 << bit for bit in range(4, bits)] + [top, top & 0x5A5A5A, top & 0xA5A5A5]:
        dut.cfg_period_i.value = period
        await bench.reset(dut)
        skipped = max(0, period - 10_000)
        if skipped:
            await bench.clocks(dut, 3)
            dut.clocks.value = 3 + skipped
        before, after = await at(dut, period + 3 - skipped - (3 if skipped else 0))
        assert (before["valid"], after["valid"]) == (0, 1), period


@bench.applies(lambda dut: len(dut.cfg_watchdog_i) == 16 and sizes(dut)[0] == 2)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_watchdog_waits_for_all_its_cycles(dut):
    """Nobody reports: the fault comes with exactly so many cycles of 16 clocks."""
    await begin(dut, **HAND)
    for watchdog in [1 << bit for bit in range(1, 16)] + [4097]:
        drive(dut, period=16, watchdog=watchdog)
        await bench.reset(dut)
        before, after = await at(dut, 16 * watchdog + 3)
        assert (before["fault"], after["fault"]) == (0, 1), watchdog


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_window_counts_once_with_its_first_detail_over(dut):
    """Three windows of 3, 4 and 3 details; the third begins in one cycle and ends in the next but one."""
    await begin(dut, **HAND)
    everyone, period = range(sizes(dut)[0]), []
    # (over, end) of every finger, one per clock
    details = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 0), (0, 0), (1, 1), (1, 0)]  # the last window stays open
    for cycle in range(5):
        now = 0
        told = {0: [], 1: details, 2: [(1, 0)], 3: [(0, 1)], 4: []}[cycle]
        queue = [(finger, *detail) for detail in told for finger in everyone]
        dut.cfg_period_i.value = length = max(20, len(queue) + 3)
        if cycle:
            for now in range(length):
                got = await clock(dut, queue.pop(0) if queue else None)
                if now == 3:
                    period.append(got["increment"])
                    assert got["valid"] == 1
        else:
            await bench.reset(dut)
            await bench.clocks(dut, length)
    # The first command; three windows add 21, of which the rate allows 11; the open window goes on over but
    # was already counted, so the grip holds; all fingers were heard and none was over, so it decays.
    assert period == [0, 11, 0, -3]


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def windows_over_that_follow_each_other_double_the_step(dut):
    """Up to 2^boost; a window that is not over ends the row; without a decision the row stays."""
    fingers, bits, _ = sizes(dut)
    top = (1 << bits) - 1
    last = fingers - 1
    await armed(dut, step=1, decay=0, maximum=top, rate=top, boost=3)
    found, _ = await cycles(dut, 7, over=[last])
    assert found == [0, 1, 2, 4, 8, 8, 8]
    found, _ = await cycles(dut, 3)
    assert found == [8, 0, 0]
    found, _ = await cycles(dut, 3, over=[last])
    assert found == [0, 1, 2]
    found, _ = await cycles(dut, 2, silent=[last])
    assert found == [4, 0]
    found, _ = await cycles(dut, 3, over=[last])
    assert found == [0, 8, 8]
    drive(dut, boost=7)  # six in a row so far
    found, _ = await cycles(dut, 3, over=[last])
    assert found == [8, 64, 128]
    drive(dut, boost=0)
    found, got = await cycles(dut, 2, over=[last])
    assert found == [128, 1] and got["fault"] == 0
    if fingers > 1:  # each finger counts its own row
        drive(dut, boost=2)
        found, _ = await cycles(dut, 2, over=[0, last])
        assert found == [1, 4]
        await cycles(dut, 1, over=[0])
        found, _ = await cycles(dut, 2, over=[last])
        assert found == [4, 1]


@bench.applies(lambda dut: sizes(dut)[0] > 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_row_is_the_same_whatever_row_another_finger_has(dut):
    """Two fingers take turns; the one that is not heard keeps its row."""
    fingers, bits, _ = sizes(dut)
    top = (1 << bits) - 1
    for pair in permutations(range(fingers), 2):
        await armed(dut, step=1, decay=0, maximum=top, rate=top, boost=7, watchdog=7)
        found = []
        for turn, count in enumerate((3, 3, 1, 1, 1, 1)):
            heard, other = pair[turn % 2], pair[1 - turn % 2]
            found += (await cycles(dut, count, over=[heard], silent=[other]))[0]
        found += (await cycles(dut, 1))[0]
        assert found == [0, 1, 2, 4, 1, 2, 4, 8, 8, 16, 16], pair


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_window_of_many_decisions_is_one_in_a_row(dut):
    """Three windows of three details, each with a detail over, one without, and one more over."""
    await armed(dut, step=1, decay=0, rate=100, boost=7)
    windows = ((1, 1, 1), (0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 1, 0))
    found = []
    for window in windows:
        details = [(0, over, place == 2) for place, over in enumerate(window)]
        for now in range(20):
            got = await clock(dut, details[now - 8] if 8 <= now < 11 else None)
            if now == 3:
                found.append(got["increment"])
    await bench.clocks(dut, 4)
    found.append(outputs(dut)["increment"])
    assert found == [0, 1, 2, 4, 0, 1]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def nine_windows_of_the_largest_step_are_the_largest_wish(dut):
    """The ninth window adds 128 steps of the largest command to the largest sum before it."""
    top = (1 << sizes(dut)[1]) - 1
    await armed(dut, step=top, decay=0, maximum=top, rate=top, boost=7)
    found = []
    for cycle in range(2):
        for now in range(20):
            got = await clock(dut, (0, 1, 1) if not cycle and 8 <= now < 17 else None)
            if now == 3:
                found.append(got["increment"])
    assert found == [0, top - 30]


async def cycles(dut, count, over=(), silent=(), ill=()):
    """``count`` periods of 20 clocks in which each finger is heard; returns the increments and the last
    outputs."""
    fingers, found = range(sizes(dut)[0]), []
    for _ in range(count):
        for now in range(20):
            finger = now - 8
            decision = (finger, finger in over, 1) if finger in set(fingers) - set(silent) else None
            got = await clock(dut, decision, healthy=[finger not in ill for finger in fingers])
            if now == 3:
                found.append(got["increment"])
    return found, got


async def armed(dut, **settings):
    """Start and wait for the first command, at the minimum; the next clock is the first of a period."""
    await begin(dut, **HAND | settings)
    _, got = await cycles(dut, 2)
    assert (got["command"], got["fault"], got["increment"]) == (30, 0, 0)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def stops_at_its_limits(dut):
    """Constant slip, then none. 30 + 10 · 7 = 100 meets the limit; then the limit is one less, and one
    more."""
    await armed(dut)
    found, got = await cycles(dut, 11, over=[0])
    assert found == [0] + [7] * 10 and (got["command"], got["fault"]) == (100, 4)
    found, got = await cycles(dut, 3, over=[0])
    assert found == [0, 0, 0] and (got["command"], got["fault"]) == (100, 4)
    drive(dut, decay=10)
    found, got = await cycles(dut, 9)
    assert found == [0, *[-10] * 7, 0] and (got["command"], got["fault"]) == (30, 0)
    drive(dut, maximum=99)
    found, got = await cycles(dut, 11, over=[0])
    assert found == [0, *[7] * 9, 6] and (got["command"], got["fault"]) == (99, 4)
    drive(dut, maximum=101)  # set while the previous period's command is computed, which already uses it
    found, got = await cycles(dut, 2, over=[0])
    assert found == [2, 0] and (got["command"], got["fault"]) == (101, 4)
    drive(dut, decay=12)  # more than the rate of 11
    found, got = await cycles(dut, 9)
    assert found == [0, *[-11] * 6, -5, 0] and got["command"] == 30


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_dead_converter_holds_and_is_reported(dut):
    """No decision, and not one step of decay; the fault comes with the fourth cycle."""
    await armed(dut)
    everyone = range(sizes(dut)[0])
    await cycles(dut, 6, over=everyone)
    found, got = await cycles(dut, 1)
    before = got["command"]
    found, got = await cycles(dut, 4, silent=everyone)
    assert found == [-3, 0, 0, 0] and (got["command"], got["fault"]) == (before - 3, 0)
    found, got = await cycles(dut, 1, silent=everyone)
    assert found == [0] and (got["command"], got["fault"]) == (before - 3, 1)
    found, got = await cycles(dut, 300, silent=everyone)
    assert set(found) == {0} and (got["command"], got["fault"]) == (before - 3, 1)
    assert got["faulty"] == (1 << len(everyone)) - 1
    found, got = await cycles(dut, 1)
    assert got["fault"] == 1
    found, got = await cycles(dut, 1)
    assert found == [-3] and got["fault"] == 0 and got["faulty"] == 0


@bench.applies(lambda dut: sizes(dut)[0] > 1)
@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_faulty_finger_takes_no_part_and_stops_the_decay(dut):
    """Windows of an unhealthy finger have no effect, those of others have, and nothing decays; with both
    rules."""
    await armed(dut)
    others = range(1, sizes(dut)[0])
    await cycles(dut, 3, over=others)
    for weakest in (0, 1):
        drive(dut, rule=weakest)
        found, got = await cycles(dut, 4, over=[0], ill=[0])
        assert found[1:] == [0, 0, 0] and (got["fault"], got["faulty"]) == (2, 1)
        found, got = await cycles(dut, 3, over=others, ill=[0])
        assert found == [0, 7, 7] and got["fault"] == 2
        found, got = await cycles(dut, 3)
        assert found == [7, -3, -3] and got["fault"] == 0
    found, got = await cycles(dut, 3, ill=[0])
    assert found == [-3, 0, 0] and got["fault"] == 2
    await cycles(dut, 1)
    # One finger slips alone: by the weakest rule the hand holds its grip and does not open.
    found, got = await cycles(dut, 4, over=[0])
    assert found == [-3, 0, 0, 0]
    drive(dut, rule=0)
    found, got = await cycles(dut, 3, over=[0])
    assert found == [7, 7, 7]


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(weakest=[0, 1])
async def the_only_finger_that_works_decides(dut, weakest):
    """A window of it adds the step: 0, the largest, and the largest with each bit cleared."""
    fingers, bits, _ = sizes(dut)
    top = (1 << bits) - 1
    await begin(dut, **HAND | {"rule": weakest, "minimum": 0, "maximum": top, "rate": top})
    for finger in range(fingers):
        ill = set(range(fingers)) - {finger}
        for step in [0, top, *(top - (1 << bit) for bit in range(bits))]:
            drive(dut, step=step)
            await bench.reset(dut)
            await cycles(dut, 1)
            await cycles(dut, 1, over=[finger], ill=ill)
            found, got = await cycles(dut, 1)
            assert found == [step] and got["command"] == step


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def a_reset_in_a_grip_moves_nothing(dut):
    """Position: an increment of 0. Force: no word until an override sets the force that the hand has."""
    await armed(dut)
    await cycles(dut, 5, over=[0])
    await bench.reset(dut)
    await bench.ReadOnly()
    assert outputs(dut) == RESET | {"valid": 0}
    await bench.RisingEdge(dut.clk_i)
    await bench.clocks(dut, 19)
    found, got = await cycles(dut, 2, over=[0])
    assert found == [0, 7] and (got["command"], got["word"], got["fault"]) == (37, 7, 0)

    drive(dut, mode=1)
    await bench.reset(dut)
    for _ in range(50):
        got = await clock(dut, (0, 1, 1))
        assert (got["valid"], got["fault"]) == (0, 16)
    drive(dut, override=1, override_value=77)
    valid = 0
    while not valid:
        got = await clock(dut)
        valid = got["valid"]
    assert (got["word"], got["increment"], got["fault"]) == (77, 0, 0)
    drive(dut, override_value=90)
    await bench.clocks(dut, 20)
    await bench.ReadOnly()
    assert outputs(dut)["word"] == 88  # limited by the rate, now that there is a command
    await bench.RisingEdge(dut.clk_i)
    for mode in (0, 1, 0):  # another mode is a reset, also without a command in between
        drive(dut, override=0, mode=mode)
        await clock(dut)
        await bench.ReadOnly()
        assert outputs(dut) == RESET | {"valid": 0}
        await bench.RisingEdge(dut.clk_i)
        await bench.clocks(dut, 19)
        found, got = await cycles(dut, 3, over=[0])
        assert (found, got["command"], got["fault"]) == (([0, 0, 0], 0, 16) if mode else ([0, 7, 7], 44, 0))


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(before=[0, 1], ill=[0, 1])
async def a_faulty_fingers_speed_counts_for_no_decision_after_its_cycle(dut, before, ill):
    """A window in the last clock before the cycle, or in its first, of a finger whose speed adds 5."""
    _, bits, shift = sizes(dut)
    top, half = (1 << bits) - 1, 1 << len(dut.cfg_speed_gain_i) - 1
    gain, speed = (half, 5 * 2**shift // half) if 2**shift >= half else (2**shift, 5)
    await armed(dut, decay=0, maximum=top, rate=top, speed_gain=gain)
    found = []
    for now in range(64):
        report = (0, 1, speed) if now == 4 else None
        well = [not (ill and now == 10)] * sizes(dut)[0]
        got = await clock(dut, (0, 1, 1) if now == 20 - before else None, report, well)
        if now in (23, 43, 63):
            found.append(got["increment"])
    assert found == [before and not ill and 12, 0 if before else 7 if ill else 12, 0]


@bench.applies(bench.whole)
@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(mode=[0, 1])
async def an_upset_of_the_last_commands_mode_moves_nothing(dut, mode):
    """Each of its bits, in mid-period: the next command follows the last one and corrects the mode."""
    await begin(dut, **HAND | {"mode": mode, "override": mode, "override_value": 30})
    await cycles(dut, 2)
    drive(dut, override=0)
    found, got = await cycles(dut, 2, over=[0])
    assert (found, got["command"]) == ([0, 7], 37)
    right = bench.read(dut.given)
    for bit in range(len(dut.given)):
        await bench.clocks(dut, 5)
        dut.given.value = right ^ 1 << bit
        await bench.clocks(dut, 15)
        found, got = await cycles(dut, 2, over=[0])
        assert (found, got["command"], got["fault"]) == ([0, 7], 51 + 14 * bit, 0)
        assert bench.read(dut.given) == right


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    names = ("out_valid_o", "out_command_o", "out_increment_o", "out_word_o", "faulty_o")
    await bench.inputs_in_reset(dut, *names)


EVIDENCE = {
    "equivalence": {"size": {"Fingers": 3}},
    "faults": {
        "settle": 40,
        "driver": {"frame": "over_valid_i", "kept": "out_command_o goal term speed_valid clocks last_clock"},
    },
}

SMALL = {"Fingers": 3, "CommandBits": 9, "PeriodBits": 6, "TimerBits": 3, "SpeedBits": 12, "GainBits": 7}


@pytest.mark.parametrize("parameters", [{}, SMALL | {"SpeedShift": 9}, {"Fingers": 1, "SpeedShift": 0}])
def test_grip(parameters):
    bench.run("actuate", "grip", parameters)


def test_refuses_illegal_parameters():
    for name, wrong in {"Fingers": 9, "CommandBits": 1, "PeriodBits": 4, "TimerBits": 32}.items():
        assert f"{name} = {wrong} must" in bench.refuses("grip", {name: wrong})
    for name, wrong in {"SpeedBits": 18, "GainBits": 18, "SpeedShift": 32}.items():
        assert f"{name} = {wrong} must" in bench.refuses("grip", {name: wrong})


@pytest.mark.parametrize("rule", ["any", "weakest"])
@pytest.mark.parametrize("mode", ["position", "force"])
def test_model_against_the_loop(rule, mode):
    """Cycle by cycle with random counts, 60 settings, three fingers and one id without a finger; a cycle is a
    period of the loop."""
    draw = random.Random(f"{bench.SEED} {rule} {mode}")
    signs = set()
    for _ in range(60):
        small = lambda most: draw.choice([0, draw.randint(0, most // 100), draw.randint(0, most), most])
        low, high = sorted((small(65535), small(65535)))
        values = [small(65535) for _ in range(4)]
        config = GripConfig(40, *values[:3], low, high, values[3], draw.randint(1, 4), rule, mode)
        config = replace(config, boost=draw.choice([0, 1, 3, 7]))
        twin = Grip(config, 3)
        loop = GripLoop(3, 16, 8, **config.settings, override=0, override_value=0)
        for _ in range(80):
            seen = [draw.choice([0, 1, 1, 3]) for _ in range(3)]
            over = [draw.randint(0, count) if draw.random() < 0.4 else 0 for count in seen]
            speed = [draw.choice([None, small(65535)]) for _ in range(3)]
            healthy = [draw.random() < 0.95 for _ in range(3)]
            override = draw.choice([None] * 5 + [small(65535)])
            loop.settings |= {"override": override is not None, "override_value": override or 0}
            decisions = [(f, n < over[f], True) for f in range(3) for n in range(seen[f])]
            for now in range(40):
                report = (now, speed[now] is not None, speed[now] or 0) if now < 3 else None
                report = (3, True, 65535) if now == 3 else report
                decision = decisions.pop(0) if now > 8 and decisions else None
                decision = (3, True, False) if now == 8 else decision
                ended = loop.clock(decision, report, healthy if now == 30 else None)
            twin.report(3, 65535)
            twin.decision(3, True, False)
            found = twin.next(over, healthy, seen, speed, override)
            faulty = sum(bad << finger for finger, bad in enumerate(found.faulty))
            assert {name: getattr(found, name) for name in ended} | {"faulty": faulty} == ended
            signs.add((found.increment > 0) - (found.increment < 0))
    assert signs == {-1, 0, 1}


def test_model_by_hand():
    """Two fingers at step 100, gain 512: a speed of 25 adds 50. Three windows of the first are 450, of which
    the rate allows 400; then the decay of 7, and a hold while the second finger is not heard."""
    config = GripConfig(step=100, speed_gain=512, decay=7, minimum=1000, maximum=1500, rate=400, watchdog=2)
    grip = Grip(config)
    command = lambda **given: grip.next(**given)
    assert command(over=[3, 0]) == Command(0, 1000, 0, True, 0, (False, False))
    assert command(over=[3, 0], speed=[25, None]) == Command(400, 1400, 0, True, 400, (False, False))
    assert command(over=[0, 0]) == Command(-7, 1393, 0, True, -7, (False, False))
    assert command(over=[0, 0], seen=[1, 0]) == Command(0, 1393, 0, True, 0, (False, False))
    assert command(over=[1, 0], seen=[1, 0]) == Command(100, 1493, 1, True, 100, (False, True))
    assert command(over=[1, 1], healthy=[True, False]) == Command(7, 1500, 6, True, 7, (False, True))
    assert command(over=[0, 0], override=1200) == Command(-300, 1200, 0, True, -300, (False, False))
    grip = Grip(replace(config, mode="force"))
    assert command(over=[1, 1]) == Command(0, 0, 16, False, 0, (False, False))
    assert command(over=[1, 1], override=1300) == Command(0, 1300, 0, True, 1300, (False, False))
    assert command(over=[1, 0]) == Command(100, 1400, 0, True, 1400, (False, False))
    grip = Grip(replace(config, mode="force", rule="weakest"), start=1111)
    assert command(over=[1, 0]).word == 1111 and command(over=[1, 2]).word == 1211


def test_model_doubles_by_hand():
    """Step 3, boost 2: 3 + 6 + 12 + 12 in four windows of a finger, 12 in its fifth; a window that is not
    over ends the row, and each finger has its own row."""
    grip = Grip(GripConfig(step=3, boost=2, minimum=0, maximum=900, rate=900), start=100)
    assert grip.next([4, 0]).command == 133 and grip.next([1, 0]).command == 145
    assert grip.next([0, 1]).command == 148 and grip.next([0, 1]).command == 154
    assert grip.next([1, 0]).command == 157 and grip.next([1, 0], seen=[2, 1]).command == 163
    assert grip.next([1, 0]).command == 166


def test_model_rests_by_hand():
    """A decay of 70, of which the rate allows 50, down to the minimum; what was heard and counted before
    is over with windows that ended, and another mode begins from nothing."""
    config = GripConfig(step=5, decay=70, minimum=1000, maximum=1210, rate=50, watchdog=2, boost=1)
    grip = Grip(config, start=1200)
    assert grip.next([1, 0], seen=[1, 0]).command == 1205  # the second finger is silent after one more
    increments = grip.rest(6)
    assert increments == [-50, -50, -50, -50, -5, 0] and grip.command == 1205
    taken = grip.take(increments, ended=True)
    assert taken == [(step, 1205 + sum(increments[: n + 1]), 0, 0) for n, step in enumerate(increments)]
    again = grip.next([1, 0], seen=[1, 0])
    assert (again.command, again.fault) == (1005, 0)  # its first silent cycle, and no doubled step
    assert grip.take([3], ended=False) == [(3, 1008, 0, 0)] and grip.next([1, 0]).command == 1018
    grip.config = replace(config, maximum=1018)  # the same mode: all goes on
    assert grip.take([0], ended=True) == [(0, 1018, 4, 0)]
    grip.config = replace(config, mode="force")
    assert grip.next([1, 1]) == Command(0, 0, 16, False, 0, (False, False))


def test_model_refuses_what_cannot_work():
    wrongs = {"period": 15, "step": 65536, "decay": -1, "watchdog": 0, "rate": 1.5, "boost": 8}
    for name, wrong in wrongs.items():
        with pytest.raises(ValueError, match=f"{name} = {wrong} must"):
            GripConfig(**{name: wrong})
    with pytest.raises(ValueError, match="minimum = 9 must not be above maximum = 8"):
        GripConfig(minimum=9, maximum=8)
    with pytest.raises(ValueError, match="rule = 'all' must be one of any, weakest"):
        GripConfig(rule="all")
    with pytest.raises(ValueError, match="immediate = 1 must be true or false"):
        GripConfig(immediate=1)
    for fingers in (0, 9):
        with pytest.raises(ValueError, match=f"fingers = {fingers} must lie in 1 .. 8"):
            Grip(fingers=fingers)
    with pytest.raises(ValueError, match=r"start = 1023 must lie in 1024 .. 60000"):
        Grip(start=1023)
    with pytest.raises(ValueError, match=r"over = 2 must lie in 0 .. 1"):
        Grip().next([2, 0], seen=[1, 1])
    with pytest.raises(ValueError, match="speed has 1 values for 2 fingers"):
        Grip().next([0, 0], speed=[3])
    with pytest.raises(ValueError, match=r"speed = 65536 must lie in 0 .. 65535"):
        Grip().next([0, 0], speed=[65536, None])
