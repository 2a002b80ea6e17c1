"""msn_health_taxel against its model, a taxel a clock and taxels that stay: samples, counters and thresholds
at their ends and one off; the first frame, reports sent and not sent; and the model against a plain loop."""

import random
from dataclasses import astuple

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock

import bench
import members
from meissner.twins.frontend.health import Limits
from meissner.twins.frontend.health_taxel import State, judge

FLAGS = ("pair", "border", "alone", "over", "surplus", "again", "tick", "fresh", "send")
COUNTERS = ("rail", "blink", "still")


def near(draw, *values, low=0, high=255):
    """One of ``values``, or one below or above it."""
    return min(max(draw.choice(values) + draw.choice((-1, 0, 0, 1)), low), high)


def limits_of(draw, bits):
    low, high = bench.width(bits)
    top = (1 << bits) - 1
    band, jump = sorted(min(top, draw.choice((0, 5, 30, 200, draw.getrandbits(bits), top))) for _ in "bj")
    counts = {name: draw.choice((0, 1, 4, 16, 17, 254, 255, draw.getrandbits(8))) for name in COUNTERS}
    ends = {
        "low": draw.choice((low, low + 9, draw.randint(low, high))),
        "high": draw.choice((high, high - 5, 7, draw.randint(low, high))),
    }
    return Limits(band, jump, **ends, over_range_enable=draw.random() < 0.5, **counts)


def case_of(draw, bits, limits):
    """A taxel's state, sample and flags, near the limits."""
    low, high = bench.width(bits)
    held = draw.choice((low, high, 0, draw.randint(low, high)))
    step = near(draw, 0, limits.band, limits.jump, high=2 * high) * draw.choice((-1, 1))
    raw = draw.choice((held + step, held + step, low, high, limits.low, limits.high + 1, limits.high))
    state = {
        name: near(draw, 0, 16, getattr(limits, name), getattr(limits, name) - 4, 239, 255)
        for name in COUNTERS
    }
    state |= {"held": held, "since": draw.randrange(4), "rising": draw.random() < 0.5}
    state |= {"jumped": draw.random() < 0.5, "faults": draw.choice((0, 0, draw.randrange(8)))}
    state["reported"] = draw.random() < 0.7
    flags = {name: draw.random() < 0.4 for name in FLAGS} | {
        "fresh": draw.random() < 0.1,
        "surplus": draw.random() < 0.1,
    }
    flags["border"] &= not flags["alone"]
    flags["pair"] &= not flags["alone"]
    return {"raw": min(max(raw, low), high), "state": state} | flags


def plain(case, limits):
    """(state, news, event, recently moved, upwards): the header of msn_health for one taxel, line by line."""
    state, raw = dict(case["state"]), case["raw"]
    if case["fresh"]:
        moved = abs(raw - state["held"]) > limits.band
        rose = raw >= state["held"] if moved else state["rising"]
        return {"held": raw} | {name: 0 for name in state if name != "held"}, 0, False, False, rose
    step = abs(raw - state["held"])
    moved = step > limits.band
    if moved or state["since"]:
        state["still"] = 0
    elif case["pair"]:
        state["still"] = min(255, state["still"] + 4)
    elif case["border"]:
        state["still"] = min(255, state["still"] + 1)
    if raw <= limits.low or raw >= limits.high or (case["over"] and limits.over_range_enable):
        if case["tick"] and state["rail"] < 255:
            state["rail"] += 1
    else:
        state["rail"] = 0
    if state["jumped"] and case["alone"]:
        state["blink"] = min(255, state["blink"] + 16)
    elif state["blink"]:
        state["blink"] -= 1
    state["jumped"] = step > limits.jump
    if moved:
        state["rising"], state["held"], state["since"] = raw > state["held"], raw, 3
    elif state["since"]:
        state["since"] -= 1
    before = state["faults"]
    for kind, name in ((1, "still"), (2, "rail"), (4, "blink")):
        if 0 < getattr(limits, name) <= state[name] and not before & kind:
            state["faults"] += kind
    news = state["faults"] - before
    told = state["reported"] and not case["again"] and not news
    event = state["faults"] > 0 and not told
    state["reported"] = state["faults"] > 0 and (told or case["send"])
    return state, news, event, state["since"] > 0, state["rising"]


