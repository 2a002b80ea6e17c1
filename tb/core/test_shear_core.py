"""A core that estimates the speed of shear, from an MCP3208's pins to the registers on the line and the words
of the reflex: two channels of rubber at 2 and 3 V are sheared one after the other, in codes of 5 V / 4096.
Each window must give the result of tb/reference/shear.py, in integers with the formula in 50 digits; words
are those of tb/reference/grip.py. Holds by the pin and by changed commands; a finger that dies; another lot
of rubber set by a host; a core that cannot have the estimator."""

import tomllib
from dataclasses import replace
from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from core import pins
from core.test_grip_core import (
    FRAME,
    PERIOD,
    RATE,
    SEEN,
    STEP,
    World,
)
from core.test_grip_core import by_loop as grip_words
from meissner.builds import config
from meissner.builds.build import verilog
from meissner.host.shear import Rubber, write_lot
from meissner.twins.core import hand_of
from reference.grip import LATENCY
from reference.shear import ShearReference, within

GAIN, REPORT, WINDOW = 21, 60, 64
UNSETTLED, RANGE, SMALL, CLIPPED, RISING, FAST = 1, 2, 4, 16, 32, 64
# docs/shear_speed.md in codes of 5 V / 4096 times 512: 419430.4 per volt; a window is 6.4 ms.
SETTINGS = {"k0": 650_117, "k1": -17_695, "exponent": 18_618, "vi_min": 796_918, "vi_max": 1_719_665}
SETTINGS |= {"noise": 41_943, "still": 1049, "full": 4095, "limit": 3 << 20, "travel": 819_200}


def build(**more):
    table = tomllib.loads((config.FOLDER / "grip.toml").read_text())
    table["clock"]["mhz"] = 4.0
    table["grip"] |= {"cycle_ms": 7.0, "step": STEP, "rate": RATE, "speed_gain": GAIN}
    table["shear_speed"] = {"vi_min_v": 1.9, "vi_max_v": 4.1, "travel_mm": 0.005} | more
    return config.read("rubber", table)


class Rubbers(World):
    """Codes by frame: at rest at 2 and 3 V; sheared from window ``begins`` on, with a rise of ``rises``
    codes, and two windows later with a ripple that looks like slip."""

    def __init__(self, dut, begins=(9, 11), rises=(820, 540), ripples=True):
        self.dut, self.begins, self.rises, self.ripples = dut, begins, rises, ripples
        self.words, self.taken, self.asked, self.goal, self.zero = [], [], [0, 0], 0, 0
        self.spoil = lambda channel, code: code

    def code(self, channel, _):
        frame = self.asked[channel]
        self.asked[channel] += 1
        frame -= self.zero
        window, code = frame // WINDOW - self.begins[channel], (1638, 2458)[channel] + frame % 5 // 4
        code += self.rises[channel] if window >= 0 else 0
        if window >= 2 and self.ripples:
            code += 15 if frame % 4 in (0, 3) else -15  # details of +30 and -30, with a mean of 0
        return self.spoil(channel, code)


async def begin(dut, **given):
    world = Rubbers(dut, **given)
    host, _ = await pins.begin(dut, world.part, pins.LineHost)
    world.watch(host)
    return world, host


def estimates(taken, settings=SETTINGS, held=lambda clock: False):
    """[(clock of the report, channel, flags, least and most speed, vi, rise)] for the samples that the core
    got."""
    found, windows = [], {0: [], 1: []}
    loops = {channel: ShearReference(settings, 6, 3, 20) for channel in windows}
    travel = dict.fromkeys(windows, 0)
    for clock, channel, code in taken:
        windows[channel].append((clock, code))
        if len(windows[channel]) < WINDOW:
            continue
        codes, loop = [code for _, code in windows[channel]], loops[channel]
        before, vi, level = loop.reference, loop.vi, 8 * sum(codes)
        flags, exact = loop.window(codes, any(held(at) for at, _ in windows[channel]))
        windows[channel].clear()
        least = most = 0
        if exact is None:
            travel[channel] = 0
        else:
            off = within(settings["exponent"], 26, 6, 16) * exact + Fraction(1, 2)
            least, most = exact - off, exact + off
            rises = level > before + settings["still"]
            travel[channel] = 0 if rises else travel[channel] + int(exact)
            assert abs(travel[channel] - settings["travel"]) > 3000
            flags |= RISING * (travel[channel] < settings["travel"]) | FAST * (exact > settings["limit"])
        known = not flags & UNSETTLED
        found.append(
            (clock + REPORT, channel, flags, least, most, vi if known else 0, level - vi if known else 0)
        )
    return found


