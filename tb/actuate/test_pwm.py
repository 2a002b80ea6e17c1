"""msn_pwm against its model clock by clock: words that change in any clock, every width of small words, both
ends, dividers that change; no pulse before the first word; reset during a pulse. The model by hand."""

import random

import cocotb
import pytest

import bench
from meissner.twins.actuate.actuate import pwm

QUIET = {"in_valid_i": 0, "in_data_i": 0, "cfg_divide_i": 0}


def steps(dut):
    return (1 << dut.Bits.value.to_unsigned()) - 1


async def clock(dut, word=None):
    """One clock, with a word or none; returns (pin, whether a period begins)."""
    dut.in_valid_i.value = word is not None
    dut.in_data_i.value = steps(dut) // 3 if word is None else word
    await bench.ReadOnly()
    got = bench.read(dut.pwm_o), bench.read(dut.begin_o)
    await bench.RisingEdge(dut.clk_i)
    return got


@bench.applies(lambda dut: steps(dut) < 100)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_model(dut):
    """A period at the pin uses the word of three clocks before its first clock, and the divider of two
    before."""
    draw, top = random.Random(bench.SEED), steps(dut)
    await bench.start(dut, **QUIET)
    given, pins = [], []
    widths = [*range(top + 1), 0, top, 0, top] + [draw.randint(0, top) for _ in range(40)]
    word, divide = widths[0], 0
    for now in range(20000):
        fresh = now == 0 or draw.random() < 0.03
        if fresh and now:
            word = widths.pop(0) if widths else draw.randint(0, top)
        if draw.random() < 0.01:
            dut.cfg_divide_i.value = divide = draw.choice([0, 0, 1, 2, 5])
        given.append((word, divide))
        pins.append(await clock(dut, word if fresh else None))
    assert not widths and pins[:3] == [(0, 0)] * 3
    at, seen = 3, set()
    while at < 19000:
        word, divide = given[at - 3][0], given[at - 2][1]
        period = pwm([word], top.bit_length(), divide)
        begins = [1] + [0] * (len(period) - 1)
        assert pins[at : at + len(period)] == list(zip(period, begins)), at
        at += len(period)
        seen.add(word)
    assert {0, 1, top - 1, top} <= seen


@bench.applies(lambda dut: steps(dut) == 65535)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(word=[65535, 40000, 0])
async def a_whole_period_of_16_bits(dut, word):
    """65535 clocks, of which the first ``word`` are high; the next period follows immediately."""
    await bench.start(dut, **QUIET)
    await clock(dut, word)
    await clock(dut)
    await clock(dut)
    levels = [await clock(dut) for _ in range(65536)]
    assert levels[0] == (int(word > 0), 1) and levels[65535] == levels[0]
    high = [level for level, _ in levels[:65535]]
    assert sum(high) == sum(high[:word]) == word and sum(begin for _, begin in levels) == 2


@bench.applies(lambda dut: steps(dut) == 65535)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(divide=[255, 254, 128, 85])
async def each_step_has_all_clocks_of_the_divider(dut, divide):
    """Two steps are high; ``begin`` marks one clock, not every clock of the first step."""
    await bench.start(dut, **QUIET | {"cfg_divide_i": divide})
    await clock(dut, 2)
    await clock(dut)
    await clock(dut)
    long = 2 * (divide + 1)
    assert [await clock(dut) for _ in range(2 * long)] == [(1, 1)] + [(1, 0)] * (long - 1) + [(0, 0)] * long


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def no_pulses_until_a_word_comes(dut):
    """Nor after a reset in the middle of a pulse."""
    await bench.start(dut, **QUIET)
    for _ in range(3):
        assert {await clock(dut) for _ in range(300)} == {(0, 0)}
        await clock(dut, steps(dut))
        assert [await clock(dut) for _ in range(4)] == [(0, 0), (0, 0), (1, 1), (1, 0)]
        await bench.reset(dut)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "pwm_o", "begin_o")


EVIDENCE = {
    "equivalence": {"size": {"Bits": 5}},
    "faults": {
        "none": "no frames: an upset lasts to the period's end, of the word or its flag to the next word"
    },
}


@pytest.mark.parametrize("parameters", [{}, {"Bits": 5, "DivideBits": 3}])
def test_pwm(parameters):
    bench.run("actuate", "pwm", parameters)


def test_refuses_illegal_parameters():
    assert "Bits = 17 must" in bench.refuses("pwm", {"Bits": 17})
    assert "DivideBits = 17 must" in bench.refuses("pwm", {"DivideBits": 17})


BY_HAND = (  # words, settings, and the pin clock by clock
    ([0, 1, 3], {"bits": 2}, [0, 0, 0, 1, 0, 0, 1, 1, 1]),
    ([2], {"bits": 2, "divide": 2}, [1] * 6 + [0] * 3),
)


def test_model_by_hand():
    for words, settings, pin in BY_HAND:
        assert pwm(words, **settings) == pin
    assert sum(pwm([40000])) == 40000 and len(pwm([40000])) == 65535
    for wrong in ({"bits": 1}, {"bits": 17}, {"divide": -1}, {"divide": 65536}):
        ((name, value),) = wrong.items()
        with pytest.raises(ValueError, match=f"{name} = {value} must lie"):
            pwm([0], **wrong)
    for word in (-1, 16):
        with pytest.raises(ValueError, match=rf"word = {word} must lie in 0 .. 15"):
            pwm([word], bits=4)
