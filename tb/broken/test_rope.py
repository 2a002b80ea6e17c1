"""Each metric of the scenes of a rope: which fault changes it, and which does not. Rope, grip, hand, sensors,
load cell or decisions are broken on purpose; the rest of the summary stays exactly equal."""

import dataclasses

import numpy as np
import pytest

from meissner import scenes
from meissner.physics import rope
from meissner.rope import train
from meissner.scenes.rope import judge, run
from meissner.scenes.rope import scene as of_rope
from meissner.scenes.timed import TimedEngine

COP, HARDNESS, PULL = "fingertip_cop", "fingertip_hardness", "rope_pull"
TIMES = {"seconds_taken", "samples_per_second"}
MOVES = {"x_moves", "y_moves", "y_left", "y_follows"}
ALARMS = {"missed", "missed_rate", "false_alarms", "false_alarm_rate", "apart_ms", "apart_ms_deviation"}
SHOWN = {"onset_s", "flag_s", "delay_s"}
FIXED = {"false_alarms_masked", "trees", "trained_on", "frames"}


def few(name):
    """One seed; of the ropes a, b and g by force, and b by speed, after a training on every fourth pull."""
    scene = dataclasses.replace(scenes.load(name), seeds=1)
    if name == PULL:
        keep = (0, 1, 6, 8)
        some = {key: tuple(getattr(scene, key)[k] for k in keep) for key in ("names", "pulls")}
        scene = dataclasses.replace(scene, **some, world=scene.world | {"trees": 30})
    return scene


def score(name):
    """{metric: value; each column of the table: values} of one run on fixed."""
    summary = run.run(few(name), "fixed", 1).summary
    rows = summary["conditions"]
    found = {key: value for key, value in summary.items() if key not in TIMES | {"conditions"}}
    return found | {f"each {key}": [row[key] for row in rows] for key in rows[0] if key != "condition"}


@pytest.fixture(scope="module")
def unbroken():
    every, right = train.pulls, judge.training
    kept = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(train, "pulls", lambda like: every(like)[::4])
        found = {name: score(name) for name in (COP, HARDNESS, PULL)}
        kept[1] = right(few(PULL), 1)
    # Every later run is trained on the sound recordings: what breaks, breaks in real time.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judge, "training", lambda scene, seed: kept[seed])
        yield found


def turned(name, sound):
    found = score(name)
    assert set(found) == set(sound[name])
    return found, {key for key in found if found[key] != sound[name][key]}


def converter(monkeypatch, breaks):
    """``breaks`` the codes [frames, rows, columns] of every recording."""
    right = of_rope.record

    def broken(*given):
        return [dataclasses.replace(one, codes=breaks(one.codes.copy())) for one in right(*given)]

    monkeypatch.setattr(of_rope, "record", broken)


def test_as_it_is(sound):
    """Falls in every slip, none in a hold; A95 slides more evenly and has a straight s_8; all slips found."""
    hard, cop, pull = sound[HARDNESS], sound[COP], sound[PULL]
    a27_3n, a27, a60, a95, r = hard["each oscillation"]
    assert a27_3n < 2 < a95 < a60 < a27 < r and hard["each slipping_sections"] == [
        0,
        *hard["each sections"][1:],
    ] == [0, 4, 4, 4, 4]
    assert (
        hard["each below"][0] == 0 and 20 <= hard["each below"][1] <= 35 and 10 <= hard["each below"][4] <= 18
    )
    assert (
        -30 < hard["each below_mean"][1] < -20 and hard["each below_mean"][4] < 2 * hard["each below_mean"][1]
    )
    assert hard["each s_8_range"][3] < 5 < hard["each s_8_range"][1] and min(hard["each s_3_rises"]) > 20
    assert cop["each x_falls"] == cop["each y_rises"] == cop["each pulls"] == [4, 4]
    assert cop["each y_follows"][0] > 1.5 * cop["each y_follows"][1]
    assert (pull["missed"], pull["false_alarms"], pull["false_alarms_masked"]) == (0, 0, 0)
    assert pull["each errors"] == [0, 0, 0, None] and pull["each slipping_sections"] == [1, 1, 1, 2]
    assert (pull["trees"], pull["frames"], pull["over_range"]) == (30, 4 * 820, 0)
    assert pull["trained_on"] == 120 - 32


