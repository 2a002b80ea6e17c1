"""The boards a bitstream can be made for, and the configurations each is offered with."""

from dataclasses import dataclass

from meissner.link.registers import RESET_BITS, reset_word

# What counts as what: patterns of nextpnr's names, of Yosys's for flip-flops.
ECP5_AREA = {"lut": "TRELLIS_COMB", "ff": "TRELLIS_FF", "bram": "DP16KD", "dsp": "MULT18X18D"}
ICE40_AREA = {"lut": "ICESTORM_LC", "ff": "SB_DFF.*", "bram": "ICESTORM_RAM", "dsp": "ICESTORM_DSP"}
GOWIN_AREA = {"lut": "LUT4|ALU|RAMW", "ff": "DFF.*", "bram": "BSRAM", "dsp": "MULT.*"}


@dataclass(frozen=True)
class Board:
    """One board: ``pnr`` and ``pack`` are commands of which synth.py fills in the files.

    ``clk_khz``: the clock of the core unless a configuration has its own; ``configs``: name to the parameters
    of rtl/msn_core.sv that are this board's; ``cells``: family whose cells the netlist has.
    """

    name: str
    title: str
    cells: str
    synth: str
    pnr: str
    constraints: str
    pack: str
    bitstream: str
    area: dict
    configs: dict

    @property
    def top(self):
        return f"{self.name}_top"

    @property
    def sources(self):
        """What a board has besides rtl/rtl.f, from the repository's root."""
        return [f"rtl/boards/{module}.sv" for module in ("msn_board_reset", "msn_board", self.top)]


def literal(value):
    """``value`` as Verilog; what is wider than an integer has its width."""
    return value if value < 1 << 31 else f"{RESET_BITS}'h{value:x}"


