"""What the host of a hand's scenes writes, and when; what the loop counts as a tightening."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from meissner import run as runs
from meissner import scenes
from meissner.scenes.hand import host, loop
from meissner.twins.actuate.grip import Grip


class Written:
    """Reflexes that record the host's writes."""

    def __init__(self):
        self.found = []

    def compare_with(self, threshold):
        pass

    def answer_by(self, steps, decays):
        self.found.append((steps.tolist(), decays.tolist()))


def test_the_grip_of_a_vc_is_that_of_the_published_points():
    for volts, newtons in ((4.0, 0.5), (3.0, 1.0), (2.0, 1.7)):
        assert host.grip_n(volts) == pytest.approx(newtons, rel=1e-4)
    assert host.grip_n(5.0) == 0.02 and host.grip_n(0.0) == 10.0


@pytest.mark.parametrize("number, cycles", [(0, 1), (3, 10)])
def test_a_step_is_a_share_of_the_grip_and_a_smaller_one_in_calm(monkeypatch, number, cycles):
    """1 N and 2 N: 80 and 160 counts of 0.1 um; from the first look after 3 s on 40 and 80, and a decay of 9
    and 18 counts in place of 2. 250 counts within a look are a tug at 1 N, 249 are not; at 2 N the limit is
    500. At 1 ms counts are five times as fine and a cycle is a tenth as long: decays of 4.5 and 9, the first
    written as 4.
    """
    monkeypatch.setattr(host, "grip_n", lambda volts: np.array([1.0, 2.0]))
    scene = scenes.load("grip_disturb")
    scene = replace(scene, grip=scene.grip | {"calm_share": 0.004, "calm_decay_share": 0.09})
    reflexes = Written()
    ours = host.Host(scene, scene.conditions[number], reflexes, np.array([3.0, 1.8]))
    finer = 5 if cycles == 10 else 1
    strong = ([80 * finer, 160 * finer], [1, 1] if finer == 5 else [2, 2])
    calm = ([40 * finer, 80 * finer], [4, 9] if finer == 5 else [9, 18])
    command = np.array([20000, 20000])
    for cycle in range(380 * cycles):
        if cycle in (330 * cycles, 350 * cycles):
            command = command + np.array([[249, 499], [250, 499]][cycle == 350 * cycles]) * finer
        ours.write(cycle)
        ours.read(np.array([3.0, 1.8]), command)
    assert len(reflexes.found) == 19
    assert reflexes.found[:16] == [strong] * 16  # 0 to 3 s
    assert reflexes.found[16:18] == [calm] * 2  # 3.2 and 3.4 s
    assert reflexes.found[18] == (  # 3.6 s: only the first had a tug
        [strong[0][0], calm[0][1]],
        [strong[1][0], calm[1][1]],
    )


@pytest.mark.parametrize("without, changes", [("step_share", {}), ("rule", {"step_mm": 0.03})])
def test_a_scene_without_a_share_and_a_condition_with_a_step_keep_their_own(without, changes):
    scene = scenes.load("grip_disturb")
    grip = {key: value for key, value in scene.grip.items() if key != without}
    scene = replace(scene, grip=grip | {"rule": "any"})
    reflexes = Written()
    ours = host.Host(scene, structs.replace(scene.conditions[0], **changes), reflexes, np.array([3.0]))
    for cycle in range(500):
        ours.write(cycle)
        ours.read(np.array([3.0]), np.array([20000]))
    assert reflexes.found == []


class Scripted:
    """Both fingers are over in cycles 10 to 14, the first alone in 20, the second in 25: 50 details per
    cycle."""

    def __init__(self, channels, config):
        self.cycle = -1

    def next(self, codes):
        self.cycle += 1
        over = np.zeros((2, 50), dtype=bool)
        over[0], over[1] = self.cycle in (10, 11, 12, 13, 14, 20), self.cycle in (10, 11, 12, 13, 14, 25)
        return np.zeros((2, 50)), np.zeros((2, 50)), over


def test_tightenings_are_cycles_and_not_fingers_or_windows():
    """Seven cycles, which contain nine or more windows of 32 details per finger; no patch slips, so all are
    false."""
    scene = scenes.load("grip_release")
    condition = structs.replace(scene.conditions[0], duration_s=0.5, step_mm=0.0, decay_mm_s=0.0)
    scene = replace(scene, conditions=(condition,), world=scene.world | {"hold_from_s": 0.1})
    held = loop.hold(scene, condition, [1], (Scripted, Grip))
    assert held.tightenings.tolist() == [7] and held.false_tightenings.tolist() == [7]
    assert held.trace.over.sum() > 20


@pytest.mark.long
@pytest.mark.parametrize("name", ["grip_water", "grip_pour", "grip_disturb", "grip_release"])
def test_every_seed_of_a_scene_is_the_same_on_the_core(name, tmp_path):
    """Each condition with all its seeds, word for word: the core differs from its twins in no cycle."""
    scene = scenes.load(name)
    summary = runs.run(scene, "rtl", tmp_path)
    assert summary["twin_mismatches"] == 0
    assert summary["runs"] == scene.seeds * len(scene.conditions) >= 40 and summary["tightenings"] > 1000
