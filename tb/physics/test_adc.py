"""The converter's transfer function, exactly: every transition of both parts, the ends, over-range, noise
statistics."""

import numpy as np
import pytest

from meissner.physics.adc import PARTS, Adc


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
