"""Measure the figures of a version, and write docs/results.md and the pages of results.

    make figures                                 everything, for hours; goes on where it ended
    make figures FIGURES=results                 docs/results.md alone: half an hour
    make figures FIGURES="acrylic_slip optacon"  print these rows, or write these pages
    make figures FIGURES=--list                  list both

docs/results.md is written when every row is measured on this commit (build/figures keeps them), another page
as soon as it is measured. Each page is headed by version, commit and date.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import synth
from meissner import interval, run, scenes
from meissner.builds.toolchain import ROOT
from meissner.tradeoff import area, table
from version import commit, heading

sys.path.insert(0, str(ROOT / "tools"))  # the rooms beside this one
KEPT = ROOT / "build/figures"
BEATS = 1024 * 1024 / 8  # of a frame of 1024×1024 taxels on 8 lanes
RESULTS = "results"  # docs/results.md, which all rows and sections make


def at_most(found):
    return f" (at most {100 * found['high']:.3g} %)"


def errors(s):
    """Misses and false alarms of a slip scene, with the upper end of the interval of each rate."""
    parts = [f"{s['missed']} missed{at_most(s['missed_rate'])}"] if s["missed_rate"] else []
    return ", ".join([*parts, f"{s['false_alarms']} false{at_most(s['false_alarm_rate'])}"])


def acrylic(s):
    (c,) = s["conditions"]
    return (
        f"{errors(s)}; {c['delay_ms_median']:.1f} ms after the first partial slip (median), "
        f"{c['lead_ms_median']:.0f} ms before the whole contact slips"
    )


def pulls(s):
    found = [c for c in s["conditions"] if c["delay_ms_median"] is not None]
    delays = [c["delay_ms_median"] for c in found]
    return (
        f"{errors(s)}; {min(delays):g} to {max(delays):g} ms after the pull begins (medians), "
        f"{min(c['lead_ms_min'] for c in found):.1f} ms or more before the object moves; "
        f"direction within {s['direction_error_deg']['maximum']:.2f}°"
    )


def evenness(s):
    before, after = 100 * s["unevenness_before"], 100 * s["unevenness_after"]
    found = f", the {s['dead']} faulty cells found" if s.get("dead_as_injected") else ""
    return f"{before:.1f} % before, {after:.2f} % after{found or ' calibration'}"


def scene(words, name):
    """A function that gives a scene's summary on engine fixed in ``words``."""

    def measure():
        with tempfile.TemporaryDirectory() as out:
            return words(run.run(scenes.load(name), "fixed", Path(out)))

    return measure


def poured():
    from published import grip

    rows = [next(grip.rows(scenes.load(name), 20, 0)) for name in ("grip_pour", "grip_water")]
    found = interval.rate(sum(row["dropped"] for row in rows), sum(row["runs"] for row in rows))
    ratios = [row["grip_ratio_mean"] for row in rows]
    return (
        f"{found['count']} of {found['runs']} dropped{at_most(found)}; grip {min(ratios):.2f} to "
        f"{max(ratios):.2f} times the least that friction allows; slip at most "
        f"{max(row['slip_mm_max'] for row in rows):.3f} mm"
    )


def held_in_recordings():
    from published import recordings

    s = recordings.figures()
    return (
        f"{s['haar']} false alarms in the hold{at_most(interval.rate(s['haar'], s['recordings']))}; "
        f"plain peak-to-peak of the same signal: {s['plain']} recordings"
    )


def solvers():
    from published import mesh_figures

    s = mesh_figures.figures()
    one, batch = (f"{float(f'{s[key]:.2g}'):,.0f}" for key in ("one", "batch"))
    return (
        f"equal to {s['difference']:.0e}; about {one} times faster one by one, "
        f"{batch} times in a batch of 1,000"
    )


def engines():
    axis = table.named("engine")
    rates = {point["engine"]: 1e6 * axis.cost(point)["msamples_s"] for point in axis.points()}
    return ", ".join(f"{name} {rate:.1e}".replace("e+0", "e") for name, rate in rates.items())


def jitter():
    with tempfile.TemporaryDirectory() as out:
        pins = run.run(scenes.load("acrylic_slip"), "rtl", Path(out))["pins"]
    return f"{pins['convert_jitter_clocks']} and {pins['decision_jitter_clocks']} clocks"


