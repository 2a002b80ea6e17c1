"""The converter's transfer function, exactly: every transition of both parts, the ends, over-range, noise
statistics."""

import numpy as np
import pytest
from scipy import signal

from meissner.physics.adc import PARTS, Adc, LowPass, old_rows, unsettled


@pytest.mark.parametrize("part", PARTS)
def test_every_code_is_centred_on_its_voltage(part):
    adc = PARTS[part]
    codes = np.arange(adc.min_code, adc.max_code + 1)
    centre = adc.volts_of(codes)
    for offset in (-0.499, 0.0, 0.499):
        converted, over = adc.convert(np.clip(centre + offset * adc.lsb_v, adc.low_v, adc.high_v))
        assert np.array_equal(converted, codes)
        assert converted.dtype == np.int64
        assert not over.any()
    # Above the middle between two codes, the upper code results.
    assert np.array_equal(adc.convert(centre[:-1] + 0.501 * adc.lsb_v)[0], codes[1:])


def test_a_half_rounds_up():
    adc = Adc(bits=3, low_v=-4.0, high_v=4.0)  # 1 V a code: halves are exact
    assert adc.convert(np.array([-4.0, -3.5, -0.5, 0.5, 2.5]))[0].tolist() == [-4, -3, 0, 1, 3]


def test_ranges_of_the_parts():
    assert (PARTS["MCP3208"].min_code, PARTS["MCP3208"].max_code) == (0, 4095)
    assert (PARTS["AD7606"].min_code, PARTS["AD7606"].max_code) == (-32768, 32767)
    assert PARTS["MCP3208"].lsb_v == 5 / 4096
    assert PARTS["AD7606"].lsb_v == PARTS["AD7606C-16"].lsb_v == 10 / 65536
    assert (PARTS["AD7606C-16"].min_code, PARTS["AD7606C-16"].noise_v) == (-32768, 0.172e-3)


@pytest.mark.parametrize("part", PARTS)
def test_over_range_saturates_and_is_flagged(part):
    adc = PARTS[part]
    volts = np.array([adc.low_v - 0.1, adc.low_v, 0.5, adc.high_v, adc.high_v + 0.1])
    codes, over = adc.convert(volts, np.random.default_rng(1))
    assert over.tolist() == [True, False, False, False, True]
    assert codes[0] == adc.min_code and codes[-1] == adc.max_code


@pytest.mark.parametrize("part", PARTS)
def test_noise_has_the_stated_size_and_is_seeded(part):
    adc = PARTS[part]
    volts = np.random.default_rng(2).uniform(0.5, 4.5, 200_000)
    codes, _ = adc.convert(volts, np.random.default_rng(3))
    error = adc.volts_of(codes) - volts
    expected = np.hypot(adc.noise_v, adc.lsb_v / np.sqrt(12))
    assert abs(error.mean()) < 5 * expected / np.sqrt(len(volts))
    assert error.std() == pytest.approx(expected, rel=0.01)
    assert np.array_equal(codes, adc.convert(volts, np.random.default_rng(3))[0])


@pytest.mark.parametrize(
    "bad", [{"bits": 0}, {"bits": 25}, {"low_v": 1.0}, {"high_v": -5.0}, {"noise_v": -1e-3}]
)
def test_a_converter_that_cannot_be_is_refused(bad):
    with pytest.raises(ValueError, match="must"):
        Adc(**{"bits": 12, "low_v": 0.0, "high_v": 5.0, "noise_v": 0.0, **bad})


@pytest.mark.parametrize(
    "volts, corner_hz, left, carrier", [(5.0, 15e3, 0.9116, 0.00562), (10.0, 23e3, 0.8167, 0.0132)]
)
def test_the_low_pass_of_an_ad7606(volts, corner_hz, left, carrier):
    """SciPy's Butterworth filter of second order; what a step leaves after 5 us, and what passes of a carrier
    of 200 kHz (docs/demod.md), as literals."""
    one = LowPass(corner_hz)
    made = signal.butter(2, 2 * np.pi * corner_hz, analog=True)
    time_s, step = signal.step(made, T=np.linspace(0, 200e-6, 101))
    assert [one.left(t) for t in time_s] == pytest.approx(1 - step, abs=1e-6)
    hertz = np.array([0.0, 1e3, corner_hz, 200e3])
    assert [one.gain(f) for f in hertz] == pytest.approx(abs(signal.freqs(*made, 2 * np.pi * hertz)[1]))
    found = {"range_v": volts, "corner_hz": corner_hz, "left": pytest.approx(left, abs=5e-5)}
    assert old_rows("ad7606", 5e-6, volts) == [found]
    assert one.gain(200e3) == pytest.approx(carrier, rel=2e-3)
    late = [abs(one.left(t)) for t in np.linspace(one.settled_s(0.01), 1e-3, 500)]
    assert max(late) <= 0.01 and one.left(0.9 * one.settled_s(0.043)) < -0.04


def test_a_range_between_two_takes_the_wider():
    of = lambda volts: [row["range_v"] for row in old_rows("AD7606", 5e-6, volts)]
    found = {volts: of(volts) for volts in (1.0, 5.0, 5.01, 10.0, 12.0, None)}
    assert found == {1.0: [5.0], 5.0: [5.0], 5.01: [10.0], 10.0: [10.0], 12.0: [10.0], None: [5.0, 10.0]}
    assert old_rows("MCP3208", 0.0) == []
    (wide,) = old_rows("ad7606c-16", 5e-6, 10.0)  # w = sqrt(2) pi 220 kHz 5 us = 4.8872
    assert wide == {"range_v": 5.0, "corner_hz": 220e3, "left": pytest.approx(0.00612, abs=5e-6)}


def test_what_is_said_of_a_row_that_has_not_settled():
    """1 % is settled. ln(100 sqrt(2)) / (sqrt(2) pi f) is 74.30 us at 15 kHz and 48.46 us at 23 kHz."""
    rows = [
        {"range_v": 5.0, "corner_hz": 15e3, "left": 0.01},
        {"range_v": 10.0, "corner_hz": 23e3, "left": 0.0},
    ]
    assert unsettled("ad7606", 5e-6, rows) == unsettled("mcp3208", 5e-6, []) == ""
    rows[0]["left"] = 0.0101
    assert unsettled("ad7606", 5e-6, rows).endswith("1 % is left after 75 us")
    rows[0]["left"], rows[1]["left"] = 0.0, 0.0101
    told = unsettled("ad7606", 5e-6, rows)
    assert "leaves 0 % (±5 V, 15 kHz) or 1.01 % (±10 V, 23 kHz) of the old row 5 us after" in told
    assert unsettled("ad7606", 5e-6, rows[1:]).endswith("1 % is left after 49 us")
