"""Write the figures of docs/results.md, README and the tables of blocks and boards from the records; stale
figures are marked (stale).

    python tools/figures.py                     list stale and unrecorded figures with their commands
    python tools/figures.py --page              write the pages from constraints/*.json and docs/figures.json
    python tools/figures.py --record [NAME...]  measure scenes on engine fixed and the entries of
                                                tools/measured_figures.py, record them in docs/figures.json,
                                                then write the pages

`python tools/make/fmax.py --record NAME` and `python tools/make/synth.py --record BOARD CONFIG` record the others.
"""

import argparse
import datetime
import json
import subprocess
import sys

import block_figures
import fmax
import synth
from meissner import interval
from meissner.builds import toolchain
from published import constants
from verify import revision

PAGES = (toolchain.ROOT / "docs/results.md", toolchain.ROOT / "README.md")  # all figures; the headlines
SCENES = toolchain.ROOT / "docs/figures.json"
BEATS = 1024 * 1024 / 8  # per frame, with 8 lanes
HEAD = "| what | figure | command |"


class Records:
    """The records: measured blocks, and the summaries of scenes and tools."""

    def __init__(self, blocks=None, printed=None):
        self.blocks = json.loads(fmax.RECORD.read_text()) if blocks is None else blocks
        self.printed = json.loads(SCENES.read_text()) if printed is None else printed

    def stale(self, key):
        """Whether ``key``, a block with its target or a name in docs/figures.json, has a stale record."""
        if key in self.blocks:
            return self.blocks[key].get("of") != fmax.revision_of(*key.split())
        entry = self.printed[key]
        of = entry.get("of")
        return of is None or of != revision.of_files(entry["rests_on"], "scenes")

    def says(self, key, template):
        """``template`` filled with an entry's fields, marked if the entry is stale."""
        entry = self.blocks.get(key) or self.printed[key]
        if key in self.blocks:
            fields = entry | entry.get("area", {})
            fields["frames"] = int(1e6 * entry.get("mhz_worst", 0) / BEATS)
            words = template.format(**fields)
        else:
            words = template(entry["summary"])
        return words + (" (stale)" if self.stale(key) else "")


def scene(*names):
    """A function of the records that gives the scene's figures in ``WORDS``; several scenes are added up."""
    return lambda records: "; ".join(dict.fromkeys(records.says(name, WORDS[name]) for name in names))


def owing(name, words):
    """A function of the records: a scene's figures, and ``words`` on how they depend on constants."""
    return lambda records: f"{records.says(name, WORDS[name])}; {records.says('constants', words)}"


def block(*parts):
    """A function of the records; ``parts`` are pairs of a key and a template."""
    return lambda records: "".join(records.says(key, template) for key, template in parts)


def errors(s):
    """Misses and false alarms of a slip scene, with the upper end of the interval of each rate."""

    parts = [f"{s['missed']} missed{at_most(s['missed_rate'])}"] if s["missed_rate"] else []
    return ", ".join([*parts, f"{s['false_alarms']} false{at_most(s['false_alarm_rate'])}"])


def at_most(found):
    return f" (at most {100 * found['high']:.3g} %)"


def acrylic(s):
    (c,) = s["conditions"]
    after, lead = c["delay_ms_median"], c["lead_ms_median"]
    return (
        f"{errors(s)}; {after:.1f} ms after the first partial slip (median), "
        f"{lead:.0f} ms before the whole contact slips"
    )


def grip(s):
    pulls = [c for c in s["conditions"] if c["delay_ms_median"] is not None]
    delays = [c["delay_ms_median"] for c in pulls]
    return (
        f"{errors(s)}; {min(delays):g} to {max(delays):g} ms after the pull begins (medians), "
        f"{min(c['lead_ms_min'] for c in pulls):.1f} ms or more before the object moves; "
        f"direction within {s['direction_error_deg']['maximum']:.2f}°"
    )


def owes_held(s):
    (least, most), (lead_least, _) = constants.ranges(s["held"])
    return (
        f"if one constant changes, the median of all pulls is {least:.0f} to {most:.0f} ms and the least "
        f"lead {lead_least:.1f} ms (`docs/constants.md`)"
    )


def evenness(s):
    before, after = 100 * s["unevenness_before"], 100 * s["unevenness_after"]
    found = f", the {s['dead']} faulty cells found" if s.get("dead_as_injected") else ""
    return f"{before:.1f} % before, {after:.2f} % after{found or ' calibration'}"


