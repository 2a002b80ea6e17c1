"""From a board and a configuration to a bitstream: Yosys, nextpnr, the packer, and their reports.

A build works in <folder>.part, which replaces the previous build's folder when it is complete. One that fails
or is interrupted leaves its logs there.
"""

import json
import math
import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from meissner.builds import boards
from meissner.builds.boards import Board
from meissner.builds.yowasp import ROOT, ToolError, read_rtl, synthesis, tool, yosys

OUT = "build/synth"  # relative to ROOT: YoWASP sees nothing outside the directory it starts in
MEASURED = 3  # seeds whose clocks are recorded
LIMIT_S = 1800  # processor time of one place and route; the longest successful one takes a few hundred
AREA = ("lut", "ff", "bram", "dsp")
Report = dict[str, Any]  # nextpnr's, as JSON
Step = Callable[[str, str], object]  # called with what begins and its log, relative to ROOT
# Pins whose delays are reported. Of the SDRAM's clock, from an output register, nextpnr knows none.
PINS = {"spi": r"adc_(cs_n|sclk|mosi|miso)_", "sdram": r"sdram_(?!clk)"}


class TooLarge(ToolError):
    """The design does not fit the device."""


@contextmanager
def private(name: str) -> Iterator[str]:
    """A folder for one build, relative to ROOT; once the build is complete it replaces ``OUT``/``name``."""
    final, part = ROOT / OUT / name, ROOT / OUT / f"{name}.part"
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    yield f"{OUT}/{part.name}"
    shutil.rmtree(final, ignore_errors=True)
    part.rename(final)


def synthesise(board: Board, config: str, folder: str) -> "tuple[str, Counter[str]]":
    """Make the netlist for place and route in ``folder``.

    Returns
    -------
    stem : str
        The files without their suffixes, relative to ROOT.
    cells : Counter
        Number of cells of each type.

    Raises
    ------
    ToolError
        If Yosys fails; ValueError if the board lacks the pins.
    """
    boards.write_board(folder, board, config)
    stem = f"{folder}/{board.top}"
    script = f"{read_rtl(board.cells)}; read_verilog -sv -I{folder} {' '.join(board.sources)} {stem}.sv; "
    script += f"{synthesis(board.synth, board.top)}; write_json {stem}.json"
    yosys(script, f"{stem}.yosys.log")
    modules = json.loads((ROOT / f"{stem}.json").read_text())["modules"]
    return stem, Counter(cell["type"] for cell in modules[board.top]["cells"].values())


def area(board: Board, cells: Mapping[str, int], report: Report) -> dict[str, int]:
    """LUT (iCE40: logic cells), FF, BRAM and DSP; FFs from the netlist, since some reports lack them."""
    counts = {cell: row["used"] for cell, row in report["utilization"].items()}

    def count(short: str) -> int:
        return sum(
            n
            for cell, n in (cells if short == "ff" else counts).items()
            if re.fullmatch(board.area[short], cell)
        )

    return {short: count(short) for short in AREA}


def too_large(log: str) -> str:
    """The resources that the design needs more of than the device has, in words; empty if there are none."""
    text = (ROOT / log).read_text() if (ROOT / log).exists() else ""  # no log if the tool is not installed
    rows = re.findall(r"Info:\s+(\w+):\s*(\d+)/\s*(\d+)\s", text)
    return ", ".join(f"{used} of {there} {cell}" for cell, used, there in rows if int(used) > int(there))


def pin_delays(report: Report) -> dict[str, float]:
    """The longest ways in ns, of each kind of pin in the design: from the clock to a pin, ``spi_out_ns``, and
    from a pin to a register, ``spi_in_ns``; the same of the SDRAM."""
    found: dict[str, float] = {}
    for net in report["detailed_net_timings"]:
        for end in net["endpoints"]:
            for event, cell, way in (end["event"], end["cell"], "out"), (net["event"], net["driver"], "in"):
                for kind in (kind for kind, names in PINS.items() if re.match(names, cell)):
                    if event == "<async>":
                        key = f"{kind}_{way}_ns"
                        found[key] = max(found.get(key, 0.0), round(max(end["delay"]), 1))
    return found


def label(board: str, device: str | None) -> str:
    return f"{board} {device}" if device else board


