"""Bitstream, resources and Fmax of a board with a configuration, from PyPI tools alone.

    python tools/synth.py ulx3s                    its first configuration
    python tools/synth.py icebreaker slip1         into build/synth/icebreaker-slip1/
    python tools/synth.py ulx3s slip1 --device 85F  for a board with another device
    python tools/synth.py --list                   every pair there is
    python tools/synth.py --record [BOARD CONFIG]  all or one, three seeds, into constraints/resources.json
    python tools/synth.py --check [BOARD CONFIG]   the same, held against that file
    python tools/synth.py --macros arty_a7 CONFIG   only the configuration's macros, for Vivado

A bitstream comes from the first seed that meets the clock; resources.json has the worst of three. It is an
error if no seed meets the clock, if a design does not fit, and in a check if anything grew by more than 3 %.
"""

import argparse
import json
import re
import sys
import time
from collections import Counter

from meissner import boards
from meissner import config as configurations
from meissner.frontend.adc_spi import AdcSpi
from meissner.yowasp import ROOT, ToolError, read_rtl, tool, warm_up, yosys

OUT = "build/synth"  # relative to ROOT: YoWASP sees nothing outside the directory it starts in
RESOURCES = ROOT / "constraints/resources.json"
SEEDS = (1, 2, 3)
GROWTH = 0.03
PAGES = ("README.md", "docs/boards.md", "docs/boards.md")
AREA = ("lut", "ff", "bram", "dsp")
PIN = re.compile(r"(adc|ext)_(cs_n|sclk|mosi|miso)_")


def synthesise(board, config, parameters):
    """Yosys up to the netlist for place and route; returns the stem of its files and the cells counted."""
    folder = f"{OUT}/{board.name}-{config}"
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    boards.write_build(folder, parameters)
    stem = f"{folder}/{board.top}"
    tops = " ".join(board.sources)
    script = f"{read_rtl(board.cells)}; read_verilog -sv -I{folder} {tops}; "
    script += f"{board.synth} -top {board.top} -json {stem}.json"
    yosys(script, f"{stem}.yosys.log")
    modules = json.loads((ROOT / f"{stem}.json").read_text())["modules"]
    return stem, Counter(cell["type"] for cell in modules[board.top]["cells"].values())


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


def place(board, config, device, stem, parameters, seed):
    """Place and route with one seed; returns nextpnr's report."""
    words = board.pnr.format(constraints=board.constraints, stem=stem, device=board.devices.get(device))
    program, *options = words.split()
    report, log = f"{stem}.{seed}.report.json", f"{stem}.{seed}.pnr.log"
    options += ["--json", f"{stem}.json", "--seed", str(seed), "--report", report, "--timing-allow-fail"]
    options += ["--freq", str(parameters["ClkKhz"] / 1000), "--detailed-timing-report"]
    try:
        tool(f"yowasp-{program}", options, log)
    except ToolError as error:
        missing = too_large(log)
        if not missing:
            raise
        raise ToolError(
            f"{config} does not fit the {label(board.name, device)}: it needs {missing}"
        ) from error
    return json.loads((ROOT / report).read_text())


def build(board, config, device, parameters, seeds, patient):
    """Make it with ``seeds``; returns what resources.json says of a pair.

    ``patient``: place with every seed; otherwise only until one meets the clock.
    """
    stem, cells = synthesise(board, config, parameters)
    clk_mhz = parameters["ClkKhz"] / 1000
    mhz, delays, packed = [], [], False
    for seed in seeds:
        report = place(board, config, device, stem, parameters, seed)
        clocks = [clock["achieved"] for clock in report["fmax"].values()]
        mhz.append(round(min(clocks), 1))
        delays.append(spi_delays(report))
        if mhz[-1] >= clk_mhz and not packed:
            program, *options = board.pack.format(stem=stem).split()
            tool(program, options, f"{stem}.pack.log")
            packed = True
            if not patient:
                break
    if not packed:
        raise ToolError(
            f"{config} on the {label(board.name, device)} does not meet its {clk_mhz:g} MHz: "
            f"{max(mhz)} MHz at best with seeds {', '.join(map(str, seeds[: len(mhz)]))}"
        )
    return {
        **({"device": device} if device else {}),
        "clk_mhz": clk_mhz,
        **area(board, cells, report),
        "mhz": mhz,
        "mhz_worst": min(mhz),
        "spi_out_ns": max(out for out, _ in delays) if delays[0][0] else None,
        "spi_in_ns": max(back for _, back in delays) if delays[0][1] else None,
    }


