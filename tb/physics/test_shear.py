"""The shear scenes: what they check and simulate, the values read from a recording, and the published
numbers.

Steps and speeds are worked out by hand from the published constants; the judges' readings are checked on
recordings made of plain levels, not of the scenes' physics.
"""

import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import scenes
from meissner.physics import plate, rubber
from meissner.physics.adc import Adc
from meissner.scenes.shear import judge, published
from meissner.scenes.shear import run as shear_run
from meissner.scenes.shear.scene import COMPONENTS

NAMES = ("shear_amount", "shear_recover", "shear_speed", "stick_slip")
RATE = 10_000


def test_the_cases_are_the_published_ones():
    amount, recover, speed, stick = map(scenes.load, NAMES)
    assert [case.moved_mm for case in amount.cases] == [n / 100 for n in range(1, 11)] and amount.seeds == 3
    assert {(case.normal_n, case.speed_mm_s) for case in amount.cases} == {(1.0, 0.05)}
    assert [case.speed_mm_s for case in speed.cases[:10]] == [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 3, 4]
    assert [case.rest_v for case in speed.cases[::10]] == pytest.approx([2, 3, 4], abs=1e-9)
    assert {case.moved_mm for case in (*speed.cases, *recover.cases)} == {0.3}
    assert [(case.speed_mm_s, case.recovers, case.lot) for case in recover.cases] == [
        (v, *way) for way in ((1.0, 1.0), (0.4, 1.0), (0.4, 2.0)) for v in (0.05, 0.1, 1.0)
    ]
    assert [(c.normal_n, c.speed_mm_s, c.moved_mm, c.first_event) for c in stick.cases] == [
        (2.0, 0.5, 4.0, 0.875),
        (2.0, 0.5, 4.0, 0.12),
    ]


def test_the_joint_line_inverted():
    """By hand: (1.4/1.01)^(1/0.11) = e^(0.326545·9.090909) and so on; Table 2's rows at 0.01 and 4 mm/s."""
    steps = published.joint_speed(2.0, np.array([1.4, 1.6, 2.1]))
    assert steps == pytest.approx([19.47, 65.5, 775.8], rel=2e-3)
    ends = np.array([0.01, 3.0, 4.0])
    off = {rest: published.joint_speed(rest, published.table_2(rest, ends)) / ends - 1 for rest in (2, 3, 4)}
    assert off[2] == pytest.approx([-0.451, -0.079, -0.054], abs=2e-3)
    assert off[3] == pytest.approx([0.130] * 3, abs=1e-3)  # the same n, so equal at every speed
    assert off[4] == pytest.approx([-0.326] * 3, abs=1e-3)


def test_the_limit_lies_in_every_paper_s_range():
    assert published.SLOWEST_MM_S == 0.01 < published.LIMIT_MM_S == 3.0 < 4.0
    assert max(c.speed_mm_s for c in scenes.load("shear_speed").cases) == 4.0  # so that one is beyond it


@pytest.mark.parametrize("number, rest_v, k", [(6, 2.0, 1.01), (16, 3.0, 0.74), (26, 4.0, 0.47)])
def test_a_run_rests_steps_and_recovers(monkeypatch, number, rest_v, k):
    """1 mm/s, so the step is k = 1.55 - 0.27·Vi; 0.5 s later e^-0.3 of it is left (three time constants in 5
    s)."""
    monkeypatch.setattr(rubber, "SHEAR_SPREAD", 0.0)
    scene = scenes.load("shear_speed")
    run = scenes.simulate(scene, number, 3)
    assert run.condition.speed_mm_s == 1.0 and run.codes.dtype == np.int64 and not run.over_range.any()
    assert set(run.modelled) | set(run.left_out) == set(COMPONENTS)
    assert (run.start_s, run.stop_s) == (1.3, 1.6) and run.onset_s is run.gross_s is None
    assert run.speed_mm_s.sum() / RATE == pytest.approx(0.3, abs=1e-12)
    at = {when: run.volts[round(when * RATE)] for when in (0.0, 1.29, 1.599, 2.0999)}
    assert at[0.0] == 5.0 and at[1.29] == pytest.approx(rest_v, abs=1e-9)
    assert at[1.599] == pytest.approx(rest_v + k, abs=1e-3)
    assert at[2.0999] == pytest.approx(rest_v + k * np.exp(-0.3), abs=1e-3)
    assert run.moving[3000] and not run.moving[8001:].any()


