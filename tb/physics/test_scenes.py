"""The scenes: what they check and simulate, and whether they reproduce the published figures.

The detector here is PyWavelets' Haar transform of the converted codes with tumbling windows of 64 samples,
independent of every twin. Amplitudes are those of its coefficient cD, in volts.
"""

import dataclasses
import sys
from functools import cache

import numpy as np
import pytest
import pywt
from msgspec import structs
from scipy import signal

from meissner import scenes
from meissner.physics import plate, rubber
from meissner.physics.adc import PARTS
from meissner.scenes.rubber import scene as rubber_scene
from meissner.twins.slip.config import SlipConfig

SEEDS = 100
PULLED = [
    (name, condition.name)
    for name in scenes.names("rubber")
    for condition in scenes.load(name).conditions
    if scenes.load(name).kind == "pull"
]
PRESSED = [("normal_force", "load 2 N"), ("normal_force", "load 4 N")]


def details(recording):
    """cD in volts and the time of the last sample of each pair."""
    volts = recording.scene.adc.volts_of(recording.codes)
    even = len(volts) // 2 * 2
    return pywt.dwt(volts[:even], "haar")[1], recording.time_s[1:even:2]


@cache
def measured(name, condition, seeds=SEEDS):
    """Per seed: largest |cD| before the onset, and from it to the slip; and the first flag's time."""
    scene = scenes.load(name)
    rows = []
    for seed in range(seeds):
        run = scenes.simulate(scene, condition, seed)
        coefficient, at = details(run)
        onset = np.inf if run.onset_s is None else run.onset_s
        gross = np.inf if run.gross_s is None else run.gross_s
        windows = len(coefficient) // 32
        block = coefficient[: windows * 32].reshape(windows, 32)
        p2p = (np.maximum.accumulate(block, axis=1) - np.minimum.accumulate(block, axis=1)).ravel()
        flags = at[: len(p2p)][p2p > scene.slip.threshold_p2p_v]
        quiet = np.abs(coefficient[at < onset]).max()
        before = np.abs(coefficient[(at >= onset) & (at < gross)]).max(initial=0.0)
        rows.append((quiet, before, flags[0] if len(flags) else np.inf, onset, gross))
    return np.array(rows).T


@pytest.mark.parametrize("name", scenes.names("rubber"))
def test_every_scene_loads_and_runs(name):
    scene = scenes.load(name)
    assert "\n" not in scenes.describe(name) and len(scenes.describe(name)) < 100
    assert isinstance(scene.slip_config(), SlipConfig)
    assert scene.seeds == 100
    for condition in scene.conditions:
        run = scenes.simulate(scene, condition, 1)
        for field in ("volts", "codes", "over_range", "normal_n", "tension_n", "slip_mm", "moving"):
            assert len(getattr(run, field)) == len(run.time_s), field
        assert run.codes.dtype == np.int64
        assert run.over_range.any() == (condition.hum_v > 0)  # hum exceeds the unpressed 5 V
        more = {"hum", "1/f noise", "hysteresis", "correlated events", "grip follows load"}
        parts = set(rubber_scene.COMPONENTS)
        assert (
            parts
            <= set(run.modelled) | set(run.left_out)
            <= parts | (more if scene.kind == "grip" else parts)
        )
        assert not set(run.modelled) & set(run.left_out)
        most = condition.normal_n + getattr(condition, "follow", 0.0) * run.tension_n.max()
        assert run.normal_n.max() == pytest.approx(most, rel=0.02)


def test_the_scenes_are_there():
    slips = {"acrylic_slip", "grip_slip", "normal_force", "slip_first_event", "slip_forces", "slip_materials"}
    assert slips == set(scenes.names("rubber"))


def test_the_first_event_at_0_875_is_acrylic_slip_bit_for_bit():
    ours = scenes.simulate(scenes.load("slip_first_event"), "first event at 0.875", 4)
    theirs = scenes.simulate(scenes.load("acrylic_slip"), 0, 4)
    assert np.array_equal(ours.volts, theirs.volts) and np.array_equal(ours.codes, theirs.codes)


