"""Each metric of the rubber's slip scenes changes when the physics or the core is broken on purpose, and the
metrics that the fault does not concern stay."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from meissner import scenes
from meissner.engines import Watched, fixed
from meissner.physics import front, plate, rubber
from meissner.run import run
from meissner.twins.slip.slip import State

RUNS = 4
DETAIL_MS = 0.2  # two samples at 10 kHz
SLIPS = "acrylic_slip"
PRESSES = "normal_force"


def few(name, **changes):
    """A scene with few runs."""
    return replace(scenes.load(name), seeds=RUNS, **changes)


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    """The summaries of the unbroken sensor and core."""
    return {name: run(few(name), "fixed", tmp_path_factory.mktemp(name)) for name in (SLIPS, PRESSES)}


def core(monkeypatch, breaks):
    """Break the engine's core: ``breaks`` gets the true one, codes, config and motion."""
    watch = fixed.watch
    monkeypatch.setattr(fixed, "watch", lambda x, config, moving=None: breaks(watch, x, config, moving))


def row(summary):
    return summary["conditions"][0]


def test_as_it_is_nothing_is_missed_or_false(sound):
    for summary in sound.values():
        counts = [summary[key] for key in ("missed", "late", "false_alarms", "false_alarms_masked")]
        assert counts == [0, 0, 0, 0]
    assert sound[SLIPS]["missed_rate"] | {"high": None} == {
        **{"count": 0, "runs": RUNS, "rate": 0.0, "low": 0.0, "high": None}
    }
    assert sound[SLIPS]["missed_rate"]["high"] == pytest.approx(1 - 0.025 ** (1 / RUNS), abs=1e-6)
    assert sound[PRESSES]["missed_rate"] is None
    assert sound[SLIPS]["contact_share_of_sliding"] == 0
    assert row(sound[SLIPS])["lead_ms_min"] > 300
    assert sound[SLIPS]["seeds"] == [1, RUNS] and sound[SLIPS]["runs"] == RUNS


def test_quieter_events_are_flagged_later(sound, tmp_path, monkeypatch):
    monkeypatch.setattr(rubber, "EVENT_SHARE", rubber.EVENT_SHARE / 2)
    found = run(few(SLIPS), "fixed", tmp_path)
    before, now = row(sound[SLIPS]), row(found)
    assert now["delay_ms_median"] > 10 * before["delay_ms_median"]
    assert now["lead_ms_min"] < before["lead_ms_min"] / 2


def test_events_too_quiet_are_missed_though_the_last_slip_raises_a_flag(tmp_path, monkeypatch):
    """At a quarter of their size only the slip of the whole contact is loud enough: a flag, but too late."""
    monkeypatch.setattr(rubber, "EVENT_SHARE", rubber.EVENT_SHARE / 4)
    found = run(few(SLIPS), "fixed", tmp_path)
    assert found["missed"] == found["missed_rate"]["count"] == RUNS and found["late"] >= RUNS - 1
    assert row(found)["lead_ms_min"] <= 0 and found["false_alarms"] == 0


def test_louder_ripple_is_a_false_alarm_unless_the_core_is_told_of_the_motion(tmp_path, monkeypatch):
    monkeypatch.setattr(plate, "RIPPLE_N", 3 * plate.RIPPLE_N)
    found = run(few(PRESSES), "fixed", tmp_path)
    assert found["false_alarms"] > RUNS and found["false_alarms_masked"] == 0
    assert found["false_alarm_rate"]["count"] > RUNS / 2  # of 2·RUNS runs, each counted once
    assert found["false_alarm_rate"]["count"] <= 2 * RUNS < found["false_alarms"] + 2 * RUNS
    assert found["missed"] == 0


def test_a_core_that_is_deaf_to_the_motion_turns_the_masked_alarms(tmp_path, monkeypatch):
    monkeypatch.setattr(plate, "RIPPLE_N", 3 * plate.RIPPLE_N)
    core(monkeypatch, lambda watch, x, config, moving: watch(x, config))
    found = run(few(PRESSES), "fixed", tmp_path)
    assert found["false_alarms_masked"] == found["false_alarms"] > 0


def test_ripple_above_the_published_limit_is_a_false_alarm(tmp_path, monkeypatch):
    """The detail passes ripple above 1 kHz; pressing raises no flag only because of the published 600 Hz."""
    monkeypatch.setattr(plate, "RIPPLE_LIMIT_HZ", 2000.0)
    assert run(few(PRESSES), "fixed", tmp_path)["false_alarms"] > 0


@pytest.mark.parametrize("details", [1, 50])
def test_late_flags_move_delay_and_lead_by_their_lateness(details, sound, tmp_path, monkeypatch):
    def late(watch, x, config, moving):
        found = watch(x, config, moving)
        state = np.roll(found.state, details, axis=1)
        state[:, :details] = State.NONE
        return Watched(found.p2p, found.over, state, found.end, found.blanked)

    core(monkeypatch, late)
    found = run(few(SLIPS), "fixed", tmp_path)
    before, now = row(sound[SLIPS]), row(found)
    for key in ("delay_ms_median", "delay_ms_mean", "delay_ms_max", "detector_ms_max"):
        assert now[key] == pytest.approx(before[key] + details * DETAIL_MS, abs=0.0015), key
    for key in ("lead_ms_median", "lead_ms_min"):
        assert now[key] == pytest.approx(before[key] - details * DETAIL_MS, abs=0.0015), key
    assert found["flag_s"] == pytest.approx(sound[SLIPS]["flag_s"] + details * DETAIL_MS / 1e3)
    assert found["delay_s"] == pytest.approx(sound[SLIPS]["delay_s"] + details * DETAIL_MS / 1e3)
    assert found["crossing_s"] == sound[SLIPS]["crossing_s"]


