"""A hand in closed loop at the pins of a core: physics, a converter's pins, and the words that move the hand.
An object being filled begins to slip and is held; each word has the size that a loop written from
docs/grip.md gives, in the clock stated there. Failures: a dead converter, a silent one, a reset during a
grip, slip that is always or never seen, a command at its limits: the hand never jumps, never opens, and
reports the cause."""

import tomllib

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge
from cocotb.utils import get_sim_time

import bench
from core import pins
from meissner.builds import config
from meissner.builds.build import verilog
from meissner.physics.adc import PARTS
from meissner.physics.hand import Grasp, Hand
from parts.mcp3208 import Mcp3208
from reference.grip import LATENCY, GripLoop

PERIOD, FRAME = 28_000, 400  # clocks of a control cycle and of a frame, at 4 MHz: 7 ms, 0.1 ms
STEP, RATE, MINIMUM, MAXIMUM = 800, 2000, 1000, 60_000
THRESHOLD, WINDOW, BLOCK = 23, 64, 10
COUNT_MM = 1e-4
# docs/grip.md, level 1 and tumbling windows: 6 clocks to the decision, 4 to the word.
DECISION, WORD = 6, 10
SEEN = ("sample_valid", "sample_ready", "sample_id", "sample")  # inside the core
SILENT, UNHEALTHY, LIMIT = 1, 2, 4


def build():
    table = tomllib.loads((config.FOLDER / "grip.toml").read_text())
    table["clock"]["mhz"] = 4.0
    table["sensor"]["rest_v"] = 4.9  # below the highest code, so both ends of the range are faults
    table["grip"] |= {"cycle_ms": 7.0, "step": STEP, "rate": RATE}
    return config.read("hand", table)


def grasp(seed=1):
    """1.25 N hold 0.1 kg; from 20 ms on 2 kg/s are poured in, up to 0.18 kg, which need 1.5 N."""
    return Grasp(
        mass_kg=np.minimum(0.1 + 2.0 * np.maximum(0, np.arange(40) * 0.01 - 0.02), 0.18),
        mu_s=(0.6, 0.58),
        mu_k=(0.5, 0.48),
        closing_mm=1.247,
        first_event=0.875,
        rng=np.random.default_rng(seed),
    )


class World:
    """Physics in steps of a millisecond; ``words``: (clock, word) of every word, each of which moves the
    hand; ``taken``: (clock, channel, code) of every sample that the slip path gets; ``spoil``: changes a
    channel's code."""

    def __init__(self, dut, grasp):
        self.dut, self.hand, self.goal = dut, Hand([grasp], 10_000, BLOCK), np.array([grasp.closing_mm])
        self.noise, self.codes, self.spoil = np.random.default_rng(7), [], lambda channel, code: code
        self.words, self.taken, self.asked, self.found = [], [], [0, 0], None

    def code(self, channel, _):
        frame = self.asked[channel]
        self.asked[channel] += 1
        while frame >= len(self.codes):
            self.found = self.hand.next(self.goal)
            self.codes += PARTS["MCP3208"].convert(self.found.volts[0], self.noise)[0].T.tolist()
        return self.spoil(channel, self.codes[frame][channel])

    def part(self, dut):
        return Prompt(dut.adc_cs_n_o, dut.adc_sclk_o, dut.adc_mosi_o, dut.adc_miso_i, self.code)

    def watch(self, host):
        self.host = host
        cocotb.start_soon(self.watch_words())
        cocotb.start_soon(self.watch_samples())

    async def watch_words(self):
        while True:
            await RisingEdge(self.dut.grip_valid_o)
            await ReadOnly()
            word = bench.as_signed(bench.read(self.dut.grip_word_o), 17)
            self.words.append((self.host.clock(), word))
            self.goal = self.goal + word * COUNT_MM
            await FallingEdge(self.dut.grip_valid_o)  # valid for one clock
            assert self.host.clock() == self.words[-1][0] + 1

    async def watch_samples(self):
        while True:
            await RisingEdge(self.dut.sample_valid)
            await ReadOnly()
            assert self.dut.sample_ready.value == 1
            one = bench.read(self.dut.sample_id), bench.read(self.dut.sample)
            self.taken.append((self.host.clock(), *one))


class Prompt(Mcp3208):
    """Without the delays of its bits: other tests check that the core allows for them."""

    def drive(self, lane, bit, delay, hold=0.0):
        self.miso.value = bit


async def begin(dut, one=None):
    world = World(dut, one or grasp())
    host, _ = await pins.begin(dut, world.part, pins.LineHost)
    world.watch(host)
    return world, host