def test_the_first_event_at_0_12_brings_the_onset_to_where_the_high_sensitivity_sensor_has_it():
    """Published: fluctuation begins at about 0.05 s of a static phase of 0.4 s."""
    scene = scenes.load("slip_first_event")
    start = scene.world["stage_start_s"]
    runs = [scenes.simulate(scene, "first event at 0.12", seed) for seed in range(20)]
    shares = [(run.onset_s - start) / (run.gross_s - start) for run in runs]
    assert min(shares) >= 0.12 and np.median(shares) < 0.16


def test_acrylic_slip_tells_the_published_story():
    run = scenes.simulate(scenes.load("acrylic_slip"), seed=3)
    start = run.scene.world["stage_start_s"]
    assert 5.0 <= run.time_s[-1] <= 6.0
    assert run.volts[0] == 5.0 and run.normal_n[0] == 0.0
    assert len(run.contacts_s) == 1 and run.contacts_s[0][1] is None
    assert 2.7 < run.gross_s - start < 3.3
    assert start < run.onset_s < run.gross_s
    assert np.all(run.slip_mm[run.time_s < run.gross_s] == 0)
    assert np.diff(run.slip_mm).min() > -1e-9 and run.slip_mm[-1] > 5
    rising = (run.time_s > start) & (run.time_s < run.gross_s)
    assert (np.diff(run.tension_n[rising]) > 0).all()
    late = run.tension_n[run.time_s > run.gross_s + 0.3]
    assert np.ptp(late) < 0.01 and late.mean() < run.tension_n.max()
    assert not run.moving[run.time_s > start].any() and run.moving.any()
    assert run.onset_s == run.events_s[0]


def test_a_slip_recording_is_seeded():
    scene = scenes.load("acrylic_slip")
    first, again, other = (scenes.simulate(scene, seed=seed) for seed in (5, 5, 6))
    assert np.array_equal(first.codes, again.codes) and first.onset_s == again.onset_s
    assert not np.array_equal(first.codes, other.codes)


def test_no_step_of_a_scene_is_a_loop_over_its_samples():
    """Calls of Python and C functions: about 380 for 55,000 samples."""
    scene, calls = scenes.load("acrylic_slip"), []
    sys.setprofile(lambda frame, event, _: calls.append(event) if event in ("call", "c_call") else None)
    try:
        run = scenes.simulate(scene, seed=1)
    finally:
        sys.setprofile(None)
    assert len(run.volts) == 55_000
    assert 100 < len(calls) < 1000


def test_normal_force_computes_no_slip_physics(monkeypatch):
    def refuse(*_):
        raise AssertionError("this scene has no plate to pull")

    for module, function in [
        (plate, "pull"),
        (rubber, "shear_level"),
        (rubber, "shear_gain"),
        (rubber, "event_ratios"),
        (rubber, "event_shares"),
        (rubber, "fluctuation"),
    ]:
        monkeypatch.setattr(module, function, refuse)
    run = scenes.simulate(scenes.load("normal_force"), seed=1)
    assert run.left_out == ("shear step", "partial slip", "plate friction", "stick-slip")
    assert run.onset_s is None and run.gross_s is None and len(run.events_s) == 0
    assert not run.tension_n.any() and not run.slip_mm.any()
    assert len(run.contacts_s) == 1 and run.contacts_s[0][1] is not None


def test_before_the_slip_there_is_content_above_1_khz():
    run = scenes.simulate(scenes.load("acrylic_slip"), seed=2)
    window = (run.time_s > run.gross_s - 0.2) & (run.time_s < run.gross_s)
    quiet = (run.time_s > run.onset_s - 0.3) & (run.time_s < run.onset_s)
    power = {}
    for key, part in (("before", window), ("quiet", quiet)):
        hertz, density = signal.welch(signal.detrend(run.volts[part]), 10_000, nperseg=512)
        power[key] = density[hertz >= 1000].sum(), density.sum()
    assert power["before"][0] > 0.5 * power["before"][1]
    assert power["before"][0] > 1e4 * power["quiet"][0]


