"""Register words of three configurations whose supply, clock and rates are odd numbers, worked out by hand.

They follow from the formulas of docs/config.md, host.md and cop4.md and from the data sheets' codes: MCP3208,
12 bits from 0 V to the supply; AD7606, 16 bits, two's complement over ±range. Each fraction is shown, so that
the direction of rounding is tested too; and the way back, codes to volts, newtons and seconds.
"""

import tomllib

import pytest

from meissner.builds import config
from meissner.builds.build import verilog
from meissner.builds.units import Units
from meissner.twins.link.registers import RESET_BITS, settings

CHANNELS = {
    "about": "odd",
    "clock": {"mhz": 13.37},
    "sensor": {"kind": "channels", "channels": 3},
    "adc": {"part": "MCP3208", "volts": 3.3, "rate_hz": 7331.0},
    "slip": {
        **{"window": 32, "threshold_p2p_v": 0.0175, "gross_threshold_p2p_v": 0.111, "contact_level_v": 2.913},
        **{"release_level_v": 3.0175, "contact_rises": False},
        "keep_threshold_p2p_v": 0.0101,
        **{"hold_ms": 12.3, "refractory_ms": 7.7, "blank_ms": 33.2},
    },
    "link": {"baud": 1_234_567},
}
ARRAY = {
    "about": "odd",
    "clock": {"mhz": 33.333},
    "sensor": {"kind": "array", "rows": 5, "columns": 6},
    "adc": {
        **{"part": "AD7606", "volts": 10.0, "rate_hz": 611.3, "converters": 2, "channels": 3},
        **{"settle_us": 1.37, "settle_share": 1.0},
    },
    "array": {"health": True, "newtons_per_count": 0.0037, "pitch_mm": 3.3},
    "health": {"band": 13, "jump": 4021, "still": 117, "rail": 9, "blink": 121},
    "tare": {"contact_codes": 67, "step": 3},
    "cop": {"min_load_n": 0.55},
    "slip": {
        **{"window": 64, "hop": 32, "level": 2, "threshold_p2p_n": 0.083, "gross_threshold_p2p_n": 0.57},
        **{"contact_level_n": 0.31, "release_level_n": 0.2007},
        **{"hold_ms": 21.0, "refractory_ms": 11.5, "blank_ms": 55.0},
    },
}
NO_SLIP = {"window": 8, "threshold_p2p_n": 0.1, "gross_threshold_p2p_n": 0.2, "contact_level_n": 0.2}
NO_SLIP |= {"release_level_n": 0.1}
ELECTRODES = {
    "about": "odd",
    "clock": {"mhz": 21.7},
    "sensor": {"kind": "electrodes"},
    "adc": {"part": "AD7606", "volts": 10.0, "rate_hz": 777.0},
    "mesh": {"rows": 9, "columns": 11, "r_ohm": 47.0, "R0_ohm": 910.0, "V0_v": 12.0, "k_n_ohm": 5100.0},
    "load": {"gain": 0.7, "lsb_n": 0.0017, "min_n": 0.123, "correction": "none"},
    "cop_slip": {
        **{"lag_ms": 33.0, "drop": 0.37, "move": 0.0123, "min_load_n": 0.3},
        **{"hold_ms": 41.0, "refractory_ms": 90.0},
    },
}


def of(table):
    return config.read(
        "odd", {key: dict(value) if isinstance(value, dict) else value for key, value in table.items()}
    )