def slippery(monkeypatch):
    """Friction that does not fall when the rope slides: no stick-slip, and the load cell sees no slip."""
    monkeypatch.setattr(rope, "KINETIC", 1.0)
    monkeypatch.setattr(rope, "UNEVEN", 0.0)


def test_the_centre_of_a_rope_that_does_not_stick(monkeypatch, sound):
    slippery(monkeypatch)
    _, which = turned(COP, sound)
    assert which <= {f"each {key}" for key in MOVES} | {"position_error", "load_error"} and which


def test_a_rope_that_does_not_stick(monkeypatch, sound):
    slippery(monkeypatch)
    found, which = turned(HARDNESS, sound)
    assert found["each slipping_sections"] == [0] * 5
    assert max(found["each below"]) == 0 and found["each below_mean"] == [None] * 5
    assert max(found["each oscillation"]) < 2
    assert which >= {"each below_least", "each below_most", "each period_steps", "each s_3_rises"}


def test_a_grip_that_lets_go_as_a_whole(monkeypatch, sound):
    """The nine-sided grip becomes the R shape: half as many falls, twice as far; the R shape stays as it
    is."""
    monkeypatch.setitem(rope.SHAPES, "nine-sided", rope.SHAPES["R"])
    found, which = turned(HARDNESS, sound)
    assert found["each below"][1] < 0.7 * sound[HARDNESS]["each below"][1]
    assert found["each below_mean"][1] < 2 * sound[HARDNESS]["each below_mean"][1]
    assert found["each period_steps"][1] > 1.5 * sound[HARDNESS]["each period_steps"][1]
    for key in which:
        if key.startswith("each"):
            assert found[key][4] == sound[HARDNESS][key][4], key


def test_hardness_without_effect_on_the_grip(monkeypatch, sound):
    """All grips as soft as A27: A60 and A95 oscillate as it does, and s_8 of A95 responds."""
    monkeypatch.setattr(rope, "modulus", lambda shore: 1.00743)
    found, _ = turned(HARDNESS, sound)
    for k in (2, 3):
        assert found["each oscillation"][k] > 0.8 * sound[HARDNESS]["each oscillation"][1]
        assert found["each s_8_range"][k] > 10


def test_a_contact_that_heals_at_once(monkeypatch, sound):
    """Then a hard grip sticks as a soft one does, only more often."""
    monkeypatch.setattr(rope, "HEAL_S", 0.002)
    found, _ = turned(HARDNESS, sound)
    assert found["each oscillation"][3] > 2 * sound[HARDNESS]["each oscillation"][3]


def test_a_hand_that_does_not_turn(monkeypatch, sound):
    """y stays: no rise in a pull beyond the noise, nothing left, while x moves as before."""
    monkeypatch.setattr(rope, "TURN_N", 0.0)
    monkeypatch.setattr(rope, "DRIFT_MM", 1e-9)
    found, which = turned(COP, sound)
    for k in range(2):
        assert abs(found["each y_moves"][k]) < 0.1 * sound[COP]["each y_moves"][k]
        assert abs(found["each y_left"][k]) < 0.1 * sound[COP]["each y_left"][k]
        assert found["each x_moves"][k] == pytest.approx(sound[COP]["each x_moves"][k], rel=0.2)
    assert "each y_follows" in which and found["each x_falls"] == [4, 4] and found["each y_rises"] != [4, 4]


def test_a_tension_that_presses_on_the_other_side(monkeypatch, sound):
    monkeypatch.setattr(rope, "WRAP", rope.WRAP[::-1])
    found, _ = turned(COP, sound)
    assert found["each x_falls"] == [0, 0] and min(found["each x_moves"]) > 0
    found, _ = turned(HARDNESS, sound)
    assert found["each below"][1] < 0.2 * sound[HARDNESS]["each below"][1]


def test_a_grip_that_hides_the_place(monkeypatch, sound):
    """Protrusions that spread the force as the grip without them does."""
    flat = rope.SHAPES["nine-sided without protrusions"]
    monkeypatch.setitem(rope.SHAPES, "nine-sided", flat)
    found, _ = turned(COP, sound)
    assert found["each y_follows"][0] == pytest.approx(found["each y_follows"][1], rel=0.1)


