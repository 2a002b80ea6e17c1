"""From a board and a configuration to a bitstream: Yosys, nextpnr, the packer, and what they say of it.

Each build works in a folder of its own, which takes the place of the one before when it is whole: two builds
at once, or one that is stopped, leave no mixture. A build that fails leaves its logs in <folder>.failed.
"""

import fcntl
import json
import math
import re
import shutil
import tempfile
from collections import Counter
from contextlib import contextmanager

from meissner.builds import boards
from meissner.builds.yowasp import ROOT, ToolError, read_rtl, synthesis, tool, yosys

OUT = "build/synth"  # relative to ROOT: YoWASP sees nothing outside the directory it starts in
LIMIT_S = 1800  # of a processor, for one place and route: the longest that ends takes a few hundred
AREA = ("lut", "ff", "bram", "dsp")
PIN = re.compile(r"adc_(cs_n|sclk|mosi|miso)_")


class TooLarge(ToolError):
    """The device has not room enough."""


@contextmanager
def private(name):
    """A folder for one build, from ROOT; at the end it takes the place of ``OUT``/``name``."""
    out = ROOT / OUT
    out.mkdir(parents=True, exist_ok=True)
    work = tempfile.mkdtemp(prefix=f"{name}.", suffix=".part", dir=out)
    final, mine = out / name, out / work
    mine.chmod(0o755)
    try:
        yield f"{OUT}/{mine.name}"
    except ToolError as error:
        failed = out / f"{name}.failed"
        _replace(mine, failed)
        words = [str(word).replace(mine.name, failed.name) for word in error.args]
        error.args, error.tail = tuple(words), error.tail.replace(mine.name, failed.name)
        raise
    except BaseException:
        shutil.rmtree(mine, ignore_errors=True)
        raise
    _replace(mine, final)
    shutil.rmtree(out / f"{name}.failed", ignore_errors=True)


def _replace(fresh, final):
    """``fresh`` in place of the folder ``final``, one build after the other."""
    with (final.parent / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        old = fresh.with_suffix(".old")
        if final.exists():
            final.rename(old)
        fresh.rename(final)
    shutil.rmtree(old, ignore_errors=True)


def synthesise(board, config, folder):
    """The netlist for place and route, in ``folder``; returns the stem of its files and the cells counted."""
    boards.write_board(folder, board, config)
    stem = f"{folder}/{board.top}"
    script = f"{read_rtl(board.cells)}; read_verilog -sv -I{folder} {' '.join(board.sources)} {stem}.sv; "
    script += f"{synthesis(board.synth, board.top)}; write_json {stem}.json"
    yosys(script, f"{stem}.yosys.log")
    modules = json.loads((ROOT / f"{stem}.json").read_text())["modules"]
    return stem, Counter(cell["type"] for cell in modules[board.top]["cells"].values())


def blocks(stem):
    """The modules that are in the netlist, by what Yosys says of the hierarchy before it flattens it."""
    log = (ROOT / f"{stem}.yosys.log").read_text("utf-8")
    seen = [
        re.findall(r"Used module:\s+\S*?\\(msn_\w+)", part)
        for part in log.split("Analyzing design hierarchy..")
    ]
    return " ".join(sorted(set([names for names in seen if names][-1])))


def area(board, cells, report):
    """LUT (of an iCE40: logic cells), FF, BRAM and DSP; FFs of the netlist, as some reports have none."""
    counts = {cell: row["used"] for cell, row in report["utilization"].items()}

    def count(short):
        return sum(
            n
            for cell, n in (cells if short == "ff" else counts).items()
            if re.fullmatch(board.area[short], cell)
        )

    return {short: count(short) for short in AREA}


def too_large(log):
    """What of the device is asked for more often than it is there, in words; empty if nothing is."""
    text = (ROOT / log).read_text() if (ROOT / log).exists() else ""  # none if the tool is not installed
    rows = re.findall(r"Info:\s+(\w+):\s*(\d+)/\s*(\d+)\s", text)
    return ", ".join(f"{used} of {there} {cell}" for cell, used, there in rows if int(used) > int(there))


def spi_delays(report):
    """ns from the clock to the converter's pins and from its pins to a register; None if not modelled."""
    out, back = [], []
    for net in report["detailed_net_timings"]:
        for end in net["endpoints"]:
            if end["event"] == "<async>" and PIN.match(end["cell"]):
                out.append(max(end["delay"]))
            elif net["event"] == "<async>" and PIN.match(net["driver"]):
                back.append(max(end["delay"]))
    return tuple(round(max(way), 1) if way else None for way in (out, back))


def label(board, device):
    return f"{board} {device}" if device else board


def place(board, config, device, stem, clk_mhz, seed, limit_s=LIMIT_S):
    """Place and route with one seed; returns nextpnr's report. ToolError if it takes more than its limit."""
    words = board.pnr.format(stem=stem, device=board.devices.get(device))
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


def build(board, config, device, folder, seeds, patient, limit_s=LIMIT_S):
    """Make it in ``folder`` with ``seeds``; returns what resources.json says of a pair.

    ``device``: its name, or None: the smallest of the board's that it fits. ``patient``: place with every
    seed, each must end; otherwise only until one meets the clock, and one that fails is passed over.
    """
    clk_mhz = board.parameters(config)["ClkKhz"] / 1000
    stem, cells = synthesise(board, config, folder)
    mhz, delays, packed, failed = [], [], False, None
    sizes = [device] if device or not board.devices else [name for name in board.devices if name != "12F"]
    for seed in seeds:
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
        mhz.append(math.floor(10 * min(clocks)) / 10)  # 99.95 is not 100
        delays.append(spi_delays(report))
        if mhz[-1] >= clk_mhz and not packed:
            program, *options = board.pack.format(stem=stem).split()
            tool(program, options, f"{stem}.pack.log")
            packed = True
            if not patient:
                break
    if not mhz:
        raise failed
    if not packed:
        raise ToolError(
            f"{boards.label(config)} on the {label(board.name, sizes[0])} does not meet its {clk_mhz:g} MHz: "
            f"{max(mhz)} MHz at best of {len(mhz)} seeds"
        )
    return {
        **({"device": sizes[0]} if sizes[0] else {}),
        "clk_mhz": clk_mhz,
        **area(board, cells, report),
        "blocks": blocks(stem),
        "mhz": mhz,
        "mhz_worst": min(mhz),
        "spi_out_ns": max(out for out, _ in delays) if delays[0][0] else None,
        "spi_in_ns": max(back for _, back in delays) if delays[0][1] else None,
    }


def _fitting(board, config, sizes, stem, clk_mhz, seed, limit_s):
    """nextpnr's report for the first of the devices that has the room; smaller ones leave the list."""
    while True:
        try:
            return place(board, config, sizes[0], stem, clk_mhz, seed, limit_s)
        except TooLarge:
            if len(sizes) == 1:
                raise
            del sizes[0]