def test_single_channels():
    """LSB 3.3/4096 = 0.8056640625 mV. Level 1: a detail is sqrt(2) coefficients, a sum is two samples."""
    build = of(CHANNELS)
    assert build.settings == {
        "link.images": 0,
        "adc.enable": 1,
        "adc.period": 1824,  # 13 370 000 / 7331 = 1823.76
        "slip.threshold": 30,  # 17.5 / 0.8056640625 · 1.414214 = 30.718, down: compared with >
        "slip.gross_threshold": 194,  # 111 / 0.8056640625 · 1.414214 = 194.843, down
        "slip.keep_threshold": 17,  # 10.1 / 0.8056640625 · 1.414214 = 17.729, down
        "slip.contact_level": 7231,  # 2 · 2913 / 0.8056640625 = 7231.30
        "slip.release_level": 7491,  # 2 · 3017.5 / 0.8056640625 = 7490.72
        "slip.contact_rises": 0,
        "slip.hold": 45,  # 12.3 ms · 7.331 / 2 = 45.09 details
        "slip.refractory": 28,  # 28.22
        "slip.blank": 122,  # 33.2 · 7.331 / 2 = 121.69
    }
    assert build.parameters | {"Resets": 0} == {
        **{"Adc": 1, "ClkKhz": 13_370, "SclkKhz": 1000, "AdcLanes": 1, "BaudHz": 1_234_567, "Channels": 3},
        **{"Slip": 1, "Level": 1, "Window": 32, "Hop": 32, "TimerBits": 16, "SampleBits": 17},
        **{"Registers": 1, "Statistics": 1, "SlipOnly": 0, "Resets": 0},
    }
    units = build.units
    assert units.volts_per_code == 0.0008056640625
    assert units.detail_volts(30) == pytest.approx(0.017090715, abs=1e-9)  # 30 · 0.8056640625 mV / 1.41421356
    assert units.detail_volts(194) == pytest.approx(0.110519961, abs=1e-9)
    assert units.seconds(1824) == pytest.approx(136.42483e-6, abs=1e-11)  # 1824 / 13.37 MHz
    assert units.detail_newtons(30) is None and units.load_newtons(1) is None
    assert (units.rows, units.columns, units.clk_khz, units.rate_hz) == (1, 3, 13_370, 7331.0)
    assert units.place(8192, -4096)[:2] == (0.5, -0.25)


def test_a_hand():
    """13.37 MHz; an MCP3208's highest code is 4095."""
    grip = {"mode": "force", "rule": "weakest", "immediate": True, "cycle_ms": 7.3, "silent_ms": 40.0}
    grip |= {"step": 17, "decay": 3, "minimum": 901, "maximum": 50_003, "rate": 1203}
    grip |= {"rail_samples": 5, "pulse_divide": 9, "speed_gain": 311, "boost": 6}
    build, plain = of(CHANNELS | {"grip": grip}), of(CHANNELS)
    assert {key: value for key, value in build.settings.items() if key not in plain.settings} == {
        "grip.enable": 1,
        "grip.period": 97_601,  # 7.3 · 13 370 = 97 601.0
        "grip.step": 17,
        "grip.decay": 3,
        "grip.minimum": 901,
        "grip.maximum": 50_003,
        "grip.rate": 1203,
        "grip.watchdog": 5,  # 40 / 7.3 = 5.48
        "grip.rule": 1,
        "grip.mode": 1,
        "grip.immediate": 1,
        "grip.low": 0,  # a grounded pull-up; 3.3 V, the highest code, is its rest
        "grip.high": 65_535,
        "grip.rail": 5,
        "grip.divide": 9,
        "grip.speed_gain": 311,
        "grip.boost": 6,
    }
    assert {key: value for key, value in build.parameters.items() if key not in plain.parameters} == {
        "Grip": 1
    }
    assert build.units.code("grip.period", "seconds", 0.0073) == 97_601
    signed = of(CHANNELS | {"grip": {}, "adc": CHANNELS["adc"] | {"part": "AD7606"}})
    assert (signed.settings["grip.low"], signed.settings["grip.high"]) == (0, 65_535)
    # The defaults: 10 ms, 50 ms.
    assert (signed.settings["grip.period"], signed.settings["grip.watchdog"]) == (133_700, 5)


@pytest.mark.parametrize(
    "change",
    [
        {"cycle_ms": 0.0011},
        {"cycle_ms": 1255.0, "silent_ms": 2000.0},
        {"silent_ms": 9.9},
        {"rule": "loudest"},
        {"minimum": 60_001},
        {"rail_samples": 256},
        {"steps": 1},
    ],
)
def test_a_hand_that_cannot_be_is_refused(change):
    """13.37 MHz: 16 clocks are 0.00119671 ms, 2^24 - 1 are 1254.84 ms."""
    with pytest.raises(ValueError, match=rf"^\[grip\]: .*{next(iter(change))}"):
        of(CHANNELS | {"grip": change})
    with pytest.raises(ValueError, match=r"\[grip\] .* 'array'"):
        of(ARRAY | {"grip": {}})


