"""msn_shear_speeds against ShearReference, a loop in integers written from docs/shear_speed.md, with speeds
within the page's bound; by hand: the clock of a report, channels that end their windows together, damaged
frames, everything that causes a hold (pin, register, changed commands), each setting at its place, off and on
again, samples that stall. The model against the same loop."""

import random
from dataclasses import replace
from fractions import Fraction

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import ShearConfig, ShearSpeeds, report
from reference.shear import DENOMINATOR, FAST, RANGE, RISING, SATURATED, ShearReference, within

UNSETTLED, SMALL = 1, 4
LATENCY = 60
# Levels are sums of 512 samples. For Vi = 512·1000, k is 500000 - 0.25·512000 = 372000, a rise of 1 mm/s.
HAND = {"k0": 500_000, "k1": -16384, "exponent": 18618, "vi_min": 300_000, "vi_max": 900_000, "noise": 5000}
HAND |= {"still": 700, "full": 4000, "limit": 3 << 20, "travel": 0, "hold": 0, "hold_cycles": 0, "select": 0}
OF_LOOP = ("k0", "k1", "exponent", "vi_min", "vi_max", "noise", "still", "full", "limit", "travel")
WINDOW, REST, TOP = 64, 8, (1 << 24) - 1  # the largest speed
REGISTERS = {name: members.PLACES["shear_speed_cfg"][name] for name in OF_LOOP}  # (place, bits)
VALID = members.PLACES["shear"]["valid"][0]
GRIP = members.PLACES["grip_status"]
GRIP_BITS = sum(bits for _, bits in GRIP.values())
UNARMED = 1 << GRIP["fault"][0] + 4


class Loop:
    """One channel by ShearReference: ``sample`` gives (flags, v, vi, rise, rises) at the end of a window,
    else None."""

    def __init__(self, settings):
        self.given = {name: settings[name] for name in OF_LOOP}
        self.window, self.held, self.travel = [], False, 0
        self.reference = ShearReference(self.given, 6, 3, 20)

    def sample(self, code, hold):
        self.window.append(code)
        self.held |= hold
        if len(self.window) < WINDOW:
            return None
        one, level = self.reference, sum(self.window) * REST
        before, vi = one.reference, one.vi
        flags, exact = one.window(self.window, self.held)
        vi = None if flags & UNSETTLED else vi
        self.window, self.held = [], False
        rises = before is not None and level > before + self.given["still"]
        return flags, exact, vi or 0, level - vi if vi is not None else 0, rises


def agrees(loop, expected, speed, flags):
    """Whether a window's speed and flags are the loop's, the speed within the bound of the docs."""
    wanted, exact, _, _, rises = expected
    if exact is None:
        loop.travel = 0
        return (speed, flags) == (0, wanted)
    bound = within(loop.given["exponent"], 26, 6, 16) * exact + Fraction(1, 2)
    limit = loop.given["limit"]
    assert abs(exact - limit) > bound < abs(exact - TOP), "the case hangs on the arithmetic's error"
    if flags:
        loop.travel = 0 if rises else loop.travel + int(exact)
        return (
            speed == 0
            and flags & ~(RISING | FAST | SATURATED) == 0
            and bool(flags & FAST) == (min(exact, TOP) > limit)
            and bool(flags & SATURATED) == (exact > TOP)
        )
    return abs(speed - exact) <= bound


