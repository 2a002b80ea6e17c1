"""What a converter reads of a sensor: its noise, and which codes mean a fault (docs/config.md).

An end of the range means a fault where the sensor is neither at rest nor when it is pressed: a grounded
pull-up reads 0, and 0 is what a pull-down reads at rest.
"""

from math import ceil, hypot
from typing import Literal, NamedTuple

from meissner.physics.adc import PARTS, Adc
from meissner.tables import Table, exact
from meissner.twins.frontend.adc_spi import Part

NEVER = (-65536, 65535)  # 17 bits: no converter of up to 16 bits reads them
NEAR = 64  # a sensor nearer to an end than this share of the range may read it
VOLTS = {False: (0.25, 5.5), True: (1, 10)}  # of a reference and a divider; of a symmetric range
Wiring = Literal["pulled_down", "pulled_up", "differential"]


class Sensed(Table, frozen=True):
    """Keys of [sensor]: how it is wired; volts at the converter at rest and under the largest force."""

    wiring: Wiring | None = None
    rest_v: float | None = None
    pressed_v: float | None = None


class Rails(NamedTuple):
    """Samples at or below ``low``, and at or above ``high``, mean a fault."""

    low: int
    high: int


def converter(part: Part, volts: float) -> Adc:
    """The converter with its own noise, a symmetric one's in proportion to its range.

    A part without a figure counts as an MCP3208. ValueError if the part does not have such a range.
    """
    least, most = VOLTS[part.signed]
    if not least <= volts <= most:
        raise ValueError(f"volts = {volts:g} must lie in {least:g} .. {most:g} for the {part.name.upper()}")
    known = PARTS.get(part.name.upper(), PARTS["MCP3208"])
    noise = known.noise_v * (volts / known.high_v if part.signed else 1)
    return Adc(part.data_bits, -volts if part.signed else 0.0, volts, noise)


def band(adc: Adc) -> int:
    """Codes of a move: ten standard deviations of the difference of two samples, rounding included."""
    return ceil(10 * 2**0.5 * hypot(adc.noise_v / adc.lsb_v, 12**-0.5))


def jump(adc: Adc) -> int:
    """Codes of a jump: a sixteenth of the range, but at least eight bands.

    A finger that moves a taxel by eight bands moves the next one by a band.
    """
    return max((1 << adc.bits) // 16, 8 * band(adc))


def contact(adc: Adc) -> int:
    """Codes above a taxel's zero that are contact: two bands, and 64 from 12 bits on."""
    return max(2 * band(adc), min(64, (1 << adc.bits) // 64))


def rest(adc: Adc, sensor: Sensed, wiring: Wiring) -> float:
    """Volts at rest; ValueError if a voltage does not lie where such a sensor can."""
    bottom = adc.low_v if wiring == "differential" else 0.0
    for key in ("rest_v", "pressed_v"):
        value = getattr(sensor, key)
        if value is not None and not bottom <= value <= adc.high_v:
            raise ValueError(f"{key} = {value:g} must lie in {bottom:g} .. {adc.high_v:g}")
    usual = {"pulled_down": 0.0, "pulled_up": adc.high_v, "differential": (bottom + adc.high_v) / 2}
    return usual[wiring] if sensor.rest_v is None else sensor.rest_v


def rails(adc: Adc, sensor: Sensed, wiring: Wiring) -> Rails:
    """The codes that mean a fault.

    A sensor between ground and supply is at 0 V where it is grounded. On a symmetric converter that is the
    middle, which a pull-down reads at rest: only the lowest code is its fault.
    """
    volts = [rest(adc, sensor, wiring)] + ([] if sensor.pressed_v is None else [sensor.pressed_v])
    grounded = wiring != "differential" and adc.min_code < 0  # its bottom is not the converter's
    bottom, top = exact(0 if grounded else adc.low_v), exact(adc.high_v)
    near = (top - bottom) / NEAR
    if exact(min(volts)) > bottom + near:
        low = 0 if grounded else adc.min_code
    else:
        low = adc.min_code if grounded else NEVER[0]
    return Rails(low, NEVER[1] if exact(max(volts)) >= top - near else adc.max_code)
