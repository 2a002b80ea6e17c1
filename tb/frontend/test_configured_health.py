"""What every configuration calls a fault: no healthy cell, finger or electrode at rest, pressed, and at both
ends of what its sensor reads; real faults still. The noise is the data sheets': 0.198 mV for parts from 0 V,
0.117 mV at ±5 V for the AD7606.
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import bench
from frontend.health_configured import CASES, registers
from meissner.builds import config
from meissner.twins.actuate.actuate import FingerHealth
from meissner.twins.cop import cop4
from meissner.twins.core import limits_of
from meissner.twins.frontend.health import BLINKING, DEAD, RAILED, Health

NAMES = [name for name in config.names() if config.load(name).health] + ["h1_health", "h2_fsr_health"]
PARTS = {
    "MCP3208": (3.3, 5.0),
    "AD7606": (5.0, 10.0),
    "AD7606C-16": (5.0,),
    "MAX11123": (3.3,),
    "MAX11124": (2.5,),
    "MAX11125": (3.3,),
    "MAX11131": (2.5,),
}
PARTS = [(part, volts) for part, several in PARTS.items() for volts in several]
ROWS, COLUMNS = 6, 7


def default(part, volts, wiring=None, rate_hz=400.0):
    """An array with health and nothing said of it."""
    adc = {"part": part, "volts": volts, "rate_hz": rate_hz, "channels": 4}
    sensor = {"kind": "array", "rows": ROWS, "columns": COLUMNS} | ({"wiring": wiring} if wiring else {})
    tables = {"about": "default", "clock": {"mhz": 50.0}, "sensor": sensor, "adc": adc}
    return config.read("default", tables | {"array": {"health": True}})


def builds():
    for name in NAMES:
        yield pytest.param(config.load(CASES / f"{name}.toml" if name.startswith("h") else name), id=name)
    for (part, volts), wiring in product(PARTS, (None, "differential")):
        yield pytest.param(default(part, volts, wiring), id=f"{part} {volts} V {wiring}")


def twin(build, **changed):
    return Health(ROWS, COLUMNS, limits=replace(limits_of(build), **changed))


def codes_of(build, volts, rng):
    """Codes of volts [frames, rows, columns] with the converter's noise."""
    bits, full = build.part.data_bits, build.adc.volts
    signed = build.part.signed
    noise, lsb = (0.117e-3 * full / 5, full / 2 ** (bits - 1)) if signed else (0.198e-3, full / 2**bits)
    codes = np.floor((volts + noise * rng.standard_normal(volts.shape)) / lsb + 0.5)
    return np.clip(codes, -(2 ** (bits - 1)) if signed else 0, 2 ** (bits - signed) - 1).astype(np.int64)


def rest_v(build):
    return build.adc.volts / 2 if build.sensor.wiring == "differential" and not build.part.signed else 0.0


def presses(build, rng, count=12):
    """Volts of frames in which objects press all over: from tips of a third of a taxel to palms of four."""
    i, j = np.indices((ROWS, COLUMNS))
    span = 0.95 * (build.adc.volts - rest_v(build))
    for _ in range(count):
        ramp, hold = rng.integers(5, 30), rng.integers(5, 60)
        level = np.interp(
            np.arange(2 * ramp + hold + 20), [0, ramp, ramp + hold, 2 * ramp + hold], [0, 1, 1, 0]
        )
        squares = (i - rng.integers(0, ROWS)) ** 2 + (j - rng.integers(0, COLUMNS)) ** 2
        shape = np.exp(-squares / (2 * rng.choice([0.35, 0.7, 1.5, 4.0]) ** 2)) * rng.uniform(0.2, 1)
        yield rest_v(build) + span * level[:, None, None] * shape


