"""Each metric of a scene of the sensor ``shear``: which fault changes it, and which does not. Rubber, plate,
converter or core is broken on purpose; the rest of the summary stays exactly equal."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec import structs

from meissner import engines, fit_rubber, run, scenes
from meissner.engines import Watched
from meissner.physics import plate, rubber
from meissner.scenes.shear import estimate
from meissner.scenes.shear import scene as shear_scene
from meissner.twins.slip.shear_speed import FAST, SMALL
from meissner.twins.slip.slip import State

AMOUNT, RECOVER, SPEED, STICK = scenes.names("shear")
CASES = {
    AMOUNT: lambda cases: cases[::3],  # 0.01, 0.04, 0.07, 0.1 mm
    RECOVER: lambda cases: cases[2::3],  # one case of each way, at 1 mm/s
    SPEED: lambda cases: [c for c in cases if c.speed_mm_s in (0.1, 0.5, 2.0, 4.0)],
    STICK: lambda cases: cases,
}
SEEDS = {AMOUNT: 3, RECOVER: 2, SPEED: 3, STICK: 3}
COMMON = {"false_alarms", "false_alarm_rate", "over_range"}
METRICS = {
    AMOUNT: COMMON | {"step_v", "deviation_v", "slope_v_mm", "slope_error_v_mm"},
    RECOVER: COMMON
    | {"restored_after_v", "converged_after_v", "converged_table_1_after_v", "settled_s", "deviation_v"},
    SPEED: COMMON
    | {"k0", "k1", "n", "residual", "deviation_v", "off_table_1", "off_table_2", "speed_error"}
    | {"beyond_found", "beyond_falsely"}
    | {"estimate_error", "estimate_missed", "estimate_beyond", "estimates_outside"},
    STICK: COMMON
    | {"missed", "late", "missed_rate", "lead_ms_min", "contact_share_of_sliding", "stick_slips"}
    | {"change_lead_ms_min", "slope_lead_ms_min", "slope_missed_rate", "slope_quiet_rate"}
    | {"slope_pressing_rate", "stick_slips_found", "elsewhere_per_s", "rms_before_v_s", "rms_sliding_v_s"},
}
FLAG = {"missed", "late", "missed_rate", "lead_ms_min", "contact_share_of_sliding", *COMMON} - {"over_range"}
SLOPE = {key for key in METRICS[STICK] if "slope" in key or "elsewhere" in key or "found" in key}


def few(name, **changes):
    scene = scenes.load(name)
    return dataclasses.replace(scene, seeds=SEEDS[name], cases=tuple(CASES[name](scene.cases)), **changes)


@pytest.fixture
def score(tmp_path):
    """The summary of a scene."""
    return lambda scene, engine="fixed": run.run(scene, engine, tmp_path, seed=1)


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    return {name: run.run(few(name), "fixed", tmp_path_factory.mktemp(name), seed=1) for name in METRICS}


def turned(name, found, sound):
    return {key for key in METRICS[name] if found[key] != sound[name][key]}


def core(monkeypatch, breaks, engine="fixed"):
    """Break the engine's core: ``breaks`` gets the true one, codes, config and motion."""
    watch = engines.load("fixed").watch
    monkeypatch.setattr(
        engines.load(engine), "watch", lambda x, config, moving=None: breaks(watch, x, config, moving)
    )


def converter(monkeypatch, breaks):
    """Break the converter's codes before anything reads them."""
    simulate = shear_scene.simulate

    def broken(*arguments):
        recording = simulate(*arguments)
        return dataclasses.replace(recording, codes=breaks(recording.codes))

    monkeypatch.setattr(shear_scene, "simulate", broken)


def test_as_it_is(sound):
    """The fit finds the published line, both recoveries have their published ends, and no slip is
    undetected."""
    assert sound[AMOUNT]["step_v"]["mean"] == pytest.approx(0.53, abs=0.02)
    assert abs(sound[AMOUNT]["slope_v_mm"]) < 3 * sound[AMOUNT]["slope_error_v_mm"]
    assert 0.01 < sound[AMOUNT]["deviation_v"]["mean"] < 0.04
    assert sound[RECOVER]["restored_after_v"]["mean"] == pytest.approx(2.05, abs=0.02)
    for row in [row for row in sound[SPEED]["constants"] if "from" not in row["constant"]]:
        assert row["low"] < row["published"] < row["high"], row
    assert sound[SPEED]["off_table_2"]["mean"] < 0.08 < 0.4 < sound[SPEED]["off_table_1"]["mean"]
    assert sound[STICK]["missed"] == sound[STICK]["slope_missed_rate"]["count"] == 0
    assert sound[STICK]["slope_pressing_rate"]["rate"] == 1 and sound[STICK]["slope_quiet_rate"]["rate"] == 0