def test_a_repeated_step_deviates_by_its_share():
    """300 measurements of 0.53 V: the relative error of their deviation is 1/sqrt(600)."""
    scene = scenes.load("shear_amount")
    steps = []
    for seed in range(300):
        run = scenes.simulate(scene, 9, seed)
        steps.append(run.volts[round(run.stop_s * RATE) - 2] - 3.0)
    k = (1.55 - 0.27 * 3) * 0.05**0.11
    assert np.mean(steps) == pytest.approx(k, rel=0.01)
    assert np.std(steps) / k == pytest.approx(0.045, rel=4 / np.sqrt(600))


def test_a_lot_and_a_recovery_are_what_they_say(monkeypatch):
    monkeypatch.setattr(rubber, "SHEAR_SPREAD", 0.0)
    scene = scenes.load("shear_recover")
    ends = []
    for number in (2, 5, 8):
        run = scenes.simulate(scene, number, 1)
        ends.append((run.volts[round(run.stop_s * RATE) - 2], run.volts[-1]))
    # 1.01 V, of which 60 % remain in the second way, and twice that in the third; after 12 s e^-7.2 of the
    # fall is left.
    assert np.ravel(ends) == pytest.approx([3.01, 2.0, 3.01, 2.606, 4.02, 3.212], abs=2e-3)


def test_a_plate_on_the_sensor_slips_and_sticks():
    """It slips at mu·N = 1.4 N over 12 N/mm: 0.117 mm at 0.5 mm/s, 0.233 s; four deviations of 3 %."""
    scene = scenes.load("stick_slip")
    for number, first in ((0, 0.875), (1, 0.12)):
        run = scenes.simulate(scene, number, 5)
        assert run.time_s[-1] == pytest.approx(9.3 - 1 / RATE) and set(run.modelled) == set(COMPONENTS)
        assert run.gross_s - run.start_s == pytest.approx(0.2333, rel=0.12)
        assert (run.onset_s - 1.3) / (run.gross_s - 1.3) == pytest.approx(first, abs=0.06)
        assert np.all(run.slip_mm[run.time_s < run.gross_s] == 0) and 3.8 < run.slip_mm[-1] < 4.0
        # A stick is (1.4 - 1.24 N)/12 N/mm long on average, 26.7 ms at 0.5 mm/s: 290 of them.
        assert len(run.slips_s) == pytest.approx(290, rel=0.25) and run.slips_s.min() > run.gross_s


def test_recordings_are_seeded():
    for name in NAMES:
        scene = scenes.load(name)
        first, again, other, case = (
            scenes.simulate(scene, *which).codes for which in ((0, 5), (0, 5), (0, 6), (1, 5))
        )
        assert np.array_equal(first, again) and not np.array_equal(first, other)
        assert len(first) != len(case) or not np.array_equal(first, case)


def levels(step_v=0.6, end_v=2.1, fall_s=1.0):
    """A recording of plain levels with 1 mV per code: 2 V, a step, a straight fall, held."""
    time_s = np.arange(10 * 1000) / 1000
    volts = np.where(time_s < 1.0, 2.0, 2.0 + step_v)
    falling = (2.0 + step_v - end_v) * np.clip((time_s - 2.0) / fall_s, 0, 1)
    adc = Adc(16, 0.0, 65.536)  # 1 mV a code
    return SimpleNamespace(
        scene=SimpleNamespace(adc=adc, rate_hz=1000),
        time_s=time_s,
        codes=adc.convert(volts - falling)[0],
        speed_mm_s=np.where((time_s >= 1.0) & (time_s < 2.0), 0.1, 0.0),
        stop_s=2.0,
    )


def test_what_is_read_off_a_recording():
    """The fall of 0.5 V in 2 s is complete to 5 % at 1.9 s; 5 s later Vc has its final value."""
    found = judge.measured(levels(fall_s=2.0))
    assert found["rest_v"] == pytest.approx(2.0) and found["step_v"] == pytest.approx(0.6)
    assert found["settled_s"] == pytest.approx(1.9, abs=0.005)
    assert found["after_v"] == found["end_v"] == pytest.approx(2.1)
    slow = judge.measured(levels(fall_s=10.0))  # 0.25 V down after 5 s, 0.4 V after the last 8 s
    assert slow["after_v"] == pytest.approx(2.35, abs=2e-3) and slow["end_v"] == pytest.approx(2.2, abs=5e-3)
    short = levels()
    short.time_s, short.codes, short.speed_mm_s = (
        a[:7000] for a in (short.time_s, short.codes, short.speed_mm_s)
    )
    assert set(judge.measured(short)) == {"rest_v", "step_v"}


