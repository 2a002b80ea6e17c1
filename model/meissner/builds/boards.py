"""The boards with bitstreams, and the named configurations that each board is offered with."""

import os
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from meissner.builds import board_files, config, pins
from meissner.builds.build import Config, verilog
from meissner.builds.toolchain import ROOT
from meissner.twins.shared import index_width

# Patterns of the cells that count as each resource: nextpnr's names, for flip-flops Yosys's.
ECP5_AREA = {"lut": "TRELLIS_COMB", "ff": "TRELLIS_FF", "bram": "DP16KD", "dsp": "MULT18X18D"}
ICE40_AREA = {"lut": "ICESTORM_LC", "ff": "SB_DFF.*", "bram": "ICESTORM_RAM", "dsp": "ICESTORM_DSP"}
GOWIN_AREA = {"lut": "LUT4|ALU|RAMW", "ff": "DFF.*", "bram": "BSRAM", "dsp": "MULT.*"}


# Sources common to all boards.
COMMON = ("rtl/boards/msn_board_reset.sv", "rtl/boards/msn_board.sv")


@dataclass(frozen=True)
class Board:
    """One board.

    Attributes
    ----------
    cells : str
        Family of the netlist's cells: ice40, ecp5 or gowin.
    synth, pnr, pack : str
        Commands in which bitstream.py fills in the files.
    constraints, bitstream : str
        Suffixes of the file of pins and of the bitstream.
    configs : dict
        The named configurations that it is offered with, each with the settings that the board, not the
        file, determines (see meissner.builds.config.load); ``device``: the smallest with room and speed.
    left_out : dict
        Every other named configuration, with the reason as part of a sentence.
    devices : dict
        {name: option of place and route} as sold, smallest first; empty if there is only one.
    rams : dict
        {device: its block RAMs}; the name of an only device is "".
    """

    name: str
    title: str
    cells: str
    synth: str
    pnr: str
    constraints: str
    pack: str
    bitstream: str
    area: dict[str, str]
    configs: dict[str, dict[str, Any]]
    left_out: dict[str, str] = field(default_factory=dict)
    devices: dict[str, str] = field(default_factory=dict)
    rams: dict[str, int] = field(default_factory=dict)

    @property
    def top(self) -> str:
        return f"{self.name}_top"

    def device(self, name: str) -> str | None:
        """Name of the smallest device for that configuration; None: there is only one, or it is unknown."""
        return self.changes(name).get("device")

    def plan(self, name: str, device: str | None = None) -> pins.Plan:
        """The pins of that configuration; ``device``: None for the smallest with room, or the largest.

        Raises
        ------
        ValueError
            If the board lacks the pins, the clock, or the block RAM for a forest.
        """
        return self.fits(self.config(name), label(name), device or self.device(name))

    def fits(self, build: Config, named: str, device: str | None = None) -> pins.Plan:
        """The pins of a build, as ``plan``; ``named``: what it is called in sentences and files."""
        if (forest := build.features.get("forest")) is not None and self.rams:
            device = device or list(self.rams)[-1]
            forest.check_room(f"{self.name} {device}".strip(), self.cells, self.rams[device])
        return pins.assign(pins.description(self.name), named, build.parameters, build.slip_pins)

    def parameters(self, name: str) -> dict[str, int]:
        """Parameters of rtl/msn_core.sv for this board with that configuration."""
        return self.config(name).parameters

    def changes(self, name: str) -> dict[str, Any]:
        """Settings of that configuration that the board determines, not the file; none for a user's file."""
        return self.configs.get(name, {})

    def own(self, name: str) -> dict[str, Any]:
        """Those of ``changes`` that meissner.builds.config.load takes."""
        return {key: v for key, v in self.changes(name).items() if key in ("mhz", "part", "registers")}

    def config(self, name: str) -> Config:
        """meissner.builds.build.Config of that name, with this board's settings."""
        return config.load(name, **self.own(name))

    @property
    def sources(self) -> list[str]:
        """Sources besides rtl/rtl.f and the top from write_board, relative to ROOT."""
        return [*COMMON, f"rtl/boards/{self.name}_clock.sv"]


def label(name: str) -> str:
    """Name of a configuration in files and folders: its own, or its file's."""
    if name in config.names():
        return name
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", Path(name).stem)
    return f"{stem}.toml" if stem in config.names() else stem  # a user's slip1.toml is not the named one


