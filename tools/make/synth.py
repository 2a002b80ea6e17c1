"""Build the bitstream of a board and a configuration, with its resources and Fmax, from PyPI tools alone.

    python tools/make/synth.py ulx3s                       its first configuration
    python tools/make/synth.py icebreaker slip1            into build/synth/icebreaker-slip1/
    python tools/make/synth.py ulx3s mine.toml             your own configuration (docs/config.md)
    python tools/make/synth.py ulx3s slip1 --device 85F    another device, into ulx3s-slip1-85F/
    python tools/make/synth.py ulx3s mine.toml --pins      only list its pins
    python tools/make/synth.py --list                      list all pairs
    python tools/make/synth.py --record [BOARD CONFIG]     three seeds or more, to constraints/resources.json
    python tools/make/synth.py --check [BOARD CONFIG]      the same, but compare with that file
    python tools/make/synth.py --macros arty_a7 CONFIG     only Vivado's input: macros, top, constraints

The bitstream is that of the first seed that meets the clock, of six at most; resources.json has the worst of
three, and of more if none of these meets it. It is an error if no seed meets the clock, if a design does not
fit, and in a check if anything grew by more than 3 %.
"""

import argparse
import shlex
import sys
import time
import tomllib
from contextlib import contextmanager
from pathlib import Path

from meissner.builds import boards
from meissner.builds import config as configurations
from meissner.builds.bitstream import AREA, LIMIT_S, OUT, build, label, private
from meissner.builds.pins import description
from meissner.builds.wiring.drawing import svg
from meissner.builds.yowasp import ROOT, ToolError, warm_up
from meissner.tables import toml
from meissner.tradeoff.area import BOARDS as RESOURCES
from meissner.tradeoff.area import recorded
from meissner.twins.frontend.adc_spi import AdcSpi
from version import record

SEEDS = (1, 2, 3, 4, 5, 6)
GROWTH = tomllib.loads((ROOT / "tb/limits.toml").read_text("utf-8"))["boards"]["growth"]


def compare(name, before, now):
    """A sentence for each figure of ``now`` that is worse than in resources.json by more than GROWTH."""
    if before is None:
        return [f"{name} is not in {RESOURCES.relative_to(ROOT)}; `make resources` writes it"]
    said = [
        f"{name}: {now[key]} {key.upper()}, {before[key]} before"
        for key in AREA
        if now[key] > (1 + GROWTH) * before[key]
    ]
    least = (1 - GROWTH) * before["mhz_worst"]
    if now["mhz_worst"] < least:
        said.append(f"{name}: {now['mhz_worst']} MHz with its worst seed, {least:.1f} or more before")
    return said


def missing(kept):
    """A sentence for each pair that ``kept`` lacks or should not have.

    It must have every board with every named configuration: with its figures, or the reason for having none.
    """
    where = RESOURCES.relative_to(ROOT)
    said = []
    for board in boards.BOARDS.values():
        for config in dict.fromkeys([*board.configs, *configurations.names()]):
            name = f"{board.name}-{config}"
            entry = kept.get(name, {})
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
        for name in sorted(set(kept) - there)
    ]


def left_out(board, config):
    """The entry of resources.json for a pair that is not offered."""
    return {"left_out": board.left_out.get(config)}


def half_bit(board, config):
    """(ns from the edge that launches a bit to its sampling edge, the converter's share of these ns)."""
    found = board.config(config)
    part, clk_khz = found.part, found.clk_khz
    clocks = 2 * AdcSpi(part, 1, 1, clk_khz, found.adc.sclk_khz).half
    if board.parameters(config).get("AdcPeriod"):  # msn_adc_single
        clocks = 1 << (clocks - 1).bit_length()
    return 1e6 * (clocks - 1) / clk_khz, part.access_ns