def test_the_power_law_of_known_constants():
    speeds = np.array([0.01, 0.1, 1.0, 3.0])
    k, n = judge.power_law(speeds, 0.7 * speeds**0.2)
    assert k == pytest.approx([0.7] * 3) and n == pytest.approx([0.2] * 3)
    # A factor of 1.1 up, down, down, up at 0, 1, 2, 3: no slope; residuals log 1.1, t for 2 is 4.302653.
    steps = 0.7 * np.array([1.0, 2.0, 4.0, 8.0]) * np.array([1.1, 1 / 1.1, 1 / 1.1, 1.1])
    (k, k_low, k_high), (n, n_low, n_high) = judge.power_law(np.array([1.0, 10.0, 100.0, 1000.0]), steps)
    assert (k, n) == pytest.approx((0.7, np.log10(2)))
    error = np.log(1.1) * np.sqrt(4 / 2)  # of a residual
    half = 4.302653 * error / (np.sqrt(5) * np.log(10))  # sum of squares of the places 0 to 3: 5
    assert (n_high - n, n - n_low) == pytest.approx((half, half))
    half = 4.302653 * error * np.sqrt(1 / 4 + 1.5**2 / 5)
    assert (np.log(k_high / k), np.log(k / k_low)) == pytest.approx((half, half))


class Cases:
    """Pairs as in a dict, for cases that cannot be keys."""

    def __init__(self, pairs):
        self.items = lambda: pairs


def of_line(rest_v, speed_mm_s, seen_mm_s):
    """A case at this speed, and its runs with the steps that the published line has at other speeds."""
    case = SimpleNamespace(name="x", rest_v=rest_v, speed_mm_s=speed_mm_s)
    runs = [
        {"rest_v": rest_v, "step_v": (1.55 - 0.27 * rest_v) * seen**0.11, "false_alarms": 0}
        for seen in seen_mm_s
    ]
    return case, runs


def test_the_speeds_of_steps_by_hand():
    """Readings at 4 mm/s count as beyond the limit or not; those at 3 mm/s, the limit itself, as up to it."""
    exact = [of_line(rest, speed, [speed] * 9) for rest in (2.0, 3.0, 4.0) for speed in (0.1, 0.2, 1.0)]
    found = [*exact, of_line(2.0, 3.0, [2.9, 3.3]), of_line(2.0, 4.0, [2.8, 3.9, 4.0])]
    answer = judge.speed(None, Cases(found))[1]
    assert (answer["beyond_found"]["count"], answer["beyond_found"]["runs"]) == (2, 3)
    assert (answer["beyond_falsely"]["count"], answer["beyond_falsely"]["runs"]) == (1, 83)
    assert [answer[name] for name in ("k0", "k1", "n")] == pytest.approx([1.55, -0.27, 0.11], abs=2e-3)
    # 1.01 V of the line against 2.1 V of Table 1 at 1 mm/s; at 0.1 mm/s 0.776247 of that against 1.6 V.
    off = [1 - 1.01 / 2.1, 1 - 1.01 * 0.776247 / 1.6]
    assert answer["off_table_1"]["mean"] == pytest.approx(np.mean(off), abs=1e-5)
    assert answer["off_table_1"]["maximum"] == pytest.approx(max(off), abs=1e-5)


def test_the_deviation_is_that_of_measurements():
    """0.5, 0.6 and 0.7 V: 0.1 V with two degrees of freedom; undefined for one measurement."""
    runs = [{"rest_v": 3.0, "step_v": step_v, "false_alarms": 1} for step_v in (0.5, 0.6, 0.7)]
    row = judge._row(SimpleNamespace(name="x"), runs)
    assert (row["deviation_v"], row["step_v"], row["false_alarms"], row["runs"]) == (0.1, 0.6, 3, 3)
    assert judge._row(SimpleNamespace(name="x"), runs[:1])["deviation_v"] is None


def pulled(**changes):
    """Levels of a slip with 1 mV per code at 1 kHz, slope over 2 ms: pressing from 0.1 to 0.5 s, the stage
    from 1 s on at 0.1 mm/s, so its step counts until 1.202 s; events from 1.5 s, slip at 2 s."""
    time_s = np.arange(4000) / 1000
    volts = np.where(time_s < 0.1, 5.0, 2.0)
    for when, height in changes.pop("steps", {}).items():
        volts = volts + np.where(np.arange(4000) >= when, height, 0.0)
    adc = Adc(16, 0.0, 65.536)
    scene = SimpleNamespace(
        adc=adc, rate_hz=1000, slope={"slope_s": 0.002, "slope_v_s": 5.0, "near_s": 0.003}
    )
    return SimpleNamespace(
        scene=scene,
        condition=SimpleNamespace(speed_mm_s=0.1),
        time_s=time_s,
        codes=adc.convert(volts)[0],
        moving=(time_s >= 0.1) & (time_s < 0.5),
        **({"start_s": 1.0, "onset_s": 1.5, "gross_s": 2.0, "slips_s": np.array([2.5, 2.6, 3.0])} | changes),
    )


