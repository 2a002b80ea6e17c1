"""Every constant of the physics has an origin, and the dependence of the slip figures on
some of them is measured."""

import types

import numpy as np
import pytest

from meissner.physics import plate, rubber
from meissner.tradeoff.changes import Change
from published import constants


@pytest.mark.parametrize("module", constants.modules(), ids=lambda module: module.__name__.split(".")[-1])
def test_every_constant_says_where_it_is_from(module):
    origins = module.ORIGINS
    assert set(origins) == set(constants.constants(module))
    for name, (kind, where, effect) in origins.items():
        assert kind in constants.KINDS, name
        assert len(where) > 4 and effect, name


def test_constants_are_numbers_and_tables_of_them():
    made = types.SimpleNamespace(
        A=1, B_2=2.5, C=((1, 2.0), "x"), D={"a": plate.MATERIALS["wood"]}, E=np.ones(2), ORIGINS={"A": 1},
        lower=3, _HIDDEN=4, WORD="x", FLAG=True, NAMES=("a", "b"),
    )  # fmt: skip
    assert list(constants.constants(made)) == ["A", "B_2", "C", "D", "E"]


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
