"""Each metric of a scene of the sensor ``grip``: which fault changes it, and which does not. Sensor or core
is broken on purpose; the rest of the summary stays exactly equal."""

import dataclasses

import numpy as np
import pytest

from meissner import engines, run, scenes
from meissner.physics import grip
from meissner.scenes.grip.scene import Grip
from meissner.twins.cop.cop_slip import CopSlipResult

WHOLE = scenes.load("cop_slip")
RIGHT, UP, LET_GO = WHOLE.conditions[0], WHOLE.conditions[2], WHOLE.conditions[-1]
SCENE = dataclasses.replace(WHOLE, seeds=2, conditions=(RIGHT, UP, LET_GO))
SLIP = {"missed", "late", "missed_rate", "false_alarms", "false_alarm_rate"}
LEAD = {"delay_s", "flag_s", "lead_ms_min"}
WAY = {"direction_deg", "direction_error_deg", "octants_wrong"}
OUTPUT = {"position_error", "load_error", "load_error_without_shear", "load_drop", "grip_rise_n", "move_v"}
TRUTH = {"onset_s", "gross_s"}
METRICS = SLIP | LEAD | WAY | OUTPUT | TRUTH


@pytest.fixture
def score(tmp_path):
    """The summary of a scene."""
    return lambda scene=SCENE, engine="fixed": run.run(scene, engine, tmp_path, seed=1)


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    return run.run(SCENE, "fixed", tmp_path_factory.mktemp("sound"), seed=1)


def test_the_fall_of_the_load_follows_the_wire_that_was_chosen(score):
    """A stiffer wire shears the rubber faster: dV = k v^0.11, so ten times the speed raises it by 29 %."""
    pulls = dataclasses.replace(WHOLE, seeds=1, conditions=WHOLE.conditions[:7])
    falls = [
        score(dataclasses.replace(pulls, world=pulls.world | {"wire_n_mm": wire}))["load_drop"]["mean"]
        for wire in (0.1, 0.2, 1.0)
    ]
    assert falls == sorted(falls) and falls == pytest.approx(
        [0.570, 0.598, 0.664], abs=0.006
    )  # cop_scenes.md


def turned(found, sound):
    """The metrics that differ; the rows of conditions, the times and the scene's text are not compared."""
    return {key for key in METRICS if found[key] != sound[key]}


def core(monkeypatch, break_it, codes_too=lambda codes: codes, engine="fixed"):
    """Put ``break_it(found, decisions)`` after the core and ``codes_too`` in front of it."""
    right = engines.load("fixed").cop_slip

    def broken(codes, *settings):
        return break_it(*right(codes_too(codes), *settings))

    monkeypatch.setattr(engines.load(engine), "cop_slip", broken)


def later(samples):
    """The decisions, delayed by ``samples``."""

    def broken(found, decisions):
        return found, CopSlipResult(
            *(np.concatenate([d[:1].repeat(samples), d[:-samples]]) for d in decisions)
        )

    return broken


def test_a_late_flag_turns_the_delay_and_the_lead(monkeypatch, score, sound):
    core(monkeypatch, later(10))
    found = score()
    assert turned(found, sound) == LEAD
    assert found["lead_ms_min"] == pytest.approx(sound["lead_ms_min"] - 10, abs=1e-3)
    assert found["delay_s"] == pytest.approx(sound["delay_s"] + 0.010)
    for row, was in zip(found["conditions"][:2], sound["conditions"]):
        assert row["delay_ms_median"] == pytest.approx(was["delay_ms_median"] + 10)
        assert row["delay_ms_max"] == pytest.approx(was["delay_ms_max"] + 10)


def test_a_flag_after_the_move_is_a_miss(monkeypatch, score, sound):
    """Each pull's lead is between 40 and 80 ms: delayed by 80 ms every flag is late, although each run has
    one."""
    assert 40 < sound["lead_ms_min"] < max(row["lead_ms_min"] or 0 for row in sound["conditions"]) < 80
    core(monkeypatch, later(80))
    found = score()
    assert turned(found, sound) == LEAD | {"missed", "late", "missed_rate"}
    assert found["missed"] == found["late"] == found["missed_rate"]["count"] == 4
    assert (
        found["lead_ms_min"] == pytest.approx(sound["lead_ms_min"] - 80, abs=1e-3)
        and found["lead_ms_min"] < 0
    )


