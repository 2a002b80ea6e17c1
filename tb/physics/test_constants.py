"""Every constant of the physics has an origin, and the dependence of the slip figures on
some of them is measured."""

import pytest

from meissner.physics import plate, rubber
from meissner.tradeoff.changes import Change
from published import constants


def test_every_constant_says_where_it_is_from():
    for module in constants.modules():
        assert set(module.ORIGINS) == set(constants.constants(module)), module.__name__
        for name, (kind, where, effect) in module.ORIGINS.items():
            assert kind in constants.KINDS and where and effect, name


def test_a_change_reaches_what_is_computed_from_it_and_ends():
    """A layer a third as thick rings at sqrt(3) times the frequency, as the stiffness is kept."""
    before = rubber.RING_HZ, rubber.RING_S, rubber.QUALITY, rubber.THICKNESS_MM
    with constants.changed(Change("THICKNESS_MM", rubber.THICKNESS_MM / 3)):
        assert pytest.approx(before[0] * 3**0.5) == rubber.RING_HZ
        assert pytest.approx(5893, abs=1) == rubber.RING_HZ, "above half of 10 kHz"
    with constants.changed(Change("QUALITY", 10.0)):
        assert pytest.approx(10 / 3 * before[1]) == rubber.RING_S and before[0] == rubber.RING_HZ
    ripple = plate.RIPPLE_N
    with constants.changed(Change("RIPPLE_N", 2.0, plate)):
        assert plate.RIPPLE_N == 2.0
    assert ripple == plate.RIPPLE_N
    assert before == (rubber.RING_HZ, rubber.RING_S, rubber.QUALITY, rubber.THICKNESS_MM)
