"""Each limit of a configuration met exactly and exceeded by one; the numbers are worked out by hand."""

import pytest

from meissner.builds import config

SLIP = {
    "threshold_v": 0.02,
    "gross_threshold_v": 0.1,
    "contact_level_v": 1.0,
    "release_level_v": 1.5,
    "contact_rises": False,
}
CHANNELS = {
    "about": "ends",
    "clock": {"mhz": 25.0},
    "sensor": {"kind": "channels", "channels": 1},
    "adc": {"part": "MCP3208", "volts": 3.3, "rate_hz": 1000.0},
    "slip": {"window": 32, **SLIP},
}
ARRAY = {
    "about": "ends",
    "clock": {"mhz": 25.0},
    "sensor": {"kind": "array", "rows": 5, "columns": 6},
    "adc": {"part": "AD7606", "volts": 10.0, "rate_hz": 100.0, "converters": 2, "channels": 3},
    "array": {"newtons_per_count": 0.0037, "pitch_mm": 3.3},
}


def read(base, **tables):
    changed = {key: base.get(key, {}) | table for key, table in tables.items()}
    return config.read(
        "ends", {k: dict(v) if isinstance(v, dict) else v for k, v in (base | changed).items()}
    )


@pytest.mark.parametrize(
    "base, tables, key, least, beyond, words",
    [
        # A conversion takes 20 bits of 26 clocks, plus one clock: 25 MHz / 521 and / 520.
        (CHANNELS, {}, ("adc", "rate_hz"), 47_984.6, 48_076.9, "takes 521 clocks"),
        # 24 bits: 25 MHz / 16777215 and / 16777216.
        (CHANNELS, {}, ("adc", "rate_hz"), 1.4901162, 1.49011612, "the longest period is 16777215 clocks"),
        # 32 bits for an array: 25 MHz / 4294967295 is 0.0058207661 Hz.
        (ARRAY, {}, ("adc", "rate_hz"), 0.00582077, 0.00582076, "the longest period is 4294967295 clocks"),
        # A place takes 106 clocks of conversion, 3, and 49 bits of 2, but at least the watchdog's 256 + 7;
        # five rows of one place: 25 MHz / 1315 and / 1314.
        (ARRAY, {}, ("adc", "rate_hz"), 19_011.4, 19_025.9, "takes 1315 clocks"),
        # 70 MHz: 65534.98 and 65535.05 clocks, rounded up.
        (ARRAY, {"clock": {"mhz": 70.0}}, ("adc", "settle_us"), 936.214, 936.215, "65535 clocks"),
        # A quarter of 13.37 MHz.
        (CHANNELS, {"clock": {"mhz": 13.37}}, ("link", "baud"), 3_342_500, 3_342_501, "at most 3342500"),
        # Per second: 100 CoP packets of 8 + 12 + 4 bytes, an image of 8 + 5 + 60 + 4; framing adds 3 each.
        (ARRAY, {"link": {"images": True}}, ("link", "baud"), 27_800, 27_799, "at least 27800"),
    ],
    ids=lambda value: str(value)[:24] if isinstance(value, (str, int, float)) else "",
)
def test_a_limit_is_met_and_not_passed(base, tables, key, least, beyond, words):
    table, name = key
    assert read(base, **{**tables, table: tables.get(table, {}) | {name: least}})
    with pytest.raises(ValueError, match=words):
        read(base, **{**tables, table: tables.get(table, {}) | {name: beyond}})


@pytest.mark.parametrize(
    "lower, upper", [("threshold_v", "gross_threshold_v"), ("contact_level_v", "release_level_v")]
)
def test_two_levels_may_be_the_same(lower, upper):
    """Here the code falls with the force, so contact lies below release."""
    same = read(CHANNELS, slip={lower: 1.25, upper: 1.25}).slip
    assert getattr(same, lower[:-2]) == getattr(same, upper[:-2])
    with pytest.raises(ValueError, match=upper if "gross" in upper else lower):
        read(CHANNELS, slip={lower: 1.2501, upper: 1.25})


def test_a_threshold_that_keeps_may_be_the_one_that_raises():
    assert read(CHANNELS, slip={"keep_threshold_v": 0.02}).slip.keep_threshold == 35  # 35.1
    with pytest.raises(ValueError, match=r"keep_threshold_v = 0\.0201 must not be above threshold_v"):
        read(CHANNELS, slip={"keep_threshold_v": 0.0201})


def test_health_wants_whole_beats():
    """msn_core refuses health if a row's last beat is not full, so the configuration does too."""
    six = {"sensor": {"columns": 6}, "adc": {"converters": 4, "channels": 2}}
    assert read(ARRAY, **six, array={"health": False, "tare": True}).parameters["Columns"] == 6
    assert read(ARRAY, adc={"converters": 2}, array={"health": True}).parameters["Health"] == 1
    with pytest.raises(ValueError, match="columns = 6 must be a multiple of the 4 converters for health"):
        read(ARRAY, **six, array={"health": True})