def held(s):
    """The figure of the glasses that the hand holds by the reflex during pouring, from the scenes' rows."""
    found = interval.rate(sum(row["dropped"] for row in s.values()), sum(row["runs"] for row in s.values()))
    ratios = [row["grip_ratio_mean"] for row in s.values()]
    return (
        f"{found['count']} of {found['runs']} dropped{at_most(found)}; grip {min(ratios):.2f} to "
        f"{max(ratios):.2f} times the least that friction allows; slip at most "
        f"{max(row['slip_mm_max'] for row in s.values()):.3f} mm"
    )


def two_digits(ratio):
    """A ratio of two times, rounded to what one run on a shared machine supports."""
    return f"{float(f'{ratio:.2g}'):,.0f}"


def owes(s):
    (least, most), _ = constants.ranges(s["rows"])
    lost = sum(constants.most_missed(row) for row in s["rows"])
    return (
        f"the median depends on chosen constants: {least:.1f} to {most:.0f} ms if one of them changes, and "
        f"with {lost} of {len(s['rows']) - 1} changes most slips are missed (`docs/constants.md`)"
    )


WORDS = {
    "acrylic_slip": acrylic,
    "slip_forces": lambda s: f"{s['runs']} runs of forces: {errors(s)}",
    "slip_materials": lambda s: f"{s['runs']} runs of materials: {errors(s)}",
    "normal_force": lambda s: f"{s['false_alarms']} false alarms{at_most(s['false_alarm_rate'])}",
    "capacitive_shapes": evenness,
    "fsr_64x64": evenness,
    "constants": lambda s: f"{owes(s)}; {owes_held(s)}",
    "cop_slip": grip,
    "grip": held,
    "recordings": lambda s: (
        f"{s['haar']} false alarms in the hold{at_most(interval.rate(s['haar'], s['recordings']))}; "
        f"plain peak-to-peak of the same signal: {s['plain']} recordings"
    ),
    "mesh": lambda s: (
        f"equal to {s['difference']:.0e}; about {two_digits(s['one'])} times faster one by one, "
        f"{two_digits(s['batch'])} times in a batch of 1,000"
    ),
    "soak": lambda s: f"{s['lost']} lost, {s['wrong']} wrong, with {s['images']:,} image packets on the line",
    "engines": lambda s: ", ".join(f"{name} {s[name]:.1e}".replace("e+0", "e") for name in s),
    "jitter": lambda s: f"{s['convert_jitter_clocks']} and {s['decision_jitter_clocks']} clocks",
}

# The command for each figure that is not measured by a scene on engine fixed.
COMMANDS = {
    "constants": "python tools/figures.py --record constants",
    "engines": "make bench",
    "grip": "python tools/figures.py --record grip",
    "jitter": "python tools/jitter.py",
    "mesh": "python tools/published/mesh_figures.py",
    "recordings": "python tools/published/recordings.py",
    "soak": "python tools/soak_link.py",
}