class Stage:
    """``clock`` runs one clock, with a sample or none; returns the report in it and whether the sample was
    taken."""

    def __init__(self, dut):
        self.dut, self.channels = dut, dut.Channels.value.to_unsigned()
        self.beside = random.Random(bench.SEED).getrandbits(GRIP_BITS)  # must not matter without grip_valid_i
        self.armed = True

    async def begin(self, **settings):
        self.settings = HAND | {"enable": 1} | settings
        await bench.start(
            self.dut,
            **{"cfg_i": self.word(), "actuator_moving_i": 0, "grip_valid_i": 0, "grip_i": 0},
            **{"in_valid_i": 0, "in_data_i": 0, "in_id_i": 0, "in_last_i": 0, "out_ready_i": 1},
        )
        names = "in_valid_i in_id_i in_data_i in_last_i out_ready_i grip_valid_i grip_i"
        self.puts = [bench.putter(getattr(self.dut, name)) for name in names.split()]

    def word(self):
        return members.word("shear_speed_cfg", self.settings)

    def grip(self, increment):
        """The reflex' status with this increment, if any, and whether it is armed; all other bits must not
        matter, and are inverted each time."""
        self.beside ^= (1 << GRIP_BITS) - 1
        low, bits = GRIP["increment"]
        within = 0 if increment is None else (1 << bits) - 1 << low
        word = self.beside & ~within | (increment or 0) << low & within
        return word & ~UNARMED if self.armed else word | UNARMED

    def put(self, **settings):
        self.settings |= settings
        self.dut.cfg_i.value = self.word()

    async def clock(self, sample=None, last=False, command=None, ready=True):
        dut = self.dut
        id_, code = sample or (0, 0x5555)
        values = (sample is not None, id_, code, last, ready, command is not None, self.grip(command))
        for put, value in zip(self.puts, values):
            put(int(value))
        await ReadOnly()
        report = bench.read(dut.report_o)
        taken = sample is not None and bench.high(dut.in_ready_o)
        assert bench.high(dut.out_valid_o) == (sample is not None and (taken or not ready))
        await RisingEdge(dut.clk_i)
        return (members.of("shear", report) if report >> VALID & 1 else None), taken

    async def send(self, id_, code, last, gap=0, ready=lambda: True):
        """Offer one sample until it is taken, then wait ``gap`` clocks; return the reports of that time."""
        reports, taken = [], False
        while not taken:
            told, taken = await self.clock((id_, code), last, ready=ready())
            reports += [told] if told else []
        for _ in range(gap):
            told, _ = await self.clock()
            reports += [told] if told else []
        return reports

    def status(self):
        found = members.of("shear_speed_status", bench.read(self.dut.status_o))
        return found | {name: bench.as_signed(found[name], bits) for name, bits in (("vi", 26), ("rise", 27))}

    async def levels(self):
        """{channel: (vi, rise, windows)} by ``select``; channels that do not exist read 0."""
        found = {}
        for channel in range(8):
            self.put(select=channel)
            await ReadOnly()
            status = self.status()
            found[channel] = status["vi"], status["rise"], status["windows"]
            await RisingEdge(self.dut.clk_i)
        assert all(found.pop(channel) == (0, 0, 0) for channel in range(self.channels, 8))
        return found


def signed(name, value):
    """A register's value from its bits."""
    return bench.as_signed(value, REGISTERS[name][1]) if name in ("k1", "vi_min", "vi_max", "full") else value


def story(rng, channels, windows):
    """Codes [channels, samples] of levels that rest, are sheared, fall and clip, each channel at its own
    times."""
    rows = []
    for _ in range(channels):
        levels = []
        while len(levels) < windows:
            rest = rng.integers(700, 1500)
            levels += [rest] * int(rng.integers(8, 13))
            k = (500_000 - 0.25 * 512 * rest) / 512
            v = rng.uniform(0.02, 2.7)
            levels += [rest + k * v**0.11] * int(rng.integers(2, 9))
            levels += [rest + k * (1.3 * v) ** 0.11] * int(rng.integers(0, 4))
            levels += [4050] * int(rng.random() < 0.5)
        rows.append(np.repeat(levels[:windows], WINDOW))
    return np.rint(np.array(rows) + rng.normal(0, 0.3, (channels, windows * WINDOW))).astype(int)


async def follow(stage, codes, loops, draw=None):
    """Check each window of each channel against its loop, in the reports and in the registers; with ``draw``
    there are gaps and the slip path stalls. Return all flags seen and the number of speeds, per channel."""
    waiting, seen, speeds = [], [0] * stage.channels, [0] * stage.channels
    for frame in codes.T.tolist():
        reports = []
        for channel, code in enumerate(frame):
            expected = loops[channel].sample(code, False)
            if expected:
                waiting.append((channel, expected))
            reports += await stage.send(
                *(channel, code, channel == stage.channels - 1),
                gap=draw.choice([0, 0, 1, 5]) if draw else 0,
                ready=lambda: not draw or draw.random() < 0.8,
            )
        if waiting and len(waiting) == stage.channels:
            for _ in range(LATENCY + 2 * stage.channels):
                told, _ = await stage.clock()
                reports += [told] if told else []
            status = stage.status()
            levels = await stage.levels()
            for channel, expected in waiting:
                speed, flags = (status[f"channel{channel}_{name}"] for name in ("speed", "flags"))
                assert agrees(loops[channel], expected, speed, flags), (channel, expected, speed, flags)
                assert levels[channel][:2] == expected[2:4]
                mine = [one for one in reports if one["id"] == channel]
                assert [(one["ok"], one["speed"]) for one in mine] == [(flags == 0, speed >> 8)]
                seen[channel] |= flags
                speeds[channel] += flags == 0
            assert len({level[2] for level in levels.values()}) == 1
            waiting.clear()
    for absent in range(stage.channels, 8):
        assert (status[f"channel{absent}_speed"], status[f"channel{absent}_flags"]) == (0, UNSETTLED)
    return seen, speeds


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def matches_the_loops(dut):
    stage, rng, draw = Stage(dut), np.random.default_rng(bench.SEED), random.Random(bench.SEED)
    await stage.begin(limit=int(1.9 * (1 << 20)), travel=1 << 18, noise=6000)
    codes = story(rng, stage.channels, 45)
    loops = [Loop(stage.settings) for _ in range(stage.channels)]
    seen, speeds = await follow(stage, codes, loops, draw)
    assert {channel: 45 for channel in range(stage.channels)} == {
        channel: level[2] for channel, level in (await stage.levels()).items()
    }
    assert np.bitwise_or.reduce(seen) & 0x75 == 0x75 and sum(speeds) > 5 * stage.channels


