"""Coverage: which points of a block and of its twin the block's own tests reach.

The tests run in builds with coverage counters (tb/harness/runner.py), whose counts are merged over all
instances and parameter sets; tb/coverage/waivers.toml leaves points out, each with a reason. A point that was
not reached, a waiver that has no reason, was hit after all or matches nothing, and more waived points than
tb/limits.toml allows break the limit.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from pathlib import Path

from meissner.builds import toolchain
from nightly import benches, evidence

ROOT = toolchain.ROOT
FOLDER = toolchain.BUILD / "coverage"
WAIVERS = ROOT / "tb/coverage/waivers.toml"
RULES = ROOT / "tb/coverage/coveragerc"
MODEL = ROOT / "model/meissner/twins"
KINDS = ("line", "branch", "toggle", "expr", "cover", "twin")
TRACES = "python/data.*.X*.H*"  # complete ones: some processes write theirs after the tests have ended
SHARED = "shared"  # in place of a block: twins' files that several blocks share, once all blocks have run


def blocks():
    return [*benches.blocks(), SHARED]


def points_of(path):
    """The points in one of Verilator's files: pairs of {key: value} and the count."""
    for line in path.read_text(encoding="latin1").splitlines():
        if line.startswith("C '"):
            key, count = line[3:].rsplit("' ", 1)
            yield dict(item.split("\x02", 1) for item in key.split("\x01")[1:]), int(count)


def merge(paths, text_of):
    """Counts by block, as {block: {(kind, label): count}}.

    A label names a point without its line number, so that it stays valid while the file changes: a toggle by
    signal and bit, any other point by the text of its source line and Verilator's comment. ``[*]`` stands for
    the index of a generate block. ``text_of``: maps a source file to its lines.
    """
    merged = defaultdict(Counter)
    for path in paths:
        for point, count in points_of(path):
            source = Path(point["f"])
            block = source.stem.removeprefix("msn_").removeprefix("cover_")
            kind, remark = point["page"].split("/")[0].removeprefix("v_"), point.get("o", "")
            if source.stem.startswith(
                "cover_"
            ):  # only its bins, and with the indices of the loops they are in
                if "bin_" not in remark or not remark.endswith(":0->1"):
                    continue
                kind, label = "cover", remark.removesuffix(":0->1").replace("bin_", "")
            elif kind == "toggle":
                label = re.sub(r"\[\d+\](?=\.)", "[*]", remark)
            else:
                at = text_of(source)[int(point["l"]) - 1]
                label = f"{remark} @ {' '.join(at.split())} :{point['n']}"
            merged[block][kind, label] += count
    return merged


def pattern(text):
    """A waiver's pattern as a regular expression: ``*`` is any text, ``{4..19}`` any number in this range."""
    parts = re.split(r"(\*|\{\d+\.\.\d+\})", text)
    for index, part in enumerate(parts):
        span = re.fullmatch(r"\{(\d+)\.\.(\d+)\}", part)
        if span:
            numbers = range(int(span[1]), int(span[2]) + 1)
            parts[index] = "(?:" + "|".join(map(str, numbers)) + ")"
        else:
            parts[index] = ".*" if part == "*" else re.escape(part)
    return re.compile("".join(parts))


def never(counts, matched):
    """Points that must not be hit. This and the next three return (points to exclude, points wrongly hit)."""
    return set(matched), {point for point in matched if counts[point]}


def constant(counts, matched):
    """Toggles of constant bits, which may change once when the simulation begins."""
    return set(matched), {point for point in matched if counts[point] and point[1].endswith(":1->0")}


def sink(counts, matched):
    """Points that may be hit or not."""
    return set(matched), set()


def counter(counts, matched):
    """Toggles of a counter's bits above the highest that toggled, if all bits below that toggled."""
    bits = defaultdict(lambda: defaultdict(set))
    for point in matched:
        signal, bit = re.fullmatch(r"(.*)\[(\d+)\]:.*", point[1]).groups()
        bits[signal][int(bit)].add(point)
    out = set()
    for points in bits.values():
        still = {bit for bit, pair in points.items() if not all(counts[point] for point in pair)}
        moved = points.keys() - still
        if moved and still and max(moved) < min(still):
            out |= {point for bit in still for point in points[bit] if not counts[point]}
    return out, set()


RULES_OF = {"never": never, "constant": constant, "sink": sink, "counter": counter}


