"""The scenes of the centre of pressure: every one loads and runs; the simulated forces against plain sums and
the published experiments; the summary against an independent computation; the messages for mistakes in a
scene."""

import json
import tomllib

import numpy as np
import pytest

from meissner import engines, run, scenes
from meissner.physics import mesh_loads, patches, plantar
from meissner.physics.mesh import Mesh
from meissner.scenes.array import scene as array_scene
from meissner.scenes.errors import errors, summarise
from meissner.scenes.mesh import scene as mesh_scene
from meissner.scenes.mesh.run import circle

ARRAYS, MESHES = scenes.names("array"), scenes.names("mesh")
COMMON = (
    "scene engine seed seconds_simulated seconds_taken samples_per_second twin_mismatches modelled left_out"
)


def centre(frames):
    """Sum, x, y of [frames, rows, columns] in plain float sums."""
    rows, columns = frames.shape[1:]
    frames = frames.astype(float)
    total = frames.sum((1, 2))
    x = (frames * np.linspace(-1, 1, columns)).sum((1, 2)) / total
    y = (frames * np.linspace(1, -1, rows)[:, None]).sum((1, 2)) / total
    return total, x, y


@pytest.mark.parametrize("name", ARRAYS)
def test_an_array_scene_presses_where_it_says(name):
    scene = scenes.load(name)
    assert "\n" not in scene.title and len(scene.title) < 100
    recording = scenes.simulate(scene, seed=3)
    codes = recording.codes
    assert codes.dtype == np.uint16 and codes.shape[1:] == (scene.rows, scene.columns)
    assert len(codes) == len(recording.time_s) == len(recording.load)
    assert recording.over_range == 0
    assert set(recording.modelled) | set(recording.left_out) == set(array_scene.COMPONENTS)
    pressed = recording.load > 0.05 * recording.load.max()
    load, x, y = centre(codes[pressed])
    assert load * scene.load_lsb == pytest.approx(recording.load[pressed], rel=0.01)
    assert np.hypot(x - recording.x[pressed], y - recording.y[pressed]).max() < 0.01


def test_an_array_scene_is_seeded():
    scene = scenes.load("walk_25x5")
    first, again, other = (scenes.simulate(scene, seed=seed).codes for seed in (5, 5, 6))
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_a_patch_goes_around_a_circle():
    phase = np.linspace(0, 1, 100)
    patch = {"path": "circle", "centre": (0, 0), "radius": 0.6, "turns": 1, "force_n": 5.0}
    load, x, y = mesh_loads.true_centre(patches.forces(16, 16, [patch | {"profile": "steady"}], phase, 1.5))
    # A little less than 0.6, because the cover spreads force to the other side of the array.
    radius = np.hypot(x, y)
    assert radius.min() > 0.5 and radius.max() < 0.6 and np.ptp(radius) < 0.03
    assert load == pytest.approx(5.0)


def test_a_known_circle_is_found():
    angle = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    found = circle(0.3 + 2 * np.cos(angle), -0.1 + 2 * np.sin(angle))
    assert found == pytest.approx(
        {"centre_x": 0.3, "centre_y": -0.1, "radius": 2, "deviation": 0, "roundness": 0}
    )
    square = circle([2, 0, -2, 0, 1, -1], [0, 2, 0, -2, 1, -1])
    assert square["roundness"] > 0.3 and square["deviation"] > 0.2
    with pytest.raises(ValueError, match="three points"):
        circle([0, 1, 2], [0, 1, 2])


def test_the_walk_goes_from_end_to_end_with_two_humps():
    recording = scenes.simulate(scenes.load("walk_25x5"))
    seen = recording.load > 0.1
    assert (np.diff(recording.y[seen]) > 0).all()
    assert recording.y[seen][0] < -0.8 and recording.y[seen][-1] > 0.8
    rising = np.diff(recording.load) > 0
    assert np.count_nonzero(np.diff(rising.astype(int))) == 3  # up, down, up, down
    assert recording.load.max() == pytest.approx(8, rel=1e-3)