def last_of(found, channel):
    return [one for one in found if one[1] == channel][-1]


async def frames(world, count):
    """Wait until ``count`` frames were converted and the last one was processed."""
    while len(world.taken) < 2 * count:
        await pins.rest(world.dut, FRAME // 2)
    await pins.rest(world.dut, 100)


async def shows(host, world, **given):
    """Check the registers of each channel against the loop's last report; return [(flags, speed)]."""
    found, shown = estimates(world.taken, **given), []
    for channel in (0, 1):
        mine = [one for one in found if one[1] == channel]
        _, _, flags, least, most, vi, rise = mine[-1]
        await host.set({"shear_speed.select": channel})
        names = (f"channel{channel}", "vi", "rise", "windows")
        word, *others = await host.read(*(f"shear_speed.{name}" for name in names))
        assert word >> 24 == flags, (channel, word >> 24, flags)
        assert (word & 0xFFFFFF == 0) if flags else least <= word & 0xFFFFFF <= most
        assert others == [vi, rise & 0x7FFFFFF, len(mine)]
        shown.append((flags, (word & 0xFFFFFF) / 2**20))
    return shown


def by_loop(world, ended, **settings):
    """(clock, word) of every word before ``ended``, with the speeds reported to the reflex."""
    reports = {}
    for clock, channel, flags, least, most, _, _ in estimates(world.taken):
        terms = {GAIN * (int(end) // 256) // 256 for end in (least, most)}
        assert len(terms) == 1, "the case hangs on the arithmetic's error"
        reports[clock] = channel, not flags, int(most) // 256
    return grip_words(world.taken, 0, ended, reports, **{"speed_gain": GAIN} | settings)


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def speeds_are_read_and_answered(dut):
    world, host = await begin(dut)
    await pins.says_what_it_is(host, "adc slip link grip shear_speed", 1, 2)
    await frames(world, 7 * WINDOW + 2)
    assert await shows(host, world) == [(UNSETTLED, 0)] * 2
    await frames(world, 9 * WINDOW + 2)
    assert await shows(host, world) == [(SMALL, 0)] * 2
    await frames(world, 10 * WINDOW + 2)
    assert (await shows(host, world))[0] == (RISING, 0)
    await frames(world, 12 * WINDOW + 2)
    (flags, speed), (rising, _) = await shows(host, world)
    assert (flags, rising) == (0, RISING) and 0.9 < speed < 1.0  # 820 codes of 827.4 at 1 mm/s
    await frames(world, 16 * WINDOW + 2)
    (_, again), (flags, speed) = await shows(host, world)
    assert flags == 0 and 0.3 < speed < 0.5 and again > 0.9  # 540 of 606.2
    # Each window over adds its finger's speed term; the words are the loop's, each in its clock.
    ended = host.clock() - 2 * LATENCY
    expected = by_loop(world, ended - LATENCY)
    assert [one for one in world.words if one[0] < ended] == expected
    without = by_loop(world, ended - LATENCY, speed_gain=0)
    assert [at for at, _ in expected] == [at for at, _ in without]
    assert {word - plain for (_, word), (_, plain) in zip(expected, without)} & set(range(290, 340))
    # Without a gain the words are those of a core without the estimator.
    await host.set({"grip.speed_gain": 0})
    since = host.clock() + PERIOD
    await frames(world, 18 * WINDOW)
    assert {word for at, word in world.words if at > since} <= {0, STEP, 2 * STEP}


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def what_may_change_the_force_holds(dut):
    """The pin for one frame; then commands: with hold_cycles = 1 every nonzero increment discards Vi for a
    cycle."""
    world, host = await begin(dut, ripples=False)
    await frames(world, 11 * WINDOW + 30)
    first = host.clock()
    dut.actuator_moving_i.value = 1
    await pins.rest(dut, 2 * FRAME)
    dut.actuator_moving_i.value = 0
    last = host.clock()
    held = lambda clock: first < clock - 3 and clock - 3 < last
    await frames(world, 12 * WINDOW + 2)
    assert [flags for flags, _ in await shows(host, world, held=held)] == [UNSETTLED] * 2
    await frames(world, 21 * WINDOW + 2)
    assert [flags for flags, _ in await shows(host, world, held=held)][1] == SMALL
    await host.set({"shear_speed.hold_cycles": 1, "grip.override_value": 3000})
    word = len(world.words)
    await host.set({"grip.override": 1})
    while not any(value for _, value in world.words[word:]):
        await pins.rest(dut, 200)
    (changed,) = [at for at, value in world.words[word:] if value]
    await frames(world, 26 * WINDOW + 2)
    following = [(at, value) for at, value in world.words if at > changed]
    assert len(following) >= 2 and not any(value for _, value in following)
    both = lambda clock: held(clock) or changed <= clock < following[0][0]
    assert [flags for flags, _ in await shows(host, world, held=both)] == [UNSETTLED] * 2


@cocotb.test(timeout_time=1, timeout_unit="sec")
async def a_host_gives_it_another_lot_and_a_dead_channel_has_no_speed(dut):
    """By meissner.host.shear over the line; then channel 1's input goes to its end."""
    world, host = await begin(dut, begins=(9, 99), rises=(800, 540), ripples=False)
    written, orders = {}, []
    lot = Rubber(k0_v=1.2, k1=-0.2, n=0.2)
    write_lot(
        lambda name, value: orders.append((name, value)) or written.update({name: value}), lot, 4096 / 5
    )
    assert orders[0] == ("shear_speed.enable", 0) and orders[-1] == ("shear_speed.enable", 1)
    assert written == {
        "shear_speed.enable": 1,
        "shear_speed.k0": 503_316,  # 1.2 · 419430.4 = 503316.48
        "shear_speed.k1": -13_107,  # -0.2 · 65536 = -13107.2
        "shear_speed.exponent": 10_240,  # 2048 / 0.2
    }
    await frames(world, WINDOW + 10)
    await host.set({"adc.enable": 0})
    await pins.rest(dut, 2 * FRAME)
    for name, value in orders:
        await host.set({name: value})
    world.taken.clear()
    world.zero = world.asked[0]
    await host.set({"adc.enable": 1})
    await frames(world, 11 * WINDOW + 2)
    given = SETTINGS | {"k0": 503_316, "k1": -13_107, "exponent": 10_240}
    (flags, speed), _ = await shows(host, world, settings=given)
    assert flags == 0 and 2.6 < speed < 2.75  # (800 / (983.04 - 0.2 · 1638.2))^5 = 2.71
    world.spoil = lambda channel, code: 4095 if channel == 1 else code
    await frames(world, 13 * WINDOW + 2)
    assert (await shows(host, world, settings=given))[1] == (CLIPPED, 0)


def test_speeds_at_the_pins():
    bench.run("core", "core", verilog(build().parameters), module="test_shear_core", inside=SEEN)


@pytest.mark.parametrize("rule", ["any", "weakest"])
def test_the_model_of_a_hand_hears_speeds_when_the_core_does(rule):
    """70 frames a period, without `immediate`: the loop clock by clock, the model a cycle at a time."""
    world = Rubbers(None, begins=(9, 10))
    world.taken = [
        (FRAME * n + 60 + 200 * channel, channel, world.code(channel, n))
        for n in range(70 * 18)
        for channel in (0, 1)
    ]
    expected = by_loop(world, 18 * PERIOD, immediate=0, rule=int(rule == "weakest"))
    table = build().features["grip"]
    reflex = replace(table.grip, immediate=False, rule=rule, period=PERIOD, watchdog=7)
    config_ = replace(build(), features=build().features | {"grip": replace(table, grip=reflex)})
    hand = hand_of(config_)
    codes = np.array([code for _, _, code in world.taken]).reshape(-1, 2)
    words = [hand.next(codes[70 * cycle : 70 * cycle + 70]).word for cycle in range(18)]
    assert words == [word for _, word in expected]
    assert set(words) - {0, STEP, 2 * STEP}, "no speed made a difference"


def test_what_the_build_asks_for():
    one = build()
    asked = {
        key.split(".")[1]: value for key, value in one.settings.items() if key.startswith("shear_speed.")
    }
    assert asked == SETTINGS | {"enable": 1, "hold_cycles": 0}
    with pytest.raises(ValueError, match="registers = true"):
        build_without = tomllib.loads((config.FOLDER / "grip.toml").read_text())
        del build_without["grip"]
        config.read("x", build_without | {"shear_speed": {}, "link": {"registers": False}})


def test_a_core_that_has_no_single_channels_is_refused():
    plain = {"ShearSpeed": 1, "Channels": 2, "ClkKhz": 4000}
    for wrong in (
        {"Slip": 0},
        {"Registers": 0},
        {"Array": 1, "Rows": 2, "Columns": 2},
        {"Slip": 0, "Cop4": 1, "Channels": 4},
        {"Serial": 1, "Channels": 1},
    ):
        said = bench.refuses("core", plain | wrong, of="shear_speeds")
        assert "ShearSpeed = 1 must go with Slip and Registers" in said
    assert "Channels = 9 must lie in 1 .. 8" in bench.refuses(
        "core", plain | {"Channels": 9}, of="shear_speeds"
    )