def place(
    board: Board,
    config: str,
    device: str | None,
    stem: str,
    clk_mhz: float,
    seed: int,
    limit_s: int = LIMIT_S,
) -> Report:
    """nextpnr's report of place and route with one seed.

    Parameters
    ----------
    clk_mhz : float
        Goal; a slower result is no error.
    limit_s : int
        Of processor time, in seconds.

    Raises
    ------
    TooLarge
        If the design does not fit the device.
    ToolError
        If the tool fails or exceeds its time.
    """
    words = board.pnr.format(stem=stem, device=board.devices.get(device or ""))
    program, *options = words.split()
    report, log = f"{stem}.{seed}.report.json", f"{stem}.{seed}.pnr.log"
    options += ["--json", f"{stem}.json", "--seed", str(seed), "--report", report, "--timing-allow-fail"]
    options += ["--freq", str(clk_mhz), "--detailed-timing-report"]
    try:
        tool(f"yowasp-{program}", options, log, limit_s)
    except ToolError as error:
        missing = too_large(log)
        if not missing:
            raise
        where = label(board.name, device)
        raise TooLarge(f"{boards.label(config)} does not fit the {where}: it needs {missing}") from error
    return json.loads((ROOT / report).read_text())


def build(
    board: Board,
    config: str,
    device: str | None,
    folder: str,
    seeds: Iterable[int],
    patient: bool,
    limit_s: int = LIMIT_S,
    step: Step = lambda what, log: None,
) -> dict[str, Any]:
    """Build in ``folder``; returns the entry of resources.json for this pair.

    Parameters
    ----------
    device : str, optional
        Its name; None: the board's smallest that fits.
    patient : bool
        Place with the first MEASURED seeds, all must succeed, and with more until one meets the clock;
        otherwise stop at the first seed that meets it and skip seeds that fail.

    Raises
    ------
    ToolError
        If no seed meets the clock; TooLarge if the design fits no device.
    """
    clk_mhz = board.parameters(config)["ClkKhz"] / 1000
    step("synthesis by Yosys", f"{folder}/{board.top}.yosys.log")
    stem, cells = synthesise(board, config, folder)
    mhz: list[float] = []
    delays: dict[str, float] = {}
    packed, failed = False, ToolError("there is no seed")
    sizes: list[str | None] = (
        [device] if device or not board.devices else [name for name in board.devices if name != "12F"]
    )
    for seed in seeds:
        if packed and len(mhz) >= (MEASURED if patient else 1):
            break
        step(f"place and route by nextpnr, seed {seed}", f"{stem}.{seed}.pnr.log")
        try:
            report = _fitting(board, config, sizes, stem, clk_mhz, seed, limit_s)
        except TooLarge:
            raise
        except ToolError as error:
            if patient:
                raise
            failed = error
            continue
        clocks = [clock["achieved"] for clock in report["fmax"].values()]
        mhz.append(math.floor(10 * min(clocks)) / 10)  # rounded down: 99.95 is not 100
        delays = {key: max(ns, delays.get(key, 0.0)) for key, ns in pin_delays(report).items()}
        if mhz[-1] >= clk_mhz and not packed:
            program, *options = board.pack.format(stem=stem).split()
            step("packing the bitstream", f"{stem}.pack.log")
            tool(program, options, f"{stem}.pack.log")
            packed = True
    if not mhz:
        raise failed
    if not packed:
        raise ToolError(
            f"{boards.label(config)} on the {label(board.name, sizes[0])} does not meet its {clk_mhz:g} MHz: "
            f"the best of {len(mhz)} seed{'s' * (len(mhz) > 1)} reaches {max(mhz)} MHz"
        )
    return {
        **({"device": sizes[0]} if sizes[0] else {}),
        "clk_mhz": clk_mhz,
        **area(board, cells, report),
        "mhz": mhz,
        "mhz_worst": min(mhz),
        **dict.fromkeys(("spi_out_ns", "spi_in_ns")),
        **delays,
    }


def _fitting(
    board: Board, config: str, sizes: list[str | None], stem: str, clk_mhz: float, seed: int, limit_s: int
) -> Report:
    """nextpnr's report for the first device that the design fits; smaller ones are removed from ``sizes``."""
    while True:
        try:
            return place(board, config, sizes[0], stem, clk_mhz, seed, limit_s)
        except TooLarge:
            if len(sizes) == 1:
                raise
            del sizes[0]