def halved(speed, flags):
    return speed / 2, flags


def deaf_below_0_3_mm_s(speed, flags):
    return speed, np.where((flags == 0) & (speed < 0.3), SMALL, flags)


def without_a_limit(speed, flags):
    return speed, flags & ~FAST


def of_every_window(speed, flags):
    return speed, 0 * flags


@pytest.mark.parametrize(
    ("breaks", "turns"),
    [
        (halved, {"estimate_error"}),
        (deaf_below_0_3_mm_s, {"estimate_error", "estimate_missed"}),
        (without_a_limit, {"estimate_error", "estimate_missed", "estimate_beyond"}),
        (of_every_window, {"estimate_error", "estimate_missed", "estimate_beyond", "estimates_outside"}),
    ],
)
def test_a_broken_estimator(score, sound, monkeypatch, breaks, turns):
    begin = estimate.Estimator.__init__

    def broken(self, scene, core):
        begin(self, scene, SimpleNamespace(shear_speed=lambda *given: breaks(*core.shear_speed(*given))))

    monkeypatch.setattr(estimate.Estimator, "__init__", broken)
    assert turned(SPEED, score(few(SPEED)), sound) == turns


def test_no_spread_is_no_deviation(score, sound, monkeypatch):
    """Only half a code remains; the first distance then differs from the others, 5 % low by its e^-3."""
    monkeypatch.setattr(rubber, "SHEAR_SPREAD", 0.0)
    found = score(few(AMOUNT))
    assert found["deviation_v"]["maximum"] < 1e-3 and found["false_alarms"] == 0
    steps = [row["step_v"] for row in found["conditions"]]
    # The step is read in the middle of its last twentieth, at 0.195 s of 3·(0.05/0.01 + 1/5) per second.
    assert steps[0] / steps[-1] == pytest.approx(1 - np.exp(-0.195 * 15.6), abs=2e-3)
    assert steps[1] == pytest.approx(steps[-1], abs=1e-3)
    found = score(few(SPEED))
    assert found["speed_error"]["maximum"] < 0.1 and found["residual"] < 2e-3
    assert found["beyond_found"]["rate"] == 1 and found["beyond_falsely"]["rate"] == 0
    assert [found[name] for name in fit_rubber.NAMES] == pytest.approx([1.55, -0.27, 0.11], abs=2e-3)


def test_twice_the_spread_is_twice_the_deviation(score, sound, monkeypatch):
    monkeypatch.setattr(rubber, "SHEAR_SPREAD", 2 * rubber.SHEAR_SPREAD)
    found = score(few(AMOUNT))
    for key in ("mean", "maximum"):
        assert found["deviation_v"][key] == pytest.approx(2 * sound[AMOUNT]["deviation_v"][key], rel=0.01)
    assert turned(AMOUNT, found, sound) == {"step_v", "deviation_v", "slope_v_mm", "slope_error_v_mm"}
    found = score(few(SPEED))
    assert found["residual"] == pytest.approx(2 * sound[SPEED]["residual"], rel=0.1)
    assert found["speed_error"]["mean"] > 1.5 * sound[SPEED]["speed_error"]["mean"]


def test_a_step_that_needs_ten_times_the_way_hangs_on_the_distance(score, sound, monkeypatch):
    scene = few(AMOUNT)
    monkeypatch.setattr(rubber, "SHEAR_FULL_MM", 0.1)
    found = score(scene)
    assert found["slope_v_mm"] > 10 * sound[AMOUNT]["slope_error_v_mm"]
    assert found["step_v"]["mean"] < 0.8 * sound[AMOUNT]["step_v"]["mean"]