def soak():
    """From the command's own line: a fault ends it non-zero."""
    command = [sys.executable, str(ROOT / "tools/published/soak_link.py")]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    events, lost, wrong, images = re.match(
        r"(\d+) slip events, (\d+) lost, (\d+) wrong; beside them (\d+)", said
    ).groups()
    return f"{lost} of {int(events):,} lost, {wrong} wrong, with {int(images):,} image packets on the line"


def tested(words, *told):
    """A function that gives ``words`` after the test that asserts them has passed."""

    def measure():
        subprocess.run([sys.executable, "-m", "pytest", "-q", *told], cwd=ROOT, check=True)
        return words

    return measure


def blocks(*parts):
    """A function that gives figures of constraints/fmax.json; ``parts`` are pairs of a key and a template."""

    def measure():
        kept = area.recorded(area.BLOCKS, "make fmax FMAX=--record")
        texts = []
        for key, template in parts:
            if key not in kept:
                raise ValueError(f"{key} is not measured: make fmax FMAX=\"--record '{key.split()[0]}'\"")
            entry = kept[key] | kept[key]["area"]
            texts.append(template.format(**entry, frames=int(1e6 * entry["mhz_worst"] / BEATS)))
        return "".join(texts)

    return measure


class Row(NamedTuple):
    """A row of docs/results.md, or a section with what a command prints; ``measure`` gives the figure."""

    what: str
    measure: object
    command: str


def run_of(name):
    return f"`meissner run {name} --engine fixed`"