@pytest.mark.parametrize(
    "breaks",
    [
        lambda codes: np.full_like(codes, 4095),  # no rubber, or a wire disconnected
        lambda codes: np.full_like(codes, 1234),  # a converter that repeats one code
    ],
    ids=["open", "stuck"],
)
def test_a_dead_channel_misses_every_slip(breaks, tmp_path, monkeypatch):
    core(monkeypatch, lambda watch, x, config, moving: watch(breaks(x), config, moving))
    found = run(few(SLIPS), "fixed", tmp_path)
    assert (found["missed"], found["late"], found["flag_s"]) == (RUNS, 0, None)
    assert found["contact_share_of_sliding"] == 1 and "delay_ms_median" not in row(found)


def test_a_gain_that_is_too_small_misses_every_slip(tmp_path, monkeypatch):
    core(monkeypatch, lambda watch, x, config, moving: watch(x // 16, config, moving))
    assert run(few(SLIPS), "fixed", tmp_path)["missed"] == RUNS


@pytest.mark.parametrize("name", [SLIPS, PRESSES])
def test_the_wrong_sign_is_contact_at_rest(name, sound, tmp_path, monkeypatch):
    """At the wrong end of the divider pressing raises Vc, so the unpressed state reads as contact. Slips are
    still detected."""
    core(monkeypatch, lambda watch, x, config, moving: watch(4095 - x, config, moving))
    found = run(few(name), "fixed", tmp_path)
    assert sound[name]["contact_wrong_share"] < 0.1
    scene = few(name)
    recordings = [scenes.simulate(scene, c, seed) for c in scene.conditions for seed in range(1, 1 + RUNS)]
    at_rest = np.mean([(one.normal_n == 0).mean() for one in recordings])
    assert found["contact_wrong_share"] == pytest.approx(at_rest, abs=0.001)


def test_a_core_that_always_says_slip_is_false_and_misses(tmp_path, monkeypatch):
    """A flag that is already up before the slip does not rise with it."""

    def cries(watch, x, config, moving):
        found = watch(x, config, moving)
        return Watched(found.p2p, found.over, np.full_like(found.state, State.GROSS), found.end, 0)

    core(monkeypatch, cries)
    found = run(few(SLIPS), "fixed", tmp_path)
    assert found["missed"] == found["false_alarms"] == found["false_alarms_masked"] == RUNS
    assert found["false_alarm_rate"]["rate"] == 1 and found["contact_share_of_sliding"] == 0


def test_without_its_own_threshold_the_flag_falls_while_the_object_slides(tmp_path):
    scene = few("slip_materials")
    slip = structs.replace(scene.slip, keep_threshold_p2p_v=scene.slip.threshold_p2p_v)
    found = run(replace(scene, slip=slip, conditions=scene.conditions[3:]), "fixed", tmp_path)
    assert found["contact_share_of_sliding"] > 0.4 and found["missed"] == 0


def test_without_the_converters_filter_events_are_seen_that_it_weakens(tmp_path, monkeypatch):
    """An AD7606 sees an event that is just before its sample only in part: a low pass ten times as slow, 1.5
    kHz, weakens each, and the flag waits for larger ones."""
    scene = few("slip_materials")
    scene = replace(scene, conditions=scene.conditions[:1])
    usual = row(run(scene, "fixed", tmp_path))["delay_ms_mean"]
    monkeypatch.setitem(front.FRONTS, "AD7606", front.Front(((5.0, 1.5e3),)))
    assert row(run(scene, "fixed", tmp_path))["delay_ms_mean"] > 2 * usual
    monkeypatch.setitem(front.FRONTS, "AD7606", front.FRONTS["MCP3208"])
    recording = scenes.simulate(scene, 0, 1)
    codes, _ = scene.adc.convert(recording.volts)
    assert np.abs(recording.codes - codes).max() < 10  # its noise, 0.8 of a code
    monkeypatch.undo()
    assert np.abs(scenes.simulate(scene, 0, 1).codes - codes).max() > 20


def test_less_friction_shortens_the_warning(sound, tmp_path, monkeypatch):
    """The contact slips at mu·N, so half of mu halves the time from the first event to the slip."""
    acrylic = plate.MATERIALS["acrylic"]
    slippery = replace(acrylic, mu_s=acrylic.mu_s / 2, mu_k=acrylic.mu_k / 2)
    monkeypatch.setitem(plate.MATERIALS, "acrylic", slippery)
    found = run(few(SLIPS), "fixed", tmp_path)
    ratio = row(found)["lead_ms_median"] / row(sound[SLIPS])["lead_ms_median"]
    assert ratio == pytest.approx(0.5, abs=0.05)


def test_a_later_pull_moves_the_truth(sound, tmp_path):
    scene = few(SLIPS)
    later = replace(scene, world=scene.world | {"stage_start_s": scene.world["stage_start_s"] + 0.25})
    found = run(later, "fixed", tmp_path)
    for key in ("onset_s", "gross_s"):
        assert found[key] == pytest.approx(sound[SLIPS][key] + 0.25, abs=1e-6)
