"""msn_condition against its model with both stages, with each and with none: complete and damaged frames,
gaps and stalls, commands to either stage between two frames, events and counts; latency."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.condition import Condition
from meissner.twins.frontend.health import Limits

FIELDS = ["data", "mask", "fits", "row_last", "last"]
LIMITS = Limits(
    band=5, jump=30, low=-900, high=901, over_range_enable=True, edges=True, still=12, rail=1, blink=29
)
TARE = {"contact": 20, "step": 37}
COMMANDS = ("clear", "report", "tare", "force", "load", "zero_write")


def twin_of(dut):
    names = ("Rows", "Columns", "Lanes", "SampleBits", "Health", "Tare", "TareLog2")
    *size, health, tare, log2 = (getattr(dut, name).value.to_unsigned() for name in names)
    return Condition(*size, LIMITS if health else None, TARE | {"tare_log2": log2} if tare else None)


def shape_of(dut):
    return tuple(
        getattr(dut, name).value.to_unsigned() for name in ("Rows", "Columns", "Lanes", "SampleBits")
    )


async def begin(dut):
    given = {f"cfg_{name}_i": 0 for name in (*COMMANDS, "zero_word", "zero")} | {"event_ready_i": 1}
    given |= {f"cfg_{name}_i": int(value) for name, value in (vars(LIMITS) | TARE).items()}
    given["cfg_low_i"] &= (1 << len(dut.cfg_low_i)) - 1
    await bench.start(dut, **given)


async def pulse(dut, *names):
    for level in (1, 0):
        for name in names:
            getattr(dut, f"cfg_{name}_i").value = level
        await RisingEdge(dut.clk_i)


def beats_of(rng, dut, count):
    """Frames that are constant, walk, jump and stay at a rail."""
    rows, columns, lanes, bits = shape_of(dut)
    shape = (count, rows, columns)
    x = np.cumsum(rng.choice([0, 0, 9, -9, 40], (count, 1, 1)), axis=0) % 300 + rng.integers(-2, 3, shape)
    x[:, 0, 0] = 901
    x[:, 1, 1] = np.where(np.arange(count) % 5 < 3, x[:, 1, 1], 500)
    return bench.lane_beats(x, lanes, bits, surplus=-1, user=rng.random(shape) < 0.02)


def expected_of(dut, twin, beats):
    """Output beats and events."""
    _, _, lanes, bits = shape_of(dut)
    wide = len(dut.out_data_o) // lanes
    out, events = [], []
    for beat in beats:
        raw = np.array(bench.lane_values(beat["data"], lanes, bits, signed=True))
        over = bench.lane_values(beat["user"], lanes, 1)
        found, mask, news = twin.beat(raw, over, beat["id"], beat["last"], beat["fits"])
        events += news
        if found is not None:
            words = {"data": bench.lane_word(found, wide), "mask": bench.lane_word(mask, 1)}
            out.append(words | {name: int(beat[name]) for name in ("fits", "row_last", "last")})
    return out, events


def check_counts(dut, twin):
    for stage, names in (
        (twin.health, ("dead", "railed", "blinking")),
        (twin.tare, ("taring", "pressed", "tared", "refused", "swallowed")),
    ):
        for name in names:
            assert bench.read(getattr(dut, f"{name}_o")) == (getattr(stage, name) if stage else 0), name


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def matches_model(dut, stall_rate):
    rng, draw, twin, events = np.random.default_rng(bench.SEED), random.Random(bench.SEED), twin_of(dut), []
    rows, columns, lanes, _ = shape_of(dut)
    length = rows * -(-columns // lanes)
    await begin(dut)

    async def listen():
        while True:
            await FallingEdge(dut.clk_i)
            if dut.event_valid_o.value == 1:
                ports = ("id", "dead", "railed", "blinking")
                events.append(tuple(bench.read(getattr(dut, f"event_{name}_o")) for name in ports))

    cocotb.start_soon(listen())
    found = []
    for turn in range(24):
        beats = beats_of(rng, dut, 8)
        if turn % 3 == 2:
            beats = bench.damage(beats, length, draw) + beats[:length]
            beats = bench.placed(beats, rows, length // rows)
        pauses = bench.gaps_and_stalls(stall_rate)
        expected, news = expected_of(dut, twin, beats)
        assert await bench.stream(dut, beats, FIELDS, *pauses, hold=True) == expected
        found += news
        assert events == found
        check_counts(dut, twin)
        command = ("none", "tare", "clear", "load", "report", "force")[turn % 6]
        if command in ("clear", "report"):
            await pulse(dut, command)
            if twin.health:
                getattr(twin.health, command)()
        elif command in ("tare", "force"):
            await pulse(dut, "tare", *["force"] * (command == "force"))
            if twin.tare:
                twin.tare.tare(command == "force")
        elif command == "load":
            dut.cfg_load_i.value = 1
            await bench.clocks(dut, 12)
            assert bench.read(dut.cfg_loading_o) == (twin.tare is not None)
            if twin.tare:
                twin.tare.load(True)
            expected, _ = expected_of(dut, twin, beats[-length:])
            assert await bench.stream(dut, beats[-length:], FIELDS) == expected
            for word in range(length):
                dut.cfg_zero_word_i.value, dut.cfg_zero_i.value = word, 3 * word + turn
                await pulse(dut, "zero_write")
                if twin.tare:
                    twin.tare.write(word, 3 * word + turn, [0])
            dut.cfg_load_i.value = 0
            await bench.clocks(dut, 12)
            if twin.tare:
                twin.tare.load(False)
            dut.cfg_zero_i.value = 0
    if twin.health:
        assert twin.health.railed and events
    if twin.tare:
        assert twin.tare.tared and twin.tare.swallowed


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """One clock per stage, and none for a missing stage; a stalled output beat holds up the next."""
    twin = twin_of(dut)
    await begin(dut)
    await bench.clocks(dut, 12)
    dut.out_ready_i.value = dut.in_valid_i.value = 1
    bench.offer(dut, {"data": 77, "user": 0, "id": 0, **bench.marks(0, 2, 3)})
    for clock in range(4):
        await ReadOnly()
        assert bench.read(dut.out_valid_o) == (clock == sum(twin.steps.values()))
        await RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0


EVIDENCE = {
    "reference": {"joins": "health, tare"},
    "equivalence": {
        "size": {"Health": 1, "Tare": 1},
        "defined": True,
        "boxes": True,
        "open": ["reset"],
    },
    "faults": {"size": {"Health": 1, "Tare": 1}},
}


@pytest.mark.parametrize("health, tare, lanes", [(1, 1, 2), (1, 0, 1), (0, 1, 4), (0, 0, 2)])
def test_condition(health, tare, lanes):
    size = {"Rows": 3, "Columns": 5, "Lanes": lanes, "SampleBits": 17, "TareLog2": 2}
    bench.run("frontend", "condition", size | {"Health": health, "Tare": tare})
