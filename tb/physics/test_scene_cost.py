"""tools/published/scene_cost.py: which features it adds to a scene, for each kind of sensor."""

import pytest

from meissner import scenes
from published import scene_cost


@pytest.mark.parametrize(
    "name, added",
    [
        ("normal_force", 1),  # the shear's speed
        ("shear_speed", 0),
        ("cop_load", 1),  # slip of the centre
        ("cop_slip", 0),
        ("walk_25x5", 1),  # calibration
        ("fsr_3x3", 0),
        ("capacitive_crosstalk", 2),  # calibration, centre of pressure
        ("rope_pull", 2),
    ],
)
def test_features_that_a_scene_does_not_use(name, added):
    scene = scene_cost.one_run(scenes.load(name))
    calls = list(scene_cost.others(scene, "fixed"))
    assert len(calls) == added
    for call in calls:
        call()


@pytest.mark.parametrize("name", ["cop_slip", pytest.param("shear_speed", marks=pytest.mark.long)])
def test_one_run_of_a_scene_is_judged(name, monkeypatch):
    monkeypatch.setattr(scene_cost, "REPEATS", 1)
    assert scene_cost.cost(name)["saved"] == 1.0


def test_every_sensor_in_the_open_is_measured():
    kinds = {scenes.load(name).sensor for name in scene_cost.names()}
    assert kinds == set(scene_cost.FEATURES)
