"""Configurations: the codes for a file's volts, newtons and milliseconds, in exact fractions; the twin of
each converter; every mistake gives one sentence that names its table."""

import copy
import re
import tomllib
from fractions import Fraction
from itertools import product
from math import floor

import pytest

from meissner.builds import config
from meissner.twins.frontend.adc_spi import AdcSpi
from meissner.twins.slip.config import SAMPLE_BITS


def tables(name):
    return tomllib.loads((config.FOLDER / f"{name}.toml").read_text())


@pytest.mark.parametrize("name", [name for name in config.names() if config.load(name).slip])
def test_codes_are_those_of_the_quantities(name):
    """A threshold is T·sqrt(2)^level / lsb rounded down; comparing its square avoids the root."""
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
        ("slip1", "slip", {"hop": 32}, "[slip]: serial must go with one channel and hop = window"),
        ("slip1", "slip", {"thresholds": 1.0}, "[slip]: unknown key 'thresholds'; the keys are: "),
        ("slip1", "adc", {"rate_hz": 1e5}, "[adc]: rate_hz = 100000 is too fast: a conversion takes "),
        ("fingertip", "adc", {"rate_hz": 1e5}, "[adc]: rate_hz = 100000 is too fast: a scan takes "),
        ("slip1", "adc", {"part": "MCP"}, "[adc]: part = "),
        ("slip1", "link", {"images": True}, "[link]: images must go with an array"),
        ("slip1", "link", {"baud": 4_000_000}, "[link]: baud = 4000000 must be at most 3000000"),
        ("cop4", "slip", {"window": 64}, "[slip] is not allowed with kind = 'electrodes'"),
    ],
)
def test_mistakes_are_answered_by_a_sentence(name, table, change, said):
    given = copy.deepcopy(tables(name))
    given[table] = given.get(table, {}) | change
    with pytest.raises(ValueError) as told:
        config.read(name, given)
    assert str(told.value).startswith(said), told.value
    assert "\n" not in str(told.value)


def changed(name, table, **change):
    given = copy.deepcopy(tables(name))
    given[table] = {key: value for key, value in (given.get(table, {}) | change).items() if value is not None}
    return given


@pytest.mark.parametrize("window", [16, 32, 64, 128])
def test_hop_is_the_windows_where_none_is_given(window):
    """slip1 gives no hop."""
    assert config.read("x", changed("slip1", "slip", window=window)).slip.hop == window
    assert config.read("x", changed("array64", "slip", window=window, hop=None)).slip.hop == window
    assert config.read("x", changed("array64", "slip", window=64, hop=16)).slip.hop == 16


@pytest.mark.parametrize(
    "name, good, bad, said",
    [
        (
            "fingertip",
            {"threshold_n": 0.4, "gross_threshold_n": 0.4},
            {"threshold_n": 0.4, "gross_threshold_n": 0.399},
            "[slip]: gross_threshold_n = 0.399 must be at least threshold_n = 0.4",
        ),
        (
            "slip1",
            {"threshold_v": 0.12},
            {"threshold_v": 0.1201},
            "[slip]: gross_threshold_v = 0.12 must be at least threshold_v = 0.1201",
        ),
        (
            "fingertip",
            {"contact_level_n": 0.1},
            {"contact_level_n": 0.0999},
            "[slip]: contact_level_n = 0.0999 must be at least release_level_n = 0.1",
        ),
        (
            "slip1",
            {"contact_level_v": 4.8},
            {"contact_level_v": 4.81},
            "[slip]: contact_level_v = 4.81 must be at most release_level_v = 4.8, "
            "as the code falls with the force",
        ),
        (
            "slip1",
            {"contact_rises": True, "contact_level_v": 4.8},
            {"contact_rises": True, "contact_level_v": 4.79},
            "[slip]: contact_level_v = 4.79 must be at least release_level_v = 4.8",
        ),
    ],
)
def test_levels_that_undo_each_other_are_refused(name, good, bad, said):
    config.read(name, changed(name, "slip", **good))
    with pytest.raises(ValueError) as told:
        config.read(name, changed(name, "slip", **bad))
    assert str(told.value) == said


@pytest.mark.parametrize(
    "name, least",
    # A CoP packet is 00, 8 + 12 + 4 bytes, a code, 00: 27. fingertip: 4000 of them and an image of 9 taxels,
    # 3 + 8 + 5 + 18 + 4 = 38 bytes: 10·(4000·27 + 38). full: 1400; 64 packets of 3 + 8 + 5 + 128 + 4 = 148.
    [("fingertip", 1_080_380), ("full", 472_720)],
)
def test_a_line_too_slow_for_its_images_is_refused(name, least):
    config.read(name, changed(name, "link", baud=least))
    with pytest.raises(
        ValueError, match=rf"^\[link\]: baud = {least - 1} is too slow for images: .* at least {least}$"
    ):
        config.read(name, changed(name, "link", baud=least - 1))
    config.read(name, changed(name, "link", baud=9600, images=False))