def test_a_shifted_centre_and_a_sum_that_is_too_large(monkeypatch, sound):
    """0.06 and -0.08 of the half range are 0.05 of the range; a tenth more load."""
    right = TimedEngine.cop

    def broken(*given):
        found = right(*given)
        shifted = {"x": found["x"] + 0.06 * 16384, "y": found["y"] - 0.08 * 16384}
        return found | shifted | {"sum": found["sum"] * 1.1}

    monkeypatch.setattr(TimedEngine, "cop", broken)
    found, which = turned(COP, sound)
    assert which == {"position_error", "load_error"}
    assert found["position_error"]["mean"] == pytest.approx(0.05, abs=0.01)
    assert found["load_error"]["mean"] > 0.05


def test_loads_too_small_for_a_position(sound):
    scene = dataclasses.replace(few(COP), min_load_n=9.0)
    found = run.run(scene, "fixed", 1).summary
    assert sound[COP]["below_min_load"] == 0 < found["below_min_load"]


def test_a_supply_that_the_sensors_reach(sound):
    readout = dataclasses.replace(few(COP).readout, load_ohm=6000.0)
    found = run.run(dataclasses.replace(few(COP), readout=readout), "fixed", 1).summary
    assert sound[COP]["over_range"] == 0 < found["over_range"]


def test_dead_sensors_miss_every_slip(monkeypatch, sound):
    converter(monkeypatch, lambda codes: codes * 0)
    found, which = turned(PULL, sound)
    assert (
        found["each missed"] == found["each slipping_sections"]
        and found["missed"] == 5
        and found["missed_rate"]["rate"] == 1
    )
    assert found["flag_s"] is found["delay_s"] is found["apart_ms"] is found["apart_ms_deviation"] is None
    assert found["onset_s"] == sound[PULL]["onset_s"] and not which & FIXED
    assert found["false_alarms"] == 0


def alarms(monkeypatch, change):
    right = judge.decide
    monkeypatch.setattr(judge, "decide", lambda *given: [(one, change(two)) for one, two in right(*given)])


def test_an_alarm_that_is_always_up(monkeypatch, sound):
    """An alarm in each section without slip, and the first of a slip at the sixth frame of its section."""
    alarms(monkeypatch, np.ones_like)
    found, which = turned(PULL, sound)
    assert found["false_alarms"] == 3 and found["false_alarm_rate"]["rate"] == 1 and found["missed"] == 0
    assert (
        found["each errors"] == [1, 1, 1, None]
        and found["each apart_steps"] != sound[PULL]["each apart_steps"]
    )
    assert found["apart_ms"] < sound[PULL]["apart_ms"] - 100
    assert which <= ALARMS | {"flag_s", "delay_s"} | {"each errors", "each apart_steps", "each apart_ms"}


def test_an_alarm_that_is_four_frames_late(monkeypatch, sound):
    alarms(monkeypatch, lambda slip: np.roll(slip, 4))
    found, which = turned(PULL, sound)
    assert found["apart_ms"] == pytest.approx(sound[PULL]["apart_ms"] + 100, abs=1e-9)
    assert found["delay_s"] == pytest.approx(sound[PULL]["delay_s"] + 0.1)
    assert which == {"apart_ms", "flag_s", "delay_s", "each apart_steps", "each apart_ms"}


def test_a_load_cell_that_says_nothing(monkeypatch, sound):
    """Without its fall there is no section that slips, and so no truth but the holds'."""
    right = rope.pull
    still = lambda *given: dataclasses.replace(found := right(*given), load_n=0 * found.load_n)
    monkeypatch.setattr(rope, "pull", still)
    found, which = turned(PULL, sound)
    assert found["missed_rate"] is None and found["each slipping_sections"] == [0] * 4
    assert found["each quiet_sections"] == [2] * 4 and found["false_alarms"] == 5
    assert found["onset_s"] is None and not which & FIXED


def test_fixed_and_float_find_the_same():
    for name in (COP, HARDNESS, PULL):
        one, other = (run.run(few(name), engine, 1).summary for engine in ("fixed", "float"))
        assert one["conditions"] == other["conditions"] or name == COP