RUBBER = {"k0_v": 1.61, "k1": -0.31, "n": 0.127, "vi_min_v": 1.31, "vi_max_v": 2.77, "noise_v": 0.083}
RUBBER |= {"still_v": 0.0031, "limit_mm_s": 2.3, "travel_mm": 0.0123, "hold_cycles": 3}


def test_sheared_rubber():
    """A level's unit is 1/512 of a code of 3.3/4096 V: 635500.606 per volt. A window lasts 64 / 7331 s."""
    build, plain = of(CHANNELS | {"shear_speed": RUBBER}), of(CHANNELS)
    assert {key: value for key, value in build.settings.items() if key not in plain.settings} == {
        "shear_speed.enable": 1,
        "shear_speed.k0": 1_023_156,  # 1.61 · 635500.606 = 1023155.98
        "shear_speed.k1": -20_316,  # -0.31 · 65536 = -20316.16
        "shear_speed.exponent": 16_126,  # 2048 / 0.127 = 16125.98
        "shear_speed.vi_min": 832_506,  # 1.31 · 635500.606 = 832505.79
        "shear_speed.vi_max": 1_760_337,  # 2.77 · 635500.606 = 1760336.68
        "shear_speed.noise": 52_747,  # 0.083 · 635500.606 = 52746.55
        "shear_speed.still": 1970,  # 0.0031 · 635500.606 = 1970.05
        "shear_speed.full": 4095,  # an MCP3208's highest code
        "shear_speed.limit": 2_411_725,  # 2.3 · 2^20 = 2411724.8
        "shear_speed.travel": 1_477_367,  # 0.0123 · 7331 / 64 · 2^20 = 1477366.58
        "shear_speed.hold_cycles": 3,
    }
    assert {key: value for key, value in build.parameters.items() if key not in plain.parameters} == {
        "ShearSpeed": 1
    }
    signed = of(CHANNELS | {"shear_speed": RUBBER, "adc": CHANNELS["adc"] | {"part": "AD7606"}})
    assert signed.settings["shear_speed.full"] == 32_767
    assert signed.settings["shear_speed.k0"] == 8_185_248  # eight times as many codes: 8185247.81


@pytest.mark.parametrize(
    "change, key",
    # 2048 / 0.03 = 68267, of 16 bits; 2 · 2^16 of 18; 16 · 2^20 of 24.
    [
        ({"n": 0.0}, "n"),
        ({"n": 0.03}, "exponent"),
        ({"k1": 2.0}, "k1"),
        ({"vi_min_v": 4.1}, "vi_min_v"),
        ({"hold_cycles": 256}, "hold_cycles"),
        ({"limit_mm_s": 16.0}, "limit"),
        ({"k": 1}, "'k'"),
    ],
)
def test_rubber_that_cannot_be_is_refused(change, key):
    with pytest.raises(ValueError, match=rf"^\[shear_speed\]: .*{key}"):
        of(CHANNELS | {"shear_speed": RUBBER | change})
    with pytest.raises(ValueError, match=r"\[shear_speed\] .* registers = true"):
        of(CHANNELS | {"shear_speed": RUBBER, "link": {"registers": False}})
    with pytest.raises(ValueError, match=r"\[shear_speed\] .* 'array'"):
        of(ARRAY | {"shear_speed": {}})