def sizes(parameters):
    """What rtl/boards must know of msn_core's parameters, by the names of its macros."""
    columns, converters = parameters.get("Columns", 1), parameters.get("Converters", 1)
    inputs = 1 if parameters.get("Demod") else parameters.get("AdcChannels", 8)
    groups = -(-columns // (converters * inputs))
    return {
        "CLK_KHZ": parameters["ClkKhz"],
        "ADC": parameters["Adc"],
        "ROWS": parameters.get("Rows", 1),
        "CONVERTERS": converters,
        "ADC_LANES": parameters.get("AdcLanes", 1),
        "GROUP_BITS": max((groups - 1).bit_length(), 1),
    }


SLIP = {
    "slip.threshold": 23,
    "slip.gross_threshold": 200,
    "slip.contact_level": 7000,
    "slip.release_level": 7400,
    "slip.contact_rises": 0,
    "slip.hold": 100,
    "slip.refractory": 50,
    "slip.blank": 250,
}
MCP3208 = {"Adc": 1, "SclkKhz": 1000}
MAX11125 = {"Adc": 5, "SclkKhz": 16000}


def _slip1(clk_khz, part):
    """One rubber sensor at 10 kHz and nothing else."""
    resets = SLIP | {"adc.enable": 1, "adc.period": clk_khz // 10}
    return part | {
        "ClkKhz": clk_khz,
        "SampleBits": 13,
        "TimerBits": 10,
        "Serial": 1,
        "SlipOnly": 1,
        "Registers": 0,
        "Statistics": 0,
        "BaudHz": 1_000_000,
        "Resets": reset_word(resets),
    }


def _fingertip(clk_khz, part):
    """A matrix of 3 x 3 behind one converter."""
    resets = SLIP | {"scan.enable": 1, "scan.settle": clk_khz // 100, "scan.period": clk_khz // 2}
    return part | {
        "ClkKhz": clk_khz,
        "Array": 1,
        "Rows": 3,
        "Columns": 3,
        "SlipDepth": 16,
        "BaudHz": 1_000_000,
        "Resets": reset_word(resets),
    }


def _cop4(clk_khz, part):
    resets = {"adc.enable": 1, "adc.period": clk_khz // 2}
    return part | {
        "ClkKhz": clk_khz,
        "Cop4": 1,
        "CopSlip": 1,
        "Slip": 0,
        "Channels": 4,
        "SlipDepth": 16,
        "BaudHz": 1_000_000,
        "Resets": reset_word(resets),
    }


def _array64(clk_khz):
    resets = SLIP | {"scan.enable": 1, "scan.settle": clk_khz // 100, "scan.period": clk_khz}
    return {
        "Adc": 2,
        "SclkKhz": 14_500,
        "Converters": 8,
        "ClkKhz": clk_khz,
        "Array": 1,
        "Rows": 64,
        "Columns": 64,
        "Image": 1,
        "BaudHz": 3_000_000,
        "Resets": reset_word(resets),
    }


BOARDS = {
    board.name: board
    for board in (
        Board(
            name="icebreaker",
            title="iCEBreaker (iCE40 UP5K)",
            cells="ice40",
            synth="synth_ice40 -dsp -device u",
            pnr="nextpnr-ice40 --up5k --package sg48 --pcf {constraints} --asc {stem}.asc",
            constraints="constraints/icebreaker.pcf",
            pack="yowasp-icepack {stem}.asc {stem}.bin",
            bitstream=".bin",
            area=ICE40_AREA,
            # The converter at 5 V, so that its SCLK may have 2 MHz.
            configs={"slip1": _slip1(12_000, MCP3208 | {"SclkKhz": 2000, "AdcPeriod": 1200}), "fingertip": _fingertip(24_000, MCP3208), "cop4": _cop4(24_000, MCP3208)},
        ),
        Board(
            name="ulx3s",
            title="ULX3S (ECP5 25F)",
            cells="ecp5",
            synth="synth_ecp5",
            pnr="nextpnr-ecp5 --25k --package CABGA381 --speed 6 --lpf {constraints} --textcfg {stem}.config",
            constraints="constraints/ulx3s.lpf",
            pack="yowasp-ecppack --compress --input {stem}.config --bit {stem}.bit",
            bitstream=".bit",
            area=ECP5_AREA,
            # A bit a clock, it has no use for 100 MHz.
            configs={"slip1": _slip1(50_000, MAX11125), "fingertip": _fingertip(100_000, MAX11125), "cop4": _cop4(100_000, MAX11125), "array64": _array64(100_000)},
        ),
        Board(
            name="orangecrab",
            title="OrangeCrab r0.2 (ECP5 25F)",
            cells="ecp5",
            synth="synth_ecp5",
            pnr="nextpnr-ecp5 --25k --package CSFBGA285 --speed 8 --lpf {constraints} "
            "--textcfg {stem}.config",
            constraints="constraints/orangecrab.lpf",
            pack="yowasp-ecppack --compress --freq 38.8 --input {stem}.config --bit {stem}.bit",
            bitstream=".bit",
            area=ECP5_AREA,
            configs={"slip1": _slip1(48_000, MCP3208)},
        ),
        Board(
            name="tangnano20k",
            title="Tang Nano 20K (GW2AR-18C)",
            cells="gowin",
            synth="synth_gowin -family gw2a",
            pnr="nextpnr-himbaechel-gowin --device GW2AR-LV18QN88C8/I7 --vopt family=GW2A-18C "
            "--vopt cst={constraints} --write {stem}.pnr.json",
            constraints="constraints/tangnano20k.cst",
            pack="gowin_pack -d GW2A-18C -o {stem}.fs {stem}.pnr.json",
            bitstream=".fs",
            area=GOWIN_AREA,
            configs={"slip1": _slip1(27_000, MCP3208)},
        ),
    )
}


def pairs(board=None, config=None):
    """(Board, configuration) of these names, all if none is given; ValueError if one is unknown."""
    if board is not None and board not in BOARDS:
        raise ValueError(f"unknown board '{board}'; the boards are: {', '.join(BOARDS)}")
    chosen = BOARDS.values() if board is None else [BOARDS[board]]
    if board is not None and config not in (None, *BOARDS[board].configs):
        offered = ", ".join(BOARDS[board].configs)
        raise ValueError(f"the {board} has no configuration '{config}'; it has: {offered}")
    return [(b, c) for b in chosen for c in b.configs if config in (None, c)]