def sizes(parameters: dict[str, int], slip_pins: int = 0) -> dict[str, int]:
    """What rtl/boards needs to know, by the names of its macros; ``slip_pins``: channels with a pin each."""
    converters = parameters.get("Converters", 1)
    found = {
        "CLK_KHZ": parameters["ClkKhz"],
        "ADC": parameters["Adc"],
        "ROWS": parameters.get("Rows", 1),
        "ROW_PINS": pins.row_pins(parameters),
        "CONVERTERS": converters,
        "DATA_LINES": converters * parameters.get("AdcLanes", 1),
        "GROUP_BITS": index_width(pins.groups(parameters)),
    }
    found |= {"SDRAM": 1} if parameters.get("ForestSdram") else {}
    found |= {"PIN_CHAINS": parameters["PinChains"]} if parameters.get("Display") else {}
    return found | ({"SLIP_PINS": slip_pins} if slip_pins else {})


def _write(path: Path, text: str) -> None:
    """Write a file atomically, because concurrent builds may write the same file."""
    if path.exists() and path.read_text("utf-8") == text:
        return
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=path.parent, delete=False) as fresh:
        fresh.write(text)
    os.chmod(fresh.name, 0o644)
    os.replace(fresh.name, path)


def write_build(folder: str, parameters: dict[str, int], slip_pins: int = 0) -> None:
    """Write the configuration as the macros that rtl/boards reads; makes ``folder``, relative to ROOT."""
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    listed = ", ".join(f".{name}({value})" for name, value in verilog(parameters).items())
    macros: dict[str, object] = {**sizes(parameters, slip_pins), "PARAMETERS": listed}
    text = "".join(f"`define MSN_{name} {value}\n" for name, value in macros.items())
    _write(ROOT / folder / "msn_build.svh", "// Written by meissner.builds.boards.\n" + text)


def write_board(folder: str, board: Board, name: str) -> pins.Plan:
    """Write a board's files: macros, top, constraints and the pin map; returns the Plan."""
    plan = board.plan(name)
    write_build(folder, board.parameters(name), board.config(name).slip_pins)
    for file, text in (
        (f"{board.top}.sv", board_files.top(plan)),
        (f"{board.top}{board.constraints}", board_files.constraints(plan, board.constraints)),
        ("pins.txt", plan.text()),
        ("pins.json", plan.json()),
    ):
        _write(ROOT / folder / file, text)
    return plan


# Four-input LUTs only: the number of wider ones depends on the order of the gates for ABC (docs/boards.md).
ECP5 = "synth_ecp5 -nowidelut"

# With nextpnr's default weight of 10 the placer leaves single cells of long paths far apart (docs/boards.md).
ECP5_PLACE = "nextpnr-ecp5 --placer-heap-timingweight 30"

# The better of the two converters that a ULX3S can have; the other gives zeros in the low bits.
ON_BOARD = "MAX11125"


def _too_few(there: int) -> dict[str, str]:
    """Why eight AD7606 do not fit a board with ``there`` header pins; builds.pins counts the pins needed."""
    reason = f"it needs 36 header pins but the board has only {there}"
    return {"array64": reason, "full": reason}


COP4_ICE = "even without registers it needs 10 multipliers, and a UP5K has 8"
UNMEASURED = "not measured; the board has the pins for it"
GRIP_ICE = "the reflex reports faults in registers, which its builds do not have"