ROWS = {
    "first_bit": Row(
        "slip event: first bit on the line after the sample that decides",
        tested(
            "10 clocks; 19 in `slip1`, two bits a clock", "-k", "channels or smallest", "tb/core/test_core.py"
        ),
        "`pytest tb/core/test_core.py`",
    ),
    "decision": Row(
        "slip decision after the sample pair that crosses",
        tested("6 clocks tumbling, 8 sliding, at 1 to 1024 channels", "tb/slip/test_slip_path.py"),
        "`pytest tb/slip/test_slip_path.py`",
    ),
    "from_the_converter": Row(
        "the same from the ADC's sampling instant, 10 kHz; worst case: the first sample of a pair crosses",
        tested("107 µs MCP3208, 106 µs AD7606 (2 lanes, 8 channels)", "tb/core/test_latency.py"),
        "`pytest tb/core/test_latency.py`",
    ),
    "jitter": Row(
        "jitter of convert start and of the decision", jitter, "`meissner run acrylic_slip --engine rtl`"
    ),
    "slip_1024": Row(
        "slip path, 1024 channels, ECP5-25k",
        blocks(
            (
                "slip-1024 ecp5",
                "{mhz_worst:.1f} MHz, {lut} LUT, {ff} FF, {ram} block RAMs, one sample per clock",
            )
        ),
        '`make fmax FMAX="slip-1024"`',
    ),
    "slip1": Row(
        "smallest slip sensor, MCP3208 to the line, UP5K",
        blocks(("slip1 up5k", "{lut} logic cells, {mhz_worst:.1f} MHz (runs at 12)")),
        '`make fmax FMAX="slip1"`',
    ),
    "acrylic_slip": Row(
        "pre-slip flag, acrylic, 2 N, 100 runs, ±0.01 read as 0.02 V peak to peak ([slip.md](slip.md)); "
        "depends on chosen constants ([tradeoff.md](tradeoff.md))",
        scene(acrylic, "acrylic_slip"),
        run_of("acrylic_slip"),
    ),
    "slip_forces": Row(
        "the same at 2, 3 and 4 N, one threshold, 300 runs",
        scene(errors, "slip_forces"),
        run_of("slip_forces"),
    ),
    "slip_materials": Row(
        "the same on acrylic, wood, cloth and paper, 400 runs",
        scene(errors, "slip_materials"),
        run_of("slip_materials"),
    ),
    "normal_force": Row(
        "loading and unloading without slip, 200 runs",
        scene(lambda s: f"{s['false_alarms']} false alarms{at_most(s['false_alarm_rate'])}", "normal_force"),
        run_of("normal_force"),
    ),
    "recordings": Row(
        "120 real recordings of a gripper holding (no slip), threshold 23 codes",
        held_in_recordings,
        "`python tools/published/recordings.py`",
    ),
    "cop_64": Row(
        "CoP of 64×64 after the last taxel, Q2.14",
        blocks(
            ("cop-64x64-q14-turn2 ecp5", "{clocks} clocks, spread 0; {ns:.0f} ns on ECP5-25k"),
            ("cop-64x64-q14-turn2 up5k", ", {ns:.0f} ns on UP5K"),
        ),
        "`make fmax FMAX=\"'cop-64x64-q14*'\"`",
    ),
    "array_forces": Row(
        "the same calibrated",
        blocks(
            ("array_forces-64x64 ecp5", "{clocks} clocks; {ns:.0f} ns on ECP5-25k (64×64)"),
            ("array_forces-32x32 up5k", ", {ns:.0f} ns on UP5K (32×32)"),
        ),
        "`make fmax FMAX=\"'array_forces*'\"`",
    ),
    "cop_1024": Row(
        "CoP of 1024×1024, 8 lanes",
        blocks(("cop-1024x1024x8-q14-turn1 ecp5", "{frames:,} frames/s at {mhz_worst:.1f} MHz")),
        "`make fmax FMAX=\"'cop-1024*'\"`",
    ),
    "array_forces_1024": Row(
        "the same calibrated, row × column",
        blocks(("array_forces-1024x1024x8 ecp5", "{frames:,} frames/s at {mhz_worst:.1f} MHz")),
        "`make fmax FMAX=\"'array_forces*'\"`",
    ),
    "cop_budget": Row(
        "CoP by size, scan and computation counted separately",
        tested("3×3 to 64×64 within 343 µs at 12 MHz, 1024×1024 within 917 µs", "tb/cop/test_cop_budget.py"),
        "`pytest tb/cop/test_cop_budget.py`",
    ),
    "array": Row(
        "array at its pins, first convert start to CoP, all stages: 64×64 behind four AD7606C-16, rows "
        "settled to 0.5 %, four MAX11131 and eight MAX11125, to half a code; digital side: 16×16 behind one "
        "AD7606, 64×64 behind eight",
        tested(
            "744 µs, 847 µs, 814 µs; 331 µs, 662 µs; equal to the model's clock count, spread 0",
            "tb/sensor/test_array_pins.py",
        ),
        "`pytest tb/sensor/test_array_pins.py`; `meissner budget`",
    ),
    "capacitive_shapes": Row(
        "even press on 8×8 capacitive cells, largest distance of a cell from the mean",
        scene(evenness, "capacitive_shapes"),
        run_of("capacitive_shapes"),
    ),
    "fsr_64x64": Row(
        "the same on 64×64 Velostat with a dead row and a stuck taxel",
        scene(evenness, "fsr_64x64"),
        run_of("fsr_64x64"),
    ),
    "cop4": Row(
        "four electrodes to x, y, load",
        blocks(
            ("cop4 ecp5", "{clocks} clocks, {ns:.0f} ns on ECP5-25k"),
            ("cop4-correct ecp5", "; corrected {clocks}, {ns:.0f} ns"),
        ),
        "`make fmax FMAX=\"'cop4*'\"`",
    ),
    "cop_slip": Row(
        "slip from four wires, seven directions and speeds, 70 pulls; 30 runs of grip alone (it depends on "
        "chosen constants, [constants.md](constants.md))",
        scene(pulls, "cop_slip"),
        run_of("cop_slip"),
    ),
    "grip": Row(
        "a glass that a hand holds by the grip reflex while particles or water run in, 40 runs",
        poured,
        '`make figures FIGURES="grip"`; [grip_scenes.md](grip_scenes.md)',
    ),
    "mesh": Row(
        "resistor mesh 41×41, six contacts: fast solver against sparse LU",
        solvers,
        '`make figures FIGURES="mesh"`',
    ),
    "soak": Row(
        "slip events lost at full image load, 6 Mbaud at 24 MHz",
        soak,
        "`python tools/published/soak_link.py`",
    ),
    "engines": Row("engines, samples per second on one core", engines, "`meissner tradeoff --axis engine`"),
}


def printed(*command):
    """A function that gives what a command prints, as a block of text."""

    def measure():
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
        return f"```text\n{done.stdout.strip()}\n```"

    return measure


SECTIONS = {
    "scene_cost": Row(
        "What a scene saves",
        printed(sys.executable, "tools/published/scene_cost.py"),
        "`python tools/published/scene_cost.py`: processor time of a simulated second, and the same with all "
        "features of the sensor on",
    ),
    "extremes": Row(
        "Extremes",
        printed("make", "--no-print-directory", "extremes"),
        "`make extremes`: the worst error of every block and solver at the ends of its range, and its bound",
    ),
}

