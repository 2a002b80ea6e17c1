"""msn_slip_chain: the slip path's decisions, also through an array's skid buffers, are the twin's; the
actuator pin acts two clocks later; without a slip path, decisions about a centre of pressure are passed on;
the flags of both, updated once for a decision that stalls.
"""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip_chain import slip_chain
from meissner.twins.slip.slip_path import slip_flags
from reference.slip_changes import ChangesReference
from slip.test_slip_path import beats_of, recording

SETTINGS = {"threshold": 60, "gross_threshold": 110, "contact_level": 200, "release_level": -100}
SETTINGS |= {"contact_rises": 1, "hold": 3, "refractory": 4, "blank": 5, "keep_threshold": 35}


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def config_of(dut):
    sizes = {name.lower(): number(dut, name) for name in ("Window", "Hop", "Level")}
    return SlipConfig(**sizes, **SETTINGS | {"contact_rises": True})


async def begin(dut, moving=0):
    idle = dict.fromkeys(("in_data", "in_id", "in_last", "in_mask", "cop_valid", "cop"), 0)
    given = {f"{name}_i": value for name, value in idle.items()}
    given["cfg_i"] = members.word("slip_cfg", SETTINGS)
    await bench.start(dut, actuator_moving_i=moving, **given)


async def run(dut, beats, gap=0.0, stall=0.0, drain=120, verdicts=None):
    """The decisions taken; the flags a clock after each was first offered; ``verdicts``: list to which
    verdicts are added."""
    verdicts = [] if verdicts is None else verdicts
    gaps, stalls = bench.gaps_and_stalls(gap, stall)
    decisions, flags, sent, quiet, waits, flagged, held = [], [], 0, 0, False, False, False
    while quiet < drain:
        offer = sent < len(beats) and (held or not gaps())
        dut.in_valid_i.value = int(offer)
        if offer:
            bench.offer(dut, beats[sent])
        ready = not stalls()
        dut.out_ready_i.value = int(ready)
        await ReadOnly()
        if flagged:
            flags.append(tuple(bench.read(getattr(dut, f"{n}_o")) for n in ("slip", "gross", "touched")))
        valid = dut.out_valid_o.value == 1
        flagged = valid and not waits
        waits = valid and not ready
        if valid and ready:
            decisions.append(members.of("decision", bench.read(dut.out_o)))
        verdict = members.of("verdict", bench.read(dut.verdict_o))
        if verdict["valid"]:
            assert flagged, "a verdict comes as its decision is offered first"
            verdicts.append(tuple(verdict[name] for name in ("id", "over", "last")))
        if valid or (sent < len(beats)):
            assert not valid or dut.busy_o.value == number(dut, "Slip")
        took = offer and dut.in_ready_o.value == 1
        held = offer and not took
        sent += took
        quiet = 0 if valid or took or sent < len(beats) else quiet + 1
        await RisingEdge(dut.clk_i)
    assert not number(dut, "Slip") or dut.busy_o.value == 0
    return decisions, flags


