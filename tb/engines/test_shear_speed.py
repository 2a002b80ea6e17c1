"""The engines' shear_speed: float, fixed and rtl compared with ShearReference, a loop from
docs/shear_speed.md; rtl equals fixed to the bit; and what its scene finds without the rubber's own
deviation."""

from fractions import Fraction

import numpy as np
import pytest

import bench
from meissner import scenes
from meissner.engines.features.shear_speed.engines import ENGINES
from meissner.physics import rubber
from meissner.scenes.shear import estimate
from meissner.scenes.timed import TimedEngine
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import ShearConfig
from reference.shear import FAST, RISING, ShearReference, within

# 5 V / 4096, 10 kHz, Vi of 1.9 to 4.1 V, 0.004 mm.
SETTINGS = {"k0": 650_117, "k1": -17_695, "exponent": 18_618, "vi_min": 796_918, "vi_max": 1_719_665}
SETTINGS |= {"noise": 41_943, "still": 1049, "full": 4088, "limit": 3 << 20, "travel": 655_360}
CONFIG = ShearConfig(ShearSettings(**SETTINGS))


def story(rng, windows):
    levels = []
    while len(levels) < windows:
        rest = rng.integers(1600, 3300)
        rise = (1.55 * 819.2 - 0.27 * rest) * rng.choice([0.04, 0.3, 1.1, 2.6, 3.7]) ** 0.11
        levels += [rest] * 9 + [rest + rise] * int(rng.integers(1, 9)) + [4095] * int(rng.random() < 0.3)
    return np.clip(np.rint(np.repeat(levels[:windows], 64) + rng.normal(0, 0.4, windows * 64)), 0, 4095)


def by_loop(codes, moving):
    """[(flags, exact speed or None)] of each window."""
    loop, travel, found = ShearReference(SETTINGS, 6, 3, 20), 0, []
    for at in range(0, len(codes) - 63, 64):
        window, before = [int(code) for code in codes[at : at + 64]], loop.reference
        flags, exact = loop.window(window, bool(moving[at : at + 64].any()))
        if exact is None:
            travel = 0
        else:
            rises = 8 * sum(window) > before + SETTINGS["still"]
            travel = 0 if rises else travel + exact
            assert abs(travel - SETTINGS["travel"]) > 1000 and abs(exact - SETTINGS["limit"]) > 2000
            flags |= RISING * (travel < SETTINGS["travel"]) | FAST * (exact > SETTINGS["limit"])
            flags |= 128 * (exact >= (1 << 24) - 1)
        found.append((flags, exact))
    return found


@pytest.mark.parametrize("engine", ["float", "fixed", "rtl"])
def test_engines_beside_the_loop(engine):
    rng = np.random.default_rng(bench.SEED)
    x = np.array([story(rng, 150) for _ in range(2)]).astype(int)[:, :-7]
    moving = np.zeros(x.shape[1], dtype=bool)
    moving[[4000, 4001, 7000]] = True
    speed, flags = ENGINES[engine](x, CONFIG, moving)
    seen, good = set(), 0
    for row, told, codes in zip(speed, flags, x):
        expected = by_loop(codes, moving)
        assert told.tolist() == [flag for flag, _ in expected]
        for v, (flag, exact) in zip(row, expected):
            off = within(18_618, 26, 6, 16) * exact + Fraction(1, 2) if flag == 0 else 0
            assert abs(Fraction(float(v)) * 2**20 - exact) <= off if flag == 0 else v == 0
            seen, good = seen | {flag}, good + (flag == 0)
    assert {1, 4, 16, 32, 64} <= seen and good >= 40


def test_rtl_is_fixed_to_the_bit():
    rng = np.random.default_rng(3)
    x = np.array([story(rng, 60) for _ in range(2)]).astype(int)
    for moving in (None, rng.random(x.shape[1]) < 0.0005):
        fixed, rtl = (ENGINES[name](x, CONFIG, moving) for name in ("fixed", "rtl"))
        assert all(np.array_equal(one, two) for one, two in zip(fixed, rtl))


def test_the_scene_finds_the_stage_s_speed(monkeypatch):
    """Without the deviation of repeated steps the speed is the stage's, within 4 % for the rubber's
    ripple."""
    monkeypatch.setattr(rubber, "SHEAR_SPREAD", 0.0)
    scene = scenes.load("shear_speed")
    one = estimate.Estimator(scene, TimedEngine("fixed", scene.features))
    for place, case in enumerate(scene.cases):
        if case.speed_mm_s not in (0.5, 1.0, 4.0):
            continue
        found = one.of(scenes.simulate(scene, place, 2))
        assert found["estimates_outside"] == 0 and found["estimate_fast"] == (case.speed_mm_s == 4.0)
        if case.speed_mm_s < 3:
            assert abs(found["estimate_mm_s"] / case.speed_mm_s - 1) < 0.04, (case.name, found)
