"""msn_sensor_array with frames on the stream: forces one by one, centres of pressure, health and counters are
the twin's, with settings through the struct; a frame's time is that of its first beat. At the pins:
test_array_pins.py and tb/core.
"""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.frontend.adc_spi import MAX11125, MCP3208
from meissner.twins.frontend.health import Limits
from meissner.twins.sensor.sensors import from_reset, sensor_array
from sensor import array_by_hand

ROWS, COLUMNS, LANES = 3, 4, 2
LIMITS = Limits(
    band=30, jump=700, low=5, high=4000, over_range_enable=True, edges=False, still=40, rail=2, blink=9
)
TARE = {"contact": 50, "step": 3}
GAIN, LEAST = 5000, {True: 4000, False: 8000}  # lower with a tare, which removes the idle level


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def settings(whole):
    limits = {f"health_{name}": value for name, value in members.limits(LIMITS).items()}
    tare = {"tare_contact": 50, "tare_step": 3, "tare_at_start": 1}
    return limits | tare | {"calibrate_preset": GAIN, "cop_min_load": LEAST[whole]}


def twin_of(dut):
    class Size:
        rows, columns, lanes = ROWS, COLUMNS, LANES

    whole = bool(number(dut, "Health"))
    tare = TARE | {"tare_log2": number(dut, "TareLog2")} if whole else None
    return from_reset(Size, GAIN, LIMITS if whole else None, tare, min_load=LEAST[whole])


def samples():
    """Idle, then a press that moves; one taxel that jumps, and one at the end of the range."""
    rng = np.random.default_rng(bench.SEED)
    found = rng.integers(100, 140, (40, ROWS, COLUMNS))
    found[8:, 1:, 1:3] += rng.integers(800, 1500, (32, 2, 2))
    found[::3, 0, 3] = 1900
    found[4:, 2, 0] = 4000
    return found