def of_model(cases, limits):
    """The model's results for taxels in parallel that share tick, fresh, again and send."""
    column = lambda values, kind: np.array(list(values), dtype=kind)
    kinds = dict.fromkeys(("rising", "jumped", "reported"), bool)
    state = State(
        *(column((c["state"][name] for c in cases), kinds.get(name, np.int64)) for name in State._fields)
    )
    raw, over = column((c["raw"] for c in cases), np.int64), column((c["over"] for c in cases), bool)
    around = [column((c[name] for c in cases), bool) for name in ("pair", "border", "alone")]
    shared = {name: cases[0][name] for name in ("tick", "fresh", "again", "send")}
    found = judge(state, raw, over, around, limits, **shared)
    each = zip(*(values.tolist() for values in found.state))
    rest = zip(*(values.tolist() for values in found[1:]))
    return [(dict(zip(State._fields, values)), *others) for values, others in zip(each, rest)]


def word(state, bits):
    """The state as the block stores it; its faults are dead, railed, blinking from the highest bit down."""
    fields = (
        (state["held"] & (1 << bits) - 1, bits),
        *((state[name], 8) for name in COUNTERS),
        (state["since"], 2),
    )
    fields += (
        (state["rising"], 1),
        (state["jumped"], 1),
        (turned(state["faults"]), 3),
        (state["reported"], 1),
    )
    value = 0
    for field, width in fields:
        value = value << width | int(field)
    return value


def turned(faults):
    return faults >> 2 & 1 | faults & 2 | (faults & 1) << 2


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def matches_model(dut):
    bits, draw = dut.SampleBits.value.to_unsigned(), random.Random(bench.SEED)
    Clock(dut.clk_i, 10, unit="ns").start()
    for _ in range(bench.rounds(60)):
        limits = limits_of(draw, bits)
        members.Settings(dut, "health_cfg", **members.limits(limits))
        await bench.clocks(dut, 3)
        slots = [None] * 5
        for clock in range(160):
            take = clock < 155 and (clock == 0 or draw.random() < 0.8)
            fresh = case_of(draw, bits, limits)
            slots.insert(
                0, fresh if take else dict(slots[0] or fresh) | {"tick": fresh["tick"], "send": fresh["send"]}
            )
            del slots[6:]
            now, last, _, third, fourth, fifth = slots
            dut.take_i.value = int(take)
            dut.state_i.value = word(fresh["state"], bits)
            for port in ("pair", "border", "alone", "surplus", "again"):
                getattr(dut, f"{port}_i").value = int(fresh[port])
            dut.user_i.value = int(fresh["over"])
            dut.raw_i.value = ((last or now)["raw"]) & (1 << bits) - 1
            if third:
                dut.tick_i.value, dut.fresh_i.value = int(third["tick"]), int(third["fresh"])
            if fourth:
                dut.send_i.value = int(fourth["send"])
            await bench.ReadOnly()
            if fourth:
                [(state, news, event, *_)] = of_model([fourth], limits)
                if fourth["surplus"]:
                    state, news, event = state | {"faults": 0}, 0, False
                assert bench.read(dut.faults_o) == turned(state["faults"])
                assert bench.read(dut.event_o) == event
                if not fourth["surplus"]:
                    assert bench.read(dut.news_o) == turned(news)
            if fifth and not fifth["surplus"]:
                [(state, _, _, *moves)] = of_model([fifth], limits)
                assert bench.read(dut.state_o) == word(state, bits), (fifth, astuple(limits))
                assert bench.read(dut.moves_o) == 2 * moves[0] + moves[1]
            await bench.RisingEdge(dut.clk_i)


EVIDENCE = {}


@pytest.mark.parametrize("bits", [17, 6])
def test_health_taxel(bits):
    bench.run("frontend", "health_taxel", {"SampleBits": bits})


def test_model_against_a_plain_loop():
    draw = random.Random(7)
    kinds = set()
    for _ in range(4000):
        limits = limits_of(draw, 17)
        case = case_of(draw, 17, limits)
        expected = plain(case, limits)
        assert of_model([case], limits) == [expected], (case, limits)
        kinds.add((expected[1], expected[2]))
    assert kinds >= {(0, False), (0, True), (1, True), (2, True), (4, True)}
