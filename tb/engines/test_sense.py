"""The public interface: results by hand, equal results in pieces of any size and in one call, and refused
input."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

import meissner
from meissner import engines, sense
from meissner.physics.adc import Adc
from meissner.physics.mesh import Mesh
from meissner.twins.slip.slip import State

# Level 1: d = x0 - x1, a = x0 + x1; a window of 4 samples has 2 details.
CONFIG = meissner.SlipConfig(
    window=4, hop=4, level=1, threshold=9, gross_threshold=30, contact_level=100, release_level=90
)
SAMPLES = [50, 50, 55, 50, 60, 50, 52, 60, 50, 50, 40, 40]
DETAILS = [0, 5, 10, -8, 0, 0]
P2P = [0, 5, 0, 18, 0, 0]  # each window alone: |5 - 0|, |-8 - 10|, 0
LINES = meissner.Calibration(
    offset=np.array([[10, 20, 30]]),
    gain=np.array([[4096, 8192, 2048]]),
    gain_shift=12,
    dead=np.array([[False, False, True]]),
    force_lsb_n=0.01,
)
MESH = Mesh(4, 5, 10.0, 1e3, 5.0, 4320.0)
WIRES = meissner.Cop4Config(MESH, Adc(16, -5.0, 5.0), gain=0.9)
STATES = [State.CONTACT, State.CONTACT, State.CONTACT, State.INCIPIENT, State.CONTACT, State.RELEASE]


def test_slip_by_hand():
    found = meissner.Slip(CONFIG).process(SAMPLES)
    assert found.running_p2p.tolist() == [P2P]
    assert found.state.tolist() == [STATES]
    assert found.slipping.tolist() == found.raised.tolist() == [[False, False, False, True, False, False]]


def test_windows_by_hand():
    """Windows of 8 samples have 4 details: 0, 5, 10, -8, of which the third exceeds 9, at sample 5; then 0, 0
    and 10, -10. Overlapping windows fire at their end."""
    config = dataclasses.replace(CONFIG, window=8, hop=8)
    slip = meissner.Slip(config)
    first, second = slip.next(SAMPLES), slip.next([50, 40, 40, 50])
    for found, p2p, end, fired in ((first, 18, 7, 5), (second, 20, 15, 13)):
        assert found.p2p.tolist() == [[p2p]] and found.window_end.tolist() == [end]
        assert found.slip.tolist() == [[True]] and found.fired_at.tolist() == [[fired]]
    for threshold, fired in ((10, 7), (17, 7), (18, -1)):  # 10 and 18 are reached, but not exceeded
        found = meissner.Slip(dataclasses.replace(config, threshold=threshold)).process(SAMPLES)
        assert (found.slip.tolist(), found.fired_at.tolist()) == ([[fired == 7]], [[fired]])
    found = meissner.Slip(dataclasses.replace(config, hop=4)).process(SAMPLES)
    assert (found.p2p.tolist(), found.window_end.tolist()) == ([[18, 18]], [7, 11])
    assert found.fired_at.tolist() == [[7, 11]]
    found = meissner.Slip(CONFIG).process(SAMPLES)
    assert (found.p2p.tolist(), found.window_end.tolist()) == ([[5, 18, 0]], [3, 7, 11])
    assert (found.slip.tolist(), found.fired_at.tolist()) == ([[False, True, False]], [[-1, 7, -1]])


def test_a_hand_that_moves_raises_no_slip():
    """``moving`` counts at the last sample of a detail: at sample 7, not at sample 6."""
    for at, slips in ((7, False), (6, True)):
        moving = np.arange(12) == at
        assert meissner.Slip(CONFIG).process(SAMPLES, moving).slipping.any() == slips


@pytest.mark.parametrize("level, window, hop", [(1, 16, 16), (2, 32, 16), (3, 64, 8)])
def test_pieces_give_what_the_whole_gives(level, window, hop):
    rng = np.random.default_rng(level)
    x, moving = rng.integers(-300, 300, (3, 701)), rng.random(701) < 0.1
    config = meissner.SlipConfig(window=window, hop=hop, level=level, threshold=700, blank=2, hold=3)
    slip = meissner.Slip(config, channels=3)
    whole = slip.process(x, moving)
    assert whole.raised.any() and not whole.slipping.all()
    cuts = [0, 1, 2, 2, 9, 50, 51, 400, 701]
    slip.reset()
    parts = [slip.next(x[:, a:b], moving[a:b]) for a, b in pairwise(cuts)]
    for name in whole._fields:
        pieces = np.concatenate([getattr(part, name) for part in parts], axis=-1)
        assert np.array_equal(pieces, getattr(whole, name)), name
    again = slip.process(x, moving)
    assert all(np.array_equal(a, b) for a, b in zip(whole, again))


@pytest.mark.parametrize("level, hop, threshold", [(1, 64, 140), (1, 32, 140), (2, 16, 190), (3, 64, 240)])
def test_slip_is_the_engines(level, hop, threshold):
    """The arrays of ``meissner process slip``, against PyWavelets, in pieces; the last window stays open."""
    x = np.random.default_rng(5).integers(-40, 40, (2, 1311))
    config = meissner.SlipConfig(window=64, hop=hop, level=level, threshold=threshold)
    slip = meissner.Slip(config, channels=2)
    parts = [slip.next(part) for part in np.split(x, [3, 3, 30, 700, 801], axis=1)]
    expected = engines.process_slip(x, config, "float")
    assert list(expected) == ["p2p", "window_end", "slip", "fired_at"]
    assert expected["slip"].any() and not expected["slip"].all()
    for name in expected:
        found = np.concatenate([getattr(part, name) for part in parts], axis=-1)
        assert found.dtype == (bool if name == "slip" else np.int64)
        assert np.array_equal(found, np.rint(expected[name])), name


def test_cop_by_hand():
    """A force of 900 at row 1 of 4, column 6 of 8: x = 5/7, y = 1/3 in units of 16384."""
    forces = np.zeros((2, 4, 8), int)
    forces[0, 1, 6] = 900
    found = meissner.Cop(min_load=900).process(forces)
    assert (found.x.tolist(), found.y.tolist()) == ([11703, 0], [5461, 0])
    assert (found.sum.tolist(), found.valid.tolist()) == ([900, 0], [True, False])
    assert (found.mx.tolist(), found.my.tolist()) == ([4500, 0], [900, 0])  # 2·6 - 7 and 3 - 2·1 times 900
    assert not meissner.Cop(min_load=901).next(forces).valid.any()


def test_results_have_the_names_of_the_files():
    """The arrays are those of ``meissner process``, of the same kinds of numbers (docs/decisions/host.md)."""
    assert {"sum", "mx", "my", "x", "y", "valid"} <= set(sense.CopResult._fields)
    assert {"x", "y", "load", "valid"} <= set(sense.Cop4Result._fields)
    assert {"window_end", "slip", "fired_at"} <= set(sense.SlipResult._fields)
    forces = np.random.default_rng(6).integers(0, 9, (20, 3, 5))
    found = meissner.Cop(min_load=60).process(forces)
    assert found.valid.any() and not found.valid.all()
    for name, array in engines.process_cop(forces, "float", min_load=60).items():
        own = getattr(found, name)
        assert np.array_equal(own, array) and own.dtype == engines.process_cop(forces, "fixed")[name].dtype


def test_array_by_hand():
    """F = (code - offset) gain / 2^12, half up; the dead cell gives 0."""
    array = meissner.Array(LINES)
    codes = np.array([[[13, 21, 500]]])
    assert array.forces(codes).tolist() == [[[3, 2, 0]]]
    found = array.process(codes)
    assert (found.sum.tolist(), found.x.tolist(), found.y.tolist()) == ([5], [-9830], [0])  # -3/5
    valid = [meissner.Array(LINES, min_load=least).process(codes).valid.tolist() for least in (5, 6)]
    assert valid == [[True], [False]]


def test_cop4_is_what_the_voltages_say():
    """The voltages come from the mesh's own solver: one point at column 3 of 5, row 1 of 4."""
    load = np.zeros((1, 4, 5))
    load[0, 1, 3] = 6.0
    solution = MESH.solve(load)
    volts = np.stack([solution.E1, solution.E2, solution.E3, solution.E4], axis=-1)
    found = meissner.Cop4(WIRES).process(WIRES.convert(volts))
    assert found.valid.all()
    assert not (found.over | found.saturated | found.imbalance | (found.open > 0)).any()
    assert abs(found.x[0] / 16384 - 0.5) < 0.01 and abs(found.y[0] / 16384 - 1 / 3) < 0.01
    assert abs(found.load[0] * WIRES.load_lsb_n - 6) < 0.3


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: meissner.Slip(channels=2).next([1, 2]), r"shape \[2, samples\], not \(1, 2\)"),
        (lambda: meissner.Slip().next([0.5, 1]), "must be integers, not float64"),
        (lambda: meissner.Slip().next([65536, 1]), "outside"),
        (lambda: meissner.Slip().next([-65537, 1]), "outside"),
        (lambda: meissner.Slip().next([1, 2], [True]), "moving"),
        (lambda: meissner.Slip().next([1, 2], [0.5, 1]), "the values of moving"),
        (lambda: meissner.Slip(channels=0), "channels = 0"),
        (lambda: meissner.Slip(channels=1.5), r"channels = 1\.5"),
        (lambda: meissner.Slip(config=3), "config"),
        (lambda: meissner.Cop().next([[1, 2]]), r"not \(1, 2\)"),
        (lambda: meissner.Cop().next([[[65536]]]), "outside"),
        (lambda: meissner.Cop().next([[[-1]]]), "outside"),
        (lambda: meissner.Cop().next(np.full((1, 2, 2), 2**63, np.uint64)), "outside"),
        (lambda: meissner.Cop().next(np.full((1, 2, 2), "a")), "integers"),
        (lambda: meissner.Cop().next([[[1.0]]]), "the forces"),
        (lambda: meissner.Cop().next(np.zeros((0, 2, 2), int)), r"not \(0, 2, 2\)"),
        (lambda: meissner.Cop().next(np.zeros((1, 1025, 1), int)), "1025 rows"),
        (lambda: meissner.Cop(min_load=-1), "min_load = -1"),
        (lambda: meissner.Cop(min_load=1 << 36), "min_load = 68719476736"),
        (lambda: meissner.Cop(min_load=1.5), r"min_load = 1\.5"),
        (lambda: meissner.Cop(1 << 19).next([[[1] * 8]]), "min_load = 524288"),
        (lambda: meissner.Array(LINES, -5), "min_load = -5"),
        (lambda: meissner.Array(LINES, 1 << 18), "min_load = 262144"),
        (lambda: meissner.Array(LINES, "1"), "min_load = 1"),
        (lambda: meissner.Array(3), "calibration"),
        (lambda: meissner.Array(LINES).next([[[1.0, 2, 3]]]), "the codes"),
        (lambda: meissner.Array(LINES).next([[[65536, 2, 3]]]), "outside"),
        (lambda: meissner.Array(LINES).next([[[1, 2]]]), "1×3"),
        (lambda: meissner.Cop4(3), "config"),
        (lambda: meissner.Cop4(WIRES).next([[1.0, 2, 3, 4]]), "the codes"),
        (lambda: meissner.Cop4(WIRES).next([[1, 2, 3]]), r"not \(1, 3\)"),
        (lambda: meissner.Cop4(WIRES).next([[32768, 0, 0, 0]]), "outside"),
        (lambda: meissner.Cop4Config(MESH, 16, 0.9), "adc"),
        (lambda: meissner.Cop4Config("mesh", WIRES.adc, 0.9), "mesh"),
        (lambda: dataclasses.replace(LINES, offset=[1, 2, 3]), "offset"),
        (lambda: dataclasses.replace(LINES, gain=LINES.gain + 0.5), "gain"),
        (lambda: dataclasses.replace(LINES, dead=LINES.gain), "dead"),
        (lambda: dataclasses.replace(LINES, gain_shift=1.5), r"gain_shift = 1\.5"),
        (lambda: meissner.nothing, "nothing"),
    ],
)
def test_refuses_in_one_sentence(call, says):
    with pytest.raises((ValueError, TypeError, AttributeError), match=says) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_limits_are_met_exactly():
    assert meissner.Slip().next([65535, -65536]).running_p2p.shape == (1, 1)
    assert meissner.Cop().next([[[65535, 0]]]).sum.tolist() == [65535]
    assert meissner.Cop((1 << 19) - 1).next([[[1] * 8]]).sum.tolist() == [8]
    assert not meissner.Cop((1 << 36) - 1).next(np.ones((1, 1024, 1024), int)).valid.any()
    assert meissner.Array(LINES, (1 << 18) - 1).next([[[-65536, 65535, 0]]]).sum.tolist() == [65535]
    assert meissner.Cop4(WIRES).next([[-32768, 32767, 0, 0]]).saturated.all()


def test_refused_samples_leave_the_state_and_empty_ones_are_taken():
    slip = meissner.Slip(CONFIG)
    slip.next(SAMPLES[:5])
    for refused in ([0.5], [65536]):
        with pytest.raises(ValueError):
            slip.next(refused)
    assert slip.next([]).running_p2p.shape == slip.next([], []).state.shape == (1, 0)
    found = slip.next(SAMPLES[5:])
    assert (found.running_p2p.tolist(), found.window_end.tolist()) == ([P2P[2:]], [7, 11])
