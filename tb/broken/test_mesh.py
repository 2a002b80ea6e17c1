"""Each metric of a scene of the four-wire mesh: which fault changes it, by how much, and which metrics that
fault leaves unchanged."""

import dataclasses
import math

import numpy as np
import pytest

from meissner import engines, run, scenes
from meissner.physics.mesh import contacts, groups
from meissner.scenes.mesh import run as mesh_run

NAMES = ("cop_two_point", "cop_load", "cop_circle", "cop_impulse_place")
METRICS = {"position_error", "load_error", "solver"}
OF = {
    "cop_circle": {"locus"},
    "cop_impulse_place": {"load_error_without_lag", "response_s", "position_response_s"},
}


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sound")
    return {name: run.run(scenes.load(name), "fixed", folder / name) for name in NAMES}


@pytest.fixture
def turned(tmp_path, sound):
    """The summary of another run, and the metrics that differ from the sound run's."""

    def again(name, scene=None, engine="fixed"):
        found = run.run(scene or scenes.load(name), engine, tmp_path)
        metrics = METRICS | OF.get(name, set())
        return found, {key for key in metrics if found[key] != sound[name][key]}

    return again


def behind(monkeypatch, break_it, engine="fixed"):
    """Put ``break_it(Cop4)`` after the core."""
    right = engines.load("fixed").cop4
    monkeypatch.setattr(engines.load(engine), "cop4", lambda *both: break_it(right(*both)))


def before(monkeypatch, break_it):
    """Put ``break_it(codes)`` between the converter and the core."""
    right = engines.load("fixed").cop4
    monkeypatch.setattr(engines.load("fixed"), "cop4", lambda codes, config: right(break_it(codes), config))


def test_a_shifted_centre(monkeypatch, turned, sound):
    """x shifted by 0.04 of the half range: 0.02 of the range, where errors were below 0.0005; a circle's
    centre moves by 0.04."""
    behind(monkeypatch, lambda got: got._replace(x=got.x + round(0.04 * engines.COP_ONE)))
    found, which = turned("cop_load")
    assert which == {"position_error"}
    assert found["position_error"]["mean"] == pytest.approx(0.02, abs=5e-4)
    assert found["conditions"][0]["position_error_mean"] == pytest.approx(0.02, abs=5e-4)
    found, which = turned("cop_circle")
    assert which == {"position_error", "locus"}
    locus, was = found["locus"], sound["cop_circle"]["locus"]
    assert locus["centre_x"] - was["centre_x"] == pytest.approx(0.04, abs=1e-4)
    for key in ("centre_y", "radius", "deviation", "roundness"):
        assert locus[key] == pytest.approx(was[key], abs=1e-9), key