@pytest.mark.parametrize(
    "name, good, bad, said",
    # 24 MHz, 2^32 - 1 clocks: 0.00559 Hz; 12 MHz, 2^24 - 1 clocks: 0.715 Hz.
    [
        ("fingertip", {"rate_hz": 0.00559}, {"rate_hz": 0.00558}, "rate_hz = 0.00558 is too slow"),
        ("slip1", {"rate_hz": 0.7153}, {"rate_hz": 0.7152}, "rate_hz = 0.7152 is too slow"),
        (
            "slip1",
            {"rate_hz": 9000},
            {"rate_hz": 1e-300},
            "rate_hz = 1e-300 must lie in 1e-12 .. 1e+12 in size",
        ),
        ("slip1", {"rate_hz": 9000}, {"rate_hz": 1e-12}, "rate_hz = 1e-12 is too slow: the longest period"),
        ("slip1", {"rate_hz": 9000}, {"rate_hz": float("inf")}, "rate_hz = inf must be a finite number"),
        ("slip1", {"rate_hz": 9000}, {"rate_hz": float("nan")}, "rate_hz = nan must be a finite number"),
        ("slip1", {"rate_hz": 9000}, {"rate_hz": True}, "rate_hz = True must be a number"),
    ],
)
def test_rates_that_no_period_holds_are_refused(name, good, bad, said):
    longer = {"hold_ms": 0.0, "refractory_ms": 0.0, "blank_ms": 0.0}
    given = changed(name, "adc", **good)
    given["slip"] |= longer
    config.read(name, given)
    given["adc"] |= bad
    with pytest.raises(ValueError, match=rf"^\[adc\]: {re.escape(said)}"):
        config.read(name, given)


def test_a_load_wider_than_the_build_is_refused():
    """fingertip: 9 taxels, 16 + 4 bits, 2 mN: 1048575 codes are 2097.15 N."""
    assert (
        config.read("x", changed("fingertip", "cop", min_load_n=2097.15)).settings["cop.min_load"]
        == 1_048_575
    )
    with pytest.raises(ValueError, match=r"^cop.min_load = 1048576 must lie in 0 .. 1048575$"):
        config.read("x", changed("fingertip", "cop", min_load_n=2097.151))
    with pytest.raises(ValueError, match=r"^\[cop\]: min_load_n = -0.1 must not be negative$"):
        config.read("x", changed("fingertip", "cop", min_load_n=-0.1))


def test_a_threshold_wider_than_the_build_is_refused():
    """slip1 is serial, 13 + 1 bits: 16383 codes of 5/4096 V are 16383·5/4096/sqrt(2) = 14.14127 V."""
    given = changed("slip1", "slip", threshold_v=14.141, gross_threshold_v=14.1413)
    assert config.read("x", given).slip.gross_threshold == 16_383
    given["slip"]["gross_threshold_v"] = 14.1422
    with pytest.raises(ValueError, match=r"^slip.gross_threshold = 16384 must lie in 0 .. 16383$"):
        config.read("x", given)


WRONG = [
    *(float("nan"), float("inf"), float("-inf"), True, False, "x", "", "\x1b[31m", [], [[1]], {}, {"a": 1}),
    *(-1, 0, -0.5, 1e300, 1e-300, -1e300, 5e-324, 10**400, 2**63, -(2**63), 1e12, -1e12, 1e-12, 1e9, 1e6),
]
DEFAULTS = {
    **{"link": config.LINK, "array": config.ARRAY, "health": config.HEALTH, "tare": config.TARE},
    **{
        "cop": {"min_load_n": 0.0},
        "cop_slip": config.COP_SLIP,
        **{name: stage.DEFAULTS for name, stage in config.STAGES.items()},
        "slip": config.SLIP | {"serial": 0, "hop": 0},
    },
    "adc": dict.fromkeys(("lanes", "sclk_khz", "converters", "channels", "settle_us")),
}


@pytest.mark.parametrize("name", ["slip1", "fingertip", "cop4", "full", "grip", "grip and shear_speed"])
def test_any_value_of_any_key_is_taken_or_refused_in_a_sentence(name):
    original, refused = tables(name.split()[0]), 0
    original |= {"shear_speed": {}} if "shear_speed" in name else {}
    for table in original:
        keys = [None]
        if isinstance(original[table], dict):
            keys += dict.fromkeys([*original[table], *DEFAULTS.get(table, {})])
        for key, value in product(keys, WRONG):
            given = copy.deepcopy(original)
            if key is None:
                given[table] = value
            else:
                given[table][key] = value
            try:
                build = config.read(name, given)
                assert build.parameters and build.settings and build.units
            except ValueError as problem:
                sentence, refused = str(problem), refused + 1
                assert sentence.isprintable() and len(sentence) < 250, (table, key, value)
                where = table if key is None else key
                if isinstance(value, (str, list, dict, bool)) and value != "":
                    assert where in sentence or "[" in sentence, (table, key, value, sentence)
    assert refused > 300


@pytest.mark.parametrize(
    "text, said",
    [
        ("x = " + "[" * 5000 + "]" * 5000, "its lists are nested too deeply"),
        ("about = [[[[[[[[[[1]]]]]]]]]]", "about = [[[...]]] must be text"),
        ("about = [[1, 2], [3]]", "about = "),
        ("about = " + "9" * 5000, "is not a TOML file"),
        ('about = "\\u001b[31m"', "must be one line of text"),
        ("[converter]\nbits = 16", "[converter] belongs in a file for `meissner process cop4`"),
    ],
)
def test_files_that_are_no_configuration(tmp_path, text, said):
    file = tmp_path / "mine.toml"
    good = "".join(f"[{table}]\n" for table in ("clock", "sensor", "adc")) if text.startswith("about") else ""
    file.write_text(text + "\n" + good)
    with pytest.raises(ValueError) as told:
        config.load(file)
    assert said in str(told.value) and "mine.toml" in str(told.value)
    assert str(told.value).isprintable() and len(str(told.value)) < 250
