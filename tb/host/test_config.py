"""Configurations: the codes for a file's volts, newtons and milliseconds, in exact fractions; each limit met
and exceeded by one, worked out by hand; every mistake gives one sentence that names its table and key."""

import copy
import re
import tomllib
from fractions import Fraction
from itertools import product
from math import floor
from pathlib import Path
from types import SimpleNamespace
from typing import get_args

import msgspec
import pytest

from meissner import scenes
from meissner.builds import config, keys
from meissner.builds.slip_table import SlipOfScene, SlipVolts
from meissner.builds.toolchain import ROOT
from meissner.twins.frontend.adc_spi import AdcSpi
from meissner.twins.slip.config import SAMPLE_BITS


def tables(name):
    return tomllib.loads((config.FOLDER / f"{name}.toml").read_text())


CHANNELS = {
    "about": "ends",
    "clock": {"mhz": 25.0},
    "sensor": {"kind": "channels", "channels": 1},
    "adc": {"part": "MCP3208", "volts": 3.3, "rate_hz": 1000.0},
    "slip": {
        **{"window": 32, "threshold_p2p_v": 0.02, "gross_threshold_p2p_v": 0.1, "contact_level_v": 1.0},
        **{"release_level_v": 1.5, "contact_rises": False},
    },
}
ARRAY = {
    "about": "ends",
    "clock": {"mhz": 25.0},
    "sensor": {"kind": "array", "rows": 5, "columns": 6},
    "adc": {
        **{"part": "AD7606", "volts": 10.0, "rate_hz": 100.0, "converters": 2, "channels": 3},
        **{"settle_us": 1.0, "settle_share": 1.0},
    },
    "array": {"newtons_per_count": 0.0037, "pitch_mm": 3.3},
}
DURING = ARRAY | {"adc": ARRAY["adc"] | {"read": "during"}}
LEVEL_2 = CHANNELS | {"slip": CHANNELS["slip"] | {"level": 2}}
RISES = CHANNELS | {
    "slip": CHANNELS["slip"] | {"contact_rises": True, "contact_level_v": 1.5, "release_level_v": 1.0}
}
HEALTHY = ARRAY | {"array": {"health": True}, "health": {"blink": 120}}
SHEARED = tables("grip") | {"shear_speed": {}}


def read(base, table=None, **change):
    """The build of a named configuration or of tables, with keys of one table changed, or left out (None)."""
    given = copy.deepcopy(tables(base) if isinstance(base, str) else base)
    if table:
        found = given.get(table, {}) | change
        given[table] = {key: value for key, value in found.items() if value is not None}
    return config.read("x", given)


def refused(base, table, named, **change):
    """The sentence of a refusal, which names the table and the key."""
    with pytest.raises(ValueError) as problem:
        read(base, table, **change)
    sentence = str(problem.value)
    assert f"[{table}]" in sentence or f"{table}." in sentence, sentence
    assert named in sentence and "\n" not in sentence, sentence
    return sentence


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
    keeps = f"keep_threshold_p2p_{unit}" in exact
    assert (build.slip.keep_threshold is not None) == keeps == ("slip.keep_threshold" in build.settings)
    for key in ("threshold", "gross_threshold", *(["keep_threshold"] if keeps else [])):
        code, square = getattr(build.slip, key), (exact[f"{key}_p2p_{unit}"] / lsb) ** 2 * group
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
    assert adc.channels == getattr(build.adc, "channels", build.channels) and adc.lanes == build.adc.lanes
    assert adc.sample_bits == (13 if build.serial else SAMPLE_BITS)


SETTINGS = {
    **{"window": 32, "hop": 16, "level": 2, "threshold_p2p_v": 0.0273, "gross_threshold_p2p_v": 0.0911},
    **{"keep_threshold_p2p_v": 0.0139, "contact_level_v": 4.37, "release_level_v": 4.71},
    **{"hold_ms": 33.3, "refractory_ms": 7.7, "blank_ms": 91.1, "contact_rises": False},
}


