"""msn_actuate against the loops of tb/reference/grip.py and test_finger_health, clock by clock, with random
settings; by hand: a dead finger, frames that a converter does not answer, `enable` = 0, counters, the words
and pulses of both modes, a change of mode. With Grip = 0 nothing happens. The model against the same
loops."""

import random
from dataclasses import replace

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, RisingEdge
from cocotb.utils import get_sim_time

import bench
import members
from actuate.test_finger_health import Runs
from meissner.twins.actuate.actuate import Actuate, ActuateConfig
from meissner.twins.actuate.grip import Command, GripConfig
from reference.grip import LATENCY, GripLoop

HAND = {"enable": 1, "period": 40, "step": 7, "decay": 0, "minimum": 30, "maximum": 100, "rate": 11}
HAND |= {"watchdog": 900, "rule": 0, "mode": 0, "immediate": 1, "override": 0, "override_value": 0}
HAND |= {"divide": 0, "low": 0, "high": 4095, "rail": 3, "speed_gain": 0, "boost": 0}
OF_LOOP = ("period", "step", "decay", "minimum", "maximum", "rate", "watchdog", "rule", "mode", "immediate")
OF_LOOP += ("override", "override_value", "speed_gain", "boost")
OF_FRAMES = ("timeout", "mistagged")  # counters of frames that were lost
SILENT, UNHEALTHY, LIMIT, UNARMED = 1, 2, 4, 16


class Stage:
    """The stage behind its pins; ``clock`` runs one clock and returns the outputs in it."""

    def __init__(self, dut):
        self.dut, self.fingers, self.started = dut, dut.Fingers.value.to_unsigned(), False
        self.adc = {"timeout": 0, "mistagged": 0, "dropped": 0, "overrun": 0, "over_range": 0}

    async def begin(self, adc=None, **settings):
        """``adc``: the converter's counters at the start."""
        self.settings, self.adc = HAND | settings, dict.fromkeys(self.adc, 0) | (adc or {})
        quiet = {
            "adc_i": members.word("adc_status", self.adc),
            "verdict_i": 0,
            "shear_i": 0,
            "sample_valid_i": 0,
            "sample_data_i": 0,
            "sample_id_i": 0,
            "decided_i": 0,
            "slips_i": 1,
        }
        if self.started:
            for name, value in (quiet | {"cfg_i": self.word()}).items():
                getattr(self.dut, name).value = value
            await bench.reset(self.dut)
        else:
            self.started = True
            await bench.start(self.dut, cfg_i=self.word(), **quiet)

    def word(self):
        signed = ("low", "high")
        return members.word(
            "grip_cfg", {k: v & 0x1FFFF if k in signed else v for k, v in self.settings.items()}
        )

    def put(self, **settings):
        self.settings |= settings
        self.dut.cfg_i.value = self.word()

    async def clock(self, verdict=None, sample=None, shear=None, slips=None, **adc):
        """``verdict``: (finger, over, end); ``sample``: (finger, code); ``shear``: (finger, ok, speed);
        ``slips``: of a decision of the forest; ``adc``: counters that change."""
        dut, self.adc = self.dut, self.adc | adc
        dut.decided_i.value, dut.slips_i.value = slips is not None, 1 if slips is None else slips
        finger, over, end = verdict or (0, 1, 1)
        word = {"valid": verdict is not None, "over": over, "last": end, "id": finger}
        dut.verdict_i.value = members.word("verdict", {name: int(value) for name, value in word.items()})
        finger, ok, speed = shear or (0, 1, 0xABCD)
        word = {"valid": int(shear is not None), "ok": int(ok), "id": finger, "speed": speed}
        dut.shear_i.value = members.word("shear", word)
        finger, code = sample or (0, 4095)
        dut.sample_valid_i.value = sample is not None
        dut.sample_id_i.value, dut.sample_data_i.value = finger, code
        dut.adc_i.value = members.word("adc_status", self.adc)
        await bench.ReadOnly()
        got = self.outputs()
        await bench.RisingEdge(dut.clk_i)
        return got

    def outputs(self):
        found = members.of("grip_status", bench.read(self.dut.status_o))
        found["increment"] = bench.as_signed(found["increment"], 17)
        found["valid"] = bench.read(self.dut.grip_valid_o)
        found["word"] = bench.as_signed(bench.read(self.dut.grip_word_o), 17)
        return found | {"pwm": bench.read(self.dut.pwm_o)}

    async def rest(self, clocks):
        """Let ``clocks`` clocks pass; return the outputs of those with a valid word."""
        return [got for got in [await self.clock() for _ in range(clocks)] if got["valid"]]

    async def window(self, finger):
        """Send one window of the finger that is over, wait two periods; return the increments that are not
        0."""
        await self.clock((finger, 1, 1))
        return [word["increment"] for word in await self.rest(80) if word["increment"]]


