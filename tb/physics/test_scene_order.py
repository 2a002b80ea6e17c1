"""A scene's results do not depend on what ran before it in the same process.

Space: on fixed, one scene of each sensor by one run of its first condition; in ``make test-long`` on fixed
and rtl every scene by one run of each condition (a hand by two seconds). The scenes run in order, then in
reverse order: summary and result.npz are equal bit for bit, except for times. Parts that leave changed state
behind are detected.
"""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from meissner import run, scenes
from meissner.physics import rubber
from meissner.scenes.sensor import sensors

TIMES = ("seconds_taken", "samples_per_second")
HAND = {"hold_from_s": 0.0, "poured_kg": 0.1, "pour_start_s": 0.0}
# Scenes that take half a second or more; each sensor is also in a scene that takes less.
LONG = {
    "rope_pull",
    "fingertip_hardness",
    "capacitive_cell",
    "capacitive_shapes",
    "fsr_64x64",
    "optacon_contact",
    "optacon_letter",
    "shear_recover",
    "shear_speed",
    "touch_to_touch",
}

pytestmark = pytest.mark.usefixtures("undrawn")


def results(name, engine, out, conditions):
    """By name: the entries of a run's summary except times, and the bytes of its arrays."""
    one = scenes.load(name)
    if getattr(one, "conditions", ()):
        one = replace(one, conditions=one.conditions[:conditions])
    if one.sensor == "hand":
        brief = (structs.replace(one.conditions[0], duration_s=2.0),)
        one = replace(one, world=one.world | HAND, conditions=brief)
    if hasattr(one, "seeds"):
        one = replace(one, seeds=1)
    summary = run.run(one, engine, out)
    found = {key: repr(value) for key, value in summary.items() if key not in TIMES}
    for array, values in np.load(out / "result.npz").items():
        found[f"result.npz {array}"] = values.dtype, values.shape, values.tobytes()
    return found


def changed(names, engine, out, conditions=1, between=lambda: None):
    """{scene: the results that differ in the second run}."""
    first = {name: results(name, engine, out, conditions) for name in names}
    between()
    found = {}
    for name in reversed([*names]):
        again = results(name, engine, out, conditions)
        differ = {key for key in first[name] | again if first[name].get(key) != again.get(key)}
        if differ:
            found[name] = differ
    return found


def test_no_short_scene_changes_another_on_fixed(tmp_path):
    names = {scenes.load(name).sensor: name for name in scenes.names() if name not in LONG}
    assert set(names) == set(sensors())
    assert changed(names.values(), "fixed", tmp_path) == {}


@pytest.mark.long
@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_no_scene_changes_another(tmp_path, engine):
    assert changed(scenes.names(), engine, tmp_path, None) == {}


def spoil_an_array():
    rubber._curve()[0].c[:] *= 1 + 2**-20


def spoil_a_constant():
    rubber.RING_S *= 2


def spoil_a_draw():
    """One shared generator for all."""
    np.random.default_rng = lambda *_, made=np.random.default_rng: made(3)


@pytest.mark.parametrize("leak", [spoil_an_array, spoil_a_constant, spoil_a_draw])
def test_a_part_that_leaves_something_behind_is_noticed(tmp_path, monkeypatch, leak):
    for module, name in ((rubber, "RING_S"), (np.random, "default_rng")):
        monkeypatch.setattr(module, name, getattr(module, name))  # restored at the end
    coefficients = rubber._curve()[0].c
    kept = coefficients.copy()
    try:
        found = changed(["cop_two_point", "acrylic_slip"], "fixed", tmp_path, between=leak)
    finally:
        coefficients[:] = kept
    assert "acrylic_slip" in found and any("result.npz" in key for key in found["acrylic_slip"])
