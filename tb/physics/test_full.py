"""``meissner run SCENE --full``: simulating everything beside a scene does not change the scene's results.

Space: in ``make test`` on fixed, scenes of every sensor by one run of their first condition; in
``make test-long`` on fixed and rtl, every scene by one run of each condition (a hand by two seconds). A first
pass runs them in order; then all other parts run in the same process,
and a second pass runs the scenes with ``--full`` in the reverse order: summary and result.npz are equal bit
for bit, except for times. Parts that leave changed state behind are detected.
"""

from dataclasses import replace

import numpy as np
import pytest

from meissner import run, scenes
from meissner.physics import rubber
from meissner.scenes import full

TIMES = ("seconds_taken", "samples_per_second", "saved")


def stretch(name, conditions=None):
    """One run of each condition of a scene, or of its first ``conditions``."""
    one = scenes.load(name)
    if getattr(one, "conditions", ()):
        one = replace(one, conditions=one.conditions[:conditions])
    if one.sensor == "hand":
        world = one.world | full.HAND
        return replace(one, seeds=1, world=world, conditions=(replace(one.conditions[0], duration_s=None),))
    return replace(one, seeds=1) if hasattr(one, "seeds") else one


def given(one, engine, out, compared=None):
    """The results of a run by name: the entries of its summary except times, and the bytes of its arrays."""
    summary = run.run(one, engine, out, compared=compared)
    found = {key: repr(value) for key, value in summary.items() if key not in TIMES}
    for name, array in np.load(out / "result.npz").items():
        found[f"result.npz {name}"] = array.dtype, array.shape, array.tobytes()
    return found


@pytest.fixture
def once(monkeypatch, undrawn):
    """No pictures, and each part of --full runs once, because no time is measured here."""
    monkeypatch.setattr(full, "_ms_per_s", lambda part: round(1e3 / part(), 3))


def changed(names, engine, folder, monkeypatch, everything=full.everything, conditions=None):
    """{scene: the results that --full changes}; runs its parts once for all scenes."""
    plain = {name: given(stretch(name, conditions), engine, folder / "plain") for name in names}
    parts = everything(engine)
    monkeypatch.setattr(full, "everything", lambda *_: parts)
    found = {}
    for name in reversed(names):
        one = stretch(name, conditions)
        whole = given(one, engine, folder / "full", run.full(one, engine))
        differ = {key for key in plain[name] | whole if plain[name].get(key) != whole.get(key)}
        if differ:
            found[name] = differ
    return found


# Scenes that take half a second or more; each sensor and feature is also in a scene that takes less, except
# the feature shear_speed.
LONG = {"capacitive_cell", "capacitive_shapes", "fsr_64x64", "shear_recover", "shear_speed"}


def test_everything_on_changes_no_short_scene_on_fixed(tmp_path, monkeypatch, once):
    names = [name for name in scenes.names() if name not in LONG]
    assert len(names) == 32 - len(LONG)
    assert {scenes.load(name).sensor for name in names} == set(full._OF)
    assert changed(names, "fixed", tmp_path, monkeypatch, conditions=1) == {}


@pytest.mark.long
@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_everything_on_changes_no_scene(tmp_path, monkeypatch, once, engine):
    names = scenes.names()
    assert len(names) == 32
    assert changed(names, engine, tmp_path, monkeypatch) == {}


def spoil_an_array():
    rubber._curve()[0].c[:] *= 1 + 2**-20


def spoil_a_constant():
    rubber.RING_S *= 2


def spoil_a_draw():
    """One shared generator for all."""
    np.random.default_rng = lambda *_, made=np.random.default_rng: made(3)


@pytest.mark.parametrize("leak", [spoil_an_array, spoil_a_constant, spoil_a_draw])
def test_a_part_that_leaves_something_behind_is_noticed(tmp_path, monkeypatch, once, leak):
    for module, name in ((rubber, "RING_S"), (np.random, "default_rng")):
        monkeypatch.setattr(module, name, getattr(module, name))  # restored at the end
    coefficients = rubber._curve()[0].c
    kept = coefficients.copy()

    def everything(engine):
        leak()
        return {"leaks": 1.0}

    try:
        found = changed(["cop_two_point", "acrylic_slip"], "fixed", tmp_path, monkeypatch, everything)
    finally:
        coefficients[:] = kept
    assert "acrylic_slip" in found and any("result.npz" in key for key in found["acrylic_slip"])