def tables(kept):
    """Tables for docs/results.md: resources, pins' timing, pairs without a bitstream."""
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
            if reason := kept[f"{board.name}-{config}"].get("left_out"):
                none.append(f"| {board.title.partition(' (')[0]}, {config} | {reason} |")
    for board, config in boards.pairs():
        r = kept[f"{board.name}-{config}"]
        if "left_out" in r:
            continue
        name = f"{label(board.title.partition(' (')[0], r.get('device'))}, {config}"
        used = " | ".join(str(r[key]) for key in AREA)
        enough, tried = sum(mhz >= r["clk_mhz"] for mhz in r["mhz"]), len(r["mhz"])
        short = f"; {enough} of {tried} seeds meet the clock" if enough < tried else ""
        area.append(f"| {name} | {r['clk_mhz']:g} | {r['mhz_worst']}{short} | {used} |")
        taken, access = half_bit(board, config)
        if r["spi_out_ns"] is not None:
            left = taken - access - r["spi_out_ns"] - r["spi_in_ns"]
            pins.append(
                f"| {name} | {taken:.0f} | {r['spi_out_ns']} | {access} | {r['spi_in_ns']} | {left:.0f} |"
            )
    return "\n".join(area), "\n".join(pins), "\n".join(none)


def write(found):
    """Merge ``found`` into constraints/resources.json, with the reasons for pairs not offered."""
    reasons = {
        f"{board.name}-{name}": left_out(board, name)
        for board in boards.BOARDS.values()
        for name in board.left_out
    }
    return record(RESOURCES, found | reasons)


def tell(name, result):
    name = label(name, result.get("device"))
    used = ", ".join(f"{result[key]} {key.upper()}" for key in AREA)
    pins = ""
    if "sdram_out_ns" in result:
        ways = result["sdram_out_ns"], result["sdram_in_ns"]
        pins = "; SDRAM: from the clock to a pin {} ns, from a pin to a register {} ns".format(*ways)
    return f"{name}: {used}; {result['mhz_worst']} MHz (its clock is {result['clk_mhz']:g}){pins}"


def options_of(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("board", nargs="?")
    parser.add_argument("config", nargs="?", help="a name, or a TOML file")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--macros", action="store_true")
    parser.add_argument("--pins", action="store_true", help="print the pin map, build nothing")
    parser.add_argument(
        "--device", help="of those that the board is sold with; else the smallest that will do"
    )
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    parser.add_argument(
        "--limit", type=int, default=LIMIT_S, metavar="S", help="of processor time for a seed (%(default)s)"
    )
    return parser.parse_args(arguments)


def refuse(problem):
    print(f"synth: {problem}", file=sys.stderr)
    sys.exit(2)


def print_list():
    for board in boards.BOARDS.values():
        offered = [f"{name} on {board.device(name)}" if board.devices else name for name in board.configs]
        print(f"{board.name:12} {board.title:28} {', '.join(offered)}")
        for name, reason in board.left_out.items():
            print(f"{'':12} {'':28} not {name}: {reason}")


def chosen(options):
    """The pairs to build, each with its Plan; ValueError with one sentence before anything is written."""
    whole = options.record or options.check
    if options.macros and options.board == boards.ARTY.name:
        pairs = [(boards.ARTY, options.config or "slip1")]
    else:
        pairs = boards.pairs(options.board, options.config)
    if not whole:
        if options.board is None:
            raise ValueError(f"name a board, BOARD=...: {', '.join(boards.BOARDS)}")
        pairs = pairs[:1]
    elif options.config and options.config not in configurations.names():
        raise ValueError("only the named configurations are recorded")
    given = options.device
    if given and (whole or given not in pairs[0][0].devices):
        known = ", ".join(pairs[0][0].devices) or "one device only"
        raise ValueError(f"--device {given} is for a bitstream of a board that has it; here: {known}")
    return [(board, config, board.plan(config, options.device)) for board, config in pairs]


@contextmanager
def progress(name):
    """Yield a function of (what begins, its log): a line for each step in a pipe; on a terminal the time and
    the last line of the log, since a step takes minutes."""
    if not sys.stderr.isatty():
        yield lambda what, _: print(f"{name}: {what} ...", flush=True)
        return
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
    from rich.text import Text

    class Last(ProgressColumn):
        def render(self, task):
            return Text(last_line(ROOT / task.fields["log"]), style="dim", no_wrap=True, overflow="ellipsis")

    columns = (SpinnerColumn(), TextColumn(name + ": {task.description}"), TimeElapsedColumn(), Last())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=None, log="")
        yield lambda what, log: bar.update(task, description=what, log=log)


