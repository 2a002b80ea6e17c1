"""Coverage points of Verilator and coverage.py, merged by place in the source and checked against waivers."""

import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from meissner.builds import toolchain
from verify import benches

ROOT = toolchain.ROOT
FOLDER = toolchain.BUILD / "coverage"
WAIVERS = ROOT / "tb/coverage/waivers.toml"
RULES = ROOT / "tb/coverage/coveragerc"
MODEL = ROOT / "model/meissner/twins"
KINDS = ("line", "branch", "toggle", "expr", "cover", "twin")
STAGES = tuple(dict.fromkeys(map(benches.stage_of, benches.blocks())))


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
    merged = defaultdict(lambda: defaultdict(int))
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


def judge(merged, waivers, blocks):
    """Rows {block: {kind: [hit, reachable, excluded]}}, and lines of text for holes and for waiver errors."""
    rows, holes, faults = {}, [], []
    excluded = defaultdict(set)
    for waiver in waivers:
        named = list(merged) if waiver["block"] == "*" else waiver["block"].split()
        judged = [name for name in named if name in blocks]
        for text in waiver["points"]:
            where = f"waiver of {waiver['block']}: {text}"
            kind, label = text.split(" ", 1)
            wanted = pattern(label)
            found = {
                name: [p for p in merged[name] if p[0] == kind and wanted.fullmatch(p[1])] for name in judged
            }
            if not waiver.get("reason", "").strip():
                faults.append(f"{where}: has no reason")
            empty = [name for name in judged if not found[name]]
            if empty and (waiver["block"] != "*" or len(empty) == len(judged) >= len(benches.blocks())):
                faults.append(f"{where}: matches nothing in {empty[0]}")
            for name, matched in found.items():
                out, wrong = RULES_OF[waiver.get("rule", "never")](merged[name], matched)
                excluded[name] |= out
                if wrong:
                    faults.append(
                        f"{where}: was hit after all, {len(wrong)} of {len(matched)}: {min(wrong)[1]}"
                    )
    for name in blocks:
        row = {}
        for kind in KINDS:
            points = {p for p in merged[name] if p[0] == kind}
            reachable = points - excluded[name]
            missed = sorted(p for p in reachable if not merged[name][p])
            row[kind] = [len(reachable) - len(missed), len(reachable), len(points) - len(reachable)]
            holes += [f"{name}: {kind} {label}" for _, label in missed]
        rows[name] = row
    return rows, holes, faults


def merge_twins(traces, merged):
    """Add the twins' lines and branches from ``traces`` to ``merged``."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "coverage"]
    rules = f"--rcfile={RULES}"
    settings = {"cwd": ROOT, "env": {**os.environ, "COVERAGE_FILE": str(FOLDER / "twins")}, "check": True}
    report = FOLDER / "report.json"
    subprocess.run([*command, "combine", rules, "--quiet", "--keep", *map(str, traces)], **settings)
    subprocess.run([*command, "json", rules, "--quiet", "--ignore-errors", "-o", str(report)], **settings)
    for name, file in json.loads(report.read_text())["files"].items():
        path = ROOT / name
        if path.parent.name not in STAGES and path != MODEL / "core.py":
            continue
        lines = [" ".join(line.split()) for line in path.read_text().splitlines()]
        text = lambda number, lines=lines: lines[number - 1] if number > 0 else "the end"
        points = merged[twin_name(path)]
        for done, line_key, branch_key in (
            (1, "executed_lines", "executed_branches"),
            (0, "missing_lines", "missing_branches"),
        ):
            for number in file[line_key]:
                points["twin", text(number)] += done
            for start, end in file[branch_key]:
                points["twin", f"{text(start)} -> {text(end)}"] += done


def twin_name(path):
    """The block whose twin is ``path``; for a file that several blocks share, its path without suffix."""
    return path.stem if path.stem in benches.blocks() else f"{path.parent.name}/{path.stem}"
