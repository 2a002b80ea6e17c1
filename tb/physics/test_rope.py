"""The rope in the grip, by hand: hardness, springs in series, tension before the first slip, the force that
still holds and the least that does not, the size of a fall, where each sensor is, and what its forces are."""

from dataclasses import replace

import numpy as np
import pytest

from meissner.physics import rope
from meissner.physics.rope import Pull

RATE = 40


@pytest.fixture
def even(monkeypatch):
    """A rope without strands, unevenness and noise."""
    for name in ("STRANDS_FALL_N", "UNEVEN", "LOAD_NOISE_N", "JITTER"):
        monkeypatch.setattr(rope, name, 0.0)
    smooth = {name: replace(one, rough=0.0) for name, one in rope.ROPES.items()}
    monkeypatch.setattr(rope, "ROPES", smooth)


def pulled(**given):
    one = Pull(free_s=1.0, **given)
    return one, rope.pull([one], RATE, [[1]])


@pytest.mark.parametrize("shore, mpa", [(27, 1.00743), (60, 3.60507), (95, 43.8292)])
def test_the_modulus_of_a_hardness(shore, mpa):
    """A27: 0.0981 * 261.8307 = 25.68559 over 0.137505 * 185.42 = 25.49618."""
    assert rope.modulus(shore) == pytest.approx(mpa, rel=1e-5)


def test_springs_in_series():
    """Rope 5, grip 1, arm 20 N/mm: 1 / (0.2 + 1 + 0.05). A95: the grip has 43.506 N/mm."""
    assert rope.stiffness(5.0, 27) == pytest.approx(0.8)
    assert rope.stiffness(5.0, 95) == pytest.approx(1 / (0.2 + 1 / 43.5059 + 0.05), rel=1e-5)


def test_the_tension_rises_with_the_way_until_the_rope_slips(even):
    """Speed control, 2 mm/s after a ramp of 0.2 s, 0.8 N/mm: 1.44 N after 1 s; 4.5 N after 2.9125 s."""
    one, found = pulled(mode="speed", values=(2,))
    start = one.spans(RATE)[0][0]
    assert start == 20
    assert found.tension_n[0, start + RATE - 1] == pytest.approx(1.44, abs=2e-3)
    assert found.slid_mm[0, start + 115] == 0 and found.tension_n[0, start + 115] == pytest.approx(
        4.48, abs=0.01
    )
    assert found.slid_mm[0, start + 117] > 0
    assert np.array_equal(found.load_n, found.tension_n)


@pytest.mark.parametrize("force, slips", [(4.4, False), (4.49, False), (4.6, True), (9.0, True)])
def test_the_force_that_still_holds(even, force, slips):
    """0.9 * 5 N."""
    _, found = pulled(values=(force,))
    assert (found.slid_mm.max() > 0) == slips and found.tension_n.max() <= 4.5 + 1e-2


@pytest.mark.parametrize("shape, fall", [("nine-sided", 1.2312), ("R", 2.565)])
def test_the_first_fall(even, shape, fall):
    """4.5 N less the share of 4.5 (1 - 0.43) = 2.565 N; the rope slides by that over 0.8 N/mm."""
    _, found = pulled(mode="speed", values=(2,), shape=shape)
    first = int(np.flatnonzero(found.slid_mm[0])[0])
    assert found.slid_mm[0, first] == pytest.approx(fall / 0.8, rel=3e-3)
    assert found.tension_n[0, first - 1 : first + 1].max() - found.tension_n[0, first] > fall - 0.05


def falls(**given):
    """Falls of the tension by more than 0.2 N from a frame to the next in a second of sliding."""
    one, found = pulled(mode="speed", **given)
    own = np.diff(found.tension_n[0, one.spans(RATE)[0][1] - 2 * RATE : one.spans(RATE)[0][1]])
    return own[own < -0.2]


def test_a_harder_grip_slides_evenly_and_a_round_one_in_larger_steps(even):
    soft, hard, round_ = (falls(values=(9,), **one) for one in ({}, {"shore": 95.0}, {"shape": "R"}))
    assert len(soft) > 10 and len(hard) == 0
    assert len(soft) > 1.5 * len(round_) and round_.mean() < 1.5 * soft.mean()


def test_each_recording_has_its_own_draws():
    """The same alone and among others, and another with another seed."""
    pulls, seeds = [Pull(free_s=0.5), Pull(rope="b", free_s=0.5)], [[1], [2]]
    both = rope.pull(pulls, RATE, seeds)
    for k in range(2):
        alone = rope.pull(pulls[k : k + 1], RATE, seeds[k : k + 1])
        for name in ("tension_n", "load_n", "slid_mm"):
            assert np.array_equal(getattr(both, name)[k], getattr(alone, name)[0])
    other = rope.pull(pulls[:1], RATE, [[3]])
    assert not np.array_equal(other.tension_n[0], both.tension_n[0])


def test_the_sensors_of_a_frame():
    """s_0 to s_2 are the first column, from top to bottom."""
    frame = np.array([[0, 3, 6], [1, 4, 7], [2, 5, 8]])
    assert rope.as_published(frame).tolist() == [*range(9)]
    assert rope.as_published(np.stack([frame, frame + 9]))[1].tolist() == [*range(9, 18)]


def of(**given):
    """Newtons on s_0 to s_8 at these tensions."""
    tension = np.array(given.pop("tension"), float)
    found = rope.forces(Pull(**given), tension, 0 * tension, RATE, np.random.default_rng(1))
    return rope.as_published(found)


def test_the_forces_on_the_sensors(even):
    """Without tension 5 N and nine preloads of 0.35 N, less 0.05 N * 1.00743 at s_8; the row of the position
    has the most; tension raises s_1 and lowers s_7."""
    for position, row in (("top", 0), ("middle", 1), ("bottom", 2)):
        rest, loaded = of(tension=[0, 4], position=position, post=True)
        assert rest.sum() == pytest.approx(5 + 9 * 0.35 - 0.05 * 1.00743, rel=1e-5)
        assert [int(part.argmax()) for part in rest.reshape(3, 3)] == [row] * 3
        assert loaded[row] - rest[row] > 0.1 and loaded[6 + row] < rest[6 + row]
        assert loaded.sum() - rest.sum() == pytest.approx(4 * (0.1 - 0.035))


def test_what_a_harder_grip_and_one_without_protrusions_change(even):
    assert of(tension=[0, 4], shore=95.0)[:, 8].tolist() == [0, 0]
    sharp, flat = (
        of(tension=[0], post=True, shape=s)[0] for s in ("nine-sided", "nine-sided without protrusions")
    )
    assert sharp[4] > 1.4 * flat[4] and sharp.sum() == pytest.approx(flat.sum())


def test_the_hand_turns_the_rope_unless_a_post_holds_it():
    """0.012 a newton and 0.0012 a millimetre, towards the first row, at most to its end."""
    tension, slid = np.array([0.0, 4.0, 0.0]), np.array([0.0, 0.0, 100.0])
    assert rope.places(Pull(), tension, slid) == pytest.approx([0, 0.048, 0.12])
    assert rope.places(Pull(position="top_middle"), tension, slid * 9).tolist() == [0.5, 0.548, 1.0]
    assert rope.places(Pull(post=True), tension, slid).tolist() == [0, 0, 0]