def test_patches_add_up():
    phase = np.linspace(0, 1, 5)
    circle = {"path": "circle", "centre": (0, 0), "radius": 0.5, "turns": 1, "force_n": 2.0}
    hold = {"path": "hold", "at": (0.5, -0.5), "force_n": 3.0, "profile": "press"}
    every = [circle | {"profile": "steady"}, hold]
    force = patches.forces(9, 7, every, phase, 1.0)
    assert force.shape == (5, 9, 7) and force.min() >= 0
    assert force.sum((1, 2)) == pytest.approx(2 + 3 * np.sin(np.pi * phase))
    assert np.allclose(force, sum(patches.forces(9, 7, [one], phase, 1.0) for one in every))
    assert max(shape(phase).max() for shape in patches.PROFILES.values()) <= 1 + 1e-12


def test_a_recorded_step_goes_from_heel_to_toe():
    frames = plantar.step(0, 1)
    assert frames.dtype == np.uint16 and frames.shape[1:] == (63, 33)
    assert frames[1].any() and frames[-2].any() and not frames[-1].any()
    load, _, y = centre(frames[20:-20])
    assert load.min() > 0
    assert y[0] > 0.5 and y[-1] < -0.5
    assert (np.diff(y[::10]) < 0).all()  # every 20 ms, as single frames tremble


def test_the_data_are_asked_for_when_absent(monkeypatch):
    monkeypatch.setattr(plantar, "find_spec", lambda _: None)
    with pytest.raises(ValueError, match=r"\[recordings\]"):
        scenes.simulate(scenes.load("plantar_step"))


@pytest.mark.parametrize("name", ["walk_25x5", "plantar_step"])
@pytest.mark.parametrize("engine", engines.NAMES)
def test_run_an_array_scene(tmp_path, name, engine, request):
    if engine != "fixed":
        request.getfixturevalue("undrawn")
    scene = scenes.load(name)
    summary = run.run(scene, engine, tmp_path, seed=2)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert set(COMMON.split()) <= set(summary)
    assert summary["twin_mismatches"] == (0 if engine == "rtl" else None)
    result = np.load(tmp_path / "result.npz")
    recording = scenes.simulate(scene, 2)
    assert np.array_equal(result["codes"], recording.codes)
    valid = result["valid"]
    assert np.array_equal(valid, recording.codes.sum((1, 2)) >= scene.min_load)
    load, x, y = centre(recording.codes[valid])
    assert np.array_equal(result["sum"][valid], load)
    assert np.abs(result["x"][valid] / 16384 - x).max() < 2**-14
    assert np.abs(result["y"][valid] / 16384 - y).max() < 2**-14
    distance = np.hypot(x - recording.x[valid], y - recording.y[valid]) / 2
    assert summary["position_error"]["mean"] == pytest.approx(distance.mean(), abs=2e-5)
    assert summary["position_error"]["maximum"] == pytest.approx(distance.max(), abs=1e-4)
    of_load = np.abs(load * scene.load_lsb / recording.load[valid] - 1)
    assert summary["load_error"] == pytest.approx({"maximum": of_load.max(), "mean": of_load.mean()})
    assert summary["position_error"]["mean"] < 5e-4
    assert engine != "fixed" or (tmp_path / f"{name}.png").stat().st_size > 30_000
    assert "data:image/png" in (tmp_path / "report.html").read_text()
    assert all(isinstance(line, str) for line in run.tell(scene, summary))


@pytest.mark.parametrize("name", ["dense_64", "dense_1024"])
def test_fixed_equals_rtl_on_dense_scenes(name):
    scene = scenes.load(name)
    codes = scenes.simulate(scene, 1).codes[:40:10]
    ours, theirs = (engines.process_cop(codes, engine, scene.min_load) for engine in ("fixed", "rtl"))
    assert all(np.array_equal(ours[field], theirs[field]) for field in ours)
    assert ours["valid"].all()


def test_errors_are_against_what_presses():
    position, load = errors(
        x=np.array([0.5, 0.5, 0, 0.3]),
        y=np.array([0, 0.2, 0, 0.3]),
        load=np.array([9.0, 11, 1, 5]),
        valid=np.array([True, True, True, False]),
        true_load=np.array([10.0, 10, 0, 10]),
        true_x=np.array([0.5, 0.5, 0, 0]),
        true_y=np.array([0, 0, 0, 0]),
    )
    assert position == pytest.approx([0, 0.1, np.nan, np.nan], nan_ok=True)
    assert load == pytest.approx([0.1, 0.1, np.nan, 0.5], nan_ok=True)
    assert summarise(position) == pytest.approx({"maximum": 0.1, "mean": 0.05})
    assert summarise(np.array([np.nan])) is None


