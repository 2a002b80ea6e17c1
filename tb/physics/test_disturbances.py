"""Hum, 1/f noise, hysteresis and bursts of the rubber sensor: each one alone in the signal, as its formula
gives it.

A recording with one of them is compared with the same run without it: slip and converter noise use another
generator, so the difference is the disturbance. Expectations are worked out by hand.
"""

import dataclasses

import numpy as np
import pytest
from msgspec import structs

from meissner import scenes
from meissner.engines import fixed
from meissner.physics import disturbances, plate, rubber
from meissner.scenes.rubber.judge import judge

RATE = 10_000


def grip(seed=3, **options):
    """A run of grip_slip's plain condition with these options."""
    scene = scenes.load("grip_slip")
    plain = structs.replace(scene.condition("plain"), **options)
    return scenes.simulate(dataclasses.replace(scene, conditions=(plain,)), 0, seed)


def test_the_grip_follows_the_pull_until_the_contact_slips():
    """mu 0.7, 2 N and half the pull: T = 0.7·2/(1 - 0.35) = 2.154 N, N = 3.077 N at the slip."""
    tensions = []
    for seed in range(40):
        run = grip(seed)
        rising = (run.time_s > 1.4) & (run.time_s < run.gross_s - 0.06)
        assert np.abs(run.normal_n - 2.0 - 0.5 * run.tension_n)[rising].max() < 0.03  # the motor's ripple
        sliding = run.time_s > run.gross_s
        assert np.abs(run.normal_n - 2.0 - 0.5 * run.tension_n)[sliding].max() < 1e-12
        assert run.onset_s < run.gross_s < run.time_s[-1] - 0.3
        tensions.append(run.tension_n.max())
    assert np.median(tensions) == pytest.approx(2.154, rel=0.04)
    assert run.moving[run.time_s > 1.3].sum() == 0


def test_events_come_at_their_share_of_the_limit_of_that_moment():
    """By the plate's own numbers: T(t) at the event over mu·N(t) is the ratio, where N rises with T."""
    time = np.arange(90_000) / RATE
    pull = plate.pull(time, 2.0, 10.0, "acrylic", 1.0, np.random.default_rng(2), follow=0.5)
    stiffness = plate.PULL_STIFFNESS_N_MM * 10.0  # N/s
    limit = stiffness * (pull.gross_s - 1.0)
    mu = limit / (2.0 + 0.5 * limit)
    for ratio in (0.0, 0.12, 0.5, 0.875, 1.0):
        tension = stiffness * (float(pull.time_of(ratio)) - 1.0)
        assert tension / (mu * (2.0 + 0.5 * tension)) == pytest.approx(ratio, abs=1e-12)


def test_what_is_drawn_for_a_disturbance_moves_no_other_draw():
    """A disturbance too small for the converter leaves the codes unchanged, including their noise."""
    plain = grip()
    for tiny in ({"hum_v": 1e-12}, {"flicker": 1e-12}):
        assert np.array_equal(grip(**tiny).codes, plain.codes), tiny


def test_vc_recovers_as_far_as_the_condition_says():
    """1 s after the slip, e^-0.6 = 0.5488 of the recoverable part remains: 0.6 + 0.4·0.5488 = 0.8195."""
    scene = scenes.load("acrylic_slip")
    runs = []
    for recovers in (1.0, 0.4):
        condition = structs.replace(scene.conditions[0], recovers=recovers)
        runs.append(scenes.simulate(dataclasses.replace(scene, conditions=(condition,)), 0, 3))
    late = np.abs(runs[0].time_s - runs[0].gross_s - 1.0) < 0.02
    held = (runs[0].time_s > 1.0) & (runs[0].time_s < 1.3)
    restored, converged = (np.median(run.volts[late]) - run.volts[held].mean() for run in runs)
    assert converged / restored == pytest.approx(0.8195 / 0.5488, rel=0.01)


def test_hum_is_a_line_at_50_hz_and_nothing_else():
    added = grip(hum_v=0.1).volts - grip().volts
    samples = len(added) // 200 * 200  # whole periods
    line = 2 * np.abs(np.fft.rfft(added[:samples])) / samples
    at = round(50 * samples / RATE)
    assert line[at] == pytest.approx(0.1, abs=1e-12)
    assert np.delete(line, at).max() < 1e-12


def test_flicker_has_the_slope_and_the_size_of_1_over_f():
    """1/f gives each octave the same power, ln 2/ln 10 = 0.30103 of share²."""
    noise = np.stack(
        [disturbances.flicker(1 << 16, RATE, 0.02, np.random.default_rng(seed)) for seed in range(30)]
    )
    power = 2 * np.mean(np.abs(np.fft.rfft(noise)) ** 2, axis=0) / (1 << 16) ** 2
    hertz = np.fft.rfftfreq(1 << 16, 1 / RATE)
    for low in (2.0, 20.0, 200.0, 2000.0):
        octave = power[(hertz >= low) & (hertz < 2 * low)].sum()
        assert octave == pytest.approx(0.30103 * 0.02**2, rel=0.15), low
    slope = np.polyfit(np.log(hertz[8:-1]), np.log(power[8:-1]), 1)[0]
    assert slope == pytest.approx(-1, abs=0.02)