def test_a_weaker_event_is_missed(monkeypatch, score, sound):
    """The load falls by 0.45 of 60 %, below the detector's 30 %: no flag, so none is late either."""
    right = grip.share
    monkeypatch.setattr(grip, "share", lambda *at: 1 - 0.45 * (1 - right(*at)))
    found = score()
    assert found["load_drop"]["mean"] == pytest.approx(0.45 * sound["load_drop"]["mean"], rel=0.02)
    assert found["load_drop"]["maximum"] < 0.3
    assert found["missed"] == found["missed_rate"]["count"] == 4
    assert found["late"] == found["false_alarms"] == 0
    assert found["lead_ms_min"] is found["direction_error_deg"] is found["flag_s"] is None
    assert found["move_v"] == pytest.approx(sound["move_v"], abs=5e-4)  # two steps of Q2.14


def test_a_grip_that_tilts_more_is_a_false_alarm(monkeypatch, score, sound):
    """As the grip opens from 3 N, the centre moves by 3 N times the tilt: 0.0015 of the half range, below the
    detector's 0.003; four times as much is above it."""
    monkeypatch.setattr(grip, "TILT", 4 * grip.TILT)
    found = score()
    assert found["missed"] == 0
    assert found["false_alarms"] == found["false_alarm_rate"]["count"] == 2
    assert [row["false_alarms"] for row in found["conditions"]] == [0, 0, 2]


def test_more_alarms_than_runs_with_one(monkeypatch, score, sound):
    """The rate counts runs: with three rises in each of six runs before any pull, six of six runs have a
    false alarm."""

    def chatter(found, decisions):
        raised = decisions.raised.copy()
        raised[10:31:10] = True
        return found, decisions._replace(raised=raised)

    core(monkeypatch, chatter)
    found = score()
    assert turned(found, sound) == {"false_alarms", "false_alarm_rate"}
    assert found["false_alarms"] == 18 and found["false_alarm_rate"]["rate"] == 1
    assert found["false_alarm_rate"]["low"] == pytest.approx(0.025 ** (1 / 6), abs=1e-6)


def test_exchanged_wires_turn_the_direction(monkeypatch, score, sound):
    """E1 and E3 exchanged: x has the wrong sign, so the pull to the right is reported to the left; up stays
    up. No other decision changes."""
    core(monkeypatch, lambda *both: both, lambda codes: codes[:, [2, 1, 0, 3]])
    found = score()
    assert turned(found, sound) == WAY | {"position_error", "move_v"}
    assert found["octants_wrong"] == 2
    assert found["direction_error_deg"]["maximum"] > 170
    assert [row["direction_error_deg_max"] > 90 for row in found["conditions"][:2]] == [True, False]


def test_a_wrong_octant(monkeypatch, score, sound):
    core(monkeypatch, lambda found, d: (found, d._replace(octant=(d.octant + 1) % 8)))
    found = score()
    assert turned(found, sound) == {"octants_wrong"} and found["octants_wrong"] == 4


def test_a_turned_axis_turns_the_direction_by_as_much(monkeypatch, score, sound):
    """The reported move is turned by 30 degrees: more than half an octant, but the octant is judged
    separately."""

    def turn(found, d):
        way = np.deg2rad(30.0)
        dx = np.rint(1e3 * (d.dx * np.cos(way) - d.dy * np.sin(way))).astype(int)
        dy = np.rint(1e3 * (d.dx * np.sin(way) + d.dy * np.cos(way))).astype(int)
        return found, d._replace(dx=dx, dy=dy)

    core(monkeypatch, turn)
    found = score()
    assert turned(found, sound) == {"direction_deg", "direction_error_deg"}
    assert (found["direction_deg"] - sound["direction_deg"]) % 360 == pytest.approx(30, abs=0.01)
    assert 24 < found["direction_error_deg"]["mean"] < 36


def test_a_shifted_centre(monkeypatch, score, sound):
    """Shifted by 0.05 of the half range: 0.025 of the range, where the error was below 0.0005."""
    core(monkeypatch, lambda found, d: (found._replace(x=found.x + round(0.05 * engines.COP_ONE)), d))
    found = score()
    assert turned(found, sound) <= {"position_error", "move_v"} and sound["position_error"]["maximum"] < 5e-4
    assert found["position_error"]["mean"] == pytest.approx(0.025, abs=5e-4)


