"""The C++ drivers pass each setting at its full width: above 2^16, at each field's top and bottom.

A value wider than its port is refused, not truncated. The effect of a setting is worked out here, except for
four electrodes, where it is the twin's, which shares no code with a driver. Latencies are those of
docs/adc.md and of the headers, to the clock.
"""

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from meissner.engines import Carrier, rtl_cop, rtl_cop4, rtl_frontend, rtl_slip
from meissner.twins.cop.cop4 import Cop4Registers, cop4
from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters
from meissner.twins.frontend import adc_spi
from meissner.twins.frontend.am_demod import AmDemod
from meissner.twins.slip.config import SlipConfig

LOW, HIGH = -65_536, 65_535  # samples
ALWAYS = {
    "contact_level": -(1 << 17),
    "release_level": -(1 << 17),
}  # the lowest sum, so always in contact


def states(codes, **settings):
    config = SlipConfig(4, 4, 1, **{"threshold": 262_143, "gross_threshold": 262_143} | ALWAYS | settings)
    return rtl_slip.watch(np.array([codes]), config)


@pytest.mark.parametrize(
    "threshold", [300, 65_535, 65_536, 65_836, 131_072, 200_000, 262_141, 262_142, 262_143]
)
@pytest.mark.parametrize("name", ["threshold", "gross_threshold"])
def test_thresholds(name, threshold):
    """A swing equal to the threshold is not over it, one code more is. Samples swing by 2·131071 at most."""
    for swing in {min(threshold, 262_142), min(threshold + 1, 262_142), 400}:
        d = -(-swing // 2), swing // 2  # detail d[0], then -d[1]
        codes = []
        for detail in (d[0], -d[1]) * 8:
            a = detail // 2
            codes += [a, a - detail]
        assert min(codes) >= LOW and max(codes) <= HIGH
        others = {"threshold": 0} if name == "gross_threshold" else {}
        found = states(codes, **others | {name: threshold})
        assert found.p2p.max() == swing
        state = 3 if name == "gross_threshold" else 2
        assert (found.state == state).any() == (swing > threshold), (swing, threshold)


@pytest.mark.parametrize("keep", [300, 65_536, 70_000, 199_999])
def test_the_lower_threshold(keep):
    """A raised flag stays up with a swing one above the lower threshold, and ends with a swing equal to
    it."""
    for swing, stays in ((keep + 1, True), (keep, False)):
        codes = []
        for size in (200_001, swing, swing):
            for detail in (-(-size // 2), -(size // 2)):
                codes += [detail // 2, detail // 2 - detail]
        found = states(codes, threshold=200_000, keep_threshold=keep, hold=1)  # a window starts unflagged
        assert found.state[0][1] == 2 and (found.state[0][-1] == 2) == stays, swing


@pytest.mark.parametrize(
    "level, total, contact",
    [
        *((131_070, 131_070, True), (131_071, 131_070, False), (65_536 + 20, 20, False), (20, 20, True)),
        *((65_536, 65_536, True), (65_537, 65_536, False), (-65_536, -65_536, True), (0, -65_536, False)),
        *((-70_000, -70_000, True), (-69_999, -70_000, False), (-131_071, -131_071, True)),
    ],
)
def test_levels(level, total, contact):
    """Contact at and above the level; at and below it, if codes fall with the force."""
    codes = [total // 2, total - total // 2] * 8
    found = states(codes, contact_level=level, release_level=-131_072)
    assert (found.state > 0).any() == contact
    fallen = {"contact_level": -level, "release_level": 131_071, "contact_rises": False}
    assert (states([-code for code in codes], **fallen).state > 0).any() == contact


def lengths(settings, quiet):
    """State after one swing of 1000, ``quiet`` quiet details, and another swing."""
    swing = [500, 0, 0, 500]
    codes = [0] * 8 + swing + [0] * (2 * quiet) + swing + [0] * 80
    return states(codes, threshold=900, **settings).state[0]


def test_hold_lasts_to_its_top():
    shown = {hold: np.count_nonzero(lengths({"hold": hold}, 65_600) == 2) for hold in (0, 300, 65_535)}
    # Both swings are held: the first for the full time, the second until the samples end at the latest.
    first = {
        hold: int(np.flatnonzero(np.diff((lengths({"hold": hold}, 65_600) == 2).astype(int)) == -1)[0])
        for hold in shown
    }
    assert first[300] - first[0] == 300 and first[65_535] - first[0] == 65_535


def test_refractory_lasts_to_its_top():
    """The least quiet time, in complete windows of two details, after which a second swing raises the
    flag."""

    def called(refractory, quiet):
        state = lengths({"refractory": refractory}, quiet)
        return np.count_nonzero(np.diff((state == 2).astype(int)) == 1) == 2

    first = {}
    for refractory in (300, 301, 65_534, 65_535):
        near = range(refractory // 2 * 2 - 8, refractory + 9, 2)
        found = [called(refractory, quiet) for quiet in near]
        assert not found[0] and found[-1] and sorted(found) == found
        first[refractory] = near[found.index(True)]
    assert first[65_534] - first[300] == 65_234 == first[65_535] - first[301]
    assert first[301] - first[300] in (0, 2)


def test_wider_settings_are_refused():
    parameters = rtl_slip._parameters(1, SlipConfig())
    for name, value in (
        *(("threshold", 1 << 18), ("gross_threshold", (1 << 32) + 5), ("contact_level", 1 << 17)),
        *(("release_level", -(1 << 17) - 1), ("hold", 1 << 16), ("refractory", (1 << 32) + 7), ("blank", -1)),
        *(("contact_rises", 2), ("contact_level", (1 << 40) + 1), ("keeps_above", 1 << 18)),
    ):
        config = SimpleNamespace(**vars(SlipConfig()) | {"keeps_above": 40} | {name: value})
        with pytest.raises(ValueError, match="wider"):
            rtl_slip.Core(parameters, config)


def test_least_loads():
    """15 taxels of 65535 are 983025, in 20 bits."""
    forces = np.full((1, 3, 5), 65_535)
    for least, valid in ((983_025, True), (983_026, False), (1_048_575, False), (65_536, True), (0, True)):
        found = rtl_cop.cop(forces, least)
        assert (found["sum"][0], found["valid"][0]) == (983_025, valid), least
    for least in (1 << 20, (1 << 32) + 5, 1 << 40, -1):
        with pytest.raises(ValueError, match="wider"):
            rtl_cop.cop(forces, least)


# Mid-range settings; top values of 17 bits, 4, 16, 18 (the largest imbalance), 17 signed.
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
            with pytest.raises(ValueError, match="wider"):
                rtl_cop4.cop4(codes, SimpleNamespace(sample_bits=17, terms=None, registers=registers))


def test_registers_of_slip_from_the_load():
    """Through msn_cop4 with ``PLAIN``; each field at its top, compared with the twin."""
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
            with pytest.raises(ValueError, match="wider"):
                rtl_cop4.cop_slip(codes[:4], config, 4, replace(plain, **{name: wrong}))


@pytest.mark.parametrize(
    "part, level, offered",
    # At 4 MHz half an SCLK is one clock: by docs/adc.md a sample comes 2·19 clocks after convert start, or 3
    # + 2·16 after BUSY, which lasts 16, or 2 with an AD7606C.
    [
        *(("MCP3208", 1, 38), ("MCP3208", 2, 38), ("MCP3208", 3, 38), ("AD7606", 1, 51), ("AD7606", 3, 51)),
        ("AD7606C-16", 1, 37),
    ],
)
def test_latencies_at_the_pins(part, level, offered):
    """A decision comes level + 5 clocks after its sample; the report gives exactly that number."""
    config = SlipConfig(32, 32, level)
    parameters = rtl_slip._parameters(1, config)
    parameters |= {
        "Adc": adc_spi.BY_NAME[part].number,
        "ClkKhz": rtl_slip.PIN_CLK_KHZ,
        "SclkKhz": rtl_slip.PIN_SCLK_KHZ,
    }
    frames = 64
    with rtl_slip.Core(parameters, config) as core:
        _, flags, facts = core.pins(part, np.arange(frames), 401, np.zeros(frames))
    assert len(flags) == frames >> level
    assert facts.decision_min == facts.decision_max == offered + level + 5
    assert facts.period_min == facts.period_max == 401 and facts.frames == frames


def test_calibrations():
    """3 taxels: F = (code - offset)·gain/4096, with the largest offsets and gains; wider ones are refused."""
    codes = np.array([[[0, 100, -65_536]]])
    offset, gain = np.array([[-65_536, 65_535, -65_536]]), np.array([[4095, 65_535, 65_535]])
    dead = np.zeros((1, 3), bool)
    given = {"offset": offset, "gain": gain, "dead": dead, "gain_shift": 12}
    forces = rtl_frontend.calibrate(codes, SimpleNamespace(**given))
    assert forces.tolist() == [[[65_520, 0, 0]]]  # 65536·4095/4096 = 65520
    # Two frames more, with the middle taxel dead and gains of 1.0, 2.0, 3.0.
    gains = {
        "gain": np.array([[4096, 8192, 12_288]]),
        "offset": np.zeros((1, 3)),
        "dead": np.array([[0, 1, 0]]),
    }
    codes = np.array([[[4096, 100, -1]], [[1, 5, 7]], [[2, 6, 8]]])
    forces = rtl_frontend.calibrate(codes, SimpleNamespace(**(given | gains)))
    assert forces.tolist() == [[[4096, 0, 0]], [[1, 0, 21]], [[2, 0, 24]]]
    for name, value in (
        ("offset", 65_536),
        ("offset", -65_537),
        ("gain", 65_536),
        ("gain", (1 << 40) + 4096),
    ):
        wrong = given | {name: np.array([[0, value, 0]])}
        with pytest.raises(ValueError, match="wider"):
            rtl_frontend.calibrate(codes, SimpleNamespace(**wrong))


def test_carriers():
    """A skip of 255 samples, the most in 8 bits; 256 samples and a shift of 32 are refused."""
    block = AmDemod()
    samples = np.concatenate([np.full(255, 30_000), np.tile([1000, 0, -1000, 0], 4)])
    carrier = Carrier(block, 4, 255, 3)
    alone = Carrier(block, 4, 0, 3)
    assert rtl_frontend.demodulate(samples, carrier) == rtl_frontend.demodulate(samples[255:], alone) == 1000
    # Four periods of ±a are a sum of 8a, shifted by 3.
    several = np.array([np.tile([size, 0, -size, 0], 4) for size in (7, 65_535, 1, 300)])
    assert rtl_frontend.demodulate(several, alone).tolist() == [7, 65_535, 1, 300]
    for wrong in (Carrier(block, 4, 256, 3), Carrier(block, 4, 4, 32), Carrier(block, 4, 4, (1 << 32) + 3)):
        with pytest.raises(ValueError, match="wider"):
            rtl_frontend.demodulate(np.zeros(wrong.samples), wrong)
