"""Slip of the centre of pressure on the three engines and in ``meissner run``: fixed equals rtl in every
field, float in every flag; the verdict on a run by hand; the quantities that the source publishes; the
summary."""

import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import engines, run, scenes
from meissner.scenes.grip import run as cop_slip
from meissner.scenes.grip.scene import Grip, Pull
from meissner.twins.cop.cop_slip import CopSlipRegisters, CopSlipResult

SCENE = scenes.load("cop_slip")


def few(seeds=1):
    return dataclasses.replace(SCENE, seeds=seeds)


@pytest.mark.parametrize("number", range(len(SCENE.conditions)))
def test_engines_agree(number):
    codes = scenes.simulate(SCENE, SCENE.conditions[number], 5).codes
    settings = SCENE.config, SCENE.lag, SCENE.registers
    floating, fixed, rtl = (engines.load(name).cop_slip(codes, *settings) for name in engines.NAMES)
    for ours, theirs in zip((*fixed[0], *fixed[1]), (*rtl[0], *rtl[1])):
        assert np.array_equal(ours, theirs) and ours.dtype == theirs.dtype
    rises, near = (np.flatnonzero(one[1].raised) for one in (fixed, floating))
    assert len(rises) == len(near) == isinstance(SCENE.conditions[number], Pull)
    assert np.abs(rises - near).max(initial=0) <= 2
    assert np.abs(fixed[1].dx - floating[1].dx).max() < 2 and np.abs(fixed[1].dy - floating[1].dy).max() < 2
    assert np.array_equal(fixed[1].octant[rises], floating[1].octant[near])


@pytest.mark.parametrize("hold, refractory", [(0, 0), (3, 0), (0, 5), (7, 20)])
@pytest.mark.parametrize("lag", [1, 5])
def test_engines_agree_where_much_happens(lag, hold, refractory):
    """Random loads, contacts that come and go, and more rises than a real slip has."""
    rng = np.random.default_rng(lag + hold + refractory)
    config, count = SCENE.config, 600
    load = np.zeros((count, 7, 7))
    for scene in load:
        scene[rng.integers(7), rng.integers(7)] = rng.choice([0, 0.2, 1, 3])
    answer = config.mesh.solve(load)
    codes = config.convert(np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1))
    registers = CopSlipRegisters(drop=77, move=800, min_load=300, hold=hold, refractory=refractory)
    floating, fixed, rtl = (
        engines.load(name).cop_slip(codes, config, lag, registers)[1] for name in engines.NAMES
    )
    for ours, theirs in zip(fixed, rtl):
        assert np.array_equal(ours, theirs)
    for name in ("slip", "raised", "over"):
        assert np.array_equal(getattr(fixed, name), getattr(floating, name)), name
    assert fixed.raised.sum() > 10


def test_a_recording_shorter_than_the_lag():
    codes = scenes.simulate(SCENE, SCENE.conditions[0], 1).codes[: SCENE.lag - 1]
    for name in engines.NAMES:
        found, decisions = engines.load(name).cop_slip(codes, SCENE.config, SCENE.lag, SCENE.registers)
        assert len(found.x) == len(decisions.slip) == len(codes) and not decisions.slip.any()


def decided(raised, dx=0, dy=0, octant=0, count=200):
    flags = np.zeros(count, dtype=bool)
    flags[list(raised)] = True
    whole = np.ones(count, dtype=np.int64)
    return CopSlipResult(flags, flags, flags, dx * whole, dy * whole, octant * whole)


def recording(onset_s=0.05, gross_s=0.1, direction_deg=0.0):
    held = SimpleNamespace(onset_s=onset_s, gross_s=gross_s, grip_n=np.arange(200.0))
    scene = SimpleNamespace(rate_hz=1000)
    return SimpleNamespace(
        scene=scene, held=held, condition=SimpleNamespace(direction_deg=direction_deg), load=None
    )


@pytest.mark.parametrize(
    "raised, flag_s, missed, false_alarms",
    [
        ([60], 0.060, False, 0),
        ([50], 0.050, False, 0),  # at the onset itself
        ([49], None, True, 1),
        ([20, 70, 90], 0.070, False, 1),
        ([99], 0.099, False, 0),
        ([100], 0.100, True, 0),  # late: not before the object moves
        ([], None, True, 0),
    ],
)
def test_judge_by_hand(raised, flag_s, missed, false_alarms):
    verdict = cop_slip.judge(recording(), decided(raised))
    assert verdict["late"] == (raised == [100])
    assert (verdict["flag_s"], verdict["missed"], verdict["false_alarms"]) == (flag_s, missed, false_alarms)
    if flag_s is None:
        assert verdict["delay_s"] is verdict["lead_s"] is verdict["direction_deg"] is None
    else:
        assert verdict["delay_s"] == pytest.approx(flag_s - 0.05)
        assert verdict["lead_s"] == pytest.approx(0.1 - flag_s)


def test_every_rise_without_a_pull_is_false():
    verdict = cop_slip.judge(recording(None, None), decided([3, 70]))
    assert verdict["false_alarms"] == 2 and not verdict["missed"] and verdict["flag_s"] is None