def test_an_array():
    build = of(ARRAY)
    assert build.settings == {
        "link.images": 0,
        "scan.enable": 1,
        "scan.settle": 46,  # 1.37 us · 33.333 = 45.67 clocks, rounded up
        "scan.period": 54_528,  # 33 333 000 / 611.3 = 54528.05
        "calibrate.preset": 4096,  # 1.0 in 12 bits of fraction
        "cop.min_load": 149,  # 0.55 / 0.0037 = 148.65, up: at least 0.55 N
        "health.use.user": 0,  # the ends that are faults follow below
        "health.use.edges": 0,
        "health.band": 13,
        "health.jump": 4021,
        "health.still": 117,
        "health.rail": 9,
        "health.blink": 121,
        "health.low": -32_768,  # the ends of 16-bit two's complement
        "health.high": 32_767,
        "tare.contact": 67,
        "tare.step": 3,
        "slip.threshold": 44,  # level 2, so 2 · 0.083 / 0.0037 = 44.86, down
        "slip.gross_threshold": 308,  # 2 · 0.57 / 0.0037 = 308.11
        "slip.contact_level": 335,  # 4 · 0.31 / 0.0037 = 335.14: a sum is four samples
        "slip.release_level": 217,  # 4 · 0.2007 / 0.0037 = 216.97
        "slip.contact_rises": 1,
        "slip.hold": 3,  # 21 ms · 0.6113 / 4 = 3.21
        "slip.refractory": 2,  # 11.5 · 0.6113 / 4 = 1.76
        "slip.blank": 8,  # 55 · 0.6113 / 4 = 8.41
    }
    assert build.parameters | {"Resets": 0} == {
        **{"Adc": 2, "ClkKhz": 33_333, "SclkKhz": 14_500, "AdcLanes": 1, "BaudHz": 3_000_000, "Array": 1},
        **{"Rows": 5, "Columns": 6, "Converters": 2, "AdcChannels": 3, "Health": 1, "Tare": 1},
        **{"RowColumn": 0, "GainShift": 12, "Image": 0, "Slip": 1, "Level": 2, "Window": 64, "Hop": 32},
        **{"TimerBits": 16, "SampleBits": 17, "Registers": 1, "Statistics": 1, "SlipOnly": 0, "Resets": 0},
    }
    units = build.units
    assert units.detail_newtons(44) == pytest.approx(0.0814, abs=1e-12)  # 44 · 3.7 mN / 2
    assert units.load_newtons(149) == pytest.approx(0.5513, abs=1e-12)
    assert units.seconds(54_528) == pytest.approx(1.635856359e-3, abs=1e-12)  # 54528 / 33.333 MHz
    assert units.detail_volts(44) is None
    # x halfway to the right, y at the upper edge: 0.5 · 3.3 · 5/2 mm, -1 · 3.3 · 4/2 mm.
    assert units.place(8192, -16_384) == (0.5, -1.0, pytest.approx(4.125), pytest.approx(-6.6))


def test_an_array_behind_an_ad7606c():
    """+-5 V on four data lines. A code is 10 V / 65536 = 0.152588 mV, so 0.172 mV of noise are 1.1272 codes,
    with the rounding's 0.2887 1.1636; ten times sqrt(2) of it is 16.46, up. 1.37 us are 45.67 clocks, up."""
    adc = ARRAY["adc"] | {"part": "AD7606C-16", "volts": 5.0, "channels": 8, "lanes": 4}
    build = of(ARRAY | {"adc": adc, "health": {}, "tare": {}})
    found = {name: build.settings[f"health.{name}"] for name in ("band", "jump", "low", "high")}
    assert found == {"band": 17, "jump": 4096, "low": -32_768, "high": 32_767}
    assert (build.settings["tare.contact"], build.settings["scan.settle"]) == (64, 46)
    wanted = {"Adc": 6, "SclkKhz": 60_000, "AdcLanes": 4, "Converters": 2, "AdcChannels": 8}
    assert {name: build.parameters[name] for name in wanted} == wanted


def widths(name, **array):
    table = tomllib.loads((config.FOLDER / f"{name}.toml").read_text())
    if array:
        table["array"] |= array
        del table["tare"]
    return config.read(name, table).widths


@pytest.mark.parametrize(
    "build, register, quantity, most, beyond",
    [
        (CHANNELS, "slip.threshold", "volts", 4.66576, 4.66577),  # 8190 · 3.3 / 4096 / sqrt(2) = 4.665766
        (CHANNELS, "slip.contact_level", "volts", 3.29939, 3.2996),  # half a step of a sum: 4095.25 codes
        (CHANNELS, "slip.release_level", "volts", -0.0002, -0.0003),
        (ARRAY, "slip.threshold", "newtons", 484.958, 484.96),  # 65535 codes of 3.7 mN, times 2 at level 2
        (ARRAY, "slip.contact_level", "newtons", 242.4795, 242.481),
        (ARRAY, "cop.min_load", "newtons", 7274.385, 7274.386),  # 30 taxels
        (ELECTRODES, "cop4.min_load", "newtons", 111.4095, 111.4096),  # 65535 · 1.7 mN
        (ELECTRODES, "cop_slip.min_load", "newtons", 111.4095, 111.4096),
    ],
)
def test_a_host_is_refused_what_the_build_never_reads(build, register, quantity, most, beyond):
    units = of(build).units
    assert units.code(register, quantity, most) >= 0
    with pytest.raises(ValueError, match=rf"^{register}: "):
        units.code(register, quantity, beyond)


