"""msn_health on the frames of tb/reference/health_cases.py, and against the loop of tb/reference/health.py.

Checks masks beat by beat, events as they leave, the three counts. Run by test_health.py.
"""

import random

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge

import bench
import members
from reference.health import HealthReference
from reference.health_cases import REST, broken, cases

KINDS = {"dead": 1, "railed": 2, "blinking": 4}  # docs/link.md


async def begin(dut):
    settings = members.Settings(dut, "health_cfg")
    await bench.start(dut, event_ready_i=1)
    events = []

    async def listen():
        while True:
            await FallingEdge(dut.clk_i)
            if dut.event_valid_o.value == 1:
                events.append([bench.read(getattr(dut, f"event_{name}_o")) for name in ("id", *KINDS)])

    return settings, events, cocotb.start_soon(listen())


async def begin_again(dut, settings, given, events):
    settings.put(**members.limits(given))
    await bench.reset(dut)
    events.clear()


async def frame(dut, codes, over, whole=None):
    """Send one frame; return the masks of its taxels, [row][column]."""
    lanes, bits = dut.Lanes.value.to_unsigned(), dut.SampleBits.value.to_unsigned()
    beats = bench.lane_beats([codes], lanes, bits, surplus=-1, user=np.array([over]))
    if whole is not None:
        beats = [beats[place] | {"id": place, "last": last} for place, last in broken(whole, len(beats))]
        beats = bench.placed(beats, len(codes), -(-len(codes[0]) // lanes))
    got = await bench.stream(dut, beats, ["mask"], drain=12)
    flags = [bench.lane_values(beat["mask"], lanes, 1) for beat in got]
    row_beats = -(-len(codes[0]) // lanes)
    rows = [
        [bit for beat in flags[at : at + row_beats] for bit in beat] for at in range(0, len(flags), row_beats)
    ]
    return [row[: len(codes[0])] for row in rows]


def faults_of(dut, events, columns):
    """{beat: {place: all its faults}} of the events, with the numbers of docs/link.md."""
    lanes = dut.Lanes.value.to_unsigned()
    row_beats, told = -(-columns // lanes), {}
    for beat, *words in events:
        for lane in range(lanes):
            faults = sum(kind for kind, word in zip(KINDS.values(), words) if word >> lane & 1)
            if faults:
                place = beat // row_beats, beat % row_beats * lanes + lane
                told.setdefault(beat, {})[place] = faults
    return told


async def counts_are(dut, faults):
    expected = {name: sum(value & kind != 0 for value in faults.values()) for name, kind in KINDS.items()}
    assert members.of("health_status", bench.read(dut.status_o)) == expected


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def finds_what_the_hand_found(dut):
    shape = dut.Rows.value.to_unsigned(), dut.Columns.value.to_unsigned()
    lanes = dut.Lanes.value.to_unsigned()
    settings, events, listener = await begin(dut)
    mine = [case for case in cases() if case.shape == shape]
    assert len(mine) > 9
    for case in mine:
        await begin_again(dut, settings, case.settings, events)
        faults = {}
        for number in range(case.frames()):
            if case.clear and number == case.clear:
                await settings.pulse(dut.clk_i, clear=1)
                faults = {}
            if case.later and number == case.later[0]:
                settings.put(**members.limits(case.later[1]))
            whole = case.broken.get(number)
            masks = await frame(dut, case.frame(number), case.frame(number, case.over), whole)
            if whole is None:
                found = {(r, c) for r, row in enumerate(masks) for c, bit in enumerate(row) if bit}
                assert found == set(faults), f"{case.name}, frame {number}: masked"
            new = case.found.get(number, {})
            for place, kind in new.items():
                faults[place] = faults.get(place, 0) | kind
            row_beats = -(-shape[1] // lanes)
            beats = {row * row_beats + column // lanes for row, column in new}
            expected = {}
            for (row, column), kind in faults.items():
                if (beat := row * row_beats + column // lanes) in beats:
                    expected.setdefault(beat, {})[row, column] = kind
            assert faults_of(dut, events, shape[1]) == expected, f"{case.name}, frame {number}: events"
            assert len(events) == len(beats), f"{case.name}, frame {number}: events"
            events.clear()
        await counts_are(dut, faults)
    listener.cancel()


@cocotb.test(timeout_time=40, timeout_unit="ms")
async def finds_what_the_loop_finds(dut):
    """Random walks around band, jump and rails; frames that break off; a clear now and then."""
    rows, columns = dut.Rows.value.to_unsigned(), dut.Columns.value.to_unsigned()
    lanes = dut.Lanes.value.to_unsigned()
    settings, events, listener = await begin(dut)
    some = (
        {"still": 9, "edges": True},
        {"rail": 2, "over_range_enable": True},
        {"blink": 17},
        {"still": 22, "rail": 1, "blink": 33},
    )
    for seed, kind in enumerate(some):
        rng, draw = np.random.default_rng(bench.SEED + seed), random.Random(bench.SEED + seed)
        given = REST | {"low": -20, "high": 21, "edges": seed > 2} | kind
        await begin_again(dut, settings, given, events)
        loop, codes = HealthReference(rows, columns, **given), np.zeros((rows, columns), int)
        places = [(row, column) for row in range(rows) for column in range(columns)]
        row_beats, counts = -(-columns // lanes), {}
        for number in range(100):
            codes = np.clip(codes + rng.choice([0, 0, 0, 0, 2, 3, -3, 7, -7, 8, -8], codes.shape), -24, 24)
            over = rng.random(codes.shape) < 0.03
            length = rows * row_beats
            whole = draw.randrange(length) if draw.random() < 0.1 else None
            if draw.random() < 0.02:
                await settings.pulse(dut.clk_i, clear=1)
                loop.clear()
                counts = {}
            came = None
            if whole is not None:
                came = {(r, c) for r, c in places if r * row_beats + c // lanes < whole}
            masked = {place for place in places if loop.faults(*place)}
            masks = await frame(dut, codes.tolist(), over.tolist(), whole)
            new = loop.frame(codes.tolist(), over.tolist(), came)
            if whole is None:
                assert {(r, c) for r, c in places if masks[r][c]} == masked, f"frame {number}, {given}"
            counts = {place: counts.get(place, 0) | new.get(place, 0) for place in places}
            told = faults_of(dut, events, columns)
            assert set(told) == {r * row_beats + c // lanes for r, c in new}, f"frame {number}, {given}"
            for beat in told.values():
                assert beat.items() <= {place: loop.faults(*place) for place in places}.items()
            events.clear()
        await counts_are(dut, counts)
    listener.cancel()
