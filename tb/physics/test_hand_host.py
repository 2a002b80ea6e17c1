"""What the host of a hand's scenes writes, and when; what the loop counts as a tightening."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from meissner import run as runs
from meissner import scenes
from meissner.physics import rubber
from meissner.scenes import base
from meissner.scenes.hand import host, loop
from meissner.twins.actuate.grip import Grip


class Written:
    """Reflexes that record the host's writes."""

    def __init__(self):
        self.found, self.floors = [], []

    def compare_with(self, threshold):
        pass

    def answer_by(self, steps, decays):
        self.found.append((steps.tolist(), decays.tolist()))

    def hold_above(self, floors):
        self.floors.append(floors.tolist())


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
    ours = host.Host(
        scene, scene.conditions[number], reflexes, np.array([3.0, 1.8]), np.array([0.004, 0.005])
    )
    finer = 5 if cycles == 10 else 1
    strong = ([80 * finer, 160 * finer], [1, 1] if finer == 5 else [2, 2])
    calm = ([40 * finer, 80 * finer], [4, 9] if finer == 5 else [9, 18])
    command = np.array([20000, 20000])
    for cycle in range(380 * cycles):
        if cycle in (330 * cycles, 350 * cycles):
            command = command + np.array([[249, 499], [250, 499]][cycle == 350 * cycles]) * finer
        ours.write(cycle)
        ours.read(np.array([3.0, 1.8]), command, np.zeros(2, dtype=bool))
    assert len(reflexes.found) == 19
    assert reflexes.found[:16] == [strong] * 16  # 0 to 3 s
    assert reflexes.found[16:18] == [calm] * 2  # 3.2 and 3.4 s
    assert reflexes.found[18] == (  # 3.6 s: only the first had a tug
        [strong[0][0], calm[0][1]],
        [strong[1][0], calm[1][1]],
    )


@pytest.mark.parametrize("off, changes", [({"step_share": 0.0}, {}), ({}, {"step_mm": 0.03})])
def test_a_scene_without_a_share_and_a_condition_with_a_step_keep_their_own(off, changes):
    scene = scenes.load("grip_disturb")
    scene = replace(scene, grip=scene.grip | off | {"rule": "any"})
    reflexes = Written()
    ours = host.Host(
        scene, structs.replace(scene.conditions[0], **changes), reflexes, np.array([3.0]), np.array([0.004])
    )
    for cycle in range(500):
        ours.write(cycle)
        ours.read(np.array([3.0]), np.array([20000]), np.zeros(1, dtype=bool))
    assert reflexes.found == []


@pytest.mark.parametrize("number, cycles", [(0, 1), (3, 10)])
def test_a_gross_slip_raises_the_floor_which_then_falls(monkeypatch, number, cycles):
    """Grips of 1 N and 2 N, 10,000 and 20,000 counts at 10 ms. After the gross slip of the second finger pair
    the floor is the command and an eighth of the grip, 32,500; 10 ms later 2 % a second less: 4 counts. A
    second gross slip at a command below it, 29,000 + 2,500, leaves it; one at the top ends at the maximum.
    At 1 ms the counts are five times as fine, and the host still answers every 10 ms.
    """
    monkeypatch.setattr(host, "grip_n", lambda volts: np.array([1.0, 2.0]))
    scene = scenes.load("grip_disturb")
    scene = replace(scene, grip=scene.grip | {"gross_share": 0.125, "floor_decay_share": 0.02})
    reflexes, finer = Written(), 5 if cycles == 10 else 1
    ours = host.Host(
        scene, scene.conditions[number], reflexes, np.array([3.0, 1.8]), np.array([0.004, 0.005])
    )
    least, top = (0, 65535) if finer == 5 else (1000, 60000)
    commands = {0: 30000 // finer, 2: 29000 // finer, 4: top - 1000}
    for cycle in range(6 * cycles):
        answer, first = divmod(cycle, cycles)
        command = np.array([9000, commands.get(answer, 30000 // finer)])
        ours.write(cycle)
        ours.read(np.array([3.0, 1.8]), command, np.array([False, answer in commands and not first]))
    if finer == 1:
        assert [floor for _, floor in reflexes.floors] == [1000, 32500, 32496, 32492, 32488, 60000]
    else:
        assert [floor for _, floor in reflexes.floors] == [0, 18500, 18480, 18460, 18440, 65535]
    assert [floor for floor, _ in reflexes.floors] == [least] * 6


def test_the_quiet_sensor_is_what_its_codes_say_while_it_closes(monkeypatch):
    """Against a plain loop over a ramp of 1 N/s to 3 N without noise or ripple: the greatest spread of
    differences of neighbours in a window of 64. With five times the noise it is at least twice as much, and
    the threshold follows."""
    scene = scenes.load("grip_pour")
    usual_v = host.quiet_v(scene, scene.conditions[0], [1, 2, 3])
    assert len(usual_v) == 3 and (usual_v > 0.003).all() and (usual_v < 0.007).all()
    monkeypatch.setattr(host.plate, "RIPPLE_N", 0.0)
    volts = rubber.rest_volts(np.maximum(np.arange(30000) / 1e4, 1e-6))
    code = [min(int(v * 4096 / 5 + 0.5), 4095) for v in volts]
    spreads = []
    for at in range(0, 30000, 64):
        differences = [code[k] - code[k + 1] for k in range(at, min(at + 64, 30000), 2)]
        spreads.append(max(differences) - min(differences))
    without_v = max(spreads) * 5 / 4096 / 2**0.5
    monkeypatch.setitem(base.PARTS, "MCP3208", replace(scene.adc, noise_v=0.0))
    assert host.quiet_v(scene, scene.conditions[0], [1, 2, 3]).tolist() == pytest.approx([without_v] * 3)
    monkeypatch.setitem(base.PARTS, "MCP3208", replace(scene.adc, noise_v=5 * 0.198e-3))
    noisy_v = host.quiet_v(scene, scene.conditions[0], [1, 2, 3])
    assert (noisy_v > 2 * without_v).all() and len(set(noisy_v.tolist())) > 1
    threshold = scene.threshold(scene.conditions[0], np.ones(2), np.array([0.004, 0.02]))
    assert threshold.tolist() == [5, 28]  # 1.25 · 0.004 V: 5.79 codes; 28.96


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
    assert summary["runs"] == scene.seeds * len(scene.conditions) >= 8 and summary["tightenings"] > 1000