def at_random(draw):
    low, high = sorted((draw.choice([0, 1, 900, 40000]), draw.choice([50, 30000, 65534, 65535])))
    if draw.random() < 0.1:
        low, high = high, low
    some = lambda: draw.choice([0, 1, draw.randrange(300), draw.randrange(65536), 65535])
    found = {name: some() for name in ("step", "decay", "rate", "override_value")}
    found |= {"speed_gain": draw.choice([0, 1, draw.randrange(3000), 65535]), "boost": draw.randrange(8)}
    found |= {name: draw.randrange(2) for name in ("rule", "mode", "immediate")}
    found |= {
        "override": int(draw.random() < 0.3),
        "watchdog": draw.choice([0, 1, 2, 5, draw.randrange(1 << 16)]),
    }
    period = draw.choice([15, 16, 23, 31, 300, draw.randrange(1 << 24)])
    if draw.random() < 0.3:  # wide limits, so that all sums of windows and speeds show
        low, high = 0, 65535
        found |= {"step": draw.randrange(1 << 12), "speed_gain": draw.randrange(1 << 16), "rate": 65535}
    return found | {
        **{"minimum": low, "maximum": high, "period": period},
        **{
            "divide": draw.randrange(256),
            "low": draw.choice([-65536, -7, 0, draw.randint(-65536, 65535)]),
            "high": draw.choice([9, 65535, draw.randint(-65536, 65535)]),
        },
        **{"rail": draw.choice([0, 1, 4, draw.randrange(256)]), "enable": 1},
    }