def test_the_bits_of_a_build():
    """A detail has level bits more than a sample; a load has 16 and those that number the taxels; an offset
    has 17, of a row or a column 16."""
    assert widths("full") == {"detail": 18, "timer": 16, "load": 28, "offset": 17}  # 4096 taxels: 12
    assert widths("fingertip") == {"detail": 18, "timer": 16, "load": 20, "offset": 17}  # 9 taxels: 4
    # A serial path has samples of 13 bits, and its hold of 1000 details needs 10.
    assert widths("slip1") == {"detail": 14, "timer": 10, "load": 16, "offset": 17}
    assert widths("fingertip", gains="row_column")["offset"] == 16
    assert widths("fingertip", gains="row_column", tare=False)["offset"] == 16
    assert of(ARRAY).widths == {"detail": 19, "timer": 16, "load": 21, "offset": 17}  # 30 taxels: 5


@pytest.mark.parametrize("gains, parameters", [("taxel", (0, 12)), ("row_column", (1, 24))])
def test_a_gain_of_one(gains, parameters):
    """The reset value 4096: 2^12 per taxel, or 2^12 of the row times 2^12 of the column."""
    build = of(ARRAY | {"array": ARRAY["array"] | {"gains": gains}})
    assert (build.parameters["RowColumn"], build.parameters["GainShift"]) == parameters
    assert build.settings["calibrate.preset"] == 4096


# Part, volts, [sensor] keys, codes at or below which and at or above which a sample is a fault: an end of the
# range, but not where the sensor is at rest or pressed; 17 bits of -65536 and 65535 are never read.
RAILS = [
    ("MCP3208", 3.3, {}, (-65_536, 4095)),
    ("MCP3208", 3.3, {"wiring": "pulled_down"}, (-65_536, 4095)),
    ("MCP3208", 3.2, {"rest_v": 0.05}, (-65_536, 4095)),  # a 64th of the range
    ("MCP3208", 3.2, {"rest_v": 0.051}, (0, 4095)),
    ("MCP3208", 3.2, {"pressed_v": 3.15}, (-65_536, 65_535)),
    ("MCP3208", 3.2, {"pressed_v": 3.149}, (-65_536, 4095)),
    ("MCP3208", 5.0, {"wiring": "differential"}, (0, 4095)),
    ("MAX11123", 3.3, {}, (-65_536, 255)),
    ("MAX11124", 3.3, {"wiring": "differential"}, (0, 1023)),
    ("MAX11125", 3.3, {}, (-65_536, 4095)),
    ("MAX11131", 2.5, {"rest_v": 0.04}, (0, 4095)),  # a 64th is 0.0391 V
    ("AD7606", 10.0, {}, (-32_768, 32_767)),  # 0 V is the middle of its range
    ("AD7606", 10.0, {"wiring": "differential"}, (-32_768, 32_767)),
    ("AD7606", 6.4, {"wiring": "differential", "rest_v": -6.2}, (-65_536, 32_767)),  # 12.8 V / 64
    ("AD7606", 6.4, {"wiring": "differential", "rest_v": -6.199, "pressed_v": 6.2}, (-32_768, 65_535)),
    ("AD7606C-16", 5.0, {"wiring": "differential"}, (-32_768, 32_767)),
    ("AD7606", 6.4, {"rest_v": 0.1}, (-32_768, 32_767)),
    ("AD7606", 6.4, {"rest_v": 0.101}, (0, 32_767)),  # a grounded input
]
FALLING = [
    ("MCP3208", 5.0, {}, (0, 65_535)),
    ("MCP3208", 5.0, {"wiring": "pulled_up", "rest_v": 4.9}, (0, 4095)),
    ("MCP3208", 5.0, {"wiring": "pulled_up", "pressed_v": 0.0}, (-65_536, 65_535)),
    ("MCP3208", 5.0, {"wiring": "differential", "rest_v": 4.9}, (0, 4095)),
    ("AD7606", 5.0, {}, (0, 65_535)),
    ("AD7606", 10.0, {"rest_v": 5.0}, (0, 32_767)),
    ("AD7606", 10.0, {"wiring": "differential", "rest_v": 5.0}, (-32_768, 32_767)),
]