def compare(name, before, now):
    """Sentences: what of ``now`` is worse than resources.json says, by more than GROWTH."""
    if before is None:
        return [f"{name} is not in {RESOURCES.relative_to(ROOT)}; `make resources` writes it"]
    said = [
        f"{name}: {now[key]} {key.upper()}, {before[key]} before"
        for key in AREA
        if now[key] > (1 + GROWTH) * before[key]
    ]
    for least, what in (
        (now["clk_mhz"], "is its clock"),
        ((1 - GROWTH) * before["mhz_worst"], "or more before"),
    ):
        if now["mhz_worst"] < least:
            said.append(f"{name}: {now['mhz_worst']} MHz with its worst seed, {least:.1f} {what}")
    return said


def missing(recorded):
    """Sentences: the pairs that ``recorded`` does not have, and those it should not have.

    Every board with every named configuration is there: with its figures, or with why it has none.
    """
    where = RESOURCES.relative_to(ROOT)
    said = []
    for board in boards.BOARDS.values():
        for config in dict.fromkeys([*board.configs, *configurations.names()]):
            name = f"{board.name}-{config}"
            entry = recorded.get(name, {})
            offered = config in board.configs
            if offered and not {"mhz", "left_out"} & set(entry):
                said.append(f"{name} is not in {where}")
            elif offered and "mhz" in entry and entry.get("device") != board.device(config):
                said.append(f"{name} is in {where} on another device than the {board.device(config)}")
            elif not offered and entry != left_out(board, config):
                said.append(f"{where} does not say why {name} is left out")
    there = {f"{board.name}-{name}" for board in boards.BOARDS.values() for name in configurations.names()}
    return said + [
        f"{name} is in {where} but is no pair of a board and a configuration"
        for name in sorted(set(recorded) - there)
    ]


def left_out(board, config):
    """What resources.json says of a pair that is not offered."""
    return {"left_out": board.left_out.get(config)}


def half_bit(board, config):
    """ns from the edge that launches a bit to where it is taken, and the converter's own ns of these."""
    found = board.config(config)
    part, clk_khz = found.part, found.clk_khz
    clocks = 2 * AdcSpi(part, 1, 1, clk_khz, found.adc["sclk_khz"]).half
    if board.parameters(config).get("AdcPeriod"):  # msn_adc_single
        clocks = 1 << (clocks - 1).bit_length()
    return 1e6 * (clocks - 1) / clk_khz, part.access_ns


def tables(recorded):
    """README's table of resources, the page's of pins and of pairs without figures, from resources.json."""
    area = [
        "| board, configuration | clock, MHz | Fmax, worst of three | LUT | FF | block RAM | DSP |",
        "|---" * 7 + "|",
    ]
    pins = [
        "| board, configuration | a bit's data are taken after, ns | out | converter | in | left |",
        "|---" * 6 + "|",
    ]
    none = ["| board, configuration | why there is none |", "|---" * 2 + "|"]
    for board in boards.BOARDS.values():
        for config in configurations.names():
            if reason := recorded[f"{board.name}-{config}"].get("left_out"):
                none.append(f"| {board.title.partition(' (')[0]}, {config} | {reason} |")
    for board, config in boards.pairs():
        r = recorded[f"{board.name}-{config}"]
        if "left_out" in r:
            continue
        name = f"{label(board.title.partition(' (')[0], r.get('device'))}, {config}"
        used = " | ".join(str(r[key]) for key in AREA)
        area.append(f"| {name} | {r['clk_mhz']:g} | {r['mhz_worst']} | {used} |")
        taken, access = half_bit(board, config)
        if r["spi_out_ns"] is not None:
            left = taken - access - r["spi_out_ns"] - r["spi_in_ns"]
            pins.append(
                f"| {name} | {taken:.0f} | {r['spi_out_ns']} | {access} | {r['spi_in_ns']} | {left:.0f} |"
            )
    return "\n".join(area), "\n".join(pins), "\n".join(none)


