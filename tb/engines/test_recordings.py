"""120 recordings of a gripper that closes and holds, without slip: fixed equals rtl in every field at every
level, with and without the timers of the slip states. The counts of tools/published/recordings.py equal those
of PyWavelets and plain NumPy. Skipped, with a message, without the data."""

import importlib.util
import sys

import numpy as np
import pytest
import pywt

from meissner.builds.toolchain import ROOT
from meissner.engines import fixed, rtl
from meissner.twins.slip.config import SlipConfig

TOOL = ROOT / "tools/published/recordings.py"


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("recordings", TOOL)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses need it there
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def recordings(tool):
    try:
        return tool.read()
    except ValueError as absent:
        pytest.skip(str(absent))


CONFIGS = [
    SlipConfig(
        hop=1 << level, level=level, threshold=10 << (level - 1), gross_threshold=13 << (level - 1), **how
    )
    for level in (1, 2, 3)
    for how in (
        {},
        # The recordings rest near 2040 codes and start up to 400 below, so contact comes and goes.
        {
            "contact_level": 2035 << level,
            "release_level": 2025 << level,
            "hold": 20,
            "refractory": 30,
            "blank": 100,
        },
    )
]


@pytest.mark.parametrize("config", CONFIGS, ids=lambda c: f"level{c.level}blank{c.blank}")
def test_fixed_equals_rtl_in_every_field(tool, recordings, config):
    """Half of the runs also have a moving actuator at times."""
    x = tool.stack(recordings)
    moving = np.arange(x.shape[1]) % 5000 < 700 if config.blank else None
    ours, theirs = (e.watch(x, config, moving) for e in (fixed, rtl))
    for field in ("p2p", "over", "state", "end"):
        assert np.array_equal(getattr(ours, field), getattr(theirs, field)), field
    assert ours.blanked == theirs.blanked
    assert len(x) == 120
    assert len(np.unique(ours.state)) >= 3
    assert (ours.blanked > 0) == (config.blank > 0)


def peak_to_peaks(x, level):
    """Start and p2p of every window of 64, by PyWavelets (level 1 to 3) or of the plain codes (level 0)."""
    group = 1 << level
    if level:
        x = pywt.wavedec(x[: len(x) // group * group].astype(float), "haar", "periodization", level)[1]
        x = np.rint(x * np.sqrt(2.0) ** level).astype(int)
    windows = np.lib.stride_tricks.sliding_window_view(x, 64 // group)
    p2p = windows.max(axis=1) - windows.min(axis=1)
    start = np.arange(len(p2p)) * group
    return (start, p2p) if level else (start[::2], p2p[::2])


def counted(tool, recordings, measured, level):
    """Per threshold: how many recordings raise an alarm and how many alarms, in the complete recording and in
    the hold; by the tool and independently."""
    found = measured[f"Haar {level}" if level else "plain"]
    held = {name: watch.holding() for name, watch in found.items()}
    windows = [(len(x), *peak_to_peaks(x, level)) for x in recordings.values()]
    for threshold in tool.THRESHOLDS:
        limit = threshold * (1.0 if level == 0 else np.sqrt(2.0) ** (level - 1))
        counts = np.zeros(4, dtype=int)
        for length, start, p2p in windows:
            inside = (start >= 1320) & (start + 64 <= length - 110)  # 0.6 s and 0.05 s
            for k, over in enumerate((p2p > limit, p2p[inside] > limit)):
                rises = int(over[0]) + int((over[1:] & ~over[:-1]).sum())
                counts[2 * k :][:2] += (rises > 0, rises)
        ours = [count(of, threshold) for of in (found, held) for count in (tool.alarming, tool.alarms)]
        yield threshold, ours, counts.tolist()


def test_every_recording_has_settled_before_the_hold(tool, recordings):
    assert max(map(tool.settled_at, recordings.values())) < tool.HOLD


@pytest.mark.parametrize("every", [30, pytest.param(1, marks=pytest.mark.long)])
def test_counts_equal_an_independent_computation(tool, recordings, every):
    """One test, so that only one worker takes the seconds of the simulations."""
    recordings = dict([*recordings.items()][::every])
    # It raises if an array of the slip command differs between rtl and fixed at any threshold.
    measured = tool.measure(recordings)
    for level in (0, 1, 2, 3):
        for threshold, ours, theirs in counted(tool, recordings, measured, level):
            assert ours == theirs, (level, threshold)
