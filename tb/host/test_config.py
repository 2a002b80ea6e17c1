"""Configurations: the codes that a file's volts, newtons and milliseconds come to, in exact fractions; what a
converter's twin is; every mistake is one sentence that names its table."""

import copy
import tomllib
from fractions import Fraction
from math import floor

import pytest

from meissner import config
from meissner.frontend.adc_spi import AdcSpi
from meissner.slip.config import SAMPLE_BITS


def tables(name):
    return tomllib.loads((config.FOLDER / f"{name}.toml").read_text())


@pytest.mark.parametrize("name", [name for name in config.names() if config.load(name).slip])
def test_codes_are_those_of_the_quantities(name):
    """A threshold holds T·sqrt(2)^level / lsb rounded down: its square tells without a root."""
    build, given = config.load(name), tables(name)
    exact = {key: Fraction(str(value)) for key, value in given["slip"].items() if not isinstance(value, bool)}
    if build.kind == "array":
        unit, lsb = "n", Fraction(str(given["array"]["newtons_per_count"]))
    else:
        unit, lsb = "v", Fraction(str(given["adc"]["volts"])) / (1 << build.part.data_bits)
    group = 1 << build.slip.level
    keeps = f"keep_threshold_{unit}" in exact
    assert (build.slip.keep_threshold is not None) == keeps == ("slip.keep_threshold" in build.settings)
    for key in ("threshold", "gross_threshold", *(["keep_threshold"] if keeps else [])):
        code, square = getattr(build.slip, key), (exact[f"{key}_{unit}"] / lsb) ** 2 * group
        assert code**2 <= square < (code + 1) ** 2, key
    for key in ("contact_level", "release_level"):
        assert abs(getattr(build.slip, key) - group * exact[f"{key}_{unit}"] / lsb) <= Fraction(1, 2), key
    for key in ("hold", "refractory", "blank"):
        details = exact[f"{key}_ms"] / 1000 * Fraction(str(given["adc"]["rate_hz"])) / group
        assert abs(getattr(build.slip, key) - details) <= Fraction(1, 2), key
    assert build.slip.contact_rises == given["slip"].get("contact_rises", build.kind == "array")
    assert floor(1000 * build.clk_khz / given["adc"]["rate_hz"] + 0.5) == build.period_clocks


@pytest.mark.parametrize("name", config.names())
def test_the_converter_is_the_files(name):
    build = config.load(name)
    adc = build.converter
    assert isinstance(adc, AdcSpi) and adc.part is build.part and adc.clk_khz == build.clk_khz
    assert adc.channels == build.adc.get("channels", build.channels) and adc.lanes == build.adc["lanes"]
    assert adc.sample_bits == (13 if build.serial else SAMPLE_BITS)
    assert build.converter is adc


@pytest.mark.parametrize(
    "name, table, change, said",
    [
        ("slip1", "slip", {"window": 48}, "[slip]: window = 48 must be a power of two, 4 or more"),
        ("slip1", "slip", {"level": 4}, "[slip]: level = '4' must be one of: 1, 2, 3"),
        ("slip1", "slip", {"threshold_v": -0.01}, "[slip]: threshold = -12 must not be negative"),
        ("fingertip", "slip", {"threshold_n": 1e9}, "[slip]: threshold = "),
        (
            "slip1",
            "slip",
            {"keep_threshold_v": 0.0201},
            "[slip]: keep_threshold_v = 0.0201 must not be above threshold_v",
        ),
        ("slip1", "slip", {"keep_threshold_v": -0.01}, "[slip]: keep_threshold = -12 must not be negative"),
        ("fingertip", "slip", {"hold_ms": 1e6}, "[slip]: hold = 2000000 must be below 65536"),
        ("fingertip", "slip", {"serial": True}, "[slip]: serial must go with one channel"),
        ("slip1", "slip", {"thresholds": 1.0}, "[slip]: unknown key 'thresholds'; the keys are: "),
        ("slip1", "adc", {"rate_hz": 1e5}, "[adc]: rate_hz = 100000 is too fast: a conversion takes "),
        ("fingertip", "adc", {"rate_hz": 1e5}, "[adc]: rate_hz = 100000 is too fast: a scan takes "),
        ("slip1", "adc", {"part": "MCP"}, "[adc]: part = "),
        ("slip1", "link", {"images": True}, "[link]: images must go with an array"),
        ("slip1", "link", {"baud": 4_000_000}, "[link]: baud = 4000000 must be at most 3000000"),
        ("cop4", "slip", {"window": 64}, "[slip] must not be there with kind = 'electrodes'"),
    ],
)
def test_mistakes_are_answered_by_a_sentence(name, table, change, said):
    given = copy.deepcopy(tables(name))
    given[table] = given.get(table, {}) | change
    with pytest.raises(ValueError) as told:
        config.read(name, given)
    assert str(told.value).startswith(said), told.value
    assert "\n" not in str(told.value)