@pytest.mark.parametrize("part, volts, sensor, codes", RAILS)
def test_which_codes_of_a_taxel_are_a_fault(part, volts, sensor, codes):
    adc = {"part": part, "volts": volts, "rate_hz": 500.0, "converters": 1, "channels": 8}
    found = of(
        ARRAY | {"adc": adc, "sensor": ARRAY["sensor"] | sensor, "health": {}, "tare": {}, "slip": NO_SLIP}
    )
    assert (found.settings["health.low"], found.settings["health.high"]) == codes
    assert found.settings["health.use.user"] == 0  # an over-range mark is of both ends


@pytest.mark.parametrize("part, volts, sensor, codes", FALLING)
def test_which_codes_of_a_finger_are_a_fault(part, volts, sensor, codes):
    slip = CHANNELS["slip"] | {"contact_level_v": 4.5, "release_level_v": 4.8}
    adc = {"part": part, "volts": volts, "rate_hz": 5000.0}
    found = of(CHANNELS | {"adc": adc, "sensor": CHANNELS["sensor"] | sensor, "slip": slip, "grip": {}})
    assert (found.settings["grip.low"], found.settings["grip.high"]) == codes


@pytest.mark.parametrize(
    "sensor, slip, named",
    [
        ({"wiring": "pulled_sideways"}, {}, "wiring"),
        ({"rest_v": 3.31}, {}, "rest_v"),
        ({"rest_v": -0.01}, {}, "rest_v"),
        ({"pressed_v": 3.31}, {}, "pressed_v"),
        ({"rest_v": 3.0175}, {}, "release_level_v"),  # code 3745, 2 · 3745 = 7490 and the level is 7491
        ({"wiring": "pulled_down"}, {}, "rest_v"),
        ({"wiring": "pulled_up"}, {"contact_rises": True, "contact_level_v": 3.1}, "rest_v"),
    ],
)
def test_a_sensor_that_cannot_rest_there_is_refused(sensor, slip, named):
    with pytest.raises(ValueError, match=rf"^\[sensor\]: .*{named}"):
        of(CHANNELS | {"sensor": CHANNELS["sensor"] | sensor, "slip": CHANNELS["slip"] | slip})
    of(CHANNELS | {"sensor": CHANNELS["sensor"] | {"rest_v": 3.019}})
    with pytest.raises(ValueError, match=r"^\[sensor\]: .*pulled_up"):
        of(ARRAY | {"sensor": ARRAY["sensor"] | {"wiring": "pulled_up"}})


def test_a_finger_is_never_unhealthy_with_rail_samples_0():
    assert of(CHANNELS | {"grip": {"rail_samples": 0}}).settings["grip.rail"] == 0
    assert of(CHANNELS | {"grip": {"rail_samples": 1}}).settings["grip.rail"] == 1


def test_a_gain_of_the_differences():
    """A 6.3rd of Cx and Cy, 5.722391 and 8.649949; their shifts; and of the least current of an electrode."""
    plain, build = of(ELECTRODES), of(ELECTRODES | {"load": ELECTRODES["load"] | {"difference_gain": 6.3}})
    changed = {key: value for key, value in build.settings.items() if value != plain.settings[key]}
    assert changed == {
        "cop4.kx": 93_756,  # 5.722391 · 2^14 = 93755.7; · 2^15 is too much
        "cop4.shift_x": 14,
        "cop4.ky": 70_860,  # 8.649949 · 2^13 = 70860.4
        "cop4.shift_y": 13,
        "cop4.busy": 27_440,  # 27525.12 - (55 + 3)·(5.722391 + 1)/(5.722391 - 1) = 27442.56; less 3
    }
    assert build.parameters | {"Resets": 0} == plain.parameters | {"Resets": 0}


