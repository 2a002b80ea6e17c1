"""A feature that a configuration leaves out costs no cell: Yosys elaborates the core of each named
configuration, and none of the blocks of the missing features is among the modules."""

import re

import pytest

from meissner.builds import config, toolchain
from meissner.builds.build import verilog
from meissner.builds.yowasp import chparam, read_rtl, yosys

# Blocks that serve only one feature.
BLOCKS = {
    "Array": {
        "msn_sensor_array",
        "msn_scan",
        "msn_calibrate",
        "msn_width_converter",
        "msn_cop_divide",
    },
    "Health": {"msn_health"},
    "Tare": {"msn_tare"},
    "Slip": {"msn_slip_path"},
    "Serial": {"msn_slip_serial", "msn_adc_single"},
    "Image": {"msn_image_chunks"},
    "Display": {"msn_render", "msn_pin_display"},
    "Cop4": {"msn_cop4", "msn_electrodes"},
    "CopSlip": {"msn_cop_slip"},
    "Grip": {"msn_grip", "msn_pwm", "msn_finger_health"},
    "Registers": {"msn_bridge", "msn_uart_rx"},
    "SlipOnly": {"msn_packet_slip"},
    "Demod": {"msn_am_demod", "msn_scan_demod"},
}


def elaborated(name, parameters):
    """Names of the modules that the core has with these parameters."""
    given = chparam("msn_core", verilog(parameters))
    folder = toolchain.BUILD / "left_out"
    folder.mkdir(parents=True, exist_ok=True)
    log = folder.relative_to(toolchain.ROOT) / f"{name}.log"
    yosys(f"{read_rtl()}; {given}hierarchy -top msn_core; tee -o {log}.modules ls", str(log))
    text = (toolchain.ROOT / f"{log}.modules").read_text()
    return set(re.findall(r"\bmsn_\w+", text))


@pytest.mark.parametrize("name", config.names())
def test_what_is_left_out_is_not_elaborated(name):
    parameters = config.load(name).parameters
    there = elaborated(name, parameters)
    for feature, blocks in BLOCKS.items():
        has = bool(parameters.get(feature, 0))
        assert (blocks <= there) if has else not (blocks & there), (name, feature, sorted(blocks & there))
