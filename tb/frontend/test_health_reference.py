"""Health of taxels by literals and by a plain loop: the cases of tb/reference/health_cases.py, by hand, must
hold for the loop, for the twin and (frontend/health_by_hand.py) for the RTL; then the twin against the
loop."""

import random

import numpy as np
import pytest

import bench
from meissner.twins.frontend.health import BLINKING, DEAD, RAILED, Health, Limits
from reference.health import HealthReference
from reference.health_cases import Case, broken, cases


def test_the_faults_have_the_numbers_of_the_link():
    assert (DEAD, RAILED, BLINKING) == (1, 2, 4)


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_the_loop_finds_what_the_hand_found(case):
    loop, found = HealthReference(*case.shape, **case.settings), {}
    places = [(row, column) for row in range(case.shape[0]) for column in range(case.shape[1])]
    for number in range(case.frames()):
        if case.clear and number == case.clear:
            loop.clear()
        if case.later and number == case.later[0]:
            loop.settings.update(case.later[1])
        whole = set(places[: case.broken[number]]) if number in case.broken else None
        if new := loop.frame(case.frame(number), case.frame(number, case.over), whole):
            found[number] = new
    assert found == case.found


def twins_frame(twin, codes, over, whole=None):
    """One frame through the twin; with ``whole`` it breaks off after that many beats of one lane."""
    if whole is None:
        masks, _ = twin.next([codes], [over])
        return masks[0]
    beats = [(code, flag) for row in zip(codes, over) for code, flag in zip(*row)]
    for place, last in broken(whole, len(beats)):
        code, flag = beats[place]
        twin.beat([code], [bool(flag)], place, last, place < whole)
    return None


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_the_twin_finds_what_the_hand_found(case):
    """It also masks these taxels from the next frame on, and counts them."""
    twin, found = Health(*case.shape, limits=Limits(**case.settings)), {}
    for number in range(case.frames()):
        if case.clear and number == case.clear:
            twin.clear()
        if case.later and number == case.later[0]:
            twin.limits = Limits(**case.settings | case.later[1])
        before = twin.faults.copy() if number and number != case.clear else np.zeros(case.shape, int)
        mask = twins_frame(twin, case.frame(number), case.frame(number, case.over), case.broken.get(number))
        assert mask is None or np.array_equal(mask, before != 0)
        new = {
            tuple(map(int, place)): int((twin.faults & ~before)[*place])
            for place in np.argwhere(twin.faults & ~before)
        }
        if new:
            found[number] = new
    assert found == case.found
    since = [places for frame, places in case.found.items() if frame >= case.clear]
    kinds = [kind for places in since for kind in places.values()]
    assert [twin.dead, twin.railed, twin.blinking] == [kinds.count(kind) for kind in (1, 2, 4)]


def test_a_rail_counts_to_255():
    """Checked in frames 16, 32 ..: the 255th time in frame 4080."""
    case = Case(
        "", {(0, 0): [50] * 4100}, {}, dict(cases()[0].settings) | {"rail": 255, "still": 0}, shape=(1, 1)
    )
    loop, twin = HealthReference(1, 1, **case.settings), Health(1, 1, limits=Limits(**case.settings))
    for number in range(4100):
        loop.frame([[50]])
        twin.next([[[50]]])
        assert loop.faults(0, 0) == twin.faults[0, 0] == (2 if number >= 4080 else 0)


@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 4), (2, 1), (3, 3), (4, 5)])
@pytest.mark.parametrize(
    "steps", [[0, 0, 0, 0, 3, -3], [0] * 10 + [8, -8], [0, 0, 2, 3, -3, 7, -7, 8, -8]], ids=str
)
def test_the_twin_is_the_loop_s(rows, columns, steps):
    """Random walks in single steps around band, jump and rails; frames that break off; clears."""
    kinds = (
        {"still": 9, "edges": True},
        {"rail": 2, "over_range_enable": True},
        {"blink": 17},
        {"still": 22, "rail": 1, "blink": 33},
    )
    for seed, kind in enumerate(kinds):
        rng, draw = np.random.default_rng(bench.SEED + seed), random.Random(bench.SEED + seed)
        given = {"band": 2, "jump": 7, "low": -20, "high": 21, "over_range_enable": False, "edges": seed > 2}
        given |= {"still": 0, "rail": 0, "blink": 0} | kind
        loop, twin = HealthReference(rows, columns, **given), Health(rows, columns, limits=Limits(**given))
        places = [(row, column) for row in range(rows) for column in range(columns)]
        codes = np.zeros((rows, columns), int)
        for number in range(300):
            codes = np.clip(codes + rng.choice(steps, codes.shape), -24, 24)
            over = rng.random(codes.shape) < 0.02
            whole = draw.randrange(len(places)) if len(places) > 1 and draw.random() < 0.1 else None
            if draw.random() < 0.01:
                loop.clear()
                twin.clear()
            loop.frame(codes.tolist(), over.tolist(), None if whole is None else set(places[:whole]))
            twins_frame(twin, codes.tolist(), over.tolist(), whole)
            faults = [[loop.faults(row, column) for column in range(columns)] for row in range(rows)]
            # After a clear the twin resets with the next complete frame; until then it masks nothing.
            assert loop.first or twin.faults.tolist() == faults, f"frame {number}, {given}"