@bench.applies(lambda dut: dut.Grip.value == 1 and bench.whole(dut))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def counters_have_32_bits(dut):
    """From values at which a carry goes through all lower bits: each word counts, a tighter one twice."""
    stage, counters = Stage(dut), dut.gen_grip
    await stage.begin(step=1, maximum=65535)
    await stage.rest(60)
    for start in bench.carries(counters.commands):
        counters.commands.value, counters.tightenings.value = start, start
        found = [await stage.clock((1, 1, 1) if n == 5 else None) for n in range(80)]
        words = [got["increment"] for got in found if got["valid"]]
        assert sorted(words) == [0, 1]
        got = await stage.clock()
        assert (got["commands"], got["tightenings"]) == ((start + 2) % 2**32, (start + 1) % 2**32)


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_the_loops(dut):
    """Repeated resets with other settings. A sample affects health after 3 clocks, a lost frame after 1. The
    converter's counters start anywhere and may wrap around."""
    stage, draw = Stage(dut), random.Random(bench.SEED)
    seen = set()
    for turn in range(30):
        settings = at_random(draw)
        stands = {name: draw.choice([0, (1 << 32) - 2, 2 * draw.randrange(1 << 31)]) for name in OF_FRAMES}
        await stage.begin(stands, **settings)
        loop = GripLoop(stage.fingers, 16, 8, **{name: settings[name] for name in OF_LOOP})
        runs = Runs(stage.fingers, settings["rail"], settings["low"], settings["high"])
        well = [[True] * stage.fingers] * 3
        shown, due = {"word": 0, "increment": 0, "command": 0, "fault": UNARMED, "faulty": 0}, {}
        often, slipping = draw.choice([0.05, 0.3]), draw.choice([0, 0.1, 0.8])
        counts, lost = {"commands": 0, "tightenings": 0}, False
        ends = [settings["low"], min(settings["low"] + 1, 65535), settings["high"]]
        for now in range(draw.choice([50, 300, 900])):
            verdict = sample = shear = None
            if draw.random() < often:
                verdict = draw.randrange(stage.fingers), draw.random() < slipping, draw.random() < 0.3
            if draw.random() < 0.3:
                sample = draw.randrange(stage.fingers), draw.choice([-65536, -7, -6, 0, 8, 9, 65535, *ends])
            if draw.random() < 0.1:
                some_speed = draw.choice([0, 1, draw.randrange(600), draw.randrange(65536), 65535])
                shear = draw.randrange(stage.fingers), draw.random() < 0.8, some_speed
            change = {}
            if draw.random() < 0.01:
                name = draw.choice(OF_FRAMES)
                change[name] = stage.adc[name] + 1 & 0xFFFFFFFF
            if draw.random() < 0.1:  # must not matter
                change["dropped"] = draw.randrange(1 << 32)
                change["overrun"], change["over_range"] = draw.randrange(1 << 32), draw.randrange(1 << 32)
            ended = loop.clock(verdict, shear, [one and not lost for one in well.pop(0)])
            lost = "timeout" in change or "mistagged" in change
            if ended:
                due[now + LATENCY] = ended
            valid = 0
            if now in due:
                shown = due.pop(now)
                valid = int(shown["valid"])
                seen.add((shown["fault"], shown["increment"] > 0))
            got = await stage.clock(verdict, sample, shear, **change)
            assert got | {"pwm": 0} == shown | counts | {"valid": valid, "pwm": 0}, (turn, now, settings)
            counts["commands"] += valid
            counts["tightenings"] += valid and shown["increment"] > 0
            if sample:
                runs.sample(*sample)
            well.append(runs.healthy())
    assert {fault & 3 for fault, _ in seen} == {0, 1, 2, 3}


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def by_hand(dut):
    """The clock of the word, a dead finger, lost frames, and off and on again."""
    stage = Stage(dut)
    await stage.begin()
    (first,) = await stage.rest(60)
    assert (first["word"], first["command"], first["fault"]) == (0, 30, 0)
    words = [await stage.clock((1, 1, 1) if n == 0 else None) for n in range(6)]
    assert [got["valid"] for got in words] == [0, 0, 0, 0, 1, 0]
    assert (words[4]["word"], words[5]["command"]) == (7, 37)
    # Three samples of finger 0 at the rail: the apparent slip is ignored and the finger is reported.
    await stage.rest(60)
    for code in (4095, 4094, 4095, 0, 4095):
        await stage.clock(sample=(0, code))
    await stage.rest(5)  # a decision comes Level + 5 clocks after its sample
    await stage.clock((0, 1, 0))
    found = await stage.rest(80)
    assert [(got["word"], got["command"], got["fault"], got["faulty"]) for got in found] == [
        (0, 37, 2, 1)
    ] * 2
    await stage.clock(sample=(0, 4094))
    await stage.rest(80)
    for counter in OF_FRAMES:  # all fingers, for one cycle only
        await stage.clock(**{counter: 1})
        found = await stage.rest(80)
        everyone = (1 << stage.fingers) - 1
        assert [(got["word"], got["fault"], got["faulty"]) for got in found][:2] == [
            (0, 2, everyone),
            (0, 0, 0),
        ]
    before = await stage.clock()
    assert before["tightenings"] == 1 and before["commands"] > 8
    stage.put(enable=0)
    await stage.clock()
    found = [await stage.clock((0, 1, 1)) for _ in range(100)]
    assert {(got["valid"], got["command"], got["fault"], got["pwm"]) for got in found} == {(0, 0, UNARMED, 0)}
    stage.put(enable=1)
    await stage.rest(44)
    after = await stage.clock()
    assert (after["command"], after["increment"], after["fault"]) == (30, 0, 0)
    assert after["commands"] == before["commands"] + 1 + (found[0]["commands"] - before["commands"])
    assert after["tightenings"] == 1


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def counts_what_tightens(dut):
    """Increments of each power of two count once; decrements of the same size do not count."""
    stage = Stage(dut)
    await stage.begin(minimum=0, maximum=65535, rate=65535)
    await stage.rest(60)
    for bit in range(16):
        stage.put(step=1 << bit)
        await stage.clock((0, 1, 1))
        await stage.rest(80)
        got = await stage.clock()
        assert (got["command"], got["tightenings"]) == ((2 << bit) - 1, bit + 1)
    for bit in range(16):
        stage.put(override=1, override_value=65536 - (2 << bit))
        found = await stage.rest(80)
        assert [word["increment"] for word in found] == [-(1 << bit), 0] and found[-1]["tightenings"] == 16


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_speed_counts_for_its_finger_until_it_is_invalid(dut):
    """A speed of 25 at a gain of 2 = 512/256 adds 50 to the step."""
    stage = Stage(dut)
    await stage.begin(minimum=0, maximum=65535, rate=65535, speed_gain=512)
    await stage.rest(60)

    for finger in range(stage.fingers):
        await stage.clock(shear=(finger, 1, 25))
        await stage.rest(80)
        assert [await stage.window(which) for which in ((finger + 1) % stage.fingers, finger)] == [[7], [57]]
        await stage.clock(shear=(finger, 0, 25))
        await stage.rest(2)
        assert await stage.window(finger) == [7]


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def windows_over_in_a_row_add_more(dut):
    """Step 7, boost 5: 7 times 1 to 32, then 32 again."""
    stage = Stage(dut)
    await stage.begin(minimum=0, maximum=65535, rate=65535, boost=5)
    await stage.rest(60)
    found = [await stage.window(1) for _ in range(8)]
    assert found == [[7], [14], [28], [56], [112], [224], [224], [224]]