def test_mesh_scenes_are_the_published_experiments():
    for name in ("cop_two_point", "cop_load", "cop_one_point", "cop_circle"):
        published = getattr(mesh_loads, name)() if name != "cop_circle" else mesh_loads.cop_stroke(steps=720)
        scene = scenes.load(name)
        true, felt = mesh_scene.loads(scene)
        assert np.array_equal(true, published.load) and np.array_equal(felt, published.load)
        assert repr(scene.mesh(scene.r_ohm[0])) == repr(published.mesh)
    scene = scenes.load("cop_six_random")
    assert scene.r_ohm == mesh_loads.SIX_R and scene.world["totals_n"] == mesh_loads.SIX_TOTALS
    true = mesh_scene.loads(scene, 4)[0].reshape(4, 100, 41, 41)
    for total, loads in zip(mesh_loads.SIX_TOTALS, true):
        assert np.array_equal(loads, mesh_loads.cop_six_random(10.0, total, seed=4).load)


def test_the_float_engine_s_formula_is_the_mesh_s():
    load = np.concatenate([mesh_loads.cop_six_random(10.0, 20.0, 20).load, np.zeros((1, 41, 41))])
    solution = Mesh(41, 41, 10.0).solve(load)
    x, y, newtons, valid = engines.load("float").cop4_of_volts(solution)
    assert valid.tolist() == [True] * 20 + [False]
    assert np.abs(x - solution.x).max() < 1e-9 and np.abs(y - solution.y).max() < 1e-9
    assert newtons == pytest.approx(solution.load, rel=1e-9)


@pytest.mark.parametrize("name", MESHES)
def test_run_a_mesh_scene(tmp_path, name):
    scene = scenes.load(name)
    summary = run.run(scene, "float", tmp_path, seed=1)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert set(COMMON.split()) <= set(summary)
    assert summary["twin_mismatches"] is None
    assert set(summary["modelled"]) | set(summary["left_out"]) == set(mesh_scene.COMPONENTS)
    assert summary["left_out"][0] == "converter"
    assert summary["load_error"]["maximum"] >= summary["load_error"]["mean"] > 0.001
    assert (tmp_path / f"{name}.png").stat().st_size > 20_000
    rows = {(row["r_ohm"], row.get("total_n")): row for row in summary["conditions"]}
    solver, solutions = summary["solver"], [one.solution for one in scenes.simulate(scene, 1)]
    assert solver["position"] == max(max(s.bound.x.max(), s.bound.y.max()) for s in solutions) / 2 < 1e-9
    pressed = [(s.bound.load / np.where(s.load > 0, s.load, 1)).max() for s in solutions]
    assert solver["load"] == pytest.approx(max(pressed), rel=1e-12) and 0 < solver["load"] < 1e-9
    assert solver["condition"] == max(s.condition.max() for s in solutions) >= 1
    assert "condition number at most" in "\n".join(run.tell(scene, summary))
    if name == "cop_load":  # figure 11: 17.23 N of 20
        load = np.load(tmp_path / "result.npz")["load"]
        assert load[10] == pytest.approx(9.26, abs=0.01) and load[20] == pytest.approx(17.23, abs=0.01)
    if name == "cop_two_point":  # figure 10: on the straight line
        result = np.load(tmp_path / "result.npz")
        assert np.abs(result["x"] - result["y"]).max() < 1e-9
    if name == "cop_six_random":  # figures 8 and 9: within 0.5 % and about 2 %
        row = rows[10.0, 20.0]
        assert row["position_error_maximum"] < 0.005 and 0.017 < row["load_error_mean"] < 0.022
        assert len(rows) == 16
    if name == "cop_impulse":
        assert summary["response_s"] == pytest.approx(0.6e-3, abs=5e-5)
        assert summary["position_error"]["maximum"] < 1e-9
        assert summary["load_error_without_lag"]["maximum"] < 0.02 < summary["load_error"]["maximum"]
        assert summary["position_response_s"] == pytest.approx(5e-5)  # the first sample with a load
    if name == "cop_impulse_place":
        # After tau ln(1/(1-f)), tau = 0.2 ms, a share f of 5 N has built up and the centre is f/(f + 0.45/5)
        # of the way; it reaches 95 % of its end, 1/1.09, at f = 0.611, which is after 0.189 ms.
        assert summary["position_response_s"] == pytest.approx(0.19e-3, abs=1.1e-5)
        assert summary["response_s"] == pytest.approx(0.6e-3, abs=2e-5)
    if name == "cop_circle":  # figures 14 and 15: a neat locus
        assert summary["locus"]["roundness"] < 1e-3 and summary["locus"]["radius"] == pytest.approx(
            1 / 3, 1e-3
        )
        assert "a circle of radius 0.3333" in "\n".join(run.tell(scene, summary))