def test_a_centre_that_moves_too_little(monkeypatch, score, sound):
    """The reported position is halved: so is the move, and a position up to 1/3 from the middle appears half
    as far out."""
    core(monkeypatch, lambda found, d: (found._replace(x=found.x // 2, y=found.y // 2), d))
    found = score()
    assert turned(found, sound) == {"position_error", "move_v"}
    assert found["move_v"]["mean"] == pytest.approx(sound["move_v"]["mean"] / 2, rel=0.02)


def test_a_wrong_gain_of_the_load(monkeypatch, score, sound):
    """A quarter more: the load of the sheared rubber, about 2 % low, is multiplied by 1.25; ratios to the
    load at rest stay."""
    core(monkeypatch, lambda found, d: (found._replace(load=found.load * 5 // 4), d))
    found = score()
    assert turned(found, sound) <= {"load_error", "load_error_without_shear", "load_drop"}
    assert found["load_error_without_shear"]["mean"] == pytest.approx(
        1.25 * (1 - sound["load_error_without_shear"]["mean"]) - 1, abs=2e-3
    )
    assert found["load_error"] != sound["load_error"]
    assert found["load_drop"] == pytest.approx(sound["load_drop"], abs=1e-3)


def test_a_dead_channel(monkeypatch, score, sound):
    """E2 stays at its code at rest: the core sees an open electrode, gives no position and flags no slip."""

    def dead(codes):
        codes = codes.copy()
        codes[:, 1] = codes[0, 1]
        return codes

    core(monkeypatch, lambda *both: both, dead)
    found = score()
    assert found["missed"] == 4 and found["late"] == found["false_alarms"] == 0
    assert found["position_error"] is found["load_error"] is found["direction_error_deg"] is None


def test_a_grip_that_rises_twice_as_much(monkeypatch, score, sound):
    monkeypatch.setattr(grip, "GRIP_RISE", 2 * grip.GRIP_RISE)
    found = score()
    for key in ("mean", "maximum"):
        assert found["grip_rise_n"][key] == pytest.approx(2 * sound["grip_rise_n"][key], rel=1e-9)


def test_a_longer_rest_moves_the_truth_and_the_flag(score, sound):
    world = SCENE.world | {"rest_s": SCENE.world["rest_s"] + 0.25}
    found = score(dataclasses.replace(SCENE, world=world))
    for key in ("onset_s", "gross_s"):
        assert found[key] == pytest.approx(sound[key] + 0.25, abs=1e-9), key
    assert found["missed"] == found["false_alarms"] == 0


def test_a_core_that_differs_from_its_twin(monkeypatch, score):
    """Two samples of one field differ in each of six runs; the run that only builds the core does not
    count."""

    def spoiled(found, decisions):
        if len(found.x) > 1:
            found.x[[100, 200]] += 1
        return found, decisions

    core(monkeypatch, lambda *both: both, engine="rtl")
    assert score(engine="rtl")["twin_mismatches"] == 0
    core(monkeypatch, spoiled, engine="rtl")
    assert score(engine="rtl")["twin_mismatches"] == 12


def test_where_nothing_is_pulled_there_is_no_rate_of_misses(score):
    found = score(dataclasses.replace(SCENE, conditions=(LET_GO,)))
    assert isinstance(LET_GO, Grip) and found["missed_rate"] is found["lead_ms_min"] is None
    told = "\n".join(run.tell(SCENE, found))
    assert "with a false alarm: 0 of 2 runs" in told and "slips missed" not in told
    assert "lead of a flag" not in told


def with_converter(**changes):
    """All conditions with the amplifiers' ``difference_gain`` or the converter's bits or noise changed."""
    config = WHOLE.config
    if "difference_gain" in changes:
        config = dataclasses.replace(config, difference_gain=changes.pop("difference_gain"))
    config = dataclasses.replace(config, adc=dataclasses.replace(config.adc, **changes))
    return dataclasses.replace(WHOLE, seeds=2, config=config)


def test_the_shipped_converter_has_something_to_spare(score):
    """An AD7606 with one and a half times the noise of its data sheet."""
    found = score(with_converter(noise_v=1.5 * 117e-6))
    assert found["missed"] == found["false_alarms"] == 0
    assert found["direction_error_deg"]["maximum"] < 22.5


@pytest.mark.parametrize("worse", [{"noise_v": 5 * 117e-6}, {"bits": 12}, {"difference_gain": 1.0}], ids=str)
def test_a_converter_that_is_worse_than_the_configuration_says(score, worse):
    """Five times the noise, 16 times the steps, or no amplifier for the differences."""
    found = score(with_converter(**worse))
    assert found["false_alarms"] > 0 and found["octants_wrong"] > 0
    assert found["direction_error_deg"]["maximum"] > 22.5