BOARDS = {
    board.name: board
    for board in (
        Board(
            name="icebreaker",
            title="iCEBreaker (iCE40 UP5K)",
            cells="ice40",
            # The fingertip fills 93 % of the cells. A tile of eight must share its clock enable, so if few
            # flip-flops share one, nextpnr does not place or route it with every seed.
            synth="synth_ice40 -dsp -device u -dffe_min_ce_use 5",
            pnr="nextpnr-ice40 --up5k --package sg48 --pcf {stem}.pcf --asc {stem}.asc",
            constraints=".pcf",
            pack="yowasp-icepack {stem}.asc {stem}.bin",
            bitstream=".bin",
            area=ICE40_AREA,
            rams={"": 30},
            # With registers the fingertip needs 7,456 logic cells; a UP5K has 5,280.
            configs={
                "slip1": {},
                "fingertip": {"mhz": 24.0, "registers": False},
                "display": {"mhz": 24.0, "registers": False},
            },
            left_out={"cop4": COP4_ICE, "grip": GRIP_ICE} | _too_few(24),
        ),
        Board(
            name="ulx3s",
            title="ULX3S (ECP5 12F to 85F)",
            cells="ecp5",
            synth=ECP5,
            pnr=ECP5_PLACE
            + " {device} --package CABGA381 --speed 6 --lpf {stem}.lpf --textcfg {stem}.config",
            constraints=".lpf",
            pack="yowasp-ecppack --compress --input {stem}.config --bit {stem}.bit",
            bitstream=".bit",
            area=ECP5_AREA,
            # These tools treat a 12F as a 25F with another name: what fits one fits the other.
            devices={"12F": "--12k", "25F": "--25k", "45F": "--45k", "85F": "--85k"},
            rams={"12F": 56, "25F": 56, "45F": 108, "85F": 208},
            # At two bits per clock, slip1 needs no faster clock.
            configs={
                "slip1": {"mhz": 50.0, "part": ON_BOARD, "device": "25F"},
                "fingertip": {"mhz": 50.0, "part": ON_BOARD, "device": "25F"},
                "cop4": {"mhz": 50.0, "device": "25F"},
                "grip": {"mhz": 50.0, "device": "25F"},
                "array64": {"mhz": 100.0, "device": "25F"},
                "full": {"mhz": 100.0, "device": "45F"},
                "display": {"mhz": 50.0, "device": "25F"},
            },
        ),
        Board(
            name="orangecrab",
            title="OrangeCrab r0.2 (ECP5 25F)",
            cells="ecp5",
            synth=ECP5,
            pnr=ECP5_PLACE + " --25k --package CSFBGA285 --speed 8 --lpf {stem}.lpf --textcfg {stem}.config",
            constraints=".lpf",
            pack="yowasp-ecppack --compress --freq 38.8 --input {stem}.config --bit {stem}.bit",
            bitstream=".bit",
            area=ECP5_AREA,
            rams={"": 56},
            configs={name: {"mhz": 48.0} for name in ("slip1", "fingertip", "cop4", "grip", "display")},
            left_out=_too_few(18),
        ),
        Board(
            name="tangnano20k",
            title="Tang Nano 20K (GW2AR-18C)",
            cells="gowin",
            synth="synth_gowin -family gw2a",
            pnr="nextpnr-himbaechel-gowin --device GW2AR-LV18QN88C8/I7 --vopt family=GW2A-18C "
            "--vopt cst={stem}.cst --write {stem}.pnr.json",
            constraints=".cst",
            pack="gowin_pack -d GW2A-18C -o {stem}.fs {stem}.pnr.json",
            bitstream=".fs",
            area=GOWIN_AREA,
            rams={"": 46},
            configs={name: {"mhz": 27.0} for name in ("slip1", "fingertip", "grip")},
            left_out={"cop4": UNMEASURED, "display": UNMEASURED} | _too_few(16),
        ),
    )
}


# Built with Vivado by tools/make/arty_a7.tcl, not here.
ARTY = Board(
    name="arty_a7",
    title="Arty A7-35T",
    cells="",
    synth="",
    pnr="",
    constraints=".xdc",
    pack="",
    bitstream=".bit",
    area={},
    configs={"slip1": {"mhz": 50.0}, "fingertip": {"mhz": 50.0}},
)


def pairs(board: str | None = None, name: str | None = None) -> list[tuple[Board, str]]:
    """(Board, configuration) of these names, all if none is given; ValueError if one is unknown.

    ``name`` may be a TOML file; Board.plan checks whether the board has its pins and its clock.
    """
    if board is not None and board not in BOARDS:
        raise ValueError(f"unknown board '{board}'; the boards are: {', '.join(BOARDS)}")
    chosen = BOARDS.values() if board is None else [BOARDS[board]]
    if board is not None and name is not None:
        offered, left_out = BOARDS[board].configs, BOARDS[board].left_out
        if name in left_out:
            raise ValueError(f"the {board} is not offered with {name}: {left_out[name]}")
        if name not in offered and not Path(name).is_file():
            raise ValueError(
                f"the {board} has no configuration '{name}'; it has: {', '.join(offered)}, or any TOML file"
            )
        return [(BOARDS[board], name)]
    return [(b, c) for b in chosen for c in b.configs if name in (None, c)]
