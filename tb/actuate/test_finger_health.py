"""msn_finger_health against a loop written from docs/grip.md, clock by clock: samples at the rails, one code
next to them and in between, runs one sample short of the count and longer than the counter's range, lost
frames, ids without a finger. The model against the same loop, in chunks of any length."""

import random

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.actuate.actuate import FingerHealth

LOW, HIGH = -21, 300


class Runs:
    """docs/grip.md: a finger is unhealthy while its last ``rail`` samples or more are at the rail."""

    def __init__(self, fingers, rail, low=LOW, high=HIGH):
        self.rail, self.low, self.high = rail, low, high
        self.last = [[] for _ in range(fingers)]

    def sample(self, finger, code):
        if finger < len(self.last):
            self.last[finger].append(not self.low < code < self.high)

    def healthy(self):
        if not self.rail:
            return [True] * len(self.last)
        tails = [row[-self.rail :] for row in self.last]
        return [not (len(tail) == self.rail and all(tail)) for tail in tails]


def sizes(dut):
    return dut.Fingers.value.to_unsigned(), len(dut.in_id_i), dut.SampleBits.value.to_unsigned()


def codes(draw, bits):
    """Runs at a rail, broken now and then by other codes; each comparison is met exactly, one below and one
    above."""
    top = 2 ** (bits - 1) - 1
    rails = [LOW, LOW - 1, HIGH, HIGH + 1, top, -top - 1]
    between = [LOW + 1, HIGH - 1, 0, 17]
    while True:
        stays = draw.choice([0, 0.5, 0.9, 0.99, 1])
        for _ in range(draw.choice([20, 100, 1600 if stays == 1 else 400])):
            yield draw.choice(rails if draw.random() < stays else between)


