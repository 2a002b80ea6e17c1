"""Each metric of a scene of an array of taxels: which fault changes it, by how much, and which metrics that
fault leaves unchanged."""

import dataclasses

import numpy as np
import pytest
from msgspec import structs

from meissner import engines, run, scenes
from meissner.engines import fixed
from meissner.physics import patches

WALK = scenes.load("walk_25x5")
SCENE = dataclasses.replace(WALK, rate_hz=200)  # which gives 300 frames
METRICS = {"position_error", "load_error", "below_min_load", "over_range", "frames", "seconds_simulated"}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return run.run(SCENE, "fixed", tmp_path_factory.mktemp("sound"))


@pytest.fixture
def turned(tmp_path, sound):
    """The summary of another run, and the metrics that differ from the sound run's."""

    def again(scene=SCENE, engine="fixed"):
        found = run.run(scene, engine, tmp_path)
        return found, {key for key in METRICS if found[key] != sound[key]}

    return again


def taxels(monkeypatch, break_it):
    """Put ``break_it(codes)`` between the converter and the core; codes [frames, 25, 5]."""
    right = engines.process_cop
    monkeypatch.setattr(
        engines, "process_cop", lambda codes, *at: right(break_it(codes.copy()).astype(np.uint16), *at)
    )


def answers(monkeypatch, break_it, engine="fixed"):
    """Put ``break_it(arrays)`` after an engine."""
    right = engines.process_cop

    def broken(codes, name, *at):
        return break_it(dict(right(codes, "fixed", *at))) if name == engine else right(codes, name, *at)

    monkeypatch.setattr(engines, "process_cop", broken)


def test_a_shifted_centre(monkeypatch, turned, sound):
    """x and y shifted by 0.06 and -0.08 of the half range: 0.05 of the range."""

    def shift(found):
        dx, dy = (round(part * engines.COP_ONE) for part in (0.06, -0.08))
        return found | {"x": found["x"] + dx * found["valid"], "y": found["y"] + dy * found["valid"]}

    answers(monkeypatch, shift)
    found, which = turned()
    assert which == {"position_error"}
    assert found["position_error"]["mean"] == pytest.approx(0.05, abs=2e-4)


def test_a_wrong_gain(monkeypatch, turned, sound):
    """Sums an eighth too small: the load is low by an eighth, the position is unchanged."""
    answers(monkeypatch, lambda found: found | {"sum": found["sum"] * 7 // 8})
    found, which = turned()
    assert which == {"load_error"}
    assert found["load_error"]["mean"] == pytest.approx(0.125, abs=1e-3)


def test_a_wrong_sign(monkeypatch, turned):
    """Columns read from right to left: x has the wrong sign, which is up to 2 * 0.36 / 2 of the range; the
    load is unaffected."""
    taxels(monkeypatch, lambda codes: codes[:, :, ::-1])
    found, which = turned()
    assert which == {"position_error"}
    assert 0.25 < found["position_error"]["maximum"] < 0.4


def test_a_dead_column_of_taxels(monkeypatch, turned, sound):
    """The patch passes over the middle column. With that column dead, load is lost, and the centre is wrong
    on the way, by as much on one side as on the other."""

    def dead(codes):
        codes[:, :, 2] = 0
        return codes

    taxels(monkeypatch, dead)
    found, which = turned()
    assert {"position_error", "load_error"} <= which <= {"position_error", "load_error", "below_min_load"}
    assert found["load_error"]["mean"] > 0.15 > 100 * sound["load_error"]["mean"]
    assert found["position_error"]["mean"] > 20 * sound["position_error"]["mean"]


def test_a_stuck_taxel(monkeypatch, turned, sound):
    """One corner always reads the converter's full scale, 2 N: every load is 2 N too large."""

    def stuck(codes):
        codes[:, 0, 0] = 4095
        return codes

    taxels(monkeypatch, stuck)
    found, which = turned()
    assert which >= {"position_error", "load_error"}
    assert found["load_error"]["maximum"] > 1 and found["position_error"]["mean"] > 0.05


def test_a_louder_converter(turned, sound):
    """White noise of 16 codes in place of a quarter of a code: both errors grow, the over-range count does
    not."""
    loud = dataclasses.replace(SCENE, converter=structs.replace(SCENE.converter, noise_lsb=16.0))
    found, which = turned(loud)
    assert {"position_error", "load_error"} <= which <= {"position_error", "load_error", "below_min_load"}
    assert found["position_error"]["mean"] > 5 * sound["position_error"]["mean"]


def test_a_range_too_small(turned, sound):
    """Taxels of 0.25 N under up to 8 N: the over-range taxels are counted, and their excess load is lost."""
    small = dataclasses.replace(SCENE, converter=structs.replace(SCENE.converter, full_scale_n=0.25))
    found, which = turned(small)
    assert (
        found["over_range"] == (over := int((true_forces() > 0.25 * (1 + 0.5 / 4095)).sum())) and over > 100
    )
    assert {"over_range", "load_error", "position_error"} <= which


def test_a_range_too_small_is_counted_in_every_piece():
    """9000 frames, more than are simulated in one piece."""
    small = structs.replace(SCENE.converter, full_scale_n=0.25, noise_lsb=0.0)
    recording = scenes.simulate(dataclasses.replace(SCENE, rate_hz=6000, converter=small))
    assert recording.over_range == (true_forces(9000) > 0.25 * (1 + 0.5 / 4095)).sum() > 3000


def true_forces(frames=300):
    phase = np.arange(frames) / frames
    return patches.forces(25, 5, SCENE.world["patches"], phase, SCENE.world["depth_pitches"])


def test_a_least_load_too_large(turned, sound):
    """4 N in place of 0.2 N: frames with less have no position; they are counted from the true force."""
    total = true_forces().sum((1, 2))
    lsb_n = 2.0 / 4095
    assert sound["below_min_load"] == ((total > 0) & (total < 400 * lsb_n)).sum()
    found, which = turned(dataclasses.replace(SCENE, min_load=round(4 / lsb_n)))
    assert which >= {"below_min_load"} and "over_range" not in which
    assert found["below_min_load"] == pytest.approx(((total > 0) & (total < 4)).sum(), abs=1)
    assert found["below_min_load"] > 10 + sound["below_min_load"]


def test_half_the_frames(turned):
    found, which = turned(dataclasses.replace(SCENE, rate_hz=100))
    assert which >= {"frames"} and found["frames"] == 150 and found["seconds_simulated"] == 1.5


def test_a_core_that_differs_from_its_twin(monkeypatch, turned):
    """One frame with a wrong x and sum and another with a wrong sum count as two frames."""
    answers(monkeypatch, lambda found: found, "rtl")
    assert turned(engine="rtl")[0]["twin_mismatches"] == 0

    def spoil(found):
        at = np.arange(len(found["x"]))
        return found | {"x": found["x"] + (at == 100), "sum": found["sum"] + ((at == 120) | (at == 100))}

    answers(monkeypatch, spoil, "rtl")
    assert turned(engine="rtl")[0]["twin_mismatches"] == 2 and callable(fixed.cop4)
