"""The values computed by the pages of the slip papers, against values worked out by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from meissner.physics.adc import PARTS
from published import _shear, _wavelets


def test_a_step_is_the_published_line_to_what_its_distance_leaves():
    """From 2 V at 1 mm/s k = 1.55 - 0.54 = 1.01 V; after 0.01 mm 1 - e^-3 = 0.9502 of it."""
    assert _shear.step(1.7, 1.0, 0.3) == pytest.approx(1.01, abs=1e-3)
    assert _shear.step(1.7, 1.0, 0.01) == pytest.approx(1.01 * 0.9502, abs=2e-3)
    assert _shear.step(1.0, 0.05, 0.1) == pytest.approx(0.74 * 0.71926, abs=1e-3)  # 0.05^0.11


def test_a_pressed_and_sheared_rubber_goes_through_2_v_and_ends_where_its_recovery_says():
    for recovers, end in ((1.0, 2.0), (0.4, 2.606)):
        time_s, vc, until = _shear.sheared(1.0, recovers)
        assert until == pytest.approx(4.3)
        assert vc[0] == 5.0 and vc[time_s.searchsorted(3.5)] == pytest.approx(2.0)
        assert vc.max() == 5.0 and vc[time_s.searchsorted(4.29)] == pytest.approx(3.01, abs=1e-3)
        assert vc[-1] == pytest.approx(end, abs=5e-3)


def test_the_slope_of_a_ramp_is_its_slope():
    assert _shear.slope(np.arange(100) * 2e-4, 10_000)[:90] == pytest.approx(2.0)


def run(codes, onset_s):
    codes = np.asarray(codes)
    scene = SimpleNamespace(adc=PARTS["MCP3208"], rate_hz=10_000)
    return SimpleNamespace(scene=scene, codes=codes, time_s=np.arange(len(codes)) / 1e4, onset_s=onset_s)


@pytest.mark.parametrize("step, found", [(23, None), (24, 0.0259)])
def test_the_first_flag_is_the_first_detail_over_the_threshold_in_its_window(step, found):
    """0.02 V between the lowest and the highest coefficient is a difference of 23.17 codes: 23 codes stay
    below.

    Sample 256 is in a window's first pair, so its coefficient can only differ from that of the second pair,
    which ends with sample 259. Samples before the onset do not count.
    """
    codes = np.full(640, 2000)
    codes[256] += step
    codes[100] += 200
    assert _wavelets.first_flag(run(codes, 0.022)) == found


def test_a_panels_columns_keep_the_greatest():
    kept = _wavelets.columns(np.array([[1, 5, 2, 2, 9, 0, 3]]), 3)
    assert kept.tolist() == [[5, 2, 9]]
