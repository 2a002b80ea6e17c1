"""The object held on the four-wire sensor: the published fall, rise and move of a slip follow from the
published rubber; forces balance; the effect of a grip alone; the scene against its own ground truth; mistakes
in a scene."""

import dataclasses
import tomllib

import numpy as np
import pytest

from meissner import scenes
from meissner.builds import config as builds
from meissner.physics import grip, plate, rubber
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh_loads import true_centre
from meissner.scenes.grip import scene as grip_scene
from meissner.scenes.grip.scene import Grip, Pull
from meissner.scenes.mesh.scene import electrodes
from meissner.twins.cop.cop4 import cop4

TIME_S = np.arange(1000) / 1000
LEVELS = [(0.0, 0.1, 2.0)]


def pulled(speed=100.0, newtons=2.0, wire=0.2, seed=1, material="acrylic"):
    rest = grip.ramps(TIME_S, [(0.0, 0.1, newtons)])
    return grip.pulled(TIME_S, rest, 0.3, speed, material, wire, np.random.default_rng(seed))


def before(held):
    """The samples from the onset to the last one before the object moves."""
    return slice(300, int(np.ceil(held.gross_s * 1000)))


def test_ramps_pass_through_their_levels():
    force = grip.ramps(TIME_S, [(0.1, 0.2, 3.0), (0.5, 0.1, 1.0), (0.8, 0.1, 0.0)])
    assert force[:101].max() == 0 and force[200] == pytest.approx(1.5)
    assert (force[300:501] == 3).all() and force[550] == pytest.approx(2.0) and (force[600:801] == 1).all()
    assert np.abs(force[900:]).max() < 1e-12 and np.abs(np.diff(force)).max() < 0.04


def test_the_published_slip():
    """2 N at 100 mm/s: two sensors' load outputs fall by 1.0 and 1.3 N, the grip rises by 0.2 N."""
    held = pulled()
    part = before(held)
    fall = 1 - held.felt_n[part].min() / held.felt_n[290]
    assert 0.5 <= fall <= 0.65
    assert np.ptp(held.grip_n[part]) == pytest.approx(0.2, rel=0.05)
    assert (np.diff(held.grip_n[part]) > 0).all()
    volts = held.move_mm[part][-1] / 10 * grip.FULL_SCALE_V  # 20 mm wide
    assert volts == pytest.approx(0.05, rel=0.1)


def test_the_fall_is_the_published_divider_s():
    """The conductance left at 2 N: the divider's volts before, and with k·v^n of the shear added, by hand."""
    speed = 1.7
    rest = rubber.rest_volts(np.array([2.0]))[0]
    sheared = rest + (1.55 - 0.27 * rest) * speed**0.11
    wanted = (5 / sheared - 1) / (5 / rest - 1)
    assert grip.share(np.array([2.0]), np.array([speed**0.11])) == pytest.approx(wanted)
    assert grip.share(np.array([0.0, 1.0]), np.array([1.0, 0.0])).tolist() == [1.0, pytest.approx(1.0)]


def test_nothing_happens_before_the_onset():
    held = pulled()
    assert held.felt_n[:301] == pytest.approx(held.grip_n[:301])
    assert held.felt_n[301] < 0.9 * held.grip_n[301]
    assert not held.move_mm[:301].any() and not held.tension_n[:301].any() and held.onset_s == 0.3
    assert not held.slip_mm[held.gross_s > TIME_S].any() and held.slip_mm[-1] > 10


def test_the_pull_ends_at_friction():
    for newtons, material in ((1.0, "paper"), (3.0, "acrylic")):
        held = pulled(newtons=newtons, material=material)
        limit = plate.MATERIALS[material].mu_s * newtons
        assert held.tension_n.max() == pytest.approx(limit, rel=0.15)
        assert held.gross_s - 0.3 == pytest.approx(limit / 20, rel=0.15)
        assert held.move_mm.max() == pytest.approx(
            grip.LEVER_MM * plate.MATERIALS[material].mu_s / 1.1, rel=0.15
        )


def test_a_cover_lengthens_the_lever():
    """0.2 and 0.6 mm of silicone on a lever of 0.2 mm: the move is twice and four times as far; nothing else
    changes."""
    bare = pulled()
    for cover_mm, times in ((0.2, 2), (0.6, 4)):
        rest = grip.ramps(TIME_S, [(0.0, 0.1, 2.0)])
        rng = np.random.default_rng(1)
        held = grip.pulled(TIME_S, rest, 0.3, 100.0, "acrylic", 0.2, rng, cover_mm=cover_mm)
        assert held.move_mm == pytest.approx(times * bare.move_mm)
        assert np.array_equal(held.felt_n, bare.felt_n) and held.gross_s == bare.gross_s


