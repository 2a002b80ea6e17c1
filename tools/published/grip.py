"""Run a hand's scene over more seeds than `meissner run` does, and print a row for each condition.

    python tools/published/grip.py grip_pour --runs 1000 --condition 0
    python tools/published/grip.py grip_release --first 1001 --set slip.threshold_share=0.007 step_mm=0.02

--condition takes a number; without it, all conditions run. Settings are chosen on seeds from 1001 on; the
page docs/grip_scenes.md has seeds from 1 on (`make figures FIGURES="grip_scenes"`).
"""

import argparse
import dataclasses
import json

from msgspec import structs

from meissner import interval, scenes
from meissner.builds import toolchain
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import AT_ONCE, PARTS, joined, statistics
from meissner.scenes.results import table

PAGE = toolchain.ROOT / "docs/grip_scenes.md"
BEGIN = "<!-- from here on measured: make figures -->"
END = "<!-- measured to here -->"
# Runs of a condition on the page; those with control cycles of 1 ms take ten times as long: a fifth.
RUNS = {"grip_disturb": 100, "grip_pour": 1000, "grip_release": 40, "grip_water": 100}
HEAD = (
    "| scene, condition | runs | dropped (95 % interval) | ratio, mean / largest | runs above 1.2 "
    "| way at most | sag / rings / slip at most | tightenings, false |"
)


def rows(scene, runs, number, engine="fixed", first=1):
    """Yield the row of a condition after each batch of seeds from ``first`` on; the last row covers all."""
    condition, held = scene.conditions[number], []
    for at in range(first, first + runs, AT_ONCE):
        seeds = range(at, min(at + AT_ONCE, first + runs))
        held.append(loop.hold(scene, condition, seeds, PARTS[engine]))
        yield statistics(condition, joined(held))


def changed(scene, settings):
    """The scene with ``settings`` KEY=VALUE of its conditions, or with a dot, of its table slip or grip."""
    for key, _, value in (one.partition("=") for one in settings):
        name, _, inner = key.rpartition(".")
        if name:
            scene = dataclasses.replace(scene, **{name: getattr(scene, name) | {inner: json.loads(value)}})
        else:
            all_of = (structs.replace(condition, **{key: float(value)}) for condition in scene.conditions)
            scene = dataclasses.replace(scene, conditions=tuple(all_of))
    return scene


def cells(name, row):
    """A row of the page's table."""
    low, high = row["dropped_interval"]
    dropped = f"0 (at most {100 * high:.3g} %)"
    if row["dropped"]:
        dropped = f"**{row['dropped']}** ({100 * low:.3g} to {100 * high:.3g} %)"
    mm = " / ".join(f"{row[f'{part}_mm_max']:.3f}" for part in ("sag", "ring", "slip"))
    return [
        f"{name}, {row['condition'].removeprefix('first event at ')}",
        *(str(row["runs"]), dropped, f"{row['grip_ratio_mean']:.3f} / {row['grip_ratio_max']:.2f}"),
        *(str(row["runs_above_ratio"]), f"{row['moved_mm_max']:.3f} mm", f"{mm} mm"),
        f"{row['tightenings'] / row['runs']:.0f}, {row['false_tightenings'] / row['runs']:.2g} a run",
    ]


def page(text, heading, kept):
    """The page's ``text`` with its table filled from ``kept``, {scene: rows}."""
    lines = [HEAD, "|" + "---|" * HEAD.count(" | ") + "---|"]
    lines += ["| " + " | ".join(cells(name, row)) + " |" for name, found in kept.items() for row in found]
    before, after = text.partition(BEGIN)[0], text.partition(END)[2]
    return before + "\n\n".join([BEGIN, heading, "\n".join(lines), END]) + after


def write(heading):
    """Measure every scene and write the page; returns its path."""
    kept = {}
    for name in scenes.names("hand"):
        scene, kept[name] = scenes.load(name), []
        for number, condition in enumerate(scene.conditions):
            runs = RUNS[name] // (5 if condition.name.endswith(" 1 ms") else 1)
            kept[name].append(list(rows(scene, runs, number))[-1])
    PAGE.write_text(page(PAGE.read_text("utf-8"), heading, kept), "utf-8")
    return str(PAGE.relative_to(toolchain.ROOT))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=scenes.names("hand"))
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=1, help="the first seed (1)")
    parser.add_argument("--condition", type=int, help="its number, from 0 on (all)")
    parser.add_argument("--engine", choices=list(PARTS), default="fixed")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="in place of the scene's")
    args = parser.parse_args()
    scene = changed(scenes.load(args.scene), args.set)
    which = range(len(scene.conditions)) if args.condition is None else [args.condition]
    found = [list(rows(scene, args.runs, number, args.engine, args.first))[-1] for number in which]
    print("\n".join(table(found)))
    count = sum(row["dropped"] for row in found)
    print("dropped:", interval.words(interval.rate(count, sum(row["runs"] for row in found))))


if __name__ == "__main__":
    main()