@bench.applies(lambda dut: number(dut, "Slip"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0), (0.3, 0.5)], moving=[0, 1])
async def events_and_flags_are_the_models(dut, pace, moving):
    await begin(dut, moving)
    await bench.clocks(dut, 3)  # the two flip-flops at the pin
    channels, config = number(dut, "Channels"), config_of(dut)
    x = recording(np.random.default_rng(bench.SEED), channels, 700)
    beats = [beat | {"mask": 0} for beat in beats_of(x)]
    verdicts = []
    decisions, flags = await run(dut, beats, *pace, verdicts=verdicts)
    group = 1 << config.level
    assert len(decisions) == 700 // group * channels
    assert [d["id"] for d in decisions] == list(range(channels)) * (700 // group)
    assert all(d["last"] == (d["id"] == channels - 1) for d in decisions)
    # Verdicts of single channels: one per detail, over by peak-to-peak alone, whether it moves or not;
    # docs/slip.md.
    span, hop = config.window // group, config.hop // group
    ends = lambda n: n >= span - 1 and (n - (span - 1)) % hop == 0
    expected = [
        (d["id"], int(d["p2p"] > 60), int(ends(place // channels))) for place, d in enumerate(decisions)
    ]
    assert verdicts == ([] if number(dut, "Array") and number(dut, "Lanes") > 1 else expected)
    assert {over for _, over, _ in expected} == {0, 1}
    heard = ChangesReference(channels)
    changes = [
        ((place // channels + 1) * group - 1, d["id"], d["p2p"], found)
        for place, d in enumerate(decisions)
        if (found := heard.decision(d["id"], d["state"], bool(d["raised"]), True))
    ]
    assert changes == slip_chain(x.T, config, np.full(700 // group, bool(moving)))
    starts = [found for *_, (start, *found) in changes if start]
    assert bool(starts) != bool(moving) and len(changes) >= len(starts) + channels
    assert flags == [
        tuple(map(int, row)) for row in slip_flags([(d["id"], d["state"], d["last"]) for d in decisions])
    ]
    status = members.of("slip_status", bench.read(dut.status_o))
    assert (status["blanked"] > 0) and status["damaged"] == 0


@bench.applies(lambda dut: number(dut, "Slip") and number(dut, "Mask"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def what_is_masked_raises_nothing(dut):
    await begin(dut)
    x = recording(np.random.default_rng(bench.SEED + 1), number(dut, "Channels"), 300)
    decisions, _ = await run(dut, [beat | {"mask": 1} for beat in beats_of(x)])
    assert decisions and not any(d["raised"] or d["p2p"] for d in decisions)


@bench.applies(lambda dut: number(dut, "Slip") and number(dut, "Array"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def is_busy_from_a_sample_on(dut):
    """Also in the clock in which the sample is offered, when the slip path does not yet have it."""
    await begin(dut)
    dut.in_valid_i.value = 1
    await ReadOnly()
    assert (dut.in_ready_o.value, dut.busy_o.value) == (1, 1)
    await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await ReadOnly()
    assert dut.busy_o.value == 1
    await bench.clocks(dut, 20)
    await ReadOnly()
    assert dut.busy_o.value == 0
    await RisingEdge(dut.clk_i)


@bench.applies(lambda dut: number(dut, "Slip"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_damaged_frame_is_counted_and_raises_no_flag_of_a_later_one(dut):
    """Contact in all channels; slip in the first, whose frame is cut before the others; then nothing."""
    await begin(dut)
    channels, group = number(dut, "Channels"), 1 << number(dut, "Level")
    frame = lambda code: [
        {"data": code, "id": c, "last": int(c == channels - 1), "mask": 0} for c in range(channels)
    ]
    contact = [beat for _ in range(8 * group) for beat in frame(500)]
    assert (await run(dut, contact))[1][-1] == (0, 0, 1)
    cut = {"data": 800, "id": 0, "last": 0, "mask": 0}, {"data": 0, "id": 0, "last": 1, "mask": 0}
    _, flags = await run(dut, [beat for _ in range(group - 1) for beat in frame(500)] + list(cut))
    assert flags == [(1, 1, 1)]
    assert members.of("slip_status", bench.read(dut.status_o)) == {"damaged": 1, "blanked": 0}
    _, flags = await run(dut, [beat for _ in range(group) for beat in frame(-400)])
    assert flags == [(1, 1, 1)] * (channels - 1) + [(0, 0, 0)]


@bench.applies(lambda dut: not number(dut, "Slip"))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def passes_on_the_decisions_about_a_centre_of_pressure(dut):
    """Every bit of each member, in the same clock, and ready likewise; then the flags."""
    await begin(dut)
    draw, seen = random.Random(bench.SEED), []
    for clock in range(200):
        bits = {name: draw.choice((0, (1 << n) - 1)) for name, (_, n) in members.PLACES["decision"].items()}
        given = bits | {"state": clock % 5}
        valid, ready = int(draw.random() < 0.6), int(draw.random() < 0.5)
        dut.cop_valid_i.value, dut.out_ready_i.value = valid, ready
        dut.cop_i.value = members.word("decision", given)
        dut.in_valid_i.value = draw.getrandbits(1)
        await ReadOnly()
        assert (dut.out_valid_o.value, dut.cop_ready_o.value) == (valid, ready)
        assert members.of("decision", bench.read(dut.out_o)) == given
        assert (dut.in_ready_o.value, dut.busy_o.value, bench.read(dut.status_o)) == (1, 0, 0)
        seen.append((valid, ready, given["id"], given["state"], given["last"]))
        await RisingEdge(dut.clk_i)
    dut.cop_valid_i.value = 0
    first = [
        decision
        for place, (valid, _, *decision) in enumerate(seen)
        if valid and not (place and seen[place - 1][0] and not seen[place - 1][1])
    ]
    await ReadOnly()
    flags = tuple(bench.read(getattr(dut, f"{name}_o")) for name in ("slip", "gross", "touched"))
    assert flags == tuple(map(int, slip_flags(first)[-1])) and len(first) > 40
    await RisingEdge(dut.clk_i)


PATH = {"Window": 16, "Hop": 8, "Level": 1}


EVIDENCE = {}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Array": 1, "Lanes": 2, "Channels": 3, "Mask": 1, "TimerBits": 5} | PATH,
        {"Channels": 2, "SampleBits": 13} | PATH,
        {"Slip": 0},
    ],
    ids=["array", "channels", "cop"],
)
def test_slip_chain(parameters):
    bench.run("slip", "slip_chain", parameters)