HEAD = """# Results

{heading}

Each figure is of this version and was measured with the command beside it, on two shared cores of an AMD
EPYC. `make figures` writes the page when a version is tagged. Fmax is nextpnr's estimate, the worst of three
seeds; it is not measured on silicon. A count's "at most" is the upper end of the exact 95 % interval of its
rate. `meissner`, `python` and `pytest` are those in `.venv/bin`; recordings are not included.

| what | figure | command |
|---|---|---|
"""
BLOCKS = """## Blocks

`make fmax FMAX="'slip*' cop4"` measures the blocks that it names, alone, with every port in registers
(`python tools/make/fmax.py --list` lists them with their parameters; `--record` keeps them in
`constraints/fmax.json`). Clocks are counted from the last input of a result to the result, ns is that time at
the clock of the worst seed. ECP5 is the 25k, speed 6. On the UP5K, LUT is logic cells.

"""
BOARDS = """## Bitstreams

`make resources` measures them into `constraints/resources.json`, as `make fmax` the blocks above: of this
version, but not all of this commit. [boards.md](boards.md) describes the boards.

{}

The time that is left of a bit at the converter's pins, from the edge that launches it to the edge that
samples it:

{}

Pairs without a bitstream:

{}
"""


def markdown(header, rows):
    """A table of Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def block_table():
    header = ("block", "target", "clocks", "MHz", "ns", "LUT", "FF", "block RAM", "DSP")
    rows = []
    for entry in area.recorded(area.BLOCKS, "make fmax FMAX=--record").values():
        used = entry["area"]
        clocks = "" if entry["clocks"] is None else entry["clocks"]
        ns = "" if entry["ns"] is None else entry["ns"]
        cells = [used["lut"], used.get("ff", ""), used["ram"], used["dsp"]]
        rows.append([entry["name"], entry["target"], clocks, f"{entry['mhz_worst']:.1f}", ns, *cells])
    return markdown(header, rows)


def results(found):
    """The text of docs/results.md with ``found``, {name of a row: its figure}."""
    rows = "".join(f"| {row.what} | {found[name]} | {row.command} |\n" for name, row in ROWS.items())
    bitstreams = BOARDS.format(*synth.tables(area.recorded(area.BOARDS, "make resources")))
    parts = [HEAD.format(heading=heading()) + rows, BLOCKS + block_table(), "", bitstreams]
    for name, section in SECTIONS.items():
        parts.append(f"## {section.what}\n\n{section.command}:\n\n{found[name]}\n")
    return "\n".join(parts)


def pages():
    """{name: a function that measures and writes a page of results}."""
    from published import constants, grip, papers, tradeoff

    of_papers = {name: lambda name=name: papers.write(name, heading()) for name in papers.NAMES}
    others = (("constants", constants), ("grip_scenes", grip), ("tradeoff", tradeoff))
    return of_papers | {name: lambda module=module: module.write(heading()) for name, module in others}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="rows or pages; all if none is named")
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    others = pages()
    if options.list:
        print(*(f"{name:20} {row.what}" for name, row in ROWS.items()), sep="\n")
        print(*(f"{name:20} {section.what}" for name, section in SECTIONS.items()), sep="\n")
        print(*(f"{name:20} a page" for name in (RESULTS, *others)), sep="\n")
        return
    known = {RESULTS, *ROWS, *SECTIONS, *others}
    if strange := [name for name in options.names if name not in known]:
        parser.error(f"no figure {strange[0]}; --list lists them")
    KEPT.mkdir(parents=True, exist_ok=True)
    path = KEPT / f"{commit()}.json"
    kept = path.exists() and "with changes" not in path.name
    found = json.loads(path.read_text("utf-8")) if kept else {}
    names = options.names or [RESULTS, *(name for name in others if name not in found)]
    if RESULTS in names:
        names = [*(name for name in [*ROWS, *SECTIONS] if name not in found), *names]
    for name in names:
        if name == RESULTS:
            (ROOT / "docs/results.md").write_text(results(found), "utf-8")
            continue
        found[name] = others[name]() if name in others else (ROWS | SECTIONS)[name].measure()
        path.write_text(json.dumps(found, ensure_ascii=False, indent=1), "utf-8")
        print(f"{name}: {found[name]}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except ValueError as problem:
        sys.exit(f"figures: {problem}")