def test_four_electrodes():
    """R0/r = 910/47 = 19.361702; a code is 10 V / 32768 after a gain of 0.7."""
    build = of(ELECTRODES)
    assert build.settings == {
        "link.images": 0,
        "adc.enable": 1,
        "adc.period": 27_928,  # 21 700 000 / 777 = 27927.93
        "cop4.rail": 55_050,  # 2 · 12 V · 0.7 · 32768 / 10 V = 55050.24
        "cop4.kx": 73_833,  # Cx = (2·9·19.361702 + 12)/10 = 36.051064; · 2^11 = 73832.58, 2^12 is too much
        "cop4.shift_x": 11,
        "cop4.ky": 111_605,  # Cy = (2·11·19.361702 + 10)/8 = 54.494681; · 2^11 = 111605.11
        "cop4.shift_y": 11,
        "cop4.kf": 105_495,  # Kf = 2·5100/910 = 11.208791 N; / 1.7 mN / 65536 · 2^(8+12) = 105494.51
        "cop4.shift_load": 12,
        "cop4.top": 32_767,
        "cop4.idle": 27_470,  # V0 is 27525.12 codes, minus 55, a 500th of it
        "cop4.busy": 27_461,  # 27525.12 - (55 + 3)·(36.051064 + 1)/(36.051064 - 1) = 27463.81; less 3
        "cop4.imbalance": 55,  # a thousandth of 2V0
        "cop4.min_load": 73,  # 0.123 / 0.0017 = 72.35, up: at least 0.123 N
        "cop_slip.drop": 95,  # 0.37 · 256 = 94.72
        "cop_slip.move": 202,  # 0.0123 · 16384 = 201.52
        "cop_slip.min_load": 177,  # 0.3 / 0.0017 = 176.47, up: at least 0.3 N
        "cop_slip.hold": 32,  # 41 ms · 0.777 = 31.86 samples
        "cop_slip.refractory": 70,  # 69.93
    }
    assert build.parameters | {"Resets": 0} == {
        **{"Adc": 2, "ClkKhz": 21_700, "SclkKhz": 14_500, "AdcLanes": 1, "BaudHz": 3_000_000, "Channels": 4},
        **{"Slip": 0, "Cop4": 1, "Correct": 0, "CopSlip": 1, "Lag": 26},  # 33 ms · 0.777 = 25.64
        **{"Registers": 1, "Statistics": 1, "SlipOnly": 0, "Resets": 0},
    }
    assert build.units.load_newtons(1000) == pytest.approx(1.7)
    assert build.cop4.volts_per_code == pytest.approx(10 / 32_768 / 0.7)


def test_the_word_of_the_reset_values_has_each_at_its_place():
    """docs/registers.md: core.scratch has 32 bits, core.hold and adc.enable one, adc.period 24; slip
    follows."""
    word, at = of(CHANNELS).parameters["Resets"], 0
    found = {}
    for group, register, field in settings():
        found[f"{group.name}.{register.name}.{field.name}"] = word >> at & (1 << field.width) - 1
        at += field.width
    assert at == RESET_BITS and word >> at == 0
    assert word >> 32 & 3 == 2 and word >> 34 & 0xFF_FFFF == 1824 and word >> 58 & 0xF_FFFF == 30
    assert found["slip.release_level.value"] == 7491 and found["slip.blank.value"] == 122
    signed = CHANNELS | {"adc": CHANNELS["adc"] | {"part": "AD7606"}}
    below = of(signed | {"slip": CHANNELS["slip"] | {"contact_level_v": -0.01}}).parameters["Resets"]
    # 2 · -10 · 32.768 / 3.3 = -198.59, in 20 bits of two's complement, after 58 + 2·20 bits.
    assert below >> 98 & 0xF_FFFF == (1 << 20) - 199
    assert verilog({"Resets": 10, "Rows": 3}) == {"Resets": f"{RESET_BITS}'ha", "Rows": "3"}