def test_the_second_sensor_sees_the_same_pull_from_the_other_side():
    assert [grip.mirrored(way) for way in (0, 90, 220)] == [180, 90, -40]
    scene = scenes.load("cop_slip")
    for condition in (scene.conditions[0], scene.conditions[2], scene.conditions[-1]):
        one, other = (scenes.simulate(scene, condition, 3, side=side) for side in (0, 1))
        assert np.array_equal(one.held.felt_n, other.held.felt_n) and one.held.gross_s == other.held.gross_s
        assert np.abs(one.x[200] - other.x[200]) > 0.01 and np.abs(one.codes - other.codes).max() > 100
        assert one.condition is condition
    one, other = (scenes.simulate(scene, scene.conditions[0], 3, side=side) for side in (0, 1))
    gross = int(one.held.gross_s * 1000)
    assert one.x[gross] - one.x[295] == pytest.approx(-(other.x[gross] - other.x[295]), rel=0.2)
    assert other.condition.direction_deg == 180


def test_a_stiffer_wire_slips_sooner():
    assert pulled(wire=0.4).gross_s - 0.3 == pytest.approx((pulled().gross_s - 0.3) / 2)


@pytest.mark.parametrize("direction", [0, 90, 135, 250])
def test_the_centre_moves_in_the_direction_of_the_pull(direction):
    held = pulled()
    pressing, felt = grip.loads(held, 7, 9, 2.5, 1.0, direction, np.random.default_rng(3))
    total, x, y = true_centre(pressing)
    assert total == pytest.approx(held.grip_n) and felt.sum((1, 2)) == pytest.approx(held.felt_n)
    end = before(held).stop - 1
    tilt = grip.TILT * (held.grip_n[end] - held.grip_n[290])
    dx, dy = (x[end] - x[290]) * 2.5 * 4, (y[end] - y[290]) * 2.5 * 3  # mm
    along = np.deg2rad(direction)
    wanted = held.move_mm[end] * np.array([np.cos(along), np.sin(along)])
    # Force beyond the sensor's edge rests on its last taxels, so the move is a little smaller.
    assert np.hypot(dx - wanted[0], dy - wanted[1]) < 0.2 * held.move_mm[end] + 10 * tilt


def test_a_grip_alone_shears_nothing_and_hardly_moves():
    held = grip.gripped(grip.ramps(TIME_S, [*LEVELS, (0.4, 0.05, 4.0), (0.6, 0.02, 1.0)]))
    pressing, felt = grip.loads(held, 7, 7, 3.3, 1.0, 0.0, np.random.default_rng(1))
    assert np.array_equal(pressing, felt) and held.onset_s is held.gross_s is None
    _, x, y = true_centre(pressing[110:])
    assert 0 < np.hypot(np.ptp(x), np.ptp(y)) < 2 * 3 * grip.TILT


def test_the_scene_is_seeded_and_names_what_it_models():
    scene = scenes.load("cop_slip")
    first, again, other = (scenes.simulate(scene, scene.conditions[0], seed) for seed in (1, 1, 2))
    assert np.array_equal(first.codes, again.codes) and not np.array_equal(first.codes[:99], other.codes[:99])
    assert first.held.gross_s != other.held.gross_s
    assert set(first.modelled) == set(grip_scene.COMPONENTS) and first.left_out == ()
    kinds = {type(condition) for condition in scene.conditions}
    assert kinds == {Pull, Grip}
    grips = scenes.simulate(scene, scene.conditions[-1], 1)
    assert "pull" in grips.left_out and "rubber shear" in grips.left_out


def test_every_condition_slips_within_its_run():
    scene = scenes.load("cop_slip")
    for condition in scene.conditions:
        for seed in range(1, 4):
            recording = scenes.simulate(scene, condition, seed)
            time_s, held = recording.time_s, recording.held
            assert len(time_s) == len(recording.codes) == round(scene.duration_s(condition) * 1000)
            assert np.abs(recording.codes).max() < scene.config.adc.max_code
            if isinstance(condition, Pull):
                assert held.gross_s + 0.1 < time_s[-1] and held.slip_mm[-1] > 0
            else:
                assert held.grip_n[-1] == pytest.approx(condition.to_n[-1])


def shipped(tmp_path, *changes):
    """The scene with a copy of the shipped configuration in which lines are changed: (old, new) each."""
    text = (builds.FOLDER / "cop4.toml").read_text()
    for old, new in changes:
        assert text.count(f"\n{old}") == 1, old
        text = text.replace(f"\n{old}", f"\n{new}")
    (tmp_path / "mine.toml").write_text(text)
    table = tomllib.loads(scenes.source("cop_slip"))
    assert table["build"] == "cop4"
    return scenes.build("mine", table | {"build": str(tmp_path / "mine.toml")})


