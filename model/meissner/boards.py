"""The boards a bitstream can be made for, and the configurations each is offered with."""

from dataclasses import dataclass

# What counts as what: patterns of nextpnr's names, of Yosys's for flip-flops.
ECP5_AREA = {"lut": "TRELLIS_COMB", "ff": "TRELLIS_FF", "bram": "DP16KD", "dsp": "MULT18X18D"}
ICE40_AREA = {"lut": "ICESTORM_LC", "ff": "SB_DFF.*", "bram": "ICESTORM_RAM", "dsp": "ICESTORM_DSP"}
GOWIN_AREA = {"lut": "LUT4|ALU|RAMW", "ff": "DFF.*", "bram": "BSRAM", "dsp": "MULT.*"}


@dataclass(frozen=True)
class Board:
    """One board: ``pnr`` and ``pack`` are commands of which synth.py fills in the files.

    ``clk_khz``: the clock of the core unless a configuration has its own; ``configs``: name to the parameters
    of rtl/boards/msn_board.sv that are this board's; ``cells``: family whose cells the netlist has.
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


# One rubber sensor at 10 kHz, thresholds in codes; times in details of two samples.
SLIP1 = {"SampleBits": 13, "BaudHz": 1_000_000}
MCP3208 = {"Adc": 1, "SclkKhz": 1000}
MAX11125 = {"Adc": 5, "SclkKhz": 16000}


def _slip1(clk_khz, part):
    return SLIP1 | part | {"ClkKhz": clk_khz, "PeriodClocks": clk_khz // 10}


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
            configs={"slip1": _slip1(12_000, MCP3208 | {"SclkKhz": 2000, "Single": 1})},
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
            configs={"slip1": _slip1(50_000, MAX11125)},
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