def write_tables(recorded):
    """Both tables into their pages, in place of the ones there."""
    for page, table in zip(PAGES, tables(recorded)):
        head = table.partition("\n")[0]
        text = (ROOT / page).read_text()
        before, _, after = text.partition(head)
        rest = after.split("\n\n", 1)[1]
        (ROOT / page).write_text(f"{before}{table}\n\n{rest}")


def write(found):
    """``found`` into constraints/resources.json as it is by now, and why boards do not have the others."""
    kept = (json.loads(RESOURCES.read_text()) if RESOURCES.exists() else {}) | found
    for board in boards.BOARDS.values():
        kept |= {f"{board.name}-{name}": left_out(board, name) for name in board.left_out}
    RESOURCES.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n")
    return kept


def tell(name, result):
    name = label(name, result.get("device"))
    used = ", ".join(f"{result[key]} {key.upper()}" for key in AREA)
    return f"{name}: {used}; {result['mhz_worst']} MHz (its clock is {result['clk_mhz']:g})"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("board", nargs="?")
    parser.add_argument("config", nargs="?")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--macros", action="store_true")
    parser.add_argument(
        "--device", help="of those that the board is sold with; else the smallest that will do"
    )
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    options = parser.parse_args()
    if options.list:
        for board in boards.BOARDS.values():
            offered = [f"{name} on {board.device(name)}" if board.devices else name for name in board.configs]
            print(f"{board.name:12} {board.title:28} {', '.join(offered)}")
            for name, reason in board.left_out.items():
                print(f"{'':12} {'':28} not {name}: {reason}")
        return
    if options.macros and options.board == boards.ARTY.name and options.config in boards.ARTY.configs:
        folder = f"{OUT}/{options.board}-{options.config}"
        boards.write_build(folder, boards.ARTY.parameters(options.config))
        print(f"{folder}/msn_build.svh")
        return
    try:
        pairs = boards.pairs(options.board, options.config)
    except ValueError as error:
        parser.exit(2, f"synth: {error}\n")
    kept = json.loads(RESOURCES.read_text()) if RESOURCES.exists() else {}
    whole = options.record or options.check
    if not whole:
        if options.board is None:
            parser.exit(2, f"synth: name a board, BOARD=...: {', '.join(boards.BOARDS)}\n")
        pairs = pairs[:1]
    given = options.device
    if given and (whole or given not in pairs[0][0].devices):
        known = ", ".join(pairs[0][0].devices) or "one device only"
        parser.exit(2, f"synth: --device {given} is for a bitstream of a board that has it; here: {known}\n")
    problems = missing(kept) if options.check and options.board is None else []
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    warm_up()
    for board, config in pairs:
        name = f"{board.name}-{config}"
        begin = time.monotonic()
        try:
            device = given or board.device(config)
            if device and not given:
                print(f"{name}: for a {device}, the smallest that it fits and is fast enough on", flush=True)
            result = build(board, config, device, board.parameters(config), options.seeds, whole)
        except ToolError as error:
            if not whole:
                sys.exit(f"synth: {error}\n{error.tail}".rstrip())
            problems.append(str(error))
            if options.record:
                kept = write({name: {"left_out": str(error)}})
            continue
        print(f"{tell(name, result)}, {time.monotonic() - begin:.0f} s", flush=True)
        if options.check:
            problems += compare(name, kept.get(name), result)
        if options.record:
            kept = write({name: result})
        if not whole:
            print(f"bitstream: {OUT}/{name}/{board.top}{board.bitstream}")
    if options.record and not missing(kept):
        write_tables(kept)
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