def last_line(log):
    """The last line so far of a tool's log with something in it."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - 400))
            lines = file.read().decode("utf-8", "replace").splitlines()
    except OSError:
        return ""
    return next((line.strip() for line in reversed(lines) if line.strip()), "")


def beside(board, config, folder):
    """Write what a user needs beside a bitstream: the drawing, and the configuration as this board has it."""
    tables = configurations.tables(config, **board.own(config))
    if "file" in tables.get("forest", {}):  # elsewhere than this file
        tables["forest"]["file"] = str(Path(tables["forest"]["file"]).resolve())
    (ROOT / folder / "config.toml").write_text(f"# On the {board.title}.\n{toml(tables)}", "utf-8")
    (ROOT / folder / "wiring.svg").write_bytes(svg(board, config))


def after(board, config, name):
    """What to do with the bitstream of a configuration in build/synth/``name``, line by line."""
    usb, folder = description(board.name).usb, f"{OUT}/{name}"
    own, table = (shlex.quote(f"{folder}/{of}") for of in (board.top + board.bitstream, "config.toml"))
    baud = board.config(config).link.baud
    first = f" ({usb['first']})" if "first" in usb else ""
    steps = {
        "wire it": f"{folder}/wiring.svg, the pins in {folder}/pins.txt",
        "load it": f".venv/bin/meissner flash {board.name} {own}{first}",
        "its port": f"{usb['port']}, {usb['about']}, {baud} baud; .venv/bin/meissner ports asks what answers",
        "once": "sudo cp host/60-meissner.rules /etc/udev/rules.d/ && sudo udevadm control --reload && "
        "sudo udevadm trigger",
        "see it": f".venv/bin/meissner live {usb['port']} --config {table} --web",
    }
    return [f"  {what:<9} {how}" for what, how in steps.items()]


def make(board, config, plan, options):
    """Build one bitstream, and print what to do with it."""
    name = "-".join(filter(None, [board.name, boards.label(config), options.device]))
    begin = time.monotonic()
    known = board.device(config)
    if known and not options.device:
        print(f"{name}: for a {known}, the smallest that it fits and is fast enough on", flush=True)
    with private(name) as folder, progress(name) as step:
        result = build(
            board, config, options.device or known, folder, options.seeds, False, options.limit, step
        )
        beside(board, config, folder)
    print(f"{tell(name, result)}, {time.monotonic() - begin:.0f} s\n\n{plan.text()}")
    print(f"pins: {OUT}/{name}/pins.txt and pins.json\nbitstream: {OUT}/{name}/{board.top}{board.bitstream}")
    print("\nwhat next:", *after(board, config, name), sep="\n")


def measure(pairs, options):
    """Run every pair with every seed, and record or check it; returns a sentence for each error."""
    kept = recorded(RESOURCES, "make resources") if options.check else {}
    problems = missing(kept) if options.check and options.board is None else []
    for board, config, _ in pairs:
        name, begin = f"{board.name}-{config}", time.monotonic()
        try:
            with private(name) as folder:
                result = build(
                    board, config, board.device(config), folder, options.seeds, True, options.limit
                )
        except ToolError as error:
            problems.append(str(error))
            if options.record:
                kept = write({name: {"left_out": str(error)}})
            continue
        print(f"{tell(name, result)}, {time.monotonic() - begin:.0f} s", flush=True)
        if options.check:
            problems += compare(name, kept.get(name), result)
        if options.record:
            kept = write({name: result})
    return problems


def main(arguments=None):
    options = options_of(arguments)
    if options.list:
        print_list()
        return
    try:
        pairs = chosen(options)
    except ValueError as problem:
        refuse(problem)
    if options.pins:
        print(pairs[0][2].text(), end="")
        return
    if options.macros:
        board, config, _ = pairs[0]
        folder = f"{OUT}/{board.name}-{boards.label(config)}"
        boards.write_board(folder, board, config)
        beside(board, config, folder)
        print(f"{folder}/msn_build.svh")
        return
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    warm_up()
    if options.record or options.check:
        problems = measure(pairs, options)
        if problems:
            sys.exit("\n".join(problems))
        return
    try:
        make(*pairs[0], options)
    except ToolError as error:
        sys.exit(f"synth: {error}\n{error.tail}".rstrip())


if __name__ == "__main__":
    main()
