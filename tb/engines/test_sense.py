"""The public interface: results by hand, equal results in pieces of any size and in one call, and refused
input."""

import inspect
from itertools import pairwise

import numpy as np
import pytest

import meissner
from meissner import engines
from meissner.engines.protocol import Engine
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Mesh
from meissner.twins.slip.slip import State

# Level 1: d = x0 - x1, a = x0 + x1; a window of 4 samples has 2 details.
CONFIG = meissner.SlipConfig(
    window=4, hop=4, level=1, threshold=9, gross_threshold=30, contact_level=100, release_level=90
)
SAMPLES = [50, 50, 55, 50, 60, 50, 52, 60, 50, 50, 40, 40]
DETAILS = [0, 5, 10, -8, 0, 0]
P2P = [0, 5, 0, 18, 0, 0]  # each window alone: |5 - 0|, |-8 - 10|, 0
STATES = [State.CONTACT, State.CONTACT, State.CONTACT, State.INCIPIENT, State.CONTACT, State.RELEASE]


def test_slip_by_hand():
    found = meissner.Slip(CONFIG).process(SAMPLES)
    assert found.p2p.tolist() == [P2P]
    assert found.state.tolist() == [STATES]
    assert found.slips.tolist() == found.raised.tolist() == [[False, False, False, True, False, False]]


def test_a_hand_that_moves_raises_no_slip():
    """``moving`` counts at the last sample of a detail: at sample 7, not at sample 6."""
    for at, slips in ((7, False), (6, True)):
        moving = np.arange(12) == at
        assert meissner.Slip(CONFIG).process(SAMPLES, moving).slips.any() == slips


@pytest.mark.parametrize("level, window, hop", [(1, 16, 16), (2, 32, 16), (3, 64, 8)])
def test_pieces_give_what_the_whole_gives(level, window, hop):
    rng = np.random.default_rng(level)
    x, moving = rng.integers(-300, 300, (3, 701)), rng.random(701) < 0.1
    config = meissner.SlipConfig(window=window, hop=hop, level=level, threshold=700, blank=2, hold=3)
    slip = meissner.Slip(config, channels=3)
    whole = slip.process(x, moving)
    assert whole.raised.any() and not whole.slips.all()
    cuts = [0, 1, 2, 2, 9, 50, 51, 400, 701]
    slip.reset()
    parts = [slip.next(x[:, a:b], moving[a:b]) for a, b in pairwise(cuts)]
    for name in whole._fields:
        pieces = np.concatenate([getattr(part, name) for part in parts], axis=1)
        assert np.array_equal(pieces, getattr(whole, name)), name
    again = slip.process(x, moving)
    assert all(np.array_equal(a, b) for a, b in zip(whole, again))


def test_slip_is_the_engines():
    """The peak-to-peak of complete windows, against PyWavelets."""
    x = np.random.default_rng(5).integers(-40, 40, (2, 640))
    config = meissner.SlipConfig(window=64, hop=64, threshold=140)
    p2p = meissner.Slip(config, channels=2).process(x).p2p[:, 31::32]
    expected = np.rint(engines.process_slip(x, config, "float")["p2p"])
    assert np.array_equal(p2p, expected) and (expected > 140).any()


def test_cop_by_hand():
    """A force of 900 at row 1 of 4, column 6 of 8: x = 5/7, y = 1/3 in units of 16384."""
    forces = np.zeros((2, 4, 8), int)
    forces[0, 1, 6] = 900
    found = meissner.Cop(min_load=900).process(forces)
    assert (found.x.tolist(), found.y.tolist()) == ([11703, 0], [5461, 0])
    assert (found.load.tolist(), found.pressed.tolist()) == ([900, 0], [True, False])
    assert not meissner.Cop(min_load=901).next(forces).pressed.any()


def test_array_by_hand():
    """F = (code - offset) gain / 2^12, half up; the dead cell gives 0."""
    calibration = meissner.Calibration(
        offset=np.array([[10, 20, 30]]),
        gain=np.array([[4096, 8192, 2048]]),
        gain_shift=12,
        dead=np.array([[False, False, True]]),
        force_lsb_n=0.01,
    )
    array = meissner.Array(calibration)
    codes = np.array([[[13, 21, 500]]])
    assert array.forces(codes).tolist() == [[[3, 2, 0]]]
    found = array.process(codes)
    assert (found.load.tolist(), found.x.tolist(), found.y.tolist()) == ([5], [-9830], [0])  # -3/5


def test_cop4_is_what_the_voltages_say():
    """The voltages come from the mesh's own solver: one point at column 3 of 5, row 1 of 4."""
    mesh = Mesh(4, 5, 10.0, 1e3, 5.0, 4320.0)
    config = Cop4Config(mesh, Adc(16, -5.0, 5.0), gain=0.9)
    load = np.zeros((1, 4, 5))
    load[0, 1, 3] = 6.0
    solution = mesh.solve(load)
    volts = np.stack([solution.E1, solution.E2, solution.E3, solution.E4], axis=-1)
    found = meissner.Cop4(config).process(config.convert(volts))
    assert found.pressed.all()
    assert abs(found.x[0] / 16384 - 0.5) < 0.01 and abs(found.y[0] / 16384 - 1 / 3) < 0.01
    assert abs(found.load[0] * config.load_lsb_n - 6) < 0.3


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: meissner.Slip(channels=2).next([1, 2]), r"shape \[2, samples\], not \(1, 2\)"),
        (lambda: meissner.Slip().next([0.5, 1]), "must be integers, not float64"),
        (lambda: meissner.Slip().next([65536, 1]), "lie in 1 .. 65536, outside -65536 .. 65535"),
        (lambda: meissner.Slip().next([-65537, 1]), "outside -65536 .. 65535"),
        (lambda: meissner.Slip().next([1, 2], [True]), r"moving must have the shape \(2,\)"),
        (lambda: meissner.Slip(channels=0), "channels = 0 must lie in"),
        (lambda: meissner.Cop().next([[1, 2]]), r"not \(1, 2\)"),
        (lambda: meissner.Cop().next([[[65536]]]), "integers in 0 .. 65535"),
        (lambda: meissner.Cop().next([[[-1]]]), "integers in 0 .. 65535"),
        (lambda: meissner.nothing, "has no attribute 'nothing'"),
    ],
)
def test_refuses_in_one_sentence(call, says):
    with pytest.raises((ValueError, AttributeError), match=says) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", engines.EVERY)
def test_every_engine_has_what_the_protocol_says(name):
    """The same parameters in the same order, followed by waves in the engines that have signals."""
    module = engines.load(name)
    asked = [item for item in vars(Engine).items() if inspect.isfunction(item[1]) and item[0][0] != "_"]
    assert len(asked) == 7
    for function, declared in asked:
        own = list(inspect.signature(getattr(module, function)).parameters)
        wanted = list(inspect.signature(declared).parameters)[1:]
        signals = ["waves"] if name in engines.VERILATED and function.startswith("cop") else []
        assert own == wanted + signals, function


def test_limits_are_met_exactly():
    assert meissner.Slip().next([65535, -65536]).p2p.shape == (1, 1)
    assert meissner.Cop().next([[[65535, 0]]]).load.tolist() == [65535]