def test_flicker_is_in_the_signal_where_the_rubber_conducts():
    run, plain = grip(flicker=0.01), grip()
    added = run.volts - plain.volts
    assert not added[plain.normal_n == 0].any()
    held = (plain.time_s > 0.9) & (plain.time_s < 1.3)  # 2 N: 1.70 V, so dV = -1.70·3.30/5 of dG/G
    vc = plain.volts[held].mean()
    step = np.diff(added[held]).std() / (vc * (5 - vc) / 5)
    # Neighbouring samples differ by the sum over f of S·4·sin²(pi·f/rate), which is 4·0.8237 of share²/ln 10.
    assert step == pytest.approx(0.01 * np.sqrt(4 * 0.8237 / 2.302585), rel=0.05)


def test_hysteresis_is_a_loop_of_vc_over_force():
    """Below the peak by more than a factor e, the rubber shows e^0.1 = 1.10517 times the force; rising, the
    force."""
    scene = scenes.load("normal_force")
    looped = structs.replace(scene.condition("load 4 N"), hysteresis=0.1)
    run = scenes.simulate(dataclasses.replace(scene, conditions=(looped,)), 0, 3)
    plain = scenes.simulate(dataclasses.replace(scene, conditions=(scene.condition("load 4 N"),)), 0, 3)
    assert np.array_equal(run.normal_n, plain.normal_n)
    for force in (0.3, 0.9, 1.4):  # all below 4/e = 1.47 N
        up = np.flatnonzero(run.normal_n >= force)[0]
        down = np.flatnonzero(run.normal_n >= force)[-1]
        assert run.volts[up] == pytest.approx(plain.volts[up], abs=0.01)
        shown = float(rubber.rest_volts(1.10517 * run.normal_n[down]))
        assert run.volts[down] == pytest.approx(shown, abs=1e-3)
        assert plain.volts[down] - run.volts[down] > 0.05
    top = (run.time_s > 1.5) & (run.time_s < 2.5)
    assert np.abs(run.volts - plain.volts)[top].max() < 0.01


def test_play_is_its_recurrence():
    x = np.random.default_rng(1).standard_normal(1001).cumsum()
    slow, last = [], x[0]
    for value in x:
        last = max(value, min(value + 1.7, last))
        slow.append(last)
    assert np.array_equal(disturbances.play(x, 1.7), slow)
    assert np.array_equal(disturbances.play([0.0, 2.0, 1.5, 0.0, 0.4, 3.0], 1.0), [0, 2, 2, 1, 1, 3])


def fano(counts):
    return counts.var() / counts.mean()


def test_bursts_bring_events_together_and_no_more_of_them():
    """Counts in 20 ms: variance over mean is 1 if independent, 2·5 - 1 = 9 for geometric groups of 5."""
    rng = np.random.default_rng(8)
    counts, edges = {1: [], 5: []}, np.arange(0, 1.0, 0.02)
    for _ in range(200):
        alone = np.sort(rng.uniform(0, 1, rng.poisson(1000)))
        begins = np.sort(rng.uniform(0, 1, rng.poisson(200)))
        together = disturbances.bursts(begins, 5.0, 1.0, rng)
        assert np.isin(begins, together).all()
        assert together.max() < 1.0 and (np.diff(together) >= 0).all()
        for size, times in ((1, alone), (5, together)):
            counts[size].append(np.histogram(times, edges)[0])
    counts = {size: np.concatenate(found) for size, found in counts.items()}
    assert counts[5].mean() == pytest.approx(counts[1].mean(), rel=0.02)
    assert fano(counts[1]) == pytest.approx(1.0, abs=0.05)
    assert 7.5 < fano(counts[5]) < 9.0  # a burst on an edge counts in two bins


def test_bursts_are_in_the_recording():
    """Intervals below 0.2 ms between events: few if independent, many within a burst of about 2 ms."""
    shares = {}
    for burst in (1.0, 5.0):
        waits = [np.diff(grip(seed, burst=burst).events_s) for seed in range(20)]
        shares[burst] = np.mean(np.concatenate(waits) < 2e-4)
    assert shares[5.0] > 2.5 * shares[1.0]
    counts = [len(grip(seed, burst=5.0).events_s) for seed in range(30)]
    assert np.mean(counts) == pytest.approx(200, rel=0.1)


@pytest.mark.parametrize(
    "options, added",
    [
        ({}, ()),
        ({"hum_v": 0.1}, ("hum",)),
        ({"flicker": 0.01}, ("1/f noise",)),
        ({"hysteresis": 0.1}, ("hysteresis",)),
        ({"burst": 5.0}, ("correlated events",)),
    ],
)
def test_a_run_names_what_disturbs_it(options, added):
    run = grip(**options)
    assert run.modelled[-len(added) :] == added if added else run.modelled[-1] == "grip follows load"
    assert run.left_out == ()


@pytest.mark.parametrize(
    "options, alarms",
    [({}, 0), ({"hum_v": 0.1}, 0), ({"hum_v": 1.0}, 3), ({"flicker": 0.002}, 0), ({"flicker": 0.006}, 3)],
)
def test_a_disturbance_that_is_too_loud_is_judged_so(options, alarms):
    """Hum adds 2·sin(pi·50/10,000)/sqrt(2) = 2.2 % of its amplitude to a coefficient: 0.1 V stays far below
    the threshold of 0.01 V, 1 V exceeds it by itself."""
    config = scenes.load("grip_slip").slip_config()
    found = []
    for seed in (1, 2, 3):
        run = grip(seed, **options)
        verdict = judge(run, fixed.watch(run.codes[None], config).state[0], config)
        found.append((verdict["false_alarms"] > 0, verdict["missed"]))
    assert sum(alarm for alarm, _ in found) == alarms
    if not alarms:
        assert not any(missed for _, missed in found)