def ends(build):
    """Volts at both ends of what is no fault, half of the taxels each, and both exchanged."""
    rails, bottom = build.rails, build.input.low_v if build.sensor.wiring == "differential" else 0.0
    lsb = build.adc.volts / 2 ** (build.part.data_bits - build.part.signed)
    least = max(bottom, (rails.low + 3) * lsb)
    most = min(build.adc.volts, (rails.high - 3 * (1 + build.part.signed)) * lsb)
    half = np.indices((ROWS, COLUMNS)).sum(axis=0) % 2 == 0
    once = np.where(half, least, most)
    return [np.repeat(one[None], 300, axis=0) for one in (once, least + most - once)]


@pytest.mark.parametrize("build", [*builds()])
def test_no_healthy_taxel_is_a_fault(build):
    rng = np.random.default_rng(bench.SEED)
    rest = np.full((1000, ROWS, COLUMNS), rest_v(build))
    for what, parts in {"rest": [rest], "pressed": presses(build, rng), "ends": ends(build)}.items():
        health = twin(build)
        for volts in parts:
            masks, events = health.next(codes_of(build, volts, rng))
            assert not masks.any() and not any(events), (what, health.faults)


def test_settings_that_contradict_each_other_mask_healthy_taxels():
    """The check above can fail: without a jump, and where rest is a rail."""
    rng, rest = np.random.default_rng(bench.SEED), np.zeros((1000, ROWS, COLUMNS))
    for build, changed, kind in (
        (default("AD7606", 5.0), {"jump": 0}, BLINKING),
        (default("MCP3208", 5.0), {"low": 0}, RAILED),
        (default("MCP3208", 5.0), {"over_range_enable": True}, 0),
    ):
        codes, health = codes_of(build, rest, rng), twin(build, **changed)
        health.next(codes, codes == build.input.min_code)
        assert (health.faults == kind).all() if kind else (health.faults == RAILED).all(), changed


@pytest.mark.parametrize("build", [*builds()])
def test_faults_are_found_with_the_same_settings(build):
    """A taxel that never moves inside a moving array; one at the supply; one whose contact opens."""
    rng = np.random.default_rng(bench.SEED)
    health, rest = twin(build), codes_of(build, np.array(rest_v(build)), rng)
    for volts in presses(build, rng, count=60):
        codes = codes_of(build, volts, rng)
        codes[:, 2, 3], codes[:, 0, 6] = rest, build.input.max_code
        loose = codes[:, 4, 2] = build.input.max_code * 3 // 4
        codes[np.arange(len(codes)) % 5 == 0, 4, 2] = rest if rest < loose else 0
        health.next(codes)
    assert health.faults[2, 3] == DEAD and health.faults[0, 6] & RAILED
    assert health.faults[4, 2] & BLINKING
    health.faults[[2, 0, 4], [3, 6, 2]] = 0
    assert not health.faults.any()


