"""120 recordings of a gripper that closes and holds, without slip: fixed equals rtl in every field at every
level, with and without the timers of the slip states. Skipped, with a message, without the data."""

import importlib.util
import sys

import numpy as np
import pytest

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