def judge(counts, waivers, block):
    """({kind: [hit, reachable, excluded]}, lines of text for holes, lines for waiver errors) of a block with
    ``counts`` {(kind, label): count}."""
    faults, excluded = [], set()
    for waiver in waivers:
        if block not in waiver["block"].split() and waiver["block"] != "*":
            continue
        for text in waiver["points"]:
            where = f"waiver of {waiver['block']}: {text}"
            kind, label = text.split(" ", 1)
            wanted = pattern(label)
            found = [point for point in counts if point[0] == kind and wanted.fullmatch(point[1])]
            if not waiver.get("reason", "").strip():
                faults.append(f"{where}: has no reason")
            if not found and waiver["block"] != "*":
                faults.append(f"{where}: matches nothing")
            out, wrong = RULES_OF[waiver.get("rule", "never")](counts, found)
            excluded |= out
            if wrong:
                faults.append(f"{where}: was hit after all, {len(wrong)} of {len(found)}: {min(wrong)[1]}")
    row, holes = {}, []
    for kind in KINDS:
        points = {point for point in counts if point[0] == kind}
        reachable = points - excluded
        missed = sorted(point for point in reachable if not counts[point])
        row[kind] = [len(reachable) - len(missed), len(reachable), len(points) - len(reachable)]
        holes += [f"{kind} {label}" for _, label in missed]
    return row, holes, faults


def twins_of(traces, folder):
    """The counts of the twins' lines and branches in ``traces``, as in ``merge``."""
    command, rules = [sys.executable, "-m", "coverage"], f"--rcfile={RULES}"
    settings = {"cwd": ROOT, "env": {**os.environ, "COVERAGE_FILE": str(folder / "twins")}, "check": True}
    report = folder / "report.json"
    subprocess.run([*command, "combine", rules, "--quiet", "--keep", *map(str, traces)], **settings)
    subprocess.run([*command, "json", rules, "--quiet", "--ignore-errors", "-o", str(report)], **settings)
    merged = defaultdict(Counter)
    for name, file in json.loads(report.read_text())["files"].items():
        path = ROOT / name
        if not path.is_relative_to(MODEL):
            continue
        lines = [" ".join(line.split()) for line in path.read_text().splitlines()]
        text = lambda number, lines=lines: lines[number - 1] if number > 0 else "the end"
        points = merged[path.stem if path.stem in benches.blocks() else SHARED]
        where = f"{path.relative_to(MODEL)}: " if path.stem not in benches.blocks() else ""
        for done, line_key, branch_key in (
            (1, "executed_lines", "executed_branches"),
            (0, "missing_lines", "missing_branches"),
        ):
            for number in file[line_key]:
                points["twin", where + text(number)] += done
            for start, end in file[branch_key]:
                points["twin", f"{where}{text(start)} -> {text(end)}"] += done
    return merged


def run(block, limits, jobs=1):
    """The facts of a block: {kind of point: [hit, reachable, excluded]}."""
    if block == SHARED:
        traces = sorted(FOLDER.glob(f"*/{TRACES}"))
        if len({path.parent for path in traces}) < len(benches.blocks()):
            return {"text": "", "broken": ["the coverage of all blocks has to run first"]}
        return facts(twins_of(traces, FOLDER)[SHARED], block, limits, [])
    folder = FOLDER / block
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "python").mkdir(parents=True)
    environment = {
        **os.environ,
        "MEISSNER_COVERAGE": str(folder / "counts"),
        "COVERAGE_PROCESS_START": str(RULES),
        "COVERAGE_FILE": str(folder / "python/data"),
    }
    spread = ["-n", str(jobs), "--dist", "worksteal"] if jobs > 1 else ["-p", "no:xdist"]
    tests = [path.relative_to(ROOT).as_posix() for path in evidence.tests_of(block)]
    command = [sys.executable, "-m", "pytest", *spread, *tests, "-m", "not long", "--timeout", "7200"]
    failed = subprocess.run(command, cwd=ROOT, env=environment).returncode
    paths, traces = sorted(folder.glob("counts/*/*.dat")), sorted(folder.glob(TRACES))
    if not paths or not traces:
        return {"text": "", "broken": ["nothing was counted"]}
    texts = {}
    counts = merge(paths, lambda path: texts.setdefault(path, path.read_text().splitlines()))[block]
    counts.update(twins_of(traces, folder)[block])
    return facts(counts, block, limits, ["its tests fail"] if failed else [])


def facts(counts, block, limits, broken):
    row, holes, faults = judge(counts, tomllib.loads(WAIVERS.read_text())["waiver"], block)
    hit, reachable, waived = (sum(part) for part in zip(*row.values()))
    if waived > limits.waived(block):
        faults.append(f"{waived} points are waived, more than the {limits.waived(block)} of tb/limits.toml")
    if not reachable:
        faults.append("has no points")
    text = f"{hit} of {reachable} points" + (f", {waived} waived" if waived else "")
    return {"text": text, "broken": [*broken, *holes, *faults], "points": row}