def decisions(taken):
    """{clock: (channel, over, end)} for the samples that the slip path got: docs/slip.md, a plain loop."""
    found, details, first = {}, {0: [], 1: []}, {}
    for clock, channel, code in taken:
        if channel not in first:
            first[channel] = code
            continue
        details[channel].append(first.pop(channel) - code)
        place = (len(details[channel]) - 1) % (WINDOW // 2)
        window = details[channel][-1 - place :]
        over = max(window) - min(window) > THRESHOLD
        found[clock + DECISION] = channel, over, place == WINDOW // 2 - 1
    return found


def waits(loop, limit):
    """How many of the next ``limit`` clocks, none of which has an input, only count in ``loop``: most do."""
    if loop.windows or loop.due or loop.faulty or loop.boost_before != loop.boost:
        return 0
    return max(0, min(limit, max(16, loop.period) - 1 - loop.in_period))


def by_loop(taken, start, clocks, reports=None, **settings):
    """(clock, word) of every word in ``clocks`` clocks from ``start`` on, where a period begins; ``reports``:
    {clock: (channel, known, speed)} of the speeds reported to the reflex."""
    given = {"period": PERIOD, "step": STEP, "rate": RATE, "minimum": MINIMUM, "maximum": MAXIMUM, "decay": 0}
    given |= {"watchdog": 7, "rule": 0, "mode": 0, "immediate": 1, "override": 0, "override_value": 0}
    given |= {"speed_gain": 0, "boost": 0}
    loop, found, words = GripLoop(2, 16, 8, **given | settings), decisions(taken), []
    clock, events = start, sorted({*found, *(reports or {}), start + clocks})
    while clock < start + clocks:
        while events[0] < clock:
            events.pop(0)
        if idle := waits(loop, events[0] - clock):
            loop.now, loop.in_period, clock = loop.now + idle, loop.in_period + idle, clock + idle
            continue
        ended = loop.clock(found.get(clock), (reports or {}).get(clock))
        if ended and ended["valid"]:
            words.append((clock + LATENCY, ended["word"]))
        clock += 1
    return words


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def an_object_that_slips_is_held(dut):
    world, host = await begin(dut)
    await pins.says_what_it_is(host, "adc slip link grip", 1, 2)
    while len(world.codes) < 1100:
        await pins.rest(dut, 5 * FRAME)
    first = world.words[0]
    # The period begins with the clock after reset; the last edge in reset is clock 0.
    assert first == (PERIOD - 1 + LATENCY, 0)
    ended = host.clock() - 2 * LATENCY
    assert [one for one in world.words if one[0] < ended] == by_loop(world.taken, 0, ended - LATENCY)
    # The first slip after an idle period: from the sample that shows it to the word.
    over = [clock - DECISION for clock, (_, is_over, _) in decisions(world.taken).items() if is_over]
    tightened = [clock for clock, word in world.words if word]
    assert tightened[0] - over[0] == WORD
    assert {clock - sample for clock in tightened for sample in over if 0 <= clock - sample <= 16} >= {WORD}
    assert len(tightened) >= 3 and {word for _, word in world.words} <= {0, STEP, 2 * STEP}
    # The registers that a host reads.
    command, increment, fault, faulty, commands, tightenings = await host.read(
        *(f"grip.{name}" for name in ("command", "increment", "fault", "faulty", "commands", "tightenings"))
    )
    words = [word for _, word in world.words]
    assert (command, fault, faulty) == (MINIMUM + sum(words), 0, 0) and increment in words
    assert len(words) - commands in (0, 1) and tightenings == len(tightened)
    # It was held; without the reflex it falls.
    assert not world.hand.dropped[0] and world.hand.slid_mm.max() < 0.5
    assert world.found.normal_n[0, -1] > 1.5
    alone = Hand([grasp()], 10_000, BLOCK)
    for _ in range(300):
        alone.next(np.array([1.247]))
    assert alone.dropped[0]


async def armed(dut, world):
    """Wait for the first command."""
    while not world.words:
        await pins.rest(dut, FRAME)


def dies(world, code):
    """From between two details on: within a detail, the step of the level would be a detail itself."""
    at = max(world.asked) + 4
    at += at % 2 == 0
    world.spoil = lambda channel, good: code(channel) if world.asked[channel] > at else good


async def quiet(dut, host, seconds=0.03):
    """Wait for that many seconds."""
    await pins.rest(dut, round(4e6 * seconds))


@cocotb.test(timeout_time=1, timeout_unit="sec")
@cocotb.parametrize(stuck=[0, 4095])
async def a_dead_converter_holds_and_says_so(dut, stuck):
    """Although it looks like slip, and although the grip would decay; the other finger goes on alone."""
    world, host = await begin(dut, grasp(3))
    await armed(dut, world)
    await host.set({"grip.rail": 1, "grip.decay": 50, "grip.minimum": 300, "grip.period": 4000})
    while len(world.words) < 8:
        await pins.rest(dut, 1000)
    assert {word for _, word in world.words[-4:]} == {-50}
    dies(world, lambda channel: stuck)
    await quiet(dut, host, 0.002)
    since = len(world.words)
    await quiet(dut, host, 0.008)
    assert {word for _, word in world.words[since:]} == {0}
    before = world.words[since - 4 : since]
    assert {word for _, word in before} <= {-50, 0}, "the step to the rail was answered"
    assert await host.read("grip.fault", "grip.faulty") == [UNHEALTHY, 3]
    assert (await host.read("grip.command"))[0] == MINIMUM + sum(word for _, word in world.words)
    # One finger alone: the hand tightens, but does not open.
    world.spoil = lambda channel, code: code + 60 * (world.asked[0] % 2) if channel == 0 else stuck
    await quiet(dut, host, 0.01)
    assert await host.read("grip.fault", "grip.faulty") == [UNHEALTHY, 2]
    assert {word for _, word in world.words[-3:]} <= {0, STEP} and world.words[-1][1] + world.words[-8][
        1
    ] >= 0
    assert max(word for _, word in world.words[-8:]) == STEP
    world.spoil = lambda channel, code: code
    await quiet(dut, host, 0.01)
    assert await host.read("grip.fault", "grip.faulty") == [0, 0]


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def with_more_samples_to_die_in_it_tightens_first(dut):
    """rail = 8: a window of each finger is answered before that many samples, and none after."""
    world, host = await begin(dut, grasp(3))
    await host.set({"grip.rail": 8, "grip.period": 4000})
    await quiet(dut, host, 0.008)
    since = len(world.words)
    dies(world, lambda channel: 4095)
    await quiet(dut, host, 0.01)
    assert [word for _, word in world.words[since:] if word] == [STEP, STEP]
    assert await host.read("grip.fault", "grip.faulty") == [UNHEALTHY, 3]


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def a_silent_converter_holds_and_says_so(dut):
    world, host = await begin(dut)
    await armed(dut, world)
    await host.set({"grip.watchdog": 3, "grip.decay": 50, "grip.minimum": 10, "grip.period": 4000})
    await quiet(dut, host, 0.008)
    await host.set({"adc.enable": 0})
    stopped = host.clock()
    await quiet(dut, host, 0.008)
    words = [word for clock, word in world.words if clock > stopped + 4000]
    assert len(words) >= 6 and set(words) == {0}
    assert await host.read("grip.fault", "grip.faulty") == [SILENT, 3]
    await host.set({"adc.enable": 1})
    await quiet(dut, host, 0.004)
    assert await host.read("grip.fault", "grip.faulty") == [0, 0] and world.words[-1][1] == -50


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def a_reset_in_a_grip_moves_nothing(dut):
    """The settings are the build's own, so the core continues by itself; the hand stays where it was."""
    world, host = await begin(dut)
    while sum(word for _, word in world.words) < 2 * STEP:
        await pins.rest(dut, 400)
    await pins.rest(dut, 3000)  # until the line is idle
    goal, before = world.goal[0], len(world.words)
    for wait in (5, 300):
        await pins.rest(dut, wait)
        dut.rst_i.value = 1
        await bench.clocks(dut, 2)
        dut.rst_i.value = 0
        host.zero = round(get_sim_time("ns") / pins.PERIOD_NS)
    world.taken.clear()
    host.packets.clear()
    while len(world.words) == before:
        await pins.rest(dut, 100)
    assert world.words[before][1] == 0 and world.goal[0] == goal
    while len(world.codes) < 1300:
        await pins.rest(dut, 5 * FRAME)
    ended = host.clock() - 2 * LATENCY
    after = [one for one in world.words[before:] if one[0] < ended]
    assert after == by_loop(world.taken, 0, ended - LATENCY)
    words = [word for _, word in world.words[before:]]
    assert set(words) <= {0, STEP, 2 * STEP} and not world.hand.dropped[0]
    assert (await host.read("grip.command"))[0] == MINIMUM + sum(words)


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def slip_stuck_on_and_off_stays_within_its_limits(dut):
    world, host = await begin(dut)
    await host.set({"grip.maximum": 1900, "grip.rate": 330, "grip.period": 4000, "grip.decay": 70})
    world.spoil = lambda channel, code: code + 200 * (world.asked[channel] % 2)
    await host.set({"slip.threshold": 0})
    await quiet(dut, host, 0.03)
    words = [word for _, word in world.words]
    assert sum(words) == 900 and set(words[-5:]) == {0} and {0, 330, 240} == set(words), words
    assert await host.read("grip.command", "grip.fault") == [1900, LIMIT]
    world.spoil = lambda channel, code: code
    await host.set({"slip.threshold": 0xFFFFF})
    await quiet(dut, host, 0.02)
    down = [word for _, word in world.words[len(words) :]]
    assert {0, -70, -60} == set(down) and set(down[-5:]) == {0}, down
    assert sum(words) + sum(down) == 0
    assert await host.read("grip.command", "grip.fault") == [1000, 0]
    # A minimum that a host sets above the command is approached at the rate.
    await host.set({"grip.minimum": 1500})
    await quiet(dut, host, 0.01)
    up = [word for _, word in world.words[len(words) + len(down) :]]
    assert sum(up) == 500 and set(up) == {0, 330, 170}


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def a_slide_is_answered_with_steps_that_double(dut):
    """Every window is over: 90 for the first finger's first, 90 + 180 for the other's first two, then 360."""
    world, host = await begin(dut)
    await host.set({"grip.step": 90, "grip.boost": 2})
    await armed(dut, world)
    world.spoil = lambda channel, code: code + 200 * (world.asked[channel] % 4 == 0)
    await quiet(dut, host, 0.05)
    ended = host.clock() - 2 * LATENCY
    words = [one for one in world.words if one[0] < ended]
    assert words == by_loop(world.taken, 0, ended - LATENCY, step=90, boost=2)
    assert [word for _, word in words][:5] == [0, 90, 270, 360, 360]


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def forces_come_as_pulses(dut):
    """No pulse until a host has set the force; then that width, and one step more after a slip."""
    world, host = await begin(dut)
    pulses = pins.Edges(host, dut.pwm_o)
    ends = pins.Edges(host, dut.pwm_o, to=0)
    await host.set({"grip.enable": 0})
    await host.set({"grip.mode": 1, "grip.enable": 1})
    world.words.clear()
    await quiet(dut, host, 0.01)
    assert not world.words and not pulses.at
    assert await host.read("grip.fault", "grip.command") == [16, 0]
    await host.set({"grip.override_value": 4660, "grip.override": 1})
    await quiet(dut, host, 0.01)
    await host.set({"grip.override": 0})
    world.goal = np.array([1.247])  # the words are no positions
    await quiet(dut, host, 0.04)
    assert {word for _, word in world.words} == {4660}
    assert ends.at[0] - pulses.at[0] == 4660 and pulses.at[1] - pulses.at[0] == 65_535
    world.spoil = lambda channel, code: code + 200 * (world.asked[channel] % 2)
    while world.words[-1][1] == 4660:
        await pins.rest(dut, 400)
    assert world.words[-1][1] == 5460
    dut.rst_i.value = 1
    await bench.clocks(dut, 2)
    assert dut.pwm_o.value == 0


def test_a_hand_at_the_pins():
    bench.run("core", "core", verilog(build().parameters), module="test_grip_core", inside=SEEN)


def test_a_core_that_has_no_fingers_is_refused():
    plain = {"Grip": 1, "Channels": 2, "ClkKhz": 4000}
    for wrong in (
        {"Slip": 0},
        {"Registers": 0},
        {"Array": 1, "Rows": 2, "Columns": 2},
        {"Slip": 0, "Cop4": 1, "Channels": 4},
        {"Serial": 1, "Channels": 1},
    ):
        assert "Grip = 1 must go with Slip and Registers" in bench.refuses(
            "core", plain | wrong, of="actuate"
        )
    assert "Fingers = 9 must lie in 1 .. 8" in bench.refuses(
        "core", plain | {"Channels": 9}, of="finger_health"
    )


def test_what_the_build_asks_for():
    one = build()
    assert one.settings["adc.period"] == FRAME and one.settings["grip.period"] == PERIOD
    assert one.settings["slip.threshold"] == THRESHOLD and one.slip.window == WINDOW
    with pytest.raises(ValueError, match="registers = true"):
        config.load("grip", registers=False)