# Rows of the results by their first cell: a function that gives the figure from the records.
GENERATED = {
    "jitter of convert start and of the decision": scene("jitter"),
    "slip path, 1024 channels, ECP5-25k": block(
        (
            "slip-1024 ecp5",
            "{mhz_worst:.1f} MHz, {lut} LUT, {ff} FF, {ram} block RAMs, one sample per clock",
        )
    ),
    "the same, 1 channel": block(("slip-1 ecp5", "{mhz_worst:.1f} MHz, {lut} LUT, {ff} FF")),
    "smallest slip sensor, MCP3208 to decision, UP5K": block(
        ("slip1 up5k", "{lut} logic cells, {mhz_worst:.1f} MHz (runs at 12)")
    ),
    "pre-slip flag, acrylic, 2 N, 100 runs": owing("acrylic_slip", owes),
    "2, 3 and 4 N; acrylic, wood, cloth, paper; 700 runs, one threshold": scene(
        "slip_forces", "slip_materials"
    ),
    "loading and unloading without slip, 200 runs": scene("normal_force"),
    "120 real recordings of a gripper holding (no slip), threshold 23 codes": scene("recordings"),
    "CoP of 64×64 after the last taxel, Q2.14": block(
        ("cop-64x64-q14-turn2 ecp5", "{clocks} clocks, spread 0; {ns:.0f} ns on ECP5-25k"),
        ("cop-64x64-q14-turn2 up5k", ", {ns:.0f} ns on UP5K"),
    ),
    "the same calibrated": block(
        ("cop_array-64x64 ecp5", "{clocks} clocks; {ns:.0f} ns on ECP5-25k (64×64)"),
        ("cop_array-32x32 up5k", ", {ns:.0f} ns on UP5K (32×32)"),
    ),
    "CoP of 1024×1024, 8 lanes": block(
        ("cop-1024x1024x8-q14-turn1 ecp5", "{frames:,} frames/s at {mhz_worst:.1f} MHz")
    ),
    "the same calibrated, row × column": block(
        ("cop_array-1024x1024x8 ecp5", "{frames:,} frames/s at {mhz_worst:.1f} MHz")
    ),
    "even press on 8×8 capacitive cells, largest distance of a cell from the mean": scene(
        "capacitive_shapes"
    ),
    "the same on 64×64 Velostat with a dead row and a stuck taxel": scene("fsr_64x64"),
    "four electrodes to x, y, load": block(
        ("cop4 ecp5", "{clocks} clocks, {ns:.0f} ns on ECP5-25k"),
        ("cop4-correct ecp5", "; corrected {clocks}, {ns:.0f} ns"),
    ),
    "slip from four wires, seven directions and speeds, 70 pulls; 30 runs of grip alone": owing(
        "cop_slip", owes_held
    ),
    "a glass that a hand holds by the grip reflex while particles or water run in, 40 runs": scene("grip"),
    "resistor mesh 41×41, six contacts: fast solver against sparse LU": scene("mesh"),
    "slip events lost of 1,000,000 at full image load, 6 Mbaud at 24 MHz": scene("soak"),
    "engines, samples per second on one core": scene("engines"),
}


def results(text):
    """The cells of a page's table of figures: [[what, figure, command]]."""
    rows = text.partition(HEAD)[2].partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in row.strip("| ").split(" | ")] for row in rows]


def page(text, records):
    """A page's ``text`` with the recorded figures filled in."""
    for what, figure, command in results(text):
        if what in GENERATED:
            row = f"| {what} | {GENERATED[what](records)} | {command} |"
            text = text.replace(f"| {what} | {figure} | {command} |", row)
    return text


def measure(names):
    """Measure and record figures, each in its own process."""
    for name in names:
        done = subprocess.run(
            [sys.executable, str(toolchain.ROOT / "tools/measured_figures.py"), name],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        found = json.loads(done.stdout.splitlines()[-1])
        entry = {
            "command": COMMANDS.get(name, f"meissner run {name} --engine fixed --json"),
            "date": str(datetime.date.today()),
            "of": revision.of_files(found["rests_on"], "scenes"),
        }
        kept = json.loads(SCENES.read_text()) if SCENES.exists() else {}
        kept[name] = entry | found
        SCENES.write_text(json.dumps(dict(sorted(kept.items())), ensure_ascii=False, indent=1) + "\n")
        print(f"{name}: {WORDS[name](found['summary'])}", flush=True)


def fmax_command(key):
    name, target = key.split()
    return f"python tools/make/fmax.py --record {name} -t {target}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition(";")[0])
    parser.add_argument("names", nargs="*", help="all if none is named")
    parser.add_argument("--record", action="store_true", help="measure, record, write the pages")
    parser.add_argument("--page", action="store_true", help="write the pages from the records")
    options = parser.parse_args()
    if strange := [name for name in options.names if name not in WORDS]:
        parser.error(f"no figure {strange[0]}; there are {', '.join(WORDS)}")
    if options.record:
        measure(options.names or list(WORDS))
    records = Records()
    if options.record or options.page:
        for path in PAGES:
            path.write_text(page(path.read_text(), records))
        block_figures.write(records)
        pairs = json.loads(synth.RESOURCES.read_text())
        if not synth.missing(pairs):
            synth.write_tables(pairs)
        return
    for key in [*records.blocks, *records.printed]:
        if records.stale(key):
            entry = records.blocks.get(key) or records.printed[key]
            print(f"{key}: {entry.get('command') or fmax_command(key)}")
    for key in block_figures.unrecorded(records):
        print(f"{key}, {block_figures.NOT_RECORDED}: {fmax_command(key)}")


if __name__ == "__main__":
    main()