def test_another_lot_turns_the_constants_by_as_much(score, sound):
    """k times 1.5: k0, k1 and every dV times 1.5, n unchanged; the speed error by the fitted line stays."""
    scene = few(SPEED)
    lot = dataclasses.replace(scene, cases=tuple(dataclasses.replace(c, lot=1.5) for c in scene.cases))
    found = score(lot)
    for key in ("k0", "k1"):
        assert found[key] == pytest.approx(1.5 * sound[SPEED][key], rel=2e-3)
    assert found["n"] == pytest.approx(sound[SPEED]["n"], abs=1e-3)
    for key in ("residual", "speed_error"):
        of = (lambda value: value["mean"]) if key == "speed_error" else float
        assert of(found[key]) == pytest.approx(of(sound[SPEED][key]), rel=0.02)
    assert found["off_table_2"]["mean"] == pytest.approx(0.54, abs=0.06)
    assert found["off_table_1"]["mean"] < sound[SPEED]["off_table_1"]["mean"] - 0.2


def test_another_exponent_is_fitted(score, sound, monkeypatch):
    monkeypatch.setattr(rubber, "SHEAR_EXPONENT", 0.2)
    found = score(few(SPEED))
    assert found["n"] == pytest.approx(0.2, abs=0.02)
    assert found["off_table_2"]["mean"] > 2 * sound[SPEED]["off_table_2"]["mean"]


def test_a_recovery_that_takes_five_times_as_long(score, sound, monkeypatch):
    """After 5 s e^-0.6 of the step is left: 0.55 V of 1.01 V; after 12 s the recovery has not ended
    either."""
    monkeypatch.setattr(rubber, "RECOVERY_S", 5 * rubber.RECOVERY_S)
    found = score(few(RECOVER))
    assert found["restored_after_v"]["mean"] == pytest.approx(2 + 1.01 * np.exp(-0.6), abs=0.04)
    assert found["settled_s"]["mean"] > 1.5 * sound[RECOVER]["settled_s"]["mean"]
    assert turned(RECOVER, found, sound) >= {"converged_after_v", "converged_table_1_after_v"}
    assert turned(RECOVER, found, sound) <= METRICS[RECOVER] - COMMON


@pytest.mark.parametrize("way, key", [(0, "restored"), (1, "converged"), (2, "converged_table_1")])
def test_each_way_turns_its_own_figure(way, key, score, sound):
    """With a tenth less recovery, a tenth of 1.01 V times the lot remains. In the way that recovers
    completely, half the lot halves the remainder after 5 s."""
    scene = few(RECOVER)
    cases = list(scene.cases)
    changes = {"recovers": cases[way].recovers - 0.1} if way else {"lot": 0.5}
    cases[way] = dataclasses.replace(cases[way], **changes)
    found = score(dataclasses.replace(scene, cases=tuple(cases)))
    after = turned(RECOVER, found, sound) & {name for name in METRICS[RECOVER] if "after" in name}
    assert after == {f"{key}_after_v"}
    rise_v = found[f"{key}_after_v"]["mean"] - sound[RECOVER][f"{key}_after_v"]["mean"]
    left = 0.1 * 1.01 * cases[way].lot * (1 - np.exp(-3)) if way else -0.5 * 1.01 * np.exp(-3)
    assert rise_v == pytest.approx(left, rel=0.1)


@pytest.mark.parametrize("name", [AMOUNT, RECOVER])
def test_a_dead_channel_has_no_step(name, score, monkeypatch):
    converter(monkeypatch, lambda codes: np.full_like(codes, 1638))
    found = score(few(name))
    steps = [row["step_v"] for row in found["conditions"]]
    assert steps == [0] * len(steps) and found["false_alarms"] == 0


def test_nothing_is_fitted_to_a_dead_channel(score, monkeypatch):
    """It is refused with one sentence, and no constants are given."""
    converter(monkeypatch, lambda codes: np.full_like(codes, 1638))
    with pytest.raises(ValueError, match="step_v"):
        score(few(SPEED))


