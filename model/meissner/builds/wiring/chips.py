"""Converters as a drawing needs them: the number of each pin, and what the pins without a signal are tied to.

docs/adc.md has the sources of the MCP3208, AD7606 and MAX11123 to MAX11125. Pin numbers of the others, marked
``unverified``, are from memory: check them against the data sheet (docs/adc.md).
"""

from dataclasses import dataclass

from meissner.twins.frontend.adc_spi import Part

LANES = "ABCDEFGH"


@dataclass(frozen=True)
class Chip:
    """``inputs``, ``lanes``: (name, number) of each; ``lines``: {role of builds.pins: (name, number)};
    ``ties``: what the other pins need, {volts} being the supply of a part with one supply."""

    package: str
    inputs: tuple[tuple[str, str], ...]
    lines: dict[str, tuple[str, str]]
    lanes: tuple[tuple[str, str], ...]
    ties: tuple[str, ...]
    fed: str  # pins that the board's 3.3 V supplies
    unverified: str = ""


MCP3208 = Chip(
    "DIP or SOIC, 16 pins",
    tuple((f"CH{k}", str(k + 1)) for k in range(8)),
    {"cs_n": ("CS", "10"), "sclk": ("CLK", "13"), "mosi": ("DIN", "11")},
    (("DOUT", "12"),),
    (
        "VDD 16, VREF 15: {volts}",
        "AGND 14, DGND 9 and unused inputs: GND",
        "VDD to GND: 1 µF, VREF to GND: 1 µF",
    ),
    "VDD, VREF",
)
_SERIAL = {
    "cs_n": ("CS", "13"),
    "sclk": ("SCLK", "12"),
    "convst": ("CONVST A, B", "9, 10"),
    "reset": ("RESET", "11"),
    "busy": ("BUSY", "14"),
}
_INPUTS = tuple((f"V{k + 1}", str(49 + 2 * k)) for k in range(8))
_SUPPLIES = (
    "AVCC 1, 37, 38, 48: 5 V, 100 nF each",
    "VDRIVE 23: {io}",
    "AGND 2, 26, 35, 40, 41, 47, REFGND 43, 46, V1GND 50 to V8GND 64 (even numbers) and unused inputs: GND",
    "REFCAPA 44 with REFCAPB 45: 10 µF to GND; REFIN 42: 10 µF; REGCAP 36, 39: 1 µF each",
)
AD7606 = Chip(
    "LQFP, 64 pins",
    _INPUTS,
    _SERIAL,
    (("DOUTA", "24"), ("DOUTB", "25")),
    (
        *_SUPPLIES,
        "PAR/SER 6, STBY 7, REF SELECT 34: high (VDRIVE)",
        "OS0 to OS2 3, 4, 5, DB0 to DB6 16 to 22, DB9 to DB15 27 to 33: GND; RANGE 8: {range}",
    ),
    "VDRIVE",
)
AD7606C = Chip(
    "LQFP, 64 pins",
    _INPUTS,
    _SERIAL | {"mosi": ("SDI", "29")},
    (
        ("DOUTA", "24"),
        ("DOUTB", "25"),
        ("DOUTC", "27"),
        ("DOUTD", "28"),
        *((f"DOUT{k}", "") for k in LANES[4:]),
    ),
    (
        *_SUPPLIES,
        "PAR/SER 6, STBY 7, OS0 to OS2 3, 4, 5, REF SELECT 34: high (VDRIVE)",
        "DB0 to DB6 16 to 22 and other unused data pins: GND",
    ),
    "VDRIVE",
    "SDI and DOUTC on",
)


def _max(unverified: str = "") -> Chip:
    return Chip(
        "TQFN, 28 pins",
        tuple((f"AIN{k}", number) for k, number in enumerate(("26", "27", "28", "1", "2", "3", "4", "5"))),
        {"cs_n": ("CS", "20"), "sclk": ("SCLK", "19"), "mosi": ("DIN", "21")},
        (("DOUT", "24"),),
        (
            "VDD 17, 18, OVDD 23, REF+ 15, CNVST 12: {volts}; 100 nF at each supply, 470 nF at REF+",
            "GND 14, 16, DGND 22, REF- 13, pad and unused inputs: GND; EOC 25 stays open",
        ),
        "VDD, OVDD, REF+",
        unverified,
    )


CHIPS = {"MCP3208": MCP3208, "AD7606": AD7606, "AD7606C-16": AD7606C}
CHIPS |= dict.fromkeys(("MAX11123", "MAX11124", "MAX11125"), _max())
CHIPS["MAX11131"] = _max("all of them")


def chip(part: Part) -> Chip:
    return CHIPS[part.name.upper()]