def test_a_wrong_gain_of_one_coordinate(monkeypatch, turned, sound):
    """x a fifth too far out: an ellipse of half axes 1.2 and 1, whose mean distance, twice the complete
    integral of sqrt(1.44 cos^2 + sin^2) over pi, is 1.1018; so it is 0.2/1.1018 out of round, and the
    centre's y is unchanged."""
    behind(monkeypatch, lambda got: got._replace(x=got.x * 6 // 5))
    found, which = turned("cop_circle")
    assert which == {"position_error", "locus"}
    at = np.deg2rad(np.arange(0.25, 360, 0.5))
    mean = np.hypot(1.2 * np.cos(at), np.sin(at)).mean()
    locus, was = found["locus"], sound["cop_circle"]["locus"]
    assert locus["radius"] == pytest.approx(was["radius"] * mean, rel=1e-3)
    assert locus["roundness"] == pytest.approx(0.2 / mean, rel=2e-2) and was["roundness"] < 3e-3
    assert locus["deviation"] == pytest.approx(was["radius"] * 0.2 / math.sqrt(8), rel=2e-2)


def test_exchanged_wires(monkeypatch, turned, sound):
    """E1 and E3 exchanged: x has the wrong sign, so from corner to corner the error is |x| of the range. The
    load, a sum of both, is unchanged. A circle stays a circle with its points elsewhere on it."""
    before(monkeypatch, lambda codes: codes[:, [2, 1, 0, 3]])
    found, which = turned("cop_two_point")
    assert which == {"position_error"}
    assert found["position_error"]["maximum"] == pytest.approx(1, abs=1e-3)
    assert found["position_error"]["mean"] == pytest.approx(
        6 / 11, abs=0.02
    )  # mean of |x| = 0, 0.2 twice, ... 1 twice
    found, _ = turned("cop_circle")
    assert found["locus"]["radius"] == pytest.approx(sound["cop_circle"]["locus"]["radius"], rel=1e-3)
    assert found["position_error"]["maximum"] > 0.3


def test_a_wrong_gain_of_the_load(monkeypatch, turned, sound):
    """An eighth too little. Two equal loads were reported up to 13.9 % low; now 1 - 0.875 (1 - 0.139)."""
    behind(monkeypatch, lambda got: got._replace(load=got.load * 7 // 8))
    found, which = turned("cop_load")
    assert which == {"load_error"}
    was = sound["cop_load"]["load_error"]["maximum"]
    assert found["load_error"]["maximum"] == pytest.approx(1 - 0.875 * (1 - was), abs=1e-4)
    row, was = found["conditions"][0], sound["cop_load"]["conditions"][0]["load_error_mean"]
    assert row["load_error_mean"] == pytest.approx(1 - 0.875 * (1 - was), abs=3e-4)
    found, which = turned("cop_impulse_place")
    assert which == {"load_error", "load_error_without_lag"}  # the times refer to shares of the rise


def test_a_dead_channel(monkeypatch, turned):
    """E3 stays at its rail: the core sees an open electrode, and there is no position."""

    def dead(codes):
        codes = codes.copy()
        codes[:, 2] = round(15 * 0.3 / 5 * 2**23)
        return codes

    before(monkeypatch, dead)
    found, which = turned("cop_two_point")
    assert which == {"position_error", "load_error"}
    assert found["position_error"] is None and found["load_error"]["mean"] > 0.9


def test_a_slower_rubber(turned):
    """Three time constants of 0.4 ms in place of 0.2 ms; the position takes 0.944 of one (see the scene)."""
    scene = scenes.load("cop_impulse_place")
    scene = dataclasses.replace(scene, world=scene.world | {"response_s": 0.0012})
    found, which = turned("cop_impulse_place", scene)
    assert which >= {"response_s", "position_response_s", "load_error", "position_error"}
    assert found["response_s"] == pytest.approx(1.2e-3, abs=3e-5)
    assert found["position_response_s"] == pytest.approx(0.4e-3 * 0.9437, abs=1.1e-5)


def test_a_late_core_turns_both_times_by_as_much(monkeypatch, turned, sound):
    """Every output is delayed by 0.1 ms."""

    def late(values):
        return np.concatenate([values[:1].repeat(10), values[:-10]])

    behind(monkeypatch, lambda got: type(got)(*map(late, got)))
    found, _ = turned("cop_impulse_place")
    for key in ("response_s", "position_response_s"):
        assert found[key] == pytest.approx(sound["cop_impulse_place"][key] + 1e-4, abs=1e-9), key


def test_more_conductance_at_rest_delays_the_position(turned):
    """1 N on nine taxels beside 5 N: 95 % of the way at f = 0.76 of the force, after 1.427 time constants."""
    scene = scenes.load("cop_impulse_place")
    scene = dataclasses.replace(scene, world=scene.world | {"rest_n": 1 / 9})
    found, which = turned("cop_impulse_place", scene)
    assert "position_response_s" in which
    assert found["position_response_s"] == pytest.approx(0.2e-3 * 1.427, abs=1.1e-5)
    assert found["position_error"]["mean"] > 0.08  # the rest pulls it towards the middle permanently


def test_wrong_currents_show_in_the_solver_s_bounds(monkeypatch, turned, sound):
    """Contact currents a millionth too high: the bounds, computed from the equations alone, must show it."""
    right = contacts.solve
    monkeypatch.setattr(groups.contacts, "solve", lambda *at: right(*at) * (1 + 1e-6))
    found, which = turned("cop_circle")
    assert "solver" in which and sound["cop_circle"]["solver"]["load"] < 1e-12
    assert 1e-6 <= found["solver"]["load"] < 1e-4 and found["solver"]["position"] > 1e-8


def test_a_mesh_of_poor_wires_shows_in_the_condition(turned, sound):
    scene = scenes.load("cop_circle")
    r_ohm, config = 47e3, scene.configs[0]
    mesh = type(config.mesh)(3, 3, r_ohm, 10e3, 15.0, 4320.0)
    scene = dataclasses.replace(scene, r_ohm=(r_ohm,), configs=(dataclasses.replace(config, mesh=mesh),))
    found, which = turned("cop_circle", scene)
    assert which == METRICS | {"locus"}
    assert found["solver"]["condition"] > 3 * sound["cop_circle"]["solver"]["condition"]


def test_a_core_that_differs_from_its_twin(monkeypatch, turned):
    behind(monkeypatch, lambda got: got, "rtl")
    assert turned("cop_load", engine="rtl")[0]["twin_mismatches"] == 0
    behind(monkeypatch, lambda got: got._replace(load=got.load + (np.arange(len(got.load)) % 7 == 3)), "rtl")
    assert turned("cop_load", engine="rtl")[0]["twin_mismatches"] == 3


def test_where_the_position_settles_by_hand():
    """At 1 kHz, pressed from sample 5 to 14: the position goes 0, 1, 3.9, 3.7, 4, 3.81, 4, ...; 5 % of 4 is
    0.2."""
    x = np.zeros(20)
    x[5:15] = [1, 3.9, 3.7, 4, 3.81, 4, 4, 4, 4, 4]
    world = {"start_s": 0.005, "pulse_s": 0.010}
    recording = type("R", (), {"scene": type("S", (), {"world": world, "rate_hz": 1000})})
    assert mesh_run._position_response_s(recording, x, np.zeros(20)) == pytest.approx(0.003)
    x[5:15] = 4
    assert mesh_run._position_response_s(recording, x, np.zeros(20)) == pytest.approx(0)