def test_the_derivative_crosses_above_its_threshold():
    """5 V/s over 2 ms are 10 mV: 10 codes do not cross, 11 do, of either sign. A step in sample n is detected
    with samples n and n + 1, because the samples 2 ms before these both lie before n."""
    assert judge.slope(np.arange(50) * 0.003, 1000, 0.002)[:48] == pytest.approx(3.0)
    for height, flag in ((0.010, None), (0.011, 1.6), (-0.011, 1.6)):
        found = judge.sloped(pulled(steps={1600: height}))
        assert found["slope_flag_s"] == flag and found["change_s"] == flag
        assert not found["slope_quiet"] and found["slope_pressing"]  # pressing is a step of 3 V


@pytest.mark.parametrize(
    "sample, change, flag, quiet",
    [
        (600, None, None, True),  # at rest
        (1000, 1.0, None, False),  # the stage starts: the step itself
        (1199, 1.199, None, False),
        (1204, 1.204, None, True),  # the step is over
        (1499, 1.499, 1.5, True),  # detected at 1.499 and 1.5 s
        (1500, 1.5, 1.5, False),  # an event
        (1999, 1.999, 1.999, False),
        (2000, None, None, False),  # the slip is no warning of itself
    ],
)
def test_what_a_crossing_counts_as(sample, change, flag, quiet):
    found = judge.sloped(pulled(steps={sample: 0.05}))
    assert (found["change_s"], found["slope_flag_s"], found["slope_quiet"]) == (change, flag, quiet)


def test_stick_slips_by_hand():
    """Sliding counts from 2.1 s on. Found: 2.5 s immediately, 3.0 s with the last sample that counts. A
    crossing after 2.6 s is one sample too late and belongs to no slip, like one at 2.8 s. 2.05 s is not
    counted."""
    slips = np.array([2.05, 2.5, 2.6, 3.0])
    found = judge.sloped(pulled(slips_s=slips, steps=dict.fromkeys((2051, 2500, 2604, 2800, 3003), 0.05)))
    assert (found["stick_slips"], found["found"], found["elsewhere"]) == (3, 2, 2)
    assert found["slid_s"] == pytest.approx(1.899)
    # Four steps, each in two differences of 0.05 V/2 ms.
    assert found["rms_sliding"] == pytest.approx(25 * np.sqrt(8 / 1899)) and found["rms_before"] == 0


def changed(name, **world):
    table = tomllib.loads(scenes.source(name))
    for key, value in world.items():
        target = table if key in table else table["world"]
        target[key] = value
        if value is None:
            del target[key]
    return table


WAY = {"name": "x", "recovers": 0.5, "lot": 1.0, "published_v": 2.0}


@pytest.mark.parametrize("lot, fits", [(2.57, True), (2.575, False)])
def test_a_lot_must_stay_below_the_supply(lot, fits):
    """3 V remain to the supply from 2 V; dV is 1.01 V·3.7^0.11 = 1.1663 V, so 2.5722 times it is too much."""
    way = WAY | {"lot": lot}
    scene = scenes.build("x", changed("shear_recover", ways=[way], speed_mm_s=[0.1, 3.7]))
    if fits:
        shear_run.check(scene)
    else:
        with pytest.raises(ValueError, match=r"lot = 2.575"):
            shear_run.check(scene)


def test_slip_settings_are_refused_as_in_the_slip_scenes():
    table = changed("stick_slip")
    table["slip"]["keep_threshold_p2p_v"] = 0.04
    with pytest.raises(ValueError, match=r"\[slip\]: keep_threshold_p2p_v"):
        scenes.build("stick_slip", table)
    ours, theirs = scenes.load("stick_slip"), scenes.load("acrylic_slip")
    assert ours.slip == theirs.slip and ours.slip_config() == theirs.slip_config()


def test_friction_moves_the_slip(monkeypatch):
    acrylic = plate.MATERIALS["acrylic"]
    scene = scenes.load("stick_slip")
    before = scenes.simulate(scene, 0, 1)
    monkeypatch.setitem(plate.MATERIALS, "acrylic", replace(acrylic, mu_s=2 * acrylic.mu_s))
    after = scenes.simulate(scene, 0, 1)
    assert after.gross_s - after.start_s == pytest.approx(2 * (before.gross_s - before.start_s))