def test_a_gain_that_is_a_quarter_low(score, sound, monkeypatch):
    """Codes at three quarters: dV and thus k0 at three quarters; k1 is a ratio of volts, and stays."""
    converter(monkeypatch, lambda codes: codes * 3 // 4)
    found = score(few(SPEED))
    assert found["k0"] == pytest.approx(0.75 * sound[SPEED]["k0"], rel=0.01)
    assert found["k1"] == pytest.approx(sound[SPEED]["k1"], rel=0.01)
    assert found["n"] == pytest.approx(sound[SPEED]["n"], abs=2e-3)


def test_a_core_that_always_says_slip_is_false_in_every_run(score, sound, monkeypatch):
    def cries(watch, x, config, moving):
        found = watch(x, config, moving)
        return Watched(found.p2p, found.over, np.full_like(found.state, State.GROSS), found.end, 0)

    core(monkeypatch, cries)
    for name in (AMOUNT, STICK):
        found = score(few(name))
        assert found["false_alarms"] == found["false_alarm_rate"]["count"] == found["runs"]
        assert turned(name, found, sound) <= FLAG
    assert found["missed"] == found["missed_rate"]["count"] == found["runs"]  # the flag is up before the slip


def test_fast_shear_raises_the_flag_and_slow_shear_does_not(sound):
    """At 2 V, 0.021·v^1.11 V per sample in the coefficient: above 0.02 V from 1 mm/s on."""
    alarms = {row["speed_mm_s"]: [] for row in sound[SPEED]["conditions"]}
    for row in sound[SPEED]["conditions"]:
        alarms[row["speed_mm_s"]].append(row["false_alarms"])
    assert alarms[0.1] == alarms[0.5] == [0, 0, 0] and alarms[4.0] == [3, 3, 3]
    assert alarms[2.0][0] == 3
    assert sound[SPEED]["false_alarms"] == sum(map(sum, alarms.values()))


def test_a_threshold_too_high_for_the_shear_is_quiet(score):
    scene = few(SPEED)
    slip = structs.replace(scene.slip, threshold_p2p_v=0.4, gross_threshold_p2p_v=0.6)
    found = score(dataclasses.replace(scene, slip=slip))
    assert found["false_alarms"] == found["false_alarm_rate"]["count"] == 0


@pytest.mark.parametrize("details", [1, 40])
def test_a_late_flag_turns_the_lead(details, score, sound, monkeypatch):
    def late(watch, x, config, moving):
        found = watch(x, config, moving)
        state = np.roll(found.state, details, axis=1)
        state[:, :details] = State.NONE
        return Watched(found.p2p, found.over, state, found.end, found.blanked)

    core(monkeypatch, late)
    found = score(few(STICK))
    assert found["lead_ms_min"] == pytest.approx(sound[STICK]["lead_ms_min"] - 0.2 * details, abs=0.0015)
    assert turned(STICK, found, sound) <= {"lead_ms_min", "contact_share_of_sliding"}


def test_a_flag_after_the_slip_is_late_and_missed(score, sound, monkeypatch):
    """A delay of 0.3 s is longer than any pull. The derivative does not depend on the core."""

    def late(watch, x, config, moving):
        found = watch(x, config, moving)
        state = np.roll(found.state, 1500, axis=1)
        state[:, :1500] = State.NONE
        return Watched(found.p2p, found.over, state, found.end, found.blanked)

    core(monkeypatch, late)
    found = score(few(STICK))
    assert found["late"] == found["missed"] == found["missed_rate"]["count"] == found["runs"]
    assert turned(STICK, found, sound) <= FLAG


def test_events_too_quiet_are_missed_by_both(score, sound, monkeypatch):
    """A hundredth of their size: neither detector finds the events or the stick-slips; the step itself stays
    sharp."""
    monkeypatch.setattr(rubber, "EVENT_SHARE", rubber.EVENT_SHARE / 100)
    found = score(few(STICK))
    runs = found["runs"]
    assert found["missed"] == found["slope_missed_rate"]["count"] == runs
    assert found["stick_slips_found"]["count"] == 0 and found["slope_lead_ms_min"] is None
    assert found["change_lead_ms_min"] == sound[STICK]["change_lead_ms_min"]
    assert found["stick_slips"] == sound[STICK]["stick_slips"]
    assert found["contact_share_of_sliding"] > 0.9
    for key in ("rms_before_v_s", "rms_sliding_v_s"):
        assert found[key] < 0.7 * sound[STICK][key]  # only the converter's noise remains


def test_louder_sliding_is_found_more_often(score, sound, monkeypatch):
    monkeypatch.setattr(rubber, "SLIDING_SHARE", 3 * rubber.SLIDING_SHARE)
    found = score(few(STICK))
    assert found["stick_slips_found"]["rate"] > 1.5 * sound[STICK]["stick_slips_found"]["rate"]
    assert found["rms_sliding_v_s"] > 2 * sound[STICK]["rms_sliding_v_s"]
    assert turned(STICK, found, sound) <= {
        "stick_slips_found",
        "rms_sliding_v_s",
        "elsewhere_per_s",
    } | FLAG - {
        "missed",
        "late",
        "missed_rate",
        "lead_ms_min",
    }


def test_a_shorter_stick_sticks_more_often(score, sound, monkeypatch):
    """A stick's length is proportional to the friction lost, 0.08 of mu: half of that, twice as many
    sticks."""
    acrylic = plate.MATERIALS["acrylic"]
    closer = dataclasses.replace(acrylic, mu_k=(acrylic.mu_s + acrylic.mu_k) / 2)
    monkeypatch.setitem(plate.MATERIALS, "acrylic", closer)
    found = score(few(STICK))
    assert found["stick_slips"]["mean"] == pytest.approx(2 * sound[STICK]["stick_slips"]["mean"], rel=0.1)
    assert found["change_lead_ms_min"] == sound[STICK]["change_lead_ms_min"]


def test_less_friction_shortens_every_lead(score, sound, monkeypatch):
    acrylic = plate.MATERIALS["acrylic"]
    slippery = dataclasses.replace(acrylic, mu_s=acrylic.mu_s / 2, mu_k=acrylic.mu_k / 2)
    monkeypatch.setitem(plate.MATERIALS, "acrylic", slippery)
    found = score(few(STICK))
    for key in ("change_lead_ms_min", "slope_lead_ms_min", "lead_ms_min"):
        assert found[key] < 0.7 * sound[STICK][key], key


def test_a_threshold_of_nothing_crosses_at_rest_and_elsewhere(score, sound):
    """1 V/s is less than one code per millisecond, 1.22 V/s: the converter's noise exceeds it."""
    scene = few(STICK)
    found = score(dataclasses.replace(scene, slope=scene.slope | {"slope_v_s": 1.0}))
    assert found["slope_quiet_rate"]["rate"] == 1 and found["elsewhere_per_s"] > 1
    assert turned(STICK, found, sound) <= SLOPE | {"change_lead_ms_min"}


def test_a_threshold_above_pressing_is_not_crossed_by_it(score, sound):
    """Pressing in half a second reaches 10 V/s with a ripple on top; above 60 V/s only the beginning of the
    step crosses, and the derivative misses slips."""
    scene = few(STICK)
    found = score(dataclasses.replace(scene, slope=scene.slope | {"slope_v_s": 400.0}))
    assert found["slope_pressing_rate"]["rate"] == 0 and found["slope_missed_rate"]["rate"] == 1
    assert found["stick_slips_found"]["count"] == 0 and found["change_lead_ms_min"] is None


def test_no_ripple_still_crosses_while_pressing(score, sound, monkeypatch):
    """The ramp alone crosses the threshold, so no threshold below it separates pressing from slip."""
    monkeypatch.setattr(plate, "RIPPLE_N", 0.0)
    found = score(few(STICK))
    assert found["slope_pressing_rate"]["rate"] == 1
    assert turned(STICK, found, sound) == set()


def test_what_lies_above_the_supply_is_over_range(score, sound, monkeypatch):
    """The unpressed divider at 5.01 V with a converter of 5 V: over-range for 0.3 s at rest and briefly in
    each press."""
    assert all(sound[name]["over_range"] == 0 for name in METRICS)
    volts = rubber.volts
    monkeypatch.setattr(rubber, "volts", lambda *what: volts(*what) + 0.01)
    found = score(few(AMOUNT))
    assert 3000 * found["runs"] <= found["over_range"] < 3500 * found["runs"]


@pytest.mark.parametrize("name", [AMOUNT, STICK])
def test_a_core_that_differs_from_its_twin(name, score, monkeypatch):
    def spoiled(watch, x, config, moving):
        found = watch(x, config, moving)
        if x.shape[1] > config.window:
            found.state[0, [10, 20]] = State.GROSS
        return found

    scene = dataclasses.replace(few(name), seeds=1)
    core(monkeypatch, lambda watch, x, config, moving: watch(x, config, moving), "rtl")
    assert score(scene, "rtl")["twin_mismatches"] == 0
    core(monkeypatch, spoiled, "rtl")
    assert score(scene, "rtl")["twin_mismatches"] == 2 * len(scene.cases)
