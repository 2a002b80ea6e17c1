"""Each board's description against the pins that it cites, copied by hand from that file: clock, line, LEDs,
headers and converter. LEDs by what their names say, in every combination of flags. PLLs by arithmetic from
the oscillator, within the limits of their data sheets."""

import json
import re
from fractions import Fraction
from itertools import product

import pytest

from meissner.builds import board_files, boards, pins
from meissner.builds.yowasp import ROOT, yosys

PMOD = ("1", "2", "3", "4", "7", "8", "9", "10")
ALL = {**boards.BOARDS, "arty_a7": boards.ARTY}


def pmod(**headers):
    return {name.replace("_", " "): dict(zip(PMOD, at.split())) for name, at in headers.items()}


def differential(first, text):
    """{GPk: pin, GNk: pin} of "pin of gp[k], pin of gn[k]" for k from ``first`` on."""
    names = [f"G{pole}{first + k}" for k in range(len(text.split()) // 2) for pole in "PN"]
    return dict(zip(names, text.split()))


# board: (end of the cited address, oscillator, its MHz, rx, tx, headers); rx is the USB chip's TXD.
PUBLISHED = {
    "icebreaker": (
        "1bitsquared_icebreaker.py", "35", 12, "6", "9",
        pmod(
            PMOD_1A="4 2 47 45 3 48 46 44",
            PMOD_1B="43 38 34 31 42 36 32 28",
            PMOD_2="27 25 21 19 26 23 20 18",
        ),
    ),
    "ulx3s": (
        "ulx3s_v20.lpf", "G2", 25, "M1", "L4",
        {
            "J1": differential(0, "B11 C11 A10 A11 A9 B10 B9 C10 A7 A8 C8 B8 C6 C7 A6 B6 A4 A5 A2 B1 C4 B4"),
            "J2": differential(
                18, "H18 H17 F17 G18 D18 E17 C18 D17 B15 C15 B17 C17 C16 D16 D14 E14 B13 C13 D13 E13"
            ),
        },
    ),
    "orangecrab": (
        "gsd_orangecrab.py", "A9", 48, "N17", "M18",
        {"feather": {
            "SDA": "C10", "SCL": "C9", "5": "B10", "6": "B9", "9": "C8", "10": "B8", "11": "A8", "12": "H2",
            "13": "J2", "MISO": "N15", "SCK": "R17", "MOSI": "N16", "A0": "L4", "A1": "N3", "A2": "N4",
            "A3": "H4", "A4": "G4", "A5": "T17",
        }},
    ),
    "tangnano20k": (
        "sipeed_tang_nano_20k.py", "4", 27, "70", "69",
        {header: {at: at for at in text.split()} for header, text in
         {"J5": "76 80 42 41 48 49 86 72 71 53 52", "J6": "73 74 75 85 77"}.items()},
    ),
    "arty_a7": (
        "Arty-A7-35-Master.xdc", "E3", 100, "A9", "D10",
        pmod(
            JA="G13 B11 A11 D12 D13 B18 A18 K16", JB="E15 E16 D15 C15 J17 J18 K15 J15",
            JC="U12 V12 V10 V11 U14 V14 T13 U13", JD="D4 D3 F4 F3 E2 D2 H2 G2",
        ),
    ),
}  # fmt: skip
# Of emard's file: adc_csn, adc_sclk, adc_mosi, adc_miso.
ONBOARD = {"cs_n": "R17", "sclk": "P17", "mosi": "R16", "miso": "U16"}


@pytest.mark.parametrize("board", PUBLISHED)
def test_pins_are_those_of_the_cited_file(board):
    source, clock, mhz, rx, tx, headers = PUBLISHED[board]
    found = pins.description(board)
    assert found.source.endswith(f"/{source}")
    assert (found.clock["pin"], found.clock["mhz"], found.serial) == (clock, mhz, {"rx": rx, "tx": tx})
    assert found.headers == {f"{name} {at}": pin for name, of in headers.items() for at, pin in of.items()}
    assert {role: found.onboard.get(role) for role in ONBOARD} == (
        ONBOARD if board == "ulx3s" else dict.fromkeys(ONBOARD)
    )


def test_the_ulx3s_reads_its_own_converter_on_its_pins():
    """By the maker's names of the lines, in the constraints that place and route reads."""
    text = board_files.constraints(boards.BOARDS["ulx3s"].plan("slip1"), ".lpf")
    at = dict(re.findall(r'LOCATE COMP "(\w+)" SITE "(\w+)"', text))
    assert {role: at[f"adc_{role}_{'i' if role == 'miso' else 'o'}"] for role in ONBOARD} == ONBOARD


# {port: (its pin in the cited file, when it is lit)}
LEDS = {
    "icebreaker": {  # red and green
        "led_red_n_o": ("11", lambda f: f["slip"] or f["gross"]),
        "led_green_n_o": ("37", lambda f: (f["touched"] or f["pressed"]) and not f["slip"]),
    },
    "ulx3s": {  # led[0] to led[7]
        "led_gross_o": ("B2", lambda f: f["gross"]), "led_slip_o": ("C2", lambda f: f["slip"]),
        "led_touched_o": ("C1", lambda f: f["touched"]), "led_pressed_o": ("D2", lambda f: f["pressed"]),
        "led_good_o": ("D1", lambda f: f["good"]), "led_5_o": ("E2", lambda f: False),
        "led_6_o": ("E1", lambda f: False), "led_7_o": ("H3", lambda f: False),
    },
    "orangecrab": {  # rgb_led
        "led_red_n_o": ("K4", lambda f: f["gross"]), "led_green_n_o": ("M3", lambda f: f["slip"]),
        "led_blue_n_o": ("J3", lambda f: f["touched"] or f["pressed"]),
    },
    "tangnano20k": {  # led_n 0 to 3
        "led_touched_n_o": ("15", lambda f: f["touched"]), "led_pressed_n_o": ("16", lambda f: f["pressed"]),
        "led_slip_n_o": ("17", lambda f: f["slip"]), "led_gross_n_o": ("18", lambda f: f["gross"]),
    },
    "arty_a7": {  # led[0] to led[3], LD4 to LD7
        "led_gross_o": ("H5", lambda f: f["gross"]), "led_slip_o": ("J5", lambda f: f["slip"]),
        "led_touched_o": ("T9", lambda f: f["touched"]), "led_pressed_o": ("T10", lambda f: f["pressed"]),
    },
}  # fmt: skip


@pytest.mark.parametrize("board", LEDS)
def test_each_led_is_lit_for_what_its_name_says(board):
    plan = ALL[board].plan("slip1")
    top = board_files.top(plan)
    shown = dict(re.findall(r"assign (led_\w+) = (.+);", top))
    assert {row["port"]: row["pin"] for row in plan.rows() if row["port"].startswith("led_")} == {
        port: pin for port, (pin, _) in LEDS[board].items()
    }
    assert shown.keys() == LEDS[board].keys()
    flags = ("slip", "gross", "touched", "pressed", "good")
    for port, text in shown.items():
        for operator, word in (("!", " not "), ("&&", " and "), ("||", " or "), ("1'b0", "False")):
            text = text.replace(operator, word)
        for values in product((False, True), repeat=len(flags)):
            now = dict(zip(flags, values))
            level = eval(text, {}, now)
            lit = level != port.endswith("_n_o")  # low-active
            assert lit == LEDS[board][port][1](now), (port, now)
    wired = dict(re.findall(r"\.(\w+?)_o +\((\w+)\)", top.partition("msn_board u_board (")[2]))
    assert all(wired[flag] == flag for flag in flags[:4])


def ice40(cell, mhz):
    """Lattice FPGA-TN-02052: a simple feedback path; 10 to 133 MHz at the detector, whose filter of range 1
    is for less than 17; an oscillator of 533 to 1066."""
    detector = mhz / (cell["DIVR"] + 1)
    oscillator = detector * (cell["DIVF"] + 1)
    assert 10 <= detector < 17 and cell["FILTER_RANGE"] == 1 and 533 <= oscillator <= 1066
    assert cell["FEEDBACK_PATH"] == "SIMPLE"
    return oscillator / 2 ** cell["DIVQ"]


def ecp5(cell, mhz):
    """Lattice FPGA-TN-02200: fed back from its output; an oscillator of 400 to 800 MHz; the phase of 0."""
    made = mhz / cell["CLKI_DIV"] * cell["CLKFB_DIV"]
    assert 400 <= made * cell["CLKOP_DIV"] <= 800 and cell["CLKOP_CPHASE"] == cell["CLKOP_DIV"] - 1
    assert (cell["FEEDBK_PATH"], cell["CLKOP_ENABLE"]) == ("CLKOP", "ENABLED")
    return made


def artix(cell, mhz):
    """AMD DS181, the slowest grade: an oscillator of 600 to 1200 MHz."""
    oscillator = mhz * Fraction(cell["CLKFBOUT_MULT_F"])
    assert 600 <= oscillator <= 1200 and Fraction(cell["CLKIN1_PERIOD"]) == 1000 / mhz
    return oscillator / Fraction(cell["CLKOUT0_DIVIDE_F"])


# (board, MHz of the core): the cell and its law; None: the oscillator itself
PLLS = {
    **{("icebreaker", 12): None, ("icebreaker", 24): ("SB_PLL40_PAD", ice40)},
    **{("ulx3s", mhz): ("EHXPLLL", ecp5) for mhz in (25, 50, 100)},
    **{("orangecrab", 48): None, ("tangnano20k", 27): None, ("arty_a7", 50): ("MMCME2_BASE", artix)},
}


def value(text):
    """A parameter in Yosys's JSON: 32 bits, or text."""
    return int(text, 2) if re.fullmatch("[01]{3,}", text) else text.strip()


def test_each_pll_makes_the_cores_clock():
    """Every clock of every board, as Yosys elaborates it, in one run."""
    assert {key for key in PLLS} == {
        (board, mhz) for board in ALL for mhz in pins.description(board).clock["core_mhz"]
    }
    script = ["read_verilog -lib tb/lint/cells.v; design -save cells"]
    for board, mhz in PLLS:
        folder = f"build/tb/clocks/{board}-{mhz}"
        (ROOT / folder).mkdir(parents=True, exist_ok=True)
        (ROOT / folder / "msn_build.svh").write_text(f"`define MSN_CLK_KHZ {1000 * mhz}\n")
        top = f"{board}_clock"
        script += [
            f"design -load cells; read_verilog -sv -I{folder} rtl/boards/{top}.sv",
            f"hierarchy -top {top}; proc; opt_clean; write_json {folder}/clock.json",
        ]
    yosys("; ".join(script), "build/tb/clocks/log")
    for (board, mhz), pll in PLLS.items():
        module = json.loads((ROOT / f"build/tb/clocks/{board}-{mhz}/clock.json").read_text())["modules"][
            f"{board}_clock"
        ]
        cells = [cell for cell in module["cells"].values() if "PLL" in cell["type"] or "MMCM" in cell["type"]]
        clock = Fraction(PUBLISHED[board][2])
        if pll is None:
            port = pins.description(board).clock["port"]
            assert not cells and module["ports"]["clk_o"]["bits"] == module["ports"][port]["bits"]
            assert clock == mhz
            continue
        (cell,), (kind, law) = cells, pll
        assert cell["type"] == kind
        assert law({name: value(text) for name, text in cell["parameters"].items()}, clock) == mhz
