"""The three engines on the same samples: fixed equals rtl in every array, float agrees, for 1 to 8 and many
channels, every kind of window and level; the four scenes; where the flag rises; refused input."""

import numpy as np
import pytest

from meissner import engines, scenes
from meissner.engines import fixed, rtl
from meissner.twins.slip.config import SlipConfig


def noise(channels, samples, seed=1):
    """Quiet and loud stretches, so that windows fall on both sides of the threshold."""
    rng = np.random.default_rng(seed)
    loud = np.repeat(rng.choice([5, 12, 30], (channels, samples // 40 + 1)), 40, axis=1)[:, :samples]
    return rng.integers(-loud, loud + 1)


def same(a, b):
    return all(np.array_equal(a[name], b[name]) for name in ("p2p", "window_end", "slip", "fired_at"))


CONFIGS = [
    SlipConfig(),
    SlipConfig(hop=32),
    SlipConfig(hop=2),
    SlipConfig(hop=6, window=32),
    SlipConfig(level=2),
    SlipConfig(level=3, hop=8),
    SlipConfig(window=4, hop=4, threshold=20),
]


@pytest.mark.parametrize("config", CONFIGS, ids=lambda c: f"window{c.window}hop{c.hop}level{c.level}")
def test_engines_agree(config):
    x = noise(3, 3001)
    results = {name: engines.process_slip(x, config, name) for name in engines.NAMES}
    assert 0.02 < results["fixed"]["slip"].mean() < 0.98
    assert same(results["fixed"], results["rtl"])
    assert np.abs(results["float"]["p2p"] - results["fixed"]["p2p"]).max() < 1e-9
    for name in ("window_end", "slip", "fired_at"):
        assert np.array_equal(results["float"][name], results["fixed"][name])


@pytest.mark.parametrize("channels", [1, 2, 4, 5, 6, 7, 8, 120, 1024])
def test_any_number_of_channels(channels):
    """test_engines_agree covers 3 channels."""
    x = noise(channels, 3000 if channels < 100 else 200)
    config = SlipConfig()
    assert same(engines.process_slip(x, config, "fixed"), engines.process_slip(x, config, "rtl"))


@pytest.mark.parametrize("config", CONFIGS[:5], ids=lambda c: f"window{c.window}hop{c.hop}level{c.level}")
def test_window_arrays_by_brute_force(config):
    """p2p, window_end, slip and fired_at as the command documents them, in plain loops."""
    x = noise(2, 700, seed=5)
    result = engines.process_slip(x, config, "fixed")
    group = 1 << config.level
    ends = [e for e in range(700) if e >= config.window - 1 and (e - config.window + 1) % config.hop == 0]
    assert result["window_end"].tolist() == ends
    for channel in range(2):
        for k, end in enumerate(ends):
            samples = x[channel, end - config.window + 1 : end + 1].reshape(-1, group)
            half = group // 2
            details = (samples[:, :half].sum(axis=1) - samples[:, half:].sum(axis=1)).tolist()
            seen, fired = [], -1
            for index, detail in enumerate(details):
                seen.append(detail)
                if max(seen) - min(seen) > config.threshold:
                    fired = end - config.window + (index + 1) * group
                    break
            slip = max(details) - min(details) > config.threshold
            assert result["p2p"][channel, k] == max(details) - min(details)
            assert result["slip"][channel, k] == slip
            if config.hop < config.window:
                fired = end if slip else -1
            assert result["fired_at"][channel, k] == fired


@pytest.mark.parametrize("name", scenes.names("rubber"))
def test_scenes_are_the_same_on_fixed_and_rtl(name):
    """Every detail's peak-to-peak, decision and state, and the arrays of the slip command."""
    scene = scenes.load(name)
    config = scene.slip_config()
    for condition in scene.conditions:
        run = scenes.simulate(scene, condition, 7)
        ours, theirs = (e.watch(run.codes[None], config, run.moving) for e in (fixed, rtl))
        for field in ("p2p", "over", "state", "end"):
            assert np.array_equal(getattr(ours, field), getattr(theirs, field)), (condition.name, field)
        assert ours.blanked == theirs.blanked
        assert same(*(engines.process_slip(run.codes, config, e) for e in ("fixed", "rtl")))


def test_float_watches_like_fixed():
    """Every field except p2p is equal, with p2p often exactly at a threshold and moving changing at any
    sample."""
    rng = np.random.default_rng(6)
    x = 150 + rng.integers(-3, 4, (2, 3000)) * rng.choice([1, 4], (2, 3000))
    moving = np.repeat(rng.random(1000) < 0.4, 3)
    for level, hop in ((1, 64), (2, 32), (1, 2), (3, 8)):
        times = {"hold": 3, "refractory": 4, "blank": 9}
        levels = {"contact_level": 150 << level, "release_level": 140 << level}
        config = SlipConfig(threshold=40, gross_threshold=44, hop=hop, level=level, **levels, **times)
        ours, theirs = (engines.load(e).watch(x, config, moving) for e in ("fixed", "float"))
        assert (ours.p2p == config.threshold).any()
        assert np.abs(ours.p2p - theirs.p2p).max() < 1e-9
        for field in ("over", "state", "end", "blanked"):
            assert np.array_equal(getattr(ours, field), getattr(theirs, field)), (level, hop, field)


def test_thresholds_and_levels_reach_the_ends_of_their_registers():
    """Full-scale samples of both signs against thresholds with the top bit set and negative levels."""
    x = np.random.default_rng(7).choice([-65536, -1, 0, 65535], (2, 512))
    for threshold, contact in ((262143, -(1 << 17)), (262141, -131072), (131072, -70000), (131071, 131070)):
        config = SlipConfig(
            window=4,
            hop=4,
            threshold=threshold,
            gross_threshold=262000,
            contact_level=contact,
            release_level=contact,
        )
        ours, theirs = (e.watch(x, config) for e in (fixed, rtl))
        for field in ("p2p", "over", "state", "end"):
            assert np.array_equal(getattr(ours, field), getattr(theirs, field)), (threshold, field)


def test_moving_and_blanking_reach_the_core():
    rng = np.random.default_rng(4)
    x = 150 + rng.integers(-40, 41, (2, 2001))
    moving = np.repeat(rng.random(87) < 0.4, 23)  # changes after even and odd counts
    config = SlipConfig(
        threshold=60, gross_threshold=110, contact_level=200, release_level=100, hold=3, refractory=4, blank=9
    )
    ours, theirs = (e.watch(x, config, moving) for e in (fixed, rtl))
    assert ours.blanked == theirs.blanked > 0
    assert np.array_equal(ours.state, theirs.state)


def test_takes_samples_of_any_width_of_number():
    x = noise(1, 200)
    for kind in (np.int8, np.float16, np.float32, np.longdouble):
        assert np.array_equal(engines.check_samples(x.astype(kind)), x)
    assert engines.check_samples([-65536, 65535]).tolist() == [[-65536, 65535]]


def test_refuses_unknown_engine():
    with pytest.raises(ValueError, match="warp"):
        engines.load("warp")