async def answers_as(loop, dut, draw, feed, count):
    """Run ``count`` clocks with samples of ``feed`` and compare; return {(health of all, whether a frame was
    lost)}.

    The answer to a sample is valid 3 clocks after it, that to a lost frame 1 clock after.
    """
    fingers, id_bits, _ = sizes(dut)
    answers, seen = [[True] * fingers] * 3, set()  # of the coming clocks
    lost_before = False
    for clock in range(count):
        valid, lost = draw.random() < 0.8, draw.random() < 0.01
        finger = draw.choice([clock // 1500 % fingers, draw.randrange(2**id_bits)])
        code = next(feed)
        dut.in_valid_i.value, dut.in_id_i.value, dut.in_data_i.value = valid, finger, code
        dut.lost_i.value = lost
        await bench.ReadOnly()
        now = answers.pop(0)
        expected = [well and not lost_before for well in now]
        got = bench.read(dut.healthy_o)
        assert got == sum(well << place for place, well in enumerate(expected))
        seen.add((tuple(now), lost_before))
        if valid:
            loop.sample(finger, code)
        answers.append(loop.healthy())
        lost_before = lost
        await bench.RisingEdge(dut.clk_i)
    return seen


IDLE = {"in_valid_i": 0, "in_data_i": 0, "in_id_i": 0, "lost_i": 0}


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(rail=[0, 1, 2, 7, 254, 255])
async def matches_the_loop(dut, rail):
    fingers, _, bits = sizes(dut)
    draw = random.Random(bench.SEED + rail)
    await bench.start(dut, cfg_low_i=LOW, cfg_high_i=HIGH, cfg_rail_i=rail, **IDLE)
    seen = await answers_as(Runs(fingers, rail), dut, draw, codes(draw, bits), 9000)
    assert ({lost for _, lost in seen}) == {False, True}
    assert {well for row, _ in seen for well in row} == ({True} if rail == 0 else {False, True})


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_dead_finger_stays_unhealthy(dut):
    """300 samples at the rail for each finger in turn: unhealthy from the 255th on, until a sample off the
    rails."""
    fingers, _, _ = sizes(dut)
    await bench.start(dut, cfg_low_i=LOW, cfg_high_i=HIGH, cfg_rail_i=255, **IDLE)

    async def each(code):
        """Send one sample to each finger; return the healthy fingers, a bit each."""
        for finger in range(fingers):
            dut.in_valid_i.value, dut.in_id_i.value, dut.in_data_i.value = 1, finger, code
            await bench.RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, 2)
        await bench.ReadOnly()
        got = bench.read(dut.healthy_o)
        await bench.RisingEdge(dut.clk_i)
        return got

    everyone = (1 << fingers) - 1
    assert [await each(LOW) for _ in range(300)] == [everyone] * 254 + [0] * 46
    assert [await each(code) for code in (LOW + 1, HIGH)] == [everyone] * 2


def beside(draw, limits, bits):
    """Codes at the limits and one next to them, within a sample's range, and random ones."""
    least, most = -(1 << bits - 1), (1 << bits - 1) - 1
    ends = {limit + more for limit in limits for more in (-1, 0, 1)} | {least, most}
    ends = sorted(code for code in ends if least <= code <= most)
    while True:
        yield draw.choice(ends) if draw.random() < 0.7 else draw.randint(least, most)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_the_loop_at_any_settings(dut):
    """Limits of all 17 bits, also beyond the range of a narrow sample, and in either order."""
    fingers, _, bits = sizes(dut)
    draw, started, seen = random.Random(bench.SEED), False, set()
    for _ in range(60):
        low, high = (draw.choice([draw.randint(-65536, 65535), draw.randint(-300, 300)]) for _ in range(2))
        low, high = (low, high) if draw.random() < 0.2 else sorted((low, high))
        rail = draw.choice([1, 2, 3, draw.randrange(256)])
        settings = {"cfg_low_i": low, "cfg_high_i": high, "cfg_rail_i": rail}
        if started:
            for name, value in (settings | IDLE).items():
                getattr(dut, name).value = value
            await bench.reset(dut)
        else:
            started = True
            await bench.start(dut, **settings, **IDLE)
        loop, feed = Runs(fingers, rail, low, high), beside(draw, (low, high), bits)
        seen |= {well for row, _ in await answers_as(loop, dut, draw, feed, 100) for well in row}
    assert seen == {False, True}


EVIDENCE = {
    "equivalence": {"size": {"Fingers": 3}},
    "faults": {"none": "no frames: an upset of a run lasts until the finger's next sample between the rails"},
}


@pytest.mark.parametrize("parameters", [{"Fingers": 8}, {"Fingers": 3, "SampleBits": 13}, {"Fingers": 1}])
def test_finger_health(parameters):
    bench.run("actuate", "finger_health", parameters)


def test_refuses_illegal_parameters():
    assert "Fingers = 9 must lie" in bench.refuses("finger_health", {"Fingers": 9})
    assert "SampleBits = 18 must lie" in bench.refuses("finger_health", {"SampleBits": 18})


@pytest.mark.parametrize("rail", [0, 1, 2, 7, 255])
def test_model_against_the_loop(rail):
    draw = random.Random(bench.SEED)
    feeds = [codes(draw, 17) for _ in range(2)]
    twin, loop, seen = FingerHealth(2, LOW, HIGH, rail), Runs(2, rail), set()
    for _ in range(400):
        length = draw.choice([0, 1, 3, 20])
        samples = np.array([[next(feed) for _ in range(length)] for feed in feeds]).reshape(2, length)
        lost = draw.random() < 0.1
        well = np.array(loop.healthy())
        for column in samples.T.tolist():
            for finger, code in enumerate(column):
                loop.sample(finger, code)
            well &= loop.healthy()
        expected = (well & (not lost)).tolist()
        assert twin.next(samples, lost).tolist() == expected
        seen.add((expected[0], lost))
    assert (False, True) in seen and ((False, False) in seen) == (rail > 0)


def test_the_model_refuses_what_the_register_has_no_room_for():
    for rail in (-1, 256):
        with pytest.raises(ValueError, match=f"rail = {rail} must lie in 0 .. 255"):
            FingerHealth(2, rail=rail)
