"""The C++ drivers pass each setting at its full width: above 2^16, at each field's top and its bottom; what is
wider than a port is refused, not cut. Expected values are worked out from the formulas of docs/, sample by sample;
of the four electrodes from the twin, which no driver is part of."""

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from meissner.cop.cop4 import Cop4Registers, cop4
from meissner.cop.cop_slip import CopSlip, CopSlipRegisters
from meissner.engines import rtl, rtl_cop, rtl_cop4
from meissner.slip.config import SlipConfig

LOW, HIGH = -65_536, 65_535  # of samples
ALWAYS = {
    "contact_level": -(1 << 17),
    "release_level": -(1 << 17),
}  # a sum is at least that: contact above it
QUIET = 4


def states(codes, **settings):
    config = SlipConfig(4, 4, 1, **{"threshold": 262_143, "gross_threshold": 262_143} | ALWAYS | settings)
    return rtl.watch(np.array([codes]), config)


def steps(swing, count=8):
    """Samples in pairs whose details are swing/2 and -swing/2 in turn: windows of two details have that swing."""
    half = swing // 2
    pair = [half // 2, half // 2 - half]
    other = [pair[1] + (swing - 2 * half), pair[0]]
    return [*pair, pair[1], pair[0] + (swing - 2 * half)] * count, other


@pytest.mark.parametrize(
    "threshold", [300, 65_535, 65_536, 65_836, 131_072, 200_000, 262_141, 262_142, 262_143]
)
@pytest.mark.parametrize("name", ["threshold", "gross_threshold"])
def test_thresholds(name, threshold):
    """A swing of the threshold is not over it, one code more is. Samples reach a swing of 2·131071 = 262142."""
    for swing in {min(threshold, 262_142), min(threshold + 1, 262_142), 400}:
        d = -(-swing // 2), swing // 2  # a detail and the next are d[0], -d[1]
        codes = []
        for detail in (d[0], -d[1]) * 8:
            a = detail // 2
            codes += [a, a - detail]
        assert LOW <= min(codes) and max(codes) <= HIGH
        others = {"threshold": 0} if name == "gross_threshold" else {}
        found = states(codes, **others | {name: threshold})
        assert found.p2p.max() == swing
        state = 3 if name == "gross_threshold" else 2
        assert (found.state == state).any() == (swing > threshold), (swing, threshold)


@pytest.mark.parametrize(
    "level, total, contact",
    [(131_069, 131_070, True), (131_070, 131_070, False), (131_071, 131_070, False), (65_536 + 9, 20, False)]
    + [(65_535, 65_536, True), (65_536, 65_536, False), (-65_537, -65_536, True), (-131_072, -131_071, True)]
    + [(-70_000, -70_000, False), (-70_001, -70_000, True)],
)
def test_levels(level, total, contact):
    codes = [total // 2, total - total // 2] * 8
    found = states(codes, contact_level=level, release_level=-(1 << 17))
    assert (found.state > 0).any() == contact
    falling = states(
        [-code for code in codes],
        contact_level=-level if level > -131_072 else 131_071,
        release_level=131_071,
        contact_rises=False,
    )
    assert level == -131_072 or (falling.state > 0).any() == contact


def lengths(settings, quiet):
    """Details with a flag after one swing of 1000, then so many details of quiet, and another swing."""
    swing = [500, 0, 0, 500]
    codes = [0] * 8 + swing + [0] * (2 * quiet) + swing + [0] * 80
    return states(codes, threshold=900, **settings).state[0]


def test_hold_lasts_to_its_top():
    shown = {hold: np.count_nonzero(lengths({"hold": hold}, 65_600) == 2) for hold in (0, 300, 65_535)}
    # Both swings hold: the first for all of the time, the second to the end of the samples at most.
    first = {
        hold: int(np.flatnonzero(np.diff((lengths({"hold": hold}, 65_600) == 2).astype(int)) == -1)[0])
        for hold in shown
    }
    assert first[300] - first[0] == 300 and first[65_535] - first[0] == 65_535


def test_refractory_lasts_to_its_top():
    """A swing that comes in the last detail of deafness is not called, one detail later it is."""

    def called(refractory, quiet):
        state = lengths({"refractory": refractory}, quiet)
        return int(np.count_nonzero(np.diff((state == 2).astype(int)) == 1))

    first = {}
    for refractory in (300, 65_535):
        counts = {quiet: called(refractory, quiet) for quiet in range(refractory - 6, refractory + 7, 2)}
        assert set(counts.values()) == {1, 2} and sorted(counts.values()) == list(counts.values())
        first[refractory] = min(quiet for quiet, count in counts.items() if count == 2) - refractory
    assert abs(first[300] - first[65_535]) <= 1


def test_wider_settings_are_refused():
    parameters = rtl._parameters(1, SlipConfig())
    for name, value in (
        *(("threshold", 1 << 18), ("gross_threshold", (1 << 32) + 5), ("contact_level", 1 << 17)),
        *(("release_level", -(1 << 17) - 1), ("hold", 1 << 16), ("refractory", (1 << 32) + 7), ("blank", -1)),
        *(("contact_rises", 2), ("contact_level", (1 << 40) + 1)),
    ):
        config = SimpleNamespace(**vars(SlipConfig()) | {name: value})
        with pytest.raises(ValueError, match="wider than the core has bits for"):
            rtl.Core(parameters, config)


def test_least_loads():
    """15 taxels of 65535 are 983025, in 20 bits."""
    forces = np.full((1, 3, 5), 65_535)
    for least, valid in ((983_025, True), (983_026, False), (1_048_575, False), (65_536, True), (0, True)):
        found = rtl_cop.cop(forces, least)
        assert (found["sum"][0], found["valid"][0]) == (983_025, valid), least
    for least in (1 << 20, (1 << 32) + 5, 1 << 40, -1):
        with pytest.raises(ValueError, match="wider than the core has bits for"):
            rtl_cop.cop(forces, least)


# Codes in the middle of the range, and tops: of 17 bits, 4, 16, 18 (the largest imbalance), 17 signed.
PLAIN = Cop4Registers(120_000, 70_001, 3, 80_003, 2, 90_007, 7, 65_000, 65_001, 64_000, 5000, 3)
TOPS = {
    **dict.fromkeys(("rail", "kx", "ky", "kf"), 131_071),
    **dict.fromkeys(("shift_x", "shift_y", "shift_load"), 15),
    **{"top": 65_535, "min_load": 65_535, "imbalance": 262_143, "idle": 65_535, "busy": 65_535},
}
BOTTOMS = {"idle": -65_536, "busy": -65_536, "rail": 65_537, "kx": 65_536, "ky": 65_537, "kf": 65_538}


def electrodes():
    rng = np.random.default_rng(5)
    codes = rng.integers(-65_536, 65_536, (300, 4))
    near = 60_000 - rng.integers(0, 9000, (300, 4)) * np.array([1, 1, 1, 1])
    near[:, 2] = near[:, 0] - rng.integers(0, 500, 300)
    near[:, [1, 3]] *= -1
    return np.concatenate([codes, near])


@pytest.mark.parametrize("ends", [TOPS, BOTTOMS], ids=["tops", "bottoms"])
def test_registers_of_four_electrodes(ends):
    codes = electrodes()
    assert set(TOPS) == {field.name for field in fields(Cop4Registers)}
    base = rtl_cop4.cop4(codes, SimpleNamespace(sample_bits=17, terms=None, registers=PLAIN))
    seen = 0
    for name, value in ends.items():
        registers = replace(PLAIN, **{name: value})
        found = rtl_cop4.cop4(codes, SimpleNamespace(sample_bits=17, terms=None, registers=registers))
        for got, expected, before in zip(found, cop4(codes, registers), base):
            assert np.array_equal(got, expected), name
            seen += not np.array_equal(got, before)
    assert seen >= 5


def test_wider_registers_of_four_electrodes_are_refused():
    codes = electrodes()[:4]
    for name, value in TOPS.items():
        for wrong in (value + 1, (1 << 32) + 1, (1 << 40) + value):
            registers = replace(PLAIN, **{name: wrong})
            with pytest.raises(ValueError, match="wider than the core has bits for"):
                rtl_cop4.cop4(codes, SimpleNamespace(sample_bits=17, terms=None, registers=registers))


def test_registers_of_slip_from_the_load():
    """Through msn_cop4 as ``PLAIN`` sets it; each field at its top, beside the twin's."""
    codes = electrodes()
    config = SimpleNamespace(sample_bits=17, terms=None, registers=PLAIN)
    place = cop4(codes, PLAIN)
    plain = CopSlipRegisters(drop=20, move=0, min_load=1, hold=2, refractory=1)
    tops = {"drop": 255, "move": 65_535, "min_load": 65_535, "hold": 65_535, "refractory": 65_535}
    for name, value in tops.items():
        registers = replace(plain, **{name: value})
        _, found = rtl_cop4.cop_slip(codes, config, 4, registers)
        expected = CopSlip(4, registers).process(place.x, place.y, place.load, place.pressed)
        for got, want in zip(found, expected):
            assert np.array_equal(got, want), name
        for wrong in (value + 1, (1 << 32) + 1, -1):
            with pytest.raises(ValueError, match="wider than the core has bits for"):
                rtl_cop4.cop_slip(codes[:4], config, 4, replace(plain, **{name: wrong}))