async def width(dut):
    """Length of the next pulse in clocks."""
    await RisingEdge(dut.pwm_o)
    rose = get_sim_time("ns")
    await FallingEdge(dut.pwm_o)
    return round((get_sim_time("ns") - rose) / 10)


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def forces_and_pulses(dut):
    """No word and no pulse until a host has set the force; then the pulse width is the force."""
    stage = Stage(dut)
    await stage.begin(mode=1, minimum=1, maximum=65535, rate=65535)
    assert await stage.rest(200) == [] and bench.read(dut.pwm_o) == 0
    stage.put(override=1, override_value=40000)
    (found,) = (await stage.rest(50))[:1]
    assert (found["word"], found["increment"], found["fault"]) == (40000, 0, 0)
    stage.put(override=0)
    await FallingEdge(dut.pwm_o)
    assert await width(dut) == 40000
    stage.put(mode=0)  # position words are no widths: the pulses stay as they were
    assert await width(dut) == 40000
    stage.put(mode=1, override=1, override_value=9, divide=2)
    await width(dut)
    assert await width(dut) == 27
    stage.put(enable=0)
    await bench.RisingEdge(dut.clk_i)
    await stage.rest(3)
    assert not any([(await stage.clock())["pwm"] for _ in range(100)])


@bench.applies(lambda dut: dut.Grip.value == 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_mode_that_changes_sends_no_width_of_the_other(dut):
    """Whenever the mode changes around a position command: its 30 must not become a force."""
    stage = Stage(dut)
    for at in range(36, 50):
        await stage.begin(mode=0, divide=0, minimum=30, maximum=60000)
        for n in range(60):
            if n == at:
                stage.put(mode=1)
            assert not (await stage.clock())["pwm"]
        assert not any([(await stage.clock())["pwm"] for _ in range(20)]), at


@bench.applies(lambda dut: dut.Grip.value == 1 and dut.Single.value == 0)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_slip_of_the_forest_marks_the_next_detail_of_every_finger(dut):
    """Once each: a step of 7. A decision that is no slip marks none; a reset forgets the marks."""
    stage = Stage(dut)
    await stage.begin()
    await stage.rest(60)

    async def closes(finger):
        await stage.clock((finger, 0, 1))
        return [word["increment"] for word in await stage.rest(80) if word["increment"]]

    await stage.clock(slips=0)
    assert await closes(0) == []
    await stage.clock(slips=1)
    assert [await closes(finger) for finger in (1, 0, 2, 1, 0)] == [[7], [7], [7], [], []]
    await stage.clock((0, 0, 1), slips=1)  # of the detail before
    assert [await closes(0), await closes(0)] == [[7], []]
    await stage.clock(slips=1)
    await stage.begin()
    await stage.rest(60)
    assert await closes(0) == []


@bench.applies(lambda dut: dut.Single.value == 1)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_forest_is_the_only_finger(dut):
    """Each decision is a window of it, others are not; without decisions it is silent, and a
    lost conversion makes it unhealthy."""
    stage = Stage(dut)
    await stage.begin(watchdog=4)
    await stage.rest(60)
    for slips, closes in ((1, [7]), (0, []), (1, [7]), (1, [7])):
        await stage.clock((0, 1, 1), slips=slips)
        assert [word["increment"] for word in await stage.rest(80) if word["increment"]] == closes
    assert (await stage.clock())["fault"] == 0
    assert (await stage.rest(200))[-1]["fault"] == SILENT
    await stage.clock(slips=1)
    await stage.clock(timeout=1)
    assert UNHEALTHY in {word["fault"] & UNHEALTHY for word in await stage.rest(60)}


@bench.applies(lambda dut: dut.Grip.value == 0)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def without_the_reflex_nothing_comes(dut):
    stage = Stage(dut)
    await stage.begin()
    for n in range(200):
        assert set((await stage.clock((0, 1, 1), (0, 4095), timeout=n)).values()) == {0}


EVIDENCE = {
    "equivalence": {"size": {"Fingers": 3}, "boxes": True},
    "faults": {"none": "instances, wires and counters; the reflex' own upsets are those of msn_grip"},
}


@pytest.mark.parametrize("parameters", [{"Fingers": 8}, {"Fingers": 3, "SampleBits": 17}, {"Grip": 0}])
def test_actuate(parameters):
    bench.run("actuate", "actuate", parameters)


def test_actuate_of_an_array():
    bench.run("actuate", "actuate", {"Single": 1, "Fingers": 1}, "the_forest_is_the_only_finger")


def test_refuses_a_core_that_does_not_suit():
    assert "Grip = 1 must go with Slip and Registers" in bench.refuses("actuate", {"Suits": 0})
    assert "Fingers = 9" in bench.refuses("actuate", {"Fingers": 9}, of="finger_health")


@pytest.mark.parametrize("rule, mode", [("any", "position"), ("weakest", "force")])
def test_model_against_the_loops(rule, mode):
    """A period of the loop, with all inputs in its middle, is a cycle of the model. A speed is reported 3
    clocks, its delay, before the first decision that it applies to."""
    draw = random.Random(bench.SEED)
    grip = GripConfig(200, 900, 300, 170, 2000, 41000, 3333, 3, rule, mode, boost=2)
    config = ActuateConfig(grip, -3, 90, 4, 5)
    assert config.settings == {
        **{"enable": 1, "period": 200, "step": 900, "decay": 170, "minimum": 2000, "maximum": 41000},
        **{"rate": 3333, "watchdog": 3, "rule": rule == "weakest", "mode": mode == "force", "immediate": 0},
        **{"low": -3, "high": 90, "rail": 4, "divide": 5, "speed_gain": 300, "boost": 2},
    }
    override = 7777 if mode == "force" else None
    loop = GripLoop(2, 16, 8, **grip.settings, override=int(mode == "force"), override_value=7777)
    runs, twin, expected, got = Runs(2, 4, -3, 90), Actuate(config), [], []
    for period in range(300):
        if period == 3 and override:
            loop.settings["override"], override = 0, None
        slipping, dying = period // 10 % 3 * 0.4, draw.random() < 0.3
        length = 0 if period // 7 % 9 == 8 else 6
        samples = [[90 if dying and draw.random() < 0.9 else 40 for _ in range(length)] for _ in range(2)]
        over = [[draw.random() < slipping for _ in range(length)] for _ in range(2)]
        ends, lost = [n % 4 == 3 for n in range(length)], draw.random() < 0.05
        reports = [
            (at, draw.randrange(2), draw.choice([None, 0, draw.randrange(2000)])) for at in range(length + 1)
        ]
        reports = [report for report in reports if draw.random() < 0.3]
        got.append(twin.next(np.array(samples).reshape(2, -1), over, ends, lost, override, reports))
        reports = {17 + 2 * at: (finger, speed is not None, speed or 0) for at, finger, speed in reports}
        feed = [(f, n) for n in range(length) for f in range(2)]
        for n in range(200):
            decision, well = None, [not lost or n != 100] * 2
            if 20 <= n < 20 + len(feed):
                finger, place = feed[n - 20]
                decision = finger, over[finger][place], ends[place]
                runs.sample(finger, samples[finger][place])
            well = [one and two for one, two in zip(well, runs.healthy())]
            ended = loop.clock(decision, reports.get(n), well)
        faulty = tuple(bool(ended["faulty"] >> f & 1) for f in range(2))
        expected.append(
            Command(*(ended[name] for name in ("increment", "command", "fault", "valid", "word")), faulty)
        )
    assert got == expected
    assert twin.commands == sum(word.valid for word in expected)
    assert twin.tightenings == sum(word.increment > 0 for word in expected) > 20
    assert {word.fault & 3 for word in got} == {0, 1, 2, 3}


def test_a_start_is_the_reflex_own():
    config = ActuateConfig(replace(GripConfig(), decay=9))
    word = Actuate(config, start=5000).next(np.full((2, 4), 7), [[0, 0]] * 2, [0, 1])
    assert (word.increment, word.command) == (-9, 4991)