def climb(rng, channels, rest, top):
    """Codes [channels, samples] of eight windows at rest and twelve with levels that rise to ``top``."""
    rows = [
        [rest + int(rng.integers(0, 99))] * 8 + sorted(rng.integers(rest + 200, top, 12))
        for _ in range(channels)
    ]
    codes = np.repeat(np.array(rows), WINDOW, axis=1)
    return np.clip(codes + rng.integers(-2, 3, codes.shape), -65_536, 65_535)


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def matches_the_loops_at_full_width(dut):
    """The entire range of codes and of speeds, with 1/n = 1; each flag of each channel; then random registers
    and levels, with each register bit both 0 and 1."""
    stage, rng = Stage(dut), np.random.default_rng(bench.SEED)
    await stage.begin()
    straight = HAND | {"k0": 512 * 100_000 // 15, "k1": 0, "exponent": 2048, "limit": TOP}
    straight |= {"vi_min": -(1 << 25), "vi_max": (1 << 25) - 1, "full": 65_535}
    drawn = {name: int(rng.integers(0, 1 << bits)) for name, (_, bits) in REGISTERS.items()}
    other = {name: value ^ (1 << REGISTERS[name][1]) - 1 for name, value in drawn.items()}
    for change, rest, top, wanted in (
        *[(straight, -50_000, 50_000, 0)] * 2,
        (straight | {"k0": 1, "limit": TOP - 1}, -60_000, 65_000, FAST | SATURATED),
        (straight | {"k0": 0, "vi_min": (1 << 25) - 1}, 30_000, 65_000, RANGE | DENOMINATOR),
        (straight | {"limit": 1 << 10, "travel": (1 << 32) - 1}, 40_000, 60_000, RISING | FAST),
        *[
            ({name: signed(name, value) for name, value in some.items()}, -65_536, 65_535, 0)
            for some in (drawn, other, drawn)
        ],
    ):
        stage.put(**HAND, enable=0)
        await settle(stage, 2)
        stage.put(**change, enable=1)
        loops = [Loop(stage.settings) for _ in range(stage.channels)]
        seen, speeds = await follow(stage, climb(rng, stage.channels, rest, top), loops)
        assert all(flags & wanted == wanted for flags in seen)
        assert change is not straight or min(speeds) > 8


async def frames(stage, level, count, others=1000, every=0):
    """``count`` frames with channel 0 at ``level`` and the others at ``others``; returns the reports."""
    reports = []
    for _ in range(count):
        for channel in range(stage.channels):
            last = channel == stage.channels - 1
            reports += await stage.send(channel, level if channel == 0 else others, last, gap=every * last)
    return reports


async def settle(stage, clocks=LATENCY + 20):
    found = [(await stage.clock())[0] for _ in range(clocks)]
    return [one for one in found if one]


async def shown(stage):
    """(speed, flags) of channel 0, from the registers."""
    await settle(stage)
    status = stage.status()
    return status["channel0_speed"], status["channel0_flags"]


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def by_hand(dut):
    """1 mm/s in the stated clock, and each further channel one clock later; samples that stall; each
    setting."""
    stage = Stage(dut)
    await stage.begin()
    first, second = 1000, 1000 + 372_000 / 512  # 726.5625: 36 of 64 samples a code higher
    for _ in range(9):
        await frames(stage, first, WINDOW)
    assert await shown(stage) == (0, SMALL)
    high = [int(second) + (n % 16 < 9) for n in range(WINDOW)]
    for n in range(WINDOW - 1):
        await frames(stage, high[n], 1)
    sent, at = [], []
    for clock in range(100):  # the last frame, one sample a clock
        sample = (clock, high[-1] if clock == 0 else 1000) if clock < stage.channels else None
        told, taken = await stage.clock(sample, clock == stage.channels - 1)
        sent += [clock] if taken else []
        at += [(clock, told["id"], told["ok"], told["speed"])] if told else []
    assert sent == list(range(stage.channels))
    assert at[0] == (LATENCY, 0, 1, 4096)
    assert at[1:] == [(LATENCY + channel, channel, 0, 0) for channel in range(1, stage.channels)]
    assert await shown(stage) == (1 << 20, 0)
    assert (await stage.levels())[0] == (512_000, 372_000, 10)
    # The next window's first two frames right after the last one: the second stalls, and none is lost.
    for n in range(WINDOW):
        await frames(stage, high[n], 1)
    taken_at, clock, place = [], 0, 0
    while len(taken_at) < 3 * stage.channels:
        channel = place % stage.channels
        _, taken = await stage.clock((channel, 1727), channel == stage.channels - 1)
        taken_at += [clock] if taken else []
        place, clock = place + taken, clock + 1
    assert 50 < taken_at[-1] <= LATENCY + 3 * stage.channels
    # Each setting except enable, by its effect on that rise.
    for change, expected in (
        ({"limit": (1 << 20) - 1}, (0, FAST)),
        ({"limit": 1 << 20}, (1 << 20, 0)),
        ({"vi_min": 512_001}, (0, 2)),
        ({"vi_min": 512_000}, (1 << 20, 0)),
        ({"vi_max": 511_999}, (0, 2)),
        ({"vi_max": 512_000}, (1 << 20, 0)),
        ({"noise": 372_001}, (0, SMALL)),
        ({"noise": 372_000}, (1 << 20, 0)),
        ({"full": 1727}, (0, 16)),
        ({"full": 1728}, (1 << 20, 0)),
        ({"travel": 1}, (0, RISING)),
        ({"k0": 128_000}, (0, 8)),
        ({"k0": 500_000 - 128_000, "k1": 0}, (1 << 20, 0)),
        ({"exponent": 0, "k0": 200_000}, (1 << 20, 0)),
        ({"exponent": 2048, "k0": 128_000 + 186_000}, (2 << 20, 0)),
        ({"still": 372_000, "travel": 1}, (1 << 20, 0)),
    ):
        stage.put(**HAND, enable=0)
        await settle(stage, 2)
        assert stage.status()["channel0_flags"] == UNSETTLED
        stage.put(**change, enable=1)
        for _ in range(8):
            await frames(stage, first, WINDOW)
        for n in range(WINDOW):
            await frames(stage, high[n], 1)
        assert await shown(stage) == expected, change
        assert (await stage.levels())[0] == (512_000, 372_000, 9)


async def known(stage, **settings):
    """Bring channel 0 to a known Vi and a valid speed."""
    stage.put(**HAND, enable=0)
    await stage.clock()
    stage.put(enable=1, **settings)
    for _ in range(8):
        await frames(stage, 1000, WINDOW)
    await frames(stage, 1727, WINDOW)
    assert (await shown(stage))[1] == 0


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def speeds_of_each_bit(dut):
    """Exactly 2^bit in each channel, from a rise of half or twice k to the power of |20 - bit|; with the
    limit at that speed and one below. The settings in force when a window is computed apply to it."""
    stage = Stage(dut)
    await stage.begin()
    rise = 512 * 726  # above Vi of 512 x 1000
    stage.put(k0=rise, k1=0)
    for level in [1000] * 8 + [1726]:
        await frames(stage, level, WINDOW, level)
    await settle(stage)
    for bit in range(24):
        stage.put(k0=2 * rise if bit < 20 else rise // 2, exponent=2048 * abs(20 - bit))
        for limit, expected in ((1 << bit, (1 << bit, 0)), ((1 << bit) - 1, (0, FAST))):
            stage.put(limit=limit)
            reports = await frames(stage, 1726, WINDOW, 1726) + await settle(stage)
            status = stage.status()
            for channel in range(stage.channels):
                found = tuple(status[f"channel{channel}_{name}"] for name in ("speed", "flags"))
                assert found == expected, (bit, channel)
            told = {one["id"]: (one["ok"], one["speed"]) for one in reports}
            assert told == dict.fromkeys(range(stage.channels), (expected[1] == 0, expected[0] >> 8))


@bench.applies(lambda dut: dut.ShearSpeed.value == 1 and bench.whole(dut))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def windows_have_32_bits(dut):
    """Each channel counts from its own value, at most of which a carry goes through all lower bits."""
    stage, port = Stage(dut), dut.gen_shear_speed.windows
    await stage.begin()
    every = [(2 << k) - 1 for k in range(32)] + [0x5A5A_A5A5, 0x0FFF_FFFF]
    for first in range(0, len(every), stage.channels):
        starts = (every * 2)[first : first + stage.channels]
        port.value = sum(start << 32 * channel for channel, start in enumerate(starts))
        await frames(stage, 1000, WINDOW)
        await settle(stage)
        found = [level[2] for level in (await stage.levels()).values()]
        assert found == [(start + 1) % 2**32 for start in starts]


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=60, timeout_unit="ms")
async def holds_while_the_force_may_change(dut):
    """In a sample anywhere in a window: the pin, the register, a changed command, a damaged frame; when the
    hold after a command ends."""
    stage = Stage(dut)
    await stage.begin()
    for place in (0, 30, WINDOW - 1):
        await known(stage)
        await frames(stage, 1727, place)
        dut.actuator_moving_i.value = 1
        await settle(stage, 6)
        await frames(stage, 1727, 1)
        await settle(stage, 6)
        dut.actuator_moving_i.value = 0
        await settle(stage, 6)
        await frames(stage, 1727, WINDOW - 1 - place)
        assert await shown(stage) == (0, UNSETTLED), place
        await known(stage)
        await frames(stage, 1727, place)
        stage.put(hold=1)
        await frames(stage, 1727, 1)
        await settle(stage, 2)
        stage.put(hold=0)
        await frames(stage, 1727, WINDOW - 1 - place)
        assert await shown(stage) == (0, UNSETTLED), place
    for cycles, increment in ((0, 5), (1, -3), (2, 1), (2, 0), (255, -65_535)):
        await known(stage, hold_cycles=cycles)
        await stage.clock(command=increment)
        held = cycles if increment else 0
        for after in range(min(held, 4)):  # the hold lasts this many cycles; here each cycle is a window
            await frames(stage, 1727, WINDOW)
            assert await shown(stage) == (0, UNSETTLED), (cycles, increment, after)
            await stage.clock(command=0)
        if held < 5:
            for _ in range(8):
                await frames(stage, 1727, WINDOW)
            await frames(stage, 1740, WINDOW)
            assert (await shown(stage))[1] == 0, (cycles, increment)
    # The count of cycles by its last one, a register written meanwhile, a reflex without a command.
    for cycles, after, change, held in (
        *[(255, 254, {}, True), (255, 255, {}, False), (255, 300, {}, False), (128, 127, {}, True)],
        *[(128, 128, {}, False), (200, 3, {"hold_cycles": 4}, True), (200, 3, {"hold_cycles": 3}, False)],
        *[(200, 3, {"hold_cycles": 0}, False), (200, 3, {"armed": False}, False)],
        *[(255, 0, {"armed": False}, False), (255, 0, {}, True)],
    ):
        await known(stage, hold_cycles=cycles)
        for increment in [1] + [0] * after:
            await stage.clock(command=increment)
        stage.armed = change.get("armed", True)
        stage.put(hold_cycles=change.get("hold_cycles", cycles))
        await settle(stage, 2)
        stage.armed = True
        await frames(stage, 1727, WINDOW)
        assert ((await shown(stage))[1] == UNSETTLED) == held, (cycles, after, change)
    # A frame without its last sample, and one with an extra sample: every channel discards its level.
    for damage in ([(0, 0)], [(c, int(c == stage.channels)) for c in range(stage.channels)] + [(0, 1)]):
        if stage.channels == 1:
            break
        await known(stage)
        for id_, last in damage:
            await stage.send(id_, 1727, last)
        await frames(stage, 1727, 1)
        windows = {channel: level[2] for channel, level in (await stage.levels()).items()}
        await frames(stage, 1727, WINDOW + 1)
        assert await shown(stage) == (0, UNSETTLED)
        assert {c: level[2] - windows[c] for c, level in (await stage.levels()).items()} == dict.fromkeys(
            windows, 1
        )


@bench.applies(lambda dut: dut.ShearSpeed.value == 1)
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def off_it_lets_samples_pass_and_forgets(dut):
    stage = Stage(dut)
    await stage.begin()
    await known(stage)
    stage.put(enable=0)
    await stage.clock()
    for n in range(300):
        told, taken = await stage.clock((n % stage.channels, 1727), n % stage.channels == stage.channels - 1)
        assert taken and told is None
    assert (await stage.levels())[0] == (0, 0, 0) and stage.status()["channel0_flags"] == UNSETTLED
    stage.put(enable=1)
    await frames(stage, 1727, WINDOW)
    assert await shown(stage) == (0, UNSETTLED) and (await stage.levels())[0] == (0, 0, 1)


@bench.applies(lambda dut: dut.ShearSpeed.value == 0)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def without_it_samples_pass_in_their_clock(dut):
    stage = Stage(dut)
    await stage.begin()
    for n in range(300):
        told, taken = await stage.clock((0, n), True, ready=n % 3 != 0)
        assert told is None and taken == (n % 3 != 0) and set(stage.status().values()) == {0}


EVIDENCE = {
    "equivalence": {"size": {"Channels": 3}, "boxes": True},
    "mutants": {"unsolved": True},
    "faults": {
        "none": "instances, wires and counters; the estimator's own upsets are those of msn_shear_speed"
    },
}


@pytest.mark.parametrize("parameters", [{"Channels": 8}, {"Channels": 3}, {"ShearSpeed": 0}], ids=str)
def test_shear_speeds(parameters):
    bench.run("slip", "shear_speeds", parameters)


def test_refuses_a_core_that_does_not_suit():
    assert "ShearSpeed = 1 must go with Slip and Registers" in bench.refuses("shear_speeds", {"Suits": 0})
    assert "Channels = 9 must lie in 1 .. 8" in bench.refuses("shear_speeds", {"Channels": 9})
    assert "samples have 17 bits" in bench.refuses("shear_speeds", {"SampleBits": 13})
    settings = ShearSettings(**{name: HAND[name] for name in OF_LOOP})
    with pytest.raises(ValueError, match=r"channels = 9 must lie in 1 .. 8"):
        ShearSpeeds(ShearConfig(settings), 9)
    with pytest.raises(ValueError, match=r"hold_cycles = 256 must lie in 0 .. 255"):
        ShearConfig(settings, 256)
    with pytest.raises(ValueError, match=r"k0 = -1 must lie in 0 .. 67108863"):
        ShearConfig(replace(settings, k0=-1))


def test_model_against_the_loop():
    """Pieces of any length; holds by sample and by changed commands."""
    rng = np.random.default_rng(bench.SEED)
    given = HAND | {"limit": int(1.9 * (1 << 20)), "travel": 1 << 18, "hold_cycles": 2}
    config = ShearConfig(ShearSettings(**{name: given[name] for name in OF_LOOP}), 2)
    assert config.settings == {name: given[name] for name in (*OF_LOOP, "hold_cycles")} | {"enable": 1}
    codes, at, cycles = story(rng, 3, 120), 0, 0
    twin, loops = ShearSpeeds(config, 3), [Loop(given) for _ in range(3)]
    speeds, held_windows = 0, 0
    while at < codes.shape[1]:
        count = int(rng.integers(1, 200))
        part, hold = codes[:, at : at + count], rng.random(min(count, codes.shape[1] - at)) < 0.0001
        found = twin.next(part, hold)
        for loop, row, windows in zip(loops, part, found):
            every = [loop.sample(int(code), bool(held) or cycles > 0) for code, held in zip(row, hold)]
            every = [one for one in every if one]
            assert len(every) == len(windows.flags)
            for expected, speed, flags, vi, rise in zip(every, *map(np.ndarray.tolist, windows)):
                assert agrees(loop, expected, speed, flags) and (vi, rise) == expected[2:4]
                assert report(speed, flags) == (None if flags else speed // 256)
                speeds, held_windows = speeds + (flags == 0), held_windows + (flags == UNSETTLED)
        increment = None if rng.random() < 0.01 else -7 * int(rng.random() < 0.03)
        twin.commanded(increment)
        cycles = 2 if increment else 0 if increment is None else max(0, cycles - 1)
        at += count
    assert speeds > 20 and held_windows > 20 and twin.windows == [120] * 3
