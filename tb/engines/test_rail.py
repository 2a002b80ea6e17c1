"""A voltage at the end of a converter's range, from the pin to the packet: volts become codes by the data
sheet, the registers come from the configuration, and the core runs in Verilator behind the converter's
pins."""

from math import floor

import numpy as np
import pytest

from meissner.builds import config
from meissner.engines.rtl_core import CoreOnPins
from meissner.twins.link.decoder import Decoder

HEALTH, RAILED = 4, 2  # docs/link.md
SLIP = ("threshold_p2p_n", "gross_threshold_p2p_n", "contact_level_n", "release_level_n")
# Full scale, bits, lowest code; volts of six taxels, and the taxels that are railed.
PARTS = {
    # 3.3 V / 4096 = 0.8057 mV: 3.2995 V is 4095.4 codes, 3.2988 V 4094.5, 0.5 mV 0.6 and 0.9 mV 1.1.
    "MCP3208": (3.3, 12, 0, [3.2995, 3.2988, 0.0005, 0.0009, 3.35, 1.65], {0, 2, 4}),
    # 10 V / 32768 = 0.30518 mV: 9.9998 V: 32767.3, 9.9995 V: 32766.4, -9.9999 V: -32767.7, -9.9996: -32766.7.
    "AD7606": (10.0, 16, -32_768, [9.9998, 9.9995, -9.9999, -9.9996, -10.5, 0.0], {0, 2, 4}),
    # 5 V / 32768 = 0.15259 mV: the same codes at half the volts.
    "AD7606C-16": (5.0, 16, -32_768, [4.9999, 4.99975, -4.99995, -4.9998, -5.5, 0.0], {0, 2, 4}),
}


def build(part, volts, wiring):
    adc = {
        "part": part,
        "volts": volts,
        "rate_hz": 500.0,
        "channels": 4 if part == "MCP3208" else 8,
        "lanes": 4 if part == "AD7606C-16" else 1,
    }
    return config.read(
        "rail",
        {
            **{"about": "of a test", "clock": {"mhz": 4.0}, "adc": adc},
            **{"sensor": {"kind": "array", "rows": 2, "columns": 3, "wiring": wiring}},
            "array": {"health": True, "tare": False},
            "health": {"still": 0, "blink": 0, "rail": 1},
            "slip": dict.fromkeys(SLIP, 1.0) | {"window": 8},
            "link": {"baud": 1_000_000, "statistics": False},
        },
    )


@pytest.mark.parametrize("wiring", ["pulled_down", "differential"])
@pytest.mark.parametrize("part", PARTS)
def test_a_code_at_the_rail_is_reported_railed(part, wiring):
    """But not where a pull-down rests: at 0 of a converter from 0 V. Runs for more than 16 frames."""
    full, bits, lowest, volts, railed = PARTS[part]
    railed = railed - {2} if wiring == "pulled_down" and not lowest else railed
    top = lowest + (1 << bits) - 1
    steps = (1 << bits) / (full - (-full if lowest else 0))
    codes = [min(max(floor(v * steps), lowest), top) for v in volts]
    made = build(part, full, wiring)
    with CoreOnPins(made, np.array(codes).reshape(1, 2, 3)) as core:
        data = core.run(24 * made.period_clocks)
    packets = [packet for packet in Decoder().next(data) if packet.kind == HEALTH]
    assert {(packet.fields["taxel"], packet.fields["faults"]) for packet in packets} == {
        (taxel, RAILED) for taxel in railed
    }