@pytest.mark.parametrize("rate_hz, blink", [(249.0, 0), (250.0, 120)])
def test_blinking_is_judged_from_250_frames_a_second(rate_hz, blink):
    """Seven taps a second are 14 jumps, which count 16 each: 224, less one a frame."""
    assert registers(default("MCP3208", 5.0, rate_hz=rate_hz))["blink"] == blink
    taps = np.zeros((3000, ROWS, COLUMNS), dtype=np.int64)
    taps[(np.arange(3000) * 14 // int(rate_hz)) % 2 == 1, 3, 3] = 3000
    health = twin(default("MCP3208", 5.0, rate_hz=rate_hz))
    health.next(taps)
    assert not health.faults.any()


@pytest.mark.parametrize(
    "part, volts, falls, sensor, ends, faults",
    [
        ("MCP3208", 5.0, True, {}, (1, 4095), (0,)),
        ("MCP3208", 5.0, False, {}, (0, 4094), (4095,)),
        ("AD7606", 5.0, True, {}, (1, 32_767), (0, -1, -32_768)),
        ("AD7606", 5.0, False, {}, (-32_767, 0, 32_766), (-32_768, 32_767)),
        ("MCP3208", 5.0, False, {"wiring": "differential"}, (1, 2048, 4094), (0, 4095)),
        ("AD7606", 10.0, True, {"rest_v": 5.0}, (1, 16_384, 32_766), (0, 32_767)),
    ],
)
def test_a_finger_is_healthy_where_its_sensor_reads(part, volts, falls, sensor, ends, faults):
    levels = (4.5, 4.8) if falls else (4.8, 4.5)
    slip = {"threshold_p2p_v": 0.02, "gross_threshold_p2p_v": 0.1, "contact_rises": not falls}
    slip |= dict(zip(("contact_level_v", "release_level_v"), levels))
    tables = {
        "about": "finger",
        "clock": {"mhz": 25.0},
        "sensor": {"kind": "channels", "channels": 1} | sensor,
    }
    tables |= {"adc": {"part": part, "volts": volts, "rate_hz": 5000.0}, "slip": slip, "grip": {}}
    found = config.read("finger", tables).settings
    for code in (*ends, *faults):
        health = FingerHealth(1, found["grip.low"], found["grip.high"], found["grip.rail"])
        assert bool(health.next(np.full((1, 7), code))[0])
        assert bool(health.next(np.full((1, 1), code))[0]) == (code in ends), code
    never = config.read("finger", tables | {"grip": {"rail_samples": 0}}).settings
    health = FingerHealth(1, never["grip.low"], never["grip.high"], never["grip.rail"])
    assert bool(health.next(np.full((1, 1000), faults[0]))[0])


@pytest.mark.parametrize("name", [name for name in config.names() if config.load(name).slip])
def test_a_sensor_at_rest_or_held_never_slips(name):
    """The noise alone: no detail's peak to peak exceeds the lowest threshold, and only rest is released."""
    build, rng = config.load(name), np.random.default_rng(bench.SEED)
    slip = build.slip
    for volts in (rest := 0.0 if slip.contact_rises else build.adc.volts, build.adc.volts / 2):
        codes = codes_of(build, np.full((1, 100_000), volts), rng)
        codes = np.maximum(codes, 0) if build.array else codes  # forces with the gain 1
        sums = codes.reshape(-1, 2, 1 << slip.level - 1).sum(axis=2)
        parts = (sums[:, 0] - sums[:, 1])[: len(sums) // 256 * 256].reshape(-1, 256)
        assert np.ptp(parts, axis=1).max() <= slip.keeps_above, volts
        level = sums.sum(axis=1)
        released = (level < slip.release_level) if slip.contact_rises else (level > slip.release_level)
        assert released.all() if volts == rest else not released.any()


def test_electrodes_at_rest_are_no_fault():
    """E1, E3 at +V0 and E2, E4 at -V0 times the gain: at the largest gain that is accepted, too."""
    tables = {"about": "rest", "clock": {"mhz": 25.0}, "sensor": {"kind": "electrodes"}}
    tables |= {"adc": {"part": "AD7606", "volts": 5.0, "rate_hz": 1000.0}}
    mesh = {"rows": 7, "columns": 7, "r_ohm": 100.0, "R0_ohm": 1000.0, "V0_v": 15.0, "k_n_ohm": 4320.0}
    for gain in (0.1, 0.3, 0.3326):
        load = {"gain": gain, "lsb_n": 0.001, "min_n": 0.1, "correction": "none"}
        build = config.read("rest", tables | {"mesh": mesh, "load": load})
        rng = np.random.default_rng(bench.SEED)
        codes = codes_of(build, 15 * gain * np.tile([1.0, -1.0, 1.0, -1.0], (5000, 1)), rng)
        assert not any(found.any() for found in cop4.faults(codes, build.cop4.registers)), gain


def test_registers_of_configurations():
    """The cells of h1 and h2 at rest, pressed and at a rail on the RTL: frontend/health_configured.py."""
    size = {"Rows": 3, "Columns": 3, "Lanes": 1, "SampleBits": 17}
    bench.run("frontend", "health", size, module="health_configured")