@pytest.mark.parametrize("condition", ["load 2 N", "load 4 N"])
def test_a_changing_normal_force_ends_at_600_hz(condition):
    run = scenes.simulate(scenes.load("normal_force"), condition, seed=2)
    for values, limit in ((run.normal_n, 1e-8), (run.volts, 1e-3)):  # the divider's curvature adds a little
        for inside in (run.time_s < 1.5, run.time_s > 2.5):
            part = values[inside]
            density = np.abs(np.fft.rfft((part - part[0]) * signal.windows.hann(len(part)))) ** 2
            hertz = np.fft.rfftfreq(len(part), 1e-4)
            ripple = density[(hertz > 100) & (hertz < 590)].sum()
            assert ripple > 0
            assert density[hertz > 600].sum() < limit * ripple


@pytest.mark.parametrize("name, condition", PULLED)
def test_coefficients_before_the_slip(name, condition):
    """Published: up to 0.04 V, cloth and paper slightly less, load of little influence.

    This refers to the mean over seeds; single runs range from half to twice of it, because the measured value
    is the largest of 200 log-normal events.
    """
    quiet, before, *_ = measured(name, condition)
    low, high = (0.024, 0.034) if "cloth" in condition or "paper" in condition else (0.032, 0.044)
    assert low < before.mean() < high
    assert before.min() > 0.01, "the published threshold is exceeded in every run"
    # From 0.12 of the limit on, the largest is taken from twice as many events.
    assert before.max() < (0.1 if condition == "first event at 0.12" else 0.09)
    assert quiet.max() < 0.01


@pytest.mark.parametrize("name, condition", PRESSED)
def test_coefficients_of_a_changing_normal_force(name, condition):
    """Published: at most 0.005 V; the maximum scatters around that over the seeds."""
    quiet, *_ = measured(name, condition)
    assert 0.003 < quiet.mean() < 0.007
    assert quiet.max() < 0.01


@pytest.mark.parametrize("name, condition", PULLED)
def test_each_slip_is_found_before_it_happens(name, condition):
    *_, flag, onset, gross = measured(name, condition)
    assert (flag >= onset).all(), f"{np.sum(flag < onset)} false alarms in {SEEDS} runs"
    assert (flag < gross).all(), f"{np.sum(flag >= gross)} missed in {SEEDS} runs"


@pytest.mark.parametrize("name, condition", PRESSED)
def test_pressing_raises_no_flag(name, condition):
    flag = measured(name, condition)[2]
    assert np.isinf(flag).all(), f"{np.isfinite(flag).sum()} false alarms in {SEEDS} runs"


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("part", PARTS)
def test_the_integer_threshold_decides_as_the_real_one(part, level):
    scene = scenes.load("acrylic_slip")
    slip = structs.replace(scene.slip, level=level)
    scene = dataclasses.replace(scene, adc_part=part, slip=slip)
    config = scene.slip_config()
    codes = np.arange(4000)
    real = codes * scene.adc.lsb_v / np.sqrt(2.0) ** level > scene.slip.threshold_p2p_v
    assert np.array_equal(codes > config.threshold, real)
    assert not config.contact_rises
    assert config.contact_level < config.release_level
    step = 1 << level
    assert config.hold == round(slip.hold_ms * 10 / step)
    codes = (slip.contact_level_v - scene.adc.low_v) / scene.adc.lsb_v + scene.adc.min_code
    assert config.contact_level / step == pytest.approx(codes, abs=0.5)


def test_an_unknown_scene_or_condition_gets_one_sentence():
    with pytest.raises(ValueError, match="'acrylic'"):
        scenes.load("acrylic")
    with pytest.raises(ValueError, match="'9 N'"):
        scenes.simulate(scenes.load("acrylic_slip"), "9 N")
