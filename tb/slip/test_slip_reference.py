"""Slip by literals and by plain loops: the cases of tb/reference/slip_cases.py, worked out by hand, must hold
for the loop, for the twin and (slip/slip_by_hand.py) for the RTL; then twins against loops on random
walks."""

import random
from types import SimpleNamespace

import numpy as np
import pytest

import bench
from meissner.engines import float_slip
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip import Slip, State
from meissner.twins.slip.slip_path import decide
from meissner.twins.slip.slip_serial import SlipSerial
from reference.slip import NUMBERS, SlipPathReference, SlipReference
from reference.slip_cases import CASES
from slip.slip_by_hand import walk


def test_the_states_have_the_numbers_of_the_package():
    assert {"ncigr"[number]: state.value for number, state in enumerate(State)} == NUMBERS


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_loop_does_what_the_hand_found(case, rises):
    loop = SlipReference(SimpleNamespace(**case.settings(rises)))
    assert "".join(loop.detail(*detail) for detail in case.details(rises)) == case.states
    assert loop.blanked == case.blanked


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_twin_does_what_the_hand_found(case, rises):
    p2p, level, moving, masked = zip(*case.details(rises))
    twin = Slip(1, SlipConfig(**case.settings(rises)))
    states = twin.process([p2p], [level], moving, np.array([masked]))[0]
    assert [int(state) for state in states] == [NUMBERS[letter] for letter in case.states]
    assert twin.blanked == case.blanked


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize(
    "case", [case for case in CASES if "x" not in case.masked], ids=lambda case: case.name
)
def test_engine_float_does_what_the_hand_found(case, rises):
    p2p, level, moving, _ = (np.array(values, dtype=float) for values in zip(*case.details(rises)))
    config = SlipConfig(**case.settings(rises))
    states, blanked = float_slip.states(p2p[None] - 0.5, level[None], config, moving.astype(bool))
    assert (states[0].tolist(), blanked) == ([NUMBERS[letter] for letter in case.states], case.blanked)


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize("times", [(0, 1, 15), (1, 15, 0), (15, 0, 1), (2, 4, 3), (7, 7, 7)], ids=str)
def test_the_twin_does_what_the_loop_does(rises, times):
    draw = random.Random(bench.SEED)
    settings = CASES[0].settings(rises) | dict(zip(("hold", "refractory", "blank"), times))
    settings |= {} if times[0] == 0 else {"keep_threshold": {1: 39, 15: 0, 2: 41, 7: 40}[times[0]]}
    details = walk(draw, 3, 4000, rises, True)
    moving = [row[0][2] for row in details]
    p2p, level, _, masked = np.array(details, dtype=int).T
    twin, loops = (
        Slip(3, SlipConfig(**settings)),
        [SlipReference(SimpleNamespace(**settings)) for _ in range(3)],
    )
    states = twin.process(p2p, level, moving, masked.astype(bool))
    expected = [[NUMBERS[loop.detail(*row[c])] for row in details] for c, loop in enumerate(loops)]
    assert states.tolist() == expected
    assert twin.blanked == sum(loop.blanked for loop in loops) > 0


def test_a_path_by_hand():
    """Window 8 at level 1: four details; contact from 10 on; over: p2p above 5.

    x       0 0   5 5   9 8   5 9   | 7 4   4 7   7 5   6 6   | 0 1
    d        0     0     1    -4    |  3    -3     2     0    | -1
    a        0    10    17    14    | 11    11    12    12    |  1
    p2p      0     0     1     5    |  0     6     6     6    |  0
    state    n     c     c     c    |  c     i     i     i    |  r
    """
    x = [0, 0, 5, 5, 9, 8, 5, 9, 7, 4, 4, 7, 7, 5, 6, 6, 0, 1]
    config = SlipConfig(window=8, hop=8, threshold=5, gross_threshold=6, contact_level=10, release_level=10)
    for seen in (
        [
            [int(row[name]) for name in ("state", "p2p", "raised", "over", "end")]
            for row in rows_of(decide(np.array([x]), config), 9, 5)
        ],
        [[NUMBERS[row[0]], row[3], int(row[1]), int(row[2]), int(row[4])] for row in loop_of(x, config)],
        serial_rows(x, config),
    ):
        assert seen == [
            [0, 0, 0, 0, 0],
            [1, 0, 0, 0, 0],
            [1, 1, 0, 0, 0],
            [1, 5, 0, 0, 1],
            [1, 0, 0, 0, 0],
            [2, 6, 1, 1, 0],
            [2, 6, 0, 1, 0],
            [2, 6, 0, 1, 1],
            [4, 0, 0, 0, 0],
        ]


def rows_of(decided, count, threshold):
    names = {
        "state": decided.state[0],
        "p2p": decided.p2p[0],
        "raised": decided.raised[0],
        "end": decided.end,
    }
    rows = [{name: values[n] for name, values in names.items()} for n in range(count)]
    return [row | {"over": row["p2p"] > threshold} for row in rows]


def loop_of(x, config, moving=None, masked=None):
    loop = SlipPathReference(config)
    moving, masked = moving or [False] * len(x), masked or [False] * len(x)
    return [row for sample in zip(x, moving, masked) if (row := loop.sample(*sample))]


def serial_rows(x, config):
    decided = SlipSerial(config).process(x)
    names = ("state", "p2p", "raised", "over", "end")
    return [[int(decided[name][n]) for name in names] for n in range(len(decided["state"]))]


PATHS = [(1, 64, 64), (1, 16, 8), (1, 16, 2), (2, 32, 16), (3, 64, 64), (2, 16, 12), (3, 64, 8)]


@pytest.mark.parametrize("rises", [True, False])
@pytest.mark.parametrize("level, window, hop", PATHS)
def test_the_path_is_the_loop_s(level, window, hop, rises):
    """Codes that vary by a few steps, so that every limit is met exactly; masked now and then."""
    rng = np.random.default_rng(bench.SEED)
    group, sign = 1 << level, 1 if rises else -1
    levels = {"contact_level": sign * 6 * group, "release_level": sign * 5 * group, "contact_rises": rises}
    times = {"hold": 2, "refractory": 5, "blank": 3, "keep_threshold": 2}
    config = SlipConfig(
        level=level, window=window, hop=hop, threshold=5, gross_threshold=8, **levels, **times
    )
    pressed = np.repeat(rng.random(120) < 0.7, 40)
    tremor = np.repeat(rng.choice([0, 1, 3], 480), 10)
    x = sign * (pressed * 6 + rng.integers(-tremor, tremor + 1))
    masked = rng.random(x.size) < 0.01
    moving = np.repeat(rng.random(x.size // group) < 0.1, group)
    decided = decide(x[None], config, moving[::group], masked[None])
    rows = loop_of(x.tolist(), config, moving.tolist(), masked.tolist())
    names = [decided.state[0], decided.raised[0], decided.p2p[0], decided.end]
    expected = [(NUMBERS[state], raised, p2p, end) for state, raised, _, p2p, end in rows]
    assert [tuple(int(v) for v in row) for row in zip(*names)] == [tuple(map(int, row)) for row in expected]
    assert {row[0] for row in expected} == set(range(5))
    if hop == window:
        rows = loop_of(x.tolist(), config, moving.tolist())
        serial = SlipSerial(config).process(x, moving=moving)
        assert serial["state"].tolist() == [NUMBERS[row[0]] for row in rows]
        assert serial["over"].tolist() == [row[2] for row in rows]