@bench.applies(lambda dut: not number(dut, "Adc"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pace=[(0.0, 0.0, 0), (0.3, 0.4, 5), (0.0, 0.0, 60)])
async def everything_is_the_models(dut, pace):
    gap, stall, rest = pace
    names = "now pending busy adc_miso adc_busy in_data in_id in_last sample_ready health_ready"
    given = {f"{name}_i": 0 for name in names.split()}
    await bench.start(dut, cfg_i=members.word("cfg", settings(bool(number(dut, "Health")))), **given)
    source, sink = random.Random(f"{bench.SEED} in"), random.Random(f"{bench.SEED} out")
    frames, clock, held, busy = samples(), 0, False, 0
    beats = frames.reshape(-1, LANES).tolist()
    per_frame = len(beats) // len(frames)
    forces, cops, reports, firsts, sent, quiet = [], [], [], [], 0, 0
    await bench.clocks(dut, 100)
    while quiet < 300:
        offer = sent < len(beats) and (held or source.random() >= gap)
        beat, place = beats[min(sent, len(beats) - 1)], sent % per_frame
        dut.in_valid_i.value, dut.in_id_i.value = int(offer), place
        dut.in_last_i.value = int(place == per_frame - 1)
        dut.in_data_i.value = bench.lane_word(beat, 17)
        ready, now = int(sink.random() >= stall), 3 + 7 * clock
        dut.sample_ready_i.value, dut.health_ready_i.value, dut.now_i.value = ready, ready, now
        dut.busy_i.value = int(busy > 0)
        await ReadOnly()
        time, busy = bench.read(dut.time_o), max(0, busy - 1)
        if dut.sample_valid_o.value == 1 and ready:
            values = [bench.read(getattr(dut, f"sample_{name}_o")) for name in ("data", "mask", "id", "last")]
            forces.append((*values, time))
            busy = rest
        if dut.cop_valid_o.value == 1:
            cop = members.of("cop", bench.read(dut.cop_o))
            sides = [bench.as_signed(cop[side], 24) for side in "xy"]
            cops.append((*sides, cop["load"], cop["pressed"], time))
        if dut.health_valid_o.value == 1 and ready:
            reports.append(members.of("health", bench.read(dut.health_o)))
        took = offer and dut.in_ready_o.value == 1
        if took and place == 0:
            assert not bench.read(dut.busy_i), "a frame was let in while what follows is busy"
            firsts.append(now)
        held = offer and not took
        sent += took
        quiet = 0 if took or sent < len(beats) else quiet + 1
        await RisingEdge(dut.clk_i)
        clock += 1
        assert clock < 30_000
    twin = twin_of(dut)
    sensed = sensor_array(twin, frames)
    taxels = ROWS * COLUMNS
    assert len(firsts) == len(frames) == len(set(firsts))
    assert cops == [(*cop, time) for cop, time in zip(sensed.cop, firsts)]
    if number(dut, "Tap"):
        assert forces == [
            (int(sensed.forces[n, t]), int(sensed.mask[n, t]), t, int(t == taxels - 1), firsts[n])
            for n in range(len(frames))
            for t in range(taxels)
        ]
    assert len({cop[:3] for cop in cops}) > 20 and any(not cop[3] for cop in cops)
    status = {k: v for k, v in members.of("status", bench.read(dut.status_o)).items() if v}
    if number(dut, "Health"):
        assert status.pop("health_railed") == twin.health.railed > 0
        assert status.pop("health_blinking") == twin.health.blinking > 0
        assert status.pop("tare_tared", 0) == twin.tare.tared > 0
        assert {r["id"] for r in reports} >= {3, 8} and sensed.mask.any()
        status.pop("health_dead", 0)
        status.pop("tare_state_pressed", 0)
    assert status == {}


@bench.applies(lambda dut: number(dut, "Adc"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_of_a_scan_have_their_first_convert_start(dut):
    """The stream is ignored. The data line is high: codes of all ones, as a carrier without amplitude."""
    names = "now pending busy adc_busy in_data in_id in_last"
    settings = members.Settings(dut, "cfg", scan_settle=5, calibrate_preset=4096)
    given = {f"{name}_i": 0 for name in names.split()} | {"adc_miso_i": 1, "in_valid_i": 1}
    await bench.start(dut, sample_ready_i=1, health_ready_i=1, **given)
    await bench.clocks(dut, 20)
    settings.put(scan_enable=1)
    carrier, per_frame = number(dut, "Demod"), 6
    taxels, converts, clock = [], [], 0
    while len(taxels) < 3 * per_frame:
        clock += 1
        dut.now_i.value = 7 * clock
        await ReadOnly()
        assert bench.read(dut.in_ready_o) == 0
        if bench.read(dut.convert_o):
            converts.append(7 * clock)
        if bench.read(dut.sample_valid_o):
            sample = [bench.read(getattr(dut, f"sample_{name}_o")) for name in ("data", "id", "last")]
            taxels.append((*sample, bench.read(dut.time_o)))
        await RisingEdge(dut.clk_i)
    value = 0 if carrier else 4095
    assert [taxel[:3] for taxel in taxels] == [(value, n, int(n == 5)) for n in range(per_frame)] * 3
    early = 7 if carrier else 0  # with a carrier the pin follows a register later
    times = [taxel[3] + early for taxel in taxels]
    firsts = times[::per_frame]
    assert times == [time for time in firsts for _ in range(per_frame)]
    assert len(set(firsts)) == 3 and set(firsts) <= set(converts) and firsts[0] == converts[0]
    found = {name: n for name, n in members.of("status", bench.read(dut.status_o)).items() if n}
    # That part tags its answers: wrong here.
    assert found.keys() == ({"scan_lost"} if carrier else set()) and found.get("scan_lost", 18) >= 18


EVIDENCE = {
    "equivalence": {"defined": True, "boxes": True},
    "mutants": {"sets": [1], "limit": 60, "unsolved": True},
    "faults": {
        "settle": 40,
        # An event that is not taken immediately comes with the next frame.
        "driver": {"quiet": "health_", "ready": "health_", "skip": "gone", "repeat": 4},
        "kept_inside": {"u_calibrate": "calibrate", "u_tare": "tare", "u_health": "health"},
    },
}
WHOLE = {
    "Rows": ROWS,
    "Columns": COLUMNS,
    "Converters": LANES,
    "Health": 1,
    "Tare": 1,
    "TareLog2": 2,
    "Tap": 1,
}
BARE = {"Rows": ROWS, "Columns": COLUMNS, "Converters": LANES, "Tap": 0}
SCAN = {"Adc": MCP3208.number, "Rows": 2, "Columns": 3, "AdcChannels": 3, "ClkKhz": 16_000, "SclkKhz": 2000}
CARRIER = {"Adc": MAX11125.number, "Rows": 2, "Columns": 3, "Demod": 1, "AdcChannels": 1, "ClkKhz": 100_000}
CARRIER |= {"SamplePeriod": 320, "Periods": 2, "Skip": 2, "Shift": 0}


@pytest.mark.parametrize("build", [WHOLE, BARE, SCAN, CARRIER], ids=["whole", "bare", "scan", "carrier"])
def test_sensor_array(build):
    bench.run("sensor", "sensor_array", build)


def test_sensor_array_by_hand():
    bench.run("sensor", "sensor_array", array_by_hand.BUILD, module="array_by_hand")