@pytest.mark.parametrize(
    "dx, dy, octant, true_deg, error_deg, right",
    [
        (100, 0, 0, 0.0, 0, True),
        (0, 100, 2, 90.0, 0, True),
        (-100, 0, 4, 180.0, 0, True),
        (-100, -1, 4, 180.0, 0.573, True),  # across ±180 degrees
        (100, 0, 0, 350.0, 10, True),
        (100, -100, 7, -45.0, 0, True),
        (100, 0, 1, 0.0, 0, False),
        (-100, 0, 4, 0.0, 180, False),
    ],
)
def test_directions_by_hand(dx, dy, octant, true_deg, error_deg, right):
    verdict = cop_slip.judge(recording(direction_deg=true_deg), decided([60], dx, dy, octant))
    assert verdict["direction_error_deg"] == pytest.approx(error_deg, abs=1e-3)
    assert verdict["octant_right"] == right


def test_what_the_source_gives_numbers_of():
    load, x = np.full(200, 2.0), np.zeros(200)
    load[60:90], x[55:] = 0.8, 0.02
    load[110:] = 0.1  # after the object moved
    facts = cop_slip.published(recording(direction_deg=180.0), x, np.ones(200), load)
    assert facts["load_drop"] == pytest.approx(0.6) and facts["grip_rise_n"] == 50
    assert facts["move_v"] == pytest.approx(-0.08)
    assert cop_slip.published(recording(None, None), x, x, load) is None


@pytest.mark.parametrize("engine", engines.NAMES)
def test_run_the_scene(tmp_path, engine, request):
    if engine != "rtl":
        request.getfixturevalue("undrawn")
    scene = few(2)
    summary = run.run(scene, engine, tmp_path, seed=3)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    keys = "scene engine seed seconds_simulated seconds_taken samples_per_second twin_mismatches modelled"
    keys += " left_out onset_s flag_s delay_s missed false_alarms position_error load_error direction_deg"
    assert set(keys.split()) <= set(summary)
    assert summary["twin_mismatches"] == (0 if engine == "rtl" else None)
    assert summary["missed"] == summary["false_alarms"] == summary["octants_wrong"] == 0
    assert summary["onset_s"] < summary["flag_s"] < summary["gross_s"]
    assert summary["direction_error_deg"]["maximum"] < 22.5
    assert 0.5 < summary["load_drop"]["mean"] < 0.65
    assert summary["grip_rise_n"]["mean"] == pytest.approx(0.2, rel=0.1)
    assert summary["move_v"]["mean"] == pytest.approx(0.05, rel=0.1)
    assert summary["position_error"]["maximum"] < 0.002 and summary["load_error"]["maximum"] > 0.5
    assert summary["load_error_without_shear"]["maximum"] < 0.1
    rows = {row["condition"]: row for row in summary["conditions"]}
    assert [rows[c.name]["delay_ms_max"] is None for c in scene.conditions] == [
        isinstance(c, Grip) for c in scene.conditions
    ]
    assert summary["runs"] == 2 * len(scene.conditions) and summary["seeds"] == [3, 4]
    # None of 14 pulls and none of 20 runs: the exact interval ends at 1 - 0.025^(1/n).
    assert summary["missed_rate"] == {"count": 0, "runs": 14, "rate": 0, "low": 0, "high": 0.231636}
    assert summary["false_alarm_rate"] == {"count": 0, "runs": 20, "rate": 0, "low": 0, "high": 0.168433}
    assert summary["lead_ms_min"] == min(row["lead_ms_min"] or 1e9 for row in summary["conditions"]) > 20
    result = np.load(tmp_path / "result.npz")
    assert np.array_equal(result["c0_codes"], scenes.simulate(scene, scene.conditions[0], 3).codes)
    assert len(list(tmp_path.glob("*.png"))) == 1 + len(scene.conditions)
    told = "\n".join(cop_slip.tell(summary))
    assert "load output down by" in told and "0 in the wrong octant" in told
    assert "0 of 14 runs (0 %, 95 % interval 0 to 23.2 %)" in told and "seeds 3 to 4" in told


def test_a_core_that_differs_is_reported(tmp_path, monkeypatch, undrawn):
    """One load in one run and two octants in the next differ, which counts three; the twin decides the
    verdict."""
    module, calls = engines.load("rtl"), []
    right = module.cop_slip

    def spoiled(codes, *settings):
        found, decisions = right(codes, *settings)
        calls.append(codes)
        if len(calls) == 2:  # the first call only builds
            found.load[10] += 1
        if len(calls) == 3:
            decisions.octant[[20, 30]] ^= 1
        return found, decisions

    monkeypatch.setattr(module, "cop_slip", spoiled)
    assert run.run(few(), "rtl", tmp_path)["twin_mismatches"] == 3


def test_a_detector_that_never_fires_misses_all(tmp_path, undrawn):
    deaf = dataclasses.replace(few(), registers=dataclasses.replace(SCENE.registers, move=20000))
    summary = run.run(deaf, "fixed", tmp_path)
    assert summary["missed"] == sum(isinstance(c, Pull) for c in SCENE.conditions)
    assert summary["direction_error_deg"] is None and summary["flag_s"] is None
    assert "no flag" in "\n".join(cop_slip.tell(summary))


def test_without_its_move_the_detector_takes_a_release_for_a_slip(tmp_path, undrawn):
    loose = dataclasses.replace(few(), registers=dataclasses.replace(SCENE.registers, move=0))
    rows = {row["condition"]: row for row in run.run(loose, "fixed", tmp_path)["conditions"]}
    assert rows["let go"]["false_alarms"] > 0 and rows["quickly"]["false_alarms"] > 0


def test_waves_are_refused_without_signals():
    with pytest.raises(ValueError, match="--waves"):
        run.check(SCENE, "fixed", waves=True)