@pytest.mark.parametrize("name", ["acrylic_slip", "shear_amount"])
def test_the_same_table_means_the_same_in_a_build_and_in_a_scene(name):
    """MCP3208 at 5 V: 819.2 codes per volt, twice that for a detail of level 2 and four times for a sum."""
    build = read(CHANNELS | {"adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 10_000.0}, "slip": SETTINGS})
    scene = scenes.build("x", tomllib.loads(scenes.source(name)) | {"slip": SETTINGS})
    assert scene.slip_config() == build.slip
    found = build.slip
    assert (found.threshold, found.gross_threshold, found.keep_threshold) == (44, 149, 22)  # 44.73, 149.26
    assert (found.contact_level, found.release_level) == (14_320, 15_434)  # 14319.6, 15433.7
    assert (found.hold, found.refractory, found.blank) == (83, 19, 228)  # 83.25, 19.25, 227.75
    assert SlipOfScene.__struct_fields__ == SlipVolts.__struct_fields__


@pytest.mark.parametrize(
    "old, value, new, amount",
    [
        *((f"{key}threshold_v", 0.01, f"{key}threshold_p2p_v", 0.02) for key in ("", "gross_", "keep_")),
        *((f"{key}_v", 4.5, f"{key}_level_v", 4.5) for key in ("contact", "release")),
        *((f"{key}_s", 0.15, f"{key}_ms", 150) for key in ("hold", "refractory", "blank")),
    ],
)
def test_what_was_written_in_scenes_is_refused_with_the_new_key(old, value, new, amount):
    table = tomllib.loads(scenes.source("acrylic_slip"))
    del table["slip"][new]
    table["slip"][old] = value
    with pytest.raises(ValueError, match=rf"{old} = {value} is now written {new} = {amount:g} \("):
        scenes.build("x", table)


@pytest.mark.parametrize("key", ["threshold", "gross_threshold", "keep_threshold"])
@pytest.mark.parametrize("base, unit", [("slip1", "v"), ("fingertip", "n")])
def test_what_was_written_in_builds_is_refused_with_the_new_key(base, unit, key):
    change = {f"{key}_{unit}": 0.01, f"{key}_p2p_{unit}": None}
    assert f"is now written {key}_p2p_{unit} = 0.01 (" in refused(base, "slip", f"{key}_{unit}", **change)
    assert "min_load_n = 0.3" in refused("cop4", "cop_slip", "min_n", min_n=0.3, min_load_n=None)
    assert "lag_ms = 128" in refused("cop4", "cop_slip", "lag_s", lag_s=0.128, lag_ms=None)


def test_the_other_tables_of_scenes_have_the_builds_keys():
    for name, path, old, new in (
        ("grip_pour", "grip", "silent_s", "silent_ms"),
        ("grip_pour", "slip", "threshold_share", "threshold_p2p_share"),
        ("fsr_3x3", "array", "min_load_n", r"\[cop\] min_load_n"),
    ):
        table = tomllib.loads(scenes.source(name))
        table[path][old] = 0.008
        with pytest.raises(ValueError, match=f"{old} = 0.008 is now written {new}"):
            scenes.build("x", table)


@pytest.mark.parametrize("case", sorted((ROOT / "tb/cases").glob("*.toml")), ids=lambda path: path.stem)
def test_the_configurations_that_went_wrong_are_read(case):
    if case.stem == "h9_grip_20V":  # 20 · 819.2 · sqrt(2) = 23170.5
        with pytest.raises(ValueError, match=r"\[slip\]: threshold_p2p_v: 20 V are 23170 codes .* 8190, "):
            config.load(case)
    else:
        build = config.load(case)
        assert build.parameters and build.units


@pytest.mark.parametrize(
    "name, table, change, key",
    [
        ("slip1", "slip", {"window": 48}, "window"),
        ("slip1", "slip", {"level": 4}, "level"),
        ("slip1", "slip", {"threshold_p2p_v": -0.01}, "threshold_p2p_v"),
        ("fingertip", "slip", {"gross_threshold_p2p_n": 1e9}, "gross_threshold"),
        ("slip1", "slip", {"keep_threshold_p2p_v": 0.0201}, "keep_threshold_p2p_v"),
        ("fingertip", "slip", {"hold_ms": 1e6}, "hold"),
        ("fingertip", "slip", {"serial": True}, "serial"),
        ("slip1", "slip", {"hop": 32}, "hop"),
        ("slip1", "slip", {"thresholds": 1.0}, "'thresholds'"),
        ("slip1", "slip", {"threshold_p2p_v": None}, "'threshold_p2p_v'"),
        ("slip1", "adc", {"rate_hz": 1e5}, "rate_hz"),
        ("fingertip", "adc", {"rate_hz": 1e5}, "rate_hz"),
        ("slip1", "adc", {"part": "MCP"}, "part"),
        ("slip1", "link", {"images": True}, "images"),
        ("slip1", "link", {"baud": 4_000_000}, "baud"),
        ("cop4", "slip", {"window": 64}, "electrodes"),
        ("fingertip", "health", {"band": 3}, "health = false"),
        ("cop4", "cop_slip", {"lag_ms": 5000.0}, "lag"),
        ("cop4", "adc", {"part": "MCP3208"}, "AD7606"),
        ("fingertip", "adc", {"read": "during"}, "'during' must be 'after'"),
        ("cop4", "adc", {"read": "between"}, "read"),
    ],
)
def test_a_mistake_is_named(name, table, change, key):
    refused(name, table, key, **change)


def test_a_read_during_the_next_conversion_is_a_parameter_and_has_the_times_of_its_frames():
    """The smallest link takes the time of the last convert start, which may be the next frame's."""
    channels = CHANNELS | {"adc": CHANNELS["adc"] | {"part": "AD7606", "read": "during"}}
    for base in (channels, DURING):
        assert read(base).parameters["ReadDuring"] == 1
        assert "ReadDuring" not in read(base, "adc", read="after").parameters
    refused(channels, "link", "slip_only", slip_only=True, registers=False)


def test_hop_is_the_windows_where_none_is_given():
    for window in (16, 32, 64, 128):
        assert read("slip1", "slip", window=window).slip.hop == window
    assert read("array64", "slip", window=64, hop=16).slip.hop == 16


@pytest.mark.parametrize(
    "name, key, good, bad",
    [
        ("fingertip", "gross_threshold_p2p_n", {"gross_threshold_p2p_n": 0.05}, 0.0499),
        ("slip1", "threshold_p2p_v", {"threshold_p2p_v": 0.12}, 0.1201),
        ("slip1", "keep_threshold_p2p_v", {"keep_threshold_p2p_v": 0.02}, 0.0201),
        ("fingertip", "contact_level_n", {"contact_level_n": 0.1}, 0.0999),
        ("slip1", "contact_level_v", {"contact_level_v": 4.8}, 4.81),  # the code falls with the force
        ("slip1", "contact_level_v", {"contact_rises": True, "contact_level_v": 4.8}, 4.79),
    ],
)
def test_levels_that_undo_each_other_are_refused(name, key, good, bad):
    read(name, "slip", **good)
    refused(name, "slip", key, **good | {key: bad})


@pytest.mark.parametrize(
    "base, clock, table, key, least, beyond",
    [
        # A conversion takes 20 bits of 26 clocks, plus one clock: 25 MHz / 521 and / 520.
        (CHANNELS, 25.0, "adc", "rate_hz", 47_984.6, 48_076.9),
        # 24 bits: 200 MHz / 16777215 and / 16777216.
        (CHANNELS, 200.0, "adc", "rate_hz", 11.92093, 11.920928),
        # 32 bits for an array: 25 MHz / 4294967295 is 0.0058207661 Hz.
        (ARRAY, 25.0, "adc", "rate_hz", 0.00582077, 0.00582076),
        # A place takes 106 clocks of conversion, 3, and 49 bits of 2, but at least the watchdog's 256 + 7;
        # five rows of one place: 25 MHz / 1315 and / 1314.
        (ARRAY, 25.0, "adc", "rate_hz", 19_011.4, 19_025.9),
        # Read during the next conversion, the part's own 5 us are enough: five rows of 125 clocks.
        (DURING, 25.0, "adc", "rate_hz", 40_000.0, 40_033.0),
        # 70 MHz: 65534.98 and 65535.05 clocks, rounded up.
        (ARRAY, 70.0, "adc", "settle_us", 936.214, 936.215),
        # A quarter of 13.37 MHz.
        (CHANNELS, 13.37, "link", "baud", 3_342_500, 3_342_501),
        # Per second: 100 CoP packets of 8 + 12 + 4 bytes, an image of 8 + 5 + 60 + 4; framing adds 3 each.
        (ARRAY | {"link": {"images": True}}, 25.0, "link", "baud", 27_800, 27_799),
        # A CoP packet has 27 bytes, an image of 9 taxels 38: 10·(4000·27 + 38).
        ("fingertip", None, "link", "baud", 1_080_380, 1_080_379),
        # 1400 packets, and 64 of 3 + 8 + 5 + 128 + 4 = 148 bytes.
        ("full", None, "link", "baud", 472_720, 472_719),
        # With the largest gain, 65535/4096, the 4095 codes of a taxel are 65519 of force: 9 · 65519 · 2 mN.
        ("fingertip", None, "cop", "min_load_n", 1179.342, 1179.343),
        ("fingertip", None, "cop", "bits_per_clock", 2, 3),
        ("fingertip", None, "cop", "bits_per_clock", 1, 0),
        # A detail of level 1 lies in -4095 .. 4095: 8190·5/4096/sqrt(2) = 7.069342 V.
        ("slip1", None, "slip", "gross_threshold_p2p_v", 7.06934, 7.06935),
        (LEVEL_2, None, "slip", "gross_threshold_p2p_v", 6.59838, 6.59839),  # 4 · 4095 · 3.3 / 4096 / 2
        # 65519 codes of 2 mN, and a peak to peak of twice as many.
        ("fingertip", None, "slip", "gross_threshold_p2p_n", 185.3157, 185.3158),
        (CHANNELS, None, "slip", "contact_level_v", 0.0, -0.001),
        # Half a step of the sum of two codes of 3.3/4096 V: 3.3 · 4095/4096 = 3.299194 V and 0.2 mV.
        (RISES, None, "slip", "contact_level_v", 3.29939, 3.2996),
        (RISES, None, "slip", "release_level_v", 0.00021, 0.0002),
        ("fingertip", None, "slip", "contact_level_n", 131.038, 131.04),
        (CHANNELS, None, "adc", "volts", 5.5, 5.51),
        (CHANNELS, None, "clock", "mhz", 200.0, 200.1),
        (ARRAY, None, "adc", "volts", 10.0, 10.1),
        (ARRAY, None, "adc", "settle_us", 1000.0, 1001.0),
        (ARRAY, None, "array", "newtons_per_count", 0.1, 0.11),
        (ARRAY, None, "array", "pitch_mm", 100.0, 101.0),
        (ARRAY, None, "tare", "contact_codes", 32_766, 32_767),  # above the 0 V at rest
        ("fingertip", None, "tare", "contact_codes", 4094, 4095),
        (ARRAY, None, "tare", "step", 255, 256),
        (HEALTHY, None, "health", "jump", 65_534, 65_535),  # 65535 codes from end to end
        (HEALTHY, None, "health", "jump", 12, 11),  # the band
        (HEALTHY | {"health": {"blink": 0}}, None, "health", "band", 65_534, 65_535),
        *((HEALTHY, None, "health", key, 255, 256) for key in ("still", "rail", "blink")),
        ("cop4", None, "load", "min_n", 65.535, 65.536),  # 16 bits of 1 mN
        *((name, None, "adc", "sclk_khz", 2000, 2001) for name in ("fingertip", "slip1")),
        ("cop4", None, "load", "gain", 0.3326, 0.3327),  # 15 V · gain and 0.2 % within 5 V
        ("cop4", None, "cop_slip", "min_load_n", 65.535, 65.536),
        ("cop4", None, "cop_slip", "lag_ms", 4096.0, 4097.0),
        ("cop4", None, "cop_slip", "hold_ms", 65_535.0, 65_536.0),
        *(("grip", None, "grip", key, 2000, 2001) for key in ("step", "decay")),  # the rate
        ("grip", None, "grip", "boost", 7, 8),
        ({**tables("grip"), "grip": {"step": 512, "rate": 600}}, None, "grip", "boost", 6, 7),  # 65536
        ("grip", None, "grip", "maximum", 65_535, 65_536),
        ("grip", None, "grip", "minimum", 60_000, 60_001),
        ("grip", None, "grip", "rate", 65_535, 65_536),
        ("grip", None, "grip", "pulse_divide", 255, 256),
        # 3 mm/s at most: 16 · 3 · gain counts, of 65535.
        (SHEARED, None, "grip", "speed_gain", 1365, 1366),
        (SHEARED, None, "shear_speed", "vi_max_v", 5.0, 5.01),
        (SHEARED, None, "shear_speed", "vi_min_v", 0.0, -0.01),
        (SHEARED, None, "shear_speed", "noise_v", 5.0, 5.01),
        (SHEARED, None, "shear_speed", "still_v", 5.0, 5.01),
        # Half a step of a level, 5 V / 4096 / 512 / 2 = 1.1921 uV, and of 1/2^20 mm in windows of 6.4 ms.
        *((SHEARED, None, "shear_speed", key, 1.193e-6, 1.192e-6) for key in ("noise_v", "still_v")),
        (SHEARED, None, "shear_speed", "travel_mm", 3.06e-9, 3.05e-9),
        *((SHEARED, None, "shear_speed", key, 0.0, 1e-9) for key in ("noise_v", "still_v", "travel_mm")),
        (SHEARED, None, "shear_speed", "n", 1.0, 1.01),
        (SHEARED, None, "shear_speed", "travel_mm", 1.0, 1.01),
        # At Vi = 4 V the rise at 1 mm/s is k0 - 1.08 V: below the converter's 5.
        (SHEARED, None, "shear_speed", "k0_v", 6.07, 6.09),
        (SHEARED, None, "shear_speed", "k0_v", 0.55, 0.54),  # above 0 at Vi = 2 V: 0.54
        (CHANNELS | {"adc": CHANNELS["adc"] | {"rate_hz": 6.4}}, None, "slip", "window", 32, 64),  # 5 s
        ("slip1", None, "link", "baud", 1200, 1199),
        # A detail lasts 0.2 ms.
        *(("slip1", None, "slip", key, 0.11, 0.1) for key in ("hold_ms", "refractory_ms", "blank_ms")),
        *(("slip1", None, "slip", key, 0.0, 1e-6) for key in ("hold_ms", "refractory_ms", "blank_ms")),
        *(("cop4", None, "cop_slip", key, 0.6, 0.5) for key in ("lag_ms", "hold_ms", "refractory_ms")),
        ("cop4", None, "cop_slip", "drop", 0.002, 0.0019),  # of 256ths
        ("cop4", None, "cop_slip", "move", 0.000031, 0.00003),  # of 16384ths
    ],
)
def test_a_limit_is_met_and_not_passed(base, clock, table, key, least, beyond):
    base = base if clock is None else base | {"clock": {"mhz": clock}}
    read(base, table, **{key: least})
    refused(base, table, key, **{key: beyond})


def test_codes_at_the_ends_of_what_occurs():
    assert read("fingertip", "cop", min_load_n=1179.342).settings["cop.min_load"] == 9 * 65_519
    assert read("slip1", "slip", gross_threshold_p2p_v=7.06934).slip.gross_threshold == 8189
    assert read(RISES, "slip", contact_level_v=3.29939).slip.contact_level == 8190
    assert read(CHANNELS, "slip", keep_threshold_p2p_v=0.02).slip.keep_threshold == 35  # 35.1


def test_names_are_in_order(monkeypatch):
    files = [Path(f"{name}.toml") for name in "cab"]
    monkeypatch.setattr(config, "FOLDER", SimpleNamespace(glob=lambda _: files))
    assert config.names() == ["a", "b", "c"]


@pytest.mark.parametrize("gains, most", [("taxel", 4080), ("row_column", 65_278)])
def test_the_largest_force_of_8_bits(gains, most):
    """255 codes times 65535/4096, or times its square: 4079.94 and 65278.01."""
    adc = {"part": "MAX11123", "volts": 3.3, "rate_hz": 100.0}
    base = ARRAY | {"adc": adc, "array": {"gains": gains, "newtons_per_count": 0.001}}
    least = 30 * most / 1000
    assert read(base, "cop", min_load_n=least).settings["cop.min_load"] == 30 * most
    refused(base, "cop", "min_load_n", min_load_n=least + 0.001)


@pytest.mark.parametrize("part", [name for name, part in keys.PARTS.items() if not part.signed])
def test_four_wires_refuse_a_converter_from_0_v_on(part):
    refused("cop4", "adc", f"part = '{part}'", part=part, volts=3.3)


def test_any_number_of_converters_up_to_eight():
    """Six columns on five converters: their second input has one column, and health numbers it as taxel 5."""
    for converters in range(1, 9):
        made = ARRAY | {"adc": ARRAY["adc"] | {"converters": converters, "channels": 6}}
        found = read(made, "array", health=True).parameters
        assert (found["Columns"], found["Converters"], found["Health"]) == (6, converters, 1)
    for converters in (0, 9):
        refused(ARRAY, "adc", "converters", converters=converters)


WRONG = [
    *(float("nan"), float("inf"), float("-inf"), True, False, "x", "", "\x1b[31m", [], [[1]], {}, {"a": 1}),
    *(-1, 0, -0.5, 1e300, 1e-300, -1e300, 5e-324, 10**400, 2**63, -(2**63), 1e12, -1e12, 1e-12, 1e9, 1e6),
]


def known(file, table):
    """The keys that the table ``table`` of ``file`` has."""
    kind = next((each.type for each in msgspec.structs.fields(file) if each.name == table), None)
    kind = next((each for each in get_args(kind) if each is not type(None)), kind)
    return getattr(kind, "__struct_fields__", ())


@pytest.mark.parametrize("name", ["slip1", "fingertip", "cop4", "full", "grip", "grip and shear_speed"])
def test_any_value_of_any_key_is_taken_or_refused_in_a_sentence(name):
    original, count = tables(name.split()[0]), 0
    original |= {"shear_speed": {}} if "shear_speed" in name else {}
    file = keys.FILES[original["sensor"]["kind"]]
    for table in original:
        inner = [None]
        if isinstance(original[table], dict):
            inner += dict.fromkeys([*original[table], *known(file, table)])
        for key, value in product(inner, WRONG):
            given = copy.deepcopy(original)
            if key is None:
                given[table] = value
            else:
                given[table][key] = value
            try:
                build = config.read(name, given)
                assert build.parameters and build.settings and build.units
            except ValueError as problem:
                sentence, count = str(problem), count + 1
                assert sentence.isprintable() and len(sentence) < 250, (table, key, value)
                if isinstance(value, (str, list, dict, bool)) and value != "":
                    where = table if key is None else key
                    assert where in sentence or "[" in sentence, (table, key, value, sentence)
    assert count > 300


@pytest.mark.parametrize(
    "text, named",
    [
        ("x = " + "[" * 5000 + "]" * 5000, "nested too deeply"),
        ("about = [[[[[[[[[[1]]]]]]]]]]", "about"),
        ("about = " + "9" * 5000, "TOML"),
        ('about = "\\u001b[31m"', "about"),
        ("[converter]\nbits = 16", "[converter]"),
    ],
)
def test_files_that_are_no_configuration(tmp_path, text, named):
    file = tmp_path / "mine.toml"
    good = (config.FOLDER / "slip1.toml").read_text()
    file.write_text(text + "\n" + re.sub("^about.*", "", good, flags=re.M))
    with pytest.raises(ValueError) as problem:
        config.load(file)
    sentence = str(problem.value)
    assert named in sentence and "mine.toml" in sentence and sentence.isprintable() and len(sentence) < 250


PAGE = (ROOT / "docs/config.md").read_text("utf-8")
MESH = {"rows": 7, "columns": 7, "r_ohm": 100.0, "R0_ohm": 1000.0, "V0_v": 4.0, "k_n_ohm": 4320.0}
FORCES = {
    "threshold_p2p_n": 0.1,
    "gross_threshold_p2p_n": 0.2,
    "contact_level_n": 0.2,
    "release_level_n": 0.1,
}
EMPTY = {  # of each kind: what must be there, and every other table empty
    "channels": {
        **{"clock": {"mhz": 25.0}, "sensor": {"kind": "channels", "channels": 2}, "link": {}, "grip": {}},
        **{"adc": {"part": "MCP3208", "volts": 5.0, "rate_hz": 5000.0}, "shear_speed": {}},
        "slip": {
            "threshold_p2p_v": 0.02,
            "gross_threshold_p2p_v": 0.1,
            "contact_level_v": 4.5,
            "release_level_v": 4.8,
        },
    },
    "array": {
        **{
            "clock": {"mhz": 50.0},
            "sensor": {"kind": "array", "rows": 4, "columns": 4},
            "link": {},
            "cop": {},
        },
        **{
            "adc": {"part": "AD7606", "volts": 5.0, "rate_hz": 500.0},
            "array": {"health": True},
            "slip": FORCES,
        },
        **{"health": {}, "tare": {}},
    },
    "electrodes": {
        **{
            "clock": {"mhz": 25.0},
            "sensor": {"kind": "electrodes"},
            "link": {},
            "mesh": MESH,
            "cop_slip": {},
        },
        "adc": {"part": "AD7606", "volts": 5.0, "rate_hz": 500.0},
        "load": {"lsb_n": 0.001, "min_n": 0.1, "correction": "none"},
    },
}


def rows_of_the_page():
    """(table, key, default as written) of every key."""
    tables = ()
    for line in re.search(r"\n\| table \| key .*?\n\n", PAGE, re.DOTALL)[0].strip().splitlines()[2:]:
        first, second, default = (cell.strip() for cell in line.split("|")[1:4])
        tables = re.findall(r"\[(\w+)\]", first) or tables
        for table, key in product(tables, re.findall(r"`(\w+)`", second)):
            yield table, key, default


def built(kind, table=None, **change):
    build = read({"about": "empty"} | EMPTY[kind], table, **change)
    return build.settings, build.parameters


def test_the_page_has_every_key_and_its_default():
    page = {}
    for table, key, default in rows_of_the_page():
        page.setdefault(table, {})[key] = default
    page["mesh"] = dict.fromkeys(MESH, "must")
    page["load"] |= dict.fromkeys(("lsb_n", "min_n", "correction"), "must")
    seen = 0
    for kind, tables in EMPTY.items():
        for table, given in tables.items():
            for key in known(keys.FILES[kind], table):
                default = page[table].get(key) or page[table][key[:-1] + "v"]  # of an array _n
                if default == "must":
                    refused({"about": "empty"} | tables, table, key, **{key: None})
                    continue
                assert key not in given or (table, key) == ("array", "health"), key
                if default in ("by part", "see below", "the window", "the threshold"):
                    continue
                if (table, key, kind) != ("slip", "contact_rises", "array") and key != "health":
                    assert built(kind, table, **{key: tomllib.loads(f"x = {default}")["x"]}) == built(kind), (
                        key
                    )
                    seen += 1
    assert seen > 60
    with pytest.raises(ValueError, match=r"health = false in \[array\]"):
        built("array", "array", health=None)


@pytest.mark.parametrize("kind, unit", [("channels", "v"), ("array", "n")])
def test_defaults_that_are_another_keys_value(kind, unit):
    slip = EMPTY[kind]["slip"]
    assert built(kind, "slip", hop=64) == built(kind) != built(kind, "slip", hop=32)
    keep = {f"keep_threshold_p2p_{unit}": slip[f"threshold_p2p_{unit}"]}
    with_it, without = built(kind, "slip", **keep)[0], built(kind)[0]
    assert (
        with_it["slip.keep_threshold"] == without["slip.threshold"] and "slip.keep_threshold" not in without
    )


def test_defaults_by_part_are_those_of_the_page():
    found = re.search(r"\n\| by part, .*?\n\n", PAGE, re.DOTALL)[0].strip().splitlines()
    names = re.findall(r"`(\w+)`", found[0])[1:]
    for line in found[2:]:
        part, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        part, volts = part.split(", ")
        adc = {"part": part, "volts": float(volts), "rate_hz": 500.0, "channels": 4}
        build = read({"about": "part"} | EMPTY["array"] | {"adc": adc, "slip": FORCES | {"window": 8}})
        of = {"sclk_khz": build.parameters["SclkKhz"], "contact_codes": build.settings["tare.contact"]}
        of |= {key: build.settings[f"health.{key}"] for key in ("band", "jump")}
        assert [of[name] for name in names] == [int(cell) for cell in cells], part
        assert names == ["sclk_khz", "band", "jump", "contact_codes"]