def test_the_scene_has_the_shipped_configuration_and_follows_it(tmp_path):
    """Everything but the world is the build's: a change of its file changes the scene."""
    scene, build = scenes.load("cop_slip"), builds.load("cop4")
    found = {f"cop4.{key}": value for key, value in dataclasses.asdict(scene.config.registers).items()}
    found |= {f"cop_slip.{key}": value for key, value in dataclasses.asdict(scene.registers).items()}
    assert found.items() <= build.settings.items() and scene.rate_hz == build.rate_hz == 1000
    assert (scene.config.adc.bits, scene.config.adc.high_v) == (16, 5)  # an AD7606
    assert scene.config.adc.noise_v == 117e-6  # its data sheet: docs/constants.md
    assert shipped(tmp_path).config.registers == scene.config.registers
    other = shipped(
        tmp_path,
        *(("r_ohm = 100.0", "r_ohm = 90.0"), ("volts = 5.0", "volts = 10.0"), ("gain = 0.3", "gain = 0.6")),
        *(("difference_gain = 16.0", "difference_gain = 9.0"), ("rate_hz = 1000.0", "rate_hz = 800.0")),
        *(
            ("lag_ms = 128.0", "lag_ms = 40.0"),
            ("drop = 0.3 ", "drop = 0.25 "),
            ("min_n = 0.3", "min_n = 0.2"),
        ),
    )
    assert other.config.mesh.r == 90 and other.rate_hz == 800 and other.lag == 32
    assert (other.config.adc.noise_v, other.config.adc.high_v) == (234e-6, 10)  # in proportion to the range
    assert (other.config.gain, other.config.difference_gain) == (0.6, 9)
    assert (other.registers.drop, other.config.registers.min_load) == (64, 200)
    assert len(scenes.simulate(other, other.conditions[0], 1).codes) < 0.85 * len(
        scenes.simulate(scene, scene.conditions[0], 1).codes
    )


def test_the_amplifiers_keep_the_mean_and_multiply_the_difference():
    """E1, E3 = 9.9 and 10.1 V, E2, E4 = -10.3 and -10.1 V; 0.3 of 10.0 ∓ 4·0.1 and of -10.2 ∓ 4·0.1; a code
    is 5 V / 32768."""
    mesh = scenes.load("cop_slip").config.mesh
    config = Cop4Config(mesh, Adc(16, -5.0, 5.0), 0.3, difference_gain=4.0)
    volts = np.array([[9.9, -10.3, 10.1, -10.1]])
    assert config.convert(volts).tolist() == [[18874, -20840, 20447, -19268]]  # 9.6, -10.6, 10.4, -9.8 V
    assert Cop4Config(mesh, Adc(16, -5.0, 5.0), 0.3).convert(volts).tolist() == [
        [19464, -20251, 19857, -19857]
    ]
    assert mesh.Cx == pytest.approx(24 + 2 / 3)
    Cop4Config(mesh, Adc(16, -5.0, 5.0), 0.3, difference_gain=24.6)
    with pytest.raises(ValueError, match="difference_gain"):
        Cop4Config(mesh, Adc(16, -5.0, 5.0), 0.3, difference_gain=24.7)


@pytest.mark.parametrize("gain", [1.0, 16.0, 24.0])
def test_amplified_differences_say_the_same_place(gain):
    """Loads up to the corners, 24 bits: within the range, no fault, and the mesh's own centre and load."""
    mesh = scenes.load("cop_slip").config.mesh
    config = Cop4Config(mesh, Adc(24, -5.0, 5.0), 0.3, difference_gain=gain)
    load = np.zeros((98, 7, 7))
    load[np.arange(49), np.arange(49) // 7, np.arange(49) % 7] = 0.4
    load[np.arange(49, 98), np.arange(49) // 7, np.arange(49) % 7] = 30.0
    answer = mesh.solve(load)
    found = cop4(config.convert(electrodes(answer)), config.registers, config.sample_bits)
    assert found.pressed.all() and not found.saturated.any() and not found.open.any()
    assert np.abs(found.x / 16384 - answer.x).max() < 1e-3 and np.abs(found.y / 16384 - answer.y).max() < 1e-3
    assert found.load * 1e-3 == pytest.approx(answer.load, rel=2e-3)


def test_settings_become_registers():
    scene = scenes.load("cop_slip")
    assert dataclasses.asdict(scene.registers) == {
        **{"drop": 77, "move": 57, "min_load": 300, "hold": 50, "refractory": 100}
    }
    assert scene.lag == 128