# The largest error that the converter and Q2.14 add to a position (of the range) and to a load.
GRAIN = {
    "cop_two_point": (2e-4, 2e-4),
    "cop_load": (4e-4, 2e-3),
    "cop_six_random": (1e-3, 5e-4),
    "cop_one_point": (1e-3, 5e-4),
    "cop_impulse": (2e-3, 5e-3),
    "cop_impulse_place": (4e-4, 1e-3),
    "cop_circle": (4e-4, 5e-4),
}


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_run_a_mesh_scene_on_the_core(tmp_path, undrawn, name, engine):
    """The result is within the converter's error of the exact voltages; the core's words equal the twin's."""
    scene = scenes.load(name)
    summary = run.run(scene, engine, tmp_path, seed=1)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert summary["twin_mismatches"] == (0 if engine == "rtl" else None)
    assert summary["modelled"][2] == "converter" and "converter" not in summary["left_out"]
    assert set(summary["modelled"]) | set(summary["left_out"]) == set(mesh_scene.COMPONENTS)
    if name == "cop_impulse":
        assert summary["response_s"] == pytest.approx(0.6e-3, abs=5e-5)
        assert summary["load_error_without_lag"]["maximum"] < 0.02 < summary["load_error"]["maximum"]
    result = np.load(tmp_path / "result.npz")
    for recording in scenes.simulate(scene, 1):
        prefix = f"r{recording.r_ohm:g}_" if len(scene.r_ohm) > 1 else ""
        twin = engines.load("fixed").cop4(recording.codes, recording.config)
        assert np.array_equal(result[prefix + "codes"], recording.codes)
        assert np.array_equal(result[prefix + "valid"], twin.pressed)
        assert np.array_equal(result[prefix + "x"], twin.x / 16384)
        assert np.array_equal(result[prefix + "load"], twin.load * 1e-3)
        assert twin.pressed.sum() == (recording.felt_n >= 0.05).sum()
        x, y, load, _ = engines.load("float").cop4_of_volts(recording.solution)
        grain, of_load = GRAIN[name]
        valid = twin.pressed & (recording.felt_n > 0.5)
        away = np.hypot(twin.x / 16384 - x, twin.y / 16384 - y)[valid] / 2
        assert away.max() < grain and np.abs(twin.load[valid] * 1e-3 / load[valid] - 1).max() < of_load


def test_the_seed_draws_the_converter_s_noise():
    scene = scenes.load("cop_load")
    one, again, other = (scenes.simulate(scene, seed)[0].codes for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert 0 < np.abs(one - other).max() < 20


def test_every_difference_from_the_twin_counts(tmp_path, undrawn, monkeypatch):
    module = engines.load("rtl")
    right = module.cop4

    def spoiled(codes, config):
        got = right(codes, config)
        return got._replace(load=got.load + (np.arange(len(got.load)) == 3), open=got.open ^ (got.x == 0))

    scene = scenes.load("cop_circle")
    twin = engines.load("fixed").cop4(scenes.simulate(scene, 1)[0].codes, scene.configs[0])
    monkeypatch.setattr(module, "cop4", spoiled)
    expected = len({3, *np.flatnonzero(twin.x == 0).tolist()})
    assert run.run(scene, "rtl", tmp_path)["twin_mismatches"] == expected >= 1


def test_the_pulse_is_a_first_order_answer():
    scene = scenes.load("cop_impulse")
    _, felt = mesh_scene.loads(scene)
    felt, tau = felt.sum((1, 2)), scene.world["response_s"] / mesh_scene.SETTLED
    level, dt = 0.0, 1 / scene.rate_hz
    for k, got in enumerate(felt):
        assert got == pytest.approx(level, abs=1e-9)
        pressing = 0.002 - 1e-9 <= k * dt < 0.007 - 1e-9
        level += (5.0 * pressing - level) * -np.expm1(-dt / tau)


def change(name, path, value):
    changed = place = tomllib.loads(scenes.source(name))
    for key in path[:-1]:
        place = place[key]
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return changed
