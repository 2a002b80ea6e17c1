"""Configurations that a user may write and that no named pair has, with the number of lines that each needs,
counted by hand."""

ARRAY = """
about = "{about}"
[clock]
mhz = {mhz}
[sensor]
kind = "array"
rows = {rows}
columns = {columns}
[adc]
part = "{part}"
converters = {converters}
channels = {channels}
lanes = {lanes}
volts = 5.0
rate_hz = {rate_hz}
[array]
tare = false
[link]
images = true
"""


def array(mhz, part, rows, columns, converters, channels, lanes=1, rate_hz=200.0):
    return ARRAY.format(**locals(), about=f"{rows}×{columns} on {converters} {part}")


CHANNELS = """
about = "three sensors on one {part}"
[clock]
mhz = {mhz}
[sensor]
kind = "channels"
channels = 3
[adc]
part = "{part}"
volts = 5.0
rate_hz = {rate_hz}
[slip]
contact_level_v = 4.5
release_level_v = 4.8
"""

RUBBER = (
    CHANNELS
    + """
threshold_p2p_v = 0.02
gross_threshold_p2p_v = 0.12
contact_rises = false
"""
)

EACH = (
    CHANNELS
    + """
window = 4
hold_ms = 2.0
threshold_p2p_v = 0.2
gross_threshold_p2p_v = 2.0
[link]
slip_pins = true
registers = false
"""
)

SPI = {"adc_cs_n_o": 1, "adc_sclk_o": 1, "moving_i": 1}
BUSY = SPI | {"adc_convst_o": 1, "adc_reset_o": 1}
USERS = {  # name: (text for a given clock, lines on the headers)
    "two": (
        lambda mhz: array(mhz, "MCP3208", 2, 4, 2, 2),
        SPI | {"adc_mosi_o": 1, "adc_miso_i": 2, "row_o": 2},
    ),
    # Ten columns on three converters: the last beat of a row has one.
    "three": (
        lambda mhz: array(mhz, "MCP3208", 2, 10, 3, 4),
        SPI | {"adc_mosi_o": 1, "adc_miso_i": 3, "row_o": 2},
    ),
    # 16 columns in four groups of 2 converters × 2 channels; 16 rows as a number and an enable.
    "groups": (
        lambda mhz: array(mhz, "MCP3208", 16, 16, 2, 2, rate_hz=5.0),
        SPI | {"adc_mosi_o": 1, "adc_miso_i": 2, "row_o": 5, "group_o": 2},
    ),
    "lanes": (
        lambda mhz: array(mhz, "AD7606", 5, 16, 2, 8, lanes=2),
        BUSY | {"adc_busy_i": 2, "adc_miso_i": 4, "row_o": 5},
    ),
    # The largest row count with one line per row, and the smallest without.
    "eight": (
        lambda mhz: array(mhz, "AD7606", 8, 7, 1, 7),
        BUSY | {"adc_busy_i": 1, "adc_miso_i": 1, "row_o": 8},
    ),
    "nine": (
        lambda mhz: array(mhz, "AD7606C-16", 9, 7, 1, 7, lanes=4),
        BUSY | {"adc_mosi_o": 1, "adc_busy_i": 1, "adc_miso_i": 4, "row_o": 5},
    ),
    "max": (
        lambda mhz: array(mhz, "MAX11131", 3, 4, 2, 2),
        SPI | {"adc_mosi_o": 1, "adc_miso_i": 2, "row_o": 3},
    ),
    "each": (
        lambda mhz: EACH.format(mhz=mhz, part="MCP3208", rate_hz=4000.0),
        SPI | {"adc_mosi_o": 1, "adc_miso_i": 1, "slip_each_o": 3},
    ),
    "channels": (
        lambda mhz: RUBBER.format(mhz=mhz, part="AD7606", rate_hz=5000.0),
        BUSY | {"adc_busy_i": 1, "adc_miso_i": 1},
    ),
}
CLOCKS = {"icebreaker": 24.0, "ulx3s": 25.0, "orangecrab": 48.0, "tangnano20k": 27.0, "arty_a7": 50.0}


def write(folder, name, mhz):
    """Write the configuration's file into ``folder``; returns its path as a string."""
    path = folder / f"{name}.toml"
    path.write_text(USERS[name][0](mhz), "utf-8")
    return str(path)