@pytest.mark.parametrize(
    "volts, level, code",
    # 5 V / 4096 per code: 4096/5 = 819.2 codes per volt, times sqrt(2)^level.
    [(0.02, 1, 23), (0.02, 2, 32), (0.02, 3, 46), (0.25, 2, 409), (5.0, 2, 8192), (0.0, 3, 0)],
)
def test_thresholds_in_volts(volts, level, code):
    """23.17, 32.77, 46.34, 409.6, 8192."""
    assert Units(volts_per_code=5 / 4096, level=level).detail_code(volts) == code


@pytest.mark.parametrize("newtons, code", [(0.57, 1140), (0.07, 140), (0.29, 580), (0.0005, 1), (0.0004, 0)])
def test_a_threshold_in_decimal_newtons_is_exact(newtons, code):
    """1 mN per code at level 2: twice as many codes. In floating point 0.57·2/0.001 is below 1140."""
    assert Units(newtons_per_code=0.001, level=2).detail_code_of_newtons(newtons) == code


@pytest.mark.parametrize(
    "newtons, code", [(0.56, 560), (0.57, 570), (0.5601, 561), (0.0, 0), (0.0001, 1), (1.1, 1100), (0.009, 9)]
)
def test_a_least_load_in_decimal_newtons_is_exact(newtons, code):
    """1 mN per code. In floating point 0.56/0.001 is above 560."""
    assert Units(newtons_per_code=0.001).code("cop.min_load", "newtons", newtons) == code


def test_levels_of_a_symmetric_and_of_a_falling_range():
    """±5 V in 16 bits: 10 V are 65536 codes, 6553.6 per volt, from -32768 at -5 V up."""
    units = Units(volts_per_code=10 / 65_536, low_v=-5.0, min_code=-32_768, level=1)
    assert units.level_code(1.2345) == 16_181  # 2 · 1.2345 · 6553.6 = 16180.84
    assert units.level_code(-1.2345) == -16_181
    assert units.level_code(-5.0) == -65_536 and units.level_code(0.0) == 0
    falling = Units(volts_per_code=5 / 4096, level=3, volts_of=lambda newtons: 5 - 2 * newtons)
    assert falling.code("slip.contact_level", "newtons", 0.3) == 28_836  # 8 · 4.4 · 819.2 = 28835.84


def test_times():
    """13.37 MHz: 1 us is 13.37 clocks. Samples at 7331 Hz; four of them give a detail of level 2."""
    units = Units(clk_khz=13_370, rate_hz=7331.0, level=2)
    assert units.code("adc.period", "seconds", 100e-6) == 1337
    assert units.code("scan.period", "seconds", 1.5e-6) == 20  # 20.06
    assert units.code("scan.period", "seconds", 1.6e-6) == 21  # 21.39
    assert units.code("scan.period", "seconds", 1.65e-6) == 22  # 22.06
    assert units.code("adc.period", "seconds", 1.62e-6) == 22  # 21.66
    assert units.code("scan.settle", "seconds", 1.5e-6) == 21  # at least 20.06
    assert units.code("scan.settle", "seconds", 100e-6) == 1337
    assert units.code("scan.settle", "seconds", 0.0) == 1
    assert units.code("slip.hold", "seconds", 0.010) == 18  # 18.33
    assert units.code("slip.blank", "seconds", 0.0101) == 19  # 18.51
    for name in ("adc.period", "scan.period"):
        with pytest.raises(ValueError, match=f"{name} = 1e-09 seconds is less than one clock"):
            units.code(name, "seconds", 1e-9)


@pytest.mark.parametrize(
    "mhz, settle_us, clocks",
    [(25.0, 1.0, 25), (25.0, 1.0001, 26), (24.0, 2.0, 48), (13.37, 1.0, 14), (1.0, 0.0, 1), (27.0, 0.3, 9)],
)
def test_settling_is_never_shorter(mhz, settle_us, clocks):
    """25.0025, 13.37 and 8.1 clocks are rounded up."""
    adc = {
        "part": "MCP3208",
        "volts": 3.3,
        "rate_hz": 20.0,
        "channels": 8,
        "settle_us": settle_us,
        "sclk_khz": 250,
    }
    array = {key: value for key, value in ARRAY.items() if key != "slip"}
    build = of(array | {"adc": adc, "clock": {"mhz": mhz}, "link": {"baud": 115_200}})
    assert build.settings["scan.settle"] == clocks
