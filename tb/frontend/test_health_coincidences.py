"""msn_health with clear and report requested at every clock around the frame in which faults are found: two
taxels at the rail, found in every sixteenth frame; events and counts worked out by hand."""

import cocotb
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members

TAXELS, RAILED = 6, {2: 7, 5: -9}  # at low, and below it
LIMITS = {
    "band": 3,
    "jump": 50,
    "low": 7,
    "high": 900,
    "use_user": 0,
    "use_edges": 0,
    "still": 0,
    "rail": 1,
    "blink": 0,
}


def railed_of(dut):
    return members.of("health_status", bench.read(dut.status_o))["railed"]


async def run(dut, frames, pulses=(), ready_from=0):
    """Returns the clocks in which beats went in, [(clock, event)], and the count after each frame's last beat
    and at the end.

    ``pulses``: (input, clock); events are taken from the clock ``ready_from`` on."""
    await bench.reset(dut)
    taken, events, counts, settings = [], [], [], members.Settings(dut, "health_cfg", **LIMITS)
    beats = [(frame, place) for frame in range(frames) for place in range(TAXELS)]
    for clock in range(10**6):
        beat = beats[len(taken)] if len(taken) < len(beats) else None
        dut.in_valid_i.value = int(beat is not None)
        place = beat[1] if beat else 0
        value = RAILED.get(place, 100 + place) & 0xFFF
        bench.offer(dut, {"data": value, "id": place, **bench.marks(place, 2, 3)})
        settings.put(**{name: (name, clock) in pulses for name in ("clear", "report")})
        dut.event_ready_i.value = int(clock >= ready_from)
        await ReadOnly()
        if clock >= ready_from and dut.event_valid_o.value == 1:
            kinds = ("id", "dead", "railed", "blinking")
            events.append((clock, *(bench.read(getattr(dut, f"event_{kind}_o")) for kind in kinds)))
        if beat is not None and dut.in_ready_o.value == 1:
            if place == 0:
                counts.append(railed_of(dut))
            taken.append(clock)
        await RisingEdge(dut.clk_i)
        if beat is None and clock > taken[-1] + 20:
            break
    return taken, events, [*counts[1:], railed_of(dut)]


def in_frames(events, taken):
    """[(frame, taxel)]: each event with the latest frame that had begun; all must report the rail and no
    other fault."""
    assert all(event[2:] == (0, 1, 0) for event in events)
    firsts = taken[::TAXELS]
    return [(sum(first < clock for first in firsts) - 1, place) for clock, place, *_ in events]


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def cleared_and_reported_at_every_clock(dut):
    """Frames 16 and 32 check the rails. A clear before frame 16's first beat makes that frame the first of
    all; in that clock or later, the faults found are reported, then cleared, and found again in frame 32.
    After a report request, the next frame reports all existing faults once more."""
    await bench.start(dut, cfg_i=members.word("health_cfg", LIMITS), in_user_i=0, out_ready_i=1)
    frames, both = 35, lambda frame: [(frame, 2), (frame, 5)]
    usual, events, counts = await run(dut, frames)
    assert in_frames(events, usual) == both(16)
    assert counts == [0] * 16 + [2] * 19
    at_16, at_17 = usual[16 * TAXELS], usual[17 * TAXELS]
    for at in range(usual[16 * TAXELS - 1] - 1, at_17 + 3):
        early, late = at < at_16, at >= at_17
        taken, events, counts = await run(dut, frames, [("clear", at)])
        found = both(32) if early else both(16) + both(32)
        assert in_frames(events, taken) == found, at - at_16
        there = 0 if early else 2 if late else 1
        assert counts == [0] * 16 + [2] * (there == 2) + [0] * (16 - (there == 2)) + [2] * 3, at - at_16
        taken, events, counts = await run(dut, frames, [("report", at)])
        again = [] if early else both(18) if late else both(17)
        assert in_frames(events, taken) == both(16) + again, at - at_16
        assert counts == [0] * 16 + [2] * 19
        taken, events, counts = await run(dut, frames, [("report", at), ("clear", at)])
        assert in_frames(events, taken) == found, at - at_16


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def events_that_nobody_takes_meet_the_next_ones(dut):
    """Events stall until any clock of the following frames: each is reported once, none is lost, and the
    counts are not delayed."""
    await bench.start(dut, cfg_i=members.word("health_cfg", LIMITS), in_user_i=0, out_ready_i=1)
    usual, _, _ = await run(dut, 20)
    for ready_from in range(usual[16 * TAXELS], usual[18 * TAXELS] + 2):
        _, events, counts = await run(dut, 21, ready_from=ready_from)
        assert sorted(place for _, place, *_ in events) == [2, 5], ready_from - usual[16 * TAXELS]
        assert counts == [0] * 16 + [2] * 5


def test_health_coincidences():
    build = {"Rows": 2, "Columns": 3, "Lanes": 1, "SampleBits": 12}
    bench.run("frontend", "health", build, module="test_health_coincidences")
