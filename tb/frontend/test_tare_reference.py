"""The zeros of taxels against literals and against a plain loop in exact rationals (tb/reference/tare.py)."""

from fractions import Fraction

import numpy as np
import pytest

import bench
from meissner.twins.frontend.tare import Tare
from reference.tare import TareReference


def both(taxels, **given):
    return TareReference(taxels, **given), Tare(1, taxels, **given)


def test_following_by_hand():
    """Steps of a quarter code: a value equal to contact is followed, one above it is not; -1/2 rounds up to
    0."""
    given = {"fraction_bits": 2, "tare_log2": 0, "contact": 5, "step": 1}
    for follow, codes, left in (
        ("towards 5", [5, 5, 5, 5, 5], [5, 5, 4, 4, 4]),  # zeros 0, 1/4, 1/2, 3/4, 1
        ("not towards 6", [6, 6, 6, 6, 6], [6, 6, 6, 6, 6]),
        ("down", [-9, -9, -9, -9, -9], [-9, -9, -9, -8, -8]),  # 0, -1/4, -1/2, -3/4, -1
        ("nothing left", [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]),
    ):
        loop, twin = both(1, **given)
        assert [loop.frame([code], [False])[0] for code in codes] == left, follow
        assert twin.process(np.array(codes).reshape(5, 1, 1)).ravel().tolist() == left, follow


def test_averaging_by_hand():
    """Four frames with a mean of 2 3/4; the next frame writes the zeros and does not move them."""
    given = {"fraction_bits": 4, "tare_log2": 2, "contact": 5, "step": 16}
    codes, left = [3, 3, 3, 2, 9, 3, 3], [3, 3, 3, 2, 6, 0, 0]
    loop, twin = both(1, **given)
    loop.tare()
    twin.tare()
    assert [loop.frame([code], [False])[0] for code in codes] == left
    assert twin.next(np.array(codes).reshape(7, 1, 1)).ravel().tolist() == left
    assert loop.zeros == [Fraction(11, 4)] and twin.zeros().tolist() == [[2.75]]
    assert loop.tared == twin.tared == 1


@pytest.mark.parametrize("pressed, masked, refused", [(5, 0, 0), (6, 0, 1), (6, 1, 0)])
def test_refusal_by_hand(pressed, masked, refused):
    """A value equal to contact does not press, one above it does, unless its taxel is masked."""
    loop, twin = both(2, fraction_bits=4, tare_log2=1, contact=5, step=0)
    for each in (loop, twin):
        each.tare()
    for _ in range(3):
        loop.frame([pressed, 1], [masked, 0])
    twin.next(np.tile([pressed, 1], (3, 1, 1)), np.tile([bool(masked), False], (3, 1, 1)))
    assert (loop.refused, loop.tared) == (twin.refused, twin.tared) == (refused, 1 - refused)
    assert loop.zeros == ([0, 0] if refused else [pressed, 1]) == twin.zeros()[0].tolist()


def test_swallowed_frames_by_hand():
    """docs/array.md: while zeros are loaded each frame is swallowed and counted, also a damaged one. The
    frame in progress when loading is requested is still passed, and the one in which the request ends is
    swallowed."""
    twin = Tare(1, 3, fraction_bits=4, tare_log2=1, contact=5, step=0)
    whole, early, late = [0, 0, 1], [0, 1], [0, 0, 0, 1]  # `last` of each beat

    def frame(lasts, load=None):
        passed = 0
        beats = [{"id": place, "fits": True, "last": last} for place, last in enumerate(lasts)]
        for number, beat in enumerate(bench.placed(beats, 1, 3)):
            passed += twin.beat([7], beat["id"], beat["last"], [False], beat["fits"]) is not None
            if number == 0 and load is not None:
                twin.load(load)
        return passed

    for lasts, load, passed, swallowed in (
        (whole, None, 3, 0),
        (whole, True, 3, 0),  # requested during this frame: applies from the next one on
        (whole, None, 0, 1),
        (early, None, 0, 2),
        (late, None, 0, 3),
        (whole, False, 0, 4),
        (whole, None, 3, 4),
        (early, None, 2, 4),
    ):
        assert frame(lasts, load) == passed
        assert twin.swallowed == swallowed


@pytest.mark.parametrize("step, tare_log2, fraction_bits", [(1, 0, 3), (7, 3, 5), (255, 2, 12)])
def test_the_twin_is_the_loop_s(step, tare_log2, fraction_bits):
    rng = np.random.default_rng(bench.SEED)
    given = {"fraction_bits": fraction_bits, "tare_log2": tare_log2, "contact": 6, "step": step}
    loop, twin = both(5, **given)
    level = rng.integers(-200, 200, 5)
    for number in range(1500):
        level += rng.integers(-1, 2, 5)
        codes = level + rng.integers(-2, 3, 5) + 8 * (rng.random(5) < 0.04)
        masked = rng.random(5) < 0.2
        if rng.random() < 0.03:
            force = bool(rng.random() < 0.5)
            assert twin.taring == (loop.seen is not None or loop.average is not None)
            if not twin.taring:
                loop.tare(force)
                twin.tare(force)
        left = twin.next(codes.reshape(1, 1, 5), masked.reshape(1, 1, 5)).ravel().tolist()
        assert loop.frame(codes.tolist(), masked.tolist()) == left, f"frame {number}"
        zeros = [zero + more for zero, more in zip(loop.zeros, loop.average or [0] * 5)]
        assert [Fraction(zero) for zero in twin.zeros()[0].tolist()] == zeros, f"frame {number}"
    assert (loop.tared, loop.refused) == (twin.tared, twin.refused)
    assert loop.tared > 2 and loop.refused > 2
